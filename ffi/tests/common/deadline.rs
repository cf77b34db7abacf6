//! The Rust side of `hosts/c/deadline.c`.

use std::cell::Cell;

use palpable_kernel::frame::{CostTable, Deadline, FrameInput};
use palpable_kernel::math::Pose;
use palpable_kernel::memory::BodyId;
use palpable_kernel::state::bodies::BodyKind;
use palpable_kernel::world::{BodyDef, PieceDef, Shape, World};

use crate::scene::with_world;

const COSTS: CostTable = CostTable {
    frame_ns: 900,
    body_ns: 50,
    piece_ns: 20,
    chain_ns: 100,
    boxes_ns: 300,
    advance_unit_ns: 2000,
    impulse_unit_ns: 3000,
    reach_step_ns: 5000,
};

fn add(world: &mut World, kind: BodyKind, x: f32, y: f32, half: f32, radius_m: f32) -> BodyId {
    let body = world
        .add_body(&BodyDef::new(kind, Pose::at(x, y, 0.0)))
        .unwrap();
    let shape = if half > 0.0 {
        Shape::Box([half; 3])
    } else {
        Shape::Point
    };
    world
        .add_piece(body, &PieceDef::new(shape, radius_m))
        .unwrap();
    body
}

/// The hash of the final state.
pub fn deadline() -> u64 {
    with_world(|world| {
        add(world, BodyKind::Fixed, 0.0, -2.0, 2.0, 0.0);
        let hands = [-1.0, -0.5].map(|x| add(world, BodyKind::Driven, x, 0.3, 0.04, 0.01));
        let ball = add(world, BodyKind::Dynamic, 0.0, 0.0501, 0.0, 0.05);
        world
            .set_velocity(ball, [1.0, 0.0, 0.0], [0.0, 0.0, -20.0])
            .unwrap();
        for frame in 0..180 {
            for (hand, x) in hands.into_iter().zip([-1.0, -0.5]) {
                let y = if frame < 10 { 0.3 } else { -0.1 };
                let z = 0.007_812_5 * frame as f32;
                world.set_target(hand, &Pose::at(x, y, z)).unwrap();
            }
            if frame % 3 == 2 {
                let now = Cell::new(0);
                let tick = || {
                    now.set(now.get() + 1);
                    now.get()
                };
                let input = FrameInput::unlimited(1.0 / 60.0);
                world.step_by_clock(&input, &tick, 1 + frame % 7);
                continue;
            }
            let more = if frame % 3 == 0 { 9000 } else { 0 };
            let time_ns = world.floor_ns(&COSTS) + more - u64::from(frame % 15 == 1);
            let focus = if frame % 2 == 0 { -1.0 } else { -0.5 };
            let deadline = Deadline {
                time_ns,
                costs: COSTS,
            };
            world.step(&FrameInput {
                focus: Some([focus, 0.0, 0.0]),
                ..FrameInput::within(1.0 / 60.0, deadline)
            });
        }
        world.hash()
    })
}
