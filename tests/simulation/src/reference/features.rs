//! The distance of cores that are apart, by all pairs of features: slow and without iteration.

use super::near;
use super::relative::Relative;
use glam::DVec3;

/// The nearest points of the two cores in the frame of `a`. The cores must not overlap.
pub(super) fn nearest(pair: &Relative) -> [DVec3; 2] {
    let mut best = Nearest {
        distance: f64::INFINITY,
        points: [DVec3::ZERO; 2],
    };
    let a = Features::of(pair.a.vertices(), pair.a.triangles(), pair.a.edges());
    let vertices: Vec<DVec3> = pair.b.vertices().iter().map(|&v| pair.carry(v)).collect();
    let edges: Vec<_> = pair.b.edges().to_vec();
    let mut b = Features::of(&vertices, pair.b.triangles(), &edges);
    b.edges
        .iter_mut()
        .flatten()
        .for_each(|end| *end = pair.carry(*end));
    best.vertices(&a, &b);
    best.against(&a, &b, |on_a, on_b| [on_a, on_b]);
    best.against(&b, &a, |on_b, on_a| [on_a, on_b]);
    best.edges(&a, &b);
    best.points
}

struct Features<'a> {
    vertices: &'a [DVec3],
    triangles: Vec<[DVec3; 3]>,
    edges: Vec<[DVec3; 2]>,
}

impl<'a> Features<'a> {
    fn of(vertices: &'a [DVec3], triangles: &[[usize; 3]], edges: &[super::Edge]) -> Self {
        Self {
            vertices,
            triangles: triangles.iter().map(|t| t.map(|i| vertices[i])).collect(),
            edges: edges.iter().map(|e| e.ends).collect(),
        }
    }
}

struct Nearest {
    distance: f64,
    points: [DVec3; 2],
}

impl Nearest {
    fn offer(&mut self, points: [DVec3; 2]) {
        let distance = (points[0] - points[1]).length();
        if distance < self.distance {
            *self = Self { distance, points };
        }
    }

    fn vertices(&mut self, a: &Features, b: &Features) {
        for &p in a.vertices {
            for &q in b.vertices {
                self.offer([p, q]);
            }
        }
    }

    fn against(&mut self, a: &Features, b: &Features, order: impl Fn(DVec3, DVec3) -> [DVec3; 2]) {
        for &p in a.vertices {
            for &[x, y, z] in &b.triangles {
                let w = near::triangle(x - p, y - p, z - p);
                self.offer(order(p, x * w[0] + y * w[1] + z * w[2]));
            }
            for &[x, y] in &b.edges {
                let w = near::segment(x - p, y - p);
                self.offer(order(p, x * w[0] + y * w[1]));
            }
        }
    }

    fn edges(&mut self, a: &Features, b: &Features) {
        for &e in &a.edges {
            for &f in &b.edges {
                if let Some(points) = between_lines(e, f) {
                    self.offer(points);
                }
            }
        }
    }
}

/// The nearest points of two segments if they lie inside both; ends are the other tests' concern.
pub(super) fn between_lines(e: [DVec3; 2], f: [DVec3; 2]) -> Option<[DVec3; 2]> {
    let (u, v, w) = (e[1] - e[0], f[1] - f[0], f[0] - e[0]);
    let along = u.normalize_or_zero();
    let across = near::square_part(along, v.normalize_or_zero())?;
    let t = -w.dot(across) / v.dot(across);
    let s = (w + v * t).dot(along) / u.length();
    let inside = (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t);
    inside.then(|| [e[0] + u * s, f[0] + v * t])
}
