//! A block that slides to a stop, and a ball that slides until it rolls.
//!
//! Both lie on the floor before they are set in motion, so that every engine starts from its own rest.

use glam::DVec3;

use super::engine::{Player, Setup, Spent, play};
use super::fit::{Sample, zero};
use super::row::{Case, Quantity, Row};
use super::scene::{Body, Form, GRAVITY, Scene};

/// Speed at the start in m/s.
const SPEED_M_S: f64 = 2.0;

/// Half height of the block, and radius of the ball, in metres.
const SIZE_M: f64 = 0.1;

/// Friction of the block and of the ball.
const FRICTION: [f64; 2] = [0.3, 0.1];

/// How long both lie before they are set in motion, in seconds; shorter than engines wait for sleep.
const SETTLED_S: f64 = 0.3;

/// What is slower than this is at rest, or rolls, in m/s.
const STILL_M_S: f64 = 1e-2;

/// How long after its slip ended the ball's speed is read, at least, in seconds.
const ROLLED_S: f64 = 0.01;

/// Samples before a stop that the line is drawn through.
const SAMPLES: usize = 8;

/// The promise for the block's stop, relative.
pub const STOP_BOUND: f64 = 1e-3;

/// The promise for the ball's speed when it rolls, relative.
pub const ROLLING_BOUND: f64 = 1e-4;

/// The promise for the ball's place after a second, in metres.
pub const PLACE_BOUND_M: f64 = 1e-4;

fn scene(form: Form, friction: f64) -> Scene {
    let body = Body::loose(form, 700.0, DVec3::new(0.0, SIZE_M, 0.0));
    Scene::new(0.0, friction, vec![Body::floor(), body])
}

/// When and where the block stops.
pub fn slide_rows(setup: &Setup) -> Vec<Row> {
    let ([stop_s, way_m], spent) = slide(setup);
    let slowing = FRICTION[0] * GRAVITY;
    let (time, way) = (SPEED_M_S / slowing, SPEED_M_S.powi(2) / (2.0 * slowing));
    let time = Quantity::relative(Case::Slide, "time to stop", "s", time);
    let way = Quantity::relative(Case::Slide, "way to stop", "m", way);
    vec![
        time.within(STOP_BOUND).row(setup, stop_s, &spent),
        way.within(STOP_BOUND).row(setup, way_m, &spent),
    ]
}

/// The block's time in seconds and way in metres, and the cost.
pub fn slide(setup: &Setup) -> ([f64; 2], Spent) {
    let scene = scene(Form::Box([0.1, SIZE_M, 0.1]), FRICTION[0]);
    play(setup, &scene, |player| {
        let from = launch(player);
        let speeds = watch(player, 1.5, |player| player.state(1).velocity.x);
        [
            zero(last_moving(&speeds)),
            player.state(1).position.x - from,
        ]
    })
}

/// Sets body 1 in motion; where it was.
fn launch(player: &mut Player) -> f64 {
    player.settle(SETTLED_S);
    player.set_velocity(1, SPEED_M_S * DVec3::X, DVec3::ZERO);
    player.state(1).position.x
}

/// A value of every frame for so many seconds.
fn watch(player: &mut Player, seconds: f64, value: impl Fn(&Player) -> f64) -> Vec<Sample> {
    let frames = player.setup().frames(seconds);
    let sample = |_| {
        player.step();
        (player.time_s(), value(player))
    };
    (0..frames).map(sample).collect()
}

/// The last samples before the value is small for the first time.
fn last_moving(samples: &[Sample]) -> &[Sample] {
    let still = samples.iter().position(|sample| sample.1 <= STILL_M_S);
    let end = still.unwrap_or(samples.len());
    &samples[end.saturating_sub(SAMPLES)..end]
}

/// When, how fast and where the ball rolls.
pub fn roll_rows(setup: &Setup) -> Vec<Row> {
    let (rolled, spent) = roll(setup);
    let slowing = FRICTION[1] * GRAVITY;
    let time = 2.0 / 7.0 * SPEED_M_S / slowing;
    let speed = 5.0 / 7.0 * SPEED_M_S;
    let place = SPEED_M_S * time - 0.5 * slowing * time * time + speed * (1.0 - time);
    let time = Quantity::relative(Case::Roll, "time to roll", "s", time);
    let speed = Quantity::relative(Case::Roll, "rolling speed", "m/s", speed);
    let place = Quantity::absolute(Case::Roll, "x after 1 s", "m", place);
    vec![
        time.row(setup, rolled.time_s, &spent),
        speed
            .within(ROLLING_BOUND)
            .row(setup, rolled.speed_m_s, &spent),
        place
            .within(PLACE_BOUND_M)
            .row(setup, rolled.place_m, &spent),
    ]
}

/// What the ball did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rolled {
    /// When its slip ended, in seconds.
    pub time_s: f64,
    /// Its speed soon after, in m/s.
    pub speed_m_s: f64,
    /// Where it was after one second, in metres.
    pub place_m: f64,
}

/// Plays the ball.
pub fn roll(setup: &Setup) -> (Rolled, Spent) {
    let scene = scene(Form::Ball(SIZE_M), FRICTION[1]);
    play(setup, &scene, |player| {
        let from = launch(player);
        let mut speeds = vec![];
        let slips = watch_both(player, &mut speeds);
        let place_m = player.state(1).position.x - from;
        let time_s = zero(last_moving(&slips));
        // Two frames on, as the one in which slip ends is still partly slid through.
        let rolls_s = time_s + ROLLED_S.max(2.0 / setup.rate_hz);
        let rolling = slips.iter().position(|slip| slip.0 >= rolls_s);
        let speed = rolling.and_then(|at| speeds.get(at));
        Rolled {
            time_s,
            speed_m_s: speed.copied().unwrap_or(f64::NAN),
            place_m,
        }
    })
}

/// Slip of every frame of one second; the speeds go into `speeds`.
fn watch_both(player: &mut Player, speeds: &mut Vec<f64>) -> Vec<Sample> {
    let frames = player.setup().frames(1.0);
    let sample = |_| {
        player.step();
        let state = player.state(1);
        speeds.push(state.velocity.x);
        // The lowest point goes at v + w x (0, -r, 0).
        (player.time_s(), state.velocity.x + state.spin.z * SIZE_M)
    };
    (0..frames).map(sample).collect()
}
