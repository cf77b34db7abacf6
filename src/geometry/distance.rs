//! Distance of two convex cores, with a certificate.
//!
//! Gilbert, Johnson and Keerthi 1988 on the difference of the cores, in f64. Whatever the iteration
//! does, the answer is safe to use: `lower_m` is the gap between two parallel planes that enclose
//! the cores, measured by their supports, and does not depend on convergence.

use glam::{DVec3, Vec3};

use super::convex::Convex;
use super::difference::Difference;
use super::manifold::CoreGap;
use super::penetration::boxes::Boxes;
use super::relative::Relative;
use super::simplex::Simplex;
use super::warm::WarmFeature;
use crate::limits::DISTANCE_STEPS_MAX;
use crate::math::{self, Pose};

/// How far apart two cores are, in the frame of the second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    /// Unit normal from B into A of the planes that `lower_m` is measured between.
    pub normal: Vec3,
    /// The cores are at least this far apart along `normal`, in metres; negative when no separating
    /// plane was found.
    pub lower_m: f32,
    /// The distance of `point_a` and `point_b`: the cores are at most this far apart.
    pub upper_m: f32,
    /// Nearest point found on A.
    pub point_a: Vec3,
    /// Nearest point found on B.
    pub point_b: Vec3,
    /// Steps used: each is one support query of each core.
    pub steps: u32,
}

impl Distance {
    /// Whether the cores overlap or touch as far as f32 can tell.
    #[must_use]
    pub fn cores_overlap(&self) -> bool {
        self.lower_m <= 0.0
    }
}

/// The distance of two cores; `a_in_b` is A's pose in B's frame, and so is the answer.
///
/// `seed` is a direction from B toward A to start with, of any length; it changes how long the
/// search takes and, within the error below, nothing else. The gap between `lower_m` and `upper_m`
/// is the certified error: at most about 1e-7 of the smaller piece's size, from rounding to f32.
///
/// Cost: at most [`DISTANCE_STEPS_MAX`] steps, typically 4 to 7.
#[must_use]
pub fn distance(a: &Convex, b: &Convex, a_in_b: &Pose, seed: Vec3) -> Distance {
    let a_in_b = Relative::from(a_in_b);
    let pair = Difference {
        a,
        b,
        a_in_b: &a_in_b,
    };
    match Boxes::of(a, b, &a_in_b).and_then(|boxes| boxes.core_gap()) {
        Some(found) => of_boxes(&found),
        None => approach(&pair, seed.as_dvec3(), Accuracy::FULL).distance(&pair),
    }
}

fn of_boxes(found: &CoreGap) -> Distance {
    let overlap = found.gap <= 0.0;
    Distance {
        normal: found.normal,
        lower_m: found.gap,
        upper_m: if overlap { 0.0 } else { found.gap },
        point_a: found.point_a,
        point_b: if overlap {
            found.point_a
        } else {
            found.point_b
        },
        steps: 1,
    }
}

/// How well a search is to know the distance of two pieces' surfaces.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Accuracy {
    /// The share of the distance that may be given away ...
    pub share: f64,
    /// ... once they are known to be farther apart than this, in metres.
    pub beyond_m: f64,
}

impl Accuracy {
    /// To the last digit.
    pub(crate) const FULL: Self = Self::share(0.0);

    /// The same share of any distance.
    pub(crate) const fn share(share: f64) -> Self {
        Self {
            share,
            beyond_m: f64::NEG_INFINITY,
        }
    }
}

/// What a search for the point of the difference nearest the origin came to.
pub(crate) struct Approach {
    /// Corners about that point; four with the origin inside when the cores overlap.
    pub simplex: Simplex,
    /// Unit normal of the best parting planes, from B into A.
    pub normal: DVec3,
    /// The gap between those planes, in metres.
    pub lower_m: f64,
    /// Whether the origin is inside the simplex.
    pub inside: bool,
    /// Steps used.
    pub steps: u32,
}

/// Searches from the direction `seed` on (of any length, or zero), until the planes prove the distance
/// as well as `accuracy` asks.
#[inline]
pub(crate) fn approach(pair: &Difference, seed: DVec3, accuracy: Accuracy) -> Approach {
    let normal = unit(seed).unwrap_or(DVec3::Y);
    let first = pair.lowest(normal);
    let start = Approach {
        simplex: Simplex::new(first),
        normal,
        lower_m: normal.dot(first.at),
        inside: false,
        steps: 1,
    };
    go_on(pair, start, accuracy)
}

/// As [`approach`], from the nearest feature of an earlier answer; `None` if there is none.
pub(crate) fn approach_again(
    pair: &Difference,
    warm: &WarmFeature,
    accuracy: Accuracy,
) -> Option<Approach> {
    let corners = warm.corners(pair)?;
    let mut simplex = Simplex::new(corners[0]);
    for &corner in &corners[1..] {
        simplex.push(corner);
    }
    let nearest = simplex.nearest_of_any()?;
    simplex.keep(&nearest);
    let start = Approach {
        simplex,
        normal: DVec3::Y,
        lower_m: f64::NEG_INFINITY,
        inside: false,
        steps: 0,
    };
    Some(go_on(pair, start, accuracy))
}

#[inline]
fn go_on(pair: &Difference, mut found: Approach, accuracy: Accuracy) -> Approach {
    let grain_m = pair.grain_m();
    let radii = f64::from(pair.a.radius) + f64::from(pair.b.radius);
    let mut last = f64::INFINITY;
    while found.steps < DISTANCE_STEPS_MAX {
        let Some(nearest) = found.simplex.nearest() else {
            found.inside = true;
            break;
        };
        if nearest.squared >= last {
            found.simplex.pop();
            break;
        }
        last = nearest.squared;
        found.simplex.keep(&nearest);
        let length = math::sqrt_f64(nearest.squared);
        let spare = accuracy.share * math::max_f64(length - radii, 0.0);
        let proves = |lower_m: f64| {
            let may_give = lower_m - radii > accuracy.beyond_m;
            lower_m >= length - (if may_give { spare } else { 0.0 } + grain_m)
        };
        if accuracy.share > 0.0 && proves(found.lower_m) {
            break;
        }
        let corner = pair.lowest(nearest.direction);
        found.steps += 1;
        if length <= grain_m {
            break;
        }
        found.take_planes(nearest.direction, corner.at);
        if proves(found.lower_m) || found.simplex.holds(&corner) {
            break;
        }
        found.simplex.push(corner);
    }
    found
}

impl Approach {
    /// Keeps the planes along a direction of any length, of which `lowest` is on one, if they are
    /// farther apart.
    #[inline]
    fn take_planes(&mut self, direction: DVec3, lowest: DVec3) {
        let scale = 1.0 / math::sqrt_f64(direction.length_squared());
        let lower_m = direction.dot(lowest) * scale;
        if lower_m > self.lower_m {
            self.lower_m = lower_m;
            self.normal = direction * scale;
        }
    }

    /// The answer in f32.
    pub(crate) fn distance(&self, pair: &Difference) -> Distance {
        let (point_a, point_b) = pair.witnesses(self.simplex.corners(), &self.simplex.weights());
        Distance {
            normal: self.normal.as_vec3(),
            lower_m: self.lower_m as f32,
            upper_m: math::length(point_a - point_b),
            point_a,
            point_b,
            steps: self.steps,
        }
    }
}

/// The unit vector along `v`; `None` for zero and what is not finite.
#[inline]
pub(crate) fn unit(v: DVec3) -> Option<DVec3> {
    let squared = v.length_squared();
    (squared > 1e-60 && squared < 1e60).then(|| v / math::sqrt_f64(squared))
}
