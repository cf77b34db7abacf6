//! Bodies that are held far from their trackers, and what their coupling has them do then.

mod common;

use common::{Block, add_box, add_piece};
use glam::{Quat, Vec3};
use palpable::frame::{FrameInput, FrameReport};
use palpable::geometry::chain::{Hinge, JointDef};
use palpable::limits::GAP_TOUCHING_M;
use palpable::math::Pose;
use palpable::memory::{BodyId, Capacities, ChainId, PieceId};
use palpable::state::bodies::{BodyKind, Coupling, DrivenReport};
use palpable::state::chains::ChainOptions;
use palpable::world::{BodyDef, ChainDef, PieceDef, Shape, World};

fn step(world: &mut World, body: BodyId, target: &Pose) -> FrameReport {
    world.set_target(body, target).unwrap();
    world.step(&FrameInput::unlimited(1.0 / 90.0))
}

fn driven(snap: u32, at: Pose) -> BodyDef {
    BodyDef {
        coupling: Coupling {
            snap,
            ..Coupling::DEFAULT
        },
        ..BodyDef::new(BodyKind::Driven, at)
    }
}

/// A hand on the near side of a plate, its tracker half a metre behind it.
fn held_behind_a_plate(snap: u32, behind: &Pose) -> (Pose, u32) {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let plate = Pose::at(0.2, 0.0, 0.0);
    add_box(&mut world, BodyKind::Fixed, plate, [0.01, 2.0, 2.0]);
    let far = Pose::at(1.2, 0.0, 0.0);
    add_box(&mut world, BodyKind::Fixed, far, [0.01, 2.0, 2.0]);
    let hand = world.add_body(&driven(snap, Pose::IDENTITY)).unwrap();
    add_piece(&mut world, hand, &PieceDef::new(Shape::Point, 0.05));
    for _ in 0..60 {
        step(&mut world, hand, behind);
    }
    (
        world.pose(hand).unwrap(),
        world.driven_report(hand).unwrap().flags,
    )
}

#[test]
fn a_detached_body_stays_and_is_reported_unless_it_may_snap() {
    let behind = Pose::at(0.7, 0.0, 0.0);
    let (pose, flags) = held_behind_a_plate(Coupling::SNAP_NEVER, &behind);
    let gap = 0.19 - (pose.position[0] + 0.05);
    assert!((0.0..=GAP_TOUCHING_M).contains(&gap), "{gap}");
    assert_ne!(flags & DrivenReport::DETACHED, 0);

    let (pose, flags) = held_behind_a_plate(Coupling::SNAP_WHEN_FREE, &behind);
    assert_eq!(pose, behind);
    assert_eq!(flags & DrivenReport::DETACHED, 0);
}

#[test]
fn a_detached_body_does_not_snap_into_anything() {
    // The tracker is in the far plate.
    let inside = Pose::at(1.17, 0.0, 0.0);
    let (pose, flags) = held_behind_a_plate(Coupling::SNAP_WHEN_FREE, &inside);
    assert!(pose.position[0] + 0.05 < 0.19);
    assert_ne!(flags & DrivenReport::DETACHED, 0);
}

/// The far plate's near side is at 1.19 m.
#[test]
fn a_detached_body_may_snap_to_the_place_nearest_to_its_tracker() {
    for turn in [0.0, 0.4] {
        let inside = Pose::new(Quat::from_rotation_z(turn), Vec3::new(1.17, 0.3, 0.1));
        let (pose, flags) = held_behind_a_plate(Coupling::SNAP_NEAR, &inside);
        let gap = 1.19 - (pose.position[0] + 0.05);
        assert!((0.0..=GAP_TOUCHING_M).contains(&gap), "{gap}");
        assert!((pose.position[1] - 0.3).abs() < 1e-6 && (pose.position[2] - 0.1).abs() < 1e-6);
        assert_eq!(pose.rotation, inside.rotation);
        assert_eq!(flags & DrivenReport::DETACHED, 0);
    }
    // Where nothing touches it it is at its tracker.
    let behind = Pose::at(0.7, 0.0, 0.0);
    let (pose, _) = held_behind_a_plate(Coupling::SNAP_NEAR, &behind);
    assert_eq!(pose, behind);
}

#[test]
fn a_body_that_stands_in_a_corner_snaps_near_and_no_farther_than_half_of_what_detaches_it() {
    // The corner is at the origin; the ball's middle comes to one radius from each of the three sides.
    for (tracker_m, snaps) in [(0.03, true), (-0.02, true), (-0.03, true), (-0.05, false)] {
        let mut block = Block::new(&Capacities::ROOM);
        let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
        for side in [Vec3::X, Vec3::Y, Vec3::Z] {
            let half = Vec3::splat(3.0) - 2.5 * side;
            let at = Pose::new(Quat::IDENTITY, -0.5 * side);
            add_box(&mut world, BodyKind::Fixed, at, half.to_array());
        }
        let wall = Pose::at(0.5, 0.0, 0.0);
        add_box(&mut world, BodyKind::Fixed, wall, [0.01, 3.0, 3.0]);
        let def = driven(Coupling::SNAP_NEAR, Pose::at(0.8, 0.1, 0.1));
        let hand = world.add_body(&def).unwrap();
        add_piece(&mut world, hand, &PieceDef::new(Shape::Point, 0.05));
        let seen = Pose::at(tracker_m, tracker_m, tracker_m);
        for _ in 0..60 {
            step(&mut world, hand, &seen);
        }
        let at = world.pose(hand).unwrap().translation();
        // Half of 0.3 m is 3^(1/2) times 0.0866 m.
        let off_m = 0.05 - tracker_m;
        assert_eq!(snaps, off_m < 0.0866, "{tracker_m}");
        if snaps {
            let gaps = at - Vec3::splat(0.05);
            let near = 0.0..=GAP_TOUCHING_M;
            assert!(
                gaps.to_array().iter().all(|gap| near.contains(gap)),
                "{gaps}"
            );
        } else {
            assert!(at.x > 0.51 + 0.05, "{at}");
        }
    }
}

/// Two arms of a hinge each on a body that is 0.5 m above a floor; each link is a capsule of 0.4 m along X.
struct Arms {
    body: BodyId,
    chains: [ChainId; 2],
    links: [PieceId; 2],
}

const LINK_RADIUS_M: f32 = 0.03;

fn arms(world: &mut World, snap: u32, at: Pose) -> Arms {
    let body = world.add_body(&driven(snap, at)).unwrap();
    let mut made = [-0.2, 0.2].map(|z| {
        let joints = [JointDef::Hinge(Hinge {
            rest: Pose::at(0.0, 0.0, z),
            axis: Vec3::Y,
            low_rad: -1.5,
            high_rad: 1.5,
        })];
        let def = ChainDef {
            joints: &joints,
            base: None,
            options: ChainOptions {
                flags: ChainOptions::DEFAULT.flags | ChainOptions::MEETS_BODY,
                ..ChainOptions::DEFAULT
            },
        };
        let chain = world.add_chain(body, &def).unwrap();
        let shape = Shape::Segment([0.1, 0.0, 0.0], [0.5, 0.0, 0.0]);
        let def = PieceDef::new(shape, LINK_RADIUS_M);
        (chain, world.add_link_piece(chain, 0, &def).unwrap())
    });
    made.sort_by_key(|(chain, _)| chain.index1);
    Arms {
        body,
        chains: made.map(|(chain, _)| chain),
        links: made.map(|(_, link)| link),
    }
}

/// Arms in front of a plate whose tracker is behind it, with so much of the links in the floor there; where they are
/// after a while, and with what flags.
fn arms_behind_a_plate(snap: u32, in_floor_m: f32, angles: [f32; 2]) -> (Vec<Pose>, u32) {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let floor = Pose::at(0.0, -0.5, 0.0);
    add_box(&mut world, BodyKind::Fixed, floor, [5.0, 0.5, 5.0]);
    let plate = Pose::at(0.0, 1.0, 0.0);
    add_box(&mut world, BodyKind::Fixed, plate, [0.01, 1.0, 3.0]);
    let arms = arms(&mut world, snap, Pose::at(-0.6, 0.3, 0.0));
    let seen = Pose::at(0.6, LINK_RADIUS_M - in_floor_m, 0.0);
    for _ in 0..60 {
        for (chain, angle) in arms.chains.into_iter().zip(angles) {
            world.set_angles(chain, &[angle]).unwrap();
        }
        step(&mut world, arms.body, &seen);
    }
    let poses = arms.links.map(|link| world.piece_pose(link).unwrap());
    (
        poses.to_vec(),
        world.driven_report(arms.body).unwrap().flags,
    )
}

#[test]
fn arms_that_touch_the_floor_snap_near_with_the_angles_that_are_tracked() {
    let angles = [0.3, -0.2];
    for in_floor_m in [0.0, 0.02] {
        let (poses, flags) = arms_behind_a_plate(Coupling::SNAP_WHEN_FREE, in_floor_m, angles);
        assert!(poses[0].position[0] < -0.5, "{poses:?}");
        assert_ne!(flags & DrivenReport::DETACHED, 0);

        let (poses, flags) = arms_behind_a_plate(Coupling::SNAP_NEAR, in_floor_m, angles);
        assert_eq!(flags & DrivenReport::DETACHED, 0);
        for ((pose, angle), z) in poses.iter().zip(angles).zip([-0.2, 0.2]) {
            let [x, y, at_z] = pose.position;
            assert!((0.0..=GAP_TOUCHING_M).contains(&(y - LINK_RADIUS_M)), "{y}");
            assert!(
                (x - 0.6).abs() < 1e-3 && (at_z - z).abs() < 1e-3,
                "{pose:?}"
            );
            let turned =
                Quat::from_array(pose.rotation).angle_between(Quat::from_rotation_y(angle));
            assert!(turned < 1e-3, "{turned}");
        }
    }
}

#[test]
fn arms_do_not_snap_near_while_they_are_tracked_in_each_other() {
    // The links cross 0.2 m on, at 0.3 m along each.
    let crossed = [-0.785, 0.785];
    let (poses, flags) = arms_behind_a_plate(Coupling::SNAP_NEAR, 0.02, crossed);
    assert!(
        poses.iter().all(|pose| pose.position[0] < -0.5),
        "{poses:?}"
    );
    assert_ne!(flags & DrivenReport::DETACHED, 0);
}
