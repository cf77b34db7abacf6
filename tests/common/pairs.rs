//! Pairs of pieces that benches ask about: one for each ordinary class of the accuracy report.
#![allow(dead_code, unreachable_pub, reason = "every bench uses a part of it")]

use glam::{Quat, Vec3};
use palpable::geometry::convex::Convex;
use palpable::geometry::hull::HullBuilder;
use palpable::geometry::separation::{Separation, separation, separation_again};
use palpable::geometry::warm::WarmStart;
use palpable::math::Pose;

use crate::scenes::{blob, rod};

/// Half of what a cube measures, and the radius of a hull, in metres.
const SIZE_M: f32 = 0.05;

/// A rod of 34 mm by 8 mm, cut like a finger's part.
const FINGER_M: [f32; 3] = [0.008, 0.008, 0.034];

/// Two pieces at poses in the world, and where a search at slightly other poses ended. The pieces are
/// never freed.
#[derive(Clone, Copy)]
pub struct Pair {
    pub a: Convex<'static>,
    pub b: Convex<'static>,
    pub poses: [Pose; 2],
    pub warm: WarmStart,
}

/// What two pieces are.
#[derive(Clone, Copy)]
pub enum Class {
    Boxes,
    Hulls12,
    Hulls32,
    Fingers,
    SlabAndFinger,
}

impl Class {
    pub const ALL: [(&'static str, Self); 5] = [
        ("boxes", Self::Boxes),
        ("hulls of 12", Self::Hulls12),
        ("hulls of 32", Self::Hulls32),
        ("fingers", Self::Fingers),
        ("slab and finger", Self::SlabAndFinger),
    ];

    fn pieces(self) -> [Convex<'static>; 2] {
        match self {
            Self::Boxes => [cuboid(Vec3::splat(SIZE_M)); 2],
            Self::Hulls12 => [hull(&blob(12, SIZE_M)); 2],
            Self::Hulls32 => [hull(&blob(32, SIZE_M)); 2],
            Self::Fingers => [hull(&rod(FINGER_M)); 2],
            Self::SlabAndFinger => [
                hull(&rod(FINGER_M)),
                hull(&corners(Vec3::new(0.5, 0.02, 0.4))),
            ],
        }
    }

    /// The pair with so much between its surfaces; where that is negative, they overlap by as much.
    pub fn at_gap(self, gap_m: f32) -> Pair {
        let [a, b] = self.pieces();
        let mut pair = Pair {
            a,
            b,
            poses: far(),
            warm: WarmStart::new(),
        };
        for _ in 0..8 {
            let found = pair.ask();
            pair.poses[0] = pair.poses[0].moved(found.normal * (gap_m - found.gap_m));
        }
        let found = pair.ask();
        assert!((found.gap_m - gap_m).abs() < 1e-5, "{found:?}");
        pair.remember_nearby();
        pair
    }
}

impl Pair {
    pub fn ask(&self) -> Separation {
        separation(&self.a, &self.b, &self.poses[0], &self.poses[1], Vec3::ZERO)
    }

    /// Starts where the search ended when A was 1 mm and 5 mrad from here.
    pub fn ask_again(&self) -> Separation {
        let mut warm = self.warm;
        let [pose_a, pose_b] = &self.poses;
        separation_again(&self.a, &self.b, pose_a, pose_b, &mut warm)
    }

    fn remember_nearby(&mut self) {
        let turn = Quat::from_rotation_y(0.005);
        let here = &self.poses[0];
        let beside = here.translation() + Vec3::new(6e-4, -5e-4, 6e-4);
        let pose = Pose::new((turn * here.quat()).normalize(), beside);
        let _ = separation_again(&self.a, &self.b, &pose, &self.poses[1], &mut self.warm);
    }
}

/// Poses far apart, turned so that nothing is parallel.
fn far() -> [Pose; 2] {
    let a = Pose {
        rotation: [0.36, 0.48, 0.0, 0.8],
        position: [0.06, 0.14, 0.1],
    };
    [a, Pose::at(0.01, 0.02, 0.03)]
}

fn cuboid(half: Vec3) -> Convex<'static> {
    let builder = Box::leak(Box::new(HullBuilder::new()));
    builder.cuboid(half).unwrap().convex(0.0)
}

fn hull(points: &[[f32; 3]]) -> Convex<'static> {
    let builder = Box::leak(Box::new(HullBuilder::new()));
    builder.build(points).unwrap().convex(0.0)
}

fn corners(half: Vec3) -> Vec<[f32; 3]> {
    let sign = |index: usize, bit: usize| if index >> bit & 1 == 1 { 1.0 } else { -1.0 };
    let corner = |i| (half * Vec3::new(sign(i, 0), sign(i, 1), sign(i, 2))).to_array();
    (0..8).map(corner).collect()
}

/// How far apart the separated pairs are, and how deep the overlapping ones, in metres.
pub const APART_M: f32 = 0.02;
pub const SHALLOW_M: f32 = -0.002;
