//! Driven bodies that loose objects stopped are not where the others were told that they would be: who
//! would get into one of them stops earlier, too.
//!
//! Where the units run out before that is known, boxes decide: who may get into one of them stays where it was.

use glam::Vec3;

use super::{place_ahead, purses, stop_within_cones};
use crate::frame::{Census, FrameReport, Spending};
use crate::geometry::separation::separation;
use crate::math::Pose;
use crate::state::State;
use crate::state::bodies::{BodyKind, DrivenReport, is_body_of, is_loose_kind};
use crate::state::contacts::{box_parts, query_units};
use crate::state::islands::GiveWay;
use crate::state::loose;
use crate::state::pieces::{Bounds, PiecesOf};
use crate::state::purse::Purse;
use crate::state::ways::{comes_to, obstacle_bounds, obstacle_pose, stays};

/// How often the part of its way that a body goes is halved until it is clear there.
const HALVINGS_MAX: u32 = 6;

/// How often all are looked at: who stops earlier may be in the way of others.
const ROUNDS: u32 = 2;

/// Has bodies stop where they are clear of those that were stopped. Nothing is looked at in a frame in which
/// nobody was stopped or planned anew. Spends units of the advance: one for each distance query, and parts for
/// the boxes. What is left to boxes when the units run out makes no more tests of them than the floor of a frame
/// pays for; who is not looked at by then goes as it said.
pub(crate) fn keep(state: &mut State, spending: &Spending, report: &mut FrameReport) {
    let slots = state.registers.body_slots as usize;
    if state.registers.driven < 2 || !(0..slots).any(|body| is_elsewhere(state, body)) {
        return;
    }
    for body in 0..slots {
        if is_body_of(state, body, BodyKind::Driven) {
            place(state, body);
        }
    }
    let mut purses = purses(spending, report);
    let mut stopped = stop_in_turn(state, |state, body| {
        keep_out(state, body, &mut purses.units)
    });
    let runs_out = purses.units.is_closed();
    purses.book(0, report);
    let mut tests = Tests {
        left: Census::of(state).stray_tests(),
    };
    if runs_out && stop_in_turn(state, |state, body| stay_behind(state, body, &mut tests)) {
        report.set(FrameReport::ADVANCE_CUT);
        stopped = true;
    }
    if stopped {
        stop_within_cones(state, spending, None, report);
    }
}

/// Has bodies that move stop as `stop` says, which tells whether it stopped one; whether it stopped any. Those first
/// that went as they said.
fn stop_in_turn(state: &mut State, mut stop: impl FnMut(&mut State, usize) -> bool) -> bool {
    let mut any = false;
    for _ in 0..ROUNDS {
        let before = any;
        for strays in [false, true] {
            for body in 0..state.registers.body_slots as usize {
                let is_turn = is_body_of(state, body, BodyKind::Driven)
                    && is_elsewhere(state, body) == strays
                    && comes_to(state, body).is_some();
                any |= is_turn && stop(state, body);
            }
        }
        if any == before {
            break;
        }
    }
    any
}

/// Whether a driven body may be elsewhere than where it was planned to come to when the others were.
fn is_elsewhere(state: &State, body: usize) -> bool {
    is_body_of(state, body, BodyKind::Driven)
        && (state.legs.stop_time[body] < 1.0 || state.islands.gives[body].replans == GiveWay::DONE)
}

/// Writes down where a body's pieces come to, or that they stay.
fn place(state: &mut State, body: usize) {
    let at = comes_to(state, body).unwrap_or(stays(state, body));
    place_ahead(state, body, &at);
}

/// Stops a body on its way where it is clear of others, if there is such a place; whether it was stopped. Where
/// the host made it overlap another one, it stays as it is.
fn keep_out(state: &mut State, body: usize, purse: &mut Purse) -> bool {
    if is_clear(state, body, purse, BodyKind::Driven) != Some(false) {
        return false;
    }
    let planned = state.legs.stop_time[body];
    for halvings in 1..=HALVINGS_MAX + 1 {
        state.legs.stop_time[body] = if halvings > HALVINGS_MAX {
            0.0
        } else {
            0.5 * state.legs.stop_time[body]
        };
        place(state, body);
        let stays = halvings > HALVINGS_MAX && is_disturbed(state);
        let clear = (stays || is_clear(state, body, purse, BodyKind::Driven) == Some(true))
            && is_clear(state, body, purse, BodyKind::Dynamic) == Some(true);
        if clear {
            return true;
        }
    }
    state.legs.stop_time[body] = planned;
    place(state, body);
    false
}

/// Tests of two boxes that are paid for.
struct Tests {
    left: u64,
}

impl Tests {
    /// Whether two boxes overlap; `None` when no test is left.
    fn overlap(&mut self, a: &Bounds, b: &Bounds) -> Option<bool> {
        self.left = self.left.checked_sub(1)?;
        Some(a.overlaps(b))
    }
}

/// Has a body stay where it was that may by its boxes get into another which is not where it was told; whether it
/// does.
fn stay_behind(state: &mut State, body: usize, tests: &mut Tests) -> bool {
    let stays = may_get_into_another(state, body, tests) == Some(true)
        && is_room_kept(state, body, tests) == Some(true);
    if stays {
        state.legs.stop_time[body] = 0.0;
        state.bodies.report[body].flags |= DrivenReport::CUT;
        place(state, body);
    }
    stays
}

/// Whether boxes overlap where a driven body and another one come to, one of which is not where the other was told;
/// `None` when the tests ran out.
fn may_get_into_another(state: &State, body: usize, tests: &mut Tests) -> Option<bool> {
    let strays = is_elsewhere(state, body);
    let pieces = |of: usize| PiecesOf::new(state.pieces.next, state.bodies.first_piece[of]);
    for other in 0..state.registers.body_slots as usize {
        let is_met = other != body
            && is_body_of(state, other, BodyKind::Driven)
            && (strays || is_elsewhere(state, other));
        if !is_met {
            continue;
        }
        for own in pieces(body) {
            for its in pieces(other) {
                let [a, b] = [own, its].map(|piece| &state.legs.ahead_bounds[piece]);
                if tests.overlap(a, b)? && !passes(state, own, its) {
                    return Some(true);
                }
            }
        }
    }
    Some(false)
}

/// Whether no loose body that moved may have come to where a driven one was; `None` when the tests ran out.
fn is_room_kept(state: &State, body: usize, tests: &mut Tests) -> Option<bool> {
    let own = PiecesOf::new(state.pieces.next, state.bodies.first_piece[body]);
    let whole = own.clone().fold(Bounds::EMPTY, |whole, piece| {
        whole.union(state.pieces.bounds[piece])
    });
    for piece in 0..state.registers.piece_slots as usize {
        if !is_loose_kind(state.pieces.body_kind[piece]) {
            continue;
        }
        let near = &state.islands.near[state.pieces.body[piece] as usize];
        if !tests.overlap(near, &whole)? {
            continue;
        }
        let (pose, bounds) = seat(state, piece);
        if pose == state.pieces.world[piece] {
            continue;
        }
        for own in own.clone() {
            if tests.overlap(&state.pieces.bounds[own], &bounds)? {
                return Some(false);
            }
        }
    }
    Some(true)
}

/// Whether the host made driven bodies overlap.
fn is_disturbed(state: &State) -> bool {
    let overlaps = |body: usize| state.bodies.report[body].flags & DrivenReport::OVERLAPS != 0;
    let driven = |body: &usize| is_body_of(state, *body, BodyKind::Driven);
    let slots = 0..state.registers.body_slots as usize;
    slots.filter(driven).any(overlaps)
}

/// Whether a body is clear of other driven bodies, or of loose ones; `None` when the units ran out.
fn is_clear(state: &State, body: usize, purse: &mut Purse, kind: BodyKind) -> Option<bool> {
    let others = 0..state.registers.piece_slots as usize;
    let own = || PiecesOf::new(state.pieces.next, state.bodies.first_piece[body]);
    let count = own().count();
    let whole = own().fold(Bounds::EMPTY, |whole, piece| {
        whole.union(state.legs.ahead_bounds[piece])
    });
    let is_near =
        |&other: &usize| is_met(state, body, other, kind) && seat(state, other).1.overlaps(&whole);
    if !purse.take_parts(box_parts(count + others.len())) {
        return None;
    }
    if !others.clone().any(|other| is_near(&other)) {
        return Some(true);
    }
    if !purse.take_parts(box_parts(count * others.len())) {
        return None;
    }
    for other in others.filter(is_near) {
        for piece in own() {
            if !passes(state, piece, other) && overlaps(state, piece, other, purse)? {
                return Some(false);
            }
        }
    }
    Some(true)
}

/// Whether a piece is one of those that a body is to be clear of.
fn is_met(state: &State, body: usize, other: usize, kind: BodyKind) -> bool {
    let other_kind = state.pieces.body_kind[other];
    if kind == BodyKind::Driven {
        other_kind == kind.code() && state.pieces.body[other] as usize != body
    } else {
        is_loose_kind(other_kind)
    }
}

/// Whether the host lets a driven piece pass another one.
fn passes(state: &State, piece: usize, other: usize) -> bool {
    state.pieces.body_kind[other] == BodyKind::Driven.code()
        && state.pieces.groups[piece].pass(state.pieces.groups[other])
}

fn overlaps(state: &State, piece: usize, other: usize, purse: &mut Purse) -> Option<bool> {
    let [a, b] = [piece, other].map(|piece| &state.pieces.shape[piece]);
    let (pose, bounds) = seat(state, other);
    if !state.legs.ahead_bounds[piece].overlaps(&bounds) {
        return Some(false);
    }
    if !purse.take(query_units(a, b)) {
        return None;
    }
    let [a, b] = [a, b].map(|shape| state.pools.convex(shape));
    let found = separation(&a, &b, &state.legs.ahead[piece], &pose, Vec3::ZERO);
    Some(found.gap_m < 0.0)
}

/// Where a piece is at the end of the frame, and its box.
fn seat(state: &State, piece: usize) -> (Pose, Bounds) {
    if is_loose_kind(state.pieces.body_kind[piece]) {
        let pose = loose::piece_pose(state, piece);
        return (pose, Bounds::of(&state.pieces.shape[piece], &pose));
    }
    (obstacle_pose(state, piece), obstacle_bounds(state, piece))
}
