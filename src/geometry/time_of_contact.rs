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
//! and two support queries at the end of the stretch certify all of it. With T as long as what is left of
//! the way, A T^2 dwarfs the gap of a pair that slides along a plane, and the pair creeps; with
//! (A_a + A_b) T^2 = 4 z(0), a gap that stays what it is certifies the whole stretch. Where the roots fall along
//! parabolas, bow (t^2 - t) beside the straight way, that part of the deviation is known with its sign:
//! it adds n.(bow_a - bow_b) T^2 (l^2 - l) instead of a bound.

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
        Clearance {
            normal: found.normal,
            gap_m: found.gap_m,
            point: 0.5 * (found.point_a + found.point_b),
            clear_until: self.clear_from(time, floor_m, found.normal, found.gap_m),
        }
    }

    /// The same where the gap at `time` and its normal are known.
    ///
    /// Cost: two support queries, unless the gap is wide for how fast it closes.
    #[must_use]
    pub fn clear_from(&self, time: f32, floor_m: f32, normal: Vec3, gap_m: f32) -> f32 {
        self.furthest(time, gap_m, math::min(floor_m, gap_m), normal)
    }

    fn furthest(&self, time: f32, gap_m: f32, floor_m: f32, normal: Vec3) -> f32 {
        let approach = self.approach(normal, time);
        let slack = gap_m - floor_m;
        let reach = time + slack / math::max(approach, 1e-30);
        if approach == 0.0 || reach >= 1.0 {
            return 1.0;
        }
        math::max(reach, self.along(time, 1.0, slack, floor_m, normal))
    }

    /// How long the pair is certainly clear that was found so at `time`: no less than was found, and longer
    /// where the pieces slide along each other, judged by a stretch as short as their gap asks for.
    ///
    /// Cost: two support queries.
    #[must_use]
    pub fn clear_nearby(&self, time: f32, floor_m: f32, found: &Clearance) -> f32 {
        let floor_m = math::min(floor_m, found.gap_m);
        let slack = found.gap_m - floor_m;
        let bend = math::max(self.bend(found.normal), 1e-30);
        let end = time + math::sqrt(2.0 * slack / bend);
        if end >= 1.0 || end <= found.clear_until {
            return found.clear_until;
        }
        let until = self.along(time, end, slack, floor_m, found.normal);
        math::max(until, found.clear_until)
    }

    /// How long the gap along `normal`, which is `slack` above the floor at `time`, stays above it, judged
    /// by a stretch that goes to `end`.
    fn along(&self, time: f32, end: f32, slack: f32, floor_m: f32, normal: Vec3) -> f32 {
        let stretch = end - time;
        let gap_m = plane_gap(
            &self.a,
            &self.b,
            &self.motion_a.at(end),
            &self.motion_b.at(end),
            normal,
        );
        let bulge = self.bend(normal) * stretch * stretch;
        time + stretch * first_below(slack, gap_m - floor_m, bulge)
    }

    /// How much the gap along `normal` may be bent, per square of time: A / 2, and what is known of it.
    fn bend(&self, normal: Vec3) -> f32 {
        let unknown = 0.5 * (self.motion_a.acceleration + self.motion_b.acceleration);
        let bow = normal.dot(self.motion_a.course.bow - self.motion_b.course.bow);
        unknown + bow
    }

    /// Upper bound of the speed at which the gap along `normal` shrinks from `time` on, per unit of time.
    #[must_use]
    pub fn approach(&self, normal: Vec3, time: f32) -> f32 {
        let (a, b) = (&self.motion_a.course, &self.motion_b.course);
        a.approach(b, normal, time)
    }
}

/// The first l in 0..=1 at which (1 - l) start + l end - l (1 - l) bulge falls below zero, or 1;
/// `start` is not negative. A negative bulge is a way that keeps away from the floor.
fn first_below(start: f32, end: f32, bulge: f32) -> f32 {
    // bulge l^2 + (end - start - bulge) l + start
    let half_b = 0.5 * (end - start - bulge);
    if half_b >= 0.0 && end >= 0.0 {
        return 1.0;
    }
    let discriminant = half_b * half_b - bulge * start;
    if discriminant < 0.0 {
        return 1.0;
    }
    let root = math::sqrt(discriminant);
    let first = if half_b >= 0.0 {
        // Up first, then down through the floor: the bulge is negative.
        -(root + half_b) / bulge
    } else {
        // The smaller root, in the form without cancellation.
        start / (root - half_b)
    };
    // A hair earlier, for the rounding of this formula.
    math::min(first * (1.0 - 4.0 * f32::EPSILON), 1.0)
}
