//! How much work a frame may do, and what is left of it.

/// How much work a frame may do.
///
/// A unit is one distance query between two ordinary pieces, with the two support queries that follow it;
/// pieces of many vertices take more units ([`crate::limits::QUERY_LANES`]). Eight impulses make a unit
/// too, or 256 tests of two boxes beyond the frame's floor, and the search of a way out of overlap that the
/// host made takes [`crate::limits::WAY_OUT_UNITS`] and more at once. A stage that is refused a unit ends
/// there and takes no other: with exactly the units that a frame reports it gives the same bits again.
///
/// Who is cut goes first in the next frame, and a body for which the search of a way out is always too much is
/// led out by its legs. Before a driven body moves it is looked at where it is, which takes a query for each
/// pair of pieces whose boxes overlap there. Frames that have less go on where the last one was cut: a gap that
/// was measured counts as long as its two pieces stay, and less the way that they went when either moved. So
/// a body among things that stay moves after some frames, if each has a unit for every 32 of its pairs, and a
/// few more. With fewer it stays. There is room for as many gaps as pairs, those of all driven bodies together
/// ([`crate::memory::Capacities::pairs`]); what finds none is measured again.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// Units for moving driven bodies. With zero a driven body moves only as far as boxes alone prove
    /// its way clear; in free air that is all the way.
    pub advance_units: u32,
    /// Units for loose objects: distance queries, impulses and what each event takes.
    pub impulse_units: u32,
    /// Steps of the solvers of chains: sweeps of cyclic descent, or least-deviation steps. A chain that
    /// gets none goes as far as contact lets its joints follow the trackers.
    pub reach_steps: u32,
}

impl Budget {
    /// As much as the kernel's own bounds allow.
    pub const UNLIMITED: Self = Self {
        advance_units: u32::MAX,
        impulse_units: u32::MAX,
        reach_steps: u32::MAX,
    };
}
