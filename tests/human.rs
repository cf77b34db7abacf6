//! Human skeletons against the sources' numbers and against poses that people know.

use glam::{Quat, Vec3};
use palpable::geometry::chain::{limb_at, posture};
use palpable::human::ranges::{self, JointLimits};
use palpable::human::{
    Base, Finger, FingerBones, JointDef, Limb, LimbDef, ball_angles, balls_of, finger, hinges_of,
    kept, lengths, limb, limb_on_root, mirrored_ball_angles, mirrored_point, mirrored_pose, swing,
    swing_near,
};
use palpable::math::{Pose, rotation_vector};

#[path = "common/shapes.rs"]
mod shapes;

use shapes::Random;

const HEIGHT_M: f32 = 1.75;

const SIDES: [(Limb, Limb); 2] = [
    (Limb::RightArm, Limb::LeftArm),
    (Limb::RightLeg, Limb::LeftLeg),
];

/// The right shoulder.
fn shoulder() -> Vec3 {
    Vec3::new(lengths::SHOULDER_ASIDE * HEIGHT_M, 0.288 * HEIGHT_M, 0.0)
}

fn near(a: Vec3, b: Vec3) -> bool {
    (a - b).length() < 2e-6
}

/// Pose of a limb's last link in the root's frame, with the spine at its zero.
fn last_link(def: &LimbDef, angles: &[f32]) -> Pose {
    let spine = limb(Limb::Spine, HEIGHT_M);
    let base = match def.base {
        Base::Root => Pose::IDENTITY,
        Base::Spine => {
            posture(&spine.hinges(), &Pose::IDENTITY, &[0.0; 3])
                .last()
                .unwrap()
                .link
        }
    };
    posture(&def.hinges(), &base, angles).last().unwrap().link
}

fn tip(def: &LimbDef, angles: &[f32]) -> Vec3 {
    last_link(def, angles).point(def.tip)
}

/// The limb's direction of a ball in the root's frame to its frame, all limbs at zero.
fn in_ball(def: &LimbDef, direction: Vec3) -> Vec3 {
    let hinges = def.hinges();
    let spine = limb(Limb::Spine, HEIGHT_M);
    let base = match def.base {
        Base::Root => Quat::IDENTITY,
        Base::Spine => spine.joints[0].rest().quat(),
    };
    (base * hinges[0].rest.quat()).conjugate() * direction
}

fn cone_contains(def: &LimbDef, direction: Vec3) -> bool {
    balls_of(&def.joints)[0]
        .cone
        .contains(in_ball(def, direction.normalize()))
}

/// Angles of a straight arm that points somewhere, without twist.
fn pointing(def: &LimbDef, direction: Vec3) -> Vec<f32> {
    let (a, b) = swing(in_ball(def, direction));
    let mut angles = vec![0.0; def.hinges().len()];
    (angles[0], angles[1]) = (a, b);
    angles
}

#[test]
fn ranges_are_the_sources() {
    let typed_in: [(JointLimits, f32, f32); 20] = [
        (ranges::SHOULDER_FLEXION, -60.0, 180.0),
        (ranges::SHOULDER_ABDUCTION, -45.0, 180.0),
        (ranges::SHOULDER_ROTATION, -70.0, 90.0),
        (ranges::ELBOW_FLEXION, 0.0, 150.0),
        (ranges::FOREARM_PRONATION, -80.0, 80.0),
        (ranges::WRIST_FLEXION, -70.0, 80.0),
        (ranges::WRIST_RADIAL, -30.0, 20.0),
        (ranges::HIP_FLEXION, -30.0, 120.0),
        (ranges::HIP_ABDUCTION, -30.0, 45.0),
        (ranges::HIP_ROTATION, -45.0, 45.0),
        (ranges::KNEE_FLEXION, 0.0, 135.0),
        (ranges::ANKLE_DORSIFLEXION, -50.0, 20.0),
        (ranges::NECK_FLEXION, -45.0, 45.0),
        (ranges::NECK_ROTATION, -60.0, 60.0),
        (ranges::SPINE_LATERAL, -35.0, 35.0),
        (ranges::KNUCKLE_FLEXION, -45.0, 90.0),
        (ranges::MIDDLE_FLEXION, 0.0, 100.0),
        (ranges::LAST_FLEXION, 0.0, 90.0),
        (ranges::THUMB_KNUCKLE_FLEXION, 0.0, 50.0),
        (ranges::THUMB_LAST_FLEXION, -20.0, 80.0),
    ];
    for (row, low, high) in typed_in {
        assert_eq!((row.low_deg, row.high_deg), (low, high), "{}", row.motion);
    }
    for row in ranges::TABLE {
        assert!(
            row.low_deg < row.high_deg && row.low_deg <= 0.0,
            "{}",
            row.motion
        );
        assert!(row.high_deg > 0.0 && row.high_deg <= 180.0);
        assert!((row.high_rad() - row.high_deg * std::f32::consts::PI / 180.0).abs() < 1e-6);
    }
}

#[test]
fn bones_add_up_to_the_height() {
    let sum = lengths::ANKLE_HEIGHT
        + lengths::SHANK
        + lengths::THIGH
        + lengths::TRUNK
        + lengths::HEAD_AND_NECK;
    assert!((sum - 1.0).abs() < 1e-6);
    for height in [1.5, HEIGHT_M, 1.95] {
        let root = lengths::HIP_HEIGHT * height;
        let head = limb_on_root(Limb::Neck, height);
        let top = posture(&head.hinges(), &Pose::IDENTITY, &[0.0; 3])[2]
            .link
            .point(head.tip);
        assert!((top.y + root - height).abs() < 1e-5);
        let leg = limb(Limb::RightLeg, height);
        let toes = posture(&leg.hinges(), &Pose::IDENTITY, &[0.0; 6])[5]
            .link
            .point(leg.tip);
        assert!((toes.y + root).abs() < 1e-5);
        let arm: f32 = limb(Limb::LeftArm, height).bones_m.iter().sum();
        assert!((arm - 0.440 * height).abs() < 1e-5);
    }
}

#[test]
fn neutral_is_within_all_limits() {
    for which in Limb::ALL {
        let def = limb(which, HEIGHT_M);
        let count = def.hinges().len();
        let zero = kept(&def.joints, &vec![0.0; count]);
        assert_eq!(zero.clamped, 0, "{which:?}");
        assert_eq!(zero.angles.len(), count);
        for hinge in def.hinges() {
            assert!(hinge.low_rad < hinge.high_rad);
            assert!(hinge.low_rad <= 0.0 && hinge.high_rad > 0.0);
            assert!((hinge.axis.length() - 1.0).abs() < 1e-6);
        }
        for ball in balls_of(&def.joints) {
            assert!((6..=12).contains(&ball.cone.corners().len()));
            assert!(!ball.cone.contains(Vec3::X) && !ball.cone.contains(Vec3::NEG_X));
            let pole = ball.cone.outside_rad(Vec3::X);
            let other = ball.cone.outside_rad(Vec3::NEG_X);
            assert!(pole > 0.17 && other > 0.17, "{which:?}: {pole} {other}");
        }
    }
    let counts = Limb::ALL.map(|which| limb(which, HEIGHT_M).hinges().len());
    assert_eq!(counts, [3, 3, 7, 7, 6, 6]);
}

#[test]
fn left_is_the_mirror_image_of_right() {
    let mut random = Random(7);
    for (right, left) in SIDES {
        let (right, left) = (limb(right, HEIGHT_M), limb(left, HEIGHT_M));
        assert_eq!(right.bones_m, left.bones_m);
        for _ in 0..200 {
            let angles: Vec<f32> = (0..right.hinges().len())
                .map(|_| random.between(-1.5, 1.5) as f32)
                .collect();
            let mut mirrored = angles.clone();
            mirrored[..3].copy_from_slice(&mirrored_ball_angles([angles[0], angles[1], angles[2]]));
            let (a, b) = (last_link(&right, &angles), last_link(&left, &mirrored));
            assert!(near(b.point(left.tip), mirrored_point(a.point(right.tip))));
            let turn = mirrored_pose(&a).quat().conjugate() * b.quat();
            assert!(rotation_vector(turn).length() < 4e-6);
            let (a, b) = (kept(&right.joints, &angles), kept(&left.joints, &mirrored));
            assert_eq!(a.clamped, b.clamped);
        }
    }
}

#[test]
fn neutral_is_standing_with_hanging_arms() {
    let arm = limb(Limb::RightArm, HEIGHT_M);
    let expected = shoulder() - Vec3::Y * (0.440 * HEIGHT_M);
    assert!(near(tip(&arm, &[0.0; 7]), expected));
    let hand = last_link(&arm, &[0.0; 7]);
    assert!(rotation_vector(hand.quat()).length() < 1e-6);
    let leg = limb(Limb::LeftLeg, HEIGHT_M);
    let toes = Vec3::new(
        -lengths::HIP_ASIDE * HEIGHT_M,
        -0.530 * HEIGHT_M,
        -0.75 * 0.152 * HEIGHT_M,
    );
    assert!(near(tip(&leg, &[0.0; 6]), toes));
}

#[test]
fn arms_reach_where_arms_are() {
    let arm = limb(Limb::RightArm, HEIGHT_M);
    let length = 0.440 * HEIGHT_M;
    for (name, direction) in [
        ("sideways", Vec3::X),
        ("forward", Vec3::NEG_Z),
        ("overhead", Vec3::Y),
        ("across", Vec3::new(-0.6, 0.0, -0.8)),
        ("behind", Vec3::new(0.1, -0.9, 0.4).normalize()),
    ] {
        let angles = pointing(&arm, direction);
        assert!(cone_contains(&arm, direction), "{name}");
        assert!(
            near(tip(&arm, &angles), shoulder() + direction * length),
            "{name}"
        );
        assert_eq!(kept(&arm.joints, &angles).clamped, 0, "{name}");
    }
    for (name, direction) in [
        ("behind the back", Vec3::new(-0.5, -0.5, 0.7)),
        ("straight back", Vec3::Z),
        ("through the chest", Vec3::new(-1.0, -0.3, 0.0)),
        ("back and up", Vec3::new(0.2, 0.5, 0.8)),
    ] {
        assert!(!cone_contains(&arm, direction), "{name}");
        assert!(kept(&arm.joints, &pointing(&arm, direction.normalize())).clamped > 0);
    }
}

#[test]
fn the_shoulders_ends_are_the_tables() {
    let arm = limb(Limb::RightArm, HEIGHT_M);
    let level = |degrees: f32| {
        let angle = degrees.to_radians();
        Vec3::new(angle.cos(), 0.0, -angle.sin())
    };
    let range = ranges::SHOULDER_HORIZONTAL;
    for (end, inside) in [(range.low_deg, 1.0), (range.high_deg, -1.0)] {
        assert!(cone_contains(&arm, level(end + inside)), "{end}");
        assert!(!cone_contains(&arm, level(end - inside)), "{end}");
    }
    let back = |degrees: f32| {
        let angle = degrees.to_radians();
        Vec3::new(0.0, -angle.cos(), angle.sin())
    };
    assert!(cone_contains(&arm, back(59.0)) && !cone_contains(&arm, back(61.0)));
}

#[test]
fn zero_twist_of_a_raised_arm_is_where_the_text_says() {
    let arm = limb(Limb::RightArm, HEIGHT_M);
    let forearm = |direction: Vec3| {
        let mut angles = pointing(&arm, direction);
        let elbow = shoulder() + direction * (0.186 * HEIGHT_M);
        angles[3] = std::f32::consts::FRAC_PI_2;
        (tip(&arm, &angles) - elbow).normalize()
    };
    let (up, side) = 50_f32.to_radians().sin_cos();
    assert!(near(forearm(Vec3::X), Vec3::new(0.0, up, -side)));
    let (inward, up) = 40_f32.to_radians().sin_cos();
    assert!(near(forearm(Vec3::NEG_Z), Vec3::new(-inward, up, 0.0)));
}

#[test]
fn hinges_bend_the_right_way() {
    let arm = limb(Limb::RightArm, HEIGHT_M);
    let moved = |hinge: usize, angle: f32| {
        let mut angles = [0.0; 7];
        angles[hinge] = angle;
        tip(&arm, &angles) - tip(&arm, &[0.0; 7])
    };
    assert!(moved(3, 1.0).z < -0.1, "the elbow brings the hand forward");
    assert!(moved(5, 1.0).x < -0.1, "the wrist bends to the palm");
    assert!(moved(6, 0.3).z < -0.02, "radial deviation is to the thumb");
    let mut angles = [0.0; 7];
    angles[4] = 1.0;
    let thumb = last_link(&arm, &angles).quat() * Vec3::NEG_Z;
    assert!(thumb.x < -0.8, "pronation turns the thumb inward");
    angles = [0.0; 7];
    angles[2] = 1.0;
    angles[3] = 1.5;
    assert!(
        tip(&arm, &angles).x > tip(&arm, &[0.0; 7]).x + 0.2,
        "lateral rotation"
    );

    let leg = limb(Limb::RightLeg, HEIGHT_M);
    let moved = |hinge: usize, angle: f32| {
        let mut angles = [0.0; 6];
        angles[hinge] = angle;
        tip(&leg, &angles) - tip(&leg, &[0.0; 6])
    };
    assert!(moved(0, 0.5).z < -0.1, "hip flexion");
    assert!(moved(1, 0.5).x > 0.1, "hip abduction");
    assert!(moved(2, 0.5).x > 0.05, "lateral rotation of the hip");
    assert!(moved(3, 0.5).z > 0.1, "knee flexion");
    assert!(moved(4, 0.3).y > 0.05, "dorsiflexion");
    assert!(moved(5, 0.3).x < -0.01, "inversion");
}

#[test]
fn hips_bend_and_open_as_far_as_the_source_says() {
    let leg = limb(Limb::RightLeg, HEIGHT_M);
    let flexed = |degrees: f32| {
        let angle = degrees.to_radians();
        Vec3::new(0.0, -angle.cos(), -angle.sin())
    };
    let aside = |degrees: f32| {
        let angle = degrees.to_radians();
        Vec3::new(angle.sin(), -angle.cos(), 0.0)
    };
    let allowed = [flexed(119.0), flexed(-29.0), aside(44.0), aside(-29.0)];
    let refused = [flexed(126.0), flexed(-33.0), aside(52.0), aside(-35.0)];
    assert!(allowed.iter().all(|&d| cone_contains(&leg, d)));
    assert!(!refused.iter().any(|&d| cone_contains(&leg, d)));
}

#[test]
fn necks_and_spines_bend_as_far_as_the_source_says() {
    for (which, fore, back, side) in [
        (Limb::Neck, 45.0, 45.0, 45.0),
        (Limb::Spine, 80.0, 25.0, 35.0),
    ] {
        let def = limb(which, HEIGHT_M);
        let tilted = |degrees: f32, x: f32, z: f32| {
            let angle: f32 = degrees.to_radians();
            Vec3::new(x * angle.sin(), angle.cos(), z * angle.sin())
        };
        for (limit, x, z) in [
            (fore, 0.0, -1.0),
            (back, 0.0, 1.0),
            (side, 1.0, 0.0),
            (side, -1.0, 0.0),
        ] {
            assert!(cone_contains(&def, tilted(limit - 0.5, x, z)), "{which:?}");
            assert!(!cone_contains(&def, tilted(limit + 0.5, x, z)), "{which:?}");
        }
    }
}

#[test]
fn random_poses_are_kept_within_limits_once_and_for_all() {
    let mut random = Random(11);
    let mut outside = 0;
    for which in Limb::ALL {
        let def = limb(which, HEIGHT_M);
        let hinges = def.hinges();
        for _ in 0..500 {
            let wild: Vec<f32> = hinges
                .iter()
                .map(|_| random.between(-4.0, 4.0) as f32)
                .collect();
            let once = kept(&def.joints, &wild);
            for ball in balls_of(&def.joints) {
                let limb = limb_at(once.angles[ball.first], once.angles[ball.first + 1]);
                assert!(ball.cone.outside_rad(limb) < 1e-3);
                let wanted = limb_at(wild[ball.first], wild[ball.first + 1]);
                let away = (limb - wanted).length();
                let least = 2.0 * (0.5 * ball.cone.outside_rad(wanted)).sin();
                assert!(away < least + 1e-3, "{away} {least}");
                outside += u32::from(least > 0.0);
            }
            for (hinge, &angle) in hinges.iter().zip(&once.angles) {
                assert!(hinge.kept(angle) == angle);
            }
        }
    }
    assert!(outside > 1000);
}

#[test]
fn swings_and_turns_are_read_back() {
    let mut random = Random(13);
    for _ in 0..2000 {
        let limb = random.unit().as_vec3();
        let (a, b) = swing(limb);
        assert!((limb_at(a, b) - limb).length() < 1e-6);
        let (a, b) = swing_near(limb, 4.0);
        assert!((limb_at(a, b) - limb).length() < 1e-6);
        let angles = [
            random.between(-3.0, 3.0) as f32,
            random.between(-1.4, 1.4) as f32,
            random.between(-3.0, 3.0) as f32,
        ];
        let turn = Quat::from_rotation_x(angles[0])
            * Quat::from_rotation_y(angles[1])
            * Quat::from_rotation_z(angles[2]);
        for (got, wanted) in ball_angles(turn).into_iter().zip(angles) {
            assert!((got - wanted).abs() < 2e-5, "{got} {wanted}");
        }
    }
}

#[test]
fn a_body_without_a_spine_stands_the_same() {
    for which in [Limb::Neck, Limb::LeftArm, Limb::RightArm] {
        let (hung, rooted) = (limb(which, HEIGHT_M), limb_on_root(which, HEIGHT_M));
        assert_eq!((hung.base, rooted.base), (Base::Spine, Base::Root));
        let zero = vec![0.0; hung.hinges().len()];
        assert!(near(tip(&hung, &zero), tip(&rooted, &zero)));
    }
}

#[test]
fn any_height_gives_a_body() {
    for height in [f32::NAN, f32::INFINITY, -1.0, 0.0, 1e30, f32::NEG_INFINITY] {
        for which in Limb::ALL {
            let def = limb(which, height);
            assert!(def.joints.iter().all(|joint| joint.rest().is_finite()));
            assert!(def.tip.is_finite() && def.bones_m.iter().all(|&m| m > 0.0 && m < 2.0));
        }
    }
}

/// A straight finger along -Z with its middle joint bent by an angle.
fn straight_bones(bend_rad: f32) -> FingerBones {
    let bend = Quat::from_rotation_x(-bend_rad);
    let knuckle = Vec3::new(0.01, 0.0, -0.09);
    let middle = knuckle + Vec3::NEG_Z * 0.04;
    let last = middle + bend * Vec3::NEG_Z * 0.025;
    FingerBones {
        joints: [
            Pose::new(Quat::IDENTITY, knuckle),
            Pose::new(bend, middle),
            Pose::new(bend, last),
        ],
        tip: last + bend * Vec3::NEG_Z * 0.02,
    }
}

#[test]
fn fingers_rest_where_their_bones_are() {
    for which in Finger::ALL {
        let bones = straight_bones(0.2);
        let def = finger(which, &bones);
        assert_eq!(def.hinges.len(), if which == Finger::Thumb { 5 } else { 4 });
        let rest = posture(&def.hinges, &Pose::IDENTITY, &[0.0; 5]);
        for (&hinge, joint) in def.bones.iter().zip(bones.joints) {
            assert!(near(rest[hinge].link.translation(), joint.translation()));
            let turn = rest[hinge].link.quat().conjugate() * joint.quat();
            assert!(rotation_vector(turn).length() < 1e-6);
        }
        let tip = rest.last().unwrap().link.point(def.tip);
        assert!(near(tip, bones.tip));
        for hinge in &def.hinges {
            assert!(hinge.low_rad < hinge.high_rad);
            assert!(hinge.low_rad <= 0.0 && hinge.high_rad >= 0.0);
        }
    }
}

#[test]
fn fingers_bend_to_the_palm_and_keep_their_range_when_bent_at_rest() {
    let def = finger(Finger::Index, &straight_bones(0.2));
    let rest = posture(&def.hinges, &Pose::IDENTITY, &[0.0; 4]);
    let bent = posture(&def.hinges, &Pose::IDENTITY, &[0.0, 0.5, 0.5, 0.5]);
    let height = |links: &[palpable::geometry::chain::Placed]| links[3].link.point(def.tip).y;
    assert!(height(&bent) < height(&rest) - 0.03);
    let middle = def.hinges[2];
    assert!((middle.low_rad + 0.2).abs() < 1e-5);
    assert!((middle.high_rad - (100.0_f32.to_radians() - 0.2)).abs() < 1e-5);
    let backward = finger(Finger::Index, &straight_bones(-0.2)).hinges[2];
    assert_eq!(backward.low_rad, 0.0);
}

#[test]
fn joints_become_hinges_in_order() {
    let arm = limb(Limb::RightArm, HEIGHT_M);
    let hinges = hinges_of(&arm.joints);
    assert_eq!(hinges.len(), 7);
    assert_eq!(
        [hinges[0].axis, hinges[1].axis, hinges[2].axis],
        [Vec3::X, Vec3::Y, Vec3::Z]
    );
    assert_eq!(hinges[1].rest, Pose::IDENTITY);
    assert!(matches!(arm.joints[0], JointDef::Ball { .. }));
    assert_eq!(balls_of(&arm.joints)[0].first, 0);
    let two = [arm.joints[1], arm.joints[0]];
    assert_eq!(balls_of(&two)[0].first, 1);
}
