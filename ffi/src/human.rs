//! Human limbs as chains: joints, ranges and lengths.

use palpable_kernel::geometry::chain::JointDef;
use palpable_kernel::human::{
    Finger, FingerBones, Limb, LimbDef, finger as human_finger, limb, limb_on_root,
};
use palpable_kernel::limits::WORLD_REACH_M;

use crate::arguments::{judge, judge_optional, put, value};
use crate::panic::guarded;
use crate::skeleton::{PALP_LIMB_JOINTS_MAX, palp_joint};
use crate::status::{PALP_BAD_ENUM, PALP_BAD_NUMBER, PALP_BAD_POSE, PALP_OK, palp_status};
use crate::types::{palp_pose, palp_vec3};

/// Trunk, from the root. With `PALP_LIMB_ON_ROOT` there is none.
pub const PALP_LIMB_SPINE: u32 = 0;
/// Neck and head.
pub const PALP_LIMB_NECK: u32 = 1;
/// Left arm: ball shoulder, elbow, forearm's twist, wrist of two.
pub const PALP_LIMB_LEFT_ARM: u32 = 2;
/// Right arm.
pub const PALP_LIMB_RIGHT_ARM: u32 = 3;
/// Left leg: ball hip, knee, ankle of two.
pub const PALP_LIMB_LEFT_LEG: u32 = 4;
/// Right leg.
pub const PALP_LIMB_RIGHT_LEG: u32 = 5;

/// Thumb: five hinges.
pub const PALP_FINGER_THUMB: u32 = 0;
/// Index finger: knuckle of two, two more.
pub const PALP_FINGER_INDEX: u32 = 1;
/// Middle finger.
pub const PALP_FINGER_MIDDLE: u32 = 2;
/// Ring finger.
pub const PALP_FINGER_RING: u32 = 3;
/// Little finger.
pub const PALP_FINGER_LITTLE: u32 = 4;

/// A human being is between these heights, in metres.
const HEIGHTS_M: core::ops::RangeInclusive<f32> = 0.3..=3.0;

/// Writes joints behind each other.
///
/// # Safety
/// `PALP_LIMB_JOINTS_MAX` joints are writable.
unsafe fn put_joints(joints: *mut palp_joint, defs: &[JointDef]) {
    for (index, def) in defs.iter().enumerate().take(PALP_LIMB_JOINTS_MAX as usize) {
        // SAFETY: the caller vouches.
        unsafe { joints.add(index).write(palp_joint::new(def)) };
    }
}

/// Joints, ranges and reach cones of a human limb for a body of a height from 0.3 to 3 m; ranges after the
/// American Academy of Orthopaedic Surgeons, lengths after Drillis and Contini 1966. The root is midway
/// between the hip joints, the body stands upright at zero angles, faces -Z, its right side is +X, its
/// arms hang. `on_root` other than zero: arms and neck hang on the root, which has the trunk; else on the
/// spine's last link. `joints` has room for `PALP_LIMB_JOINTS_MAX`; `count` gets their number. `tip` gets
/// the limb's end in the last link's frame, in metres, and may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_human_limb(
    which: u32,
    on_root: u32,
    height_m: f32,
    joints: *mut palp_joint,
    count: *mut u32,
    tip: *mut palp_vec3,
) -> palp_status {
    guarded(|| {
        judge(joints)?;
        judge(count)?;
        judge_optional(tip)?;
        let which = *Limb::ALL.get(which as usize).ok_or(PALP_BAD_ENUM)?;
        if !HEIGHTS_M.contains(&height_m) {
            return Err(PALP_BAD_NUMBER);
        }
        let def: LimbDef = if on_root == 0 {
            limb(which, height_m)
        } else {
            limb_on_root(which, height_m)
        };
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            put_joints(joints, &def.joints);
            put(count, def.joints.len() as u32);
            put(tip, palp_vec3::new(def.tip.to_array()));
        }
        Ok(PALP_OK)
    })
}

/// Hinges of a finger whose bones a tracker gave at rest: `bones` are three poses of joints in the frame
/// that the chain is to hang on, with OpenXR's axes (-Z along the bone, +Y to the back of the hand): of a
/// finger its knuckle, middle and last joint, of the thumb its metacarpal, knuckle and last joint. `tip`
/// is the finger's end in that frame, in metres. Zero angles are the rest pose. `joints` has room for
/// `PALP_LIMB_JOINTS_MAX`; `count` gets their number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_human_finger(
    which: u32,
    bones: *const palp_pose,
    tip: *const palp_vec3,
    joints: *mut palp_joint,
    count: *mut u32,
) -> palp_status {
    guarded(|| {
        judge(bones)?;
        judge(joints)?;
        judge(count)?;
        let which = *Finger::ALL.get(which as usize).ok_or(PALP_BAD_ENUM)?;
        // SAFETY: the header's rules for pointers and threads; three poses are readable.
        unsafe {
            let end = value(tip)?.to_array();
            let mut rest = [palpable_kernel::math::Pose::IDENTITY; 3];
            for (index, pose) in rest.iter_mut().enumerate() {
                let given = bones.add(index).read().to_kernel();
                *pose = given.normalised(WORLD_REACH_M).ok_or(PALP_BAD_POSE)?;
            }
            if !end.iter().all(|x| x.abs() <= WORLD_REACH_M) {
                return Err(PALP_BAD_POSE);
            }
            let found = human_finger(
                which,
                &FingerBones {
                    joints: rest,
                    tip: end.into(),
                },
            );
            let mut written = 0;
            for &hinge in &found.hinges {
                joints
                    .add(written)
                    .write(palp_joint::new(&JointDef::Hinge(hinge)));
                written += 1;
            }
            put(count, written as u32);
        }
        Ok(PALP_OK)
    })
}

// Numbers that the header repeats are places in the kernel's lists.
const _: () = {
    assert!(matches!(Limb::ALL[PALP_LIMB_SPINE as usize], Limb::Spine));
    assert!(matches!(Limb::ALL[PALP_LIMB_NECK as usize], Limb::Neck));
    assert!(matches!(
        Limb::ALL[PALP_LIMB_LEFT_ARM as usize],
        Limb::LeftArm
    ));
    assert!(matches!(
        Limb::ALL[PALP_LIMB_RIGHT_ARM as usize],
        Limb::RightArm
    ));
    assert!(matches!(
        Limb::ALL[PALP_LIMB_LEFT_LEG as usize],
        Limb::LeftLeg
    ));
    assert!(matches!(
        Limb::ALL[PALP_LIMB_RIGHT_LEG as usize],
        Limb::RightLeg
    ));
    assert!(matches!(
        Finger::ALL[PALP_FINGER_THUMB as usize],
        Finger::Thumb
    ));
    assert!(matches!(
        Finger::ALL[PALP_FINGER_INDEX as usize],
        Finger::Index
    ));
    assert!(matches!(
        Finger::ALL[PALP_FINGER_MIDDLE as usize],
        Finger::Middle
    ));
    assert!(matches!(
        Finger::ALL[PALP_FINGER_RING as usize],
        Finger::Ring
    ));
    assert!(matches!(
        Finger::ALL[PALP_FINGER_LITTLE as usize],
        Finger::Little
    ));
};
