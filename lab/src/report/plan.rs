//! Where the parts of a frame-time figure stand, in pixels.

use super::Run;
use super::format::time_us;
use super::labels::{Layout, Wish, overhang, shortened, text_width};
use super::series::frame_range;

pub(super) const NAME_PX: f64 = 13.0;
pub(super) const SMALL_PX: f64 = 12.0;

pub(super) const WIDTH: f64 = 1120.0;
pub(super) const LEFT: f64 = 70.0;
pub(super) const FULL_RIGHT: f64 = WIDTH - 26.0;
const LABELS_TOP: f64 = 72.0;
const LABEL_ROW: f64 = 40.0;
const TIME_PANEL: f64 = 320.0;
const PANEL_GAP: f64 = 44.0;
const WORK_PANEL: f64 = 110.0;
const AXIS_STRIP: f64 = 56.0;

const LABEL_CHARACTERS_MAX: usize = 32;

/// A panel's upper and lower edge.
#[derive(Clone, Copy)]
pub(super) struct Panel {
    pub(super) top: f64,
    pub(super) bottom: f64,
}

pub(super) struct Plan {
    /// Right edge of the panels: flags of late phases need room beyond it.
    pub(super) right: f64,
    /// First frame and one past the last.
    pub(super) frames: (f64, f64),
    pub(super) wishes: Vec<Wish>,
    pub(super) layout: Layout,
    pub(super) time: Panel,
    pub(super) work: Panel,
    pub(super) height: f64,
}

impl Plan {
    pub(super) fn new(run: &Run) -> Self {
        let frames = frame_range(run);
        let right = FULL_RIGHT - overhang(&wishes(run, frames, FULL_RIGHT), FULL_RIGHT);
        let wishes = wishes(run, frames, right);
        let layout = Layout::new(&wishes);
        let time = Panel::new(LABELS_TOP + LABEL_ROW * layout.rows() as f64, TIME_PANEL);
        let work = Panel::new(time.bottom + PANEL_GAP, WORK_PANEL);
        Self {
            right,
            frames,
            wishes,
            layout,
            time,
            work,
            height: work.bottom + AXIS_STRIP,
        }
    }

    pub(super) fn x(&self, frame: f64) -> f64 {
        x_of(frame, self.frames, self.right)
    }

    /// Middle of a label row's height.
    pub(super) fn label_y(&self, row: usize) -> f64 {
        self.time.top - LABEL_ROW * (row as f64 + 0.5)
    }
}

impl Panel {
    pub(super) fn new(top: f64, height: f64) -> Self {
        Self {
            top,
            bottom: top + height,
        }
    }

    /// Height of a share of the axis, 0 at the bottom and 1 at the top.
    pub(super) fn y(self, share: f64) -> f64 {
        self.bottom - (self.bottom - self.top) * share.clamp(0.0, 1.0)
    }
}

/// A phase's name, and its figures in small print.
pub(super) fn label_lines(run: &Run, index: usize) -> [String; 2] {
    let phase = &run.phases[index];
    let time = &phase.frame_time_us;
    let figures = format!(
        "median {}, max {} µs",
        time_us(time.median),
        time_us(time.max)
    );
    [shortened(&phase.name, LABEL_CHARACTERS_MAX), figures]
}

fn wishes(run: &Run, frames: (f64, f64), right: f64) -> Vec<Wish> {
    (0..run.phases.len())
        .map(|index| wish(run, index, frames, right))
        .collect()
}

fn wish(run: &Run, index: usize, frames: (f64, f64), right: f64) -> Wish {
    let phase = &run.phases[index];
    let [name, figures] = label_lines(run, index);
    Wish {
        band_left: x_of(f64::from(phase.first_frame), frames, right),
        band_right: x_of(f64::from(phase.first_frame + phase.frames), frames, right),
        width: text_width(&name, NAME_PX, true).max(text_width(&figures, SMALL_PX, false)),
    }
}

fn x_of(frame: f64, (first, end): (f64, f64), right: f64) -> f64 {
    LEFT + (right - LEFT) * (frame - first) / (end - first)
}
