//! How long two moving pieces certainly stay clear of each other.
//!
//! Conservative advancement (Mirtich 1996): with a gap s along a normal n, nothing touches before
//! s / (approach of the linear velocities along n + largest turning speed). That bound grows with the
//! pieces' arms and is far too careful for a piece that slides or rolls along a plane. So a second
//! bound stands beside it, and the better of the two holds. Fix n. The gap between the planes is
//! z(t) = min_a n.a(t) - max_b n.b(t). Every point's n.x(t) differs from its linear interpolation
//! over a stretch T by at most A T^2 / 8, where A bounds its acceleration. The least over points of a
//! linear interpolation is at least the interpolation of the leasts, so for l in 0..=1
//!
//!   z(l T) >= (1 - l) z(0) + l z(T) - 4 l (1 - l) (A_a + A_b) T^2 / 8,
//!
//! and two support queries at the end of the stretch certify all of it.

use glam::Vec3;

use super::convex::Convex;
use super::motion::Motion;
use super::separation::separation_from;
use super::warm::WarmFeature;
use crate::math::{self, Pose};

/// What is known of a pair at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance {
    /// Unit normal from B into A, in the world.
    pub normal: Vec3,
    /// Certified gap between the surfaces at that time, in metres; negative when they overlap.
    pub gap_m: f32,
    /// Midway between the surfaces where they are nearest, in the world.
    pub point: Vec3,
    /// The gap stays at least the floor until then, in 0..=1.
    pub clear_until: f32,
}

/// A pair of moving pieces.
#[derive(Clone, Copy, Debug)]
pub struct MovingPair<'a> {
    /// The first piece.
    pub a: Convex<'a>,
    /// The second piece.
    pub b: Convex<'a>,
    /// How the first moves.
    pub motion_a: Motion<'a>,
    /// How the second moves.
    pub motion_b: Motion<'a>,
}

/// The gap between parallel planes with normal `n` (from B into A) that enclose the pieces.
#[must_use]
pub fn plane_gap(a: &Convex, b: &Convex, pose_a: &Pose, pose_b: &Pose, n: Vec3) -> f32 {
    let reach_a = a.support(pose_a.quat().conjugate() * -n).reach;
    let reach_b = b.support(pose_b.quat().conjugate() * n).reach;
    let apart = n.dot(pose_a.translation() - pose_b.translation());
    apart - reach_a - reach_b - a.radius - b.radius
}

impl MovingPair<'_> {
    /// How long the pair is certainly clear, judged from `time` on.
    ///
    /// `floor_m` is the gap that must not be undercut; a pair that is closer already, or
    /// overlaps, must not get any closer or deeper. `feature` is where the last search ended, `accuracy`
    /// the share of the gap that the certificate may give away. Cost: one distance query and two support
    /// queries; where the cores overlap, one penetration query more.
    #[must_use]
    pub fn clear_until(
        &self,
        time: f32,
        floor_m: f32,
        feature: &mut WarmFeature,
        accuracy: f32,
    ) -> Clearance {
        let pose_a = self.motion_a.at(time);
        let pose_b = self.motion_b.at(time);
        let found = separation_from(&self.a, &self.b, &pose_a, &pose_b, feature, accuracy);
        let floor_m = math::min(floor_m, found.gap_m);
        Clearance {
            normal: found.normal,
            gap_m: found.gap_m,
            point: 0.5 * (found.point_a + found.point_b),
            clear_until: self.furthest(time, found.gap_m, floor_m, found.normal),
        }
    }

    fn furthest(&self, time: f32, gap_m: f32, floor_m: f32, normal: Vec3) -> f32 {
        let approach = self.approach(normal);
        let slack = gap_m - floor_m;
        let reach = time + slack / math::max(approach, 1e-30);
        if approach == 0.0 || reach >= 1.0 {
            return 1.0;
        }
        let rest = 1.0 - time;
        let end = plane_gap(
            &self.a,
            &self.b,
            &self.motion_a.at(1.0),
            &self.motion_b.at(1.0),
            normal,
        );
        let bulge = 0.125 * (self.motion_a.acceleration + self.motion_b.acceleration) * rest * rest;
        math::max(
            reach,
            time + rest * first_below(slack, end - floor_m, bulge),
        )
    }

    /// Upper bound of the speed at which the gap along `normal` shrinks, per unit of time.
    #[must_use]
    pub fn approach(&self, normal: Vec3) -> f32 {
        let linear = normal.dot(self.motion_b.linear - self.motion_a.linear);
        let turning = self.motion_a.turning + self.motion_b.turning;
        math::max(0.0, linear + turning)
    }
}

/// The first l in 0..=1 at which (1 - l) start + l end - 4 l (1 - l) bulge falls below zero, or 1;
/// `start` is not negative.
fn first_below(start: f32, end: f32, bulge: f32) -> f32 {
    // 4 bulge l^2 + (end - start - 4 bulge) l + start
    let a = 4.0 * bulge;
    let half_b = 0.5 * (end - start - a);
    if half_b >= 0.0 {
        return 1.0;
    }
    let discriminant = half_b * half_b - a * start;
    if discriminant < 0.0 {
        return 1.0;
    }
    // The smaller root, in the form without cancellation.
    let first = start / (math::sqrt(discriminant) - half_b);
    // A hair earlier, for the rounding of this formula.
    math::min(first * (1.0 - 4.0 * f32::EPSILON), 1.0)
}
