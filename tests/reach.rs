//! Solvers of chains: analytic cases, the optimum in f64 found another way, limits, rest.

use glam::{DQuat, DVec3, Quat, Vec3};
use palpable::geometry::chain::{Hinge, posture};
use palpable::math::Pose;
use palpable::reach::cyclic_descent::cyclic_descent;
use palpable::reach::goal::{Goal, Reached, Task};
use palpable::reach::least_deviation::{least_deviation, least_deviation_following};

#[path = "common/shapes.rs"]
mod shapes;

use shapes::Random;

const TOLERANCE_M: f32 = 1e-3;

fn hinge(at: Vec3, axis: Vec3, low_rad: f32, high_rad: f32) -> Hinge {
    Hinge {
        rest: Pose::new(Quat::IDENTITY, at),
        axis,
        low_rad,
        high_rad,
    }
}

/// Two links in a plane, 0.30 m and 0.26 m.
fn planar(low_rad: f32, high_rad: f32) -> [Hinge; 2] {
    let second = hinge(Vec3::X * 0.30, Vec3::Z, low_rad, high_rad);
    [hinge(Vec3::ZERO, Vec3::Z, low_rad, high_rad), second]
}

/// A shoulder of three hinges, an elbow, a forearm's twist, a wrist of two; the hand's tip is 80 mm on.
fn arm() -> [Hinge; 7] {
    let (upper, fore) = (Vec3::NEG_Y * 0.30, Vec3::NEG_Y * 0.26);
    [
        hinge(Vec3::ZERO, Vec3::X, -2.8, 1.0),
        hinge(Vec3::ZERO, Vec3::Z, -0.5, 2.8),
        hinge(Vec3::ZERO, Vec3::Y, -1.5, 1.5),
        hinge(upper, Vec3::X, -2.5, 0.0),
        hinge(Vec3::ZERO, Vec3::Y, -1.4, 1.4),
        hinge(fore, Vec3::X, -1.2, 1.2),
        hinge(Vec3::ZERO, Vec3::Z, -0.4, 0.6),
    ]
}

const TIP: Vec3 = Vec3::new(0.0, -0.08, 0.0);

fn random_angles(random: &mut Random, hinges: &[Hinge], margin: f64) -> Vec<f32> {
    let within = |h: &Hinge| {
        let (low, high) = (f64::from(h.low_rad), f64::from(h.high_rad));
        random.between(low + margin * (high - low), high - margin * (high - low)) as f32
    };
    hinges.iter().map(within).collect()
}

/// Goals of a chain that begins at the origin.
fn task<'a>(hinges: &'a [Hinge], wanted: &'a [f32], goals: &'a [Goal]) -> Task<'a> {
    Task {
        hinges,
        balls: &[],
        root: Pose::IDENTITY,
        wanted,
        goals,
        tolerance_m: TOLERANCE_M,
    }
}

/// A plane that a point of a random far link is 10 to 80 mm behind.
fn push(random: &mut Random, hinges: &[Hinge], wanted: &[f32]) -> Goal {
    let link = [3, 4, 6, 6][(random.bits() % 4) as usize];
    let point = TIP * random.between(0.2, 1.0) as f32;
    let normal = random.unit().as_vec3();
    let at = posture(hinges, &Pose::IDENTITY, wanted)[link]
        .link
        .point(point);
    let height_m = normal.dot(at) + random.between(0.01, 0.08) as f32;
    Goal {
        link,
        point,
        normal,
        height_m,
        is_exact: false,
        softness: 0.0,
    }
}

/// The goal's point and the derivatives of its height, in f64.
fn height_and_row(hinges: &[Hinge], q: &[f64], goal: &Goal) -> (f64, Vec<f64>) {
    let (mut turn, mut at) = (DQuat::IDENTITY, DVec3::ZERO);
    let mut joints = vec![];
    for (hinge, &angle) in hinges.iter().zip(q).take(goal.link + 1) {
        at += turn * hinge.rest.translation().as_dvec3();
        let axis = turn * hinge.axis.as_dvec3();
        joints.push((at, axis));
        turn = DQuat::from_axis_angle(axis, angle) * turn;
    }
    let normal = goal.normal.as_dvec3();
    let point = at + turn * goal.point.as_dvec3();
    let mut row = vec![0.0; q.len()];
    for (slot, (at, axis)) in row.iter_mut().zip(joints) {
        *slot = normal.dot(axis.cross(point - at));
    }
    (normal.dot(point) - f64::from(goal.height_m), row)
}

/// The least change that meets one goal: where the pull of a force on the joints, limits kept, holds the
/// point on the plane. The force is found by bisection. `None` when no force is enough.
fn optimum(hinges: &[Hinge], wanted: &[f32], goal: &Goal) -> Option<f64> {
    let held = |force: f64| {
        let mut q: Vec<f64> = wanted.iter().map(|&w| f64::from(w)).collect();
        for _ in 0..80 {
            let (_, row) = height_and_row(hinges, &q, goal);
            for (j, hinge) in hinges.iter().enumerate() {
                let pulled = f64::from(wanted[j]) + force * row[j];
                let kept = pulled.clamp(hinge.low_rad.into(), hinge.high_rad.into());
                q[j] += 0.5 * (kept - q[j]);
            }
        }
        q
    };
    let (mut low, mut high) = (0.0, 4.0);
    if height_and_row(hinges, &held(high), goal).0 < 0.0 {
        return None;
    }
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        let met = height_and_row(hinges, &held(middle), goal).0 >= 0.0;
        (low, high) = if met { (low, middle) } else { (middle, high) };
    }
    Some(change(&held(high), wanted))
}

fn change(q: &[f64], wanted: &[f32]) -> f64 {
    let squares = q
        .iter()
        .zip(wanted)
        .map(|(q, &w)| (q - f64::from(w)).powi(2));
    squares.sum::<f64>().sqrt()
}

fn within(hinges: &[Hinge], angles: &[f32]) -> bool {
    let fits = |(h, &q): (&Hinge, &f32)| (h.low_rad..=h.high_rad).contains(&q);
    hinges.iter().zip(angles).all(fits)
}

type Solver = fn(&Task, &mut [f32], u32) -> Reached;

const SOLVERS: [(&str, Solver); 2] = [
    ("cyclic descent", cyclic_descent),
    ("least deviation", least_deviation),
];

#[test]
fn two_links_reach_the_analytic_angles() {
    let hinges = planar(-3.0, 3.0);
    let goals = Goal::place(1, Vec3::X * 0.26, Vec3::new(0.4, 0.2, 0.0));
    for (name, solve) in SOLVERS {
        let wanted = [0.2, 0.8];
        let task = Task {
            tolerance_m: 1e-6,
            ..task(&hinges, &wanted, &goals[..2])
        };
        let mut angles = wanted;
        let found = solve(&task, &mut angles, 400);
        assert!(found.missed_m <= 1e-6, "{name}: {found:?}");
        let off = [angles[0] + 0.130_125, angles[1] - 1.295_538_7];
        assert!(off.iter().all(|x| x.abs() < 2e-5), "{name}: {angles:?}");
    }
}

#[test]
fn pushes_are_solved_in_few_steps_near_the_optimum() {
    let hinges = arm();
    let mut random = Random(7);
    let mut solved = [[0; 4]; 2];
    let (mut reachable, mut ratios) = (0, vec![]);
    while reachable < 2000 {
        let wanted = random_angles(&mut random, &hinges, 0.1);
        let goal = push(&mut random, &hinges, &wanted);
        let Some(least) = optimum(&hinges, &wanted, &goal) else {
            continue;
        };
        reachable += 1;
        let goals = [goal];
        let task = task(&hinges, &wanted, &goals);
        for (place, (_, solve)) in SOLVERS.into_iter().enumerate() {
            for (column, steps) in [2, 4, 8, 64].into_iter().enumerate() {
                let mut angles = wanted.clone();
                let found = solve(&task, &mut angles, steps);
                assert!(found.steps <= steps && within(&hinges, &angles));
                solved[place][column] += u32::from(found.missed_m <= TOLERANCE_M);
                if place == 1 && steps == 64 {
                    let q: Vec<f64> = angles.iter().map(|&q| q.into()).collect();
                    ratios.push(change(&q, &wanted) / least);
                }
            }
        }
    }
    ratios.sort_by(f64::total_cmp);
    let p95 = ratios[ratios.len() * 95 / 100];
    println!("solved of {reachable} after 2, 4, 8, 64 steps: {solved:?}");
    println!(
        "change / optimum: median {}, p95 {p95}",
        ratios[ratios.len() / 2]
    );
    let [_, least] = solved;
    assert!(
        least[0] >= 1900 && least[1] >= 1998 && least[3] == 2000,
        "{least:?}"
    );
    assert!(p95 < 1.03, "{p95}");
}

#[test]
fn what_touches_nothing_costs_nothing() {
    let hinges = arm();
    let mut random = Random(8);
    let wanted = random_angles(&mut random, &hinges, 0.0);
    let mut goal = push(&mut random, &hinges, &wanted);
    goal.height_m -= 0.2;
    let goals = [goal];
    let task = task(&hinges, &wanted, &goals);
    for (name, solve) in SOLVERS {
        let mut angles = wanted.clone();
        let found = solve(&task, &mut angles, 8);
        assert_eq!((found.steps, found.missed_m), (0, 0.0), "{name}");
        assert_eq!(angles, wanted, "{name}");
    }
    // Coming back from somewhere else ends at the tracked angles to the bit.
    let mut angles = random_angles(&mut random, &hinges, 0.3);
    least_deviation(&task, &mut angles, 16);
    assert_eq!(angles, wanted);
}

/// A push that no joint can answer does not keep the joints from their tracked angles, nor from other pushes.
#[test]
fn what_cannot_be_met_keeps_no_joint_from_what_can() {
    let hinges = planar(-2.0, 2.0);
    let wanted = [0.5, -0.3];
    let tip = Vec3::X * 0.26;
    let goal = |link: usize, normal: Vec3, height_m: f32| Goal {
        link,
        point: tip,
        normal,
        height_m,
        is_exact: false,
        softness: 0.0,
    };
    // Across the plane in which the links turn.
    for short_m in [1e-5, 1e-3, 3e-2] {
        let aside = goal(1, Vec3::Z, short_m);
        let mut angles = [0.0, 0.0];
        let found = least_deviation_following(&task(&hinges, &wanted, &[aside]), &mut angles, 10);
        assert!((found.missed_m - short_m).abs() < 1e-6, "{found:?}");
        assert!(found.steps <= 4, "{found:?}");
        assert_eq!(angles, wanted, "{short_m}");

        let push = goal(1, Vec3::Y, 0.25);
        let mut alone = [0.0, 0.0];
        let one = least_deviation_following(&task(&hinges, &wanted, &[push]), &mut alone, 20);
        assert!(
            one.missed_m <= TOLERANCE_M && alone[0] > wanted[0],
            "{alone:?}"
        );
        let mut both = [0.0, 0.0];
        let goals = [push, aside];
        let found = least_deviation_following(&task(&hinges, &wanted, &goals), &mut both, 20);
        assert!((found.missed_m - short_m).abs() < 1e-6 || short_m < TOLERANCE_M);
        let height_m = hinges_tip_y(&hinges, &both);
        assert!(height_m > 0.25 - 1.1 * TOLERANCE_M, "{height_m}");
        let off: f32 = alone.iter().zip(both).map(|(a, b)| (a - b).abs()).sum();
        assert!(off < 1e-2, "{alone:?} {both:?}");
    }
    // The first hinge is at its end, the second one is free.
    let stiff = [hinge(Vec3::ZERO, Vec3::Z, -0.1, 0.0), hinges[1]];
    let push = Goal {
        point: Vec3::X * 0.3,
        ..goal(0, Vec3::Y, 0.01)
    };
    let mut angles = [-0.05, 0.0];
    let found = least_deviation_following(&task(&stiff, &[-0.05, 0.4], &[push]), &mut angles, 10);
    let slack_rad = TOLERANCE_M / 0.3;
    assert!(angles[0].abs() < slack_rad, "{angles:?} {found:?}");
    assert!((angles[1] - 0.4).abs() < 1e-3, "{angles:?} {found:?}");
    assert!((found.missed_m - 0.01).abs() < TOLERANCE_M, "{found:?}");
}

fn hinges_tip_y(hinges: &[Hinge], angles: &[f32]) -> f32 {
    posture(hinges, &Pose::IDENTITY, angles)[1]
        .link
        .point(Vec3::X * 0.26)
        .y
}

#[test]
fn out_of_reach_limits_hold_and_nothing_oscillates() {
    let hinges = arm();
    let mut random = Random(9);
    for round in 0..200 {
        let wanted = random_angles(&mut random, &hinges, 0.0);
        let far = [0.0, 0.9, 3.0, 1000.0][round % 4];
        let goals = Goal::place(6, TIP, random.unit().as_vec3() * far);
        let task = task(&hinges, &wanted, &goals);
        for (name, solve) in SOLVERS {
            let mut angles = wanted.clone();
            let distance = |angles: &[f32]| {
                let tip = posture(&hinges, &Pose::IDENTITY, angles)[6].link.point(TIP);
                let place = goals.map(|goal| goal.height_m);
                (tip - Vec3::from_array(place)).length()
            };
            let mut before = distance(&angles);
            for _ in 0..20 {
                let found = solve(&task, &mut angles, 4);
                assert!(within(&hinges, &angles), "{name}: {angles:?}");
                assert!(found.missed_m.is_finite(), "{name}");
                let after = distance(&angles);
                if name == "least deviation" {
                    let worse = after - before.max(TOLERANCE_M);
                    assert!(worse <= 0.0, "{worse} worse");
                }
                before = after;
            }
            let mut again = wanted.clone();
            for _ in 0..20 {
                solve(&task, &mut again, 4);
            }
            assert_eq!(again, angles, "{name}");
        }
    }
}

#[test]
fn straight_arms_and_links_without_length_stay_finite() {
    let hinges = [
        hinge(Vec3::ZERO, Vec3::Z, -2.0, 2.0),
        hinge(Vec3::X * 0.3, Vec3::Z, -2.0, 2.0),
        hinge(Vec3::ZERO, Vec3::Z, -2.0, 2.0),
    ];
    for place in [Vec3::ZERO, Vec3::X * 0.2, Vec3::X * 0.56, Vec3::Z * 0.1] {
        let goals = Goal::place(2, Vec3::X * 0.26, place);
        let wanted = [0.0; 3];
        let task = task(&hinges, &wanted, &goals);
        for (name, solve) in SOLVERS {
            let mut angles = wanted;
            let found = solve(&task, &mut angles, 50);
            assert!(
                found.missed_m.is_finite() && within(&hinges, &angles),
                "{name}"
            );
        }
    }
}

#[test]
fn a_place_out_of_reach_is_followed_in_a_step_a_frame() {
    let hinges = arm();
    let wanted = [-0.6, 0.3, 0.2, -1.0, 0.1, 0.0, 0.0];
    let mut angles = wanted;
    let (mut steps, frames) = (0, 200);
    for frame in 0..frames {
        let aside = 0.002 * frame as f32;
        let place = Vec3::new(0.1 + aside, -0.36, 0.85);
        let goals = Goal::place(6, TIP, place).map(|goal| Goal {
            softness: 1e-5,
            ..goal
        });
        let first = if frame == 0 { 64 } else { 4 };
        let found = least_deviation(&task(&hinges, &wanted, &goals), &mut angles, first);
        steps += if frame == 0 { 0 } else { found.steps };
        assert!(within(&hinges, &angles), "{frame}: {angles:?}");
        // The stretched arm is 640 mm long, and on the straight line to the place.
        let nearest = place.normalize() * 0.64;
        let placed = posture(&hinges, &Pose::IDENTITY, &angles);
        let off_m = (placed[6].link.point(TIP) - nearest).length();
        assert!(off_m < 5e-4, "{frame}: {off_m} m off");
    }
    assert!(steps <= frames * 3 / 2, "{steps} steps in {frames} frames");
}

#[test]
fn points_along_a_straight_arm_are_pushed_without_a_swing() {
    // Their rows are nearly parallel, and the elbow is at its limit.
    let mut random = Random(7);
    let hinges = arm();
    for case in 0..2000 {
        let mut at = random_angles(&mut random, &hinges, 0.2);
        for angle in &mut at[3..] {
            *angle = 0.0;
        }
        let near = |angle: &f32| angle + random.between(-0.02, 0.02) as f32;
        let mut wanted: Vec<f32> = at.iter().map(near).collect();
        wanted[3] = 0.0;
        let placed = posture(&hinges, &Pose::IDENTITY, &at);
        let along = placed[6].link.point(TIP).normalize();
        let mut across = || along.cross(random.unit().as_vec3()).normalize();
        let (normal, other) = (across(), across());
        let other = (normal + 0.3 * other).normalize();
        let pushed = |link: usize, point: Vec3, normal: Vec3, by_m: f32| Goal {
            link,
            point,
            normal,
            height_m: normal.dot(placed[link].link.point(point)) + by_m,
            is_exact: false,
            softness: 0.0,
        };
        let goals = [
            pushed(3, Vec3::NEG_Y * 0.007, normal, 2e-5),
            pushed(6, TIP, other, -1e-6),
            pushed(3, Vec3::NEG_Y * 0.24, normal, 2e-5),
        ];
        let task = Task {
            tolerance_m: 2e-6,
            ..task(&hinges, &wanted, &goals)
        };
        let mut angles = at.clone();
        let found = least_deviation(&task, &mut angles, 16);
        assert!(found.missed_m <= 2e-6, "{case}: {found:?}");
        // The tracked angles are 0.02 rad away.
        let turned = angles.iter().zip(&at).map(|(a, b)| (a - b).abs());
        let turned = turned.fold(0.0, f32::max);
        assert!(turned <= 0.06, "{case}: {turned} rad");
    }
}

/// At right angles to its fork a universal joint's point goes sideways by the product of two angles: no joint
/// lifts it alone, and the slope says next to nothing.
#[test]
fn a_point_on_a_saddle_climbs_with_two_joints_at_once() {
    const LENGTH_M: f32 = 0.3;
    let fork = 0.5 * core::f32::consts::PI;
    let hinges = [
        hinge(Vec3::ZERO, Vec3::X, -1.2, 1.2),
        hinge(Vec3::ZERO, Vec3::Z, 0.0, 2.8),
    ];
    let tip = Vec3::NEG_Y * LENGTH_M;
    for (a, b) in [(0.01, 0.02), (-0.02, -0.01), (0.0, 0.03), (0.02, 0.0)] {
        let wanted = [a, fork + b];
        let goals = [Goal {
            link: 1,
            point: tip,
            normal: Vec3::Z,
            height_m: 0.04,
            is_exact: false,
            softness: 0.0,
        }];
        let task = task(&hinges, &wanted, &goals);
        let mut angles = wanted;
        let reached = least_deviation(&task, &mut angles, 2);
        assert!(reached.missed_m <= TOLERANCE_M, "{a} {b}: {reached:?}");
        // A chain that follows its tracker does as much for a push as deep as that.
        let mut followed = wanted;
        let reached = least_deviation_following(&task, &mut followed, 2);
        assert!(reached.missed_m <= TOLERANCE_M, "{a} {b}: {reached:?}");
        assert_eq!(followed, angles);
        // Height is length sin a sin b; both turn the same way to raise it.
        let least = (1..10_000).map(|step| {
            let to_a = f64::from(step) * 1.2e-4;
            let to_b = (0.04 / (f64::from(LENGTH_M) * to_a.sin())).min(1.0).asin();
            [1.0, -1.0].map(|sign| (sign * to_a - f64::from(a)).hypot(sign * to_b - f64::from(b)))
        });
        let least = least.flatten().fold(f64::INFINITY, f64::min);
        let found = change(&angles.map(f64::from), &wanted);
        assert!(
            found <= 1.01 * least,
            "{a} {b}: {found} rad, {least} would do"
        );
    }
}
