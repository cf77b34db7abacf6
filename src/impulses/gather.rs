//! From pairs to rows: the contacts of an event.

use glam::Vec3;

use super::Stretch;
use super::movers::is_free;
use super::sweep::{Measured, measure, prescribed, withheld};
use super::touch;
use crate::frame::FrameReport;
use crate::geometry::manifold::Contact;
use crate::limits::{GRIP_M_MAX, LOOSE_BAND_M, LOOSE_REST_M};
use crate::math;
use crate::state::State;
use crate::state::bodies::BodyKind;
use crate::state::purse::Purse;
use crate::state::rows::Row;

/// Finds the contacts of all pairs at the start of a stretch; how many rows there are, `None` when the
/// units ran out. A distance query for each pair whose boxes are close, part of a unit for the others.
pub(super) fn run(
    state: &mut State,
    pairs: usize,
    stretch: &Stretch,
    purse: &mut Purse,
    report: &mut FrameReport,
) -> Option<usize> {
    let mut count = 0;
    let mut last = None;
    for index in 0..pairs {
        let measured = measure(state, index, stretch, &mut last, purse);
        if purse.is_closed() {
            return None;
        }
        if let Some(measured) = measured
            && !add_manifold(state, index, &measured, stretch, &mut count)
        {
            report.set(FrameReport::FULL_CONTACTS);
            // What is known of the others is of an earlier event, and there may be no units to look.
            for pair in &mut state.islands.pairs[index + 1..pairs] {
                pair.measured = 0;
                pair.gap = 0.0;
            }
            break;
        }
    }
    if state.rows.rows[..count].iter().any(|row| row.touch == 0) {
        report.set(FrameReport::FULL_CONTACTS);
    }
    let mark = &mut state.registers.high_water.contacts;
    *mark = (*mark).max(count as u32);
    Some(count)
}

/// Adds the rows of a pair; false when there was no room for all.
fn add_manifold(
    state: &mut State,
    index: usize,
    measured: &Measured,
    stretch: &Stretch,
    count: &mut usize,
) -> bool {
    let first = *count;
    for contact in &measured.contacts {
        let contact = Contact {
            point: measured.pose_b.point(contact.point),
            normal: measured.pose_b.quat() * contact.normal,
            ..*contact
        };
        if *count == state.rows.rows.len() {
            return false;
        }
        let mut row = row(state, index, &contact);
        row.manifold = first as u32;
        let local =
            measured.pose_a.quat().conjugate() * (contact.point - measured.pose_a.translation());
        row.touch = touch::find(state, index, local, stretch);
        state.rows.rows[*count] = row;
        *count += 1;
    }
    true
}

/// A row that knows its geometry and its materials.
fn row(state: &State, index: usize, contact: &Contact) -> Row {
    let pair = &state.islands.pairs[index];
    let (a, b) = (pair.a as usize, pair.b as usize);
    let bodies = [a, b].map(|piece| state.pieces.body[piece] as usize);
    let stride = state.material_stride();
    let surface = state
        .materials
        .pair(stride, state.pieces.material[a], state.pieces.material[b]);
    let gravity = state.registers.gravity;
    Row {
        body_a: bodies[0] as u32,
        body_b: bodies[1] as u32,
        normal: contact.normal,
        point: contact.point,
        restitution: surface.restitution,
        friction: surface.friction,
        height: -math::direction(gravity).map_or(0.0, |down| down.dot(contact.point)),
        gap: contact.gap,
        pair: index as u32,
        ..Row::default()
    }
}

/// Completes the rows once it is known who moves: arms and prescribed velocities.
///
/// Against something that impulses do not move, the arm ends on the loose body's own surface, so that a
/// ball rolls on its radius and not on half the gap more.
pub(super) fn place(state: &mut State, rows: usize, stretch: &Stretch) {
    for index in 0..rows {
        let mut row = state.rows.rows[index];
        let (a, b) = (row.body_a as usize, row.body_b as usize);
        let pair = state.islands.pairs[row.pair as usize];
        let middle = row.point;
        let answers = is_free(state, b, stretch.from);
        let on_a = if answers {
            middle
        } else {
            middle + row.normal * (0.5 * row.gap)
        };
        let holds = state.islands.gives[b].holds == 1;
        row.prescribed = -prescribed(state, pair.b as usize, middle, holds, stretch);
        row.arm_a = on_a - state.islands.centre[a];
        row.arm_b = if answers {
            middle - state.islands.centre[b]
        } else {
            Vec3::ZERO
        };
        state.rows.rows[index] = row;
    }
}

/// The widest gap that counts as closed, in metres.
pub(super) const CARRYING_M: f32 = LOOSE_REST_M + LOOSE_BAND_M;

/// Whether a gap counts as closed.
pub(super) fn is_closed(row: &Row) -> bool {
    row.gap < CARRYING_M
}

/// Presses the rows of driven bodies that keep their pieces where they are: by the coupling's stiffness
/// times the way that is kept from the piece, shared out over its contacts.
pub(super) fn press(state: &mut State, rows: usize, seconds: f32) {
    for index in 0..rows {
        let row = state.rows.rows[index];
        let body = row.body_b as usize;
        let driven = state.bodies.kind[body] == BodyKind::Driven.code();
        if driven && state.islands.gives[body].holds == 1 && is_closed(&row) {
            let pair = state.islands.pairs[row.pair as usize];
            let kept = withheld(state, pair.b as usize, row.point).dot(row.normal);
            let way = math::clamp(kept, 0.0, GRIP_M_MAX);
            let stiffness = state.bodies.coupling[body].stiffness_n_per_m;
            let shared = manifold_size(&state.rows.rows[..rows], row.manifold);
            state.rows.rows[index].least = stiffness * way * seconds / shared;
        }
    }
}

fn manifold_size(rows: &[Row], manifold: u32) -> f32 {
    let mut size = 0.0;
    for row in &rows[manifold as usize..] {
        if row.manifold != manifold {
            break;
        }
        size += 1.0;
    }
    size
}
