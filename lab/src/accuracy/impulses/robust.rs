//! Bodies ten thousand times as heavy as their neighbours, and slender rods that friction jams, at frames
//! from a tenth of a millisecond to a tenth of a second: numbers stay finite, and no energy is gained.

use glam::{DQuat, DVec3};
use palpable::limits::LOOSE_REST_M;

use super::engine::{Player, Setup, Spent, Subject, play};
use super::row::{Case, Quantity, Row};
use super::scene::{Body, Form, GRAVITY, Scene};

/// Frame rates of these cases, in Hz: from the shortest frame that is stepped as it is to the longest.
pub const RATES_HZ: [f64; 5] = [10.0, 60.0, 90.0, 1000.0, 10_000.0];

/// What is played, in seconds.
const PLAYED_S: f64 = 1.0;

/// A scene that engines may lose themselves in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hard {
    /// A light box on the floor with a box ten thousand times as heavy on it.
    HeavyOnLight,
    /// The other way round.
    LightOnHeavy,
    /// A rod of 1 m that slides and turns into a floor of much friction (after Painleve).
    Rod,
    /// The same rod, thrown flat and fast.
    RodThrown,
    /// The rod let go with restitution and friction of one at (0.1, -1) m/s, where solving friction after
    /// restitution would gain energy.
    RodElastic,
}

impl Hard {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::HeavyOnLight,
        Self::LightOnHeavy,
        Self::Rod,
        Self::RodThrown,
        Self::RodElastic,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::HeavyOnLight => "10000:1 on a box",
            Self::LightOnHeavy => "1:10000 on a box",
            Self::Rod => "jammed rod, friction 2",
            Self::RodThrown => "thrown rod, friction 2",
            Self::RodElastic => "rod, e = friction = 1",
        }
    }

    fn scene(self) -> Scene {
        match self {
            Self::HeavyOnLight => boxes([10.0, 1e5]),
            Self::LightOnHeavy => boxes([1e5, 10.0]),
            Self::Rod => rod(0.9, DVec3::new(3.0, -0.5, 0.0), DVec3::new(0.0, 0.0, -2.0)),
            Self::RodThrown => rod(0.2, DVec3::new(6.0, -3.0, 1.0), DVec3::new(3.0, 0.0, 9.0)),
            Self::RodElastic => Scene {
                restitution: 1.0,
                friction: 1.0,
                ..rod(0.8, DVec3::new(0.1, -1.0, 0.0), DVec3::ZERO)
            },
        }
    }
}

/// Two boxes of these densities, one 5 mm above the other, which is 5 mm above the floor.
fn boxes(densities: [f64; 2]) -> Scene {
    let at = |index: usize| {
        let y = 0.105 + index as f64 * 0.205;
        Body::loose(Form::Box([0.1; 3]), densities[index], y * DVec3::Y)
    };
    Scene::new(0.3, 0.5, vec![Body::floor(), at(0), at(1)])
}

/// A rod at an angle to the floor in radians, its lower end 2 mm above it.
fn rod(angle_rad: f64, velocity: DVec3, spin: DVec3) -> Scene {
    let half = [0.5, 0.01, 0.01];
    let low = half[0] * angle_rad.sin() + half[1] * angle_rad.cos();
    let mut rod = Body::loose(Form::Box(half), 700.0, (low + 2e-3) * DVec3::Y);
    rod.rotation = DQuat::from_rotation_z(-angle_rad);
    (rod.velocity, rod.spin) = (velocity, spin);
    Scene::new(0.2, 2.0, vec![Body::floor(), rod])
}

/// What a rise may be, in J: gaps that the kernel restores lift bodies by at most two rest gaps.
pub fn restored_j(hard: Hard) -> f64 {
    let scene = hard.scene();
    let weight: f64 = scene.bodies.iter().map(Body::mass_kg).sum::<f64>() * GRAVITY;
    2.0 * f64::from(LOOSE_REST_M) * weight
}

/// The largest rises of the energy.
pub fn rows(subject: Subject, timed: bool) -> Vec<Row> {
    let setups = RATES_HZ.map(|rate_hz| Setup {
        subject,
        rate_hz,
        timed,
    });
    let cases = setups.iter().flat_map(|s| Hard::ALL.map(|hard| (s, hard)));
    cases.flat_map(|(setup, hard)| both(setup, hard)).collect()
}

fn both(setup: &Setup, hard: Hard) -> [Row; 2] {
    let (rise_j, start_j, spent) = rise(setup, hard);
    let name = format!("{}: energy rise", hard.name());
    let joules = Quantity::absolute(Case::Robustness, name, "J", 0.0);
    let name = format!("{}: rise over start", hard.name());
    let share = Quantity::reported(Case::Robustness, name, "");
    [
        joules.within(restored_j(hard)).row(setup, rise_j, &spent),
        share.row(setup, rise_j / start_j, &spent),
    ]
}

/// The largest rise of the mechanical energy above its least before in J, infinite when a number is not
/// finite; the energy at the start in J; the cost.
pub fn rise(setup: &Setup, hard: Hard) -> (f64, f64, Spent) {
    let scene = hard.scene();
    let ((rise, start), spent) = play(setup, &scene, |player| {
        let start = energy_j(player, &scene);
        let (mut least, mut rise) = (start, 0.0_f64);
        for _ in 0..setup.frames(PLAYED_S) {
            player.step();
            let now = energy_j(player, &scene);
            if !now.is_finite() {
                return (f64::INFINITY, start);
            }
            least = least.min(now);
            rise = rise.max(now - least);
        }
        (rise, start)
    });
    (rise, start, spent)
}

/// Kinetic and potential energy in J, the latter above the floor.
fn energy_j(player: &Player, scene: &Scene) -> f64 {
    let bodies = scene.bodies.iter().enumerate();
    bodies
        .filter(|(_, body)| body.density_kg_m3.is_some())
        .map(|(index, body)| {
            let state = player.state(index);
            body.kinetic_j(&state) + body.mass_kg() * GRAVITY * state.position.y
        })
        .sum()
}
