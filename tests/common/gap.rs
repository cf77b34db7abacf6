//! The gap of two pieces in double precision, by brute force over their features: a reference that
//! shares nothing with the kernel but the shapes.
#![allow(
    dead_code,
    unreachable_pub,
    reason = "every test file uses a part of it"
)]

use glam::{DQuat, DVec3};

use crate::shapes::{Hull, overlap};

/// Where a piece is, in double precision.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    pub turn: DQuat,
    pub at: DVec3,
}

/// A piece's vertices where they are.
pub struct Body<'h> {
    pub hull: &'h Hull,
    pub points: Vec<DVec3>,
}

/// Signed gap of the surfaces and the unit normal from B into A along which it is.
#[derive(Clone, Copy, Debug)]
pub struct Gap {
    pub gap_m: f64,
    pub normal: DVec3,
}

impl<'h> Body<'h> {
    pub fn new(hull: &'h Hull, place: &Place) -> Self {
        let put = |v: &glam::Vec3| place.turn * v.as_dvec3() + place.at;
        Self {
            hull,
            points: hull.points.iter().map(put).collect(),
        }
    }

    /// The edges; a sphere's core is one of no length.
    fn edges(&self) -> Vec<[DVec3; 2]> {
        let end = |index: u16| self.points[index as usize];
        match self.points[..] {
            [centre] => vec![[centre; 2]],
            _ => self
                .hull
                .edges
                .iter()
                .map(|e| e.vertices.map(end))
                .collect(),
        }
    }

    fn faces(&self) -> Vec<Vec<DVec3>> {
        let ring = |face: &palpable::geometry::convex::Face| {
            let first = face.first_loop as usize;
            let ring = &self.hull.loops[first..first + face.loop_count as usize];
            ring.iter().map(|&i| self.points[i as usize]).collect()
        };
        self.hull.faces.iter().map(ring).collect()
    }
}

/// The gap between planes with a unit normal from B into A: never more than the gap.
pub fn plane_gap(a: &Body, b: &Body, normal: DVec3) -> f64 {
    let radii = f64::from(a.hull.radius) + f64::from(b.hull.radius);
    -overlap(&a.points, &b.points, normal) - radii
}

/// The gap of the surfaces.
///
/// The nearest pair of an edge and an edge, or of a vertex and a face above which it lies, is that of
/// the cores if they are apart. That is proved by the planes across it; without proof the cores
/// overlap, and the least overlap over all axes counts.
pub fn gap(a: &Body, b: &Body) -> Gap {
    let radii = f64::from(a.hull.radius) + f64::from(b.hull.radius);
    let between = nearest_features(a, b);
    let normal = between.normalize_or_zero();
    let size = a.hull.size() + b.hull.size();
    let distance = -overlap(&a.points, &b.points, normal);
    if distance > 0.0 && between.length() - distance <= 1e-9 * (size + distance) {
        return Gap {
            gap_m: distance - radii,
            normal,
        };
    }
    let (depth, normal) = depth(a, b);
    Gap {
        gap_m: -depth - radii,
        normal,
    }
}

/// From B to A, between the nearest pair of features.
fn nearest_features(a: &Body, b: &Body) -> DVec3 {
    let mut best = DVec3::splat(1e9);
    let mut take = |between: DVec3| {
        if between.length_squared() < best.length_squared() {
            best = between;
        }
    };
    let edges_b = b.edges();
    for edge_a in a.edges() {
        for edge_b in &edges_b {
            take(between_segments(edge_a, *edge_b));
        }
    }
    for face in b.faces() {
        for &point in &a.points {
            above(&face, point).into_iter().for_each(&mut take);
        }
    }
    for face in a.faces() {
        for &point in &b.points {
            above(&face, point).into_iter().for_each(|up| take(-up));
        }
    }
    best
}

/// From the segment `q` to the segment `p` where they are nearest: inside both, or at an end of one.
fn between_segments([p0, p1]: [DVec3; 2], [q0, q1]: [DVec3; 2]) -> DVec3 {
    let (u, v, w) = (p1 - p0, q1 - q0, p0 - q0);
    let to_p = |q: DVec3| p0 + u * share(q - p0, u) - q;
    let to_q = |p: DVec3| p - (q0 + v * share(p - q0, v));
    let mut best = to_p(q0);
    for other in [to_p(q1), to_q(p0), to_q(p1)] {
        if other.length_squared() < best.length_squared() {
            best = other;
        }
    }
    let (uu, vv, uv) = (u.dot(u), v.dot(v), u.dot(v));
    let det = uu * vv - uv * uv;
    if det > 1e-14 * uu * vv {
        let s = (uv * v.dot(w) - vv * u.dot(w)) / det;
        let t = (uu * v.dot(w) - uv * u.dot(w)) / det;
        let inside = w + u * s - v * t;
        let within = (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t);
        if within && inside.length_squared() < best.length_squared() {
            best = inside;
        }
    }
    best
}

/// How far along a segment's direction the nearest point to `to` is, in 0..=1.
fn share(to: DVec3, along: DVec3) -> f64 {
    let squared = along.length_squared();
    if squared > 0.0 {
        (to.dot(along) / squared).clamp(0.0, 1.0)
    } else {
        0.0
    }
}

/// From a face to a point that lies above it.
fn above(face: &[DVec3], point: DVec3) -> Option<DVec3> {
    let corner = |k: usize| face[k % face.len()];
    let area: DVec3 = (1..face.len())
        .map(|k| (corner(k) - corner(0)).cross(corner(k + 1) - corner(0)))
        .sum();
    let normal = area.normalize();
    let height = normal.dot(point - corner(0));
    let inside = |k: usize| {
        let side = (corner(k + 1) - corner(k)).cross(normal);
        side.dot(point - corner(k)) <= 0.0
    };
    (height > 0.0 && (0..face.len()).all(inside)).then_some(normal * height)
}

/// Least overlap of the cores over all axes, and the axis; nothing overlaps without a solid.
fn depth(a: &Body, b: &Body) -> (f64, DVec3) {
    let mut axes: Vec<DVec3> = Vec::new();
    for body in [a, b] {
        for face in body.faces() {
            axes.push((face[1] - face[0]).cross(face[2] - face[0]));
        }
    }
    let edges_b = b.edges();
    for [p0, p1] in a.edges() {
        axes.extend(edges_b.iter().map(|[q0, q1]| (p1 - p0).cross(*q1 - *q0)));
    }
    let mut best = (f64::MAX, DVec3::Y);
    for axis in axes.iter().filter_map(|axis| axis.try_normalize()) {
        for normal in [axis, -axis] {
            let depth = overlap(&a.points, &b.points, normal);
            if depth < best.0 {
                best = (depth, normal);
            }
        }
    }
    if best.0 == f64::MAX {
        (0.0, DVec3::Y)
    } else {
        best
    }
}
