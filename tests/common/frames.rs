//! Which frame of a scene is typical and which is the heaviest: `benches/frames.txt` has them, so that what
//! counts instructions need not play every scene under an emulator to find out.
#![allow(
    dead_code,
    unreachable_pub,
    reason = "a test and a bench use a part of it"
)]

use std::path::{Path, PathBuf};
use std::{env, fs};

use palpable::frame::FrameReport;

use crate::scenes::Scene;
use crate::watched::{ALL, Named};

/// Names the folder for the states before those frames: playing up to them takes minutes under an emulator.
pub const FOLDER: &str = "PALPABLE_FRAMES";

/// Frames of a scene that are looked at.
pub const FRAMES: u32 = 240;

/// A step of a chain's solver takes about so many times the instructions of another unit.
const REACH_STEP_UNITS: u32 = 4;

/// The checked-in table: name, typical frame, heaviest frame.
pub const RECORDED: &str = include_str!("../../benches/frames.txt");

fn work(report: &FrameReport) -> u32 {
    report.advance_units + report.impulse_units + REACH_STEP_UNITS * report.reach_steps
}

/// The line of a scene: the last frame whose work is the median, and the first with the most.
pub fn line((name, make): Named) -> String {
    let mut scene = make();
    let works: Vec<u32> = (0..FRAMES).map(|_| work(&scene.step())).collect();
    let mut sorted = works.clone();
    sorted.sort_unstable();
    let (median, most) = (sorted[works.len() / 2], sorted[works.len() - 1]);
    let typical = works.iter().rposition(|&work| work == median).unwrap();
    let heaviest = works.iter().position(|&work| work == most).unwrap();
    format!("{name:<22} {typical:4} {heaviest:4}\n")
}

/// The typical and the heaviest frame of a scene, as recorded.
fn recorded(name: &str) -> [u32; 2] {
    let line = RECORDED
        .lines()
        .find(|line| line.starts_with(name))
        .unwrap();
    let mut frames = line[name.len()..].split_whitespace();
    [(); 2].map(|()| frames.next().unwrap().parse().unwrap())
}

fn snapshot_path(folder: &str, name: &str, frame: u32) -> PathBuf {
    Path::new(folder).join(format!("{name} {frame}"))
}

/// Whether all that a scene has is in its world: a snapshot of the host's own engine is not.
fn is_all_in_the_world(name: &str) -> bool {
    name != "hosted box"
}

/// Writes the states before the recorded frames of all scenes into a folder.
pub fn save_all(folder: &str) {
    for (name, make) in ALL {
        for frame in recorded(name) {
            let scene = make().after(frame);
            let mut snapshot = vec![0; scene.world.snapshot_bytes()];
            scene.world.save(&mut snapshot).unwrap();
            fs::write(snapshot_path(folder, name, frame), snapshot).unwrap();
        }
    }
}

/// A scene before a recorded frame, from the folder that [`FOLDER`] names.
fn before(name: &str, frame: u32) -> Scene {
    let (_, make) = ALL.iter().find(|(known, _)| *known == name).unwrap();
    if !is_all_in_the_world(name) {
        return make().after(frame);
    }
    let folder = env::var(FOLDER).unwrap();
    let snapshot = fs::read(snapshot_path(&folder, name, frame)).unwrap();
    let mut scene = make();
    scene.world.load(&snapshot).unwrap();
    scene.frame = frame;
    scene
}

pub fn before_typical(name: &str) -> Scene {
    before(name, recorded(name)[0])
}

pub fn before_heaviest(name: &str) -> Scene {
    before(name, recorded(name)[1])
}
