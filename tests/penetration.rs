//! Depth of cores: analytic cases, a brute-force reference in double precision, symmetry and
//! continuity.

#[path = "common/shapes.rs"]
mod shapes;

use glam::{Quat, Vec3};
use palpable::geometry::penetration::{
    CorePenetration, Feature, core_penetration, core_penetration_until,
};
use palpable::math::Pose;
use shapes::{Hull, Random, blob, cuboid, in_b, overlap, reference};

fn depth(a: &Hull, b: &Hull, pose: &Pose) -> CorePenetration {
    core_penetration(&a.view(), &b.view(), pose)
}

fn inverse(pose: &Pose) -> Pose {
    Pose::IDENTITY.seen_from(pose)
}

/// Depth, unit normal, and the overlap along that normal, all against double precision.
fn check(a: &Hull, b: &Hull, pose: &Pose, tolerance: f64) -> CorePenetration {
    let found = depth(a, b, pose);
    let solid = |hull: &&&Hull| hull.points.len() > 2;
    let sizes = [a, b];
    let size = sizes
        .iter()
        .filter(solid)
        .map(|hull| hull.size())
        .fold(f64::MAX, f64::min);
    let (expected, _) = reference(a, b, pose);
    let error = f64::from(found.depth) - expected;
    assert!(
        error >= -tolerance * size,
        "{found:?} expected {expected} size {size}"
    );
    // Apart, axes of edges whose arcs do not cross may part more: only the sign is exact.
    let bound = if expected < 0.0 { -expected } else { 0.0 };
    assert!(
        error <= bound + tolerance * size,
        "{found:?} expected {expected} size {size}"
    );
    let normal = found.normal.as_dvec3();
    assert!((normal.length() - 1.0).abs() < 4e-7);
    let along = overlap(
        &in_b(a, pose),
        &in_b(b, &Pose::IDENTITY),
        normal.normalize(),
    );
    assert!((along - f64::from(found.depth)).abs() <= tolerance * size);
    let witness = (found.point_b - found.point_a).as_dvec3().dot(normal);
    assert!((witness - f64::from(found.depth)).abs() <= 2.0 * tolerance * size);
    found
}

#[test]
fn offset_cubes() {
    let cube = cuboid(Vec3::ONE);
    for scale in [5e-4, 1.0, 50.0] {
        let scaled = cuboid(Vec3::splat(scale));
        let found = check(&scaled, &scaled, &Pose::at(1.9 * scale, 0.0, 0.0), 2e-7);
        assert!((found.depth - 0.1 * scale).abs() <= 4e-7 * scale);
        assert_eq!(found.normal, Vec3::X);
    }
    let found = depth(&cube, &cube, &Pose::at(-1.9, 0.3, 0.1));
    assert_eq!(found.normal, Vec3::NEG_X);
}

#[test]
fn edge_against_edge() {
    // A cube stood on an edge along z, another laid on an edge along x above it: the edges cross
    // at right angles, both sqrt 2 from their centres.
    let cube = cuboid(Vec3::ONE);
    let eighth = std::f32::consts::FRAC_PI_4;
    let turned = Quat::from_rotation_x(eighth) * Quat::from_rotation_z(-eighth);
    let up = Quat::from_rotation_z(eighth).conjugate();
    let apart = 2.0 * std::f32::consts::SQRT_2 - 0.05;
    let pose = Pose::new(
        (up * Quat::from_rotation_x(eighth)).normalize(),
        up * Vec3::new(0.0, apart, 0.0),
    );
    let found = check(&cube, &cube, &pose, 2e-7);
    assert!((found.depth - 0.05).abs() < 5e-7, "{found:?}");
    assert!(matches!(found.feature, Feature::Edges(..)));
    assert!(found.normal.dot(up * Vec3::Y) > 0.999_999);
    let middle = up * Vec3::new(0.0, apart / 2.0, 0.0);
    assert!((found.point_a - middle).length() < 0.026);
    let both = Pose::new(turned, Vec3::new(1.4, 1.3, 0.2));
    check(&cube, &cube, &both, 2e-7);
}

#[test]
fn parallel_faces_and_edges() {
    let (a, b) = (
        cuboid(Vec3::new(0.3, 0.2, 0.5)),
        cuboid(Vec3::new(0.4, 0.1, 0.7)),
    );
    let mut random = Random(3);
    for step in 0..200 {
        let tilt = [0.0, 1e-8, 1e-7, 3e-7, 1e-6, 1e-5, 1e-4][step % 7];
        let axis = random.unit().as_vec3();
        let turn = Quat::from_axis_angle(axis, tilt).normalize();
        let at = (random.unit() * random.between(0.05, 0.6)).as_vec3();
        check(&a, &b, &Pose::new(turn, at), 3e-7);
    }
}

#[test]
fn parallel_edges_of_turned_prisms() {
    // Edges along z only differ by a tilt near rounding; everything else is general.
    let mut random = Random(8);
    let hull = blob(&mut random, 16, Vec3::ONE);
    for tilt in [0.0, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3] {
        for _ in 0..20 {
            let turn = Quat::from_axis_angle(random.unit().as_vec3(), tilt).normalize();
            let at = (random.unit() * random.between(0.1, 1.9)).as_vec3();
            check(&hull, &hull, &Pose::new(turn, at), 3e-7);
        }
    }
}

#[test]
fn coincident_concentric_and_inside() {
    let mut random = Random(4);
    for _ in 0..10 {
        let hull = blob(&mut random, 14, Vec3::new(0.02, 0.05, 0.03));
        check(&hull, &hull, &Pose::IDENTITY, 3e-7);
        check(&hull, &hull, &Pose::new(random.turn(), Vec3::ZERO), 3e-7);
        let large = cuboid(Vec3::splat(0.1));
        let at = (random.unit() * 0.02).as_vec3();
        check(&hull, &large, &Pose::new(random.turn(), at), 6e-7);
        check(&large, &hull, &Pose::new(random.turn(), at), 6e-7);
    }
    let cube = cuboid(Vec3::ONE);
    assert_eq!(depth(&cube, &cube, &Pose::IDENTITY).depth, 2.0);
}

#[test]
fn touching_has_depth_zero() {
    let cube = cuboid(Vec3::ONE);
    for (x, y, z) in [(2.0, 0.0, 0.0), (2.0, 2.0, 0.0), (2.0, 2.0, 2.0)] {
        let found = depth(&cube, &cube, &Pose::at(x, y, z));
        assert_eq!(found.depth, 0.0);
    }
}

#[test]
fn separated_axis_is_a_lower_bound() {
    let cube = cuboid(Vec3::ONE);
    let found = depth(&cube, &cube, &Pose::at(2.5, 0.0, 0.0));
    assert_eq!((found.depth, found.normal), (-0.5, Vec3::X));
    let found = depth(&cube, &cube, &Pose::at(3.0, 3.0, 0.0));
    let distance = std::f32::consts::SQRT_2;
    assert!(found.depth < 0.0 && found.depth >= -distance);
}

#[test]
fn random_hulls_of_every_size() {
    let mut random = Random(1);
    for round in 0..120 {
        let scale = [1e-3, 0.02, 1.0, 100.0][round % 4] / 2.0;
        let counts = [(4, 4), (8, 8), (12, 20), (32, 32), (20, 6)][round % 5];
        let stretch = |random: &mut Random| {
            let part = |random: &mut Random| random.between(0.2, 1.0) as f32;
            Vec3::new(part(random), part(random), part(random)) * scale
        };
        let (half_a, half_b) = (stretch(&mut random), stretch(&mut random));
        let a = blob(&mut random, counts.0, half_a);
        let b = blob(&mut random, counts.1, half_b);
        let far = random.between(0.0, 1.6) * f64::from(scale);
        let pose = Pose::new(random.turn(), (random.unit() * far).as_vec3());
        check(&a, &b, &pose, 4e-7);
    }
}

#[test]
fn slivers() {
    let mut random = Random(2);
    for _ in 0..60 {
        let needle = cuboid(Vec3::new(0.5, 0.0005, 0.0005));
        let plate = cuboid(Vec3::new(0.5, 0.5, 0.0005));
        let at = (random.unit() * random.between(0.0, 0.4)).as_vec3();
        let pose = Pose::new(random.turn(), at);
        for (a, b) in [(&needle, &needle), (&needle, &plate), (&plate, &plate)] {
            check(a, b, &pose, 4e-7);
        }
    }
}

/// Solids whose faces meet in angles down to 1e-6: sides of an edge have nearly opposite normals.
#[test]
fn blades() {
    let mut random = Random(15);
    for round in 0..3000 {
        let thin = 10f64.powf(random.between(-5.2, -2.0)) as f32;
        let half = Vec3::from_array(
            [[1.0, 1.0, thin], [1.0, thin, 0.3], [thin, thin * 3.0, 1.0]][round % 3],
        );
        let count = 7 + round % 5;
        let blade = blob(&mut random, count, half);
        let solid = blob(&mut random, 9, Vec3::ONE);
        let other = blob(&mut random, 7, Vec3::new(thin, 1.0, 0.7));
        let at = (random.unit() * random.between(0.0, 1.5)).as_vec3();
        let pose = Pose::new(random.turn(), at);
        for (a, b) in [(&blade, &solid), (&solid, &blade), (&blade, &other)] {
            check(a, b, &pose, 4e-7);
        }
    }
}

#[test]
fn duplicate_and_coplanar_vertices() {
    let mut points = cuboid(Vec3::ONE).points;
    points.push(points[3]);
    points.push(Vec3::new(0.25, 1.0, 0.25));
    points.push(Vec3::new(1.0, 0.0, 0.0));
    let (a, cube) = (Hull::new(&points, 0.0), cuboid(Vec3::ONE));
    let mut random = Random(6);
    for _ in 0..30 {
        let at = (random.unit() * random.between(0.0, 2.4)).as_vec3();
        let pose = Pose::new(random.turn(), at);
        let found = check(&a, &cube, &pose, 3e-7);
        let plain = depth(&cube, &cube, &pose);
        assert!((found.depth - plain.depth).abs() < 2e-6);
    }
}

#[test]
fn swapping_negates_the_normal() {
    let mut random = Random(7);
    for _ in 0..60 {
        let a = blob(&mut random, 18, Vec3::new(1.0, 0.4, 0.3));
        let b = blob(&mut random, 11, Vec3::new(0.3, 0.9, 0.5));
        let pose = Pose::new(random.turn(), (random.unit() * 0.7).as_vec3());
        let there = check(&a, &b, &pose, 4e-7);
        let back = check(&b, &a, &inverse(&pose), 4e-7);
        assert!((there.depth - back.depth).abs() < 1e-6);
        // Normals of different axes are compared by what they do: both must reach the depth.
        let turned = -(pose.quat() * back.normal);
        let along = overlap(
            &in_b(&a, &pose),
            &in_b(&b, &Pose::IDENTITY),
            turned.as_dvec3().normalize(),
        );
        assert!((along - f64::from(there.depth)).abs() < 1e-6);
    }
}

#[test]
fn depth_is_continuous_over_a_full_turn() {
    let mut random = Random(9);
    let a = blob(&mut random, 20, Vec3::new(1.0, 0.5, 0.2));
    let b = cuboid(Vec3::new(0.5, 0.7, 0.3));
    let axis = random.unit().as_vec3();
    let steps = 20_000;
    let mut last: Option<f32> = None;
    for step in 0..=steps {
        let angle = std::f32::consts::TAU * step as f32 / steps as f32;
        let pose = Pose::new(Quat::from_axis_angle(axis, angle), Vec3::new(0.2, 0.3, 0.1));
        let now = depth(&a, &b, &pose).depth;
        // A vertex is at most 1 m from A's origin and moves at most that much a radian.
        let bound = 2.0 * std::f32::consts::TAU / steps as f32;
        assert!(last.is_none_or(|before| (now - before).abs() <= bound));
        last = Some(now);
    }
}

#[test]
fn points_and_segments_against_solids() {
    let cube = cuboid(Vec3::ONE);
    let point = Hull::new(&[Vec3::ZERO], 0.1);
    let found = check(&point, &cube, &Pose::at(0.75, 0.1, 0.2), 1e-7);
    assert_eq!((found.depth, found.normal), (0.25, Vec3::X));
    let found = depth(&cube, &point, &Pose::at(-0.75, 0.1, 0.2));
    assert_eq!((found.depth, found.normal), (0.25, Vec3::NEG_X));
    let mut random = Random(10);
    for _ in 0..200 {
        let ends = [random.unit().as_vec3() * 0.7, random.unit().as_vec3() * 0.7];
        let segment = Hull::new(&ends, 0.1);
        let hull = blob(&mut random, 15, Vec3::new(0.9, 0.6, 0.4));
        let pose = Pose::new(random.turn(), (random.unit() * 0.6).as_vec3());
        check(&segment, &hull, &pose, 4e-7);
        check(&hull, &segment, &pose, 4e-7);
    }
}

#[test]
fn points_and_segments_alone() {
    let point = Hull::new(&[Vec3::ZERO], 0.1);
    let segment = Hull::new(&[Vec3::new(-1.0, 0.0, 0.0), Vec3::new(1.0, 0.0, 0.0)], 0.1);
    let found = depth(&point, &point, &Pose::at(0.0, 0.5, 0.0));
    assert_eq!((found.depth, found.normal), (-0.5, Vec3::Y));
    assert_eq!(depth(&point, &point, &Pose::IDENTITY).depth, 0.0);
    let found = depth(&point, &segment, &Pose::at(0.4, 0.0, -0.5));
    assert!((found.depth + 0.5).abs() < 1e-7 && found.normal.dot(Vec3::NEG_Z) > 0.999_999);
    assert!((found.point_b - Vec3::new(0.4, 0.0, 0.0)).length() < 1e-6);
    let across = Quat::from_rotation_z(std::f32::consts::FRAC_PI_2);
    let found = depth(
        &segment,
        &segment,
        &Pose::new(across, Vec3::new(0.0, 0.0, 0.25)),
    );
    assert!((found.depth + 0.25).abs() < 1e-7 && found.normal.dot(Vec3::Z) > 0.999_999);
    for turn in [Quat::IDENTITY, across] {
        let found = depth(&segment, &segment, &Pose::new(turn, Vec3::ZERO));
        assert!(found.depth.abs() < 1e-7);
        assert!(found.normal.dot(Vec3::X).abs() < 1e-6);
        assert!((found.normal.length() - 1.0).abs() < 1e-6);
    }
}

#[test]
fn early_out_stops_at_an_axis_that_parts() {
    let mut random = Random(11);
    for _ in 0..100 {
        let a = blob(&mut random, 12, Vec3::ONE);
        let b = blob(&mut random, 12, Vec3::ONE);
        let pose = Pose::new(
            random.turn(),
            (random.unit() * random.between(0.8, 2.4)).as_vec3(),
        );
        let full = depth(&a, &b, &pose);
        let early = core_penetration_until(&a.view(), &b.view(), &pose, 0.0);
        assert_eq!(early.depth <= 0.0, full.depth <= 0.0);
        assert!(early.depth >= full.depth);
        assert!(full.depth <= 0.0 || early == full);
    }
}

#[test]
fn equal_calls_give_equal_bits() {
    let mut random = Random(12);
    let a = blob(&mut random, 32, Vec3::ONE);
    let pose = Pose::new(random.turn(), Vec3::new(0.5, 0.4, 0.3));
    assert_eq!(depth(&a, &a, &pose), depth(&a, &a, &pose));
}

#[test]
fn boxes_of_every_shape_and_turn() {
    let mut random = Random(14);
    for round in 0..2000 {
        let scale = [1e-3, 0.02, 1.0, 100.0][round % 4];
        let half = |random: &mut Random| {
            let part = |random: &mut Random| random.between(0.05, 1.0) as f32;
            Vec3::new(part(random), part(random), part(random)) * scale
        };
        let (a, b) = (cuboid(half(&mut random)), cuboid(half(&mut random)));
        let far = random.between(0.0, 1.5) * f64::from(scale);
        let pose = Pose::new(random.turn(), (random.unit() * far).as_vec3());
        let found = check(&a, &b, &pose, 4e-7);
        let (low, high) = features_agree(&a, &b, &pose, &found);
        assert!(low && high, "{found:?}");
    }
}

/// Whether the features of A and of B are the ones that reach farthest along the normal.
fn features_agree(a: &Hull, b: &Hull, pose: &Pose, found: &CorePenetration) -> (bool, bool) {
    let normal = found.normal.as_dvec3();
    let (of_a, of_b) = (in_b(a, pose), in_b(b, &Pose::IDENTITY));
    let low = of_a.iter().map(|v| v.dot(normal)).fold(f64::MAX, f64::min);
    let high = of_b.iter().map(|v| v.dot(normal)).fold(f64::MIN, f64::max);
    let ring = |hull: &Hull, face: u16| -> Vec<usize> {
        let face = hull.faces[face as usize];
        let first = face.first_loop as usize;
        let ring = &hull.loops[first..first + face.loop_count as usize];
        ring.iter().map(|&i| i as usize).collect()
    };
    let ends = |hull: &Hull, edge: u16| hull.edges[edge as usize].vertices.map(usize::from);
    let (on_a, on_b) = match found.feature {
        Feature::FaceA(face) => (ring(a, face), vec![]),
        Feature::FaceB(face) => (vec![], ring(b, face)),
        Feature::Edges(i, j) => (ends(a, i).to_vec(), ends(b, j).to_vec()),
        Feature::Points => (vec![], vec![]),
    };
    let slack = 1e-6 * (a.size() + b.size());
    (
        on_a.iter().all(|&i| of_a[i].dot(normal) <= low + slack),
        on_b.iter().all(|&i| of_b[i].dot(normal) >= high - slack),
    )
}
