//! Equal calls give equal bits on every processor and at every optimisation level: promise P5.
//!
//! `golden.txt` is a table that a person can read: scene, frames stepped, contacts, where the body
//! that matters is, and the hash of the whole state. The hash is what must be equal; the columns
//! before it say what was going on where it first is not. A table that differs is a changed answer:
//! look at the positions, and when the change is meant, write it anew with
//!
//! ```text
//! PALPABLE_UPDATE_GOLDENS=1 cargo test --test golden
//! ```
//!
//! What is not promised: equal bits between versions of this library.

mod common;
#[path = "common/scenes.rs"]
mod scenes;

use std::fmt::Write;
use std::path::Path;
use std::{env, fs};

use scenes::Scene;

/// Frames of each scene.
const FRAMES: u32 = 270;

/// Frames between two lines of a scene.
const FRAMES_PER_LINE: u32 = 30;

type NamedScene = (&'static str, fn() -> Scene);

const SCENES: [NamedScene; 5] = [
    ("falling sphere", scenes::falling_sphere),
    ("pushed stack", scenes::pushed_stack),
    ("sliding hand", scenes::sliding_hand),
    ("compound in a corner", scenes::compound_in_a_corner),
    ("two arms", scenes::two_arms),
];

const HEAD: &str = "\
scene                 frame contacts      x mm      y mm      z mm  state hash
";

fn line(name: &str, scene: &Scene) -> String {
    let [x, y, z] = scene.world.pose(scene.shown).unwrap().position;
    let mm = |metres: f32| format!("{:9.3}", 1e3 * f64::from(metres));
    format!(
        "{name:<21} {:5} {:8} {} {} {}  {:016x}\n",
        scene.frame,
        scene.world.contacts().len(),
        mm(x),
        mm(y),
        mm(z),
        scene.world.hash(),
    )
}

fn table() -> String {
    let mut text = HEAD.to_owned();
    for (name, make) in SCENES {
        let mut scene = make();
        for _ in 0..FRAMES / FRAMES_PER_LINE {
            scene = scene.after(FRAMES_PER_LINE);
            text.write_str(&line(name, &scene)).unwrap();
        }
    }
    text
}

#[test]
fn the_bits_are_the_checked_in_ones() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden.txt");
    let found = table();
    if env::var_os("PALPABLE_UPDATE_GOLDENS").is_some_and(|value| value == "1") {
        fs::write(&path, &found).unwrap();
    }
    let expected = fs::read_to_string(&path).unwrap();
    for (found, expected) in found.lines().zip(expected.lines()) {
        assert_eq!(found, expected, "the first line that differs");
    }
    assert_eq!(found.lines().count(), expected.lines().count());
}

#[test]
fn the_same_calls_in_one_process_give_the_same_bits() {
    // Memory that was used before, and other addresses, must not matter.
    for (name, make) in SCENES {
        let (first, second) = (make().after(90), make().after(90));
        assert_eq!(first.world.hash(), second.world.hash(), "{name}");
    }
}

#[test]
fn every_scene_touches_something() {
    // A golden of things in free air would hold very little of the kernel still.
    for (name, make) in SCENES {
        let mut scene = make();
        let touched = (0..FRAMES).any(|_| scene.step().contacts > 0);
        assert!(touched, "{name}");
    }
}
