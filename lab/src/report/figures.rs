//! The numbers of figures with joints, as they stand in `report.json`.

use serde::{Deserialize, Serialize};

use super::Quantiles;
use super::data::slug;

/// How far an angle may be beyond its range, or a limb outside its cone, in radians: rounding.
pub const BEYOND_LIMITS_RAD_MAX: f64 = 1e-5;

/// How far a tracked wrist may be from the nearest place in front of a wall, in millimetres.
pub const WRIST_OFF_MM_MAX: f64 = 5.0;

/// One scene of a figure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FigureScene {
    /// Who moves, such as `avatar in capsules`.
    pub figure: String,
    /// What happens, such as `arm in a corner`.
    pub name: String,
    /// How the chains' angles were found: `least deviation` or `cyclic descent`.
    pub method: String,
    /// Number of frames.
    pub frames: u32,
    /// Frame time, in microseconds of the thread's CPU time.
    pub frame_time_us: Quantiles,
    /// Deepest overlap with a fixed thing, in millimetres.
    pub overlap_fixed_mm_max: f64,
    /// Deepest overlap with a loose thing, in millimetres.
    pub overlap_loose_mm_max: f64,
    /// Deepest overlap of the figure's pieces that are to keep out of each other, in millimetres.
    pub overlap_own_mm_max: f64,
    /// The same in the first frame: a motion may begin so.
    pub overlap_own_first_mm: f64,
    /// The most by which a pair of such pieces got deeper in a frame while deeper than 1 mm.
    pub overlap_own_grown_mm_max: f64,
    /// How far a published piece is from where the published angles have it in f64, in millimetres.
    pub astray_mm_max: f64,
    /// How far an angle is beyond its range, or a limb outside its cone, in radians.
    pub beyond_limits_rad_max: f64,
    /// Largest change of an angle in a frame, in degrees.
    pub jump_deg_max: f64,
    /// Largest change of a wanted angle in a frame, in degrees.
    pub wanted_jump_deg_max: f64,
    /// How far the root is from its target, in millimetres.
    pub root_off_mm_max: f64,
    /// Steps of the chains' solvers over the whole scene.
    pub steps_total: u64,
    /// Most steps in one frame.
    pub steps_max: u32,
    /// Frames with steps and without contact at their beginning and end.
    pub steps_untouched: u32,
    /// Most hinges away from where the tracker wants them in one frame.
    pub adjusted_max: u32,
    /// Most contacts in one frame.
    pub contacts_max: u32,
    /// Hash of the world's state after the last frame, in hexadecimal.
    pub state_hash: String,
    /// The stretches of contact, in their order; one that pauses for at most 10 frames goes on.
    pub first_contacts: Vec<FirstContact>,
    /// The longest stretch of still targets in contact, if one lasts 60 frames.
    pub rest: Option<Rest>,
    /// What a tracker at the wrist showed.
    pub wrist: Option<Wrist>,
    /// One entry per frame, in order.
    pub samples: Vec<FigureFrame>,
}

/// What the solvers did when a stretch of contact began.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FirstContact {
    /// First frame with contact.
    pub first_frame: u32,
    /// Number of frames.
    pub frames: u32,
    /// Mean number of solver steps over the first 20 frames.
    pub steps_onset_mean: f64,
    /// The same over the 100 frames after those.
    pub steps_sustained_mean: f64,
    /// The same over all frames of the contact after the first 20.
    pub steps_after_mean: f64,
}

/// How a figure came to rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Rest {
    /// First frame in which the targets no longer change.
    pub first_frame: u32,
    /// Frames for which they do not.
    pub frames: u32,
    /// Frames of these after which root and angles do not change by one bit.
    pub moving_frames: u32,
}

/// How near a tracked wrist stays in contact.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Wrist {
    /// Largest distance from the tracker along the wall, and behind it, in millimetres.
    pub off_mm_max: f64,
    /// Largest gap between arm and wall, in millimetres.
    pub gap_mm_max: f64,
}

/// What one frame cost and left.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FigureFrame {
    /// Frame number.
    pub frame: u32,
    /// Frame time, in microseconds of the thread's CPU time.
    pub time_us: f64,
    /// Steps of the chains' solvers.
    pub steps: u32,
    /// Hinges that are not where the tracker wants them.
    pub adjusted: u32,
    /// Number of contacts.
    pub contacts: u32,
    /// Units of work.
    pub units: u32,
    /// Deepest overlap with a fixed thing, in millimetres.
    pub fixed_mm: f64,
    /// Deepest overlap with a loose thing, in millimetres.
    pub loose_mm: f64,
    /// Deepest overlap of the figure with itself, in millimetres.
    pub own_mm: f64,
    /// Largest change of an angle, in degrees.
    pub jump_deg: f64,
    /// How far the root is from its target, in millimetres.
    pub root_off_mm: f64,
}

/// What slaps of the avatar's arm at a plate of 20 mm showed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ArmSlaps {
    /// How many slaps.
    pub slaps: u32,
    /// The slowest, in m/s.
    pub speed_min: f64,
    /// The fastest, in m/s.
    pub speed_max: f64,
    /// Slaps with contact.
    pub touched: u32,
    /// Speeds of those that went through: they overlapped the plate by more than is promised, or the
    /// straight way from one frame to the next leads through it.
    pub tunnelled_speeds: Vec<f64>,
    /// Slaps after which a corner of the arm was behind the plate within its outline: an arm that slides off
    /// the edge and swings on ends there without having gone through.
    pub behind: u32,
    /// Deepest overlap with the plate, in millimetres.
    pub overlap_mm_max: f64,
    /// Deepest overlap with the plate on the straight way of the angles between two frames, in millimetres.
    pub overlap_between_mm_max: f64,
    /// Deepest overlap of the avatar with itself, in millimetres; of swings that begin in the body what was
    /// added.
    pub overlap_own_mm_max: f64,
    /// Swings that begin in the body.
    pub began_in_itself: u32,
    /// How far an angle is beyond its range, or a limb outside its cone, in radians.
    pub beyond_limits_rad_max: f64,
    /// Frame time over all slaps, in microseconds of the thread's CPU time.
    pub frame_time_us: Option<Quantiles>,
}

impl FigureScene {
    /// A file-name-safe name.
    pub(super) fn slug(&self) -> String {
        slug(&format!("{} {}", self.figure, self.name))
    }

    /// Whether the pieces of the figure met each other by more than they may: more than 1 mm, unless the
    /// motion began so and they only parted.
    pub(super) fn own_limit_mm(&self) -> f64 {
        self.overlap_own_first_mm.max(super::BALL_OVERLAP_MM_MAX)
    }

    /// All numbers that could be without a value.
    pub(super) fn numbers(&self) -> impl Iterator<Item = f64> {
        let time = &self.frame_time_us;
        let summary = [
            time.median,
            time.p99,
            time.p999,
            time.max,
            self.overlap_fixed_mm_max,
            self.overlap_loose_mm_max,
            self.overlap_own_mm_max,
            self.overlap_own_first_mm,
            self.overlap_own_grown_mm_max,
            self.astray_mm_max,
            self.beyond_limits_rad_max,
            self.jump_deg_max,
            self.wanted_jump_deg_max,
            self.root_off_mm_max,
        ];
        let wrist = self.wrist.iter().flat_map(|w| [w.off_mm_max, w.gap_mm_max]);
        let contacts = self.first_contacts.iter();
        let contacts = contacts.flat_map(|c| {
            [
                c.steps_onset_mean,
                c.steps_sustained_mean,
                c.steps_after_mean,
            ]
        });
        let samples = self.samples.iter().flat_map(|s| {
            [
                s.time_us,
                s.fixed_mm,
                s.loose_mm,
                s.own_mm,
                s.jump_deg,
                s.root_off_mm,
            ]
        });
        summary
            .into_iter()
            .chain(wrist)
            .chain(contacts)
            .chain(samples)
    }
}

impl ArmSlaps {
    /// All numbers that could be without a value.
    pub(super) fn numbers(&self) -> impl Iterator<Item = f64> {
        let time = self.frame_time_us.iter();
        let time = time.flat_map(|t| [t.median, t.p99, t.p999, t.max]);
        [
            self.speed_min,
            self.speed_max,
            self.overlap_mm_max,
            self.overlap_between_mm_max,
            self.overlap_own_mm_max,
            self.beyond_limits_rad_max,
        ]
        .into_iter()
        .chain(self.tunnelled_speeds.iter().copied())
        .chain(time)
    }
}
