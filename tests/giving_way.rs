//! Loose bodies among hands that stop, give way and are put elsewhere: bugs that were found, each with the test
//! that found it.

mod common;
#[path = "common/loose.rs"]
mod loose;

use common::{Block, add_box, add_piece};
use glam::Vec3;
use loose::{ball, floor, position, surface};
use palpable::frame::{FrameInput, FrameReport};
use palpable::geometry::chain::JointDef;
use palpable::geometry::reach_cone::ReachCone;
use palpable::limits::STILL_SPEED;
use palpable::math::Pose;
use palpable::memory::{BodyId, Capacities, ChainId};
use palpable::state::bodies::{BodyKind, Coupling};
use palpable::state::chains::ChainOptions;
use palpable::world::{BodyDef, ChainDef, PieceDef, Shape, World};

const FRAME_S: f32 = 1.0 / 60.0;

const SMALL: Capacities = Capacities {
    bodies: 4,
    pieces: 16,
    vertices: 128,
    pairs: 16,
    contacts: 16,
    materials: 2,
    chains: 2,
    joints: 9,
};

#[test]
fn what_falls_beside_more_contacts_than_there_is_room_for_stops_at_the_floor() {
    let mut cut = false;
    for impulse_units in [u32::MAX, 40, 30, 25, 20, 15, 10, 5] {
        for step in 0..40_u8 {
            cut |= fall_beside(impulse_units, step);
        }
    }
    assert!(cut, "there was always room");
}

/// Three balls fall to a floor from about the same height; whether there was no room for their contacts.
fn fall_beside(impulse_units: u32, step: u8) -> bool {
    let capacities = Capacities {
        contacts: 1,
        ..SMALL
    };
    let mut block = Block::new(&capacities);
    let mut world = World::create(block.bytes(), &capacities).unwrap();
    surface(&mut world, 0.0, 0.5);
    floor(&mut world);
    let first = 0.3 + 0.005 * f32::from(step);
    let balls = [first, first + 0.02, first + 0.04].map(|height| {
        let x = 10.0 * (height - first);
        ball(&mut world, BodyKind::Dynamic, [x, height, 0.0], 0.05)
    });
    let mut cut = false;
    for frame in 0..60 {
        let mut input = FrameInput::unlimited(FRAME_S);
        input.budget.impulse_units = impulse_units;
        cut |= world.step(&input).flags & FrameReport::FULL_CONTACTS != 0;
        for body in balls {
            let above = position(&world, body)[1] - 0.05;
            assert!(above > -1e-4, "{impulse_units} {step} {frame}: {above} m");
        }
    }
    cut
}

/// Numbers in -1..1 from a seed.
fn noise(seed: &mut u32) -> f32 {
    *seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    (*seed >> 8) as f32 / 8_388_608.0 - 1.0
}

/// Angles of a wrist without pieces, and its cone.
fn add_wrist(world: &mut World, hand: BodyId) -> ChainId {
    let (s, c) = 0.4_f32.sin_cos();
    let corners = [[s, 0.0, c], [0.0, s, c], [-s, 0.0, c], [0.0, -s, c]];
    let cone = ReachCone::new(Vec3::Z, &corners.map(Vec3::from_array)).unwrap();
    let joints = [JointDef::Ball {
        rest: Pose::at(0.0, 0.1, 0.0),
        twist_low_rad: -1.0,
        twist_high_rad: 1.0,
        cone,
    }];
    let def = ChainDef {
        joints: &joints,
        base: None,
        options: ChainOptions::default(),
    };
    world.add_chain(hand, &def).unwrap()
}

/// A hand of two balls presses another ball into a corner. It meets the walls itself while it gives way, so
/// that its ways have several legs.
fn press_into_a_corner(seed: u32, has_wrist: bool) {
    let mut draw = seed * 7919 + 1;
    let mut block = Block::new(&SMALL);
    let mut world = World::create(block.bytes(), &SMALL).unwrap();
    surface(&mut world, 0.0, 0.5);
    let corner = world
        .add_body(&BodyDef::new(BodyKind::Fixed, Pose::IDENTITY))
        .unwrap();
    for (at, half) in [
        ([0.0, -0.1, 0.0], [1.0, 0.1, 1.0]),
        ([-0.1, 0.0, 0.0], [0.1, 1.0, 1.0]),
        ([0.0, 0.0, -0.1], [1.0, 1.0, 0.1]),
    ] {
        let mut wall = PieceDef::new(Shape::Box(half), 0.0);
        wall.local = Pose::at(at[0], at[1], at[2]);
        add_piece(&mut world, corner, &wall);
    }
    let pressed = ball(&mut world, BodyKind::Dynamic, [0.0503; 3], 0.05);
    let hand = ball(&mut world, BodyKind::Driven, [0.2; 3], 0.04);
    let mut thumb = PieceDef::new(Shape::Point, 0.03);
    thumb.local = Pose::at(0.1, 0.02, 0.0);
    let thumb = add_piece(&mut world, hand, &thumb);
    let wrist = has_wrist.then(|| add_wrist(&mut world, hand));
    // An island of its own, which goes last.
    ball(&mut world, BodyKind::Dynamic, [0.0, 50.0, 0.0], 0.05);
    for frame in 0..40 {
        let near = |draw: &mut u32| 0.06 + 0.12 * noise(draw);
        let (x, y, z) = (near(&mut draw), near(&mut draw), near(&mut draw));
        let [a, b, c] = [(); 3].map(|()| 0.5 * noise(&mut draw));
        let w = (1.0 - a * a - b * b - c * c).sqrt();
        let target = Pose {
            rotation: [a, b, c, w],
            ..Pose::at(x, y, z)
        };
        world.set_target(hand, &target).unwrap();
        if let Some(wrist) = wrist {
            let angles = [(); 3].map(|()| noise(&mut draw));
            world.set_angles(wrist, &angles).unwrap();
        }
        world.step(&FrameInput::unlimited(FRAME_S));
        let at = position(&world, pressed);
        let tip = world.piece_pose(thumb).unwrap().position.map(f64::from);
        for (part, radius) in [(position(&world, hand), 0.04), (tip, 0.03)] {
            let away: f64 = (0..3).map(|i| (part[i] - at[i]).powi(2)).sum();
            let gap = away.sqrt() - 0.05 - radius;
            assert!(gap > -1e-4, "{seed} {frame}: {gap} m");
        }
    }
}

#[test]
fn a_hand_that_gives_way_beside_walls_does_not_enter_what_it_presses() {
    for seed in 0..400 {
        press_into_a_corner(seed, false);
    }
}

#[test]
fn a_hand_whose_wrist_is_at_the_edge_of_its_cone_does_not_enter_what_it_presses() {
    for seed in 0..400 {
        press_into_a_corner(seed, true);
    }
}

/// Under a slot that the hand is too wide for, its tracker above it; a small ball flies through where the hand
/// is to be put, and on through the slot to where it is. There is no room for contacts, so nothing bounces.
#[test]
fn a_hand_is_not_put_where_something_flies_by() {
    for step in 0..40_u8 {
        let capacities = Capacities {
            contacts: 0,
            ..SMALL
        };
        let mut block = Block::new(&capacities);
        let mut world = World::create(block.bytes(), &capacities).unwrap();
        world.set_gravity([0.0; 3]);
        for x in [-0.56, 0.56] {
            let half = [0.5, 0.01, 0.5];
            add_box(&mut world, BodyKind::Fixed, Pose::at(x, 0.0, 0.0), half);
        }
        let coupling = Coupling {
            divergence_m: 0.1,
            snap: Coupling::SNAP_WHEN_FREE,
            ..Coupling::DEFAULT
        };
        let def = BodyDef {
            coupling,
            ..BodyDef::new(BodyKind::Driven, Pose::at(0.0, -0.3, 0.0))
        };
        let hand = world.add_body(&def).unwrap();
        add_piece(&mut world, hand, &PieceDef::new(Shape::Point, 0.1));
        let small = ball(&mut world, BodyKind::Dynamic, [0.0, 0.3, 0.0], 0.03);
        for frame in 0..10 {
            world.set_target(hand, &Pose::at(0.0, 0.3, 0.0)).unwrap();
            if frame == 5 {
                let speed = 115.0 + f32::from(step);
                world.place_body(small, &Pose::at(0.0, 2.0, 0.0)).unwrap();
                world
                    .set_velocity(small, [0.0, -speed, 0.0], [0.0; 3])
                    .unwrap();
            }
            world.step(&FrameInput::unlimited(FRAME_S));
            let apart = position(&world, small)[1] - position(&world, hand)[1];
            assert!(apart.abs() > 0.13 - 1e-4, "{step} {frame}: {apart} m");
            // It is not stopped by a hand that did not come.
            assert!(frame != 5 || apart < 0.2, "{step}: {apart} m");
        }
    }
}

#[test]
fn pieces_of_what_falls_asleep_are_where_it_is() {
    let mut block = Block::new(&SMALL);
    let mut world = World::create(block.bytes(), &SMALL).unwrap();
    world.set_gravity([0.0; 3]);
    let body = ball(&mut world, BodyKind::Dynamic, [0.0; 3], 0.05);
    let off_centre = PieceDef {
        local: Pose::at(0.0, 0.0, 0.02),
        ..PieceDef::new(Shape::Point, 0.02)
    };
    let piece = add_piece(&mut world, body, &off_centre);
    // It drifts, but so slowly that it counts as still.
    let slow = 0.4 * STILL_SPEED;
    world
        .set_velocity(body, [slow, 0.0, 0.0], [0.0; 3])
        .unwrap();
    let mut slept = false;
    for frame in 0..60 {
        world.step(&FrameInput::unlimited(FRAME_S));
        let part = world.piece_pose(piece).unwrap();
        let expected = world.pose(body).unwrap().then(&off_centre.local);
        assert_eq!(part.position, expected.position, "{frame}");
        slept |= world.is_asleep(body).unwrap();
    }
    assert!(slept, "it never fell asleep");
}

#[test]
fn what_left_the_world_is_still_in_the_way_of_a_hand() {
    let mut block = Block::new(&SMALL);
    let mut world = World::create(block.bytes(), &SMALL).unwrap();
    world.set_gravity([0.0; 3]);
    let giant = add_box(
        &mut world,
        BodyKind::Dynamic,
        Pose::at(1015.0, 0.0, 0.0),
        [30.0; 3],
    );
    let hand = ball(&mut world, BodyKind::Driven, [970.0, 0.0, 0.0], 0.1);
    world
        .set_velocity(giant, [900.0, 0.0, 0.0], [0.0; 3])
        .unwrap();
    for frame in 0..120 {
        let x = if frame < 60 { 970.0 } else { 1020.0 };
        world.set_target(hand, &Pose::at(x, 0.0, 0.0)).unwrap();
        world.step(&FrameInput::unlimited(FRAME_S));
        let gap = position(&world, giant)[0] - 30.0 - position(&world, hand)[0] - 0.1;
        assert!(gap > -1e-3, "{frame}: {gap} m");
        assert!(frame != 59 || world.is_asleep(giant).unwrap());
    }
    assert!(position(&world, giant)[0] > 1024.0);
    assert!(position(&world, hand)[0] > 990.0);
}
