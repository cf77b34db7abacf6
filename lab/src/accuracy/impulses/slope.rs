//! A box on a slope: with a little more friction than the slope asks for it stays, with a little less it
//! slides, slowly. Once gravity is tilted, once the slope is.

use glam::{DQuat, DVec3};

use super::engine::{Player, Setup, Spent, play};
use super::fit::line;
use super::row::{Case, Quantity, Row};
use super::scene::{Body, Form, GRAVITY, Scene};

/// Angle of the slope in radians: 25 degrees.
const ANGLE_RAD: f64 = 25.0 * std::f64::consts::PI / 180.0;

/// Half extents of the box in metres, flat so that it does not topple.
const HALF_M: [f64; 3] = [0.1, 0.05, 0.1];

/// How long the box lies on the slope while gravity presses it straight on, in seconds.
const SETTLED_S: f64 = 0.3;

/// How long it may creep or slide, in seconds.
const PLAYED_S: f64 = 2.0;

/// How far a box that holds may creep, in metres: what nobody sees.
pub const CREEP_BOUND_M: f64 = 1e-4;

/// How far its acceleration may be off when it slides, relative.
pub const SLIDING_BOUND: f64 = 1e-2;

/// What is tilted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tilted {
    /// Gravity; the floor is level in the coordinates.
    Gravity,
    /// The floor.
    Plane,
}

impl Tilted {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Gravity, Self::Plane];

    fn name(self) -> &'static str {
        match self {
            Self::Gravity => "gravity tilted",
            Self::Plane => "plane tilted",
        }
    }

    /// How the slope lies in the coordinates.
    fn turn(self) -> DQuat {
        match self {
            Self::Gravity => DQuat::IDENTITY,
            Self::Plane => DQuat::from_rotation_z(-ANGLE_RAD),
        }
    }
}

/// Creep of the box that holds and acceleration of the box that slides.
pub fn rows(setup: &Setup) -> Vec<Row> {
    Tilted::ALL
        .into_iter()
        .flat_map(|tilted| both(setup, tilted))
        .collect()
}

fn both(setup: &Setup, tilted: Tilted) -> [Row; 2] {
    let name = tilted.name();
    let (creep, spent) = creep_m(setup, tilted);
    let holds = Quantity::absolute(Case::Slope, format!("creep in 2 s, {name}"), "m", 0.0);
    let holds = holds.within(CREEP_BOUND_M).row(setup, creep, &spent);
    let (found, spent) = acceleration(setup, tilted);
    let name = format!("acceleration, {name}");
    let slides = Quantity::relative(Case::Slope, name, "m/s2", exact_acceleration());
    [
        holds,
        slides.within(SLIDING_BOUND).row(setup, found, &spent),
    ]
}

/// Acceleration of the box that slides, in m/s2: g (sin a - mu cos a), for the friction that f32 has.
pub fn exact_acceleration() -> f64 {
    let friction = f64::from(friction(0.99) as f32);
    GRAVITY * (ANGLE_RAD.sin() - friction * ANGLE_RAD.cos())
}

fn friction(share: f64) -> f64 {
    ANGLE_RAD.tan() * share
}

/// The farthest that the box which should hold is from where it lay, in metres, and the cost.
pub fn creep_m(setup: &Setup, tilted: Tilted) -> (f64, Spent) {
    on_slope(setup, tilted, 1.01, |player| {
        let from = player.state(1).position;
        let mut farthest = 0.0_f64;
        for _ in 0..setup.frames(PLAYED_S) {
            player.step();
            farthest = farthest.max(player.state(1).position.distance(from));
        }
        farthest
    })
}

/// The acceleration of the box that should slide in m/s2, from its velocities, and the cost.
pub fn acceleration(setup: &Setup, tilted: Tilted) -> (f64, Spent) {
    let down = tilted.turn() * DVec3::X;
    on_slope(setup, tilted, 0.99, |player| {
        let mut samples = vec![];
        for _ in 0..setup.frames(PLAYED_S) {
            player.step();
            samples.push((player.time_s(), player.state(1).velocity.dot(down)));
        }
        line(&samples).1
    })
}

/// Puts the box down on the slope with a share of the friction that just holds, lets it settle, lets
/// gravity pull along the slope.
fn on_slope(
    setup: &Setup,
    tilted: Tilted,
    share: f64,
    run: impl FnOnce(&mut Player) -> f64,
) -> (f64, Spent) {
    let turn = tilted.turn();
    let placed = |mut body: Body| {
        body.position = turn * body.position;
        body.rotation = turn;
        body
    };
    let block = Body::loose(Form::Box(HALF_M), 700.0, HALF_M[1] * DVec3::Y);
    let bodies = vec![placed(Body::floor()), placed(block)];
    let scene = Scene {
        gravity: turn * DVec3::new(0.0, -GRAVITY, 0.0),
        ..Scene::new(0.0, friction(share), bodies)
    };
    let pull = GRAVITY * DVec3::new(ANGLE_RAD.sin(), -ANGLE_RAD.cos(), 0.0);
    play(setup, &scene, |player| {
        player.settle(SETTLED_S);
        player.set_velocity(1, DVec3::ZERO, DVec3::ZERO);
        player.set_gravity(turn * pull);
        run(player)
    })
}
