//! The table of the goldens: every scene at several budgets, as text. One source for every processor.
#![allow(
    unreachable_pub,
    reason = "included by a test and by the build for wasm"
)]

use std::fmt::Write;

use palpable::frame::{Budget, CostTable, Deadline, FrameInput};

use crate::scenes::Scene;
use crate::watched::ALL;

/// What a frame may do: its number and its length in seconds are given.
type Input = fn(u32, f32) -> FrameInput;

/// A budget by its name, and the frames after which a line is written.
type Row = (&'static str, Input, &'static [u32]);

const ROWS: [Row; 4] = [
    (
        "unlimited",
        |_, dt_s| FrameInput::unlimited(dt_s),
        &[60, 120, 180, 240],
    ),
    ("scarce", scarce, &[120, 240]),
    ("zero", zero, &[120]),
    ("deadline", deadline, &[120, 240]),
];

/// Prices that are not alike, made up: what a machine really takes must not decide a golden.
const COSTS: CostTable = CostTable {
    frame_ns: 700,
    body_ns: 40,
    piece_ns: 15,
    chain_ns: 90,
    boxes_ns: 300,
    advance_unit_ns: 1100,
    impulse_unit_ns: 1700,
    reach_step_ns: 4300,
};

/// So few units that busy frames are cut in every stage.
fn scarce(_: u32, dt_s: f32) -> FrameInput {
    FrameInput {
        budget: Budget {
            advance_units: 6,
            impulse_units: 9,
            reach_steps: 2,
        },
        ..FrameInput::unlimited(dt_s)
    }
}

/// As much as is wanted until things touch, and then nothing.
fn zero(frame: u32, dt_s: f32) -> FrameInput {
    let mut input = FrameInput::unlimited(dt_s);
    if frame >= 60 {
        input.budget = Budget {
            advance_units: 0,
            impulse_units: 0,
            reach_steps: 0,
        };
    }
    input
}

/// Less time than busy frames want, and the viewer looks at one place.
fn deadline(_: u32, dt_s: f32) -> FrameInput {
    let deadline = Deadline {
        time_ns: 40_000,
        costs: COSTS,
    };
    FrameInput {
        focus: Some([0.1, 0.2, 0.0]),
        ..FrameInput::within(dt_s, deadline)
    }
}

fn line(text: &mut String, scene: &Scene, name: &str, budget: &str) {
    let [x, y, z] = scene.world.pose(scene.shown).unwrap().position;
    let mm = |metres: f32| 1e3 * f64::from(metres);
    writeln!(
        text,
        "{name:<22} {budget:<9} {:5} {:8} {:10.3} {:9.3} {:11.3}  {:016x}",
        scene.frame,
        scene.world.contacts().len(),
        mm(x),
        mm(y),
        mm(z),
        scene.world.hash(),
    )
    .unwrap();
}

/// The whole table.
#[must_use]
pub fn table() -> String {
    let mut text = String::from(
        "scene                  budget    frame contacts       x mm      y mm        z mm  state hash\n",
    );
    for (name, make) in ALL {
        for (budget, input, lines) in ROWS {
            let mut scene = make();
            for &end in lines {
                while scene.frame < end {
                    let dt_s = (scene.length_s)(scene.frame);
                    scene.step_with(&input(scene.frame, dt_s));
                }
                line(&mut text, &scene, name, budget);
            }
        }
    }
    text
}
