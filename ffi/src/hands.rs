//! Hand trackers, as OpenXR delivers them.

use core::ffi::c_void;

use palpable_kernel::math::Pose;
use palpable_kernel::world::{JointInput, JointUse, SetJointsError};

use crate::arguments::{array, judge, judge_optional, put};
use crate::block::Block;
use crate::bodies::kernel_poses;
use crate::panic::guarded;
use crate::status::{
    PALP_BAD_NUMBER, PALP_BAD_POSE, PALP_BAD_STRIDE, PALP_JOINTS_IGNORED, PALP_OK, PALP_STALE_BODY,
    PALP_TRACKING_LOST, PALP_UNKNOWN_JOINT, PALP_WRONG_COUNT, PALP_WRONG_KIND, palp_status,
};
use crate::types::{PALP_HAND_JOINTS, palp_body_id, palp_pose, palp_world};

const JOINTS: usize = PALP_HAND_JOINTS as usize;

/// `XR_HAND_JOINT_WRIST_EXT`.
const WRIST: usize = 1;

/// `XR_SPACE_LOCATION_ORIENTATION_VALID_BIT | XR_SPACE_LOCATION_POSITION_VALID_BIT`.
const VALID: u64 = 3;

/// `XrHandJointLocationEXT`.
#[repr(C)]
#[derive(Clone, Copy)]
struct JointLocation {
    flags: u64,
    pose: palp_pose,
    radius_m: f32,
}

const _: () = assert!(size_of::<JointLocation>() == 40);

const fn joints_status(error: SetJointsError) -> palp_status {
    match error {
        SetJointsError::Stale => PALP_STALE_BODY,
        SetJointsError::WrongKind | SetJointsError::OnLinks => PALP_WRONG_KIND,
        SetJointsError::WrongCount => PALP_WRONG_COUNT,
        SetJointsError::UnknownJoint => PALP_UNKNOWN_JOINT,
        SetJointsError::BadOffset => PALP_BAD_POSE,
        SetJointsError::BadReach => PALP_BAD_NUMBER,
    }
}

fn use_status(used: &JointUse) -> palp_status {
    if !used.root {
        PALP_TRACKING_LOST
    } else if used.pieces_kept > 0 {
        PALP_JOINTS_IGNORED
    } else {
        PALP_OK
    }
}

/// The joints that the runtime says it knows.
///
/// # Safety
/// 40 bytes are readable at each of 26 places, `stride` bytes apart.
unsafe fn known_joints(
    locations: *const c_void,
    stride: u32,
) -> Result<[Option<Pose>; JOINTS], palp_status> {
    let size = size_of::<JointLocation>();
    let stride = if stride == 0 { size } else { stride as usize };
    judge(locations.cast::<u8>())?;
    if stride < size {
        return Err(PALP_BAD_STRIDE);
    }
    let mut joints = [None; JOINTS];
    for (index, joint) in joints.iter_mut().enumerate() {
        // SAFETY: readable by contract; nothing is asked of the alignment, and any bits are numbers.
        let location = unsafe {
            locations
                .byte_add(index * stride)
                .cast::<JointLocation>()
                .read_unaligned()
        };
        if location.flags & VALID == VALID {
            *joint = Some(location.pose.to_kernel());
        }
    }
    Ok(joints)
}

/// Tells where a hand tracker sees the 26 joints of a hand that is a driven body: the wrist becomes the
/// body's target, and each piece's target in the body's frame is its joint seen from the wrist, then
/// its offset. For hands without chains: a piece on a link would take that for its pose in the link's
/// frame. Instead of `palp_body_set_target` and `palp_body_set_piece_targets`; call it every frame
/// in which `XrHandJointLocationsEXT.isActive` is true.
///
/// `locations` is an `XrHandJointLocationEXT[26]` as `xrLocateHandJointsEXT` filled it, of any
/// alignment, `stride` bytes from one joint to the next; 0 stands for 40. `piece_joints` has the number
/// of the joint that carries each piece, in the order the pieces were added, 0 to 25, and
/// `piece_offsets` each piece's pose on that joint; null when all pieces lie on their joints as they
/// are. `count` is the number of pieces. A joint farther than `reach_m` metres from the wrist is not
/// believed; 0.5 suits a hand of human size.
///
/// Flags are checked and not trusted. A joint whose orientation or position is not flagged as valid,
/// not finite, without length or out of reach is ignored: its pieces keep their last targets, and the
/// status is `PALP_JOINTS_IGNORED`. When the wrist is like that, nothing is set, the next frame counts
/// the tracker as lost, and the status is `PALP_TRACKING_LOST`. `pieces_kept`, which may be null, gets
/// the number of pieces that keep their last targets.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_hand_set_joints(
    world: *mut palp_world,
    body: palp_body_id,
    locations: *const c_void,
    stride: u32,
    piece_offsets: *const palp_pose,
    piece_joints: *const u32,
    count: u32,
    reach_m: f32,
    pieces_kept: *mut u32,
) -> palp_status {
    guarded(|| {
        judge_optional(pieces_kept)?;
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let joints = known_joints(locations, stride)?;
            let block = Block::of(world)?;
            let offsets = if piece_offsets.is_null() { 0 } else { count };
            let input = JointInput {
                joints: &joints,
                root: WRIST,
                piece_joints: array(piece_joints, count, &block.range())?,
                piece_offsets: kernel_poses(array(piece_offsets, offsets, &block.range())?),
                reach_m,
            };
            let used = block.change(|world| {
                world
                    .set_joints(body.to_kernel(), &input)
                    .map_err(joints_status)
            })?;
            put(
                pieces_kept,
                if used.root { used.pieces_kept } else { count },
            );
            Ok(use_status(&used))
        }
    })
}
