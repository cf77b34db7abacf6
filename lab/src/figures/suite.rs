//! Every scene of the figures, one after the other.

use palpable::state::chains::ChainOptions;

use super::grasps::Grasps;
use super::play::{Scene, play};
use super::scenes::{AVATAR_OPTIONS, of_motion};
use super::summary::summary;
use super::{Figure, slaps, wrist};
use crate::avatar::motions::{self, MOTION_HEIGHT_M, MotionKind};
use crate::avatar::{AvatarPlan, Style, Trunk};
use crate::hand::Hand;
use crate::hand_scene::SceneError;
use crate::report::{ArmSlaps, FigureScene};

/// Seed of the arm's slaps.
pub const SLAP_SEED: u64 = 2004;

/// Everything that the scenes need.
pub struct Suite {
    hulls: AvatarPlan,
    capsules: AvatarPlan,
    hulls_figure: Figure,
    capsules_figure: Figure,
    hulls_arm: Figure,
    capsules_arm: Figure,
    grasps: Grasps,
}

/// The paper's method beside the kernel's own.
const CYCLIC: ChainOptions = ChainOptions {
    method: ChainOptions::CYCLIC_DESCENT,
    ..AVATAR_OPTIONS
};

impl Suite {
    /// With the lab's hand.
    ///
    /// # Errors
    /// [`SceneError`] when the avatar has no right arm.
    pub fn new(hand: &Hand) -> Result<Self, SceneError> {
        let plan = |style| AvatarPlan::new(MOTION_HEIGHT_M, style, Trunk::Rigid);
        let (hulls, capsules) = (plan(Style::Hulls), plan(Style::Capsules));
        let [hulls_figure, capsules_figure] = [&hulls, &capsules].map(Figure::of_avatar);
        Ok(Self {
            hulls_arm: wrist::right_arm(&hulls, &hulls_figure)?,
            capsules_arm: wrist::right_arm(&capsules, &capsules_figure)?,
            hulls_figure,
            capsules_figure,
            hulls,
            capsules,
            grasps: Grasps::new(hand),
        })
    }

    /// All scenes, with the name of the figure that plays.
    ///
    /// # Errors
    /// [`SceneError`] when a scene could not be set.
    pub fn scenes(&self) -> Result<Vec<(String, Scene<'_>)>, SceneError> {
        let hulls = format!("avatar of {} triangles", self.hulls.triangles());
        let mut all = Vec::new();
        for kind in MotionKind::ALL {
            let scene = of_motion(&self.hulls_figure, kind, AVATAR_OPTIONS);
            all.push((hulls.clone(), scene));
            if kind == MotionKind::PushWall {
                let mut scene = of_motion(&self.hulls_figure, kind, CYCLIC);
                scene.name = "wall by cyclic descent".to_owned();
                all.push((hulls.clone(), scene));
            }
        }
        let scene = wrist::into_wall(&self.hulls, &self.hulls_figure)?;
        all.push((hulls, scene));
        let scene = wrist::arm_into_wall(&self.hulls, &self.hulls_arm)?;
        all.push(("arm alone".to_owned(), scene));
        for kind in MotionKind::ALL {
            let scene = of_motion(&self.capsules_figure, kind, AVATAR_OPTIONS);
            all.push(("avatar in capsules".to_owned(), scene));
        }
        let scene = wrist::into_wall(&self.capsules, &self.capsules_figure)?;
        all.push(("avatar in capsules".to_owned(), scene));
        let scene = wrist::arm_into_wall(&self.capsules, &self.capsules_arm)?;
        all.push(("arm alone in capsules".to_owned(), scene));
        for scene in self.grasps.scenes()? {
            all.push(("hand with bending fingers".to_owned(), scene));
        }
        Ok(all)
    }

    /// Plays at most so many frames of every scene; `tick` is called after every frame.
    ///
    /// # Errors
    /// [`SceneError`] names what the world refused.
    pub fn run(
        &self,
        frames_max: u32,
        mut tick: impl FnMut(),
    ) -> Result<Vec<FigureScene>, SceneError> {
        let mut done = Vec::new();
        for (figure, mut scene) in self.scenes()? {
            scene.frames = scene.frames.min(frames_max);
            let played = play(&scene, &mut tick)?;
            done.extend(summary(&figure, &scene, &played));
        }
        Ok(done)
    }

    /// Frames that [`Suite::run`] plays.
    ///
    /// # Errors
    /// [`SceneError`] when a scene could not be set.
    pub fn frames(&self, frames_max: u32) -> Result<u64, SceneError> {
        let scenes = self.scenes()?;
        let frames = scenes.iter().map(|(_, scene)| scene.frames.min(frames_max));
        Ok(frames.map(u64::from).sum())
    }

    /// The first slaps of the arm.
    ///
    /// # Errors
    /// [`SceneError`] names what the world refused.
    pub fn slaps(&self, count: usize, tick: impl FnMut()) -> Result<ArmSlaps, SceneError> {
        let all = motions::slaps(SLAP_SEED);
        slaps::run(&self.hulls, &all[..count.min(all.len())], tick)
    }
}
