//! Motion of driven bodies: free, into contact, along it, and at any speed.

mod common;

use common::{Block, add_box, add_piece};
use palpable::frame::{Budget, FrameInput};
use palpable::limits::OVERLAP_SLOP_M;
use palpable::math::Pose;
use palpable::memory::{BodyId, Capacities};
use palpable::state::bodies::{BodyKind, DrivenReport};
use palpable::world::{BodyDef, PieceDef, Shape, World};

const FRAME_S: f32 = 1.0 / 60.0;

fn step(world: &mut World, body: BodyId, target: &Pose, dt_s: f32) -> Pose {
    world.set_target(body, target).unwrap();
    world.step(&FrameInput::unlimited(dt_s));
    world.pose(body).unwrap()
}

fn floor(world: &mut World) {
    // Top at y = 0.
    add_box(
        world,
        BodyKind::Fixed,
        Pose::at(0.0, -0.5, 0.0),
        [5.0, 0.5, 5.0],
    );
}

#[test]
fn free_motion_has_no_lag() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    floor(&mut world);
    let hand = add_box(
        &mut world,
        BodyKind::Driven,
        Pose::at(0.0, 1.0, 0.0),
        [0.05; 3],
    );
    for frame in 0..200 {
        let t = frame as f32 * 0.037;
        let target = Pose {
            rotation: palpable::math::quat_from_rotation_vector(glam::Vec3::new(t.sin(), t, 0.3))
                .to_array(),
            position: [t.cos(), 1.0 + 0.5 * t.sin(), -t],
        };
        assert_eq!(
            step(&mut world, hand, &target, FRAME_S),
            target.normalised(1e4).unwrap()
        );
    }
}

#[test]
fn a_cube_stops_at_a_thin_plate_at_the_right_place() {
    // HARD_CASES: 20 mm cube at 10 m/s toward a 1 mm plate 100 mm away: contact after 10 ms.
    for dt in [1.0 / 60.0, 1.0 / 1000.0] {
        let mut block = Block::new(&Capacities::ROOM);
        let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
        add_box(
            &mut world,
            BodyKind::Fixed,
            Pose::at(0.1105, 0.0, 0.0),
            [0.0005, 1.0, 1.0],
        );
        let cube = add_box(&mut world, BodyKind::Driven, Pose::IDENTITY, [0.01; 3]);
        step(&mut world, cube, &Pose::IDENTITY, dt);
        let mut t = 0.0;
        for _ in 0..(0.1 / dt) as usize {
            t += dt;
            let pose = step(&mut world, cube, &Pose::at(10.0 * t, 0.0, 0.0), dt);
            let gap = 0.1 - pose.position[0];
            assert!(gap > 0.0, "through the plate: {gap}");
            if t > 0.0101 {
                assert!(gap <= OVERLAP_SLOP_M, "stopped {gap} m away");
            } else if t < 0.0099 {
                assert_eq!(pose.position[0], 10.0 * t);
            }
        }
    }
}

#[test]
fn a_pressed_body_rests_to_the_bit_and_slides_without_lag() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    floor(&mut world);
    let hand = add_box(
        &mut world,
        BodyKind::Driven,
        Pose::at(0.0, 0.2, 0.0),
        [0.05; 3],
    );
    for _ in 0..60 {
        step(&mut world, hand, &Pose::at(0.0, -0.1, 0.0), FRAME_S);
    }
    let rest = world.pose(hand).unwrap();
    let bottom = rest.position[1] - 0.05;
    assert!(
        (0.0..=OVERLAP_SLOP_M).contains(&bottom),
        "bottom at {bottom}"
    );
    let hash = world.hash();
    for _ in 0..100 {
        assert_eq!(
            step(&mut world, hand, &Pose::at(0.0, -0.1, 0.0), FRAME_S),
            rest
        );
        assert_eq!(world.hash(), hash);
    }
    let report = world.driven_report(hand).unwrap();
    assert!(report.flags & DrivenReport::TOUCHING != 0);
    assert!(
        (report.force_n[1] - 150.0).abs() < 1.0,
        "{:?}",
        report.force_n
    );
    for frame in 1..100 {
        let x = 0.005 * frame as f32;
        let pose = step(&mut world, hand, &Pose::at(x, -0.1, 0.0), FRAME_S);
        assert!(
            (pose.position[0] - x).abs() < 1e-6,
            "lag {}",
            pose.position[0] - x
        );
        assert!((0.0..=OVERLAP_SLOP_M).contains(&(pose.position[1] - 0.05)));
    }
}

#[test]
fn a_body_released_from_contact_returns_to_its_tracker() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    floor(&mut world);
    let hand = add_box(
        &mut world,
        BodyKind::Driven,
        Pose::at(0.0, 0.2, 0.0),
        [0.05; 3],
    );
    for _ in 0..30 {
        step(&mut world, hand, &Pose::at(0.0, -0.1, 0.0), FRAME_S);
    }
    let target = Pose::at(0.0, 0.5, 0.0);
    for _ in 0..60 {
        step(&mut world, hand, &target, FRAME_S);
    }
    assert_eq!(world.pose(hand).unwrap(), target);
}

#[test]
fn a_corner_holds_a_body_on_both_sides() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    floor(&mut world);
    add_box(
        &mut world,
        BodyKind::Fixed,
        Pose::at(1.5, 0.0, 0.0),
        [0.5, 5.0, 5.0],
    );
    let hand = add_box(
        &mut world,
        BodyKind::Driven,
        Pose::at(0.5, 0.5, 0.0),
        [0.05; 3],
    );
    let mut last = Pose::IDENTITY;
    for _ in 0..100 {
        last = step(&mut world, hand, &Pose::at(1.3, -0.2, 0.1), FRAME_S);
    }
    let (right, bottom) = (1.0 - (last.position[0] + 0.05), last.position[1] - 0.05);
    assert!((0.0..=OVERLAP_SLOP_M).contains(&right), "{right}");
    assert!((0.0..=OVERLAP_SLOP_M).contains(&bottom), "{bottom}");
    assert_eq!(
        step(&mut world, hand, &Pose::at(1.3, -0.2, 0.1), FRAME_S),
        last
    );
}

#[test]
fn a_teleport_through_walls_stops_at_the_first() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    add_box(
        &mut world,
        BodyKind::Fixed,
        Pose::at(3.0, 0.0, 0.0),
        [0.01, 2.0, 2.0],
    );
    add_box(
        &mut world,
        BodyKind::Fixed,
        Pose::at(5.0, 0.0, 0.0),
        [0.01, 2.0, 2.0],
    );
    let hand = add_box(&mut world, BodyKind::Driven, Pose::IDENTITY, [0.05; 3]);
    for _ in 0..20 {
        let pose = step(&mut world, hand, &Pose::at(10.0, 0.0, 0.0), FRAME_S);
        assert!(pose.position[0] + 0.05 < 2.99);
    }
}

#[test]
fn turning_into_the_floor_lifts_the_body() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    floor(&mut world);
    let body = world
        .add_body(&BodyDef::new(BodyKind::Driven, Pose::at(0.0, 0.3, 0.0)))
        .unwrap();
    add_piece(
        &mut world,
        body,
        &PieceDef::new(Shape::Box([0.1, 0.01, 0.02]), 0.0),
    );
    step(&mut world, body, &Pose::at(0.0, 0.02, 0.0), FRAME_S);
    for frame in 0..=60 {
        let angle = frame as f32 * std::f32::consts::FRAC_PI_2 / 60.0;
        let turn = palpable::math::quat_from_rotation_vector(glam::Vec3::new(0.0, 0.0, angle));
        let target = Pose::new(turn, glam::Vec3::new(0.0, 0.02, 0.0));
        let pose = step(&mut world, body, &target, FRAME_S);
        let lowest = pose.position[1] - 0.1 * angle.sin() - 0.01 * angle.cos();
        assert!(lowest > -1e-6, "frame {frame}: {lowest}");
        assert!(pose.quat().dot(turn).abs() > 0.9999, "the turn is followed");
    }
}

#[test]
fn without_a_budget_a_body_goes_only_where_boxes_alone_prove_it_safe() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    floor(&mut world);
    let hand = add_box(
        &mut world,
        BodyKind::Driven,
        Pose::at(0.0, 0.2, 0.0),
        [0.05; 3],
    );
    let input = FrameInput {
        budget: Budget {
            advance_units: 0,
            impulse_units: 0,
            reach_steps: 0,
        },
        ..FrameInput::unlimited(FRAME_S)
    };
    for _ in 0..10 {
        world.set_target(hand, &Pose::at(0.0, -1.0, 0.0)).unwrap();
        let report = world.step(&input);
        assert_eq!(report.advance_units, 0);
        assert!(world.pose(hand).unwrap().position[1] >= 0.05);
    }
    assert!(world.driven_report(hand).unwrap().flags & DrivenReport::CUT != 0);
}
