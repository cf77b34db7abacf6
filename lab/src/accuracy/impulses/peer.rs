//! rapier3d as an engine under test.
//!
//! Both bodies of a contact carry the scene's coefficients, so that rapier's usual mean of the two is
//! the scene's.

use glam::{DQuat, DVec3};
use rapier3d::prelude::{
    ColliderBuilder, PhysicsWorld, Pose, RigidBodyBuilder, RigidBodyHandle, Rotation, Vector,
};

use super::engine::Engine;
use super::scene::{Body, BodyState, Form, Scene};

/// How rapier is tuned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tuning {
    /// As it comes: one step a frame, four solver iterations.
    Usual,
    /// Every frame in four steps, continuous collision detection, and contacts found anew in each step.
    /// Its friction stays the usual one: with that of every contact point, `FrictionModel::Coulomb`, the
    /// sliding block stops 6.8 % late at any rate. More solver iterations gained nothing at 1000 Hz.
    Best,
}

/// Steps of a frame of [`Tuning::Best`].
const STEPS_BEST: u32 = 4;

/// Steps of continuous collision detection within one step of [`Tuning::Best`].
const CCD_STEPS_BEST: usize = 4;

/// A world of rapier and the handles of the scene's bodies.
pub struct Peer {
    world: PhysicsWorld,
    bodies: Vec<RigidBodyHandle>,
    steps: u32,
}

/// A vector as rapier has it.
pub fn single(v: DVec3) -> Vector {
    Vector::from_array(v.as_vec3().to_array())
}

fn double(v: Vector) -> DVec3 {
    DVec3::from_array(v.to_array().map(f64::from))
}

impl Peer {
    /// A world of this scene.
    pub fn new(scene: &Scene, tuning: Tuning) -> Self {
        let mut world = PhysicsWorld {
            gravity: single(scene.gravity),
            ..PhysicsWorld::default()
        };
        let steps = tune(&mut world, tuning);
        let bodies = scene.bodies.iter();
        let bodies = bodies.map(|body| add(&mut world, scene, body, tuning));
        let bodies = bodies.collect();
        Self {
            world,
            bodies,
            steps,
        }
    }
}

/// Sets the parameters; how many steps a frame is cut into.
pub fn tune(world: &mut PhysicsWorld, tuning: Tuning) -> u32 {
    if tuning == Tuning::Usual {
        return 1;
    }
    let parameters = &mut world.integration_parameters;
    parameters.max_ccd_substeps = CCD_STEPS_BEST;
    parameters.contact_recycling = false;
    parameters.warmstart_joints = true;
    STEPS_BEST
}

fn add(world: &mut PhysicsWorld, scene: &Scene, body: &Body, tuning: Tuning) -> RigidBodyHandle {
    let builder = match body.density_kg_m3 {
        Some(_) => RigidBodyBuilder::dynamic(),
        None => RigidBodyBuilder::fixed(),
    };
    let rotation = Rotation::from_array(body.rotation.as_quat().to_array());
    let builder = builder
        .pose(Pose::from_parts(single(body.position), rotation))
        .linvel(single(body.velocity))
        .angvel(single(body.spin))
        .gyroscopic_forces_enabled(true)
        .allow_fast_rotation(true)
        .can_sleep(scene.may_sleep)
        .ccd_enabled(tuning == Tuning::Best);
    let collider = match body.form {
        Form::Ball(radius) => ColliderBuilder::ball(radius as f32),
        Form::Box([x, y, z]) => ColliderBuilder::cuboid(x as f32, y as f32, z as f32),
        Form::Capsule(half, radius) => ColliderBuilder::capsule_y(half as f32, radius as f32),
    };
    let collider = collider
        .density(body.density_kg_m3.unwrap_or(1.0) as f32)
        .restitution(scene.restitution as f32)
        .friction(scene.friction as f32);
    world.insert(builder, collider).0
}

impl Engine for Peer {
    fn step(&mut self, dt_s: f64) {
        let dt = (dt_s / f64::from(self.steps)) as f32;
        self.world.integration_parameters.dt = dt;
        // As a hundredth of a step, which is what it is at 60 Hz by default.
        self.world.integration_parameters.min_ccd_dt = dt / 100.0;
        for _ in 0..self.steps {
            self.world.step();
        }
    }

    fn state(&self, body: usize) -> BodyState {
        let body = &self.world.bodies[self.bodies[body]];
        let rotation = body.rotation().to_array().map(f64::from);
        BodyState {
            position: double(body.translation()),
            rotation: DQuat::from_array(rotation).normalize(),
            velocity: double(body.linvel()),
            spin: double(body.angvel()),
        }
    }

    fn set_velocity(&mut self, body: usize, velocity: DVec3, spin: DVec3) {
        let body = &mut self.world.bodies[self.bodies[body]];
        body.set_linvel(single(velocity), true);
        body.set_angvel(single(spin), true);
    }

    fn set_gravity(&mut self, gravity: DVec3) {
        self.world.gravity = single(gravity);
    }
}
