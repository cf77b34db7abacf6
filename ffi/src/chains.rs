//! Skeletons: adding, driving and reading chains of joints.

use palpable_kernel::geometry::chain::JointDef;
use palpable_kernel::limits::CHAIN_HINGES_MAX;
use palpable_kernel::memory::ChainId;
use palpable_kernel::world::{AddChainError, ChainDef, ChainError, World};

use crate::arguments::{
    array, each_versioned, judge, judge_optional, judge_versioned, put, put_versioned, value,
    versioned,
};
use crate::block::Block;
use crate::bodies::kernel_poses;
use crate::panic::{Outcome, guarded};
use crate::pieces::{add_status as piece_status, with_piece};
use crate::skeleton::{
    PALP_CONE_CORNERS_MAX, cone, palp_chain_def, palp_chain_id, palp_chain_options,
    palp_chain_state, palp_joint,
};
use crate::status::{
    PALP_BAD_AXIS, PALP_BAD_BASE, PALP_BAD_OPTIONS, PALP_BAD_POSE, PALP_BAD_RANGE,
    PALP_CHAIN_IN_USE, PALP_CONE_TOO_MANY_CORNERS, PALP_FULL_CHAINS, PALP_FULL_JOINTS,
    PALP_NOT_FINITE, PALP_OK, PALP_STALE_BODY, PALP_STALE_CHAIN, PALP_TOO_MANY_CHAINS,
    PALP_WRONG_COUNT, PALP_WRONG_KIND, palp_status,
};
use crate::types::{palp_body_id, palp_piece_def, palp_piece_id, palp_pose, palp_vec3, palp_world};

const fn add_status(error: AddChainError) -> palp_status {
    match error {
        AddChainError::StaleBody => PALP_STALE_BODY,
        AddChainError::WrongKind => PALP_WRONG_KIND,
        AddChainError::FullChains => PALP_FULL_CHAINS,
        AddChainError::FullJoints => PALP_FULL_JOINTS,
        AddChainError::TooManyChains => PALP_TOO_MANY_CHAINS,
        AddChainError::WrongCount => PALP_WRONG_COUNT,
        AddChainError::BadBase => PALP_BAD_BASE,
        AddChainError::BadPose => PALP_BAD_POSE,
        AddChainError::BadAxis => PALP_BAD_AXIS,
        AddChainError::BadRange => PALP_BAD_RANGE,
        AddChainError::BadOptions => PALP_BAD_OPTIONS,
    }
}

const fn chain_status(error: ChainError) -> palp_status {
    match error {
        ChainError::Stale => PALP_STALE_CHAIN,
        ChainError::WrongCount => PALP_WRONG_COUNT,
        ChainError::BadAngle => PALP_NOT_FINITE,
        ChainError::BadPose => PALP_BAD_POSE,
        ChainError::BadOptions => PALP_BAD_OPTIONS,
        ChainError::InUse => PALP_CHAIN_IN_USE,
    }
}

/// A chain's joints, copied next to each other.
struct Joints {
    list: [JointDef; CHAIN_HINGES_MAX],
    count: usize,
}

impl Joints {
    /// Gathers the joints of a definition.
    ///
    /// # Safety
    /// The joints are readable: `joint_count` of them, `joint_stride` bytes apart.
    unsafe fn gather(def: &palp_chain_def, block: &Block) -> Result<Self, palp_status> {
        let count = def.joint_count as usize;
        if count == 0 || count > CHAIN_HINGES_MAX {
            return Err(PALP_WRONG_COUNT);
        }
        let mut list = [JointDef::Hinge(palp_joint::NONE.hinge()); CHAIN_HINGES_MAX];
        let take = |index: usize, joint: &palp_joint| {
            list[index] = joint.to_kernel()?;
            Ok(())
        };
        // SAFETY: the caller vouches.
        unsafe {
            each_versioned(
                def.joints,
                def.joint_count,
                def.joint_stride,
                &block.range(),
                take,
            )?;
        }
        Ok(Self { list, count })
    }
}

/// Adds a chain of joints to a driven body, behind those it has: an arm, a leg, a finger. Its angles
/// begin at zero, or where the limits are nearest to it, and are held there until targets come.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_chain_add(
    world: *mut palp_world,
    body: palp_body_id,
    def: *const palp_chain_def,
    chain: *mut palp_chain_id,
) -> palp_status {
    guarded(|| {
        judge(chain)?;
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let def = versioned(def)?;
            let block = Block::of(world)?;
            let joints = Joints::gather(&def, &block)?;
            let made = ChainDef {
                joints: &joints.list[..joints.count],
                base: def.kernel_base(),
                options: def.options.to_kernel(),
            };
            let id = block
                .change(|world| world.add_chain(body.to_kernel(), &made).map_err(add_status))?;
            put(chain, palp_chain_id::new(id));
        }
        Ok(PALP_OK)
    })
}

/// Does something to a chain.
///
/// # Safety
/// The header's rules for pointers and threads.
unsafe fn change(
    world: *mut palp_world,
    chain: palp_chain_id,
    act: impl FnOnce(&mut World, ChainId) -> Result<(), ChainError>,
) -> Outcome {
    // SAFETY: the caller vouches.
    unsafe {
        Block::of(world)?.change(|world| act(world, chain.to_kernel()).map_err(chain_status))?;
    }
    Ok(PALP_OK)
}

/// Removes a chain and the pieces on its links. Refused while another chain hangs on it. Costs one pass
/// over all pieces' vertices for each of its pieces, and one over all joints.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_chain_remove(
    world: *mut palp_world,
    chain: palp_chain_id,
) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers and threads.
        unsafe { change(world, chain, |world, chain| world.remove_chain(chain)) }
    })
}

/// Says how a chain answers contact from the next frame on.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_chain_set_options(
    world: *mut palp_world,
    chain: palp_chain_id,
    options: *const palp_chain_options,
) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let options = value(options)?.to_kernel();
            change(world, chain, |world, chain| {
                world.set_chain_options(chain, &options)
            })
        }
    })
}

/// Adds a piece to the link behind a hinge of a chain, `hinge` counting from 0, three to a ball. The
/// piece's `local_pose` is in that link's frame. Counts as the body's last piece.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_chain_add_piece(
    world: *mut palp_world,
    chain: palp_chain_id,
    hinge: u32,
    def: *const palp_piece_def,
    piece: *mut palp_piece_id,
) -> palp_status {
    guarded(|| {
        judge(piece)?;
        let chain = chain.to_kernel();
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let id = with_piece(def, |def| {
                Block::of(world)?.change(|world| {
                    world
                        .add_link_piece(chain, hinge, def)
                        .map_err(piece_status)
                })
            })?;
            put(piece, palp_piece_id::new(id));
        }
        Ok(PALP_OK)
    })
}

/// Tells where the tracker wants a chain's hinges, in radians, from the base on, three to a ball. What is
/// outside a range or a reach cone becomes the nearest that is inside. The chain moves there over the
/// frame, as far as contact allows, and keeps its targets until others come. Refused as a whole when
/// `count` is not the number of hinges or an angle is not finite.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_chain_set_angles(
    world: *mut palp_world,
    chain: palp_chain_id,
    angles_rad: *const f32,
    count: u32,
) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let angles = array(angles_rad, count, &Block::of(world)?.range())?;
            change(world, chain, |world, chain| world.set_angles(chain, angles))
        }
    })
}

/// Tells where the tracker sees a chain's links: one pose in the world for each joint of its definition,
/// a ball being one joint, that of the link behind it. Only the orientations count; what the joints
/// cannot do is left out. Instead of `palp_chain_set_angles`; call it behind `palp_body_set_target`, and
/// for a chain behind the one that it hangs on.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_chain_set_link_poses(
    world: *mut palp_world,
    chain: palp_chain_id,
    poses: *const palp_pose,
    count: u32,
) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let poses = kernel_poses(array(poses, count, &Block::of(world)?.range())?);
            change(world, chain, |world, chain| {
                world.set_link_poses(chain, poses)
            })
        }
    })
}

/// Tells where the tracker sees the last link alone, in the world: a controller in the hand. The targets
/// become the angles that bring the link there with the least change from `posture_rad`, one angle for
/// each hinge, or that come as near as the limits allow. Give a relaxed posture, the same in every frame:
/// then nothing drifts. `distance_m`, which may be null, gets how far from there the link's origin is
/// then, in metres.
/// Instead of `palp_chain_set_angles`; call it behind `palp_body_set_target`, and for a chain behind the
/// one that it hangs on. Costs at most 16 steps of the least-deviation solver.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_chain_set_tip(
    world: *mut palp_world,
    chain: palp_chain_id,
    tip: *const palp_pose,
    posture_rad: *const f32,
    count: u32,
    distance_m: *mut f32,
) -> palp_status {
    guarded(|| {
        judge_optional(distance_m)?;
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let tip = value(tip)?.to_kernel();
            let block = Block::of(world)?;
            let posture = array(posture_rad, count, &block.range())?;
            let distance = block.change(|world| {
                world
                    .set_tip(chain.to_kernel(), &tip, posture)
                    .map_err(chain_status)
            })?;
            put(distance_m, distance);
        }
        Ok(PALP_OK)
    })
}

/// Puts a chain's hinges at angles at once, without a way there; they become the targets too. What is
/// outside the limits becomes the nearest that is inside. Overlap made so is reported by the next frame
/// and never gets deeper.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_chain_place(
    world: *mut palp_world,
    chain: palp_chain_id,
    angles_rad: *const f32,
    count: u32,
) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let angles = array(angles_rad, count, &Block::of(world)?.range())?;
            change(world, chain, |world, chain| {
                world.place_angles(chain, angles)
            })
        }
    })
}

/// Hands out a column of a chain.
///
/// # Safety
/// The header's rules for pointers and threads; `T` in C is `U`.
unsafe fn column<T, U>(
    world: *const palp_world,
    first: *mut *const U,
    count: *mut u32,
    of: impl for<'w> FnOnce(&'w World<'_>) -> Result<&'w [T], ChainError>,
) -> Outcome {
    judge(first)?;
    judge_optional(count)?;
    // SAFETY: the caller vouches.
    unsafe {
        let block = Block::of(world)?;
        let (start, number) = block.read(|world| {
            let column = of(world).map_err(chain_status)?;
            Ok((block.column(column), column.len() as u32))
        })?;
        put(first, start);
        put(count, number);
    }
    Ok(PALP_OK)
}

/// The published angles of a chain's hinges in radians, from the base on. The array lies in the world's
/// block and is good until the next call that changes the world. `count` may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_chain_angles(
    world: *const palp_world,
    chain: palp_chain_id,
    angles_rad: *mut *const f32,
    count: *mut u32,
) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            column::<f32, f32>(world, angles_rad, count, |world| {
                world.angles(chain.to_kernel())
            })
        }
    })
}

/// The target angles of a chain's hinges in radians, as the limits left them. The array lies in the
/// world's block and is good until the next call that changes the world. `count` may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_chain_target_angles(
    world: *const palp_world,
    chain: palp_chain_id,
    angles_rad: *mut *const f32,
    count: *mut u32,
) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            column::<f32, f32>(world, angles_rad, count, |world| {
                world.target_angles(chain.to_kernel())
            })
        }
    })
}

/// The published poses of a chain's links in the world, one behind each hinge. The array lies in the
/// world's block and is good until the next call that changes the world. `count` may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_chain_link_poses(
    world: *const palp_world,
    chain: palp_chain_id,
    poses: *mut *const palp_pose,
    count: *mut u32,
) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            column(world, poses, count, |world| {
                world.link_poses(chain.to_kernel())
            })
        }
    })
}

/// What the last frame did to a chain. `state->struct_size` is set by the host.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_chain_report(
    world: *const palp_world,
    chain: palp_chain_id,
    state: *mut palp_chain_state,
) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let stated = judge_versioned(state)?;
            let report = Block::of(world)?
                .read(|world| world.chain_report(chain.to_kernel()).map_err(chain_status))?;
            put_versioned(state, stated, &palp_chain_state::new(&report));
        }
        Ok(PALP_OK)
    })
}

/// Whether directions make a reach cone: PALP_OK, or the `PALP_CONE_` status with which `palp_chain_add`
/// would refuse a ball with it. For tools that author skeletons; needs no world.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_cone_check(
    visible: *const palp_vec3,
    corners: *const palp_vec3,
    count: u32,
) -> palp_status {
    guarded(|| {
        if count > PALP_CONE_CORNERS_MAX {
            return Err(PALP_CONE_TOO_MANY_CORNERS);
        }
        // SAFETY: the header's rules for pointers.
        unsafe { cone(value(visible)?, array(corners, count, &(0..0))?)? };
        Ok(PALP_OK)
    })
}
