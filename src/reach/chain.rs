//! Chains of hinges, and where their links are for given angles.

use arrayvec::ArrayVec;
use bytemuck::{Pod, Zeroable};
use glam::{Quat, Vec3};

use crate::limits::CHAIN_HINGES_MAX;
use crate::math::{self, Pose};

/// A hinge between two links. Ball joints are three hinges in one place.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Hinge {
    /// Pose of the hinge in the frame of the link before it, or of the chain's root.
    pub rest: Pose,
    /// Unit axis in the hinge's frame.
    pub axis: Vec3,
    /// Least angle in radians.
    pub low_rad: f32,
    /// Largest angle in radians.
    pub high_rad: f32,
}

impl Hinge {
    /// The angle within the limits that is nearest to one.
    #[inline]
    #[must_use]
    pub fn kept(&self, angle_rad: f32) -> f32 {
        math::clamp(angle_rad, self.low_rad, self.high_rad)
    }
}

/// Where one hinge and the link behind it are, in the frame of the root's parent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// A point of the axis.
    pub origin: Vec3,
    /// Unit axis.
    pub axis: Vec3,
    /// The link's frame: the hinge's, turned by its angle.
    pub link: Pose,
}

/// Every hinge of a chain, from the root on.
pub type Posture = ArrayVec<Placed, CHAIN_HINGES_MAX>;

/// Forward kinematics. Hinges beyond [`CHAIN_HINGES_MAX`], or without an angle, are left out.
///
/// Cost: one pose composition and one rotation a hinge.
#[must_use]
pub fn posture(hinges: &[Hinge], root: &Pose, angles: &[f32]) -> Posture {
    let mut link = *root;
    hinges
        .iter()
        .zip(angles)
        .take(CHAIN_HINGES_MAX)
        .map(|(hinge, &angle)| {
            let at = link.then(&hinge.rest);
            let turn = at.quat() * turn_about(hinge.axis, angle);
            link = Pose::new(math::renormalised(turn), at.translation());
            Placed {
                origin: at.translation(),
                axis: at.quat() * hinge.axis,
                link,
            }
        })
        .collect()
}

fn turn_about(axis: Vec3, angle: f32) -> Quat {
    let v = axis * math::sin(0.5 * angle);
    Quat::from_xyzw(v.x, v.y, v.z, math::cos(0.5 * angle))
}
