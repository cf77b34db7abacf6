//! How much of everything a world has room for.

use bytemuck::{Pod, Zeroable};

use crate::state;

/// How much of everything a world has room for. Plain data; zero is a valid count.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct Capacities {
    /// Bodies of all kinds.
    pub bodies: u32,
    /// Convex pieces of all bodies.
    pub pieces: u32,
    /// Vertices of all pieces: a sphere has 1, a capsule 2, a box 8. Faces and edges get the room
    /// that this many vertices can need.
    pub vertices: u32,
    /// Pairs of pieces that may touch within one frame, and gaps that driven bodies remember when one is cut.
    pub pairs: u32,
    /// Contacts of loose objects within one frame, and contacts that the host can read.
    pub contacts: u32,
    /// Materials, the three built-in ones not counted.
    pub materials: u32,
    /// Chains of joints of all bodies.
    pub chains: u32,
    /// Hinges of all chains; a ball joint is three.
    pub joints: u32,
}

impl Capacities {
    /// Enough for an avatar or two hands with fingers, a furnished room and a few loose objects.
    pub const ROOM: Self = Self {
        bodies: 64,
        pieces: 256,
        vertices: 4096,
        pairs: 1024,
        contacts: 256,
        materials: 8,
        chains: 16,
        joints: 96,
    };

    /// The bound of each capacity. They keep every byte offset below 2^40 and every index in 32 bits.
    pub const LARGEST: Self = Self {
        bodies: 1 << 20,
        pieces: 1 << 20,
        vertices: 1 << 24,
        pairs: 1 << 20,
        contacts: 1 << 20,
        materials: 1 << 8,
        chains: 1 << 16,
        joints: 1 << 20,
    };

    /// Bytes of the block that a world with these capacities needs.
    ///
    /// `usize::MAX` when a capacity is above its bound: no block is that large.
    #[must_use]
    pub const fn bytes(&self) -> usize {
        if !self.are_within_bounds() {
            return usize::MAX;
        }
        let bytes = state::State::bytes(self);
        if bytes > usize::MAX as u64 {
            return usize::MAX;
        }
        bytes as usize
    }

    /// Whether every capacity is at most its bound in [`Capacities::LARGEST`].
    #[must_use]
    pub const fn are_within_bounds(&self) -> bool {
        self.bodies <= Self::LARGEST.bodies
            && self.pieces <= Self::LARGEST.pieces
            && self.vertices <= Self::LARGEST.vertices
            && self.pairs <= Self::LARGEST.pairs
            && self.contacts <= Self::LARGEST.contacts
            && self.materials <= Self::LARGEST.materials
            && self.chains <= Self::LARGEST.chains
            && self.joints <= Self::LARGEST.joints
    }

    /// Lanes of eight vertices: every piece may leave its last lane partly empty.
    pub(crate) const fn lanes(&self) -> u32 {
        (self.vertices + 7 * self.pieces).div_ceil(8)
    }

    /// Faces that the vertices can span: 2 V - 4 a piece (Euler).
    pub(crate) const fn faces(&self) -> u32 {
        2 * self.vertices
    }

    /// Edges that the vertices can span: 3 V - 6 a piece (Euler).
    pub(crate) const fn edges(&self) -> u32 {
        3 * self.vertices
    }

    /// Entries of face loops: every edge borders two faces.
    pub(crate) const fn loops(&self) -> u32 {
        2 * self.edges()
    }
}
