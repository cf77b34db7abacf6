//! `report.json`: indented down to the runs, then one line per phase and per frame, so that a
//! person can read and compare thousands of frames.

use std::io::{self, Write};

use serde::Serialize;
use serde_json::ser::{CompactFormatter, Formatter, PrettyFormatter, Serializer};

use super::{ArmSlaps, FigureScene, Phase, Report};

/// Report, `runs`, run, `phases` or `samples`: what is nested deeper goes on one line.
const INDENTED_LEVELS: usize = 4;

/// The report as JSON that ends in a line feed.
///
/// # Errors
/// [`io::ErrorKind::InvalidData`] if a number is not finite.
pub fn to_json(report: &Report) -> io::Result<String> {
    if !has_finite_numbers(report) {
        let message = "the report holds a number that is not finite";
        return Err(io::Error::new(io::ErrorKind::InvalidData, message));
    }
    let mut bytes = Vec::new();
    report.serialize(&mut Serializer::with_formatter(
        &mut bytes,
        OneLinePerRow::default(),
    ))?;
    bytes.push(b'\n');
    String::from_utf8(bytes).map_err(io::Error::other)
}

/// `serde_json` writes NaN and infinities as `null`, which reads back as an error or as `None`.
fn has_finite_numbers(report: &Report) -> bool {
    let hand = &report.hand;
    let hand_numbers = [
        hand.uncovered_share,
        hand.uncovered_mm_max,
        hand.sticking_out_mm_max,
        hand.sticking_out_mm_mean,
    ];
    let phases = report
        .runs
        .iter()
        .flat_map(|run| &run.phases)
        .flat_map(phase_numbers);
    let samples = report.runs.iter().flat_map(|run| &run.samples);
    let sample_numbers = samples.flat_map(|sample| [sample.time_us, sample.overlap_mm]);
    hand_numbers
        .into_iter()
        .chain(phases)
        .chain(sample_numbers)
        .chain(report.figures.iter().flat_map(FigureScene::numbers))
        .chain(report.arm_slaps.iter().flat_map(ArmSlaps::numbers))
        .all(f64::is_finite)
}

fn phase_numbers(phase: &Phase) -> impl Iterator<Item = f64> {
    let time = &phase.frame_time_us;
    let always = [
        time.median,
        time.p99,
        time.p999,
        time.max,
        phase.overlap_hand_fixed_mm_max,
        phase.overlap_ball_fixed_mm_max,
        phase.overlap_hand_ball_mm_max,
        phase.contacts_mean,
    ];
    always
        .into_iter()
        .chain(phase.free_lag_mm_max)
        .chain(phase.jitter_mm_max)
}

struct OneLinePerRow {
    pretty: PrettyFormatter<'static>,
    level: usize,
}

impl Default for OneLinePerRow {
    fn default() -> Self {
        Self {
            pretty: PrettyFormatter::new(),
            level: 0,
        }
    }
}

impl OneLinePerRow {
    fn is_indented(&self) -> bool {
        self.level <= INDENTED_LEVELS
    }

    fn separator<W: ?Sized + Write>(writer: &mut W, first: bool) -> io::Result<()> {
        if first {
            Ok(())
        } else {
            writer.write_all(b", ")
        }
    }
}

impl Formatter for OneLinePerRow {
    fn begin_array<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.level += 1;
        if self.is_indented() {
            self.pretty.begin_array(writer)
        } else {
            CompactFormatter.begin_array(writer)
        }
    }

    fn end_array<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        let indented = self.is_indented();
        self.level -= 1;
        if indented {
            self.pretty.end_array(writer)
        } else {
            CompactFormatter.end_array(writer)
        }
    }

    fn begin_array_value<W: ?Sized + Write>(
        &mut self,
        writer: &mut W,
        first: bool,
    ) -> io::Result<()> {
        if self.is_indented() {
            self.pretty.begin_array_value(writer, first)
        } else {
            Self::separator(writer, first)
        }
    }

    fn end_array_value<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        if self.is_indented() {
            self.pretty.end_array_value(writer)
        } else {
            Ok(())
        }
    }

    fn begin_object<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.level += 1;
        if self.is_indented() {
            self.pretty.begin_object(writer)
        } else {
            CompactFormatter.begin_object(writer)
        }
    }

    fn end_object<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        let indented = self.is_indented();
        self.level -= 1;
        if indented {
            self.pretty.end_object(writer)
        } else {
            CompactFormatter.end_object(writer)
        }
    }

    fn begin_object_key<W: ?Sized + Write>(
        &mut self,
        writer: &mut W,
        first: bool,
    ) -> io::Result<()> {
        if self.is_indented() {
            self.pretty.begin_object_key(writer, first)
        } else {
            Self::separator(writer, first)
        }
    }

    fn begin_object_value<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        writer.write_all(b": ")
    }

    fn end_object_value<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        if self.is_indented() {
            self.pretty.end_object_value(writer)
        } else {
            Ok(())
        }
    }
}
