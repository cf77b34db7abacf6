//! One block of the host's memory, cut into columns.
//!
//! The host supplies the block, 64-byte aligned; everything the kernel ever stores lies in it,
//! counts and free slots included. So copying the block is a snapshot, and the copy works at
//! another address.

pub mod capacities;
pub(crate) mod columns;
pub(crate) mod hash;
pub(crate) mod header;
pub mod ids;

pub use capacities::Capacities;
pub use header::{BlockHead, HEADER_BYTES, LAYOUT_VERSION};
pub use ids::{BodyId, ChainId, PieceId};

/// Alignment of the block and of every column in it, in bytes: one cache line.
pub const BLOCK_ALIGNMENT: usize = 64;

/// Why a block of memory was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CreateError {
    /// The block does not start at a multiple of [`BLOCK_ALIGNMENT`].
    Misaligned,
    /// The block is shorter than [`Capacities::bytes`].
    TooSmall,
    /// A capacity is above its bound in [`Capacities::LARGEST`].
    CapacityTooLarge,
}

/// Why a block was not taken for a world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AttachError {
    /// The block does not start at a multiple of [`BLOCK_ALIGNMENT`].
    Misaligned,
    /// The block is shorter than its own header says, or too short for a header.
    TooSmall,
    /// The block holds no world: nothing was created in it, or its header was overwritten.
    NotAWorld,
    /// The world was made by a library with another memory layout.
    OtherLayout,
    /// The header contradicts its own checksum.
    Damaged,
}

/// Why a snapshot was not saved or restored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SnapshotError {
    /// The buffer is shorter than [`Capacities::bytes`].
    TooSmall,
    /// The snapshot is of a world with other capacities or of another memory layout.
    OtherLayout,
    /// The snapshot's header contradicts its own checksum, or it holds no world at all.
    Damaged,
}
