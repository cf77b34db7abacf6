//! Playing a setting on an engine: what it publishes and how long it takes, frame by frame.

use std::time::Duration;

use cpu_time::ThreadTime;
use palpable::math::Pose;

use super::setting::Setting;
use crate::hand_scene::SceneError;

/// Something that moves hands and loose things. A frame is told and stepped like this by a host.
pub trait Engine {
    /// Takes a fixed thing away.
    ///
    /// # Errors
    /// [`SceneError`] when the engine refuses.
    fn remove_fixed(&mut self, index: usize) -> Result<(), SceneError>;

    /// Tells where the wrists' trackers are, one pose a hand, and steps one frame.
    ///
    /// # Errors
    /// [`SceneError`] when the engine refuses.
    fn step(&mut self, wrists: &[Pose]) -> Result<(), SceneError>;

    /// The published poses of a hand's parts, in the world.
    ///
    /// # Errors
    /// [`SceneError`] when the engine has lost one.
    fn parts(&self, hand: usize) -> Result<Vec<Pose>, SceneError>;

    /// The published pose of a loose thing.
    ///
    /// # Errors
    /// [`SceneError`] when the engine has lost it.
    fn loose(&self, index: usize) -> Result<Pose, SceneError>;
}

/// What a frame published.
#[derive(Clone, Debug, PartialEq)]
pub struct Shot {
    /// CPU time of the thread for telling the targets and stepping.
    pub spent: Duration,
    /// For each hand the poses of its parts.
    pub hands: Vec<Vec<Pose>>,
    /// Poses of the loose things.
    pub loose: Vec<Pose>,
}

/// Plays all frames of a setting. Only telling the targets and stepping is in the time.
///
/// # Errors
/// [`SceneError`] when the engine refuses.
pub fn play(setting: &Setting, engine: &mut dyn Engine) -> Result<Vec<Shot>, SceneError> {
    let mut shots = Vec::new();
    for frame in 0..setting.frames() {
        for (index, fixed) in setting.fixed.iter().enumerate() {
            if fixed.until == Some(frame) {
                engine.remove_fixed(index)?;
            }
        }
        let wrists: Vec<Pose> = setting
            .hands
            .iter()
            .map(|hand| hand.wrist[frame as usize])
            .collect();
        let begun = ThreadTime::now();
        engine.step(&wrists)?;
        let spent = begun.elapsed();
        shots.push(shot(setting, engine, spent)?);
    }
    Ok(shots)
}

fn shot(setting: &Setting, engine: &dyn Engine, spent: Duration) -> Result<Shot, SceneError> {
    let hands = 0..setting.hands.len();
    let loose = 0..setting.loose.len();
    Ok(Shot {
        spent,
        hands: hands
            .map(|hand| engine.parts(hand))
            .collect::<Result<_, _>>()?,
        loose: loose
            .map(|index| engine.loose(index))
            .collect::<Result<_, _>>()?,
    })
}
