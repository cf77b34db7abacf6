//! The numbers of a report, as they stand in `report.json`.

use serde::{Deserialize, Serialize};

use super::{ArmSlaps, FigureScene};

/// Deepest overlap of the hand with fixed bodies that the kernel promises, in millimetres.
pub const HAND_FIXED_OVERLAP_MM_MAX: f64 = 0.1;

/// Deepest overlap of the ball with anything that the kernel promises, in millimetres.
pub const BALL_OVERLAP_MM_MAX: f64 = 1.0;

/// Whether a measured value breaks its promised limit; one that is not a number does.
pub(super) fn is_beyond(value: f64, limit: f64) -> bool {
    value.is_nan() || value > limit
}

/// One call of the lab: where it ran, which hand it used, and its runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// Heading of the table and the page.
    pub title: String,
    /// What the figures were measured on.
    pub machine: Machine,
    /// How well the hand's parts stand in for its mesh.
    pub hand: HandCoverage,
    /// One entry per ball and noise setting, in the order they were run.
    pub runs: Vec<Run>,
    /// Slaps through a wall, when they were run.
    pub slaps: Option<Slaps>,
    /// Figures with joints, scene by scene, in the order they were played.
    pub figures: Vec<FigureScene>,
    /// Slaps of the avatar's arm, when they were played.
    pub arm_slaps: Option<ArmSlaps>,
}

/// The measuring machine, without anything that tells one owner's from another's.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    /// Processor model, or `unknown`.
    pub cpu: String,
    /// Operating system and architecture.
    pub os: String,
    /// Compiler version, if known.
    pub rustc: Option<String>,
}

/// How the convex parts of the hand compare with the mesh they were cut from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HandCoverage {
    /// Number of convex parts.
    pub parts: u32,
    /// Share of the mesh's surface that lies outside every part, 0 to 1.
    pub uncovered_share: f64,
    /// Largest distance from the mesh's surface to the nearest part, in millimetres.
    pub uncovered_mm_max: f64,
    /// Largest distance by which a part sticks out of the mesh, in millimetres.
    pub sticking_out_mm_max: f64,
    /// Mean distance by which the parts stick out of the mesh, in millimetres.
    pub sticking_out_mm_mean: f64,
}

/// The shape that stands for the ball.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Ball {
    /// One point with a radius.
    Sphere,
    /// The convex hull of the paper's ball of 960 triangles.
    Hull,
}

/// One pass over the scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Name shown to people, such as `ball as sphere, no noise`.
    pub name: String,
    /// Shape of the ball.
    pub ball: Ball,
    /// Whether noise was added to the tracker's poses.
    pub noise: bool,
    /// Number of frames.
    pub frames: u32,
    /// Hash of the world's state after the last frame, in hexadecimal.
    pub state_hash: String,
    /// Parts of the hand, and the ball, that were outside the building in some frame.
    pub beyond_walls: u32,
    /// The phases of the motion, in order of their first frames.
    pub phases: Vec<Phase>,
    /// One entry per frame, in order.
    pub samples: Vec<FrameSample>,
}

/// Summary of consecutive frames in which the tracker does one thing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Phase {
    /// What the tracker does, such as `slide there`.
    pub name: String,
    /// Number of the phase's first frame.
    pub first_frame: u32,
    /// Number of frames.
    pub frames: u32,
    /// Frame time, in microseconds of the thread's CPU time.
    pub frame_time_us: Quantiles,
    /// Deepest overlap of the hand with a fixed body, in millimetres.
    pub overlap_hand_fixed_mm_max: f64,
    /// Deepest overlap of the ball with a fixed body, in millimetres.
    pub overlap_ball_fixed_mm_max: f64,
    /// Deepest overlap of the hand with the ball, in millimetres.
    pub overlap_hand_ball_mm_max: f64,
    /// Largest distance from the tracker's target to the published pose in frames without contact,
    /// in millimetres; `None` if every frame had contact.
    pub free_lag_mm_max: Option<f64>,
    /// Largest movement of the published pose from frame to frame while the tracker is held still
    /// in contact, in millimetres; `None` if it never is.
    pub jitter_mm_max: Option<f64>,
    /// Most contacts in one frame.
    pub contacts_max: u32,
    /// Mean number of contacts per frame.
    pub contacts_mean: f64,
    /// Impulses over the whole phase.
    pub impulses_total: u64,
    /// Units of work over the whole phase.
    pub units_total: u64,
    /// Most units of work in one frame.
    pub units_max: u64,
}

/// What one frame cost and left.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FrameSample {
    /// Frame number.
    pub frame: u32,
    /// Frame time, in microseconds of the thread's CPU time.
    pub time_us: f64,
    /// Number of contacts.
    pub contacts: u32,
    /// Number of impulses.
    pub impulses: u32,
    /// Units of work.
    pub units: u64,
    /// Deepest overlap of anything with anything, in millimetres.
    pub overlap_mm: f64,
}

/// Order statistics of a list of measurements, in the list's unit.
///
/// By nearest rank: the quantile q of n values is the one at rank ceil(q n), counted from 1 in
/// ascending order. It is always a value that was measured, never an interpolation; with fewer than
/// 1000 values `p999` equals `max`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quantiles {
    /// At least half of the values are at most this.
    pub median: f64,
    /// At least 99 % of the values are at most this.
    pub p99: f64,
    /// At least 99.9 % of the values are at most this.
    pub p999: f64,
    /// The largest value.
    pub max: f64,
}

impl Quantiles {
    /// Sorts `samples` and reads the quantiles off; `None` if there are no samples.
    ///
    /// The order is [`f64::total_cmp`], so a NaN counts as the largest value and shows up in `max`.
    pub fn from_samples(samples: &mut [f64]) -> Option<Self> {
        samples.sort_unstable_by(f64::total_cmp);
        Some(Self {
            median: nearest_rank(samples, 500)?,
            p99: nearest_rank(samples, 990)?,
            p999: nearest_rank(samples, 999)?,
            max: *samples.last()?,
        })
    }
}

/// Integers keep the rank exact: in f64, 0.99 times 100 is not 99.
fn nearest_rank(sorted: &[f64], per_mille: usize) -> Option<f64> {
    let rank = (sorted.len() * per_mille).div_ceil(1000);
    sorted.get(rank.checked_sub(1)?).copied()
}

impl Report {
    /// File-name-safe names of the runs, in their order and all different: lower-case ASCII
    /// letters, digits and `-`.
    pub fn slugs(&self) -> Vec<String> {
        different(self.runs.iter().map(|run| slug(&run.name)))
    }

    /// The same for the figures' scenes.
    pub fn figure_slugs(&self) -> Vec<String> {
        different(self.figures.iter().map(FigureScene::slug))
    }
}

fn different(names: impl Iterator<Item = String>) -> Vec<String> {
    let mut slugs: Vec<String> = Vec::new();
    for base in names {
        let unused = (1..)
            .map(|n| numbered(&base, n))
            .find(|candidate| !slugs.contains(candidate));
        slugs.extend(unused);
    }
    slugs
}

pub(super) fn slug(name: &str) -> String {
    let words: Vec<String> = name
        .split(|c: char| !c.is_ascii_alphanumeric())
        .filter(|word| !word.is_empty())
        .map(str::to_ascii_lowercase)
        .collect();
    if words.is_empty() {
        "run".to_owned()
    } else {
        words.join("-")
    }
}

fn numbered(base: &str, n: u32) -> String {
    if n == 1 {
        base.to_owned()
    } else {
        format!("{base}-{n}")
    }
}

/// What slaps through a wall of 20 mm showed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Slaps {
    /// How many slaps.
    pub slaps: u32,
    /// Parts of the hand with a corner behind the wall in some frame, over all slaps.
    pub parts_behind: u32,
    /// Deepest overlap of the hand and the wall, in millimetres.
    pub overlap_mm_max: f64,
}
