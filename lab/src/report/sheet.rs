//! A sheet of SVG to draw on in fractions of pixels.

use plotters::backend::SVGBackend;
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind, IntoDrawingArea};
use plotters::element::{Circle, PathElement, Rectangle};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{
    Color, FontDesc, FontFamily, FontStyle, FontTransform, ShapeStyle, TextStyle,
};

use super::palette::{PAPER, Role};

/// The backend has whole coordinates; this many of them make one pixel of the sheet.
pub(super) const SUBPIXELS: f64 = 8.0;

/// The backend divides font sizes by this.
const BACKEND_FONT_RATIO: f64 = 1.24;

const FONT: &str = "system-ui, Helvetica, Arial, sans-serif";

pub(super) type Point = (f64, f64);
pub(super) type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;

/// Positions, lengths and font sizes are in pixels from the top left.
pub(super) struct Sheet<'a> {
    area: DrawingArea<SVGBackend<'a>, Shift>,
}

/// How a text looks and which of its points is given; vertically it is always the middle.
#[derive(Clone, Copy)]
pub(super) struct Lettering {
    pub(super) size: f64,
    pub(super) role: Role,
    pub(super) is_bold: bool,
    pub(super) is_upright: bool,
    pub(super) anchor: HPos,
}

impl Lettering {
    pub(super) fn new(size: f64, role: Role) -> Self {
        Self {
            size,
            role,
            is_bold: false,
            is_upright: false,
            anchor: HPos::Left,
        }
    }

    pub(super) fn bold(self) -> Self {
        Self {
            is_bold: true,
            ..self
        }
    }

    /// Reads from bottom to top.
    pub(super) fn upright(self) -> Self {
        Self {
            is_upright: true,
            ..self
        }
    }

    pub(super) fn anchored(self, anchor: HPos) -> Self {
        Self { anchor, ..self }
    }

    fn style(&self) -> TextStyle<'static> {
        let weight = if self.is_bold {
            FontStyle::Bold
        } else {
            FontStyle::Normal
        };
        let turn = if self.is_upright {
            FontTransform::Rotate270
        } else {
            FontTransform::None
        };
        let size = self.size * SUBPIXELS * BACKEND_FONT_RATIO;
        let font = FontDesc::new(FontFamily::Name(FONT), size, weight).transform(turn);
        TextStyle {
            font,
            color: self.role.colour().to_backend_color(),
            pos: Pos::new(self.anchor, VPos::Center),
        }
    }
}

impl<'a> Sheet<'a> {
    pub(super) fn new(
        svg: &'a mut String,
        width: f64,
        height: f64,
    ) -> Result<Self, DrawingAreaErrorKind<std::io::Error>> {
        let size = (subpixels(width) as u32, subpixels(height) as u32);
        let area = SVGBackend::with_string(svg, size).into_drawing_area();
        area.fill(&PAPER.colour())?;
        Ok(Self { area })
    }

    pub(super) fn finish(self) -> Drawn {
        self.area.present()
    }

    pub(super) fn text(&self, text: &str, at: Point, lettering: &Lettering) -> Drawn {
        self.area.draw_text(text, &lettering.style(), place(at))
    }

    pub(super) fn line(&self, from: Point, to: Point, role: Role, thickness: f64) -> Drawn {
        self.curve(&[from, to], role, thickness)
    }

    pub(super) fn curve(&self, points: &[Point], role: Role, thickness: f64) -> Drawn {
        let places: Vec<(i32, i32)> = points.iter().copied().map(place).collect();
        self.area
            .draw(&PathElement::new(places, stroke(role, thickness)))
    }

    pub(super) fn fill(&self, top_left: Point, bottom_right: Point, role: Role) -> Drawn {
        self.area.draw(&Rectangle::new(
            [place(top_left), place(bottom_right)],
            role.colour().filled(),
        ))
    }

    pub(super) fn ring(&self, centre: Point, radius: f64, role: Role) -> Drawn {
        self.area.draw(&Circle::new(
            place(centre),
            subpixels(radius),
            stroke(role, 1.75),
        ))
    }
}

fn stroke(role: Role, thickness: f64) -> ShapeStyle {
    role.colour().stroke_width(subpixels(thickness) as u32)
}

fn place((x, y): Point) -> (i32, i32) {
    (subpixels(x), subpixels(y))
}

fn subpixels(pixels: f64) -> i32 {
    (pixels * SUBPIXELS).round() as i32
}
