//! What the bodies of an island do about the contacts of an event.
//!
//! First impacts, at once; then the forces of the stretch, evenly. Driven bodies are movers that impulses
//! do not change, so that what is free is pushed without lag. Where that leaves contacts closing, an object
//! cannot get out of the way: the driven bodies take part with the mass of their couplings
//! ([`crate::couple`]), and where that does not help they keep their turn and their pieces too, pressed by
//! the couplings' stiffness.

use glam::{Mat3, Vec3};

use super::movers::{is_free, mover};
use super::solver::{Order, Problem};
use super::sweep::{prescribed, root_velocity};
use super::{Stretch, cluster, energy, gather, rest, touch};
use crate::limits::{
    BOUNCE_MIN, CONTACT_SHARE_MIN, CONTACT_TURN_RAD, GAP_FLOOR_M, GAP_RESTORED, GAP_RESTORED_PER_S,
    GIVING_INERTIA_KG_M2, GRIP_EVENED, LONE_BOUNCE_MIN, LONE_BOUNCE_PART, LOOSE_REST_M,
    RESIDUAL_PART, RESTORING_SPEED_MAX, STALLED_TURN_PART, STEP_MIN_M, TURN_RAD, TURN_SHARE_MIN,
    WEDGED_M,
};
use crate::math;
use crate::state::bodies::{BodyKind, Coupling, is_loose_kind};
use crate::state::islands::{GiveWay, Members};
use crate::state::purse::Purse;
use crate::state::rows::{Mover, Row};
use crate::state::{Registers, State};

/// Parts of a unit that a row takes in an attempt, beside its impulses.
const ROW_PARTS: usize = 4;

/// The same for a body.
const MEMBER_PARTS: usize = 3;

/// Gives the bodies of an island their motion at the start and the end of a stretch; how many impulses
/// that took. In the first event of a frame, driven bodies may give way.
pub(super) fn run(state: &mut State, rows: usize, stretch: &Stretch, purse: &mut Purse) -> u32 {
    let first = stretch.is_first;
    if first {
        begin_giving(state, stretch);
    }
    let mut impulses = 0;
    for last in [false, false, false, true] {
        if !purse.take_parts(event_parts(state, rows, stretch)) {
            break;
        }
        let answer = attempt(state, rows, last, stretch, purse);
        impulses += answer.impulses;
        if !answer.wedged {
            break;
        }
    }
    touch::note_impacts(state, rows);
    if first {
        give_way(state, rows, stretch);
    }
    impulses
}

/// Parts of a unit for what an attempt takes beside its impulses.
fn event_parts(state: &State, rows: usize, stretch: &Stretch) -> u32 {
    let members = Members::of(state, stretch.island as usize).count();
    (ROW_PARTS * rows + MEMBER_PARTS * members) as u32
}

/// Every body in its mover, before impulses.
pub(super) fn ready(state: &mut State, stretch: &Stretch) {
    let mut next = Some(stretch.island as usize);
    while let Some(body) = next {
        next = state.islands.next[body].checked_sub(1).map(|n| n as usize);
        let made = mover(state, body, stretch.from);
        state.rows.even[body] = 0;
        state.rows.movers[body] = made;
        state.rows.begun[body] = made;
    }
}

fn is_driven(state: &State, body: u32) -> bool {
    state.bodies.kind[body as usize] == BodyKind::Driven.code()
}

/// Whether driven bodies are among those of an island.
pub(super) fn has_driven(state: &State, island: usize) -> bool {
    Members::of(state, island).any(|body| is_driven(state, body as u32))
}

/// Starts the frame with what was found in the last one: who gave way does so again.
fn begin_giving(state: &mut State, stretch: &Stretch) {
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

/// Errors of velocity that are none, in m/s.
fn tolerance(registers: &Registers, stretch: &Stretch) -> f32 {
    let gravity = math::max(math::length(registers.gravity), 1.0);
    math::max(RESIDUAL_PART * gravity * stretch.dt_s, 1e-6)
}

/// The problem that the rows pose.
fn problem<'s>(state: &'s mut State, rows: usize, stretch: &Stretch) -> Problem<'s> {
    let tolerance = tolerance(state.registers, stretch);
    Problem {
        movers: &mut *state.rows.movers,
        rows: &mut state.rows.rows[..rows],
        first: &mut *state.rows.first,
        queue: &mut *state.rows.queue,
        order: Order::MostNegative,
        tolerance,
    }
}

/// Whether a driven body takes part with a mass in this stretch.
fn gives(state: &State, body: u32, stretch: &Stretch) -> bool {
    stretch.is_first
        && is_driven(state, body)
        && state.bodies.yielding[body as usize].level > 0
        && state.legs.stop_time[body as usize] > stretch.from
}

/// What an attempt came to.
struct Answer {
    impulses: u32,
    /// An object cannot get out of the way of a driven body, which gives way in the next attempt.
    wedged: bool,
}

/// Impacts, then forces. The last attempt makes do with what it finds.
fn attempt(
    state: &mut State,
    rows: usize,
    last: bool,
    stretch: &Stretch,
    purse: &mut Purse,
) -> Answer {
    ready(state, stretch);
    for index in 0..rows {
        let body = state.rows.rows[index].body_b;
        if gives(state, body, stretch) {
            let mass = state.bodies.yielding[body as usize].mass_kg;
            state.rows.movers[body as usize].inverse_mass = 1.0 / mass;
            state.rows.movers[body as usize].inverse_inertia =
                Mat3::from_diagonal(Vec3::splat(1.0 / GIVING_INERTIA_KG_M2));
        } else if !is_loose_kind(state.bodies.kind[body as usize])
            || !is_free(state, body as usize, stretch.from)
        {
            state.rows.movers[body as usize] = Mover::default();
        }
    }
    gather::place(state, rows, stretch);
    let mut impulses = strike(state, rows, stretch, purse);
    if !stretch.is_first && is_wedged(state, rows, stretch) {
        impulses += strike_on(state, rows, stretch, purse);
    }
    let mut wedged = !last && is_wedged(state, rows, stretch) && step_back(state, rows, stretch);
    if !wedged {
        impulses += merge(state, rows, stretch);
        copy_begun(state, stretch);
        impulses += push(state, rows, stretch, purse);
        wedged = !last && is_wedged(state, rows, stretch) && step_back(state, rows, stretch);
    }
    if !wedged {
        impulses += merge(state, rows, stretch);
        note_working(state, rows);
    }
    keep_finite(state, rows);
    Answer { impulses, wedged }
}

/// Leaves out the impulses of rows whose masses, speeds and arms made numbers that f32 does not hold.
fn keep_finite(state: &mut State, rows: usize) {
    for row in &mut state.rows.rows[..rows] {
        if !row.impulse.is_finite() || !row.struck.is_finite() {
            row.impulse = Vec3::ZERO;
            row.struck = Vec3::ZERO;
        }
    }
}

/// Has driven bodies give way, or stop; false when all that push have. What stands still leaves every
/// object a way to be.
fn step_back(state: &mut State, rows: usize, stretch: &Stretch) -> bool {
    (stretch.is_first && raise(state, rows)) || stop(state, rows, stretch)
}

fn copy_begun(state: &mut State, stretch: &Stretch) {
    let mut next = Some(stretch.island as usize);
    while let Some(body) = next {
        next = state.islands.next[body].checked_sub(1).map(|n| n as usize);
        state.rows.begun[body] = state.rows.movers[body];
    }
}

/// The impacts of an event.
fn strike(state: &mut State, rows: usize, stretch: &Stretch, purse: &mut Purse) -> u32 {
    for index in 0..rows {
        let mut row = state.rows.rows[index];
        row.impulse = Vec3::ZERO;
        row.least = 0.0;
        row.bounce = f32::INFINITY;
        if gives(state, row.body_b, stretch) {
            row.prescribed = -state.bodies.yielding[row.body_b as usize].velocity;
        }
        state.rows.rows[index] = row;
    }
    let mut posed = problem(state, rows, stretch);
    posed.prepare();
    for index in 0..rows {
        aim_strike(state, rows, index, stretch);
    }
    let mut posed = problem(state, rows, stretch);
    let applied = posed.strike_paid(&mut |impulses| purse.take_parts(impulses));
    for row in &mut state.rows.rows[..rows] {
        row.struck = row.impulse;
    }
    applied
}

/// Goes on with impacts that came to no end one after the other, as between surfaces where a ball is almost
/// jammed: what is left of the approach is answered at all contacts together, without restitution.
fn strike_on(state: &mut State, rows: usize, stretch: &Stretch, purse: &mut Purse) -> u32 {
    for row in &mut state.rows.rows[..rows] {
        row.impulse = Vec3::ZERO;
        row.pushes = 0;
    }
    let mut posed = problem(state, rows, stretch);
    posed.order = Order::Conjugate;
    let applied = posed.settle_paid(&mut |impulses| purse.take_parts(impulses));
    for row in &mut state.rows.rows[..rows] {
        row.struck += row.impulse;
        row.impulse = row.struck;
    }
    applied
}

/// Whether a row is the only one of its movable bodies, and those are spheres there: a ball that bounces or
/// rolls, which is followed exactly. A lone corner of a polyhedron is soon not alone.
fn is_lone(state: &State, rows: usize, index: usize) -> bool {
    let row = &state.rows.rows[..rows][index];
    let pair = &state.islands.pairs[row.pair as usize];
    let only = |body: u32, next: u32, piece: u32| {
        !state.rows.movers[body as usize].is_movable()
            || (state.rows.first[body as usize] == index as u32 + 1
                && next == 0
                && state.pieces.shape[piece as usize].core_reach() == 0.0)
    };
    only(row.body_a, row.next_a, pair.a) && only(row.body_b, row.next_b, pair.b)
}

/// How far a gap is from closed, in metres; zero when it counts as closed.
///
/// What hands hold goes on carrying as before where it leaves what counts as closed: if it closed to the rest gap
/// from there, an object that creeps would jolt.
fn spare_m(state: &State, row: &Row, lone: bool) -> f32 {
    let (closed_m, rest_m) = if lone {
        (2.0 * GAP_FLOOR_M, 1.5 * GAP_FLOOR_M)
    } else if is_driven(state, row.body_b) {
        (gather::CARRYING_M, gather::CARRYING_M)
    } else {
        (gather::CARRYING_M, LOOSE_REST_M)
    };
    if row.gap <= closed_m {
        0.0
    } else {
        row.gap - rest_m
    }
}

/// What an impact brings a row to.
///
/// A closed contact bounces when it is fast, and stops when it is slow. An open one closes to the rest gap
/// within the stretch at the most when it is slow, and is left alone until it meets when it is fast.
fn aim_strike(state: &mut State, rows: usize, index: usize, stretch: &Stretch) {
    let row = state.rows.rows[index];
    let lone = is_lone(state, rows, index);
    let velocity = problem(state, rows, stretch).relative_velocity(&row);
    touch::note_approach(state, &row, velocity);
    let least = bounce_least(state, lone, stretch);
    let giving = gives(state, row.body_b, stretch);
    let spare = spare_m(state, &row, lone);
    let fast = meets_fast(state, &row, velocity.dot(row.normal), lone, least);
    let row = &mut state.rows.rows[index];
    if spare == 0.0 {
        row.target = math::max(restoring(row.gap, stretch), 0.0);
        row.bounce = if giving { f32::INFINITY } else { least };
    } else if fast {
        row.target = f32::NEG_INFINITY;
    } else {
        row.target = -spare / stretch.seconds();
    }
}

/// Whether a contact meets faster than what bounces: by its speed now, or for a lone one by what it will have
/// fallen.
fn meets_fast(state: &State, row: &Row, normal_velocity: f32, lone: bool, least: f32) -> bool {
    let square = if lone {
        let fall = math::max(-state.registers.gravity.dot(row.normal), 0.0);
        normal_velocity * normal_velocity + 2.0 * fall * math::max(row.gap, 0.0)
    } else {
        let approach = math::max(-normal_velocity, 0.0);
        approach * approach
    };
    square > least * least
}

/// Twice what gravity adds in a frame: slower impacts are a matter of one frame's fall. A lone contact is
/// followed through its bounces.
fn bounce_least(state: &State, lone: bool, stretch: &Stretch) -> f32 {
    let fall = math::length(state.registers.gravity) * stretch.dt_s;
    if lone {
        math::max(LONE_BOUNCE_PART * fall, LONE_BOUNCE_MIN)
    } else {
        math::max(2.0 * fall, BOUNCE_MIN)
    }
}

/// The forces of a stretch: gravity, the host's, and those of the contacts.
fn push(state: &mut State, rows: usize, stretch: &Stretch, purse: &mut Purse) -> u32 {
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
    let squeezed = has_driven(state, stretch.island as usize);
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
fn note_working(state: &mut State, rows: usize) {
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
    let spare = spare_m(state, &row, lone);
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

/// The velocity at a contact that a giving body's way prescribes, which the impacts of the event did not
/// see.
fn planned_at(state: &State, row: &Row, stretch: &Stretch) -> Vec3 {
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

fn push_target(row: &Row, spare: f32, begun: f32, even: bool, stretch: &Stretch) -> f32 {
    let seconds = stretch.seconds();
    let target = if even {
        -spare / seconds
    } else {
        math::min(-2.0 * spare / seconds - begun, 0.0)
    };
    math::max(target, restoring(row.gap, stretch))
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

/// The share of a stretch for which the contacts are where they were found: until a body that is pushed off
/// its centre has turned by [`CONTACT_TURN_RAD`].
pub(super) fn holds_for(state: &State, rows: usize, stretch: &Stretch) -> f32 {
    let mut share = 1.0;
    for row in &state.rows.rows[..rows] {
        for (body, arm) in [(row.body_a, row.arm_a), (row.body_b, row.arm_b)] {
            let mover = &state.rows.movers[body as usize];
            let off_centre = arm.cross(row.normal) != Vec3::ZERO;
            if mover.is_movable() && off_centre && row.impulse != Vec3::ZERO {
                let turn = math::length(mover.spin) * stretch.seconds();
                let angle = CONTACT_TURN_RAD;
                share = math::min(share, angle / math::max(turn, angle));
            }
        }
    }
    math::max(share, CONTACT_SHARE_MIN)
}

/// The share of a stretch in which no loose body turns by more than [`TURN_RAD`], or by a part of it after so many
/// events that brought nobody forward. What turns so fast that this were a small share of the frame turns farther.
pub(super) fn turns_for(state: &State, stretch: &Stretch, stalls: u32) -> f32 {
    let mut fastest = 0.0;
    for body in Members::of(state, stretch.island as usize) {
        for mover in [&state.rows.begun[body], &state.rows.movers[body]] {
            fastest = math::max(fastest, mover.spin.length_squared());
        }
    }
    let turn = math::sqrt(fastest) * stretch.seconds();
    let (mut most, mut least) = (TURN_RAD, TURN_SHARE_MIN);
    for _ in 0..stalls {
        most *= STALLED_TURN_PART;
        least *= STALLED_TURN_PART;
    }
    if turn <= most {
        return 1.0;
    }
    let least = least * stretch.dt_s / stretch.seconds();
    math::min(math::max(most / turn, least), 1.0)
}

/// The speed that takes some of an overlap away, which the host made: gently, for it feeds energy in.
fn restoring(gap: f32, stretch: &Stretch) -> f32 {
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

/// Whether a contact would close by more than a driven body's gap can take.
fn is_wedged(state: &mut State, rows: usize, stretch: &Stretch) -> bool {
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

/// Clusters are made of what approaches this much faster than what counts as no error.
const MERGED_FROM: f32 = 4.0;

/// Makes rigid clusters of what would still run into each other.
fn merge(state: &mut State, rows: usize, stretch: &Stretch) -> u32 {
    let seconds = stretch.seconds();
    let allowed = |row: &Row| {
        let spare = math::min(row.gap, LOOSE_REST_M) - 1.5 * GAP_FLOOR_M;
        math::max(spare, 0.0) / seconds - math::min(row.target, 0.0)
    };
    let tolerance = MERGED_FROM * tolerance(state.registers, stretch);
    let mut posed = Problem {
        movers: &mut *state.rows.movers,
        rows: &mut state.rows.rows[..rows],
        first: &mut *state.rows.first,
        queue: &mut *state.rows.queue,
        order: Order::MostNegative,
        tolerance,
    };
    cluster::run(
        &mut posed,
        state.islands.centre,
        state.rows.cluster,
        allowed,
    )
}

/// Notes how driven bodies gave way, and who is to start the next frame so.
fn give_way(state: &mut State, rows: usize, stretch: &Stretch) {
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
