//! Contacts of pieces whose patches are known.

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

/// Hulls and random numbers.
mod shapes {
    use glam::{DQuat, DVec3, Quat, Vec3};
    use palpable::geometry::convex::{Convex, Edge, Face, Lane};
    use palpable::geometry::hull::HullBuilder;
    use palpable::math::Pose;

    /// A convex piece that owns its parts.
    pub struct Hull {
        pub points: Vec<Vec3>,
        faces: Vec<Face>,
        edges: Vec<Edge>,
        loops: Vec<u16>,
        pub radius: f32,
        lanes: Vec<Lane>,
        centre: Vec3,
        half_extents: Vec3,
    }

    impl Hull {
        pub fn new(points: &[Vec3], radius: f32) -> Self {
            let mut builder = Box::new(HullBuilder::new());
            let view = match *points {
                [centre] => builder.sphere(centre),
                [start, end] => builder.capsule(start, end),
                _ => {
                    let points: Vec<[f32; 3]> = points.iter().map(Vec3::to_array).collect();
                    builder.build(&points)
                }
            };
            let piece = view.expect("points with volume").convex(radius);
            Self {
                points: (0..piece.vertex_count)
                    .map(|index| piece.vertex(index))
                    .collect(),
                faces: piece.faces.to_vec(),
                edges: piece.edges.to_vec(),
                loops: piece.loops.to_vec(),
                radius,
                lanes: piece.lanes.to_vec(),
                centre: piece.centre,
                half_extents: piece.half_extents,
            }
        }

        pub fn view(&self) -> Convex<'_> {
            Convex {
                lanes: &self.lanes,
                vertex_count: self.points.len(),
                faces: &self.faces,
                edges: &self.edges,
                loops: &self.loops,
                radius: self.radius,
                centre: self.centre,
                half_extents: self.half_extents,
            }
        }
    }

    /// A box with the given half extents about the origin.
    pub fn cuboid(half: Vec3) -> Hull {
        let points: Vec<Vec3> = (0..8)
            .map(|i| {
                let sign = |bit: usize| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
                half * Vec3::new(sign(0), sign(1), sign(2))
            })
            .collect();
        Hull::new(&points, 0.0)
    }

    /// `count` points on an ellipsoid, as a hull.
    pub fn blob(random: &mut Random, count: usize, half: Vec3) -> Hull {
        let points: Vec<Vec3> = (0..count)
            .map(|_| (random.unit() * half.as_dvec3()).as_vec3())
            .collect();
        Hull::new(&points, 0.0)
    }

    /// A generator of repeatable numbers (SplitMix64).
    pub struct Random(pub u64);

    impl Random {
        pub fn bits(&mut self) -> u64 {
            self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            z ^ (z >> 31)
        }

        /// In [0, 1).
        pub fn next(&mut self) -> f64 {
            (self.bits() >> 11) as f64 / (1u64 << 53) as f64
        }

        pub fn between(&mut self, low: f64, high: f64) -> f64 {
            low + (high - low) * self.next()
        }

        pub fn unit(&mut self) -> DVec3 {
            loop {
                let v = DVec3::new(
                    self.between(-1., 1.),
                    self.between(-1., 1.),
                    self.between(-1., 1.),
                );
                if v.length() > 0.1 && v.length() < 1.0 {
                    return v.normalize();
                }
            }
        }

        pub fn turn(&mut self) -> Quat {
            let angle = self.between(0.0, std::f64::consts::TAU);
            DQuat::from_axis_angle(self.unit(), angle).as_quat()
        }
    }

    /// The vertices of A in B's frame, in double precision.
    pub fn in_b(a: &Hull, pose: &Pose) -> Vec<DVec3> {
        let turn = pose.quat().as_dquat().normalize();
        let at = pose.translation().as_dvec3();
        a.points.iter().map(|v| turn * v.as_dvec3() + at).collect()
    }

    /// Overlap of two point sets along the unit vector from B into A.
    pub fn overlap(a: &[DVec3], b: &[DVec3], normal: DVec3) -> f64 {
        let low = a.iter().map(|&v| normal.dot(v)).fold(f64::MAX, f64::min);
        let high = b.iter().map(|&v| normal.dot(v)).fold(f64::MIN, f64::max);
        high - low
    }
}
