//! What a frame did.

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

    pub(crate) fn set(&mut self, flag: u32) {
        self.flags |= flag;
    }
}
