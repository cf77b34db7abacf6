//! Scenes that goldens and benches share, built with + - * / alone: every processor starts from the
//! same bits.
#![allow(
    dead_code,
    unreachable_pub,
    reason = "every test and bench uses a part of it"
)]

use glam::Vec3;
use palpable::frame::{FrameInput, FrameReport};
use palpable::geometry::chain::{Hinge, JointDef};
use palpable::geometry::reach_cone::ReachCone;
use palpable::math::Pose;
use palpable::memory::{BodyId, Capacities, ChainId};
use palpable::state::bodies::BodyKind;
use palpable::state::chains::ChainOptions;
use palpable::state::materials::Material;
use palpable::world::{BodyDef, ChainDef, PieceDef, Shape, World};

use crate::common::{Block, add_box, add_piece};

/// Length of a frame, in seconds.
pub const FRAME_S: f32 = 1.0 / 90.0;

/// Where the tracker sees the driven body in a frame.
pub type Script = fn(u32) -> Pose;

/// A world, and what happens in it.
pub struct Scene {
    pub world: World<'static>,
    /// The body whose pose tells a reader what goes on; null when there is none.
    pub shown: BodyId,
    driven: Option<(BodyId, Script)>,
    /// Poses of the driven body's pieces in a frame.
    bending: Option<fn(u32) -> Vec<Pose>>,
    /// Chains of the driven body, and their angles in a frame by the chain's number.
    pub limbs: Vec<ChainId>,
    pub posture: fn(u32, usize) -> Vec<f32>,
    /// What else the host does before a frame.
    pub host: Option<Host>,
    /// Length of a frame, in seconds.
    pub length_s: fn(u32) -> f32,
    pub frame: u32,
}

/// What a host does before the frame of a number.
pub type Host = Box<dyn FnMut(&mut World, u32)>;

impl Scene {
    pub fn new(world: World<'static>, shown: BodyId) -> Self {
        Self {
            world,
            shown,
            driven: None,
            bending: None,
            limbs: vec![],
            posture: |_, _| vec![],
            host: None,
            length_s: |_| FRAME_S,
            frame: 0,
        }
    }

    #[must_use]
    pub fn hosted_by(mut self, host: impl FnMut(&mut World, u32) + 'static) -> Self {
        self.host = Some(Box::new(host));
        self
    }

    #[must_use]
    pub fn driven_by(mut self, body: BodyId, script: Script) -> Self {
        self.driven = Some((body, script));
        self
    }

    /// Tells the trackers' news and steps the world.
    pub fn step(&mut self) -> FrameReport {
        self.step_with(&FrameInput::unlimited((self.length_s)(self.frame)))
    }

    /// The same with another input.
    pub fn step_with(&mut self, input: &FrameInput) -> FrameReport {
        self.tell();
        self.world.step(input)
    }

    /// Tells the trackers' news.
    pub fn tell(&mut self) {
        if let Some((body, script)) = self.driven {
            self.world.set_target(body, &script(self.frame)).unwrap();
            if let Some(bending) = self.bending {
                let poses = bending(self.frame);
                self.world.set_piece_targets(body, &poses).unwrap();
            }
        }
        for (number, &chain) in self.limbs.iter().enumerate() {
            let angles = (self.posture)(self.frame, number);
            if !angles.is_empty() {
                self.world.set_angles(chain, &angles).unwrap();
            }
        }
        if let Some(host) = &mut self.host {
            host(&mut self.world, self.frame);
        }
        self.frame += 1;
    }

    /// The scene after so many frames.
    #[must_use]
    pub fn after(mut self, frames: u32) -> Self {
        for _ in 0..frames {
            self.step();
        }
        self
    }
}

/// An empty world. Its memory is given back when the program ends: a scene moves, and a world
/// borrows.
pub fn world() -> World<'static> {
    let block = Box::leak(Box::new(Block::new(&Capacities::ROOM)));
    World::create(block.bytes(), &Capacities::ROOM).unwrap()
}

/// A floor whose top is at y = 0.
pub fn floor(world: &mut World) {
    let pose = Pose::at(0.0, -0.5, 0.0);
    add_box(world, BodyKind::Fixed, pose, [2.0, 0.5, 2.0]);
}

pub fn add_body(world: &mut World, kind: BodyKind, pose: Pose) -> BodyId {
    world.add_body(&BodyDef::new(kind, pose)).unwrap()
}

pub fn add_sphere(world: &mut World, pose: Pose, radius_m: f32) -> BodyId {
    let body = add_body(world, BodyKind::Dynamic, pose);
    add_piece(world, body, &PieceDef::new(Shape::Point, radius_m));
    body
}

/// How far between `first` and `last` a frame is, from 0 to 1.
pub fn share(frame: u32, first: u32, last: u32) -> f32 {
    if frame <= first {
        0.0
    } else if frame >= last {
        1.0
    } else {
        (frame - first) as f32 / (last - first) as f32
    }
}

/// A turn about x with the tangent of a quarter of the angle.
pub fn turned_about_x(quarter_tangent: f32) -> [f32; 4] {
    let square = quarter_tangent * quarter_tangent;
    let scale = 1.0 + square;
    [
        2.0 * quarter_tangent / scale,
        0.0,
        0.0,
        (1.0 - square) / scale,
    ]
}

// What the goldens watch.

/// A sphere falls on a floor, bounces, and rolls out.
pub fn falling_sphere() -> Scene {
    let mut world = world();
    floor(&mut world);
    let sphere = add_sphere(&mut world, Pose::at(0.1, 0.4, -0.2), 0.05);
    world
        .set_velocity(sphere, [0.3, 0.0, 0.1], [0.0, 2.0, 0.0])
        .unwrap();
    Scene::new(world, sphere)
}

/// Two boxes, one on the other; a driven capsule pushes the lower one.
pub fn pushed_stack() -> Scene {
    let mut world = world();
    floor(&mut world);
    let half = [0.06, 0.05, 0.07];
    add_box(
        &mut world,
        BodyKind::Dynamic,
        Pose::at(0.0, 0.0503, 0.0),
        half,
    );
    let upper = Pose::at(0.01, 0.1508, 0.005);
    let upper = add_box(&mut world, BodyKind::Dynamic, upper, half);
    let pusher = add_body(&mut world, BodyKind::Driven, Pose::at(-0.3, 0.06, 0.0));
    let capsule = Shape::Segment([0.0, 0.0, -0.03], [0.0, 0.0, 0.03]);
    add_piece(&mut world, pusher, &PieceDef::new(capsule, 0.02));
    Scene::new(world, upper).driven_by(pusher, |frame| {
        Pose::at(-0.3 + 0.5 * share(frame, 30, 150), 0.06, 0.004)
    })
}

/// A palm and five capsules bend while they are pressed on a box, slid over its edge and lifted.
pub fn sliding_hand() -> Scene {
    let mut world = world();
    floor(&mut world);
    add_box(
        &mut world,
        BodyKind::Fixed,
        Pose::at(0.0, 0.1, 0.0),
        [0.25, 0.1, 0.25],
    );
    let hand = add_body(&mut world, BodyKind::Driven, Pose::at(0.0, 0.4, 0.1));
    let palm = PieceDef {
        material: Material::HUMAN,
        ..PieceDef::new(Shape::Box([0.035, 0.006, 0.04]), 0.006)
    };
    add_piece(&mut world, hand, &palm);
    let finger = Shape::Segment([0.0, 0.0, 0.0], [0.0, 0.0, -0.07]);
    for local in fingers(0).into_iter().skip(1) {
        let def = PieceDef {
            local,
            material: Material::HUMAN,
            ..PieceDef::new(finger, 0.009)
        };
        add_piece(&mut world, hand, &def);
    }
    let mut scene = Scene::new(world, hand).driven_by(hand, |frame| {
        let pressed = share(frame, 0, 45) - share(frame, 180, 225);
        let slid = share(frame, 60, 150);
        Pose::at(0.4 * slid, 0.4 - 0.27 * pressed, 0.1 - 0.05 * slid)
    });
    scene.bending = Some(fingers);
    scene
}

/// The pieces of the sliding hand: the palm and five bending fingers.
fn fingers(frame: u32) -> Vec<Pose> {
    let mut poses = vec![Pose::IDENTITY];
    for number in 0..5 {
        let bend = share(frame, 20 + 7 * number, 110) - share(frame, 120, 200);
        poses.push(Pose {
            rotation: turned_about_x(-0.15 * bend),
            position: [-0.036 + 0.018 * number as f32, 0.0, -0.045],
        });
    }
    poses
}

/// A body of a box, a hull and a capsule falls into a corner of three fixed boxes.
pub fn compound_in_a_corner() -> Scene {
    let mut world = world();
    floor(&mut world);
    for (x, z) in [(-0.6, 0.0), (0.0, -0.6)] {
        let pose = Pose::at(x, 0.5, z);
        add_box(&mut world, BodyKind::Fixed, pose, [0.5, 0.5, 0.5]);
    }
    let pose = Pose {
        rotation: [0.36, 0.48, 0.0, 0.8],
        position: [0.02, 0.2, 0.03],
    };
    let body = add_body(&mut world, BodyKind::Dynamic, pose);
    add_piece(
        &mut world,
        body,
        &PieceDef::new(Shape::Box([0.03, 0.04, 0.05]), 0.0),
    );
    let points = blob(12, 0.045);
    let hull = PieceDef {
        local: Pose::at(0.06, 0.01, 0.0),
        ..PieceDef::new(Shape::Hull(&points), 0.0)
    };
    add_piece(&mut world, body, &hull);
    let rod = Shape::Segment([-0.05, 0.05, 0.0], [0.04, 0.08, 0.02]);
    add_piece(&mut world, body, &PieceDef::new(rod, 0.015));
    world
        .set_velocity(body, [-0.5, 0.0, -0.4], [0.5, 0.0, -0.5])
        .unwrap();
    Scene::new(world, body)
}

/// The joints of an arm at a place: a ball whose limb points down at rest and stays within a pyramid, an
/// elbow, and the forearm's twist.
fn arm_joints(at: [f32; 3]) -> [JointDef; 3] {
    let side = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];
    let corners = side.map(|[x, y]| Vec3::new(1.5 * x, 4.0 * y, 1.0));
    let cone = ReachCone::new(Vec3::Z, &corners).unwrap();
    let hinge = |at: [f32; 3], axis, low_rad, high_rad| {
        JointDef::Hinge(Hinge {
            rest: Pose::at(at[0], at[1], at[2]),
            axis,
            low_rad,
            high_rad,
        })
    };
    // A quarter turn about x: z points down.
    let half = 0.707_106_77;
    [
        JointDef::Ball {
            rest: Pose {
                rotation: [half, 0.0, 0.0, half],
                position: at,
            },
            twist_low_rad: -1.0,
            twist_high_rad: 1.0,
            cone,
        },
        hinge([0.0, 0.0, 0.3], Vec3::X, 0.0, 2.4),
        hinge([0.0, 0.0, 0.0], Vec3::Z, -1.2, 1.2),
    ]
}

/// Arms that keep out of each other and move the root.
pub const ARM_OPTIONS: ChainOptions = ChainOptions {
    flags: ChainOptions::MOVES_ROOT | ChainOptions::MEETS_BODY,
    ..ChainOptions::DEFAULT
};

/// Adds two arms to a body, their links capsules along z.
pub fn add_arms(world: &mut World, body: BodyId, options: ChainOptions) -> Vec<ChainId> {
    [-0.2, 0.2]
        .map(|x| {
            let joints = arm_joints([x, 0.0, 0.0]);
            let def = ChainDef {
                joints: &joints,
                base: None,
                options,
            };
            let chain = world.add_chain(body, &def).unwrap();
            for (hinge, length_m) in [(2, 0.3), (4, 0.34)] {
                let shape = Shape::Segment([0.0; 3], [0.0, 0.0, length_m]);
                let def = PieceDef::new(shape, 0.04);
                world.add_link_piece(chain, hinge, &def).unwrap();
            }
            chain
        })
        .to_vec()
}

/// Two arms swing forward into a wall, the left one crosses the right one's way, a box on a table is
/// pushed, and the arms go back.
pub fn two_arms() -> Scene {
    let mut world = world();
    floor(&mut world);
    let wall = Pose::at(0.5, 1.0, -0.75);
    add_box(&mut world, BodyKind::Fixed, wall, [0.5, 1.0, 0.2]);
    let table = Pose::at(-0.2, 0.5, -0.5);
    add_box(&mut world, BodyKind::Fixed, table, [0.3, 0.5, 0.2]);
    let crate_pose = Pose::at(-0.06, 1.0603, -0.42);
    let half = [0.06, 0.06, 0.06];
    let pushed = add_box(&mut world, BodyKind::Dynamic, crate_pose, half);
    let root = Pose::at(0.0, 1.4, 0.0);
    let body = add_body(&mut world, BodyKind::Driven, root);
    let arms = add_arms(&mut world, body, ARM_OPTIONS);
    let mut scene = Scene::new(world, pushed).driven_by(body, |_| Pose::at(0.0, 1.4, 0.0));
    scene.limbs = arms;
    scene.posture = arm_posture;
    scene
}

/// Arms swing forward, cross, part and go back.
pub fn arm_posture(frame: u32, number: usize) -> Vec<f32> {
    let up = share(frame, 10, 80) - share(frame, 200, 250);
    let across = share(frame, 90, 150) - share(frame, 160, 200);
    let side = if number == 0 { 1.0 } else { -1.0 };
    vec![0.9 * up, side * 0.5 * across, 0.0, 0.4 * up, 0.2 * up]
}

// What the benches measure.

/// Two arms, free, or as far into a wall as a third of a metre.
fn arms(wall: bool) -> Scene {
    let mut world = world();
    if wall {
        let pose = Pose::at(0.0, 1.0, -0.6);
        add_box(&mut world, BodyKind::Fixed, pose, [1.0, 1.0, 0.2]);
    }
    let root = Pose::at(0.0, 1.4, 0.0);
    let body = add_body(&mut world, BodyKind::Driven, root);
    let arms = add_arms(&mut world, body, ARM_OPTIONS);
    let mut scene = Scene::new(world, body).driven_by(body, |_| Pose::at(0.0, 1.4, 0.0));
    scene.limbs = arms;
    scene.posture = |frame, _| {
        let up = share(frame, 0, 100);
        vec![1.4 * up, 0.1 * up, 0.0, 0.2, 0.0]
    };
    scene
}

/// Two arms swing in free air.
pub fn free_arms() -> Scene {
    arms(false)
}

/// Two arms are pushed into a wall.
pub fn arms_at_a_wall() -> Scene {
    arms(true)
}

/// So many points of a sphere, none of which is inside the hull of the others, by stereographic
/// projection of points of the unit square, alternating between the two halves.
pub fn blob(count: u32, radius_m: f32) -> Vec<[f32; 3]> {
    (0..count)
        .map(|number| {
            // Steps of the R2 sequence (Roberts 2018): even, and no two faces are parallel.
            let u = fraction(number, 3_242_174_889);
            let v = fraction(number, 2_447_445_414);
            let square = u * u + v * v;
            let height = (1.0 - square) / (1.0 + square);
            let side = if number % 2 == 0 { height } else { -height };
            let scale = 2.0 * radius_m / (1.0 + square);
            [scale * u, radius_m * side, scale * v]
        })
        .collect()
}

/// A number from -0.85 to 0.85: the upper bits of a multiple.
fn fraction(number: u32, step: u32) -> f32 {
    let bits = number.wrapping_mul(step).wrapping_add(1 << 28) >> 12;
    (bits as f32 / (1 << 20) as f32 - 0.5) * 1.7
}

/// A rounded rod along z: four rings of eight points within these half extents.
pub fn rod(half: [f32; 3]) -> Vec<[f32; 3]> {
    const DIAGONAL: f32 = 0.707_106_77;
    const RING: [[f32; 2]; 8] = [
        [1.0, 0.0],
        [DIAGONAL, DIAGONAL],
        [0.0, 1.0],
        [-DIAGONAL, DIAGONAL],
        [-1.0, 0.0],
        [-DIAGONAL, -DIAGONAL],
        [0.0, -1.0],
        [DIAGONAL, -DIAGONAL],
    ];
    let rings = [(-1.0, 0.6), (-0.6, 1.0), (0.6, 1.0), (1.0, 0.6)];
    rings
        .iter()
        .flat_map(|&(z, scale)| {
            RING.map(|[x, y]| [scale * x * half[0], scale * y * half[1], z * half[2]])
        })
        .collect()
}

/// A flat hand of 18 hulls of 32 points, as many parts as the hand of Schmidl and Lin 2004 has.
pub fn add_hand(world: &mut World, pose: Pose) -> BodyId {
    let hand = add_body(world, BodyKind::Driven, pose);
    add_rod(world, hand, [0.025, 0.015, 0.03], [0.0, 0.0, 0.06]);
    add_rod(world, hand, [0.02, 0.014, 0.045], [-0.02, 0.0, -0.005]);
    add_rod(world, hand, [0.02, 0.014, 0.045], [0.02, 0.0, -0.005]);
    for bone in 0..3 {
        let along = bone as f32;
        let at = [-0.05 - 0.008 * along, 0.0, 0.01 - 0.03 * along];
        add_rod(world, hand, [0.009, 0.009, 0.018], at);
        for finger in 0..4 {
            let at = [-0.03 + 0.02 * finger as f32, 0.0, -0.06 - 0.03 * along];
            add_rod(world, hand, [0.008, 0.008, 0.017], at);
        }
    }
    hand
}

pub fn add_rod(world: &mut World, body: BodyId, half: [f32; 3], at: [f32; 3]) {
    let points = rod(half);
    let def = PieceDef {
        local: Pose::at(at[0], at[1], at[2]),
        material: Material::HUMAN,
        ..PieceDef::new(Shape::Hull(&points), 0.0)
    };
    add_piece(world, body, &def);
}

/// A table whose top is at y = 0, and boxes far from it, so many fixed pieces in all.
pub fn furnish(world: &mut World, pieces: u32) {
    if pieces > 0 {
        let pose = Pose::at(0.0, -0.02, 0.0);
        add_box(world, BodyKind::Fixed, pose, [1.5, 0.02, 1.0]);
    }
    // Rows of boxes behind it, 16 to a body, because a room has more pieces than things.
    let mut body = BodyId::NULL;
    for number in 1..pieces {
        if number % 16 == 1 {
            body = add_body(world, BodyKind::Fixed, Pose::at(0.0, 0.3, -2.0));
        }
        let (column, row) = (number % 8, number / 8);
        let def = PieceDef {
            local: Pose::at(-0.9 + 0.25 * column as f32, 0.0, -0.3 * row as f32),
            ..PieceDef::new(Shape::Box([0.1, 0.1, 0.1]), 0.0)
        };
        add_piece(world, body, &def);
    }
}

fn hand_scene(fixed_pieces: u32, script: Script) -> Scene {
    let mut world = world();
    furnish(&mut world, fixed_pieces);
    let hand = add_hand(&mut world, script(0));
    Scene::new(world, hand).driven_by(hand, script)
}

/// Nothing at all.
pub fn empty() -> Scene {
    Scene::new(world(), BodyId::NULL)
}

/// A hand moves through free air, 0.2 m above a table and beside so many fixed pieces in all.
pub fn free_hand(fixed_pieces: u32) -> Scene {
    hand_scene(fixed_pieces, |frame| {
        Pose::at(0.001 * frame as f32, 0.2, 0.0)
    })
}

/// A hand is pressed 0.1 m into a table and held there.
pub fn pressed_hand() -> Scene {
    hand_scene(56, |frame| {
        Pose::at(0.0, 0.1 - 0.2 * share(frame, 0, 30), 0.0)
    })
}

/// A hand is pressed 30 mm into a table and moves along it at 0.9 m/s.
pub fn slid_hand() -> Scene {
    hand_scene(56, |frame| {
        let slid = share(frame, 30, 130);
        let pressed = share(frame, 0, 20);
        Pose::at(-0.5 + slid, 0.1 - 0.13 * pressed, 0.0)
    })
}

/// A sphere rolls over a table.
pub fn rolling_sphere() -> Scene {
    let mut world = world();
    furnish(&mut world, 1);
    let sphere = add_sphere(&mut world, Pose::at(-1.0, 0.0503, 0.0), 0.05);
    world
        .set_velocity(sphere, [0.6, 0.0, 0.0], [0.0, 0.0, -12.0])
        .unwrap();
    Scene::new(world, sphere)
}
