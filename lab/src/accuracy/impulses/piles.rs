//! Twenty boxes dropped in a heap, and eight stacked for a minute: rest, overlap, creep, and what frames
//! cost awake and asleep.

use glam::{DQuat, DVec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::engine::{Player, Setup, Spent, play};
use super::row::{Case, Quantity, Row};
use super::scene::{Body, BodyState, Form, Scene};
use crate::accuracy::summary::Spread;
use crate::reference::{Judge, Pose, Solid};

/// Boxes of the heap, and of the stack.
const HEAP: usize = 20;
const STACK: usize = 8;

/// A body whose surface is slower than this is still, in m/s: the kernel's own bound.
const STILL_M_S: f64 = 0.01;

/// How long everything must be still to count as rest, in seconds; engines sleep after half of that.
const STILL_S: f64 = 1.0;

/// The promise for overlaps of loose bodies, in metres.
pub const OVERLAP_BOUND_M: f64 = 1e-3;

/// How far a box of the stack that stands may ever be to the side of where it was put, in metres: an eightieth
/// of its side.
pub const CREEP_BOUND_M: f64 = 2.5e-3;

/// How often overlaps are judged, in Hz: judging takes longer than playing.
const JUDGED_HZ: f64 = 60.0;

/// How long is played at most, in seconds.
#[derive(Clone, Copy, Debug)]
pub struct PileTimes {
    /// The heap.
    pub heap_s: f64,
    /// The stack.
    pub stack_s: f64,
}

/// The heap and the stack.
pub fn rows(setup: &Setup, seed: u64, times: PileTimes) -> Vec<Row> {
    let mut rows = heap_rows(setup, seed, times.heap_s);
    rows.extend(stack_rows(setup, times.stack_s));
    rows
}

/// What the heap did.
#[derive(Clone, Debug, Default)]
pub struct Heap {
    /// When the last box was last moving, in seconds; none when one still moved at the end.
    pub rest_s: Option<f64>,
    /// The deepest overlap of any two in metres, by the lab's reference.
    pub overlap_m: f64,
    /// CPU time of frames until rest, in microseconds.
    pub awake_us: Vec<f64>,
    /// The same afterwards.
    pub asleep_us: Vec<f64>,
}

fn heap_rows(setup: &Setup, seed: u64, seconds: f64) -> Vec<Row> {
    let (found, spent) = heap(setup, seed, seconds);
    let reported = |name: &str, unit| Quantity::reported(Case::Piles, name, unit);
    let overlap = Quantity::absolute(Case::Piles, "heap of 20: deepest overlap", "m", 0.0);
    let awake = Spread::of(found.awake_us.iter().copied());
    let asleep = Spread::of(found.asleep_us.iter().copied());
    let mut rows = vec![
        reported("heap of 20: still after", "s").row(
            setup,
            found.rest_s.unwrap_or(f64::INFINITY),
            &spent,
        ),
        overlap
            .within(OVERLAP_BOUND_M)
            .row(setup, found.overlap_m, &spent),
    ];
    if let Some(awake) = awake {
        rows.push(reported("heap of 20: awake, median", "µs").row(setup, awake.median, &spent));
        rows.push(reported("heap of 20: awake, p99", "µs").row(setup, awake.p99, &spent));
    }
    if let Some(asleep) = asleep {
        rows.push(reported("heap of 20: asleep, median", "µs").row(setup, asleep.median, &spent));
    }
    rows
}

/// Plays the heap until it was still for a second, or for so many seconds.
pub fn heap(setup: &Setup, seed: u64, seconds: f64) -> (Heap, Spent) {
    let scene = heap_scene(seed);
    let judge = judge(&scene);
    play(setup, &scene, |player| {
        watch_heap(player, &scene, &judge, seconds)
    })
}

fn watch_heap(player: &mut Player, scene: &Scene, judge: &Judge, seconds: f64) -> Heap {
    let mut found = Heap::default();
    let every = (player.setup().rate_hz / JUDGED_HZ).round().max(1.0) as u32;
    let mut moving_until = 0.0;
    for frame in 0..player.setup().frames(seconds) {
        player.step();
        if frame % every == 0 {
            let deepest = judge.frame(&poses(player, scene)).deepest;
            found.overlap_m = found
                .overlap_m
                .max(deepest.map_or(0.0, |found| found.depth_m));
        }
        let cost = player.last_frame_us();
        if (1..scene.bodies.len()).any(|body| is_moving(&scene.bodies[body], &player.state(body))) {
            moving_until = player.time_s();
            found.awake_us.append(&mut found.asleep_us);
            found.awake_us.push(cost);
        } else {
            found.asleep_us.push(cost);
        }
        if player.time_s() > moving_until + STILL_S {
            found.rest_s = Some(moving_until);
            break;
        }
    }
    // Engines fall asleep in the first half of the still time.
    let asleep = found.asleep_us.len() / 5 * 3;
    found.asleep_us.drain(..asleep);
    found
}

fn is_moving(body: &Body, state: &BodyState) -> bool {
    state.velocity.length() + state.spin.length() * body.form.reach_m() > STILL_M_S
}

/// Boxes of different sizes above each other, turned at random.
fn heap_scene(seed: u64) -> Scene {
    let random = &mut Pcg64Mcg::seed_from_u64(seed);
    let mut bodies = vec![Body::floor()];
    for index in 0..HEAP {
        let mut between = |low: f64, high: f64| random.random_range(low..high);
        let half = [between(0.04, 0.1), between(0.04, 0.1), between(0.04, 0.1)];
        let away = [between(-0.1, 0.1), between(-0.1, 0.1)];
        let turn = DVec3::new(between(-1.0, 1.0), between(-1.0, 1.0), between(-1.0, 1.0));
        let at = DVec3::new(away[0], 0.3 + 0.35 * index as f64, away[1]);
        let mut body = Body::loose(Form::Box(half), 700.0, at);
        body.rotation = DQuat::from_scaled_axis(3.0 * turn);
        bodies.push(body);
    }
    Scene {
        may_sleep: true,
        ..Scene::new(0.3, 0.5, bodies)
    }
}

fn judge(scene: &Scene) -> Judge {
    let mut judge = Judge::new();
    for (index, body) in scene.bodies.iter().enumerate() {
        let Form::Box(half) = body.form else { continue };
        // Of f32 halves, as the engines have them.
        let [x, y, z] = half.map(|h| f64::from(h as f32));
        let corners = [-1.0, 1.0].into_iter().flat_map(|i| {
            [-1.0, 1.0]
                .into_iter()
                .flat_map(move |j| [-1.0, 1.0].map(|k| DVec3::new(i * x, j * y, k * z)))
        });
        let solid = Solid::new(&corners.collect::<Vec<_>>(), 0.0).expect("a box is a solid");
        match body.density_kg_m3 {
            Some(_) => judge.add_moving(solid, index as u32, "loose", "box"),
            None => judge.add_fixed(solid, index as u32, "fixed", "floor", pose(body)),
        };
    }
    judge
}

fn pose(body: &Body) -> Pose {
    Pose::new(body.rotation, body.position)
}

fn poses(player: &Player, scene: &Scene) -> Vec<Pose> {
    let loose = (0..scene.bodies.len()).filter(|&i| scene.bodies[i].density_kg_m3.is_some());
    loose
        .map(|body| {
            let state = player.state(body);
            Pose::new(state.rotation, state.position)
        })
        .collect()
}

fn stack_rows(setup: &Setup, seconds: f64) -> Vec<Row> {
    let (creep, spent) = stack_creep_m(setup, seconds);
    let name = format!("stack of {STACK}: creep in {seconds} s");
    let creeps = Quantity::absolute(Case::Piles, name, "m", 0.0);
    vec![creeps.within(CREEP_BOUND_M).row(setup, creep, &spent)]
}

/// The farthest that a box of the stack ever was to the side of where it was put, in metres, and the cost.
pub fn stack_creep_m(setup: &Setup, seconds: f64) -> (f64, Spent) {
    let at = |index: usize| {
        let y = 0.1 + 0.2 * index as f64;
        Body::loose(Form::Box([0.1; 3]), 700.0, y * DVec3::Y)
    };
    let bodies = [Body::floor()].into_iter().chain((0..STACK).map(at));
    let scene = Scene {
        may_sleep: true,
        ..Scene::new(0.3, 0.5, bodies.collect())
    };
    play(setup, &scene, |player| {
        let mut creep = 0.0_f64;
        for _ in 0..setup.frames(seconds) {
            player.step();
            for body in 1..=STACK {
                let at = player.state(body).position;
                let aside = at.x.hypot(at.z);
                creep = if aside.is_finite() {
                    creep.max(aside)
                } else {
                    f64::INFINITY
                };
            }
        }
        creep
    })
}
