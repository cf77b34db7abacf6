//! From a handle to the world in its block.

use core::ops::Range;

use palpable_kernel::memory::{AttachError, BLOCK_ALIGNMENT, BlockHead, HEADER_BYTES};
use palpable_kernel::world::World;

use crate::status::{
    PALP_DAMAGED, PALP_MEMORY_TOO_SMALL, PALP_MISALIGNED, PALP_NOT_A_WORLD, PALP_NULL,
    PALP_OTHER_LAYOUT, palp_status,
};
use crate::types::palp_world;

pub(crate) const fn attach_status(error: AttachError) -> palp_status {
    match error {
        AttachError::Misaligned => PALP_MISALIGNED,
        AttachError::TooSmall => PALP_MEMORY_TOO_SMALL,
        AttachError::NotAWorld => PALP_NOT_A_WORLD,
        AttachError::OtherLayout => PALP_OTHER_LAYOUT,
        AttachError::Damaged => PALP_DAMAGED,
    }
}

/// Refuses an address that no block can have.
pub(crate) fn judge_address(memory: *const u8) -> Result<(), palp_status> {
    if memory.is_null() {
        return Err(PALP_NULL);
    }
    if !memory.addr().is_multiple_of(BLOCK_ALIGNMENT) {
        return Err(PALP_MISALIGNED);
    }
    Ok(())
}

/// A world's block: where it starts, and how long its own head says that it is.
#[derive(Clone, Copy)]
pub(crate) struct Block {
    start: *mut u8,
    head: BlockHead,
}

impl Block {
    /// The block behind a handle.
    ///
    /// # Safety
    /// A handle that is neither null nor misaligned is readable for a header; if a whole header lies
    /// there, then so does the block that it tells of.
    pub(crate) unsafe fn of(world: *const palp_world) -> Result<Self, palp_status> {
        let start = world.cast_mut().cast::<u8>();
        judge_address(start)?;
        // SAFETY: readable by contract.
        let header = unsafe { core::slice::from_raw_parts(start, HEADER_BYTES) };
        let head = BlockHead::read(header).map_err(attach_status)?;
        Ok(Self { start, head })
    }

    /// Addresses of the block.
    pub(crate) fn range(&self) -> Range<usize> {
        self.start.addr()..self.start.addr() + self.head.bytes()
    }

    /// The same column as the kernel sees it, through the host's own pointer.
    pub(crate) fn column<T, U>(&self, column: &[T]) -> *const U {
        let offset = column.as_ptr().addr() - self.start.addr();
        self.start.wrapping_add(offset).cast_const().cast::<U>()
    }

    /// Asks the world something.
    ///
    /// # Safety
    /// Nobody changes the block meanwhile.
    pub(crate) unsafe fn read<R>(
        &self,
        ask: impl FnOnce(&World) -> Result<R, palp_status>,
    ) -> Result<R, palp_status> {
        // SAFETY: the caller vouches; `ask` cannot change the world.
        unsafe { self.change(|world| ask(world)) }
    }

    /// Does something to the world.
    ///
    /// # Safety
    /// Nobody else uses the block meanwhile.
    pub(crate) unsafe fn change<R>(
        &self,
        act: impl FnOnce(&mut World) -> Result<R, palp_status>,
    ) -> Result<R, palp_status> {
        // SAFETY: the header vouched for the length, and the caller for nobody else being there.
        let memory = unsafe { core::slice::from_raw_parts_mut(self.start, self.head.bytes()) };
        let mut world = World::attach_known(memory, &self.head).map_err(attach_status)?;
        act(&mut world)
    }
}
