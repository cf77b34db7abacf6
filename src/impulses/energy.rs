//! The energy of forces: contacts take, they do not give.
//!
//! Impulses J that change the velocities v of their contacts by K J do the work J.v + J.K J / 2, the mean of their
//! power before and after, beyond what their targets ask for and what couplings press. It is positive where a sweep
//! over jammed contacts has come to no end but grows from pass to pass, or where what held up a light body under one
//! ten thousand times as heavy would throw it up. The share -J.v / J.K J of all impulses then does the least work.
//!
//! Cost: a pass over the rows when the impulses are passive, three more when they are not.

use super::solver::Problem;
use crate::math;
use crate::state::rows::Row;

/// Leaves of the impulses that `which` names, which the movers have already, the best share when they feed energy
/// in.
pub(super) fn keep_passive(problem: &mut Problem, which: fn(&Row) -> bool) {
    let (after, rounded) = power(problem, which);
    if after <= rounded {
        return;
    }
    apply(problem, which, -1.0);
    let (before, _) = power(problem, which);
    let share = if before + after <= rounded {
        1.0
    } else {
        math::clamp(-before / (after - before), 0.0, 1.0)
    };
    apply(problem, which, share);
    for row in problem.rows.iter_mut().filter(|row| which(row)) {
        row.impulse *= share;
    }
}

/// Changes the movers by a share of impulses.
pub(super) fn apply(problem: &mut Problem, which: fn(&Row) -> bool, share: f32) {
    for row in problem.rows.iter().filter(|row| which(row)) {
        let impulse = row.impulse * share;
        problem.movers[row.body_a as usize].push(row.arm_a, impulse);
        problem.movers[row.body_b as usize].push(row.arm_b, -impulse);
    }
}

/// Impulses times how fast their contacts open beyond their targets, in joules, and what of it counts as no error.
fn power(problem: &Problem, which: fn(&Row) -> bool) -> (f32, f32) {
    let (mut power, mut pushes) = (0.0, 0.0);
    for row in problem.rows.iter().filter(|row| which(row)) {
        let opens = problem.relative_velocity(row) - row.normal * row.target;
        power += (row.impulse - row.normal * row.least).dot(opens);
        pushes += math::length(row.impulse);
    }
    (power, pushes * problem.tolerance)
}
