//! The comparison in a terminal.

use comfy_table::{Cell, CellAlignment, ContentArrangement, LineStyle, Table, presets};

use super::summary::{Comparison, ENGINES, Found, Row, Standing};
use crate::report::Quantiles;

/// What stands where there is nothing to say.
const NOTHING: &str = "–";

/// All tables: what must hold, and frame times.
#[must_use]
pub fn tables(found: &Comparison) -> String {
    format!(
        "Worst of {} trackers, median in brackets; of {} slaps, the peer's {}; seed {}\n{}\n\n\
         Frame time, CPU of the thread: median / p99 / max in µs of the frames in contact, or of all \
         where there is none\n{}",
        found.trackers,
        found.slaps[0],
        found.slaps[1],
        found.seed,
        rows(found).trim_fmt(),
        times(found).trim_fmt()
    )
}

fn table(last: [&str; 3]) -> Table {
    let mut table = Table::new();
    let header = last[..2].iter().chain(&ENGINES).chain(&last[2..]);
    table
        .load_style(presets::UTF8_HORIZONTAL_ONLY.row_separator(LineStyle::none()))
        .set_content_arrangement(ContentArrangement::Disabled)
        .set_header(header);
    table
}

fn right(text: String) -> Cell {
    Cell::new(text).set_alignment(CellAlignment::Right)
}

fn rows(found: &Comparison) -> Table {
    let mut table = table(["scene and figure", "promised", "kept, beside the peer"]);
    let mut last = "";
    for row in &found.rows {
        if last != row.scene {
            table.add_row([row.scene]);
            last = row.scene;
        }
        let unit = match row.unit {
            "" => String::new(),
            unit => format!(" [{unit}]"),
        };
        let mut cells = vec![Cell::new(format!("  {}{unit}", row.measure))];
        cells.push(right(promise(row.promised)));
        cells.extend(row.found.iter().map(|found| right(shown(found.as_ref()))));
        cells.push(Cell::new(verdict(row)));
        table.add_row(cells);
    }
    table
}

fn promise(promised: Option<f64>) -> String {
    match promised {
        None => NOTHING.to_owned(),
        Some(0.0) => "0".to_owned(),
        Some(most) => format!("≤ {most}"),
    }
}

/// Exact zero is a promise of its own and must not look like something small.
fn number(value: f64) -> String {
    match value {
        0.0 => "0".to_owned(),
        small if small.abs() < 0.001 => format!("{small:.0e}"),
        small if small.abs() < 1.0 => format!("{small:.3}"),
        large if large.fract() == 0.0 => format!("{large}"),
        large => format!("{large:.2}"),
    }
}

fn shown(found: Option<&Found>) -> String {
    let Some(found) = found else {
        return NOTHING.to_owned();
    };
    let worst = number(found.worst);
    match found.median {
        None => worst,
        Some(median) => format!("{worst} ({})", number(median)),
    }
}

fn kept(is_kept: Option<bool>) -> &'static str {
    match is_kept {
        None => NOTHING,
        Some(true) => "pass",
        Some(false) => "FAIL",
    }
}

fn verdict(row: &Row) -> String {
    let beside = match row.standing() {
        None => NOTHING,
        Some(Standing::Better) => "better",
        Some(Standing::Equal) => "equal",
        Some(Standing::Worse) => "worse",
    };
    format!("{}, {beside}", kept(row.is_kept()))
}

fn times(found: &Comparison) -> Table {
    let mut table = table(["scene", "promised", "kept, times faster"]);
    for row in &found.times {
        let mut cells = vec![Cell::new(row.scene), right(promise(row.promised_us))];
        cells.extend(row.found.iter().map(|found| right(spread(found.as_ref()))));
        let peers = row.found[1..].iter().flatten().map(|q| q.median);
        let best = peers.reduce(f64::min);
        let faster = best
            .zip(row.found[0])
            .map(|(best, ours)| best / ours.median);
        let faster = faster.map_or(NOTHING.to_owned(), |times| format!("{times:.1}"));
        cells.push(Cell::new(format!("{}, {faster}", kept(row.is_kept()))));
        table.add_row(cells);
    }
    table
}

fn spread(found: Option<&Quantiles>) -> String {
    found.map_or_else(
        || NOTHING.to_owned(),
        |q| {
            let whole = |us: f64| {
                if us < 10.0 {
                    format!("{us:.1}")
                } else {
                    format!("{us:.0}")
                }
            };
            format!("{} / {} / {}", whole(q.median), whole(q.p99), whole(q.max))
        },
    )
}
