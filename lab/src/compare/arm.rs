//! The avatar's right arm, led by its wrist 150 mm into a wall.

use palpable::math::Pose;

use super::judging::largest;
use super::setting::Perturbation;
use crate::avatar::motions::MOTION_HEIGHT_M;
use crate::avatar::{AvatarPlan, Style, Trunk};
use crate::figures::play::{Scene, play};
use crate::figures::{Figure, wrist};
use crate::hand_scene::SceneError;

/// First frame that is judged for jitter: the tracker has been still for a second.
const STILL_FROM: usize = 490;

/// What an arm showed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ArmFound {
    /// Deepest overlap with the wall in any frame, in millimetres.
    pub overlap_mm: f64,
    /// How far a hinge was beyond its range at most, in degrees.
    pub beyond_deg: f64,
    /// Largest turn of a hinge from frame to frame under a still tracker, in degrees.
    pub jitter_deg: f64,
    /// CPU time of each frame, in microseconds.
    pub times_us: Vec<f64>,
}

impl ArmFound {
    /// Takes a frame in.
    pub fn note(&mut self, overlap_mm: f64, beyond_deg: f64, turned_deg: f64, time_us: f64) {
        self.overlap_mm = largest([self.overlap_mm, overlap_mm].into_iter());
        self.beyond_deg = largest([self.beyond_deg, beyond_deg].into_iter());
        if self.times_us.len() >= STILL_FROM {
            self.jitter_deg = largest([self.jitter_deg, turned_deg].into_iter());
        }
        self.times_us.push(time_us);
    }
}

/// The avatar.
pub struct Arm {
    /// As plain data.
    pub plan: AvatarPlan,
    figure: Figure,
}

impl Default for Arm {
    fn default() -> Self {
        let plan = AvatarPlan::new(MOTION_HEIGHT_M, Style::Hulls, Trunk::Rigid);
        let figure = Figure::of_avatar(&plan);
        Self { plan, figure }
    }
}

impl Arm {
    /// The lab's scene with another tracker.
    ///
    /// # Errors
    /// [`SceneError`] when the avatar has no such arm.
    pub fn scene(&self, tracker: Perturbation) -> Result<Scene<'_>, SceneError> {
        let mut scene = wrist::into_wall(&self.plan, &self.figure)?;
        if let Some(tip) = scene.tip.as_mut() {
            let straight = std::mem::replace(&mut tip.pose, Box::new(|_| Pose::IDENTITY));
            tip.pose = Box::new(move |frame| {
                let pose = straight(frame);
                let turn = glam::Quat::from_rotation_y(tracker.heading_rad);
                Pose::new(turn * pose.quat(), pose.translation() + tracker.offset)
            });
        }
        Ok(scene)
    }

    /// Plays it on the kernel.
    ///
    /// # Errors
    /// [`SceneError`] names what the world refused.
    pub fn play(&self, tracker: Perturbation) -> Result<ArmFound, SceneError> {
        let played = play(&self.scene(tracker)?, || ())?;
        let mut found = ArmFound::default();
        for sample in &played.samples {
            let beyond_deg = sample.beyond_rad.to_degrees();
            let overlap_mm = sample.found.fixed_mm;
            found.note(overlap_mm, beyond_deg, sample.jump_deg, sample.time_us);
        }
        Ok(found)
    }
}
