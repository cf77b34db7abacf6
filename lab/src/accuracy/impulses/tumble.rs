//! A free body that turns about its middle axis flips over and over, and keeps momentum and energy.
//!
//! Moments of 1, 2 and 3 kg m2 belong to a flat plate without thickness. This one is 10 mm thick and has
//! moments of 1, 2 and 2.9998: its flips are compared with those of a reference in f64 for the very
//! same moments.

use glam::DVec3;

use super::engine::{Player, Setup, Spent, play};
use super::row::{Case, Quantity, Row};
use super::scene::{Body, BodyState, Form, Scene};
use super::top;

/// Mass in kg and half thickness in metres.
const MASS_KG: f64 = 12.0;
const THIN_M: f64 = 5e-3;

/// Angular velocity at the start, in rad/s.
const SPIN: DVec3 = DVec3::new(0.01, 1.0, 0.01);

/// Flips whose distances are measured.
const FLIPS: usize = 4;

/// The promise for the angular momentum, relative.
pub const MOMENTUM_BOUND: f64 = 1e-6;

/// The promise for the energy, relative.
pub const ENERGY_BOUND: f64 = 1e-4;

/// How far the time between flips may be off, relative. Near the middle axis it goes with the logarithm of
/// 2 T I2 - L^2, a difference of 5e-5 of its terms, so that what f32 rounds off L alone takes some 0.1 %.
pub const FLIP_BOUND: f64 = 1e-2;

/// The plate.
pub fn plate() -> Body {
    let square = |moment: f64| 3.0 * moment / MASS_KG - THIN_M * THIN_M;
    // Rounded as the engines take them, so that the reference has the moments that they have.
    let rounded = |value: f64| f64::from(value as f32);
    let half = [square(2.0).sqrt(), square(1.0).sqrt(), THIN_M].map(rounded);
    let density = rounded(MASS_KG / (8.0 * half[0] * half[1] * half[2]));
    Body {
        spin: SPIN,
        ..Body::loose(Form::Box(half), density, DVec3::ZERO)
    }
}

/// Flips, momentum and energy over so many steps.
pub fn rows(setup: &Setup, steps: u32) -> Vec<Row> {
    let (found, spent) = tumble(setup, steps);
    let flip_s = top::flip_s(plate().inertia(), SPIN, 100.0).unwrap_or(f64::NAN);
    let flips = Quantity::relative(Case::Tumble, "time between flips", "s", flip_s);
    let name = |of: &str| format!("{of} kept over {steps} steps");
    let momentum = Quantity::absolute(Case::Tumble, name("|L|"), "", 0.0);
    let energy = Quantity::absolute(Case::Tumble, name("energy"), "", 0.0);
    vec![
        flips.within(FLIP_BOUND).row(setup, found.flip_s, &spent),
        momentum
            .within(MOMENTUM_BOUND)
            .row(setup, found.momentum_off, &spent),
        energy
            .within(ENERGY_BOUND)
            .row(setup, found.energy_off, &spent),
    ]
}

/// What the plate did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tumbled {
    /// Mean time between its first flips, in seconds; NaN when it did not flip as often.
    pub flip_s: f64,
    /// The largest change of the angular momentum's length, relative.
    pub momentum_off: f64,
    /// The largest change of the kinetic energy, relative.
    pub energy_off: f64,
}

/// Plays the plate.
pub fn tumble(setup: &Setup, steps: u32) -> (Tumbled, Spent) {
    let body = plate();
    let scene = Scene {
        gravity: DVec3::ZERO,
        ..Scene::new(0.0, 0.0, vec![body])
    };
    play(setup, &scene, |player| watch(player, &body, steps))
}

fn watch(player: &mut Player, body: &Body, steps: u32) -> Tumbled {
    let start = player.state(0);
    let momentum = body.angular_momentum(&start).length();
    let energy = body.kinetic_j(&start);
    let (mut momentum_off, mut energy_off) = (0.0_f64, 0.0_f64);
    let mut flips = vec![];
    let mut last = (0.0, about_middle(&start));
    for _ in 0..steps {
        player.step();
        let state = player.state(0);
        let now = (player.time_s(), about_middle(&state));
        if flips.len() <= FLIPS && (last.1 < 0.0) != (now.1 < 0.0) {
            flips.push(last.0 + (now.0 - last.0) * last.1 / (last.1 - now.1));
        }
        last = now;
        momentum_off =
            momentum_off.max((body.angular_momentum(&state).length() / momentum - 1.0).abs());
        energy_off = energy_off.max((body.kinetic_j(&state) / energy - 1.0).abs());
    }
    let flip_s = match (flips.first(), flips.get(FLIPS)) {
        (Some(first), Some(last)) => (last - first) / FLIPS as f64,
        _ => f64::NAN,
    };
    Tumbled {
        flip_s,
        momentum_off,
        energy_off,
    }
}

/// Spin about the body's second axis, in rad/s.
fn about_middle(state: &BodyState) -> f64 {
    (state.rotation * DVec3::Y).dot(state.spin)
}
