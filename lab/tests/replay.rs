//! What the lab records is replayed to the same states, and a run that went another way is found out.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::{Arc, Mutex};
use std::{env, fs};

use palpable::frame::FrameInput;
use palpable::math::Pose;
use palpable::memory::Capacities;
use palpable::recording::{CallKind, ReplayError};
use palpable::state::bodies::BodyKind;
use palpable::world::{BodyDef, PieceDef, Shape, World};
use palpable_lab::hand::Hand;
use palpable_lab::memory::Block;
use palpable_lab::replay::{Verdict, replay};
use palpable_lab::report::Ball;
use palpable_lab::run::{RunPlan, run, run_into};

const PLAN: RunPlan = RunPlan {
    ball: Ball::Sphere,
    noise: true,
    frames: 400,
};

#[test]
fn a_recorded_run_is_replayed_to_the_same_state() {
    let hand = Hand::load().unwrap();
    let mut log = Vec::new();
    let mut sink = |bytes: &[u8]| log.extend_from_slice(bytes);
    let (recorded, _) = run_into(&hand, &PLAN, Some(&mut sink), || ()).unwrap();
    let (plain, _) = run(&hand, &PLAN, || ()).unwrap();
    assert_eq!(recorded.state_hash, plain.state_hash);
    let mut ticks = 0;
    let verdict = replay(&log, || ticks += 1).unwrap();
    assert!(verdict.is_equal(), "{verdict}");
    assert_eq!((verdict.frames, ticks), (400, 400));
    let last = log.len() - 1;
    let cut = replay(&log[..last], || ()).unwrap_err();
    assert!(matches!(cut, ReplayError::CutShort { at } if at < last));
}

/// A ball falls for 20 frames. Before frame 8 somebody changes gravity behind the log's back.
fn log_with_a_gap() -> Vec<u8> {
    let log = Arc::new(Mutex::new(Vec::new()));
    let sink = || {
        let log = Arc::clone(&log);
        move |bytes: &[u8]| log.lock().unwrap().extend_from_slice(bytes)
    };
    let (mut first, mut second) = (sink(), sink());
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    world.record_to(&mut first);
    let def = BodyDef::new(BodyKind::Dynamic, Pose::at(0.0, 2.0, 0.0));
    let ball = world.add_body(&def).unwrap();
    let sphere = PieceDef::new(Shape::Point, 0.1);
    world.add_piece(ball, &sphere).unwrap();
    let frames = |world: &mut World, frames: u32| {
        for _ in 0..frames {
            world.apply_force(ball, [1.0, 0.0, 0.0], [0.0; 3]).unwrap();
            world.apply_force(ball, [0.0, 0.0, 1.0], [0.0; 3]).unwrap();
            world.step(&FrameInput::unlimited(1.0 / 90.0));
        }
    };
    frames(&mut world, 7);
    world.stop_recording();
    world.set_gravity([0.0, -9.0, 0.0]);
    world.record_on(&mut second);
    frames(&mut world, 13);
    drop((first, second));
    Arc::into_inner(log).unwrap().into_inner().unwrap()
}

#[test]
fn the_first_frame_that_went_another_way_is_named() {
    let verdict = replay(&log_with_a_gap(), || ()).unwrap();
    let Verdict {
        calls,
        frames,
        first_call,
        first_frame,
    } = verdict;
    let other = first_frame.unwrap();
    // Two calls make the ball; three are a frame.
    assert_eq!((calls, frames), (2 + 8 * 3, 8));
    assert_eq!((other.step.frame, other.step.call), (8, calls));
    assert_eq!(first_call, Some(other.step));
    assert_ne!(other.step.recorded.value(), other.step.replayed.value());
    let since: Vec<_> = other.since.iter().map(|made| made.kind).collect();
    assert_eq!(since, [CallKind::ApplyForce; 2]);
}

fn scratch(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

fn lab(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_palpable-lab"));
    command.args(arguments).output().unwrap()
}

fn printed(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn the_command_tells_by_its_exit_code() {
    let file = scratch("gap.palplog");
    let mut log = log_with_a_gap();
    fs::write(&file, &log).unwrap();
    let name = file.to_str().unwrap();
    let output = lab(&["replay", name]);
    assert_eq!(output.status.code(), Some(1));
    let text = printed(&output);
    assert!(text.contains("frame 8 is the first"), "{text}");
    assert!(text.contains("by call 26"), "{text}");
    assert!(
        text.contains("calls since the frame before: 2 apply_force"),
        "{text}"
    );
    assert_eq!(text.matches("  recorded hash ").count(), 2, "{text}");
    // A byte of the state at the start.
    log[500] ^= 1;
    fs::write(&file, &log).unwrap();
    let output = lab(&["replay", name]);
    assert_eq!(output.status.code(), Some(1));
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(text.contains("what begins at byte 60 is damaged"), "{text}");
}

#[test]
fn the_command_records_a_run_that_it_replays() {
    let (file, out) = (scratch("run.palplog"), scratch("recorded"));
    let (file, out) = (file.to_str().unwrap(), out.to_str().unwrap());
    let run = ["--frames", "120", "--out", out, "--record", file];
    let output = lab(&[&["--scene", "hull"][..], &run].concat());
    assert!(output.status.success(), "{output:?}");
    let output = lab(&["replay", file]);
    let text = printed(&output);
    assert!(output.status.success(), "{text}");
    assert!(text.contains("120 frames: equal"), "{text}");
    let several = lab(&[&["--scene", "all"][..], &run].concat());
    assert_eq!(several.status.code(), Some(1));
}
