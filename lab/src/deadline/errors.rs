//! What errors come to: distances of published poses from those that there was time for.

use serde::Serialize;

use super::play::Outcome;

/// Distances, each the mean over the things of one frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Distances {
    /// How many.
    pub count: usize,
    /// Mean, in millimetres.
    pub mean_mm: f64,
    /// 99th percentile, in millimetres.
    pub p99_mm: f64,
    /// All of them from the least on, so that scenes can be put together.
    #[serde(skip)]
    sorted_mm: Vec<f64>,
}

impl Distances {
    /// Of distances in millimetres.
    #[must_use]
    pub fn of_mm(mut mm: Vec<f64>) -> Self {
        mm.sort_by(f64::total_cmp);
        let count = mm.len();
        let rank = (count * 99).div_ceil(100);
        Self {
            count,
            mean_mm: mm.iter().sum::<f64>() / count.max(1) as f64,
            p99_mm: rank.checked_sub(1).map_or(0.0, |index| mm[index]),
            sorted_mm: mm,
        }
    }

    fn pooled<'a>(parts: impl Iterator<Item = &'a Self>) -> Self {
        Self::of_mm(parts.flat_map(|part| &part.sorted_mm).copied().collect())
    }
}

/// What too little time comes to within so many frames from the same state.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct LocalError {
    /// Frames that were played from the state.
    pub frames: u32,
    /// Of the driven pieces, those on links of chains included.
    pub driven: Distances,
    /// Of the loose bodies.
    pub loose: Distances,
}

/// Errors at one deadline over all trials; each trial weighs as much as it has frames.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Overall {
    /// In microseconds.
    pub deadline_us: u32,
    /// As in [`Outcome::local_errors`].
    pub local_errors: Vec<LocalError>,
    /// As in [`Outcome::run_error`].
    pub run_error: Distances,
}

/// Puts the trials together, deadline by deadline.
#[must_use]
pub fn overall(outcomes: &[Outcome]) -> Vec<Overall> {
    let mut deadlines_us: Vec<u32> = outcomes.iter().filter_map(|at| at.deadline_us).collect();
    deadlines_us.sort_unstable();
    deadlines_us.dedup();
    let at = |deadline_us: u32| {
        let of_it = || {
            outcomes
                .iter()
                .filter(move |at| at.deadline_us == Some(deadline_us))
        };
        let horizons = of_it().map(|at| at.local_errors.len()).min().unwrap_or(0);
        let local = |horizon: usize| {
            let errors = || of_it().map(move |at| &at.local_errors[horizon]);
            LocalError {
                frames: errors().map(|error| error.frames).max().unwrap_or(0),
                driven: Distances::pooled(errors().map(|error| &error.driven)),
                loose: Distances::pooled(errors().map(|error| &error.loose)),
            }
        };
        Overall {
            deadline_us,
            local_errors: (0..horizons).map(local).collect(),
            run_error: Distances::pooled(of_it().map(|at| &at.run_error)),
        }
    };
    deadlines_us.into_iter().map(at).collect()
}
