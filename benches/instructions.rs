//! How many instructions things take, counted by valgrind: the same on a busy machine.
//!
//! Goals: a change that makes something dearer is seen on the day it is made, and a scene pays only
//! for what it uses (promise P7). Not a goal: time. Counts know nothing of caches and of instructions
//! that wait for each other; `stages.rs` measures that.
//!
//! `benches/instructions.limits` holds the counts that were agreed on, and
//! `.ci/instruction_limits.py` compares: it says how to run this and how to write the counts anew.
//! Frames are counted ten at a time, because one frame can be lucky.
#![allow(missing_docs, reason = "the macros make public items")]

#[path = "../tests/common/mod.rs"]
mod common;
#[path = "../tests/common/pairs.rs"]
mod pairs;
#[path = "../tests/common/scenes.rs"]
mod scenes;

use std::hint::black_box;

use iai_callgrind::{library_benchmark, library_benchmark_group, main};
use palpable::geometry::penetration::{CorePenetration, core_penetration};
use palpable::geometry::separation::Separation;

use pairs::{APART_M, Class, Pair, SHALLOW_M};
use scenes::Scene;

#[library_benchmark]
#[bench::boxes_apart(Class::Boxes.at_gap(APART_M))]
#[bench::boxes_shallow(Class::Boxes.at_gap(SHALLOW_M))]
#[bench::hulls_of_12_apart(Class::Hulls12.at_gap(APART_M))]
#[bench::hulls_of_12_shallow(Class::Hulls12.at_gap(SHALLOW_M))]
#[bench::hulls_of_32_apart(Class::Hulls32.at_gap(APART_M))]
#[bench::hulls_of_32_shallow(Class::Hulls32.at_gap(SHALLOW_M))]
#[bench::fingers_apart(Class::Fingers.at_gap(APART_M))]
#[bench::fingers_shallow(Class::Fingers.at_gap(SHALLOW_M))]
#[bench::slab_and_finger_apart(Class::SlabAndFinger.at_gap(APART_M))]
#[bench::slab_and_finger_shallow(Class::SlabAndFinger.at_gap(SHALLOW_M))]
fn cold(pair: Pair) -> Separation {
    black_box(pair).ask()
}

#[library_benchmark]
#[bench::boxes_apart(Class::Boxes.at_gap(APART_M))]
#[bench::boxes_shallow(Class::Boxes.at_gap(SHALLOW_M))]
#[bench::hulls_of_12_apart(Class::Hulls12.at_gap(APART_M))]
#[bench::hulls_of_12_shallow(Class::Hulls12.at_gap(SHALLOW_M))]
#[bench::hulls_of_32_apart(Class::Hulls32.at_gap(APART_M))]
#[bench::hulls_of_32_shallow(Class::Hulls32.at_gap(SHALLOW_M))]
#[bench::fingers_apart(Class::Fingers.at_gap(APART_M))]
#[bench::fingers_shallow(Class::Fingers.at_gap(SHALLOW_M))]
#[bench::slab_and_finger_apart(Class::SlabAndFinger.at_gap(APART_M))]
#[bench::slab_and_finger_shallow(Class::SlabAndFinger.at_gap(SHALLOW_M))]
fn warm(pair: Pair) -> Separation {
    black_box(pair).ask_again()
}

#[library_benchmark]
#[bench::hulls_of_32(Class::Hulls32.at_gap(SHALLOW_M))]
fn enumeration(pair: Pair) -> CorePenetration {
    let Pair { a, b, poses, .. } = black_box(pair);
    core_penetration(&a, &b, &poses[0].seen_from(&poses[1]))
}

#[library_benchmark]
#[bench::empty(scenes::empty())]
#[bench::free_hand_beside_0(scenes::free_hand(0).after(30))]
#[bench::free_hand_beside_16(scenes::free_hand(16).after(30))]
#[bench::free_hand_beside_56(scenes::free_hand(56).after(30))]
#[bench::free_hand_beside_64(scenes::free_hand(64).after(30))]
#[bench::pressed_hand_at_rest(scenes::pressed_hand().after(120))]
#[bench::slid_hand(scenes::slid_hand().after(60))]
#[bench::rolling_sphere(scenes::rolling_sphere().after(60))]
#[bench::free_arms(scenes::free_arms().after(30))]
#[bench::arms_at_a_wall(scenes::arms_at_a_wall().after(70))]
#[bench::settled_arms(scenes::arms_at_a_wall().after(200))]
fn ten_frames(scene: Scene) -> Scene {
    scene.after(10)
}

library_benchmark_group!(
    name = geometry;
    benchmarks = cold, warm, enumeration
);
library_benchmark_group!(
    name = frames;
    benchmarks = ten_frames
);
main!(library_benchmark_groups = geometry, frames);
