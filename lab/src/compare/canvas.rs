//! An SVG to draw on in fractions of pixels.

use std::io;

use plotters::backend::SVGBackend;
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind, IntoDrawingArea};
use plotters::element::{Circle, PathElement};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontDesc, FontFamily, FontStyle, FontTransform, RGBColor, TextStyle};

use super::summary::ENGINES;

pub(super) type Spot = (f64, f64);
pub(super) type Drawn = Result<(), DrawingAreaErrorKind<io::Error>>;

/// Pixels of the drawing are this many coordinates of the backend, which has whole ones.
const SUBPIXELS: f64 = 4.0;
/// The backend divides font sizes by this.
const BACKEND_FONT_RATIO: f64 = 1.24;
const FONT: &str = "system-ui, Helvetica, Arial, sans-serif";

pub(super) const SMALL: f64 = 11.0;
pub(super) const NORMAL: f64 = 13.0;
pub(super) const LARGE: f64 = 17.0;

const PAPER: RGBColor = RGBColor(0xFF, 0xFF, 0xFF);
pub(super) const INK: RGBColor = RGBColor(0x22, 0x27, 0x2E);
pub(super) const QUIET: RGBColor = RGBColor(0x5C, 0x66, 0x70);
pub(super) const GRID: RGBColor = RGBColor(0xD3, 0xD8, 0xDD);

/// One an engine, told apart by lightness as well.
pub(super) const COLOURS: [RGBColor; ENGINES.len()] = [
    RGBColor(0x1F, 0x4E, 0x79),
    RGBColor(0xD0, 0x8A, 0x2C),
    RGBColor(0xB0, 0x41, 0x6E),
];

/// Positions, lengths and font sizes are in pixels from the top left.
pub(super) struct Canvas<'a> {
    area: DrawingArea<SVGBackend<'a>, Shift>,
}

/// A stand-alone SVG document of a size in pixels.
///
/// # Panics
/// Never: the backend can only fail to write files, and here it writes into a string.
pub(super) fn document(
    name: &str,
    (width, height): Spot,
    draw: impl FnOnce(&Canvas) -> Drawn,
) -> String {
    let mut drawing = String::new();
    drawn(&mut drawing, (width, height), draw).expect("a string takes every drawing");
    let body = drawing.split_once('>').map_or("", |(_, body)| body);
    let (inner_width, inner_height) = (width * SUBPIXELS, height * SUBPIXELS);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {inner_width} {inner_height}\" role=\"img\" aria-label=\"{name}\">{body}"
    )
}

fn drawn(svg: &mut String, size: Spot, draw: impl FnOnce(&Canvas) -> Drawn) -> Drawn {
    let (width, height) = place(size);
    let area = SVGBackend::with_string(svg, (width as u32, height as u32)).into_drawing_area();
    area.fill(&PAPER)?;
    let canvas = Canvas { area };
    draw(&canvas)?;
    canvas.area.present()
}

impl Canvas<'_> {
    pub(super) fn text(
        &self,
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
        self.area.draw_text(text, &style, place(at))
    }

    pub(super) fn line(&self, points: &[Spot], colour: RGBColor, thickness: f64) -> Drawn {
        let points: Vec<(i32, i32)> = points.iter().copied().map(place).collect();
        let style = colour.stroke_width((thickness * SUBPIXELS) as u32);
        self.area.draw(&PathElement::new(points, style))
    }

    pub(super) fn dot(&self, at: Spot, radius: f64, colour: RGBColor) -> Drawn {
        let radius = (radius * SUBPIXELS) as i32;
        self.area
            .draw(&Circle::new(place(at), radius, colour.filled()))
    }

    /// The engines' names with their colours, in a row from the left.
    pub(super) fn legend(&self, (left, y): Spot) -> Drawn {
        for (index, (name, colour)) in ENGINES.iter().zip(COLOURS).enumerate() {
            let x = left + 150.0 * index as f64;
            self.line(&[(x, y), (x + 24.0, y)], colour, 2.5)?;
            self.dot((x + 12.0, y), 3.5, colour)?;
            self.text(name, (x + 32.0, y), NORMAL, INK, HPos::Left)?;
        }
        Ok(())
    }
}

fn place((x, y): Spot) -> (i32, i32) {
    (
        (x * SUBPIXELS).round() as i32,
        (y * SUBPIXELS).round() as i32,
    )
}
