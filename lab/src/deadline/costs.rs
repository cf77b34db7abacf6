//! What work costs on this machine: a cost table from measured frames.
//!
//! Whatever a frame does in any case is priced first, in worlds that have nothing else; then the units of
//! each stage, in frames of which most is that stage; and last all prices are raised by what the worst of
//! the trials' frames cost more than they were priced. Every few frames the caches are emptied. The result
//! is a measured worst case with a margin, not a guarantee.

use palpable::frame::{Budget, Census, CostTable, FrameInput};
use palpable::limits::BOXES_PER_UNIT;
use palpable::math::Pose;
use palpable::state::bodies::BodyKind;
use palpable::world::{BodyDef, PieceDef, Shape, World};
use serde::{Deserialize, Serialize};

use super::set::Set;
use super::stopwatch::{Eviction, timed};
use super::trials::{Kit, RATE_HZ, Trial};
use crate::hand_scene::SceneError;
use crate::memory::Block;

/// What is added to what was measured.
const MARGIN: f64 = 1.25;

/// Every so many frames the caches are emptied.
const COLD_EVERY: u32 = 4;

/// A cost table as it is written to a file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Prices {
    /// Fields as in [`CostTable`].
    pub frame_ns: u32,
    /// See `frame_ns`.
    pub body_ns: u32,
    /// See `frame_ns`.
    pub piece_ns: u32,
    /// See `frame_ns`.
    pub chain_ns: u32,
    /// See `frame_ns`.
    pub boxes_ns: u32,
    /// See `frame_ns`.
    pub advance_unit_ns: u32,
    /// See `frame_ns`.
    pub impulse_unit_ns: u32,
    /// See `frame_ns`.
    pub reach_step_ns: u32,
}

impl From<Prices> for CostTable {
    fn from(prices: Prices) -> Self {
        Self {
            frame_ns: prices.frame_ns,
            body_ns: prices.body_ns,
            piece_ns: prices.piece_ns,
            chain_ns: prices.chain_ns,
            boxes_ns: prices.boxes_ns,
            advance_unit_ns: prices.advance_unit_ns,
            impulse_unit_ns: prices.impulse_unit_ns,
            reach_step_ns: prices.reach_step_ns,
        }
    }
}

/// A frame as the prices see it.
#[derive(Clone, Copy)]
struct Frame {
    cpu_ns: f64,
    census: Census,
    spent: Budget,
}

/// What was found.
#[derive(Clone, Copy, Debug)]
pub struct Calibration {
    /// With all margins.
    pub prices: Prices,
    /// What all prices were raised by at the end, because frames cost more than they were priced.
    pub raised: f64,
    /// Frames that were timed.
    pub frames: usize,
}

/// A value that all but one in `left_out` do not exceed.
fn nearly_worst(mut values: Vec<f64>, left_out: usize) -> f64 {
    values.sort_by(f64::total_cmp);
    let rank = values.len() - values.len() / left_out;
    values[rank.clamp(1, values.len()) - 1]
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// Times frames of a world.
fn frames_of(
    world: &mut World,
    count: u32,
    mut input: impl FnMut(&mut World, u32) -> FrameInput,
) -> Vec<Frame> {
    let mut eviction = Eviction::default();
    let mut found = Vec::new();
    for frame in 0..count {
        let given = input(world, frame);
        let census = world.census();
        if frame % COLD_EVERY == 0 {
            eviction.run();
        }
        let (report, taken) = timed(|| world.step(&given));
        found.push(Frame {
            cpu_ns: taken.cpu_ns as f64,
            census,
            spent: report.spent(),
        });
    }
    found
}

/// Frames of bodies in free air: driven ones follow their trackers.
fn free_frames(kind: BodyKind, bodies: u32, pieces: u32, count: u32) -> Vec<Frame> {
    let capacities = Trial::Loose64.capacities();
    let mut block = Block::new(&capacities);
    let mut world = World::create(block.bytes(), &capacities).expect("the block fits");
    world.set_gravity([0.0; 3]);
    let mut ids = Vec::new();
    for index in 0..bodies {
        let at = Pose::at(3.0 * index as f32, 0.0, 0.0);
        let body = world
            .add_body(&BodyDef::new(kind, at))
            .expect("there is room");
        for piece in 0..pieces {
            let def = PieceDef {
                local: Pose::at(0.0, 0.02 * piece as f32, 0.0),
                ..PieceDef::new(Shape::Point, 0.005)
            };
            world.add_piece(body, &def).expect("there is room");
        }
        ids.push(body);
    }
    frames_of(&mut world, count, |world, frame| {
        if kind == BodyKind::Driven {
            for (index, &body) in (0..).zip(&ids) {
                let to = Pose::at(3.0 * index as f32, 0.001 * (frame % 100) as f32, 0.0);
                let _ = world.set_target(body, &to);
            }
        }
        FrameInput::unlimited(1.0 / RATE_HZ)
    })
}

fn worst_ns(frames: &[Frame]) -> f64 {
    nearly_worst(frames.iter().map(|frame| frame.cpu_ns).collect(), 1000)
}

/// Frames of a trial with budgets of all sizes.
fn trial_frames(kit: &Kit, trial: Trial, count: u32) -> Result<Vec<Frame>, SceneError> {
    let capacities = trial.capacities();
    let mut block = Block::new(&capacities);
    let mut world =
        World::create(block.bytes(), &capacities).map_err(|e| SceneError(format!("{e:?}")))?;
    let mut set = Set::new(&mut world);
    kit.fill(trial, &mut set)?;
    let cast = set.cast;
    let mut failed = None;
    let frames = frames_of(&mut world, count, |world, frame| {
        if let Err(why) = kit.tell(trial, world, &cast, frame) {
            failed.get_or_insert(why);
        }
        let units = [u32::MAX, 400, 200, 100, 50, 25, 12][(frame / 7 % 7) as usize];
        FrameInput {
            budget: Budget {
                advance_units: units,
                impulse_units: units,
                reach_steps: units,
            },
            ..FrameInput::unlimited(1.0 / RATE_HZ)
        }
    });
    failed.map_or(Ok(frames), Err)
}

/// The price of one stage's unit: what nearly all frames with many of them cost no more than, when the
/// floor and the means of the other stages are taken off.
fn unit_price(
    frames: &[Frame],
    known: &CostTable,
    units: impl Fn(&Budget) -> u32,
    others: impl Fn(&Budget) -> f64,
) -> (f64, f64) {
    let ratios: Vec<f64> = frames
        .iter()
        .filter(|frame| units(&frame.spent) >= 12)
        .map(|frame| {
            // The floor's prices are worst cases: half of them is nearer to what it was.
            let floor = 0.5 * known.floor_ns(&frame.census) as f64;
            let rest = frame.cpu_ns - floor - others(&frame.spent);
            rest.max(0.0) / f64::from(units(&frame.spent))
        })
        .collect();
    if ratios.is_empty() {
        return (0.0, 0.0);
    }
    (mean(&ratios), nearly_worst(ratios, 1000))
}

/// Measures this machine with so many frames of each trial; `tick` is called after each part.
///
/// # Errors
/// [`SceneError`] when a trial could not be set.
pub fn calibrate(kit: &Kit, count: u32, mut tick: impl FnMut()) -> Result<Calibration, SceneError> {
    let mut costs = CostTable::default();
    let frame_ns = worst_ns(&free_frames(BodyKind::Fixed, 0, 0, count));
    tick();
    // One driven body of many pieces: its boxes against its own world.
    let one = free_frames(BodyKind::Driven, 1, 96, count);
    let boxes = one[0].census.box_tests() as f64 / f64::from(BOXES_PER_UNIT);
    let many = free_frames(BodyKind::Driven, 48, 1, count);
    tick();
    let body_ns = (worst_ns(&many) - frame_ns) / 48.0;
    let piece_ns = (worst_ns(&one) - frame_ns - body_ns) / 96.0;
    let boxes_ns = (worst_ns(&one) - frame_ns - body_ns) / boxes;
    let raised = |ns: f64, by: f64| (ns.max(1.0) * by).ceil() as u32;
    costs.frame_ns = raised(frame_ns, 1.0);
    costs.body_ns = raised(body_ns, 1.0);
    costs.piece_ns = raised(piece_ns, 0.5);
    costs.boxes_ns = raised(boxes_ns, 0.5);
    let all: Vec<Vec<Frame>> = Trial::ALL
        .iter()
        .map(|&trial| {
            let frames = trial_frames(kit, trial, count);
            tick();
            frames
        })
        .collect::<Result<_, _>>()?;
    let of = |trial: Trial| {
        let index = Trial::ALL.iter().position(|&t| t == trial);
        &all[index.unwrap_or_default()]
    };
    let driven = [of(Trial::Teleports).as_slice(), of(Trial::FullPools)].concat();
    let advance = |b: &Budget| b.advance_units;
    let impulse = |b: &Budget| b.impulse_units;
    let (push_mean, push) = unit_price(of(Trial::Loose64), &costs, impulse, |_| 0.0);
    let (query_mean, query) = unit_price(&driven, &costs, advance, |b| {
        push_mean * f64::from(b.impulse_units)
    });
    let chained = [of(Trial::AllChains).as_slice(), of(Trial::AvatarInRoom)].concat();
    costs.chain_ns = raised(chain_price(&chained, &costs, query_mean), 1.0);
    let (_, step) = unit_price(
        &chained,
        &costs,
        |b| b.reach_steps,
        |b| query_mean * f64::from(b.advance_units),
    );
    costs.advance_unit_ns = raised(query, 1.0);
    costs.impulse_unit_ns = raised(push, 1.0);
    costs.reach_step_ns = raised(step, 1.0);
    let ratio = |frame: &Frame| frame.cpu_ns / costs.worst_ns(&frame.census, &frame.spent) as f64;
    let ratios: Vec<f64> = all.iter().flatten().map(ratio).collect();
    let frames = ratios.len();
    let over = nearly_worst(ratios, 10_000).max(0.5);
    let price = |ns: u32| raised(f64::from(ns), over * MARGIN);
    Ok(Calibration {
        prices: Prices {
            frame_ns: price(costs.frame_ns),
            body_ns: price(costs.body_ns),
            piece_ns: price(costs.piece_ns),
            chain_ns: price(costs.chain_ns),
            boxes_ns: price(costs.boxes_ns),
            advance_unit_ns: price(costs.advance_unit_ns),
            impulse_unit_ns: price(costs.impulse_unit_ns),
            reach_step_ns: price(costs.reach_step_ns),
        },
        raised: over * MARGIN,
        frames,
    })
}

/// What a chain costs in frames that spend nothing on it.
fn chain_price(frames: &[Frame], known: &CostTable, query_ns: f64) -> f64 {
    let each: Vec<f64> = frames
        .iter()
        .filter(|frame| frame.spent.reach_steps == 0)
        .map(|frame| {
            let units = query_ns * f64::from(frame.spent.advance_units);
            let floor = 0.5 * known.floor_ns(&frame.census) as f64;
            (frame.cpu_ns - floor - units).max(0.0) / f64::from(frame.census.chains)
        })
        .collect();
    if each.is_empty() {
        return 0.0;
    }
    nearly_worst(each, 1000)
}
