//! Five equal balls in a row without gravity, fully elastic: as many go out as came in.

use glam::DVec3;

use super::engine::{Setup, Spent, play};
use super::row::{Case, Quantity, Row};
use super::scene::{Body, Form, Scene};

/// Radius of the balls in metres.
const RADIUS_M: f64 = 0.1;

/// Speed of those that come in, in m/s.
const SPEED_M_S: f64 = 1.0;

/// What is left between those that come and those that wait, in metres.
const AWAY_M: f64 = 0.1;

/// Gaps between the waiting balls, in metres: touching, and apart.
pub const GAPS_M: [f64; 2] = [0.0, 5e-3];

/// The promise for the velocities, in m/s.
pub const VELOCITY_BOUND_M_S: f64 = 1e-4;

/// How long is played, in seconds: twice what the blow takes to arrive and pass through.
const PLAYED_S: f64 = 0.3;

/// One in and two in, touching and apart.
pub fn rows(setup: &Setup) -> Vec<Row> {
    let cases = GAPS_M.into_iter().flat_map(|gap| [(1, gap), (2, gap)]);
    cases
        .map(|(coming, gap_m)| {
            let (off, spent) = largest_off_m_s(setup, coming, gap_m);
            let gap = if gap_m > 0.0 { "5 mm gaps" } else { "touching" };
            let name = format!("{coming} in {coming} out, {gap}");
            let quantity = Quantity::absolute(Case::Cradle, name, "m/s", 0.0);
            quantity.within(VELOCITY_BOUND_M_S).row(setup, off, &spent)
        })
        .collect()
}

/// The largest difference of a ball's velocity from the exact one in m/s, and the cost.
pub fn largest_off_m_s(setup: &Setup, coming: usize, gap_m: f64) -> (f64, Spent) {
    let scene = scene(coming, gap_m);
    play(setup, &scene, |player| {
        for _ in 0..setup.frames(PLAYED_S) {
            player.step();
        }
        let off = |ball: usize| {
            let goes = ball >= 5 - coming;
            let exact = if goes {
                SPEED_M_S * DVec3::X
            } else {
                DVec3::ZERO
            };
            (player.state(ball).velocity - exact).length()
        };
        (0..5).map(off).fold(0.0, f64::max)
    })
}

fn scene(coming: usize, gap_m: f64) -> Scene {
    let ball = |index: usize| {
        let away = if index < coming { AWAY_M } else { 0.0 };
        let x = index as f64 * (2.0 * RADIUS_M + gap_m) - away;
        let mut ball = Body::loose(Form::Ball(RADIUS_M), 700.0, x * DVec3::X);
        if index < coming {
            ball.velocity = SPEED_M_S * DVec3::X;
        }
        ball
    };
    Scene {
        gravity: DVec3::ZERO,
        ..Scene::new(1.0, 0.0, (0..5).map(ball).collect())
    }
}
