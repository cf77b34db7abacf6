//! Hulls of known shape and where they lie, for tests of geometry.
#![allow(
    dead_code,
    unreachable_pub,
    reason = "every test file uses a part of it"
)]

use glam::{DQuat, DVec3, Quat, Vec3};
use palpable::geometry::convex::{Convex, Edge, Face, Lane};
use palpable::geometry::hull::HullBuilder;
use palpable::math::Pose;

/// A convex piece that owns its parts.
pub struct Hull {
    pub points: Vec<Vec3>,
    pub faces: Vec<Face>,
    pub edges: Vec<Edge>,
    pub loops: Vec<u16>,
    pub radius: f32,
    lanes: Vec<Lane>,
    centre: Vec3,
    half_extents: Vec3,
    is_box: bool,
}

impl Hull {
    pub fn new(points: &[Vec3], radius: f32) -> Self {
        let mut builder = Box::new(HullBuilder::new());
        let view = match *points {
            [centre] => builder.sphere(centre),
            [start, end] => builder.capsule(start, end),
            _ => {
                let points: Vec<[f32; 3]> = points.iter().map(Vec3::to_array).collect();
                builder.build(&points)
            }
        };
        let piece = view.expect("points with volume").convex(radius);
        Self {
            points: (0..piece.vertex_count)
                .map(|index| piece.vertex(index))
                .collect(),
            faces: piece.faces.to_vec(),
            edges: piece.edges.to_vec(),
            loops: piece.loops.to_vec(),
            radius,
            lanes: piece.lanes.to_vec(),
            centre: piece.centre,
            half_extents: piece.half_extents,
            is_box: piece.is_box,
        }
    }

    pub fn view(&self) -> Convex<'_> {
        Convex {
            lanes: &self.lanes,
            vertex_count: self.points.len(),
            faces: &self.faces,
            edges: &self.edges,
            loops: &self.loops,
            radius: self.radius,
            centre: self.centre,
            half_extents: self.half_extents,
            is_box: self.is_box,
        }
    }

    /// Diagonal of the bounding box.
    pub fn size(&self) -> f64 {
        2.0 * self.half_extents.as_dvec3().length()
    }
}

/// A box with the given half extents about the origin.
pub fn cuboid(half: Vec3) -> Hull {
    let points: Vec<Vec3> = (0..8)
        .map(|i| {
            let sign = |bit: usize| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
            half * Vec3::new(sign(0), sign(1), sign(2))
        })
        .collect();
    Hull::new(&points, 0.0)
}

/// `count` points on an ellipsoid, as a hull.
pub fn blob(random: &mut Random, count: usize, half: Vec3) -> Hull {
    let points: Vec<Vec3> = (0..count)
        .map(|_| (random.unit() * half.as_dvec3()).as_vec3())
        .collect();
    Hull::new(&points, 0.0)
}

/// A generator of repeatable numbers (SplitMix64).
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    pub fn next(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    pub fn unit(&mut self) -> DVec3 {
        loop {
            let v = DVec3::new(
                self.between(-1., 1.),
                self.between(-1., 1.),
                self.between(-1., 1.),
            );
            if v.length() > 0.1 && v.length() < 1.0 {
                return v.normalize();
            }
        }
    }

    pub fn turn(&mut self) -> Quat {
        let angle = self.between(0.0, std::f64::consts::TAU);
        DQuat::from_axis_angle(self.unit(), angle).as_quat()
    }
}

/// The vertices of A in B's frame, in double precision.
pub fn in_b(a: &Hull, pose: &Pose) -> Vec<DVec3> {
    let turn = pose.quat().as_dquat().normalize();
    let at = pose.translation().as_dvec3();
    a.points.iter().map(|v| turn * v.as_dvec3() + at).collect()
}

/// Overlap of two point sets along the unit vector from B into A.
pub fn overlap(a: &[DVec3], b: &[DVec3], normal: DVec3) -> f64 {
    let low = a.iter().map(|&v| normal.dot(v)).fold(f64::MAX, f64::min);
    let high = b.iter().map(|&v| normal.dot(v)).fold(f64::MIN, f64::max);
    high - low
}

/// The depth by brute force: every face normal and every cross product of edges, both ways.
pub fn reference(a: &Hull, b: &Hull, pose: &Pose) -> (f64, DVec3) {
    let (pa, pb) = (in_b(a, pose), in_b(b, &Pose::IDENTITY));
    let mut axes = vec![];
    let mut best = (f64::MAX, DVec3::Y);
    for (hull, p) in [(a, &pa), (b, &pb)] {
        for face in &hull.faces {
            let first = face.first_loop as usize;
            let ring: Vec<usize> = hull.loops[first..first + face.loop_count as usize]
                .iter()
                .map(|&i| i as usize)
                .collect();
            axes.push(area_vector(p, &ring).normalize());
        }
    }
    for ea in &a.edges {
        for eb in &b.edges {
            let d = pa[ea.vertices[1] as usize] - pa[ea.vertices[0] as usize];
            let e = pb[eb.vertices[1] as usize] - pb[eb.vertices[0] as usize];
            let cross = d.cross(e);
            if cross.length() > 1e-9 * d.length() * e.length() {
                axes.push(cross.normalize());
            }
        }
    }
    for axis in axes {
        for normal in [axis, -axis] {
            let depth = overlap(&pa, &pb, normal);
            if depth < best.0 {
                best = (depth, normal);
            }
        }
    }
    best
}

/// Twice the area of a polygon along its normal.
fn area_vector(p: &[DVec3], ring: &[usize]) -> DVec3 {
    let arm = |k: usize| p[ring[k % ring.len()]] - p[ring[0]];
    (0..ring.len()).map(|k| arm(k).cross(arm(k + 1))).sum()
}
