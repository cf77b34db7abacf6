//! Pairs of pieces that benches ask about.
#![allow(dead_code, unreachable_pub, reason = "every bench uses a part of it")]

use glam::Vec3;
use palpable::geometry::convex::Convex;
use palpable::geometry::distance::distance;
use palpable::geometry::hull::HullBuilder;
use palpable::math::Pose;

use crate::scenes::blob;

/// Half of what a cube measures, and the radius of a hull, in metres.
const SIZE_M: f32 = 0.05;

/// Two pieces, the first at a pose in the frame of the second. They are never freed.
#[derive(Clone, Copy)]
pub struct Pair {
    pub a: Convex<'static>,
    pub b: Convex<'static>,
    pub a_in_b: Pose,
}

impl Pair {
    /// The direction that a host without memory would start with: between the centres.
    #[must_use]
    pub fn seed(&self) -> Vec3 {
        self.a_in_b.translation()
    }

    /// The same pair, the first piece moved along the line between the centres until the cores are
    /// apart by so much, or, where that is negative, overlap by about as much.
    fn at_gap(mut self, gap_m: f32) -> Self {
        for _ in 0..8 {
            let found = distance(&self.a, &self.b, &self.a_in_b, self.seed());
            assert!(found.lower_m > 0.0);
            self.a_in_b = self.a_in_b.moved(found.normal * (1e-4 - found.lower_m));
        }
        let found = distance(&self.a, &self.b, &self.a_in_b, self.seed());
        self.a_in_b = self.a_in_b.moved(found.normal * (gap_m - found.lower_m));
        self
    }
}

/// A pose far out, turned so that nothing is parallel.
fn far() -> Pose {
    Pose {
        rotation: [0.36, 0.48, 0.0, 0.8],
        position: [0.2, 0.15, 0.1],
    }
}

fn boxes() -> Pair {
    let builder = Box::leak(Box::new(HullBuilder::new()));
    let cube = builder.cuboid(Vec3::splat(SIZE_M)).unwrap().convex(0.0);
    Pair {
        a: cube,
        b: cube,
        a_in_b: far(),
    }
}

fn hulls() -> Pair {
    let builder = Box::leak(Box::new(HullBuilder::new()));
    let hull = builder.build(&blob(32, SIZE_M)).unwrap().convex(0.0);
    assert_eq!(hull.vertex_count, 32);
    Pair {
        a: hull,
        b: hull,
        a_in_b: far(),
    }
}

pub fn boxes_apart() -> Pair {
    boxes().at_gap(0.02)
}

pub fn hulls_apart() -> Pair {
    hulls().at_gap(0.02)
}

pub fn boxes_shallow() -> Pair {
    boxes().at_gap(-0.002)
}

pub fn hulls_shallow() -> Pair {
    hulls().at_gap(-0.002)
}
