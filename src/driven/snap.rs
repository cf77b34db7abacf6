//! Detached bodies that jump to their trackers.

use super::{Walk, look_along, push_leg};
use crate::state::State;
use crate::state::bodies::{Coupling, Displacement};
use crate::state::loose;
use crate::state::purse::Purse;
use crate::state::ways::Position;
use crate::{contacts, math};

/// Puts a detached body at its tracker, or near it, when its coupling says so and nothing is in the way there, nor may
/// come there within the frame: a body that is put somewhere cannot be stopped on its way. Whether it did.
pub(super) fn snap(state: &mut State, body: usize, dt_s: f32, purse: &mut Purse) -> bool {
    let coupling = state.bodies.coupling[body];
    let away = math::length(state.bodies.displacement[body].offset);
    if coupling.snap == Coupling::SNAP_NEVER || away <= coupling.divergence_m {
        return false;
    }
    // Every other turn of a body that waits goes without the look there, which may always be too much.
    if state.bodies.waiting[body].turns % 2 == 1 {
        return false;
    }
    let Some(place) = free_place(state, body, &coupling, purse) else {
        return false;
    };
    if loose::may_come(state, &state.legs.whole[body], dt_s) {
        return false;
    }
    let target = state.bodies.tracker[body].target;
    state.bodies.displacement[body] = Displacement::default();
    state.legs.wanted[body] = target;
    let here = Position {
        share: 0.0,
        ..place
    };
    push_leg(state, body, &here, &place, 1.0, 1.0);
    true
}

/// Where nothing touches a body, as its tracker has it; `None` when there is no such place that its coupling allows, or
/// the units ran out.
#[cold]
fn free_place(
    state: &mut State,
    body: usize,
    coupling: &Coupling,
    purse: &mut Purse,
) -> Option<Position> {
    let target = Position {
        root: state.bodies.tracker[body].target,
        local: 1.0,
        leg: 0,
        share: 1.0,
    };
    let pairs = look_along(state, body, &target, &target).ok()?;
    if !contacts::measure_touching(state, pairs, &target, purse) {
        return None;
    }
    if !contacts::touches_any(state, pairs) {
        return Some(target);
    }
    // No place is nearer than the deepest piece is deep.
    let near_m = NEAR_SHARE * coupling.divergence_m;
    if coupling.snap != Coupling::SNAP_NEAR || contacts::depth_m(state, pairs) > near_m {
        return None;
    }
    let mut walk = Walk::new(body, target, target, pairs);
    let root = walk.way_out(state, purse).ok()??;
    let aside = root.translation() - target.root.translation();
    let place = Position { root, ..target };
    let free = math::length(aside) <= near_m
        && contacts::is_clear_of_itself(state, walk.pairs, &place, purse);
    free.then_some(place)
}

/// How far from its tracker a body may snap to, as a part of the distance at which it is detached: it is not to be
/// detached again at once.
const NEAR_SHARE: f32 = 0.5;
