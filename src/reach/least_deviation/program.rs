//! The program of one step: goals and cones linearised, solved through its dual.
//!
//! Least d M d / 2 + slope . d + sum of s^2 / (2 softness) over turns d that stay within the hinges'
//! ranges, subject to rows . d + s >= need, or equal where exact, s being zero where hard. Soft goals that
//! are exact have no rows: they are part of the metric M, which has the second derivatives of the cost,
//! and of the slope. Forces f give d = inverse of M times (rows^T f - slope), and the dual matrix is rows
//! times the inverse of M times rows^T, with softness on the diagonal. Which rows press and which joints
//! are at their limits is found by the primal-dual active set method (Hintermueller, Ito and Kunisch 2002:
//! for these programs a Newton method). It goes round in circles where rows are nearly parallel, as those of
//! two points along a straight arm: after a few passes it begins again with none, and the worst row or joint
//! alone is changed. That is at most [`PASSES_MAX`] times a small factorisation.
//!
//! Heights bend: a shoulder's by as much as the arm is long. Where that matters the program is solved
//! twice more, see [`Program::bend`].

use arrayvec::ArrayVec;
use glam::Vec3;

use super::metric::{Factor, Metric, Torques, Wide, product};
use super::spot::Spot;
use super::{DAMPING_RAISED, TURN_MAX};
use crate::geometry::chain::{Hinge, Posture};
use crate::limits::{CHAIN_GOALS_MAX, CHAIN_HINGES_MAX};
use crate::math;
use crate::reach::goal::{Angles, CHAIN_BALLS_MAX, Goal, Levers, Row, Task};

/// Most factorisations in one solution of a step's program, of which there are at most three.
pub const PASSES_MAX: u32 = 10;

/// How many of them change all rows and joints that are wrong: what does not go round in circles is mostly
/// found by then.
const BLOCK_PASSES: u32 = 4;

/// A row or joint that is wrong by no more than this is right, in radians.
const WRONG_MIN: f64 = 1e-9;

/// A push whose point no joint moves by a micrometre a radian, squared: it is not asked for, since no force is enough.
pub(super) const UNMOVED: f64 = 1e-12;

/// Most rows: goals, and two edges of each ball's cone.
const ROWS_MAX: usize = CHAIN_GOALS_MAX + 2 * CHAIN_BALLS_MAX;

/// A metre missed costs this many times the largest force in the merit: more than one, so that the
/// program's way lowers it.
const PENALTY_FACTOR: f32 = 1.5;

pub(super) type Rows<T> = ArrayVec<T, ROWS_MAX>;

/// Chains of no more hinges than this have programs of this width.
pub(super) const NARROW: usize = CHAIN_HINGES_MAX / 2;

/// Goals that bend away by no more than this part of the tolerance are taken for straight.
const BEND_MIN: f32 = 0.25;

/// Least curvature that a step trusts, that of the change of the angles being one.
const PIVOT_MIN: f64 = 0.1;

/// Curvature that is not worth solving again for, that of the change of the angles being one.
const CURVED_MIN: f64 = 0.03;

/// Ways that turn a joint by more are so far that soft goals are taken for straight, in radians.
const LEAP_MIN: f32 = 0.25;

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
pub(super) struct Line<const W: usize> {
    pub(super) row: Wide<W>,
    /// The height that is asked for, above where the point is.
    pub(super) need: f64,
    is_exact: bool,
    softness: f64,
    /// The row's product with itself and its softness.
    stiffness: f64,
    /// What is added to the diagonal of the matrix.
    added: f64,
    /// The multiplier.
    pub(super) force: f64,
    pub(super) presses: bool,
}

/// How goals bend on a way.
struct Bent {
    /// What second derivatives goals add to the cost.
    torques: Torques,
    /// The most that a pressing goal stays behind its tangent, in metres.
    short_m: f32,
    /// Whether the way is so far that soft goals were taken for straight: what is missed where it begins says
    /// little of what is missed where it ends.
    leaps: bool,
}

/// A program for at most `W` joints.
pub(super) struct Program<const W: usize> {
    pub(super) lines: Rows<Line<W>>,
    /// How many of them are goals'; cones' follow.
    pub(super) goal_lines: usize,
    pub(super) joints: usize,
    /// Where it is linearised; zero beyond the joints.
    pub(super) q: Wide<W>,
    /// First derivatives of the cost there.
    pub(super) slope: Wide<W>,
    /// Second derivatives of the cost.
    pub(super) metric: Metric<W>,
    /// Those among the joints that are not at their limits.
    pub(super) factor: Factor<W>,
    /// The turns found.
    pub(super) turns: Wide<W>,
}

impl<const W: usize> Program<W> {
    /// A program without goals, to begin at some angles.
    #[inline]
    pub(super) fn at(spot: &Spot) -> Self {
        let metric = Metric::new();
        let joints = spot.q.len();
        Self {
            lines: Rows::new(),
            goal_lines: 0,
            joints,
            q: padded(&spot.q),
            slope: [0.0; W],
            factor: Factor::new(&metric, &[true; W], joints),
            metric,
            turns: [0.0; W],
        }
    }

    /// Linearises a task at the spot; `restores` asks for the least change from there instead of from the
    /// tracked angles.
    pub(super) fn linearise(
        &mut self,
        task: &Task,
        spot: &Spot,
        levers: &[Levers],
        restores: bool,
        damping: f32,
    ) {
        let joints = self.joints;
        if !restores {
            let wanted: Wide<W> = padded(&task.wanted[..joints]);
            for j in 0..joints {
                self.slope[j] = self.q[j] - wanted[j];
            }
        }
        let largest = self.add_goals(task, levers);
        self.goal_lines = self.lines.len();
        if damping >= DAMPING_RAISED {
            self.metric.damp(f64::from(damping), joints);
        }
        for line in &mut self.lines {
            line.added =
                line.softness + f64::from(damping) * largest + f64::from(f32::MIN_POSITIVE);
        }
        self.add_cones(task, spot);
        if self.metric.is_unit() {
            for j in 0..joints {
                self.turns[j] = -self.slope[j];
            }
        } else {
            self.factor = Factor::new(&self.metric, &[true; W], joints);
        }
        self.choose();
    }

    /// Adds rows for hard goals, and soft ones to the cost; the largest stiffness of a hard one.
    fn add_goals(&mut self, task: &Task, levers: &[Levers]) -> f64 {
        let mut largest = 0.0;
        let points = task.used_goals().chunk_by(Goal::is_beside);
        for (beside, levers) in points.zip(levers) {
            for goal in beside {
                let row = widened(&goal.row(levers));
                let above_m = goal.normal.dot(levers.at) - goal.height_m;
                if goal.is_spring() {
                    let stiffness = 1.0 / goal.softness;
                    self.metric
                        .add_square(&row, f64::from(stiffness), self.joints);
                    for j in 0..W {
                        self.slope[j] += row[j] * f64::from(above_m * stiffness);
                    }
                    continue;
                }
                let softness = if goal.is_hard() { 0.0 } else { goal.softness };
                let mut line =
                    Line::new(row, -f64::from(above_m), goal.is_exact, f64::from(softness));
                if line.stiffness < UNMOVED && !goal.is_exact {
                    line.need = f64::NEG_INFINITY;
                }
                if goal.is_hard() {
                    largest = math::max_f64(line.stiffness, largest);
                }
                self.lines.push(line);
            }
        }
        largest
    }

    fn add_cones(&mut self, task: &Task, spot: &Spot) {
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
                let mut line = Line::new(row, -f64::from(normal.dot(limb)), false, 0.0);
                line.added = CONE_DAMPING * line.stiffness + f64::from(f32::MIN_POSITIVE);
                self.lines.push(line);
            }
        }
    }

    /// Solves again with second derivatives, where they matter: with those of the Lagrangian, and then as
    /// much more is asked for as the goals bend away from their tangents. With `along`, those of each joint
    /// alone are taken. With `climbs`, a way up is looked for where there is more of them than the change of the
    /// angles bears. Whether the turns found are those of a Newton step.
    pub(super) fn bend(
        &mut self,
        task: &Task,
        posture: &Posture,
        levers: &[Levers],
        along: bool,
        climbs: bool,
    ) -> bool {
        let mut is_newton = true;
        let straight = self.metric.clone();
        for leads in [false, true] {
            let Bent {
                torques,
                short_m,
                leaps,
            } = self.bent(task, posture, levers, leads);
            is_newton &= !leaps;
            let is_straight = short_m <= BEND_MIN * task.tolerance_m;
            if is_straight && leads {
                return is_newton;
            }
            let curvature = Metric::curved(&torques, posture);
            if is_straight && curvature.largest() <= CURVED_MIN {
                return is_newton;
            }
            if climbs && !self.bears(&straight, &curvature) {
                let part = f64::from(self.turned().1);
                if self.climb(task, &straight, &curvature, part) {
                    return false;
                }
            }
            is_newton &= self.curve(&straight, &curvature, along);
            self.solve(task);
            if !self.lines.iter().any(|line| line.presses) {
                break;
            }
        }
        is_newton
    }

    /// How goals bend on the way found. With `leads`, hard ones are asked for as much more as they do.
    fn bent(&mut self, task: &Task, posture: &Posture, levers: &[Levers], leads: bool) -> Bent {
        let (turned, part) = self.turned();
        let mut bent = Bent {
            torques: [Vec3::ZERO; CHAIN_HINGES_MAX],
            short_m: 0.0,
            leaps: false,
        };
        let is_far = part * self.widest() > LEAP_MIN;
        let mut lines = self.lines.iter_mut();
        let points = task.used_goals().chunk_by(Goal::is_beside);
        for (beside, levers) in points.zip(levers) {
            let mut aside = None;
            let mut pull = Vec3::ZERO;
            for goal in beside {
                if goal.is_spring() {
                    bent.leaps |= is_far;
                    if !is_far {
                        let at = levers.at + levers.along(&turned);
                        pull +=
                            goal.normal * ((goal.normal.dot(at) - goal.height_m) / goal.softness);
                    }
                    continue;
                }
                let Some(line) = lines.next().filter(|line| line.presses) else {
                    continue;
                };
                let aside = aside.get_or_insert_with(|| levers.aside(posture, &turned));
                let short_m = -goal.normal.dot(*aside);
                bent.short_m = math::max(short_m.abs(), bent.short_m);
                pull -= goal.normal * (part * line.force as f32);
                if leads && line.softness == 0.0 {
                    let gain = product(&line.row, &widened(&turned));
                    let share = lead((f64::from(short_m) / gain) as f32);
                    line.need += gain * f64::from((share - 1.0) / part);
                }
            }
            if pull != Vec3::ZERO {
                for (torque, by) in bent.torques.iter_mut().zip(levers.by()) {
                    *torque += by.cross(pull);
                }
            }
        }
        bent
    }

    /// Whether the change of the angles has more curvature in every direction, limits or not.
    fn bears(&self, straight: &Metric<W>, bent: &Metric<W>) -> bool {
        if straight.is_unit() && bent.most(self.joints) <= 1.0 - PIVOT_MIN {
            return true;
        }
        let whole = straight.with(bent, 1.0, self.joints);
        Factor::new(&whole, &[true; W], self.joints).least_pivot() >= PIVOT_MIN
    }

    /// Takes curvature into the metric, `along` each joint alone or with all that joints do to each other;
    /// whether all of it was taken.
    fn curve(&mut self, straight: &Metric<W>, bent: &Metric<W>, along: bool) -> bool {
        if !along {
            let whole = straight.with(bent, 1.0, self.joints);
            let factor = Factor::new(&whole, &[true; W], self.joints);
            if factor.least_pivot() >= PIVOT_MIN {
                self.factor = factor.among(&whole, self.factor.free());
                self.metric = whole;
                return true;
            }
        }
        self.metric = straight.clone();
        self.metric.hold(bent, along, self.joints);
        self.factor = Factor::new(&self.metric, self.factor.free(), self.joints);
        false
    }

    pub(super) fn widest(&self) -> f32 {
        let turns = self.turns.iter().map(|turn| turn.abs());
        turns.fold(0.0, math::max_f64) as f32
    }

    /// The turns found, no longer than a step may be, and which part of them that is.
    fn turned(&self) -> (Row, f32) {
        let mut turned = [0.0; CHAIN_HINGES_MAX];
        for (slot, &turn) in turned.iter_mut().zip(&self.turns) {
            *slot = turn as f32;
        }
        let widest = self.widest();
        let part = if widest > TURN_MAX {
            TURN_MAX / widest
        } else {
            1.0
        };
        (turned.map(|turn| turn * part), part)
    }

    /// The angles found.
    pub(super) fn angles(&self) -> Angles {
        let found = self.q.iter().zip(&self.turns);
        found
            .take(self.joints)
            .map(|(q, turn)| (q + turn) as f32)
            .collect()
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
            let short = line.need - product(&line.row, &self.turns);
            let pressed = (line.stiffness - line.softness) * line.force + short;
            let presses = line.is_exact || pressed > 0.0;
            changed |= presses != line.presses;
            line.presses = presses;
        }
        changed
    }

    pub(super) fn solve(&mut self, task: &Task) {
        for _ in 0..BLOCK_PASSES {
            self.balance();
            if !self.change_all(task) {
                return;
            }
        }
        self.release();
        for _ in BLOCK_PASSES..PASSES_MAX {
            self.balance();
            if !self.change_worst(task) {
                return;
            }
        }
        for (index, hinge) in task.hinges.iter().enumerate().take(self.joints) {
            self.turns[index] = kept(hinge, self.q[index], self.turns[index]);
        }
    }

    /// Changes all rows and joints that are wrong; whether there were any.
    fn change_all(&mut self, task: &Task) -> bool {
        let pulled = self.pulled();
        let mut free = *self.factor.free();
        for (index, hinge) in task.hinges.iter().enumerate().take(self.joints) {
            self.turns[index] = kept(hinge, self.q[index], pulled[index]);
            free[index] = self.turns[index] == pulled[index];
        }
        let mut changed = self.choose();
        if free != *self.factor.free() {
            changed = true;
            self.factor = Factor::new(&self.metric, &free, self.joints);
        }
        changed
    }

    /// Lets go of all joints, and of all rows but the exact ones.
    fn release(&mut self) {
        for line in &mut self.lines {
            line.presses = line.is_exact;
        }
        self.factor = Factor::new(&self.metric, &[true; W], self.joints);
    }

    /// Changes the row or joint that is wrong by most; whether any is.
    fn change_worst(&mut self, task: &Task) -> bool {
        let pulled = self.pulled();
        let mut free = *self.factor.free();
        let (mut most, mut joint) = (WRONG_MIN, None);
        for (index, hinge) in task.hinges.iter().enumerate().take(self.joints) {
            let to = kept(hinge, self.q[index], pulled[index]);
            let wrong = if free[index] {
                (pulled[index] - to).abs()
            } else if to == pulled[index] {
                (to - self.turns[index]).abs()
            } else {
                0.0
            };
            if wrong > most {
                (most, joint) = (wrong, Some((index, to)));
            }
        }
        let mut row = None;
        for line in &mut self.lines {
            let wrong = line.wrong(&self.turns);
            if wrong > most {
                (most, row) = (wrong, Some(line));
            }
        }
        if let Some(line) = row {
            line.presses = !line.presses;
        } else if let Some((index, to)) = joint {
            self.turns[index] = to;
            free[index] = !free[index];
            self.factor = Factor::new(&self.metric, &free, self.joints);
        } else {
            return false;
        }
        true
    }

    /// Where the forces pull joints that have no limits.
    fn pulled(&self) -> Wide<W> {
        let mut pulled = self.turns;
        let free = self.factor.free();
        if free[..self.joints].iter().all(|&is_free| is_free) {
            return pulled;
        }
        for joint in (0..self.joints).filter(|&joint| !free[joint]) {
            let mut push = -self.slope[joint] - self.metric.row_times(joint, &self.turns);
            for line in self.lines.iter().filter(|line| line.presses) {
                push += line.row[joint] * line.force;
            }
            pulled[joint] += push / self.metric.diagonal(joint);
        }
        pulled
    }

    /// The forces with which the pressing rows hold and what they turn, the joints that are not free staying
    /// where they are.
    fn balance(&mut self) {
        let pressing: Rows<usize> = (0..self.lines.len())
            .filter(|&index| self.lines[index].presses)
            .collect();
        // Few rows press as a rule: no more of the matrix is cleared than is used.
        match pressing.len() {
            0..=4 => self.balance_few::<4>(&pressing),
            5..=8 => self.balance_few::<8>(&pressing),
            9..=12 => self.balance_few::<12>(&pressing),
            _ => self.balance_few::<ROWS_MAX>(&pressing),
        }
    }

    /// The same for at most `N` pressing rows.
    fn balance_few<const N: usize>(&mut self, pressing: &[usize]) {
        self.turns = self.factor.downhill(&self.metric, &self.slope, &self.turns);
        let mut moved = [[0.0_f64; W]; N];
        let mut matrix = [[0.0_f64; N]; N];
        let mut right = [0.0_f64; N];
        for (i, &index) in pressing.iter().enumerate() {
            let line = &self.lines[index];
            right[i] = line.need - product(&line.row, &self.turns);
            moved[i] = self.factor.solved(&line.row);
            for (j, &other) in pressing.iter().enumerate().take(i + 1) {
                matrix[i][j] = product(&moved[i], &self.lines[other].row);
                matrix[j][i] = matrix[i][j];
            }
            matrix[i][i] += line.added;
        }
        solve_symmetric(&mut matrix, &mut right, pressing.len());
        for line in &mut self.lines {
            line.force = 0.0;
        }
        for (i, &index) in pressing.iter().enumerate() {
            self.lines[index].force = right[i];
            for j in 0..W {
                self.turns[j] += moved[i][j] * right[i];
            }
        }
    }
}

/// Damping of a cone's rows, as a part of their own diagonal entry.
const CONE_DAMPING: f64 = 1e-6;

impl<const W: usize> Line<W> {
    fn new(row: Wide<W>, need: f64, is_exact: bool, softness: f64) -> Self {
        Self {
            row,
            need,
            is_exact,
            softness,
            stiffness: product(&row, &row) + softness,
            added: 0.0,
            force: 0.0,
            presses: is_exact,
        }
    }

    /// By how much it pulls instead of pressing, or falls short without pressing, in radians; nothing or
    /// less where it is right.
    fn wrong(&self, turns: &Wide<W>) -> f64 {
        let size = math::sqrt_f64(math::max_f64(self.stiffness, f64::from(f32::MIN_POSITIVE)));
        if self.is_exact {
            0.0
        } else if self.presses {
            -self.force * size
        } else {
            (self.need - product(&self.row, turns)) / size
        }
    }
}

fn padded<const W: usize>(angles: &[f32]) -> Wide<W> {
    let mut row = [0.0; W];
    for (slot, &angle) in row.iter_mut().zip(angles) {
        *slot = f64::from(angle);
    }
    row
}

/// [`Hinge::kept`] in f64, for a turn from an angle.
pub(super) fn kept(hinge: &Hinge, from: f64, turn: f64) -> f64 {
    let (low, high) = (
        f64::from(hinge.low_rad) - from,
        f64::from(hinge.high_rad) - from,
    );
    if turn > high {
        high
    } else if turn >= low {
        turn
    } else {
        low
    }
}

fn widened<const W: usize>(row: &Row) -> Wide<W> {
    core::array::from_fn(|joint| f64::from(row[joint]))
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
