//! Driven bodies with balls that loose objects stop on their way: between two postures whose limbs are within
//! their reach cones, the angles pass through others.

use super::{followers, pays_for_pairs, purses};
use crate::frame::{FrameReport, Spending};
use crate::state::State;
use crate::state::bodies::{BodyKind, DrivenReport};
use crate::state::chains::has_chains;
use crate::state::purse::Purse;
use crate::state::ways::{Position, driven_at};
use crate::{contacts, pairs, reach};

/// In how many steps a stopped body looks back along its way for a place to stop.
const STEPS_BACK: u32 = 16;

/// Has bodies that loose objects stopped stop where every ball is within its cone.
///
/// The balls are taken into their cones where the body stopped, if it is clear of everything then. Else it stops
/// earlier on its way, where no loose body followed it, or where its leg began when there is no such place: what
/// followed it there steps back ([`followers`]). Where that cannot, or without units to look for such a place, it stays
/// where it stopped, reports that it was cut, and comes back into its cones when it moves on: there is no overlap.
/// Spends units of the advance, and when those run out what `spare` has.
pub(crate) fn stop_within_cones(
    state: &mut State,
    spending: &Spending,
    mut spare: Option<&mut Purse>,
    report: &mut FrameReport,
) {
    for body in 0..state.registers.body_slots as usize {
        let stop = state.legs.stop_time[body];
        let goes = state.bodies.kind[body] == BodyKind::Driven.code() && state.legs.count[body] > 0;
        if !goes || stop <= 0.0 || stop >= 1.0 || !has_chains(state, body) {
            continue;
        }
        let at = driven_at(state.legs.of(body), &state.bodies.pose[body], stop);
        if !reach::are_within_cones(state, body, at.leg, at.share) {
            let mut purses = purses(spending, report);
            let mut stopped = stop_clear(state, body, &at, &mut purses.units);
            let mut is_cut = purses.units.is_closed();
            if let Some(spare) = spare.as_deref_mut()
                && !stopped
                && is_cut
            {
                stopped = stop_clear(state, body, &at, spare);
                is_cut = spare.is_closed();
            }
            let mut flags = 0;
            let begun = state.legs.of(body)[at.leg].at(at.leg, 0.0);
            if !stopped && !is_cut && followers::step_back(state, body, &begun, &mut purses.units) {
                stop_at(state, body, &at, 0.0);
            } else if !stopped {
                flags = DrivenReport::CUT;
                state.bodies.report[body].flags |= flags;
            }
            purses.book(flags, report);
        }
    }
}

/// Stops a body where its balls are within their cones and it is clear; false when no such place was found.
fn stop_clear(state: &mut State, body: usize, at: &Position, purse: &mut Purse) -> bool {
    if bend(state, body, at, purse) {
        return true;
    }
    let share = step_back(state, body, at, purse);
    if let Some(share) = share {
        stop_at(state, body, at, share);
    }
    share.is_some()
}

/// Takes the balls of a body into their cones where it is on its way; false when it is not clear then, or the
/// units ran out.
fn bend(state: &mut State, body: usize, at: &Position, purse: &mut Purse) -> bool {
    let bent = Position {
        leg: at.leg + 1,
        share: 0.0,
        ..*at
    };
    let clear = reach::bend_into_cones(state, body, at, bent.leg)
        && pays_for_pairs(state, body, purse)
        && is_clear_of_all(state, body, &bent, purse);
    if clear {
        reach::copy_posture(state, body, bent.leg, at.leg);
    }
    clear
}

/// Whether a body is clear of everything at a place; false, too, when there are no units to tell.
fn is_clear_of_all(state: &mut State, body: usize, at: &Position, purse: &mut Purse) -> bool {
    let Ok(pairs) = pairs::collect_driven(state, body, &at.still()) else {
        return false;
    };
    contacts::is_clear(state, pairs, at, purse) == Some(true)
        && contacts::is_clear_of_itself(state, pairs, at, purse)
        && contacts::is_clear_of_loose(state, body, at, purse)
}

/// The largest of some shares of the leg before a place at which every ball is within its cone and nothing loose
/// is in the way; `None` when there is none.
fn step_back(state: &State, body: usize, at: &Position, purse: &mut Purse) -> Option<f32> {
    let legs = state.legs.of(body);
    let shares = (1..STEPS_BACK).rev();
    shares
        .map(|step| at.share * (step as f32 / STEPS_BACK as f32))
        .find(|&share| {
            let place = legs[at.leg].at(at.leg, share);
            reach::are_within_cones(state, body, at.leg, share)
                && contacts::is_clear_of_loose(state, body, &place, purse)
        })
}

/// Has a body stop at a share of the leg on which it was stopped.
fn stop_at(state: &mut State, body: usize, at: &Position, share: f32) {
    let legs = state.legs.of(body);
    let before = at.leg.checked_sub(1);
    let begun = before.map_or(0.0, |before| legs[before].end_time);
    let leg = &legs[at.leg];
    let part = share / leg.reached;
    state.legs.stop_time[body] = begun + (leg.end_time - begun) * part;
}
