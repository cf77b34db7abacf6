//! The kernel never allocates: counted, not believed.

mod common;
#[path = "common/scenes.rs"]
mod scenes;

use allocation_counter::measure;
use common::{Block, add_box, add_piece};
use palpable::frame::FrameInput;
use palpable::math::Pose;
use palpable::memory::{BodyId, Capacities};
use palpable::recording::Replay;
use palpable::state::bodies::BodyKind;
use palpable::world::{BodyDef, PieceDef, Shape, World};

const FRAME_S: f32 = 1.0 / 60.0;

/// Runs something that must not allocate, not even to give the memory back at once.
fn without_allocation<T>(what: &str, run: impl FnOnce() -> T) -> T {
    let mut result = None;
    let counted = measure(|| result = Some(run()));
    assert_eq!(counted.count_total, 0, "{what} allocated");
    result.unwrap()
}

fn hull_points() -> Vec<[f32; 3]> {
    // A spiral on a sphere: every point is a corner.
    (0..200)
        .map(|i| {
            let y = 1.0 - 2.0 * (i as f32 + 0.5) / 200.0;
            let (r, turn) = ((1.0 - y * y).sqrt(), 2.4 * i as f32);
            [0.1 * r * turn.cos(), 0.1 * y, 0.1 * r * turn.sin()]
        })
        .collect()
}

/// A floor, a hand of two pieces, a crate and a ball.
fn furnish(world: &mut World) -> [BodyId; 3] {
    add_box(
        world,
        BodyKind::Fixed,
        Pose::at(0.0, -0.5, 0.0),
        [5.0, 0.5, 5.0],
    );
    let hand = add_box(world, BodyKind::Driven, Pose::at(-0.4, 0.2, 0.0), [0.05; 3]);
    add_piece(world, hand, &PieceDef::new(Shape::Point, 0.06));
    let crate_body = add_box(world, BodyKind::Dynamic, Pose::at(0.0, 0.3, 0.0), [0.05; 3]);
    let ball = world
        .add_body(&BodyDef::new(BodyKind::Dynamic, Pose::at(0.3, 0.2, 0.0)))
        .unwrap();
    add_piece(world, ball, &PieceDef::new(Shape::Point, 0.1));
    [hand, crate_body, ball]
}

#[test]
fn the_counter_counts() {
    assert_ne!(
        measure(|| drop(std::hint::black_box(vec![1_u8; 100]))).count_total,
        0
    );
}

#[test]
fn making_and_filling_a_world_does_not_allocate() {
    let mut block = Block::new(&Capacities::ROOM);
    let memory = block.bytes();
    let points = hull_points();
    let mut world = without_allocation("create", || {
        World::create(memory, &Capacities::ROOM).unwrap()
    });
    let bodies = without_allocation("add_body, add_piece", || furnish(&mut world));
    let piece = without_allocation("add_piece of a hull", || {
        add_piece(
            &mut world,
            bodies[1],
            &PieceDef::new(Shape::Hull(&points), 0.001),
        )
    });
    without_allocation("add_material", || world.add_material().unwrap());
    without_allocation("remove_piece", || world.remove_piece(piece).unwrap());
    without_allocation("remove_body", || world.remove_body(bodies[2]).unwrap());
    without_allocation("attach", || World::attach(block.bytes()).map(drop).unwrap());
}

#[test]
fn frames_and_reads_do_not_allocate() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let [hand, crate_body, ball] = furnish(&mut world);
    let (mut touched, mut pushed) = (false, false);
    for frame in 0..240 {
        let t = frame as f32 * FRAME_S;
        let target = Pose::at(-0.4 + 0.25 * t, 0.05, 0.01 * t);
        let fingers = [Pose::IDENTITY, Pose::at(0.02 * t, 0.01, 0.0)];
        without_allocation("set_target", || world.set_target(hand, &target).unwrap());
        without_allocation("set_piece_targets", || {
            world.set_piece_targets(hand, &fingers).unwrap();
        });
        let report = without_allocation("step", || world.step(&FrameInput::unlimited(FRAME_S)));
        touched |= report.contacts > 0;
        pushed |= report.impulses > 0;
        without_allocation("reads", || {
            world.pose(crate_body).unwrap();
            world.velocity(ball).unwrap();
            world.driven_report(hand).unwrap();
            assert!(world.contacts().len() + world.piece_poses().len() > 0);
        });
        without_allocation("hash", || world.hash());
    }
    assert!(touched && pushed, "the scene does something");
}

#[test]
fn snapshots_and_moves_by_the_host_do_not_allocate() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let [_, crate_body, ball] = furnish(&mut world);
    let mut buffer = vec![0; world.snapshot_bytes()];
    without_allocation("save", || world.save(&mut buffer).unwrap());
    without_allocation("load", || world.load(&buffer).unwrap());
    without_allocation("place_body", || {
        world
            .place_body(crate_body, &Pose::at(1.0, 1.0, 1.0))
            .unwrap();
    });
    without_allocation("set_velocity", || {
        world.set_velocity(ball, [1.0; 3], [2.0; 3]).unwrap();
    });
    without_allocation("set_gravity", || world.set_gravity([0.0; 3]));
}

#[test]
fn recording_and_replay_do_not_allocate() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut log = Vec::with_capacity(1 << 24);
    let mut sink = |bytes: &[u8]| log.extend_from_slice(bytes);
    let points = hull_points();
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    without_allocation("recording", || {
        world.record_to(&mut sink);
        let [hand, crate_body, _] = furnish(&mut world);
        add_piece(
            &mut world,
            crate_body,
            &PieceDef::new(Shape::Hull(&points), 0.0),
        );
        for frame in 0..10 {
            let target = Pose::at(0.01 * frame as f32, 0.05, 0.0);
            world.set_target(hand, &target).unwrap();
            world.set_piece_targets(hand, &[Pose::IDENTITY; 2]).unwrap();
            world.step(&FrameInput::unlimited(FRAME_S));
        }
    });
    let hash = world.hash();
    without_allocation("replay", || {
        let mut replay = Replay::open(&log).unwrap();
        let mut world = replay.start(block.bytes()).unwrap();
        while replay.next_call(&mut world).unwrap().is_some() {}
        assert_eq!(world.hash(), hash);
    });
}

#[test]
fn refusals_do_not_allocate() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let [hand, ..] = furnish(&mut world);
    let bad = Pose::at(f32::NAN, 0.0, 0.0);
    without_allocation("refusals", || {
        assert!(world.set_target(hand, &bad).is_err());
        assert!(world.set_piece_targets(hand, &[]).is_err());
        assert!(world.pose(BodyId::NULL).is_err());
        assert!(world.load(&[0; 10]).is_err());
        let flat = [[0.0; 3]; 5];
        let def = PieceDef::new(Shape::Hull(&flat), 0.0);
        assert!(world.add_piece(hand, &def).is_err());
    });
}

#[test]
fn arms_at_a_wall_do_not_allocate() {
    let mut scene = scenes::arms_at_a_wall();
    let input = FrameInput::unlimited(FRAME_S);
    let chains: Vec<_> = scene.limbs.clone();
    for frame in 0..150 {
        let angles = (scene.posture)(frame, 0);
        for &chain in &chains {
            without_allocation("set_angles", || {
                scene.world.set_angles(chain, &angles).unwrap();
            });
        }
        without_allocation("step", || scene.world.step(&input));
    }
    assert!(scene.world.chain_report(chains[0]).unwrap().flags != 0);
}
