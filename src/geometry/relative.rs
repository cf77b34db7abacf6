//! How one piece lies in the frame of another, in double precision.
//!
//! Poses come in f32, and their quaternions have unit length only up to rounding. Composed in f32,
//! two of them are off by 2e-7 of the larger piece, which is more than a small piece's depth may be
//! off. So the pair's own pose is composed in f64, where the f32 numbers are exact.

use glam::{DMat3, DQuat, DVec3, Vec3};

use crate::math::Pose;

/// The pose of a piece A in the frame of a piece B.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relative {
    /// A's axes in B's frame, as columns.
    pub(crate) turn: DMat3,
    /// A's origin in B's frame, in metres.
    pub(crate) shift: DVec3,
}

impl Relative {
    /// Where A is in the frame of B, from where both are in the world.
    #[inline]
    #[must_use]
    pub fn between(pose_a: &Pose, pose_b: &Pose) -> Self {
        let back = wide(pose_b).conjugate();
        let apart = pose_a.translation().as_dvec3() - pose_b.translation().as_dvec3();
        Self {
            turn: matrix(back * wide(pose_a)),
            shift: rotated(back, apart),
        }
    }

    /// A point of A's frame in B's.
    #[inline]
    pub(crate) fn point(&self, p: Vec3) -> DVec3 {
        self.turn * p.as_dvec3() + self.shift
    }

    /// A direction of B's frame in A's.
    #[inline]
    pub(crate) fn back(&self, d: DVec3) -> DVec3 {
        let axes = &self.turn;
        DVec3::new(axes.x_axis.dot(d), axes.y_axis.dot(d), axes.z_axis.dot(d))
    }
}

impl From<&Pose> for Relative {
    /// From a pose that is given in B's frame already.
    #[inline]
    fn from(a_in_b: &Pose) -> Self {
        Self {
            turn: matrix(wide(a_in_b)),
            shift: a_in_b.translation().as_dvec3(),
        }
    }
}

#[inline]
fn wide(pose: &Pose) -> DQuat {
    let [x, y, z, w] = pose.rotation.map(f64::from);
    DQuat::from_xyzw(x, y, z, w)
}

/// `v` rotated by a quaternion of any length but zero.
#[inline]
fn rotated(q: DQuat, v: DVec3) -> DVec3 {
    let axis = DVec3::new(q.x, q.y, q.z);
    let scale = 2.0 / q.length_squared();
    v + axis.cross(axis.cross(v) + v * q.w) * scale
}

/// The rotation matrix of a quaternion of any length but zero.
#[inline]
fn matrix(q: DQuat) -> DMat3 {
    let s = 2.0 / q.length_squared();
    let (xs, ys, zs) = (q.x * s, q.y * s, q.z * s);
    let (wx, wy, wz) = (q.w * xs, q.w * ys, q.w * zs);
    let (xx, xy, xz) = (q.x * xs, q.x * ys, q.x * zs);
    let (yy, yz, zz) = (q.y * ys, q.y * zs, q.z * zs);
    DMat3::from_cols(
        DVec3::new(1.0 - (yy + zz), xy + wz, xz - wy),
        DVec3::new(xy - wz, 1.0 - (xx + zz), yz + wx),
        DVec3::new(xz + wy, yz - wx, 1.0 - (xx + yy)),
    )
}
