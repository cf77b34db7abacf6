//! Reading what touches.

use crate::arguments::{judge, put};
use crate::block::Block;
use crate::panic::guarded;
use crate::status::{PALP_OK, palp_status};
use crate::types::{palp_contact, palp_world};

/// The contacts of the last frame. The array lies in the world's block and is good until the next call
/// that changes the world.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_contacts(
    world: *const palp_world,
    contacts: *mut *const palp_contact,
    count: *mut u32,
) -> palp_status {
    guarded(|| {
        judge(contacts)?;
        judge(count)?;
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let block = Block::of(world)?;
            let (first, number) = block.read(|world| {
                let column = world.contacts();
                Ok((block.column(column), column.len() as u32))
            })?;
            put(contacts, first);
            put(count, number);
        }
        Ok(PALP_OK)
    })
}
