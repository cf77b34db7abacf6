//! What still approaches against the impulses spent, a panel a problem, a line an order.

use plotters::backend::SVGBackend;
use plotters::drawing::IntoDrawingArea;
use plotters::style::RGBColor;
use plotters::style::text_anchor::HPos;

use super::orders::{BUDGETS, Left, ORDERS, OrderCurve, Posed, TOLERANCE_M_S};
use super::panel::{Area, Drawn, GRID, INK, NORMAL, QUIET, SMALL, SUBPIXELS, Spot, line, text};

const PAPER: RGBColor = RGBColor(0xFF, 0xFF, 0xFF);
const PANEL: Spot = (400.0, 230.0);
const LEFT: f64 = 76.0;
const TOP: f64 = 150.0;
const GAP: Spot = (96.0, 104.0);
const WIDTH: f64 = LEFT + 2.0 * PANEL.0 + GAP.0 + 34.0;
const HEIGHT: f64 = TOP + 2.0 * PANEL.1 + GAP.1 + 62.0;

/// Speeds that are shown, powers of ten in m/s; slower ones are drawn as the slowest.
const UP: (i32, i32) = (-5, 0);

const COLOURS: [RGBColor; 5] = [
    RGBColor(0x1F, 0x4E, 0x79),
    RGBColor(0xB0, 0x41, 0x3A),
    RGBColor(0xD9, 0x9A, 0x2B),
    RGBColor(0x6B, 0x8E, 0x4E),
    RGBColor(0x7A, 0x4E, 0x8A),
];

/// A stand-alone SVG document.
///
/// # Panics
/// Never: the backend can only fail to write files, and here it writes into a string.
pub fn orders_svg(curves: &[OrderCurve]) -> String {
    let mut drawing = String::new();
    draw(curves, &mut drawing).expect("a string takes every drawing");
    let body = drawing.split_once('>').map_or("", |(_, body)| body);
    let (inner_width, inner_height) = (WIDTH * SUBPIXELS, HEIGHT * SUBPIXELS);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{HEIGHT}\" \
         viewBox=\"0 0 {inner_width} {inner_height}\" role=\"img\" \
         aria-label=\"Speed of approach that is left after a number of impulses\">{body}"
    )
}

fn draw(curves: &[OrderCurve], svg: &mut String) -> Drawn {
    let size = [WIDTH, HEIGHT].map(|length| (length * SUBPIXELS) as u32);
    let area = SVGBackend::with_string(svg, (size[0], size[1])).into_drawing_area();
    area.fill(&PAPER)?;
    heading(&area)?;
    for (index, problem) in Posed::ALL.into_iter().enumerate() {
        let at = (
            LEFT + (index % 2) as f64 * (PANEL.0 + GAP.0),
            TOP + (index / 2) as f64 * (PANEL.1 + GAP.1),
        );
        frame(&area, at, problem)?;
        for curve in curves.iter().filter(|curve| curve.problem == problem) {
            let spots: Vec<Spot> = curve.left.iter().map(|left| spot(at, left)).collect();
            line(&area, &spots, colour(curve.order), 2.0)?;
        }
    }
    area.present()
}

fn colour(order: &str) -> RGBColor {
    let place = ORDERS.iter().position(|(_, name)| *name == order);
    COLOURS[place.unwrap_or(0)]
}

/// Share of the panel's height.
fn share_up(speed: f64) -> f64 {
    let (low, high) = (f64::from(UP.0), f64::from(UP.1));
    (speed.log10().clamp(low, high) - low) / (high - low)
}

fn share_across(impulses: u32) -> f64 {
    let most = BUDGETS[BUDGETS.len() - 1];
    f64::from(impulses).log2() / f64::from(most).log2()
}

fn spot(at: Spot, left: &Left) -> Spot {
    (
        at.0 + PANEL.0 * share_across(left.budget),
        at.1 + PANEL.1 * (1.0 - share_up(f64::from(left.approach_m_s))),
    )
}

fn heading(area: &Area) -> Drawn {
    let title =
        "What still approaches after so many impulses, by the order in which contacts get them";
    text(area, title, (LEFT, 24.0), 17.0, INK, HPos::Left)?;
    let below = "fastest approach of any contact [m/s] against impulses allowed, 32 a contact at most; \
                 dashes: what counts as none";
    text(area, below, (LEFT, 48.0), NORMAL, QUIET, HPos::Left)?;
    for (index, (_, name)) in ORDERS.iter().enumerate() {
        let x = LEFT + 168.0 * index as f64;
        line(area, &[(x, 78.0), (x + 32.0, 78.0)], COLOURS[index], 2.5)?;
        text(area, name, (x + 42.0, 78.0), NORMAL, INK, HPos::Left)?;
    }
    Ok(())
}

/// Title, grid, names of the axes, and what counts as none.
fn frame(area: &Area, at: Spot, problem: Posed) -> Drawn {
    let (right, bottom) = (at.0 + PANEL.0, at.1 + PANEL.1);
    let name = match problem {
        Posed::Impact => format!("{} (conjugate goes as sweep)", problem.name()),
        _ => problem.name().to_owned(),
    };
    text(area, &name, (at.0, at.1 - 34.0), NORMAL, INK, HPos::Left)?;
    text(
        area,
        "approach [m/s]",
        (at.0, at.1 - 15.0),
        SMALL,
        QUIET,
        HPos::Left,
    )?;
    for decade in UP.0..=UP.1 {
        let y = bottom - PANEL.1 * share_up(10f64.powi(decade));
        line(area, &[(at.0, y), (right, y)], GRID, 1.0)?;
        let name = if decade < -3 {
            format!("1e{decade}")
        } else {
            10f64.powi(decade).to_string()
        };
        text(area, &name, (at.0 - 8.0, y), SMALL, QUIET, HPos::Right)?;
    }
    for impulses in BUDGETS.into_iter().step_by(2) {
        let x = at.0 + PANEL.0 * share_across(impulses);
        line(area, &[(x, at.1), (x, bottom)], GRID, 1.0)?;
        let name = impulses.to_string();
        text(area, &name, (x, bottom + 14.0), SMALL, QUIET, HPos::Center)?;
    }
    let middle = (at.0 + 0.5 * PANEL.0, bottom + 34.0);
    text(area, "impulses", middle, SMALL, QUIET, HPos::Center)?;
    let y = bottom - PANEL.1 * share_up(f64::from(TOLERANCE_M_S));
    for dash in 0..40 {
        let x = at.0 + PANEL.0 * f64::from(dash) / 40.0;
        line(area, &[(x, y), (x + 5.0, y)], INK, 1.0)?;
    }
    Ok(())
}
