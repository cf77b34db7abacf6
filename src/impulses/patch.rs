//! Rest on a patch: a loose body that lies on three or more contacts of one pair.
//!
//! Impulses one contact at a time converge slowly when the contacts are close together compared with
//! the body: a polyhedral ball on a table rocks from corner to corner for ever. So the impulse that
//! stops the body altogether is tried first. It is one that the patch can give when it pushes, when
//! Coulomb's cone holds it, and when its centre of pressure lies inside the patch (Featherstone 2008,
//! "Rigid Body Dynamics Algorithms", section 11; Vukobratovic's zero moment point).

use glam::Vec3;

use super::movers::{centre_pose, is_stopped};
use super::solve::push_together;
use crate::limits::MANIFOLD_CONTACTS_MAX;
use crate::math;
use crate::state::State;
use crate::state::bodies::BodyKind;
use crate::state::contacts::Constraint;

/// Stops every dynamic body that a patch on something that stands still can stop, and gives the other
/// patches their first impulse as a whole; how many impulses that took.
pub(super) fn run(state: &mut State, constraints: usize) -> u32 {
    let mut impulses = 0;
    let mut first = 0;
    while first < constraints {
        let pair = state.pairs.constraints[first].pair;
        let mut end = first + 1;
        while end < constraints && state.pairs.constraints[end].pair == pair {
            end += 1;
        }
        if end - first >= 3 && can_rest(state, first, end) {
            stop(state, first, end);
            impulses += 1;
        } else if end - first >= 2 {
            impulses += u32::from(push_together(state, first, end));
        }
        first = end;
    }
    impulses
}

/// Whether the patch of the constraints from `first` to `end` can stop its body.
fn can_rest(state: &State, first: usize, end: usize) -> bool {
    let patch = &state.pairs.constraints[first..end];
    let body = patch[0].body_a as usize;
    let closed = patch
        .iter()
        .all(|c| c.target == 0.0 && c.prescribed_a == Vec3::ZERO && c.prescribed_b == Vec3::ZERO);
    closed
        && is_movable(state, body)
        && !is_movable(state, patch[0].body_b as usize)
        && is_within_cone(state, body, patch)
}

fn is_movable(state: &State, body: usize) -> bool {
    state.bodies.kind[body] == BodyKind::Dynamic.code()
        && !is_stopped(state, body, 1.0 - f32::EPSILON)
}

/// With P the impulse and L the angular impulse about the centre of mass that stop the body, h the
/// centre's height over the patch and n the normal: the centre of pressure is n x (L + h n x P) / P_n
/// beside the centre's foot, and what is left of L about n must be held by friction.
fn is_within_cone(state: &State, body: usize, patch: &[Constraint]) -> bool {
    let n = patch[0].normal;
    let mass = &state.bodies.mass[body];
    let momentum = &state.bodies.momentum[body];
    let impulse = -momentum.velocity * mass.mass_kg;
    let turning = -momentum.angular;
    let push = impulse.dot(n);
    let slip = impulse - n * push;
    let friction = patch[0].friction * push;
    if push <= 0.0 || slip.length_squared() > friction * friction {
        return false;
    }
    let centre = centre_pose(state, body).translation();
    let height = n.dot(centre - patch[0].point);
    let beside = n.cross(turning + height * n.cross(slip)) / push;
    let pressed = centre - n * height + beside;
    let about_normal = turning.dot(n) - n.dot(beside.cross(slip));
    holds(patch, n, pressed) && about_normal.abs() <= friction * reach_m(patch)
}

/// Half the patch's width: the arm that friction has about the normal.
fn reach_m(patch: &[Constraint]) -> f32 {
    let mut longest = 0.0;
    for contact in patch {
        longest = math::max(longest, math::length(contact.point - patch[0].point));
    }
    0.5 * longest
}

/// Whether a point of the patch's plane is inside the hull of the contacts: on the inner side of every
/// line through two of them that has no contact on its outer side.
fn holds(patch: &[Constraint], n: Vec3, point: Vec3) -> bool {
    debug_assert!(patch.len() <= MANIFOLD_CONTACTS_MAX);
    let mut sides = 0;
    for a in patch {
        for b in patch {
            let inward = n.cross(b.point - a.point);
            let is_side = inward.length_squared() > 0.0
                && patch
                    .iter()
                    .all(|c| inward.dot(c.point - a.point) >= -1e-6 * inward.length_squared());
            if is_side {
                sides += 1;
                if inward.dot(point - a.point) < 0.0 {
                    return false;
                }
            }
        }
    }
    sides >= 3
}

fn stop(state: &mut State, first: usize, end: usize) {
    let body = state.pairs.constraints[first].body_a as usize;
    let push = -state.bodies.momentum[body].velocity * state.bodies.mass[body].mass_kg;
    state.bodies.momentum[body].velocity = Vec3::ZERO;
    state.bodies.momentum[body].angular = Vec3::ZERO;
    let share = push / (end - first) as f32;
    for contact in &mut state.pairs.constraints[first..end] {
        contact.impulse = share;
    }
}
