//! How exact loose bodies are: cases with analytic answers, each with its error and the time it took, at
//! three frame rates, beside rapier3d on the same scenes.
//!
//! Everything is measured from the poses and velocities that an engine publishes at the ends of frames, the
//! same way for all engines. Everything but the times is a pure function of the seed.

pub mod bounce;
pub mod coupling;
pub mod cradle;
pub mod engine;
mod figure;
pub mod fit;
pub mod glide;
pub mod impacts;
pub mod kernel;
pub mod orders;
mod orders_figure;
mod panel;
pub mod peer;
pub mod piles;
pub mod robust;
pub mod row;
pub mod scene;
pub mod slope;
mod table;
pub mod top;
pub mod tumble;

use std::io;
use std::path::Path;

use serde::Serialize;

use crate::report::Machine;
use engine::{RATES_HZ, Setup, Subject};
use orders::OrderCurve;
use piles::PileTimes;
use row::{Case, Row};

pub use figure::error_time_svg;
pub use orders_figure::orders_svg;
pub use table::{failures, tables};

/// What to measure.
#[derive(Clone, Copy, Debug)]
pub struct ImpulsePlan {
    /// The only case to measure; none for all of them.
    pub only: Option<Case>,
    /// Seed of the random impacts and of the heap.
    pub seed: u64,
    /// Random impacts.
    pub impacts: u32,
    /// Steps that the free body turns through.
    pub tumbling_steps: u32,
    /// How long the heap may take to come to rest, in seconds.
    pub heap_s: f64,
    /// How long the stack stands, in seconds.
    pub stack_s: f64,
    /// Whether times are taken.
    pub timed: bool,
}

impl ImpulsePlan {
    /// The plan of the promises: 10000 impacts, a million steps, a minute.
    pub fn full(seed: u64) -> Self {
        Self {
            only: None,
            seed,
            impacts: 10_000,
            tumbling_steps: 1_000_000,
            heap_s: 6.0,
            stack_s: 60.0,
            timed: true,
        }
    }

    /// How often `tick` is called.
    pub fn ticks(&self) -> u64 {
        let at_rates = |case| match case {
            Case::Robustness => 1,
            _ => RATES_HZ.len(),
        };
        let runs: usize = self.cases().map(at_rates).sum();
        (runs * Subject::ALL.len() + usize::from(self.has_orders())) as u64
    }

    fn has_orders(&self) -> bool {
        self.only.is_none_or(|only| only == Case::Orders)
    }

    fn cases(&self) -> impl Iterator<Item = Case> {
        let only = self.only;
        let is_wanted = move |case: &Case| only.is_none_or(|only| only == *case);
        Case::ALL.into_iter().filter(is_wanted)
    }
}

/// Everything that was measured.
#[derive(Clone, Debug, Serialize)]
pub struct ImpulseAccuracy {
    /// Where it was measured.
    pub machine: Machine,
    /// Seed of the random impacts and of the heap.
    pub seed: u64,
    /// One per quantity, rate and engine.
    pub rows: Vec<Row>,
    /// The solver's orders on problems of their own; none when they were not asked for.
    pub orders: Vec<OrderCurve>,
}

/// Measures all cases; `tick` is called after each case of an engine at a rate.
pub fn run(plan: &ImpulsePlan, mut tick: impl FnMut()) -> ImpulseAccuracy {
    let mut rows = vec![];
    for case in plan.cases() {
        for subject in Subject::ALL {
            if case == Case::Robustness {
                rows.extend(robust::rows(subject, plan.timed));
                tick();
                continue;
            }
            for rate_hz in RATES_HZ {
                let setup = Setup {
                    subject,
                    rate_hz,
                    timed: plan.timed,
                };
                rows.extend(at_rate(plan, case, &setup));
                tick();
            }
        }
    }
    let mut curves = vec![];
    if plan.has_orders() {
        curves = orders::curves();
        tick();
    }
    ImpulseAccuracy {
        machine: Machine::detect(),
        seed: plan.seed,
        rows,
        orders: curves,
    }
}

/// A case that is played at one rate at a time.
fn at_rate(plan: &ImpulsePlan, case: Case, setup: &Setup) -> Vec<Row> {
    let times = PileTimes {
        heap_s: plan.heap_s,
        stack_s: plan.stack_s,
    };
    match case {
        Case::Bounce => bounce::rows(setup),
        Case::Slide => glide::slide_rows(setup),
        Case::Roll => glide::roll_rows(setup),
        Case::Cradle => cradle::rows(setup),
        Case::Slope => slope::rows(setup),
        Case::Tumble => tumble::rows(setup, plan.tumbling_steps),
        Case::Coupling => coupling::rows(setup),
        Case::Impacts => impacts::rows(setup, plan.seed, plan.impacts),
        Case::Robustness | Case::Orders => vec![],
        Case::Piles => piles::rows(setup, plan.seed, times),
    }
}

/// Writes `accuracy-impulses.json` into `out_dir`, creating it if needed, and the figures of what was
/// measured, `accuracy-impulses.svg` and `accuracy-impulses-orders.svg`.
///
/// # Errors
/// The first file-system error.
pub fn write(accuracy: &ImpulseAccuracy, out_dir: &Path) -> io::Result<()> {
    let json = serde_json::to_string(accuracy).map_err(io::Error::other)?;
    std::fs::create_dir_all(out_dir)?;
    std::fs::write(out_dir.join("accuracy-impulses.json"), json + "\n")?;
    if !accuracy.orders.is_empty() {
        let svg = orders_svg(&accuracy.orders);
        std::fs::write(out_dir.join("accuracy-impulses-orders.svg"), svg)?;
    }
    if accuracy.rows.is_empty() {
        return Ok(());
    }
    let svg = error_time_svg(accuracy);
    std::fs::write(out_dir.join("accuracy-impulses.svg"), svg)
}
