//! The spring between tracker and body: a tenth of a second in one, six, nine and a hundred steps.
//!
//! rapier's nearest thing is the motor of a prismatic joint, with the same stiffness and damping.

use palpable::couple::SpringMap;
use palpable::state::bodies::Coupling;
use rapier3d::prelude::{
    ColliderBuilder, MotorModel, PhysicsWorld, PrismaticJointBuilder, RigidBodyBuilder, Vector,
};

use super::engine::{Setup, Spent, Subject};
use super::peer::{Tuning, tune};
use super::row::{Case, Quantity, Row};

/// Displacement at the start in metres, stiffness in N/m, damping in N s/m.
const START_M: f64 = 0.1;
const STIFFNESS: f64 = 1000.0;
const DAMPING: f64 = 40.0;

/// What is played, in seconds.
const PLAYED_S: f64 = 0.1;

/// How far a displacement may be off, in metres, and a rate, in m/s: some ten roundings of f32 at 0.1 m
/// and 1 m/s, a step each for a hundred steps.
pub const PLACE_BOUND_M: f64 = 1e-6;
/// See [`PLACE_BOUND_M`].
pub const RATE_BOUND_M_S: f64 = 1e-5;

/// Masses in kg, exact displacement in metres and rate in m/s.
fn exact(mass_kg: f64) -> [f64; 2] {
    let decay = 0.5 * DAMPING / mass_kg;
    let square = STIFFNESS / mass_kg - decay * decay;
    let (cos, sin) = if square > 0.0 {
        let w = square.sqrt();
        ((w * PLAYED_S).cos(), (w * PLAYED_S).sin() / w)
    } else {
        (1.0, PLAYED_S)
    };
    let left = START_M * (-decay * PLAYED_S).exp();
    [
        left * (cos + decay * sin),
        -left * STIFFNESS / mass_kg * sin,
    ]
}

/// Displacement and rate for two masses.
pub fn rows(setup: &Setup) -> Vec<Row> {
    [1.0, 0.4]
        .into_iter()
        .flat_map(|mass_kg| both(setup, mass_kg))
        .collect()
}

fn both(setup: &Setup, mass_kg: f64) -> [Row; 2] {
    let ([place, rate], spent) = swing(setup, mass_kg);
    let [exact_place, exact_rate] = exact(mass_kg);
    let name = |of: &str| format!("{of} after 0.1 s, {mass_kg} kg");
    let places = Quantity::absolute(Case::Coupling, name("x"), "m", exact_place);
    let rates = Quantity::absolute(Case::Coupling, name("v"), "m/s", exact_rate);
    [
        places.within(PLACE_BOUND_M).row(setup, place, &spent),
        rates.within(RATE_BOUND_M_S).row(setup, rate, &spent),
    ]
}

/// Displacement in metres and rate in m/s at the end, and the cost.
pub fn swing(setup: &Setup, mass_kg: f64) -> ([f64; 2], Spent) {
    match setup.subject {
        Subject::Palpable => by_map(setup, mass_kg),
        Subject::Rapier => by_motor(setup, mass_kg, Tuning::Usual),
        Subject::RapierBest => by_motor(setup, mass_kg, Tuning::Best),
    }
}

fn by_map(setup: &Setup, mass_kg: f64) -> ([f64; 2], Spent) {
    let coupling = Coupling {
        mass_kg: mass_kg as f32,
        stiffness_n_per_m: STIFFNESS as f32,
        damping_n_s_per_m: DAMPING as f32,
        ..Coupling::DEFAULT
    };
    let (mut x, mut v) = (START_M as f32, 0.0_f32);
    let mut spent = Spent::default();
    let frames = setup.frames(PLAYED_S);
    let dt_s = PLAYED_S / f64::from(frames);
    for _ in 0..frames {
        spent.time(setup.timed, || {
            // The kernel makes the map anew in every frame, so that frames may differ in length.
            let map = SpringMap::new(&coupling, dt_s as f32);
            (x, v) = (map.xx * x + map.xv * v, map.vx * x + map.vv * v);
        });
    }
    ([x, v].map(f64::from), spent)
}

fn by_motor(setup: &Setup, mass_kg: f64, tuning: Tuning) -> ([f64; 2], Spent) {
    let mut world = PhysicsWorld {
        gravity: Vector::ZERO,
        ..PhysicsWorld::default()
    };
    let steps = tune(&mut world, tuning);
    let anchor = world.insert_body(RigidBodyBuilder::fixed());
    let start = Vector::new(START_M as f32, 0.0, 0.0);
    let body = RigidBodyBuilder::dynamic().translation(start);
    let collider = ColliderBuilder::ball(0.05).mass(mass_kg as f32);
    let body = world.insert(body, collider).0;
    let motor = PrismaticJointBuilder::new(Vector::X)
        .motor_model(MotorModel::ForceBased)
        .motor_position(0.0, STIFFNESS as f32, DAMPING as f32);
    world.insert_impulse_joint(anchor, body, motor);
    let frames = setup.frames(PLAYED_S);
    let dt_s = PLAYED_S / f64::from(frames * steps);
    world.integration_parameters.dt = dt_s as f32;
    let mut spent = Spent::default();
    for _ in 0..frames {
        spent.time(setup.timed, || {
            for _ in 0..steps {
                world.step();
            }
        });
    }
    let body = &world.bodies[body];
    let found = [body.translation().x, body.linvel().x];
    (found.map(f64::from), spent)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_values_are_those_of_the_hard_cases() {
        let [place, rate] = exact(1.0);
        assert!((place + 0.003_367_848).abs() < 1e-9, "{place}");
        assert!((rate + 0.352_584_633).abs() < 1e-9, "{rate}");
        let [place, _] = exact(0.4);
        assert!((place - 0.004_042_768).abs() < 1e-9, "{place}");
    }
}
