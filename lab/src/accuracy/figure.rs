//! Speed against error: one mark per method and class, both axes logarithmic.

use std::io;

use plotters::backend::SVGBackend;
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind, IntoDrawingArea};
use plotters::element::{Circle, PathElement, Polygon, Rectangle};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontDesc, FontFamily, FontStyle, FontTransform, RGBColor, TextStyle};

use super::Accuracy;
use super::generate::Class;
use super::methods::Method;
use super::summary::Row;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = Result<(), DrawingAreaErrorKind<io::Error>>;
type Spot = (f64, f64);

/// Pixels of the drawing are this many coordinates of the backend, which has whole ones.
const SUBPIXELS: f64 = 4.0;
/// The backend divides font sizes by this.
const BACKEND_FONT_RATIO: f64 = 1.24;
const FONT: &str = "system-ui, Helvetica, Arial, sans-serif";

const WIDTH: f64 = 1160.0;
const HEIGHT: f64 = 700.0;
const LEFT: f64 = 76.0;
const RIGHT: f64 = 920.0;
const TOP: f64 = 64.0;
const BOTTOM: f64 = 640.0;
const LEGEND_LEFT: f64 = 944.0;
const LEGEND_LINE: f64 = 21.0;
const MARK: f64 = 5.0;
/// What keeps marks apart that overlap.
const HALO: f64 = MARK + 1.0;
const SMALL: f64 = 11.0;
const NORMAL: f64 = 13.0;

/// Errors below this are drawn here.
const ERROR_MIN: f64 = 1e-17;

const PAPER: RGBColor = RGBColor(0xFF, 0xFF, 0xFF);
const INK: RGBColor = RGBColor(0x22, 0x27, 0x2E);
const QUIET: RGBColor = RGBColor(0x5C, 0x66, 0x70);
const GRID: RGBColor = RGBColor(0xD3, 0xD8, 0xDD);
const LEADER: RGBColor = RGBColor(0x9A, 0xA3, 0xAC);

/// The methods that are drawn, with their colours.
const DRAWN: [(Method, RGBColor); 6] = [
    (Method::Palpable, RGBColor(0x1F, 0x4E, 0x79)),
    (Method::PalpableWarm, RGBColor(0x3D, 0x9A, 0xC9)),
    (Method::ParryF32, RGBColor(0xB0, 0x41, 0x3A)),
    (Method::ParryF64, RGBColor(0xC0, 0x78, 0x2A)),
    (Method::LocalWalk, RGBColor(0x35, 0x61, 0x1E)),
    (Method::LocalWalkWarm, RGBColor(0x72, 0x9F, 0x35)),
];

/// A stand-alone SVG document, 1160 pixels wide: the 99th percentile of the error across, the
/// median time up. Numbers beside the marks name the classes; rows without times are left out.
///
/// # Panics
/// Never: the backend can only fail to write files, and here it writes into a string.
pub fn speed_error_svg(accuracy: &Accuracy) -> String {
    let mut drawing = String::new();
    draw(accuracy, &mut drawing).expect("a string takes every drawing");
    let body = drawing.split_once('>').map_or("", |(_, body)| body);
    let (inner_width, inner_height) = (WIDTH * SUBPIXELS, HEIGHT * SUBPIXELS);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{HEIGHT}\" \
         viewBox=\"0 0 {inner_width} {inner_height}\" role=\"img\" \
         aria-label=\"Time against error of penetration depth and distance\">{body}"
    )
}

fn draw(accuracy: &Accuracy, svg: &mut String) -> Drawn {
    let size = (
        place((WIDTH, HEIGHT)).0 as u32,
        place((WIDTH, HEIGHT)).1 as u32,
    );
    let area = SVGBackend::with_string(svg, size).into_drawing_area();
    area.fill(&PAPER)?;
    let axes = Axes::around(&accuracy.rows);
    heading(&area, accuracy)?;
    axes.draw(&area)?;
    let marks = marks(accuracy, &axes);
    let labels = labels(&marks);
    for (label, mark) in labels.iter().zip(&marks) {
        draw_leader(&area, mark, label)?;
    }
    for mark in &marks {
        let halo = Circle::new(place(mark.at), (HALO * SUBPIXELS) as i32, PAPER.filled());
        area.draw(&halo)?;
        draw_mark(&area, mark.method, mark.at)?;
    }
    for (label, mark) in labels.iter().zip(&marks) {
        text(
            &area,
            &mark.number.to_string(),
            *label,
            SMALL,
            colour(mark.method),
            HPos::Center,
        )?;
    }
    legend(&area)?;
    area.present()
}

/// The axes: from one round number to another.
struct Axes {
    /// Powers of ten.
    error: (i32, i32),
    /// Nanoseconds.
    time: (f64, f64),
}

fn coordinates(row: &Row) -> Option<(f64, f64)> {
    let time = row.time_ns?.median;
    (time > 0.0).then_some((row.error?.p99.max(ERROR_MIN), time))
}

fn decades(values: impl Iterator<Item = f64>) -> (i32, i32) {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value.log10()), high.max(value.log10()))
    });
    if low > high {
        return (0, 1);
    }
    let low_decade = (low - 0.05).floor() as i32;
    (
        low_decade,
        ((high + 0.05).ceil() as i32).max(low_decade + 1),
    )
}

/// 1, 2 and 5 times the powers of ten from one nanosecond to a second.
fn round_numbers() -> impl Iterator<Item = f64> {
    (0..=9).flat_map(|power| [1.0, 2.0, 5.0].map(|factor| factor * 10f64.powi(power)))
}

/// Round numbers a little below the least value and above the greatest.
fn round_range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), value| {
        (low.min(value), high.max(value))
    });
    let below = round_numbers().filter(|round| *round < 0.9 * low).last();
    let above = round_numbers().find(|round| *round > 1.1 * high);
    let low = below.filter(|_| low.is_finite()).unwrap_or(1.0);
    (low, above.unwrap_or(1e9).max(2.0 * low))
}

impl Axes {
    fn around(rows: &[Row]) -> Self {
        let drawn = || {
            rows.iter()
                .filter(|row| is_drawn(row))
                .filter_map(coordinates)
        };
        Self {
            error: decades(drawn().map(|(error, _)| error)),
            time: round_range(drawn().map(|(_, time)| time)),
        }
    }

    fn x(&self, error: f64) -> f64 {
        let (low, high) = self.error;
        LEFT + (RIGHT - LEFT) * (error.log10() - f64::from(low)) / f64::from(high - low)
    }

    fn y(&self, time: f64) -> f64 {
        let (low, high) = self.time;
        BOTTOM - (BOTTOM - TOP) * (time / low).log10() / (high / low).log10()
    }

    fn draw(&self, area: &Area) -> Drawn {
        for power in self.error.0..=self.error.1 {
            let x = self.x(10f64.powi(power));
            line(area, &[(x, TOP), (x, BOTTOM)], GRID, 1.0)?;
            text(
                area,
                &format!("1e{power}"),
                (x, BOTTOM + 14.0),
                SMALL,
                QUIET,
                HPos::Center,
            )?;
        }
        for time in round_numbers().filter(|t| (self.time.0..=self.time.1).contains(t)) {
            let y = self.y(time);
            line(area, &[(LEFT, y), (RIGHT, y)], GRID, 1.0)?;
            let name = time.to_string();
            text(area, &name, (LEFT - 8.0, y), SMALL, QUIET, HPos::Right)?;
        }
        let middle = (0.5 * (LEFT + RIGHT), BOTTOM + 36.0);
        let across =
            "error of depth or distance, 99th percentile, relative to the smaller piece's size";
        text(area, across, middle, NORMAL, INK, HPos::Center)?;
        upright(
            area,
            "median time of a call [ns]",
            (22.0, 0.5 * (TOP + BOTTOM)),
        )
    }
}

fn is_drawn(row: &Row) -> bool {
    DRAWN.iter().any(|(method, _)| *method == row.method)
}

struct Mark {
    method: Method,
    /// One and up, in the order of the classes.
    number: usize,
    at: Spot,
}

fn marks(accuracy: &Accuracy, axes: &Axes) -> Vec<Mark> {
    let mark = |row: &Row| {
        let (error, time) = coordinates(row)?;
        Some(Mark {
            method: row.method,
            number: 1 + Class::ALL.iter().position(|class| *class == row.class)?,
            at: (axes.x(error), axes.y(time)),
        })
    };
    let rows = accuracy.rows.iter().filter(|row| is_drawn(row));
    rows.filter_map(mark).collect()
}

/// Half the room that a label needs, and that a mark needs.
const LABEL_ROOM: Spot = (7.5, 6.5);
const MARK_ROOM: Spot = (MARK + 0.5, MARK + 0.5);

fn collide(p: Spot, of_p: Spot, q: Spot, of_q: Spot) -> bool {
    (p.0 - q.0).abs() < of_p.0 + of_q.0 && (p.1 - q.1).abs() < of_p.1 + of_q.1
}

/// Where the numbers stand: as near to their marks as possible, over no mark and no other number.
fn labels(marks: &[Mark]) -> Vec<Spot> {
    let mut taken: Vec<Spot> = Vec::new();
    for mark in marks {
        let is_free = |spot: &Spot| {
            let inside = spot.0 > LEFT + LABEL_ROOM.0
                && spot.0 < RIGHT - LABEL_ROOM.0
                && spot.1 > TOP + LABEL_ROOM.1
                && spot.1 < BOTTOM - LABEL_ROOM.1;
            inside
                && !marks
                    .iter()
                    .any(|m| collide(*spot, LABEL_ROOM, m.at, MARK_ROOM))
                && !taken
                    .iter()
                    .any(|t| collide(*spot, LABEL_ROOM, *t, LABEL_ROOM))
        };
        let spot = around(mark.at).find(is_free).unwrap_or(mark.at);
        taken.push(spot);
    }
    taken
}

/// Places around a mark, nearest first.
fn around(at: Spot) -> impl Iterator<Item = Spot> {
    (0..30).flat_map(move |ring| {
        let radius = 13.0 + 4.0 * f64::from(ring);
        (0..16).map(move |step| {
            let turn = std::f64::consts::TAU * f64::from(step) / 16.0;
            (at.0 + radius * turn.cos(), at.1 - radius * turn.sin())
        })
    })
}

fn draw_leader(area: &Area, mark: &Mark, label: &Spot) -> Drawn {
    let (dx, dy) = (label.0 - mark.at.0, label.1 - mark.at.1);
    let length = dx.hypot(dy);
    if length < 16.0 {
        return Ok(());
    }
    let end = 1.0 - 7.0 / length;
    let to = (mark.at.0 + dx * end, mark.at.1 + dy * end);
    line(area, &[mark.at, to], LEADER, 0.75)
}

fn colour(method: Method) -> RGBColor {
    let known = DRAWN.iter().find(|(drawn, _)| *drawn == method);
    known.map_or(INK, |(_, colour)| *colour)
}

fn draw_mark(area: &Area, method: Method, at: Spot) -> Drawn {
    let style = colour(method).filled();
    match method {
        Method::ParryF32 => {
            let corners = [(0.0, -1.2), (1.1, 0.8), (-1.1, 0.8)];
            let corners = corners.map(|(x, y)| place((at.0 + MARK * x, at.1 + MARK * y)));
            area.draw(&Polygon::new(corners.to_vec(), style))
        }
        Method::ParryF64 => {
            let half = 0.85 * MARK;
            let low = place((at.0 - half, at.1 - half));
            area.draw(&Rectangle::new(
                [low, place((at.0 + half, at.1 + half))],
                style,
            ))
        }
        Method::LocalWalk | Method::LocalWalkWarm => {
            let corners = [(0.0, -1.2), (1.2, 0.0), (0.0, 1.2), (-1.2, 0.0)];
            let corners = corners.map(|(x, y)| place((at.0 + MARK * x, at.1 + MARK * y)));
            area.draw(&Polygon::new(corners.to_vec(), style))
        }
        _ => area.draw(&Circle::new(place(at), (MARK * SUBPIXELS) as i32, style)),
    }
}

fn heading(area: &Area, accuracy: &Accuracy) -> Drawn {
    let title = "Penetration depth and distance of convex hulls: time against error";
    text(area, title, (LEFT, 22.0), 17.0, INK, HPos::Left)?;
    let below = format!(
        "{} pairs a class, seed {}; {}; lower left is better",
        accuracy.pairs, accuracy.seed, accuracy.machine.cpu
    );
    text(area, &below, (LEFT, 45.0), NORMAL, QUIET, HPos::Left)
}

fn legend(area: &Area) -> Drawn {
    let mut y = TOP + 8.0;
    for (method, _) in DRAWN {
        draw_mark(area, method, (LEGEND_LEFT + 7.0, y))?;
        text(
            area,
            method.name(),
            (LEGEND_LEFT + 24.0, y),
            NORMAL,
            INK,
            HPos::Left,
        )?;
        y += LEGEND_LINE;
    }
    for line in ["the walk: overlapping pairs", "only, the others: all pairs"] {
        text(area, line, (LEGEND_LEFT, y), SMALL, QUIET, HPos::Left)?;
        y += 0.75 * LEGEND_LINE;
    }
    y += 0.5 * LEGEND_LINE;
    for (index, class) in Class::ALL.into_iter().enumerate() {
        let number = (index + 1).to_string();
        text(
            area,
            &number,
            (LEGEND_LEFT + 14.0, y),
            NORMAL,
            QUIET,
            HPos::Right,
        )?;
        text(
            area,
            class.name(),
            (LEGEND_LEFT + 24.0, y),
            NORMAL,
            INK,
            HPos::Left,
        )?;
        y += LEGEND_LINE;
    }
    Ok(())
}

fn text(area: &Area, text: &str, at: Spot, size: f64, colour: RGBColor, anchor: HPos) -> Drawn {
    lettering(area, text, at, size, (colour, anchor, FontTransform::None))
}

fn upright(area: &Area, text: &str, at: Spot) -> Drawn {
    lettering(
        area,
        text,
        at,
        NORMAL,
        (INK, HPos::Center, FontTransform::Rotate270),
    )
}

fn lettering(
    area: &Area,
    text: &str,
    at: Spot,
    size: f64,
    (colour, anchor, turn): (RGBColor, HPos, FontTransform),
) -> Drawn {
    let size = size * SUBPIXELS * BACKEND_FONT_RATIO;
    let font = FontDesc::new(FontFamily::Name(FONT), size, FontStyle::Normal).transform(turn);
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
