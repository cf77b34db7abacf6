//! The hard deadline: what work costs on this machine, and what frames come to when there is too little
//! time.

pub mod costs;
pub mod errors;
mod figure;
pub mod local;
pub mod pauses;
pub mod play;
pub mod set;
pub mod stopwatch;
pub mod table;
pub mod trials;

use std::io;
use std::path::{Path, PathBuf};

use serde::Serialize;

pub use costs::{Calibration, Prices, calibrate};
pub use errors::{Overall, overall};
pub use figure::error_svg;
pub use play::{DEADLINES_US, Outcome};
pub use trials::{Kit, Trial};

use crate::hand_scene::SceneError;

/// All that was found, as `deadline.json` has it.
#[derive(Debug, Serialize)]
pub struct Findings<'a> {
    /// The prices that the deadlines were kept by.
    pub prices: &'a Prices,
    /// Each trial at each deadline.
    pub outcomes: &'a [Outcome],
    /// Errors over all trials at each deadline.
    pub overall: &'a [Overall],
}

/// Plays some trials without a deadline and at all deadlines; `tick` is called after each.
///
/// # Errors
/// [`SceneError`] when a trial could not be set or played.
pub fn run(
    kit: &Kit,
    trials: &[Trial],
    frames: u32,
    prices: Prices,
    mut tick: impl FnMut(&Outcome),
) -> Result<Vec<Outcome>, SceneError> {
    let mut outcomes = Vec::new();
    for &trial in trials {
        let mut trace = play::Trace::sampled_at(&DEADLINES_US, &prices);
        let whole = play::play(kit, trial, frames, None, &prices, &mut trace)?;
        tick(&whole);
        outcomes.push(whole);
        for (deadline_us, local_errors) in DEADLINES_US.into_iter().zip(trace.take_local_errors()) {
            let cut = play::play_undisturbed(kit, trial, frames, deadline_us, &prices, &mut trace)?;
            tick(&cut);
            outcomes.push(Outcome {
                local_errors,
                ..cut
            });
        }
    }
    Ok(outcomes)
}

/// Writes `deadline.json` and the figure.
///
/// # Errors
/// What the file system says, or that a number was not finite.
pub fn write(findings: &Findings, out: &Path) -> io::Result<PathBuf> {
    std::fs::create_dir_all(out)?;
    let json = serde_json::to_string_pretty(findings)?;
    std::fs::write(out.join("deadline.json"), json)?;
    let drawing = error_svg(findings.outcomes, findings.overall).map_err(io::Error::other)?;
    let path = out.join("deadline-error.svg");
    std::fs::write(&path, drawing)?;
    Ok(path)
}
