//! Distance of cores: certificates, and boxes against a search that knows nothing of boxes.

use glam::{DQuat, DVec3, Vec3};
use palpable::geometry::convex::Convex;
use palpable::geometry::distance::{Distance, distance};
use palpable::geometry::hull::HullBuilder;
use palpable::math::Pose;

/// Calls `use_piece` with the hull of some points.
fn with_hull<T>(points: &[[f32; 3]], use_piece: impl FnOnce(&Convex) -> T) -> T {
    let mut builder = Box::new(HullBuilder::new());
    let view = builder.build(points).expect("points with volume");
    use_piece(&view.convex(0.0))
}

/// The corners of a box about `centre`, and with `nose` one vertex more that leaves the shape as it
/// is to 1e-6 of its size: a solid that is no box to the kernel.
fn corners(centre: Vec3, half: Vec3, nose: bool) -> Vec<[f32; 3]> {
    let sign = |i: usize, bit: usize| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
    let corner = |i| centre + half * Vec3::new(sign(i, 0), sign(i, 1), sign(i, 2));
    let mut points: Vec<[f32; 3]> = (0..8).map(|i| corner(i).to_array()).collect();
    if nose {
        points.push((centre + Vec3::new(half.x * (1.0 + 2e-5), 0.0, 0.0)).to_array());
    }
    points
}

fn check(a: &Convex, b: &Convex, pose: &Pose, found: &Distance) {
    let size = f64::from(a.size().max(b.size()));
    let turn = pose.quat().as_dquat().normalize();
    let at = pose.translation().as_dvec3();
    let normal = found.normal.as_dvec3().normalize();
    let low = (0..a.vertex_count)
        .map(|i| normal.dot(turn * a.vertex(i).as_dvec3() + at))
        .fold(f64::MAX, f64::min);
    let high = (0..b.vertex_count)
        .map(|i| normal.dot(b.vertex(i).as_dvec3()))
        .fold(f64::MIN, f64::max);
    assert!((low - high - f64::from(found.lower_m)).abs() < 4e-7 * size);
    if found.lower_m > 0.0 {
        let apart = (found.point_a - found.point_b).as_dvec3().length();
        assert!((apart - f64::from(found.upper_m)).abs() < 4e-7 * size);
        assert!(found.upper_m - found.lower_m <= 2e-6 * (found.upper_m + size as f32));
    }
}

#[test]
fn boxes_are_as_far_apart_as_other_solids() {
    let mut seed = 5_u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 33) as f64 / (1_u64 << 30) as f64 - 1.0
    };
    let (mut apart, mut overlapping) = (0, 0);
    for _ in 0..400 {
        let mut part = || 0.55 + 0.45 * random() as f32;
        let (half_a, half_b) = (
            Vec3::new(part(), part(), part()),
            Vec3::new(part(), part(), part()),
        );
        let axis = DVec3::new(random(), random(), random() + 0.01).normalize();
        let turn = DQuat::from_axis_angle(axis, 3.0 * random()).as_quat();
        let at = 2.5 * DVec3::new(random(), random(), random());
        let centre = Vec3::new(0.3, -0.2, 0.1);
        let pose = Pose::new(turn, at.as_vec3() - turn * centre);
        let seed = at.as_vec3();
        let of_boxes = with_hull(&corners(centre, half_a, false), |a| {
            with_hull(&corners(Vec3::ZERO, half_b, false), |b| {
                let found = distance(a, b, &pose, seed);
                check(a, b, &pose, &found);
                found
            })
        });
        let of_solids = with_hull(&corners(centre, half_a, true), |a| {
            with_hull(&corners(Vec3::ZERO, half_b, true), |b| {
                distance(a, b, &pose, seed)
            })
        });
        if of_boxes.lower_m > 1e-3 {
            apart += 1;
            assert!((of_boxes.lower_m - of_solids.lower_m).abs() < 1e-4);
        } else if of_boxes.lower_m < -1e-3 {
            overlapping += 1;
            assert!(of_solids.lower_m <= 1e-4);
        }
    }
    assert!(apart > 100 && overlapping > 20, "{apart} {overlapping}");
}
