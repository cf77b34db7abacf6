//! Frame time over frame number, after figure 6 of Schmidl and Lin 2004, with the work of each
//! frame under it.

use plotters::style::text_anchor::HPos;

use super::format::{count, time_us};
use super::labels::{LEADER_GAP_PX, Layout, shortened, text_width};
use super::palette::{
    BANDS, CONTACTS, EACH_FRAME, FINE_GRID, FRAME_LINE, GRID, IMPULSES, INK, QUIET_INK, Role,
    SLOWEST, WINDOW_MEDIAN, style_sheet,
};
use super::plan::{FULL_RIGHT, LEFT, NAME_PX, Panel, Plan, SMALL_PX, WIDTH, label_lines};
use super::series::{
    curve, round_ticks, running_median, slowest, time_range_us, window_frames, without_flat_points,
};
use super::sheet::{Drawn, Lettering, Point, SUBPIXELS, Sheet};
use super::{FrameSample, Quantiles, Run};

const TITLE_PX: f64 = 18.0;
const TITLE_Y: f64 = 26.0;
const TITLE_CHARACTERS_MAX: usize = 80;
const SUMMARY_Y: f64 = 52.0;
const AXIS_TITLE_X: f64 = 16.0;
const FRAME_TICKS_MAX: f64 = 10.0;
const WORK_TICKS_MAX: f64 = 4.0;

/// A stand-alone SVG document, 1120 pixels wide, light or dark as the reader prefers.
///
/// The upper panel shows the time of each frame on a logarithmic scale and its running median, the
/// lower one contacts and impulses. Phases are bands with labels above the panels. Frame times of
/// zero or less are drawn at the bottom.
///
/// # Panics
/// Never: the backend can only fail to write files, and here it writes into a string.
pub fn frame_time_svg(run: &Run) -> String {
    let plan = Plan::new(run);
    let mut drawing = String::new();
    draw(run, &plan, &mut drawing).expect("a string takes every drawing");
    with_own_header(run, plan.height, &drawing)
}

fn draw(run: &Run, plan: &Plan, svg: &mut String) -> Drawn {
    let sheet = Sheet::new(svg, WIDTH, plan.height)?;
    draw_heading(&sheet, run)?;
    draw_labels(&sheet, run, plan)?;
    draw_time_panel(&sheet, run, plan)?;
    draw_work_panel(&sheet, run, plan)?;
    draw_frame_axis(&sheet, plan)?;
    sheet.finish()
}

/// Replaces the backend's root element by one that scales subpixels to pixels, names the figure and
/// brings the style.
fn with_own_header(run: &Run, height: f64, drawing: &str) -> String {
    let name = format!("Frame time: {}. {}", run.name, summary(run));
    with_header(&name, height, drawing)
}

/// The same for a figure of any name.
pub(super) fn with_header(name: &str, height: f64, drawing: &str) -> String {
    let body = drawing.split_once('>').map_or("", |(_, body)| body);
    let (inner_width, inner_height) = (WIDTH * SUBPIXELS, height * SUBPIXELS);
    let name = escaped(name);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{height}\" \
         viewBox=\"0 0 {inner_width} {inner_height}\" role=\"img\" aria-label=\"{name}\">\n\
         <style>{}</style>{body}",
        style_sheet()
    )
}

/// Text with the characters replaced that mean something in XML.
pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

fn draw_heading(sheet: &Sheet, run: &Run) -> Drawn {
    let title = shortened(&format!("Frame time: {}", run.name), TITLE_CHARACTERS_MAX);
    sheet.text(
        &title,
        (LEFT, TITLE_Y),
        &Lettering::new(TITLE_PX, INK).bold(),
    )?;
    sheet.text(
        &summary(run),
        (LEFT, SUMMARY_Y),
        &Lettering::new(NAME_PX, QUIET_INK),
    )?;
    let running = window_frames(run).map(|window| format!("median of {window} frames"));
    let median = running
        .as_deref()
        .map(|name| Entry::line(name, WINDOW_MEDIAN));
    let mut entries = vec![Entry::ring("slowest", SLOWEST)];
    entries.extend(median);
    entries.push(Entry::line("each frame", EACH_FRAME));
    draw_legend(sheet, &entries, SUMMARY_Y)
}

fn summary(run: &Run) -> String {
    let mut times: Vec<f64> = run.samples.iter().map(|sample| sample.time_us).collect();
    let Some((all, slowest)) = Quantiles::from_samples(&mut times).zip(slowest(run)) else {
        return "no frames".to_owned();
    };
    format!(
        "{} frames: median {}, p99 {}, p99.9 {}, max {} µs (frame {})",
        count(run.samples.len() as u64),
        time_us(all.median),
        time_us(all.p99),
        time_us(all.p999),
        time_us(all.max),
        slowest.frame
    )
}

pub(super) struct Entry<'a> {
    name: &'a str,
    role: Role,
    swatch: Swatch,
}

#[derive(PartialEq)]
enum Swatch {
    Line,
    Ring,
    Ground,
}

impl<'a> Entry<'a> {
    pub(super) fn line(name: &'a str, role: Role) -> Self {
        Self {
            name,
            role,
            swatch: Swatch::Line,
        }
    }

    fn ring(name: &'a str, role: Role) -> Self {
        Self {
            name,
            role,
            swatch: Swatch::Ring,
        }
    }

    /// A colour behind the curves.
    pub(super) fn ground(name: &'a str, role: Role) -> Self {
        Self {
            name,
            role,
            swatch: Swatch::Ground,
        }
    }
}

/// Entries from right to left, ending at the right margin.
pub(super) fn draw_legend(sheet: &Sheet, entries: &[Entry], y: f64) -> Drawn {
    const SWATCH: f64 = 18.0;
    const GAP: f64 = 6.0;
    const ENTRY_GAP: f64 = 14.0;
    let mut right = FULL_RIGHT;
    for entry in entries {
        let text_left = right - text_width(entry.name, SMALL_PX, false);
        let swatch_right = text_left - GAP;
        let is_ring = entry.swatch == Swatch::Ring;
        let swatch_left = swatch_right - if is_ring { 2.0 * RING_PX } else { SWATCH };
        match entry.swatch {
            Swatch::Ring => sheet.ring((swatch_right - RING_PX, y), RING_PX, entry.role)?,
            Swatch::Line => sheet.line((swatch_left, y), (swatch_right, y), entry.role, 2.5)?,
            Swatch::Ground => draw_ground(sheet, swatch_left, swatch_right, y, entry.role)?,
        }
        sheet.text(
            entry.name,
            (text_left, y),
            &Lettering::new(SMALL_PX, QUIET_INK),
        )?;
        right = swatch_left - ENTRY_GAP;
    }
    Ok(())
}

const RING_PX: f64 = 4.5;

/// A small outlined field of a ground's colour.
fn draw_ground(sheet: &Sheet, left: f64, right: f64, y: f64, role: Role) -> Drawn {
    let (top, bottom) = (y - 6.0, y + 6.0);
    sheet.fill((left, top), (right, bottom), role)?;
    let corners = [
        (left, top),
        (right, top),
        (right, bottom),
        (left, bottom),
        (left, top),
    ];
    sheet.curve(&corners, FRAME_LINE, 1.0)
}

fn draw_labels(sheet: &Sheet, run: &Run, plan: &Plan) -> Drawn {
    for (index, wish) in plan.wishes.iter().enumerate() {
        let centre = 0.5 * (wish.band_left + wish.band_right);
        match &plan.layout {
            Layout::Centred => {
                draw_label(sheet, run, index, (centre, plan.label_y(0)), HPos::Center)?
            }
            Layout::Flags(rows) => {
                let y = plan.label_y(rows[index]);
                sheet.line(
                    (centre, y - LINE_PX),
                    (centre, plan.time.top),
                    FRAME_LINE,
                    1.0,
                )?;
                draw_label(sheet, run, index, (centre + LEADER_GAP_PX, y), HPos::Left)?;
            }
        }
    }
    Ok(())
}

/// Distance of a label's lines, in pixels.
const LINE_PX: f64 = 16.0;

fn draw_label(sheet: &Sheet, run: &Run, index: usize, (x, y): Point, anchor: HPos) -> Drawn {
    let [name, figures] = label_lines(run, index);
    let bold = Lettering::new(NAME_PX, INK).bold().anchored(anchor);
    sheet.text(&name, (x, y - 0.5 * LINE_PX), &bold)?;
    sheet.text(
        &figures,
        (x, y + 0.5 * LINE_PX),
        &Lettering::new(SMALL_PX, QUIET_INK).anchored(anchor),
    )
}

fn draw_time_panel(sheet: &Sheet, run: &Run, plan: &Plan) -> Drawn {
    let range_us = time_range_us(run);
    let to_sheet = &|point: &Point| {
        (
            plan.x(point.0 + 0.5),
            plan.time.y(log_share(point.1, range_us)),
        )
    };
    draw_bands(sheet, plan, plan.time)?;
    draw_decades(sheet, plan, range_us)?;
    let times = curve(run, |sample| sample.time_us);
    match window_frames(run) {
        None => draw_curve(sheet, &times, to_sheet, EACH_FRAME, 1.5)?,
        Some(window) => {
            draw_curve(sheet, &times, to_sheet, EACH_FRAME, 0.75)?;
            draw_curve(
                sheet,
                &running_median(&times, window),
                to_sheet,
                WINDOW_MEDIAN,
                1.75,
            )?;
        }
    }
    if let Some(sample) = slowest(run) {
        sheet.ring(
            to_sheet(&(f64::from(sample.frame), sample.time_us)),
            RING_PX,
            SLOWEST,
        )?;
    }
    draw_frame(sheet, plan, plan.time)?;
    draw_axis_title(sheet, plan.time, "frame time [µs], logarithmic")
}

/// Share of the logarithmic axis; 0 for values that have no logarithm.
pub(super) fn log_share(value: f64, (least, most): (f64, f64)) -> f64 {
    if value > least {
        (value / least).log10() / (most / least).log10()
    } else {
        0.0
    }
}

fn draw_decades(sheet: &Sheet, plan: &Plan, range_us: (f64, f64)) -> Drawn {
    let (first, last) = (
        range_us.0.log10().round() as i32,
        range_us.1.log10().round() as i32,
    );
    for power in first..=last {
        let decade = 10f64.powi(power);
        for multiple in (2..10)
            .map(|factor| f64::from(factor) * decade)
            .filter(|value| *value < range_us.1)
        {
            draw_grid_line(
                sheet,
                plan,
                plan.time.y(log_share(multiple, range_us)),
                FINE_GRID,
            )?;
        }
        let y = plan.time.y(log_share(decade, range_us));
        draw_grid_line(sheet, plan, y, GRID)?;
        draw_tick_label(sheet, y, &decade_name(decade))?;
    }
    Ok(())
}

pub(super) fn decade_name(decade: f64) -> String {
    if decade < 1e5 {
        decade.to_string()
    } else {
        format!("{decade:e}")
    }
}

fn draw_work_panel(sheet: &Sheet, run: &Run, plan: &Plan) -> Drawn {
    let work = |sample: &FrameSample| sample.contacts.max(sample.impulses);
    let top = f64::from(run.samples.iter().map(work).max().unwrap_or(0).max(1)) * 1.08;
    let to_sheet = &|point: &Point| (plan.x(point.0 + 0.5), plan.work.y(point.1 / top));
    draw_bands(sheet, plan, plan.work)?;
    for tick in round_ticks(0.0, top, WORK_TICKS_MAX) {
        let y = plan.work.y(tick / top);
        draw_grid_line(sheet, plan, y, GRID)?;
        draw_tick_label(sheet, y, &count(tick as u64))?;
    }
    let impulses = curve(run, |sample| f64::from(sample.impulses));
    let contacts = curve(run, |sample| f64::from(sample.contacts));
    draw_curve(
        sheet,
        &without_flat_points(&impulses),
        to_sheet,
        IMPULSES,
        1.0,
    )?;
    draw_curve(
        sheet,
        &without_flat_points(&contacts),
        to_sheet,
        CONTACTS,
        1.0,
    )?;
    draw_frame(sheet, plan, plan.work)?;
    draw_axis_title(sheet, plan.work, "per frame")?;
    let y = plan.work.top - 16.0;
    sheet.text(
        "Contacts and impulses",
        (LEFT, y),
        &Lettering::new(NAME_PX, INK).bold(),
    )?;
    draw_legend(
        sheet,
        &[
            Entry::line("impulses", IMPULSES),
            Entry::line("contacts", CONTACTS),
        ],
        y,
    )
}

fn draw_frame_axis(sheet: &Sheet, plan: &Plan) -> Drawn {
    let style = Lettering::new(SMALL_PX, QUIET_INK).anchored(HPos::Center);
    for tick in round_ticks(plan.frames.0, plan.frames.1, FRAME_TICKS_MAX) {
        let x = plan.x(tick);
        for panel in [plan.time, plan.work] {
            sheet.line((x, panel.bottom), (x, panel.bottom + 5.0), FRAME_LINE, 1.0)?;
        }
        sheet.text(&count(tick as u64), (x, plan.work.bottom + 15.0), &style)?;
    }
    let middle = 0.5 * (LEFT + plan.right);
    sheet.text("frame number", (middle, plan.work.bottom + 36.0), &style)
}

fn draw_bands(sheet: &Sheet, plan: &Plan, panel: Panel) -> Drawn {
    for (wish, role) in plan.wishes.iter().zip(BANDS.into_iter().cycle()) {
        sheet.fill(
            (wish.band_left, panel.top),
            (wish.band_right, panel.bottom),
            role,
        )?;
    }
    Ok(())
}

/// The panel's outline and the borders between phases.
fn draw_frame(sheet: &Sheet, plan: &Plan, panel: Panel) -> Drawn {
    let (top_left, top_right) = ((LEFT, panel.top), (plan.right, panel.top));
    let (bottom_left, bottom_right) = ((LEFT, panel.bottom), (plan.right, panel.bottom));
    sheet.curve(
        &[top_left, top_right, bottom_right, bottom_left, top_left],
        FRAME_LINE,
        1.0,
    )?;
    for x in plan.wishes.iter().skip(1).map(|wish| wish.band_left) {
        sheet.line((x, panel.top), (x, panel.bottom), FRAME_LINE, 0.5)?;
    }
    Ok(())
}

fn draw_curve(
    sheet: &Sheet,
    curve: &[Point],
    to_sheet: impl Fn(&Point) -> Point,
    role: Role,
    thickness: f64,
) -> Drawn {
    let points: Vec<Point> = curve.iter().map(to_sheet).collect();
    sheet.curve(&points, role, thickness)
}

fn draw_grid_line(sheet: &Sheet, plan: &Plan, y: f64, role: Role) -> Drawn {
    sheet.line((LEFT, y), (plan.right, y), role, 1.0)
}

fn draw_tick_label(sheet: &Sheet, y: f64, label: &str) -> Drawn {
    sheet.text(
        label,
        (LEFT - 8.0, y),
        &Lettering::new(SMALL_PX, QUIET_INK).anchored(HPos::Right),
    )
}

fn draw_axis_title(sheet: &Sheet, panel: Panel, title: &str) -> Drawn {
    let style = Lettering::new(SMALL_PX, QUIET_INK)
        .upright()
        .anchored(HPos::Center);
    sheet.text(
        title,
        (AXIS_TITLE_X, 0.5 * (panel.top + panel.bottom)),
        &style,
    )
}
