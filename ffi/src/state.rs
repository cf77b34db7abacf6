//! Saving, restoring and hashing the state.

use core::ffi::c_void;
use core::slice;

use palpable_kernel::memory::SnapshotError;

use crate::arguments::{judge, judge_optional, judge_outside, put};
use crate::block::Block;
use crate::panic::guarded;
use crate::status::{PALP_BUFFER_TOO_SMALL, PALP_DAMAGED, PALP_OK, PALP_OTHER_LAYOUT, palp_status};
use crate::types::palp_world;

const fn snapshot_status(error: SnapshotError) -> palp_status {
    match error {
        SnapshotError::TooSmall => PALP_BUFFER_TOO_SMALL,
        SnapshotError::OtherLayout => PALP_OTHER_LAYOUT,
        SnapshotError::Damaged => PALP_DAMAGED,
    }
}

/// Bytes that `palp_state_save` writes: depends on the capacities alone.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_state_bytes(
    world: *const palp_world,
    bytes: *mut usize,
) -> palp_status {
    guarded(|| {
        judge(bytes)?;
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let needed = Block::of(world)?.read(|world| Ok(world.snapshot_bytes()))?;
            put(bytes, needed);
        }
        Ok(PALP_OK)
    })
}

/// Copies the state into a buffer of `bytes` bytes of any alignment, at least as many as
/// `palp_state_bytes` says, which is how many are written. `written` may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_state_save(
    world: *const palp_world,
    buffer: *mut c_void,
    bytes: usize,
    written: *mut usize,
) -> palp_status {
    guarded(|| {
        judge_optional(written)?;
        judge(buffer.cast::<u8>())?;
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let block = Block::of(world)?;
            let size = block.read(|world| Ok(world.snapshot_bytes()))?;
            if bytes < size {
                return Err(PALP_BUFFER_TOO_SMALL);
            }
            judge_outside(&block.range(), buffer.addr(), size)?;
            let buffer = slice::from_raw_parts_mut(buffer.cast::<u8>(), size);
            let end = block.read(|world| world.save(buffer).map_err(snapshot_status))?;
            buffer[end..].fill(0);
            put(written, size);
        }
        Ok(PALP_OK)
    })
}

/// Rolls the world back to a state saved from it, or from one with the same capacities. Ids of that
/// time are good again. Its head is checked and the rest is not: load only what `palp_state_save`
/// wrote.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_state_load(
    world: *mut palp_world,
    buffer: *const c_void,
    bytes: usize,
) -> palp_status {
    guarded(|| {
        judge(buffer.cast::<u8>())?;
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let block = Block::of(world)?;
            let size = block.read(|world| Ok(world.snapshot_bytes()))?;
            let size = bytes.min(size);
            judge_outside(&block.range(), buffer.addr(), size)?;
            let buffer = slice::from_raw_parts(buffer.cast::<u8>(), size);
            block.change(|world| world.load(buffer).map_err(snapshot_status))?;
        }
        Ok(PALP_OK)
    })
}

/// A hash of the whole state: equal after equal calls, on every processor. Not a checksum against
/// forgery.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_state_hash(world: *const palp_world, hash: *mut u64) -> palp_status {
    guarded(|| {
        judge(hash)?;
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let found = Block::of(world)?.read(|world| Ok(world.hash()))?;
            put(hash, found);
        }
        Ok(PALP_OK)
    })
}
