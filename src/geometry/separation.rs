//! The gap of two pieces in the world: distance while they are apart, penetration depth when they
//! overlap.

use glam::Vec3;

use super::convex::Convex;
use super::difference::Difference;
use super::distance::approach;
use super::expansion;
use super::manifold::CoreGap;
use super::penetration::boxes::Boxes;
use super::penetration::core_penetration_in;
use super::relative::Relative;
use crate::math::Pose;

/// How two pieces lie to each other, in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Separation {
    /// Unit normal from B into A.
    pub normal: Vec3,
    /// Certified gap along the normal in metres; negative is penetration depth.
    pub gap_m: f32,
    /// Nearest (or deepest) point on A's surface.
    pub point_a: Vec3,
    /// Nearest (or deepest) point on B's surface.
    pub point_b: Vec3,
}

/// The separation of two pieces at poses in the world.
///
/// `seed` is a direction from B toward A to start with; zero when none is known. It never changes
/// which answer is right, only how soon it is found. The pair is computed in B's frame.
///
/// Cost: one distance query, and one penetration query when the cores overlap.
#[must_use]
pub fn separation(a: &Convex, b: &Convex, pose_a: &Pose, pose_b: &Pose, seed: Vec3) -> Separation {
    separation_within(a, b, pose_a, pose_b, seed, 0.0)
}

/// As [`separation`], with the distance known to the share `accuracy` only, from below.
#[must_use]
pub fn separation_within(
    a: &Convex,
    b: &Convex,
    pose_a: &Pose,
    pose_b: &Pose,
    seed: Vec3,
    accuracy: f32,
) -> Separation {
    let to_world = pose_b.quat();
    let a_in_b = Relative::between(pose_a, pose_b);
    let core = gap_of_cores(a, b, &a_in_b, to_world.conjugate() * seed, accuracy);
    Separation {
        normal: to_world * core.normal,
        gap_m: core.gap - a.radius - b.radius,
        point_a: pose_b.point(core.point_a - core.normal * a.radius),
        point_b: pose_b.point(core.point_b + core.normal * b.radius),
    }
}

/// The gap of two cores in the frame of B, `a_in_b` being A's pose there; `seed` as in
/// [`super::distance::distance`].
#[must_use]
pub fn core_gap(a: &Convex, b: &Convex, a_in_b: &Pose, seed: Vec3) -> CoreGap {
    gap_of_cores(a, b, &Relative::from(a_in_b), seed, 0.0)
}

fn gap_of_cores(a: &Convex, b: &Convex, a_in_b: &Relative, seed: Vec3, accuracy: f32) -> CoreGap {
    if let Some(boxes) = Boxes::of(a, b, a_in_b)
        && let Some(found) = boxes.core_gap()
    {
        return found;
    }
    let pair = Difference { a, b, a_in_b };
    let seed = if seed == Vec3::ZERO {
        pair.guess()
    } else {
        seed.as_dvec3()
    };
    let found = approach(&pair, seed, f64::from(accuracy));
    if found.lower_m > 0.0 {
        return (&found.distance(&pair)).into();
    }
    if found.inside
        && let Some(depth) = expansion::depth(&pair, found.simplex.corners())
    {
        return CoreGap {
            normal: depth.normal.as_vec3(),
            gap: -depth.depth_m as f32,
            point_a: depth.point_a,
            point_b: depth.point_b,
        };
    }
    (&core_penetration_in(a, b, a_in_b, f32::NEG_INFINITY)).into()
}
