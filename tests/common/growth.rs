//! Worlds that grow by one thing at a time, for what each more of it costs.
#![allow(dead_code, unreachable_pub, reason = "benches use a part of it")]

use palpable::geometry::chain::{Hinge, JointDef};
use palpable::math::Pose;
use palpable::memory::Capacities;
use palpable::state::bodies::BodyKind;
use palpable::state::chains::ChainOptions;
use palpable::world::{ChainDef, PieceDef, Shape, World};

use crate::common::{Block, add_box, add_piece};
use crate::scenes::{FRAME_S, Scene, add_body, add_hand, add_rod, furnish};

/// Room for the largest of them.
const CAPACITIES: Capacities = Capacities {
    bodies: 128,
    chains: 64,
    joints: 256,
    ..Capacities::ROOM
};

fn world() -> World<'static> {
    with(&CAPACITIES)
}

fn with(capacities: &Capacities) -> World<'static> {
    let block = Box::leak(Box::new(Block::new(capacities)));
    World::create(block.bytes(), capacities).unwrap()
}

/// Nothing, where there is room for a thousand bodies.
pub fn empty_with_much_room() -> Scene {
    let capacities = Capacities {
        bodies: 1024,
        pieces: 4096,
        vertices: 32_768,
        pairs: 8192,
        contacts: 4096,
        materials: 64,
        chains: 256,
        joints: 1024,
    };
    Scene::new(with(&capacities), palpable::memory::BodyId::NULL)
}

/// So many boxes that lie on a floor, far from each other, frames before they sleep.
pub fn boxes_awake(count: u32) -> Scene {
    boxes(count).after(6)
}

/// The same boxes asleep.
pub fn boxes_asleep(count: u32) -> Scene {
    let mut scene = boxes(count);
    // Long frames: they fall asleep sooner.
    scene.length_s = |frame| if frame < 30 { 0.05 } else { FRAME_S };
    let mut scene = scene.after(30);
    assert_eq!(scene.step().impulse_units, 0, "they do not sleep");
    scene
}

fn boxes(count: u32) -> Scene {
    let mut world = world();
    let ground = Pose::at(0.0, -0.5, 0.0);
    let mut shown = add_box(&mut world, BodyKind::Fixed, ground, [5.0, 0.5, 5.0]);
    for number in 0..count {
        let x = 0.5 * (number % 8) as f32 - 2.0;
        let z = 0.5 * (number / 8) as f32 - 2.0;
        let pose = Pose::at(x, 0.0502, z);
        shown = add_box(&mut world, BodyKind::Dynamic, pose, [0.05; 3]);
    }
    Scene::new(world, shown)
}

/// A hand moves freely beside so many fixed pieces.
pub fn beside_pieces(count: u32) -> Scene {
    let mut world = world();
    furnish(&mut world, count);
    let hand = add_hand(&mut world, Pose::at(0.0, 0.2, 0.0));
    moving(Scene::new(world, hand))
}

/// A hand of so many pieces moves freely beside 16 fixed ones.
pub fn hand_pieces(count: u32) -> Scene {
    let mut world = world();
    furnish(&mut world, 16);
    let hand = add_body(&mut world, BodyKind::Driven, Pose::at(0.0, 0.2, 0.0));
    for number in 0..count {
        let (column, row) = (number % 8, number / 8);
        let at = [0.02 * column as f32, 0.0, 0.02 * row as f32];
        add_rod(&mut world, hand, [0.008, 0.008, 0.009], at);
    }
    moving(Scene::new(world, hand))
}

fn moving(scene: Scene) -> Scene {
    let hand = scene.shown;
    scene
        .driven_by(hand, |frame| Pose::at(0.001 * frame as f32, 0.2, 0.0))
        .after(5)
}

/// Driven bodies of four chains each, so many chains in all, of two hinges each, bend in free air.
pub fn chains(count: u32) -> Scene {
    let mut world = world();
    let hinge = |x: f32| {
        JointDef::Hinge(Hinge {
            rest: Pose::at(x, 0.0, 0.0),
            axis: glam::Vec3::Z,
            low_rad: -1.0,
            high_rad: 1.0,
        })
    };
    let mut body = palpable::memory::BodyId::NULL;
    let mut limbs = vec![];
    for number in 0..count {
        if number % 4 == 0 {
            let at = Pose::at(0.5 * (number / 4) as f32, 1.0, 0.0);
            body = add_body(&mut world, BodyKind::Driven, at);
        }
        let def = ChainDef {
            joints: &[hinge(0.05), hinge(0.1)],
            base: None,
            options: ChainOptions::DEFAULT,
        };
        let chain = world.add_chain(body, &def).unwrap();
        let shape = Shape::Segment([0.0; 3], [0.08, 0.0, 0.0]);
        world
            .add_link_piece(chain, 1, &PieceDef::new(shape, 0.01))
            .unwrap();
        limbs.push(chain);
    }
    let mut scene = Scene::new(world, body);
    scene.limbs = limbs;
    scene.posture = |frame, _| vec![0.01 * frame as f32, 0.0];
    scene.after(5)
}

/// One loose body stands on a floor with so many feet.
pub fn contacts(count: u32) -> Scene {
    let mut world = world();
    let ground = Pose::at(0.0, -0.5, 0.0);
    add_box(&mut world, BodyKind::Fixed, ground, [5.0, 0.5, 5.0]);
    let table = add_body(&mut world, BodyKind::Dynamic, Pose::at(0.0, 0.0502, 0.0));
    for number in 0..count {
        let (column, row) = (number % 8, number / 8);
        let def = PieceDef {
            local: Pose::at(0.2 * column as f32, 0.0, 0.2 * row as f32),
            ..PieceDef::new(Shape::Point, 0.05)
        };
        add_piece(&mut world, table, &def);
    }
    Scene::new(world, table).after(6)
}

/// A driven body that the host put into fixed boxes, so many of its pieces into one each; the frame that leads it out.
pub fn overlaps(count: u32) -> Scene {
    let mut world = world();
    let body = add_body(&mut world, BodyKind::Driven, Pose::IDENTITY);
    for number in 0..count {
        let at = [0.2 * (number % 8) as f32, 0.0, 0.2 * (number / 8) as f32];
        add_rod(&mut world, body, [0.03, 0.02, 0.04], at);
        // Each a little otherwise: aside by up to 20 mm, and turned.
        let aside = |salt: u32| 0.005 * ((number * salt) % 9) as f32 - 0.02;
        let at = glam::Vec3::from(at) + glam::Vec3::new(aside(2), aside(4), aside(7));
        let turn = glam::Quat::from_rotation_y(0.3 * number as f32);
        add_box(&mut world, BodyKind::Fixed, Pose::new(turn, at), [0.03; 3]);
    }
    Scene::new(world, body)
}
