//! The program of one step: goals and cones linearised, solved through its dual.
//!
//! Least |y - reference|^2 / 2 + sum of s^2 / (2 softness) over angles y within the hinges' ranges,
//! subject to rows . y + s >= least, or equal where exact, s being zero where hard. The dual matrix is
//! rows rows^T + softness on the diagonal; forces f give y = reference + rows^T f, kept within the
//! ranges. Which rows press and which joints are at their limits is found by the primal-dual active set
//! method (Hintermueller, Ito and Kunisch 2002: for these programs a Newton method), at most
//! [`PASSES_MAX`] times a small factorisation.
//!
//! Heights bend: a shoulder's by as much as the arm is long. Where that matters the program is solved
//! twice more, see [`Program::bend`].

use arrayvec::ArrayVec;

use super::TURN_MAX;
use super::spot::Spot;
use crate::geometry::chain::Hinge;
use crate::limits::{CHAIN_GOALS_MAX, CHAIN_HINGES_MAX};
use crate::math;
use crate::reach::goal::{Angles, CHAIN_BALLS_MAX, Goal, Row, Task};

/// Most factorisations in one solution of a step's program, of which there are at most three.
pub const PASSES_MAX: u32 = 7;

/// Most rows: goals, and two edges of each ball's cone.
const ROWS_MAX: usize = CHAIN_GOALS_MAX + 2 * CHAIN_BALLS_MAX;

/// A metre missed costs this many times the largest force in the merit: more than one, so that the
/// program's way lowers it.
const PENALTY_FACTOR: f32 = 1.5;

type Rows<T> = ArrayVec<T, ROWS_MAX>;

/// Soft goals of 1e-5 m2/rad2 against hard ones mean forces of 1e4 that cancel: f32 would not do.
type Wide<const W: usize> = [f64; W];

/// Chains of no more hinges than this have programs of this width.
pub(super) const NARROW: usize = CHAIN_HINGES_MAX / 2;

/// Goals that bend away by no more than this part of the tolerance are taken for straight.
const BEND_MIN: f32 = 0.25;

/// Most that second derivatives stiffen a joint, the pull toward its tracked angle being one.
const SPRING_MAX: f32 = 10.0;

/// Most that is asked for where a goal bends away, as a part of what is needed.
const LEAD_MAX: f32 = 2.0;

/// What to ask for of a height that falls short of its tangent by `short` of the step asked for: the
/// lesser t with t - short t2 = 1.
fn lead(short: f32) -> f32 {
    if short.abs() < 1e-3 {
        1.0 + short
    } else if short < 0.25 {
        (1.0 - math::sqrt(1.0 - 4.0 * short)) / (2.0 * short)
    } else {
        LEAD_MAX
    }
}

/// One linearised goal or edge.
struct Line<const W: usize> {
    row: Wide<W>,
    least: f64,
    is_exact: bool,
    softness: f64,
    /// The row's product with itself and its softness: what a unit of force does to it.
    stiffness: f64,
    /// What is added to the diagonal of the matrix.
    added: f64,
    /// The multiplier.
    force: f64,
    presses: bool,
}

/// A program for at most `W` joints.
pub(super) struct Program<const W: usize> {
    lines: Rows<Line<W>>,
    /// The angles that the change is least from, zero beyond the joints.
    reference: Wide<W>,
    y: Wide<W>,
    joints: usize,
    /// The reference before springs are added.
    tracked: Wide<W>,
    /// How far a unit of force turns each joint.
    give: Wide<W>,
}

impl<const W: usize> Program<W> {
    /// The program at a spot; `restores` asks for the least change from there instead of from the
    /// tracked angles.
    pub(super) fn new(task: &Task, spot: &Spot, restores: bool, damping: f32) -> Self {
        let q = padded(&spot.q);
        let joints = spot.q.len();
        let reference = if restores {
            q
        } else {
            padded(&task.wanted[..joints])
        };
        let mut new = Self {
            lines: Rows::new(),
            reference,
            y: reference,
            joints,
            tracked: reference,
            give: [1.0; W],
        };
        let mut largest = 0.0;
        for beside in task.used_goals().chunk_by(Goal::is_beside) {
            let levers = beside[0].levers(&spot.placed);
            for goal in beside {
                let row = widened(&goal.row(&levers));
                let softness = if goal.is_hard() { 0.0 } else { goal.softness };
                let above_m = goal.normal.dot(levers.at) - goal.height_m;
                let least = product(&row, &q) - f64::from(above_m);
                let line = Line::new(row, least, goal.is_exact, f64::from(softness));
                if goal.is_hard() {
                    largest = math::max_f64(line.stiffness, largest);
                }
                new.lines.push(line);
            }
        }
        for line in &mut new.lines {
            line.added =
                line.softness + f64::from(damping) * largest + f64::from(f32::MIN_POSITIVE);
        }
        new.add_cones(task, spot, &q);
        new.choose();
        new
    }

    fn add_cones(&mut self, task: &Task, spot: &Spot, q: &Wide<W>) {
        for ball in task.used_balls() {
            if ball.first.saturating_add(2) >= self.joints {
                continue;
            }
            let limb = ball.limb(&spot.q);
            let [by_a, by_b] = ball.limb_slopes(&spot.q);
            for normal in ball.walls(limb) {
                let mut row = [0.0; W];
                row[ball.first] = f64::from(normal.dot(by_a));
                row[ball.first + 1] = f64::from(normal.dot(by_b));
                let least = product(&row, q) - f64::from(normal.dot(limb));
                let mut line = Line::new(row, least, false, 0.0);
                line.added = CONE_DAMPING * line.stiffness + f64::from(f32::MIN_POSITIVE);
                self.lines.push(line);
            }
        }
    }

    /// Solves again with second derivatives, where goals bend away by more than a part of the tolerance:
    /// joints along which the pressing goals bend give way less, and then as much more is asked for as
    /// the goals bend away from their tangents.
    ///
    /// Of the Hessian of the Lagrangian the diagonal is kept, where it is positive.
    pub(super) fn bend(&mut self, task: &Task, spot: &Spot) {
        for leads in [false, true] {
            let mut turned = difference(&self.angles(), &spot.q);
            let widest = turned.iter().map(|x| x.abs()).fold(0.0, math::max);
            let part = if widest > TURN_MAX {
                TURN_MAX / widest
            } else {
                1.0
            };
            for turned in &mut turned {
                *turned *= part;
            }
            let mut most = 0.0;
            let mut curved = [0.0; CHAIN_HINGES_MAX];
            let mut lines = self.lines.iter_mut();
            for beside in task.used_goals().chunk_by(Goal::is_beside) {
                // What goals of one point have in common, once one of them presses.
                let mut bends = None;
                for (goal, line) in beside.iter().zip(&mut lines) {
                    if !line.presses {
                        continue;
                    }
                    let bends = bends.get_or_insert_with(|| goal.bends(&spot.placed, &turned));
                    let short_m = bends.short_m(goal.normal);
                    most = math::max(short_m.abs(), most);
                    for (sum, c) in curved.iter_mut().zip(bends.curvature(goal.normal)) {
                        *sum += part * line.force as f32 * c;
                    }
                    if leads && line.softness == 0.0 {
                        let gain = product(&line.row, &widened(&turned));
                        let share = lead((f64::from(short_m) / gain) as f32);
                        line.least += gain * f64::from((share - 1.0) / part);
                    }
                }
            }
            if most <= BEND_MIN * task.tolerance_m {
                return;
            }
            self.stiffen(&curved, &spot.q);
            self.solve(task);
        }
    }

    /// Adds a spring to each joint that holds it where it is.
    fn stiffen(&mut self, curved: &Row, q: &Angles) {
        for (joint, q) in q.iter().enumerate() {
            let spring = math::clamp(curved[joint], 0.0, SPRING_MAX);
            let spring = f64::from(spring);
            self.give[joint] = 1.0 / (1.0 + spring);
            let pulled = self.tracked[joint] + spring * f64::from(*q);
            self.reference[joint] = pulled * self.give[joint];
        }
    }

    /// The angles found.
    pub(super) fn angles(&self) -> Angles {
        self.y[..self.joints].iter().map(|&y| y as f32).collect()
    }

    /// What missing a metre of the hard goals is to cost, in rad2.
    pub(super) fn penalty(&self) -> f32 {
        let hard = self.lines.iter().filter(|line| line.softness == 0.0);
        PENALTY_FACTOR
            * hard
                .map(|line| line.force.abs() as f32)
                .fold(0.0, math::max)
    }

    /// The rows that press: exact ones, those with a force and those that are not met. Whether that
    /// changed anything.
    fn choose(&mut self) -> bool {
        let mut changed = false;
        for line in &mut self.lines {
            let short = line.least - product(&line.row, &self.y);
            let pressed = (line.stiffness - line.softness) * line.force + short;
            let presses = line.is_exact || pressed > 0.0;
            changed |= presses != line.presses;
            line.presses = presses;
        }
        changed
    }

    pub(super) fn solve(&mut self, task: &Task) {
        let mut free = [0.0; W];
        free[..self.joints].fill(1.0);
        for _ in 0..PASSES_MAX {
            self.balance(&free);
            let mut changed = false;
            let pulled = self.pulled();
            for (index, hinge) in task.hinges.iter().enumerate().take(self.joints) {
                self.y[index] = kept(hinge, pulled[index]);
                let is_free = if self.y[index] == pulled[index] {
                    1.0
                } else {
                    0.0
                };
                changed |= is_free != free[index];
                free[index] = is_free;
            }
            changed |= self.choose();
            if !changed {
                break;
            }
        }
    }

    /// Where the forces pull joints that have no limits.
    fn pulled(&self) -> Wide<W> {
        let mut pulled = self.reference;
        for line in self.lines.iter().filter(|line| line.presses) {
            for j in 0..W {
                pulled[j] += line.row[j] * self.give[j] * line.force;
            }
        }
        pulled
    }

    /// The forces with which the pressing rows hold, the joints that are not free staying where they
    /// are.
    fn balance(&mut self, free: &Wide<W>) {
        let pressing: Rows<usize> = (0..self.lines.len())
            .filter(|&index| self.lines[index].presses)
            .collect();
        // Few rows press as a rule: no more of the matrix is cleared than is used.
        match pressing.len() {
            0..=4 => self.balance_few::<4>(free, &pressing),
            5..=8 => self.balance_few::<8>(free, &pressing),
            9..=12 => self.balance_few::<12>(free, &pressing),
            _ => self.balance_few::<ROWS_MAX>(free, &pressing),
        }
    }

    /// The same for at most `N` pressing rows.
    fn balance_few<const N: usize>(&mut self, free: &Wide<W>, pressing: &[usize]) {
        let mut held = self.y;
        let mut give = self.give;
        for j in 0..W {
            if free[j] != 0.0 {
                held[j] = self.reference[j];
            } else {
                give[j] = 0.0;
            }
        }
        let mut matrix = [[0.0_f64; N]; N];
        let mut right = [0.0_f64; N];
        for (i, &index) in pressing.iter().enumerate() {
            let line = &self.lines[index];
            right[i] = line.least - product(&line.row, &held);
            let mut moved = line.row;
            for j in 0..W {
                moved[j] *= give[j];
            }
            for (j, &other) in pressing.iter().enumerate().take(i + 1) {
                matrix[i][j] = product(&moved, &self.lines[other].row);
                matrix[j][i] = matrix[i][j];
            }
            matrix[i][i] += line.added;
        }
        solve_symmetric(&mut matrix, &mut right, pressing.len());
        for line in &mut self.lines {
            line.force = 0.0;
        }
        for (&index, &force) in pressing.iter().zip(&right) {
            self.lines[index].force = force;
        }
    }
}

/// Damping of a cone's rows, as a part of their own diagonal entry.
const CONE_DAMPING: f64 = 1e-6;

impl<const W: usize> Line<W> {
    fn new(row: Wide<W>, least: f64, is_exact: bool, softness: f64) -> Self {
        Self {
            row,
            least,
            is_exact,
            softness,
            stiffness: product(&row, &row) + softness,
            added: 0.0,
            force: 0.0,
            presses: is_exact,
        }
    }
}

fn difference(a: &[f32], b: &[f32]) -> Row {
    let mut row = [0.0; CHAIN_HINGES_MAX];
    for (slot, (a, b)) in row.iter_mut().zip(a.iter().zip(b)) {
        *slot = a - b;
    }
    row
}

fn padded<const W: usize>(angles: &[f32]) -> Wide<W> {
    let mut row = [0.0; W];
    for (slot, &angle) in row.iter_mut().zip(angles) {
        *slot = f64::from(angle);
    }
    row
}

/// [`Hinge::kept`] in f64.
fn kept(hinge: &Hinge, angle: f64) -> f64 {
    let (low, high) = (f64::from(hinge.low_rad), f64::from(hinge.high_rad));
    if angle > high {
        high
    } else if angle >= low {
        angle
    } else {
        low
    }
}

fn widened<const W: usize>(row: &Row) -> Wide<W> {
    core::array::from_fn(|joint| f64::from(row[joint]))
}

/// Eight sums side by side, then one fixed tree.
fn product<const W: usize>(a: &Wide<W>, b: &Wide<W>) -> f64 {
    let mut s = [0.0; NARROW];
    for k in 0..NARROW {
        s[k] = a[k] * b[k];
    }
    for k in NARROW..W {
        s[k - NARROW] += a[k] * b[k];
    }
    ((s[0] + s[4]) + (s[1] + s[5])) + ((s[2] + s[6]) + (s[3] + s[7]))
}

/// Solves a symmetric positive definite system in place (Cholesky without roots). Rows are worked on as a
/// whole, what nobody reads any more included: loops of one length are straight lines.
fn solve_symmetric<const N: usize>(matrix: &mut [[f64; N]; N], right: &mut [f64; N], count: usize) {
    for i in 0..count {
        for j in 0..i {
            let factor = matrix[i][j] / matrix[j][j];
            for k in 0..N {
                matrix[i][k] -= factor * matrix[j][k];
            }
            right[i] -= factor * right[j];
        }
    }
    for i in (0..count).rev() {
        for j in i + 1..count {
            right[i] -= matrix[i][j] * right[j];
        }
        right[i] /= matrix[i][i];
    }
}
