//! The kernel beside what engines do for hands today: a dynamic body of the same convex parts, pulled to
//! the tracker. Same scenes, same trackers, same judge, same run.

pub mod arm;
mod canvas;
pub mod drive;
mod figure;
pub mod grip;
pub mod judging;
pub mod kernel;
pub mod measures;
pub mod peer;
pub mod peer_arm;
pub mod play;
pub mod run;
pub mod scenes;
pub mod setting;
pub mod slaps;
pub mod summary;
mod table;

use std::io;
use std::path::Path;

pub use figure::{curves_svg, times_svg};
pub use run::{ComparePlan, run};
pub use summary::Comparison;
pub use table::tables;

/// Writes `compare.json` and the figures, `compare-SCENE.svg` and `compare-times.svg`, into a folder.
///
/// # Errors
/// What the file system says.
pub fn write(found: &Comparison, folder: &Path) -> io::Result<()> {
    std::fs::create_dir_all(folder)?;
    let json = serde_json::to_string_pretty(found).map_err(io::Error::other)?;
    std::fs::write(folder.join("compare.json"), json + "\n")?;
    for scene in run::DRAWN {
        let file = format!("compare-{scene:?}.svg").to_lowercase();
        std::fs::write(folder.join(file), curves_svg(found, scene))?;
    }
    std::fs::write(folder.join("compare-times.svg"), times_svg(found))
}
