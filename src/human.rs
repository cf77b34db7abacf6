//! Human skeletons: joints, ranges and lengths of arms, legs, trunk, neck and fingers.
//!
//! # Frames
//!
//! The root of a body is midway between the hip joints. +Y is up, the avatar faces -Z, its right side is
//! +X. At zero angles it stands upright with straight legs, feet forward, arms hanging, thumbs forward,
//! palms to the thighs. Behind every hinge, the link's frame at zero angles has the root's axes; behind
//! a ball joint it has those of the ball's rest pose.
//!
//! # Positive angles
//!
//! | limb | hinges, from the root on |
//! |---|---|
//! | arm | shoulder (ball: 3), elbow flexion, forearm pronation, wrist flexion, wrist radial deviation |
//! | leg | hip (ball: 3), knee flexion, ankle dorsiflexion, foot inversion |
//! | spine, neck | one ball: 3 |
//!
//! Left limbs are mirror images: hinges keep the signs of their angles, and of a ball's three angles the
//! second and third change sign, see [`mirrored_ball_angles`].
//!
//! # Ball joints
//!
//! The swing's poles (where its two angles do not tell a direction) are +X and -X of the rest frame. A
//! shoulder's are horizontal, 50 degrees across the body from straight ahead and 40 degrees behind
//! straight sideways: both lie 10 degrees outside the cone. A hip's, a neck's and the spine's point
//! straight sideways, 40 degrees and more outside.
//!
//! A shoulder's twist range is that of the hanging arm. In an arm that points straight sideways zero
//! twist is 50 degrees of lateral rotation, in one that points straight ahead it is 40 degrees of
//! medial rotation; one range does not follow the arm there.

use arrayvec::ArrayVec;
use glam::{Quat, Vec3};

pub use crate::geometry::chain::JointDef;
use crate::geometry::chain::{Ball, Hinge, SWING_RAD, limb_at};
use crate::geometry::reach_cone::ReachCone;
use crate::limits::CHAIN_HINGES_MAX;
use crate::math::{self, Pose};

mod fingers;
pub mod lengths;
mod limbs;
pub mod ranges;

pub use fingers::{Finger, FingerBones, FingerDef, finger};
pub use limbs::{Base, Limb, LimbDef, limb, limb_on_root};

/// Most joints of one limb: an arm has a ball and four hinges.
pub const LIMB_JOINTS_MAX: usize = 5;

const QUARTER: f32 = core::f32::consts::FRAC_PI_2;

impl JointDef {
    /// The same joint on the other side of the plane x = 0, see [`mirrored_ball_angles`].
    ///
    /// # Panics
    /// Never: the mirror image of a cone is one.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        match *self {
            Self::Hinge(hinge) => Self::Hinge(Hinge {
                rest: mirrored_pose(&hinge.rest),
                axis: Vec3::new(hinge.axis.x, -hinge.axis.y, -hinge.axis.z),
                ..hinge
            }),
            Self::Ball {
                rest,
                twist_low_rad,
                twist_high_rad,
                cone,
            } => {
                let corners: ArrayVec<Vec3, { crate::limits::REACH_CONE_EDGES_MAX }> =
                    cone.corners().iter().map(|&c| mirrored_point(c)).collect();
                let cone = ReachCone::new(mirrored_point(cone.visible()), &corners);
                Self::Ball {
                    rest: mirrored_pose(&rest),
                    twist_low_rad: -twist_high_rad,
                    twist_high_rad: -twist_low_rad,
                    cone: cone.expect("the mirror image of a cone is one"),
                }
            }
        }
    }
}

/// All hinges of some joints, in their order. Those beyond [`CHAIN_HINGES_MAX`] are left out.
#[must_use]
pub fn hinges_of(joints: &[JointDef]) -> ArrayVec<Hinge, CHAIN_HINGES_MAX> {
    joints
        .iter()
        .flat_map(JointDef::hinges)
        .take(CHAIN_HINGES_MAX)
        .collect()
}

/// The reach cones of some joints, each with the index of its first hinge.
#[must_use]
pub fn balls_of(joints: &[JointDef]) -> ArrayVec<Ball, LIMB_JOINTS_MAX> {
    let mut first = 0;
    let mut balls = ArrayVec::new();
    for joint in joints.iter().take(LIMB_JOINTS_MAX) {
        if let JointDef::Ball { cone, .. } = *joint {
            balls.push(Ball { first, cone });
        }
        first += joint.hinge_count();
    }
    balls
}

/// Angles within the limits of their joints.
#[derive(Clone, Debug, PartialEq)]
pub struct Kept {
    /// One a hinge, in radians.
    pub angles: ArrayVec<f32, CHAIN_HINGES_MAX>,
    /// How many hinges, swings and twists had to be changed.
    pub clamped: u32,
}

/// The nearest angles within the limits: hinges and twists by their ranges, swings by the nearest
/// direction in the cone. Missing angles count as zero.
///
/// Cost: one projection a ball.
#[must_use]
pub fn kept(joints: &[JointDef], angles: &[f32]) -> Kept {
    let mut given = angles.iter().copied().chain(core::iter::repeat(0.0));
    let mut next = || given.next().unwrap_or(0.0);
    let mut kept = Kept {
        angles: ArrayVec::new(),
        clamped: 0,
    };
    for joint in joints {
        let mut put = |old: f32, new: f32| {
            let _ = kept.angles.try_push(new);
            u32::from(old.to_bits() != new.to_bits())
        };
        kept.clamped += match joint {
            JointDef::Hinge(hinge) => {
                let angle = next();
                put(angle, hinge.kept(angle))
            }
            JointDef::Ball {
                twist_low_rad,
                twist_high_rad,
                cone,
                ..
            } => {
                let (a, b, c) = (next(), next(), next());
                let (kept_a, kept_b) = kept_swing(cone, a, b);
                let swung = put(a, kept_a).max(put(b, kept_b));
                swung + put(c, math::clamp(c, *twist_low_rad, *twist_high_rad))
            }
        };
    }
    kept
}

fn kept_swing(cone: &ReachCone, a: f32, b: f32) -> (f32, f32) {
    let limb = limb_at(a, b);
    if cone.contains(limb) && b.abs() <= QUARTER && a.abs() <= SWING_RAD {
        return (a, b);
    }
    swing_near(cone.nearest(limb), a)
}

/// The first two angles of a ball whose limb points along a unit vector of the rest frame: the first in
/// (-pi, pi], the second within a quarter turn.
#[must_use]
pub fn swing(limb: Vec3) -> (f32, f32) {
    let across = math::sqrt(limb.y * limb.y + limb.z * limb.z);
    (math::atan2(-limb.y, limb.z), math::atan2(limb.x, across))
}

/// [`swing`] with the first angle taken a turn further when that is nearer to `a_near`, within
/// [`SWING_RAD`].
#[must_use]
pub fn swing_near(limb: Vec3, a_near: f32) -> (f32, f32) {
    let (a, b) = swing(limb);
    let turn = core::f32::consts::TAU;
    let mut best = a;
    for other in [a - turn, a + turn] {
        if other.abs() <= SWING_RAD && (other - a_near).abs() < (best - a_near).abs() {
            best = other;
        }
    }
    (best, b)
}

/// The three angles of a ball that is turned by a unit quaternion from its rest frame; the twist in
/// [-pi, pi].
#[must_use]
pub fn ball_angles(turn: Quat) -> [f32; 3] {
    let (a, b) = swing(turn * Vec3::Z);
    let rest = (about(Vec3::X, a) * about(Vec3::Y, b)).conjugate() * turn;
    let rest = math::nearer_sign(rest, Quat::IDENTITY);
    [a, b, 2.0 * math::atan2(rest.z, rest.w)]
}

/// The angles of a ball's mirror image.
#[must_use]
pub const fn mirrored_ball_angles(angles: [f32; 3]) -> [f32; 3] {
    [angles[0], -angles[1], -angles[2]]
}

/// A point on the other side of the plane x = 0.
#[must_use]
pub const fn mirrored_point(p: Vec3) -> Vec3 {
    Vec3::new(-p.x, p.y, p.z)
}

/// A frame on the other side of the plane x = 0, its X axis turned round so that it stays right-handed.
#[must_use]
pub const fn mirrored_pose(pose: &Pose) -> Pose {
    let [x, y, z, w] = pose.rotation;
    Pose {
        rotation: [x, -y, -z, w],
        position: [-pose.position[0], pose.position[1], pose.position[2]],
    }
}

fn about(axis: Vec3, angle_rad: f32) -> Quat {
    let v = axis * math::sin(0.5 * angle_rad);
    Quat::from_xyzw(v.x, v.y, v.z, math::cos(0.5 * angle_rad))
}
