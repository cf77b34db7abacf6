//! Reading what touches.

use palpable_kernel::world::World;

use crate::arguments::{judge, put};
use crate::block::Block;
use crate::panic::{Outcome, guarded};
use crate::status::{PALP_OK, palp_status};
use crate::types::{palp_contact, palp_contact_event, palp_world};

/// Hands out a column of the last frame.
///
/// # Safety
/// The header's rules for pointers and threads; `T` in C is `U`.
unsafe fn column<T, U>(
    world: *const palp_world,
    first: *mut *const U,
    count: *mut u32,
    of: impl for<'w> FnOnce(&'w World<'_>) -> &'w [T],
) -> Outcome {
    judge(first)?;
    judge(count)?;
    // SAFETY: the caller vouches.
    unsafe {
        let block = Block::of(world)?;
        let (start, number) = block.read(|world| {
            let column = of(world);
            Ok((block.column(column), column.len() as u32))
        })?;
        put(first, start);
        put(count, number);
    }
    Ok(PALP_OK)
}

/// The contacts of the last frame. The array lies in the world's block and is good until the next call
/// that changes the world.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_contacts(
    world: *const palp_world,
    contacts: *mut *const palp_contact,
    count: *mut u32,
) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers and threads.
        unsafe { column(world, contacts, count, |world| world.contacts()) }
    })
}

/// What began to touch, stayed and parted in the last frame: one event for each pair of pieces, first those
/// that began, then those that ended, then those that stayed. Bodies that sleep go on touching without being
/// told of. The array lies in the world's block and is good until the next call that changes the world. What
/// found no room, those that stayed before all others, is counted in `palp_frame_report.events_dropped`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_contact_events(
    world: *const palp_world,
    events: *mut *const palp_contact_event,
    count: *mut u32,
) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers and threads.
        unsafe { column(world, events, count, |world| world.contact_events()) }
    })
}
