//! What a frame is given beside the targets.

use super::{Budget, Deadline};

/// What a frame is given beside the targets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameInput {
    /// Time since the frame before, in seconds. Zero, negative or not a number: nothing moves.
    /// Otherwise kept between [`crate::limits::FRAME_S_MIN`] and [`crate::limits::FRAME_S_MAX`].
    pub dt_s: f32,
    /// How much work the frame may do.
    pub budget: Budget,
    /// How long it may take, by the prices of the host's machine; `None` for as long as the budget lasts.
    pub deadline: Option<Deadline>,
    /// What the viewer looks at, in the world, in metres: when time is short, what is near goes first.
    /// What is not finite counts as `None`.
    pub focus: Option<[f32; 3]>,
}

impl FrameInput {
    /// A frame of this length with an unlimited budget.
    #[must_use]
    pub const fn unlimited(dt_s: f32) -> Self {
        Self {
            dt_s,
            budget: Budget::UNLIMITED,
            deadline: None,
            focus: None,
        }
    }

    /// A frame of this length that takes no longer than a deadline.
    #[must_use]
    pub const fn within(dt_s: f32, deadline: Deadline) -> Self {
        Self {
            deadline: Some(deadline),
            ..Self::unlimited(dt_s)
        }
    }
}
