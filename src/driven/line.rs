//! In which order driven bodies go when time may run out.

use glam::Vec3;

use crate::frame::FrameReport;
use crate::math;
use crate::state::State;
use crate::state::bodies::{BodyKind, DrivenReport, is_body_of};

/// The driven bodies of a frame, one after the other: those first that waited for the most frames, then
/// those that overlap where the host put them, then those nearest to what the host looks at, then by slot.
///
/// Whoever is cut waits, and whoever waits comes before all that did not. Who was cut though it went first had
/// its turn, and goes behind all others that wait; so with two bodies or two hundred each gets the whole of a
/// frame's time in turn, and none that is never through keeps the others from theirs.
pub(super) struct Line {
    focus: Option<Vec3>,
    /// Key of the last that went.
    last: Option<(u64, usize)>,
    turn: u32,
    /// Who went first.
    head: Option<usize>,
    /// The bodies before this one went in the same order in the last frame.
    pub(super) is_as_before: bool,
}

impl Line {
    pub(super) const fn new(focus: Option<Vec3>) -> Self {
        Self {
            focus,
            last: None,
            turn: 0,
            head: None,
            is_as_before: true,
        }
    }

    /// The next body. Cost: a pass over the bodies.
    pub(super) fn next(&mut self, state: &mut State) -> Option<usize> {
        let mut least: Option<(u64, usize)> = None;
        for body in 0..state.registers.body_slots as usize {
            if !is_body_of(state, body, BodyKind::Driven) {
                continue;
            }
            let key = (self.key(state, body), body);
            let is_new = self.last.is_none_or(|last| key > last);
            if is_new && least.is_none_or(|least| key < least) {
                least = Some(key);
            }
        }
        let (_, body) = least?;
        self.last = least;
        self.head = self.head.or(Some(body));
        let settled = &mut state.bodies.settled[body];
        self.is_as_before &= settled.turn == self.turn;
        settled.turn = self.turn;
        self.turn += 1;
        Some(body)
    }

    /// What goes first is least.
    fn key(&self, state: &State, body: usize) -> u64 {
        let waiting = &state.bodies.waiting[body];
        let distance = self.focus.map_or(0.0, |focus| {
            math::length(state.bodies.pose[body].translation() - focus)
        });
        // Bits of floats that are not negative are in the floats' order.
        let place = u64::from(distance.to_bits());
        let patience = u64::from(u16::MAX) - u64::from(waiting.frames.min(u32::from(u16::MAX)));
        (patience << 33) | (u64::from(waiting.overlaps == 0) << 32) | place
    }

    /// Notes who has to wait.
    pub(super) fn end(self, state: &mut State, report: &mut FrameReport) {
        for body in 0..state.registers.body_slots as usize {
            if is_body_of(state, body, BodyKind::Driven) {
                let flags = state.bodies.report[body].flags;
                let chains = super::chains_cut(state, body);
                let is_cut = flags & DrivenReport::CUT != 0 || chains > 0;
                report.chains_cut += chains;
                let waiting = &mut state.bodies.waiting[body];
                let had_turn = self.head == Some(body);
                (waiting.frames, waiting.turns) = match (is_cut, had_turn) {
                    (false, _) => (0, 0),
                    (true, true) => (1, waiting.turns.wrapping_add(1)),
                    (true, false) => (waiting.frames.max(1).saturating_add(1), waiting.turns),
                };
                waiting.overlaps = u32::from(flags & DrivenReport::OVERLAPS != 0);
                report.driven_cut += u32::from(is_cut);
                report.kept += u32::from(is_cut && state.legs.count[body] == 0);
            }
        }
    }
}
