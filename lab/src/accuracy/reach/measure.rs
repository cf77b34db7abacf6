//! All methods on all cases: solved or not, how far from the optimum, limits, time.

use std::hint::black_box;
use std::time::Instant;

use palpable::geometry::chain::posture;
use palpable::reach::cyclic_descent::cyclic_descent;
use palpable::reach::goal::{Reached, Task, worst_m};
use palpable::reach::least_deviation::{least_deviation, least_deviation_following};
use serde::Serialize;

use super::cases::{Case, Class, TOLERANCE_M, case, random};
use super::chains::{Chain, Model};
use super::optimum::Problem;
use super::peer::Peer;
use crate::accuracy::summary::Spread;

/// The iteration counts that are tried.
pub const STEPS: [u32; 7] = [1, 2, 4, 8, 16, 32, 64];

/// Random postures that the optimum is looked for from, beside the tracked one.
const STARTS: u32 = 5;

/// A solver.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// The paper's, in the kernel.
    CyclicDescent,
    /// The kernel's own.
    LeastDeviation,
    /// The same as the chains of a world use it from frame to frame.
    Following,
    /// The `k` crate's, in f64.
    Jacobian,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 4] = [
        Self::CyclicDescent,
        Self::LeastDeviation,
        Self::Following,
        Self::Jacobian,
    ];

    /// The name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::CyclicDescent => "cyclic descent",
            Self::LeastDeviation => "least deviation",
            Self::Following => "least deviation in frames",
            Self::Jacobian => "k, Jacobian, f64",
        }
    }

    /// The kernel's function; none for the peer.
    pub fn kernel(self) -> Option<Solver> {
        match self {
            Self::CyclicDescent => Some(cyclic_descent),
            Self::LeastDeviation => Some(least_deviation),
            Self::Following => Some(least_deviation_following),
            Self::Jacobian => None,
        }
    }
}

/// A solver of the kernel.
pub type Solver = fn(&Task, &mut [f32], u32) -> Reached;

/// A case that is judged: what f64 says of it.
pub struct Judged {
    /// The case.
    pub case: Case,
    /// The least change that meets the goals in radians, or the least distance in metres of a case
    /// out of reach.
    pub least: f64,
}

/// The first `wanted` cases of a class that f64 finds possible, or impossible out of reach.
pub fn judged(chain: &Chain, class: Class, seed: u64, wanted: u32) -> Vec<Judged> {
    let mut found = vec![];
    for index in 0..8 * wanted {
        if found.len() as u32 == wanted {
            break;
        }
        let case = case(chain, class, seed, index);
        let problem = Problem::new(chain, &case);
        let random = &mut random(seed, 99, index);
        let least = if class == Class::Beyond {
            Some(problem.closest_m(random, STARTS)).filter(|&m| m > 2.0 * f64::from(TOLERANCE_M))
        } else {
            let least = problem.least(random, STARTS);
            least.map(|q| problem.change(&q))
        };
        if let Some(least) = least {
            found.push(Judged { case, least });
        }
    }
    found
}

/// What one call gave.
#[derive(Clone, Debug)]
pub struct Answer {
    /// The angles it ended with.
    pub angles: Vec<f64>,
    /// Whether all goals are met to 1 mm, by the kernel's forward kinematics.
    pub is_solved: bool,
    /// Steps it says it used.
    pub steps: u32,
    /// Time of the call.
    pub time_ns: f64,
}

/// One call from the tracked angles.
pub fn solve(chain: &Chain, case: &Case, method: Method, steps: u32, timed: bool) -> Answer {
    match method.kernel() {
        Some(solve) => {
            let task = case.task(chain);
            let mut angles = case.wanted.clone();
            let reached = solve(&task, &mut angles, steps);
            let time_ns = time(timed, || {
                let mut angles = case.wanted.clone();
                let start = Instant::now();
                for _ in 0..REPEATS {
                    angles.copy_from_slice(&case.wanted);
                    black_box(solve(black_box(&task), black_box(&mut angles), steps));
                }
                start.elapsed()
            });
            answer(
                chain,
                case,
                angles.iter().map(|&q| q.into()).collect(),
                reached.steps,
                time_ns,
            )
        }
        None => {
            let peer = Peer::new(chain, case);
            peer.solve(steps);
            let angles = peer.angles();
            let time_ns = time(timed, || {
                let start = Instant::now();
                for _ in 0..REPEATS {
                    black_box(peer.solve(black_box(steps)));
                }
                start.elapsed()
            });
            answer(chain, case, angles, steps, time_ns)
        }
    }
}

/// Calls between two looks at the clock.
const REPEATS: u32 = 4;

fn time(timed: bool, mut run: impl FnMut() -> std::time::Duration) -> f64 {
    if !timed {
        return 0.0;
    }
    let runs = (0..2).map(|_| run().as_secs_f64() * 1e9 / f64::from(REPEATS));
    runs.fold(f64::INFINITY, f64::min)
}

fn answer(chain: &Chain, case: &Case, angles: Vec<f64>, steps: u32, time_ns: f64) -> Answer {
    let rounded: Vec<f32> = angles.iter().map(|&q| q as f32).collect();
    let placed = posture(&chain.hinges, &chain.root, &rounded);
    Answer {
        is_solved: worst_m(&case.goals, &placed) <= TOLERANCE_M * 1.0001,
        angles,
        steps,
        time_ns,
    }
}

/// How far angles are outside their limits, cones included, in radians.
pub fn violation_rad(chain: &Chain, angles: &[f64]) -> f64 {
    let hinges = chain.hinges.iter().zip(angles).map(|(hinge, &q)| {
        let (low, high) = (f64::from(hinge.low_rad), f64::from(hinge.high_rad));
        (low - q).max(q - high).max(0.0)
    });
    let rounded: Vec<f32> = angles.iter().map(|&q| q as f32).collect();
    let balls = chain
        .balls
        .iter()
        .map(|ball| f64::from(ball.outside_rad(&rounded)));
    hinges.chain(balls).fold(0.0, f64::max)
}

/// One method on one class of one model.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// The chain.
    pub model: Model,
    /// The class.
    pub class: Class,
    /// The method.
    pub method: Method,
    /// How many cases were tried.
    pub cases: usize,
    /// Share of the cases solved to 1 mm after [`STEPS`] iterations; nothing out of reach.
    pub solved: [f64; STEPS.len()],
    /// Median time of a call with so many iterations, in nanoseconds.
    pub time_ns: [f64; STEPS.len()],
    /// Time of a step, in nanoseconds: of all calls with most iterations by the steps they used.
    pub step_ns: f64,
    /// Length of the change over that of the optimum, of those solved after 64 iterations.
    pub ratio: Option<Spread>,
    /// Out of reach: distance beyond the least one, in metres.
    pub excess_m: Option<Spread>,
    /// The most that a limit or a cone was left by, in radians.
    pub violation_rad: f64,
}

/// All methods on judged cases.
pub fn rows(model: Model, class: Class, judged: &[Judged], timed: bool) -> Vec<Row> {
    let chain = model.chain();
    let row = |method| row(&chain, model, class, judged, method, timed);
    Method::ALL.map(row).into()
}

fn row(
    chain: &Chain,
    model: Model,
    class: Class,
    judged: &[Judged],
    method: Method,
    timed: bool,
) -> Row {
    let mut violation = 0.0_f64;
    let (mut solved, mut times) = ([0.0; STEPS.len()], [0.0; STEPS.len()]);
    let (mut ratios, mut excess) = (vec![], vec![]);
    let mut step_ns = 0.0;
    for (place, steps) in STEPS.into_iter().enumerate() {
        let answers: Vec<Answer> = judged
            .iter()
            .map(|judged| solve(chain, &judged.case, method, steps, timed))
            .collect();
        let count = answers.iter().filter(|answer| answer.is_solved).count();
        solved[place] = count as f64 / judged.len().max(1) as f64;
        let spread = Spread::of(answers.iter().map(|answer| answer.time_ns));
        times[place] = spread.map_or(0.0, |spread| spread.median);
        for answer in &answers {
            violation = violation.max(violation_rad(chain, &answer.angles));
        }
        let used: u32 = answers.iter().map(|answer| answer.steps).sum();
        let time: f64 = answers.iter().map(|answer| answer.time_ns).sum();
        step_ns = time / f64::from(used.max(1));
        if steps == STEPS[STEPS.len() - 1] {
            for (answer, judged) in answers.iter().zip(judged) {
                let problem = Problem::new(chain, &judged.case);
                if class == Class::Beyond {
                    excess.push(problem.distance_m(&answer.angles) - judged.least);
                } else if answer.is_solved {
                    ratios.push(problem.change(&answer.angles) / judged.least);
                }
            }
        }
    }
    Row {
        model,
        class,
        method,
        cases: judged.len(),
        solved,
        time_ns: times,
        step_ns,
        ratio: Spread::of(ratios.into_iter()),
        excess_m: Spread::of(excess.into_iter()),
        violation_rad: violation,
    }
}
