//! The figures: overlap and displacement over time, and frame times.

use plotters::style::text_anchor::HPos;

use super::canvas::{
    COLOURS, Canvas, Drawn, GRID, INK, LARGE, NORMAL, QUIET, SMALL, Spot, document,
};
use super::scenes::Scene;
use super::setting::RATE_HZ;
use super::summary::{Comparison, Curve};
use crate::report::Quantiles;

const WIDTH: f64 = 960.0;
const LEFT: f64 = 72.0;
const RIGHT: f64 = 930.0;

/// A panel's range of y in pixels.
struct Panel {
    top: f64,
    bottom: f64,
}

const OVERLAP: Panel = Panel {
    top: 120.0,
    bottom: 300.0,
};
const DISPLACEMENT: Panel = Panel {
    top: 350.0,
    bottom: 530.0,
};

/// Overlap and displacement of the first tracker over time, on all engines, as a stand-alone SVG.
#[must_use]
pub fn curves_svg(found: &Comparison, scene: Scene) -> String {
    let curves: Vec<&Curve> = found
        .curves
        .iter()
        .filter(|curve| curve.scene == scene.name())
        .collect();
    document(scene.name(), (WIDTH, 580.0), |canvas| {
        canvas.text(scene.name(), (LEFT, 24.0), LARGE, INK, HPos::Left)?;
        let machine = format!("first tracker of seed {}, 90 Hz", found.seed);
        canvas.text(&machine, (LEFT, 46.0), NORMAL, QUIET, HPos::Left)?;
        canvas.legend((LEFT, 72.0))?;
        let overlaps = curves.iter().map(|c| (c.engine, &c.overlap_mm[..]));
        panel(
            canvas,
            &OVERLAP,
            "deepest overlap of a hand with anything [mm]",
            &overlaps.collect::<Vec<_>>(),
        )?;
        let displacements = curves.iter().map(|c| (c.engine, &c.displacement_mm[..]));
        panel(
            canvas,
            &DISPLACEMENT,
            "distance from hand to tracker [mm]",
            &displacements.collect::<Vec<_>>(),
        )?;
        let middle = 0.5 * (LEFT + RIGHT);
        canvas.text(
            "time [s]",
            (middle, DISPLACEMENT.bottom + 36.0),
            SMALL,
            QUIET,
            HPos::Center,
        )
    })
}

/// A multiple of 1, 2 or 5 times a power of ten that goes into `most` at most five times.
fn step_for(most: f64) -> f64 {
    let least = (most / 5.0).max(1e-6);
    let decade = 10f64.powf(least.log10().floor());
    let factors = [1.0, 2.0, 5.0, 10.0];
    let fits = factors.into_iter().find(|f| f * decade >= least);
    fits.unwrap_or(10.0) * decade
}

fn panel(canvas: &Canvas, panel: &Panel, title: &str, curves: &[(usize, &[f64])]) -> Drawn {
    canvas.text(title, (LEFT, panel.top - 14.0), NORMAL, INK, HPos::Left)?;
    let all = curves.iter().flat_map(|(_, values)| values.iter().copied());
    let most = 1.05 * all.fold(1e-3, f64::max);
    let frames = curves.iter().map(|(_, values)| values.len()).max();
    let seconds = (frames.unwrap_or(1) as f64 / f64::from(RATE_HZ)).max(1e-3);
    let y = |value: f64| panel.bottom - (panel.bottom - panel.top) * value / most;
    let x = |second: f64| LEFT + (RIGHT - LEFT) * second / seconds;
    let step = step_for(most);
    for tick in 0..=(most / step) as u32 {
        let value = step * f64::from(tick);
        canvas.line(&[(LEFT, y(value)), (RIGHT, y(value))], GRID, 1.0)?;
        let decimals = (-step.log10().floor()).max(0.0) as usize;
        let name = format!("{value:.decimals$}");
        canvas.text(&name, (LEFT - 8.0, y(value)), SMALL, QUIET, HPos::Right)?;
    }
    let step = step_for(seconds).max(1.0);
    for tick in 0..=(seconds / step) as u32 {
        let second = step * f64::from(tick);
        let ends = [(x(second), panel.top), (x(second), panel.bottom)];
        canvas.line(&ends, GRID, 1.0)?;
        let below = (x(second), panel.bottom + 13.0);
        canvas.text(&second.to_string(), below, SMALL, QUIET, HPos::Center)?;
    }
    // The kernel last, so that it lies on top where curves meet.
    for (engine, values) in curves.iter().rev() {
        let at = |(frame, &value): (usize, &f64)| (x(frame as f64 / f64::from(RATE_HZ)), y(value));
        let points: Vec<Spot> = values.iter().enumerate().map(at).collect();
        canvas.line(&points, COLOURS[*engine], 1.75)?;
    }
    Ok(())
}

/// Where the times' axis begins, in pixels, and its range in microseconds.
const TIMES_LEFT: f64 = 260.0;
const TIMES_TOP: f64 = 110.0;
const SCENE_PX: f64 = 58.0;
const RANGE_US: (f64, f64) = (0.1, 100_000.0);

/// Frame times of all scenes and engines as a stand-alone SVG: median, and a line to the 99th percentile
/// and a tick at the largest.
#[must_use]
pub fn times_svg(found: &Comparison) -> String {
    let bottom = TIMES_TOP + SCENE_PX * found.times.len() as f64;
    document("frame times", (WIDTH, bottom + 54.0), |canvas| {
        let title = "Frame time [µs], logarithmic: dot median, line to p99, tick largest";
        canvas.text(title, (24.0, 24.0), LARGE, INK, HPos::Left)?;
        let machine = format!("CPU time of the thread, {}", found.machine.cpu);
        canvas.text(&machine, (24.0, 46.0), NORMAL, QUIET, HPos::Left)?;
        canvas.legend((24.0, 76.0))?;
        draw_decades(canvas, bottom)?;
        for (index, row) in found.times.iter().enumerate() {
            let top = TIMES_TOP + SCENE_PX * index as f64;
            let middle = (24.0, top + 0.5 * SCENE_PX);
            canvas.text(row.scene, middle, NORMAL, INK, HPos::Left)?;
            for (engine, times) in row.found.iter().enumerate() {
                if let Some(times) = times {
                    let y = top + SCENE_PX * (engine as f64 + 1.0) / 4.0;
                    draw_times(canvas, engine, times, y)?;
                }
            }
            canvas.line(&[(24.0, top), (RIGHT, top)], GRID, 1.0)?;
        }
        let middle = (0.5 * (TIMES_LEFT + RIGHT), bottom + 36.0);
        canvas.text("µs a frame", middle, SMALL, QUIET, HPos::Center)
    })
}

fn across(us: f64) -> f64 {
    let (least, most) = RANGE_US;
    let share = (us.max(least) / least).log10() / (most / least).log10();
    TIMES_LEFT + (RIGHT - TIMES_LEFT) * share.min(1.0)
}

fn draw_decades(canvas: &Canvas, bottom: f64) -> Drawn {
    let mut us = RANGE_US.0;
    while us <= RANGE_US.1 * 1.001 {
        let x = across(us);
        canvas.line(&[(x, TIMES_TOP), (x, bottom)], GRID, 1.0)?;
        let name = if us < 0.5 {
            "0.1".to_owned()
        } else {
            format!("{us:.0}")
        };
        canvas.text(&name, (x, bottom + 14.0), SMALL, QUIET, HPos::Center)?;
        us *= 10.0;
    }
    Ok(())
}

fn draw_times(canvas: &Canvas, engine: usize, times: &Quantiles, y: f64) -> Drawn {
    let colour = COLOURS[engine];
    let [median, p99, max] = [times.median, times.p99, times.max].map(across);
    canvas.line(&[(median, y), (p99, y)], colour, 2.0)?;
    canvas.line(&[(max, y - 4.0), (max, y + 4.0)], colour, 2.0)?;
    canvas.dot((median, y), 4.0, colour)
}
