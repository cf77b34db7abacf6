//! The order of impulses: the contact whose normal velocity is most wrong first, ties by index.

use super::solve::{push, relative_velocity};
use crate::limits::{APPROACH_MIN, IMPULSES_PER_CONTACT_MAX};
use crate::state::State;
use crate::state::purse::Purse;
use glam::Vec3;

/// Applies impulses until no contact approaches, all have had their share, or the units run out;
/// how many were applied.
///
/// Biggest error first is the best order to be cut off in. Cost: at most
/// [`IMPULSES_PER_CONTACT_MAX`] impulses a contact, one unit each.
pub(super) fn run(state: &mut State, constraints: usize, purse: &mut Purse) -> u32 {
    let mut applied = 0;
    while let Some(worst) = worst(state, constraints) {
        if !purse.take() {
            break;
        }
        applied += u32::from(push(state, worst));
    }
    applied
}

/// The contact farthest from its target velocity, among those that may still be pushed: below it, or
/// above it with an impulse to give back.
fn worst(state: &State, constraints: usize) -> Option<usize> {
    let mut worst = None;
    let mut largest = APPROACH_MIN;
    for index in 0..constraints {
        let constraint = &state.pairs.constraints[index];
        if constraint.impulses >= IMPULSES_PER_CONTACT_MAX {
            continue;
        }
        let velocity = relative_velocity(state, constraint).dot(constraint.normal);
        let missing = constraint.target - velocity;
        let pushed = constraint.impulse != Vec3::ZERO;
        let error = if pushed { missing.abs() } else { missing };
        if error > largest {
            largest = error;
            worst = Some(index);
        }
    }
    worst
}
