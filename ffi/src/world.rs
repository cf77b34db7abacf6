//! Making a world in the host's memory, and taking one up.

use core::ffi::{c_char, c_void};
use core::slice;

use palpable_kernel::memory::{Capacities, CreateError};
use palpable_kernel::world::World;

use crate::arguments::{judge, judge_versioned, put, put_versioned, value, versioned};
use crate::block::{Block, attach_status, block_bytes, judge_address};
use crate::panic::{guarded, guarded_or};
use crate::status::{
    PALP_CAPACITY_TOO_LARGE, PALP_MEMORY_TOO_SMALL, PALP_MISALIGNED, PALP_NOT_FINITE, PALP_OK,
    palp_status,
};
use crate::types::{palp_capacities, palp_vec3, palp_world};

const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), "\0");

/// The library's version, such as "0.1.0". Never null; lasts as long as the library is loaded.
#[unsafe(no_mangle)]
pub extern "C" fn palp_version() -> *const c_char {
    VERSION.as_ptr().cast()
}

/// Room for an avatar or two hands with fingers, a furnished room and a few loose objects: what
/// `PALP_CAPACITIES_ROOM` is at compile time. `capacities->struct_size` is set by the host.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_capacities_room(capacities: *mut palp_capacities) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers.
        unsafe {
            let stated = judge_versioned(capacities)?;
            put_versioned(capacities, stated, &palp_capacities::new(&Capacities::ROOM));
        }
        Ok(PALP_OK)
    })
}

/// Bytes of the block that a world with these capacities needs. 0 when they are refused: null, a
/// wrong `struct_size`, or a capacity beyond what any world may have.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_memory_bytes(capacities: *const palp_capacities) -> usize {
    guarded_or(0, || {
        // SAFETY: the header's rules for pointers.
        let Ok(capacities) = (unsafe { versioned(capacities) }) else {
            return 0;
        };
        let capacities = capacities.to_kernel();
        if !capacities.are_within_bounds() {
            return 0;
        }
        block_bytes(&capacities)
    })
}

/// Makes an empty world in `memory`, which holds `bytes` bytes, aligned to `PALP_BLOCK_ALIGNMENT`.
/// What they held before does not matter. The memory stays the host's: it must outlive the last call
/// with the handle, and is freed when the world is no longer wanted.
///
/// Call it as `palp_world_create`: the number in the symbol is `PALP_ABI`, so that a program built
/// with another header does not link.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_world_create_abi2(
    memory: *mut c_void,
    bytes: usize,
    capacities: *const palp_capacities,
    world: *mut *mut palp_world,
) -> palp_status {
    guarded(|| {
        judge(world)?;
        judge_address(memory.cast())?;
        // SAFETY: the header's rules for pointers.
        let capacities = unsafe { versioned(capacities) }?.to_kernel();
        // SAFETY: the host gave `bytes` bytes and does nothing else with them.
        let block = unsafe { cleared(memory.cast(), bytes, &capacities) }?;
        World::create(block, &capacities).map_err(create_status)?;
        // SAFETY: judged above.
        unsafe { put(world, memory.cast()) };
        Ok(PALP_OK)
    })
}

pub(crate) const fn create_status(error: CreateError) -> palp_status {
    match error {
        CreateError::Misaligned => PALP_MISALIGNED,
        CreateError::TooSmall => PALP_MEMORY_TOO_SMALL,
        CreateError::CapacityTooLarge => PALP_CAPACITY_TOO_LARGE,
    }
}

/// The kernel's part of a block for a new world, all zeros as the tail behind it.
///
/// # Safety
/// The host gave `bytes` bytes and does nothing else with them while `'a` lasts.
pub(crate) unsafe fn cleared<'a>(
    memory: *mut u8,
    bytes: usize,
    capacities: &Capacities,
) -> Result<&'a mut [u8], palp_status> {
    if !capacities.are_within_bounds() {
        return Err(PALP_CAPACITY_TOO_LARGE);
    }
    let needed = block_bytes(capacities);
    if bytes < needed || isize::try_from(needed).is_err() {
        return Err(PALP_MEMORY_TOO_SMALL);
    }
    // SAFETY: `bytes` bytes are the library's, at least `needed`.
    unsafe {
        memory.write_bytes(0, needed);
        Ok(slice::from_raw_parts_mut(memory, capacities.bytes()))
    }
}

/// Takes up a world that was made in `memory`, or copied there, checking that `bytes` bytes hold it. Ends a
/// recording: whoever copies a block back to where it was is to call this.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_world_attach(
    memory: *mut c_void,
    bytes: usize,
    world: *mut *mut palp_world,
) -> palp_status {
    guarded(|| {
        judge(world)?;
        judge_address(memory.cast())?;
        if isize::try_from(bytes).is_err() {
            return Err(PALP_MEMORY_TOO_SMALL);
        }
        // SAFETY: the host gave `bytes` readable bytes and does nothing else with them.
        let block = unsafe { slice::from_raw_parts_mut(memory.cast::<u8>(), bytes) };
        let kept = World::attach(block).map_err(attach_status)?;
        if bytes < block_bytes(&kept.capacities()) {
            return Err(PALP_MEMORY_TOO_SMALL);
        }
        // SAFETY: the world is whole, its tail is within `bytes`, and nobody else uses it.
        unsafe { Block::any(memory.cast())?.stop_recording() };
        // SAFETY: judged above.
        unsafe { put(world, memory.cast()) };
        Ok(PALP_OK)
    })
}

/// The most that was ever in use at once: what to ship as capacities.
/// `capacities->struct_size` is set by the host.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_high_water(
    world: *const palp_world,
    capacities: *mut palp_capacities,
) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let stated = judge_versioned(capacities)?;
            let marks = Block::of(world)?.read(|world| Ok(world.high_water()))?;
            put_versioned(capacities, stated, &palp_capacities::new(&marks));
        }
        Ok(PALP_OK)
    })
}

/// Sets the acceleration of loose bodies, in m/s2. A new world has 0, -9.81, 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_gravity_set(
    world: *mut palp_world,
    gravity_m_s2: *const palp_vec3,
) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let gravity = value(gravity_m_s2)?.to_array();
            if !gravity.iter().all(|part| part.is_finite()) {
                return Err(PALP_NOT_FINITE);
            }
            Block::of(world)?.change(|world| {
                world.set_gravity(gravity);
                Ok(PALP_OK)
            })
        }
    })
}
