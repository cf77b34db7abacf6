//! Random scenes, any speed, any budget: no published driven pose overlaps a fixed body by more than
//! promised. `PALPABLE_SEED=n cargo test -p palpable-lab --test random_scenes` replays one scene.

use glam::{DQuat, DVec3};
use palpable::frame::{Budget, FrameInput};
use palpable::limits::OVERLAP_SLOP_M;
use palpable::math::Pose;
use palpable::memory::{BodyId, PieceId};
use palpable::state::bodies::BodyKind;
use palpable::world::{BodyDef, PieceDef, Shape, World};
use palpable_lab::hand_scene::{CAPACITIES, poses_of_pieces};
use palpable_lab::memory::Block;
use palpable_lab::reference::{self, Judge, Solid};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

const SCENES: u64 = 400;
const FRAMES: u32 = 100;

struct Scene {
    random: Pcg64Mcg,
    judge: Judge,
    hand: BodyId,
    pieces: Vec<PieceId>,
}

fn between(random: &mut Pcg64Mcg, low: f64, high: f64) -> f64 {
    low + (high - low) * random.random::<f64>()
}

fn vector(random: &mut Pcg64Mcg, most: f64) -> DVec3 {
    let mut draw = || between(random, -most, most);
    DVec3::new(draw(), draw(), draw())
}

fn turn(random: &mut Pcg64Mcg) -> DQuat {
    DQuat::from_scaled_axis(vector(random, 3.0))
}

fn pose(orientation: DQuat, position: DVec3) -> Pose {
    Pose {
        rotation: orientation.as_quat().to_array(),
        position: position.as_vec3().to_array(),
    }
}

fn points(random: &mut Pcg64Mcg, size: f64) -> Vec<[f32; 3]> {
    let count = 6 + (random.random::<u32>() % 20) as usize;
    let stretch = DVec3::new(1.0, between(random, 0.2, 1.0), between(random, 0.1, 1.0));
    (0..count)
        .map(|_| (vector(random, size) * stretch).as_vec3().to_array())
        .collect()
}

/// Fixed hulls all around, none within 0.35 m of the origin, where the driven body starts.
fn scene(world: &mut World, seed: u64) -> Scene {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut judge = Judge::new();
    for group in 0..12 {
        let corners = points(&mut random, 0.35);
        let direction = vector(&mut random, 1.0).normalize();
        let at = pose(
            turn(&mut random),
            direction * between(&mut random, 1.0, 1.3),
        );
        let body = world.add_body(&BodyDef::new(BodyKind::Fixed, at)).unwrap();
        world
            .add_piece(body, &PieceDef::new(Shape::Hull(&corners), 0.0))
            .unwrap();
        let solid = Solid::from_f32(&corners, 0.0).unwrap();
        let placed = reference::Pose::from_f32(at.rotation, at.position);
        judge.add_fixed(solid, group, "fixed", "obstacle", placed);
    }
    let hand = world
        .add_body(&BodyDef::new(BodyKind::Driven, Pose::IDENTITY))
        .unwrap();
    let mut pieces = Vec::new();
    for _ in 0..4 {
        let radius = if random.random::<bool>() { 0.01 } else { 0.0 };
        let corners = points(&mut random, 0.06);
        let local = pose(turn(&mut random), vector(&mut random, 0.08));
        let def = PieceDef {
            local,
            ..PieceDef::new(Shape::Hull(&corners), radius)
        };
        pieces.push(world.add_piece(hand, &def).unwrap());
        judge.add_moving(
            Solid::from_f32(&corners, radius).unwrap(),
            99,
            "hand",
            "part",
        );
    }
    Scene {
        random,
        judge,
        hand,
        pieces,
    }
}

impl Scene {
    fn step(&mut self, world: &mut World, far: f64) {
        let target = pose(turn(&mut self.random), vector(&mut self.random, far));
        world.set_target(self.hand, &target).unwrap();
        let locals: Vec<Pose> = self
            .pieces
            .iter()
            .map(|_| pose(turn(&mut self.random), vector(&mut self.random, 0.08)))
            .collect();
        world.set_piece_targets(self.hand, &locals).unwrap();
        let advance_units = match self.random.random::<u32>() % 4 {
            0 => self.random.random::<u32>() % 12,
            1 => 0,
            _ => u32::MAX,
        };
        world.step(&FrameInput {
            budget: Budget {
                advance_units,
                ..Budget::UNLIMITED
            },
            ..FrameInput::unlimited(between(&mut self.random, 1e-3, 0.03) as f32)
        });
    }
}

/// The deepest overlap of any frame, in metres, and how many frames were in contact.
fn run(seed: u64) -> (f64, u32) {
    let mut block = Block::new(&CAPACITIES);
    let mut world = World::create(block.bytes(), &CAPACITIES).unwrap();
    let mut scene = scene(&mut world, seed);
    let (mut deepest, mut touching) = (0.0_f64, 0);
    for frame in 0..FRAMES {
        // Now and then a teleport through everything, else a hand's usual reach.
        let far = if frame % 10 == 0 { 5.0 } else { 0.9 };
        scene.step(&mut world, far);
        let poses = poses_of_pieces(&world, &scene.pieces).unwrap();
        deepest = deepest.max(scene.judge.frame(&poses).depth_between("hand", "fixed"));
        touching += u32::from(!world.contacts().is_empty());
    }
    (deepest, touching)
}

#[test]
fn no_random_scene_shows_overlap() {
    let seeds = match std::env::var("PALPABLE_SEED") {
        Ok(seed) => {
            let seed: u64 = seed.parse().unwrap();
            seed..seed + 1
        }
        Err(_) => 0..SCENES,
    };
    let mut touching = 0;
    for seed in seeds {
        let (deepest, contacts) = run(seed);
        touching += contacts;
        assert!(
            deepest <= f64::from(OVERLAP_SLOP_M),
            "overlap of {deepest} m: replay with PALPABLE_SEED={seed}"
        );
    }
    assert!(touching > 0, "nothing touched anything");
    println!("{touching} frames in contact");
}
