//! Driven bodies that give way: to what cannot get out of theirs, first with their coupling's mass, then with all
//! their pieces held, and in the end they stop.

use glam::Vec3;

use super::respond::problem;
use super::sweep::{prescribed, root_velocity};
use super::{Stretch, gather};
use crate::limits::{STEP_MIN_M, WEDGED_M};
use crate::math;
use crate::state::State;
use crate::state::bodies::{BodyKind, Coupling};
use crate::state::islands::{GiveWay, Members};
use crate::state::rows::{Mover, Row};
pub(super) fn is_driven(state: &State, body: u32) -> bool {
    state.bodies.kind[body as usize] == BodyKind::Driven.code()
}

/// Whether driven bodies are among those of an island.
pub(super) fn has_driven(state: &State, island: usize) -> bool {
    Members::of(state, island).any(|body| is_driven(state, body as u32))
}

/// Starts the frame with what was found in the last one: who gave way does so again.
pub(super) fn begin_giving(state: &mut State, stretch: &Stretch) {
    let mut next = Some(stretch.island as usize);
    while let Some(body) = next {
        next = state.islands.next[body].checked_sub(1).map(|n| n as usize);
        let light = state.bodies.coupling[body].push == Coupling::PUSH_WITH_MASS;
        let yielding = &mut state.bodies.yielding[body];
        if light {
            yielding.level = yielding.level.max(1);
        }
        state.islands.gives[body] = GiveWay {
            holds: u32::from(yielding.level == 2),
            ..GiveWay::default()
        };
    }
}

/// Whether a driven body takes part with a mass in this stretch.
pub(super) fn gives(state: &State, body: u32, stretch: &Stretch) -> bool {
    stretch.is_first
        && is_driven(state, body)
        && state.bodies.yielding[body as usize].level > 0
        && state.legs.stop_time[body as usize] > stretch.from
}

/// Has driven bodies give way, or stop; false when all that push have. What stands still leaves every
/// object a way to be.
pub(super) fn step_back(state: &mut State, rows: usize, stretch: &Stretch) -> bool {
    (stretch.is_first && raise(state, rows)) || stop(state, rows, stretch)
}

/// Whether a contact would close by more than a driven body's gap can take.
pub(super) fn is_wedged(state: &mut State, rows: usize, stretch: &Stretch) -> bool {
    let driven = has_driven(state, stretch.island as usize);
    let closing = WEDGED_M / stretch.seconds();
    driven && problem(state, rows, stretch).worst_approach(gather::is_closed) > closing
}

/// Has the driven bodies that push give way further; false when none can.
fn raise(state: &mut State, rows: usize) -> bool {
    let mut raised = false;
    let lowest = lowest_level(state, rows);
    for index in 0..rows {
        let row = state.rows.rows[index];
        let body = row.body_b as usize;
        if is_driven(state, row.body_b)
            && row.impulse + row.struck != Vec3::ZERO
            && state.bodies.yielding[body].level == lowest
            && lowest < 2
        {
            state.bodies.yielding[body].level = lowest + 1;
            state.islands.gives[body].holds = u32::from(lowest + 1 == 2);
            raised = true;
        }
    }
    raised
}

/// Stops the driven bodies that push; false when all are.
fn stop(state: &mut State, rows: usize, stretch: &Stretch) -> bool {
    let mut stopped = false;
    for index in 0..rows {
        let row = state.rows.rows[index];
        let body = row.body_b as usize;
        if is_driven(state, row.body_b)
            && row.impulse + row.struck != Vec3::ZERO
            && state.legs.stop_time[body] > stretch.from
        {
            state.legs.stop_time[body] = stretch.from;
            stopped = true;
        }
    }
    stopped
}

fn lowest_level(state: &State, rows: usize) -> u32 {
    let mut lowest = 2;
    for row in &state.rows.rows[..rows] {
        if is_driven(state, row.body_b) && row.impulse + row.struck != Vec3::ZERO {
            lowest = lowest.min(state.bodies.yielding[row.body_b as usize].level);
        }
    }
    lowest
}

/// Notes how driven bodies gave way, and who is to start the next frame so.
pub(super) fn give_way(state: &mut State, rows: usize, stretch: &Stretch) {
    let mut next = Some(stretch.island as usize);
    while let Some(body) = next {
        next = state.islands.next[body].checked_sub(1).map(|n| n as usize);
        if !gives(state, body as u32, stretch) {
            continue;
        }
        let change = Some(state.rows.movers[body].velocity).filter(|change| change.is_finite());
        let change = change.unwrap_or_default();
        state.rows.movers[body] = Mover::default();
        state.rows.begun[body] = Mover::default();
        let holds = state.islands.gives[body].holds;
        let planned = planned(state, body, stretch);
        let moves = math::length(change) * stretch.dt_s > 0.5 * STEP_MIN_M;
        state.islands.gives[body] = GiveWay {
            replans: if holds == 1 || moves || state.legs.count[body] == 0 {
                GiveWay::ASKED
            } else {
                0
            },
            holds,
            way: (planned + change) * stretch.dt_s,
        };
        let (pushed, pressed) = pressure(state, rows, body);
        // Along what pushes it: the rest of its way is not in question.
        let yields = -change.dot(pushed) > YIELDS_FROM * planned.dot(pushed);
        let pushed = pushed != Vec3::ZERO;
        state.bodies.yielding[body].level = match (pushed, pressed, yields) {
            (false, ..) => 0,
            (true, true, _) => 2,
            (true, false, true) => 1,
            (true, false, false) => 0,
        };
    }
}

/// A body that gives way by less than this part of what it wanted is let push without lag again.
const YIELDS_FROM: f32 = 0.2;

/// The normal impulses of a driven body on what it touches, and whether its held pieces press.
fn pressure(state: &State, rows: usize, body: usize) -> (Vec3, bool) {
    let (mut pushed, mut pressed) = (Vec3::ZERO, false);
    for row in &state.rows.rows[..rows] {
        if row.body_b as usize == body {
            pushed += row.normal * row.impulse.dot(row.normal);
            pressed |= row.least > 0.0;
        }
    }
    (pushed, pressed)
}

/// The velocity at a contact that a giving body's way prescribes, which the impacts of the event did not
/// see.
pub(super) fn planned_at(state: &State, row: &Row, stretch: &Stretch) -> Vec3 {
    let body = row.body_b as usize;
    if state.islands.gives[body].holds == 1 || state.legs.count[body] == 0 {
        return planned(state, body, stretch);
    }
    let piece = state.islands.pairs[row.pair as usize].b as usize;
    prescribed(state, piece, row.point, false, stretch)
}

/// The mean velocity of a driven body's root on its way through the frame; of one that has no way, because
/// it was found settled, where its coupling wants it.
fn planned(state: &State, body: usize, stretch: &Stretch) -> Vec3 {
    if state.legs.count[body] > 0 {
        return root_velocity(state, body, stretch);
    }
    let (wanted, here) = (state.legs.wanted[body], state.bodies.pose[body]);
    (wanted.translation() - here.translation()) / stretch.dt_s
}
