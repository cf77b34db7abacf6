//! Contacts of pieces whose patches are known.

#[path = "common/shapes.rs"]
mod shapes;

use glam::{Quat, Vec3};
use palpable::geometry::convex::Convex;
use palpable::geometry::distance::distance;
use palpable::geometry::manifold::{Contact, CoreGap, manifold};
use palpable::geometry::penetration::core_penetration;
use palpable::math::Pose;
use shapes::{Hull, Random, blob, cuboid, in_b, overlap};

fn gap(a: &Convex, b: &Convex, pose: &Pose) -> CoreGap {
    CoreGap::from(&core_penetration(a, b, pose))
}

fn contacts(a: &Hull, b: &Hull, pose: &Pose, margin: f32) -> Vec<Contact> {
    let (a, b) = (a.view(), b.view());
    manifold(&a, &b, pose, &gap(&a, &b, pose), margin).to_vec()
}

fn sorted_points(contacts: &[Contact]) -> Vec<Vec3> {
    let mut points: Vec<Vec3> = contacts.iter().map(|c| c.point).collect();
    let key = |p: &Vec3| ((p.x * 1e4).round() as i64, (p.z * 1e4).round() as i64);
    points.sort_by_key(key);
    points
}

fn near(left: &[Vec3], right: &[Vec3], tolerance: f32) {
    assert_eq!(left.len(), right.len(), "{left:?} {right:?}");
    for (l, r) in left.iter().zip(right) {
        assert!((*l - *r).length() <= tolerance, "{left:?} {right:?}");
    }
}

#[test]
fn box_on_a_floor_touches_with_its_four_corners() {
    for scale in [1e-3, 1.0, 100.0] {
        let (small, floor) = (
            cuboid(Vec3::splat(scale)),
            cuboid(Vec3::new(5.0, 1.0, 5.0) * scale),
        );
        for lift in [-0.01, 0.0, 0.01] {
            let pose = Pose::at(0.5 * scale, (2.0 + lift) * scale, -0.25 * scale);
            let found = contacts(&small, &floor, &pose, 0.02 * scale);
            let y = (1.0 + 0.5 * lift) * scale;
            let corner = |x: f32, z: f32| Vec3::new(x * scale, y, z * scale);
            let expected = [
                corner(-0.5, -1.25),
                corner(-0.5, 0.75),
                corner(1.5, -1.25),
                corner(1.5, 0.75),
            ];
            let mut points = found.iter().map(|c| c.point / scale).collect::<Vec<_>>();
            points.sort_by_key(|p| ((p.x * 1e3).round() as i64, (p.z * 1e3).round() as i64));
            near(&points, &expected.map(|p| p / scale), 1e-6);
            for contact in &found {
                assert_eq!(contact.normal, Vec3::Y);
                assert!((contact.gap - lift * scale).abs() <= 1e-6 * scale);
            }
        }
    }
}

#[test]
fn beyond_the_margin_there_is_nothing() {
    let cube = cuboid(Vec3::ONE);
    assert!(contacts(&cube, &cube, &Pose::at(0.0, 2.1, 0.0), 0.05).is_empty());
    assert_eq!(
        contacts(&cube, &cube, &Pose::at(0.0, 2.1, 0.0), 0.15).len(),
        4
    );
}

#[test]
fn overhanging_box_is_clipped_by_the_edge() {
    let cube = cuboid(Vec3::ONE);
    let found = contacts(&cube, &cube, &Pose::at(1.5, 1.99, 0.5), 0.0);
    let y = 0.995;
    let corner = |x: f32, z: f32| Vec3::new(x, y, z);
    let expected = [
        corner(0.5, -0.5),
        corner(0.5, 1.0),
        corner(1.0, -0.5),
        corner(1.0, 1.0),
    ];
    near(&sorted_points(&found), &expected, 1e-6);
}

#[test]
fn turned_box_on_box_keeps_four_of_eight() {
    let cube = cuboid(Vec3::ONE);
    let turn = Quat::from_rotation_y(std::f32::consts::FRAC_PI_4);
    let found = contacts(
        &cube,
        &cube,
        &Pose::new(turn, Vec3::new(0.0, 1.99, 0.0)),
        0.0,
    );
    assert_eq!(found.len(), 4);
    // The patch is a regular octagon of in-radius 1: its best four corners span 2 * sqrt(2) r^2.
    let p = sorted_points(&found);
    let area = (p[3] - p[0]).cross(p[2] - p[1]).length() * 0.5;
    let corner_squared = 1.0 + (std::f32::consts::SQRT_2 - 1.0).powi(2);
    assert!(area > 0.8 * 2.0 * corner_squared, "{area}");
}

#[test]
fn tilted_box_touches_along_an_edge() {
    let (cube, floor) = (cuboid(Vec3::ONE), cuboid(Vec3::new(5.0, 1.0, 5.0)));
    let tilt = 0.3_f32;
    let lowest = tilt.cos() + tilt.sin();
    let pose = Pose::new(
        Quat::from_rotation_z(tilt),
        Vec3::new(0.0, 1.0 + lowest - 0.01, 0.0),
    );
    let found = contacts(&cube, &floor, &pose, 0.005);
    assert_eq!(found.len(), 2, "{found:?}");
    for contact in &found {
        assert!((contact.gap + 0.01).abs() < 1e-6 && (contact.point.z.abs() - 1.0).abs() < 1e-6);
    }
    // With the floor as A the face that the normal belongs to is A's.
    let back = contacts(&floor, &cube, &Pose::IDENTITY.seen_from(&pose), 0.005);
    assert_eq!(back.len(), 2, "{back:?}");
    let returned: Vec<Vec3> = back.iter().map(|c| pose.point(c.point)).collect();
    for contact in &found {
        assert!(
            returned
                .iter()
                .any(|p| (*p - contact.point).length() < 1e-6)
        );
    }
}

#[test]
fn crossing_edges_make_one_contact() {
    let cube = cuboid(Vec3::ONE);
    let eighth = std::f32::consts::FRAC_PI_4;
    let up = Quat::from_rotation_z(-eighth);
    let apart = 2.0 * std::f32::consts::SQRT_2 - 0.05;
    let turn = (up * Quat::from_rotation_x(eighth)).normalize();
    let found = contacts(
        &cube,
        &cube,
        &Pose::new(turn, up * Vec3::new(0.0, apart, 0.0)),
        0.0,
    );
    assert_eq!(found.len(), 1);
    assert!((found[0].gap + 0.05).abs() < 1e-6);
    assert!((found[0].point - up * Vec3::new(0.0, apart / 2.0, 0.0)).length() < 1e-6);
}

#[test]
fn sphere_and_capsule_on_a_floor() {
    let floor = cuboid(Vec3::new(5.0, 1.0, 5.0));
    let sphere = Hull::new(&[Vec3::ZERO], 0.1);
    let core = CoreGap {
        normal: Vec3::Y,
        gap: 0.09,
        point_a: Vec3::new(0.0, 1.09, 0.0),
        point_b: Vec3::Y,
    };
    let pose = Pose::at(0.0, 1.09, 0.0);
    let found = manifold(&sphere.view(), &floor.view(), &pose, &core, 0.0);
    assert_eq!(found.len(), 1);
    assert!((found[0].gap + 0.01).abs() < 1e-6);
    assert!((found[0].point - Vec3::new(0.0, 0.995, 0.0)).length() < 1e-6);
    let capsule = Hull::new(&[Vec3::new(-0.3, 0.0, 0.0), Vec3::new(0.3, 0.0, 0.0)], 0.1);
    for (place, left) in [(0.0, -0.3), (4.9, 4.6)] {
        let pose = Pose::at(place, 1.09, 0.0);
        let found = manifold(&capsule.view(), &floor.view(), &pose, &core, 0.0);
        let right = (place + 0.3_f32).min(5.0);
        let expected = [Vec3::new(left, 0.995, 0.0), Vec3::new(right, 0.995, 0.0)];
        near(&sorted_points(&found), &expected, 2e-6);
    }
}

#[test]
fn parallel_capsules_touch_along_their_overlap() {
    let capsule = Hull::new(&[Vec3::new(-1.0, 0.0, 0.0), Vec3::new(1.0, 0.0, 0.0)], 0.1);
    let turn = Quat::from_rotation_y(std::f32::consts::PI);
    for rotation in [Quat::IDENTITY, turn] {
        let found = contacts(
            &capsule,
            &capsule,
            &Pose::new(rotation, Vec3::new(0.5, 0.19, 0.0)),
            0.0,
        );
        let expected = [Vec3::new(-0.5, 0.095, 0.0), Vec3::new(1.0, 0.095, 0.0)];
        near(&sorted_points(&found), &expected, 1e-6);
        assert!(found.iter().all(|c| (c.gap + 0.01).abs() < 1e-6));
    }
    let across = Quat::from_rotation_y(std::f32::consts::FRAC_PI_2);
    assert_eq!(
        contacts(&capsule, &capsule, &Pose::new(across, Vec3::Y * 0.19), 0.0).len(),
        1
    );
}

#[test]
fn swapping_moves_no_contact() {
    let (a, b) = (
        cuboid(Vec3::new(0.3, 0.2, 0.4)),
        cuboid(Vec3::new(1.0, 0.5, 1.0)),
    );
    let pose = Pose::new(Quat::from_rotation_y(0.4), Vec3::new(0.2, 0.69, 0.1));
    let there = contacts(&a, &b, &pose, 0.01);
    let back = contacts(&b, &a, &Pose::IDENTITY.seen_from(&pose), 0.01);
    let returned: Vec<Contact> = back
        .iter()
        .map(|c| Contact {
            point: pose.point(c.point),
            ..*c
        })
        .collect();
    near(&sorted_points(&there), &sorted_points(&returned), 1e-6);
    assert!(
        back.iter()
            .all(|c| (pose.quat() * c.normal + Vec3::Y).length() < 1e-6)
    );
}

/// Whatever the pair: 1 to 4 contacts, the first the deepest and as deep as the query said, all
/// within the margin, all inside both pieces' supporting planes.
#[test]
fn random_pairs_keep_their_promises() {
    let mut random = Random(21);
    for round in 0..400 {
        let scale = [1e-3, 1.0, 100.0][round % 3];
        let size = Vec3::new(1.0, 0.6, 0.3) * scale;
        let (a, b) = match round % 2 {
            0 => (blob(&mut random, 14, size), cuboid(size)),
            _ => (cuboid(size), blob(&mut random, 9, size)),
        };
        let at = random.unit() * random.between(0.2, 1.2) * f64::from(scale);
        let pose = Pose::new(random.turn(), at.as_vec3());
        let (view_a, view_b) = (a.view(), b.view());
        let core = gap(&view_a, &view_b, &pose);
        let core = if core.gap > 0.0 {
            CoreGap::from(&distance(&view_a, &view_b, &pose, Vec3::X))
        } else {
            core
        };
        let margin = core.gap.max(0.0) + 0.02 * scale;
        let found = manifold(&view_a, &view_b, &pose, &core, margin);
        assert!((1..=4).contains(&found.len()));
        let tolerance = 2e-4 * 3.0 * scale;
        assert!(
            (found[0].gap - core.gap).abs() <= tolerance,
            "{found:?} {core:?}"
        );
        let (pa, pb) = (in_b(&a, &pose), in_b(&b, &Pose::IDENTITY));
        let along = -overlap(&pa, &pb, core.normal.as_dvec3().normalize()) as f32;
        for contact in &found {
            assert!(contact.gap >= found[0].gap && contact.gap <= margin);
            assert!(contact.gap >= along - tolerance);
        }
    }
}

#[test]
fn radii_move_the_point_to_the_middle_of_the_surfaces() {
    let mut a = cuboid(Vec3::ONE);
    let mut b = cuboid(Vec3::ONE);
    (a.radius, b.radius) = (0.2, 0.05);
    let found = contacts(&a, &b, &Pose::at(0.0, 2.3, 0.0), 0.1);
    assert_eq!(found.len(), 4);
    // B's surface is at 1.05, A's at 1.1.
    assert!(
        found
            .iter()
            .all(|c| (c.point.y - 1.075).abs() < 1e-6 && (c.gap - 0.05).abs() < 1e-6)
    );
}
