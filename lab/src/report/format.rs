//! Numbers as people read them, the same in the table, the figures and the page.

/// Keeps the groups of a long number together in a page and in a terminal.
const GROUP_SEPARATOR: char = '\u{a0}';

/// What stands where there is nothing to measure.
pub(super) const NOTHING: &str = "–";

/// Microseconds with three significant digits and no unit.
pub(super) fn time_us(value: f64) -> String {
    match value.abs() {
        size if size < 9.995 => format!("{value:.2}"),
        size if size < 99.95 => format!("{value:.1}"),
        size if size < 9999.5 => format!("{value:.0}"),
        _ => count(value.round() as u64),
    }
}

/// Millimetres to the micrometre; a bare `0` is exactly zero and `<0.001` is not.
pub(super) fn length_mm(value: f64) -> String {
    match value {
        0.0 => "0".to_owned(),
        _ if value.abs() < 0.0005 => if value > 0.0 { "<0.001" } else { ">-0.001" }.to_owned(),
        _ => format!("{value:.3}"),
    }
}

/// [`length_mm`], or a dash.
pub(super) fn optional_length_mm(value: Option<f64>) -> String {
    value.map_or_else(|| NOTHING.to_owned(), length_mm)
}

/// A whole number in groups of three digits.
pub(super) fn count(value: u64) -> String {
    let digits = value.to_string();
    let mut grouped = String::with_capacity(digits.len() * 4 / 3);
    for (position, digit) in digits.chars().enumerate() {
        if position > 0 && (digits.len() - position).is_multiple_of(3) && digits.len() > 4 {
            grouped.push(GROUP_SEPARATOR);
        }
        grouped.push(digit);
    }
    grouped
}

/// A mean number of things per frame.
pub(super) fn mean(value: f64) -> String {
    format!("{value:.1}")
}

/// A share of one as per cent with two decimals.
pub(super) fn per_cent(share: f64) -> String {
    format!("{:.2} %", share * 100.0)
}
