//! The forces of a stretch: gravity, the host's, and those of the contacts, which keep what touches where it is.

use glam::Vec3;

use super::giving::{gives, is_driven, planned_at};
use super::movers::is_free;
use super::respond::{bounce_least, is_lone, meets_fast, problem, spare_m};
use super::solver::Order;
use super::{Stretch, energy, gather, giving, rest, touch};
use crate::limits::{GAP_RESTORED, GAP_RESTORED_PER_S, GRIP_EVENED, RESTORING_SPEED_MAX};
use crate::math;
use crate::state::State;
use crate::state::bodies::BodyKind;
use crate::state::islands::Members;
use crate::state::purse::Purse;
use crate::state::rows::Row;
/// The forces of a stretch: gravity, the host's, and those of the contacts.
pub(super) fn push(state: &mut State, rows: usize, stretch: &Stretch, purse: &mut Purse) -> u32 {
    let seconds = stretch.seconds();
    note_even(state, rows, stretch);
    for index in 0..rows {
        aim_push(state, rows, index, stretch);
    }
    load(state, stretch);
    gather::press(state, rows, seconds);
    for row in &mut state.rows.rows[..rows] {
        row.impulse = Vec3::ZERO;
        row.pushes = 0;
    }
    let mut posed = problem(state, rows, stretch);
    let rested = rest::run(&mut posed);
    warm_start(state, rows, stretch);
    let mut posed = problem(state, rows, stretch);
    let mut pay = |impulses| purse.take_parts(impulses);
    let mut applied = posed.spread_paid(&mut pay);
    for row in posed.rows.iter_mut() {
        row.pushes = 0;
    }
    posed.order = Order::Conjugate;
    applied += posed.settle_paid(&mut pay);
    rested + applied
}

/// Starts with the forces of the stretch before. Rows that do so count as pushed.
fn warm_start(state: &mut State, rows: usize, stretch: &Stretch) {
    let seconds = stretch.seconds();
    for index in 0..rows {
        let row = state.rows.rows[index];
        let rested = row.impulse != Vec3::ZERO;
        let impulse = if rested || row.target == f32::NEG_INFINITY {
            row.impulse
        } else {
            touch::remembered(state, &row, seconds)
        };
        let row = &mut state.rows.rows[index];
        row.impulse = impulse;
        row.pushes = u32::from(impulse != Vec3::ZERO);
        row.rests = u32::from(rested);
    }
    even_grips(state, rows, stretch);
    let remembered: fn(&Row) -> bool = |row| row.pushes == 1 && row.rests == 0;
    let squeezed = giving::has_driven(state, stretch.island as usize);
    let mut posed = problem(state, rows, stretch);
    energy::apply(&mut posed, remembered, 1.0);
    // What hands press from both sides does no work but by rounding.
    if !squeezed {
        energy::keep_passive(&mut posed, remembered);
    }
}

/// Spreads what presses a held object over each manifold a little more evenly than the frame before. Which
/// corner carries is up to chance else, and an object held at one corner swings about it.
fn even_grips(state: &mut State, rows: usize, stretch: &Stretch) {
    let mut first = 0;
    while first < rows {
        let row = state.rows.rows[first];
        let mut end = first + 1;
        while end < rows && state.rows.rows[end].manifold == row.manifold {
            end += 1;
        }
        if gives(state, row.body_b, stretch) && end - first > 1 {
            let mut mean = Vec3::ZERO;
            for row in &state.rows.rows[first..end] {
                mean += row.impulse;
            }
            mean /= (end - first) as f32;
            for row in &mut state.rows.rows[first..end] {
                row.impulse += (mean - row.impulse) * GRIP_EVENED;
                row.pushes = u32::from(row.impulse != Vec3::ZERO);
            }
        }
        first = end;
    }
}

/// Notes which bodies move at even speed through the stretch: those that touch others that move, where
/// that takes the last bit of motion out of a stack, and those of an island where driven bodies give way,
/// where both sides are to go the same way. Hosted ones as well, as most engines do. All others fall and slide exactly.
fn note_even(state: &mut State, rows: usize, stretch: &Stretch) {
    let all =
        Members::of(state, stretch.island as usize).any(|body| gives(state, body as u32, stretch));
    let mut next = Some(stretch.island as usize);
    while let Some(body) = next {
        next = state.islands.next[body].checked_sub(1).map(|n| n as usize);
        let hosted = state.bodies.kind[body] == BodyKind::Hosted.code();
        state.rows.even[body] = u32::from(all || hosted);
    }
    for row in &state.rows.rows[..rows] {
        if state.rows.movers[row.body_b as usize].is_movable() && gather::is_closed(row) {
            state.rows.even[row.body_a as usize] = 1;
            state.rows.even[row.body_b as usize] = 1;
        }
    }
}

/// Notes the bodies that contacts would do work on, by the mean of the motion at both ends: what friction
/// stops within a stretch went the other way first. At even speed they do none.
pub(super) fn note_working(state: &mut State, rows: usize) {
    for row in &state.rows.rows[..rows] {
        let (a, b) = (row.body_a as usize, row.body_b as usize);
        if row.impulse == Vec3::ZERO || state.rows.even[a] == 1 {
            continue;
        }
        let ends = |body: usize, arm: Vec3| {
            state.rows.begun[body].velocity_at(arm) + state.rows.movers[body].velocity_at(arm)
        };
        let way = ends(a, row.arm_a) - ends(b, row.arm_b) + 2.0 * row.prescribed;
        let work = 0.5 * row.impulse.dot(way);
        let scale = math::length(row.impulse) * math::length(way);
        if row.prescribed == Vec3::ZERO && work > 1e-4 * scale {
            state.rows.even[a] = 1;
        }
    }
}

/// What the forces of a stretch bring a row to.
///
/// Speed changes evenly, so the gap closes by the mean of the speeds at both ends; it is to close to the
/// rest gap at the most.
fn aim_push(state: &mut State, rows: usize, index: usize, stretch: &Stretch) {
    let mut row = state.rows.rows[index];
    let lone = is_lone(state, rows, index);
    let velocity = problem(state, rows, stretch).relative_velocity(&row);
    let begun = velocity.dot(row.normal);
    let least = bounce_least(state, lone, stretch);
    let spare = spare_m(&row, lone);
    let bounced = lone && row.gap >= 0.0 && begun > 0.25 * least;
    let meets_later = spare > 0.0 && meets_fast(state, &row, begun, lone, least);
    state.islands.pairs[row.pair as usize].bounced = u32::from(bounced);
    if gives(state, row.body_b, stretch) {
        let body = row.body_b as usize;
        row.prescribed = -planned_at(state, &row, stretch);
        state.rows.movers[body].velocity = Vec3::ZERO;
    } else if is_driven(state, row.body_b) && state.bodies.yielding[row.body_b as usize].level > 0 {
        let kept = touch::remembered(state, &row, stretch.seconds());
        row.least = math::max(kept.dot(row.normal), 0.0);
    }
    row.target = if bounced || meets_later {
        f32::NEG_INFINITY
    } else {
        let even = state.rows.even[row.body_a as usize] == 1;
        push_target(&row, spare, begun, even, stretch)
    };
    state.rows.rows[index] = row;
}

fn push_target(row: &Row, spare: f32, begun: f32, even: bool, stretch: &Stretch) -> f32 {
    let seconds = stretch.seconds();
    let target = if even {
        -spare / seconds
    } else {
        math::min(-2.0 * spare / seconds - begun, 0.0)
    };
    math::max(target, restoring(row.gap, stretch))
}

/// The speed that takes some of an overlap away, which the host made: gently, for it feeds energy in.
pub(super) fn restoring(gap: f32, stretch: &Stretch) -> f32 {
    if gap >= 0.0 {
        return f32::NEG_INFINITY;
    }
    let rate = math::min(GAP_RESTORED_PER_S, GAP_RESTORED / stretch.dt_s);
    math::min(-gap * rate, RESTORING_SPEED_MAX)
}

/// Gravity and the host's forces over a stretch.
fn load(state: &mut State, stretch: &Stretch) {
    let seconds = stretch.seconds();
    let fall = state.registers.gravity * seconds;
    let mut next = Some(stretch.island as usize);
    while let Some(body) = next {
        next = state.islands.next[body].checked_sub(1).map(|n| n as usize);
        if is_free(state, body, stretch.from) {
            let load = state.bodies.load[body];
            let mover = &mut state.rows.movers[body];
            mover.velocity += fall + load.force * (mover.inverse_mass * seconds);
            if load.torque != Vec3::ZERO {
                mover.spin += mover.inverse_inertia * (load.torque * seconds);
            }
        }
    }
}

/// Leaves only a share of what the forces of a stretch do.
pub(super) fn shorten(state: &mut State, rows: usize, stretch: &Stretch, share: f32) {
    for row in &mut state.rows.rows[..rows] {
        row.impulse *= share;
    }
    let mut next = Some(stretch.island as usize);
    while let Some(body) = next {
        next = state.islands.next[body].checked_sub(1).map(|n| n as usize);
        let begun = state.rows.begun[body];
        let mover = &mut state.rows.movers[body];
        mover.velocity = begun.velocity + (mover.velocity - begun.velocity) * share;
        mover.spin = begun.spin + (mover.spin - begun.spin) * share;
    }
}
