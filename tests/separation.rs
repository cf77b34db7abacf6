//! Separation of pieces at poses: what the search starts from changes nothing, and both answers
//! stand against an f64 reference.

#[path = "common/shapes.rs"]
mod shapes;

use glam::Vec3;
use palpable::geometry::separation::{Separation, separation};
use palpable::math::Pose;
use shapes::{Hull, Random, blob, cuboid, overlap};

/// A pair at poses in the world: hulls of many shapes, shallow to deep to apart.
struct Pair {
    a: Hull,
    b: Hull,
    poses: [Pose; 2],
}

impl Pair {
    fn random(random: &mut Random) -> Self {
        let half = |random: &mut Random| {
            let part = |random: &mut Random| random.between(0.1, 1.0) as f32;
            Vec3::new(part(random), part(random), part(random))
        };
        let counts = [(5, 30), (12, 12), (32, 32), (8, 100)][(random.bits() % 4) as usize];
        let scale = [0.01, 0.3, 20.0][(random.bits() % 3) as usize];
        let half_a = half(random) * scale;
        let a = if random.bits() % 4 == 0 {
            cuboid(half_a)
        } else {
            blob(random, counts.0, half_a)
        };
        let half_b = half(random) * scale;
        let b = blob(random, counts.1, half_b);
        let far = random.between(0.0, 2.0) * f64::from(scale);
        let place = (random.unit() * 50.0).as_vec3();
        let offset = (random.unit() * far).as_vec3();
        let poses = [
            Pose::new(random.turn(), place + offset),
            Pose::new(random.turn(), place),
        ];
        Self { a, b, poses }
    }

    fn ask(&self, seed: Vec3) -> Separation {
        separation(
            &self.a.view(),
            &self.b.view(),
            &self.poses[0],
            &self.poses[1],
            seed,
        )
    }

    fn size(&self) -> f64 {
        self.a.size().min(self.b.size())
    }
}

#[test]
fn seeds_change_neither_gap_nor_normal() {
    let mut random = Random(13);
    let (mut apart, mut overlapping) = (0, 0);
    for _ in 0..400 {
        let pair = Pair::random(&mut random);
        let cold = pair.ask(Vec3::ZERO);
        if cold.gap_m > 0.0 {
            apart += 1;
        } else {
            overlapping += 1;
        }
        let beside = cold.normal + 0.01 * random.unit().as_vec3();
        let any = random.unit().as_vec3();
        for seed in [Vec3::NAN, cold.normal, beside, -beside, any] {
            let seeded = pair.ask(seed);
            assert_eq!(seeded.gap_m.to_bits(), cold.gap_m.to_bits(), "{seed}");
            assert_eq!(seeded.normal, cold.normal, "{seed}");
        }
    }
    assert!(apart > 50 && overlapping > 50, "{apart} {overlapping}");
}

#[test]
fn gaps_are_those_along_the_normal_and_points_lie_that_far_apart() {
    let mut random = Random(14);
    for _ in 0..400 {
        let pair = Pair::random(&mut random);
        let found = pair.ask(Vec3::ZERO);
        let points = [0, 1].map(|i| {
            let hull = [&pair.a, &pair.b][i];
            let turn = pair.poses[i].quat().as_dquat().normalize();
            let at = (pair.poses[i].translation() - pair.poses[1].translation()).as_dvec3();
            let of = |p: &Vec3| turn * p.as_dvec3() + at;
            hull.points.iter().map(of).collect::<Vec<_>>()
        });
        let normal = found.normal.as_dvec3();
        let gap = -overlap(&points[0], &points[1], normal);
        // A normal in f32 is off by 1e-7, which counts as far as the pieces lie beside each other.
        let allowed = 1e-6 * pair.size();
        assert!((gap - f64::from(found.gap_m)).abs() < allowed, "{found:?}");
        // World coordinates 50 m out are rounded to 4e-6 m.
        let between = (found.point_a - found.point_b).as_dvec3();
        let wanted = normal * f64::from(found.gap_m);
        assert!((between - wanted).length() < allowed + 2e-5, "{found:?}");
    }
}
