//! What the integration tests share: memory for a world, and the world's usual furniture.
#![allow(
    dead_code,
    unreachable_pub,
    reason = "every test file uses a part of it"
)]

use palpable::math::Pose;
use palpable::memory::{BodyId, Capacities, PieceId};
use palpable::state::bodies::BodyKind;
use palpable::world::{BodyDef, PieceDef, Shape, World};

/// One cache line, so that a vector of them is aligned as a world needs it.
#[repr(C, align(64))]
#[derive(Clone, Copy)]
pub struct Line(pub [u8; 64]);

/// Memory for a world, aligned.
pub struct Block(Vec<Line>);

impl Block {
    pub fn new(capacities: &Capacities) -> Self {
        Self(vec![Line([0; 64]); capacities.bytes().div_ceil(64)])
    }

    pub fn bytes(&mut self) -> &mut [u8] {
        bytes_of(&mut self.0)
    }
}

fn bytes_of(lines: &mut [Line]) -> &mut [u8] {
    let length = lines.len() * 64;
    // SAFETY: a line is 64 initialised bytes without padding, and bytes have no invalid values.
    unsafe { core::slice::from_raw_parts_mut(lines.as_mut_ptr().cast(), length) }
}

/// Adds a box with these half extents as a body of its own.
pub fn add_box(world: &mut World, kind: BodyKind, pose: Pose, half: [f32; 3]) -> BodyId {
    let body = world.add_body(&BodyDef::new(kind, pose)).unwrap();
    add_piece(world, body, &PieceDef::new(Shape::Box(half), 0.0));
    body
}

pub fn add_piece(world: &mut World, body: BodyId, def: &PieceDef) -> PieceId {
    world.add_piece(body, def).unwrap()
}
