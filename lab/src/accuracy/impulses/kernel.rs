//! The kernel as an engine under test.

use glam::{DQuat, DVec3};
use palpable::frame::FrameInput;
use palpable::math::Pose;
use palpable::memory::{BodyId, Capacities};
use palpable::state::bodies::BodyKind;
use palpable::state::materials::{Material, Surface};
use palpable::world::{BodyDef, PieceDef, Shape, World};

use super::engine::Engine;
use super::scene::{Body, BodyState, Form, Scene};
use crate::memory::Block;

/// A world of the kernel and the ids of the scene's bodies.
pub struct Kernel<'a> {
    world: World<'a>,
    bodies: Vec<BodyId>,
}

fn single(v: DVec3) -> [f32; 3] {
    v.as_vec3().to_array()
}

fn double(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}

/// Memory for the world of a scene.
pub fn block(scene: &Scene) -> Block {
    Block::new(&capacities(scene))
}

impl<'a> Kernel<'a> {
    /// A world of this scene in memory that [`block`] made for it.
    ///
    /// # Panics
    /// When the scene has what the kernel refuses.
    pub fn new(scene: &Scene, block: &'a mut Block) -> Self {
        let mut world = World::create(block.bytes(), &capacities(scene)).expect("room");
        world.set_gravity(single(scene.gravity));
        let surface = Surface {
            restitution: scene.restitution as f32,
            friction: scene.friction as f32,
        };
        let wood = Material::WOOD;
        let set = world.set_surface(wood, wood, surface);
        set.expect("a valid surface");
        let bodies = scene.bodies.iter().map(|body| add(&mut world, body));
        let bodies = bodies.collect();
        Self { world, bodies }
    }
}

impl Engine for Kernel<'_> {
    fn step(&mut self, dt_s: f64) {
        self.world.step(&FrameInput::unlimited(dt_s as f32));
    }

    fn state(&self, body: usize) -> BodyState {
        let id = self.bodies[body];
        let pose = self.world.pose(id).expect("the scene's body");
        let (velocity, spin) = self.world.velocity(id).unwrap_or_default();
        BodyState {
            position: double(pose.position),
            rotation: DQuat::from_array(pose.rotation.map(f64::from)).normalize(),
            velocity: double(velocity),
            spin: double(spin),
        }
    }

    fn set_velocity(&mut self, body: usize, velocity: DVec3, spin: DVec3) {
        let set = self
            .world
            .set_velocity(self.bodies[body], single(velocity), single(spin));
        set.expect("a loose body and a valid velocity");
    }

    fn set_gravity(&mut self, gravity: DVec3) {
        self.world.set_gravity(single(gravity));
    }
}

fn capacities(scene: &Scene) -> Capacities {
    let count = scene.bodies.len() as u32;
    let pairs = count * (count - 1) / 2 + 1;
    Capacities {
        bodies: count,
        pieces: count,
        vertices: 8 * count,
        pairs,
        contacts: (4 * pairs).min(1024),
        materials: 0,
        chains: 0,
        joints: 0,
    }
}

fn add(world: &mut World, body: &Body) -> BodyId {
    let kind = match body.density_kg_m3 {
        Some(_) => BodyKind::Dynamic,
        None => BodyKind::Fixed,
    };
    let pose = Pose {
        rotation: body.rotation.as_quat().to_array(),
        position: single(body.position),
    };
    let id = world.add_body(&BodyDef::new(kind, pose)).expect("room");
    let (shape, radius_m) = match body.form {
        Form::Ball(radius) => (Shape::Point, radius),
        Form::Box(half) => (Shape::Box(half.map(|h| h as f32)), 0.0),
        Form::Capsule(half, radius) => {
            let half = half as f32;
            (Shape::Segment([0.0, -half, 0.0], [0.0, half, 0.0]), radius)
        }
    };
    let piece = PieceDef {
        density_kg_m3: body.density_kg_m3.unwrap_or(1.0) as f32,
        ..PieceDef::new(shape, radius_m as f32)
    };
    world.add_piece(id, &piece).expect("a valid piece");
    if kind == BodyKind::Dynamic {
        let (velocity, spin) = (single(body.velocity), single(body.spin));
        world
            .set_velocity(id, velocity, spin)
            .expect("a valid velocity");
    }
    id
}
