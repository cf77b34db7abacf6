//! Forward kinematics of the model's bones under the poses' rotations.

use glam::{DQuat, DVec3};

use super::joints::{JOINT_COUNT, PALM, PALM_ENDS, WRIST, is_palm_bone, joint_parent};

/// Where a joint is, in metres, in the wrist's frame (OpenXR axes: fingers along -Z, back of the hand +Y).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointPose {
    /// Unit quaternion; -Z points along the bone to the tip, +Y to the back of the hand.
    pub orientation: DQuat,
    /// Metres.
    pub position: DVec3,
    /// Distance from the joint to the skin, in metres.
    pub radius: f64,
}

/// Rotations of all joints relative to their parents, in OpenXR order.
pub(super) type LocalRotations = [DQuat; JOINT_COUNT];

/// The model's bones: where each joint sits in its parent's frame.
#[derive(Clone, Debug)]
pub(super) struct Skeleton {
    bind: LocalRotations,
    offset_m: [DVec3; JOINT_COUNT],
    radius_m: [f64; JOINT_COUNT],
}

impl Skeleton {
    /// Takes the bones from bind poses in the wrist's frame; entry `PALM` is ignored and derived.
    pub(super) fn new(
        bind: &[(DQuat, DVec3); JOINT_COUNT],
        mut radius_m: [f64; JOINT_COUNT],
    ) -> Self {
        let mut bind = *bind;
        let [near, far] = PALM_ENDS;
        bind[PALM] = (bind[near].0, bind[near].1.midpoint(bind[far].1));
        radius_m[PALM] = radius_m[near];
        Self {
            bind: local_rotations(&bind.map(|(orientation, _)| orientation)),
            offset_m: std::array::from_fn(|joint| offset_in_parent(&bind, joint)),
            radius_m,
        }
    }

    pub(super) fn bind_rotations(&self) -> &LocalRotations {
        &self.bind
    }

    /// Parent-relative rotations that give every phalanx the orientation recorded for it, with the palm's bones as modelled.
    pub(super) fn retarget(&self, recorded: &[DQuat; JOINT_COUNT]) -> LocalRotations {
        let bind = self.forward(&self.bind);
        let mut orientation = *recorded;
        for joint in (0..JOINT_COUNT).filter(|&joint| is_palm_bone(joint) || joint == PALM) {
            orientation[joint] = bind[joint].orientation;
        }
        orientation[WRIST] = DQuat::IDENTITY;
        local_rotations(&orientation)
    }

    /// Joint poses in the wrist's frame.
    pub(super) fn forward(&self, local: &LocalRotations) -> [JointPose; JOINT_COUNT] {
        let mut joints = self.radius_m.map(|radius| JointPose {
            orientation: DQuat::IDENTITY,
            position: DVec3::ZERO,
            radius,
        });
        for joint in (WRIST + 1..JOINT_COUNT).chain([PALM]) {
            let parent = joint_parent(joint).map_or(joints[WRIST], |parent| joints[parent]);
            joints[joint].orientation = (parent.orientation * local[joint]).normalize();
            joints[joint].position = parent.position + parent.orientation * self.offset_m[joint];
        }
        joints
    }
}

/// Shortest-arc blend of parent-relative rotations; exact at both ends.
pub(super) fn blend(from: &LocalRotations, to: &LocalRotations, weight: f64) -> LocalRotations {
    if weight >= 1.0 {
        *to
    } else if weight > 0.0 {
        std::array::from_fn(|joint| from[joint].slerp(to[joint], weight))
    } else {
        *from
    }
}

fn local_rotations(orientation: &[DQuat; JOINT_COUNT]) -> LocalRotations {
    std::array::from_fn(|joint| {
        joint_parent(joint).map_or(DQuat::IDENTITY, |parent| {
            (orientation[parent].inverse() * orientation[joint]).normalize()
        })
    })
}

fn offset_in_parent(bind: &[(DQuat, DVec3); JOINT_COUNT], joint: usize) -> DVec3 {
    joint_parent(joint).map_or(DVec3::ZERO, |parent| {
        bind[parent].0.inverse() * (bind[joint].1 - bind[parent].1)
    })
}
