//! What a frame remembers of its contacts, and tells the host.

use glam::Vec3;

use super::Stretch;
use crate::frame::FrameReport;
use crate::math;
use crate::state::State;
use crate::state::bodies::{BodyKind, is_loose_kind};
use crate::state::contacts::{self, ContactPoint};
use crate::state::rows::Row;
use crate::state::touches::{Touch, push};

/// Puts the touches of the frame before aside and keeps those of sleepers; how many there were.
pub(super) fn begin(state: &mut State) -> usize {
    let count = state.registers.touches as usize;
    state.before.touches[..count].copy_from_slice(&state.touches.touches[..count]);
    state.registers.touches = 0;
    for index in 0..count {
        let touch = state.before.touches[index];
        if sleeps(state, &touch) {
            push(
                state,
                Touch {
                    stage: Touch::ASLEEP,
                    ..touch
                },
            );
        }
    }
    count
}

/// Whether the loose bodies of a touch are all asleep, and still exist.
fn sleeps(state: &State, touch: &Touch) -> bool {
    let asleep = |piece: usize| {
        let body = state.pieces.body[piece] as usize;
        !is_loose_kind(state.pieces.body_kind[piece]) || state.bodies.momentum[body].asleep == 1
    };
    let [a, b] = [touch.piece_a, touch.piece_b].map(|piece| piece.find(state.pieces.generation));
    a.is_some_and(asleep) && b.is_some_and(asleep)
}

/// The touch of this frame that a contact belongs to, index plus one: one that an earlier event of the
/// island found, or a new one that knows what the frame before left. Zero when there is no room.
pub(super) fn find(state: &mut State, pair: usize, local: Vec3, stretch: &Stretch) -> u32 {
    let pair = state.islands.pairs[pair];
    let (piece_a, piece_b) = (state.pieces.id(pair.a), state.pieces.id(pair.b));
    let same = |touch: &Touch| touch.piece_a == piece_a && touch.piece_b == piece_b;
    let first = stretch.first_touch;
    let now = &state.touches.touches[first..state.registers.touches as usize];
    let free = |touch: &Touch| same(touch) && touch.stage == Touch::GONE;
    if let Some(index) = nearest(now, local, free) {
        let touch = &mut state.touches.touches[first + index];
        touch.stage = Touch::NOW;
        return (first + index) as u32 + 1;
    }
    let before = &state.before.touches[..stretch.touches_before];
    let untaken = |touch: &Touch| same(touch) && touch.stage != TAKEN;
    let mut made = Touch {
        piece_a,
        piece_b,
        local,
        point: Vec3::ZERO,
        normal: Vec3::ZERO,
        gap: 0.0,
        force: Vec3::ZERO,
        impulse: Vec3::ZERO,
        approach: 0.0,
        slide: 0.0,
        stage: Touch::NOW,
    };
    if let Some(index) = nearest(before, local, untaken) {
        made.force = state.before.touches[index].force;
        state.before.touches[index].stage = TAKEN;
    }
    push(state, made).map_or(0, |index| index as u32 + 1)
}

/// A touch of the frame before that a contact of this one goes on from.
const TAKEN: u32 = u32::MAX;

fn nearest(touches: &[Touch], local: Vec3, counts: impl Fn(&Touch) -> bool) -> Option<usize> {
    let mut found = None;
    let mut least = f32::INFINITY;
    for (index, touch) in touches.iter().enumerate() {
        let away = (touch.local - local).length_squared();
        if away < least && counts(touch) {
            least = away;
            found = Some(index);
        }
    }
    found
}

/// Marks the island's touches as gone until the next event finds them again.
pub(super) fn forget(state: &mut State, stretch: &Stretch) {
    let end = state.registers.touches as usize;
    for touch in &mut state.touches.touches[stretch.first_touch..end] {
        touch.stage = Touch::GONE;
    }
}

/// The impulse that a row starts a stretch with: the force of the stretch before.
pub(super) fn remembered(state: &State, row: &Row, seconds: f32) -> Vec3 {
    let Some(index) = row.touch.checked_sub(1) else {
        return Vec3::ZERO;
    };
    let force = state.touches.touches[index as usize].force * seconds;
    let push = force.dot(row.normal);
    if push <= 0.0 {
        return Vec3::ZERO;
    }
    force
}

/// Books the impacts of an event.
pub(super) fn note_impacts(state: &mut State, rows: usize) {
    for index in 0..rows {
        let row = state.rows.rows[index];
        if let Some(index) = row.touch.checked_sub(1) {
            state.touches.touches[index as usize].impulse += row.struck;
        }
    }
}

/// Books how a contact is and how fast it approached before an event's impacts, in m/s.
pub(super) fn note_approach(state: &mut State, row: &Row, velocity: Vec3) {
    let Some(index) = row.touch.checked_sub(1).filter(|_| velocity.is_finite()) else {
        return;
    };
    let approach = -velocity.dot(row.normal);
    let touch = &mut state.touches.touches[index as usize];
    touch.approach = math::max(touch.approach, approach);
    touch.slide = math::length(velocity + row.normal * approach);
    touch.point = row.point;
    touch.normal = row.normal;
    touch.gap = row.gap;
}

/// The least share of a frame whose forces are worth remembering: in a shorter stretch they are what puts
/// velocities right.
const REMEMBERED_SHARE: f32 = 0.1;

/// Books the forces of a stretch, which are in the rows' impulses and lasted for the share `reached`.
pub(super) fn note_forces(state: &mut State, rows: usize, stretch: &Stretch, reached: f32) {
    let seconds = stretch.seconds();
    let lasts = seconds > REMEMBERED_SHARE * stretch.dt_s;
    for index in 0..rows {
        let row = state.rows.rows[index];
        if let Some(index) = row.touch.checked_sub(1) {
            let touch = &mut state.touches.touches[index as usize];
            if lasts {
                touch.force = row.impulse / seconds;
            }
            touch.impulse += row.impulse * reached;
        }
    }
}

/// Writes the island's contacts that carried an impulse where the host can read them, and what driven and
/// hosted bodies got.
pub(super) fn record(state: &mut State, stretch: &Stretch, report: &mut FrameReport) {
    for index in stretch.first_touch..state.registers.touches as usize {
        let touch = state.touches.touches[index];
        let push = touch.impulse.dot(touch.normal);
        if push <= 0.0 {
            continue;
        }
        give(state, &touch, push);
        let point = ContactPoint {
            piece_a: touch.piece_a,
            piece_b: touch.piece_b,
            point: touch.point.to_array(),
            normal: touch.normal.to_array(),
            gap_m: touch.gap,
            impulse_n_s: push,
            approach_m_s: touch.approach,
            slide_m_s: touch.slide,
        };
        if !contacts::add(state, point) {
            report.set(FrameReport::FULL_CONTACTS);
        }
    }
    finish_hosted(state, stretch.island as usize);
}

/// Books a touch's impulse at the driven and hosted bodies that it acted on.
fn give(state: &mut State, touch: &Touch, push: f32) {
    let pieces = [touch.piece_a, touch.piece_b].map(|piece| piece.find(state.pieces.generation));
    let [Some(a), Some(b)] = pieces else { return };
    let bodies = [a, b].map(|piece| state.pieces.body[piece] as usize);
    let kinds = bodies.map(|body| state.bodies.kind[body]);
    if kinds[1] == BodyKind::Driven.code() {
        state.bodies.yielding[bodies[1]].reaction -= touch.impulse;
    }
    let own = |kind: u32| kind == BodyKind::Driven.code() || kind == BodyKind::Dynamic.code();
    for (side, sign) in [(0, 1.0), (1, -1.0)] {
        if kinds[side] == BodyKind::Hosted.code() && own(kinds[1 - side]) {
            let centre = state.islands.centre[bodies[side]];
            let impulse = touch.impulse * sign;
            let arm = touch.point - centre;
            let hosted = &mut state.bodies.hosted[bodies[side]];
            let linear = Vec3::from_array(hosted.impulse_n_s) + impulse;
            let angular = Vec3::from_array(hosted.angular_n_m_s) + arm.cross(impulse);
            // Weighted by the push until `finish_hosted` divides.
            let point = Vec3::from_array(hosted.point) + arm * push;
            hosted.impulse_n_s = linear.to_array();
            hosted.angular_n_m_s = angular.to_array();
            hosted.point = point.to_array();
            hosted.contacts += 1;
            hosted.push_n_s += push;
        }
    }
}

fn finish_hosted(state: &mut State, island: usize) {
    let mut next = Some(island);
    while let Some(body) = next {
        next = state.islands.next[body].checked_sub(1).map(|n| n as usize);
        let hosted = &mut state.bodies.hosted[body];
        if hosted.push_n_s > 0.0 {
            let point =
                Vec3::from_array(hosted.point) / hosted.push_n_s + state.islands.centre[body];
            hosted.point = point.to_array();
        }
    }
}
