//! What hosts do to loose bodies and learn of them: contact events, forces, sleep, and what hands feel.
//! Everything is judged from outside in f64.

mod common;
#[path = "common/loose.rs"]
mod loose;

use common::{Block, add_box, add_piece};
use loose::{ball, floor, position, surface};
use palpable::frame::{FrameInput, FrameReport};
use palpable::math::Pose;
use palpable::memory::{BodyId, Capacities};
use palpable::state::bodies::{BodyKind, Coupling};
use palpable::state::events::ContactEvent;
use palpable::world::{BodyDef, BodyError, PieceDef, Shape, World};

const FRAME_S: f32 = 1.0 / 90.0;
const SECOND: u32 = 90;
const GRAVITY: f64 = 9.81;

fn step(world: &mut World) -> FrameReport {
    world.step(&FrameInput::unlimited(FRAME_S))
}

fn steps(world: &mut World, frames: u32) {
    for _ in 0..frames {
        step(world);
    }
}

fn velocity(world: &World, body: BodyId) -> [f64; 3] {
    world.velocity(body).unwrap().0.map(f64::from)
}

fn spin(world: &World, body: BodyId) -> [f64; 3] {
    world.velocity(body).unwrap().1.map(f64::from)
}

fn mass(world: &World, body: BodyId) -> f64 {
    f64::from(world.mass_kg(body).unwrap())
}

/// How many events of a kind the last frame had.
fn count(world: &World, kind: u32) -> usize {
    let events = world.contact_events().iter();
    events.filter(|event| event.kind == kind).count()
}

/// A ball of this mass, in kg.
fn weighed_ball(world: &mut World, at: [f32; 3], radius_m: f32, mass_kg: f64) -> BodyId {
    let body = BodyDef::new(BodyKind::Dynamic, Pose::at(at[0], at[1], at[2]));
    let body = world.add_body(&body).unwrap();
    let volume = 4.0 / 3.0 * std::f64::consts::PI * f64::from(radius_m).powi(3);
    let piece = PieceDef {
        density_kg_m3: (mass_kg / volume) as f32,
        ..PieceDef::new(Shape::Point, radius_m)
    };
    add_piece(world, body, &piece);
    body
}

/// A box of this mass, in kg.
fn weighed_box(world: &mut World, pose: Pose, half: [f32; 3], mass_kg: f64) -> BodyId {
    let body = world
        .add_body(&BodyDef::new(BodyKind::Dynamic, pose))
        .unwrap();
    let volume = 8.0 * half.iter().map(|h| f64::from(*h)).product::<f64>();
    let piece = PieceDef {
        density_kg_m3: (mass_kg / volume) as f32,
        ..PieceDef::new(Shape::Box(half), 0.0)
    };
    add_piece(world, body, &piece);
    body
}

/// A driven box with this coupling.
fn palm(world: &mut World, pose: Pose, half: [f32; 3], coupling: Coupling) -> BodyId {
    let def = BodyDef {
        coupling,
        ..BodyDef::new(BodyKind::Driven, pose)
    };
    let body = world.add_body(&def).unwrap();
    add_piece(world, body, &PieceDef::new(Shape::Box(half), 0.0));
    body
}

#[test]
fn an_impact_begins_with_the_speed_of_the_fall() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    surface(&mut world, 0.0, 0.3);
    floor(&mut world);
    let body = ball(&mut world, BodyKind::Dynamic, [0.0, 1.1, 0.0], 0.1);
    for frame in 1..=60 {
        step(&mut world);
        let begun = world.contact_events();
        let begun: Vec<_> = begun
            .iter()
            .filter(|e| e.kind == ContactEvent::BEGIN)
            .collect();
        if begun.is_empty() {
            assert!(world.contact_events().is_empty(), "frame {frame}");
            continue;
        }
        assert_eq!(begun.len(), 1);
        // A metre of free fall: (2 g h)^1/2.
        let speed = (2.0 * GRAVITY).sqrt();
        let approach = f64::from(begun[0].approach_m_s);
        assert!((approach / speed - 1.0).abs() < 0.01, "{approach} m/s");
        assert!(f64::from(begun[0].point[1]).abs() < 1e-3, "{:?}", begun[0]);
        assert!((f64::from(begun[0].normal[1]) - 1.0).abs() < 1e-5);
        // The impact takes all momentum, and what is left of the frame carries the weight.
        let least = mass(&world, body) * speed;
        let most = least + mass(&world, body) * GRAVITY * f64::from(FRAME_S);
        let impulse = f64::from(begun[0].impulse_n_s);
        assert!(
            impulse > 0.99 * least && impulse < 1.01 * most,
            "{impulse} N s"
        );
        // (2 h / g)^1/2.
        let time = (2.0 / GRAVITY).sqrt();
        assert!((f64::from(frame) * f64::from(FRAME_S) - time).abs() < 0.02);
        return;
    }
    panic!("nothing began");
}

#[test]
fn what_rolls_stays_and_what_is_lifted_ends() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    surface(&mut world, 0.0, 0.5);
    floor(&mut world);
    let body = ball(&mut world, BodyKind::Dynamic, [0.0, 0.101, 0.0], 0.1);
    world
        .set_velocity(body, [1.0, 0.0, 0.0], [0.0, 0.0, -10.0])
        .unwrap();
    steps(&mut world, SECOND / 2);
    for frame in 0..SECOND {
        step(&mut world);
        let told: Vec<u32> = world.contact_events().iter().map(|e| e.kind).collect();
        assert_eq!(told, [ContactEvent::STAY], "frame {frame}");
        let stays = world.contact_events()[0];
        // It rolls: its lowest point stands still.
        assert!(stays.slide_m_s < 0.02, "{} m/s", stays.slide_m_s);
        let under = f64::from(stays.point[0]) - position(&world, body)[0];
        assert!(under.abs() < 0.02, "{under}");
    }
    world.set_velocity(body, [0.0, 3.0, 0.0], [0.0; 3]).unwrap();
    let mut ended = 0;
    for _ in 0..10 {
        step(&mut world);
        ended += count(&world, ContactEvent::END);
        assert_eq!(count(&world, ContactEvent::BEGIN), 0);
    }
    assert_eq!(ended, 1);
    assert!(world.contact_events().is_empty());
}

#[test]
fn a_sleeping_box_sends_no_end() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    floor(&mut world);
    let body = add_box(
        &mut world,
        BodyKind::Dynamic,
        Pose::at(0.0, 0.051, 0.0),
        [0.05; 3],
    );
    let (mut begun, mut slept) = (0, false);
    for frame in 0..3 * SECOND {
        step(&mut world);
        begun += count(&world, ContactEvent::BEGIN);
        assert_eq!(count(&world, ContactEvent::END), 0, "frame {frame}");
        if slept {
            assert!(world.contact_events().is_empty(), "frame {frame}");
        }
        slept |= world.is_asleep(body).unwrap();
    }
    assert!(slept);
    assert_eq!(begun, 1);
    // Woken and thrown up, it parts, once.
    world.set_velocity(body, [0.0, 2.0, 0.0], [0.0; 3]).unwrap();
    let mut ended = 0;
    for _ in 0..10 {
        step(&mut world);
        ended += count(&world, ContactEvent::END);
        assert_eq!(count(&world, ContactEvent::BEGIN), 0);
    }
    assert_eq!(ended, 1);
}

#[test]
fn a_full_buffer_drops_what_stays_first() {
    let capacities = Capacities {
        contacts: 2,
        ..Capacities::ROOM
    };
    let mut block = Block::new(&capacities);
    let mut world = World::create(block.bytes(), &capacities).unwrap();
    surface(&mut world, 0.0, 0.3);
    floor(&mut world);
    // Islands of their own, a contact each.
    let resting = [-1.0, 1.0].map(|x| ball(&mut world, BodyKind::Dynamic, [x, 0.1003, 0.0], 0.1));
    steps(&mut world, 5);
    assert_eq!(count(&world, ContactEvent::STAY), 2);
    // One is taken away while a third one arrives.
    world
        .place_body(resting[0], &Pose::at(-1.0, 3.0, 0.0))
        .unwrap();
    let third = ball(&mut world, BodyKind::Dynamic, [3.0, 0.1003, 0.0], 0.1);
    world
        .set_velocity(third, [0.0, -1.0, 0.0], [0.0; 3])
        .unwrap();
    let report = step(&mut world);
    assert_eq!(count(&world, ContactEvent::BEGIN), 1);
    assert_eq!(count(&world, ContactEvent::END), 1);
    assert_eq!(count(&world, ContactEvent::STAY), 0);
    assert_eq!((report.events, report.events_dropped), (2, 1));
    // Once both are told, what stays is told again.
    let report = step(&mut world);
    assert_eq!(count(&world, ContactEvent::STAY), 2);
    assert_eq!((report.events, report.events_dropped), (2, 0));
}

#[test]
fn a_constant_force_and_torque_give_their_momentum() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    world.set_gravity([0.0; 3]);
    let body = weighed_ball(&mut world, [0.0; 3], 0.1, 2.0);
    let (force, torque) = ([3.0, -1.0, 0.5], [0.02, 0.0, -0.01]);
    for _ in 0..SECOND {
        // Two calls add up.
        for _ in 0..2 {
            let half = |v: [f32; 3]| v.map(|x| 0.5 * x);
            world.apply_force(body, half(force), half(torque)).unwrap();
        }
        step(&mut world);
    }
    // A solid ball's 2/5 m r^2.
    let inertia = 0.4 * mass(&world, body) * 0.01;
    for axis in 0..3 {
        // Ninety sums of f32, and the way by the mean speed of every frame.
        let gained = f64::from(force[axis]) / mass(&world, body);
        assert!((velocity(&world, body)[axis] - gained).abs() < 1e-5);
        assert!((position(&world, body)[axis] - 0.5 * gained).abs() < 1e-5);
        let turned = f64::from(torque[axis]) / inertia;
        assert!((spin(&world, body)[axis] - turned).abs() < 1e-4);
    }
    let before = velocity(&world, body);
    step(&mut world);
    assert_eq!(
        velocity(&world, body),
        before,
        "a force lasts for one frame"
    );
}

#[test]
fn an_impulse_acts_at_its_point() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    world.set_gravity([0.0; 3]);
    let body = weighed_ball(&mut world, [1.0, 2.0, 3.0], 0.1, 2.0);
    world
        .apply_impulse(body, [0.0, 0.0, 4.0], [1.1, 2.0, 3.0])
        .unwrap();
    // 4 N s on 2 kg; 0.1 m x 4 N s on 2/5 m r^2 = 0.008 kg m2.
    let (v, w) = (velocity(&world, body), spin(&world, body));
    assert!((v[2] - 2.0).abs() < 1e-5, "{v:?}");
    assert!((w[1] + 50.0).abs() < 1e-3, "{w:?}");
    step(&mut world);
    assert_eq!(velocity(&world, body), v);
}

#[test]
fn forces_and_impulses_wake() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    floor(&mut world);
    let body = weighed_box(&mut world, Pose::at(0.0, 0.1003, 0.0), [0.1; 3], 1.0);
    steps(&mut world, 2 * SECOND);
    assert!(world.is_asleep(body).unwrap());
    world.apply_force(body, [10.0, 0.0, 0.0], [0.0; 3]).unwrap();
    assert!(!world.is_asleep(body).unwrap());
    step(&mut world);
    // 10 N against 0.3 of the weight.
    let speed = (10.0 - 0.3 * GRAVITY) * f64::from(FRAME_S);
    let found = velocity(&world, body)[0];
    assert!((found - speed).abs() < 0.01 * speed, "{found} not {speed}");
    steps(&mut world, 2 * SECOND);
    assert!(world.is_asleep(body).unwrap());
    let centre = world.pose(body).unwrap().position;
    world.apply_impulse(body, [0.0, 2.0, 0.0], centre).unwrap();
    assert!(!world.is_asleep(body).unwrap());
    assert!((velocity(&world, body)[1] - 2.0).abs() < 1e-5);
}

/// Three boxes on each other, on the floor.
fn stack(world: &mut World, x: f32) -> [BodyId; 3] {
    [0.0503, 0.1506, 0.2509]
        .map(|y| add_box(world, BodyKind::Dynamic, Pose::at(x, y, 0.0), [0.05; 3]))
}

#[test]
fn a_stack_sleeps_and_wakes_as_one() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    floor(&mut world);
    let (near, far) = (stack(&mut world, 0.0), stack(&mut world, 3.0));
    let sleepers = |world: &World, bodies: [BodyId; 3]| {
        bodies
            .iter()
            .filter(|b| world.is_asleep(**b).unwrap())
            .count()
    };
    for frame in 0..3 * SECOND {
        step(&mut world);
        let asleep = sleepers(&world, near);
        assert!(asleep == 0 || asleep == 3, "frame {frame}: {asleep} sleep");
    }
    assert_eq!((sleepers(&world, near), sleepers(&world, far)), (3, 3));
    let rest = far.map(|body| world.pose(body).unwrap());
    world
        .apply_impulse(near[2], [0.2, 0.0, 0.0], [0.0, 0.25, 0.0])
        .unwrap();
    step(&mut world);
    assert_eq!((sleepers(&world, near), sleepers(&world, far)), (0, 3));
    steps(&mut world, 3 * SECOND);
    assert_eq!((sleepers(&world, near), sleepers(&world, far)), (3, 3));
    assert_eq!(far.map(|body| world.pose(body).unwrap()), rest);
}

/// A hand that runs at 1 m/s, from `away_m` before it, into a ball as heavy as its coupling; how far the hand
/// was behind its target at the most, and the ball's fastest speed.
fn run_into(push: u32, away_m: f32) -> (f64, f64) {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    world.set_gravity([0.0; 3]);
    surface(&mut world, 0.0, 0.0);
    let coupling = Coupling {
        push,
        ..Coupling::DEFAULT
    };
    let hand = palm(
        &mut world,
        Pose::at(-0.07 - away_m, 0.0, 0.0),
        [0.02, 0.05, 0.05],
        coupling,
    );
    let struck = weighed_ball(&mut world, [0.0; 3], 0.05, f64::from(coupling.mass_kg));
    let (mut behind, mut fastest) = (0.0_f64, 0.0_f64);
    for frame in 1..=SECOND {
        let target = Pose::at(-0.07 - away_m + frame as f32 * FRAME_S, 0.0, 0.0);
        world.set_target(hand, &target).unwrap();
        step(&mut world);
        let lag = f64::from(target.position[0]) - position(&world, hand)[0];
        behind = behind.max(lag);
        fastest = fastest.max(velocity(&world, struck)[0]);
        let gap = position(&world, struck)[0] - position(&world, hand)[0] - 0.07;
        assert!(gap > -1e-3, "frame {frame}: {gap}");
        if push == Coupling::PUSH_WITHOUT_LAG {
            assert_eq!(world.pose(hand).unwrap(), target, "frame {frame}");
        }
    }
    (behind, fastest)
}

#[test]
fn a_hand_that_pushes_without_lag_equals_its_target() {
    let (behind, fastest) = run_into(Coupling::PUSH_WITHOUT_LAG, 0.23);
    assert_eq!(behind, 0.0);
    assert!((fastest - 1.0).abs() < 0.02, "{fastest}");
}

#[test]
fn a_hand_that_pushes_with_its_mass_lags_behind_its_target() {
    // It touches the ball before it sets out: a hit in the middle of a frame is one without lag. Both go on
    // at half the speed; the spring between the tracker and the two masses of 0.4 kg then lets them fall
    // behind by v / 2w e^-at sin(wt) = 6.4 mm (a = w = 25 / s, wt = pi / 4), with the coupling's mass counted
    // up to twice (`held_mass_kg` in the kernel) by less.
    let (behind, fastest) = run_into(Coupling::PUSH_WITH_MASS, 1e-4);
    assert!((1e-3..0.02).contains(&behind), "{behind} m behind");
    // The spring brings both up to the tracker's speed, and a little past it.
    assert!((0.9..1.4).contains(&fastest), "{fastest} m/s");
}

#[test]
fn a_palm_feels_the_weight_that_it_carries() {
    for push in [Coupling::PUSH_WITHOUT_LAG, Coupling::PUSH_WITH_MASS] {
        let mut block = Block::new(&Capacities::ROOM);
        let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
        let coupling = Coupling {
            push,
            ..Coupling::DEFAULT
        };
        let start = Pose::at(0.0, 1.0, 0.0);
        let hand = palm(&mut world, start, [0.1, 0.01, 0.1], coupling);
        let carried = weighed_box(&mut world, Pose::at(0.0, 1.0603, 0.0), [0.05; 3], 0.3);
        let mut force = 0.0;
        let mut measured = 0;
        for frame in 1..=2 * SECOND {
            // Evenly up, so that it feels the weight alone and nothing sleeps.
            let up = 0.2 * frame as f32 * FRAME_S;
            world
                .set_target(hand, &Pose::at(0.0, 1.0 + up, 0.0))
                .unwrap();
            step(&mut world);
            let felt = world.driven_report(hand).unwrap().reaction_n.map(f64::from);
            if frame > SECOND {
                force += felt[1];
                measured += 1;
                let weight = mass(&world, carried) * GRAVITY;
                assert!(
                    (felt[1] / weight + 1.0).abs() < 0.01,
                    "push {push}, frame {frame}: {felt:?} N"
                );
                assert!(
                    felt[0].abs().max(felt[2].abs()) < 0.01 * weight,
                    "{felt:?} N"
                );
            }
        }
        let weight = mass(&world, carried) * GRAVITY;
        assert!((force / f64::from(measured) / weight + 1.0).abs() < 0.01);
    }
}

#[test]
fn a_squeeze_is_felt_as_the_spring_says() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    surface(&mut world, 0.0, 0.5);
    floor(&mut world);
    let held = weighed_box(&mut world, Pose::at(0.0, 0.0503, 0.0), [0.05; 3], 0.3);
    let hands = [-1.0_f32, 1.0].map(|side| {
        let start = Pose::at(0.08 * side, 0.07, 0.0);
        (
            side,
            palm(&mut world, start, [0.01, 0.04, 0.05], Coupling::DEFAULT),
        )
    });
    for frame in 1..=2 * SECOND {
        // 10 mm into each side.
        let x = 0.08 - 0.03 * (frame as f32 / SECOND as f32).min(1.0);
        for (side, hand) in hands {
            world
                .set_target(hand, &Pose::at(x * side, 0.07, 0.0))
                .unwrap();
        }
        step(&mut world);
    }
    let off = position(&world, held)[0];
    for (side, hand) in hands {
        let report = world.driven_report(hand).unwrap();
        let target = 0.05 * f64::from(side);
        let displaced = position(&world, hand)[0] - target;
        let force = f64::from(report.force_n[0]);
        // The spring pulls the hand to where its body is held.
        let spring = f64::from(Coupling::DEFAULT.stiffness_n_per_m) * displaced;
        println!(
            "hand {side}: {displaced} m, {force} N, felt {:?}, box at {off}",
            report.reaction_n
        );
        assert!(
            (force / spring - 1.0).abs() < 0.05,
            "{force} N for {displaced} m"
        );
        assert!((displaced.abs() - 0.01).abs() < 1e-3, "{displaced} m");
        let felt = f64::from(report.reaction_n[0]);
        assert!(
            (felt / spring - 1.0).abs() < 0.05,
            "{felt} N for {displaced} m"
        );
    }
}

#[test]
fn bad_input_is_refused_and_changes_nothing() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let ground = floor(&mut world);
    let hand = ball(&mut world, BodyKind::Driven, [2.0, 0.5, 0.0], 0.05);
    let body = ball(&mut world, BodyKind::Dynamic, [0.0, 0.5, 0.0], 0.1);
    let gone = ball(&mut world, BodyKind::Dynamic, [1.0, 0.5, 0.0], 0.1);
    world.remove_body(gone).unwrap();
    let before = world.hash();
    for bad in [f32::NAN, f32::INFINITY, -f32::INFINITY, 2e9] {
        for axis in 0..3 {
            let mut wrong = [0.0; 3];
            wrong[axis] = bad;
            assert_eq!(
                world.apply_force(body, wrong, [0.0; 3]),
                Err(BodyError::BadForce)
            );
            assert_eq!(
                world.apply_force(body, [0.0; 3], wrong),
                Err(BodyError::BadForce)
            );
            assert_eq!(
                world.apply_impulse(body, wrong, [0.0; 3]),
                Err(BodyError::BadForce)
            );
            assert_eq!(
                world.apply_impulse(body, [1.0; 3], wrong),
                Err(BodyError::BadPose)
            );
            assert_eq!(
                world.set_velocity(body, wrong, [0.0; 3]),
                Err(BodyError::BadVelocity)
            );
        }
    }
    for (id, error) in [
        (gone, BodyError::Stale),
        (ground, BodyError::WrongKind),
        (hand, BodyError::WrongKind),
    ] {
        assert_eq!(world.apply_force(id, [1.0; 3], [0.0; 3]), Err(error));
        assert_eq!(world.apply_impulse(id, [1.0; 3], [0.0; 3]), Err(error));
        assert_eq!(world.set_velocity(id, [1.0; 3], [0.0; 3]), Err(error));
        assert_eq!(world.velocity(id), Err(error));
        assert_eq!(world.is_asleep(id), Err(error));
        assert_eq!(world.mass_kg(id), Err(error));
    }
    assert_eq!(world.hosted_impulse(body), Err(BodyError::WrongKind));
    assert_eq!(world.driven_report(body), Err(BodyError::WrongKind));
    assert_eq!(world.hash(), before);
}
