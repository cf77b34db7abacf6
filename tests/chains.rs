//! Chains that are refused, and what the refusal leaves.

mod common;

use common::Block;
use glam::Vec3;
use palpable::geometry::chain::{Hinge, JointDef};
use palpable::math::Pose;
use palpable::memory::Capacities;
use palpable::state::bodies::BodyKind;
use palpable::state::chains::ChainOptions;
use palpable::world::{AddChainError, BodyDef, ChainDef, World};

#[test]
fn an_axis_with_any_part_not_a_number_is_refused() {
    let mut block = Block::new(&Capacities::ROOM);
    let mut world = World::create(block.bytes(), &Capacities::ROOM).unwrap();
    let body = world
        .add_body(&BodyDef::new(BodyKind::Driven, Pose::IDENTITY))
        .unwrap();
    let before = world.hash();
    for part in 0..3 {
        for bad in [f32::NAN, f32::INFINITY] {
            let mut axis = [1.0; 3];
            axis[part] = bad;
            let hinge = Hinge {
                rest: Pose::IDENTITY,
                axis: Vec3::from_array(axis),
                low_rad: -1.0,
                high_rad: 1.0,
            };
            let def = ChainDef {
                joints: &[JointDef::Hinge(hinge)],
                base: None,
                options: ChainOptions::DEFAULT,
            };
            let added = world.add_chain(body, &def);
            assert_eq!(added, Err(AddChainError::BadAxis), "{axis:?}");
            assert_eq!(world.hash(), before);
        }
    }
}
