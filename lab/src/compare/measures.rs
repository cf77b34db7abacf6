//! The figures of a scene, read off what was published and judged.

use std::ops::Range;

use glam::Vec3;

use super::grip;
use super::judging::{Reading, largest};
use super::play::Shot;
use super::scenes::{PRESS_FRAMES, PUSH_MEETS_FRAME, Scene, TRAP_FRAMES};
use super::setting::Setting;

/// What is measured: smaller is better.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measure {
    /// What it is.
    pub name: &'static str,
    /// Its unit; empty for a count.
    pub unit: &'static str,
    /// The most that the kernel promises.
    pub promised: Option<f64>,
    /// Counts add up over the trackers; of anything else the worst tracker counts.
    pub is_count: bool,
}

const fn millimetres(name: &'static str, promised: Option<f64>) -> Measure {
    Measure {
        name,
        unit: "mm",
        promised,
        is_count: false,
    }
}

/// Of a lag.
pub const LAG: Measure = millimetres("lag behind the tracker", Some(0.0));
/// See [`LAG`].
pub const PUSH_LAG: Measure = millimetres("lag behind the tracker", Some(1.0));
/// Of overlaps.
pub const PRESSED: Measure = millimetres("pressed: hand in table", Some(0.1));
/// See [`PRESSED`].
pub const PRESSED_RMS: Measure = millimetres("pressed: the same, rms", None);
/// See [`PRESSED`].
pub const SLID: Measure = millimetres("sliding: hand in table", Some(0.1));
/// See [`PRESSED`].
pub const SLID_RMS: Measure = millimetres("sliding: the same, rms", None);
/// See [`PRESSED`].
pub const PUSHED: Measure = millimetres("hand in ball", Some(1.0));
/// See [`PRESSED`].
pub const TRAPPED: Measure = millimetres("hand in ball", Some(0.3));
/// See [`PRESSED`].
pub const WALLED: Measure = millimetres("ball in wall and floor", Some(0.3));
/// See [`PRESSED`].
pub const HELD: Measure = millimetres("hand in box", Some(0.1));
/// How far anything goes from frame to frame under still trackers, after a second.
pub const JITTER: Measure = millimetres("jitter under a still tracker", Some(0.0));
/// How long after the trackers anything still moved by a single bit; all the rest of the scene when it never
/// came to rest.
pub const REST: Measure = Measure {
    name: "at rest to the bit after",
    unit: "s",
    promised: None,
    is_count: false,
};
/// How far the box is from where the hands should have it, at the end.
pub const SLIPPED: Measure = millimetres("box off its place at the end", None);
/// How far the hands that hold the box are from their trackers: what a wedged box costs.
pub const HELD_BACK: Measure = millimetres("hand off its tracker", None);
/// Boxes that fell, or that the hands could not take along.
pub const DROPPED: Measure = Measure {
    name: "boxes dropped or left behind",
    unit: "",
    promised: Some(0.0),
    is_count: true,
};

/// A box farther from its place is dropped, in millimetres: half of it.
const DROPPED_MM: f64 = 30.0;

/// The figures of a scene for one tracker.
#[must_use]
pub fn measures(
    scene: Scene,
    setting: &Setting,
    shots: &[Shot],
    readings: &[Reading],
) -> Vec<(Measure, f64)> {
    let most = |frames: Range<u32>, value: fn(&Reading) -> f64| {
        largest(within(readings, frames).iter().map(value))
    };
    let all = 0..setting.frames();
    let [arrived, pressed, slides, slid] = PRESS_FRAMES;
    let second = super::setting::RATE_HZ as u32;
    match scene {
        Scene::Free => vec![(LAG, most(all, |r| r.lag_mm))],
        Scene::Press => vec![
            (PRESSED, most(0..pressed, |r| r.hand_fixed_mm)),
            (PRESSED_RMS, rms(within(readings, arrived..pressed))),
            (JITTER, most(arrived + second..pressed, |r| r.moved_mm)),
            (SLID, most(slides..slid, |r| r.hand_fixed_mm)),
            (SLID_RMS, rms(within(readings, slides..slid))),
        ],
        Scene::Push => vec![
            (PUSH_LAG, most(all.clone(), |r| r.lag_mm)),
            (PUSHED, most(all, |r| r.hand_loose_mm)),
        ],
        Scene::Trap => {
            let still = TRAP_FRAMES.start + second..TRAP_FRAMES.end;
            vec![
                (TRAPPED, most(all.clone(), |r| r.hand_loose_mm)),
                (WALLED, most(all, |r| r.loose_fixed_mm)),
                (JITTER, most(still, |r| r.moved_mm)),
            ]
        }
        Scene::Squeeze | Scene::Carry => {
            let carried = scene == Scene::Carry;
            let slipped_mm = slipped_mm(setting, shots, carried);
            // What is not a number is nowhere near its place either.
            let dropped = slipped_mm.is_nan() || slipped_mm > DROPPED_MM;
            let still = grip::still_frames(carried);
            vec![
                (DROPPED, f64::from(dropped)),
                (SLIPPED, slipped_mm),
                (HELD_BACK, most(all.clone(), |r| r.lag_mm)),
                (HELD, most(all, |r| r.hand_loose_mm)),
                (JITTER, most(still.clone(), |r| r.moved_mm)),
                (REST, rest_s(readings, still.start - second)),
            ]
        }
        Scene::Idle => vec![(LAG, most(all, |r| r.lag_mm))],
    }
}

/// Seconds from a frame to the last one in which anything moved.
fn rest_s(readings: &[Reading], still_from: u32) -> f64 {
    let after = &readings[still_from as usize..];
    let last = after.iter().rposition(|r| r.moved_mm != 0.0);
    last.map_or(0.0, |last| (last + 1) as f64) / f64::from(super::setting::RATE_HZ)
}

/// The largest median of a frame with contact and of an idle one that is promised, in microseconds.
const CONTACT_US: Option<f64> = Some(20.0);
/// See [`CONTACT_US`].
const IDLE_US: Option<f64> = Some(2.0);

/// A stretch of a scene whose frame times belong together.
#[derive(Clone, Debug, PartialEq)]
pub struct Timed {
    /// What happens in it.
    pub name: &'static str,
    /// Its frames.
    pub frames: Range<u32>,
    /// The largest median that is promised, in microseconds.
    pub promised_us: Option<f64>,
}

/// The stretches of a scene whose times count: those with contact, or all where there is none.
#[must_use]
pub fn timed(scene: Scene) -> Vec<Timed> {
    let stretch = |name, frames, promised_us| Timed {
        name,
        frames,
        promised_us,
    };
    let end = u32::MAX;
    let [arrived, pressed, slides, slid] = PRESS_FRAMES;
    let whole = |first, promised_us| vec![stretch(scene.name(), first..end, promised_us)];
    match scene {
        Scene::Free => whole(0, None),
        Scene::Press => vec![
            stretch("pressed into a table", arrived..pressed, CONTACT_US),
            stretch("slid along it", slides..slid, CONTACT_US),
        ],
        Scene::Push => whole(PUSH_MEETS_FRAME, CONTACT_US),
        Scene::Trap => whole(TRAP_FRAMES.start, CONTACT_US),
        Scene::Squeeze | Scene::Carry => whole(grip::pedestal_frame(), CONTACT_US),
        Scene::Idle => whole(0, IDLE_US),
    }
}

/// A stretch of frames, as far as they were played.
#[must_use]
pub fn within(readings: &[Reading], frames: Range<u32>) -> &[Reading] {
    let end = (frames.end as usize).min(readings.len());
    &readings[(frames.start as usize).min(end)..end]
}

fn rms(readings: &[Reading]) -> f64 {
    let squares = readings.iter().map(|r| r.hand_fixed_mm * r.hand_fixed_mm);
    (squares.sum::<f64>() / readings.len().max(1) as f64).sqrt()
}

fn slipped_mm(setting: &Setting, shots: &[Shot], carried: bool) -> f64 {
    let Some(last) = shots.last() else {
        return f64::NAN;
    };
    let way = if carried {
        grip::carried_m(setting.frames())
    } else {
        Vec3::ZERO
    };
    let place = setting.loose[0].pose.translation() + way;
    1e3 * f64::from((last.loose[0].translation() - place).length())
}
