//! Seeded pairs of pieces: ordinary classes and hard ones.
//!
//! Each pair is made so that two features (faces, edges or vertices) meet along a common normal
//! with a wanted gap. For a pair apart that gap is the distance; an overlap of that depth along the
//! normal is at least the penetration depth. Poses are rounded to f32 afterwards, so the wanted gap
//! is only a wish: the reference says what came of it.

use glam::{DQuat, DVec3};
use palpable::math::Pose;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::Serialize;

use super::shapes::{
    Shape, direction, finger, log_uniform, orientation, prism, random_box, random_hull, slab,
    sliver, with_duplicates,
};
use crate::gallery::ball_points;
use crate::reference::Solid;

/// A kind of pieces and of how they lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Class {
    /// Two boxes of 20 mm to 300 mm a side.
    Box8,
    /// Two hulls of 12 vertices, aspect ratios to 10:1.
    Hull12,
    /// Two hulls of 32 vertices, aspect ratios to 10:1.
    Hull32,
    /// Two capsule hulls of 34 vertices, 10:1.
    Finger,
    /// A table's slab and a finger.
    SlabFinger,
    /// The paper's ball of 482 vertices and a hull of 32.
    BallHull32,
    /// Prisms and boxes, face against face.
    ParallelFaces,
    /// Edges against edges that are parallel up to 1e-8 to 1e-5 rad.
    ParallelEdges,
    /// A hull and its copy at the same pose or one very near.
    Coincident,
    /// Hulls a thousand times longer than thick.
    Sliver,
    /// Hulls of 12 and 32 vertices, 1 mm long.
    Millimetre,
    /// Hulls of 12 and 32 vertices, 100 m long.
    HundredMetres,
    /// Boxes, hulls and fingers 100 m from the origin.
    Far100,
    /// Boxes, hulls and fingers 1 km from the origin.
    Far1000,
    /// Hulls of 12 with repeated vertices and vertices on edges.
    Duplicates,
}

impl Class {
    /// All classes, the ordinary ones first.
    pub const ALL: [Self; 15] = [
        Self::Box8,
        Self::Hull12,
        Self::Hull32,
        Self::Finger,
        Self::SlabFinger,
        Self::BallHull32,
        Self::ParallelFaces,
        Self::ParallelEdges,
        Self::Coincident,
        Self::Sliver,
        Self::Millimetre,
        Self::HundredMetres,
        Self::Far100,
        Self::Far1000,
        Self::Duplicates,
    ];

    /// The class's name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Box8 => "box 8",
            Self::Hull12 => "hull 12",
            Self::Hull32 => "hull 32",
            Self::Finger => "finger 34",
            Self::SlabFinger => "slab - finger",
            Self::BallHull32 => "ball 482 - hull 32",
            Self::ParallelFaces => "parallel faces",
            Self::ParallelEdges => "parallel edges",
            Self::Coincident => "coincident",
            Self::Sliver => "sliver 1:1000",
            Self::Millimetre => "millimetre hulls",
            Self::HundredMetres => "hulls of 100 m",
            Self::Far100 => "100 m away",
            Self::Far1000 => "1 km away",
            Self::Duplicates => "duplicate vertices",
        }
    }

    fn shapes(self, random: &mut Pcg64Mcg) -> [Shape; 2] {
        let pieces = |random: &mut Pcg64Mcg, make: &dyn Fn(&mut Pcg64Mcg) -> Shape| {
            [make(random), make(random)]
        };
        match self {
            Self::Box8 => pieces(random, &random_box),
            Self::Hull12 | Self::Coincident => pieces(random, &|r| sized_hull(r, 12, 1.0)),
            Self::Hull32 => pieces(random, &|r| sized_hull(r, 32, 1.0)),
            Self::Finger => pieces(random, &finger),
            Self::SlabFinger => [slab(random), finger(random)],
            Self::BallHull32 => [ball(), sized_hull(random, 32, 1.0)],
            Self::ParallelFaces | Self::ParallelEdges => pieces(random, &box_or_prism),
            Self::Sliver => pieces(random, &sliver),
            Self::Millimetre => pieces(random, &|r| hull_12_or_32(r, 0.0005)),
            Self::HundredMetres => pieces(random, &|r| hull_12_or_32(r, 50.0)),
            Self::Far100 | Self::Far1000 => pieces(random, &any_shape),
            Self::Duplicates => pieces(random, &with_duplicates),
        }
    }

    /// Distance of the pair from the origin, in metres.
    fn away_m(self) -> f64 {
        match self {
            Self::Far100 => 100.0,
            Self::Far1000 => 1000.0,
            Self::HundredMetres => 10.0,
            _ => 0.5,
        }
    }
}

fn ball() -> Shape {
    Shape {
        points: ball_points(),
        half_extents: None,
    }
}

/// A hull of 30 mm to 300 mm times `scale`.
fn sized_hull(random: &mut Pcg64Mcg, count: usize, scale: f64) -> Shape {
    let size_m = scale * log_uniform(random, 0.03, 0.3);
    random_hull(random, count, size_m)
}

fn hull_12_or_32(random: &mut Pcg64Mcg, semi_axis_m: f64) -> Shape {
    let count = if random.random_range(0..2) == 0 {
        12
    } else {
        32
    };
    random_hull(random, count, semi_axis_m)
}

fn box_or_prism(random: &mut Pcg64Mcg) -> Shape {
    if random.random_range(0..2) == 0 {
        random_box(random)
    } else {
        prism(random)
    }
}

fn any_shape(random: &mut Pcg64Mcg) -> Shape {
    match random.random_range(0..4) {
        0 => random_box(random),
        1 => sized_hull(random, 12, 1.0),
        2 => sized_hull(random, 32, 1.0),
        _ => finger(random),
    }
}

/// What was wished for; rounding may make something else of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Overlap of 1e-4 to 5e-2 of the smaller piece's size.
    Shallow,
    /// Overlap of a tenth to nine tenths of the thinner piece.
    Deep,
    /// A gap or an overlap of at most 1e-6 of size.
    Touching,
    /// A gap of 1e-3 to 0.3 of size.
    Near,
}

const KINDS: [Kind; 4] = [Kind::Shallow, Kind::Deep, Kind::Touching, Kind::Near];

/// Two pieces at two pairs of poses, the second for warm measurements.
#[derive(Clone, Debug, PartialEq)]
pub struct Pair {
    /// The class.
    pub class: Class,
    /// The pair's number in its class; with the seed it replays the pair.
    pub index: u32,
    /// What was wished for.
    pub kind: Kind,
    /// The pieces A and B.
    pub shapes: [Shape; 2],
    /// Poses of A and B, first and then a little later.
    pub poses: [[Pose; 2]; 2],
}

/// The reference's solids of a pair.
///
/// # Panics
/// If the points are not finite; generated ones are.
pub fn solids(shapes: &[Shape; 2]) -> [Solid; 2] {
    shapes
        .each_ref()
        .map(|shape| Solid::from_f32(&shape.points, 0.0).expect("generated points are finite"))
}

/// Largest move of the second pose, in metres; also at most 1 % of size.
const MOVE_M_MAX: f64 = 1e-3;
/// Turn of the second pose, in radians.
const TURN_RAD: f64 = 5e-3;

/// Pair number `index` of a class: equal arguments give equal bits.
pub fn pair(class: Class, seed: u64, index: u32) -> Pair {
    let stream = seed
        .wrapping_mul(0x9E37_79B9_7F4A_7C15)
        .wrapping_add(u64::from(index) << 8)
        .wrapping_add(class as u64);
    let random = &mut Pcg64Mcg::seed_from_u64(stream);
    let kind = KINDS[index as usize % KINDS.len()];
    let mut shapes = class.shapes(random);
    if class == Class::Coincident {
        shapes[1] = shapes[0].clone();
    }
    let solids = solids(&shapes);
    let size_m = solids[0].size().min(solids[1].size());
    let first = if class == Class::Coincident {
        coincident(random, size_m)
    } else {
        meeting(random, class, kind, &solids)
    };
    let first = carried_away(random, class, first);
    let second = [moved(random, first[0], size_m), first[1]];
    Pair {
        class,
        index,
        kind,
        shapes,
        poses: [first, second].map(|poses| poses.map(rounded)),
    }
}

/// Rotation and position in f64, before rounding.
type Exact = (DQuat, DVec3);

fn rounded((rotation, position): Exact) -> Pose {
    Pose::new(rotation.as_quat(), position.as_vec3())
}

fn moved(random: &mut Pcg64Mcg, (rotation, position): Exact, size_m: f64) -> Exact {
    let turn = DQuat::from_axis_angle(direction(random), TURN_RAD);
    let step = direction(random) * MOVE_M_MAX.min(0.01 * size_m);
    ((turn * rotation).normalize(), position + step)
}

fn carried_away(random: &mut Pcg64Mcg, class: Class, poses: [Exact; 2]) -> [Exact; 2] {
    let away = direction(random) * class.away_m();
    poses.map(|(rotation, position)| (rotation, position + away))
}

/// Two copies at one place, or apart by 1e-8 to 1e-3 of size, or turned by as many radians.
fn coincident(random: &mut Pcg64Mcg, size_m: f64) -> [Exact; 2] {
    let rotation = orientation(random);
    let off = log_uniform(random, 1e-8, 1e-3);
    let a = match random.random_range(0..3) {
        0 => (rotation, DVec3::ZERO),
        1 => (rotation, direction(random) * off * size_m),
        _ => {
            let turn = DQuat::from_axis_angle(direction(random), off);
            ((turn * rotation).normalize(), DVec3::ZERO)
        }
    };
    [a, (rotation, DVec3::ZERO)]
}

/// A point of a solid's surface, an outward normal there, and a direction across it: the edge's
/// when the point lies on an edge.
#[derive(Clone, Copy, Debug)]
struct Spot {
    point: DVec3,
    normal: DVec3,
    across: DVec3,
}

fn on_vertex(random: &mut Pcg64Mcg, solid: &Solid) -> Spot {
    let normal = direction(random);
    let reach = |p: &&DVec3| normal.dot(**p);
    let farthest = solid
        .vertices()
        .iter()
        .max_by(|p, q| reach(p).total_cmp(&reach(q)));
    Spot {
        point: farthest.copied().unwrap_or_default(),
        normal,
        across: normal.any_orthonormal_vector(),
    }
}

fn on_edge(random: &mut Pcg64Mcg, solid: &Solid) -> Spot {
    let edge = &solid.edges()[random.random_range(0..solid.edges().len())];
    let along: f64 = random.random_range(0.05..0.95);
    let blend: f64 = random.random_range(0.05..0.95);
    Spot {
        point: edge.ends[0].lerp(edge.ends[1], along),
        normal: edge.normals[0].lerp(edge.normals[1], blend).normalize(),
        across: edge.direction,
    }
}

fn on_face(random: &mut Pcg64Mcg, solid: &Solid) -> Spot {
    let triangle = solid.triangles()[random.random_range(0..solid.triangles().len())];
    let [a, b, c] = triangle.map(|vertex| solid.vertices()[vertex]);
    let (mut u, mut v): (f64, f64) = (random.random_range(0.0..1.0), random.random_range(0.0..1.0));
    if u + v > 1.0 {
        (u, v) = (1.0 - u, 1.0 - v);
    }
    Spot {
        point: a + (b - a) * u + (c - a) * v,
        normal: (b - a).cross(c - a).normalize(),
        across: (b - a).normalize(),
    }
}

fn on_anything(random: &mut Pcg64Mcg, solid: &Solid) -> Spot {
    match random.random_range(0..3) {
        0 => on_vertex(random, solid),
        1 => on_edge(random, solid),
        _ => on_face(random, solid),
    }
}

/// Brings two spots together, normal against normal, with a gap of the wanted kind.
fn meeting(random: &mut Pcg64Mcg, class: Class, kind: Kind, solids: &[Solid; 2]) -> [Exact; 2] {
    let [a, b] = match class {
        Class::ParallelFaces => [on_face(random, &solids[0]), on_face(random, &solids[1])],
        Class::ParallelEdges => [on_edge(random, &solids[0]), on_edge(random, &solids[1])],
        _ => [
            on_anything(random, &solids[0]),
            on_anything(random, &solids[1]),
        ],
    };
    let turn = match class {
        Class::ParallelFaces => {
            f64::from(random.random_range(0..2)) * random.random_range(0.0..1.0)
        }
        Class::ParallelEdges => log_uniform(random, 1e-8, 1e-5),
        _ => random.random_range(0.0..std::f64::consts::TAU),
    };
    let rotation_b = orientation(random);
    let normal = rotation_b * b.normal;
    let opposed = frame(-a.normal, a.across);
    let wanted = frame(
        normal,
        DQuat::from_axis_angle(normal, turn) * (rotation_b * b.across),
    );
    let rotation_a = (wanted * opposed.inverse()).normalize();
    let gap_m = wanted_gap_m(random, kind, solids, [a.normal, b.normal]);
    let position_a = rotation_b * b.point + normal * gap_m - rotation_a * a.point;
    [(rotation_a, position_a), (rotation_b, DVec3::ZERO)]
}

/// The rotation that takes z to `normal` and x to `across`, made square to it.
fn frame(normal: DVec3, across: DVec3) -> DQuat {
    let x = across.reject_from_normalized(normal).normalize();
    DQuat::from_mat3(&glam::DMat3::from_cols(x, normal.cross(x), normal))
}

fn wanted_gap_m(
    random: &mut Pcg64Mcg,
    kind: Kind,
    solids: &[Solid; 2],
    normals: [DVec3; 2],
) -> f64 {
    let size_m = solids[0].size().min(solids[1].size());
    match kind {
        Kind::Shallow => -size_m * log_uniform(random, 1e-4, 5e-2),
        Kind::Deep => {
            let [a, b] = [0, 1].map(|i| width_m(&solids[i], normals[i]));
            -a.min(b) * random.random_range(0.1..0.9)
        }
        Kind::Touching => size_m * random.random_range(-1e-6..1e-6),
        Kind::Near => size_m * log_uniform(random, 1e-3, 0.3),
    }
}

fn width_m(solid: &Solid, normal: DVec3) -> f64 {
    let reaches = solid.vertices().iter().map(|p| normal.dot(*p));
    let (low, high) = reaches.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), reach| {
        (low.min(reach), high.max(reach))
    });
    high - low
}
