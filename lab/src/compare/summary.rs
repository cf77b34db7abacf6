//! What the comparison found, as it stands in `compare.json`.

use serde::Serialize;

use super::measures::Measure;
use crate::report::{Machine, Quantiles};

/// Names of the engines, in the order of every row.
pub const ENGINES: [&str; 3] = ["Palpable", "Rapier, soft", "Rapier, stiff"];

/// The whole comparison.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    /// What it was measured on.
    pub machine: Machine,
    /// Of the trackers and the slaps.
    pub seed: u64,
    /// Trackers a scene.
    pub trackers: usize,
    /// Slaps of each engine.
    pub slaps: [usize; ENGINES.len()],
    /// Scene by scene.
    pub rows: Vec<Row>,
    /// Scene by scene.
    pub times: Vec<TimeRow>,
    /// Of the first tracker: what the figures draw.
    #[serde(skip)]
    pub curves: Vec<Curve>,
}

/// A figure of a scene for every engine. Smaller is better.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The scene.
    pub scene: &'static str,
    /// What was measured.
    pub measure: &'static str,
    /// Its unit; empty for a count.
    pub unit: &'static str,
    /// The most that the kernel promises.
    pub promised: Option<f64>,
    /// One for each engine; `None` where it did not play.
    pub found: [Option<Found>; ENGINES.len()],
}

/// What an engine showed over all trackers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Found {
    /// Of the worst tracker; of a count the sum.
    pub worst: f64,
    /// Of the median tracker; of a count nothing.
    pub median: Option<f64>,
}

/// How a row came out for the kernel beside the better one of its peers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Standing {
    /// Smaller than both.
    Better,
    /// As small as the smaller one.
    Equal,
    /// Larger.
    Worse,
}

impl Found {
    /// From the values of the trackers.
    #[must_use]
    pub fn of(measure: &Measure, values: &[f64]) -> Self {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let median = sorted.get(sorted.len().saturating_sub(1) / 2).copied();
        if measure.is_count {
            let worst = values.iter().sum();
            return Self {
                worst,
                median: None,
            };
        }
        Self {
            worst: sorted.last().copied().unwrap_or(f64::NAN),
            median,
        }
    }
}

impl Row {
    /// Whether the kernel keeps what is promised; `None` when nothing is.
    #[must_use]
    pub fn is_kept(&self) -> Option<bool> {
        let (promised, found) = self.promised.zip(self.found[0])?;
        Some(found.worst <= promised)
    }

    /// The kernel beside the better one of its peers.
    #[must_use]
    pub fn standing(&self) -> Option<Standing> {
        let ours = self.found[0]?.worst;
        let theirs = self.found[1..].iter().flatten().map(|found| found.worst);
        let best = theirs.reduce(f64::min)?;
        Some(if ours < best {
            Standing::Better
        } else if ours <= best {
            Standing::Equal
        } else {
            Standing::Worse
        })
    }
}

/// Frame times of a scene, in microseconds of the thread's CPU time, over all trackers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TimeRow {
    /// The scene, or a stretch of it.
    pub scene: &'static str,
    /// The median that is promised.
    pub promised_us: Option<f64>,
    /// One for each engine; `None` where it did not play.
    pub found: [Option<Quantiles>; ENGINES.len()],
}

impl TimeRow {
    /// Whether the kernel keeps what is promised; `None` when nothing is.
    #[must_use]
    pub fn is_kept(&self) -> Option<bool> {
        let (promised, found) = self.promised_us.zip(self.found[0])?;
        Some(found.median <= promised)
    }
}

/// Frame by frame of one scene and one engine.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The scene.
    pub scene: &'static str,
    /// Index of the engine.
    pub engine: usize,
    /// Deepest overlap of a hand with anything, in millimetres.
    pub overlap_mm: Vec<f64>,
    /// How far the hand is from its tracker, in millimetres.
    pub displacement_mm: Vec<f64>,
}
