//! Skeletons in a world: free motion, arms at walls, links that meet each other, budgets, bad input.

mod common;

use common::{Block, add_box};
use glam::{DQuat, DVec3, Quat, Vec3};
use palpable::frame::{Budget, FrameInput, FrameReport};
use palpable::geometry::chain::{Hinge, JointDef};
use palpable::limits::OVERLAP_SLOP_M;
use palpable::math::Pose;
use palpable::memory::{BodyId, Capacities, ChainId};
use palpable::state::bodies::BodyKind;
use palpable::state::chains::ChainOptions;
use palpable::state::pieces::Groups;
use palpable::world::{BodyDef, ChainDef, PieceDef, Shape, World};

const FRAME_S: f32 = 1.0 / 90.0;
const RADIUS_M: f32 = 0.04;

fn hinge(at: Vec3, axis: Vec3, low_rad: f32, high_rad: f32) -> JointDef {
    JointDef::Hinge(Hinge {
        rest: Pose::new(Quat::IDENTITY, at),
        axis,
        low_rad,
        high_rad,
    })
}

const UPPER: Vec3 = Vec3::new(0.0, -0.30, 0.0);
const FORE: Vec3 = Vec3::new(0.0, -0.26, 0.0);
const HAND: Vec3 = Vec3::new(0.0, -0.10, 0.0);

/// A shoulder of three hinges, an elbow, a forearm's twist, a wrist of two, hanging down.
fn arm_joints() -> [JointDef; 7] {
    [
        hinge(Vec3::ZERO, Vec3::X, -1.0, 2.8),
        hinge(Vec3::ZERO, Vec3::Z, -2.8, 2.8),
        hinge(Vec3::ZERO, Vec3::Y, -1.5, 1.5),
        hinge(UPPER, Vec3::X, 0.0, 2.5),
        hinge(Vec3::ZERO, Vec3::Y, -1.4, 1.4),
        hinge(FORE, Vec3::X, -1.2, 1.2),
        hinge(Vec3::ZERO, Vec3::Z, -0.6, 0.6),
    ]
}

fn capsule(to: Vec3) -> PieceDef<'static> {
    PieceDef::new(Shape::Segment([0.0; 3], to.to_array()), RADIUS_M)
}

/// The links with pieces, and the far ends of their segments.
const LINKS: [(u32, Vec3); 3] = [(2, UPPER), (4, FORE), (6, HAND)];

/// An arm that hangs on a driven body without pieces of its own.
fn add_arm(world: &mut World, shoulder: Pose, options: ChainOptions) -> (BodyId, ChainId) {
    let body = world
        .add_body(&BodyDef::new(BodyKind::Driven, shoulder))
        .unwrap();
    let def = ChainDef {
        joints: &arm_joints(),
        base: None,
        options,
    };
    let chain = world.add_chain(body, &def).unwrap();
    for (link, to) in LINKS {
        world.add_link_piece(chain, link, &capsule(to)).unwrap();
    }
    world.set_target(body, &shoulder).unwrap();
    (body, chain)
}

/// Where arms hang.
const SHOULDER: Pose = Pose::at(0.0, 1.4, 0.0);

/// An arm that hangs there, before a wall whose face is at z = -0.45.
fn add_arm_at_wall(world: &mut World, options: ChainOptions) -> (BodyId, ChainId) {
    let wall = Pose::at(0.0, 1.2, -0.55);
    add_box(world, BodyKind::Fixed, wall, [2.0, 2.0, 0.1]);
    add_arm(world, SHOULDER, options)
}

/// Angles with which the arm swings forward and becomes straight: from bent and hanging at 0 to the hand 0.2 m behind the
/// wall's face at 1.
fn swung(s: f32) -> [f32; 7] {
    let elbow = 0.25 * (1.0 - s) + 0.05;
    [1.5 * s, 0.1 * s, 0.0, elbow, 0.0, 0.0, 0.0]
}

/// From 0 to 1 and with no speed at either end.
fn eased(t: f32) -> f32 {
    0.5 - 0.5 * (t * core::f32::consts::PI).cos()
}

/// The largest turn of a joint between two postures.
fn most_turned(a: &[f32], b: &[f32]) -> f32 {
    a.iter()
        .zip(b)
        .fold(0.0, |most, (a, b)| most.max((a - b).abs()))
}

/// Ends of the arm's segments in double precision, from the published angles alone.
fn ends(world: &World, body: BodyId, chain: ChainId) -> Vec<DVec3> {
    ends_at(&world.pose(body).unwrap(), world.angles(chain).unwrap())
}

fn ends_at(root: &Pose, angles: &[f32]) -> Vec<DVec3> {
    let mut turn = DQuat::from_array(root.rotation.map(f64::from)).normalize();
    let mut at = DVec3::from_array(root.position.map(f64::from));
    let mut found = vec![];
    for (index, (joint, &angle)) in arm_joints().iter().zip(angles).enumerate() {
        let JointDef::Hinge(hinge) = joint else {
            unreachable!()
        };
        at += turn * hinge.rest.translation().as_dvec3();
        turn *= DQuat::from_axis_angle(hinge.axis.as_dvec3(), f64::from(angle));
        for (link, to) in LINKS {
            if link as usize == index {
                found.extend([at, at + turn * to.as_dvec3()]);
            }
        }
    }
    found
}

fn step(world: &mut World, body: BodyId, root: &Pose) -> FrameReport {
    world.set_target(body, root).unwrap();
    world.step(&FrameInput::unlimited(FRAME_S))
}

/// How deep the arm is behind the plane z = `wall`, in metres; the wall is on the side of -Z.
fn depth_m(world: &World, body: BodyId, chain: ChainId, wall: f64) -> f64 {
    deepest_m(&ends(world, body, chain), wall)
}

fn deepest_m(ends: &[DVec3], wall: f64) -> f64 {
    let lowest = ends.iter().fold(f64::INFINITY, |low, end| low.min(end.z));
    wall - (lowest - f64::from(RADIUS_M))
}

#[test]
fn an_arm_at_a_wall_stays_outside() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let (body, chain) = add_arm_at_wall(&mut world, ChainOptions::DEFAULT);
    let mut before = vec![0.0, 0.0, 0.0, 0.3, 0.0, 0.0, 0.0];
    world.place_angles(chain, &before).unwrap();
    let (mut deepest, mut jump, mut steps) = (f64::NEG_INFINITY, 0.0_f32, 0);
    for frame in 0..400 {
        let angles = swung(eased((frame as f32 / 180.0).min(1.0)));
        world.set_angles(chain, &angles).unwrap();
        let report = step(&mut world, body, &SHOULDER);
        deepest = deepest.max(depth_m(&world, body, chain, -0.45));
        let now = world.angles(chain).unwrap().to_vec();
        for (a, b) in now.iter().zip(&before) {
            jump = jump.max((a - b).abs());
        }
        steps += report.reach_steps;
        before = now;
    }
    assert!(deepest <= f64::from(OVERLAP_SLOP_M), "{deepest} m");
    assert!(deepest > -1e-3, "the arm comes to the wall: {deepest} m");
    assert!(steps > 0 && jump < 3.0_f32.to_radians(), "{steps} {jump}");
    assert_eq!(world.pose(body).unwrap(), SHOULDER);
}

/// Schmidl and Lin 2004, figure 7: the method of the paper does most where contact begins, for what contact did in one
/// frame it does about as much of in the next. When the tracker comes back the hand stays at the wall until the tracker
/// leaves it.
#[test]
fn sweeps_of_an_arm_at_a_wall_become_few_and_it_does_not_hover() {
    const PUSH: u32 = 180;
    const STAY: u32 = 60;
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let options = ChainOptions {
        method: ChainOptions::CYCLIC_DESCENT,
        ..ChainOptions::DEFAULT
    };
    let (body, chain) = add_arm_at_wall(&mut world, options);
    let mut before = vec![0.0, 0.0, 0.0, 0.3, 0.0, 0.0, 0.0];
    world.place_angles(chain, &before).unwrap();
    let (mut sweeps, mut jump, mut hovers) = (vec![], 0.0_f32, 0.0_f64);
    for frame in 0..2 * PUSH + STAY {
        let into = frame.min(PUSH).min((2 * PUSH + STAY).saturating_sub(frame));
        let angles = swung(eased(into as f32 / PUSH as f32));
        world.set_angles(chain, &angles).unwrap();
        let report = step(&mut world, body, &SHOULDER);
        let depth_m = depth_m(&world, body, chain, -0.45);
        assert!(depth_m <= f64::from(OVERLAP_SLOP_M), "{frame}: {depth_m} m");
        let wanted_m = deepest_m(&ends_at(&SHOULDER, &angles), -0.45);
        if wanted_m > 0.01 {
            hovers = hovers.max(-depth_m);
        }
        if wanted_m > 0.0 && frame < PUSH {
            sweeps.push(report.reach_steps);
        }
        let now = world.angles(chain).unwrap().to_vec();
        jump = jump.max(most_turned(&now, &before));
        before = now;
    }
    let mean = |of: &[u32]| f64::from(of.iter().sum::<u32>()) / of.len() as f64;
    let (first, then) = (mean(&sweeps[..10]), mean(&sweeps[10..]));
    println!("{first} sweeps a frame, then {then}; {jump} rad; hovers {hovers} m");
    assert!(first > 0.0 && then < 0.5 * first, "{first}, {then}");
    assert!(hovers < 2e-4, "{hovers} m");
    assert!(jump < 3.0_f32.to_radians(), "{jump}");
}

/// What contact did in the frame before is mostly what it does in the next: most frames of a push take no step. They come
/// to nearly what a world comes to that has no past and as many frames as it likes.
#[test]
fn a_push_at_a_wall_goes_on_without_steps_and_stays_the_least_deviation() {
    const PUSH: u32 = 240;
    const MORE_FRAMES: u32 = 60;
    let mut blocks = [(); 2].map(|()| Block::new(&Capacities::ROOM));
    let [mut world, mut fresh] = blocks
        .each_mut()
        .map(|block| World::create(block.bytes(), &Capacities::ROOM).unwrap());
    let (body, chain) = add_arm_at_wall(&mut world, ChainOptions::DEFAULT);
    let (its_body, its_chain) = add_arm_at_wall(&mut fresh, ChainOptions::DEFAULT);
    let mut before = vec![0.0, 0.0, 0.0, 0.3, 0.0, 0.0, 0.0];
    world.place_angles(chain, &before).unwrap();
    let (mut frames, mut with_steps, mut fresh_steps, mut dearer) = (0, 0, 0, 0.0_f64);
    for frame in 0..PUSH {
        let wanted = swung(eased(frame as f32 / PUSH as f32));
        fresh.place_angles(its_chain, &before).unwrap();
        fresh.set_angles(its_chain, &wanted).unwrap();
        world.set_angles(chain, &wanted).unwrap();
        let steps = step(&mut world, body, &SHOULDER).reach_steps;
        let its_steps = step(&mut fresh, its_body, &SHOULDER).reach_steps;
        for _ in 0..MORE_FRAMES {
            step(&mut fresh, its_body, &SHOULDER);
        }
        before = world.angles(chain).unwrap().to_vec();
        assert!(depth_m(&world, body, chain, -0.45) <= f64::from(OVERLAP_SLOP_M));
        if deepest_m(&ends_at(&SHOULDER, &wanted), -0.45) > 0.01 {
            let deviation = |angles: &[f32]| -> f64 {
                let change = angles.iter().zip(&wanted);
                change.map(|(a, b)| f64::from(a - b).powi(2)).sum()
            };
            let least = deviation(fresh.angles(its_chain).unwrap());
            frames += 1;
            with_steps += u32::from(steps > 0);
            fresh_steps += u32::from(its_steps > 0);
            dearer = dearer.max(deviation(&before) / least - 1.0);
        }
    }
    println!("{with_steps} of {frames} frames take steps; deviation {dearer} above the least");
    assert!(
        frames > 100 && fresh_steps == frames,
        "{fresh_steps} of {frames}"
    );
    assert!(4 * with_steps < frames, "{with_steps} of {frames}");
    assert!(dearer < 0.005, "{dearer}");
}

#[test]
fn the_wrist_of_an_arm_stays_where_the_tracker_is_nearest() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    // The wall's face is at z = -0.40.
    add_box(
        &mut world,
        BodyKind::Fixed,
        Pose::at(0.0, 1.2, -0.50),
        [2.0, 2.0, 0.1],
    );
    let shoulder = Pose::at(0.0, 1.4, 0.0);
    let options = ChainOptions {
        flags: ChainOptions::MOVES_ROOT | ChainOptions::HOLDS_TIP,
        ..ChainOptions::DEFAULT
    };
    let (body, chain) = add_arm(&mut world, shoulder, options);
    let posture = [0.4, 0.1, 0.0, 1.2, 0.0, 0.0, 0.0];
    let forward = Quat::from_rotation_x(core::f32::consts::FRAC_PI_2);
    let start = Pose::new(forward, Vec3::new(0.0, 1.25, -0.20));
    world.set_tip(chain, &start, &posture).unwrap();
    let angles = world.target_angles(chain).unwrap().to_vec();
    world.place_angles(chain, &angles).unwrap();
    let mut before = angles;
    let (mut deepest, mut jump, mut off) = (f64::NEG_INFINITY, 0.0_f32, 0.0_f32);
    for frame in 0..600 {
        let t = (frame as f32 / 180.0).min(1.0);
        let s = 0.5 - 0.5 * (t * core::f32::consts::PI).cos();
        // 150 mm behind the face, and sideways along it.
        let aside = 0.1 * ((frame as f32 / 400.0).min(1.0) * 6.0).sin();
        let wrist = Vec3::new(aside, 1.25, -0.20 - 0.35 * s);
        world
            .set_tip(chain, &Pose::new(forward, wrist), &posture)
            .unwrap();
        step(&mut world, body, &shoulder);
        deepest = deepest.max(depth_m(&world, body, chain, -0.40));
        let now = world.angles(chain).unwrap().to_vec();
        if frame > 0 {
            for (a, b) in now.iter().zip(&before) {
                jump = jump.max((a - b).abs());
            }
        }
        let at = world.link_poses(chain).unwrap()[6].translation();
        let nearest = Vec3::new(wrist.x, wrist.y, wrist.z.max(at.z));
        if frame > 250 {
            off = off.max((at - nearest).length());
        }
        if frame > 500 {
            assert_eq!(now, before, "a still tracker keeps the arm still");
        }
        before = now;
    }
    assert!(deepest <= f64::from(OVERLAP_SLOP_M), "{deepest} m");
    assert!(deepest > -1e-3, "the arm comes to the wall: {deepest} m");
    assert!(jump < 3.0_f32.to_radians(), "{jump}");
    assert!(off < 5e-3, "{off} m from the nearest point");
}

#[test]
fn free_chains_follow_to_the_bit_and_cost_no_step() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let (body, chain) = add_arm(&mut world, Pose::at(0.0, 1.4, 0.0), ChainOptions::DEFAULT);
    for frame in 0..200 {
        let t = frame as f32 * 0.05;
        let angles: Vec<f32> = (0..7).map(|i| 0.4 * (t + i as f32).sin()).collect();
        world.set_angles(chain, &angles).unwrap();
        let targets = world.target_angles(chain).unwrap().to_vec();
        let root = Pose::at(t.sin(), 1.4, t.cos());
        let report = step(&mut world, body, &root);
        assert_eq!(world.angles(chain).unwrap(), targets);
        assert_eq!(world.pose(body).unwrap(), root);
        assert_eq!(report.reach_steps, 0);
        for ((target, angle), joint) in targets.iter().zip(&angles).zip(arm_joints()) {
            if let JointDef::Hinge(hinge) = joint {
                assert_eq!(*target, angle.clamp(hinge.low_rad, hinge.high_rad));
            }
        }
    }
}

/// Distance of two segments, by ternary search over the one and projection on the other: distance is
/// convex along a segment.
fn segment_distance(a: [DVec3; 2], b: [DVec3; 2]) -> f64 {
    let to_b = |p: DVec3| {
        let along = b[1] - b[0];
        let t = ((p - b[0]).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        p.distance(b[0] + along * t)
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..100 {
        let (x, y) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if to_b(a[0].lerp(a[1], x)) < to_b(a[0].lerp(a[1], y)) {
            high = y;
        } else {
            low = x;
        }
    }
    to_b(a[0].lerp(a[1], low))
}

/// How far the surfaces of two arms are apart, in metres.
fn arms_apart_m(a: &[DVec3], b: &[DVec3]) -> f64 {
    let mut least = f64::INFINITY;
    for p in a.chunks(2) {
        for q in b.chunks(2) {
            least = least.min(segment_distance([p[0], p[1]], [q[0], q[1]]));
        }
    }
    least - 2.0 * f64::from(RADIUS_M)
}

#[test]
fn arms_of_one_body_do_not_cross() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let root = Pose::at(0.0, 1.4, 0.0);
    let body = world
        .add_body(&BodyDef::new(BodyKind::Driven, root))
        .unwrap();
    let options = ChainOptions {
        flags: ChainOptions::MOVES_ROOT | ChainOptions::MEETS_BODY,
        ..ChainOptions::DEFAULT
    };
    let mut arms = vec![];
    for side in [-0.2, 0.2] {
        let mut joints = arm_joints();
        if let JointDef::Hinge(first) = &mut joints[0] {
            first.rest = Pose::at(side, 0.0, 0.0);
        }
        let def = ChainDef {
            joints: &joints,
            base: None,
            options,
        };
        let chain = world.add_chain(body, &def).unwrap();
        for (link, to) in LINKS {
            world.add_link_piece(chain, link, &capsule(to)).unwrap();
        }
        arms.push(chain);
    }
    let mut nearest = f64::INFINITY;
    let mut touched = 0;
    for frame in 0..500 {
        let s = 0.5 - 0.5 * (frame as f32 * 0.02).cos();
        // Both reach forward and inward: left to the right and right to the left, the left a bit lower.
        for (chain, sign) in arms.iter().zip([1.0, -1.0]) {
            let lift = 1.4 + 0.1 * sign;
            let angles = [lift, sign * 0.7 * s, 0.0, 0.2, 0.0, 0.0, 0.0];
            world.set_angles(*chain, &angles).unwrap();
        }
        let report = step(&mut world, body, &root);
        let mut places = vec![];
        for (chain, side) in arms.iter().zip([-0.2, 0.2]) {
            let mut points = ends(&world, body, *chain);
            for point in &mut points {
                point.x += side;
            }
            places.push(points);
        }
        let apart = arms_apart_m(&places[0], &places[1]);
        assert!(apart >= -1e-3, "frame {frame}: {apart} m");
        nearest = nearest.min(apart);
        touched += u32::from(report.reach_steps > 0);
    }
    assert!(
        nearest < 1e-3 && touched > 50,
        "the arms meet: {nearest} m, {touched} frames"
    );
}

#[test]
fn two_driven_bodies_keep_out_of_each_other() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let mut hands = vec![];
    for side in [-0.3, 0.3] {
        let hand = add_box(
            &mut world,
            BodyKind::Driven,
            Pose::at(side, 1.0, 0.0),
            [0.05; 3],
        );
        hands.push(hand);
    }
    let mut nearest = f32::INFINITY;
    for frame in 0..300 {
        // Fast, through each other and back.
        let x = 0.3 * (frame as f32 * 0.2).cos();
        world.set_target(hands[0], &Pose::at(-x, 1.0, 0.0)).unwrap();
        world.set_target(hands[1], &Pose::at(x, 1.01, 0.0)).unwrap();
        world.step(&FrameInput::unlimited(FRAME_S));
        let [a, b] = [0, 1].map(|i| world.pose(hands[i]).unwrap().translation());
        let gap = (a - b).abs() - Vec3::splat(0.1);
        let gap = gap.x.max(gap.y).max(gap.z);
        assert!(gap > -OVERLAP_SLOP_M, "frame {frame}: {gap} m");
        nearest = nearest.min(gap);
    }
    assert!(nearest < 1e-3);
}

#[test]
fn without_budget_the_arm_is_held_before_the_wall_within_its_limits() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let (body, chain) = add_arm_at_wall(&mut world, ChainOptions::DEFAULT);
    let mut cut = 0;
    for frame in 0..400_u32 {
        let s = 0.5 - 0.5 * (frame as f32 * 0.05).cos();
        world
            .set_angles(chain, &[1.5 * s, 0.2, 0.0, 0.3, 0.0, 0.0, 0.0])
            .unwrap();
        world.set_target(body, &SHOULDER).unwrap();
        let report = world.step(&FrameInput {
            budget: Budget {
                advance_units: frame % 5,
                impulse_units: 0,
                reach_steps: frame % 3,
            },
            ..FrameInput::unlimited(FRAME_S)
        });
        assert!(report.advance_units <= frame % 5 && report.reach_steps <= frame % 3);
        cut += u32::from(report.flags & (FrameReport::REACH_CUT | FrameReport::ADVANCE_CUT) != 0);
        assert!(depth_m(&world, body, chain, -0.45) <= f64::from(OVERLAP_SLOP_M));
        for (joint, &angle) in arm_joints().iter().zip(world.angles(chain).unwrap()) {
            if let JointDef::Hinge(hinge) = joint {
                assert!(angle >= hinge.low_rad && angle <= hinge.high_rad);
            }
        }
    }
    assert!(cut > 0);
}

#[test]
fn a_rigid_chain_keeps_its_angles_and_moves_the_root() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let options = ChainOptions {
        flags: ChainOptions::RIGID,
        ..ChainOptions::DEFAULT
    };
    let (body, chain) = add_arm_at_wall(&mut world, options);
    let mut steps = 0;
    for frame in 0..200 {
        let lift = (0.01 * frame as f32).min(1.5);
        world
            .set_angles(chain, &[lift, 0.0, 0.0, 0.05, 0.0, 0.0, 0.0])
            .unwrap();
        steps += step(&mut world, body, &SHOULDER).reach_steps;
        assert!(depth_m(&world, body, chain, -0.45) <= f64::from(OVERLAP_SLOP_M));
    }
    for _ in 0..100 {
        steps += step(&mut world, body, &SHOULDER).reach_steps;
    }
    assert_eq!(
        world.angles(chain).unwrap(),
        world.target_angles(chain).unwrap()
    );
    let back_m = world.pose(body).unwrap().position[2];
    assert!(
        (0.1..0.4).contains(&back_m) && steps == 0,
        "{back_m} m, {steps} steps"
    );
}

#[test]
fn groups_let_driven_things_pass() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let mut hands = vec![];
    for (side, member_of, passes) in [(-0.3, 1, 0), (0.3, 2, 1)] {
        let at = Pose::at(side, 1.0, 0.0);
        let hand = world.add_body(&BodyDef::new(BodyKind::Driven, at)).unwrap();
        let piece = world
            .add_piece(hand, &PieceDef::new(Shape::Box([0.05; 3]), 0.0))
            .unwrap();
        world
            .set_groups(piece, Groups { member_of, passes })
            .unwrap();
        hands.push(hand);
    }
    for frame in 0..60 {
        let x = 0.3 - 0.01 * frame as f32;
        for (hand, sign) in hands.iter().zip([-1.0, 1.0]) {
            let target = Pose::at(sign * x, 1.0, 0.0);
            world.set_target(*hand, &target).unwrap();
        }
        world.step(&FrameInput::unlimited(FRAME_S));
        for (hand, sign) in hands.iter().zip([-1.0, 1.0]) {
            assert_eq!(world.pose(*hand).unwrap(), Pose::at(sign * x, 1.0, 0.0));
        }
    }
}

#[test]
fn a_hand_between_two_plates_stays_between_them() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    // A slot of 84 mm for a hand of 80 mm.
    for z in [-0.442, -0.258] {
        add_box(
            &mut world,
            BodyKind::Fixed,
            Pose::at(0.0, 1.0, z),
            [0.3, 0.25, 0.05],
        );
    }
    let shoulder = Pose::at(0.0, 1.4, 0.0);
    let (body, chain) = add_arm(&mut world, shoulder, ChainOptions::DEFAULT);
    // Hanging forward into the slot.
    let start = [0.95, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    world.place_angles(chain, &start).unwrap();
    let mut steps = 0;
    let mut before = vec![];
    for frame in 0..300 {
        let swing = 0.3 * (frame.min(200) as f32 * 0.05).sin();
        let angles = [
            0.95 + swing,
            0.0,
            0.0,
            0.3 * swing.max(0.0),
            0.0,
            swing,
            0.0,
        ];
        world.set_angles(chain, &angles).unwrap();
        steps += step(&mut world, body, &shoulder).reach_steps;
        for &plate in &[1, 2] {
            let id = palpable::memory::BodyId {
                index1: plate,
                generation: 1,
            };
            let found = world.penetration(body, id).unwrap();
            assert!(
                found.depth_m <= OVERLAP_SLOP_M,
                "frame {frame}: {} m",
                found.depth_m
            );
        }
        if frame > 290 {
            assert_eq!(world.angles(chain).unwrap(), before, "still in the slot");
        }
        before = world.angles(chain).unwrap().to_vec();
    }
    assert!(steps > 100, "{steps} steps");
}

#[test]
fn tracked_link_poses_give_the_angles_back() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let shoulder = Pose::new(Quat::from_rotation_y(0.7), Vec3::new(0.3, 1.4, -0.2));
    let (body, chain) = add_arm(&mut world, shoulder, ChainOptions::DEFAULT);
    for frame in 0..200 {
        let t = frame as f32 * 0.13;
        let wanted: Vec<f32> = arm_joints()
            .iter()
            .enumerate()
            .map(|(i, joint)| match joint {
                JointDef::Hinge(hinge) => {
                    let share = 0.5 + 0.5 * (t + 1.7 * i as f32).sin();
                    hinge.low_rad + share * (hinge.high_rad - hinge.low_rad)
                }
                JointDef::Ball { .. } => unreachable!(),
            })
            .collect();
        world.place_angles(chain, &wanted).unwrap();
        world.place_body(body, &shoulder).unwrap();
        let poses = world.link_poses(chain).unwrap().to_vec();
        world.set_angles(chain, &[0.3; 7]).unwrap();
        world.set_target(body, &shoulder).unwrap();
        world.set_link_poses(chain, &poses).unwrap();
        for (angle, wanted) in world.target_angles(chain).unwrap().iter().zip(&wanted) {
            assert!((angle - wanted).abs() < 2e-6, "{angle} {wanted}");
        }
    }
}

#[test]
fn a_snapshot_of_an_arm_at_a_wall_rolls_back_to_the_bit() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let (body, chain) = add_arm_at_wall(&mut world, ChainOptions::DEFAULT);
    let play = |world: &mut World, from: u32| {
        for frame in from..from + 60 {
            let lift = 0.5 + 0.01 * frame as f32;
            world
                .set_angles(chain, &[lift, 0.1, 0.0, 0.1, 0.0, 0.0, 0.0])
                .unwrap();
            step(world, body, &SHOULDER);
        }
        world.hash()
    };
    play(&mut world, 0);
    let mut saved = vec![0; world.snapshot_bytes()];
    world.save(&mut saved).unwrap();
    let first = play(&mut world, 60);
    play(&mut world, 10);
    world.load(&saved).unwrap();
    assert_eq!(play(&mut world, 60), first);
    let mut other_block = Block::new(&Capacities::ROOM);
    let mut other = World::create(other_block.bytes(), &Capacities::ROOM).unwrap();
    other.load(&saved).unwrap();
    assert_eq!(play(&mut other, 60), first);
}

#[test]
fn what_settled_looks_again_when_anything_changes() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let wall = Pose::at(0.0, 1.2, -0.55);
    let wall = add_box(&mut world, BodyKind::Fixed, wall, [2.0, 2.0, 0.1]);
    let shoulder = Pose::at(0.0, 1.4, 0.0);
    let (body, chain) = add_arm(&mut world, shoulder, ChainOptions::DEFAULT);
    let forward = [1.5, 0.1, 0.0, 0.1, 0.0, 0.0, 0.0];
    world.set_angles(chain, &forward).unwrap();
    // Two hands beside it that want the same place.
    let hands = [5.0, 5.3].map(|x| {
        let pose = Pose::at(x, 1.0, 0.0);
        add_box(&mut world, BodyKind::Driven, pose, [0.05; 3])
    });
    let settle = |world: &mut World, first_at: f32| {
        let mut report = FrameReport::default();
        for _ in 0..200 {
            world
                .set_target(hands[0], &Pose::at(first_at, 1.0, 0.0))
                .unwrap();
            world
                .set_target(hands[1], &Pose::at(5.0, 1.0, 0.0))
                .unwrap();
            report = step(world, body, &shoulder);
        }
        report
    };
    let report = settle(&mut world, 5.0);
    assert_eq!(
        (report.advance_units, report.reach_steps),
        (0, 0),
        "all is settled"
    );
    assert!(report.contacts >= 2, "and its contacts are still told");
    let blocked = world.pose(hands[1]).unwrap().position[0];
    assert!(blocked > 5.099, "{blocked}");

    // The other hand goes away: this one follows.
    settle(&mut world, 4.0);
    assert_eq!(world.pose(hands[1]).unwrap().position[0], 5.0);

    // The wall comes nearer by host, then goes: the arm yields, then reaches its target.
    world.place_body(wall, &Pose::at(0.0, 1.2, -0.9)).unwrap();
    settle(&mut world, 4.0);
    assert_eq!(world.angles(chain).unwrap(), forward);
}

/// Two links that turn about upright axes, lying on a table: what no joint can mend keeps none from turning.
#[test]
fn links_that_lie_on_a_table_turn_on_it_and_come_to_rest() {
    let joints = [
        hinge(Vec3::ZERO, Vec3::Y, -1.5, 1.5),
        hinge(Vec3::X * 0.3, Vec3::Y, -1.5, 1.5),
    ];
    let options = [ChainOptions::MOVES_ROOT, 0].map(|flags| ChainOptions {
        flags,
        ..ChainOptions::DEFAULT
    });
    // How far the links are tracked below where they lie.
    let pressed_m = [-5e-5, -3e-5, 0.0, 1e-5, 5e-5, 1e-4, 1e-3, 1e-2];
    for (options, pressed_m) in options.iter().flat_map(|o| pressed_m.map(|m| (o, m))) {
        if options.flags == 0 && pressed_m > 2e-3 {
            // A root that does not give way takes nearly all of each frame from a link that is pressed so deep.
            continue;
        }
        let mut block = Block::new(&Capacities::ROOM);
        let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
        let table = Pose::at(0.0, -0.5, 0.0);
        add_box(&mut world, BodyKind::Fixed, table, [2.0, 0.5, 2.0]);
        let at = Pose::at(0.0, 0.1, 0.0);
        let body = world.add_body(&BodyDef::new(BodyKind::Driven, at)).unwrap();
        let def = ChainDef {
            joints: &joints,
            base: None,
            options: *options,
        };
        let chain = world.add_chain(body, &def).unwrap();
        for link in 0..2 {
            let piece = capsule(Vec3::X * 0.25);
            world.add_link_piece(chain, link, &piece).unwrap();
        }
        let mut still = 0;
        let mut last = [0.0; 2];
        for frame in 0..400 {
            let height = (0.1 - 0.002 * frame as f32).max(RADIUS_M - pressed_m);
            let turned = 0.3 * ((frame as f32 - 60.0) / 60.0).clamp(0.0, 1.0);
            let wanted = [turned, -2.0 * turned];
            world.set_angles(chain, &wanted).unwrap();
            step(&mut world, body, &Pose::at(0.0, height, 0.0));
            let angles: [f32; 2] = world.angles(chain).unwrap().try_into().unwrap();
            let off = most_turned(&angles, &wanted);
            if options.flags == ChainOptions::MOVES_ROOT {
                // Where the root does not give way it takes a part of each frame, and angles lag.
                assert!(off < 1e-3, "{frame}, pressed {pressed_m} m: {off} rad");
            }
            still = if angles == last { still + 1 } else { 0 };
            last = angles;
        }
        let off = most_turned(&last, &[0.3, -0.6]);
        assert!(off < 2e-3, "pressed {pressed_m} m: {off} rad");
        assert!(
            still > 100,
            "pressed {pressed_m} m: moved {still} frames ago"
        );
    }
}
