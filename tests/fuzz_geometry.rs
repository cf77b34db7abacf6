//! The checks of separations that the fuzz target makes, over seeded bytes, and what the target found.

#[path = "common/separations.rs"]
mod separations;
#[path = "common/shapes.rs"]
mod shapes;

use glam::{DVec3, Quat, Vec3};
use palpable::geometry::penetration::core_penetration;
use palpable::geometry::separation::{Separation, separation};
use palpable::math::Pose;
use separations::{CHECKS, Checker, Draw, Outcome};
use shapes::{Hull, Random, cuboid, reference};

/// Words from bytes, little-endian, and zeros after their end: as the fuzz target reads its input.
struct Bytes<'b>(&'b [u8]);

impl Draw for Bytes<'_> {
    fn word(&mut self) -> u32 {
        let mut word = [0; 4];
        let count = self.0.len().min(4);
        let (now, later) = self.0.split_at(count);
        word[..count].copy_from_slice(now);
        self.0 = later;
        u32::from_le_bytes(word)
    }
}

#[test]
fn seeded_bytes_break_nothing() {
    let (mut checker, mut random) = (Checker::default(), Random(61));
    let mut counts = [0_u32; 3];
    for _ in 0..20_000 {
        // Room for two clouds of 31 points and all else.
        let bytes: Vec<u8> = (0..128).flat_map(|_| random.bits().to_le_bytes()).collect();
        let outcome = checker.check(&mut Bytes(&bytes));
        counts[outcome as usize] += 1;
    }
    println!("refused, apart, overlapping: {counts:?}");
    for (name, worst) in CHECKS.iter().zip(checker.worst) {
        println!("{name}: at worst {worst:.3} of what is allowed");
    }
    assert!(counts[Outcome::Apart as usize] > 4000);
    assert!(counts[Outcome::Overlapping as usize] > 1500);
}

/// Inputs of the fuzz target that once failed: give a failure's bytes to this list to replay it.
const FAILED: &[&[u8]] = &[
    b"\x7f\x14\x14\x14\x14\x7f\x7f\x7e\x7f\xff\xff\x01\x7f\x7f\x00\xd9\x7f\x7f\x7f\x7f\x7f\x7f\x7f\x7f\x7f\x7f\x7f\x7f\x7f\x7f\x7f\x7f\x7a\x1f\x3a",
    b"\x9c\x5f\xf9\x05\x9c\x9c\x9c\x9c\x9c\x9c\x9c\x9c\x9c\x9c\x79\x9c\x9c\x01\x00\x00\x02\x9c\xdf\x9c\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\x00\x00\x00\x00\x00\x00\x00\xff\xff\xff\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\xff\xff\xff\xff\xff\xff\xff\x9c\x3a\x9c\x9c\x9c\x9c\x2c\x01\x22\x08\x05\xa9\x41\x00\x18\x55\x55\x15\x55\x62\xa9\x63\x5f\x5f\x5f\x5f\x5f\x5f\x5f\x5f\x5f\x5f\x5f\x5f\x5f\x5f\x5f\x5f\x5f\x5f\x5f\x5f\x5f\x5f\x63\x63\x63\xf3\x0b\x00\x00\x63\x63\x63\x63\x63\x63\x63\x63\x9c\x63\x63\x63\x63\x63\x63\x63\x63\x01\x00",
    b"\x4a\x55\x55\x55\x55\x55\x55\x55\x55\x55\x55\x55\x55\x55\x55\x55\x55\x55\x55\x45\x55\x55\x55\x55\x55\x55\x55\x55\x55\x55\xff\xff\xff\xff\xff\xff\xff\x0b\x55\x55\x55\x55\x55\x55\x55\xab\x55\x55\x55\x55\x55\x55\x55\x55\x55\x55\x55\x55\x55\x55\x55\x55\x55\x55\x55\x55\x55\x55\x21\x55\x55\x55\x6f\xba\xba\xba\x03\xfc\x3b\xba\xba\xba\xba\xba\x32\xb8\xba",
    b"\x9c\x5f\x9c\xfd\x9c\x9c\x9c\x9c\x9c\x9c\x9c\x9c\x9c\x9c\x9c\xa5\x01\x00\x00\x02\x9c\xa9\xa9\xa9\xa9\xa9\xa9\x4e\x56\x56\x56\x56\x56\x56\x56\x56\x56\x56\x56\xe6\xff\x56\x56\xa9\xa9\xa9\xa9\xa9\xa9\xa9\x45\xa9\xa9\xa9\xa9\xa9\xa9\x41\x18\x63\x63\x01\xa9\xa9\xa9\xa9\xa9\xa9\xa9\xa9\xa9\xa9\xa9\x5e\xa9\xa9\xa9\xa9\xa9\xa9\x31\x00",
    b"\x71\x71\x71\x71\x71\x71\x71\x71\x71\x71\x71\x71\x71\x71\x71\x71\x71\x71\x71\x71\x9c\x9c\x9c\x9c\x9c\x9c\x9c\x9c\x9c\x9c\x9c\x9c\x04\x71\x71\x7a\x71\x71\x71\x71\x71\x71\x71\x71\x71\x09\xaa\xaa\xaa\xaa\xaa\xaa\xab\xff\xff\xff\x6f\x01\x5e\xc2\xa8\x71\x71\x71\x71\x71\x71\x71\x71\x71\xa9\x1c\x1c\x1c\x1c\x1c\x1c\x1c\x1c\x1c\x1c\x1c\x1c\x1c\x1c\x14\x71\x71\x71\x71\x71\x71\x71\x71\x71\x71\x71\x71\x71\x71\x71\x71\x71\x9c\x9c\x9c\x9c\x9c\x9c\x9c\x9c\x9c\x9c\x9c\x9c\x04\x71\x71\x7a\x71\x71\x71\x71\x71\x71\x71\x71\x71\x09\xaa\xaa\xaa\xaa\xaa\xaa\xab\xff\xff\xff\x6f\x71\x28",
    b"\x22\x00\x00\x00\x22\x92\x2c\x00\x92\x92\x92\x92\x92\x92\x92\x92\x92\x92\x92\x92\x92\x92\x92\x92\x92\x92\x92\x92\x92\xd2\x92\x92\x00\x00\x00\x2a\x30\xf1\x00\x9c\x5f\x9c\xfd\x9c\x9c\x9c\x9c\x9c\x9c\x9c\x9c\x9c\x9c\x9c\x9c\x17\x00\x00\x02\x9c\x9c\x9c\x9c\x9c\x9c\x9c\x2c\x01\x22\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\xff\xff\xff\xff\xff\xff\xef\x05\xff\xff\xff\x09\x00\x01\x00\x00\x00\x08\x05\xa9\x41\x18\x22\x00\x55\x55\xf3\x0b\xa9\xff\xff\xff\xff\xff\x02\x00\xff\xff\x01\x00\x50\x50\x50\x50\x50\x50\x50\x50\x1c\x00\x00\x00\x00\x00\x00\x00\x50\x50\x50\x50\x50\x50\x50\x50\x50\xd0\x50\x50\x27\x50\x23\x50\x50\x50\x63\x63\x00\xaf\x3b\x63\x63\x63\x00\x04\x2a\x32\x21\x30\xf1\x00\x04\x04\x2a\x32\x30\xf1\x04\x00\x04\x2a\x30\xf1\x0e\x00\x32\x0e\x0e\x2e\x01\x00\x01\x10\x01\x4c\x3d\xf8\x00\x0e\x0e\x0e\xfd\x03\x0e\x28\x04\x78\x04\xd7\xca\x06",
];

#[test]
fn what_failed_once_does_not_again() {
    for bytes in FAILED {
        Checker::default().check(&mut Bytes(bytes));
    }
}

fn ask(a: &Hull, b: &Hull, pose_a: &Pose, pose_b: &Pose) -> Separation {
    separation(&a.view(), &b.view(), pose_a, pose_b, Vec3::ZERO)
}

/// Where cores overlap, B's point once was the one opposite to A's on B's supporting plane: under a
/// table top a corner of the top, a metre beside the pebble that is pressed.
#[test]
fn the_point_of_an_overlap_is_on_both() {
    let (top, pebble) = (cuboid(Vec3::new(1.0, 0.1, 1.0)), cuboid(Vec3::splat(0.01)));
    let found = ask(&top, &pebble, &Pose::at(0.0, 0.109, 0.0), &Pose::IDENTITY);
    assert!((found.gap_m + 0.001).abs() < 1e-6);
    let inside = found.point_b.abs().max_element() <= 0.010_001;
    assert!(inside, "{} is beside the pebble", found.point_b);
}

/// The origin is within rounding of the difference's surface: corners about it are no nearest points.
#[test]
fn touching_cores_have_one_point() {
    let a = [
        [6.666_667, 6.666_667, 1.568_743_6],
        [-4.726_716, 9.960_690_5, -3.046_724_3],
        [9.960_784, 9.960_784, 9.960_784],
        [9.960_784, -6.007_030_6e-7, -4.656_613e-9],
        [-4.656_613e-9; 3],
    ];
    let b = [
        [-0.705_882_4, -0.705_880_46, 0.972_553_9],
        [0.242_983_36, -0.011_734_111, 0.011_703_446_5],
        [-0.046_707_228, 1.972_867_2e-5, 0.0],
        [0.0; 3],
    ];
    let hull = |points: &[[f32; 3]]| {
        let points: Vec<Vec3> = points.iter().map(|&p| Vec3::from_array(p)).collect();
        Hull::new(&points, 0.0)
    };
    let turn = Quat::from_xyzw(-0.5, -0.5, -0.5, -0.5);
    let [at_a, at_b] = [-10.0, -1.0].map(|x| Pose::new(turn, Vec3::splat(x)));
    let found = ask(&hull(&a), &hull(&b), &at_a, &at_b);
    assert!(found.gap_m.abs() < 1e-6);
    let apart = (found.point_a - found.point_b).length();
    assert!(apart < 1e-4, "touching points are {apart} m apart");
}

/// A segment along a box's face has its deepest points inside both; no vertex is one of them.
#[test]
fn a_segment_along_a_face_is_deepest_inside_both() {
    let block = cuboid(Vec3::splat(66.666_67));
    let rod = Hull::new(&[Vec3::new(100.0, -100.0, 100.0), Vec3::splat(-100.0)], 0.0);
    let turn = Quat::from_xyzw(-0.5, -0.5, -0.5, -0.5);
    let [at_block, at_rod] = [-100.0, -10.0].map(|x| Pose::new(turn, Vec3::splat(x)));
    let found = ask(&block, &rod, &at_block, &at_rod);
    let in_block = Pose::IDENTITY.seen_from(&at_block).point(found.point_a);
    assert!(in_block.abs().max_element() < 66.67, "{found:?}");
    let on_rod = Pose::IDENTITY.seen_from(&at_rod).point(found.point_b);
    let straight = (on_rod.x - on_rod.z).abs() < 1e-3 && (on_rod.y + 100.0).abs() < 1e-3;
    assert!(straight && on_rod.x.abs() < 100.01, "{on_rod} {found:?}");
    let between = found.point_a - found.point_b;
    assert!(
        (between - found.normal * found.gap_m).length() < 1e-3,
        "{found:?}"
    );
}

/// Axes that cross leave a rounding error between their nearest points, and its direction once was
/// given as the normal. Moving by the radii along it did not part the capsules.
#[test]
fn capsules_that_cross_are_parted_across() {
    let mut random = Random(62);
    for _ in 0..200 {
        let turn = |random: &mut Random| random.turn().as_dquat().normalize();
        let (turn_a, turn_b) = (turn(&mut random), turn(&mut random));
        let capsule = Hull::new(&[Vec3::X * -0.3, Vec3::X * 0.3], 0.05);
        // The axes meet at 0.1 m from the middle of each.
        let at = turn_b * DVec3::X * 0.1 - turn_a * DVec3::X * 0.1;
        let pose_a = Pose::new(turn_a.as_quat(), at.as_vec3());
        let pose_b = Pose::new(turn_b.as_quat(), Vec3::ZERO);
        let found = ask(&capsule, &capsule, &pose_a, &pose_b);
        let out = pose_a.moved(-found.gap_m * found.normal);
        let left = ask(&capsule, &capsule, &out, &pose_b).gap_m;
        assert!(left.abs() < 1e-5, "{left} m left after moving");
    }
}

/// The normals of a sliver's two sides are nearly opposite: heights over both planes do not tell how far a
/// point is beyond their edge, so edges must not be left out by them.
#[test]
fn slivers_are_as_deep_as_they_are() {
    let cube = cuboid(Vec3::splat(100.0));
    let sliver = [
        [0.099_414_06, 99.999_99, 4.609_527],
        [0.076_862_745, 76.862_75, 0.000_108_936_8],
        [0.096_470_59, 96.470_59, 9.647_058_5],
        [0.000_376_838_23, 0.0, 7.686_274_5],
        [-1.878_943_3e-6, -4.656_613e-8, -4.656_613e-9],
    ];
    let sliver = Hull::new(&sliver.map(Vec3::from_array), 0.0);
    let turn = Quat::from_xyzw(-0.632_455_5, -0.316_227_76, -0.316_227_76, -0.632_455_5);
    let pose = Pose::new(turn, Vec3::new(43.466_667, -56.533_333, 94.451_04));
    let found = core_penetration(&cube.view(), &sliver.view(), &pose);
    let (least, _) = reference(&cube, &sliver, &pose);
    let error = f64::from(found.depth) - least;
    assert!(error < 1e-4, "{error} m too deep");
}

/// Three of these points are collinear but for less than a cell of the hull's grid, and an edge of 0.008
/// rad is beside a fourth.
#[test]
fn faces_of_hulls_have_normals() {
    let points = [
        [0.000_996_078_5, 0.000_666_666_7, 0.000_666_666_7],
        [0.000_666_666_7, 0.000_666_666_7, 0.000_666_666_7],
        [0.000_666_666_7, -3.921_569_3e-6, -4.656_613e-13],
        [-4.656_613e-13; 3],
        [0.000_996_078_5; 3],
        [0.000_996_067_1, -6.007_031e-11, -4.656_613e-13],
    ];
    let hull = Hull::new(&points.map(Vec3::from_array), 0.0);
    for face in &hull.faces {
        let length = face.normal.length();
        assert!((length - 1.0).abs() < 1e-6, "no normal: {face:?}");
    }
}
