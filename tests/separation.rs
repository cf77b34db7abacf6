//! Separation of pieces at poses: what the search starts from changes nothing, and both answers
//! stand against an f64 reference.

#[path = "common/shapes.rs"]
mod shapes;

use glam::{Quat, Vec3};
use palpable::geometry::separation::{Separation, separation, separation_again, separation_from};
use palpable::geometry::warm::{WarmFeature, WarmStart};
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
        let a = if random.bits().is_multiple_of(4) {
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

    fn ask_again(&self, warm: &mut WarmStart) -> Separation {
        let [a, b] = [self.a.view(), self.b.view()];
        separation_again(&a, &b, &self.poses[0], &self.poses[1], warm)
    }

    fn ask_from(&self, feature: &mut WarmFeature) -> Separation {
        let [a, b] = [self.a.view(), self.b.view()];
        separation_from(&a, &b, &self.poses[0], &self.poses[1], feature, 0.0)
    }

    /// Moves A toward where it touches, by a hundredth of its size about that, and turns it by 5 mrad.
    fn tremble(&mut self, found: &Separation, random: &mut Random) {
        let nearer = (found.normal * (-0.2 * found.gap_m)).as_dvec3();
        let step = nearer + random.unit() * random.between(0.0, 0.01 * self.size());
        let turn = Quat::from_axis_angle(random.unit().as_vec3(), 0.005);
        let pose = &self.poses[0];
        let rotation = (turn * pose.quat()).normalize();
        self.poses[0] = Pose::new(rotation, pose.translation() + step.as_vec3());
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

fn assert_same(found: &Separation, cold: &Separation) {
    assert_eq!(found.gap_m.to_bits(), cold.gap_m.to_bits());
    assert_eq!(found.normal, cold.normal);
}

#[test]
fn warm_starts_change_neither_gap_nor_normal() {
    let mut random = Random(15);
    let mut changes = 0;
    // Those of the pair before are left over: they fit nothing.
    let (mut warm, mut feature) = (WarmStart::new(), WarmFeature::new());
    for _ in 0..150 {
        let mut pair = Pair::random(&mut random);
        let mut last = pair.ask(Vec3::ZERO).gap_m;
        for _ in 0..40 {
            let cold = pair.ask(Vec3::ZERO);
            assert_same(&pair.ask_again(&mut warm), &cold);
            assert_same(&pair.ask_from(&mut feature), &cold);
            changes += u32::from(last * cold.gap_m < 0.0);
            last = cold.gap_m;
            pair.tremble(&cold, &mut random);
        }
    }
    assert!(
        changes > 300,
        "{changes} changes between apart and overlapping"
    );
}
