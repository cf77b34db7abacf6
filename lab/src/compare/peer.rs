//! Rapier as an engine, the way 'physics hands' are made with it: each hand is one dynamic body of the
//! same convex parts, without gravity, that a drive pulls to its tracker.

use palpable::math::Pose;
use rapier3d::prelude as rapier;

use super::drive::{Drive, HandDrive};
use super::play::Engine;
use super::setting::{FRICTION, Fixed, HAND_MASS_KG, Loose, LooseShape, RATE_HZ, Setting, Tracked};
use crate::hand_scene::SceneError;

/// Steps of the engine a frame. Fewer let a slap through, more cost time and gain little.
pub const SUBSTEPS: u32 = 4;

/// Iterations of the solver a step. Its own default of four costs twice as much and, with four steps a
/// frame already, makes a pressed hand no shallower and a stiffly driven one tremble.
const SOLVER_ITERATIONS: usize = 1;

/// Natural frequency of contacts in Hz: with 120 a pressed hand sinks in three times as deep, with the
/// engine's own 30 and 60 more.
const CONTACT_HZ: f32 = 240.0;

/// Extents of a hand in metres, across, through and along: what its inertia is taken from.
const HAND_EXTENTS_M: [f32; 3] = [0.10, 0.04, 0.19];
/// The hand's centre of mass in the wrist's frame, in metres.
const HAND_CENTRE_M: [f32; 3] = [0.0, -0.01, -0.08];

struct PeerHand {
    body: rapier::RigidBodyHandle,
    colliders: Vec<rapier::ColliderHandle>,
    drive: HandDrive,
}

/// A setting in a world of Rapier.
pub struct Peer {
    world: rapier::PhysicsWorld,
    fixed: Vec<rapier::RigidBodyHandle>,
    loose: Vec<rapier::RigidBodyHandle>,
    hands: Vec<PeerHand>,
}

/// A pose for Rapier.
#[must_use]
pub fn to_peer(pose: &Pose) -> rapier::Pose {
    let [x, y, z, w] = pose.rotation;
    let rotation = rapier::Rotation::from_xyzw(x, y, z, w).normalize();
    rapier::Pose::from_parts(rapier::Vector::from_array(pose.position), rotation)
}

/// A pose from Rapier.
#[must_use]
pub fn from_peer(pose: &rapier::Pose) -> Pose {
    Pose {
        rotation: pose.rotation.to_array(),
        position: pose.translation.to_array(),
    }
}

/// An empty world with the best settings found: stiff contacts, continuous collision detection, and
/// steps of a part of a frame.
#[must_use]
pub fn tuned_world(substeps: u32) -> rapier::PhysicsWorld {
    let mut world = rapier::PhysicsWorld::new();
    let parameters = &mut world.integration_parameters;
    parameters.dt = 1.0 / (RATE_HZ * substeps as f32);
    parameters.contact_softness.natural_frequency = CONTACT_HZ;
    parameters.static_contact_softness.natural_frequency = CONTACT_HZ;
    parameters.num_solver_iterations = SOLVER_ITERATIONS;
    world
}

/// A collider of the hull of these points.
///
/// # Errors
/// [`SceneError`] when Rapier finds no hull.
pub fn hull(points: &[[f32; 3]]) -> Result<rapier::ColliderBuilder, SceneError> {
    let points: Vec<_> = points
        .iter()
        .map(|&p| rapier::Vector::from_array(p))
        .collect();
    let builder = rapier::ColliderBuilder::convex_hull(&points);
    builder.ok_or_else(|| SceneError("the peer finds no hull".to_owned()))
}

impl Peer {
    /// Fills a world.
    ///
    /// # Errors
    /// [`SceneError`] names what the engine refused.
    pub fn new(setting: &Setting, drive: Drive) -> Result<Self, SceneError> {
        let mut peer = Self {
            world: tuned_world(SUBSTEPS),
            fixed: Vec::new(),
            loose: Vec::new(),
            hands: Vec::new(),
        };
        for fixed in &setting.fixed {
            peer.add_fixed(fixed)?;
        }
        for loose in &setting.loose {
            peer.add_loose(loose);
        }
        for hand in &setting.hands {
            peer.add_hand(hand, drive)?;
        }
        Ok(peer)
    }

    fn add_fixed(&mut self, fixed: &Fixed) -> Result<(), SceneError> {
        let body = rapier::RigidBodyBuilder::fixed().pose(to_peer(&fixed.object.pose));
        let body = self.world.insert_body(body);
        for piece in &fixed.object.pieces {
            let collider = match piece.half_extents {
                Some([x, y, z]) => rapier::ColliderBuilder::cuboid(x, y, z),
                None => hull(&piece.points)?,
            };
            let collider = collider.position(to_peer(&piece.local)).friction(FRICTION);
            self.world.insert_collider(collider, Some(body));
        }
        self.fixed.push(body);
        Ok(())
    }

    fn add_loose(&mut self, loose: &Loose) {
        let body = rapier::RigidBodyBuilder::dynamic()
            .pose(to_peer(&loose.pose))
            .ccd_enabled(true);
        let body = self.world.insert_body(body);
        let collider = match loose.shape {
            LooseShape::Sphere(radius_m) => rapier::ColliderBuilder::ball(radius_m),
            LooseShape::Box([x, y, z]) => rapier::ColliderBuilder::cuboid(x, y, z),
        };
        let collider = collider.mass(loose.mass_kg).friction(FRICTION);
        self.world.insert_collider(collider, Some(body));
        self.loose.push(body);
    }

    fn add_hand(&mut self, hand: &Tracked, drive: Drive) -> Result<(), SceneError> {
        let wrist = to_peer(&hand.wrist.first().copied().unwrap_or_default());
        let mass = hand_mass();
        let body = rapier::RigidBodyBuilder::dynamic()
            .pose(wrist)
            .gravity_scale(0.0)
            .additional_mass_properties(mass)
            .can_sleep(false)
            .ccd_enabled(true);
        let body = self.world.insert_body(body);
        let mut colliders = Vec::new();
        for (points, local) in hand.model.points.iter().zip(&hand.model.locals) {
            let collider = hull(points)?
                .position(to_peer(local))
                .density(0.0)
                .friction(FRICTION);
            colliders.push(self.world.insert_collider(collider, Some(body)));
        }
        self.hands.push(PeerHand {
            body,
            colliders,
            drive: HandDrive::new(drive, wrist, mass),
        });
        Ok(())
    }
}

/// What a hand weighs: the moments are those of a box of its extents.
fn hand_mass() -> rapier::MassProperties {
    let [x, y, z] = HAND_EXTENTS_M.map(|extent| extent * extent);
    let moments = rapier::Vector::new(y + z, x + z, x + y) * (HAND_MASS_KG / 12.0);
    let centre = rapier::Vector::from_array(HAND_CENTRE_M);
    rapier::MassProperties::new(centre, HAND_MASS_KG, moments)
}

impl Engine for Peer {
    fn remove_fixed(&mut self, index: usize) -> Result<(), SceneError> {
        let removed = self.world.remove_body(self.fixed[index]);
        let removed = removed.ok_or_else(|| SceneError("no such fixed thing".to_owned()));
        self.world.wake_up_all(true);
        removed.map(|_| ())
    }

    fn step(&mut self, wrists: &[Pose]) -> Result<(), SceneError> {
        let step_s = self.world.integration_parameters.dt;
        for (hand, wrist) in self.hands.iter_mut().zip(wrists) {
            hand.drive.track(to_peer(wrist));
        }
        for substep in 0..SUBSTEPS {
            for hand in &mut self.hands {
                let body = &mut self.world.bodies[hand.body];
                hand.drive.pull(body, substep, SUBSTEPS, step_s);
            }
            self.world.step();
        }
        Ok(())
    }

    fn parts(&self, hand: usize) -> Result<Vec<Pose>, SceneError> {
        let colliders = self.hands[hand].colliders.iter();
        let pose =
            |&handle: &rapier::ColliderHandle| from_peer(self.world.colliders[handle].position());
        Ok(colliders.map(pose).collect())
    }

    fn loose(&self, index: usize) -> Result<Pose, SceneError> {
        Ok(from_peer(self.world.bodies[self.loose[index]].position()))
    }
}
