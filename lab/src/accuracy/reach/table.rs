//! The results in a terminal.

use comfy_table::{Cell, CellAlignment, ContentArrangement, LineStyle, Table, presets};

use super::ReachAccuracy;
use super::cases::Class;
use super::measure::STEPS;
use crate::accuracy::summary::Spread;

/// What stands where there is nothing to measure.
const NOTHING: &str = "–";

/// All tables: solved shares, postures and times, out of reach, avatars, motion.
pub fn tables(found: &ReachAccuracy) -> String {
    [
        format!(
            "Share solved to 1 mm after so many iterations, {} cases a class that f64 finds possible, \
             seed {}\n{}",
            found.cases, found.seed, solved(found)
        ),
        format!(
            "Posture change over that of the f64 optimum, of those solved after 64 iterations; what \
             limits and\ncones are left by; median time of a call with so many iterations\n{}",
            postures(found)
        ),
        format!(
            "Out of reach: distance beyond the least one after 64 iterations\n{}",
            beyond(found)
        ),
        format!(
            "Avatars of five chains, one after the other: share with every chain solved, and median time \
             of all five\n{}",
            avatars(found)
        ),
        format!(
            "The arm's tip drawn ten times round closed loops, 8 iterations a frame: joints at the end \
             against the\nbeginning, and the largest turn of a joint from frame to frame\n{}",
            motion(found)
        ),
    ]
    .join("\n\n")
}

fn table(header: Vec<String>) -> Table {
    let mut table = Table::new();
    table
        .load_style(presets::UTF8_HORIZONTAL_ONLY.row_separator(LineStyle::none()))
        .set_content_arrangement(ContentArrangement::Disabled)
        .set_header(header);
    table
}

fn right(text: String) -> Cell {
    Cell::new(text).set_alignment(CellAlignment::Right)
}

fn percent(share: f64) -> Cell {
    let text = format!("{:.1}", 100.0 * share);
    right(if share < 1.0 && text == "100.0" {
        format!("{:.2}", 100.0 * share)
    } else {
        text
    })
}

fn number(value: Option<f64>, decimals: usize) -> Cell {
    right(value.map_or_else(|| NOTHING.to_owned(), |value| format!("{value:.decimals$}")))
}

fn header(first: &[&str], last: &[&str]) -> Vec<String> {
    let steps = STEPS.map(|steps| steps.to_string());
    let first = first.iter().map(ToString::to_string);
    first
        .chain(steps)
        .chain(last.iter().map(ToString::to_string))
        .collect()
}

fn solved(found: &ReachAccuracy) -> Table {
    let mut table = table(header(&["chain", "class", "% solved by"], &[]));
    let mut last = None;
    for row in found.rows.iter().filter(|row| row.class != Class::Beyond) {
        let is_new = last.replace((row.model, row.class)) != Some((row.model, row.class));
        let mut cells = vec![
            Cell::new(if is_new { row.model.name() } else { "" }),
            Cell::new(if is_new { row.class.name() } else { "" }),
            Cell::new(row.method.name()),
        ];
        cells.extend(row.solved.map(percent));
        table.add_row(cells);
    }
    table
}

fn postures(found: &ReachAccuracy) -> Table {
    let more = ["ratio med", "p95", "outside rad", "ns/step"];
    let names = ["chain", "class", "ns by"];
    let mut table = table(header(&names, &more));
    let mut last = None;
    for row in &found.rows {
        let is_new = last.replace((row.model, row.class)) != Some((row.model, row.class));
        let mut cells = vec![
            Cell::new(if is_new { row.model.name() } else { "" }),
            Cell::new(if is_new { row.class.name() } else { "" }),
            Cell::new(row.method.name()),
        ];
        cells.extend(row.time_ns.map(|time| number(Some(time), 0)));
        cells.push(number(row.ratio.map(|s| s.median), 3));
        cells.push(number(row.ratio.map(|s| s.p95), 3));
        cells.push(right(format!("{:.1e}", row.violation_rad)));
        cells.push(number(Some(row.step_ns), 0));
        table.add_row(cells);
    }
    table
}

fn beyond(found: &ReachAccuracy) -> Table {
    let header = ["chain", "method", "excess mm med", "p95", "max"];
    let mut table = table(header.map(str::to_owned).into());
    for row in found.rows.iter().filter(|row| row.class == Class::Beyond) {
        let mm = |of: fn(Spread) -> f64| number(row.excess_m.map(|s| 1e3 * of(s)), 3);
        table.add_row([
            Cell::new(row.model.name()),
            Cell::new(row.method.name()),
            mm(|s| s.median),
            mm(|s| s.p95),
            mm(|s| s.max),
        ]);
    }
    table
}

fn avatars(found: &ReachAccuracy) -> Table {
    let mut table = table(header(&["method", ""], &[]));
    for row in &found.avatars {
        let mut cells = vec![Cell::new(row.method.name()), Cell::new("% solved")];
        cells.extend(row.solved.map(percent));
        table.add_row(cells);
        let mut cells = vec![Cell::new(""), Cell::new("ns")];
        cells.extend(row.time_ns.map(|time| number(Some(time), 0)));
        table.add_row(cells);
    }
    table
}

fn motion(found: &ReachAccuracy) -> Table {
    let header = [
        "method",
        "loops",
        "drift deg med",
        "p95",
        "max",
        "jump deg med",
        "p95",
        "max",
    ];
    let mut table = table(header.map(str::to_owned).into());
    for row in &found.drifts {
        let mut cells = vec![Cell::new(row.method.name()), right(row.loops.to_string())];
        for spread in [row.drift_deg, row.jump_deg] {
            cells.push(number(spread.map(|s| s.median), 3));
            cells.push(number(spread.map(|s| s.p95), 3));
            cells.push(number(spread.map(|s| s.max), 3));
        }
        table.add_row(cells);
    }
    table
}
