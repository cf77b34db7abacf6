//! Slaps of the hand through a wall: does anything end behind it?
//!
//! The tracker drives the hand through a wall of 20 mm and half a metre beyond, with the fingers or the
//! palm first, from ten starting points that shift the frames against the wall.

use glam::{DQuat, DVec3};
use palpable::frame::FrameInput;
use palpable::math::Pose;
use palpable::state::bodies::BodyKind;
use palpable::world::{BodyDef, PieceDef, Shape, World};

use crate::hand::{Hand, HandPose};
use crate::hand_scene::{self, CAPACITIES, SceneError};
use crate::memory::Block;
use crate::reference::{self, Judge, Solid};
use crate::report::Slaps;
use crate::script::{HandTarget, RATE_HZ};

/// Speeds of the slaps, in m/s.
pub const SPEEDS: [f64; 3] = [5.0, 10.0, 20.0];

/// Starting points a speed and direction.
pub const OFFSETS: u32 = 10;

/// Thickness of the wall, in metres.
const WALL_M: f64 = 0.02;

/// The wall's near face is this far from the start, in metres.
const WAY_M: f64 = 0.6;

const WALL_HALF: [f32; 3] = [1.0, 1.0, (WALL_M / 2.0) as f32];

/// One slap along -Z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slap {
    /// In m/s.
    pub speed: f64,
    /// The palm goes first; else the fingers.
    pub palm_first: bool,
    /// Share of a frame's way that the start is shifted by.
    pub offset: f64,
}

/// All slaps.
#[must_use]
pub fn slaps() -> Vec<Slap> {
    let mut all = Vec::new();
    for speed in SPEEDS {
        for palm_first in [false, true] {
            for offset in 0..OFFSETS {
                all.push(Slap {
                    speed,
                    palm_first,
                    offset: f64::from(offset) / f64::from(OFFSETS),
                });
            }
        }
    }
    all
}

/// Runs slaps and counts what ended behind the wall.
///
/// # Errors
/// [`SceneError`] when the world refused something.
pub fn run(hand: &Hand, slaps: &[Slap]) -> Result<Slaps, SceneError> {
    let mut total = Slaps {
        slaps: slaps.len() as u32,
        parts_behind: 0,
        overlap_mm_max: 0.0,
    };
    for slap in slaps {
        let (behind, overlap_m) = run_one(hand, slap)?;
        total.parts_behind += behind;
        total.overlap_mm_max = total.overlap_mm_max.max(1e3 * overlap_m);
    }
    Ok(total)
}

/// Parts with a corner behind the wall's near face by more than the promised overlap, in any frame;
/// and the deepest overlap in metres.
fn run_one(hand: &Hand, slap: &Slap) -> Result<(u32, f64), SceneError> {
    let refused = |why: &dyn std::fmt::Debug| SceneError(format!("{slap:?}: {why:?}"));
    let mut block = Block::new(&CAPACITIES);
    let mut world = World::create(block.bytes(), &CAPACITIES).map_err(|e| refused(&e))?;
    let wall_pose = Pose::at(0.0, 0.0, -(WALL_M / 2.0) as f32);
    let wall = world
        .add_body(&BodyDef::new(BodyKind::Fixed, wall_pose))
        .map_err(|e| refused(&e))?;
    world
        .add_piece(wall, &PieceDef::new(Shape::Box(WALL_HALF), 0.0))
        .map_err(|e| refused(&e))?;
    let (body, pieces) = hand_scene::add_hand(&mut world, hand, &target(slap, 0))?;
    let judge = judge(hand, &wall_pose)?;
    let mut behind = vec![false; pieces.len()];
    let mut deepest: f64 = 0.0;
    for frame in 0..frames(slap) {
        let target = target(slap, frame);
        let locals = hand_scene::locals(hand, &target);
        world
            .set_target(body, &hand_scene::wrist(&target))
            .and_then(|()| world.set_piece_targets(body, &locals))
            .map_err(|e| refused(&e))?;
        world.step(&FrameInput::unlimited((1.0 / RATE_HZ) as f32));
        let poses = hand_scene::poses_of_pieces(&world, &pieces)?;
        for (part, (behind, pose)) in hand.parts.iter().zip(behind.iter_mut().zip(&poses)) {
            *behind |= is_behind(&part.vertices, pose);
        }
        let verdict = judge.frame(&poses);
        deepest = deepest.max(verdict.deepest.map_or(0.0, |overlap| overlap.depth_m));
    }
    Ok((behind.iter().filter(|b| **b).count() as u32, deepest))
}

/// Until the tracker is half a metre behind the wall, and a second more.
fn frames(slap: &Slap) -> u32 {
    ((WAY_M + 0.5) / slap.speed * RATE_HZ).ceil() as u32 + RATE_HZ as u32
}

fn target(slap: &Slap, frame: u32) -> HandTarget {
    let way = slap.speed * (f64::from(frame) + slap.offset) / RATE_HZ;
    let orientation = if slap.palm_first {
        // The palm faces -Y; turned about +X by a quarter it faces -Z.
        DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2)
    } else {
        DQuat::IDENTITY
    };
    HandTarget {
        orientation,
        position: DVec3::new(0.0, 0.0, WAY_M - way.min(WAY_M + 0.5)),
        from: HandPose::Flat,
        to: HandPose::Relaxed,
        weight: 0.5,
        free: false,
        resting: false,
    }
}

fn judge(hand: &Hand, wall: &Pose) -> Result<Judge, SceneError> {
    let refused = |why| SceneError(format!("reference: {why:?}"));
    let mut judge = Judge::new();
    let [x, y, z] = WALL_HALF;
    let corners: Vec<[f32; 3]> = (0..8)
        .map(|c: u32| {
            let sign = |bit: u32| if c >> bit & 1 == 0 { -1.0 } else { 1.0 };
            [sign(0) * x, sign(1) * y, sign(2) * z]
        })
        .collect();
    let solid = Solid::from_f32(&corners, 0.0).map_err(refused)?;
    let pose = reference::Pose::from_f32(wall.rotation, wall.position);
    judge.add_fixed(solid, 0, hand_scene::FIXED, "wall", pose);
    for part in &hand.parts {
        let solid = Solid::from_f32(&part.vertices, 0.0).map_err(refused)?;
        judge.add_moving(solid, 1, hand_scene::HAND, &part.name);
    }
    Ok(judge)
}

fn is_behind(vertices: &[[f32; 3]], pose: &reference::Pose) -> bool {
    let limit = -f64::from(palpable::limits::OVERLAP_SLOP_M);
    vertices.iter().any(|v| {
        let corner = DVec3::new(f64::from(v[0]), f64::from(v[1]), f64::from(v[2]));
        (pose.rotation * corner + pose.position).z < limit
    })
}
