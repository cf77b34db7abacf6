//! The distance of cores that are apart, with proof of how far off it can be.
//!
//! Source: Gilbert, Johnson and Keerthi 1988, with van den Bergen's duality gap as the stopping
//! rule: every support plane bounds the distance from below, every simplex from above.

use super::near::{self, Weighted};
use super::relative::Relative;
use glam::DVec3;

const PASSES_MAX: usize = 128;
/// The bounds may differ by this times the pair's scale.
const SETTLED_RELATIVE: f64 = 1e-14;
/// Below this times the pair's scale the simplex gives no direction any more.
const TOUCHING_RELATIVE: f64 = 1e-15;

/// What is known about the distance between two cores, in metres and in the frame of `a`.
pub(super) struct Apart {
    /// The distance is at least this; negative if no separating plane was met.
    pub lower: f64,
    /// The distance between the two points; infinite if a simplex encloses the origin, which
    /// rounding may also cause when cores touch.
    pub upper: f64,
    pub points: [DVec3; 2],
    /// From the second point to the first, of length one unless they coincide.
    pub direction: DVec3,
}

/// Closes the bounds on the distance, or stops as soon as `lower` exceeds `enough`.
pub(super) fn bounds(pair: &Relative, enough: f64) -> Apart {
    let start = pair.between_centres();
    let start = if start.length() > 0.0 {
        start.normalize()
    } else {
        DVec3::X
    };
    let mut search = Search::new(pair, start);
    for _ in 0..PASSES_MAX {
        if !search.advance(pair, enough) {
            break;
        }
    }
    search.found.direction = search.direction();
    search.found
}

struct Search {
    simplex: Vec<[DVec3; 2]>,
    found: Apart,
}

impl Search {
    fn new(pair: &Relative, normal: DVec3) -> Self {
        let points = pair.support(normal);
        let lower = normal.dot(points[0] - points[1]);
        let upper = (points[0] - points[1]).length();
        let mut simplex = Vec::with_capacity(4);
        simplex.push(points);
        Self {
            simplex,
            found: Apart {
                lower,
                upper,
                points,
                direction: normal,
            },
        }
    }

    fn advance(&mut self, pair: &Relative, enough: f64) -> bool {
        let Apart { lower, upper, .. } = self.found;
        if lower > enough || upper <= TOUCHING_RELATIVE * pair.scale {
            return false;
        }
        let normal = self.direction();
        let vertex = pair.support(normal);
        let gap = normal.dot(vertex[0] - vertex[1]);
        self.found.lower = lower.max(gap);
        let settled = upper - gap <= SETTLED_RELATIVE * pair.scale;
        !settled && self.found.lower <= enough && self.shrink(vertex)
    }

    /// From one point to the other, made square to the simplex. The difference of two near points
    /// has lost digits, and without this the lower bound would be off by rounding times scale
    /// squared over distance.
    fn direction(&self) -> DVec3 {
        let [a, b] = self.found.points;
        let normal = (a - b).normalize_or_zero();
        let longer_than_gap = |part: DVec3| {
            let length = part.length();
            if length > (a - b).length() {
                part / length
            } else {
                DVec3::ZERO
            }
        };
        let from_first = |i: usize| {
            let side = |[a, b]: [DVec3; 2]| a - b;
            let first = side(self.simplex[0]);
            self.simplex
                .get(i)
                .map_or(DVec3::ZERO, |&p| side(p) - first)
        };
        let along = longer_than_gap(from_first(1));
        let across = longer_than_gap(without(from_first(2), along));
        let square = without(without(normal, along), across);
        if square.length() > 0.5 {
            square.normalize()
        } else {
            normal
        }
    }

    fn shrink(&mut self, vertex: [DVec3; 2]) -> bool {
        if self.simplex.contains(&vertex) {
            return false;
        }
        self.simplex.push(vertex);
        let corners: Vec<DVec3> = self.simplex.iter().map(|[a, b]| *a - *b).collect();
        match near::simplex(&corners) {
            Some(weights) if self.accept(&weights) => true,
            enclosed_or_stalled => {
                if enclosed_or_stalled.is_none() {
                    self.found.upper = f64::INFINITY;
                }
                self.simplex.pop();
                false
            }
        }
    }

    fn accept(&mut self, weights: &Weighted) -> bool {
        let points = blend(&self.simplex, weights);
        let distance = (points[0] - points[1]).length();
        if distance >= self.found.upper {
            return false;
        }
        self.found.upper = distance;
        self.found.points = points;
        let mut weight = weights.iter();
        self.simplex
            .retain(|_| weight.next().is_some_and(|&w| w > 0.0));
        true
    }
}

fn without(vector: DVec3, axis: DVec3) -> DVec3 {
    vector - axis * axis.dot(vector)
}

fn blend(simplex: &[[DVec3; 2]], weights: &Weighted) -> [DVec3; 2] {
    [0, 1].map(|side| simplex.iter().zip(weights).map(|(p, &w)| p[side] * w).sum())
}
