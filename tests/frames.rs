//! `benches/frames.txt` names the typical and the heaviest frame of every scene. Where it does not, write it
//! anew with
//!
//! ```text
//! PALPABLE_UPDATE_FRAMES=1 cargo test --test frames
//! ```
//!
//! With `PALPABLE_FRAMES=FOLDER` it writes the states before those frames for `benches/instructions.rs`.

mod common;
#[path = "common/frames.rs"]
mod frames;
#[path = "common/scenes.rs"]
mod scenes;
#[path = "common/watched.rs"]
mod watched;

use std::path::Path;
use std::{env, fs};

#[test]
fn the_recorded_frames_are_the_typical_and_the_heaviest_ones() {
    let found: String = watched::ALL.into_iter().map(frames::line).collect();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/frames.txt");
    if env::var_os("PALPABLE_UPDATE_FRAMES").is_some_and(|value| value == "1") {
        fs::write(&path, &found).unwrap();
    }
    assert_eq!(found, fs::read_to_string(&path).unwrap());
    if let Ok(folder) = env::var(frames::FOLDER) {
        frames::save_all(&folder);
    }
}
