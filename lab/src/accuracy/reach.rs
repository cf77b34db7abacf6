//! How many goals the chains' solvers meet, how near to the optimum and how fast, beside the `k`
//! crate's solver and against an optimum in f64 that shares nothing with them.
//!
//! Everything but the times is a pure function of the seed.

pub mod cases;
pub mod chains;
mod figure;
pub mod measure;
pub mod motion;
pub mod optimum;
pub mod peer;
mod table;

use std::io;
use std::path::Path;

use serde::Serialize;

use crate::report::Machine;
use cases::Class;
use chains::Model;
use measure::{Row, judged, rows};
use motion::{Avatars, Drift};

pub use figure::{solved_by_steps_svg, solved_by_time_svg};
pub use table::tables;

/// What to measure.
#[derive(Clone, Copy, Debug)]
pub struct ReachPlan {
    /// Seed of all cases.
    pub seed: u64,
    /// Cases in each class; pushes of the arm are ten times as many.
    pub cases: u32,
    /// Loops that are drawn.
    pub loops: u32,
    /// Whether times are taken.
    pub timed: bool,
}

impl ReachPlan {
    /// How often `tick` is called.
    pub fn ticks(&self) -> u64 {
        (Model::ALL.len() * Class::ALL.len() + 2) as u64
    }

    fn cases_of(&self, model: Model, class: Class) -> u32 {
        if model == Model::Arm && class == Class::Push {
            10 * self.cases
        } else {
            self.cases
        }
    }
}

/// Everything that was measured.
#[derive(Clone, Debug, Serialize)]
pub struct ReachAccuracy {
    /// Where it was measured.
    pub machine: Machine,
    /// Seed of all cases.
    pub seed: u64,
    /// Cases in each class.
    pub cases: u32,
    /// The iteration counts of the rows.
    pub steps: [u32; measure::STEPS.len()],
    /// One per chain, class and method.
    pub rows: Vec<Row>,
    /// One per method.
    pub avatars: Vec<Avatars>,
    /// One per method.
    pub drifts: Vec<Drift>,
}

/// Measures all chains and classes; `tick` is called after each class.
pub fn run(plan: &ReachPlan, mut tick: impl FnMut()) -> ReachAccuracy {
    let mut all = vec![];
    for model in Model::ALL {
        let chain = model.chain();
        for class in Class::ALL {
            let cases = judged(&chain, class, plan.seed, plan.cases_of(model, class));
            all.extend(rows(model, class, &cases, plan.timed));
            tick();
        }
    }
    let avatars = motion::avatars(plan.seed, plan.cases, plan.timed);
    tick();
    let drifts = motion::drifts(plan.seed, plan.loops);
    tick();
    ReachAccuracy {
        machine: Machine::detect(),
        seed: plan.seed,
        cases: plan.cases,
        steps: measure::STEPS,
        rows: all,
        avatars,
        drifts,
    }
}

/// Writes `accuracy-reach.json`, `accuracy-reach-steps.svg` and `accuracy-reach-time.svg` into
/// `out_dir`, creating it if needed.
///
/// # Errors
/// The first file-system error.
pub fn write(accuracy: &ReachAccuracy, out_dir: &Path) -> io::Result<()> {
    let json = serde_json::to_string(accuracy).map_err(io::Error::other)?;
    std::fs::create_dir_all(out_dir)?;
    std::fs::write(out_dir.join("accuracy-reach.json"), json + "\n")?;
    let by_steps = solved_by_steps_svg(accuracy);
    std::fs::write(out_dir.join("accuracy-reach-steps.svg"), by_steps)?;
    let by_time = solved_by_time_svg(accuracy);
    std::fs::write(out_dir.join("accuracy-reach-time.svg"), by_time)
}
