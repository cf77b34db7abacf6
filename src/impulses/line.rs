//! In which order islands go when time may run out, and who waits.

use glam::Vec3;

use super::islands;
use crate::frame::FrameReport;
use crate::limits::EVENTS_MAX;
use crate::math;
use crate::state::State;
use crate::state::bodies::{is_loose, is_loose_kind};
use crate::state::islands::Members;

/// The islands of a frame, one after the other: those first that waited for the most frames, then those
/// nearest to what the host looks at, then by label.
pub(super) struct Line {
    focus: Option<Vec3>,
    /// Nobody waits and nothing is looked at: the order is that of the labels.
    is_plain: bool,
    /// One past the last label that went, when the order is plain.
    first: usize,
}

impl Line {
    pub(super) fn new(state: &mut State, focus: Option<Vec3>) -> Self {
        let slots = state.registers.body_slots as usize;
        state.islands.went[..slots].fill(0);
        let waiting = &state.bodies.waiting[..slots];
        let waits = (0..slots).any(|body| waiting[body].frames > 0 && is_loose(state, body));
        Self {
            focus,
            is_plain: focus.is_none() && !waits,
            first: 0,
        }
    }

    /// The label of the next island, each once: going through the frame changes what its turn depends on.
    /// Cost: a pass over the bodies.
    pub(super) fn next(&mut self, state: &mut State) -> Option<usize> {
        let mut least: Option<(u64, usize)> = None;
        for label in self.first..state.registers.body_slots as usize {
            if state.islands.went[label] == 1 || !islands::begins(state, label) {
                continue;
            }
            let key = (self.key(state, label), label);
            if least.is_none_or(|least| key < least) {
                least = Some(key);
            }
            if self.is_plain {
                self.first = label + 1;
                break;
            }
        }
        let (_, label) = least?;
        state.islands.went[label] = 1;
        Some(label)
    }

    /// What goes first is least.
    fn key(&self, state: &State, label: usize) -> u64 {
        if self.is_plain {
            return 0;
        }
        let (mut frames, mut nearest) = (0, f32::INFINITY);
        for body in Members::of(state, label) {
            if is_loose_kind(state.bodies.kind[body]) {
                frames = frames.max(state.bodies.waiting[body].frames);
                let from = self.focus.unwrap_or_default();
                let away = math::length(state.bodies.pose[body].translation() - from);
                nearest = math::min(nearest, away);
            }
        }
        let place = self.focus.map_or(0, |_| nearest.to_bits());
        (u64::from(WAITED_MAX - frames) << 32) | u64::from(place)
    }
}

/// Every so many frames an island that was through with its ration gets a larger one. What it cannot use is
/// a frame in which it does not move.
const TRIES_MORE_EVERY: u64 = 8;

/// Most frames that are counted.
const WAITED_MAX: u32 = 16;

/// Lets only some bodies of an island move that was too large for the frames before: half as many for every
/// frame that ended before it moved at all, others each time. The rest stays where it is, with what speed it
/// has, so that an island of any size moves on in turns.
pub(super) fn ration(state: &mut State, label: usize) {
    let (mut loose, mut frames) = (0, 0);
    for body in Members::of(state, label) {
        if is_loose_kind(state.bodies.kind[body]) {
            loose += 1;
            frames = frames.max(state.bodies.waiting[body].frames);
        }
    }
    if frames == 0 {
        return;
    }
    let share = (loose >> frames).max(1);
    let first = (state.registers.frame % u64::from(loose)) as u32 * share % loose;
    let (mut index, mut next) = (0, Some(label));
    while let Some(body) = next {
        next = state.islands.next[body].checked_sub(1).map(|n| n as usize);
        if is_loose_kind(state.bodies.kind[body]) {
            if (index + loose - first) % loose >= share {
                state.legs.stop_time[body] = 0.0;
            }
            index += 1;
        }
    }
}

/// Notes how far an island came.
pub(super) fn note(state: &mut State, label: usize, time: f32, report: &mut FrameReport) {
    let mut next = Some(label);
    while let Some(body) = next {
        next = state.islands.next[body].checked_sub(1).map(|n| n as usize);
        if !is_loose_kind(state.bodies.kind[body]) {
            continue;
        }
        let stop = state.legs.stop_time[body];
        let tries_more = state.registers.frame.is_multiple_of(TRIES_MORE_EVERY);
        let waiting = &mut state.bodies.waiting[body];
        if time >= 1.0 {
            waiting.frames = waiting.frames.saturating_sub(u32::from(tries_more));
            waiting.hurry = waiting.hurry.saturating_sub(u32::from(tries_more));
        } else {
            let stuck = u32::from(time == 0.0);
            waiting.frames = (waiting.frames + stuck).min(WAITED_MAX);
            waiting.hurry = (waiting.hurry + 1).min(HURRY_MAX);
        }
        report.loose_cut += u32::from(stop < 1.0);
        report.kept += u32::from(stop == 0.0);
    }
}

/// How many events of an island are answered in full: all, or an eighth for every time it was cut lately.
pub(super) fn full_events(state: &State, label: usize) -> u32 {
    let mut hurry = 0;
    for body in Members::of(state, label) {
        hurry = hurry.max(state.bodies.waiting[body].hurry);
    }
    EVENTS_MAX >> (3 * hurry)
}

/// Levels of hurry; at the last, only the first event of a frame is answered.
const HURRY_MAX: u32 = 2;
