//! Which loose and driven bodies may touch each other within a frame, and who sleeps.

use glam::Vec3;

use super::Stretch;
use super::movers::{self, centre_pose, keep_sane};
use crate::limits::{LOOSE_MARGIN_M, SLEEP_S, STILL_SPEED};
use crate::math;
use crate::state::State;
use crate::state::bodies::{BodyKind, is_body_of, is_loose};
use crate::state::islands::{Members, NONE};
use crate::state::loose::{self, reach_m, spin};
use crate::state::pieces::{Bounds, PiecesOf};
use crate::state::rows::Mover;
use crate::state::ways::{Position, comes_to, piece_pose};

/// Wakes what is about to be touched and finds the islands; false when nothing is awake.
///
/// Cost: a pass over pairs of bodies' boxes.
pub(super) fn find(state: &mut State, dt_s: f32) -> bool {
    let slots = state.registers.body_slots as usize;
    for body in 0..slots {
        state.islands.label[body] = NONE;
        state.islands.next[body] = 0;
        // What impulses do not move or what sleeps is in no island, and its columns are read all the same.
        state.rows.movers[body] = Mover::default();
        state.rows.begun[body] = Mover::default();
        state.rows.even[body] = 0;
        if is_loose(state, body) {
            state.legs.stop_time[body] = 1.0;
            state.islands.rounded[body] = Vec3::ZERO;
            state.islands.near[body] = loose::near(state, body, dt_s);
        } else if is_body_of(state, body, BodyKind::Driven) {
            state.islands.near[body] = near_driven(state, body);
        }
    }
    wake_disturbed(state);
    let mut any = false;
    for body in 0..slots {
        if is_up(state, body) {
            keep_sane(state, body);
            any |= state.bodies.momentum[body].asleep == 0;
        }
    }
    any && label(state)
}

/// Whether a loose body is awake.
fn is_up(state: &State, body: usize) -> bool {
    is_loose(state, body) && state.bodies.momentum[body].asleep == 0
}

/// A box around all that a driven body may touch in the frame.
fn near_driven(state: &State, body: usize) -> Bounds {
    if state.legs.count[body] > 0 {
        return state.legs.whole[body];
    }
    let mut own = Bounds::EMPTY;
    for piece in PiecesOf::new(state.pieces.next, state.bodies.first_piece[body]) {
        own = own.union(state.pieces.bounds[piece]);
    }
    own.grown(LOOSE_MARGIN_M)
}

/// Wakes sleeping bodies that something comes near, with those that fell asleep with them.
///
/// Cost: a test of two boxes for each sleeper and each body that is up; where nothing is, a pass over the bodies.
fn wake_disturbed(state: &mut State) {
    let slots = state.registers.body_slots as usize;
    // Scratch of the line, which is not there yet.
    let mut count = 0;
    for body in 0..slots {
        let moves = is_body_of(state, body, BodyKind::Driven) && state.legs.count[body] > 0;
        if moves || is_up(state, body) {
            state.islands.went[count] = body as u32;
            count += 1;
        }
    }
    for body in 0..slots {
        let sleeps = is_loose(state, body) && state.bodies.momentum[body].asleep == 1;
        if sleeps && is_disturbed(state, body, &state.islands.went[..count]) {
            wake_nap(state, state.bodies.momentum[body].nap, &mut count);
        }
    }
}

fn is_disturbed(state: &State, body: usize, by: &[u32]) -> bool {
    let near = &state.islands.near;
    by.iter()
        .any(|&other| near[other as usize].overlaps(&near[body]))
}

/// Wakes all that fell asleep together, and lists them among those that are up.
fn wake_nap(state: &mut State, nap: u32, count: &mut usize) {
    for body in 0..state.registers.body_slots as usize {
        let momentum = &state.bodies.momentum[body];
        if momentum.asleep == 1 && momentum.nap == nap && is_loose(state, body) {
            wake(state, body);
            state.islands.went[*count] = body as u32;
            *count += 1;
        }
    }
}

/// Wakes a body. Driven bodies that lean on sleepers look again.
fn wake(state: &mut State, body: usize) {
    let momentum = &mut state.bodies.momentum[body];
    momentum.asleep = 0;
    momentum.still_s = 0.0;
    for driven in 0..state.registers.body_slots as usize {
        if state.bodies.yielding[driven].leans == 1 {
            state.bodies.yielding[driven].leans = 0;
            state.bodies.settled[driven].is_settled = 0;
        }
    }
}

/// Labels the bodies of each island by its smallest slot and links them; whether there is one that
/// matters: dynamic bodies, or hosted ones beside driven ones.
fn label(state: &mut State) -> bool {
    let slots = state.registers.body_slots as usize;
    for body in 0..slots {
        if takes_part(state, body) {
            state.islands.label[body] = body as u32;
            for other in 0..body {
                if state.islands.label[other] != NONE && may_meet(state, body, other) {
                    unite(state, body, other);
                }
            }
        }
    }
    // Linked from behind, so that each list ascends.
    for body in (0..slots).rev() {
        let label = state.islands.label[body];
        if label != NONE && label as usize != body {
            state.islands.next[body] = state.islands.next[label as usize];
            state.islands.next[label as usize] = body as u32 + 1;
        }
    }
    true
}

fn takes_part(state: &State, body: usize) -> bool {
    is_up(state, body) || is_body_of(state, body, BodyKind::Driven)
}

fn may_meet(state: &State, body: usize, other: usize) -> bool {
    let driven = |body: usize| state.bodies.kind[body] == BodyKind::Driven.code();
    !(driven(body) && driven(other))
        && state.islands.near[body].overlaps(&state.islands.near[other])
}

/// Gives all bodies of two islands the smaller label.
fn unite(state: &mut State, a: usize, b: usize) {
    let (a, b) = (state.islands.label[a], state.islands.label[b]);
    let (kept, gone) = (a.min(b), a.max(b));
    if kept != gone {
        for label in &mut state.islands.label[..state.registers.body_slots as usize] {
            if *label == gone {
                *label = kept;
            }
        }
    }
}

/// Whether a body begins an island that the frame has to go through.
pub(super) fn begins(state: &State, body: usize) -> bool {
    if state.islands.label[body] != body as u32 {
        return false;
    }
    let (mut dynamic, mut hosted, mut driven) = (false, false, false);
    for member in Members::of(state, body) {
        let kind = state.bodies.kind[member];
        dynamic |= kind == BodyKind::Dynamic.code();
        hosted |= kind == BodyKind::Hosted.code();
        driven |= kind == BodyKind::Driven.code();
    }
    dynamic || (hosted && driven)
}

/// Counts how long an island has been still, and puts it to sleep as a whole.
pub(super) fn rest(state: &mut State, stretch: &Stretch) {
    let island = stretch.island as usize;
    let (mut still, mut rested) = (true, true);
    let mut next = Some(island);
    while let Some(body) = next {
        next = state.islands.next[body].checked_sub(1).map(|n| n as usize);
        match state.bodies.kind[body] {
            kind if kind == BodyKind::Dynamic.code() => {
                let speed = surface_speed(state, body);
                let momentum = &mut state.bodies.momentum[body];
                momentum.still_s = still_for(momentum.still_s, speed, stretch.dt_s);
                rested &= momentum.still_s >= SLEEP_S;
            }
            kind if kind == BodyKind::Driven.code() => {
                still &= has_rested(state, body, stretch) || !touches(state, body);
            }
            _ => still = false,
        }
    }
    if still && rested {
        fall_asleep(state, island);
    }
}

/// How long a loose body has been still after a frame at that speed. One that is faster than what is still loses as
/// much time as such a thing would have taken for its way: what rocks back once while it settles loses little.
fn still_for(still_s: f32, speed: f32, dt_s: f32) -> f32 {
    if speed < STILL_SPEED {
        math::min(still_s + dt_s, SLEEP_S)
    } else {
        math::max(still_s - dt_s * speed / STILL_SPEED, 0.0)
    }
}

/// Whether a driven body stays where it is: with nowhere to go, or kept from it and as slow as an object that lies
/// still for as long as that before it sleeps.
fn has_rested(state: &mut State, body: usize, stretch: &Stretch) -> bool {
    let goes_to = comes_to(state, body);
    let slow = goes_to.is_none_or(|at| is_slow(state, body, &at, STILL_SPEED * stretch.dt_s));
    let still_s = &mut state.bodies.momentum[body].still_s;
    *still_s = if slow { *still_s + stretch.dt_s } else { 0.0 };
    goes_to.is_none() && (state.legs.count[body] == 0 || *still_s >= SLEEP_S)
}

/// Whether no point of a driven body goes farther than `most_m` on its way to a place.
fn is_slow(state: &State, body: usize, at: &Position, most_m: f32) -> bool {
    let pieces = &state.pieces;
    PiecesOf::new(pieces.next, state.bodies.first_piece[body]).all(|piece| {
        let (from, to) = (pieces.world[piece], piece_pose(state, piece, at));
        let turned = math::nearer_sign(to.quat(), from.quat()) - from.quat();
        let turn = 2.0 * math::sqrt(turned.length_squared()) * pieces.shape[piece].reach;
        math::length(to.translation() - from.translation()) + turn <= most_m
    })
}

/// Whether a driven body touches a loose one.
fn touches(state: &State, body: usize) -> bool {
    state.bodies.yielding[body].level > 0 || state.bodies.yielding[body].reaction != Vec3::ZERO
}

fn fall_asleep(state: &mut State, island: usize) {
    let mut next = Some(island);
    while let Some(body) = next {
        next = state.islands.next[body].checked_sub(1).map(|n| n as usize);
        if state.bodies.kind[body] == BodyKind::Dynamic.code() {
            let momentum = &mut state.bodies.momentum[body];
            momentum.asleep = 1;
            momentum.nap = island as u32;
            momentum.velocity = Vec3::ZERO;
            momentum.angular = Vec3::ZERO;
        } else if touches(state, body) && comes_to(state, body).is_none() {
            state.bodies.yielding[body].leans = 1;
        }
    }
}

/// Upper bound of the speed of any point of a loose body, in m/s.
fn surface_speed(state: &State, body: usize) -> f32 {
    let speed = math::length(state.bodies.momentum[body].velocity);
    speed + math::length(spin(state, body)) * reach_m(state, body)
}

/// Where the centre of mass of every member is.
pub(super) fn note_centres(state: &mut State, island: usize) {
    let mut next = Some(island);
    while let Some(body) = next {
        next = state.islands.next[body].checked_sub(1).map(|n| n as usize);
        state.islands.centre[body] = centre_pose(state, body).translation();
    }
}

/// Where every loose member is at the end of a stretch.
pub(super) fn aim(state: &mut State, stretch: &Stretch) {
    let mut next = Some(stretch.island as usize);
    while let Some(body) = next {
        next = state.islands.next[body].checked_sub(1).map(|n| n as usize);
        if is_loose(state, body) {
            movers::aim(state, body, stretch);
        }
    }
}
