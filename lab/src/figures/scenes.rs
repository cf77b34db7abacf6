//! The scenes of the paper's second half, and a hand with bending fingers.

use palpable::math::Pose;
use palpable::state::bodies::BodyKind;
use palpable::state::chains::ChainOptions;

use super::Figure;
use super::play::{Scene, Thing};
use crate::avatar::motions::{ArmSlap, MotionKind, Obstacle, RATE_HZ, Script};

/// Corners of a box.
pub(super) fn corners(half_m: [f32; 3]) -> Vec<[f32; 3]> {
    let sign = |bit: u8| if bit == 0 { -1.0 } else { 1.0 };
    (0..8_u8)
        .map(|i| {
            let [x, y, z] = half_m;
            [x * sign(i & 1), y * sign(i & 2), z * sign(i & 4)]
        })
        .collect()
}

/// A fixed box.
pub(super) fn fixed(obstacle: &Obstacle) -> Thing {
    Thing {
        name: "box".to_owned(),
        kind: BodyKind::Fixed,
        pose: obstacle.pose,
        pieces: vec![(Pose::IDENTITY, corners(obstacle.half_m), 0.0)],
    }
}

/// How an avatar's chains answer.
pub const AVATAR_OPTIONS: ChainOptions = ChainOptions {
    flags: ChainOptions::MOVES_ROOT | ChainOptions::MEETS_BODY,
    ..ChainOptions::DEFAULT
};

fn title(kind: MotionKind) -> &'static str {
    match kind {
        MotionKind::TouchBox => "touching a box",
        MotionKind::PushWall => "two arms into a wall",
        MotionKind::Corner => "arm in a corner",
        MotionKind::CrossArms => "arm against arm",
        MotionKind::Table => "seated at a table",
    }
}

/// A motion of the avatar.
#[must_use]
pub fn of_motion<'s>(figure: &'s Figure, kind: MotionKind, options: ChainOptions) -> Scene<'s> {
    let script = Script::new(kind);
    Scene {
        name: title(kind).to_owned(),
        figure,
        things: script.obstacles.iter().map(fixed).collect(),
        options,
        frames: script.frames,
        rate_hz: RATE_HZ,
        target: Box::new(move |frame| script.target(frame)),
        tip: None,
    }
}

/// A slap of the avatar.
#[must_use]
pub fn of_slap<'s>(figure: &'s Figure, slap: &'s ArmSlap) -> Scene<'s> {
    Scene {
        name: format!("slap at {:.1} m/s", slap.speed),
        figure,
        things: vec![fixed(&slap.plate)],
        options: AVATAR_OPTIONS,
        frames: slap.frames,
        rate_hz: RATE_HZ,
        target: Box::new(|frame| slap.target(frame)),
        tip: None,
    }
}
