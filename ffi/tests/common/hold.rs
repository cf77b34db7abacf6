//! The scene of `hosts/c/hold.c` on the kernel's own interface, with the same inputs.

use palpable_kernel::frame::FrameInput;
use palpable_kernel::math::Pose;
use palpable_kernel::memory::BodyId;
use palpable_kernel::state::bodies::{BodyKind, Coupling};
use palpable_kernel::state::materials::Material;
use palpable_kernel::world::{BodyDef, PieceDef, Shape, World};

use super::scene::with_world;

const SUPPORT_GONE: u32 = 120;
const LOAD: core::ops::Range<u32> = 180..240;
const LIFT_TO: u32 = 300;
const OPEN: u32 = 360;
const NUDGED: u32 = 540;
const FRAMES: u32 = 560;
const TOP: f32 = 0.2;
const MIDDLE: f32 = TOP + 0.03 + 0.0003;
const WIDE: f32 = 0.12;
const SQUEEZED: f32 = 0.023;

fn share_of(frame: u32, from: u32, to: u32) -> f32 {
    if frame <= from {
        0.0
    } else if frame >= to {
        1.0
    } else {
        (frame - from) as f32 / (to - from) as f32
    }
}

fn palm_at(frame: u32, side: f32) -> Pose {
    let closed = share_of(frame, 0, 60) - share_of(frame, OPEN, OPEN + 30);
    let x = WIDE + (SQUEEZED - WIDE) * closed;
    let y = MIDDLE + 0.1 * share_of(frame, LOAD.end, LIFT_TO);
    Pose::at(side * x, y, 0.0)
}

fn add_box(world: &mut World, body: &BodyDef, half: [f32; 3], surface: (Material, f32)) -> BodyId {
    let id = world.add_body(body).unwrap();
    let mut piece = PieceDef::new(Shape::Box(half), surface.1);
    piece.material = surface.0;
    world.add_piece(id, &piece).unwrap();
    id
}

/// The hash after `hosts/c/hold.c`, for palms that push in one way.
pub fn hold(push: u32) -> u64 {
    const WOOD: (Material, f32) = (Material::WOOD, 0.0);
    const SKIN: (Material, f32) = (Material::HUMAN, 0.005);
    with_world(|world| {
        let fixed = |y: f32| BodyDef::new(BodyKind::Fixed, Pose::at(0.0, y, 0.0));
        add_box(world, &fixed(-0.05), [1.0, 0.05, 1.0], WOOD);
        let pedestal = add_box(world, &fixed(TOP - 0.1), [0.02, 0.1, 0.02], WOOD);
        let loose = BodyDef::new(BodyKind::Dynamic, Pose::at(0.0, MIDDLE, 0.0));
        let held = add_box(world, &loose, [0.03; 3], WOOD);
        let sides = [-1.0, 1.0];
        let palms = sides.map(|side| {
            let mut palm = BodyDef::new(BodyKind::Driven, palm_at(0, side));
            palm.coupling = Coupling {
                push,
                ..Coupling::DEFAULT
            };
            add_box(world, &palm, [0.008, 0.04, 0.04], SKIN)
        });
        for frame in 0..FRAMES {
            for (palm, side) in palms.into_iter().zip(sides) {
                world.set_target(palm, &palm_at(frame, side)).unwrap();
            }
            if frame == SUPPORT_GONE {
                world.remove_body(pedestal).unwrap();
            }
            if LOAD.contains(&frame) {
                world.apply_force(held, [0.0, -2.0, 0.0], [0.0; 3]).unwrap();
            }
            if frame == NUDGED {
                let point = world.pose(held).unwrap().position;
                world.apply_impulse(held, [0.0, 0.05, 0.0], point).unwrap();
            }
            world.step(&FrameInput::unlimited(1.0 / 90.0));
        }
        world.hash()
    })
}
