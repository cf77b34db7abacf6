//! The figure: error against the frame's time.

use plotters::backend::SVGBackend;
use plotters::chart::ChartBuilder;
use plotters::coord::Shift;
use plotters::coord::combinators::IntoLogRange;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind, IntoDrawingArea};
use plotters::element::{Circle, PathElement, Text};
use plotters::style::{Color, RGBColor, WHITE};

use super::errors::{Distances, LocalError, Overall};
use super::local::HORIZONS;
use super::play::Outcome;
use super::trials::Trial;

const SIZE: (u32, u32) = (1240, 520);

/// Errors below this are drawn at it, in millimetres.
const LEAST_MM: f64 = 1e-4;

/// Deadlines that the axis names, in microseconds.
const NAMED_US: [f64; 4] = [100.0, 200.0, 500.0, 1000.0];

const COLOURS: [RGBColor; 6] = [
    RGBColor(0x1F, 0x4E, 0x79),
    RGBColor(0xD0, 0x8A, 0x2C),
    RGBColor(0xB0, 0x41, 0x6E),
    RGBColor(0x3B, 0x7A, 0x57),
    RGBColor(0x6B, 0x5B, 0x95),
    RGBColor(0x55, 0x5F, 0x68),
];

/// The curve over all trials.
const OVERALL: RGBColor = RGBColor(0x11, 0x11, 0x11);

/// Pixels for the legend below the panels.
const LEGEND: i32 = 34;

/// A mean error at a deadline: microseconds and millimetres.
type Spot = (f64, f64);
/// A panel's title, and a curve for each trial and over all.
type Panel = (String, Vec<Vec<Spot>>);
type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;

/// Names and colours of the curves of a panel, in their order.
fn curves() -> impl Iterator<Item = (&'static str, RGBColor, u32)> {
    let trials = Trial::ALL.into_iter().zip(COLOURS);
    let thin = trials.map(|(trial, colour)| (trial.name(), colour, 2));
    thin.chain([("all", OVERALL, 4)])
}

/// The panels: of each horizon, and of whole runs.
fn panels(outcomes: &[Outcome], overall: &[Overall]) -> Vec<Panel> {
    let panel = |title: String, local: &dyn Fn(&[LocalError]) -> Option<f64>| {
        let mean = |errors: &[LocalError], run: &Distances| {
            let mm = local(errors).unwrap_or(run.mean_mm);
            mm.max(LEAST_MM)
        };
        let of_trial = |trial: Trial| {
            let of_it = outcomes.iter().filter(move |at| at.trial == trial.name());
            let spot = |at: &Outcome| {
                let us = f64::from(at.deadline_us?);
                Some((us, mean(&at.local_errors, &at.run_error)))
            };
            of_it.filter_map(spot).collect()
        };
        let spot = |at: &Overall| {
            let us = f64::from(at.deadline_us);
            (us, mean(&at.local_errors, &at.run_error))
        };
        let all = overall.iter().map(spot).collect();
        let curves = Trial::ALL.into_iter().map(of_trial).chain([all]);
        (title, curves.collect())
    };
    let [soon, later] = HORIZONS;
    vec![
        panel(format!("{soon} frame from the same state"), &|errors| {
            Some(errors.first()?.driven.mean_mm)
        }),
        panel(format!("{later} frames from the same state"), &|errors| {
            Some(errors.get(1)?.driven.mean_mm)
        }),
        panel("whole runs".to_owned(), &|_| None),
    ]
}

/// Mean distance of the driven pieces from where they are without a deadline, over the deadline: a panel
/// for a frame from the same state, for a few, and for whole runs, and in each a curve for every trial and
/// one over all; a stand-alone SVG.
///
/// # Errors
/// When the drawing cannot be made.
pub fn error_svg(
    outcomes: &[Outcome],
    overall: &[Overall],
) -> Result<String, DrawingAreaErrorKind<std::io::Error>> {
    let panels = panels(outcomes, overall);
    let (mut least, mut most) = (f64::MAX, LEAST_MM);
    for &(_, mm) in panels.iter().flat_map(|(_, curves)| curves).flatten() {
        (least, most) = (least.min(mm), most.max(mm));
    }
    // From one power of ten to another, so that the axis has labels.
    let bottom = 10_f64.powf(least.min(most).log10().floor());
    let top = 10_f64.powf(most.log10().ceil()).max(10.0 * bottom);
    let mut drawing = String::new();
    {
        let area = SVGBackend::with_string(&mut drawing, SIZE).into_drawing_area();
        area.fill(&WHITE)?;
        let area = area.titled(
            "mean distance of driven pieces from where they are without a deadline",
            ("sans-serif", 20),
        )?;
        let (charts, legend) = area.split_vertically(area.dim_in_pixel().1 as i32 - LEGEND);
        for (part, panel) in charts.split_evenly((1, panels.len())).iter().zip(&panels) {
            draw_panel(part, panel, bottom..top)?;
        }
        draw_legend(&legend, &panels)?;
        area.present()?;
    }
    Ok(drawing)
}

fn draw_panel(
    area: &DrawingArea<SVGBackend, Shift>,
    (title, spots): &Panel,
    mm: std::ops::Range<f64>,
) -> Drawn {
    let mut chart = ChartBuilder::on(area)
        .caption(title, ("sans-serif", 16))
        .margin(8)
        .x_label_area_size(40)
        .y_label_area_size(64)
        .build_cartesian_2d((40.0..1250.0).log_scale(), mm.log_scale())?;
    chart
        .configure_mesh()
        .x_desc("deadline of a frame [us]")
        .y_desc("mean distance [mm]")
        .x_label_formatter(&|us: &f64| {
            let is_named = NAMED_US.contains(us);
            if is_named {
                format!("{us:.0}")
            } else {
                String::new()
            }
        })
        .y_label_formatter(&|mm: &f64| format!("{mm}"))
        .light_line_style(WHITE)
        .draw()?;
    for ((_, colour, width), spots) in curves().zip(spots) {
        let line = PathElement::new(spots.clone(), colour.stroke_width(width));
        chart.draw_series([line])?;
        let marks = spots.iter().map(|&at| Circle::new(at, 4, colour.filled()));
        chart.draw_series(marks)?;
    }
    Ok(())
}

/// Names the curves that the panels have, in one line.
fn draw_legend(area: &DrawingArea<SVGBackend, Shift>, panels: &[Panel]) -> Drawn {
    let mut x = 72;
    for (index, (name, colour, width)) in curves().enumerate() {
        if panels.iter().all(|(_, curves)| curves[index].is_empty()) {
            continue;
        }
        let swatch = vec![(x, 12), (x + 24, 12)];
        area.draw(&PathElement::new(swatch, colour.stroke_width(width)))?;
        area.draw(&Text::new(name, (x + 30, 5), ("sans-serif", 14)))?;
        x += 56 + 7 * name.len() as i32;
    }
    Ok(())
}
