//! Scores and times of all methods over all classes.

use std::hint::black_box;
use std::time::Instant;

use palpable::geometry::hull::HullBuilder;
use palpable::math::Pose;
use serde::Serialize;

use super::generate::{Class, Kind, Pair, pair, solids};
use super::methods::{Answer, Method, Ready, exact};
use crate::reference::{Placed, Signed, Solid, signed_distance};

/// Depths and gaps below this, relative to size, have no sign that must be right.
pub const TOUCHING: f64 = 1e-4;
/// A depth may be off by this, relative to itself, before it counts as a failure.
const OFF_SHARE_MAX: f64 = 0.1;
/// And by this, relative to size.
const OFF_SIZE_MAX: f64 = 1e-5;

/// How a pair's time is taken: the least of so many batches of so many calls.
const BATCHES: usize = 7;
const CALLS: u32 = 6;

/// Why an answer is a failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Failure {
    /// The method panicked.
    Panicked,
    /// It had no answer, or refused the pieces.
    Missing,
    /// A number was infinite or not a number.
    NotFinite,
    /// Overlap was called a gap, or a gap overlap.
    WrongSign,
    /// The value was off by more than 10 % and 1e-5 of size.
    Off,
}

/// One method's answer for one pair, judged by the reference.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Score {
    /// The pair's number in its class.
    pub index: u32,
    /// What the generator wished for.
    pub kind: Kind,
    /// The reference's gap in metres; minus the depth if the pieces overlap.
    pub reference_m: f64,
    /// The smaller piece's bounding-box diagonal, in metres.
    pub size_m: f64,
    /// The larger piece's, in metres: f32 poses and coordinates are only exact relative to it.
    pub larger_m: f64,
    /// Error of the depth or distance, relative to size; missing without an answer.
    pub error: Option<f64>,
    /// What is left between the pieces after A is moved by the answer, relative to size.
    pub left: Option<f64>,
    /// Why this is a failure, if it is one.
    pub failure: Option<Failure>,
    /// Time of one call, in nanoseconds.
    pub time_ns: f64,
}

impl Score {
    /// Whether the pieces overlap by more than what counts as touching.
    pub fn overlaps(&self) -> bool {
        self.reference_m < -TOUCHING * self.size_m
    }

    /// Whether the pieces are apart by more than what counts as touching.
    pub fn is_apart(&self) -> bool {
        self.reference_m > TOUCHING * self.size_m
    }
}

/// All scores of one method in one class, in the order of the pairs that it was asked about.
#[derive(Clone, Debug, Serialize)]
pub struct Scores {
    /// The class.
    pub class: Class,
    /// The method.
    pub method: Method,
    /// One a pair; only overlapping pairs for a method that is for these.
    pub scores: Vec<Score>,
}

/// Scores of all methods in a class of `pairs` pairs. `timed` is whether times are taken; without
/// they are zero. `tick` is called after each pair.
pub fn class(
    class: Class,
    seed: u64,
    pairs: u32,
    timed: bool,
    mut tick: impl FnMut(),
) -> Vec<Scores> {
    let mut builder = Box::new(HullBuilder::new());
    let mut all = Method::ALL.map(|method| Scores {
        class,
        method,
        scores: Vec::new(),
    });
    for index in 0..pairs {
        let judged = judge(&pair(class, seed, index), &mut builder, timed);
        for (scores, score) in all.iter_mut().zip(judged) {
            scores.scores.extend(score);
        }
        tick();
    }
    all.into()
}

/// One score a method; none if the method is not for this pair.
fn judge(
    pair: &Pair,
    builder: &mut HullBuilder,
    timed: bool,
) -> [Option<Score>; Method::ALL.len()] {
    let ready = Ready::new(pair, builder);
    let solids = solids(&pair.shapes);
    let truths = pair.poses.map(|poses| Truth::new(&solids, &poses));
    let truth_of = |method: Method| &truths[usize::from(method.is_warm())];
    let asked = Method::ALL.map(|m| !m.needs_overlap() || truth_of(m).signed.value < 0.0);
    let answers = std::array::from_fn(|place| {
        let method = Method::ALL[place];
        asked[place].then(|| ready.ask_guarded(method)).flatten()
    });
    let times = if timed {
        times_ns(&ready, &answers)
    } else {
        [0.0; Method::ALL.len()]
    };
    std::array::from_fn(|place| {
        let truth = truth_of(Method::ALL[place]);
        asked[place].then(|| truth.score(pair, answers[place], times[place]))
    })
}

/// A pair in the reference.
struct Truth<'a> {
    placed: [Placed<'a>; 2],
    signed: Signed,
    size_m: f64,
    larger_m: f64,
}

impl<'a> Truth<'a> {
    fn new(solids: &'a [Solid; 2], poses: &[Pose; 2]) -> Self {
        let placed = [0, 1].map(|i| {
            let (rotation, position) = exact(&poses[i]);
            Placed::new(&solids[i], rotation, position)
        });
        Self {
            placed,
            signed: signed_distance(&placed[0], &placed[1]),
            size_m: solids[0].size().min(solids[1].size()),
            larger_m: solids[0].size().max(solids[1].size()),
        }
    }

    fn score(&self, pair: &Pair, answer: Option<Option<Answer>>, time_ns: f64) -> Score {
        let failure = match answer {
            None => Some(Failure::Panicked),
            Some(None) => Some(Failure::Missing),
            Some(Some(answer)) => self.failure(&answer),
        };
        let usable = answer.flatten().filter(is_finite);
        Score {
            index: pair.index,
            kind: pair.kind,
            reference_m: self.signed.value,
            size_m: self.size_m,
            larger_m: self.larger_m,
            error: usable.map(|answer| self.error(&answer)),
            left: usable.map(|answer| self.left(&answer)),
            failure,
            time_ns,
        }
    }

    fn failure(&self, answer: &Answer) -> Option<Failure> {
        if !is_finite(answer) {
            return Some(Failure::NotFinite);
        }
        let value = self.signed.value;
        let has_sign = value.abs() > TOUCHING * self.size_m;
        if has_sign && answer.gap_m * value <= 0.0 {
            return Some(Failure::WrongSign);
        }
        let off = (answer.gap_m - value).abs();
        let is_off = off > OFF_SHARE_MAX * value.abs() + OFF_SIZE_MAX * self.size_m;
        is_off.then_some(Failure::Off)
    }

    fn error(&self, answer: &Answer) -> f64 {
        (answer.gap_m - self.signed.value).abs() / self.size_m
    }

    fn left(&self, answer: &Answer) -> f64 {
        let moved = self.placed[0].moved(answer.normal * -answer.gap_m);
        signed_distance(&moved, &self.placed[1]).value.abs() / self.size_m
    }
}

fn is_finite(answer: &Answer) -> bool {
    answer.gap_m.is_finite() && answer.normal.is_finite()
}

/// The least time of a call per method; methods take turns so that the machine's moods hit all.
/// Methods that panicked or were not asked are not timed.
fn times_ns(
    ready: &Ready,
    answers: &[Option<Option<Answer>>; Method::ALL.len()],
) -> [f64; Method::ALL.len()] {
    let mut least = [f64::INFINITY; Method::ALL.len()];
    for _ in 0..BATCHES {
        for (place, method) in Method::ALL.into_iter().enumerate() {
            if answers[place].is_some() {
                least[place] = least[place].min(batch_ns(ready, method));
            }
        }
    }
    least.map(|time| if time.is_finite() { time } else { 0.0 })
}

fn batch_ns(ready: &Ready, method: Method) -> f64 {
    black_box(black_box(ready).ask(black_box(method)));
    let start = Instant::now();
    for _ in 0..CALLS {
        black_box(black_box(ready).ask(black_box(method)));
    }
    start.elapsed().as_secs_f64() * 1e9 / f64::from(CALLS)
}
