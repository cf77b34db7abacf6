//! The outcomes as tables.

use comfy_table::{Cell, CellAlignment, LineStyle, Table, presets};

use super::costs::{Calibration, Prices};
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

/// Frame times, misses and what was cut.
#[must_use]
pub fn of_times(outcomes: &[Outcome]) -> String {
    let mut table = table(&[
        "trial",
        "deadline [us]",
        "processor: median / 99 / 99.9 / 99.99 % / max [us]",
        "wall: the same [us]",
        "misses: processor, those again in a replay, a loop as long, wall",
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
            right(outcome.above_price),
            right(outcome.frames),
            right(format!("{}, {}", outcome.cut, outcome.late)),
        ]);
    }
    table.to_string()
}

/// Error against budget, and what the judge found.
#[must_use]
pub fn of_errors(outcomes: &[Outcome]) -> String {
    let mut table = table(&[
        "trial",
        "deadline [us]",
        "mean price [us]",
        "distance from the run without a deadline: mean, 99 % [mm]",
        "judged",
        "overlap > 0.1 mm",
        "deepest [mm]",
    ]);
    for outcome in outcomes {
        table.add_row([
            Cell::new(outcome.trial),
            right(deadline(outcome)),
            right(us(outcome.priced_us_mean)),
            right(format!(
                "{:.3}, {:.3}",
                outcome.error_mm_mean, outcome.error_mm_p99
            )),
            right(outcome.judged),
            right(outcome.violations),
            right(format!("{:.4}", outcome.overlap_mm)),
        ]);
    }
    table.to_string()
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
