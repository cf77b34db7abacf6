//! What the scores come to: quantiles, counts and ratios.

use serde::Serialize;

use super::generate::Class;
use super::measure::{Score, Scores};
use super::methods::Method;

/// Median, 95th and 99th percentile, and maximum, by the nearest rank.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Spread {
    /// Half are at most this.
    pub median: f64,
    /// 95 % are at most this.
    pub p95: f64,
    /// 99 % are at most this.
    pub p99: f64,
    /// The largest.
    pub max: f64,
}

impl Spread {
    /// The spread of values; none if there are none. Values must not be NaN.
    pub fn of(values: impl Iterator<Item = f64>) -> Option<Self> {
        let mut sorted: Vec<f64> = values.collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let last = sorted.len().checked_sub(1)?;
        let at = |share: f64| sorted[(share * last as f64).round() as usize];
        Some(Self {
            median: at(0.5),
            p95: at(0.95),
            p99: at(0.99),
            max: sorted[last],
        })
    }
}

/// One method in one class.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// The class.
    pub class: Class,
    /// The method.
    pub method: Method,
    /// How many pairs the method was asked about.
    pub pairs: usize,
    /// Failures among them.
    pub failures: usize,
    /// Error of depth or distance relative to the smaller piece's size, of pairs with an answer.
    pub error: Option<Spread>,
    /// What moving by the answer leaves between the pieces, relative to size.
    pub left: Option<Spread>,
    /// Time of a call in nanoseconds, over all pairs that got an answer.
    pub time_ns: Option<Spread>,
    /// The same for overlapping pairs.
    pub overlapping_ns: Option<Spread>,
    /// The same for pairs apart.
    pub apart_ns: Option<Spread>,
}

impl Row {
    /// Sums the scores up.
    pub fn new(scores: &Scores) -> Self {
        let answered = || scores.scores.iter().filter(|score| score.error.is_some());
        let times = |wanted: &dyn Fn(&Score) -> bool| {
            Spread::of(answered().filter(|s| wanted(s)).map(|s| s.time_ns))
        };
        Self {
            class: scores.class,
            method: scores.method,
            pairs: scores.scores.len(),
            failures: scores.scores.iter().filter(|s| s.failure.is_some()).count(),
            error: Spread::of(answered().filter_map(|score| score.error)),
            left: Spread::of(answered().filter_map(|score| score.left)),
            time_ns: times(&|_| true),
            overlapping_ns: times(&Score::overlaps),
            apart_ns: times(&Score::is_apart),
        }
    }
}

/// How many times faster Palpable is than parry3d f32, by medians, and what was aimed at.
#[derive(Clone, Debug, Serialize)]
pub struct Ratios {
    /// The class.
    pub class: Class,
    /// All pairs, cold.
    pub cold: Option<f64>,
    /// Overlapping pairs, cold: what the target is for.
    pub cold_overlapping: Option<f64>,
    /// Pairs apart, cold.
    pub cold_apart: Option<f64>,
    /// All pairs, warm.
    pub warm: Option<f64>,
    /// Overlapping pairs, warm: what the target is for.
    pub warm_overlapping: Option<f64>,
    /// Targets: cold overlapping, cold apart, warm overlapping.
    pub targets: Option<[f64; 3]>,
}

impl Ratios {
    /// The ratios of a class from its rows.
    pub fn new(class: Class, rows: &[Row]) -> Self {
        let ratio = |ours, theirs, of: fn(&Row) -> Option<Spread>| {
            let median = |method| {
                let row = rows
                    .iter()
                    .find(|row| row.class == class && row.method == method)?;
                of(row).map(|spread| spread.median)
            };
            Some(median(theirs)? / median(ours)?)
        };
        let cold = |of| ratio(Method::Palpable, Method::ParryF32, of);
        let warm = |of| ratio(Method::PalpableWarm, Method::ParryF32Warm, of);
        Self {
            class,
            cold: cold(|row| row.time_ns),
            cold_overlapping: cold(|row| row.overlapping_ns),
            cold_apart: cold(|row| row.apart_ns),
            warm: warm(|row| row.time_ns),
            warm_overlapping: warm(|row| row.overlapping_ns),
            targets: targets(class),
        }
    }
}

/// A walk whose answer is deeper than the depth by this, relative to size, ended at a local minimum.
const LOCAL_MIN: f64 = 1e-6;

/// How often the local walk ends at the depth, and its time beside the others', on overlapping pairs.
#[derive(Clone, Debug, Serialize)]
pub struct Walks {
    /// The class.
    pub class: Class,
    /// The walk, cold or warm.
    pub method: Method,
    /// How many pairs overlap.
    pub pairs: usize,
    /// How many walks ended deeper than the depth, by more than rounding.
    pub local_minima: usize,
    /// How many of these are failures: off by more than a tenth.
    pub failures: usize,
    /// The largest factor by which a walk ended deeper, of pairs that do more than touch.
    pub worst_factor: Option<f64>,
    /// Median times in nanoseconds of the walk, Palpable, parry f32 and parry f64.
    pub times_ns: [Option<f64>; 4],
}

impl Walks {
    /// Cold and warm, from all scores and rows.
    pub fn all(scores: &[Scores], rows: &[Row]) -> Vec<Self> {
        let walks = scores.iter().filter(|scores| scores.method.needs_overlap());
        walks.map(|walk| Self::new(walk, rows)).collect()
    }

    fn new(walk: &Scores, rows: &[Row]) -> Self {
        let methods = if walk.method.is_warm() {
            [
                Method::PalpableWarm,
                Method::ParryF32Warm,
                Method::ParryF64Warm,
            ]
        } else {
            [Method::Palpable, Method::ParryF32, Method::ParryF64]
        };
        let [palpable, single, double] = methods;
        let median = |method| {
            let mut rows = rows.iter();
            let row = rows.find(|row| row.class == walk.class && row.method == method)?;
            row.overlapping_ns.map(|spread| spread.median)
        };
        let is_local = |score: &&Score| score.error.is_some_and(|error| error > LOCAL_MIN);
        let factor = |s: &Score| Some(1.0 + s.error? * s.size_m / s.reference_m.abs());
        let deep = walk.scores.iter().filter(|score| score.overlaps());
        Self {
            class: walk.class,
            method: walk.method,
            pairs: walk.scores.len(),
            local_minima: walk.scores.iter().filter(is_local).count(),
            failures: walk.scores.iter().filter(|s| s.failure.is_some()).count(),
            worst_factor: deep.filter_map(factor).max_by(f64::total_cmp),
            times_ns: [walk.method, palpable, single, double].map(median),
        }
    }
}

/// The aims: cold overlapping, cold apart, warm.
fn targets(class: Class) -> Option<[f64; 3]> {
    match class {
        Class::Box8 => Some([10.0, 3.0, 8.0]),
        Class::Hull32 => Some([2.5, 3.0, 8.0]),
        Class::Finger | Class::SlabFinger => Some([3.0, 3.0, 8.0]),
        _ => None,
    }
}

/// The aim for the error of depth and distance, relative to the smaller piece's size.
pub const ERROR_AIM: f64 = 2e-7;
/// The aim for what moving by the answer leaves, relative to the smaller piece's size.
pub const LEFT_AIM: f64 = 1e-6;

/// How many of the kernel's answers are less exact than aimed at, and the worst.
#[derive(Clone, Debug, Serialize)]
pub struct Beyond {
    /// The class.
    pub class: Class,
    /// Cold or warm.
    pub method: Method,
    /// How many pairs are beyond [`ERROR_AIM`].
    pub by_error: usize,
    /// How many pairs are beyond [`LEFT_AIM`].
    pub by_left: usize,
    /// The pair of the largest error: with class and seed it replays it.
    pub worst_index: u32,
    /// That error, relative to the smaller piece's size.
    pub worst_error: f64,
    /// That error, relative to the larger piece's size.
    pub worst_error_of_larger: f64,
    /// The pair of which moving by the answer leaves most.
    pub worst_left_index: u32,
    /// What it leaves, relative to the smaller piece's size.
    pub worst_left: f64,
}

impl Beyond {
    /// None if every answer is as exact as aimed at.
    pub fn new(scores: &Scores) -> Option<Self> {
        let by = |of: fn(&Score) -> Option<f64>| {
            let value = move |score: &Score| of(score).unwrap_or(0.0);
            let largest = |p: &&Score, q: &&Score| value(p).total_cmp(&value(q));
            scores.scores.iter().max_by(largest)
        };
        let count = |aim: f64, of: fn(&Score) -> Option<f64>| {
            let values = scores.scores.iter().filter_map(of);
            values.filter(|value| *value > aim).count()
        };
        let (worst, worst_left) = (by(|s| s.error)?, by(|s| s.left)?);
        let by_error = count(ERROR_AIM, |s| s.error);
        let by_left = count(LEFT_AIM, |s| s.left);
        let worst_error = worst.error.unwrap_or(0.0);
        (by_error + by_left > 0).then(|| Self {
            class: scores.class,
            method: scores.method,
            by_error,
            by_left,
            worst_index: worst.index,
            worst_error,
            worst_error_of_larger: worst_error * worst.size_m / worst.larger_m,
            worst_left_index: worst_left.index,
            worst_left: worst_left.left.unwrap_or(0.0),
        })
    }
}
