//! One frame: the stages in order, and nothing else.

pub mod budget;
pub mod input;
pub mod report;

pub use budget::Budget;
pub use input::FrameInput;
pub use report::FrameReport;

use crate::limits::{FRAME_S_MAX, FRAME_S_MIN};
use crate::state::State;
use crate::{couple, driven, events, impulses, publish};

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

/// Steps a world by one frame.
pub(crate) fn step(state: &mut State, input: &FrameInput) -> FrameReport {
    let mut report = FrameReport::default();
    let Some(dt_s) = time_step(input.dt_s, &mut report) else {
        report.frame = state.registers.frame;
        return report;
    };
    state.registers.contacts = 0;
    couple::run(state, dt_s);
    driven::run(state, &input.budget, &mut report);
    if let Some(mut loose) = impulses::begin(state, dt_s, input.budget.impulse_units) {
        while let Some(island) = loose.next(state, &mut report) {
            driven::give_way(state, &input.budget, &mut report);
            loose.run(state, island, &mut report);
        }
        loose.end(state, &mut report);
        driven::lean(state);
    }
    publish::run(state, dt_s);
    events::run(state, &mut report);
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
