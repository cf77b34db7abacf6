//! The scene of `hosts/c/table.c` on the kernel's own interface, with the same inputs.

use palpable_kernel::frame::FrameInput;
use palpable_kernel::math::Pose;
use palpable_kernel::memory::{BodyId, Capacities};
use palpable_kernel::state::bodies::BodyKind;
use palpable_kernel::state::materials::Material;
use palpable_kernel::world::{BodyDef, JointInput, PieceDef, Shape, World};

const FRAMES: u32 = 600;
const FINGERS: usize = 5;
const PIECES: usize = 1 + 2 * FINGERS;
const JOINTS: usize = 26;
const WRIST: usize = 1;
const PIECE_JOINTS: [u32; PIECES] = [0, 3, 4, 7, 9, 12, 14, 17, 19, 22, 24];

const KEYS: [(u32, [f32; 3]); 8] = [
    (0, [-0.25, 0.85, 0.05]),
    (60, [-0.20, 0.87, 0.0]),
    (120, [-0.25, 0.85, 0.05]),
    (180, [-0.25, 0.70, 0.05]),
    (300, [-0.05, 0.70, 0.05]),
    (360, [-0.05, 0.79, 0.05]),
    (420, [-0.05, 0.77, 0.0]),
    (600, [0.30, 0.77, 0.0]),
];

fn wrist_at(frame: u32) -> [f32; 3] {
    let k = KEYS.iter().skip(1).take_while(|key| frame > key.0).count();
    let ((begin, from), (end, to)) = (KEYS[k], KEYS[k + 1]);
    let share = (frame - begin) as f32 / (end - begin) as f32;
    core::array::from_fn(|axis| from[axis] + (to[axis] - from[axis]) * share)
}

fn bend_at(frame: u32) -> f32 {
    let step = frame % 60;
    0.3 * ((if step < 30 { step } else { 60 - step }) as f32 / 30.0)
}

fn pose_at(x: f32, y: f32, z: f32, half_tangent: f32) -> Pose {
    Pose {
        rotation: [0.0 - half_tangent, 0.0, 0.0, 1.0],
        position: [x, y, z],
    }
}

fn see_hand(frame: u32) -> [Option<Pose>; JOINTS] {
    let [x, y, z] = wrist_at(frame);
    let bend = bend_at(frame);
    let mut joints = [Some(pose_at(x, y, z, 0.0)); JOINTS];
    joints[0] = Some(pose_at(x, y, z - 0.05, 0.0));
    for finger in 0..FINGERS {
        let across = x + (0.02 * finger as f32 - 0.04);
        let near = PIECE_JOINTS[1 + 2 * finger] as usize;
        let far = PIECE_JOINTS[2 + 2 * finger] as usize;
        joints[near] = Some(pose_at(across, y, z - 0.1, 0.0));
        joints[far] = Some(pose_at(across, y - 0.02 * bend, z - 0.138, bend));
    }
    if (200..210).contains(&frame) {
        joints[9] = None;
        joints[14].as_mut().unwrap().rotation = [0.0; 4];
    }
    joints
}

fn add_body(world: &mut World, kind: BodyKind, [x, y, z]: [f32; 3]) -> BodyId {
    let def = BodyDef::new(kind, pose_at(x, y, z, 0.0));
    world.add_body(&def).unwrap()
}

fn add_fixed_box(world: &mut World, at: [f32; 3], half: [f32; 3]) {
    let body = add_body(world, BodyKind::Fixed, at);
    world
        .add_piece(body, &PieceDef::new(Shape::Box(half), 0.0))
        .unwrap();
}

fn add_hand(world: &mut World) -> BodyId {
    let hand = add_body(world, BodyKind::Driven, KEYS[0].1);
    let mut palm = PieceDef::new(Shape::Box([0.04, 0.008, 0.045]), 0.005);
    palm.material = Material::HUMAN;
    palm.local = pose_at(0.0, 0.0, -0.05, 0.0);
    palm.local.rotation = [0.0, 0.0, 0.0, 1.0];
    world.add_piece(hand, &palm).unwrap();
    for p in 1..PIECES {
        let mut finger = PieceDef::new(Shape::Segment([0.0; 3], [0.0, 0.0, -0.035]), 0.008);
        let z = if p % 2 == 1 { -0.1 } else { -0.138 };
        finger.material = Material::HUMAN;
        finger.local = pose_at(0.02 * ((p - 1) / 2) as f32 - 0.04, 0.0, z, 0.0);
        world.add_piece(hand, &finger).unwrap();
    }
    hand
}

/// A block of the kernel's alignment.
pub fn with_world<R>(act: impl FnOnce(&mut World) -> R) -> R {
    let bytes = Capacities::ROOM.bytes();
    let mut memory = vec![0u8; bytes + 64];
    let past = memory.as_ptr().addr() % 64;
    let block = &mut memory[64 - past..][..bytes];
    act(&mut World::create(block, &Capacities::ROOM).unwrap())
}

/// The hash after `hosts/c/table.c`.
pub fn table() -> u64 {
    with_world(|world| {
        add_fixed_box(world, [0.0, 0.70, 0.0], [0.6, 0.02, 0.4]);
        add_fixed_box(world, [0.0, 0.75, 0.04], [0.02, 0.03, 0.02]);
        let ball = add_body(world, BodyKind::Dynamic, [0.15, 0.761, -0.08]);
        world
            .add_piece(ball, &PieceDef::new(Shape::Point, 0.04))
            .unwrap();
        let hand = add_hand(world);
        for frame in 0..FRAMES {
            let input = JointInput {
                joints: &see_hand(frame),
                root: WRIST,
                piece_joints: &PIECE_JOINTS,
                piece_offsets: &[],
                reach_m: 0.5,
            };
            world.set_joints(hand, &input).unwrap();
            world.step(&FrameInput::unlimited(1.0 / 60.0));
        }
        world.hash()
    })
}

/// The hash after `hosts/cpp/push.cpp`.
pub fn push() -> u64 {
    with_world(|world| {
        add_fixed_box(world, [0.0; 3], [0.01, 1.0, 1.0]);
        let hand = world
            .add_body(&BodyDef::new(BodyKind::Driven, Pose::at(-0.5, 0.0, 0.0)))
            .unwrap();
        let capsule = Shape::Segment([0.0, 0.0, 0.05], [0.0, 0.0, -0.05]);
        world
            .add_piece(hand, &PieceDef::new(capsule, 0.02))
            .unwrap();
        for frame in 0..120 {
            let target = Pose::at(-0.5 + 0.01 * frame as f32, 0.0, 0.0);
            world.set_target(hand, &target).unwrap();
            world.set_piece_targets(hand, &[Pose::IDENTITY]).unwrap();
            world.step(&FrameInput::unlimited(1.0 / 60.0));
        }
        world.hash()
    })
}
