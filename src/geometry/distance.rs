//! Distance of two convex cores, with a certificate.
//!
//! Gilbert, Johnson and Keerthi 1988 on the difference of the cores, with the reduction of van den
//! Bergen 2003 (only sub-simplices with the newest vertex can win). The simplex is solved in f64:
//! its f32 vertices are exact there, so degenerate simplices do no harm. Whatever the iteration
//! does, the answer is safe to use: `lower_m` is the gap between two parallel planes that enclose
//! the cores, measured by their supports, and does not depend on convergence.

use glam::{DVec3, Vec3};

use super::convex::Convex;
use super::penetration::boxes::Boxes;
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

/// A vertex of the difference A - B and where it comes from.
#[derive(Clone, Copy, Debug)]
struct Vertex {
    difference: DVec3,
    on_a: Vec3,
    on_b: Vec3,
}

/// Up to four vertices with the weights of the point nearest the origin.
#[derive(Clone, Copy, Debug)]
struct Simplex {
    vertices: [Vertex; 4],
    weights: [f64; 4],
    count: usize,
}

/// Two cores and where the first is in the frame of the second.
struct Cores<'a> {
    a: &'a Convex<'a>,
    b: &'a Convex<'a>,
    a_in_b: Pose,
    rotation: glam::Mat3,
    inverse: glam::Mat3,
}

impl Cores<'_> {
    /// The vertex of A - B that reaches farthest along `-direction`.
    fn nearest_along(&self, direction: Vec3) -> Vertex {
        let index_a = self.a.support(self.inverse * -direction).index;
        let index_b = self.b.support(direction).index;
        let on_a = self.rotation * self.a.vertex(index_a) + self.a_in_b.translation();
        let on_b = self.b.vertex(index_b);
        Vertex {
            difference: on_a.as_dvec3() - on_b.as_dvec3(),
            on_a,
            on_b,
        }
    }
}

/// The distance of two cores; `a_in_b` is A's pose in B's frame, and so is the answer.
///
/// `seed` is a direction from B toward A to start with, of any length; it changes how long the
/// search takes and, within the error below, nothing else. The gap between `lower_m` and `upper_m`
/// is the certified error: at most about 1e-6 of the distance plus 1e-7 of the pieces' size.
///
/// Cost: at most [`DISTANCE_STEPS_MAX`] steps, typically 3 to 6.
#[must_use]
pub fn distance(a: &Convex, b: &Convex, a_in_b: &Pose, seed: Vec3) -> Distance {
    distance_within(a, b, a_in_b, seed, 0.0)
}

/// As [`distance`], but done as soon as the certified error is at most `accuracy` of the distance: for
/// bounds that are used once, where the normal does not matter.
#[must_use]
pub fn distance_within(
    a: &Convex,
    b: &Convex,
    a_in_b: &Pose,
    seed: Vec3,
    accuracy: f32,
) -> Distance {
    let accuracy = f64::from(math::max(accuracy, 1e-6));
    let rotation = a_in_b.matrix();
    let cores = Cores {
        a,
        b,
        a_in_b: *a_in_b,
        rotation,
        inverse: rotation.transpose(),
    };
    let noise = 1e-7 * f64::from(a.size() + b.size());
    if let Some(found) = distance_of_boxes(a, b, a_in_b, noise) {
        return found;
    }
    let mut direction = math::direction(seed).unwrap_or(Vec3::Y);
    let first = cores.nearest_along(direction);
    let mut simplex = Simplex::new(first);
    let mut best_normal = direction;
    let mut best_lower = plane_gap(direction, &first);
    let mut steps = 1;
    while steps < DISTANCE_STEPS_MAX {
        let nearest = simplex.nearest();
        let length = math::sqrt_f64(nearest.length_squared());
        if length <= noise {
            break;
        }
        direction = (nearest / length).as_vec3();
        let vertex = cores.nearest_along(direction);
        steps += 1;
        let lower = plane_gap(direction, &vertex);
        if lower > best_lower {
            best_lower = lower;
            best_normal = direction;
        }
        let converged = length - best_lower <= accuracy * length + noise;
        if converged || simplex.holds(&vertex) || !simplex.reduce_with(vertex, length) {
            break;
        }
    }
    answer(&simplex, best_normal, best_lower, steps)
}

/// The answer for two boxes whose nearest features are those of the axis that parts them most, and
/// for boxes that overlap.
fn distance_of_boxes(a: &Convex, b: &Convex, a_in_b: &Pose, noise: f64) -> Option<Distance> {
    let pair = Boxes::of(a, b, a_in_b)?;
    let least = pair.least(f64::NEG_INFINITY);
    if least.depth > -noise && least.depth <= noise {
        return None;
    }
    let (on_a, on_b) = pair.nearest_points(&least, noise)?;
    let upper = if least.depth < 0.0 {
        math::sqrt_f64((on_a - on_b).length_squared())
    } else {
        0.0
    };
    Some(Distance {
        normal: least.normal.as_vec3(),
        lower_m: -least.depth as f32,
        upper_m: upper as f32,
        point_a: on_a.as_vec3(),
        point_b: on_b.as_vec3(),
        steps: 1,
    })
}

fn plane_gap(direction: Vec3, vertex: &Vertex) -> f64 {
    direction.as_dvec3().dot(vertex.difference)
}

fn answer(simplex: &Simplex, normal: Vec3, lower: f64, steps: u32) -> Distance {
    let (mut on_a, mut on_b) = (DVec3::ZERO, DVec3::ZERO);
    for (vertex, weight) in simplex
        .vertices
        .iter()
        .zip(simplex.weights)
        .take(simplex.count)
    {
        on_a += vertex.on_a.as_dvec3() * weight;
        on_b += vertex.on_b.as_dvec3() * weight;
    }
    Distance {
        normal,
        lower_m: lower as f32,
        upper_m: math::sqrt_f64((on_a - on_b).length_squared()) as f32,
        point_a: on_a.as_vec3(),
        point_b: on_b.as_vec3(),
        steps,
    }
}

impl Simplex {
    fn new(vertex: Vertex) -> Self {
        Self {
            vertices: [vertex; 4],
            weights: [1.0, 0.0, 0.0, 0.0],
            count: 1,
        }
    }

    fn nearest(&self) -> DVec3 {
        let mut sum = DVec3::ZERO;
        for (vertex, weight) in self.vertices.iter().zip(self.weights).take(self.count) {
            sum += vertex.difference * weight;
        }
        sum
    }

    fn holds(&self, vertex: &Vertex) -> bool {
        self.vertices[..self.count]
            .iter()
            .any(|held| held.on_a == vertex.on_a && held.on_b == vertex.on_b)
    }

    /// Adds a vertex and keeps the smallest sub-simplex nearest the origin. False when that gets no
    /// nearer than `length`, or when the origin is inside.
    fn reduce_with(&mut self, vertex: Vertex, length: f64) -> bool {
        self.vertices[self.count] = vertex;
        self.count += 1;
        let newest = self.count - 1;
        // A triangle that the origin projects into is nearer than its sides.
        if newest == 2
            && let Some(best) = self.triangle(0, 1, 2)
        {
            return self.keep_nearer(&best, length);
        }
        let mut best = Candidate::point(newest, vertex.difference);
        for first in 0..newest {
            best.take_nearer(self.edge(first, newest));
            for second in first + 1..newest {
                best.take_nearer(self.triangle(first, second, newest));
            }
        }
        let inside = self.count == 4 && self.holds_origin();
        if inside {
            self.keep_inside();
            return false;
        }
        self.keep_nearer(&best, length)
    }

    /// Keeps a sub-simplex with the newest vertex if it is nearer than `length`, else drops the vertex.
    fn keep_nearer(&mut self, best: &Candidate, length: f64) -> bool {
        let nearer = best.length_squared < length * length;
        if nearer {
            self.keep(best);
        } else {
            self.count -= 1;
        }
        nearer
    }

    fn edge(&self, first: usize, newest: usize) -> Option<Candidate> {
        let (p, q) = (
            self.vertices[first].difference,
            self.vertices[newest].difference,
        );
        let along = p - q;
        let span = along.length_squared();
        let weight = -q.dot(along);
        if !(weight > 0.0 && weight < span) {
            return None;
        }
        let share = weight / span;
        Some(Candidate {
            length_squared: (q + along * share).length_squared(),
            vertices: [first, newest, 0],
            weights: [share, 1.0 - share, 0.0],
            count: 2,
        })
    }

    fn triangle(&self, first: usize, second: usize, newest: usize) -> Option<Candidate> {
        let corner = self.vertices[newest].difference;
        let u = self.vertices[first].difference - corner;
        let v = self.vertices[second].difference - corner;
        let normal = u.cross(v);
        let area = normal.length_squared();
        if area <= 1e-24 * u.length_squared() * v.length_squared() {
            return None;
        }
        // Barycentric coordinates of the origin's projection (Ericson 2005, section 3.4).
        let first_weight = v.cross(corner).dot(normal) / area;
        let second_weight = corner.cross(u).dot(normal) / area;
        let last_weight = 1.0 - first_weight - second_weight;
        if first_weight < 0.0 || second_weight < 0.0 || last_weight < 0.0 {
            return None;
        }
        let distance = corner.dot(normal);
        Some(Candidate {
            length_squared: distance * distance / area,
            vertices: [first, second, newest],
            weights: [first_weight, second_weight, last_weight],
            count: 3,
        })
    }

    /// Whether the origin is in the tetrahedron: on the inner side of all four faces.
    fn holds_origin(&self) -> bool {
        let p = |i: usize| self.vertices[i].difference;
        const FACES: [[usize; 4]; 4] = [[0, 1, 2, 3], [0, 1, 3, 2], [0, 2, 3, 1], [1, 2, 3, 0]];
        FACES.iter().all(|&[a, b, c, opposite]| {
            let normal = (p(b) - p(a)).cross(p(c) - p(a));
            let inner = normal.dot(p(opposite) - p(a));
            let origin = normal.dot(-p(a));
            inner * origin > 0.0
        })
    }

    fn keep(&mut self, best: &Candidate) {
        self.count = best.count;
        // The vertices of a candidate ascend, so none is overwritten before it is taken.
        for slot in 0..best.count {
            let from = best.vertices[slot];
            if from != slot {
                self.vertices[slot] = self.vertices[from];
            }
            self.weights[slot] = best.weights[slot];
        }
    }

    /// The cores overlap: weights are of no use any more.
    fn keep_inside(&mut self) {
        self.weights = [0.25; 4];
    }
}

/// A sub-simplex and its point nearest the origin.
struct Candidate {
    length_squared: f64,
    vertices: [usize; 3],
    weights: [f64; 3],
    count: usize,
}

impl Candidate {
    fn point(vertex: usize, at: DVec3) -> Self {
        Self {
            length_squared: at.length_squared(),
            vertices: [vertex, 0, 0],
            weights: [1.0, 0.0, 0.0],
            count: 1,
        }
    }

    fn take_nearer(&mut self, other: Option<Self>) {
        if let Some(other) = other
            && other.length_squared < self.length_squared
        {
            *self = other;
        }
    }
}
