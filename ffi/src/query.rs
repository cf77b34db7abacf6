//! How two bodies lie to each other, without a frame.

use palpable_kernel::world::{BodyError, BodyPenetration, World};

use crate::arguments::{judge_versioned, put_versioned, value};
use crate::block::Block;
use crate::bodies::body_status;
use crate::panic::{Outcome, guarded};
use crate::status::{PALP_OK, PALP_PAIRS_LEFT_OUT, palp_status};
use crate::types::{palp_body_id, palp_penetration_result, palp_pose, palp_world};

/// Asks the world and writes the answer.
///
/// # Safety
/// The header's rules for pointers and threads.
unsafe fn answer(
    world: *const palp_world,
    result: *mut palp_penetration_result,
    ask: impl FnOnce(&World) -> Result<BodyPenetration, BodyError>,
) -> Outcome {
    // SAFETY: the caller vouches.
    unsafe {
        let stated = judge_versioned(result)?;
        let found = Block::of(world)?.read(|world| ask(world).map_err(body_status))?;
        put_versioned(result, stated, &palp_penetration_result::new(&found));
        Ok(if found.complete {
            PALP_OK
        } else {
            PALP_PAIRS_LEFT_OUT
        })
    }
}

/// How deep two bodies overlap where they are published, and the least translation of A that parts
/// them; or how far apart they are, and the closest points. Needs no frame, changes nothing, and is
/// refused when `a` is `b`. `result->struct_size` is set by the host.
///
/// Takes about 200 kB of stack. Pairs of pieces far from each other cost a look at their boxes.
/// `PALP_PAIRS_LEFT_OUT`: more than 64 pairs of pieces are in the way of the translation, or it took
/// more rounds than 8 to find them; the depth may then be too small to part the bodies.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_penetration(
    world: *const palp_world,
    a: palp_body_id,
    b: palp_body_id,
    result: *mut palp_penetration_result,
) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            answer(world, result, |world| {
                world.penetration(a.to_kernel(), b.to_kernel())
            })
        }
    })
}

/// As `palp_penetration`, with the bodies at other poses. Their pieces keep the local poses that were
/// published: a bent finger stays bent.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_penetration_at(
    world: *const palp_world,
    a: palp_body_id,
    pose_a: *const palp_pose,
    b: palp_body_id,
    pose_b: *const palp_pose,
    result: *mut palp_penetration_result,
) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let (pose_a, pose_b) = (value(pose_a)?.to_kernel(), value(pose_b)?.to_kernel());
            answer(world, result, |world| {
                world.penetration_at(a.to_kernel(), &pose_a, b.to_kernel(), &pose_b)
            })
        }
    })
}
