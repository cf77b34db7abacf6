//! The results in a terminal.

use comfy_table::{Cell, CellAlignment, ContentArrangement, LineStyle, Table, presets};

use super::ImpulseAccuracy;
use super::engine::Subject;
use super::orders;
use super::row::{Case, Judged, Quantity, Row};

/// What stands where there is nothing to measure.
const NOTHING: &str = "–";

/// One table a case: what was found by whom, how far it is off, and what it took.
pub fn tables(found: &ImpulseAccuracy) -> String {
    let mut parts = vec![
        "✓ and ✗: within what must hold or not; µs: median frame; ms: all frames, CPU time of the thread"
            .to_owned(),
    ];
    for case in Case::ALL {
        let rows: Vec<&Row> = found
            .rows
            .iter()
            .filter(|row| row.quantity.case == case)
            .collect();
        if !rows.is_empty() {
            parts.push(format!("{}\n{}", case.name(), of_case(&rows)));
        }
    }
    if !found.orders.is_empty() {
        let told =
            "orders: fastest approach left, in mm/s, after so many impulses; ✓: none that counts";
        parts.push(format!("{told}\n{}", orders::table(&found.orders)));
    }
    parts.join("\n\n")
}

/// The kernel's results that are not within what must hold, a line each.
pub fn failures(found: &ImpulseAccuracy) -> String {
    let kernel = found.rows.iter().filter(|r| r.subject == Subject::Palpable);
    let failed: Vec<String> = kernel
        .filter(|r| r.passes == Some(false))
        .map(told)
        .collect();
    if failed.is_empty() {
        return "the kernel holds everything that must hold".to_owned();
    }
    format!("the kernel does not hold:\n{}", failed.join("\n"))
}

fn told(row: &Row) -> String {
    let bound = row.quantity.bound.unwrap_or(0.0);
    format!(
        "  {}: {} at {} Hz: off by {}, must be within {}",
        row.quantity.case.name(),
        row.quantity.name,
        row.rate_hz,
        amount(row.error.unwrap_or(f64::NAN)),
        amount(bound)
    )
}

fn right(text: String) -> Cell {
    Cell::new(text).set_alignment(CellAlignment::Right)
}

/// Few digits where few tell something, powers of ten where many zeros would stand.
fn amount(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e5).contains(&size) {
        let digits = (5 - size.log10().floor() as i32).clamp(0, 6) as usize;
        format!("{value:.digits$}")
    } else {
        format!("{value:.2e}")
    }
}

fn of_case(rows: &[&Row]) -> Table {
    let mut table = Table::new();
    let mut header = vec!["quantity", "exact", "within", "Hz"];
    for subject in Subject::ALL {
        header.extend([subject.name(), "off", "", "µs", "ms"]);
    }
    table
        .load_style(presets::UTF8_HORIZONTAL_ONLY.row_separator(LineStyle::none()))
        .set_content_arrangement(ContentArrangement::Disabled)
        .set_header(header);
    let mut last = None;
    for (quantity, rate_hz) in lines(rows) {
        let is_new = last.replace(&quantity.name) != Some(&quantity.name);
        let mut cells = first(quantity, is_new);
        cells.push(right(rate_hz.to_string()));
        for subject in Subject::ALL {
            let row = rows.iter().find(|row| {
                row.quantity.name == quantity.name
                    && row.rate_hz == rate_hz
                    && row.subject == subject
            });
            cells.extend(row.map_or_else(
                || (0..5).map(|_| right(NOTHING.into())).collect(),
                |r| result(r),
            ));
        }
        table.add_row(cells);
    }
    table
}

/// Every quantity at every rate, in the order in which they were first measured, rates together.
fn lines<'a>(rows: &[&'a Row]) -> Vec<(&'a Quantity, f64)> {
    let mut names: Vec<&str> = vec![];
    let mut lines: Vec<(&Quantity, f64)> = vec![];
    for row in rows {
        if !names.contains(&row.quantity.name.as_str()) {
            names.push(&row.quantity.name);
        }
        let is_known =
            |line: &(&Quantity, f64)| line.0.name == row.quantity.name && line.1 == row.rate_hz;
        if !lines.iter().any(is_known) {
            lines.push((&row.quantity, row.rate_hz));
        }
    }
    let place = |name: &str| names.iter().position(|known| *known == name);
    lines.sort_by(|a, b| {
        place(&a.0.name)
            .cmp(&place(&b.0.name))
            .then(a.1.total_cmp(&b.1))
    });
    lines
}

fn first(quantity: &Quantity, is_new: bool) -> Vec<Cell> {
    if !is_new {
        return vec![Cell::new(""), Cell::new(""), Cell::new("")];
    }
    let name = if quantity.unit.is_empty() {
        quantity.name.clone()
    } else {
        format!("{} [{}]", quantity.name, quantity.unit)
    };
    let exact = match quantity.judged {
        Judged::Reported => NOTHING.to_owned(),
        _ => amount(quantity.exact),
    };
    let bound = quantity
        .bound
        .map_or(NOTHING.to_owned(), |bound| error(quantity, bound));
    vec![Cell::new(name), right(exact), right(bound)]
}

fn error(quantity: &Quantity, error: f64) -> String {
    match quantity.judged {
        Judged::Relative => format!("{} %", amount(100.0 * error)),
        _ => amount(error),
    }
}

fn result(row: &Row) -> Vec<Cell> {
    let off = row
        .error
        .map_or(NOTHING.to_owned(), |off| error(&row.quantity, off));
    let passes = row
        .passes
        .map_or("", |passes| if passes { "✓" } else { "✗" });
    let frame = row
        .frame_us
        .map_or(NOTHING.to_owned(), |us| format!("{us:.1}"));
    vec![
        right(amount(row.value)),
        right(off),
        Cell::new(passes),
        right(frame),
        right(format!("{:.0}", row.total_ms)),
    ]
}
