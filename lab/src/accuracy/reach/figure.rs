//! Share solved against iterations and against time: one small panel per chain and class.

use std::io;

use plotters::backend::SVGBackend;
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind, IntoDrawingArea};
use plotters::element::{Circle, PathElement};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontDesc, FontFamily, FontStyle, FontTransform, RGBColor, TextStyle};

use super::ReachAccuracy;
use super::cases::Class;
use super::chains::Model;
use super::measure::{Method, STEPS};

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = Result<(), DrawingAreaErrorKind<io::Error>>;
type Spot = (f64, f64);

/// Pixels of the drawing are this many coordinates of the backend, which has whole ones.
const SUBPIXELS: f64 = 4.0;
/// The backend divides font sizes by this.
const BACKEND_FONT_RATIO: f64 = 1.24;
const FONT: &str = "system-ui, Helvetica, Arial, sans-serif";

const WIDTH: f64 = 1160.0;
const LEFT: f64 = 64.0;
const TOP: f64 = 106.0;
const PANEL: Spot = (242.0, 150.0);
const GAP: Spot = (30.0, 62.0);
const BELOW: f64 = 52.0;
const SMALL: f64 = 11.0;
const NORMAL: f64 = 13.0;

const PAPER: RGBColor = RGBColor(0xFF, 0xFF, 0xFF);
const INK: RGBColor = RGBColor(0x22, 0x27, 0x2E);
const QUIET: RGBColor = RGBColor(0x5C, 0x66, 0x70);
const GRID: RGBColor = RGBColor(0xD3, 0xD8, 0xDD);

/// The classes that are drawn, one a column.
const COLUMNS: [Class; 4] = [Class::Push, Class::Reach, Class::Straight, Class::Limits];

fn colour(method: Method) -> RGBColor {
    match method {
        Method::CyclicDescent => RGBColor(0x35, 0x61, 0x1E),
        Method::LeastDeviation => RGBColor(0x1F, 0x4E, 0x79),
        Method::Following => RGBColor(0x5B, 0x9B, 0xD5),
        Method::Jacobian => RGBColor(0xB0, 0x41, 0x3A),
    }
}

/// What is drawn across.
#[derive(Clone, Copy, PartialEq)]
enum Across {
    Steps,
    Time,
}

/// A stand-alone SVG document: share solved to 1 mm against iterations.
///
/// # Panics
/// Never: the backend can only fail to write files, and here it writes into a string.
pub fn solved_by_steps_svg(accuracy: &ReachAccuracy) -> String {
    document(accuracy, Across::Steps)
}

/// A stand-alone SVG document: share solved to 1 mm against the median time of a call.
///
/// # Panics
/// Never: the backend can only fail to write files, and here it writes into a string.
pub fn solved_by_time_svg(accuracy: &ReachAccuracy) -> String {
    document(accuracy, Across::Time)
}

fn height() -> f64 {
    TOP + (Model::ALL.len() + 1) as f64 * (PANEL.1 + GAP.1) - GAP.1 + BELOW
}

fn document(accuracy: &ReachAccuracy, across: Across) -> String {
    let mut drawing = String::new();
    draw(accuracy, across, &mut drawing).expect("a string takes every drawing");
    let body = drawing.split_once('>').map_or("", |(_, body)| body);
    let height = height();
    let (inner_width, inner_height) = (WIDTH * SUBPIXELS, height * SUBPIXELS);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{height}\" \
         viewBox=\"0 0 {inner_width} {inner_height}\" role=\"img\" \
         aria-label=\"Share of goals met against iterations or time\">{body}"
    )
}

/// One method's curve in a panel.
struct Curve {
    method: Method,
    solved: [f64; STEPS.len()],
    time_ns: [f64; STEPS.len()],
}

fn draw(accuracy: &ReachAccuracy, across: Across, svg: &mut String) -> Drawn {
    let (width, tall) = place((WIDTH, height()));
    let area = SVGBackend::with_string(svg, (width as u32, tall as u32)).into_drawing_area();
    area.fill(&PAPER)?;
    heading(&area, accuracy, across)?;
    for (line, model) in Model::ALL.into_iter().enumerate() {
        for (column, class) in COLUMNS.into_iter().enumerate() {
            let rows = accuracy.rows.iter();
            let rows = rows.filter(|row| row.model == model && row.class == class);
            let curves: Vec<Curve> = rows
                .map(|row| Curve {
                    method: row.method,
                    solved: row.solved,
                    time_ns: row.time_ns,
                })
                .collect();
            let title = format!("{}: {}", model.name(), class.name());
            panel(&area, corner(line, column), &title, &curves, across)?;
        }
    }
    let curves: Vec<Curve> = accuracy
        .avatars
        .iter()
        .map(|row| Curve {
            method: row.method,
            solved: row.solved,
            time_ns: row.time_ns,
        })
        .collect();
    let title = "avatar: all five chains reach";
    panel(&area, corner(Model::ALL.len(), 0), title, &curves, across)?;
    area.present()
}

/// The upper left corner of a panel.
fn corner(line: usize, column: usize) -> Spot {
    (
        LEFT + column as f64 * (PANEL.0 + GAP.0),
        TOP + line as f64 * (PANEL.1 + GAP.1),
    )
}

fn heading(area: &Area, accuracy: &ReachAccuracy, across: Across) -> Drawn {
    let title = match across {
        Across::Steps => "Share of goals met to 1 mm [%] against iterations",
        Across::Time => "Share of goals met to 1 mm [%] against the median time of a call [µs]",
    };
    text(area, title, (LEFT, 22.0), 17.0, INK, HPos::Left)?;
    let below = format!(
        "{} cases a class that f64 finds possible, seed {}; {}; upper left is better",
        accuracy.cases, accuracy.seed, accuracy.machine.cpu
    );
    text(area, &below, (LEFT, 45.0), NORMAL, QUIET, HPos::Left)?;
    let mut x = LEFT;
    for method in Method::ALL {
        line(area, &[(x, 68.0), (x + 24.0, 68.0)], colour(method), 2.0)?;
        dot(area, (x + 12.0, 68.0), colour(method))?;
        text(
            area,
            method.name(),
            (x + 32.0, 68.0),
            NORMAL,
            INK,
            HPos::Left,
        )?;
        x += 180.0;
    }
    Ok(())
}

/// From 1 µs to 1 ms.
const TIME_DECADES: (f64, f64) = (0.0, 3.0);

fn x_share(across: Across, place: usize, time_ns: f64) -> f64 {
    match across {
        Across::Steps => place as f64 / (STEPS.len() - 1) as f64,
        Across::Time => {
            let (low, high) = TIME_DECADES;
            let decade = (1e-3 * time_ns).max(1e-9).log10();
            ((decade - low) / (high - low)).clamp(0.0, 1.0)
        }
    }
}

fn panel(area: &Area, at: Spot, title: &str, curves: &[Curve], across: Across) -> Drawn {
    let (left, top) = at;
    let (right, bottom) = (left + PANEL.0, top + PANEL.1);
    text(area, title, (left, top - 14.0), NORMAL, INK, HPos::Left)?;
    for share in [0.0, 0.25, 0.5, 0.75, 1.0] {
        let y = bottom - PANEL.1 * share;
        line(area, &[(left, y), (right, y)], GRID, 1.0)?;
        let name = (100.0 * share).to_string();
        text(area, &name, (left - 6.0, y), SMALL, QUIET, HPos::Right)?;
    }
    let ticks: Vec<(f64, String)> = match across {
        Across::Steps => (0..STEPS.len())
            .map(|i| (x_share(across, i, 0.0), STEPS[i].to_string()))
            .collect(),
        Across::Time => [1.0, 10.0, 100.0, 1000.0]
            .map(|us: f64| (x_share(across, 0, 1e3 * us), us.to_string()))
            .into(),
    };
    for (share, name) in ticks {
        let x = left + PANEL.0 * share;
        line(area, &[(x, top), (x, bottom)], GRID, 1.0)?;
        text(area, &name, (x, bottom + 13.0), SMALL, QUIET, HPos::Center)?;
    }
    for curve in curves {
        let points: Vec<Spot> = (0..STEPS.len())
            .map(|i| {
                let x = left + PANEL.0 * x_share(across, i, curve.time_ns[i]);
                (x, bottom - PANEL.1 * curve.solved[i])
            })
            .collect();
        line(area, &points, colour(curve.method), 2.0)?;
        for point in points {
            dot(area, point, colour(curve.method))?;
        }
    }
    Ok(())
}

fn dot(area: &Area, at: Spot, colour: RGBColor) -> Drawn {
    let radius = (3.0 * SUBPIXELS) as i32;
    area.draw(&Circle::new(place(at), radius, colour.filled()))
}

fn text(area: &Area, text: &str, at: Spot, size: f64, colour: RGBColor, anchor: HPos) -> Drawn {
    let size = size * SUBPIXELS * BACKEND_FONT_RATIO;
    let font = FontDesc::new(FontFamily::Name(FONT), size, FontStyle::Normal)
        .transform(FontTransform::None);
    let style = TextStyle {
        font,
        color: colour.to_backend_color(),
        pos: Pos::new(anchor, VPos::Center),
    };
    area.draw_text(text, &style, place(at))
}

fn line(area: &Area, points: &[Spot], colour: RGBColor, thickness: f64) -> Drawn {
    let points: Vec<(i32, i32)> = points.iter().copied().map(place).collect();
    let style = colour.stroke_width((thickness * SUBPIXELS) as u32);
    area.draw(&PathElement::new(points, style))
}

fn place((x, y): Spot) -> (i32, i32) {
    (
        (x * SUBPIXELS).round() as i32,
        (y * SUBPIXELS).round() as i32,
    )
}
