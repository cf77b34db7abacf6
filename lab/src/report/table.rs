//! The report in a terminal: at most 120 columns for run names of up to 28 characters.

use std::iter;

use comfy_table::{Cell, CellAlignment, ContentArrangement, LineStyle, Table, presets};

use super::data::is_beyond;
use super::format::{count, length_mm, mean, optional_length_mm, per_cent, time_us};
use super::{
    BALL_OVERLAP_MM_MAX, HAND_FIXED_OVERLAP_MM_MAX, HandCoverage, Phase, Report, Run, Slaps,
};

/// Phases stand under the name of their run.
pub(super) const INDENT: &str = "  ";

/// The report as text: machine and hand, a table of frame times and work, a table of what must
/// hold, and the state hashes. Both tables have one row per phase under the name of its run; a
/// value beyond its promised limit carries a `!`.
pub fn table(report: &Report) -> String {
    let sections = [
        heading(report),
        format!("Frame time and work\n{}", work_table(&report.runs)),
        format!(
            "Overlap, lag and rest (! beyond the promised limit)\n{}",
            promise_table(&report.runs)
        ),
        state_hashes(&report.runs),
        super::joints_table::tables(&report.figures, report.arm_slaps.as_ref()),
        report
            .slaps
            .as_ref()
            .map(slaps_sentence)
            .unwrap_or_default(),
    ];
    let sections: Vec<String> = sections.into_iter().filter(|s| !s.is_empty()).collect();
    sections.join("\n\n") + "\n"
}

fn heading(report: &Report) -> String {
    let machine = &report.machine;
    let compiler = machine
        .rustc
        .as_deref()
        .map(|rustc| format!(", {rustc}"))
        .unwrap_or_default();
    let hand = hand_sentence(&report.hand);
    format!(
        "{}\n{}, {}{compiler}\n{hand}",
        report.title, machine.cpu, machine.os
    )
}

fn hand_sentence(hand: &HandCoverage) -> String {
    format!(
        "Hand: {} parts leave {} of the mesh uncovered, by {} mm at most,\n      \
         and stick out by {} mm on average, {} mm at most",
        hand.parts,
        per_cent(hand.uncovered_share),
        length_mm(hand.uncovered_mm_max),
        length_mm(hand.sticking_out_mm_mean),
        length_mm(hand.sticking_out_mm_max),
    )
}

fn slaps_sentence(slaps: &Slaps) -> String {
    format!(
        "{} slaps through a wall of 20 mm: {} parts behind it, overlap at most {} mm",
        slaps.slaps,
        slaps.parts_behind,
        length_mm(slaps.overlap_mm_max)
    )
}

fn state_hashes(runs: &[Run]) -> String {
    let lines: Vec<String> = runs
        .iter()
        .map(|run| {
            format!(
                "state hash {}, {} things beyond the walls  {}",
                run.state_hash, run.beyond_walls, run.name
            )
        })
        .collect();
    lines.join("\n")
}

fn work_table(runs: &[Run]) -> String {
    let header = [
        "run and phase",
        "frames",
        "median\nµs",
        "p99\nµs",
        "p99.9\nµs",
        "max\nµs",
        "contacts\nmean / max",
        "impulses\ntotal",
        "units\ntotal",
        "units\nmax",
    ];
    phase_table(&header, runs, work_cells)
}

fn work_cells(phase: &Phase) -> Vec<String> {
    let time = &phase.frame_time_us;
    vec![
        phase.frames.to_string(),
        time_us(time.median),
        time_us(time.p99),
        time_us(time.p999),
        time_us(time.max),
        format!("{} / {}", mean(phase.contacts_mean), phase.contacts_max),
        count(phase.impulses_total),
        count(phase.units_total),
        count(phase.units_max),
    ]
}

fn promise_table(runs: &[Run]) -> String {
    let hand_fixed = format!("hand in fixed\nmax mm (≤ {HAND_FIXED_OVERLAP_MM_MAX})");
    let ball_fixed = format!("ball in fixed\nmax mm (≤ {BALL_OVERLAP_MM_MAX})");
    let hand_ball = format!("hand in ball\nmax mm (≤ {BALL_OVERLAP_MM_MAX})");
    let header = [
        "run and phase",
        &hand_fixed,
        &ball_fixed,
        &hand_ball,
        "free lag\nmax mm (= 0)",
        "jitter at rest\nmax mm",
    ];
    phase_table(&header, runs, promise_cells)
}

fn promise_cells(phase: &Phase) -> Vec<String> {
    let lag_is_broken = phase.free_lag_mm_max.is_some_and(|lag| is_beyond(lag, 0.0));
    vec![
        marked(phase.overlap_hand_fixed_mm_max, HAND_FIXED_OVERLAP_MM_MAX),
        marked(phase.overlap_ball_fixed_mm_max, BALL_OVERLAP_MM_MAX),
        marked(phase.overlap_hand_ball_mm_max, BALL_OVERLAP_MM_MAX),
        mark(optional_length_mm(phase.free_lag_mm_max), lag_is_broken),
        optional_length_mm(phase.jitter_mm_max),
    ]
}

pub(super) fn marked(value_mm: f64, limit_mm: f64) -> String {
    mark(length_mm(value_mm), is_beyond(value_mm, limit_mm))
}

pub(super) fn mark(text: String, is_broken: bool) -> String {
    if is_broken { format!("!{text}") } else { text }
}

fn phase_table(header: &[&str], runs: &[Run], cells: fn(&Phase) -> Vec<String>) -> String {
    let mut table = table_with(header);
    for run in runs {
        add_run(&mut table, run, cells);
    }
    table.trim_fmt()
}

/// An empty table.
pub(super) fn table_with(header: &[&str]) -> Table {
    let mut table = Table::new();
    table
        .load_style(presets::UTF8_HORIZONTAL_ONLY.row_separator(LineStyle::none()))
        .set_content_arrangement(ContentArrangement::Disabled);
    table.set_header(
        header
            .iter()
            .enumerate()
            .map(|(column, text)| aligned(column, text)),
    );
    table
}

fn add_run(table: &mut Table, run: &Run, cells: fn(&Phase) -> Vec<String>) {
    table.add_row([&run.name]);
    for phase in &run.phases {
        let row = iter::once(format!("{INDENT}{}", phase.name)).chain(cells(phase));
        table.add_row(row.enumerate().map(|(column, text)| aligned(column, &text)));
    }
}

pub(super) fn aligned(column: usize, text: &str) -> Cell {
    let alignment = if column == 0 {
        CellAlignment::Left
    } else {
        CellAlignment::Right
    };
    Cell::new(text).set_alignment(alignment)
}
