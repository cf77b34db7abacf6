//! What a simulation did: one sees from it that it exercised something.

use palpable::frame::FrameReport;

use crate::host::Call;
use crate::invariants::Worst;
use crate::overlap::Class;

/// Counts over frames and scenes.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// Scenes that were begun.
    pub scenes: u64,
    /// Frames that were judged, those included whose time step was none.
    pub frames: u64,
    /// Frames that moved nothing because of their time step.
    pub still: u64,
    /// Frames that a budget cut.
    pub cut: u64,
    /// Frames with a contact that the host can read.
    pub touching: u64,
    /// Frames that found a pool full.
    pub full: u64,
    /// Frames that reported overlap that the host made.
    pub overlapping: u64,
    /// Frames stepped again from a snapshot, elsewhere and with what was spent as budget.
    pub replayed: u64,
    /// Calls by kind: those that were taken, and those that were refused by name.
    pub calls: [[u64; 2]; Call::COUNT],
    /// The deepest overlaps, in metres.
    pub worst: Worst,
}

impl Tally {
    /// Counts a frame.
    pub fn note(&mut self, report: &FrameReport) {
        let has = |flags: u32| u64::from(report.flags & flags != 0);
        self.frames += 1;
        self.still += has(FrameReport::BAD_TIME_STEP);
        self.cut +=
            has(FrameReport::ADVANCE_CUT | FrameReport::IMPULSES_CUT | FrameReport::REACH_CUT);
        self.full += has(FrameReport::FULL_PAIRS | FrameReport::FULL_CONTACTS);
        self.overlapping += has(FrameReport::OVERLAP);
        self.touching += u64::from(report.contacts > 0);
    }

    /// Takes the deeper overlaps of both.
    pub fn note_worst(&mut self, worst: &Worst) {
        for class in 0..Class::COUNT {
            self.worst.clean_m[class] = self.worst.clean_m[class].max(worst.clean_m[class]);
            self.worst.made_m[class] = self.worst.made_m[class].max(worst.made_m[class]);
            self.worst.excused_m[class] = self.worst.excused_m[class].max(worst.excused_m[class]);
        }
        self.worst.outside_rad = self.worst.outside_rad.max(worst.outside_rad);
    }
}
