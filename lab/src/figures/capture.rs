//! Motion capture played by the avatar on a floor, with a table and a wall near its path.

use std::path::Path;

use glam::Vec3;
use palpable::math::Pose;

use super::Figure;
use super::play::{Scene, play};
use super::scenes::{AVATAR_OPTIONS, fixed};
use super::summary::summary;
use crate::avatar::bvh::{self, Frame};
use crate::avatar::motions::{MOTION_HEIGHT_M, Obstacle};
use crate::avatar::{AvatarPlan, Style, Target, Trunk};
use crate::hand_scene::SceneError;
use crate::report::FigureScene;

/// What stands near the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Obstacles {
    /// The floor alone.
    None,
    /// A box as high as a table.
    Table,
    /// A wall.
    Wall,
    /// Both.
    Both,
}

impl Obstacles {
    fn count(self) -> [bool; 2] {
        match self {
            Self::None => [false, false],
            Self::Table => [false, true],
            Self::Wall => [true, false],
            Self::Both => [true, true],
        }
    }
}

/// Room that obstacles leave the first posture, in metres.
const ROOM_M: f32 = 0.02;

/// How far into the stretch that the motion needs beyond its first posture an obstacle stands.
const SHARE: f32 = 0.4;

/// A table's height in metres.
const TABLE_HEIGHT_M: f32 = 0.75;

/// Why a file was not played.
#[derive(Debug)]
pub enum CaptureError {
    /// The file is not motion capture of a person.
    File(bvh::BvhError),
    /// The world refused something.
    Scene(SceneError),
}

impl std::fmt::Display for CaptureError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::File(why) => why.fmt(f),
            Self::Scene(why) => why.fmt(f),
        }
    }
}

impl std::error::Error for CaptureError {}

/// A clip on an avatar.
pub struct Clip {
    plan: AvatarPlan,
    figure: Figure,
    targets: Vec<Target>,
    rate_hz: f32,
    /// How many hinges, swings and twists had to be changed to be within their limits, over all frames.
    pub clamped: u64,
}

impl Clip {
    /// Reads a file.
    ///
    /// # Errors
    /// [`CaptureError::File`] names the line and what is wrong there.
    pub fn read(path: &Path, style: Style) -> Result<Self, CaptureError> {
        let motion = bvh::read(path).map_err(CaptureError::File)?;
        let plan = AvatarPlan::new(MOTION_HEIGHT_M, style, Trunk::Bending);
        let frames = motion.frames(&plan).map_err(CaptureError::File)?;
        Ok(Self {
            figure: Figure::of_avatar(&plan),
            plan,
            clamped: frames.iter().map(|frame| u64::from(frame.clamped)).sum(),
            targets: frames
                .into_iter()
                .map(|Frame { target, .. }| target)
                .collect(),
            rate_hz: (1.0 / motion.frame_s) as f32,
        })
    }

    /// Frames of the clip.
    #[must_use]
    pub fn frames(&self) -> u32 {
        self.targets.len() as u32
    }

    /// Plays the clip.
    ///
    /// # Errors
    /// [`CaptureError::Scene`] names what the world refused.
    pub fn play(
        &self,
        name: &str,
        obstacles: Obstacles,
        tick: impl FnMut(),
    ) -> Result<Option<FigureScene>, CaptureError> {
        let scene = self.scene(name, obstacles);
        let played = play(&scene, tick).map_err(CaptureError::Scene)?;
        Ok(summary("motion capture", &scene, &played))
    }

    fn scene(&self, name: &str, obstacles: Obstacles) -> Scene<'_> {
        let boxes = self.boxes(obstacles);
        Scene {
            name: name.to_owned(),
            figure: &self.figure,
            things: boxes.iter().map(fixed).collect(),
            options: AVATAR_OPTIONS,
            frames: self.frames(),
            rate_hz: self.rate_hz,
            target: Box::new(|frame| {
                let last = self.targets.len() - 1;
                self.targets[(frame as usize).min(last)].clone()
            }),
            tip: None,
        }
    }

    /// The floor, a wall on the side to which the motion goes farthest, a table on the side to which it
    /// goes farthest but one. The first posture is free of all.
    fn boxes(&self, obstacles: Obstacles) -> Vec<Obstacle> {
        let first = self.bounds(&self.targets[..1]);
        let all = self.bounds(&self.targets);
        let floor = f32::min(0.0, first[0].y - 0.001);
        let middle = 0.5 * (all[0] + all[1]);
        let reach = 0.5 * (all[1] - all[0]).max_element() + 2.0;
        let ground = Obstacle {
            pose: Pose::at(middle.x, floor - 0.1, middle.z),
            half_m: [reach, 0.1, reach],
        };
        // Ways out of the first posture: axis and sign.
        let mut ways = [(0, -1.0_f32), (0, 1.0), (2, -1.0), (2, 1.0)];
        let beyond = |&(axis, sign): &(usize, f32)| {
            let end = usize::from(sign > 0.0);
            sign * (all[end][axis] - first[end][axis])
        };
        ways.sort_by(|a, b| beyond(b).total_cmp(&beyond(a)));
        let heights = [2.0, TABLE_HEIGHT_M];
        let wanted = obstacles.count().into_iter().zip(heights);
        let mut boxes = vec![ground];
        for ((is_wanted, height), way) in wanted.zip(&ways) {
            if is_wanted {
                let &(axis, sign) = way;
                let end = usize::from(sign > 0.0);
                let mut centre = 0.5 * (first[0] + first[1]);
                let mut half = Vec3::new(1.0, 0.5 * height, 1.0);
                half[axis] = 0.3;
                let face = first[end][axis] + sign * (SHARE * beyond(way)).max(ROOM_M);
                centre[axis] = face + sign * half[axis];
                centre.y = floor + 0.5 * height;
                boxes.push(Obstacle {
                    pose: Pose::at(centre.x, centre.y, centre.z),
                    half_m: half.to_array(),
                });
            }
        }
        boxes
    }

    fn bounds(&self, targets: &[Target]) -> [Vec3; 2] {
        let mut bounds = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        for target in targets {
            let poses = self.plan.piece_poses(target);
            for (piece, pose) in self.plan.pieces.iter().zip(&poses) {
                for &point in &piece.points {
                    let at = pose.point(point.into());
                    bounds[0] = bounds[0].min(at - piece.radius_m);
                    bounds[1] = bounds[1].max(at + piece.radius_m);
                }
            }
        }
        bounds
    }
}
