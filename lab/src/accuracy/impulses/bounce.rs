//! A ball dropped from a metre: when it comes to rest, and how high it bounces.
//!
//! Rest falls between two frames, and what an engine does within one cannot be seen. So the drop is played
//! several times, each time begun a little later in its fall, and every one says that rest came after one
//! frame and before the next. The mean of the middles is what is measured: exact for an engine whose
//! answer does not depend on where frames begin, to a frame over twice the number of drops.

use glam::DVec3;

use super::engine::{Player, Setup, Spent, play};
use super::fit::vertex;
use super::row::{Case, Quantity, Row};
use super::scene::{Body, Form, GRAVITY, Scene};

/// Radius of the ball in metres.
const RADIUS_M: f64 = 0.1;

/// What it falls through, surface to floor, in metres.
const HEIGHT_M: f64 = 1.0;

/// Drops that begin at different times within a frame.
const PHASES: u32 = 8;

/// What is faster than this still moves, in m/s. With a restitution of 0.9 a bounce that leaves at this
/// speed takes 4 ms to come to its end, 0.05 % of the whole.
const MOVING_M_S: f64 = 2e-3;

/// What is higher above its last place than this still moves, in metres.
const MOVING_M: f64 = 1e-4;

/// The promise for the time to rest, relative.
pub const REST_BOUND: f64 = 5e-3;

/// Restitutions, and bounces whose height is compared.
const RESTITUTIONS: [(f64, u32); 3] = [(0.3, 2), (0.5, 3), (0.9, 3)];

/// When the dropped ball is at rest, in seconds: the fall, and ever shorter bounces.
pub fn rest_s(restitution: f64) -> f64 {
    let fall = (2.0 * HEIGHT_M / GRAVITY).sqrt();
    fall * (1.0 + restitution) / (1.0 - restitution)
}

/// Times to rest and heights of bounces for the three restitutions.
pub fn rows(setup: &Setup) -> Vec<Row> {
    let drops = RESTITUTIONS.into_iter();
    drops
        .flat_map(|(restitution, bounces)| drop_rows(setup, restitution, bounces))
        .collect()
}

fn drop_rows(setup: &Setup, restitution: f64, bounces: u32) -> Vec<Row> {
    let (rest, heights, spent) = measure(setup, restitution);
    let name = format!("time to rest, e = {restitution}");
    let quantity = Quantity::relative(Case::Bounce, name, "s", rest_s(restitution));
    let mut rows = vec![quantity.within(REST_BOUND).row(setup, rest, &spent)];
    for bounce in 1..=bounces {
        let exact = restitution.powi(2 * bounce as i32) * HEIGHT_M;
        let name = format!("height {bounce}, e = {restitution}");
        let found = heights.get(bounce as usize - 1).copied();
        let quantity = Quantity::relative(Case::Bounce, name, "m", exact);
        rows.push(quantity.row(setup, found.unwrap_or(f64::NAN), &spent));
    }
    rows
}

/// Time to rest in seconds, heights of the first bounces in metres, and the cost.
pub fn measure(setup: &Setup, restitution: f64) -> (f64, Vec<f64>, Spent) {
    let (mut rest, mut spent) = (0.0, Spent::default());
    let mut heights = vec![];
    for phase in 0..PHASES {
        let begun_s = f64::from(phase) / f64::from(PHASES) / setup.rate_hz;
        let scene = dropped(restitution, begun_s);
        let seconds = 1.3 * rest_s(restitution);
        let (samples, cost) = play(setup, &scene, |player| watch(player, seconds));
        rest += (begun_s + last_moving_s(setup, &samples)) / f64::from(PHASES);
        spent.absorb(&cost);
        if phase == 0 {
            heights = peaks(&samples);
        }
    }
    (rest, heights, spent)
}

/// The drop after it has lasted for `begun_s` seconds.
fn dropped(restitution: f64, begun_s: f64) -> Scene {
    let fallen = 0.5 * GRAVITY * begun_s * begun_s;
    let height = RADIUS_M + HEIGHT_M - fallen;
    let mut ball = Body::loose(Form::Ball(RADIUS_M), 700.0, DVec3::new(0.0, height, 0.0));
    ball.velocity.y = -GRAVITY * begun_s;
    Scene::new(restitution, 0.0, vec![Body::floor(), ball])
}

/// Height of the ball's surface in metres and its speed in m/s, frame by frame from the first one's end.
fn watch(player: &mut Player, seconds: f64) -> Vec<(f64, f64)> {
    let frames = player.setup().frames(seconds);
    (0..frames)
        .map(|_| {
            player.step();
            let state = player.state(1);
            (state.position.y - RADIUS_M, state.velocity.length())
        })
        .collect()
}

/// The middle of the frame in which the ball stopped moving.
fn last_moving_s(setup: &Setup, samples: &[(f64, f64)]) -> f64 {
    let last = samples.last().map_or(0.0, |sample| sample.0);
    let moves = |&(height, speed): &(f64, f64)| speed > MOVING_M_S || height > last + MOVING_M;
    let frames = samples.iter().rposition(moves).map_or(0, |at| at + 1);
    (frames as f64 + 0.5) / setup.rate_hz
}

/// The tops of the bounces that are seen in three frames at least.
fn peaks(samples: &[(f64, f64)]) -> Vec<f64> {
    let triples = samples.windows(3);
    triples
        .map(|three| [three[0].0, three[1].0, three[2].0])
        .filter(|[before, top, after]| top > before && top >= after)
        .map(vertex)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_times_are_those_of_the_hard_cases() {
        for (restitution, exact) in [(0.3, 0.838_544), (0.5, 1.354_571), (0.9, 8.578_949)] {
            assert!((rest_s(restitution) - exact).abs() < 1e-6);
        }
    }
}
