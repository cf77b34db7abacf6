//! The first bytes of a block: what it is, and whether it is whole.

use bytemuck::{Pod, Zeroable};

use super::hash::StateHash;
use super::{AttachError, BLOCK_ALIGNMENT, Capacities, CreateError, SnapshotError};

/// "PALPABLE", little endian.
const MAGIC: u64 = u64::from_le_bytes(*b"PALPABLE");

/// Raised whenever a column changes: a block of another layout is refused.
pub const LAYOUT_VERSION: u32 = 7;

/// What a block says about itself.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct Header {
    magic: u64,
    bytes: u64,
    layout_version: u32,
    pub(crate) capacities: Capacities,
    padding: u32,
    checksum: u64,
}

impl Header {
    pub(crate) fn new(capacities: &Capacities) -> Self {
        let mut header = Self {
            magic: MAGIC,
            bytes: capacities.bytes() as u64,
            layout_version: LAYOUT_VERSION,
            capacities: *capacities,
            padding: 0,
            checksum: 0,
        };
        header.checksum = header.expected_checksum();
        header
    }

    fn expected_checksum(&self) -> u64 {
        let mut hash = StateHash::new();
        let unsigned = Self {
            checksum: 0,
            ..*self
        };
        hash.bytes(bytemuck::bytes_of(&unsigned));
        hash.value()
    }

    /// The header at the start of a snapshot, however short the rest is. The version is judged before the
    /// checksum: another layout may have another header.
    pub(crate) fn read_snapshot(bytes: &[u8]) -> Result<Self, SnapshotError> {
        let bytes = bytes
            .get(..size_of::<Self>())
            .ok_or(SnapshotError::Damaged)?;
        let header: Self = bytemuck::pod_read_unaligned(bytes);
        if header.magic != MAGIC {
            return Err(SnapshotError::Damaged);
        }
        if header.layout_version != LAYOUT_VERSION {
            return Err(SnapshotError::OtherLayout);
        }
        if header.checksum != header.expected_checksum() {
            return Err(SnapshotError::Damaged);
        }
        Ok(header)
    }

    /// Reads and judges the header at the start of `bytes`, however short the rest is.
    fn read(bytes: &[u8]) -> Result<Self, AttachError> {
        let bytes = bytes
            .get(..size_of::<Self>())
            .ok_or(AttachError::TooSmall)?;
        let header: Self = bytemuck::pod_read_unaligned(bytes);
        if header.magic != MAGIC {
            return Err(AttachError::NotAWorld);
        }
        if header.layout_version != LAYOUT_VERSION {
            return Err(AttachError::OtherLayout);
        }
        let whole = header.checksum == header.expected_checksum()
            && header.capacities.are_within_bounds()
            && header.bytes == header.capacities.bytes() as u64;
        if !whole {
            return Err(AttachError::Damaged);
        }
        Ok(header)
    }
}

/// Bytes at the start of a block that tell how long it is.
pub const HEADER_BYTES: usize = size_of::<Header>();

/// The head of a block, read and judged: for a host that keeps the block's address alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlockHead(Header);

impl BlockHead {
    /// Judges the head that starts with these bytes, at least [`HEADER_BYTES`] of them.
    ///
    /// # Errors
    /// [`AttachError`] when the bytes start no world of this library, or a damaged one.
    pub fn read(bytes: &[u8]) -> Result<Self, AttachError> {
        Header::read(bytes).map(Self)
    }

    /// How many bytes the world takes.
    #[must_use]
    pub const fn bytes(&self) -> usize {
        self.0.bytes as usize
    }

    pub(crate) const fn capacities(&self) -> Capacities {
        self.0.capacities
    }

    /// Whether `memory` starts with this head.
    pub(crate) fn starts(&self, memory: &[u8]) -> bool {
        memory.starts_with(bytemuck::bytes_of(&self.0))
    }
}

/// Whether the block starts where a block may start.
pub(crate) fn is_aligned(memory: &[u8]) -> bool {
    memory.as_ptr().addr().is_multiple_of(BLOCK_ALIGNMENT)
}

/// Whether a world with these capacities can be made in this block.
pub(crate) fn judge(memory: &[u8], capacities: &Capacities) -> Result<(), CreateError> {
    if !capacities.are_within_bounds() {
        return Err(CreateError::CapacityTooLarge);
    }
    if !is_aligned(memory) {
        return Err(CreateError::Misaligned);
    }
    if memory.len() < capacities.bytes() {
        return Err(CreateError::TooSmall);
    }
    Ok(())
}
