//! Rest on a patch: a loose body that lies on three or more contacts of one pair and on nothing else.
//!
//! Impulses one contact at a time converge slowly when the contacts are close together compared with
//! the body: a polyhedral ball on a table rocks from corner to corner for ever. So the impulse that
//! stops the body altogether is tried first. It is one that the patch can give when it pushes, when
//! Coulomb's cone holds it, and when its centre of pressure lies inside the patch (Featherstone 2008,
//! "Rigid Body Dynamics Algorithms", section 11; Vukobratovic's zero moment point).

use glam::Vec3;

use super::solver::Problem;
use crate::limits::MANIFOLD_CONTACTS_MAX;
use crate::math;
use crate::state::rows::{Mover, Row};

/// Stops every body that a patch on something that stands still can stop; how many impulses that took.
pub(super) fn run(problem: &mut Problem) -> u32 {
    let mut impulses = 0;
    let mut first = 0;
    while first < problem.rows.len() {
        let mut end = first + 1;
        while end < problem.rows.len() && problem.rows[end].manifold as usize == first {
            end += 1;
        }
        if end - first >= 3 && can_rest(problem, first, end) {
            stop(problem, first, end);
            impulses += 1;
        }
        first = end;
    }
    impulses
}

/// Whether the patch of the rows from `first` to `end` can stop its body.
fn can_rest(problem: &Problem, first: usize, end: usize) -> bool {
    let patch = &problem.rows[first..end];
    let body = patch[0].body_a as usize;
    let closed = patch
        .iter()
        .all(|row| is_closed(row, problem.tolerance) && row.prescribed == Vec3::ZERO);
    closed
        && problem.movers[body].is_movable()
        && !problem.movers[patch[0].body_b as usize].is_movable()
        && lies_alone(problem, body, first)
        && is_within_cone(&problem.movers[body], patch)
}

/// Whether a contact is to stay as it is, but for what it was let come back.
fn is_closed(row: &Row, tolerance: f32) -> bool {
    row.target <= 0.0 && row.target >= -10.0 * tolerance && row.least == 0.0
}

/// Whether all rows of a body belong to one manifold.
fn lies_alone(problem: &Problem, body: usize, manifold: usize) -> bool {
    let mut next = problem.first[body];
    while let Some(index) = next.checked_sub(1) {
        let row = &problem.rows[index as usize];
        if row.manifold as usize != manifold {
            return false;
        }
        next = if row.body_a as usize == body {
            row.next_a
        } else {
            row.next_b
        };
    }
    true
}

/// With P the impulse and L the angular impulse about the centre of mass that stop the body, h the
/// centre's height over the patch and n the normal: the centre of pressure is n x (L + h n x P) / P_n
/// beside the centre's foot, and what is left of L about n must be held by friction.
fn is_within_cone(mover: &Mover, patch: &[Row]) -> bool {
    let n = patch[0].normal;
    let impulse = -mover.velocity / mover.inverse_mass;
    if mover.inverse_inertia.determinant() <= 0.0 {
        return false;
    }
    let turning = -(mover.inverse_inertia.inverse() * mover.spin);
    let push = impulse.dot(n);
    let slip = impulse - n * push;
    let friction = patch[0].friction * push;
    if push <= 0.0 || slip.length_squared() > friction * friction {
        return false;
    }
    // Everything as the centre of mass sees it.
    let height = -n.dot(patch[0].arm_a);
    let beside = n.cross(turning + height * n.cross(slip)) / push;
    let pressed = beside - n * height;
    let about_normal = turning.dot(n) - n.dot(beside.cross(slip));
    holds(patch, n, pressed) && about_normal.abs() <= friction * reach_m(patch)
}

/// Half the patch's width: the arm that friction has about the normal.
fn reach_m(patch: &[Row]) -> f32 {
    let mut longest = 0.0;
    for row in patch {
        longest = math::max(longest, math::length(row.arm_a - patch[0].arm_a));
    }
    0.5 * longest
}

/// Whether a point of the patch's plane is inside the hull of the contacts: on the inner side of every
/// line through two of them that has no contact on its outer side.
fn holds(patch: &[Row], n: Vec3, point: Vec3) -> bool {
    debug_assert!(patch.len() <= MANIFOLD_CONTACTS_MAX);
    let mut sides = 0;
    for a in patch {
        for b in patch {
            let inward = n.cross(b.arm_a - a.arm_a);
            let is_side = inward.length_squared() > 0.0
                && patch
                    .iter()
                    .all(|c| inward.dot(c.arm_a - a.arm_a) >= -1e-6 * inward.length_squared());
            if is_side {
                sides += 1;
                if inward.dot(point - a.arm_a) < 0.0 {
                    return false;
                }
            }
        }
    }
    sides >= 3
}

fn stop(problem: &mut Problem, first: usize, end: usize) {
    let mover = &mut problem.movers[problem.rows[first].body_a as usize];
    let push = -mover.velocity / mover.inverse_mass;
    mover.velocity = Vec3::ZERO;
    mover.spin = Vec3::ZERO;
    let share = push / (end - first) as f32;
    for row in &mut problem.rows[first..end] {
        row.impulse = share;
    }
}
