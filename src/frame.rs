//! One frame: the stages in order, and nothing else.

use crate::limits::{FRAME_S_MAX, FRAME_S_MIN};
use crate::state::State;
use crate::{advance, couple, impulses, publish};

/// The stages of a frame, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Where driven things want to be.
    Couple,
    /// Which pieces may touch this frame.
    Pairs,
    /// How far apart or how deep those pairs are.
    Contacts,
    /// Joint angles that take links out.
    Reach,
    /// Moving along a path that never overlaps.
    Advance,
    /// What the loose objects do.
    Impulses,
    /// Poses for the host to draw.
    Publish,
}

/// How much work a frame may do. A unit is one distance query between two pieces, with the two
/// support queries that follow it; its cost grows with the pieces' vertex counts.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// Units for moving driven bodies. With zero a driven body moves only as far as boxes alone prove
    /// its way clear; in free air that is all the way.
    pub advance_units: u32,
    /// Units for loose objects: distance queries and impulses.
    pub impulse_units: u32,
}

impl Budget {
    /// As much as the kernel's own bounds allow.
    pub const UNLIMITED: Self = Self {
        advance_units: u32::MAX,
        impulse_units: u32::MAX,
    };
}

/// What a frame is given beside the targets.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameInput {
    /// Time since the frame before, in seconds. Zero, negative or not a number: nothing moves.
    /// Otherwise kept between [`FRAME_S_MIN`] and [`FRAME_S_MAX`].
    pub dt_s: f32,
    /// How much work the frame may do.
    pub budget: Budget,
}

impl FrameInput {
    /// A frame of this length with an unlimited budget.
    #[must_use]
    pub const fn unlimited(dt_s: f32) -> Self {
        Self {
            dt_s,
            budget: Budget::UNLIMITED,
        }
    }
}

/// What a frame did.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameReport {
    /// Frames stepped so far, this one included.
    pub frame: u64,
    /// Bits of [`FrameReport::BAD_TIME_STEP`] and the others.
    pub flags: u32,
    /// Units spent on driven bodies.
    pub advance_units: u32,
    /// Units spent on loose objects.
    pub impulse_units: u32,
    /// Contacts that the host can read.
    pub contacts: u32,
    /// Impulses applied.
    pub impulses: u32,
    /// Time by which loose bodies were stopped before the end of the frame, at most, in seconds.
    pub lost_s: f32,
}

impl FrameReport {
    /// The time step was not a positive number: nothing moved.
    pub const BAD_TIME_STEP: u32 = 1;
    /// The time step was clamped.
    pub const TIME_STEP_CLAMPED: u32 = 1 << 1;
    /// A driven body's way was cut by the budget.
    pub const ADVANCE_CUT: u32 = 1 << 2;
    /// Loose bodies were stopped early by the budget or by the bound on events.
    pub const IMPULSES_CUT: u32 = 1 << 3;
    /// Pairs were left out and their movers held: raise [`crate::memory::Capacities::pairs`].
    pub const FULL_PAIRS: u32 = 1 << 4;
    /// Contacts were left out: raise [`crate::memory::Capacities::contacts`].
    pub const FULL_CONTACTS: u32 = 1 << 5;
    /// A driven body overlaps a fixed one where the host put it.
    pub const OVERLAP: u32 = 1 << 6;

    pub(crate) fn set(&mut self, flag: u32) {
        self.flags |= flag;
    }
}

/// Steps a world by one frame.
pub(crate) fn step(state: &mut State, input: &FrameInput) -> FrameReport {
    let mut report = FrameReport::default();
    let Some(dt_s) = time_step(input.dt_s, &mut report) else {
        report.frame = state.registers.frame;
        return report;
    };
    state.registers.contacts = 0;
    couple::run(state, dt_s);
    report.advance_units = advance::run(state, input.budget.advance_units, &mut report);
    impulses::run(state, dt_s, input.budget.impulse_units, &mut report);
    publish::run(state);
    state.registers.frame += 1;
    report.frame = state.registers.frame;
    report.contacts = state.registers.contacts;
    report
}

/// The time step that is used; `None` when nothing is to move.
fn time_step(dt_s: f32, report: &mut FrameReport) -> Option<f32> {
    if !(dt_s > 0.0 && dt_s.is_finite()) {
        report.set(FrameReport::BAD_TIME_STEP);
        return None;
    }
    let used = crate::math::clamp(dt_s, FRAME_S_MIN, FRAME_S_MAX);
    if used != dt_s {
        report.set(FrameReport::TIME_STEP_CLAMPED);
    }
    Some(used)
}
