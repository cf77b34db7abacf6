//! How much work a frame may do, and what is left of it.

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
