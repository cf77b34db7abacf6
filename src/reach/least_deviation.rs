//! The angles nearest to the tracked ones that meet all goals.
//!
//! Least sum of squared changes from the tracked angles, subject to the goals' planes and the joint
//! limits: sequential quadratic programming with the goals linearised. Each program is solved through
//! its dual by the primal-dual active set method (Hintermueller, Ito and Kunisch 2002: for these
//! programs a Newton method), at most [`PASSES_MAX`] times a small factorisation. A step is taken only
//! if it gets nearer to the goals, or nearer to the tracked angles with the goals met; it is halved
//! otherwise.
//!
//! The first step starts from the tracked angles. Where it misses, because the planes of the goals bend
//! with the angles, the next ones are the least changes from where it came to: a Newton method for the
//! goals alone, which converges where further steps from the tracked angles would swing from side to
//! side. Once the goals are met, steps pull toward the tracked angles again.

use arrayvec::ArrayVec;

use super::goal::{Angles, Reached, Row, Task, worst_m};
use crate::geometry::chain::posture;
use crate::limits::{CHAIN_GOALS_MAX, CHAIN_HINGES_MAX};
use crate::math;

/// Most factorisations in one step.
pub const PASSES_MAX: u32 = 7;

/// Most that an angle changes in one step, in radians: beyond it the linearised goals mean little.
const TURN_MAX: f32 = 0.7;

/// A step that would turn no joint by more than this ends the search, in radians.
const TURN_MIN: f32 = 1e-4;

/// What is added to the factorised matrix's diagonal, as a part of its largest entry: it bounds the
/// step where goals cannot be met.
const DAMPING: f32 = 1e-6;

/// How often a step is halved.
const HALVINGS_MAX: u32 = 4;

/// Takes up to `steps` steps from `angles`, which stay within the limits.
///
/// A step is one linearisation, at most [`PASSES_MAX`] factorisations of a matrix with as many rows as
/// goals, and at most five forward kinematics. With all goals met at the tracked angles none is taken.
pub fn least_deviation(task: &Task, angles: &mut [f32], steps: u32) -> Reached {
    let mut q = task.start(angles);
    let mut missed_m = worst_m(task.goals, &posture(task.hinges, &task.root, &q));
    let mut used = 0;
    let at_rest = missed_m <= task.tolerance_m && task.deviation(&q) == 0.0;
    while used < steps && !at_rest {
        used += 1;
        let wanted = task.wanted_angles();
        let restores = used > 1 && missed_m > task.tolerance_m;
        let reference = if restores { q.clone() } else { wanted };
        let next = Program::new(task, &q, reference).solve(task);
        let Some((nearer, missed)) = guarded(task, &q, &next, missed_m) else {
            break;
        };
        let turned = q.iter().zip(&nearer).map(|(a, b)| (a - b).abs());
        let turned = turned.fold(0.0, math::max);
        (q, missed_m) = (nearer, missed);
        if missed_m <= task.tolerance_m && turned <= TURN_MIN {
            break;
        }
    }
    for (angle, &found) in angles.iter_mut().zip(&q) {
        *angle = found;
    }
    Reached {
        steps: used,
        missed_m,
    }
}

/// The longest part of the way from `q` to `next` that is worth going, with what is missed there.
fn guarded(task: &Task, q: &Angles, next: &Angles, missed_m: f32) -> Option<(Angles, f32)> {
    let change = |(a, b): (&f32, &f32)| (b - a).abs();
    let most = q.iter().zip(next).map(change).fold(0.0, math::max);
    let mut share = if most > TURN_MAX {
        TURN_MAX / most
    } else {
        1.0
    };
    for _ in 0..=HALVINGS_MAX {
        let part = |(a, b): (&f32, &f32)| {
            if share == 1.0 {
                *b
            } else {
                a + (b - a) * share
            }
        };
        let trial: Angles = q.iter().zip(next).map(part).collect();
        let missed = worst_m(task.goals, &posture(task.hinges, &task.root, &trial));
        let met = missed <= task.tolerance_m;
        let nearer = missed_m <= task.tolerance_m && task.deviation(&trial) < task.deviation(q);
        if (met && (nearer || missed_m > task.tolerance_m)) || (!met && missed < missed_m) {
            return Some((trial, missed));
        }
        share *= 0.5;
    }
    None
}

type Goals<T> = ArrayVec<T, CHAIN_GOALS_MAX>;

/// The goals linearised at some angles: rows . y >= least, or equal where exact.
struct Program {
    rows: Goals<Row>,
    least: Goals<f32>,
    exact: Goals<bool>,
    /// Multipliers of the rows.
    forces: Goals<f32>,
    /// The rows that press.
    active: Goals<bool>,
    /// The angles that the change is least from.
    reference: Angles,
    y: Angles,
}

impl Program {
    fn new(task: &Task, q: &Angles, reference: Angles) -> Self {
        let placed = posture(task.hinges, &task.root, q);
        let mut new = Self {
            rows: Goals::new(),
            least: Goals::new(),
            exact: Goals::new(),
            forces: Goals::new(),
            active: Goals::new(),
            y: reference.clone(),
            reference,
        };
        for goal in task.goals.iter().take(CHAIN_GOALS_MAX) {
            let row = goal.row(&placed);
            new.least.push(product(&row, q) - goal.above_m(&placed));
            new.rows.push(row);
            new.exact.push(goal.is_exact);
            new.forces.push(0.0);
            new.active.push(goal.is_exact);
        }
        new.choose();
        new
    }

    /// The rows that press: exact ones, those with a force and those that are not met. Whether that
    /// changed anything.
    fn choose(&mut self) -> bool {
        let mut changed = false;
        for index in 0..self.rows.len() {
            let row = &self.rows[index];
            let short = self.least[index] - product(row, &self.y);
            let stiffness = row.iter().map(|x| x * x).sum::<f32>();
            let presses = self.exact[index] || self.forces[index] * stiffness + short > 0.0;
            changed |= presses != self.active[index];
            self.active[index] = presses;
        }
        changed
    }

    fn solve(mut self, task: &Task) -> Angles {
        let mut free: ArrayVec<bool, CHAIN_HINGES_MAX> = self.y.iter().map(|_| true).collect();
        for _ in 0..PASSES_MAX {
            self.balance(&free);
            let mut changed = false;
            for (index, hinge) in task.hinges.iter().enumerate().take(self.y.len()) {
                let pulled = self.pulled(index);
                self.y[index] = hinge.kept(pulled);
                let is_free = self.y[index] == pulled;
                changed |= is_free != free[index];
                free[index] = is_free;
            }
            changed |= self.choose();
            if !changed {
                break;
            }
        }
        self.y
    }

    /// Where the forces pull a joint that has no limits.
    fn pulled(&self, joint: usize) -> f32 {
        let rows = self.rows.iter().zip(&self.forces);
        self.reference[joint] + rows.map(|(row, force)| row[joint] * force).sum::<f32>()
    }

    /// The forces with which the pressing rows hold exactly, the joints that are not free staying where
    /// they are.
    fn balance(&mut self, free: &[bool]) {
        let pressing: Goals<usize> = (0..self.rows.len()).filter(|&i| self.active[i]).collect();
        let mut matrix = [[0.0_f32; CHAIN_GOALS_MAX]; CHAIN_GOALS_MAX];
        let mut right = [0.0_f32; CHAIN_GOALS_MAX];
        let mut largest = 0.0;
        for (i, &row) in pressing.iter().enumerate() {
            right[i] = self.least[row] - self.without_forces(free, row);
            for (j, &other) in pressing.iter().enumerate() {
                let both = self.rows[row].iter().zip(&self.rows[other]).zip(free);
                matrix[i][j] = both
                    .map(|((a, b), &free)| if free { a * b } else { 0.0 })
                    .sum();
            }
            largest = math::max(matrix[i][i], largest);
        }
        for (i, line) in matrix.iter_mut().enumerate().take(pressing.len()) {
            line[i] += DAMPING * largest + f32::MIN_POSITIVE;
        }
        solve_symmetric(&mut matrix, &mut right, pressing.len());
        self.forces.fill(0.0);
        for (i, &row) in pressing.iter().enumerate() {
            self.forces[row] = right[i];
        }
    }

    /// A row's product with the reference where joints are free, and with the limits elsewhere.
    fn without_forces(&self, free: &[bool], row: usize) -> f32 {
        let at = |joint: usize| {
            if free[joint] {
                self.reference[joint]
            } else {
                self.y[joint]
            }
        };
        (0..self.y.len()).map(|j| self.rows[row][j] * at(j)).sum()
    }
}

fn product(row: &Row, q: &Angles) -> f32 {
    row.iter().zip(q).map(|(a, b)| a * b).sum()
}

/// Solves a symmetric positive definite system in place (Cholesky without roots).
fn solve_symmetric(
    matrix: &mut [[f32; CHAIN_GOALS_MAX]; CHAIN_GOALS_MAX],
    right: &mut [f32; CHAIN_GOALS_MAX],
    count: usize,
) {
    for i in 0..count {
        for j in 0..i {
            let factor = matrix[i][j] / matrix[j][j];
            for k in j..count {
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
