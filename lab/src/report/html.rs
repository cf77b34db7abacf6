//! `index.html`: one page that needs no other file and no network.

use super::data::is_beyond;
use super::figure::{escaped, frame_time_svg};
use super::format::{NOTHING, count, length_mm, mean, optional_length_mm, per_cent, time_us};
use super::{
    BALL_OVERLAP_MM_MAX, HAND_FIXED_OVERLAP_MM_MAX, Phase, Report, Run, Slaps, figure_file_name,
};

const TEMPLATE: &str = include_str!("../../assets/report/index.html");

/// The report as a page: worst values, tables with one row per run and phase, figures, hand
/// coverage, and the command that makes it again. Well-formed XML too, so that tools can read the
/// tables.
pub fn index_html(report: &Report) -> String {
    let machine = &report.machine;
    let compiler = machine
        .rustc
        .as_deref()
        .map(|rustc| format!(" · {rustc}"))
        .unwrap_or_default();
    let fields = [
        ("title", escaped(&report.title)),
        (
            "machine",
            escaped(&format!("{} · {}{compiler}", machine.cpu, machine.os)),
        ),
        ("worst", worst(&report.runs)),
        ("work_rows", rows(&report.runs, work_cells)),
        ("promise_rows", rows(&report.runs, promise_cells)),
        ("figures", figures(report)),
        ("hand_rows", hand_rows(report)),
        (
            "slaps",
            report
                .slaps
                .as_ref()
                .map(slaps_sentence)
                .unwrap_or_default(),
        ),
        ("joints", super::joints_html::section(report)),
        ("hash_rows", hash_rows(report)),
        ("hand_fixed_limit", HAND_FIXED_OVERLAP_MM_MAX.to_string()),
        ("ball_limit", BALL_OVERLAP_MM_MAX.to_string()),
    ];
    filled(TEMPLATE, &fields)
}

/// Replaces each `{{name}}` of the template once, so that a value that holds braces stays as it is.
fn filled(template: &str, fields: &[(&str, String)]) -> String {
    let mut pieces = template.split("{{");
    let mut page = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        let (name, rest) = piece.split_once("}}").unwrap_or((piece, ""));
        let value = fields
            .iter()
            .find(|(field, _)| *field == name)
            .map(|(_, value)| value.as_str());
        page.push_str(value.unwrap_or_default());
        page.push_str(rest);
    }
    page
}

pub(super) struct Cell {
    text: String,
    is_broken: bool,
}

impl Cell {
    pub(super) fn plain(text: String) -> Self {
        Self {
            text,
            is_broken: false,
        }
    }

    pub(super) fn limited(value_mm: f64, limit_mm: f64) -> Self {
        Self {
            text: length_mm(value_mm),
            is_broken: is_beyond(value_mm, limit_mm),
        }
    }

    /// Text that says itself whether its limit is kept.
    pub(super) fn judged(text: String, is_broken: bool) -> Self {
        Self { text, is_broken }
    }

    fn optional(value_mm: Option<f64>, limit_mm: f64) -> Self {
        Self {
            text: optional_length_mm(value_mm),
            is_broken: value_mm.is_some_and(|value| is_beyond(value, limit_mm)),
        }
    }

    pub(super) fn html(&self) -> String {
        let Self { text, is_broken } = self;
        let text = escaped(text);
        if *is_broken {
            format!("<td class=\"broken\">{text} <b>over</b></td>")
        } else {
            format!("<td>{text}</td>")
        }
    }
}

fn work_cells(phase: &Phase) -> Vec<Cell> {
    let time = &phase.frame_time_us;
    let texts = [
        count(phase.frames.into()),
        time_us(time.median),
        time_us(time.p99),
        time_us(time.p999),
        time_us(time.max),
        phase.contacts_max.to_string(),
        mean(phase.contacts_mean),
        count(phase.impulses_total),
        count(phase.units_total),
        count(phase.units_max),
    ];
    texts.into_iter().map(Cell::plain).collect()
}

fn promise_cells(phase: &Phase) -> Vec<Cell> {
    vec![
        Cell::limited(phase.overlap_hand_fixed_mm_max, HAND_FIXED_OVERLAP_MM_MAX),
        Cell::limited(phase.overlap_ball_fixed_mm_max, BALL_OVERLAP_MM_MAX),
        Cell::limited(phase.overlap_hand_ball_mm_max, BALL_OVERLAP_MM_MAX),
        Cell::optional(phase.free_lag_mm_max, 0.0),
        Cell::plain(optional_length_mm(phase.jitter_mm_max)),
    ]
}

/// One `tbody` per run, whose name spans its rows.
fn rows(runs: &[Run], cells: fn(&Phase) -> Vec<Cell>) -> String {
    runs.iter().map(|run| run_rows(run, cells)).collect()
}

fn run_rows(run: &Run, cells: fn(&Phase) -> Vec<Cell>) -> String {
    let mut html = "<tbody>\n".to_owned();
    for (index, phase) in run.phases.iter().enumerate() {
        let cells: String = cells(phase).iter().map(Cell::html).collect();
        let run_name = if index == 0 {
            spanning_name(run)
        } else {
            String::new()
        };
        html += &format!(
            "<tr>{run_name}<th scope=\"row\">{}</th>{cells}</tr>\n",
            escaped(&phase.name)
        );
    }
    html + "</tbody>\n"
}

fn spanning_name(run: &Run) -> String {
    format!(
        "<th scope=\"rowgroup\" rowspan=\"{}\">{}</th>",
        run.phases.len(),
        escaped(&run.name)
    )
}

fn figures(report: &Report) -> String {
    report
        .runs
        .iter()
        .zip(report.slugs())
        .map(|(run, slug)| figure(run, &slug))
        .collect()
}

fn figure(run: &Run, slug: &str) -> String {
    let file = figure_file_name(slug);
    let name = escaped(&run.name);
    format!(
        "<figure id=\"{slug}\">\n<div class=\"wide\">{}</div>\n<figcaption>{name}: \
         <a href=\"{file}\">{file}</a></figcaption>\n</figure>\n",
        frame_time_svg(run)
    )
}

fn hand_rows(report: &Report) -> String {
    let hand = &report.hand;
    let row = |name: &str, value: String| {
        format!("<tr><th scope=\"row\">{name}</th><td>{value}</td></tr>\n")
    };
    [
        row("Convex parts", hand.parts.to_string()),
        row(
            "Mesh surface outside every part",
            per_cent(hand.uncovered_share),
        ),
        row(
            "Farthest uncovered point",
            format!("{} mm", escaped(&length_mm(hand.uncovered_mm_max))),
        ),
        row(
            "Parts stick out, mean",
            format!("{} mm", escaped(&length_mm(hand.sticking_out_mm_mean))),
        ),
        row(
            "Parts stick out, max",
            format!("{} mm", escaped(&length_mm(hand.sticking_out_mm_max))),
        ),
    ]
    .concat()
}

fn hash_rows(report: &Report) -> String {
    let row = |run: &Run| {
        let (name, hash) = (escaped(&run.name), escaped(&run.state_hash));
        format!(
            "<tr><th scope=\"row\">{name}</th><td>{}</td><td>{}</td><td><code>{hash}</code></td></tr>\n",
            run.frames, run.beyond_walls
        )
    };
    report.runs.iter().map(row).collect()
}

fn slaps_sentence(slaps: &Slaps) -> String {
    format!(
        "<p>{} slaps through a wall of 20 mm at 5, 10 and 20 m/s, fingers or palm first: {} parts \
         ended behind it, overlap at most {} mm.</p>",
        slaps.slaps,
        slaps.parts_behind,
        length_mm(slaps.overlap_mm_max)
    )
}

/// The few numbers to look at first, as entries of a description list.
fn worst(runs: &[Run]) -> String {
    let of_all = |value: fn(&Phase) -> f64| {
        runs.iter()
            .flat_map(|run| &run.phases)
            .map(value)
            .reduce(worse)
    };
    let length = |name, value: Option<f64>, limit_mm| {
        let is_broken = value.is_some_and(|value| is_beyond(value, limit_mm));
        let class = if is_broken { "broken" } else { "kept" };
        tile(name, class, &optional_length_mm(value), "mm")
    };
    let time = |name, value: Option<f64>| {
        tile(
            name,
            "plain",
            &value.map_or_else(|| NOTHING.to_owned(), time_us),
            "µs",
        )
    };
    [
        time("Slowest frame", of_all(|phase| phase.frame_time_us.max)),
        time("Slowest median", of_all(|phase| phase.frame_time_us.median)),
        length(
            "Hand in fixed",
            of_all(|phase| phase.overlap_hand_fixed_mm_max),
            HAND_FIXED_OVERLAP_MM_MAX,
        ),
        length(
            "Ball in anything",
            of_all(ball_overlap_mm),
            BALL_OVERLAP_MM_MAX,
        ),
        length("Free lag", free_lag_mm(runs), 0.0),
    ]
    .concat()
}

fn tile(name: &str, class: &str, value: &str, unit: &str) -> String {
    let value = escaped(value);
    format!("<div class=\"{class}\"><dt>{name}</dt><dd>{value} <small>{unit}</small></dd></div>\n")
}

/// The larger value, or NaN if either is.
fn worse(a: f64, b: f64) -> f64 {
    if is_beyond(b, a) { b } else { a }
}

fn ball_overlap_mm(phase: &Phase) -> f64 {
    phase
        .overlap_ball_fixed_mm_max
        .max(phase.overlap_hand_ball_mm_max)
}

fn free_lag_mm(runs: &[Run]) -> Option<f64> {
    runs.iter()
        .flat_map(|run| &run.phases)
        .filter_map(|phase| phase.free_lag_mm_max)
        .reduce(worse)
}
