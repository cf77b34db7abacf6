//! Equal calls give equal bits on every processor and at every optimisation level: promise P5.
//!
//! `golden.txt` is a table that a person can read: scene, budget, frames stepped, contacts, where the
//! body that matters is, and the hash of the whole state. The hash is what must be equal; the columns
//! before it say what was going on where it first is not. A table that differs is a changed answer:
//! look at the positions, and when the change is meant, write it anew with
//!
//! ```text
//! PALPABLE_UPDATE_GOLDENS=1 cargo test --test golden
//! ```
//!
//! The budgets are `common/table.rs`'s: as much as is wanted, few units for each stage, none at all from
//! frame 60 on, and a deadline by made-up prices. `.ci/run` compares the same table with builds for
//! other processors: x86-64 with and without newer instructions, optimised and not, 64-bit Arm, and
//! WebAssembly.
//!
//! What is not promised: equal bits between versions of this library.

mod common;
#[path = "common/scenes.rs"]
mod scenes;
#[path = "common/table.rs"]
mod table;
#[path = "common/watched.rs"]
mod watched;

use std::path::Path;
use std::{env, fs};

use table::table;
use watched::ALL;

/// The most lines that a person would still look through.
const LINES_MAX: usize = 150;

fn checked_in() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden.txt");
    fs::read_to_string(path).unwrap()
}

#[test]
fn the_bits_are_the_checked_in_ones() {
    let found = table();
    if env::var_os("PALPABLE_UPDATE_GOLDENS").is_some_and(|value| value == "1") {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden.txt");
        fs::write(path, &found).unwrap();
    }
    let expected = checked_in();
    for (found, expected) in found.lines().zip(expected.lines()) {
        assert_eq!(found, expected, "the first line that differs");
    }
    assert_eq!(found.lines().count(), expected.lines().count());
    assert!(found.lines().count() <= LINES_MAX);
}

#[test]
fn the_same_calls_in_one_process_give_the_same_bits() {
    // Memory that was used before, and other addresses, must not matter.
    for (name, make) in ALL {
        let (first, second) = (make().after(90), make().after(90));
        assert_eq!(first.world.hash(), second.world.hash(), "{name}");
    }
}

#[test]
fn every_scene_touches_something() {
    // A golden of things in free air would hold very little of the kernel still.
    for (name, make) in ALL {
        let mut scene = make();
        let touched = (0..240).any(|_| {
            let report = scene.step();
            report.contacts > 0 || report.impulses > 0
        });
        assert!(touched, "{name}");
    }
}

/// Whether a budget cuts a scene: the hash after 120 frames is not the unlimited one's.
fn is_cut(text: &str, name: &str, budget: &str) -> bool {
    let hash = |budget: &str| {
        let starts = format!("{name:<22} {budget:<9} {:5} ", 120);
        let found = text.lines().find(|line| line.starts_with(&starts));
        found
            .map(|line| line[line.len() - 16..].to_owned())
            .unwrap()
    };
    hash(budget) != hash("unlimited")
}

#[test]
fn every_budget_cuts_most_scenes() {
    // A budget that changes nothing would hold nothing that the unlimited one does not.
    let text = checked_in();
    for budget in ["scarce", "zero", "deadline"] {
        let cut = ALL.iter().filter(|(name, _)| is_cut(&text, name, budget));
        let count = cut.count();
        assert!(2 * count > ALL.len(), "{budget} cuts {count} scenes");
    }
}
