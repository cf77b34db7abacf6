//! One small log-log panel: error against time.

use std::io;

use plotters::backend::SVGBackend;
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind};
use plotters::element::{Circle, PathElement};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontDesc, FontFamily, FontStyle, FontTransform, RGBColor, TextStyle};

pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub(super) type Drawn = Result<(), DrawingAreaErrorKind<io::Error>>;
/// A place on the drawing, in pixels.
pub(super) type Spot = (f64, f64);

/// Pixels of the drawing are this many coordinates of the backend, which has whole ones.
pub(super) const SUBPIXELS: f64 = 4.0;
/// The backend divides font sizes by this.
const BACKEND_FONT_RATIO: f64 = 1.24;
const FONT: &str = "system-ui, Helvetica, Arial, sans-serif";

pub(super) const PANEL: Spot = (230.0, 150.0);
pub(super) const SMALL: f64 = 11.0;
pub(super) const NORMAL: f64 = 13.0;
pub(super) const INK: RGBColor = RGBColor(0x22, 0x27, 0x2E);
pub(super) const QUIET: RGBColor = RGBColor(0x5C, 0x66, 0x70);
pub(super) const GRID: RGBColor = RGBColor(0xD3, 0xD8, 0xDD);

/// Errors below this are drawn as this: f32 has no more.
const LEAST: f64 = 1e-9;
/// Errors above this, and those that are not numbers, are drawn as this.
const MOST: f64 = 1e2;

/// One engine's results at rising frame rates.
pub(super) struct Curve {
    pub colour: RGBColor,
    /// Time in ms, and error.
    pub points: Vec<(f64, f64)>,
}

/// What a panel shows.
pub(super) struct Panel {
    pub title: String,
    pub unit: String,
    pub bound: Option<f64>,
    pub curves: Vec<Curve>,
}

/// Powers of ten that are shown, from and to.
type Decades = (i32, i32);

/// The powers of ten around values, two at least; with many between them only some are named.
fn decades(values: impl Iterator<Item = f64>) -> Decades {
    let logs: Vec<f64> = values.map(f64::log10).collect();
    let low = logs.iter().copied().fold(f64::INFINITY, f64::min);
    let high = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if !low.is_finite() || !high.is_finite() {
        return (0, 2);
    }
    let (low, high) = (low.floor() as i32, high.ceil() as i32);
    (low, high.max(low + 2))
}

fn shown(error: f64) -> f64 {
    if error.is_finite() {
        error.clamp(LEAST, MOST)
    } else {
        MOST
    }
}

fn share((low, high): Decades, value: f64) -> f64 {
    (value.log10() - f64::from(low)) / f64::from(high - low)
}

impl Panel {
    /// Draws it with its upper left corner at `at`.
    pub(super) fn draw(&self, area: &Area, at: Spot) -> Drawn {
        let points = || self.curves.iter().flat_map(|curve| &curve.points);
        let across = decades(points().map(|point| point.0));
        let up = decades(
            points()
                .map(|p| shown(p.1))
                .chain(self.bound.filter(|b| *b > 0.0)),
        );
        let title = (at.0, at.1 - 28.0);
        text(area, &self.title, title, NORMAL, INK, HPos::Left)?;
        let unit = (at.0, at.1 - 12.0);
        text(area, &self.unit, unit, SMALL, QUIET, HPos::Left)?;
        grid(area, at, across, up)?;
        let place = |(time, error): (f64, f64)| {
            let x = at.0 + PANEL.0 * share(across, time);
            (x, at.1 + PANEL.1 * (1.0 - share(up, error)))
        };
        if let Some(bound) = self.bound.filter(|b| *b > 0.0) {
            self.bound_line(area, at, place((1.0, bound)).1)?;
        }
        for curve in &self.curves {
            let spots: Vec<Spot> = curve
                .points
                .iter()
                .map(|p| place((p.0, shown(p.1))))
                .collect();
            line(area, &spots, curve.colour, 1.5)?;
            for (index, spot) in spots.into_iter().enumerate() {
                dot(area, spot, curve.colour, index)?;
            }
        }
        Ok(())
    }

    /// What must hold: dashes across the panel.
    fn bound_line(&self, area: &Area, at: Spot, y: f64) -> Drawn {
        let dashes = 23;
        for dash in 0..dashes {
            let x = at.0 + PANEL.0 * f64::from(dash) / f64::from(dashes);
            line(area, &[(x, y), (x + 6.0, y)], INK, 1.5)?;
        }
        Ok(())
    }
}

fn grid(area: &Area, at: Spot, across: Decades, up: Decades) -> Drawn {
    let (right, bottom) = (at.0 + PANEL.0, at.1 + PANEL.1);
    for decade in (up.0..=up.1).step_by(named_every(up, 8)) {
        let y = bottom - PANEL.1 * share(up, 10f64.powi(decade));
        line(area, &[(at.0, y), (right, y)], GRID, 1.0)?;
        text(
            area,
            &power(decade),
            (at.0 - 6.0, y),
            SMALL,
            QUIET,
            HPos::Right,
        )?;
    }
    for decade in (across.0..=across.1).step_by(named_every(across, 6)) {
        let x = at.0 + PANEL.0 * share(across, 10f64.powi(decade));
        line(area, &[(x, at.1), (x, bottom)], GRID, 1.0)?;
        text(
            area,
            &power(decade),
            (x, bottom + 13.0),
            SMALL,
            QUIET,
            HPos::Center,
        )?;
    }
    Ok(())
}

fn named_every(decades: Decades, most: i32) -> usize {
    ((decades.1 - decades.0) / most + 1) as usize
}

fn power(decade: i32) -> String {
    match decade {
        -2..=4 => 10f64.powi(decade).to_string(),
        _ => format!("1e{decade}"),
    }
}

/// A dot: the higher the frame rate, the larger.
pub(super) fn dot(area: &Area, at: Spot, colour: RGBColor, rate: usize) -> Drawn {
    let radius = (2.2 + 1.3 * rate as f64) * SUBPIXELS;
    area.draw(&Circle::new(place(at), radius as i32, colour.filled()))
}

pub(super) fn text(
    area: &Area,
    text: &str,
    at: Spot,
    size: f64,
    colour: RGBColor,
    anchor: HPos,
) -> Drawn {
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

pub(super) fn line(area: &Area, points: &[Spot], colour: RGBColor, thickness: f64) -> Drawn {
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
