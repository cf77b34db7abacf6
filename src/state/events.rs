//! Contact events: what begins, stays and ends, for haptics and sound.

use bytemuck::{Pod, Zeroable};

use crate::memory::columns::columns;
use crate::memory::ids::PieceId;
use crate::state::materials::Material;

/// Two pieces that began to touch, still do, or came apart.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct ContactEvent {
    /// [`ContactEvent::BEGIN`], [`ContactEvent::STAY`] or [`ContactEvent::END`].
    pub kind: u32,
    /// Piece of the driven or loose body. After an end it may be gone.
    pub piece_a: PieceId,
    /// Piece of the other body.
    pub piece_b: PieceId,
    /// Material of A.
    pub material_a: Material,
    /// Material of B.
    pub material_b: Material,
    /// Mean of the contacts' points, weighted by their impulses, in the world, in metres; after an end the
    /// last one.
    pub point: [f32; 3],
    /// From B into A at the contact with the largest impulse, unit length.
    pub normal: [f32; 3],
    /// Sum of the normal impulses during the frame, in newton seconds; zero for driven against fixed.
    pub impulse_n_s: f32,
    /// Fastest approach before an impulse, in m/s: how hard the pieces met.
    pub approach_m_s: f32,
    /// Fastest slip, in m/s.
    pub slide_m_s: f32,
}

impl ContactEvent {
    /// The pieces did not touch in the frame before.
    pub const BEGIN: u32 = 1;
    /// They did.
    pub const STAY: u32 = 2;
    /// They do not any more.
    pub const END: u32 = 3;
}

columns! {
    /// Outlive the frame.
    pub(crate) struct Events(capacities) {
        /// Events of the last frame.
        list: [ContactEvent; capacities.contacts],
        /// Pieces that touch, in the order of their slots; [`ContactEvent::kind`] is not used.
        touching: [ContactEvent; capacities.contacts],
    }
}

columns! {
    /// Scratch of one frame.
    pub(crate) struct EventsNow(capacities) {
        touching: [ContactEvent; capacities.contacts],
        order: [u32; capacities.contacts],
    }
}
