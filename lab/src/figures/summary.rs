//! What the frames of a scene come to.

use palpable::state::chains::ChainOptions;

use super::play::{Played, Sample, Scene};
use crate::report::{FigureFrame, FigureScene, FirstContact, Quantiles, Rest, Wrist};

/// Frames after a first contact in which the answer is found.
pub const ONSET_FRAMES: usize = 20;

/// Frames after those, in which it is kept.
pub const SUSTAINED_FRAMES: usize = 100;

/// Contacts that are fewer frames apart are one.
const APART_FRAMES: usize = 10;

/// Frames that a tracker has to be still for to say when the figure is.
const STILL_FRAMES_MIN: usize = 60;

/// The figures of a scene that was played; `None` without frames.
#[must_use]
pub fn summary(figure: &str, scene: &Scene, played: &Played) -> Option<FigureScene> {
    let samples = &played.samples;
    let mut times: Vec<f64> = samples.iter().map(|s| s.time_us).collect();
    let most = |value: fn(&Sample) -> f64| samples.iter().map(value).fold(0.0, f64::max);
    Some(FigureScene {
        figure: figure.to_owned(),
        name: played.name.clone(),
        method: if scene.options.method == ChainOptions::CYCLIC_DESCENT {
            "cyclic descent".to_owned()
        } else {
            "least deviation".to_owned()
        },
        frames: samples.len() as u32,
        frame_time_us: Quantiles::from_samples(&mut times)?,
        overlap_fixed_mm_max: most(|s| s.found.fixed_mm),
        overlap_loose_mm_max: most(|s| s.found.loose_mm),
        overlap_own_mm_max: most(|s| s.found.own_mm),
        overlap_own_first_mm: samples.first()?.found.own_mm,
        overlap_own_grown_mm_max: most(|s| s.found.own_grown_mm),
        astray_mm_max: most(|s| s.found.astray_mm),
        beyond_limits_rad_max: most(|s| s.beyond_rad),
        jump_deg_max: most(|s| s.jump_deg),
        wanted_jump_deg_max: most(|s| s.wanted_jump_deg),
        root_off_mm_max: most(|s| s.root_mm),
        steps_total: samples.iter().map(|s| u64::from(s.steps)).sum(),
        steps_max: samples.iter().map(|s| s.steps).max()?,
        steps_untouched: idle_work(samples),
        adjusted_max: samples.iter().map(|s| s.adjusted).max()?,
        contacts_max: samples.iter().map(|s| s.contacts).max()?,
        state_hash: format!("{:016x}", played.hash),
        first_contacts: first_contacts(samples),
        rest: rest(samples),
        wrist: scene.tip.as_ref().map(|_| wrist(samples)),
        samples: (0..).zip(samples).map(frame_of).collect(),
    })
}

/// Frames with steps though nothing touched at their beginning or end.
fn idle_work(samples: &[Sample]) -> u32 {
    let mut touched = false;
    let mut idle = 0;
    for sample in samples {
        let touches = sample.contacts > 0;
        idle += u32::from(sample.steps > 0 && !touches && !touched);
        touched = touches;
    }
    idle
}

fn frame_of((frame, sample): (u32, &Sample)) -> FigureFrame {
    FigureFrame {
        frame,
        time_us: sample.time_us,
        steps: sample.steps,
        adjusted: sample.adjusted,
        contacts: sample.contacts,
        units: sample.units,
        fixed_mm: sample.found.fixed_mm,
        loose_mm: sample.found.loose_mm,
        own_mm: sample.found.own_mm,
        jump_deg: sample.jump_deg,
        root_off_mm: sample.root_mm,
    }
}

/// First and last frame of each stretch of contact.
#[must_use]
pub fn contact_stretches(contacts: &[u32]) -> Vec<(usize, usize)> {
    let mut stretches: Vec<(usize, usize)> = Vec::new();
    for (frame, _) in contacts.iter().enumerate().filter(|(_, count)| **count > 0) {
        match stretches.last_mut() {
            Some((_, last)) if frame - *last <= APART_FRAMES => *last = frame,
            _ => stretches.push((frame, frame)),
        }
    }
    stretches
}

fn first_contacts(samples: &[Sample]) -> Vec<FirstContact> {
    let contacts: Vec<u32> = samples.iter().map(|s| s.contacts).collect();
    let mean = |from: usize, to: usize| {
        let to = to.min(samples.len());
        let steps = samples.get(from..to).unwrap_or_default();
        let total: u32 = steps.iter().map(|s| s.steps).sum();
        f64::from(total) / steps.len().max(1) as f64
    };
    let one = |&(first, last): &(usize, usize)| FirstContact {
        first_frame: first as u32,
        frames: (last + 1 - first) as u32,
        steps_onset_mean: mean(first, first + ONSET_FRAMES),
        steps_sustained_mean: mean(
            first + ONSET_FRAMES,
            first + ONSET_FRAMES + SUSTAINED_FRAMES,
        ),
        steps_after_mean: mean(first + ONSET_FRAMES, last + 1),
    };
    contact_stretches(&contacts).iter().map(one).collect()
}

/// How the figure comes to rest in the longest stretch of still targets in contact.
fn rest(samples: &[Sample]) -> Option<Rest> {
    let mut best: Option<Rest> = None;
    let mut frame = 0;
    while frame < samples.len() {
        let stretch = samples[frame..].iter().take_while(|s| s.still).count();
        if stretch >= STILL_FRAMES_MIN && samples[frame].contacts > 0 {
            let frames = &samples[frame..frame + stretch];
            let moving = frames.iter().rposition(|s| !s.at_rest);
            if best.is_none_or(|best| best.frames < stretch as u32) {
                best = Some(Rest {
                    first_frame: frame as u32,
                    frames: stretch as u32,
                    moving_frames: moving.map_or(0, |last| last as u32 + 1),
                });
            }
        }
        frame += stretch + 1;
    }
    best
}

fn wrist(samples: &[Sample]) -> Wrist {
    let touching = samples.iter().filter(|s| s.contacts > 0);
    let most = |value: fn(&Sample) -> f64| touching.clone().map(value).fold(0.0, f64::max);
    Wrist {
        off_mm_max: most(|s| s.tip_off_mm),
        gap_mm_max: most(|s| s.tip_gap_mm),
    }
}
