//! What the bodies of an island do about the contacts of an event.
//!
//! First impacts, at once; then the forces of the stretch, evenly. Driven bodies are movers that impulses
//! do not change, so that what is free is pushed without lag. Where that leaves contacts closing, an object
//! cannot get out of the way: the driven bodies take part with the mass of their couplings
//! ([`crate::couple`]), and where that does not help they keep their turn and their pieces too, pressed by
//! the couplings' stiffness.

use glam::{Mat3, Vec3};

use super::forces::{note_working, push, restoring};
use super::giving::{begin_giving, give_way, gives, is_wedged, step_back};
use super::movers::{is_free, mover};
use super::solver::{Order, Problem};
use super::{Stretch, cluster, gather, touch};
use crate::limits::{
    BOUNCE_MIN, GAP_FLOOR_M, GIVING_INERTIA_KG_M2, LONE_BOUNCE_MIN, LONE_BOUNCE_PART, LOOSE_REST_M,
    RESIDUAL_PART,
};
use crate::math;
use crate::state::bodies::is_loose_kind;
use crate::state::islands::Members;
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

/// Errors of velocity that are none, in m/s.
fn tolerance(registers: &Registers, stretch: &Stretch) -> f32 {
    let gravity = math::max(math::length(registers.gravity), 1.0);
    math::max(RESIDUAL_PART * gravity * stretch.dt_s, 1e-6)
}

/// The problem that the rows pose.
pub(super) fn problem<'s>(state: &'s mut State, rows: usize, stretch: &Stretch) -> Problem<'s> {
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
pub(super) fn is_lone(state: &State, rows: usize, index: usize) -> bool {
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
pub(super) fn spare_m(row: &Row, lone: bool) -> f32 {
    let (closed_m, rest_m) = if lone {
        (2.0 * GAP_FLOOR_M, 1.5 * GAP_FLOOR_M)
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
    let spare = spare_m(&row, lone);
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
pub(super) fn meets_fast(
    state: &State,
    row: &Row,
    normal_velocity: f32,
    lone: bool,
    least: f32,
) -> bool {
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
pub(super) fn bounce_least(state: &State, lone: bool, stretch: &Stretch) -> f32 {
    let fall = math::length(state.registers.gravity) * stretch.dt_s;
    if lone {
        math::max(LONE_BOUNCE_PART * fall, LONE_BOUNCE_MIN)
    } else {
        math::max(2.0 * fall, BOUNCE_MIN)
    }
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
