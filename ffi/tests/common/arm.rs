//! The scenes of `hosts/c/arm.c` and of the short arms on the kernel's own interface, with the same inputs.

use palpable_kernel::frame::{Budget, FrameInput};
use palpable_kernel::geometry::chain::{Hinge, JointDef};
use palpable_kernel::geometry::reach_cone::ReachCone;
use palpable_kernel::math::Pose;
use palpable_kernel::memory::{BodyId, ChainId};
use palpable_kernel::state::bodies::BodyKind;
use palpable_kernel::state::chains::ChainOptions;
use palpable_kernel::state::materials::Material;
use palpable_kernel::state::pieces::Groups;
use palpable_kernel::world::{BodyDef, ChainDef, PieceDef, Shape, World};

use super::scene::with_world;

const FRAMES: u32 = 600;
const HINGES: usize = 7;
const HALF_TURN: f32 = core::f32::consts::PI;

const AWAY: [f32; HINGES] = [0.85, 0.1, 0.1, 1.2, 0.2, 0.25, 0.1];

const KEYS: [(u32, [f32; HINGES]); 7] = [
    (0, [0.9, 0.0, 0.0, 1.0, 0.0, 0.3, 0.0]),
    (60, AWAY),
    (180, [0.0; HINGES]),
    (300, [0.0; HINGES]),
    (420, AWAY),
    (480, AWAY),
    (600, [0.0; HINGES]),
];

const CORNERS: [[f32; 3]; 6] = [
    [0.0, 1.0, 0.5],
    [-1.0, 0.6, 0.5],
    [-1.0, -0.6, 0.5],
    [0.0, -1.0, 0.5],
    [1.0, -0.6, 0.5],
    [1.0, 0.6, 0.5],
];

fn seen_at(frame: u32) -> [f32; HINGES] {
    let k = KEYS.iter().skip(1).take_while(|key| frame > key.0).count();
    let ((begin, from), (end, to)) = (KEYS[k], KEYS[k + 1]);
    let share = (frame - begin) as f32 / (end - begin) as f32;
    core::array::from_fn(|h| from[h] + (to[h] - from[h]) * share)
}

fn hinge(at: [f32; 3], axis: [f32; 3], low_rad: f32, high_rad: f32) -> JointDef {
    JointDef::Hinge(Hinge {
        rest: Pose::at(at[0], at[1], at[2]),
        axis: axis.into(),
        low_rad,
        high_rad,
    })
}

fn shoulder() -> JointDef {
    let corners = CORNERS.map(Into::into);
    JointDef::Ball {
        rest: Pose {
            rotation: [0.0, 1.0, 0.0, 0.0],
            position: [0.0; 3],
        },
        twist_low_rad: -1.0,
        twist_high_rad: 1.0,
        cone: ReachCone::new([0.0, 0.0, 1.0].into(), &corners).unwrap(),
    }
}

fn add_chain(
    world: &mut World,
    body: BodyId,
    joints: &[JointDef],
    base: Option<(ChainId, u32)>,
    options: ChainOptions,
) -> ChainId {
    let def = ChainDef {
        joints,
        base,
        options,
    };
    world.add_chain(body, &def).unwrap()
}

fn add_arm(world: &mut World, body: BodyId) -> ChainId {
    let joints = [
        shoulder(),
        hinge([0.0, 0.0, 0.30], [1.0, 0.0, 0.0], 0.0, 2.4),
        hinge([0.0; 3], [0.0, 0.0, 1.0], -1.4, 1.4),
        hinge([0.0, 0.0, 0.26], [1.0, 0.0, 0.0], -1.2, 1.2),
        hinge([0.0; 3], [0.0, 1.0, 0.0], -0.6, 0.6),
    ];
    let arm = add_chain(world, body, &joints, None, ChainOptions::DEFAULT);
    for (link, length) in [(2, 0.30), (4, 0.26), (6, 0.10)] {
        let mut capsule = PieceDef::new(Shape::Segment([0.0; 3], [0.0, 0.0, length]), 0.04);
        capsule.material = Material::HUMAN;
        world.add_link_piece(arm, link, &capsule).unwrap();
    }
    arm
}

fn add_neck(world: &mut World, body: BodyId) -> ChainId {
    let joint = hinge([-0.2, 0.2, 0.0], [1.0, 0.0, 0.0], -HALF_TURN, HALF_TURN);
    let neck = add_chain(world, body, &[joint], None, ChainOptions::DEFAULT);
    let mut head = PieceDef::new(Shape::Point, 0.1);
    head.local = Pose::at(0.0, 0.15, 0.0);
    let head = world.add_link_piece(neck, 0, &head).unwrap();
    let groups = Groups {
        member_of: 1,
        passes: 2,
    };
    world.set_groups(head, groups).unwrap();
    neck
}

/// A wall across -Z, and a driven body without pieces.
fn add_wall_and_body(world: &mut World) -> BodyId {
    let wall = BodyDef::new(BodyKind::Fixed, Pose::at(0.0, 0.0, -0.55 - 0.1));
    let wall = world.add_body(&wall).unwrap();
    world
        .add_piece(wall, &PieceDef::new(Shape::Box([2.0, 2.0, 0.1]), 0.0))
        .unwrap();
    world
        .add_body(&BodyDef::new(BodyKind::Driven, Pose::IDENTITY))
        .unwrap()
}

fn other_trackers(world: &mut World, arm: ChainId) {
    let wild = [-3.0, 2.0, 9.0, -1.0, 9.0, -9.0, 9.0];
    let rest = [0.0, 0.0, 0.0, 0.4, 0.0, 0.0, 0.0];
    world.set_angles(arm, &wild).unwrap();
    world.place_angles(arm, &AWAY).unwrap();
    let seen = world.link_poses(arm).unwrap()[2..].to_vec();
    world.set_angles(arm, &rest).unwrap();
    world.set_link_poses(arm, &seen).unwrap();
    world.set_tip(arm, seen.last().unwrap(), &rest).unwrap();
}

/// The hash after `hosts/c/arm.c`.
pub fn arm() -> u64 {
    with_world(|world| {
        let body = add_wall_and_body(world);
        let arm = add_arm(world, body);
        let joint = hinge([0.0, 0.0, 0.1], [1.0, 0.0, 0.0], -HALF_TURN, HALF_TURN);
        let on_hand = Some((arm, HINGES as u32 - 1));
        let finger = add_chain(world, body, &[joint], on_hand, ChainOptions::DEFAULT);
        let neck = add_neck(world, body);
        world.place_angles(arm, &KEYS[0].1).unwrap();
        for frame in 0..FRAMES {
            world.set_target(body, &Pose::IDENTITY).unwrap();
            world.set_angles(arm, &seen_at(frame)).unwrap();
            let nod = 0.01 * (frame % 50) as f32;
            world.set_angles(neck, &[nod]).unwrap();
            let curl = 0.02 * (frame % 40) as f32;
            world.set_angles(finger, &[curl]).unwrap();
            let default = ChainOptions::DEFAULT;
            let options = match frame {
                300 => Some(ChainOptions {
                    method: ChainOptions::CYCLIC_DESCENT,
                    ..default
                }),
                480 => Some(ChainOptions {
                    flags: default.flags | ChainOptions::HOLDS_TIP,
                    ..default
                }),
                _ => None,
            };
            if let Some(options) = options {
                world.set_chain_options(arm, &options).unwrap();
            }
            let reach_steps = match frame {
                0..480 => u32::MAX,
                480..580 => 1,
                _ => 0,
            };
            world.step(&FrameInput {
                budget: Budget {
                    reach_steps,
                    ..Budget::UNLIMITED
                },
                ..FrameInput::unlimited(1.0 / 90.0)
            });
        }
        other_trackers(world, arm);
        world.hash()
    })
}

/// The hash after `hosts/cpp/elbow.cpp` and `hosts/luajit/elbow.lua`.
pub fn elbow() -> u64 {
    with_world(|world| {
        let body = add_wall_and_body(world);
        let joints = [
            hinge([0.0; 3], [1.0, 0.0, 0.0], -2.0, 2.0),
            hinge([0.0, 0.0, -0.35], [1.0, 0.0, 0.0], -2.0, 2.0),
        ];
        let options = ChainOptions {
            attraction_s: 0.03,
            ..ChainOptions::DEFAULT
        };
        let arm = add_chain(world, body, &joints, None, options);
        let capsule = PieceDef::new(Shape::Segment([0.0; 3], [0.0, 0.0, -0.35]), 0.04);
        for link in 0..2 {
            world.add_link_piece(arm, link, &capsule).unwrap();
        }
        world.place_angles(arm, &[-1.5, 0.0]).unwrap();
        for frame in 0..120 {
            world.set_target(body, &Pose::IDENTITY).unwrap();
            let raised = 0.0125 * frame as f32 - 1.5;
            world.set_angles(arm, &[raised, 0.25]).unwrap();
            world.step(&FrameInput::unlimited(1.0 / 60.0));
        }
        world.hash()
    })
}
