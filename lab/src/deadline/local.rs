//! Local errors: what too little time costs within a frame, and within a few.
//!
//! Two runs of a scene that have come apart stay apart, so that the distance of whole runs tells of the
//! scene more than of what was cut. As the local error of a numerical method is that of one step from the
//! exact solution, so here: from states of the run without a deadline the same inputs are played with a
//! budget, and compared with what the run itself goes on to.

use glam::DVec3;
use palpable::frame::FrameInput;
use palpable::world::World;

use super::errors::{Distances, LocalError};
use super::set::Cast;
use crate::hand_scene::SceneError;

/// Every so many frames errors are sampled: no multiple of the 20 frames for which trackers of
/// [`super::Trial::FullPools`] stay, so that all phases of them are met.
pub const SAMPLED_EVERY: u32 = 47;

/// After so many frames from a sampled state poses are compared: one, and a tenth of a second or so.
pub const HORIZONS: [u32; 2] = [1, 10];

const LONGEST: u32 = HORIZONS[HORIZONS.len() - 1];
// The run has come to where one sample ends before the next one begins.
const _: () = assert!(LONGEST <= SAMPLED_EVERY);

/// Where the things are that are compared.
#[derive(Default)]
struct Places {
    /// Origins of the driven pieces.
    driven: Vec<DVec3>,
    /// Origins of the loose bodies.
    loose: Vec<DVec3>,
}

impl Places {
    fn of(world: &World, cast: &Cast) -> Result<Self, SceneError> {
        let stale = |e| SceneError(format!("{e:?}"));
        let pieces = cast.pieces.iter().map(|&id| world.piece_pose(id));
        let bodies = cast.loose.iter().map(|&id| world.pose(id));
        let at = |pose: palpable::math::Pose| pose.translation().as_dvec3();
        Ok(Self {
            driven: pieces
                .map(|pose| pose.map(at).map_err(stale))
                .collect::<Result<_, _>>()?,
            loose: bodies
                .map(|pose| pose.map(at).map_err(stale))
                .collect::<Result<_, _>>()?,
        })
    }
}

/// The mean distance in millimetres; nothing when there is nothing to compare.
fn mean_mm(a: &[DVec3], b: &[DVec3]) -> Option<f64> {
    let sum: f64 = a.iter().zip(b).map(|(a, b)| a.distance(*b)).sum();
    (!a.is_empty()).then(|| 1e3 * sum / a.len() as f64)
}

/// One input, where it led from the last sampled state, and how far that was off in all samples.
struct Branch {
    input: FrameInput,
    led_to: [Places; HORIZONS.len()],
    driven_mm: [Vec<f64>; HORIZONS.len()],
    loose_mm: [Vec<f64>; HORIZONS.len()],
}

/// Samples a run as it is played.
#[derive(Default)]
pub struct Sampler {
    branches: Vec<Branch>,
    /// The state at the start of `from`.
    snapshot: Vec<u8>,
    from: u32,
}

impl Sampler {
    /// Of these inputs, which are to have no clock: a budget, or a deadline and prices.
    pub fn new(inputs: impl IntoIterator<Item = FrameInput>) -> Self {
        let branch = |input| Branch {
            input,
            led_to: Default::default(),
            driven_mm: Default::default(),
            loose_mm: Default::default(),
        };
        Self {
            branches: inputs.into_iter().map(branch).collect(),
            ..Self::default()
        }
    }

    /// Plays the frames from `from` on with each input, and rolls the world back. `tell` says what the
    /// trackers see in a frame.
    ///
    /// # Errors
    /// [`SceneError`] when the world cannot be told, saved or loaded.
    pub fn branch(
        &mut self,
        world: &mut World,
        cast: &Cast,
        from: u32,
        mut tell: impl FnMut(&mut World, u32) -> Result<(), SceneError>,
    ) -> Result<(), SceneError> {
        let refused = |e| SceneError(format!("{e:?}"));
        self.from = from;
        self.snapshot.resize(world.snapshot_bytes(), 0);
        world.save(&mut self.snapshot).map_err(refused)?;
        for branch in &mut self.branches {
            for frame in 0..LONGEST {
                tell(world, from + frame)?;
                world.step(&branch.input);
                if let Some(horizon) = horizon_after(frame) {
                    branch.led_to[horizon] = Places::of(world, cast)?;
                }
            }
            world.load(&self.snapshot).map_err(refused)?;
        }
        Ok(())
    }

    /// Compares where the branches led with where the run itself is after `frame`.
    ///
    /// # Errors
    /// [`SceneError`] when an id is stale.
    pub fn compare(&mut self, world: &World, cast: &Cast, frame: u32) -> Result<(), SceneError> {
        let Some(horizon) = frame.checked_sub(self.from).and_then(horizon_after) else {
            return Ok(());
        };
        let places = Places::of(world, cast)?;
        for branch in &mut self.branches {
            let led_to = &branch.led_to[horizon];
            branch.driven_mm[horizon].extend(mean_mm(&led_to.driven, &places.driven));
            branch.loose_mm[horizon].extend(mean_mm(&led_to.loose, &places.loose));
        }
        Ok(())
    }

    /// Whether a run of so many frames is sampled at the start of this one: there is something to be
    /// compared, and a frame before it, and all horizons lie in the run.
    #[must_use]
    pub fn is_due(&self, frame: u32, frames: u32) -> bool {
        let is_turn = frame % SAMPLED_EVERY == SAMPLED_EVERY - 1;
        is_turn && frame + LONGEST <= frames && !self.branches.is_empty()
    }

    /// For each input the error after each of [`HORIZONS`].
    #[must_use]
    pub fn errors(self) -> Vec<Vec<LocalError>> {
        let of = |branch: Branch| {
            let found = branch.driven_mm.into_iter().zip(branch.loose_mm);
            let errors = found
                .zip(HORIZONS)
                .map(|((driven, loose), frames)| LocalError {
                    frames,
                    driven: Distances::of_mm(driven),
                    loose: Distances::of_mm(loose),
                });
            errors.collect()
        };
        self.branches.into_iter().map(of).collect()
    }
}

/// Which horizon is reached with this frame, counted from the sampled state.
fn horizon_after(frame: u32) -> Option<usize> {
    HORIZONS.iter().position(|&frames| frames == frame + 1)
}
