//! Random impacts of two free bodies: kinetic energy, computed from outside in f64, never rises, and momentum
//! stays.

use glam::{DQuat, DVec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::engine::{Player, Setup, Spent, play};
use super::row::{Case, Quantity, Row};
use super::scene::{Body, Form, Scene};

/// How much the energy may rise, relative to what there was at the start: what f32 rounds off momenta of
/// bodies a thousand times as heavy as each other.
pub const RISE_BOUND: f64 = 1e-5;

/// How much of the momentum may be lost, relative to the sum of both bodies' at the start: it is f32's.
pub const MOMENTUM_BOUND: f64 = 1e-4;

/// Density of the lighter body in kg/m3.
const DENSITY_KG_M3: f64 = 700.0;

/// How long before the balls around the bodies meet, in seconds.
const BEFORE_S: f64 = 0.02;

/// What a set of impacts came to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Impacts {
    /// The largest rise of the energy over a frame, relative to the energy at the start.
    pub rise_max: f64,
    /// Which impact that was.
    pub worst: u32,
    /// How many rose by more than [`RISE_BOUND`].
    pub rising: u32,
    /// The largest part of the momentum that an impact lost.
    pub momentum_off_max: f64,
    /// How many pairs met.
    pub met: u32,
    /// How many gave something infinite or not a number.
    pub not_finite: u32,
}

/// Random impacts by a seed.
pub fn rows(setup: &Setup, seed: u64, count: u32) -> Vec<Row> {
    let (found, spent) = impacts(setup, seed, count);
    let of = |name: String| Quantity::absolute(Case::Impacts, name, "", 0.0);
    let rise = of(format!("energy rise, worst of {count}")).within(RISE_BOUND);
    let rising = of("impacts that gain energy".into()).within(0.0);
    let momentum = of(format!("momentum lost, worst of {count}")).within(MOMENTUM_BOUND);
    let broken = of("impacts not finite".into()).within(0.0);
    let met = Quantity::reported(Case::Impacts, "pairs that met", "");
    vec![
        rise.row(setup, found.rise_max, &spent),
        rising.row(setup, found.rising.into(), &spent),
        momentum.row(setup, found.momentum_off_max, &spent),
        broken.row(setup, found.not_finite.into(), &spent),
        met.row(setup, found.met.into(), &spent),
    ]
}

/// Plays `count` impacts.
pub fn impacts(setup: &Setup, seed: u64, count: u32) -> (Impacts, Spent) {
    let mut spent = Spent::default();
    let mut found = Impacts::default();
    for index in 0..count {
        let (scene, seconds) = scene(seed, index);
        let (impact, cost) = impact(setup, &scene, seconds);
        spent.absorb(&cost);
        found.note(index, &impact);
    }
    (found, spent)
}

/// Plays one impact for so many seconds.
pub fn impact(setup: &Setup, scene: &Scene, seconds: f64) -> (Impact, Spent) {
    play(setup, scene, |player| watch(player, scene, seconds))
}

/// What one impact did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// The largest rise of the energy over a frame, relative to the energy at the start; NaN when a number is
    /// not finite.
    pub rise: f64,
    /// The part of the momentum that it lost, relative to the sum of both bodies' at the start.
    pub momentum_off: f64,
    /// Whether the pair met.
    pub met: bool,
}

impl Impacts {
    fn note(&mut self, index: u32, watched: &Impact) {
        self.met += u32::from(watched.met);
        if !watched.rise.is_finite() {
            self.not_finite += 1;
            return;
        }
        self.momentum_off_max = self.momentum_off_max.max(watched.momentum_off);
        self.rising += u32::from(watched.rise > RISE_BOUND);
        if watched.rise > self.rise_max {
            (self.rise_max, self.worst) = (watched.rise, index);
        }
    }
}

fn watch(player: &mut Player, scene: &Scene, seconds: f64) -> Impact {
    let energy = |player: &Player| -> f64 {
        let bodies = scene.bodies.iter().enumerate();
        bodies.map(|(i, b)| b.kinetic_j(&player.state(i))).sum()
    };
    let momenta = |player: &Player| -> Vec<DVec3> {
        let bodies = scene.bodies.iter().enumerate();
        bodies
            .map(|(i, b)| b.mass_kg() * player.state(i).velocity)
            .collect()
    };
    let start = energy(player);
    let begun = momenta(player);
    let velocity = player.state(0).velocity;
    let (mut last, mut rise) = (start, 0.0_f64);
    for _ in 0..player.setup().frames(seconds) {
        player.step();
        let now = energy(player);
        if !now.is_finite() {
            return Impact {
                rise: f64::NAN,
                momentum_off: f64::NAN,
                met: true,
            };
        }
        rise = rise.max((now - last) / start);
        last = now;
    }
    let met = player.state(0).velocity.distance(velocity) > 1e-6 * velocity.length();
    let sizes: f64 = begun.iter().map(|momentum| momentum.length()).sum();
    let changes = momenta(player).into_iter().zip(begun);
    let lost: DVec3 = changes.map(|(after, before)| after - before).sum();
    Impact {
        rise,
        momentum_off: lost.length() / sizes,
        met,
    }
}

/// Two bodies on their way into each other, and how long to watch them, in seconds.
pub fn scene(seed: u64, index: u32) -> (Scene, f64) {
    let random = &mut random_of(seed, index);
    let mut bodies = [body(random), body(random)];
    let ratio = 10f64.powf(random.random_range(0.0..3.0));
    let as_heavy = bodies[1].mass_kg() / bodies[0].mass_kg();
    bodies[0].density_kg_m3 = Some(DENSITY_KG_M3 * as_heavy * ratio);
    let reach = bodies[0].form.reach_m() + bodies[1].form.reach_m();
    let towards = direction(random);
    let aside = towards.any_orthonormal_vector() * random.random_range(0.0..0.5) * reach;
    let speed = random.random_range(2.0..20.0);
    let shared = direction(random) * random.random_range(0.0..2.0);
    let way = reach + BEFORE_S * speed;
    (bodies[0].position, bodies[1].position) = (-0.5 * way * towards, 0.5 * way * towards + aside);
    let share = random.random_range(0.0..1.0);
    bodies[0].velocity = shared + share * speed * towards;
    bodies[1].velocity = shared - (1.0 - share) * speed * towards;
    let restitution = random.random_range(0.0..1.0);
    let friction = random.random_range(0.0..1.5);
    let scene = Scene {
        gravity: DVec3::ZERO,
        ..Scene::new(restitution, friction, bodies.into())
    };
    (scene, BEFORE_S + reach / speed + 0.05)
}

fn random_of(seed: u64, index: u32) -> Pcg64Mcg {
    Pcg64Mcg::seed_from_u64(seed ^ u64::from(index).wrapping_mul(0x9E37_79B9_7F4A_7C15))
}

/// A still body at the origin that turns.
fn body(random: &mut Pcg64Mcg) -> Body {
    let mut body = Body::loose(form(random), DENSITY_KG_M3, DVec3::ZERO);
    body.rotation = rotation(random);
    body.spin = direction(random) * random.random_range(0.0..20.0);
    body
}

fn form(random: &mut Pcg64Mcg) -> Form {
    let mut size = || random.random_range(0.02..0.1);
    let sizes = [size(), size(), size()];
    match random.random_range(0..3) {
        0 => Form::Ball(sizes[0]),
        1 => Form::Box(sizes),
        _ => Form::Capsule(sizes[0], 0.5 * sizes[1]),
    }
}

fn direction(random: &mut Pcg64Mcg) -> DVec3 {
    rotation(random) * DVec3::X
}

fn rotation(random: &mut Pcg64Mcg) -> DQuat {
    loop {
        let four = [0; 4].map(|_| random.random_range(-1.0..1.0));
        let quat = DQuat::from_array(four);
        if (0.01..1.0).contains(&quat.length_squared()) {
            return quat.normalize();
        }
    }
}
