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
use palpable::geometry::distance::{Distance, distance};
use palpable::geometry::penetration::{CorePenetration, core_penetration};

use pairs::Pair;
use scenes::Scene;

#[library_benchmark]
#[bench::boxes_apart(pairs::boxes_apart())]
#[bench::hulls_of_32_apart(pairs::hulls_apart())]
fn distance_of(pair: Pair) -> Distance {
    let Pair { a, b, a_in_b } = black_box(pair);
    distance(&a, &b, &a_in_b, pair.seed())
}

#[library_benchmark]
#[bench::boxes_shallow(pairs::boxes_shallow())]
#[bench::hulls_of_32_shallow(pairs::hulls_shallow())]
fn penetration_of(pair: Pair) -> CorePenetration {
    let Pair { a, b, a_in_b } = black_box(pair);
    core_penetration(&a, &b, &a_in_b)
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
fn ten_frames(scene: Scene) -> Scene {
    scene.after(10)
}

library_benchmark_group!(
    name = geometry;
    benchmarks = distance_of, penetration_of
);
library_benchmark_group!(
    name = frames;
    benchmarks = ten_frames
);
main!(library_benchmark_groups = geometry, frames);
