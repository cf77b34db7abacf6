//! Error against time, case by case: a small panel for every quantity that has an exact value.

use plotters::backend::SVGBackend;
use plotters::drawing::IntoDrawingArea;
use plotters::style::RGBColor;
use plotters::style::text_anchor::HPos;

use super::ImpulseAccuracy;
use super::engine::Subject;
use super::panel::{
    Area, Curve, Drawn, INK, NORMAL, PANEL, Panel, QUIET, SUBPIXELS, Spot, dot, line, text,
};
use super::row::{Case, Judged, Quantity, Row};

const PAPER: RGBColor = RGBColor(0xFF, 0xFF, 0xFF);
const COLUMNS: usize = 4;
const LEFT: f64 = 64.0;
const TOP: f64 = 140.0;
const GAP: Spot = (62.0, 84.0);
const WIDTH: f64 = LEFT + COLUMNS as f64 * (PANEL.0 + GAP.0) - GAP.0 + 30.0;
const BELOW: f64 = 34.0;

fn colour(subject: Subject) -> RGBColor {
    match subject {
        Subject::Palpable => RGBColor(0x1F, 0x4E, 0x79),
        Subject::Rapier => RGBColor(0xB0, 0x41, 0x3A),
        Subject::RapierBest => RGBColor(0xD9, 0x9A, 0x2B),
    }
}

/// A stand-alone SVG document.
///
/// # Panics
/// Never: the backend can only fail to write files, and here it writes into a string.
pub fn error_time_svg(accuracy: &ImpulseAccuracy) -> String {
    let panels = panels(accuracy);
    let height = TOP + panels.len().div_ceil(COLUMNS) as f64 * (PANEL.1 + GAP.1) - GAP.1 + BELOW;
    let mut drawing = String::new();
    draw(accuracy, &panels, height, &mut drawing).expect("a string takes every drawing");
    let body = drawing.split_once('>').map_or("", |(_, body)| body);
    let (inner_width, inner_height) = (WIDTH * SUBPIXELS, height * SUBPIXELS);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{height}\" \
         viewBox=\"0 0 {inner_width} {inner_height}\" role=\"img\" \
         aria-label=\"Error of loose bodies against time spent\">{body}"
    )
}

/// A panel for every quantity that is promised; those of [`Case::Robustness`] are for the tables.
fn panels(accuracy: &ImpulseAccuracy) -> Vec<Panel> {
    let mut quantities: Vec<&Quantity> = vec![];
    for row in &accuracy.rows {
        let quantity = &row.quantity;
        let is_drawn =
            quantity.bound.is_some_and(|bound| bound > 0.0) && quantity.case != Case::Robustness;
        if is_drawn && !quantities.iter().any(|known| known.name == quantity.name) {
            quantities.push(quantity);
        }
    }
    quantities
        .into_iter()
        .map(|quantity| panel(accuracy, quantity))
        .collect()
}

fn panel(accuracy: &ImpulseAccuracy, quantity: &Quantity) -> Panel {
    let of = |subject: Subject| {
        let rows = accuracy.rows.iter();
        let rows = rows.filter(move |r| r.subject == subject && r.quantity.name == quantity.name);
        Curve {
            colour: colour(subject),
            points: rows.map(point).collect(),
        }
    };
    let unit = match quantity.judged {
        Judged::Relative => "relative error".to_owned(),
        _ if quantity.unit.is_empty() => "relative".to_owned(),
        _ => format!("error [{}]", quantity.unit),
    };
    Panel {
        title: format!("{}: {}", quantity.case.name(), quantity.name),
        unit: format!("{unit} against CPU time [ms]"),
        bound: quantity.bound,
        // The kernel last, on top of the others.
        curves: Subject::ALL.into_iter().rev().map(of).collect(),
    }
}

fn point(row: &Row) -> (f64, f64) {
    (row.total_ms.max(1e-3), row.error.unwrap_or(f64::NAN))
}

fn draw(accuracy: &ImpulseAccuracy, panels: &[Panel], height: f64, svg: &mut String) -> Drawn {
    let size = [WIDTH, height].map(|length| (length * SUBPIXELS) as u32);
    let area = SVGBackend::with_string(svg, (size[0], size[1])).into_drawing_area();
    area.fill(&PAPER)?;
    heading(&area, accuracy)?;
    for (index, panel) in panels.iter().enumerate() {
        let column = (index % COLUMNS) as f64;
        let row = (index / COLUMNS) as f64;
        let at = (
            LEFT + column * (PANEL.0 + GAP.0),
            TOP + row * (PANEL.1 + GAP.1),
        );
        panel.draw(&area, at)?;
    }
    area.present()
}

fn heading(area: &Area, accuracy: &ImpulseAccuracy) -> Drawn {
    let title = "Error of loose bodies against the time spent on the whole case";
    text(area, title, (LEFT, 22.0), 17.0, INK, HPos::Left)?;
    let below = format!(
        "dots: 60, 90 and 1000 frames a second, from small to large; dashes: what must hold; \
         errors from 1e-9 to 100; lower left is better; seed {}; {}",
        accuracy.seed, accuracy.machine.cpu
    );
    text(area, &below, (LEFT, 45.0), NORMAL, QUIET, HPos::Left)?;
    let mut x = LEFT;
    for subject in Subject::ALL {
        line(area, &[(x, 72.0), (x + 36.0, 72.0)], colour(subject), 1.5)?;
        for rate in 0..3 {
            dot(
                area,
                (x + 4.0 + 13.0 * rate as f64, 72.0),
                colour(subject),
                rate,
            )?;
        }
        text(
            area,
            subject.name(),
            (x + 46.0, 72.0),
            NORMAL,
            INK,
            HPos::Left,
        )?;
        x += 170.0;
    }
    Ok(())
}
