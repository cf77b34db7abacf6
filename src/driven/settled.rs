//! Driven bodies that contact holds where they are: as long as nothing changes, a frame finds what the one
//! before found, and need not look.

use crate::limits::{LEANING_M, LEANING_RAD};
use crate::math;
use crate::state::State;
use crate::state::bodies::{BodyKind, DrivenReport, Settled, is_body_of};
use crate::state::chains::{ChainReport, chains_of, joints_of, next_chain};

/// Whether a body did not move in the last frame, is asked the same again, and nothing that it could meet
/// has moved since.
pub(super) fn is_settled(state: &State, body: usize) -> bool {
    let settled = &state.bodies.settled[body];
    settled.is_settled == 1
        && state.registers.disturbed == 0
        && is_wanted_there(state, body)
        && settled.first_contact == state.registers.contacts
        && chains_of(state, body).all(|chain| is_chain_settled(state, chain))
        && others_are_still(state, body)
}

/// Whether a body is wanted where it was when it settled. One that leans on sleepers may be wanted a hair aside while
/// its tracker is still to the bit: its coupling comes to rest later than they.
fn is_wanted_there(state: &State, body: usize) -> bool {
    let settled = &state.bodies.settled[body];
    let (before, now) = (settled.wanted, state.legs.wanted[body]);
    let leans = state.bodies.yielding[body].leans == 1;
    if before == now || !leans || settled.tracked != state.bodies.tracker[body].target {
        return before == now;
    }
    let moved = now.translation() - before.translation();
    let turned = math::nearer_sign(now.quat(), before.quat()) - before.quat();
    math::length(moved) <= LEANING_M && 4.0 * turned.length_squared() <= LEANING_RAD * LEANING_RAD
}

fn is_chain_settled(state: &State, chain: usize) -> bool {
    let same = |joint: usize| state.joints.settled[joint] == state.ways.wanted[joint];
    state.chains.tip_settled[chain] == state.ways.tip[chain] && joints_of(state, chain).all(same)
}

/// Whether no other driven body moved: those before this one in this frame, those behind it in the last.
fn others_are_still(state: &State, body: usize) -> bool {
    state.registers.driven == 1
        || (0..state.registers.body_slots as usize).all(|other| {
            other == body
                || !is_body_of(state, other, BodyKind::Driven)
                || state.bodies.settled[other].moved == 0
        })
}

/// Reports what was found when the body settled.
pub(super) fn repeat(state: &mut State, body: usize) -> u32 {
    let settled = state.bodies.settled[body];
    state.registers.contacts += settled.contacts;
    settled.flags
}

/// Notes what a frame found, for the next one.
pub(super) fn note(state: &mut State, body: usize, flags: u32) {
    let unsure = DrivenReport::CUT
        | DrivenReport::POOL_FULL
        | DrivenReport::OVERLAPS
        | DrivenReport::CONTACTS_FULL;
    let is_cut = |chain: usize| state.chains.report[chain].flags & ChainReport::CUT != 0;
    let still = state.legs.count[body] == 0;
    let is_settled = still && flags & unsure == 0 && !chains_of(state, body).any(is_cut);
    let before = state.bodies.settled[body].first_contact;
    let contacts = state.registers.contacts - before;
    let settled = &mut state.bodies.settled[body];
    settled.moved = u32::from(!still);
    settled.contacts = contacts;
    settled.is_settled = u32::from(is_settled);
    if is_settled {
        remember(state, body, flags);
    }
}

/// Notes what a settled body was asked.
pub(super) fn remember(state: &mut State, body: usize, flags: u32) {
    state.bodies.settled[body] = Settled {
        is_settled: 1,
        wanted: state.legs.wanted[body],
        tracked: state.bodies.tracker[body].target,
        moved: 0,
        flags,
        ..state.bodies.settled[body]
    };
    let mut next = state.bodies.first_chain[body];
    while let Some(chain) = next.checked_sub(1) {
        let chain = chain as usize;
        state.chains.tip_settled[chain] = state.ways.tip[chain];
        for joint in joints_of(state, chain) {
            state.joints.settled[joint] = state.ways.wanted[joint];
        }
        next = next_chain(state, chain);
    }
}
