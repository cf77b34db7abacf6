//! The results in a terminal.

use comfy_table::{Cell, CellAlignment, ContentArrangement, LineStyle, Table, presets};

use super::Accuracy;
use super::methods::Method;
use super::summary::{Beyond, ERROR_AIM, LEFT_AIM, Ratios, Row, Spread, Walks};
use super::unions::UnionRow;

/// What stands where there is nothing to measure.
const NOTHING: &str = "–";

/// All tables: accuracy and time per class and method, ratios with their targets, the
/// paper's local walk, failures, unions.
pub fn tables(accuracy: &Accuracy) -> String {
    [
        format!(
            "Depth and distance against f64, {} pairs a class, seed {}. Errors relative to the smaller \
             piece's size;\nleft: what moving by the answer leaves. Warm: moved by 1 mm or 1 %, and 5 mrad.\n\
             The local walk is asked for overlapping pairs only.\n{}",
            accuracy.pairs,
            accuracy.seed,
            rows(&accuracy.rows)
        ),
        format!(
            "Palpable is faster than parry3d f32 by these factors (medians of the calls that\nanswered at all, right or wrong; aims in brackets)\n{}",
            ratios(&accuracy.ratios)
        ),
        format!(
            "The paper's local walk on overlapping pairs: how often it ended deeper than the depth, and off by\n\
             more than a tenth of it; by what factor at worst, and median ns, of pairs that do more than touch\n{}",
            walks(&accuracy.walks)
        ),
        format!(
            "Where Palpable is less exact than aimed at: error {ERROR_AIM:e}, left {LEFT_AIM:e}\n{}",
            beyond(&accuracy.beyond)
        ),
        format!("Least translation of unions\n{}", unions(&accuracy.unions)),
        failures(accuracy),
    ]
    .join("\n\n")
}

fn table(header: &[&str]) -> Table {
    let mut table = Table::new();
    table
        .load_style(presets::UTF8_HORIZONTAL_ONLY.row_separator(LineStyle::none()))
        .set_content_arrangement(ContentArrangement::Disabled)
        .set_header(header.iter().copied());
    table
}

fn right(text: String) -> Cell {
    Cell::new(text).set_alignment(CellAlignment::Right)
}

fn exponent(value: Option<f64>) -> Cell {
    right(value.map_or_else(|| NOTHING.to_owned(), |value| format!("{value:.1e}")))
}

fn whole(value: Option<f64>) -> Cell {
    right(value.map_or_else(|| NOTHING.to_owned(), |value| format!("{value:.0}")))
}

fn rows(rows: &[Row]) -> Table {
    let mut table = table(&[
        "class",
        "method",
        "failed",
        "error med",
        "p99",
        "max",
        "left med",
        "p99",
        "max",
        "ns med",
        "p99",
    ]);
    let mut last = None;
    for row in rows {
        let is_new = last.replace(row.class) != Some(row.class);
        let mut cells = vec![
            Cell::new(if is_new { row.class.name() } else { "" }),
            Cell::new(row.method.name()),
            right(format!("{}/{}", row.failures, row.pairs)),
        ];
        for spread in [row.error, row.left] {
            cells.push(exponent(spread.map(|s| s.median)));
            cells.push(exponent(spread.map(|s| s.p99)));
            cells.push(exponent(spread.map(|s| s.max)));
        }
        cells.push(whole(row.time_ns.map(|s| s.median)));
        cells.push(whole(row.time_ns.map(|s| s.p99)));
        table.add_row(cells);
    }
    table
}

fn ratios(ratios: &[Ratios]) -> Table {
    let mut table = table(&[
        "class",
        "cold, all",
        "cold, overlapping",
        "cold, apart",
        "warm, all",
        "warm, overlapping",
    ]);
    for ratio in ratios {
        let aim = |place: usize| ratio.targets.map(|targets| targets[place]);
        table.add_row([
            Cell::new(ratio.class.name()),
            factor(ratio.cold, None),
            factor(ratio.cold_overlapping, aim(0)),
            factor(ratio.cold_apart, aim(1)),
            factor(ratio.warm, None),
            factor(ratio.warm_overlapping, aim(2)),
        ]);
    }
    table
}

fn factor(value: Option<f64>, aim: Option<f64>) -> Cell {
    let Some(value) = value else {
        return right(NOTHING.to_owned());
    };
    right(match aim {
        None => format!("{value:.2}"),
        Some(aim) if value >= aim => format!("{value:.2} (met, {aim})"),
        Some(aim) => format!("{value:.2} (missed, {aim})"),
    })
}

fn walks(rows: &[Walks]) -> Table {
    let mut table = table(&[
        "class",
        "method",
        "local minima",
        "off",
        "worst factor",
        "ns walk",
        "Palpable",
        "parry f32",
        "parry f64",
    ]);
    let mut last = None;
    for row in rows {
        let is_new = last.replace(row.class) != Some(row.class);
        let worst = row.worst_factor.map(|factor| format!("{factor:.2}"));
        let mut cells = vec![
            Cell::new(if is_new { row.class.name() } else { "" }),
            Cell::new(row.method.name()),
            right(format!("{}/{}", row.local_minima, row.pairs)),
            right(format!("{}/{}", row.failures, row.pairs)),
            right(worst.unwrap_or_else(|| NOTHING.to_owned())),
        ];
        cells.extend(row.times_ns.map(whole));
        table.add_row(cells);
    }
    for method in [Method::LocalWalk, Method::LocalWalkWarm] {
        table.add_row(walks_of_all_classes(rows, method));
    }
    table
}

fn walks_of_all_classes(rows: &[Walks], method: Method) -> [Cell; 4] {
    let sum = |of: fn(&Walks) -> usize| -> usize {
        let rows = rows.iter().filter(|row| row.method == method);
        rows.map(of).sum()
    };
    let pairs = sum(|row| row.pairs);
    let part = |count: usize| {
        let percent = 100.0 * count as f64 / pairs.max(1) as f64;
        right(format!("{count}/{pairs}, {percent:.1} %"))
    };
    [
        Cell::new("all classes"),
        Cell::new(method.name()),
        part(sum(|row| row.local_minima)),
        part(sum(|row| row.failures)),
    ]
}

fn beyond(rows: &[Beyond]) -> Table {
    let mut table = table(&[
        "class",
        "method",
        "by error",
        "by left",
        "worst index",
        "error",
        "of larger",
        "worst index",
        "left",
    ]);
    for row in rows {
        table.add_row([
            Cell::new(row.class.name()),
            Cell::new(row.method.name()),
            right(row.by_error.to_string()),
            right(row.by_left.to_string()),
            right(row.worst_index.to_string()),
            exponent(Some(row.worst_error)),
            exponent(Some(row.worst_error_of_larger)),
            right(row.worst_left_index.to_string()),
            exponent(Some(row.worst_left)),
        ]);
    }
    table
}

fn unions(rows: &[UnionRow]) -> Table {
    let mut table = table(&[
        "unions",
        "by",
        "still overlap",
        "left max",
        "length/least med",
        "p95",
        "max",
        "us med",
        "p99",
    ]);
    let mut last = None;
    for row in rows {
        let is_new = last.replace(row.class) != Some(row.class);
        let ratio = |of: fn(Spread) -> f64| {
            right(
                row.ratio
                    .map_or_else(|| NOTHING.to_owned(), |s| format!("{:.4}", of(s))),
            )
        };
        let micros = |of: fn(Spread) -> f64| {
            right(
                row.time_ns
                    .map_or_else(|| NOTHING.to_owned(), |s| format!("{:.1}", 1e-3 * of(s))),
            )
        };
        table.add_row([
            Cell::new(if is_new { row.class.name() } else { "" }),
            Cell::new(row.mover.name()),
            right(format!("{}/{}", row.overlapping, row.unions)),
            exponent(row.left.map(|s| s.max)),
            ratio(|s| s.median),
            ratio(|s| s.p95),
            ratio(|s| s.max),
            micros(|s| s.median),
            micros(|s| s.p99),
        ]);
    }
    table
}

/// How many failures are listed one by one.
const LISTED_MAX: usize = 20;

fn failures(accuracy: &Accuracy) -> String {
    let lines: Vec<String> = accuracy
        .kernel_failures()
        .map(|(class, method, score)| {
            format!(
                "  {}, {}, seed {} index {} ({:?}): {:?}, reference {:e} m, error {:?}",
                class.name(),
                method.name(),
                accuracy.seed,
                score.index,
                score.kind,
                score.failure,
                score.reference_m,
                score.error
            )
        })
        .collect();
    let shown = lines.len().min(LISTED_MAX);
    format!(
        "Palpable failures: {}\n{}",
        lines.len(),
        lines[..shown].join("\n")
    )
}
