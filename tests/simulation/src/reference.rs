//! An f64 reference for depth and distance between rounded convex pieces, and between unions of them.
//!
//! It shares no code and no method choices with the kernel, which it judges. Lengths are in metres.
//!
//! * [`signed_distance`]: gap or penetration depth of a pair, with normal and points.
//! * [`overlap_depth`]: the depth alone, fast when the pair is apart.
//! * [`Judge`]: the deepest overlap in a scene, frame by frame.
//! * [`union_escape`]: the least translation that separates two unions.

mod apart;
mod axes;
mod exact;
mod features;
mod hull;
mod judge;
mod near;
mod relative;
mod solid;
mod union;

pub use hull::{Edge, Face};
pub use judge::{Judge, Overlap, Verdict};
pub use solid::{Placed, Pose, Solid, SolidError};
pub use union::{EscapeError, union_escape};

use apart::Apart;
use axes::Deepest;
use glam::DVec3;
use relative::Relative;

/// Bounds that differ by less than this times the pair's scale give the distance.
const PROVEN_RELATIVE: f64 = 1e-13;
/// Cores nearer than this times the pair's scale are also measured by separating axes.
const TOUCHING_RELATIVE: f64 = 1e-9;

/// How far apart two rounded pieces are, in metres and in the world's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Signed {
    /// The gap if positive; minus the penetration depth if negative.
    pub value: f64,
    /// From `b` into `a`, of length one: moving `a` by `-value * normal` makes the two just touch.
    pub normal: DVec3,
    /// The point of `a` that is nearest to `b`, or deepest in it.
    pub point_a: DVec3,
    /// The point of `b` likewise: `point_a - point_b = value * normal`.
    pub point_b: DVec3,
}

/// The signed distance between two rounded pieces.
///
/// Cores apart: their distance by Gilbert, Johnson and Keerthi with both bounds closed to 1e-13 of
/// the pair's scale, or by all pairs of features if they do not close. Cores that overlap: all
/// separating axes. The scale is the sum of both radii about the centres and the distance between
/// these. Where the deepest direction is not unique, any of them is returned.
pub fn signed_distance(a: &Placed, b: &Placed) -> Signed {
    let pair = Relative::new(a, b);
    let found = apart::bounds(&pair, f64::INFINITY);
    rounded(a, b, core(&pair, found))
}

/// The penetration depth of two rounded pieces, in metres; zero if they are apart or touch.
pub fn overlap_depth(a: &Placed, b: &Placed) -> f64 {
    let radii = a.solid().radius() + b.solid().radius();
    let reach = a.solid().reach() + b.solid().reach() + radii;
    if a.world_centre().distance_squared(b.world_centre()) > reach * reach {
        return 0.0;
    }
    let pair = Relative::new(a, b);
    let found = apart::bounds(&pair, radii);
    if found.lower > radii {
        return 0.0;
    }
    (radii - core(&pair, found).gap).max(0.0)
}

/// The signed distance of the cores in the frame of `a`, from what is known about their distance.
fn core(pair: &Relative, found: Apart) -> Deepest {
    let proven = |lower: f64| found.upper - lower <= PROVEN_RELATIVE * pair.scale;
    if proven(found.lower) && found.upper > TOUCHING_RELATIVE * pair.scale {
        return Deepest {
            gap: found.upper,
            normal: found.direction,
            points: found.points,
        };
    }
    let deepest = axes::deepest(pair);
    if deepest.gap <= 0.0 {
        return deepest;
    }
    let settled = proven(found.lower.max(deepest.gap));
    let points = if settled {
        found.points
    } else {
        features::nearest(pair)
    };
    touching(pair, deepest, points)
}

fn by_points(points: [DVec3; 2]) -> Deepest {
    let gap = (points[0] - points[1]).length();
    Deepest {
        gap,
        normal: (points[0] - points[1]) / gap,
        points,
    }
}

/// Of two candidates for cores that are barely apart, the one whose normal proves the larger gap.
fn touching(pair: &Relative, deepest: Deepest, points: [DVec3; 2]) -> Deepest {
    if points[0] == points[1] {
        return deepest;
    }
    let nearest = by_points(points);
    let proves_more = pair.gap_along(nearest.normal) >= deepest.gap;
    if proves_more {
        nearest
    } else {
        Deepest {
            gap: nearest.gap.max(deepest.gap),
            ..deepest
        }
    }
}

fn rounded(a: &Placed, b: &Placed, core: Deepest) -> Signed {
    let (radius_a, radius_b) = (a.solid().radius(), b.solid().radius());
    let [on_a, on_b] = core.points;
    let point_a = on_a - core.normal * radius_a;
    let point_b = on_b + core.normal * radius_b;
    let world = |p: DVec3| a.rotation() * p + a.position();
    Signed {
        value: core.gap - radius_a - radius_b,
        normal: (a.rotation() * core.normal).normalize(),
        point_a: world(point_a),
        point_b: world(point_b),
    }
}
