//! 4 reach: joint angles that take a chain's links where they are allowed to be.
//!
//! Two methods share one interface and one unit of work, a step: the paper's cyclic coordinate descent
//! with mended formulas, and the least deviation from the tracked angles. Nothing here knows about
//! frames or bodies yet, and no frame calls it: a host may, with goals of its own. Limits of ball joints
//! are [`crate::geometry::reach_cone`].

pub mod cyclic_descent;
pub mod goal;
pub mod least_deviation;
mod root;

pub(crate) use root::plan;

use crate::state::ways::Position;

/// Where the next leg goes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plan {
    pub goal: Position,
    /// Contact changed the goal.
    pub bent: bool,
}
