//! Loose bodies and what they stand on, judged from poses and sizes in f64.
#![allow(
    dead_code,
    unreachable_pub,
    reason = "every test file uses a part of it"
)]

use palpable::math::Pose;
use palpable::memory::BodyId;
use palpable::state::bodies::BodyKind;
use palpable::state::materials::{Material, Surface};
use palpable::world::{BodyDef, PieceDef, Shape, World};

use crate::common::{add_box, add_piece};

/// A floor whose top is at y = 0.
pub fn floor(world: &mut World) -> BodyId {
    // Top at y = 0.
    add_box(
        world,
        BodyKind::Fixed,
        Pose::at(0.0, -0.5, 0.0),
        [20.0, 0.5, 20.0],
    )
}

/// A sphere as a body of its own.
pub fn ball(world: &mut World, kind: BodyKind, at: [f32; 3], radius_m: f32) -> BodyId {
    let body = world
        .add_body(&BodyDef::new(kind, Pose::at(at[0], at[1], at[2])))
        .unwrap();
    add_piece(world, body, &PieceDef::new(Shape::Point, radius_m));
    body
}

/// How wood meets wood.
pub fn surface(world: &mut World, restitution: f32, friction: f32) {
    let surface = Surface {
        restitution,
        friction,
    };
    world
        .set_surface(Material::WOOD, Material::WOOD, surface)
        .unwrap();
}

/// Where a body is.
pub fn position(world: &World, body: BodyId) -> [f64; 3] {
    world.pose(body).unwrap().position.map(f64::from)
}

/// Height of a box's lowest corner above y = 0.
pub fn lowest_corner(pose: &Pose, half: [f32; 3]) -> f64 {
    let [x, y, z, w] = pose.rotation.map(f64::from);
    // Second row of the rotation matrix.
    let row = [
        2.0 * (x * y + z * w),
        1.0 - 2.0 * (x * x + z * z),
        2.0 * (y * z - x * w),
    ];
    let reach: f64 = (0..3).map(|i| row[i].abs() * f64::from(half[i])).sum();
    f64::from(pose.position[1]) - reach
}
