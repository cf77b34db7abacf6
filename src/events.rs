//! Contact events, made of the contacts of two frames that follow each other.
//!
//! Pieces touch while the host can read a contact between them; sleepers touch as they did when they fell
//! asleep, and are not told of again until they wake or part. Begin and end go before stay, so that a full
//! buffer drops what matters least.

use bytemuck::Zeroable;
use glam::Vec3;

use crate::frame::FrameReport;
use crate::math;
use crate::memory::ids::PieceId;
use crate::state::State;
use crate::state::bodies::is_loose_kind;
use crate::state::contacts::ContactPoint;
use crate::state::events::ContactEvent;
use crate::state::materials::Material;

/// Finds what began, stayed and ended. Cost: a sort of the contacts.
pub(crate) fn run(state: &mut State, report: &mut FrameReport) {
    state.registers.events = 0;
    if state.registers.contacts == 0 && state.registers.touching == 0 {
        return;
    }
    let now = gather(state);
    for kind in [ContactEvent::BEGIN, ContactEvent::END, ContactEvent::STAY] {
        tell(state, now, kind, report);
    }
    keep(state, now);
    report.events = state.registers.events;
}

type Key = (PieceId, PieceId);

fn order_of(event: &ContactEvent) -> Key {
    (event.piece_a, event.piece_b)
}

fn key(point: &ContactPoint) -> Key {
    (point.piece_a, point.piece_b)
}

/// Writes one entry for each pair of pieces with contacts, in order; how many there are.
fn gather(state: &mut State) -> usize {
    let count = state.registers.contacts as usize;
    let contacts = &state.contacts.list[..count];
    let order = &mut state.events_now.order[..count];
    for (index, place) in order.iter_mut().enumerate() {
        *place = index as u32;
    }
    order.sort_unstable_by_key(|&index| {
        let point = &contacts[index as usize];
        (key(point), index)
    });
    let mut made = 0;
    let mut last = None;
    let mut largest = 0.0;
    for place in 0..count {
        let point = state.contacts.list[state.events_now.order[place] as usize];
        if last != Some(key(&point)) {
            last = Some(key(&point));
            largest = f32::NEG_INFINITY;
            state.events_now.touching[made] = begun(state, &point);
            made += 1;
        }
        let event = &mut state.events_now.touching[made - 1];
        add(event, &point, &mut largest);
    }
    made
}

/// An entry without impulse.
fn begun(state: &State, point: &ContactPoint) -> ContactEvent {
    let material = |piece: PieceId| {
        let slot = piece.find(state.pieces.generation);
        slot.map_or(Material(0), |slot| Material(state.pieces.material[slot]))
    };
    ContactEvent {
        piece_a: point.piece_a,
        piece_b: point.piece_b,
        material_a: material(point.piece_a),
        material_b: material(point.piece_b),
        point: point.point,
        normal: point.normal,
        ..ContactEvent::zeroed()
    }
}

fn add(event: &mut ContactEvent, point: &ContactPoint, largest: &mut f32) {
    let whole = event.impulse_n_s + point.impulse_n_s;
    if point.impulse_n_s > *largest {
        *largest = point.impulse_n_s;
        event.normal = point.normal;
    }
    if whole > 0.0 {
        let share = point.impulse_n_s / whole;
        let (mean, here) = (Vec3::from_array(event.point), Vec3::from_array(point.point));
        event.point = (mean + (here - mean) * share).to_array();
    }
    event.impulse_n_s = whole;
    event.approach_m_s = math::max(event.approach_m_s, point.approach_m_s);
    event.slide_m_s = math::max(event.slide_m_s, point.slide_m_s);
}

/// Walks this frame's pairs and those of the frame before side by side, and tells those of one kind.
fn tell(state: &mut State, now: usize, kind: u32, report: &mut FrameReport) {
    let before = state.registers.touching as usize;
    let (mut i, mut j) = (0, 0);
    while i < now || j < before {
        let new = (i < now).then(|| state.events_now.touching[i]);
        let old = (j < before).then(|| state.events.touching[j]);
        let (event, is) = match (new, old) {
            (Some(new), Some(old)) if order_of(&new) == order_of(&old) => {
                i += 1;
                j += 1;
                (new, ContactEvent::STAY)
            }
            (Some(new), Some(old)) if order_of(&new) > order_of(&old) => {
                j += 1;
                (old, ContactEvent::END)
            }
            (None, Some(old)) => {
                j += 1;
                (old, ContactEvent::END)
            }
            (Some(new), _) => {
                i += 1;
                (new, ContactEvent::BEGIN)
            }
            (None, None) => break,
        };
        let told = is == kind && !(is == ContactEvent::END && sleeps(state, &event));
        if told {
            push(state, ContactEvent { kind, ..event }, report);
        }
    }
}

fn push(state: &mut State, event: ContactEvent, report: &mut FrameReport) {
    let count = state.registers.events as usize;
    let ended = event.kind == ContactEvent::END;
    match state.events.list.get_mut(count) {
        Some(slot) => {
            *slot = event;
            if ended {
                slot.impulse_n_s = 0.0;
                slot.approach_m_s = 0.0;
                slot.slide_m_s = 0.0;
            }
            state.registers.events += 1;
        }
        None => report.events_dropped += 1,
    }
}

/// Whether the loose bodies of a pair are asleep, so that it touches without being told of.
fn sleeps(state: &State, event: &ContactEvent) -> bool {
    let mut loose = false;
    for piece in [event.piece_a, event.piece_b] {
        let Some(slot) = piece.find(state.pieces.generation) else {
            return false;
        };
        if is_loose_kind(state.pieces.body_kind[slot]) {
            loose = true;
            if state.bodies.momentum[state.pieces.body[slot] as usize].asleep == 0 {
                return false;
            }
        }
    }
    loose
}

/// Remembers what touches: this frame's pairs, and the sleepers among those of the frame before.
fn keep(state: &mut State, now: usize) {
    let before = state.registers.touching as usize;
    let mut kept = now;
    for index in 0..before {
        let old = state.events.touching[index];
        let touching = &state.events_now.touching[..now];
        let again = touching
            .binary_search_by_key(&order_of(&old), order_of)
            .is_ok();
        if !again && sleeps(state, &old) && kept < state.events_now.touching.len() {
            state.events_now.touching[kept] = old;
            kept += 1;
        }
    }
    let touching = &mut state.events_now.touching[..kept];
    touching.sort_unstable_by_key(order_of);
    state.events.touching[..kept].copy_from_slice(touching);
    state.registers.touching = kept as u32;
}
