//! What a frame did.

use super::Budget;

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
    /// Steps spent on chains; none while nothing touches one.
    pub reach_steps: u32,
    /// Contacts that the host can read.
    pub contacts: u32,
    /// Impulses applied.
    pub impulses: u32,
    /// Contact events that the host can read.
    pub events: u32,
    /// Contact events that found no room: raise [`crate::memory::Capacities::contacts`].
    pub events_dropped: u32,
    /// Time by which loose bodies were stopped before the end of the frame, at most, in seconds.
    pub lost_s: f32,
    /// Driven bodies whose way was cut: the rest follows, before all others, in the next frame.
    pub driven_cut: u32,
    /// Chains that got fewer steps than they wanted.
    pub chains_cut: u32,
    /// Loose bodies that were stopped before the end of the frame.
    pub loose_cut: u32,
    /// Bodies of both kinds that were to move and have the poses of the last frame because there was no
    /// time for them.
    pub kept: u32,
    /// What the frame costs whatever happens, by the deadline's prices, in nanoseconds; zero without one.
    pub floor_ns: u64,
    /// What it cost by those prices.
    pub priced_ns: u64,
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
    /// The budget's steps for chains were used up.
    pub const REACH_CUT: u32 = 1 << 7;
    /// The frame's time was used up, by the deadline's prices.
    pub const OUT_OF_TIME: u32 = 1 << 8;
    /// The host's clock ended the frame's work. Stepping with the units of this report as the budget, and
    /// no deadline, gives the same bits.
    pub const LATE: u32 = 1 << 9;
    /// The deadline is shorter than the frame's floor: no unit was spent.
    pub const BELOW_FLOOR: u32 = 1 << 10;
    /// The calling thread has its processor put numbers below [`f32::MIN_POSITIVE`] to zero. All promises
    /// hold but one: the bits may not be those of a thread that keeps such numbers.
    pub const FLUSHES_TO_ZERO: u32 = 1 << 11;

    pub(crate) const OF_TIME: u32 = Self::OUT_OF_TIME | Self::LATE | Self::BELOW_FLOOR;

    /// The budget that leads to the same bits without a deadline or a clock.
    #[must_use]
    pub const fn spent(&self) -> Budget {
        Budget {
            advance_units: self.advance_units,
            impulse_units: self.impulse_units,
            reach_steps: self.reach_steps,
        }
    }

    pub(crate) fn set(&mut self, flag: u32) {
        self.flags |= flag;
    }
}
