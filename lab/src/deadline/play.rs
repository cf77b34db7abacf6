//! A trial played at a deadline, and beside what it was without one.
//!
//! Deadlines are kept as a host would: by prices, with the wall's clock as the backstop.

use std::time::{Duration, Instant};

use glam::DVec3;
use palpable::frame::{Budget, CostTable, Deadline, FrameInput, FrameReport};
use palpable::limits::OVERLAP_SLOP_M;
use palpable::world::World;
use serde::Serialize;

use super::costs::Prices;
use super::errors::{Distances, LocalError};
use super::local::Sampler;
use super::set::{Cast, FIXED};
use super::stopwatch::{Loop, Taken, timed};
use super::trials::{Kit, RATE_HZ, Trial};
use crate::hand_scene::{SceneError, poses_of_pieces};
use crate::reference::Judge;

/// Deadlines that are tried, in microseconds.
pub const DEADLINES_US: [u32; 5] = [50, 100, 250, 500, 1000];

/// Every so many frames the driven pieces are judged in f64.
pub const JUDGED_EVERY: u32 = 50;

/// What is kept from the clock for pauses of the machine is at most one part of a deadline in so many.
const PAUSES_MOST: u64 = 3;

/// Frames at the start that are not counted: a first frame finds nothing in the caches and everything new.
const UNCOUNTED: u32 = 10;

/// Quantiles of a frame time, in microseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Times {
    /// At least half of the frames took at most this.
    pub median: f64,
    /// 99 in 100.
    pub p99: f64,
    /// 999 in 1000.
    pub p999: f64,
    /// 9999 in 10000.
    pub p9999: f64,
    /// The longest.
    pub max: f64,
}

impl Times {
    fn of(mut ns: Vec<u64>) -> Self {
        ns.sort_unstable();
        let at = |per: usize| {
            let rank = (ns.len() * per).div_ceil(10_000);
            rank.checked_sub(1).map_or(0.0, |i| 1e-3 * ns[i] as f64)
        };
        Self {
            median: at(5000),
            p99: at(9900),
            p999: at(9990),
            p9999: at(9999),
            max: at(10_000),
        }
    }
}

/// A run in which the loop without memory missed the deadline too often to say anything of frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Disturbed {
    /// See [`Outcome::misses_cpu`].
    pub misses_cpu: u32,
    /// See [`Outcome::misses_again`].
    pub misses_again: u32,
    /// See [`Outcome::misses_loop`].
    pub misses_loop: u32,
}

/// A run is disturbed in which the loop misses more than one deadline in so many.
const DISTURBED_ONE_IN: u32 = 20_000;

/// Runs that are not taken because they are disturbed; the next one is, whatever it is.
const DISTURBED_MAX: usize = 3;

/// What a trial came to at one deadline.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// Name of the trial.
    pub trial: &'static str,
    /// In microseconds; `None` without one.
    pub deadline_us: Option<u32>,
    /// Frames that were counted.
    pub frames: u32,
    /// On the thread's processor.
    pub cpu_us: Times,
    /// By the wall.
    pub wall_us: Times,
    /// Frames that took longer than the deadline on the processor.
    pub misses_cpu: u32,
    /// Those of them that did so again when the whole run was replayed to the bit from the units that its
    /// frames reported: the work itself is too much, and not only what the machine did beside it.
    pub misses_again: u32,
    /// After each frame that met the deadline a loop without memory ran as long as the frame had. Of these
    /// loops, how many took longer than the deadline on the processor: what the machine does without us.
    pub misses_loop: u32,
    /// Frames that took longer than the deadline by the wall.
    pub misses_wall: u32,
    /// Runs before this one that were not taken, because the loop missed too often in them.
    pub disturbed: Vec<Disturbed>,
    /// Frames that took longer than they were priced.
    pub above_price: u32,
    /// Frames that were cut by time.
    pub cut: u32,
    /// Frames that the clock ended.
    pub late: u32,
    /// Frames whose deadline was below their floor.
    pub below_floor: u32,
    /// Frames that were judged in f64.
    pub judged: u32,
    /// Judged frames in which a driven piece overlapped a fixed one by more than promised.
    pub violations: u32,
    /// Deepest overlap with a fixed piece, in millimetres.
    pub overlap_mm: f64,
    /// Distance of the driven pieces from where they are without a deadline, after so many frames from
    /// the same state; none without a deadline.
    pub local_errors: Vec<LocalError>,
    /// Distance of the driven pieces from where the whole run without a deadline had them.
    pub run_error: Distances,
    /// Mean time that a frame was priced at, in microseconds: what the error is drawn against.
    pub priced_us_mean: f64,
}

/// The run without a deadline, as far as others are compared with it.
#[derive(Default)]
pub struct Trace {
    /// Where the driven pieces were, frame by frame.
    positions: Vec<f32>,
    sampler: Sampler,
}

impl Trace {
    /// For local errors at these deadlines, in microseconds. They are sampled by prices alone, with no
    /// clock, so that they are the same whatever else the machine does.
    #[must_use]
    pub fn sampled_at(deadlines_us: &[u32], prices: &Prices) -> Self {
        let inputs = deadlines_us.iter().map(|&us| input(Some(us), prices));
        Self {
            sampler: Sampler::new(inputs),
            ..Self::default()
        }
    }

    /// The local errors at each deadline; they are given once.
    pub fn take_local_errors(&mut self) -> Vec<Vec<LocalError>> {
        std::mem::take(&mut self.sampler).errors()
    }
}

struct Counts {
    /// What every frame spent, those that are not counted too.
    spent: Vec<Budget>,
    cpu_ns: Vec<u64>,
    wall_ns: Vec<u64>,
    misses_loop: u32,
    above_price: u32,
    cut: u32,
    late: u32,
    below_floor: u32,
    judged: u32,
    violations: u32,
    overlap_m: f64,
    errors_mm: Vec<f64>,
    priced_ns: u64,
}

/// Plays so many frames of a trial. Without a deadline it fills the trace; with one it is compared with it.
///
/// # Errors
/// [`SceneError`] when the trial could not be set or played.
pub fn play(
    kit: &Kit,
    trial: Trial,
    frames: u32,
    deadline_us: Option<u32>,
    prices: &Prices,
    trace: &mut Trace,
) -> Result<Outcome, SceneError> {
    let input = input(deadline_us, prices);
    let mut counts = Counts::new(frames);
    let beside = Loop::measured();
    if deadline_us.is_none() {
        trace.positions.clear();
    }
    let hash = kit.stage(trial, |world, cast, judge| {
        for frame in 0..frames + UNCOUNTED {
            if deadline_us.is_none() && trace.sampler.is_due(frame, frames + UNCOUNTED) {
                let tell = |world: &mut World, frame| kit.tell(trial, world, cast, frame);
                trace.sampler.branch(world, cast, frame, tell)?;
            }
            kit.tell(trial, world, cast, frame)?;
            let (report, taken) = step(world, &input, deadline_us, prices);
            if deadline_us.is_none() {
                trace.sampler.compare(world, cast, frame)?;
            }
            counts.spent.push(report.spent());
            if frame < UNCOUNTED {
                continue;
            }
            counts.note(&report, taken);
            if let Some(us) = deadline_us {
                counts.note_loop(&beside, taken, u64::from(us) * 1000);
            }
            let counted = frame - UNCOUNTED;
            compare(world, cast, deadline_us, counted, trace, &mut counts)?;
            if frame % JUDGED_EVERY == 0 {
                counts.judge(judge, world, cast)?;
            }
        }
        Ok(world.hash())
    })?;
    let again_ns = match deadline_us {
        Some(us) if counts.misses(us) > 0 => replay(kit, trial, &counts.spent, hash)?,
        _ => vec![],
    };
    Ok(counts.outcome(trial, deadline_us, &again_ns))
}

/// The same until the machine leaves it alone: a run is not taken in which a loop that does nothing of ours misses the
/// deadline too often, whatever our frames did, but three at most. What those showed is told.
///
/// # Errors
/// As [`play`].
pub fn play_undisturbed(
    kit: &Kit,
    trial: Trial,
    frames: u32,
    deadline_us: u32,
    prices: &Prices,
    trace: &mut Trace,
) -> Result<Outcome, SceneError> {
    let mut disturbed = Vec::new();
    loop {
        let outcome = play(kit, trial, frames, Some(deadline_us), prices, trace)?;
        let is_disturbed = outcome.misses_loop > outcome.frames / DISTURBED_ONE_IN;
        if !is_disturbed || disturbed.len() == DISTURBED_MAX {
            return Ok(Outcome {
                disturbed,
                ..outcome
            });
        }
        disturbed.push(Disturbed {
            misses_cpu: outcome.misses_cpu,
            misses_again: outcome.misses_again,
            misses_loop: outcome.misses_loop,
        });
    }
}

/// Plays a trial again with what its frames spent as their budgets; the frame times on the processor, in
/// nanoseconds.
fn replay(kit: &Kit, trial: Trial, spent: &[Budget], hash: u64) -> Result<Vec<u64>, SceneError> {
    let mut cpu_ns = Vec::with_capacity(spent.len());
    let came_to = kit.stage(trial, |world, cast, _| {
        for (frame, &budget) in spent.iter().enumerate() {
            kit.tell(trial, world, cast, frame as u32)?;
            let input = FrameInput {
                budget,
                ..FrameInput::unlimited(1.0 / RATE_HZ)
            };
            let (_, taken) = timed(|| world.step(&input));
            if frame >= UNCOUNTED as usize {
                cpu_ns.push(taken.cpu_ns);
            }
        }
        Ok(world.hash())
    })?;
    if came_to == hash {
        Ok(cpu_ns)
    } else {
        Err(SceneError(format!(
            "{}: its frames with what they spent as their budgets came to something else",
            trial.name()
        )))
    }
}

/// Time on the processor that so many frames of a trial take, after those that are not counted.
///
/// # Errors
/// [`SceneError`] when the trial could not be set or played.
pub fn time(
    kit: &Kit,
    trial: Trial,
    frames: u32,
    deadline_us: Option<u32>,
    prices: &Prices,
) -> Result<Duration, SceneError> {
    let input = input(deadline_us, prices);
    let mut cpu_ns = 0;
    kit.stage(trial, |world, cast, _| {
        for frame in 0..frames + UNCOUNTED {
            kit.tell(trial, world, cast, frame)?;
            let (_, taken) = step(world, &input, deadline_us, prices);
            cpu_ns += if frame < UNCOUNTED { 0 } else { taken.cpu_ns };
        }
        Ok(())
    })?;
    Ok(Duration::from_nanos(cpu_ns))
}

/// One frame, by its prices and by the wall's clock, which is over a little before the deadline: a pause of the machine
/// after the last look at it is not to be too much.
fn step(
    world: &mut World,
    input: &FrameInput,
    deadline_us: Option<u32>,
    prices: &Prices,
) -> (FrameReport, Taken) {
    let Some(us) = deadline_us else {
        return timed(|| world.step(input));
    };
    let ends_ns = u64::from(us) * 1000;
    let floor_ns = world.floor_ns(&CostTable::from(*prices));
    timed(|| {
        let begun = Instant::now();
        let clock = || begun.elapsed().as_nanos() as u64;
        world.step_by_clock(
            input,
            &clock,
            clock_ends_ns(ends_ns, prices).saturating_sub(floor_ns),
        )
    })
}

/// When a frame with a deadline is to be over by the clock.
fn clock_ends_ns(deadline_ns: u64, prices: &Prices) -> u64 {
    deadline_ns - u64::from(prices.pauses_ns).min(deadline_ns / PAUSES_MOST)
}

fn input(deadline_us: Option<u32>, prices: &Prices) -> FrameInput {
    let (dt_s, costs) = (1.0 / RATE_HZ, CostTable::from(*prices));
    match deadline_us {
        // Priced all the same, so that the report tells what the frame cost.
        None => FrameInput::within(
            dt_s,
            Deadline {
                time_ns: 1 << 50,
                costs,
            },
        ),
        Some(us) => FrameInput::within(
            dt_s,
            Deadline {
                time_ns: u64::from(us) * 1000,
                costs,
            },
        ),
    }
}

/// Notes where the driven pieces are, or how far they are from what was noted.
fn compare(
    world: &World,
    cast: &Cast,
    deadline_us: Option<u32>,
    frame: u32,
    trace: &mut Trace,
    counts: &mut Counts,
) -> Result<(), SceneError> {
    let count = cast.pieces.len();
    let first = frame as usize * count * 3;
    let mut sum = 0.0;
    for (index, &piece) in cast.pieces.iter().enumerate() {
        let pose = world
            .piece_pose(piece)
            .map_err(|e| SceneError(format!("{e:?}")))?;
        if deadline_us.is_none() {
            trace.positions.extend(pose.position);
        } else {
            let noted = &trace.positions[first + 3 * index..first + 3 * index + 3];
            let [x, y, z]: [f64; 3] =
                std::array::from_fn(|i| f64::from(pose.position[i]) - f64::from(noted[i]));
            sum += DVec3::new(x, y, z).length();
        }
    }
    counts.errors_mm.push(1e3 * sum / count.max(1) as f64);
    Ok(())
}

impl Counts {
    fn new(frames: u32) -> Self {
        let room = frames as usize;
        Self {
            spent: Vec::with_capacity(room + UNCOUNTED as usize),
            cpu_ns: Vec::with_capacity(room),
            wall_ns: Vec::with_capacity(room),
            misses_loop: 0,
            above_price: 0,
            cut: 0,
            late: 0,
            below_floor: 0,
            judged: 0,
            violations: 0,
            overlap_m: 0.0,
            errors_mm: Vec::with_capacity(room),
            priced_ns: 0,
        }
    }

    fn note(&mut self, report: &FrameReport, taken: Taken) {
        self.cpu_ns.push(taken.cpu_ns);
        self.wall_ns.push(taken.wall_ns);
        let has = |flag: u32| u32::from(report.flags & flag != 0);
        self.above_price += u32::from(taken.cpu_ns > report.priced_ns);
        self.cut += has(FrameReport::OUT_OF_TIME);
        self.late += has(FrameReport::LATE);
        self.below_floor += has(FrameReport::BELOW_FLOOR);
        self.priced_ns += report.priced_ns;
    }

    /// Runs a loop as long as a frame that met its deadline took.
    fn note_loop(&mut self, beside: &Loop, taken: Taken, most_ns: u64) {
        if taken.cpu_ns <= most_ns {
            self.misses_loop += u32::from(beside.run(taken.cpu_ns) > most_ns);
        }
    }

    fn judge(&mut self, judge: &Judge, world: &World, cast: &Cast) -> Result<(), SceneError> {
        let verdict = judge.frame(&poses_of_pieces(world, &cast.pieces)?);
        let depth = verdict.depth_between("driven", FIXED);
        self.judged += 1;
        self.violations += u32::from(depth > f64::from(OVERLAP_SLOP_M));
        self.overlap_m = self.overlap_m.max(depth);
        Ok(())
    }

    /// Frames that took longer than a deadline on the processor.
    fn misses(&self, deadline_us: u32) -> usize {
        let most = u64::from(deadline_us) * 1000;
        self.cpu_ns.iter().filter(|&&ns| ns > most).count()
    }

    /// `again_ns` are the frame times of a replay; none when there was none.
    fn outcome(self, trial: Trial, deadline_us: Option<u32>, again_ns: &[u64]) -> Outcome {
        let both: Vec<u64> = self
            .cpu_ns
            .iter()
            .zip(again_ns)
            .map(|(&a, &b)| a.min(b))
            .collect();
        let frames = self.cpu_ns.len();
        let late = |ns: &[u64]| {
            let most = deadline_us.map_or(u64::MAX, |us| u64::from(us) * 1000);
            ns.iter().filter(|&&ns| ns > most).count() as u32
        };
        let (misses_cpu, misses_wall) = (late(&self.cpu_ns), late(&self.wall_ns));
        Outcome {
            trial: trial.name(),
            deadline_us,
            frames: frames as u32,
            cpu_us: Times::of(self.cpu_ns),
            wall_us: Times::of(self.wall_ns),
            misses_cpu,
            misses_again: late(&both),
            misses_loop: self.misses_loop,
            misses_wall,
            disturbed: vec![],
            above_price: self.above_price,
            cut: self.cut,
            late: self.late,
            below_floor: self.below_floor,
            judged: self.judged,
            violations: self.violations,
            overlap_mm: 1e3 * self.overlap_m,
            local_errors: vec![],
            run_error: Distances::of_mm(self.errors_mm),
            priced_us_mean: 1e-3 * self.priced_ns as f64 / frames.max(1) as f64,
        }
    }
}
