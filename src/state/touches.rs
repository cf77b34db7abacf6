//! Contacts of loose bodies from frame to frame: what they carried, to start the next frame with, and to
//! tell the host.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::memory::columns::columns;
use crate::memory::ids::PieceId;
use crate::state::State;

/// A contact of a loose body.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct Touch {
    pub piece_a: PieceId,
    pub piece_b: PieceId,
    /// Where it is on A, in the piece's frame.
    pub local: Vec3,
    /// Midway between the surfaces, in the world.
    pub point: Vec3,
    /// From B into A.
    pub normal: Vec3,
    pub gap: f32,
    /// Force on A in the last stretch of time, in newtons.
    pub force: Vec3,
    /// Impulse on A in the frame, in newton seconds.
    pub impulse: Vec3,
    /// Fastest approach in the frame before an impulse, in m/s.
    pub approach: f32,
    /// Speed along the surface, in m/s.
    pub slide: f32,
    /// One of the `*` constants.
    pub stage: u32,
}

impl Touch {
    /// Found in the last event of its island.
    pub(crate) const NOW: u32 = 0;
    /// Gone by then, but it carried an impulse in this frame.
    pub(crate) const GONE: u32 = 1;
    /// Its bodies sleep.
    pub(crate) const ASLEEP: u32 = 2;
}

columns! {
    /// Outlive the frame.
    pub(crate) struct Touches(capacities) {
        touches: [Touch; capacities.contacts],
    }
}

columns! {
    /// The touches of the frame before: scratch.
    pub(crate) struct TouchesBefore(capacities) {
        touches: [Touch; capacities.contacts],
    }
}

/// Adds a touch; its index, `None` when there is no room.
pub(crate) fn push(state: &mut State, touch: Touch) -> Option<usize> {
    let index = state.registers.touches as usize;
    *state.touches.touches.get_mut(index)? = touch;
    state.registers.touches += 1;
    Some(index)
}
