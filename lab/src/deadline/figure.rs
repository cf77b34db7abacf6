//! The figure: error against the frame's time.

use plotters::backend::SVGBackend;
use plotters::chart::ChartBuilder;
use plotters::coord::combinators::IntoLogRange;
use plotters::drawing::{DrawingAreaErrorKind, IntoDrawingArea};
use plotters::element::{Circle, PathElement, Text};
use plotters::style::{Color, RGBColor, WHITE};

use super::play::Outcome;
use super::trials::Trial;

const SIZE: (u32, u32) = (960, 560);

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

/// Mean distance of the published poses from those of the run without a deadline, over the deadline, a
/// curve for each trial; a stand-alone SVG.
///
/// # Errors
/// When the drawing cannot be made.
pub fn error_svg(outcomes: &[Outcome]) -> Result<String, DrawingAreaErrorKind<std::io::Error>> {
    let mut drawing = String::new();
    {
        let area = SVGBackend::with_string(&mut drawing, SIZE).into_drawing_area();
        area.fill(&WHITE)?;
        let most = outcomes
            .iter()
            .fold(1.0, |most: f64, outcome| most.max(outcome.error_mm_mean));
        let cut = outcomes
            .iter()
            .filter(|outcome| outcome.deadline_us.is_some());
        let least = cut.fold(most, |least: f64, outcome| {
            least.min(outcome.error_mm_mean.max(LEAST_MM))
        });
        let mut chart = ChartBuilder::on(&area)
            .caption(
                "distance of the driven pieces from the run without a deadline",
                ("sans-serif", 20),
            )
            .margin(16)
            .margin_right(220)
            .x_label_area_size(44)
            .y_label_area_size(72)
            .build_cartesian_2d(
                (40.0..1250.0).log_scale(),
                // From one power of ten to another, so that the axis has labels.
                (10_f64.powf(least.log10().floor())..10_f64.powf(most.log10().ceil())).log_scale(),
            )?;
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
        let mut row = 0;
        for (index, trial) in Trial::ALL.into_iter().enumerate() {
            let points: Vec<(f64, f64)> = outcomes
                .iter()
                .filter(|outcome| outcome.trial == trial.name())
                .filter_map(|outcome| {
                    let us = f64::from(outcome.deadline_us?);
                    Some((us, outcome.error_mm_mean.max(LEAST_MM)))
                })
                .collect();
            if points.is_empty() {
                continue;
            }
            let colour = COLOURS[index % COLOURS.len()];
            chart.draw_series([PathElement::new(points.clone(), colour.stroke_width(2))])?;
            let y = 60 + 22 * row;
            row += 1;
            let swatch = vec![(756, y), (780, y)];
            area.draw(&PathElement::new(swatch, colour.stroke_width(3)))?;
            area.draw(&Text::new(trial.name(), (788, y - 8), ("sans-serif", 14)))?;
            chart.draw_series(
                points
                    .into_iter()
                    .map(|at| Circle::new(at, 4, colour.filled())),
            )?;
        }
        area.present()?;
    }
    Ok(drawing)
}
