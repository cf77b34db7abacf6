//! An arm that a tracker leads by the wrist, into a wall.

use glam::Vec3;
use palpable::human::{Limb, swing_near};
use palpable::math::Pose;
use palpable::state::chains::ChainOptions;

use super::play::{Scene, Tip};
use super::scenes::{AVATAR_OPTIONS, fixed};
use super::{Figure, refused};
use crate::avatar::motions::{Obstacle, RATE_HZ};
use crate::avatar::{AvatarPlan, Target};
use crate::hand_scene::SceneError;

/// How far the tracker goes into the wall, in metres.
const INTO_M: f32 = 0.15;

/// How far the tracker goes in all, in metres. The arm could follow it, and the hand starts in front.
const WAY_M: f32 = 0.38;

/// How far the tracker goes to either side along the wall, in metres.
const ASIDE_M: f32 = 0.1;

/// Half extents of the wall, in metres; it is thicker than the tracker goes in with the whole hand.
const WALL_HALF_M: [f32; 3] = [1.5, 1.25, 0.25];

/// The tracker goes in.
const IN_FRAMES: u32 = 180;

/// The tracker has gone along the wall and stays.
const STILL_FRAME: u32 = 400;

/// Frames in all.
const FRAMES: u32 = 600;

/// From 0 to 1 without a jump of the speed at either end.
pub(super) fn ease(frame: u32, first: u32, frames: u32) -> f32 {
    let t = frame.saturating_sub(first) as f32 / frames as f32;
    0.5 - 0.5 * (t.min(1.0) * std::f32::consts::PI).cos()
}

/// The right wrist's tracker goes 150 mm into a wall ahead, 100 mm to either side, and stays there.
///
/// # Errors
/// [`SceneError`] when the avatar has no such arm.
pub fn into_wall<'s>(plan: &'s AvatarPlan, figure: &'s Figure) -> Result<Scene<'s>, SceneError> {
    let chain = plan
        .chain(Limb::RightArm)
        .ok_or_else(|| refused("wrist", "no right arm"))?;
    let posture = ready(plan, chain);
    let links = plan.postures(&posture);
    let start = links[chain]
        .last()
        .ok_or_else(|| refused("wrist", "no hinge"))?
        .link;
    // The hand touches before the wrist is there.
    let face = start.translation().z - (WAY_M - INTO_M);
    assert!(face < foremost(plan, &posture), "the arm starts in front");
    let [_, half_y, half_z] = WALL_HALF_M;
    let wall = Obstacle {
        pose: Pose::at(0.0, half_y, face - half_z),
        half_m: WALL_HALF_M,
    };
    let pose = move |frame: u32| {
        let turn = ease(frame, IN_FRAMES, STILL_FRAME - IN_FRAMES);
        let aside = ASIDE_M * (turn * 1.25 * std::f32::consts::TAU).sin();
        let at = start.translation() + Vec3::new(aside, 0.0, -WAY_M * ease(frame, 0, IN_FRAMES));
        Pose::new(start.quat(), at)
    };
    Ok(Scene {
        name: "wrist 150 mm in a wall".to_owned(),
        figure,
        things: vec![fixed(&wall)],
        options: ChainOptions {
            flags: AVATAR_OPTIONS.flags | ChainOptions::HOLDS_TIP,
            ..AVATAR_OPTIONS
        },
        frames: FRAMES,
        rate_hz: RATE_HZ,
        target: Box::new(move |_| posture.clone()),
        tip: Some(Tip {
            chain,
            pose: Box::new(pose),
            out: Vec3::Z,
        }),
    })
}

/// The same with the arm and nothing else, as physics engines are measured with.
///
/// # Errors
/// [`SceneError`] when the avatar has no such arm.
pub fn arm_into_wall<'s>(plan: &'s AvatarPlan, arm: &'s Figure) -> Result<Scene<'s>, SceneError> {
    let mut scene = into_wall(plan, arm)?;
    let Some(tip) = &mut scene.tip else {
        return Err(refused("wrist", "no tracker"));
    };
    let mut posture = (scene.target)(0);
    posture.angles = vec![posture.angles.swap_remove(tip.chain)];
    tip.chain = 0;
    scene.target = Box::new(move |_| posture.clone());
    Ok(scene)
}

/// The right arm of an avatar's figure.
///
/// # Errors
/// [`SceneError`] when the avatar has none.
pub fn right_arm(plan: &AvatarPlan, figure: &Figure) -> Result<Figure, SceneError> {
    let chain = plan.chain(Limb::RightArm);
    let chain = chain.ok_or_else(|| refused("wrist", "no right arm"))?;
    Ok(figure.chain_alone(chain))
}

/// An avatar that stands with the right elbow drawn back and the forearm forward.
fn ready(plan: &AvatarPlan, chain: usize) -> Target {
    let mut target = plan.neutral();
    let shoulder = plan.chains[chain].joints[0].rest().quat().conjugate();
    let upper_arm = Vec3::new(0.2, -1.0, 0.5).normalize();
    let (a, b) = swing_near(shoulder * upper_arm, -std::f32::consts::FRAC_PI_2);
    let angles = &mut target.angles[chain];
    (angles[0], angles[1], angles[3]) = (a, b, 2.0);
    target
}

/// Where the foremost point of the avatar is along Z.
fn foremost(plan: &AvatarPlan, target: &Target) -> f32 {
    let poses = plan.piece_poses(target);
    let points = plan.pieces.iter().zip(&poses).flat_map(|(piece, pose)| {
        let all = piece.points.iter();
        all.map(|&point| pose.point(point.into()).z - piece.radius_m)
    });
    points.fold(f32::INFINITY, f32::min)
}
