//! Contacts of pieces whose patches are known.

#[path = "common/shapes.rs"]
mod shapes;

use glam::{DQuat, Quat, Vec3};
use palpable::geometry::convex::Convex;
use palpable::geometry::distance::distance;
use palpable::geometry::manifold::{Contact, CoreGap, manifold};
use palpable::geometry::penetration::core_penetration;
use palpable::geometry::separation::core_gap;
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

/// The contacts as the stages ask for them: depth where the cores overlap, distance where they do not.
fn touching(a: &Hull, b: &Hull, pose: &Pose, margin: f32) -> Vec<Contact> {
    let (a, b) = (a.view(), b.view());
    let core = core_gap(&a, &b, pose, pose.translation());
    manifold(&a, &b, pose, &core, margin).to_vec()
}

/// A pose beside another: moved and turned by up to so many metres and radians.
fn jittered(random: &mut Random, pose: &Pose, most: f64) -> Pose {
    let turn = random.unit() * random.between(0.0, most);
    let turn = DQuat::from_scaled_axis(turn) * pose.quat().as_dquat();
    let at = pose.translation().as_dvec3() + random.unit() * random.between(0.0, most);
    Pose::new(turn.normalize().as_quat(), at.as_vec3())
}

/// The farthest that any contact of `now` is from the nearest of `before`.
fn moved(before: &[Contact], now: &[Contact]) -> f32 {
    let away = |c: &Contact| {
        let to = |other: &Contact| (other.point - c.point).length();
        before.iter().map(to).fold(f32::MAX, f32::min)
    };
    now.iter().map(away).fold(0.0, f32::max)
}

const JITTERS: [f64; 2] = [1e-6, 1e-5];

/// Half of what the jittered box measures, in metres.
const HALF: f32 = 0.1;

/// How often contacts come, go or leap while the pose is jittered a thousand times about each of three
/// heights: just apart, touching, just overlapping.
///
/// Two poses differ by at most twice the jitter j, so a corner moves by 2 j (1 + 0.1 sqrt 3). Where it is
/// cut off by an edge that crosses its own at an angle, the cut moves by that over the sine. The
/// smallest here is cos 0.3: 2.46 j in all, and the rounding of a metre on top.
fn leaps(b: &Hull, pose: &Pose) -> usize {
    let (a, mut random, mut count) = (cuboid(Vec3::splat(HALF)), Random(51), 0);
    for gap in [6e-5, 0.0, -6e-5] {
        for jitter in JITTERS {
            let bound = 2.5 * jitter as f32 + 5e-7;
            let mut next = || {
                let pose = jittered(&mut random, &pose.moved(Vec3::Y * gap), jitter);
                touching(&a, b, &pose, 1e-3)
            };
            let mut before = next();
            for _ in 0..1000 {
                let now = next();
                let far = moved(&before, &now).max(moved(&now, &before));
                count += usize::from(now.len() != before.len() || far > bound);
                before = now;
            }
        }
    }
    count
}

fn resting(x: f32, z: f32, turn: f32) -> Pose {
    Pose::new(Quat::from_rotation_y(turn), Vec3::new(x, 2.0 * HALF, z))
}

#[test]
fn a_trembling_box_on_a_slab_keeps_its_contacts() {
    let slab = cuboid(Vec3::new(1.0, HALF, 1.0));
    for turn in [0.0, 0.3] {
        for x in [0.0, 0.95] {
            assert_eq!(leaps(&slab, &resting(x, 0.2, turn)), 0, "{x} {turn}");
        }
    }
    let cube = cuboid(Vec3::splat(HALF));
    assert_eq!(leaps(&cube, &resting(0.05, 0.03, 0.0)), 0);
}

/// Sides that run along each other cross anywhere, and by rounding such a crossing can be the deepest
/// corner of all: the four true corners are kept all the same.
#[test]
fn a_trembling_box_on_an_equal_one_keeps_its_contacts() {
    let count = leaps(&cuboid(Vec3::splat(HALF)), &resting(0.0, 0.0, 0.0));
    assert_eq!(count, 0, "leaps");
}

/// Four of eight corners are kept, and which is the deepest of the eight is up to the jitter.
#[test]
fn a_trembling_box_turned_on_an_equal_one_keeps_its_contacts() {
    let count = leaps(&cuboid(Vec3::splat(HALF)), &resting(0.0, 0.0, 0.3));
    assert_eq!(count, 0, "leaps");
}

/// A prism of six sides about the vertical.
fn hexagon() -> Hull {
    let corner = |i: usize| {
        let (sin, cos) = (std::f32::consts::FRAC_PI_3 * (i / 2) as f32).sin_cos();
        HALF * Vec3::new(cos, [-1.0, 1.0][i % 2], sin)
    };
    Hull::new(&(0..12).map(corner).collect::<Vec<_>>(), 0.0)
}

/// At every degree of a full turn, with cuts at any angle: nothing moves by a millimetre where the jitter
/// is a hundredth of one.
#[test]
fn trembling_pieces_keep_their_contacts_at_any_turn() {
    let mut random = Random(54);
    for (a, b) in [
        (cuboid(Vec3::splat(HALF)), cuboid(Vec3::splat(HALF))),
        (hexagon(), hexagon()),
    ] {
        for step in 0..360 {
            let turn = std::f32::consts::TAU / 360.0 * step as f32;
            let pose = resting(0.0, 0.0, turn).moved(Vec3::Y * 6e-5);
            let mut next = || touching(&a, &b, &jittered(&mut random, &pose, 1e-5), 1e-3);
            let mut before = next();
            for _ in 0..10 {
                let now = next();
                let far = moved(&before, &now).max(moved(&now, &before));
                assert!(now.len() == 4 && far < 1e-3, "{step} degrees: {far}");
                before = now;
            }
        }
    }
}

/// Whether a contact of two boxes lies over B's top and under A's bottom, up to rounding. Midway along
/// the normal of one, it is beside the other's face by at most its gap times the sine of their tilt.
fn inside_both(contact: &Contact, a: Vec3, b: Vec3, pose: &Pose, tilt: f32) -> bool {
    let slack = 2e-6 + tilt * contact.gap.abs();
    let within = |p: Vec3, half: Vec3| {
        let over = p.abs() - half;
        over.x <= slack && over.z <= slack
    };
    let in_a = pose.quat().conjugate() * (contact.point - pose.translation());
    within(contact.point, b) && within(in_a, a)
}

/// A box turns slowly through a full turn on another, lying flat or tilted. No point of it is farther
/// than `reach` from the axis, so its true gap changes by at most that times the angle.
#[test]
fn slow_turns_are_continuous() {
    let (a, steps) = (Vec3::new(0.1, 0.05, 0.06), 4000);
    let (hull, reach) = (cuboid(a), a.length());
    let angle = std::f32::consts::TAU / steps as f32;
    let bases = [[0.5, 0.1, 0.5], [0.08; 3], [0.1, 0.1, 0.02]].map(Vec3::from_array);
    for (b, tilt, gap) in bases
        .iter()
        .flat_map(|&b| [0.0, 1e-3, 0.01, 0.05].map(|tilt| (b, tilt)))
        .flat_map(|(b, tilt)| [1e-4, -1e-3].map(|gap| (b, tilt, gap)))
    {
        let base = cuboid(b);
        let mut before: Option<f32> = None;
        for step in 0..=steps {
            let turn = Quat::from_rotation_y(angle * step as f32) * Quat::from_rotation_z(tilt);
            let at = Vec3::new(0.01, a.y + b.y + gap, -0.02);
            let pose = Pose::new(turn.normalize(), at);
            let found = touching(&hull, &base, &pose, 6e-3);
            assert!((1..=4).contains(&found.len()));
            let inside = |c: &Contact| inside_both(c, a, b, &pose, tilt);
            assert!(found.iter().all(inside), "{b} {tilt} {found:?}");
            let now = found[0].gap;
            let change = before.map_or(0.0, |gap| (gap - now).abs());
            assert!(change <= reach * angle + 1e-7, "{b} {tilt} {change}");
            assert!(
                tilt != 0.0 || (now - gap).abs() <= 1e-7,
                "{now} is not {gap}"
            );
            before = Some(now);
        }
    }
}

#[test]
fn swapping_negates_normals_and_keeps_points_and_gaps() {
    let slab = cuboid(Vec3::new(0.5, 0.1, 0.5));
    let capsule = Hull::new(&[Vec3::X * -0.1, Vec3::X * 0.15], 0.1);
    let mut random = Random(52);
    for round in 0..300 {
        let (upper, count) = match round % 2 {
            0 => (cuboid(Vec3::new(0.12, 0.1, 0.07)), 4),
            _ => (Hull::new(&capsule.points, 0.1), 2),
        };
        let turn = Quat::from_rotation_y(random.between(0.0, 6.3) as f32);
        let [x, z] = [0; 2].map(|_| random.between(-0.2, 0.2) as f32);
        let gap = [1e-4, -1e-4][round / 2 % 2];
        let pose = Pose::new(turn, Vec3::new(x, 0.2 + gap, z));
        let there = touching(&upper, &slab, &pose, 1e-3);
        let back = touching(&slab, &upper, &Pose::IDENTITY.seen_from(&pose), 1e-3);
        assert_eq!((there.len(), back.len()), (count, count));
        for c in &back {
            let point = pose.point(c.point);
            let twin = there.iter().find(|t| (t.point - point).length() <= 1e-6);
            let twin = twin.unwrap_or_else(|| panic!("{point} not in {there:?}"));
            assert!((pose.quat() * c.normal + twin.normal).length() <= 1e-6);
            assert!((c.gap - twin.gap).abs() <= 2e-7);
        }
    }
}

/// A capsule above the origin of a box's face or edge, along x, longer than the box or shorter.
fn capsule_along(up: Vec3, half_length: f32, gap: f32) -> Vec<Contact> {
    let (half, radius) = (0.2, 0.05);
    let capsule = Hull::new(&[Vec3::X * -half_length, Vec3::X * half_length], radius);
    let surface = half * Vec3::new(0.0, up.y.signum(), if up.z > 0.0 { 1.0 } else { 0.0 });
    let at = surface + up * (radius + gap) + Vec3::X * 0.02;
    let pose = Pose::at(at.x, at.y, at.z);
    let found = touching(&capsule, &cuboid(Vec3::splat(half)), &pose, 2e-3);
    for contact in &found {
        assert!((contact.gap - gap).abs() <= 2e-7 && (contact.normal - up).length() <= 1e-3);
        let beside = contact.point - (surface + up * (0.5 * gap));
        assert!(beside.reject_from(Vec3::X).length() <= 2e-6, "{found:?}");
    }
    found
}

fn ends_are_the_capsules(up: Vec3) {
    for (half_length, left, right) in [(0.1, -0.08, 0.12), (0.3, -0.2, 0.2)] {
        for gap in [1e-4, -1e-3] {
            let mut ends: Vec<f32> = capsule_along(up, half_length, gap)
                .iter()
                .map(|c| c.point.x)
                .collect();
            ends.sort_by(f32::total_cmp);
            let at_ends = ends.len() == 2
                && (ends[0] - left).abs() <= 2e-6
                && (ends[1] - right).abs() <= 2e-6;
            assert!(at_ends, "not at {left} and {right} but at {ends:?}");
        }
    }
}

#[test]
fn a_capsule_along_a_face_touches_at_its_ends() {
    ends_are_the_capsules(Vec3::Y);
}

#[test]
fn a_capsule_along_an_edge_touches_at_its_ends() {
    let diagonal = std::f32::consts::FRAC_1_SQRT_2;
    ends_are_the_capsules(Vec3::new(0.0, diagonal, diagonal));
}

/// Two boxes on their edges, ridge on ridge, the upper one turned about the vertical.
fn ridge_on_ridge(turn: f32) -> Vec<Contact> {
    let eighth = Quat::from_rotation_x(std::f32::consts::FRAC_PI_4);
    let (upper, lower) = (
        cuboid(Vec3::new(0.3, 0.1, 0.1)),
        cuboid(Vec3::new(0.2, 0.1, 0.1)),
    );
    let apart = Vec3::Y * (0.2 * std::f32::consts::SQRT_2 + 1e-4);
    let pose = Pose::new(Quat::from_rotation_y(turn) * eighth, apart);
    let mut found = touching(
        &upper,
        &lower,
        &pose.seen_from(&Pose::new(eighth, Vec3::ZERO)),
        1e-3,
    );
    for contact in &mut found {
        contact.point = eighth * contact.point;
    }
    found
}

/// The ridges touch where they are less than `sideways` beside each other: twice the sine of half the
/// turn for each metre from the crossing.
#[test]
fn ridges_along_each_other_touch_in_a_stretch() {
    let merge = 1e-4 * 2.0 * 0.06_f32.sqrt();
    let sideways = (merge * (2e-4 + merge)).sqrt();
    for (turn, reach) in
        [0.0, 1e-4, 1e-3, 0.02, 0.1].map(|turn: f32| (turn, sideways / (2.0 * (0.5 * turn).sin())))
    {
        let found = ridge_on_ridge(turn);
        assert_eq!(found.len(), 2, "{turn}");
        for c in &found {
            let far = c.point.x.abs();
            assert!(
                (far - reach.min(0.2)).abs() <= 0.02 * reach.min(0.2),
                "{turn} {far} {reach}"
            );
            assert!((c.gap - 1e-4).abs() <= 2e-7 && c.point.z.abs() <= sideways);
        }
        assert!(found[0].point.x * found[1].point.x < 0.0);
    }
    assert_eq!(ridge_on_ridge(0.5).len(), 1);
}

/// Every number of a contact, as bits.
fn bits(contact: &Contact) -> [u32; 7] {
    let ([x, y, z], [u, v, w]) = (contact.point.to_array(), contact.normal.to_array());
    [x, y, z, u, v, w, contact.gap].map(f32::to_bits)
}

#[test]
fn equal_input_gives_equal_bits() {
    let run = || -> Vec<[u32; 7]> {
        let mut random = Random(53);
        (0..200)
            .flat_map(|_| {
                let a = blob(&mut random, 14, Vec3::new(0.2, 0.1, 0.15));
                let b = cuboid(Vec3::new(0.2, 0.1, 0.3));
                let at = (random.unit() * random.between(0.1, 0.3)).as_vec3();
                touching(&a, &b, &Pose::new(random.turn(), at), 0.05)
            })
            .map(|contact| bits(&contact))
            .collect()
    };
    let first = run();
    assert!(first.len() > 100);
    assert_eq!(first, run());
}
