//! Trees of hinges: where a link is while the angles change, and bounds on how fast it moves.

use super::chain::Hinge;
use crate::math::{self, Pose};

/// Hinges of a tree in columns, each with the hinge before it.
#[derive(Clone, Copy, Debug)]
pub struct Linkage<'a> {
    /// The hinges; a hinge comes behind the one that it hangs on.
    pub hinges: &'a [Hinge],
    /// The hinge before each, index plus one; zero for one that hangs on the root.
    pub parents: &'a [u32],
    /// How far each hinge is from the origin of what it hangs on, in metres.
    pub lengths_m: &'a [f32],
}

impl Linkage<'_> {
    /// The frame of the link behind a hinge, in the root's frame. Cost: one turn for each hinge from there
    /// to the root.
    #[must_use]
    pub fn link(&self, joint: usize, angle_rad: impl Fn(usize) -> f32) -> Pose {
        let mut pose = self.behind(joint, angle_rad(joint));
        let mut next = self.parents[joint];
        while let Some(index) = next.checked_sub(1) {
            let index = index as usize;
            pose = self.behind(index, angle_rad(index)).then(&pose);
            next = self.parents[index];
        }
        Pose::new(math::renormalised(pose.quat()), pose.translation())
    }

    /// The frame of the link behind a hinge, in the frame of what the hinge hangs on.
    #[must_use]
    pub fn behind(&self, joint: usize, angle_rad: f32) -> Pose {
        self.hinges[joint].behind(angle_rad)
    }
}

/// A link's way while all angles of its tree change at constant rates.
#[derive(Clone, Copy, Debug)]
pub struct LinkPath<'a> {
    /// The tree.
    pub linkage: Linkage<'a>,
    /// The hinge before the link.
    pub joint: usize,
    /// Every hinge's angle at share 0, in radians.
    pub from: &'a [f32],
    /// Every hinge's angle at share 1, in radians.
    pub to: &'a [f32],
    /// The link at share 0, in the root's frame.
    pub from_pose: Pose,
    /// The link at share 1, in the root's frame.
    pub to_pose: Pose,
}

/// Bounds of a point's motion in the root's frame, per unit of share.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PathBounds {
    /// The farthest from the root's origin, in metres.
    pub arm: f32,
    /// Largest speed.
    pub speed: f32,
    /// Largest angular speed of the link, in radians.
    pub angular: f32,
    /// Largest acceleration.
    pub acceleration: f32,
}

/// An angle between two; exactly the ends at 0 and 1.
#[inline]
#[must_use]
pub fn angle_at(from: f32, to: f32, share: f32) -> f32 {
    if share >= 1.0 {
        to
    } else {
        from + (to - from) * share
    }
}

impl LinkPath<'_> {
    /// The link at a share of the way, in the root's frame.
    #[must_use]
    pub fn at(&self, share: f32) -> Pose {
        if share <= 0.0 {
            self.from_pose
        } else if share >= 1.0 {
            self.to_pose
        } else {
            self.linkage
                .link(self.joint, |j| angle_at(self.from[j], self.to[j], share))
        }
    }

    fn before(&self, joint: usize) -> Option<usize> {
        Some(self.linkage.parents[joint].checked_sub(1)? as usize)
    }

    /// Bounds for all points within `reach_m` of the link's origin.
    ///
    /// A point x moves by the sum over hinges j before it of w_j a_j x (x - o_j). With R_j no less than
    /// |x - o_j|, W_j the sum of |w_i| over the hinges i before j and V_j that of |w_i| R_i over the others,
    /// the axis turns by at most W_j and x - o_j changes by at most W_j R_j + V_j, so the acceleration is at
    /// most the sum of |w_j| (2 W_j R_j + V_j).
    pub(super) fn bounds(&self, reach_m: f32) -> PathBounds {
        let rate = |joint: usize| (self.to[joint] - self.from[joint]).abs();
        let mut before = 0.0;
        let mut next = Some(self.joint);
        while let Some(joint) = next {
            before += rate(joint);
            next = self.before(joint);
        }
        let mut bounds = PathBounds {
            arm: reach_m,
            angular: before,
            ..PathBounds::default()
        };
        let mut next = Some(self.joint);
        while let Some(joint) = next {
            let w = rate(joint);
            // Never below zero, which is where rounding could take it.
            before = math::max(before - w, 0.0);
            bounds.speed += w * bounds.arm;
            bounds.acceleration += w * (2.0 * before * bounds.arm + bounds.speed);
            bounds.arm += self.linkage.lengths_m[joint];
            next = self.before(joint);
        }
        bounds
    }
}
