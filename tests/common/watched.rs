//! Scenes that the goldens watch beside those of `scenes.rs`, so that every part of the kernel is held.
//! Built with + - * / and the kernel's own functions alone, as those are.
#![allow(
    dead_code,
    unreachable_pub,
    reason = "every test and bench uses a part of it"
)]

use glam::Vec3;
use palpable::geometry::chain::{Hinge, JointDef};
use palpable::geometry::reach_cone::ReachCone;
use palpable::human::{Finger, FingerBones, finger};
use palpable::math::Pose;
use palpable::memory::{BodyId, ChainId};
use palpable::state::bodies::{BodyKind, Coupling};
use palpable::state::chains::ChainOptions;
use palpable::state::materials::{Material, Surface};
use palpable::state::pieces::Groups;
use palpable::world::{BodyDef, ChainDef, HostedInput, PieceDef, Shape, World};

use crate::common::{add_box, add_piece};
use crate::scenes::{
    ARM_OPTIONS, FRAME_S, Scene, add_arms, add_body, add_sphere, arm_posture, blob,
    compound_in_a_corner, falling_sphere, floor, pushed_stack, rod, share, sliding_hand, two_arms,
    world,
};

/// A scene by its name.
pub type Named = (&'static str, fn() -> Scene);

/// Every scene that the goldens hold.
pub const ALL: [Named; 15] = [
    ("falling sphere", falling_sphere),
    ("pushed stack", pushed_stack),
    ("sliding hand", sliding_hand),
    ("compound in a corner", compound_in_a_corner),
    ("two arms", two_arms),
    ("arms, cyclic descent", arms_by_cyclic_descent),
    ("arms led by their tips", arms_led_by_tips),
    ("pile", pile),
    ("two hands hold a box", two_hands),
    ("fingers on a ball", fingers_on_a_ball),
    ("hosted box", hosted_box),
    ("spinning plate", spinning_plate),
    ("hull of 400", pushed_ball_of_400),
    ("uneven frames", uneven_frames),
    ("detached hand", detached_hand),
];

/// Two arms that answer a wall by the paper's method, in turns that a draw decides.
pub fn arms_by_cyclic_descent() -> Scene {
    let options = ChainOptions {
        method: ChainOptions::CYCLIC_DESCENT,
        flags: ARM_OPTIONS.flags | ChainOptions::SHUFFLED,
        ..ARM_OPTIONS
    };
    let (world, body, arms) = arms_before_a_wall(options);
    let mut scene = Scene::new(world, body).driven_by(body, |_| Pose::at(0.0, 1.4, 0.0));
    scene.limbs = arms;
    scene.posture = arm_posture;
    scene
}

/// Two arms of which the tips alone are tracked, into a wall and along it.
pub fn arms_led_by_tips() -> Scene {
    let options = ChainOptions {
        flags: ARM_OPTIONS.flags | ChainOptions::HOLDS_TIP,
        tip: [0.0, 0.0, 0.34],
        ..ARM_OPTIONS
    };
    let (world, body, arms) = arms_before_a_wall(options);
    Scene::new(world, body)
        .driven_by(body, |_| Pose::at(0.0, 1.4, 0.0))
        .hosted_by(move |world, frame| {
            let reached = share(frame, 10, 80);
            let slid = share(frame, 90, 200);
            for (&arm, side) in arms.iter().zip([-1.0, 1.0]) {
                let tip = Pose {
                    rotation: [1.0, 0.0, 0.0, 0.0],
                    position: [
                        side * (0.2 + 0.1 * slid),
                        1.05 + 0.3 * slid,
                        -0.1 - 0.4 * reached,
                    ],
                };
                world.set_tip(arm, &tip, &[0.0; 5]).unwrap();
            }
        })
}

/// Two arms of a body in front of a wall.
fn arms_before_a_wall(options: ChainOptions) -> (World<'static>, BodyId, Vec<ChainId>) {
    let mut world = world();
    let wall = Pose::at(0.0, 1.0, -0.6);
    add_box(&mut world, BodyKind::Fixed, wall, [1.0, 1.0, 0.2]);
    let body = add_body(&mut world, BodyKind::Driven, Pose::at(0.0, 1.4, 0.0));
    let arms = add_arms(&mut world, body, options);
    (world, body, arms)
}

/// Boxes, hulls, spheres and capsules fall on each other between low walls.
pub fn pile() -> Scene {
    let mut world = world();
    floor(&mut world);
    for (x, z) in [(-0.3, 0.0), (0.3, 0.0), (0.0, -0.3), (0.0, 0.3)] {
        let half = if x == 0.0 {
            [0.3, 0.1, 0.1]
        } else {
            [0.1, 0.1, 0.3]
        };
        add_box(&mut world, BodyKind::Fixed, Pose::at(x, 0.1, z), half);
    }
    let mut shown = BodyId::NULL;
    for number in 0..12 {
        let at = [
            0.06 * (number % 3) as f32 - 0.05,
            0.1 + 0.06 * number as f32,
            0.05 * (number % 4) as f32 - 0.07,
        ];
        shown = add_loose(&mut world, number, at);
    }
    Scene::new(world, shown)
}

/// A loose body of one of four shapes and three materials.
fn add_loose(world: &mut World, number: u32, at: [f32; 3]) -> BodyId {
    let pose = Pose {
        rotation: [0.48, 0.0, 0.36, 0.8],
        position: at,
    };
    let points = blob(10 + number, 0.045);
    let (shape, radius_m) = match number % 4 {
        0 => (Shape::Box([0.04, 0.03, 0.05]), 0.0),
        1 => (Shape::Hull(&points), 0.0),
        2 => (Shape::Point, 0.04),
        _ => (Shape::Segment([-0.04, 0.0, 0.0], [0.04, 0.0, 0.0]), 0.025),
    };
    let body = add_body(world, BodyKind::Dynamic, pose);
    let def = PieceDef {
        material: [Material::WOOD, Material::METAL, Material::HUMAN][number as usize % 3],
        ..PieceDef::new(shape, radius_m)
    };
    add_piece(world, body, &def);
    body
}

/// Two driven palms close on a box on a pedestal, the one pushing with its mass; the pedestal goes, and
/// they lift the box, turn it and let it fall.
pub fn two_hands() -> Scene {
    let mut world = world();
    floor(&mut world);
    let pedestal = Pose::at(0.0, 0.1, 0.0);
    let pedestal = add_box(&mut world, BodyKind::Fixed, pedestal, [0.02, 0.1, 0.02]);
    let at = Pose::at(0.0, 0.2303, 0.0);
    let held = add_box(&mut world, BodyKind::Dynamic, at, [0.03; 3]);
    let pushes = [Coupling::PUSH_WITH_MASS, Coupling::PUSH_WITHOUT_LAG];
    let palms = [0, 1].map(|side| {
        let coupling = Coupling {
            push: pushes[side],
            ..Coupling::DEFAULT
        };
        let def = BodyDef {
            coupling,
            ..BodyDef::new(BodyKind::Driven, palm_at(0, side))
        };
        let palm = world.add_body(&def).unwrap();
        let piece = PieceDef {
            material: Material::HUMAN,
            ..PieceDef::new(Shape::Box([0.008, 0.04, 0.04]), 0.005)
        };
        add_piece(&mut world, palm, &piece);
        palm
    });
    Scene::new(world, held).hosted_by(move |world, frame| {
        for (side, &palm) in palms.iter().enumerate() {
            world.set_target(palm, &palm_at(frame, side)).unwrap();
        }
        if frame == 70 {
            world.remove_body(pedestal).unwrap();
        }
        if (100..130).contains(&frame) {
            world.apply_force(held, [0.0, -1.0, 0.0], [0.0; 3]).unwrap();
        }
    })
}

fn palm_at(frame: u32, side: usize) -> Pose {
    let closed = share(frame, 0, 50) - share(frame, 200, 220);
    let x = 0.12 - 0.097 * closed;
    let y = 0.2303 + 0.1 * share(frame, 80, 150);
    let sign = if side == 0 { -1.0 } else { 1.0 };
    Pose::at(sign * x, y, 0.02 * share(frame, 130, 170))
}

/// A hand of three fingers with ball knuckles and a thumb closes on a ball on a table and lifts it.
pub fn fingers_on_a_ball() -> Scene {
    let mut world = world();
    floor(&mut world);
    let ball = add_sphere(&mut world, Pose::at(0.0, 0.0353, -0.06), 0.035);
    let palm = add_body(&mut world, BodyKind::Driven, Pose::at(0.0, 0.3, 0.0));
    let piece = PieceDef {
        material: Material::HUMAN,
        ..PieceDef::new(Shape::Box([0.03, 0.006, 0.03]), 0.006)
    };
    add_piece(&mut world, palm, &piece);
    let mut limbs: Vec<ChainId> = (0..3)
        .map(|number| {
            add_finger(
                &mut world,
                palm,
                &knuckles(-0.025 + 0.025 * number as f32),
                0.04,
            )
        })
        .collect();
    limbs.push(add_finger(&mut world, palm, &thumb(), -0.035));
    let mut scene = Scene::new(world, ball).driven_by(palm, |frame| {
        let down = share(frame, 0, 60) - share(frame, 170, 230);
        Pose::at(0.0, 0.3 - 0.21 * down, 0.0)
    });
    scene.limbs = limbs;
    scene.posture = |frame, number| {
        let bent = share(frame, 60 + 5 * number as u32, 140);
        vec![0.9 * bent, 0.1 * bent, 0.05 * bent, 0.8 * bent, 0.6 * bent]
    };
    scene
}

/// A ball knuckle whose limb points along -z at rest and stays within a pyramid, and two hinges.
fn knuckles(x: f32) -> [JointDef; 3] {
    let side = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];
    let corners = side.map(|[x, y]| Vec3::new(0.4 * x, 3.0 * y, 1.0));
    let hinge = |z: f32| {
        JointDef::Hinge(Hinge {
            rest: Pose::at(0.0, 0.0, z),
            axis: Vec3::X,
            low_rad: 0.0,
            high_rad: 1.6,
        })
    };
    [
        JointDef::Ball {
            // Half a turn about y: z points along -z.
            rest: Pose {
                rotation: [0.0, 1.0, 0.0, 0.0],
                position: [x, 0.0, -0.04],
            },
            twist_low_rad: -0.2,
            twist_high_rad: 0.2,
            cone: ReachCone::new(Vec3::Z, &corners).unwrap(),
        },
        hinge(0.04),
        hinge(0.04),
    ]
}

/// A person's thumb beside the palm.
fn thumb() -> Vec<JointDef> {
    let bones = FingerBones {
        joints: [
            Pose::at(0.045, -0.02, 0.0),
            Pose::at(0.045, -0.025, -0.035),
            Pose::at(0.045, -0.03, -0.07),
        ],
        tip: Vec3::new(0.045, -0.03, -0.1),
    };
    let def = finger(Finger::Thumb, &bones);
    def.hinges.into_iter().map(JointDef::Hinge).collect()
}

/// Adds a finger whose last three links are capsules along z, the pieces in a group of their own.
fn add_finger(world: &mut World, palm: BodyId, joints: &[JointDef], length_m: f32) -> ChainId {
    let def = ChainDef {
        joints,
        base: None,
        options: ARM_OPTIONS,
    };
    let chain = world.add_chain(palm, &def).unwrap();
    for hinge in 2..5 {
        let shape = Shape::Segment([0.0; 3], [0.0, 0.0, 0.8 * length_m]);
        let piece = PieceDef {
            material: Material::HUMAN,
            ..PieceDef::new(shape, 0.008)
        };
        let piece = world.add_link_piece(chain, hinge, &piece).unwrap();
        let groups = Groups {
            member_of: 1,
            passes: 1,
        };
        world.set_groups(piece, groups).unwrap();
    }
    chain
}

/// A box that an engine of the host's own moves, without friction or gravity; a driven rod pushes it.
pub fn hosted_box() -> Scene {
    let mut world = world();
    floor(&mut world);
    let start = Pose::at(0.0, 0.2, 0.0);
    let hosted = add_box(&mut world, BodyKind::Hosted, start, [0.05, 0.04, 0.06]);
    let pusher = add_body(&mut world, BodyKind::Driven, Pose::at(-0.3, 0.21, 0.01));
    let points = rod([0.02, 0.02, 0.05]);
    add_piece(
        &mut world,
        pusher,
        &PieceDef::new(Shape::Hull(&points), 0.0),
    );
    let (mut pose, mut velocity) = (start, [0.0; 3]);
    Scene::new(world, hosted)
        .driven_by(pusher, |frame| {
            let swing = share(frame, 20, 90) - share(frame, 150, 200);
            Pose::at(-0.3 + 0.4 * swing, 0.21, 0.01)
        })
        .hosted_by(move |world, _| {
            let got = world.hosted_impulse(hosted).unwrap();
            for axis in 0..3 {
                velocity[axis] += got.impulse_n_s[axis] / 2.0;
                pose.position[axis] += velocity[axis] * FRAME_S;
            }
            let told = HostedInput {
                body: hosted,
                pose,
                velocity,
                spin: [0.0; 3],
                mass_kg: 2.0,
                centre: [0.0; 3],
                moments: [0.004, 0.005, 0.003],
                axes: [0.0, 0.0, 0.0, 1.0],
            };
            world.set_hosted([told]).unwrap();
        })
}

/// A lopsided plate tumbles about its middle axis far from the origin, and lands.
pub fn spinning_plate() -> Scene {
    let mut world = world();
    world.set_gravity([0.0, -1.6, 0.0]);
    let ground = Pose::at(300.0, -0.5, -200.0);
    add_box(&mut world, BodyKind::Fixed, ground, [5.0, 0.5, 5.0]);
    let metal = Surface {
        restitution: 0.6,
        friction: 0.8,
    };
    world
        .set_surface(Material::WOOD, Material::METAL, metal)
        .unwrap();
    let plate = add_body(&mut world, BodyKind::Dynamic, Pose::at(300.0, 1.0, -200.0));
    for (half, at, density_kg_m3) in [
        ([0.1, 0.01, 0.06], [0.0, 0.0, 0.0], 700.0),
        ([0.02, 0.02, 0.03], [0.06, 0.03, 0.01], 7800.0),
    ] {
        let def = PieceDef {
            local: Pose {
                rotation: [0.0, 0.28, 0.0, 0.96],
                position: at,
            },
            material: Material::METAL,
            density_kg_m3,
            ..PieceDef::new(Shape::Box(half), 0.0)
        };
        add_piece(&mut world, plate, &def);
    }
    world
        .set_velocity(plate, [0.2, 0.5, 0.0], [9.0, 0.05, 0.02])
        .unwrap();
    Scene::new(world, plate)
}

/// A ball of 400 vertices is pushed over a floor by a hull of 32.
pub fn pushed_ball_of_400() -> Scene {
    let mut world = world();
    floor(&mut world);
    let points = blob(400, 0.1);
    let ball = add_body(&mut world, BodyKind::Dynamic, Pose::at(0.0, 0.102, 0.0));
    add_piece(&mut world, ball, &PieceDef::new(Shape::Hull(&points), 0.0));
    let pusher = add_body(&mut world, BodyKind::Driven, Pose::at(-0.4, 0.1, 0.0));
    let points = rod([0.03, 0.04, 0.05]);
    add_piece(
        &mut world,
        pusher,
        &PieceDef::new(Shape::Hull(&points), 0.0),
    );
    Scene::new(world, ball).driven_by(pusher, |frame| {
        Pose::at(-0.4 + 0.6 * share(frame, 10, 150), 0.1, 0.01)
    })
}

/// The pushed stack in frames of 1 to 40 ms.
pub fn uneven_frames() -> Scene {
    let mut scene = pushed_stack();
    scene.length_s = |frame| {
        const LENGTHS_S: [f32; 5] = [
            1.0 / 90.0,
            1.0 / 1000.0,
            1.0 / 60.0,
            1.0 / 25.0,
            1.0 / 144.0,
        ];
        LENGTHS_S[frame as usize % 5]
    };
    scene
}

/// A hand follows its tracker through a wall's edge, loses it, and snaps to it where that is free.
pub fn detached_hand() -> Scene {
    let mut world = world();
    floor(&mut world);
    let wall = Pose::at(0.0, 0.3, 0.0);
    add_box(&mut world, BodyKind::Fixed, wall, [0.02, 0.3, 0.5]);
    let coupling = Coupling {
        divergence_m: 0.15,
        snap: Coupling::SNAP_WHEN_FREE,
        ..Coupling::DEFAULT
    };
    let def = BodyDef {
        coupling,
        ..BodyDef::new(BodyKind::Driven, Pose::at(-0.2, 0.5, 0.0))
    };
    let hand = world.add_body(&def).unwrap();
    let shape = Shape::Segment([0.0, 0.0, -0.04], [0.0, 0.03, 0.04]);
    add_piece(&mut world, hand, &PieceDef::new(shape, 0.03));
    Scene::new(world, hand).hosted_by(move |world, frame| {
        // What the tracker does not see for a while is not told.
        if !(100..130).contains(&frame) {
            let through = 0.3 * share(frame, 20, 90) + 0.2 * share(frame, 130, 220);
            let down = 0.2 * share(frame, 60, 120);
            let target = Pose {
                rotation: [0.0, 0.6, 0.0, 0.8],
                position: [-0.2 + through, 0.5 - down, 0.0],
            };
            world.set_target(hand, &target).unwrap();
        }
    })
}
