//! The first bytes of a block: what it is, and whether it is whole.

use bytemuck::{Pod, Zeroable};

use super::hash::StateHash;
use super::{AttachError, BLOCK_ALIGNMENT, Capacities, CreateError};

/// "PALPABLE", little endian.
const MAGIC: u64 = u64::from_le_bytes(*b"PALPABLE");

/// Raised whenever a column changes: a block of another layout is refused.
pub const LAYOUT_VERSION: u32 = 1;

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

    /// The header at the start of `bytes`, if it is whole, however short the rest is.
    pub(crate) fn read_any(bytes: &[u8]) -> Option<Self> {
        let header: Self = bytemuck::pod_read_unaligned(bytes.get(..size_of::<Self>())?);
        let whole = header.magic == MAGIC && header.checksum == header.expected_checksum();
        whole.then_some(header)
    }

    /// Reads and judges the header at the start of `memory`, whatever its alignment.
    pub(crate) fn read(memory: &[u8]) -> Result<Self, AttachError> {
        let header = Self::read_alone(memory)?;
        if header.bytes > memory.len() as u64 {
            return Err(AttachError::TooSmall);
        }
        Ok(header)
    }

    /// Reads and judges the header at the start of `bytes`, however short the rest is.
    fn read_alone(bytes: &[u8]) -> Result<Self, AttachError> {
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

/// How many bytes the world takes whose block starts with these [`HEADER_BYTES`] bytes: for a host
/// that keeps the block's address alone.
///
/// # Errors
/// [`AttachError`] when the bytes start no world of this library, or a damaged one.
pub fn block_bytes(header: &[u8]) -> Result<usize, AttachError> {
    Header::read_alone(header).map(|header| header.bytes as usize)
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
