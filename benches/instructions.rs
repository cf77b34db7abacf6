//! How many instructions things take, counted by valgrind: the same on a busy machine.
//!
//! Goals: a change that makes something dearer is seen on the day it is made, and a scene pays only
//! for what it uses (promise P7). Not a goal: time. Counts know nothing of caches and of instructions
//! that wait for each other; `stages.rs` measures that.
//!
//! `benches/instructions.limits` holds the counts that were agreed on, and
//! `.ci/instruction_limits.py` compares: it says how to run this and how to write the counts anew.
//! Frames are counted ten at a time, because one frame can be lucky; and one at a time where it is known
//! which one is typical and which the heaviest (`frames.txt`). Growth series have one more thing at a time;
//! unit series allow a frame a few units more at a time, so that the difference is what a unit takes.
#![allow(missing_docs, reason = "the macros make public items")]

#[path = "../tests/common/mod.rs"]
mod common;
#[path = "../tests/common/frames.rs"]
mod frames;
#[path = "../tests/common/growth.rs"]
mod growth;
#[path = "../tests/common/pairs.rs"]
mod pairs;
#[path = "../tests/common/scenes.rs"]
mod scenes;
#[path = "../tests/common/watched.rs"]
mod watched;

use std::hint::black_box;

use arrayvec::ArrayVec;
use glam::{Mat3, Vec3};
use iai_callgrind::{
    Callgrind, LibraryBenchmarkConfig, library_benchmark, library_benchmark_group, main,
};
use palpable::frame::{Budget, FrameInput};
use palpable::geometry::manifold::{Contact, CoreGap, manifold};
use palpable::geometry::penetration::{CorePenetration, core_penetration};
use palpable::geometry::separation::{Separation, core_gap};
use palpable::impulses::solver::{Order, Problem};
use palpable::state::rows::{Mover, Row};

use frames::{before_heaviest, before_typical};
use pairs::{APART_M, Class, Pair, SHALLOW_M};
use scenes::{FRAME_S, Scene};

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

/// A pair whose gap is known, for its contacts.
struct Touching {
    pair: Pair,
    core: CoreGap,
}

fn touching(class: Class) -> Touching {
    let pair = class.at_gap(SHALLOW_M);
    let a_in_b = pair.poses[0].seen_from(&pair.poses[1]);
    let core = core_gap(&pair.a, &pair.b, &a_in_b, Vec3::ZERO);
    Touching { pair, core }
}

#[library_benchmark]
#[bench::boxes(touching(Class::Boxes))]
#[bench::hulls_of_32(touching(Class::Hulls32))]
fn contacts_of_a_pair(touching: Touching) -> ArrayVec<Contact, 4> {
    let Touching { pair, core } = black_box(touching);
    let a_in_b = pair.poses[0].seen_from(&pair.poses[1]);
    manifold(&pair.a, &pair.b, &a_in_b, &core, 0.01)
}

/// A ball of 1 kg that meets what nothing moves at 2 m/s.
fn impact() -> ([Mover; 2], [Row; 1]) {
    let ball = Mover {
        velocity: Vec3::new(0.5, -2.0, 0.0),
        inverse_mass: 1.0,
        inverse_inertia: Mat3::from_diagonal(Vec3::splat(1000.0)),
        ..Mover::default()
    };
    let mut row = Row::default();
    row.body_b = 1;
    row.normal = Vec3::Y;
    row.arm_a = Vec3::new(0.0, -0.05, 0.0);
    row.target = f32::NEG_INFINITY;
    row.bounce = 0.2;
    row.restitution = 0.5;
    row.friction = 0.3;
    ([ball, Mover::default()], [row])
}

#[library_benchmark]
#[bench::of_a_ball(impact())]
fn one_impulse((mut movers, mut rows): ([Mover; 2], [Row; 1])) -> Vec3 {
    let mut problem = Problem {
        movers: &mut movers,
        rows: &mut rows,
        first: &mut [0; 2],
        queue: &mut [0; 1],
        order: Order::MostNegative,
        tolerance: 1e-4,
    };
    problem.prepare();
    let impulses = problem.strike(9);
    assert!(impulses > 0, "it does not bounce");
    movers[0].velocity
}

/// So many units for each stage.
const fn budget(advance_units: u32, impulse_units: u32, reach_steps: u32) -> Budget {
    Budget {
        advance_units,
        impulse_units,
        reach_steps,
    }
}

fn advance(units: u32) -> (Scene, Budget) {
    (before_heaviest("sliding hand"), budget(units, 0, 0))
}

fn impulse(units: u32) -> (Scene, Budget) {
    (before_heaviest("pile"), budget(0, units, 0))
}

/// Tips that contact lets slide take steps in every frame.
fn reach(steps: u32) -> (Scene, Budget) {
    let scene = before_typical("arms led by their tips");
    (scene, budget(u32::MAX, 0, steps))
}

#[library_benchmark]
#[benches::advance(args = [0, 1, 2, 4], setup = advance)]
#[benches::impulse(args = [0, 32, 64, 128], setup = impulse)]
#[benches::reach(args = [0, 1, 2, 4], setup = reach)]
fn units((mut scene, budget): (Scene, Budget)) -> Scene {
    scene.step_with(&FrameInput {
        budget,
        ..FrameInput::unlimited(FRAME_S)
    });
    scene
}

#[library_benchmark]
#[bench::falling_sphere(before_typical("falling sphere"))]
#[bench::pushed_stack(before_typical("pushed stack"))]
#[bench::sliding_hand(before_typical("sliding hand"))]
#[bench::compound_in_a_corner(before_typical("compound in a corner"))]
#[bench::two_arms(before_typical("two arms"))]
#[bench::arms_cyclic_descent(before_typical("arms, cyclic descent"))]
#[bench::arms_led_by_their_tips(before_typical("arms led by their tips"))]
#[bench::pile(before_typical("pile"))]
#[bench::two_hands_hold_a_box(before_typical("two hands hold a box"))]
#[bench::fingers_on_a_ball(before_typical("fingers on a ball"))]
#[bench::hosted_box(before_typical("hosted box"))]
#[bench::spinning_plate(before_typical("spinning plate"))]
#[bench::hull_of_400(before_typical("hull of 400"))]
#[bench::uneven_frames(before_typical("uneven frames"))]
#[bench::detached_hand(before_typical("detached hand"))]
fn typical_frame(mut scene: Scene) -> Scene {
    scene.step();
    scene
}

#[library_benchmark]
#[bench::falling_sphere(before_heaviest("falling sphere"))]
#[bench::pushed_stack(before_heaviest("pushed stack"))]
#[bench::sliding_hand(before_heaviest("sliding hand"))]
#[bench::compound_in_a_corner(before_heaviest("compound in a corner"))]
#[bench::two_arms(before_heaviest("two arms"))]
#[bench::arms_cyclic_descent(before_heaviest("arms, cyclic descent"))]
#[bench::arms_led_by_their_tips(before_heaviest("arms led by their tips"))]
#[bench::pile(before_heaviest("pile"))]
#[bench::two_hands_hold_a_box(before_heaviest("two hands hold a box"))]
#[bench::fingers_on_a_ball(before_heaviest("fingers on a ball"))]
#[bench::hosted_box(before_heaviest("hosted box"))]
#[bench::spinning_plate(before_heaviest("spinning plate"))]
#[bench::hull_of_400(before_heaviest("hull of 400"))]
#[bench::uneven_frames(before_heaviest("uneven frames"))]
#[bench::detached_hand(before_heaviest("detached hand"))]
fn heaviest_frame(mut scene: Scene) -> Scene {
    scene.step();
    scene
}

#[library_benchmark]
#[bench::nothing(scenes::empty())]
#[bench::nothing_with_much_room(growth::empty_with_much_room())]
#[benches::boxes_awake(args = [1, 2, 4, 8, 16, 32, 64], setup = growth::boxes_awake)]
#[benches::boxes_asleep(args = [1, 2, 4, 8, 16, 32, 64], setup = growth::boxes_asleep)]
#[benches::beside_pieces(args = [1, 2, 4, 8, 16, 32, 64], setup = growth::beside_pieces)]
#[benches::hand_pieces(args = [1, 2, 4, 8, 16, 32, 64], setup = growth::hand_pieces)]
#[benches::chains(args = [1, 2, 4, 8, 16, 32, 64], setup = growth::chains)]
#[benches::contacts(args = [1, 2, 4, 8, 16, 32, 64], setup = growth::contacts)]
#[benches::overlaps(args = [1, 2, 4, 8, 16, 32, 64], setup = growth::overlaps)]
fn growth_frame(mut scene: Scene) -> Scene {
    scene.step();
    scene
}

library_benchmark_group!(
    name = geometry;
    benchmarks = cold, warm, enumeration, contacts_of_a_pair, one_impulse
);
library_benchmark_group!(
    name = whole_frames;
    benchmarks = ten_frames, units, typical_frame, heaviest_frame, growth_frame
);
main!(
    // Caches are not looked at, and the states before frames come from a folder.
    config = LibraryBenchmarkConfig::default()
        .pass_through_env(frames::FOLDER)
        .tool(Callgrind::with_args(["--cache-sim=no"]));
    library_benchmark_groups = geometry, whole_frames);
