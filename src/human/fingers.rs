//! Fingers of a tracked or modelled hand.

use arrayvec::ArrayVec;
use glam::Vec3;

use super::ranges::{self, JointLimits};
use crate::geometry::chain::Hinge;
use crate::math::{self, Pose};

/// Most hinges of one finger: the thumb's.
const FINGER_HINGES_MAX: usize = 5;

/// A finger.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Finger {
    /// Five hinges: base flexion, base abduction, base rotation, knuckle flexion, last flexion.
    Thumb,
    /// Four hinges, as the other fingers: knuckle spread, knuckle flexion, middle and last flexion.
    Index,
    /// See [`Finger::Index`].
    Middle,
    /// See [`Finger::Index`].
    Ring,
    /// See [`Finger::Index`].
    Little,
}

impl Finger {
    /// All fingers.
    pub const ALL: [Self; 5] = [
        Self::Thumb,
        Self::Index,
        Self::Middle,
        Self::Ring,
        Self::Little,
    ];
}

/// Where a finger's joints are in a straight rest pose, in the wrist's or palm's frame.
///
/// Frames are those of `XrHandJointEXT`: -Z along the bone to the tip, +Y to the back of the hand or
/// thumb. Both hands use the same axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FingerBones {
    /// The three joints that move: knuckle, middle and last joint; for the thumb its metacarpal, knuckle
    /// and last joint.
    pub joints: [Pose; 3],
    /// The tip, in metres.
    pub tip: Vec3,
}

/// A finger's hinges. Zero angles are the rest pose.
#[derive(Clone, Debug, PartialEq)]
pub struct FingerDef {
    /// From the palm on; each rest pose is relative to the hinge before it, the first to the frame of
    /// [`FingerBones`].
    pub hinges: ArrayVec<Hinge, FINGER_HINGES_MAX>,
    /// The index of the hinge behind which each of the three bones hangs; the link's frame at rest is
    /// the joint's frame.
    pub bones: [usize; 3],
    /// The tip in the last link's frame, in metres.
    pub tip: Vec3,
}

/// The hinges of a finger whose bones are known. Flexion is positive, about -X; spread and abduction
/// are about +Y, rotation about -Z.
///
/// A middle or last joint that is bent at rest has its range moved by that bend; the range always
/// contains the rest pose.
#[must_use]
pub fn finger(finger: Finger, bones: &FingerBones) -> FingerDef {
    let [first, second, third] = bones.joints;
    let mut hinges = ArrayVec::new();
    let mut push = |rest: Pose, axis: Vec3, limits: &JointLimits, bend_rad: f32| {
        hinges.push(Hinge {
            rest,
            axis,
            low_rad: math::min(limits.low_rad() - bend_rad, 0.0),
            high_rad: math::max(limits.high_rad() - bend_rad, 0.0),
        });
    };
    let (second, third) = (second.seen_from(&first), third.seen_from(&second));
    let (bend, last_bend) = (flexion_rad(&second), flexion_rad(&third));
    if finger == Finger::Thumb {
        push(first, Vec3::NEG_X, &ranges::THUMB_BASE_FLEXION, 0.0);
        let here = Pose::IDENTITY;
        push(here, Vec3::Y, &ranges::THUMB_BASE_ABDUCTION, 0.0);
        push(here, Vec3::NEG_Z, &ranges::THUMB_BASE_ROTATION, 0.0);
        push(second, Vec3::NEG_X, &ranges::THUMB_KNUCKLE_FLEXION, bend);
        push(third, Vec3::NEG_X, &ranges::THUMB_LAST_FLEXION, last_bend);
    } else {
        push(first, Vec3::Y, &ranges::KNUCKLE_SPREAD, 0.0);
        let here = Pose::IDENTITY;
        push(here, Vec3::NEG_X, &ranges::KNUCKLE_FLEXION, 0.0);
        push(second, Vec3::NEG_X, &ranges::MIDDLE_FLEXION, bend);
        push(third, Vec3::NEG_X, &ranges::LAST_FLEXION, last_bend);
    }
    let last = hinges.len() - 1;
    let tip = Pose::at(bones.tip.x, bones.tip.y, bones.tip.z);
    FingerDef {
        bones: [last - 2, last - 1, last],
        hinges,
        tip: tip.seen_from(&bones.joints[2]).translation(),
    }
}

/// How far a joint is bent about -X relative to the bone before it, in radians.
fn flexion_rad(rest: &Pose) -> f32 {
    let bone = rest.quat() * Vec3::NEG_Z;
    math::atan2(-bone.y, -bone.z)
}
