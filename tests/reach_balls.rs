//! Ball joints and soft goals in both solvers: cones kept, no flips, and compromises where they belong.

use std::f32::consts::{FRAC_PI_2, PI};

use glam::{Quat, Vec3};
use palpable::geometry::chain::{Ball, Hinge, posture};
use palpable::geometry::reach_cone::ReachCone;
use palpable::math::Pose;
use palpable::reach::cyclic_descent::cyclic_descent;
use palpable::reach::goal::{Goal, Reached, Task};
use palpable::reach::least_deviation::least_deviation;

#[path = "common/shapes.rs"]
mod shapes;

use shapes::Random;

/// How far a limb may be outside its cone, in radians.
const OUTSIDE_RAD: f32 = 1e-5;

type Solver = fn(&Task, &mut [f32], u32) -> Reached;

const SOLVERS: [(&str, Solver); 2] = [
    ("cyclic descent", cyclic_descent),
    ("least deviation", least_deviation),
];

fn hinge(at: Vec3, axis: Vec3, low_rad: f32, high_rad: f32) -> Hinge {
    Hinge {
        rest: Pose::new(Quat::IDENTITY, at),
        axis,
        low_rad,
        high_rad,
    }
}

/// A ball, an elbow and a wrist along Z.
fn arm(middle_rad: f32) -> [Hinge; 5] {
    [
        hinge(Vec3::ZERO, Vec3::X, -PI, PI),
        hinge(Vec3::ZERO, Vec3::Y, -middle_rad, middle_rad),
        hinge(Vec3::ZERO, Vec3::Z, -1.5, 1.5),
        hinge(Vec3::Z * 0.3, Vec3::X, -2.5, 0.0),
        hinge(Vec3::Z * 0.26, Vec3::Y, -1.0, 1.0),
    ]
}

const TIP: Vec3 = Vec3::new(0.0, 0.0, 0.08);

/// A cone about Z with corners at 0.5 to 1.2 rad: star-shaped, not convex.
fn cone(random: &mut Random) -> ReachCone {
    let corners: Vec<Vec3> = (0..8_u8)
        .map(|index| {
            let turn = PI * f32::from(index) / 4.0;
            let spread = random.between(0.5, 1.2) as f32;
            let aside = Vec3::new(turn.cos(), turn.sin(), 0.0);
            Vec3::Z * spread.cos() + aside * spread.sin()
        })
        .collect();
    ReachCone::new(Vec3::Z, &corners).unwrap()
}

fn oriented(q: &[f32]) -> Quat {
    Quat::from_rotation_x(q[0]) * Quat::from_rotation_y(q[1]) * Quat::from_rotation_z(q[2])
}

#[test]
fn both_pairs_of_angles_aim_the_limb() {
    let mut random = Random(3);
    let cone = cone(&mut random);
    let ball = Ball { first: 1, cone };
    for _ in 0..2000 {
        let mut angle = || random.between(-3.0, 3.0) as f32;
        let chain = [9.0, angle(), angle(), angle(), 9.0];
        let limb = random.unit().as_vec3();
        let both = ball.aimed(limb, &chain);
        for own in both {
            let found = ball.limb(&[0.0, own[0], own[1], own[2]]);
            assert!((found - limb).length() < 2e-6, "{found} {limb}");
        }
        // The other pair with its twist is the same orientation.
        let turn = oriented(&both[0]).dot(oriented(&both[1])).abs();
        assert!(turn > 1.0 - 1e-5, "{both:?}");
        // The limb where it is asks for no change.
        let [same, _] = ball.aimed(ball.limb(&chain), &chain);
        for (a, b) in same.iter().zip(&chain[1..4]) {
            assert!((a - b).abs() < 1e-3, "{same:?} {chain:?}");
        }
    }
}

#[test]
fn poles_keep_the_first_angle() {
    let ball = Ball {
        first: 0,
        cone: cone(&mut Random(4)),
    };
    for a in [-2.0, 0.3, 3.0] {
        for (limb, b) in [(Vec3::X, FRAC_PI_2), (Vec3::NEG_X, -FRAC_PI_2)] {
            let [near, _] = ball.aimed(limb, &[a, 0.9 * b, 0.2]);
            assert!((near[0] - a).abs() < 1e-6 && (near[1] - b).abs() < 1e-6);
            // Past the pole the limb comes back on the other side, and nothing flips.
            let past = [a, 1.1 * b, 0.2];
            let [near, _] = ball.aimed(ball.limb(&past), &[a, 0.95 * b, 0.2]);
            assert!((near[0] - a).abs() < 1e-5 && (near[1] - 1.1 * b).abs() < 1e-5);
        }
    }
}

#[test]
fn kept_takes_the_limb_into_the_cone_and_rests_there() {
    let mut random = Random(5);
    for _ in 0..300 {
        let ball = Ball {
            first: 0,
            cone: cone(&mut random),
        };
        let mut q = [0; 3].map(|_| random.between(-3.0, 3.0) as f32);
        let before = ball.limb(&q);
        let nearest = ball.cone.nearest(before);
        ball.kept(&mut q);
        assert!(ball.outside_rad(&q) <= OUTSIDE_RAD);
        assert!((ball.limb(&q) - nearest).length() < 1e-5);
        let once = q;
        ball.kept(&mut q);
        assert_eq!(q, once);
    }
    let mut short = [0.5; 2];
    let ball = Ball {
        first: 0,
        cone: cone(&mut random),
    };
    ball.kept(&mut short);
    assert_eq!(short, [0.5; 2]);
}

/// Goals anywhere, in reach and out of it: every posture on the way is allowed.
#[test]
fn no_posture_leaves_a_cone_or_a_range() {
    let mut random = Random(6);
    for round in 0..300 {
        let hinges = arm(if round % 2 == 0 { FRAC_PI_2 } else { PI });
        let balls = [Ball {
            first: 0,
            cone: cone(&mut random),
        }];
        let wanted = hinges.map(|h| random.between(h.low_rad.into(), h.high_rad.into()) as f32);
        let place = random.unit().as_vec3() * random.between(0.1, 0.8) as f32;
        let mut goals = Goal::place(4, TIP, place);
        if round % 3 == 0 {
            goals = goals.map(|goal| Goal {
                softness: 1e-3,
                ..goal
            });
        }
        let task = Task {
            hinges: &hinges,
            balls: &balls,
            root: Pose::IDENTITY,
            wanted: &wanted,
            goals: &goals,
            tolerance_m: 1e-3,
        };
        for (name, solve) in SOLVERS {
            let mut q = wanted;
            for steps in [0, 1, 1, 2, 4, 8, 32] {
                solve(&task, &mut q, steps);
                let outside = balls[0].outside_rad(&q);
                assert!(outside <= OUTSIDE_RAD, "{name}: {outside}");
                for (hinge, angle) in hinges.iter().zip(&q) {
                    assert!((hinge.low_rad..=hinge.high_rad).contains(angle), "{name}");
                }
            }
        }
    }
}

/// A limb that is asked out of its cone slides along the boundary to its nearest point.
#[test]
fn the_optimum_slides_along_the_cone() {
    let mut random = Random(7);
    let mut farthest = 0.0_f32;
    for _ in 0..200 {
        let corners = [0.0_f32, 1.3, 2.6, 3.9, 5.2].map(|turn| {
            let spread = random.between(0.5, 1.0) as f32;
            let aside = Vec3::new(turn.cos(), turn.sin(), 0.0);
            Vec3::Z * spread.cos() + aside * spread.sin()
        });
        let balls = [Ball {
            first: 0,
            cone: ReachCone::new(Vec3::Z, &corners).unwrap(),
        }];
        let hinges = &arm(FRAC_PI_2)[..3];
        let aim = (random.unit().as_vec3() + Vec3::Z * 1.2).normalize();
        let goals = Goal::place(2, Vec3::Z * 0.3, aim * 0.3);
        let wanted = [0.1, 0.0, 0.0];
        let task = Task {
            hinges,
            balls: &balls,
            root: Pose::IDENTITY,
            wanted: &wanted,
            goals: &goals,
            tolerance_m: 1e-4,
        };
        let nearest = balls[0].cone.nearest(aim);
        let mut q = wanted;
        least_deviation(&task, &mut q, 64);
        let off = balls[0].limb(&q).angle_between(aim) - nearest.angle_between(aim);
        farthest = farthest.max(off);
    }
    assert!(farthest < 0.02, "{farthest} rad");
}

/// The tip softly held at a tracker 150 mm inside a wall: it ends at the tracker's projection.
#[test]
fn soft_places_yield_to_hard_planes() {
    let hinges = [
        hinge(Vec3::ZERO, Vec3::X, -2.8, 2.8),
        hinge(Vec3::ZERO, Vec3::Y, -2.8, 2.8),
        hinge(Vec3::ZERO, Vec3::Z, -2.5, 2.5),
        hinge(Vec3::Z * 0.3, Vec3::X, -2.5, 0.0),
        hinge(Vec3::Z * 0.26, Vec3::X, -1.2, 1.2),
        hinge(Vec3::ZERO, Vec3::Y, -1.0, 1.0),
    ];
    let mut random = Random(8);
    for round in 0..60 {
        let softness = [1e-5, 3e-5, 1e-4][round % 3];
        let mut angle = |low: f64, high: f64| random.between(low, high) as f32;
        let wanted = [
            angle(-0.8, 0.8),
            angle(-0.8, 0.8),
            angle(-0.5, 0.5),
            angle(-1.8, -1.0),
            angle(-0.4, 0.4),
            angle(-0.4, 0.4),
        ];
        let tracker = posture(&hinges, &Pose::IDENTITY, &wanted)[5]
            .link
            .point(TIP);
        // The wall pushes toward the shoulder, so that its surface is in reach.
        let normal = (random.unit().as_vec3() * 0.5 - tracker.normalize()).normalize();
        let height_m = normal.dot(tracker) + 0.15;
        let wall = Goal {
            link: 5,
            point: TIP,
            normal,
            height_m,
            is_exact: false,
            softness: 0.0,
        };
        let mut goals = vec![wall];
        goals.extend(Goal::place(5, TIP, tracker).map(|goal| Goal { softness, ..goal }));
        let task = Task {
            hinges: &hinges,
            balls: &[],
            root: Pose::IDENTITY,
            wanted: &wanted,
            goals: &goals,
            tolerance_m: 1e-4,
        };
        let projection = tracker + normal * 0.15;
        for (name, solve) in SOLVERS {
            let mut q = wanted;
            let found = solve(&task, &mut q, 64);
            let tip = posture(&hinges, &Pose::IDENTITY, &q)[5].link.point(TIP);
            assert!(found.missed_m <= 1e-4, "{name} {round}: {found:?}");
            // The descent's postures meet the wall; it does not weigh the change against the place.
            if name == "least deviation" {
                let off = (tip - projection).length();
                assert!(off < 1e-3, "{round} softness {softness}: {off} m");
            }
        }
    }
}

/// With nothing hard in the way the compromise is the one of the two weights.
#[test]
fn softness_weighs_the_place_against_the_angles() {
    let hinges = [hinge(Vec3::ZERO, Vec3::Z, -2.0, 2.0)];
    for softness in [1e-5, 1e-4, 1e-3, 1e-2_f32] {
        let goal = Goal {
            link: 0,
            point: Vec3::X * 0.1,
            normal: Vec3::Y,
            height_m: 0.01,
            is_exact: true,
            softness,
        };
        let task = Task {
            hinges: &hinges,
            balls: &[],
            root: Pose::IDENTITY,
            wanted: &[0.0],
            goals: &[goal],
            tolerance_m: 1e-6,
        };
        let mut q = [0.0];
        let found = least_deviation(&task, &mut q, 16);
        assert_eq!(found.missed_m, 0.0);
        // q + (0.1 sin q - 0.01) 0.1 cos q / softness = 0.
        let mut exact = 0.0_f64;
        for _ in 0..50 {
            let (sin, cos) = exact.sin_cos();
            let s = f64::from(softness);
            let slope = exact + (0.1 * sin - 0.01) * 0.1 * cos / s;
            exact -= slope / (1.0 + 0.01 * cos * cos / s);
        }
        let off = (f64::from(q[0]) - exact).abs();
        assert!(off < 1e-3 * exact, "{softness}: {} {exact}", q[0]);
    }
}
