//! The outcomes as tables.

use comfy_table::{Cell, CellAlignment, LineStyle, Table, presets};

use super::costs::{Calibration, Prices};
use super::errors::{Distances, LocalError, Overall};
use super::local::{HORIZONS, SAMPLED_EVERY};
use super::play::{Outcome, Times};

fn right(text: impl ToString) -> Cell {
    Cell::new(text).set_alignment(CellAlignment::Right)
}

fn table(heads: &[&str]) -> Table {
    let mut table = Table::new();
    table
        .load_style(presets::UTF8_HORIZONTAL_ONLY.row_separator(LineStyle::none()))
        .set_header(heads.iter().map(Cell::new));
    table
}

fn us(value: f64) -> String {
    if value < 10.0 {
        format!("{value:.1}")
    } else {
        format!("{value:.0}")
    }
}

fn times(times: &Times) -> String {
    [times.median, times.p99, times.p999, times.p9999, times.max]
        .map(us)
        .join(" / ")
}

fn deadline(outcome: &Outcome) -> String {
    outcome
        .deadline_us
        .map_or("none".to_owned(), |us| us.to_string())
}

/// What runs showed that were not taken.
fn disturbed(outcome: &Outcome) -> String {
    let runs = outcome.disturbed.iter();
    let told: Vec<String> = runs
        .map(|run| {
            format!(
                "{}, {}, {}",
                run.misses_cpu, run.misses_again, run.misses_loop
            )
        })
        .collect();
    if told.is_empty() {
        "-".to_owned()
    } else {
        told.join("; ")
    }
}

/// Frame times, misses and what was cut.
#[must_use]
pub fn of_times(outcomes: &[Outcome]) -> String {
    let mut table = table(&[
        "trial",
        "deadline [us]",
        "processor: median / 99 / 99.9 / 99.99 % / max [us]",
        "wall: the same [us]",
        "misses: processor, those again in a replay, a loop as long, wall",
        "the first three in disturbed runs",
        "above price",
        "frames",
        "cut by price, by clock",
    ]);
    for outcome in outcomes {
        table.add_row([
            Cell::new(outcome.trial),
            right(deadline(outcome)),
            right(times(&outcome.cpu_us)),
            right(times(&outcome.wall_us)),
            right(format!(
                "{}, {}, {}, {}",
                outcome.misses_cpu, outcome.misses_again, outcome.misses_loop, outcome.misses_wall
            )),
            right(disturbed(outcome)),
            right(outcome.above_price),
            right(outcome.frames),
            right(format!("{}, {}", outcome.cut, outcome.late)),
        ]);
    }
    table.to_string()
}

/// Prices, and what the judge found.
#[must_use]
pub fn of_overlaps(outcomes: &[Outcome]) -> String {
    let mut table = table(&[
        "trial",
        "deadline [us]",
        "mean price [us]",
        "judged",
        "overlap > 0.1 mm",
        "deepest [mm]",
    ]);
    for outcome in outcomes {
        table.add_row([
            Cell::new(outcome.trial),
            right(deadline(outcome)),
            right(us(outcome.priced_us_mean)),
            right(outcome.judged),
            right(outcome.violations),
            right(format!("{:.4}", outcome.overlap_mm)),
        ]);
    }
    table.to_string()
}

fn mean_and_99(distances: &Distances) -> Cell {
    right(if distances.count == 0 {
        "-".to_owned()
    } else {
        format!("{:.3}, {:.3}", distances.mean_mm, distances.p99_mm)
    })
}

/// Error against deadline: of a frame, of a few, and of whole runs.
#[must_use]
pub fn of_errors(outcomes: &[Outcome], overall: &[Overall]) -> String {
    let [soon, later] = HORIZONS.map(|frames| match frames {
        1 => "1 frame".to_owned(),
        _ => format!("{frames} frames"),
    });
    let heads = [
        "trial".to_owned(),
        "deadline [us]".to_owned(),
        "samples".to_owned(),
        format!("driven, {soon} from the same state: mean, 99 % [mm]"),
        format!("driven, {later} from the same state [mm]"),
        "driven, whole runs apart [mm]".to_owned(),
        format!("loose, {soon} [mm]"),
        format!("loose, {later} [mm]"),
    ];
    let mut table = table(&heads.each_ref().map(String::as_str));
    let mut row = |trial: &str, deadline_us: u32, local: &[LocalError], run: &Distances| {
        let [soon, later] = local else { return };
        table.add_row([
            Cell::new(trial),
            right(deadline_us),
            right(soon.driven.count),
            mean_and_99(&soon.driven),
            mean_and_99(&later.driven),
            mean_and_99(run),
            mean_and_99(&soon.loose),
            mean_and_99(&later.loose),
        ]);
    };
    for at in outcomes {
        if let Some(us) = at.deadline_us {
            row(at.trial, us, &at.local_errors, &at.run_error);
        }
    }
    for at in overall {
        row("all", at.deadline_us, &at.local_errors, &at.run_error);
    }
    format!(
        "distances from where there is no deadline, in the mean over the pieces of a frame: after as many \
         frames from the same state, sampled every {SAMPLED_EVERY} frames, with what the deadline buys and no \
         clock; and between the whole runs\n{table}"
    )
}

/// A cost table.
#[must_use]
pub fn of_prices(prices: &Prices, found: Option<&Calibration>) -> String {
    let mut table = table(&["what", "price [ns]"]);
    for (what, ns) in [
        ("frame", prices.frame_ns),
        ("body", prices.body_ns),
        ("piece", prices.piece_ns),
        ("chain", prices.chain_ns),
        ("256 tests of boxes", prices.boxes_ns),
        ("advance unit", prices.advance_unit_ns),
        ("impulse unit", prices.impulse_unit_ns),
        ("reach step", prices.reach_step_ns),
        ("kept from the clock for pauses", prices.pauses_ns),
    ] {
        table.add_row([Cell::new(what), right(ns)]);
    }
    let said = found.map_or(String::new(), |found| {
        format!(
            "\nfrom {} frames; raised by {:.2}, for frames that cost more than the sum of their prices \
             and a margin",
            found.frames, found.raised
        )
    });
    format!("{table}{said}")
}
