//! The gap of two pieces in the world: distance while they are apart, penetration depth when they
//! overlap.

use glam::Vec3;

use super::convex::Convex;
use super::difference::Difference;
use super::distance::{Accuracy, Approach, approach, approach_again};
use super::expansion::{self, Depth};
use super::manifold::CoreGap;
use super::penetration::boxes::Boxes;
use super::penetration::{core_penetration_in, normal_of_crossing};
use super::relative::Relative;
use super::warm::{WarmFeature, WarmStart};
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
/// which answer is right, only how soon it is found. The pair is computed in B's frame, in f64, and
/// rounded once: gap and depth are exact to 1e-7 of the smaller piece wherever the pair is.
///
/// Where the cores overlap the normal is that of the least translation that parts them; of several
/// equally short ones the answer does not depend on the seed either.
///
/// Cost: for a pair of boxes fifteen axes. Otherwise at most [`crate::limits::DISTANCE_STEPS_MAX`]
/// steps of one support query of each core, and where the cores overlap at most 60 more steps with a
/// pass over at most 92 triangles each. Pairs for which that is not enough are measured by enumeration,
/// in [`super::penetration::worst_steps`].
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
    let start = Start::Seed(pose_b.quat().conjugate() * seed);
    in_world(
        a,
        b,
        pose_a,
        pose_b,
        start,
        Accuracy::share(accuracy.into()),
    )
}

/// As [`separation`], starting where the last question about these two pieces ended.
///
/// The answer is that of [`separation`]; `warm` only saves time, and holds this answer's end
/// afterwards. Where the nearest points are not unique (parallel faces or edges), which of them are
/// returned may depend on it. Cost when little has moved: one pass over what is remembered and one or
/// two support queries of each core; at most that of [`separation`] more.
#[must_use]
pub fn separation_again(
    a: &Convex,
    b: &Convex,
    pose_a: &Pose,
    pose_b: &Pose,
    warm: &mut WarmStart,
) -> Separation {
    in_world(a, b, pose_a, pose_b, Start::Surface(warm), Accuracy::FULL)
}

/// As [`separation_within`], starting at the nearest feature of the last answer, and leaving the new
/// one.
#[must_use]
pub fn separation_from(
    a: &Convex,
    b: &Convex,
    pose_a: &Pose,
    pose_b: &Pose,
    feature: &mut WarmFeature,
    accuracy: f32,
) -> Separation {
    let start = Start::Feature(feature);
    in_world(
        a,
        b,
        pose_a,
        pose_b,
        start,
        Accuracy::share(accuracy.into()),
    )
}

/// What a search starts from.
enum Start<'w> {
    /// A direction from B toward A in B's frame, or zero.
    Seed(Vec3),
    /// The nearest feature of the last answer.
    Feature(&'w mut WarmFeature),
    /// That and the surface around the origin.
    Surface(&'w mut WarmStart),
}

fn in_world(
    a: &Convex,
    b: &Convex,
    pose_a: &Pose,
    pose_b: &Pose,
    start: Start,
    accuracy: Accuracy,
) -> Separation {
    let to_world = pose_b.quat();
    let a_in_b = Relative::between(pose_a, pose_b);
    let core = gap_of_cores(a, b, &a_in_b, start, accuracy);
    Separation {
        normal: to_world * core.normal,
        gap_m: core.gap - a.radius - b.radius,
        point_a: pose_b.point(core.point_a - core.normal * a.radius),
        point_b: pose_b.point(core.point_b + core.normal * b.radius),
    }
}

/// The gap of two cores in the frame of B, `a_in_b` being A's pose there; `seed` is a direction from B
/// toward A to start with, or zero.
#[must_use]
pub fn core_gap(a: &Convex, b: &Convex, a_in_b: &Pose, seed: Vec3) -> CoreGap {
    gap_of_cores(
        a,
        b,
        &Relative::from(a_in_b),
        Start::Seed(seed),
        Accuracy::FULL,
    )
}

/// As [`core_gap`], starting at the nearest feature of the last answer, and leaving the new one. Of cores whose
/// surfaces are farther apart than `beyond_m`, the share `share` of the distance may be given away: the gap is then
/// that of the planes along the answer's normal, and the witness points are none of the nearest.
#[must_use]
pub fn core_gap_beyond(
    a: &Convex,
    b: &Convex,
    a_in_b: &Pose,
    feature: &mut WarmFeature,
    beyond_m: f32,
    share: f32,
) -> CoreGap {
    let a_in_b = Relative::from(a_in_b);
    let accuracy = Accuracy {
        share: share.into(),
        beyond_m: beyond_m.into(),
    };
    gap_of_cores(a, b, &a_in_b, Start::Feature(feature), accuracy)
}

fn gap_of_cores(
    a: &Convex,
    b: &Convex,
    a_in_b: &Relative,
    start: Start,
    accuracy: Accuracy,
) -> CoreGap {
    if let Some(boxes) = Boxes::of(a, b, a_in_b)
        && let Some(found) = boxes.core_gap()
    {
        return found;
    }
    let pair = Difference { a, b, a_in_b };
    let found = match start {
        Start::Seed(seed) => {
            let seed = if seed == Vec3::ZERO {
                pair.guess()
            } else {
                seed.as_dvec3()
            };
            approached(&pair, &approach(&pair, seed, accuracy), None)
        }
        Start::Feature(feature) => {
            let found = approach_from(&pair, feature, accuracy);
            approached(&pair, &found, None)
        }
        Start::Surface(warm) => again(&pair, warm),
    };
    found.unwrap_or_else(|| (&core_penetration_in(a, b, a_in_b, f32::NEG_INFINITY)).into())
}

fn again(pair: &Difference, warm: &mut WarmStart) -> Option<CoreGap> {
    if let Some(depth) = expansion::depth_again(pair, warm) {
        return Some((&depth).into());
    }
    warm.forget_surface();
    let found = approach_from(pair, &mut warm.feature, Accuracy::FULL);
    approached(pair, &found, Some(warm))
}

/// A search from the last nearest feature, if there is one, that leaves the new one.
fn approach_from(pair: &Difference, feature: &mut WarmFeature, accuracy: Accuracy) -> Approach {
    let found = approach_again(pair, feature, accuracy)
        .unwrap_or_else(|| approach(pair, pair.guess(), accuracy));
    feature.remember(found.simplex.corners());
    found
}

/// The gap at the end of a search; `None` where enumeration has to decide.
#[inline]
fn approached(
    pair: &Difference,
    found: &Approach,
    warm: Option<&mut WarmStart>,
) -> Option<CoreGap> {
    let corners = found.simplex.corners();
    if found.inside {
        return Some((&expansion::depth(pair, corners, warm)?).into());
    }
    if found.lower_m > 0.0 {
        return Some((&found.distance(pair)).into());
    }
    if pair.a.faces.is_empty() && pair.b.faces.is_empty() {
        return Some(meeting(pair, found));
    }
    Some((&expansion::depth_from_afar(pair, corners, warm)?).into())
}

/// Points or segments that meet: the least way out of their rounding is across both.
fn meeting(pair: &Difference, found: &Approach) -> CoreGap {
    let end = found.distance(pair);
    let along_a = pair.a_in_b.turn * pair.a.extent().as_dvec3();
    CoreGap {
        normal: normal_of_crossing(along_a.as_vec3(), pair.b.extent()),
        gap: 0.0,
        point_a: end.point_a,
        point_b: end.point_b,
    }
}

impl From<&Depth> for CoreGap {
    fn from(found: &Depth) -> Self {
        Self {
            normal: found.normal.as_vec3(),
            gap: -found.depth_m as f32,
            point_a: found.point_a,
            point_b: found.point_b,
        }
    }
}
