//! One frame: the stages in order, and nothing else.

pub mod budget;
pub mod deadline;
pub mod input;
pub mod report;

pub use budget::Budget;
pub use deadline::{Census, CostTable, Deadline};
pub use input::FrameInput;
pub use report::FrameReport;

use glam::Vec3;

use crate::limits::{FRAME_S_MAX, FRAME_S_MIN, LOOSE_SHARE};
use crate::math;
use crate::state::State;
use crate::state::purse::Account;
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

/// What the stages of a frame may spend.
pub(crate) struct Spending<'a> {
    pub budget: Budget,
    pub costs: CostTable,
    pub account: &'a Account<'a>,
    /// The time step.
    pub dt_s: f32,
    /// What the viewer looks at.
    pub focus: Option<Vec3>,
}

/// A clock of the host's, and when the frame is to be over by it, both in nanoseconds.
#[derive(Clone, Copy)]
pub(crate) struct Clock<'a> {
    pub now_ns: &'a dyn Fn() -> u64,
    pub ends_ns: u64,
}

/// Steps a world by one frame.
pub(crate) fn step(state: &mut State, input: &FrameInput, clock: Option<Clock>) -> FrameReport {
    let mut report = FrameReport::default();
    let Some(dt_s) = time_step(input.dt_s, &mut report) else {
        report.frame = state.registers.frame;
        return report;
    };
    if math::flushes_to_zero() {
        report.set(FrameReport::FLUSHES_TO_ZERO);
    }
    let account = open_account(state, input.deadline.as_ref(), clock, &mut report);
    let spending = Spending {
        budget: input.budget,
        costs: input.deadline.map_or(CostTable::default(), |d| d.costs),
        account: &account,
        dt_s,
        focus: input.focus.map(Vec3::from_array).filter(|f| f.is_finite()),
    };
    state.registers.contacts = 0;
    couple::run(state, dt_s);
    if impulses::is_awake(state) {
        account.keep_back(LOOSE_SHARE);
    }
    driven::run(state, &spending, &mut report);
    account.next_stage();
    if let Some(mut loose) = impulses::begin(state, &spending) {
        while let Some(island) = loose.next(state, &mut report) {
            driven::give_way(state, &spending, &mut report);
            loose.run(state, island, &mut report);
        }
        driven::stop_within_cones(state, &spending, Some(loose.purse()), &mut report);
        loose.end(state, &mut report);
        driven::apart::keep(state, &spending, &mut report);
        driven::lean(state);
    }
    publish::run(state, dt_s);
    events::run(state, &mut report);
    close_account(&account, &spending.costs, &mut report);
    state.registers.frame += 1;
    report.frame = state.registers.frame;
    report.contacts = state.registers.contacts;
    report
}

/// What is left for units when the floor is paid.
fn open_account<'c>(
    state: &State,
    deadline: Option<&Deadline>,
    clock: Option<Clock<'c>>,
    report: &mut FrameReport,
) -> Account<'c> {
    let mut left_ns = u64::MAX;
    if let Some(deadline) = deadline {
        report.floor_ns = deadline.costs.floor_ns(&Census::of(state));
        left_ns = deadline.time_ns.saturating_sub(report.floor_ns);
        if deadline.time_ns < report.floor_ns {
            report.set(FrameReport::BELOW_FLOOR);
        }
    }
    Account::new(
        left_ns,
        clock.map(|clock| clock.now_ns),
        clock.map_or(u64::MAX, |clock| clock.ends_ns),
    )
}

/// Says what the frame cost and what ended it.
fn close_account(account: &Account, costs: &CostTable, report: &mut FrameReport) {
    let of = |price: u32, count: u32| u64::from(price) * u64::from(count);
    report.priced_ns = report.floor_ns
        + of(costs.advance_unit_ns, report.advance_units)
        + of(costs.impulse_unit_ns, report.impulse_units)
        + of(costs.reach_step_ns, report.reach_steps);
    if account.is_short() {
        report.set(FrameReport::OUT_OF_TIME);
    }
    if account.is_late() {
        report.set(FrameReport::LATE);
    }
}

/// The time step that is used; `None` when nothing is to move.
fn time_step(dt_s: f32, report: &mut FrameReport) -> Option<f32> {
    if !(dt_s > 0.0 && dt_s.is_finite()) {
        report.set(FrameReport::BAD_TIME_STEP);
        return None;
    }
    let used = math::clamp(dt_s, FRAME_S_MIN, FRAME_S_MAX);
    if used != dt_s {
        report.set(FrameReport::TIME_STEP_CLAMPED);
    }
    Some(used)
}
