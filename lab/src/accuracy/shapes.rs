//! Point sets of the pieces that pairs are made of. Lengths are in metres.

use std::f64::consts::{FRAC_PI_4, TAU};

use glam::{DQuat, DVec3};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

/// A sharp convex piece: the hull of its points, and whether it is a box about its origin.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// Points whose hull is meant, in metres; duplicates and points inside the hull are allowed.
    pub points: Vec<[f32; 3]>,
    /// Half extents in metres when the piece is a box about its origin.
    pub half_extents: Option<[f32; 3]>,
}

impl Shape {
    /// The hull of `points` in metres, rounded to f32.
    pub(super) fn hull(points: &[DVec3]) -> Self {
        Self {
            points: points.iter().map(|p| p.as_vec3().to_array()).collect(),
            half_extents: None,
        }
    }

    /// A box about the origin by its half extents in metres.
    pub(super) fn cuboid(half_extents: DVec3) -> Self {
        let half = half_extents.as_vec3().to_array();
        let corner = |index: usize| {
            [0, 1, 2].map(|axis| {
                if index >> axis & 1 == 1 {
                    half[axis]
                } else {
                    -half[axis]
                }
            })
        };
        Self {
            points: (0..8).map(corner).collect(),
            half_extents: Some(half),
        }
    }
}

/// A number whose logarithm is uniform in `[from, to)`.
pub(super) fn log_uniform(random: &mut Pcg64Mcg, from: f64, to: f64) -> f64 {
    random.random_range(from.ln()..to.ln()).exp()
}

/// A direction uniform on the sphere.
pub(super) fn direction(random: &mut Pcg64Mcg) -> DVec3 {
    let height: f64 = random.random_range(-1.0..1.0);
    let turn = random.random_range(0.0..TAU);
    let ring = (1.0 - height * height).sqrt();
    DVec3::new(ring * turn.cos(), ring * turn.sin(), height)
}

/// An orientation uniform over all.
pub(super) fn orientation(random: &mut Pcg64Mcg) -> DQuat {
    let to = direction(random);
    let turn = random.random_range(0.0..TAU);
    DQuat::from_axis_angle(to, turn) * DQuat::from_rotation_arc(DVec3::Z, to)
}

/// A box with sides of 20 mm to 300 mm.
pub(super) fn random_box(random: &mut Pcg64Mcg) -> Shape {
    let mut half = || log_uniform(random, 0.01, 0.15);
    Shape::cuboid(DVec3::new(half(), half(), half()))
}

/// `count` points on an ellipsoid with semi-axes `size_m` times 1 down to one tenth: all corners.
pub(super) fn random_hull(random: &mut Pcg64Mcg, count: usize, size_m: f64) -> Shape {
    let axes = DVec3::new(
        1.0,
        1.0 / log_uniform(random, 1.0, 10.0),
        1.0 / log_uniform(random, 1.0, 10.0),
    );
    ellipsoid_hull(random, count, axes * size_m)
}

/// A hull of 12 points that is a thousand times longer than thick.
pub(super) fn sliver(random: &mut Pcg64Mcg) -> Shape {
    let width = 1.0 / log_uniform(random, 1.0, 1000.0);
    let size_m = log_uniform(random, 0.03, 0.3);
    ellipsoid_hull(random, 12, DVec3::new(1.0, width, 1e-3) * size_m)
}

fn ellipsoid_hull(random: &mut Pcg64Mcg, count: usize, semi_axes: DVec3) -> Shape {
    let points: Vec<DVec3> = (0..count).map(|_| direction(random) * semi_axes).collect();
    Shape::hull(&points)
}

/// A capsule ten times longer than thick as a hull: four rings of eight points and both poles.
pub(super) fn finger(random: &mut Pcg64Mcg) -> Shape {
    let length_m = random.random_range(0.05..0.1);
    let radius = 0.05 * length_m;
    let straight = 0.5 * length_m - radius;
    let bend = radius * FRAC_PI_4.sin();
    let mut points = vec![
        DVec3::new(0.0, 0.0, 0.5 * length_m),
        DVec3::new(0.0, 0.0, -0.5 * length_m),
    ];
    for (ring, height) in [
        (bend, straight + bend),
        (radius, straight),
        (radius, -straight),
        (bend, -straight - bend),
    ] {
        points.extend((0..8).map(|slice| {
            let turn = TAU * f64::from(slice) / 8.0;
            DVec3::new(ring * turn.cos(), ring * turn.sin(), height)
        }));
    }
    Shape::hull(&points)
}

/// A table's slab, 0.8 m to 1.6 m long and 20 mm to 50 mm thick.
pub(super) fn slab(random: &mut Pcg64Mcg) -> Shape {
    Shape::cuboid(DVec3::new(
        random.random_range(0.4..0.8),
        random.random_range(0.3..0.5),
        random.random_range(0.01..0.025),
    ))
}

/// A right prism over a regular polygon of 3 to 8 corners.
pub(super) fn prism(random: &mut Pcg64Mcg) -> Shape {
    let corners = random.random_range(3..=8);
    let radius = log_uniform(random, 0.02, 0.15);
    let half_height = log_uniform(random, 0.01, 0.15);
    let mut points = Vec::new();
    for slice in 0..corners {
        let turn = TAU * f64::from(slice) / f64::from(corners);
        let (x, y) = (radius * turn.cos(), radius * turn.sin());
        points.push(DVec3::new(x, y, half_height));
        points.push(DVec3::new(x, y, -half_height));
    }
    Shape::hull(&points)
}

/// A hull of 12 points with every point twice, some of them one bit off, and midpoints of pairs.
pub(super) fn with_duplicates(random: &mut Pcg64Mcg) -> Shape {
    let size_m = log_uniform(random, 0.03, 0.3);
    let mut shape = random_hull(random, 12, size_m);
    let corners = shape.points.clone();
    for (index, corner) in corners.iter().enumerate() {
        let off_by_a_bit = random.random_range(0..2) == 1;
        shape.points.push(corner.map(|x| {
            if off_by_a_bit {
                f32::from_bits(x.to_bits() + 1)
            } else {
                x
            }
        }));
        let next = corners[(index + 1) % corners.len()];
        shape
            .points
            .push([0, 1, 2].map(|axis| 0.5 * (corner[axis] + next[axis])));
    }
    shape
}
