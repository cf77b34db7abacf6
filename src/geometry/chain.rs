//! Chains of hinges, and where their links are for given angles.

use arrayvec::ArrayVec;
use bytemuck::{Pod, Zeroable};
use glam::{Quat, Vec3};

use super::reach_cone::ReachCone;
use crate::limits::CHAIN_HINGES_MAX;
use crate::math::{self, Pose};

/// A hinge between two links. A ball joint is three hinges in one place, see [`Ball`].
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

/// The reach cone of a ball joint: three hinges in one place with the axes X, Y and Z of one frame, the
/// first one's rest pose. Z turned by the first two is the limb; the third is its twist.
///
/// At angles a and b of the first two the limb is (sin b, -sin a cos b, cos a cos b) in that frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Index of the first of the three hinges.
    pub first: usize,
    /// Where the limb may point, in the frame of the first hinge's rest.
    pub cone: ReachCone,
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
