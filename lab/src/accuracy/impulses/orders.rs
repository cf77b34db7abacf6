//! Which contact gets the next impulse: what still approaches after so many impulses, for every order of the
//! kernel's solver, on four problems of plain data.
//!
//! All bodies are cubes of 0.1 m, 1 kg where nothing else is said, with four contacts on each face that
//! touches, in the middle of a frame at 90 Hz. Nothing is known of the frame before, and nothing is spread
//! over faces, merged or put to rest at once, as the kernel does around its solver: this is the order alone.

use comfy_table::{Cell, CellAlignment, ContentArrangement, LineStyle, Table, presets};
use glam::{Mat3, Vec3};
use palpable::impulses::solver::{Order, Problem};
use palpable::limits::RESIDUAL_PART;
use palpable::state::rows::{Mover, Row};
use serde::Serialize;

/// Half the edge of a cube, in metres.
const HALF_M: f32 = 0.05;

const FRICTION: f32 = 0.5;

/// What gravity adds to a body's speed in a frame, in m/s.
const FALL_M_S: f32 = 9.81 / 90.0;

/// Errors of velocity below this are none, as in the kernel, in m/s.
pub const TOLERANCE_M_S: f32 = RESIDUAL_PART * FALL_M_S;

/// Impulses that may be spent: 1, 2, 4 up to 4096.
pub const BUDGETS: [u32; 13] = [1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096];

/// The orders and their names.
pub const ORDERS: [(Order, &str); 5] = [
    (Order::MostNegative, "most negative"),
    (Order::Energy, "energy"),
    (Order::BottomUp, "bottom up"),
    (Order::Sweep, "sweep"),
    (Order::Conjugate, "conjugate"),
];

/// A problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Posed {
    /// A frame's gravity on ten boxes on each other.
    Stack,
    /// The topmost of ten boxes comes down at 1 m/s, without restitution.
    Impact,
    /// A frame's gravity on eight boxes on each other, each of twice the mass of the one below.
    HeavyTop,
    /// A frame's gravity on twenty boxes in rows of six, five, four, three and two.
    Pile,
}

impl Posed {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Stack, Self::Impact, Self::HeavyTop, Self::Pile];

    /// The name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stack => "stack of 10, gravity",
            Self::Impact => "stack of 10, hit from above at 1 m/s",
            Self::HeavyTop => "column of 8, masses 1 to 128 kg upwards",
            Self::Pile => "pile of 20, gravity",
        }
    }
}

/// What was left after a number of impulses.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Left {
    /// Impulses that might be spent.
    pub budget: u32,
    /// Impulses that were spent.
    pub spent: u32,
    /// The fastest approach of any contact, in m/s.
    pub approach_m_s: f32,
}

/// An order on a problem.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OrderCurve {
    /// The problem.
    pub problem: Posed,
    /// The order's name.
    pub order: &'static str,
    /// One for each of [`BUDGETS`].
    pub left: Vec<Left>,
}

/// Bodies and contacts that own themselves. Mover zero is the floor.
#[derive(Default)]
struct Heap {
    movers: Vec<Mover>,
    rows: Vec<Row>,
    centres: Vec<Vec3>,
}

impl Heap {
    fn on_floor() -> Self {
        Self {
            movers: vec![Mover::default()],
            rows: vec![],
            centres: vec![Vec3::ZERO],
        }
    }

    /// Adds a cube; its number.
    fn cube(&mut self, x: f32, level: usize, mass_kg: f32) -> u32 {
        let moment = mass_kg * (2.0 * HALF_M) * (2.0 * HALF_M) / 6.0;
        self.movers.push(Mover {
            inverse_mass: 1.0 / mass_kg,
            inverse_inertia: Mat3::from_diagonal(Vec3::splat(1.0 / moment)),
            ..Mover::default()
        });
        let y = HALF_M * (2 * level + 1) as f32;
        self.centres.push(Vec3::new(x, y, 0.0));
        self.centres.len() as u32 - 1
    }

    /// Has a cube lie on another body, on four contacts between `left` and `right`.
    fn lay(&mut self, upper: u32, lower: u32, [left, right]: [f32; 2]) {
        let y = self.centres[upper as usize].y - HALF_M;
        let first = self.rows.len() as u32;
        for (x, z) in [
            (left, -HALF_M),
            (right, -HALF_M),
            (right, HALF_M),
            (left, HALF_M),
        ] {
            let point = Vec3::new(x, y, z);
            let arm_b = if lower == 0 {
                Vec3::ZERO
            } else {
                point - self.centres[lower as usize]
            };
            let mut row = Row::default();
            (row.body_a, row.body_b, row.manifold) = (upper, lower, first);
            row.normal = Vec3::Y;
            row.arm_a = point - self.centres[upper as usize];
            row.arm_b = arm_b;
            row.bounce = f32::INFINITY;
            row.friction = FRICTION;
            row.height = y;
            self.rows.push(row);
        }
    }

    /// Cubes of these masses on each other.
    fn column(masses_kg: impl IntoIterator<Item = f32>) -> Self {
        let mut heap = Self::on_floor();
        for (level, mass_kg) in masses_kg.into_iter().enumerate() {
            let cube = heap.cube(0.0, level, mass_kg);
            heap.lay(cube, cube - 1, [-HALF_M, HALF_M]);
        }
        heap
    }

    /// Rows of cubes, each cube on two of the row below.
    fn pile() -> Self {
        let mut heap = Self::on_floor();
        let mut below: Vec<u32> = vec![];
        for (level, count) in (2..=6).rev().enumerate() {
            let mut row = vec![];
            for place in 0..count {
                let x = 2.1 * HALF_M * (place as f32 - 0.5 * (count - 1) as f32);
                let cube = heap.cube(x, level, 1.0);
                if level == 0 {
                    heap.lay(cube, 0, [x - HALF_M, x + HALF_M]);
                } else {
                    let [left, right] = [below[place], below[place + 1]];
                    let edges = [left, right].map(|lower| heap.centres[lower as usize].x);
                    heap.lay(cube, left, [x - HALF_M, edges[0] + HALF_M]);
                    heap.lay(cube, right, [edges[1] - HALF_M, x + HALF_M]);
                }
                row.push(cube);
            }
            below = row;
        }
        heap
    }

    fn fall(mut self) -> Self {
        for mover in &mut self.movers[1..] {
            mover.velocity.y = -FALL_M_S;
        }
        self
    }

    fn of(posed: Posed) -> Self {
        match posed {
            Posed::Stack => Self::column([1.0; 10]).fall(),
            Posed::Impact => {
                let mut heap = Self::column([1.0; 10]);
                heap.movers[10].velocity.y = -1.0;
                heap
            }
            Posed::HeavyTop => Self::column((0..8).map(|level| f32::exp2(level as f32))).fall(),
            Posed::Pile => Self::pile().fall(),
        }
    }
}

/// What is left when `order` spends at most `budget` impulses on a problem. Impacts collide, all else
/// settles.
pub fn left(posed: Posed, order: Order, budget: u32) -> Left {
    let mut heap = Heap::of(posed);
    let mut first = vec![0; heap.movers.len()];
    let mut queue = vec![0; heap.rows.len()];
    let mut problem = Problem {
        movers: &mut heap.movers,
        rows: &mut heap.rows,
        first: &mut first,
        queue: &mut queue,
        order,
        tolerance: TOLERANCE_M_S,
    };
    problem.prepare();
    let spent = match posed {
        Posed::Impact => problem.strike(budget),
        _ => problem.settle(budget),
    };
    Left {
        budget,
        spent,
        approach_m_s: problem.worst_approach(|_| true),
    }
}

/// All orders on all problems.
pub fn curves() -> Vec<OrderCurve> {
    let on = |problem: Posed| {
        ORDERS.map(|(order, name)| OrderCurve {
            problem,
            order: name,
            left: BUDGETS.map(|budget| left(problem, order, budget)).to_vec(),
        })
    };
    Posed::ALL.into_iter().flat_map(on).collect()
}

/// What is left, in mm/s, for every problem, order and number of impulses.
pub fn table(curves: &[OrderCurve]) -> Table {
    let mut table = Table::new();
    let mut header = vec!["problem".to_owned(), "order".to_owned()];
    header.extend(BUDGETS.map(|budget| budget.to_string()));
    header.push("spent".to_owned());
    table
        .load_style(presets::UTF8_HORIZONTAL_ONLY.row_separator(LineStyle::none()))
        .set_content_arrangement(ContentArrangement::Disabled)
        .set_header(header);
    let mut last = None;
    for curve in curves {
        let is_new = last.replace(curve.problem) != Some(curve.problem);
        let name = if is_new { curve.problem.name() } else { "" };
        let mut cells = vec![Cell::new(name), Cell::new(curve.order)];
        cells.extend(curve.left.iter().map(|left| right(mm_s(left.approach_m_s))));
        let spent = curve.left.last().map_or(0, |left| left.spent);
        cells.push(right(spent.to_string()));
        table.add_row(cells);
    }
    table
}

fn right(text: String) -> Cell {
    Cell::new(text).set_alignment(CellAlignment::Right)
}

/// What counts as no error is not told apart.
fn mm_s(speed: f32) -> String {
    if speed <= TOLERANCE_M_S {
        "✓".to_owned()
    } else {
        let speed = 1e3 * f64::from(speed);
        let digits = (1 - speed.log10().floor() as i32).clamp(0, 3) as usize;
        format!("{speed:.digits$}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_problems_are_what_they_are_called() {
        let sizes = Posed::ALL.map(|posed| {
            let heap = Heap::of(posed);
            (heap.movers.len() - 1, heap.rows.len())
        });
        assert_eq!(sizes, [(10, 40), (10, 40), (8, 32), (20, 24 + 4 * 28)]);
        for posed in Posed::ALL {
            let before = left(posed, Order::Sweep, 0).approach_m_s;
            let expected = if posed == Posed::Impact {
                1.0
            } else {
                FALL_M_S
            };
            assert!((before - expected).abs() < 1e-6, "{posed:?}: {before}");
        }
    }

    #[test]
    fn budgets_are_kept() {
        for curve in curves() {
            for left in &curve.left {
                assert!(left.spent <= left.budget, "{curve:?}");
                assert!(left.approach_m_s.is_finite(), "{curve:?}");
            }
        }
    }
}
