//! What a run of the lab leaves behind: terminal tables, `report.json`, frame-time figures and
//! `index.html`.
//!
//! The data model holds measured numbers only; everything here is a pure function of a
//! [`Report`], except [`write()`], which writes files, and [`Machine::detect`], which asks the
//! machine for its name. Times are in microseconds and lengths in millimetres, as the field names
//! say.

mod data;
mod figure;
mod figures;
mod format;
mod html;
mod joints;
mod joints_html;
mod joints_table;
mod json;
mod labels;
mod machine;
mod palette;
mod plan;
mod series;
mod sheet;
mod table;

use std::io;
use std::path::Path;

pub use data::{
    BALL_OVERLAP_MM_MAX, Ball, FrameSample, HAND_FIXED_OVERLAP_MM_MAX, HandCoverage, Machine,
    Phase, Quantiles, Report, Run, Slaps,
};
pub use figure::frame_time_svg;
pub use figures::{
    ArmSlaps, BEYOND_LIMITS_RAD_MAX, FigureFrame, FigureScene, FirstContact, Rest,
    WRIST_OFF_MM_MAX, Wrist,
};
pub use html::index_html;
pub use joints::joints_svg;
pub use joints_table::tables as figure_tables;
pub use json::to_json;
pub use table::table;

/// Writes `report.json`, `frame-time-<slug>.svg` for each run, `joints-<slug>.svg`
/// for each scene of a figure, and `index.html` into `out_dir`,
/// creating it if needed.
///
/// Files of these names are replaced, others are left alone.
///
/// # Errors
/// The first file-system error, or [`io::ErrorKind::InvalidData`] before anything is written if a
/// number in the report is not finite (JSON has no word for it).
pub fn write(report: &Report, out_dir: &Path) -> io::Result<()> {
    let json = to_json(report)?;
    std::fs::create_dir_all(out_dir)?;
    std::fs::write(out_dir.join("report.json"), json)?;
    for (run, slug) in report.runs.iter().zip(report.slugs()) {
        std::fs::write(out_dir.join(figure_file_name(&slug)), frame_time_svg(run))?;
    }
    for (scene, slug) in report.figures.iter().zip(report.figure_slugs()) {
        std::fs::write(out_dir.join(joints_file_name(&slug)), joints_svg(scene))?;
    }
    std::fs::write(out_dir.join("index.html"), index_html(report))
}

/// Writes `joints-<slug>.svg` of one scene into `out_dir`, creating it if needed; the file's path.
///
/// # Errors
/// The first file-system error.
pub fn write_joints(scene: &FigureScene, out_dir: &Path) -> io::Result<std::path::PathBuf> {
    std::fs::create_dir_all(out_dir)?;
    let path = out_dir.join(joints_file_name(&scene.slug()));
    std::fs::write(&path, joints_svg(scene))?;
    Ok(path)
}

fn joints_file_name(slug: &str) -> String {
    format!("joints-{slug}.svg")
}

fn figure_file_name(slug: &str) -> String {
    format!("frame-time-{slug}.svg")
}

#[cfg(test)]
mod sample;
#[cfg(test)]
mod tests;
