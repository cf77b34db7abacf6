//! Reach cones against f64: membership by meridians, nearest directions by dense sampling.

use glam::{DQuat, DVec3, Vec3};
use palpable::geometry::reach_cone::{ConeError, ReachCone};
use palpable::limits::REACH_CONE_EDGES_MAX;

#[path = "common/shapes.rs"]
mod shapes;

use shapes::Random;

fn octant() -> ReachCone {
    ReachCone::new(Vec3::ONE, &[Vec3::X, Vec3::Y, Vec3::Z]).unwrap()
}

/// A cone around a random axis: between `low` and `high` radians from it, in random steps.
fn random_cone(random: &mut Random, low: f64, high: f64) -> (ReachCone, DVec3, Vec<DVec3>) {
    let axis = random.unit();
    let u = axis.any_orthonormal_vector();
    let v = axis.cross(u);
    let count = 3 + (random.bits() % 10) as usize;
    let corners: Vec<DVec3> = (0..count)
        .map(|index| {
            // No lune is wider than half a turn.
            let jitter = random.between(-0.2, 0.2);
            let azimuth = std::f64::consts::TAU * (index as f64 + jitter) / count as f64;
            let angle = random.between(low, high);
            axis * angle.cos() + (u * azimuth.cos() + v * azimuth.sin()) * angle.sin()
        })
        .collect();
    let single: Vec<Vec3> = corners.iter().map(|p| p.as_vec3()).collect();
    (
        ReachCone::new(axis.as_vec3(), &single).expect("star-shaped about its axis"),
        axis,
        corners,
    )
}

/// How far inside a direction is along its meridian, in radians: to where the meridian meets the edge.
fn margin(axis: DVec3, corners: &[DVec3], limb: DVec3) -> f64 {
    let tangent = (limb - axis * axis.dot(limb)).normalize();
    let angle = axis.cross(limb).length().atan2(axis.dot(limb));
    let around = |p: DVec3| tangent.cross(p).dot(axis).atan2(tangent.dot(p));
    for (index, &a) in corners.iter().enumerate() {
        let b = corners[(index + 1) % corners.len()];
        let (from, to) = (around(a), around(b));
        // The tangent is at zero; the edge that passes it goes from below to above, by less than pi.
        if from <= 0.0 && to >= 0.0 && to - from < std::f64::consts::PI {
            let normal = a.cross(b);
            return axis.dot(normal).atan2(-tangent.dot(normal)) - angle;
        }
    }
    panic!("no edge is met");
}

/// Angle to the nearest of many points on the boundary, and how far those are apart.
fn sampled(corners: &[DVec3], limb: DVec3) -> (f64, f64) {
    const STEPS: usize = 400;
    let (mut least, mut spacing) = (f64::MAX, 0.0_f64);
    for (index, &a) in corners.iter().enumerate() {
        let b = corners[(index + 1) % corners.len()];
        spacing = spacing.max(a.distance(b) * 2.0 / STEPS as f64);
        for step in 0..=STEPS {
            let p = a.lerp(b, step as f64 / STEPS as f64).normalize();
            least = least.min(p.cross(limb).length().atan2(p.dot(limb)));
        }
    }
    (least, spacing)
}

#[test]
fn an_octant_allows_what_is_positive() {
    let cone = octant();
    assert!(cone.contains(Vec3::ONE));
    assert!(cone.contains(Vec3::new(1.0, 0.01, 3.0)));
    assert!(!cone.contains(Vec3::new(1.0, -0.01, 3.0)));
    assert!(!cone.contains(-Vec3::ONE));
    let inside = Vec3::new(0.6, 0.0, 0.8);
    assert_eq!(cone.nearest(inside), inside);
    let below = Vec3::new(0.6, -0.6, 0.529_150_3);
    let wanted = Vec3::new(0.6, 0.0, 0.529_150_3).normalize();
    assert!((cone.nearest(below) - wanted).length() < 1e-6);
    let corner = cone.nearest(Vec3::new(0.9, -0.3, -0.316_227_77));
    assert!((corner - Vec3::X).length() < 1e-6);
    assert!((cone.outside_rad(Vec3::NEG_X) - std::f32::consts::FRAC_PI_2).abs() < 1e-6);
}

#[test]
fn either_way_round_is_the_same_cone() {
    let back = ReachCone::new(Vec3::ONE, &[Vec3::Z, Vec3::Y, Vec3::X]).unwrap();
    let mut random = Random(3);
    for _ in 0..1000 {
        let limb = random.unit().as_vec3();
        assert_eq!(octant().contains(limb), back.contains(limb));
        assert_eq!(octant().outside_rad(limb), back.outside_rad(limb));
    }
}

#[test]
fn membership_is_that_of_the_meridians() {
    let mut random = Random(1);
    let mut counts = [0, 0];
    for round in 0..300 {
        let (low, high) = [(0.3, 1.0), (0.9, 1.3), (1.2, 1.7), (1.8, 2.2)][round % 4];
        let (cone, axis, corners) = random_cone(&mut random, low, high);
        for _ in 0..100 {
            let limb = random.unit();
            let margin = margin(axis, &corners, limb);
            if margin.abs() > 1e-5 {
                assert_eq!(cone.contains(limb.as_vec3()), margin > 0.0, "{margin}");
                counts[usize::from(margin > 0.0)] += 1;
            }
        }
    }
    assert!(counts.iter().all(|&count| count > 5000), "{counts:?}");
}

#[test]
fn the_nearest_is_on_the_boundary_and_nothing_is_nearer() {
    let mut random = Random(2);
    let mut outside = 0;
    for _ in 0..60 {
        let (cone, _, corners) = random_cone(&mut random, 0.3, 1.4);
        for _ in 0..40 {
            let limb = random.unit();
            if cone.contains(limb.as_vec3()) {
                continue;
            }
            outside += 1;
            let nearest = cone.nearest(limb.as_vec3());
            let angle = limb.cross(nearest.as_dvec3()).length();
            let angle = angle.atan2(limb.dot(nearest.as_dvec3()));
            let (least, spacing) = sampled(&corners, limb);
            assert!(angle <= least + 2e-6 && angle >= least - spacing - 2e-6);
            assert!((nearest.length() - 1.0).abs() < 1e-6);
            assert!(cone.outside_rad(nearest) < 1e-6);
            assert!((f64::from(cone.outside_rad(limb.as_vec3())) - angle).abs() < 1e-6);
        }
    }
    assert!(outside > 1000, "{outside}");
}

#[test]
fn bad_corners_are_named() {
    let new = ReachCone::new;
    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    assert_eq!(new(Vec3::ONE, &[x, y]), Err(ConeError::TooFew));
    let many = [x; REACH_CONE_EDGES_MAX + 1];
    assert_eq!(new(Vec3::ONE, &many), Err(ConeError::TooMany));
    for bad in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY] {
        assert_eq!(new(bad, &[x, y, z]), Err(ConeError::NoDirection));
        assert_eq!(new(Vec3::ONE, &[x, bad, z]), Err(ConeError::NoDirection));
    }
    assert_eq!(new(Vec3::ONE, &[x, x, y, z]), Err(ConeError::Edge));
    assert_eq!(new(Vec3::ONE, &[x, -x, y]), Err(ConeError::Edge));
    assert_eq!(
        new(-Vec3::ONE + 3.0 * z, &[x, y, z]),
        Err(ConeError::NotVisible)
    );
    assert_eq!(new(x, &[x, y, z]), Err(ConeError::NotVisible));
    let star: Vec<Vec3> = (0..5)
        .map(|index| {
            let (sine, cosine) = (index as f32 * 2.0 * std::f32::consts::TAU / 5.0).sin_cos();
            Vec3::new(cosine, sine, 1.0)
        })
        .collect();
    assert_eq!(new(z, &star), Err(ConeError::Winding));
    let text = ConeError::Winding.to_string();
    assert!(text.contains("more than once"), "{text}");
}

#[test]
fn equal_questions_have_equal_answers_and_ties_go_to_the_first_edge() {
    let cone = octant();
    let away = -Vec3::ONE.normalize();
    assert_eq!(cone.nearest(away), cone.nearest(away));
    assert_eq!(cone.nearest(away), cone.corners()[0]);
    assert_eq!(cone.visible(), Vec3::ONE.normalize());
}

#[test]
fn what_is_hardly_outside_is_not_sent_to_another_edge() {
    // Found by random skeletons: a third of a milliradian from a corner, a hair outside one of its edges,
    // the cosines to both edges are one in f32, and the first edge was taken.
    let corners = [
        Vec3::new(1.0, 1.0, 1.0),
        Vec3::new(-1.0, 1.0, 1.0),
        Vec3::new(-0.3, 0.0, 1.0),
        Vec3::new(-1.0, -1.0, 1.0),
        Vec3::new(1.0, -1.0, 1.0),
    ];
    let cone = ReachCone::new(Vec3::new(0.2, 0.0, 1.0), &corners).unwrap();
    for (corner, next) in [(0, 1), (1, 2), (2, 3), (3, 4), (4, 0)] {
        let (a, b) = (cone.corners()[corner], cone.corners()[next]);
        let outward = -a.cross(b).normalize();
        for along in [1e-4_f32, 2e-4, 3e-4] {
            for aside in [2e-7_f32, 1e-6, 1e-5] {
                let on = (a + (b - a).normalize() * along).normalize();
                let limb = (on + outward * aside).normalize();
                let nearest = cone.nearest(limb);
                assert!(
                    (nearest - limb).length() <= 1.5 * aside + 1e-7,
                    "{corner} {along} {aside}"
                );
                assert!(
                    cone.outside_rad(nearest) <= 1e-6,
                    "{corner} {along} {aside}"
                );
            }
        }
    }
}

/// The angle between a direction and the arc between two, in radians.
fn to_arc_rad(limb: DVec3, a: DVec3, b: DVec3) -> f64 {
    let normal = a.cross(b).normalize();
    let beside = normal.cross(a).dot(limb) >= 0.0 && b.cross(normal).dot(limb) >= 0.0;
    if beside {
        normal.dot(limb).asin().abs()
    } else {
        limb.angle_between(a).min(limb.angle_between(b))
    }
}

/// How far the direction that a cone gives for a limb is from its boundary, in radians.
fn nearest_is_off_rad(cone: &ReachCone, limb: DVec3) -> f64 {
    let found = cone.nearest(limb.as_vec3()).as_dvec3().normalize();
    let corners = cone.corners();
    let ends = |index: usize| [corners[index], corners[(index + 1) % corners.len()]];
    (0..corners.len())
        .map(|index| {
            let [a, b] = ends(index).map(|corner| corner.as_dvec3().normalize());
            to_arc_rad(found, a, b)
        })
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn limbs_at_right_angles_to_an_edge_come_to_the_boundary() {
    let mut random = Random(7);
    for _ in 0..300 {
        let (cone, _, _) = random_cone(&mut random, 0.3, 1.4);
        for index in 0..cone.corners().len() {
            let next = (index + 1) % cone.corners().len();
            let [a, b] = [index, next].map(|corner| cone.corners()[corner].as_dvec3());
            let aside = 10.0_f64.powf(random.between(-5.0, -1.0));
            let limb = (a + b).normalize() * aside - a.cross(b).normalize();
            let off = nearest_is_off_rad(&cone, limb.normalize());
            assert!(off < 1e-6, "{cone:?} {limb}: {off}");
        }
    }
}

#[test]
fn an_edge_of_milliradians_is_as_sharp_as_a_long_one() {
    let mut random = Random(8);
    for _ in 0..3000 {
        let turn = DQuat::from_rotation_arc(DVec3::X, random.unit()).as_quat();
        let skew = random.between(-0.001, 0.001) as f32;
        let corners = [Vec3::X, Vec3::new(1.0, 0.002, skew), Vec3::Y, Vec3::Z];
        let cone = ReachCone::new(turn * Vec3::ONE, &corners.map(|p| turn * p)).unwrap();
        let [a, b] = [0, 1].map(|index| cone.corners()[index].as_dvec3());
        let inward = a.cross(b).normalize();
        let out = random.between(-1e-5, 1e-5);
        let limb = ((a + b).normalize() - inward * out).as_vec3();
        if out.abs() > 1e-6 {
            assert_eq!(cone.contains(limb), out < 0.0, "{out} {cone:?}");
        }
    }
}
