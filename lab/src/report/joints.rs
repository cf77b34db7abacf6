//! Frame time, solver steps and adjusted joints over frame number, after figures 6 and 7 of Schmidl and
//! Lin 2004.

use plotters::style::text_anchor::HPos;

use super::figure::{Entry, decade_name, draw_legend, log_share, with_header};
use super::format::{count, time_us};
use super::labels::shortened;
use super::palette::{
    ADJUSTED, BANDS, EACH_FRAME, FINE_GRID, FRAME_LINE, GRID, INK, QUIET_INK, Role, STEPS,
    WINDOW_MEDIAN,
};
use super::plan::{FULL_RIGHT, LEFT, NAME_PX, Panel, SMALL_PX, WIDTH};
use super::series::{
    decades_around, round_ticks, running_median, window_over, without_flat_points,
};
use super::sheet::{Drawn, Lettering, Point, Sheet};
use super::{FigureFrame, FigureScene};

const TITLE_PX: f64 = 18.0;
const TITLE_Y: f64 = 26.0;
const TITLE_CHARACTERS_MAX: usize = 90;
const SUMMARY_Y: f64 = 52.0;
const AXIS_TITLE_X: f64 = 16.0;
const FRAME_TICKS_MAX: f64 = 10.0;
const TICKS_MAX: f64 = 5.0;
const TOP: f64 = 104.0;
const GAP: f64 = 44.0;
const TIME_HEIGHT: f64 = 220.0;
const STEPS_HEIGHT: f64 = 130.0;
const ADJUSTED_HEIGHT: f64 = 110.0;
const AXIS_STRIP: f64 = 56.0;

/// A stand-alone SVG document, 1120 pixels wide, light or dark as the reader prefers.
///
/// Three panels over the frame number: the time of each frame on a logarithmic scale with its running
/// median, the steps of the chains' solvers, and the hinges that are not where the tracker wants them.
/// Frames with contact stand on a tinted ground.
///
/// # Panics
/// Never: the backend can only fail to write files, and here it writes into a string.
pub fn joints_svg(scene: &FigureScene) -> String {
    let plot = Plot::new(scene);
    let mut drawing = String::new();
    plot.draw(&mut drawing)
        .expect("a string takes every drawing");
    let name = format!("{}. {}", title(scene), summary(scene));
    with_header(&name, plot.height, &drawing)
}

fn title(scene: &FigureScene) -> String {
    let name = &scene.name;
    let (first, rest) = name.split_at(name.chars().next().map_or(0, char::len_utf8));
    let title = format!("{}{rest}: {}", first.to_uppercase(), scene.figure);
    if name.contains(&scene.method) {
        title
    } else {
        format!("{title}, {}", scene.method)
    }
}

fn summary(scene: &FigureScene) -> String {
    let time = &scene.frame_time_us;
    format!(
        "{} frames: median {}, p99 {}, max {} µs; {} solver steps, at most {} in a frame",
        count(scene.frames.into()),
        time_us(time.median),
        time_us(time.p99),
        time_us(time.max),
        count(scene.steps_total),
        scene.steps_max,
    )
}

struct Plot<'s> {
    scene: &'s FigureScene,
    panels: [Panel; 3],
    frames: f64,
    height: f64,
}

impl<'s> Plot<'s> {
    fn new(scene: &'s FigureScene) -> Self {
        let time = Panel::new(TOP, TIME_HEIGHT);
        let steps = Panel::new(time.bottom + GAP, STEPS_HEIGHT);
        let adjusted = Panel::new(steps.bottom + GAP, ADJUSTED_HEIGHT);
        Self {
            scene,
            panels: [time, steps, adjusted],
            frames: scene.samples.len().max(1) as f64,
            height: adjusted.bottom + AXIS_STRIP,
        }
    }

    fn x(&self, frame: f64) -> f64 {
        LEFT + (FULL_RIGHT - LEFT) * frame / self.frames
    }

    fn draw(&self, svg: &mut String) -> Drawn {
        let sheet = Sheet::new(svg, WIDTH, self.height)?;
        let title = shortened(&title(self.scene), TITLE_CHARACTERS_MAX);
        let bold = Lettering::new(TITLE_PX, INK).bold();
        sheet.text(&title, (LEFT, TITLE_Y), &bold)?;
        let small = Lettering::new(NAME_PX, QUIET_INK);
        sheet.text(&summary(self.scene), (LEFT, SUMMARY_Y), &small)?;
        for panel in self.panels {
            self.draw_ground(&sheet, panel)?;
        }
        self.draw_times(&sheet)?;
        let [_, steps, adjusted] = self.panels;
        self.draw_counts(&sheet, steps, STEPS, |frame| frame.steps)?;
        self.draw_counts(&sheet, adjusted, ADJUSTED, |frame| frame.adjusted)?;
        let names = [
            ("Frame time", "[µs], logarithmic"),
            ("Solver steps", "per frame"),
            ("Joints adjusted", "hinges"),
        ];
        for (panel, (name, axis)) in self.panels.into_iter().zip(names) {
            self.draw_frame(&sheet, panel, name, axis)?;
        }
        self.draw_frame_axis(&sheet)?;
        sheet.finish()
    }

    fn draw_ground(&self, sheet: &Sheet, panel: Panel) -> Drawn {
        let contact = BANDS[1];
        let mut first = 0;
        for group in self.scene.samples.chunk_by(|a, b| touches(a) == touches(b)) {
            let end = first + group.len();
            if touches(&group[0]) {
                let (left, right) = (self.x(first as f64), self.x(end as f64));
                sheet.fill((left, panel.top), (right, panel.bottom), contact)?;
            }
            first = end;
        }
        Ok(())
    }

    fn curve(&self, value: impl Fn(&FigureFrame) -> f64) -> Vec<Point> {
        let samples = self.scene.samples.iter();
        samples.map(|s| (f64::from(s.frame), value(s))).collect()
    }

    fn draw_times(&self, sheet: &Sheet) -> Drawn {
        let panel = self.panels[0];
        let range = decades_around(self.scene.samples.iter().map(|s| s.time_us));
        self.draw_decades(sheet, panel, range)?;
        let times = self.curve(|s| s.time_us);
        let place = |points: &[Point]| -> Vec<Point> {
            let at = |p: &Point| (self.x(p.0 + 0.5), panel.y(log_share(p.1, range)));
            points.iter().map(at).collect()
        };
        sheet.curve(&place(&times), EACH_FRAME, 0.75)?;
        let window = window_over(times.len());
        let name = window.map(|window| format!("median of {window} frames"));
        if let Some(window) = window {
            sheet.curve(&place(&running_median(&times, window)), WINDOW_MEDIAN, 1.75)?;
        }
        let median = name.as_deref().map(|name| Entry::line(name, WINDOW_MEDIAN));
        let mut entries = vec![Entry::ground("contact", BANDS[1])];
        entries.extend(median);
        entries.push(Entry::line("each frame", EACH_FRAME));
        draw_legend(sheet, &entries, panel.top - 16.0)
    }

    fn draw_decades(&self, sheet: &Sheet, panel: Panel, range: (f64, f64)) -> Drawn {
        let (first, last) = (
            range.0.log10().round() as i32,
            range.1.log10().round() as i32,
        );
        for power in first..=last {
            let decade = 10_f64.powi(power);
            let fine = (2..10).map(|factor| f64::from(factor) * decade);
            for value in fine.filter(|value| *value < range.1) {
                grid_line(sheet, panel.y(log_share(value, range)), FINE_GRID)?;
            }
            let y = panel.y(log_share(decade, range));
            grid_line(sheet, y, GRID)?;
            tick_label(sheet, y, &decade_name(decade))?;
        }
        Ok(())
    }

    fn draw_counts(
        &self,
        sheet: &Sheet,
        panel: Panel,
        role: Role,
        value: fn(&FigureFrame) -> u32,
    ) -> Drawn {
        let most = self.scene.samples.iter().map(value).max().unwrap_or(0);
        let top = f64::from(most.max(1)) * 1.08;
        for tick in round_ticks(0.0, top, TICKS_MAX) {
            let y = panel.y(tick / top);
            grid_line(sheet, y, GRID)?;
            tick_label(sheet, y, &count(tick as u64))?;
        }
        let counts = self.curve(|s| f64::from(value(s)));
        let at = |p: &Point| (self.x(p.0 + 0.5), panel.y(p.1 / top));
        let points: Vec<Point> = without_flat_points(&counts).iter().map(at).collect();
        sheet.curve(&points, role, 1.0)
    }

    fn draw_frame(&self, sheet: &Sheet, panel: Panel, name: &str, axis: &str) -> Drawn {
        let (top, bottom) = (panel.top, panel.bottom);
        let corners = [
            (LEFT, top),
            (FULL_RIGHT, top),
            (FULL_RIGHT, bottom),
            (LEFT, bottom),
            (LEFT, top),
        ];
        sheet.curve(&corners, FRAME_LINE, 1.0)?;
        let bold = Lettering::new(NAME_PX, INK).bold();
        sheet.text(name, (LEFT, top - 16.0), &bold)?;
        let upright = Lettering::new(SMALL_PX, QUIET_INK)
            .upright()
            .anchored(HPos::Center);
        sheet.text(axis, (AXIS_TITLE_X, 0.5 * (top + bottom)), &upright)
    }

    fn draw_frame_axis(&self, sheet: &Sheet) -> Drawn {
        let style = Lettering::new(SMALL_PX, QUIET_INK).anchored(HPos::Center);
        let last = self.panels[2];
        for tick in round_ticks(0.0, self.frames, FRAME_TICKS_MAX) {
            let x = self.x(tick);
            for panel in self.panels {
                sheet.line((x, panel.bottom), (x, panel.bottom + 5.0), FRAME_LINE, 1.0)?;
            }
            sheet.text(&count(tick as u64), (x, last.bottom + 15.0), &style)?;
        }
        let middle = 0.5 * (LEFT + FULL_RIGHT);
        sheet.text("frame number", (middle, last.bottom + 36.0), &style)
    }
}

fn touches(frame: &FigureFrame) -> bool {
    frame.contacts > 0
}

fn grid_line(sheet: &Sheet, y: f64, role: Role) -> Drawn {
    sheet.line((LEFT, y), (FULL_RIGHT, y), role, 1.0)
}

fn tick_label(sheet: &Sheet, y: f64, label: &str) -> Drawn {
    let style = Lettering::new(SMALL_PX, QUIET_INK).anchored(HPos::Right);
    sheet.text(label, (LEFT - 8.0, y), &style)
}
