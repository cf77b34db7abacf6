//! Before a driven body moves it is looked at where it is, pair by pair. Frames that have less than that takes
//! go on where the last one was cut, so that the body gets free after some of them.

mod common;
#[path = "common/loose.rs"]
mod loose;

use common::{Block, add_piece};
use glam::{DQuat, DVec3};
use loose::{ball, floor, position};
use palpable::frame::{Budget, FrameInput, FrameReport};
use palpable::limits::OVERLAP_SLOP_M;
use palpable::math::Pose;
use palpable::memory::{BodyId, Capacities};
use palpable::state::bodies::{BodyKind, Coupling, DrivenReport};
use palpable::world::{BodyDef, PieceDef, Shape, World};

const FRAME_S: f32 = 1.0 / 90.0;
const FINGER_M: f32 = 0.01;
const PLATE_HALF: [f32; 3] = [0.25, 0.3, 0.004];

/// Less than the 26 times 20 queries of the hand's first look.
const FEW: u32 = 40;

fn few() -> FrameInput {
    within(FEW)
}

fn within(advance_units: u32) -> FrameInput {
    FrameInput {
        budget: Budget {
            advance_units,
            ..Budget::UNLIMITED
        },
        ..FrameInput::unlimited(FRAME_S)
    }
}

fn world() -> World<'static> {
    let capacities = Capacities {
        pairs: 2048,
        ..Capacities::ROOM
    };
    let block = Box::leak(Box::new(Block::new(&capacities)));
    World::create(block.bytes(), &capacities).unwrap()
}

/// Where the spheres of a hand are in its frame.
fn fingers() -> impl Iterator<Item = [f32; 3]> {
    (0..26).map(|index| {
        let y = -0.06 + 0.01 * (index / 2) as f32;
        [0.0, y, if index % 2 == 0 { -0.015 } else { 0.015 }]
    })
}

/// A hand of 26 spheres.
fn hand(world: &mut World, at: Pose, coupling: Coupling) -> BodyId {
    let def = BodyDef {
        coupling,
        ..BodyDef::new(BodyKind::Driven, at)
    };
    let hand = world.add_body(&def).unwrap();
    for [x, y, z] in fingers() {
        let def = PieceDef {
            local: Pose::at(x, y, z),
            ..PieceDef::new(Shape::Point, FINGER_M)
        };
        add_piece(world, hand, &def);
    }
    hand
}

/// A plate along x that leans over a hand at the origin, `away` metres from it on one side or the other: its
/// box holds the hand's boxes, and the plate is clear of the hand.
fn leaning(away: f32) -> Pose {
    let half = core::f32::consts::FRAC_PI_8;
    let side = away * core::f32::consts::FRAC_1_SQRT_2;
    Pose {
        rotation: [-half.sin(), 0.0, 0.0, half.cos()],
        position: [0.0, side, side],
    }
}

fn plate(world: &mut World, kind: BodyKind, at: Pose) -> BodyId {
    let plate = world.add_body(&BodyDef::new(kind, at)).unwrap();
    add_piece(world, plate, &PieceDef::new(Shape::Box(PLATE_HALF), 0.0));
    plate
}

/// Ten plates on either side.
fn plates(world: &mut World) -> Vec<BodyId> {
    let away = |index: i32| {
        let outward = 0.09 + 0.01 * (index / 2) as f32;
        if index % 2 == 0 { outward } else { -outward }
    };
    (0..20)
        .map(|index| plate(world, BodyKind::Fixed, leaning(away(index))))
        .collect()
}

fn place(pose: &Pose) -> (DQuat, DVec3) {
    let [x, y, z, w] = pose.rotation.map(f64::from);
    (
        DQuat::from_xyzw(x, y, z, w).normalize(),
        DVec3::from_array(pose.position.map(f64::from)),
    )
}

/// The least distance of a hand's spheres from plates, in double precision from poses and sizes.
fn clearance(world: &World, hand: BodyId, plates: &[BodyId]) -> f64 {
    let (turn, at) = place(&world.pose(hand).unwrap());
    let half = DVec3::from_array(PLATE_HALF.map(f64::from));
    let mut least = f64::INFINITY;
    for &plate in plates {
        let (plate_turn, plate_at) = place(&world.pose(plate).unwrap());
        for finger in fingers() {
            let centre = at + turn * DVec3::from_array(finger.map(f64::from));
            let q = (plate_turn.conjugate() * (centre - plate_at)).abs() - half;
            let gap = q.max(DVec3::ZERO).length() + q.max_element().min(0.0);
            least = least.min(gap - f64::from(FINGER_M));
        }
    }
    least
}

fn check_clear(world: &World, hand: BodyId, plates: &[BodyId], frame: u32) {
    let clear = clearance(world, hand, plates);
    assert!(
        clear > -f64::from(OVERLAP_SLOP_M),
        "frame {frame}: {clear} m"
    );
}

fn is_at(world: &World, body: BodyId, x: f64) -> bool {
    (position(world, body)[0] - x).abs() < 1e-3
}

/// Steps until a hand is at its tracker, `x` metres along the plates; how many frames that took.
fn pull(world: &mut World, hand: BodyId, plates: &[BodyId], x: f32, input: &FrameInput) -> u32 {
    for frame in 0..600 {
        world.set_target(hand, &Pose::at(x, 0.0, 0.0)).unwrap();
        let report = world.step(input);
        assert!(report.advance_units <= input.budget.advance_units);
        check_clear(world, hand, plates, frame);
        if is_at(world, hand, f64::from(x)) {
            return frame;
        }
    }
    panic!("still at {:?}", position(world, hand));
}

#[test]
fn a_hand_gets_out_though_a_frame_has_less_than_its_first_look() {
    for units in [24, FEW, 300] {
        let mut world = world();
        let plates = plates(&mut world);
        let hand = hand(&mut world, Pose::IDENTITY, Coupling::DEFAULT);
        assert!(clearance(&world, hand, &plates) > 0.01);
        pull(&mut world, hand, &plates, 0.5, &within(units));
    }
}

#[test]
fn a_tracker_that_never_rests_is_followed_as_well() {
    let mut world = world();
    let plates = plates(&mut world);
    let hand = hand(&mut world, Pose::IDENTITY, Coupling::DEFAULT);
    let mut reached = 0.0_f64;
    for frame in 0..400 {
        let shake = 0.002 * (frame % 3) as f32;
        let target = Pose::at(0.5 + shake, shake, -shake);
        world.set_target(hand, &target).unwrap();
        world.step(&few());
        check_clear(&world, hand, &plates, frame);
        reached = reached.max(position(&world, hand)[0]);
    }
    assert!(reached > 0.49, "{reached} m");
}

/// A post in front of every sphere of a hand 1 m above the origin, which it meets 50 mm farther on.
fn posts(world: &mut World) {
    for [_, y, z] in fingers() {
        let def = BodyDef::new(BodyKind::Fixed, Pose::at(0.26, 1.0 + y, z));
        let post = world.add_body(&def).unwrap();
        let shape = Shape::Box([0.2, 0.004, 0.004]);
        add_piece(world, post, &PieceDef::new(shape, 0.0));
    }
}

#[test]
fn a_hand_that_rests_on_many_posts_gets_off_them() {
    let mut world = world();
    posts(&mut world);
    let hand = hand(&mut world, Pose::at(0.0, 1.0, 0.0), Coupling::DEFAULT);
    for _ in 0..60 {
        world.set_target(hand, &Pose::at(0.2, 1.0, 0.0)).unwrap();
        world.step(&FrameInput::unlimited(FRAME_S));
    }
    let rests = position(&world, hand)[0];
    assert!((rests - 0.05).abs() < 2e-4, "{rests}");
    for _ in 0..400 {
        world.set_target(hand, &Pose::at(-0.3, 1.0, 0.0)).unwrap();
        world.step(&within(8));
        assert!(position(&world, hand)[0] < 0.05 + 1e-4);
    }
    assert!(is_at(&world, hand, -0.3), "{:?}", position(&world, hand));
}

#[test]
fn a_hand_that_is_never_through_leaves_others_their_turns() {
    let mut world = world();
    posts(&mut world);
    let presses = hand(&mut world, Pose::at(0.0, 1.0, 0.0), Coupling::DEFAULT);
    floor(&mut world);
    let other = ball(&mut world, BodyKind::Driven, [0.5, 0.2, 0.0], 0.02);
    let mut cut = 0;
    for frame in 0..300 {
        let slides = 0.001 * (frame % 3) as f32;
        let target = Pose::at(0.2, 1.0 + slides, -slides);
        world.set_target(presses, &target).unwrap();
        let aside = Pose::at(0.5, -0.1, 0.001 * frame as f32);
        world.set_target(other, &aside).unwrap();
        world.step(&within(8));
        assert!(position(&world, presses)[0] < 0.05 + 1e-4);
        let flags = world.driven_report(presses).unwrap().flags;
        cut += u32::from(flags & DrivenReport::CUT != 0);
    }
    println!("{cut}");
    assert!(cut > 200, "{cut} frames were cut");
    let [_, _, z] = position(&world, other);
    assert!(z > 0.25, "left behind at {z} m");
}

#[test]
fn a_neighbour_that_moves_in_each_frame_does_not_hold_a_hand_for_ever() {
    let mut world = world();
    let plates = plates(&mut world);
    let hand = hand(&mut world, Pose::IDENTITY, Coupling::DEFAULT);
    // Crosswise to the others, below the hand.
    let along = |frame: u32| {
        let turned = leaning(0.0);
        Pose {
            rotation: [-turned.rotation[0], 0.0, 0.0, turned.rotation[3]],
            position: [0.3, -0.4, 0.4 + 0.001 * (frame % 20) as f32],
        }
    };
    let neighbour = plate(&mut world, BodyKind::Driven, along(0));
    let mut all = plates.clone();
    all.push(neighbour);
    assert!(clearance(&world, hand, &all) > 0.01);
    for frame in 0..600 {
        world.set_target(neighbour, &along(frame)).unwrap();
        world.set_target(hand, &Pose::at(0.5, 0.0, 0.0)).unwrap();
        world.step(&few());
        check_clear(&world, hand, &plates, frame);
        let clear = clearance(&world, hand, &all);
        assert!(clear > -1e-3, "frame {frame}: {clear} m");
        if is_at(&world, hand, 0.5) {
            return;
        }
    }
    panic!("still at {:?}", position(&world, hand));
}

/// The first and the second of them shake among the plates for ever.
#[test]
fn hands_take_turns_though_none_is_ever_through_in_one_frame() {
    let mut world = world();
    let plates = plates(&mut world);
    let from = [0.0, -0.1, 0.1];
    let hands = from.map(|x| hand(&mut world, Pose::at(x, 0.0, 0.0), Coupling::DEFAULT));
    for frame in 0..1200_u32 {
        for index in 0..2 {
            let shake = 0.02 * (frame % 2) as f32;
            let target = Pose::at(from[index] - shake, 0.0, 0.0);
            world.set_target(hands[index], &target).unwrap();
        }
        world
            .set_target(hands[2], &Pose::at(0.6, 0.0, 0.0))
            .unwrap();
        world.step(&within(20));
        for hand in hands {
            check_clear(&world, hand, &plates, frame);
        }
        if is_at(&world, hands[2], 0.6) {
            return;
        }
    }
    panic!("still at {:?}", hands.map(|hand| position(&world, hand)));
}

#[test]
fn a_hand_that_would_snap_to_its_tracker_gets_out_too() {
    let mut world = world();
    let plates = plates(&mut world);
    let coupling = Coupling {
        snap: Coupling::SNAP_WHEN_FREE,
        divergence_m: 0.05,
        ..Coupling::DEFAULT
    };
    let hand = hand(&mut world, Pose::IDENTITY, coupling);
    // The tracker stays among the plates.
    for _ in 0..600 {
        world.set_target(hand, &Pose::at(0.2, 0.0, 0.0)).unwrap();
        world.step(&few());
        check_clear(&world, hand, &plates, 0);
    }
    assert!(is_at(&world, hand, 0.2), "{:?}", position(&world, hand));
}

/// What was seen of a plate counts no longer when the host has moved it, or put another one in its slot.
#[test]
fn what_the_host_changes_is_looked_at_again() {
    for replaced in [false, true] {
        for changed_in in 0..24 {
            let mut world = world();
            let mut plates = plates(&mut world);
            let hand = hand(&mut world, Pose::IDENTITY, Coupling::DEFAULT);
            // Across the hand's way, and just clear of it.
            let quarter = core::f32::consts::FRAC_1_SQRT_2;
            let across = Pose {
                rotation: [0.0, quarter, 0.0, quarter],
                position: [FINGER_M + 0.005, 0.0, 0.0],
            };
            for frame in 0..120 {
                if frame == changed_in {
                    if replaced {
                        world.remove_body(plates[3]).unwrap();
                        plates[3] = plate(&mut world, BodyKind::Fixed, across);
                    } else {
                        world.place_body(plates[3], &across).unwrap();
                    }
                    if clearance(&world, hand, &plates) < 0.0 {
                        break;
                    }
                }
                world.set_target(hand, &Pose::at(0.5, 0.0, 0.0)).unwrap();
                world.step(&few());
                check_clear(&world, hand, &plates, frame);
            }
        }
    }
}

#[test]
fn a_world_that_is_rolled_back_goes_on_from_where_it_was_cut() {
    let mut world = world();
    plates(&mut world);
    let hand = hand(&mut world, Pose::IDENTITY, Coupling::DEFAULT);
    let step = |world: &mut World| {
        world.set_target(hand, &Pose::at(0.5, 0.0, 0.0)).unwrap();
        let report = world.step(&few());
        (report.spent(), world.hash())
    };
    for _ in 0..5 {
        step(&mut world);
    }
    let mut saved = vec![0; world.snapshot_bytes()];
    world.save(&mut saved).unwrap();
    let first: Vec<_> = (0..60).map(|_| step(&mut world)).collect();
    world.load(&saved).unwrap();
    let again: Vec<_> = (0..60).map(|_| step(&mut world)).collect();
    assert!(first == again);
}

#[test]
fn the_reported_units_replay_looks_that_were_cut() {
    let scene = || {
        let mut world = world();
        plates(&mut world);
        let hand = hand(&mut world, Pose::IDENTITY, Coupling::DEFAULT);
        ball(&mut world, BodyKind::Dynamic, [0.3, 0.0, 0.0], 0.02);
        (world, hand)
    };
    let ((mut first, hand), (mut twin, _)) = (scene(), scene());
    let mut cut = 0;
    for frame in 0..200_u32 {
        let budget = Budget {
            advance_units: 7 + (frame * 37) % 101,
            ..Budget::UNLIMITED
        };
        for world in [&mut first, &mut twin] {
            world.set_target(hand, &Pose::at(0.5, 0.0, 0.0)).unwrap();
        }
        let of = |budget| FrameInput {
            budget,
            ..FrameInput::unlimited(FRAME_S)
        };
        let report = first.step(&of(budget));
        let again = twin.step(&of(report.spent()));
        assert_eq!(again.spent(), report.spent(), "frame {frame}");
        assert_eq!(first.hash(), twin.hash(), "frame {frame}");
        cut += u32::from(report.flags & FrameReport::ADVANCE_CUT != 0);
    }
    assert!(cut > 5, "{cut} frames were cut");
    let flags = first.driven_report(hand).unwrap().flags;
    assert_eq!(flags & DrivenReport::CUT, 0);
}
