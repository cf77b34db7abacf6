//! What the host may hand in: everything, and nothing breaks.

mod common;

use common::{Block, add_box, add_piece};
use palpable::frame::{Budget, FrameInput, FrameReport};
use palpable::limits::{FRAME_S_MAX, FRAME_S_MIN, WORLD_REACH_M};
use palpable::math::Pose;
use palpable::memory::{BodyId, Capacities};
use palpable::state::bodies::{BodyKind, Coupling, DrivenReport};
use palpable::state::materials::{Material, Surface};
use palpable::world::{
    AddBodyError, AddPieceError, BodyDef, BodyError, MaterialError, PieceDef, Shape, World,
};

const FRAME_S: f32 = 1.0 / 60.0;

const NOT_FINITE: [f32; 3] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];

fn floor(world: &mut World) -> BodyId {
    add_box(
        world,
        BodyKind::Fixed,
        Pose::at(0.0, -0.5, 0.0),
        [5.0, 0.5, 5.0],
    )
}

/// The identity with one of its seven numbers replaced.
fn spoiled(index: usize, value: f32) -> Pose {
    let mut pose = Pose::IDENTITY;
    match index {
        0..4 => pose.rotation[index] = value,
        _ => pose.position[index - 4] = value,
    }
    pose
}

fn turned(rotation: [f32; 4]) -> Pose {
    Pose {
        rotation,
        position: [0.1, 0.2, 0.3],
    }
}

/// Poses that no body can have.
fn bad_poses() -> Vec<Pose> {
    let mut poses = Vec::new();
    for index in 0..7 {
        poses.extend(NOT_FINITE.map(|value| spoiled(index, value)));
        poses.extend([1e30, -1e30, f32::MAX].map(|value| spoiled(index, value)));
    }
    poses.push(turned([0.0; 4]));
    poses.push(turned([0.0, 0.0, 0.0, 1e-30]));
    poses.push(turned([0.0, 0.0, 0.0, 1e30]));
    poses.push(turned([1e-40, -1e-40, 1e-40, 1e-40]));
    poses.push(Pose::at(0.0, WORLD_REACH_M * 1.001, 0.0));
    poses
}

#[test]
fn impossible_poses_are_refused_by_name_and_change_nothing() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let hand = add_box(&mut world, BodyKind::Driven, Pose::IDENTITY, [0.05; 3]);
    let loose = add_box(
        &mut world,
        BodyKind::Dynamic,
        Pose::at(1.0, 0.0, 0.0),
        [0.05; 3],
    );
    let hash = world.hash();
    for pose in bad_poses() {
        for kind in [BodyKind::Fixed, BodyKind::Dynamic, BodyKind::Driven] {
            assert_eq!(
                world.add_body(&BodyDef::new(kind, pose)),
                Err(AddBodyError::BadPose),
                "{pose:?}"
            );
        }
        assert_eq!(
            world.set_target(hand, &pose),
            Err(BodyError::BadPose),
            "{pose:?}"
        );
        assert_eq!(
            world.set_piece_targets(hand, &[pose]),
            Err(BodyError::BadPose)
        );
        for body in [hand, loose] {
            assert_eq!(world.place_body(body, &pose), Err(BodyError::BadPose));
        }
        let def = PieceDef {
            local: pose,
            ..PieceDef::new(Shape::Point, 0.1)
        };
        assert_eq!(world.add_piece(hand, &def), Err(AddPieceError::BadPose));
        assert_eq!(world.hash(), hash, "{pose:?}");
    }
}

#[test]
fn orientations_of_any_sound_length_are_normalised() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let hand = add_box(&mut world, BodyKind::Driven, Pose::IDENTITY, [0.05; 3]);
    for length in [0.999, 1.001, 0.5, 2.0, 1.1e-3, 900.0] {
        let target = turned([0.6 * length, 0.0, 0.0, 0.8 * length]);
        world.set_target(hand, &target).unwrap();
        world.step(&FrameInput::unlimited(FRAME_S));
        let pose = world.pose(hand).unwrap();
        // Two roundings of each coordinate.
        for (got, expected) in pose.rotation.iter().zip([0.6, 0.0, 0.0, 0.8]) {
            assert!((got - expected).abs() < 2.0 * f32::EPSILON, "{pose:?}");
        }
        assert_eq!(pose.position, target.position);
    }
}

#[test]
fn denormal_numbers_are_numbers() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    floor(&mut world);
    let start = Pose::at(0.0, 0.2, 0.0);
    let hand = add_box(&mut world, BodyKind::Driven, start, [0.05; 3]);
    for index in 0..7 {
        for tiny in [1e-40, -1e-40, f32::MIN_POSITIVE] {
            let mut target = spoiled(index, tiny);
            if index == 3 {
                target.rotation[0] = 1.0;
            }
            world.set_target(hand, &target).unwrap();
            world.step(&FrameInput::unlimited(FRAME_S));
            let pose = world.pose(hand).unwrap();
            assert!(pose.is_finite());
            assert!(pose.position[1] >= 0.05 - 1e-6, "{pose:?} for {target:?}");
        }
    }
}

#[test]
fn a_bad_target_counts_as_a_lost_tracker() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let hand = add_box(&mut world, BodyKind::Driven, Pose::IDENTITY, [0.05; 3]);
    let good = Pose::at(0.1, 0.2, 0.3);
    world.set_target(hand, &good).unwrap();
    world.step(&FrameInput::unlimited(FRAME_S));
    for frame in 1..=30 {
        let bad = spoiled(frame as usize % 7, f32::NAN);
        assert_eq!(world.set_target(hand, &bad), Err(BodyError::BadPose));
        world.step(&FrameInput::unlimited(FRAME_S));
        assert_eq!(world.pose(hand).unwrap(), good);
        let lost = world.driven_report(hand).unwrap().flags & DrivenReport::LOST != 0;
        // Grace is 0.1 s, six frames; the sum of six f32 frames may round to either side of it.
        match frame {
            1..=5 => assert!(!lost, "frame {frame}"),
            6 => {}
            _ => assert!(lost, "frame {frame}"),
        }
    }
}

#[test]
fn a_lost_tracker_keeps_its_target_and_is_reported_after_the_grace() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let def = BodyDef {
        coupling: Coupling {
            grace_s: 0.5,
            ..Coupling::DEFAULT
        },
        ..BodyDef::new(BodyKind::Driven, Pose::IDENTITY)
    };
    let hand = world.add_body(&def).unwrap();
    add_piece(&mut world, hand, &PieceDef::new(Shape::Point, 0.05));
    let target = Pose::at(0.3, 0.2, 0.1);
    world.set_target(hand, &target).unwrap();
    world.step(&FrameInput::unlimited(0.0625));
    for frame in 1..=20 {
        world.step(&FrameInput::unlimited(0.0625));
        assert_eq!(world.pose(hand).unwrap(), target);
        // 1/16 s adds up without rounding: eight frames are the grace to the bit.
        let lost = world.driven_report(hand).unwrap().flags & DrivenReport::LOST != 0;
        assert_eq!(lost, frame > 8, "frame {frame}");
    }
    world.set_target(hand, &target).unwrap();
    world.step(&FrameInput::unlimited(0.0625));
    let flags = world.driven_report(hand).unwrap().flags;
    assert_eq!(flags & DrivenReport::LOST, 0);
}

#[test]
fn a_body_whose_tracker_was_never_seen_stays() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let start = Pose::at(1.0, 2.0, 3.0);
    let hand = add_box(&mut world, BodyKind::Driven, start, [0.05; 3]);
    assert_eq!(
        world.set_target(hand, &spoiled(0, f32::NAN)),
        Err(BodyError::BadPose)
    );
    for _ in 0..10 {
        world.step(&FrameInput::unlimited(FRAME_S));
        assert_eq!(world.pose(hand).unwrap(), start);
    }
}

#[test]
fn a_time_step_that_is_none_moves_nothing() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    floor(&mut world);
    let hand = add_box(
        &mut world,
        BodyKind::Driven,
        Pose::at(0.0, 0.5, 0.0),
        [0.05; 3],
    );
    add_box(
        &mut world,
        BodyKind::Dynamic,
        Pose::at(1.0, 0.5, 0.0),
        [0.05; 3],
    );
    let bad = [
        0.0,
        -0.0,
        -1.0,
        -1e-9,
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
    ];
    for dt_s in bad {
        world.set_target(hand, &Pose::at(0.0, 1.0, 0.0)).unwrap();
        let hash = world.hash();
        let report = world.step(&FrameInput::unlimited(dt_s));
        assert_eq!(report.flags, FrameReport::BAD_TIME_STEP, "{dt_s}");
        assert_eq!(report.frame, 0);
        assert_eq!(world.hash(), hash, "{dt_s}");
    }
}

#[test]
fn a_time_step_too_short_or_too_long_is_clamped() {
    for (dt_s, used) in [
        (1e-9, FRAME_S_MIN),
        (1e-40, FRAME_S_MIN),
        (10.0, FRAME_S_MAX),
        (1e30, FRAME_S_MAX),
    ] {
        let [clamped, expected] = [dt_s, used].map(|dt_s| {
            let mut block = Block::new(&Capacities::ROOM);
            let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
            floor(&mut world);
            let hand = add_box(
                &mut world,
                BodyKind::Driven,
                Pose::at(0.0, 0.5, 0.0),
                [0.05; 3],
            );
            add_box(
                &mut world,
                BodyKind::Dynamic,
                Pose::at(1.0, 0.5, 0.0),
                [0.05; 3],
            );
            for _ in 0..50 {
                world.set_target(hand, &Pose::at(0.0, -1.0, 0.0)).unwrap();
                let report = world.step(&FrameInput::unlimited(dt_s));
                let clamped = report.flags & FrameReport::TIME_STEP_CLAMPED != 0;
                assert_eq!(clamped, dt_s != used);
            }
            world.hash()
        });
        assert_eq!(clamped, expected, "{dt_s}");
    }
}

#[test]
fn the_wrong_kind_and_the_wrong_count_are_named() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let fixed = floor(&mut world);
    let loose = add_box(
        &mut world,
        BodyKind::Dynamic,
        Pose::at(0.0, 1.0, 0.0),
        [0.05; 3],
    );
    let hand = add_box(
        &mut world,
        BodyKind::Driven,
        Pose::at(0.0, 2.0, 0.0),
        [0.05; 3],
    );
    add_piece(&mut world, hand, &PieceDef::new(Shape::Point, 0.02));
    let hash = world.hash();
    for body in [fixed, loose] {
        assert_eq!(
            world.set_target(body, &Pose::IDENTITY),
            Err(BodyError::WrongKind)
        );
        assert_eq!(
            world.set_piece_targets(body, &[Pose::IDENTITY]),
            Err(BodyError::WrongKind)
        );
        assert_eq!(world.driven_report(body), Err(BodyError::WrongKind));
    }
    for body in [fixed, hand] {
        assert_eq!(
            world.set_velocity(body, [0.0; 3], [0.0; 3]),
            Err(BodyError::WrongKind)
        );
        assert_eq!(world.velocity(body), Err(BodyError::WrongKind));
        assert_eq!(world.mass_kg(body), Err(BodyError::WrongKind));
    }
    for count in [0, 1, 3, 100] {
        assert_eq!(
            world.set_piece_targets(hand, &vec![Pose::IDENTITY; count]),
            Err(BodyError::WrongCount)
        );
    }
    assert_eq!(world.hash(), hash);
}

#[test]
fn one_bad_piece_target_keeps_all_the_old_ones() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let hand = add_box(&mut world, BodyKind::Driven, Pose::IDENTITY, [0.05; 3]);
    add_piece(&mut world, hand, &PieceDef::new(Shape::Point, 0.02));
    let hash = world.hash();
    for bad in bad_poses() {
        for poses in [[Pose::at(1.0, 0.0, 0.0), bad], [bad, Pose::IDENTITY]] {
            assert_eq!(
                world.set_piece_targets(hand, &poses),
                Err(BodyError::BadPose)
            );
        }
    }
    assert_eq!(world.hash(), hash);
}

#[test]
fn bad_numbers_of_velocities_surfaces_and_couplings_are_refused() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let loose = add_box(&mut world, BodyKind::Dynamic, Pose::IDENTITY, [0.05; 3]);
    let hash = world.hash();
    for bad in NOT_FINITE {
        for axis in 0..3 {
            let mut spoiled = [0.0; 3];
            spoiled[axis] = bad;
            for (linear, angular) in [(spoiled, [0.0; 3]), ([0.0; 3], spoiled)] {
                assert_eq!(
                    world.set_velocity(loose, linear, angular),
                    Err(BodyError::BadVelocity)
                );
            }
            world.set_gravity(spoiled);
        }
        let coupling = Coupling {
            stiffness_n_per_m: bad,
            ..Coupling::DEFAULT
        };
        let def = BodyDef {
            coupling,
            ..BodyDef::new(BodyKind::Driven, Pose::IDENTITY)
        };
        assert_eq!(world.add_body(&def), Err(AddBodyError::BadCoupling));
    }
    for (restitution, friction) in [
        (f32::NAN, 0.1),
        (0.1, f32::NAN),
        (-0.1, 0.1),
        (1.1, 0.1),
        (0.1, -0.1),
        (0.1, f32::INFINITY),
    ] {
        let surface = Surface {
            restitution,
            friction,
        };
        assert_eq!(
            world.set_surface(Material::WOOD, Material::METAL, surface),
            Err(MaterialError::BadSurface)
        );
    }
    let surface = Surface {
        restitution: 0.1,
        friction: 0.1,
    };
    for unknown in [Material(3), Material(u32::MAX)] {
        assert_eq!(
            world.set_surface(unknown, Material::WOOD, surface),
            Err(MaterialError::Unknown)
        );
        assert_eq!(
            world.set_surface(Material::WOOD, unknown, surface),
            Err(MaterialError::Unknown)
        );
    }
    assert_eq!(world.hash(), hash);
}

/// A generator of 32 random bits; the same seed gives the same sequence everywhere.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 32) as u32
    }

    fn below(&mut self, bound: u32) -> u32 {
        self.next() % bound
    }

    /// In -1..1.
    fn signed(&mut self) -> f32 {
        (self.next() >> 8) as f32 / (1 << 23) as f32 - 1.0
    }

    /// Any of the numbers that break programs, or one of a usual size.
    fn number(&mut self) -> f32 {
        match self.below(16) {
            0 => f32::from_bits(self.next()),
            1 => NOT_FINITE[self.below(3) as usize],
            2 => 1e-40 * self.signed(),
            3 => 1e30 * self.signed(),
            4 => 0.0,
            5 => WORLD_REACH_M * self.signed(),
            _ => self.signed(),
        }
    }

    /// Mostly a sound pose near the scene, sometimes one made of any numbers.
    fn pose(&mut self) -> Pose {
        if self.below(4) == 0 {
            return Pose {
                rotation: [(); 4].map(|()| self.number()),
                position: [(); 3].map(|()| self.number()),
            };
        }
        Pose {
            rotation: [(); 4].map(|()| self.signed()),
            position: [(); 3].map(|()| 0.5 * self.signed()),
        }
    }

    fn time_step(&mut self) -> f32 {
        match self.below(8) {
            0 => self.number(),
            1 => 1e-9,
            2 => 10.0,
            _ => FRAME_S,
        }
    }

    fn budget(&mut self) -> Budget {
        match self.below(4) {
            0 => Budget {
                advance_units: self.below(20),
                impulse_units: self.below(20),
                reach_steps: self.below(20),
            },
            _ => Budget::UNLIMITED,
        }
    }
}

fn assert_finite(world: &World, bodies: &[BodyId], seed: u64, frame: u32) {
    for body in bodies {
        let pose = world.pose(*body).unwrap();
        assert!(pose.is_finite(), "seed {seed}, frame {frame}: {pose:?}");
        let length = pose.quat().length();
        // Normalised each frame: two roundings off.
        assert!((length - 1.0).abs() < 1e-5, "seed {seed}, frame {frame}");
        if let Ok((linear, angular)) = world.velocity(*body) {
            let finite = linear.iter().chain(&angular).all(|x| x.is_finite());
            assert!(finite, "seed {seed}, frame {frame}: {linear:?} {angular:?}");
        }
        if let Ok(report) = world.driven_report(*body) {
            assert!(report.displacement_m.is_finite() && report.displacement_m >= 0.0);
            assert!(report.force_n.iter().all(|x| x.is_finite()));
        }
    }
    assert!(world.piece_poses().iter().all(Pose::is_finite));
    for contact in world.contacts() {
        let numbers = contact.point.iter().chain(&contact.normal);
        assert!(numbers.chain([&contact.gap_m]).all(|x| x.is_finite()));
    }
}

/// A hand of two pieces among fixed and loose bodies, given any numbers at all.
fn garbage(seed: u64, frames: u32) -> u64 {
    let mut random = Random(seed);
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let ground = floor(&mut world);
    let hand = add_box(
        &mut world,
        BodyKind::Driven,
        Pose::at(0.0, 0.4, 0.0),
        [0.05; 3],
    );
    add_piece(&mut world, hand, &PieceDef::new(Shape::Point, 0.03));
    let loose = add_box(
        &mut world,
        BodyKind::Dynamic,
        Pose::at(0.3, 0.06, 0.0),
        [0.05; 3],
    );
    let ball = world
        .add_body(&BodyDef::new(BodyKind::Dynamic, Pose::at(0.0, 0.06, 0.3)))
        .unwrap();
    add_piece(&mut world, ball, &PieceDef::new(Shape::Point, 0.05));
    let bodies = [ground, hand, loose, ball];
    for frame in 0..frames {
        let _ = world.set_target(hand, &random.pose());
        if random.below(4) == 0 {
            let _ = world.set_piece_targets(hand, &[random.pose(), random.pose()]);
        }
        if random.below(50) == 0 {
            let body = bodies[random.below(4) as usize];
            let _ = world.place_body(body, &random.pose());
        }
        if random.below(50) == 0 {
            let linear = [(); 3].map(|()| 20.0 * random.signed());
            let angular = [(); 3].map(|()| 50.0 * random.signed());
            world.set_velocity(loose, linear, angular).unwrap();
        }
        let input = FrameInput {
            budget: random.budget(),
            ..FrameInput::unlimited(random.time_step())
        };
        world.step(&input);
        assert_finite(&world, &bodies, seed, frame);
    }
    world.hash()
}

/// Seeds that are tried; `PALPABLE_SEED=n cargo test --test input` replays one.
fn seeds() -> Vec<u64> {
    match std::env::var("PALPABLE_SEED") {
        Ok(seed) => vec![seed.parse().unwrap()],
        Err(_) => (1..=6).collect(),
    }
}

#[test]
fn nothing_becomes_infinite_whatever_comes_in() {
    for seed in seeds() {
        println!("replay with PALPABLE_SEED={seed} cargo test --test input");
        garbage(seed, 2000);
    }
}

#[test]
fn the_same_garbage_gives_the_same_bits() {
    for seed in seeds().into_iter().take(2) {
        assert_eq!(garbage(seed, 300), garbage(seed, 300), "seed {seed}");
    }
}
