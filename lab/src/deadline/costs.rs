//! What work costs on this machine: a cost table fitted to measured frames.
//!
//! Frames of the trials at budgets of all sizes, and of bodies in free air, half of them with cold caches,
//! say how long so many units took. The prices are fitted to them from above: least squares in which a
//! frame that costs more than its price weighs as much as thirty that cost less (the expectiles of Newey
//! and Powell 1987), none below zero; then all are raised by what the worst frames cost more, and a margin.
//! The result is a measured worst case, not a guarantee. What the machine takes from frames beside is measured on its
//! own, for the clock behind the prices.

use std::time::Duration;

use glam::Vec3;
use palpable::frame::{Budget, Census, CostTable, FrameInput};
use palpable::geometry::chain::{Hinge, JointDef};
use palpable::limits::BOXES_PER_UNIT;
use palpable::math::Pose;
use palpable::state::bodies::BodyKind;
use palpable::state::chains::ChainOptions;
use palpable::world::{BodyDef, ChainDef, PieceDef, Shape, World};
use serde::{Deserialize, Serialize};

use super::pauses;
use super::stopwatch::{Eviction, timed};
use super::trials::{Kit, RATE_HZ, Trial};
use crate::hand_scene::SceneError;
use crate::memory::Block;

/// What is added to what was measured.
const MARGIN: f64 = 1.4;

/// One in so many frames may cost more than the prices before the margin: the clock behind them takes care
/// of what the machine does beside.
const LEFT_OUT: usize = 200;

/// Every so many frames the caches are emptied.
const COLD_EVERY: u32 = 2;

/// A cost table as it is written to a file, and what is to be kept from the clock behind it.
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
    /// How long before a deadline the clock behind the prices is to be over, see [`pauses::margin_ns`].
    pub pauses_ns: u32,
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

/// For each frame of a trial pauses are looked for as long as this.
const WATCHED_FOR_EACH: Duration = Duration::from_micros(2500);

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

/// Numbers of a cost table.
const PRICES: usize = 8;

impl Frame {
    /// How many of each thing the frame pays for.
    fn counts(&self) -> [f64; PRICES] {
        let boxes = self.census.box_tests().div_ceil(u64::from(BOXES_PER_UNIT));
        let [bodies, pieces, chains] =
            [self.census.bodies, self.census.pieces, self.census.chains].map(f64::from);
        [
            1.0,
            bodies,
            pieces,
            chains,
            boxes as f64,
            f64::from(self.spent.advance_units),
            f64::from(self.spent.impulse_units),
            f64::from(self.spent.reach_steps),
        ]
    }
}

fn priced(prices: &[f64; PRICES], counts: &[f64; PRICES]) -> f64 {
    prices.iter().zip(counts).map(|(p, n)| p * n).sum()
}

/// How much more a frame weighs that costs more than its price.
const UNDERPRICED_WEIGHT: f64 = 30.0;

/// Frames shorter than this are taken for as long, in nanoseconds: their errors are not to matter more.
const SHORT_NS: f64 = 10_000.0;

/// Frames longer than this say nothing about deadlines, in nanoseconds.
const LONG_NS: f64 = 2e6;

/// Prices that fit the frames from above.
fn fit(frames: &[Frame]) -> [f64; PRICES] {
    let rows: Vec<([f64; PRICES], f64, f64)> = frames
        .iter()
        .filter(|frame| frame.cpu_ns < LONG_NS)
        .map(|frame| {
            let scale = frame.cpu_ns.max(SHORT_NS).powi(-2);
            (frame.counts(), frame.cpu_ns, scale)
        })
        .collect();
    let mut prices = [100.0; PRICES];
    for _ in 0..60 {
        let mut products = [[0.0; PRICES]; PRICES];
        let mut sums = [0.0; PRICES];
        for (counts, ns, scale) in &rows {
            let under = priced(&prices, counts) < *ns;
            let weight = scale * if under { UNDERPRICED_WEIGHT } else { 1.0 };
            for i in 0..PRICES {
                sums[i] += weight * counts[i] * ns;
                for j in 0..PRICES {
                    products[i][j] += weight * counts[i] * counts[j];
                }
            }
        }
        descend(&products, &sums, &mut prices);
    }
    prices
}

/// The least of a quadratic form over prices that are not negative, one coordinate after the other.
fn descend(products: &[[f64; PRICES]; PRICES], sums: &[f64; PRICES], prices: &mut [f64; PRICES]) {
    for _ in 0..400 {
        for i in 0..PRICES {
            if products[i][i] > 0.0 {
                let others: f64 = (0..PRICES)
                    .filter(|&j| j != i)
                    .map(|j| products[i][j] * prices[j])
                    .sum();
                prices[i] = ((sums[i] - others) / products[i][i]).max(0.0);
            }
        }
    }
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

/// Frames of arms in free air, all of whose joints move, so that none is like the one before.
fn arm_frames(arms: u32, count: u32) -> Vec<Frame> {
    let capacities = Trial::AllChains.capacities();
    let mut block = Block::new(&capacities);
    let mut world = World::create(block.bytes(), &capacities).expect("the block fits");
    let body = world
        .add_body(&BodyDef::new(BodyKind::Driven, Pose::IDENTITY))
        .expect("there is room");
    let joints = [
        Vec3::X,
        Vec3::Z,
        Vec3::Y,
        Vec3::X,
        Vec3::Y,
        Vec3::X,
        Vec3::Z,
    ]
    .map(|axis| {
        JointDef::Hinge(Hinge {
            rest: Pose::at(0.0, -0.1, 0.0),
            axis,
            low_rad: -1.0,
            high_rad: 1.0,
        })
    });
    let mut chains = Vec::new();
    for arm in 0..arms {
        let [JointDef::Hinge(mut first), others @ ..] = joints else {
            unreachable!("hinges were made above")
        };
        first.rest = Pose::at(arm as f32, 0.0, 0.0);
        let joints: Vec<JointDef> = std::iter::once(JointDef::Hinge(first))
            .chain(others)
            .collect();
        let def = ChainDef {
            joints: &joints,
            base: None,
            options: ChainOptions::DEFAULT,
        };
        let chain = world.add_chain(body, &def).expect("there is room");
        for link in [2, 4, 6] {
            let def = PieceDef::new(Shape::Segment([0.0; 3], [0.0, -0.1, 0.0]), 0.03);
            world
                .add_link_piece(chain, link, &def)
                .expect("there is room");
        }
        chains.push(chain);
    }
    frames_of(&mut world, count, |world, frame| {
        let angles = [0.01 * (frame % 100) as f32; 7];
        for &chain in &chains {
            let _ = world.set_angles(chain, &angles);
        }
        FrameInput::unlimited(1.0 / RATE_HZ)
    })
}

/// Frames of a trial with budgets of all sizes.
fn trial_frames(kit: &Kit, trial: Trial, count: u32) -> Result<Vec<Frame>, SceneError> {
    kit.stage(trial, |world, cast, _| {
        let mut failed = None;
        let frames = frames_of(world, count, |world, frame| {
            if let Err(why) = kit.tell(trial, world, cast, frame) {
                failed.get_or_insert(why);
            }
            let units = [u32::MAX, 400, 200, 100, 50, 25, 12, 0][(frame / 7 % 8) as usize];
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
    })
}

/// Measures this machine with so many frames of each trial; `tick` is called after each part.
///
/// # Errors
/// [`SceneError`] when a trial could not be set.
pub fn calibrate(kit: &Kit, count: u32, mut tick: impl FnMut()) -> Result<Calibration, SceneError> {
    let mut frames = Vec::new();
    for (kind, bodies, pieces) in [
        (BodyKind::Fixed, 0, 0),
        (BodyKind::Driven, 1, 96),
        (BodyKind::Driven, 48, 1),
        (BodyKind::Fixed, 90, 2),
    ] {
        frames.extend(free_frames(kind, bodies, pieces, count / 4));
    }
    for arms in [1, 4, 8] {
        frames.extend(arm_frames(arms, count / 4));
    }
    tick();
    for trial in Trial::ALL {
        frames.extend(trial_frames(kit, trial, count)?);
        tick();
    }
    let pauses_ns = pauses::margin_ns(WATCHED_FOR_EACH * count);
    tick();
    let prices = fit(&frames);
    let over = |frame: &Frame| frame.cpu_ns / priced(&prices, &frame.counts()).max(1.0);
    let tight = frames.iter().filter(|frame| frame.cpu_ns < LONG_NS);
    let raised = nearly_worst(tight.map(over).collect(), LEFT_OUT).max(1.0) * MARGIN;
    let ns = prices.map(|price| (price * raised).ceil() as u32);
    Ok(Calibration {
        prices: Prices {
            frame_ns: ns[0],
            body_ns: ns[1],
            piece_ns: ns[2],
            chain_ns: ns[3],
            boxes_ns: ns[4],
            advance_unit_ns: ns[5],
            impulse_unit_ns: ns[6],
            reach_step_ns: ns[7],
            pauses_ns,
        },
        raised,
        frames: frames.len(),
    })
}
