//! Running the hand scene and measuring it.

use cpu_time::ThreadTime;
use palpable::frame::FrameInput;
use palpable::math::Pose;
use palpable::memory::Capacities;
use palpable::recording::Sink;
use palpable::world::World;

use crate::gallery::is_inside;
use crate::hand::Hand;
use crate::hand_scene::{self, BALL, CAPACITIES, FIXED, HAND, Ids, SceneError};
use crate::memory::Block;
use crate::reference::Verdict;
use crate::report::{Ball, FrameSample, Phase, Quantiles, Run};
use crate::script::{FRAMES, HandTarget, PHASES, RATE_HZ, Script};

/// Which run of the hand scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RunPlan {
    /// The ball's shape.
    pub ball: Ball,
    /// Whether the tracker is noisy.
    pub noise: bool,
    /// Frames to run, at most [`FRAMES`].
    pub frames: u32,
}

/// The seed of the tracker's noise.
pub const NOISE_SEED: u64 = 2004;

/// What one frame showed.
struct Measured {
    sample: FrameSample,
    verdict: Verdict,
    lag_mm: Option<f64>,
    jitter_mm: Option<f64>,
}

/// Runs the hand scene; `tick` is called after every frame.
///
/// Frame time is the CPU time of the thread for telling the world the targets and stepping it; judging
/// is not in it.
///
/// # Errors
/// [`SceneError`] when the world refused something.
pub fn run(
    hand: &Hand,
    plan: &RunPlan,
    tick: impl FnMut(),
) -> Result<(Run, Capacities), SceneError> {
    run_into(hand, plan, None, tick)
}

/// Runs the hand scene and records it, if there is a sink. The recording's cost is in the frame time.
///
/// # Errors
/// [`SceneError`] when the world refused something.
pub fn run_into(
    hand: &Hand,
    plan: &RunPlan,
    sink: Option<&mut dyn Sink>,
    mut tick: impl FnMut(),
) -> Result<(Run, Capacities), SceneError> {
    let mut block = Block::new(&CAPACITIES);
    let mut world = World::create(block.bytes(), &CAPACITIES)
        .map_err(|why| SceneError(format!("world: {why:?}")))?;
    if let Some(sink) = sink {
        world.record_to(sink);
    }
    let mut script = Script::new(plan.noise.then_some(NOISE_SEED));
    let ids = hand_scene::fill(&mut world, hand, plan.ball, &script.target(0))?;
    let judge = hand_scene::judge(hand, plan.ball)?;
    let mut measured = Vec::new();
    let mut before = poses_of(&world, &ids)?;
    let mut beyond = vec![false; ids.hand_pieces.len() + 1];
    for frame in 0..plan.frames.min(FRAMES) {
        let target = script.target(frame);
        let (sample, locals) = step(&mut world, hand, &ids, &target, frame)?;
        let after = poses_of(&world, &ids)?;
        let published = hand_scene::published(&world, &ids)?;
        for (gone, pose) in beyond.iter_mut().zip(&published) {
            *gone |= !is_inside(pose.position.to_array());
        }
        measured.push(Measured {
            verdict: judge.frame(&published),
            lag_mm: target.free.then(|| lag_mm(&world, &ids, &target, &locals)),
            jitter_mm: target.resting.then(|| largest_change_mm(&before, &after)),
            sample,
        });
        before = after;
        tick();
    }
    let run = Run {
        name: name(plan),
        ball: plan.ball,
        noise: plan.noise,
        frames: measured.len() as u32,
        beyond_walls: beyond.iter().filter(|gone| **gone).count() as u32,
        state_hash: format!("{:016x}", world.hash()),
        phases: phases(&measured),
        samples: measured.iter().map(sample_of).collect(),
    };
    Ok((run, world.high_water()))
}

fn name(plan: &RunPlan) -> String {
    let ball = match plan.ball {
        Ball::Sphere => "ball as sphere",
        Ball::Hull => "ball as hull",
    };
    let noise = if plan.noise {
        "noisy tracker"
    } else {
        "no noise"
    };
    format!("{ball}, {noise}")
}

fn step(
    world: &mut World,
    hand: &Hand,
    ids: &Ids,
    target: &HandTarget,
    frame: u32,
) -> Result<(FrameSample, Vec<Pose>), SceneError> {
    let wrist = hand_scene::wrist(target);
    let locals = hand_scene::locals(hand, target);
    let input = FrameInput::unlimited((1.0 / RATE_HZ) as f32);
    let refused = |why| SceneError(format!("frame {frame}: {why:?}"));
    let begun = ThreadTime::now();
    world.set_target(ids.hand, &wrist).map_err(refused)?;
    world
        .set_piece_targets(ids.hand, &locals)
        .map_err(refused)?;
    let report = world.step(&input);
    let spent = begun.elapsed();
    let sample = FrameSample {
        frame,
        time_us: spent.as_secs_f64() * 1e6,
        contacts: report.contacts,
        impulses: report.impulses,
        units: u64::from(report.advance_units) + u64::from(report.impulse_units),
        overlap_mm: 0.0,
    };
    Ok((sample, locals))
}

fn poses_of(world: &World, ids: &Ids) -> Result<Vec<Pose>, SceneError> {
    ids.hand_pieces
        .iter()
        .map(|&piece| {
            world
                .piece_pose(piece)
                .map_err(|why| SceneError(format!("{why:?}")))
        })
        .collect()
}

/// How far the published hand is from its target, in millimetres and thousandths of quaternion
/// components; exactly zero means equal bits.
fn lag_mm(world: &World, ids: &Ids, target: &HandTarget, locals: &[Pose]) -> f64 {
    let wrist = hand_scene::wrist(target);
    let Ok(root) = world.pose(ids.hand) else {
        return f64::NAN;
    };
    let wanted: Vec<Pose> = locals
        .iter()
        .map(|local| normalised(&wrist).then(&normalised(local)))
        .collect();
    let Ok(parts) = poses_of(world, ids) else {
        return f64::NAN;
    };
    largest_change_mm(&[normalised(&wrist)], &[root]).max(largest_change_mm(&wanted, &parts))
}

fn normalised(pose: &Pose) -> Pose {
    pose.normalised(palpable::limits::WORLD_REACH_M)
        .unwrap_or(*pose)
}

fn largest_change_mm(before: &[Pose], after: &[Pose]) -> f64 {
    let numbers = |pose: &Pose| {
        let mut all = [0.0f64; 7];
        for (slot, x) in all
            .iter_mut()
            .zip(pose.rotation.iter().chain(&pose.position))
        {
            *slot = f64::from(*x);
        }
        all
    };
    let mut largest: f64 = 0.0;
    for (a, b) in before.iter().zip(after) {
        for (x, y) in numbers(a).iter().zip(numbers(b)) {
            largest = largest.max(1e3 * (x - y).abs());
        }
    }
    largest
}

fn sample_of(measured: &Measured) -> FrameSample {
    let deepest = measured.verdict.deepest.as_ref().map_or(0.0, |o| o.depth_m);
    FrameSample {
        overlap_mm: 1e3 * deepest,
        ..measured.sample
    }
}

fn phases(measured: &[Measured]) -> Vec<Phase> {
    let mut phases = Vec::new();
    for (index, &(name, first)) in PHASES.iter().enumerate() {
        let end = PHASES.get(index + 1).map_or(FRAMES, |next| next.1);
        let end = (end as usize).min(measured.len());
        if let Some(frames) = measured.get(first as usize..end)
            && let Some(phase) = phase(name, first, frames)
        {
            phases.push(phase);
        }
    }
    phases
}

fn phase(name: &str, first_frame: u32, frames: &[Measured]) -> Option<Phase> {
    let mut times: Vec<f64> = frames.iter().map(|m| m.sample.time_us).collect();
    let samples = || frames.iter().map(|m| &m.sample);
    let deepest = |one: &str, other: &str| {
        let depths = frames.iter().map(|m| m.verdict.depth_between(one, other));
        1e3 * depths.fold(0.0, f64::max)
    };
    Some(Phase {
        name: name.to_owned(),
        first_frame,
        frames: frames.len() as u32,
        frame_time_us: Quantiles::from_samples(&mut times)?,
        overlap_hand_fixed_mm_max: deepest(HAND, FIXED),
        overlap_ball_fixed_mm_max: deepest(BALL, FIXED),
        overlap_hand_ball_mm_max: deepest(HAND, BALL),
        free_lag_mm_max: largest(frames.iter().filter_map(|m| m.lag_mm)),
        jitter_mm_max: largest(frames.iter().filter_map(|m| m.jitter_mm)),
        contacts_max: samples().map(|s| s.contacts).max()?,
        contacts_mean: samples().map(|s| f64::from(s.contacts)).sum::<f64>() / frames.len() as f64,
        impulses_total: samples().map(|s| u64::from(s.impulses)).sum(),
        units_total: samples().map(|s| s.units).sum(),
        units_max: samples().map(|s| s.units).max()?,
    })
}

fn largest(values: impl Iterator<Item = f64>) -> Option<f64> {
    values.reduce(f64::max)
}
