//! How exact and how fast penetration, distance and least translations are, beside parry3d and
//! the paper's own local walk, and against the lab's f64 reference.
//!
//! Everything but the times is a pure function of the seed.

mod figure;
pub mod generate;
pub mod impulses;
pub mod local_walk;
pub mod measure;
pub mod methods;
pub mod reach;
pub mod shapes;
pub mod summary;
mod table;
pub mod unions;

use std::io;
use std::path::Path;

use serde::Serialize;

use generate::Class;
use measure::{Score, Scores};
use methods::Method;
use summary::{Beyond, Ratios, Row, Walks};
use unions::{Moved, UnionClass, UnionRow};

use crate::report::Machine;

pub use figure::speed_error_svg;
pub use table::tables;

/// What to measure.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// Seed of all pairs and unions.
    pub seed: u64,
    /// Pairs in each class.
    pub pairs: u32,
    /// Unions in each of the classes shallow and deep; the others have a fifth of that.
    pub unions: u32,
    /// Whether times are taken.
    pub timed: bool,
}

impl Plan {
    /// How often `tick` is called.
    pub fn ticks(&self) -> u64 {
        let unions: u32 = UnionClass::ALL
            .map(|class| self.unions_of(class))
            .iter()
            .sum();
        u64::from(self.pairs) * Class::ALL.len() as u64 + u64::from(unions)
    }

    fn unions_of(&self, class: UnionClass) -> u32 {
        match class {
            UnionClass::Shallow | UnionClass::Deep => self.unions,
            UnionClass::Slot | UnionClass::Corner => self.unions.div_ceil(5),
        }
    }
}

/// Everything that was measured.
#[derive(Clone, Debug, Serialize)]
pub struct Accuracy {
    /// Where it was measured.
    pub machine: Machine,
    /// Seed of all pairs and unions.
    pub seed: u64,
    /// Pairs in each class.
    pub pairs: u32,
    /// One per class and method.
    pub rows: Vec<Row>,
    /// One per class.
    pub ratios: Vec<Ratios>,
    /// One per class, cold and warm: the paper's local walk.
    pub walks: Vec<Walks>,
    /// Where the kernel is less exact than aimed at.
    pub beyond: Vec<Beyond>,
    /// One per class of unions and mover.
    pub unions: Vec<UnionRow>,
    /// Every pair, per class and method.
    pub scores: Vec<Scores>,
    /// Every pair of unions, per class, in the movers' order.
    pub moved: Vec<Vec<[Moved; 4]>>,
}

impl Accuracy {
    /// The kernel's failures, cold and warm.
    pub fn kernel_failures(&self) -> impl Iterator<Item = (Class, Method, &Score)> {
        self.scores.iter().filter(is_kernel).flat_map(|scores| {
            let failed = scores.scores.iter().filter(|score| score.failure.is_some());
            failed.map(|score| (scores.class, scores.method, score))
        })
    }
}

fn is_kernel(scores: &&Scores) -> bool {
    matches!(scores.method, Method::Palpable | Method::PalpableWarm)
}

/// Measures all classes; `tick` is called after each pair and each union.
pub fn run(plan: &Plan, mut tick: impl FnMut()) -> Accuracy {
    let scores: Vec<Scores> = Class::ALL
        .into_iter()
        .flat_map(|class| measure::class(class, plan.seed, plan.pairs, plan.timed, &mut tick))
        .collect();
    let rows: Vec<Row> = scores.iter().map(Row::new).collect();
    let moved: Vec<Vec<[Moved; 4]>> = UnionClass::ALL
        .into_iter()
        .map(|class| unions::class(class, plan.seed, plan.unions_of(class), &mut tick))
        .collect();
    let union_rows = UnionClass::ALL.into_iter().zip(&moved);
    Accuracy {
        machine: Machine::detect(),
        seed: plan.seed,
        pairs: plan.pairs,
        ratios: Class::ALL.map(|class| Ratios::new(class, &rows)).into(),
        walks: Walks::all(&scores, &rows),
        rows,
        beyond: scores
            .iter()
            .filter(is_kernel)
            .filter_map(Beyond::new)
            .collect(),
        unions: union_rows
            .flat_map(|(class, moved)| unions::rows(class, moved))
            .collect(),
        scores,
        moved,
    }
}

/// Writes `accuracy-penetration.json` and `accuracy-penetration.svg` into `out_dir`, creating it if
/// needed.
///
/// # Errors
/// The first file-system error.
pub fn write(accuracy: &Accuracy, out_dir: &Path) -> io::Result<()> {
    let json = serde_json::to_string(accuracy).map_err(io::Error::other)?;
    std::fs::create_dir_all(out_dir)?;
    std::fs::write(out_dir.join("accuracy-penetration.json"), json + "\n")?;
    std::fs::write(
        out_dir.join("accuracy-penetration.svg"),
        speed_error_svg(accuracy),
    )
}
