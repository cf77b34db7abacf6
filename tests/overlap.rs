//! Overlap that the host makes.

mod common;

use common::{Block, add_box};
use palpable::frame::{Budget, FrameInput, FrameReport};
use palpable::limits::{OVERLAP_SLOP_M, WAY_OUT_PAIR_UNITS, WAY_OUT_UNITS};
use palpable::math::Pose;
use palpable::memory::{BodyId, Capacities};
use palpable::state::bodies::{BodyKind, DrivenReport};
use palpable::world::World;

const FRAME_S: f32 = 1.0 / 90.0;

fn floor(world: &mut World) {
    // Top at y = 0.
    let pose = Pose::at(0.0, -0.5, 0.0);
    add_box(world, BodyKind::Fixed, pose, [5.0, 0.5, 5.0]);
}

fn step(world: &mut World, body: BodyId, target: &Pose) -> FrameReport {
    world.set_target(body, target).unwrap();
    world.step(&FrameInput::unlimited(FRAME_S))
}

#[test]
fn a_body_spawned_in_the_floor_and_a_wall_gets_out_of_both() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    floor(&mut world);
    let wall = Pose::at(1.5, 0.0, 0.0);
    add_box(&mut world, BodyKind::Fixed, wall, [0.5, 3.0, 3.0]);
    // HARD_CASES: 10 mm into the floor and 10 mm into the wall: out by (10, 10) mm.
    let spawned = Pose::at(0.96, 0.04, 0.0);
    let hand = add_box(&mut world, BodyKind::Driven, spawned, [0.05; 3]);
    let report = step(&mut world, hand, &spawned);
    assert_ne!(report.flags & FrameReport::OVERLAP, 0);
    let flags = world.driven_report(hand).unwrap().flags;
    assert_ne!(flags & DrivenReport::OVERLAPS, 0);
    for _ in 0..30 {
        let [x, y, z] = world.pose(hand).unwrap().position;
        let gaps = [1.0 - (x + 0.05), y - 0.05];
        for gap in gaps {
            assert!((0.0..=OVERLAP_SLOP_M).contains(&gap), "{gaps:?}");
        }
        assert!(z.abs() < 1e-6, "{z}");
        let report = step(&mut world, hand, &spawned);
        assert_eq!(report.flags & FrameReport::OVERLAP, 0);
    }
}

#[test]
fn the_way_out_of_a_little_overlap_costs_little_among_much_that_is_near() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    floor(&mut world);
    for (x, z) in (-2..=2).flat_map(|x| (-2..=2).map(move |z| (x, z))) {
        if (x, z) != (0, 0) {
            // The nearest are 8 mm from the hand's sides.
            let at = Pose::at(0.068 * x as f32, 0.2, 0.068 * z as f32);
            add_box(&mut world, BodyKind::Fixed, at, [0.01, 0.2, 0.01]);
        }
    }
    let spawned = Pose::at(0.0, 0.048, 0.0);
    let hand = add_box(&mut world, BodyKind::Driven, spawned, [0.05; 3]);
    world.set_target(hand, &Pose::at(0.0, -0.1, 0.0)).unwrap();
    let input = FrameInput {
        budget: Budget {
            advance_units: WAY_OUT_UNITS + 2 * WAY_OUT_PAIR_UNITS + 48,
            ..Budget::UNLIMITED
        },
        ..FrameInput::unlimited(FRAME_S)
    };
    world.step(&input);
    let [x, y, z] = world.pose(hand).unwrap().position;
    assert!((0.0..=OVERLAP_SLOP_M).contains(&(y - 0.05)), "{y}");
    assert!(x.abs().max(z.abs()) < 1e-6, "{x} {z}");
}
