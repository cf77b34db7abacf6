//! What a frame is given beside the targets.

use super::Budget;

/// What a frame is given beside the targets.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameInput {
    /// Time since the frame before, in seconds. Zero, negative or not a number: nothing moves.
    /// Otherwise kept between [`crate::limits::FRAME_S_MIN`] and [`crate::limits::FRAME_S_MAX`].
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
