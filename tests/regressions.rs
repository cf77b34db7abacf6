//! Bugs that were found, each with the test that found it.

mod common;
#[path = "common/loose.rs"]
mod loose;

use common::{Block, add_box, add_piece};
use glam::{Quat, Vec3};
use loose::{ball, floor, lowest_corner, position, surface};
use palpable::frame::{FrameInput, FrameReport};
use palpable::limits::{
    DENSITY_MAX, FORCE_MAX, FRICTION_MAX, LOOSE_REST_M, OVERLAP_SLOP_M, SPEED_MAX, SPIN_MAX,
    WORLD_REACH_M,
};
use palpable::math::Pose;
use palpable::memory::{BodyId, Capacities, PieceId};
use palpable::state::bodies::{BodyKind, Coupling};
use palpable::state::materials::{Material, Surface};
use palpable::world::{AddPieceError, BodyDef, PieceDef, Shape, World};

const FRAME_S: f32 = 1.0 / 60.0;

fn speed(world: &World, body: BodyId) -> f64 {
    let (v, _) = world.velocity(body).unwrap();
    v.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn a_sliding_block_stops_after_the_right_time_and_way() {
    // HARD_CASES: 2 m/s, mu = .3: after 0.679579 s and 0.679579 m.
    let half = [0.1, 0.02, 0.1];
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    surface(&mut world, 0.0, 0.3);
    floor(&mut world);
    let slider = add_box(
        &mut world,
        BodyKind::Dynamic,
        Pose::at(0.0, 0.02 + LOOSE_REST_M, 0.0),
        half,
    );
    world
        .set_velocity(slider, [2.0, 0.0, 0.0], [0.0; 3])
        .unwrap();
    let dt_s = 1.0 / 240.0;
    let mut stopped_s = None;
    for frame in 1..=240 {
        world.step(&FrameInput::unlimited(dt_s));
        assert!(lowest_corner(&world.pose(slider).unwrap(), half) > 0.0);
        // One frame's friction is 12 mm/s.
        if stopped_s.is_none() && speed(&world, slider) < 0.012 {
            stopped_s = Some(f64::from(frame) / 240.0);
        }
    }
    let stopped_s = stopped_s.expect("friction stops it within a second");
    assert!((stopped_s / 0.679_579 - 1.0).abs() < 0.05, "{stopped_s} s");
    let way = position(&world, slider)[0];
    assert!((way / 0.679_579 - 1.0).abs() < 0.05, "{way} m");
    assert!(position(&world, slider)[2].abs() < 0.01);
}

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
fn driven_contacts_beyond_the_capacity_are_reported() {
    let capacities = Capacities {
        contacts: 0,
        ..SMALL
    };
    let mut block = Block::new(&capacities);
    let mut world = World::create(block.bytes(), &capacities).unwrap();
    floor(&mut world);
    let hand = add_box(
        &mut world,
        BodyKind::Driven,
        Pose::at(0.0, 0.2, 0.0),
        [0.05; 3],
    );
    let mut flags = 0;
    for _ in 0..30 {
        world.set_target(hand, &Pose::at(0.0, -0.1, 0.0)).unwrap();
        flags |= world.step(&FrameInput::unlimited(FRAME_S)).flags;
    }
    assert_ne!(flags & FrameReport::FULL_CONTACTS, 0);
}

#[test]
fn pairs_full_for_loose_bodies_are_reported() {
    let capacities = Capacities { pairs: 0, ..SMALL };
    let mut block = Block::new(&capacities);
    let mut world = World::create(block.bytes(), &capacities).unwrap();
    floor(&mut world);
    add_box(
        &mut world,
        BodyKind::Dynamic,
        Pose::at(0.0, 0.06, 0.0),
        [0.05; 3],
    );
    let mut flags = 0;
    for _ in 0..30 {
        flags |= world.step(&FrameInput::unlimited(FRAME_S)).flags;
    }
    assert_ne!(flags & FrameReport::FULL_PAIRS, 0, "{flags}");
}

fn press_with(coupling: Coupling) -> Option<Pose> {
    let mut block = Block::new(&SMALL);
    let mut world = World::create(block.bytes(), &SMALL).unwrap();
    floor(&mut world);
    let def = BodyDef {
        coupling,
        ..BodyDef::new(BodyKind::Driven, Pose::at(0.0, 0.2, 0.0))
    };
    let hand = world.add_body(&def).ok()?;
    add_piece(&mut world, hand, &PieceDef::new(Shape::Box([0.05; 3]), 0.0));
    for frame in 0..60 {
        world
            .set_target(
                hand,
                &Pose::at(0.0, if frame < 30 { -0.1 } else { 0.3 }, 0.0),
            )
            .unwrap();
        world.step(&FrameInput::unlimited(FRAME_S));
        let pose = world.pose(hand).unwrap();
        let r = world.driven_report(hand).unwrap();
        assert!(
            pose.is_finite()
                && r.force_n.iter().all(|x| x.is_finite())
                && r.displacement_m.is_finite(),
            "{coupling:?} {frame} {pose:?} {r:?}"
        );
    }
    Some(world.pose(hand).unwrap())
}
#[test]
fn no_coupling_makes_a_pose_that_is_not_finite() {
    let usual = Coupling::DEFAULT;
    let masses = [1e-44, 1e-38, 1e-6, 0.1, 1e6, 3e38].map(|mass_kg| Coupling { mass_kg, ..usual });
    let springs = [0.0, 1e9, 3e38].map(|stiffness_n_per_m| Coupling {
        stiffness_n_per_m,
        ..usual
    });
    let dampers = [0.0, 1e6, 1e9, 3e38].map(|damping_n_s_per_m| Coupling {
        damping_n_s_per_m,
        ..usual
    });
    let mut accepted = 0;
    for coupling in masses.into_iter().chain(springs).chain(dampers) {
        accepted += u32::from(press_with(coupling).is_some());
    }
    assert_eq!(accepted, 8, "extremes are refused, everything else works");
}

#[test]
fn an_overdamped_spring_keeps_its_slow_part() {
    for (mass, k, r) in [(0.1, 1000.0, 1e6), (0.001, 1000.0, 400.0), (0.1, 10.0, 1e4)] {
        let coupling = Coupling {
            mass_kg: mass,
            stiffness_n_per_m: k,
            damping_n_s_per_m: r,
            ..Coupling::DEFAULT
        };
        let a = 0.5 * f64::from(r) / f64::from(mass);
        let root = (a * a - f64::from(k) / f64::from(mass)).sqrt();
        let (slow, fast) = (-f64::from(k) / f64::from(mass) / (a + root), -a - root);
        for dt in [0.0137, 1.0 / 60.0, 1.0 / 90.0, 0.05, 0.1, 1.0] {
            let xx = f64::from(palpable::couple::SpringMap::new(&coupling, dt).xx);
            let h = f64::from(dt);
            let exact = (slow * (fast * h).exp() - fast * (slow * h).exp()) / (slow - fast);
            // Two roundings of a and of the root, relative to a h = 5e4 at most, in a factor near 1.
            assert!(
                (xx - exact).abs() < 2e-6,
                "R {r} dt {dt}: {xx}, exactly {exact}"
            );
        }
    }
}

fn loose(velocity: [f32; 3], spin: [f32; 3], gravity: [f32; 3], density: f32) {
    let mut block = Block::new(&SMALL);
    let mut world = World::create(block.bytes(), &SMALL).unwrap();
    floor(&mut world);
    world.set_gravity(gravity);
    let body = world
        .add_body(&BodyDef::new(BodyKind::Dynamic, Pose::at(0.0, 0.2, 0.0)))
        .unwrap();
    let Ok(_) = world.add_piece(
        body,
        &PieceDef {
            density_kg_m3: density,
            ..PieceDef::new(Shape::Box([0.05; 3]), 0.0)
        },
    ) else {
        return;
    };
    if world.set_velocity(body, velocity, spin).is_err() {
        return;
    }
    for frame in 0..300 {
        let r = world.step(&FrameInput::unlimited(FRAME_S));
        let pose = world.pose(body).unwrap();
        let (v, w) = world.velocity(body).unwrap();
        assert!(
            pose.is_finite() && v.iter().chain(&w).all(|x| x.is_finite()),
            "frame {frame}: {pose:?} {v:?} {w:?} {r:?}"
        );
        let gap = lowest_corner(&pose, [0.05; 3]);
        let above = pose.position[0].abs() < 19.0 && pose.position[2].abs() < 19.0;
        assert!(!above || gap > -1e-3, "frame {frame} gap {gap}");
    }
}
const G: [f32; 3] = [0.0, -9.81, 0.0];
#[test]
fn no_speed_gravity_or_density_makes_a_frame_endless_or_a_pose_not_finite() {
    const STILL: [f32; 3] = [0.0; 3];
    for down in [-1e30, -1e12, -1e3, 1e3, 1e30] {
        loose([0.0, down, 0.0], STILL, G, 700.0);
        loose(STILL, STILL, [0.0, down, 0.0], 700.0);
    }
    for fast in [1e3, 1e4, 1e20, 1e38, f32::MAX] {
        loose([fast; 3], STILL, G, 700.0);
        loose(STILL, [fast, 0.2 * fast, 0.5 * fast], G, 700.0);
    }
    for density in [1e-44, 1e-38, 1e38] {
        loose(STILL, [1.0; 3], G, density);
    }
}

#[test]
fn a_snapshot_damaged_behind_its_header_is_refused() {
    let mut block = Block::new(&SMALL);
    let mut world = World::create(block.bytes(), &SMALL).unwrap();
    floor(&mut world);
    add_box(
        &mut world,
        BodyKind::Dynamic,
        Pose::at(0.0, 0.06, 0.0),
        [0.05; 3],
    );
    let mut buffer = vec![0; world.snapshot_bytes()];
    let end = world.save(&mut buffer).unwrap();
    let mut accepted = 0;
    let mut panics = 0;
    for index in 56..end {
        let mut bad = buffer.clone();
        bad[index] ^= 0x80;
        if world.load(&bad).is_ok() {
            accepted += 1;
            let done = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
                world.step(&FrameInput::unlimited(FRAME_S));
            }));
            panics += u32::from(done.is_err());
        }
    }
    assert_eq!((accepted, panics), (0, 0));
}

#[test]
fn loose_box_kept_awake_rests_to_the_bit() {
    let mut block = Block::new(&SMALL);
    let mut world = World::create(block.bytes(), &SMALL).unwrap();
    floor(&mut world);
    let b = add_box(
        &mut world,
        BodyKind::Dynamic,
        Pose::at(0.0, 0.0502, 0.0),
        [0.05; 3],
    );
    let hand = ball(&mut world, BodyKind::Driven, [0.3, 0.5, 0.0], 0.05);
    let mut flags = 0;
    let mut low = 1.0_f64;
    for frame in 0..3000 {
        // near: 2 mm above the box's face, moving to and fro
        world
            .set_target(
                hand,
                &Pose::at(0.0, 0.1502 + 0.001 + 0.0002 * (frame % 2) as f32, 0.0),
            )
            .unwrap();
        let r = world.step(&FrameInput::unlimited(FRAME_S));
        flags |= r.flags;
        low = low.min(lowest_corner(&world.pose(b).unwrap(), [0.05; 3]));
        if frame % 300 == 0 {
            println!("{frame} {:?} {low}", world.pose(b).unwrap());
        }
    }
    assert_eq!(flags, 0, "low {low} {:?}", world.pose(b).unwrap());
}

#[test]
fn an_arm_that_cannot_turn_on_its_way_meets_what_only_the_unturned_one_can() {
    // A finger that points up in a shaft; its tracker lies it down far above. In the shaft it cannot turn,
    // so it goes up as it is, and a ceiling is in its way that is not in the way of one that turned.
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    for side in [-1.0, 1.0] {
        let wall = Pose::at(side * 0.512, 1.0, 0.0);
        add_box(&mut world, BodyKind::Fixed, wall, [0.5, 3.0, 0.5]);
    }
    let ceiling = Pose::at(0.0, 2.05, 0.0);
    add_box(&mut world, BodyKind::Fixed, ceiling, [1.0, 0.05, 1.0]);
    let finger = world
        .add_body(&BodyDef::new(BodyKind::Driven, Pose::IDENTITY))
        .unwrap();
    let shape = Shape::Segment([0.0; 3], [0.0, 0.5, 0.0]);
    add_piece(&mut world, finger, &PieceDef::new(shape, 0.01));
    let half_turn = std::f32::consts::FRAC_1_SQRT_2;
    let lying = Pose {
        rotation: [0.0, 0.0, half_turn, half_turn],
        position: [0.0, 1.6, 0.0],
    };
    world.set_target(finger, &lying).unwrap();
    world.step(&FrameInput::unlimited(FRAME_S));
    let pose = world.pose(finger).unwrap();
    let [x, y, z, w] = pose.rotation.map(f64::from);
    // Height of the finger's far end: the second row of the rotation, times 0.5 up.
    let far = f64::from(pose.position[1]) + 0.5 * (w * w + y * y - x * x - z * z);
    let top = far.max(f64::from(pose.position[1])) + 0.01;
    assert!(top < 2.0 + 1e-4, "the ceiling is at 2, the finger at {top}");
    assert!(top > 0.6, "the finger did not move");
}

#[test]
fn what_lost_its_last_piece_while_it_turned_has_a_velocity() {
    let mut block = Block::new(&SMALL);
    let mut world = World::create(block.bytes(), &SMALL).unwrap();
    let def = BodyDef::new(BodyKind::Dynamic, Pose::IDENTITY);
    let body = world.add_body(&def).unwrap();
    let piece = add_piece(&mut world, body, &PieceDef::new(Shape::Box([0.05; 3]), 0.0));
    world.set_velocity(body, [1.0; 3], [1.0; 3]).unwrap();
    world.remove_piece(piece).unwrap();
    for _ in 0..3 {
        let (linear, angular) = world.velocity(body).unwrap();
        assert!(linear.iter().chain(&angular).all(|part| part.is_finite()));
        // What has no mass has nothing that an impulse could turn.
        world
            .apply_impulse(body, [1.0; 3], [1.0, 0.0, 0.0])
            .unwrap();
        world.step(&FrameInput::unlimited(FRAME_S));
    }
}

#[test]
fn the_way_out_of_overlap_does_not_end_in_something_farther_away() {
    let mut block = Block::new(&SMALL);
    let mut world = World::create(block.bytes(), &SMALL).unwrap();
    let hand = add_box(&mut world, BodyKind::Driven, Pose::IDENTITY, [0.05; 3]);
    world.set_target(hand, &Pose::IDENTITY).unwrap();
    world.step(&FrameInput::unlimited(FRAME_S));
    // The shortest way out of the first is up, 0.45 m, into the second, which is not near at first.
    let cover = Pose::at(0.0, -0.1, 0.0);
    add_box(&mut world, BodyKind::Fixed, cover, [2.0, 0.5, 2.0]);
    let lid = add_box(
        &mut world,
        BodyKind::Fixed,
        Pose::at(0.0, 0.7, 0.0),
        [3.0, 0.28, 3.0],
    );
    for frame in 0..20 {
        world.set_target(hand, &Pose::IDENTITY).unwrap();
        world.step(&FrameInput::unlimited(FRAME_S));
        let found = world.penetration(hand, lid).unwrap();
        assert!(found.depth_m <= OVERLAP_SLOP_M, "frame {frame}: {found:?}");
    }
}

#[test]
fn overlap_is_told_of_after_a_frame_that_could_not_look() {
    let mut block = Block::new(&SMALL);
    let mut world = World::create(block.bytes(), &SMALL).unwrap();
    let hand = add_box(&mut world, BodyKind::Driven, Pose::IDENTITY, [0.05; 3]);
    let step = |world: &mut World, units: u32| {
        world.set_target(hand, &Pose::IDENTITY).unwrap();
        let mut input = FrameInput::unlimited(FRAME_S);
        input.budget.advance_units = units;
        world.step(&input).flags
    };
    step(&mut world, u32::MAX);
    add_box(
        &mut world,
        BodyKind::Fixed,
        Pose::at(0.05, 0.0, 0.0),
        [0.05; 3],
    );
    assert_ne!(step(&mut world, 0) & FrameReport::ADVANCE_CUT, 0);
    assert_ne!(step(&mut world, u32::MAX) & FrameReport::OVERLAP, 0);
}

#[test]
fn a_slot_that_was_a_loose_body_and_is_a_fixed_one_forgets_how_it_moved() {
    // Two worlds with the same state: in one, the floor's slot was a fast body's before.
    let drop = |used: bool| {
        let mut block = Block::new(&SMALL);
        let mut world = World::create(block.bytes(), &SMALL).unwrap();
        let first = add_box(
            &mut world,
            BodyKind::Dynamic,
            Pose::at(0.0, -2.0, 0.0),
            [0.05; 3],
        );
        let slider = add_box(
            &mut world,
            BodyKind::Dynamic,
            Pose::at(0.0, 0.1, 0.0),
            [0.1, 0.05, 0.1],
        );
        if used {
            let mut bytes = vec![0; world.snapshot_bytes()];
            world.save(&mut bytes).unwrap();
            world
                .set_velocity(first, [3.0, 2.0, 1.0], [0.0; 3])
                .unwrap();
            world.step(&FrameInput::unlimited(FRAME_S));
            world.load(&bytes).unwrap();
        }
        world.remove_body(first).unwrap();
        floor(&mut world);
        world
            .set_velocity(slider, [2.0, -1.0, 0.3], [0.0, 3.0, 0.0])
            .unwrap();
        for _ in 0..60 {
            world.step(&FrameInput::unlimited(FRAME_S));
        }
        world.hash()
    };
    assert_eq!(drop(true), drop(false));
}

#[test]
fn friction_beyond_what_f32_can_multiply_is_refused() {
    let mut block = Block::new(&SMALL);
    let mut world = World::create(block.bytes(), &SMALL).unwrap();
    for (friction, taken) in [
        (0.0, true),
        (FRICTION_MAX, true),
        (1e30, false),
        (f32::MAX, false),
    ] {
        let surface = Surface {
            restitution: 0.3,
            friction,
        };
        let done = world.set_surface(Material::WOOD, Material::WOOD, surface);
        assert_eq!(done.is_ok(), taken, "{friction}");
    }
}

#[test]
fn a_grain_whose_moments_have_no_inverse_has_a_velocity() {
    for density in [1e-44, 1e-30, 1e-20, 1e-18] {
        let mut block = Block::new(&SMALL);
        let mut world = World::create(block.bytes(), &SMALL).unwrap();
        let def = BodyDef::new(BodyKind::Dynamic, Pose::IDENTITY);
        let body = world.add_body(&def).unwrap();
        let grain = PieceDef {
            density_kg_m3: density,
            ..PieceDef::new(Shape::Point, 1e-4)
        };
        add_piece(&mut world, body, &grain);
        world
            .apply_impulse(body, [1.0, 2.0, 3.0], [1.0, 0.5, 0.0])
            .unwrap();
        for _ in 0..3 {
            let (linear, angular) = world.velocity(body).unwrap();
            let finite = linear.iter().chain(&angular).all(|part| part.is_finite());
            assert!(finite, "{density}: {linear:?} {angular:?}");
            world.step(&FrameInput::unlimited(FRAME_S));
        }
    }
}

#[test]
fn a_force_that_takes_a_body_to_a_hand_far_away_does_not_hold_up_the_frame() {
    for up_n in [1e3, 1e5, 1e7, 6e8] {
        let mut block = Block::new(&SMALL);
        let mut world = World::create(block.bytes(), &SMALL).unwrap();
        let thrown = ball(&mut world, BodyKind::Dynamic, [0.0, 10.0, 0.0], 0.1);
        let hand = ball(&mut world, BodyKind::Driven, [0.0, 20.0, 0.0], 0.1);
        for frame in 0..4 {
            world.set_target(hand, &Pose::at(0.01, 20.0, 0.0)).unwrap();
            world
                .apply_force(thrown, [0.0, up_n, 0.0], [0.0; 3])
                .unwrap();
            let report = world.step(&FrameInput::unlimited(FRAME_S));
            assert_eq!(
                report.flags & FrameReport::IMPULSES_CUT,
                0,
                "{up_n} {frame}"
            );
            let speed = speed(&world, thrown);
            assert!(
                speed <= f64::from(SPEED_MAX) * 1.0001,
                "{up_n}: {speed} m/s"
            );
            let away = position(&world, hand)[1] - position(&world, thrown)[1];
            assert!(away.abs() > 0.2 - 1e-4, "{up_n}: {away} m");
        }
    }
}

/// A body of boxes of these half extents, places and densities, turned by a third of a turn.
fn add_loose(world: &mut World, boxes: &[(f32, [f32; 3], f32)]) -> (BodyId, Vec<PieceId>) {
    let pose = Pose {
        rotation: [0.5; 4],
        position: [1.0, 2.0, 3.0],
    };
    let body = world
        .add_body(&BodyDef::new(BodyKind::Dynamic, pose))
        .unwrap();
    let add = |&(half, [x, y, z], density_kg_m3): &(f32, [f32; 3], f32)| {
        let def = PieceDef {
            density_kg_m3,
            local: Pose::at(x, y, z),
            ..PieceDef::new(Shape::Box([half; 3]), 0.0)
        };
        add_piece(world, body, &def)
    };
    (body, boxes.iter().map(add).collect())
}

fn is_finite((linear, angular): ([f32; 3], [f32; 3])) -> bool {
    linear.iter().chain(&angular).all(|part| part.is_finite())
}

#[test]
fn an_impulse_makes_nothing_faster_than_the_limits() {
    for density in [1e-34, 1e-22, 1e-10, 1.0] {
        let mut block = Block::new(&SMALL);
        let mut world = World::create(block.bytes(), &SMALL).unwrap();
        let (body, _) = add_loose(&mut world, &[(0.05, [0.0; 3], density)]);
        for _ in 0..3 {
            let strong = [FORCE_MAX, -FORCE_MAX, 0.5 * FORCE_MAX];
            world
                .apply_impulse(body, strong, [900.0, -900.0, 900.0])
                .unwrap();
            let (linear, angular) = world.velocity(body).unwrap();
            assert!(
                is_finite((linear, angular)),
                "{density}: {linear:?} {angular:?}"
            );
            let way = Vec3::from(linear);
            assert!(
                (way.length() / SPEED_MAX - 1.0).abs() < 1e-5,
                "{density}: {way}"
            );
            assert!(way.normalize().distance(Vec3::from(strong).normalize()) < 1e-5);
            assert!(
                Vec3::from(angular).length() <= 1.0001 * SPIN_MAX,
                "{angular:?}"
            );
        }
    }
}

#[test]
fn what_is_left_of_a_body_moves_as_it_did() {
    let mut block = Block::new(&SMALL);
    let mut world = World::create(block.bytes(), &SMALL).unwrap();
    world.set_gravity([0.0; 3]);
    let boxes = [(0.05, [0.0; 3], 700.0), (0.2, [0.3, 0.1, 0.0], 1e9)];
    let (body, pieces) = add_loose(&mut world, &boxes);
    let spin = [1.0, -2.0, 3.0];
    world.set_velocity(body, [0.5, 0.0, 0.0], spin).unwrap();
    // The heavy piece's centre is that of the whole, but for a part in 1e8.
    let heavy = Vec3::from(world.piece_pose(pieces[1]).unwrap().position);
    let light = Vec3::from(world.piece_pose(pieces[0]).unwrap().position);
    let expected = Vec3::X * 0.5 + Vec3::from(spin).cross(light - heavy);
    world.remove_piece(pieces[1]).unwrap();
    let (linear, angular) = world.velocity(body).unwrap();
    assert!(Vec3::from(linear).distance(expected) < 1e-5, "{linear:?}");
    assert!(
        Vec3::from(angular).distance(Vec3::from(spin)) < 1e-5,
        "{angular:?}"
    );
}

#[test]
fn impulses_of_the_heaviest_bodies_are_finite() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    floor(&mut world);
    let body = world
        .add_body(&BodyDef::new(BodyKind::Dynamic, Pose::at(0.0, 1.1, 0.0)))
        .unwrap();
    let dense = |density_kg_m3: f32| PieceDef {
        density_kg_m3,
        ..PieceDef::new(Shape::Box([1.0; 3]), 0.0)
    };
    for density in [2.0 * DENSITY_MAX, 1e37, f32::MAX] {
        let refused = world.add_piece(body, &dense(density));
        assert_eq!(refused, Err(AddPieceError::BadNumber), "{density}");
    }
    add_piece(&mut world, body, &dense(DENSITY_MAX));
    let down = [0.0, -SPEED_MAX, 0.0];
    world
        .set_velocity(body, down, [SPIN_MAX, 0.0, 0.0])
        .unwrap();
    let mut touched = false;
    for _ in 0..10 {
        world.step(&FrameInput::unlimited(FRAME_S));
        assert!(is_finite(world.velocity(body).unwrap()));
        for event in world.contact_events() {
            touched |= event.impulse_n_s > 0.0;
            assert!(event.impulse_n_s.is_finite(), "{event:?}");
        }
    }
    assert!(touched, "it meets the floor");
}

/// Numbers from -1 to 1, the same ones for the same seed.
fn numbers(seed: u32) -> impl FnMut() -> f32 {
    let mut bits = seed.wrapping_mul(0x9e37_79b9) | 1;
    move || {
        bits ^= bits << 13;
        bits ^= bits >> 17;
        bits ^= bits << 5;
        f32::from_bits(0x3f80_0000 | bits >> 9) * 2.0 - 3.0
    }
}

/// How deep a driven ball that hangs on its body gets into a fixed one, in f64, while its tracker goes through
/// the fixed one to and fro.
fn deepest_of_balls(seed: u32, home: Vec3, fixed_m: f32) -> f64 {
    let mut draw = numbers(seed);
    let mut vector = || Vec3::new(draw(), draw(), draw());
    let mut block = Block::new(&SMALL);
    let mut world = World::create(block.bytes(), &SMALL).unwrap();
    let away = (home + 0.1 * vector()).normalize() * (fixed_m + 0.3);
    let stone = ball(
        &mut world,
        BodyKind::Fixed,
        (home - away).to_array(),
        fixed_m,
    );
    let def = BodyDef::new(BodyKind::Driven, Pose::new(Quat::IDENTITY, home));
    let hand = world.add_body(&def).unwrap();
    let mut finger = PieceDef::new(Shape::Point, 0.02);
    finger.local = Pose::new(Quat::IDENTITY, 0.1 * vector());
    let finger = add_piece(&mut world, hand, &finger);
    let mut deepest = f64::NEG_INFINITY;
    for _ in 0..120 {
        let turn = Quat::from_scaled_axis(vector());
        let target = home - away * (0.5 / away.length()) + 0.3 * vector();
        world.set_target(hand, &Pose::new(turn, target)).unwrap();
        world.step(&FrameInput::unlimited(FRAME_S));
        let at = world.piece_pose(finger).unwrap().translation().as_dvec3();
        let apart = at.distance(world.pose(stone).unwrap().translation().as_dvec3());
        deepest = deepest.max(f64::from(fixed_m) + f64::from(0.02_f32) - apart);
    }
    deepest
}

#[test]
fn no_overlap_shows_far_from_the_origin() {
    let mut touched = 0;
    for seed in 0..200 {
        let part = [0.01, 0.3, 0.6, 0.98][seed as usize % 4];
        let sign = |bit: u32| if seed & bit == 0 { 1.0 } else { -1.0 };
        let home = part * WORLD_REACH_M * Vec3::new(sign(4), sign(8), sign(16));
        let fixed_m = [0.1, home.length()][seed as usize / 32 % 2];
        let deepest = deepest_of_balls(seed, home, fixed_m);
        let most = f64::from(OVERLAP_SLOP_M);
        assert!(
            deepest <= most,
            "{seed}: {deepest} m at {home}, {fixed_m} m"
        );
        touched += u32::from(deepest > -1e-3);
    }
    assert!(touched > 100, "{touched}");
}

#[test]
fn a_slide_does_not_leave_the_world() {
    let mut block = Block::new(&SMALL);
    let mut world = World::create(block.bytes(), &SMALL).unwrap();
    // A ceiling that rises along X: what is pressed against it is bent forward.
    let turn = Quat::from_rotation_z(0.1);
    let ceiling = Pose::new(turn, turn * Vec3::new(0.0, 1.1, 0.0));
    add_box(&mut world, BodyKind::Fixed, ceiling, [3000.0, 1.0, 3.0]);
    let hand = ball(&mut world, BodyKind::Driven, [0.0; 3], 0.05);
    let target = Pose::at(WORLD_REACH_M, 0.5 * WORLD_REACH_M, 0.0);
    for frame in 0..10 {
        world.set_target(hand, &target).unwrap();
        world.step(&FrameInput::unlimited(FRAME_S));
        let at = position(&world, hand);
        let most = 1.000_001 * f64::from(WORLD_REACH_M);
        assert!(at.iter().all(|x| x.abs() <= most), "{frame}: {at:?}");
        assert!(at[0] > 1000.0, "{frame}: {at:?}");
    }
}

#[test]
fn a_hand_does_not_get_into_one_that_a_wedged_object_stopped() {
    for (first_m, push) in [(0.3, 0), (0.5, 1), (0.6, 0), (0.3, 1)] {
        let mut block = Block::new(&SMALL);
        let mut world = World::create(block.bytes(), &SMALL).unwrap();
        world.set_gravity([0.0; 3]);
        let mut hand = |x: f32| {
            let def = BodyDef {
                coupling: Coupling {
                    push,
                    ..Coupling::DEFAULT
                },
                ..BodyDef::new(BodyKind::Driven, Pose::at(x, 0.0, 0.0))
            };
            let hand = world.add_body(&def).unwrap();
            add_piece(&mut world, hand, &PieceDef::new(Shape::Point, 0.1));
            hand
        };
        // The second follows the first, which finds a ball between it and a wall.
        let hands = [hand(0.0), hand(-0.25)];
        ball(&mut world, BodyKind::Dynamic, [0.45, 0.0, 0.0], 0.3);
        let wall = Pose::at(1.7503, 0.0, 0.0);
        add_box(&mut world, BodyKind::Fixed, wall, [1.0, 3.0, 3.0]);
        let mut gap = 0.05;
        for frame in 0..12 {
            for (hand, x) in hands.into_iter().zip([first_m, first_m - 0.25]) {
                world.set_target(hand, &Pose::at(x, 0.0, 0.0)).unwrap();
            }
            let report = world.step(&FrameInput::unlimited(FRAME_S));
            assert_eq!(
                report.flags & FrameReport::OVERLAP,
                0,
                "{frame}: {report:?}"
            );
            let [a, b] = hands.map(|hand| world.pose(hand).unwrap().translation());
            gap = a.distance(b) - 0.2;
            assert!(gap > -1e-5, "{first_m} {push} {frame}: {gap} m");
        }
        assert!(
            gap < 0.01,
            "the second comes near: {first_m} {push} {gap} m"
        );
    }
}
