//! What a host does to loose bodies, and what it reads of them.

use bytemuck::{Pod, Zeroable};
use glam::{Quat, Vec3};

use super::{BodyError, World};
use crate::limits::{FORCE_MAX, SPEED_MAX, SPIN_MAX, WORLD_REACH_M};
use crate::math::Pose;
use crate::memory::BodyId;
use crate::publish::place_pieces;
use crate::recording::CallKind;
use crate::state::bodies::{BodyKind, BodyMass, HostedImpulse};
use crate::state::events::ContactEvent;

/// A body of the host's own physics engine, as the host has it before a frame.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct HostedInput {
    /// A body of the kind [`BodyKind::Hosted`].
    pub body: BodyId,
    /// Where it is.
    pub pose: Pose,
    /// Velocity of its centre of mass, in m/s.
    pub velocity: [f32; 3],
    /// Angular velocity in the world, in rad/s.
    pub spin: [f32; 3],
    /// Mass in kg; zero for one that nothing moves.
    pub mass_kg: f32,
    /// Centre of mass in the body's frame, in metres.
    pub centre: [f32; 3],
    /// Principal moments of inertia about the centre of mass, in kg m2; above zero when the mass is.
    pub moments: [f32; 3],
    /// Orientation of the principal axes in the body's frame, x y z w.
    pub axes: [f32; 4],
}

/// The first of several hosted bodies that was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HostedError {
    /// Its place among those given.
    pub index: usize,
    /// Why; a mass or a moment that is not one is a [`BodyError::BadMass`].
    pub error: BodyError,
}

impl World<'_> {
    /// Adds a force (N) and a torque about the centre of mass (N m), both in the world, that act on a
    /// dynamic body over the whole of the next frame, and wakes it.
    ///
    /// # Errors
    /// [`BodyError`]; [`BodyError::BadForce`] for a coordinate that is not finite or beyond
    /// [`FORCE_MAX`].
    pub fn apply_force(
        &mut self,
        id: BodyId,
        force: [f32; 3],
        torque: [f32; 3],
    ) -> Result<(), BodyError> {
        self.recorded(
            CallKind::ApplyForce,
            |to| {
                to.pod(&id);
                to.pod(&[force, torque]);
            },
            |world| world.take_force(id, force, torque),
        )
    }

    fn take_force(
        &mut self,
        id: BodyId,
        force: [f32; 3],
        torque: [f32; 3],
    ) -> Result<(), BodyError> {
        let body = self.index_of_kind(id, BodyKind::Dynamic)?;
        let load = &mut self.state.bodies.load[body];
        let force = load.force + Vec3::from_array(force);
        let torque = load.torque + Vec3::from_array(torque);
        if !is_within(force, FORCE_MAX) || !is_within(torque, FORCE_MAX) {
            return Err(BodyError::BadForce);
        }
        load.force = force;
        load.torque = torque;
        self.wake_one(body);
        Ok(())
    }

    /// Changes a dynamic body's motion at once by an impulse (N s) at a point, both in the world, and
    /// wakes it. What would become faster than [`SPEED_MAX`] or [`SPIN_MAX`] becomes just as fast.
    ///
    /// # Errors
    /// [`BodyError`]; [`BodyError::BadForce`] for a coordinate that is not finite or beyond
    /// [`FORCE_MAX`], [`BodyError::BadPose`] for a point beyond [`WORLD_REACH_M`].
    pub fn apply_impulse(
        &mut self,
        id: BodyId,
        impulse: [f32; 3],
        point: [f32; 3],
    ) -> Result<(), BodyError> {
        self.recorded(
            CallKind::ApplyImpulse,
            |to| {
                to.pod(&id);
                to.pod(&[impulse, point]);
            },
            |world| world.take_impulse(id, impulse, point),
        )
    }

    fn take_impulse(
        &mut self,
        id: BodyId,
        impulse: [f32; 3],
        point: [f32; 3],
    ) -> Result<(), BodyError> {
        let body = self.index_of_kind(id, BodyKind::Dynamic)?;
        let (impulse, point) = (Vec3::from_array(impulse), Vec3::from_array(point));
        if !is_within(impulse, FORCE_MAX) {
            return Err(BodyError::BadForce);
        }
        if !is_within(point, WORLD_REACH_M) {
            return Err(BodyError::BadPose);
        }
        let mass = self.state.bodies.mass[body];
        let pose = self.state.bodies.pose[body];
        let arm = point - pose.point(mass.centre);
        self.state.bodies.momentum[body].strike(&mass, pose.quat(), impulse, arm);
        self.wake_one(body);
        Ok(())
    }

    /// Wakes a body; driven bodies that lean on sleepers look again.
    pub(crate) fn wake_one(&mut self, body: usize) {
        let momentum = &mut self.state.bodies.momentum[body];
        momentum.asleep = 0;
        momentum.still_s = 0.0;
        for yielding in self.state.bodies.yielding.iter_mut() {
            yielding.leans = 0;
        }
        for settled in self.state.bodies.settled.iter_mut() {
            settled.is_settled = 0;
        }
    }

    /// Whether a dynamic body sleeps: it and all it leans on have been still for a while.
    ///
    /// # Errors
    /// [`BodyError::Stale`], [`BodyError::WrongKind`].
    pub fn is_asleep(&self, id: BodyId) -> Result<bool, BodyError> {
        let body = self.index_of_kind(id, BodyKind::Dynamic)?;
        Ok(self.state.bodies.momentum[body].asleep == 1)
    }

    /// Tells where the host's own bodies are, how they move and what they weigh, before a frame. Driven
    /// bodies make room for them, push, squeeze and hold them; [`World::hosted_impulse`] is what that did to
    /// them. A body that is not told of stays where it is, or where contact with the kernel's own bodies
    /// brought it.
    ///
    /// All that are good are taken.
    ///
    /// # Errors
    /// [`HostedError`] names the first that was not, which stays as it was.
    pub fn set_hosted(
        &mut self,
        inputs: impl IntoIterator<Item = HostedInput>,
    ) -> Result<(), HostedError> {
        let mut first = Ok(());
        for (index, input) in inputs.into_iter().enumerate() {
            let taken = self.recorded(
                CallKind::SetHosted,
                |to| to.pod(&input),
                |world| world.set_one_hosted(&input),
            );
            if let Err(error) = taken
                && first.is_ok()
            {
                first = Err(HostedError { index, error });
            }
        }
        first
    }

    fn set_one_hosted(&mut self, input: &HostedInput) -> Result<(), BodyError> {
        let body = self.index_of_kind(input.body, BodyKind::Hosted)?;
        let pose = input
            .pose
            .normalised(WORLD_REACH_M)
            .ok_or(BodyError::BadPose)?;
        let mass = input.mass().ok_or(BodyError::BadMass)?;
        let velocity = Vec3::from_array(input.velocity);
        let spin = Vec3::from_array(input.spin);
        if !is_within(velocity, SPEED_MAX) || !is_within(spin, SPIN_MAX) {
            return Err(BodyError::BadVelocity);
        }
        let bodies = &mut self.state.bodies;
        let moved = bodies.pose[body] != pose;
        bodies.pose[body] = pose;
        bodies.mass[body] = mass;
        bodies.momentum[body].velocity = velocity;
        bodies.momentum[body].angular = mass.inertia(pose.quat()) * spin;
        bodies.momentum[body].asleep = 0;
        if moved {
            place_pieces(&mut self.state, body);
        }
        Ok(())
    }

    /// What the kernel's bodies did to a hosted body in the last frame. The host's engine is to apply it
    /// before its own step.
    ///
    /// The kernel foresees that gravity acts at once, at the start of the step, as the impulse does. An
    /// engine that spreads gravity over substeps lifts a held body by up to half of g times the square of
    /// the step; it is better to switch gravity off for a body that was touched, and to add its weight
    /// times the step to the impulse.
    ///
    /// # Errors
    /// [`BodyError::Stale`], [`BodyError::WrongKind`].
    pub fn hosted_impulse(&self, id: BodyId) -> Result<HostedImpulse, BodyError> {
        let body = self.index_of_kind(id, BodyKind::Hosted)?;
        Ok(self.state.bodies.hosted[body])
    }

    /// What began to touch, stayed and parted in the last frame. What found no room is counted in
    /// [`crate::frame::FrameReport::events_dropped`]; there is room for
    /// [`crate::memory::Capacities::contacts`], and what stays is dropped first.
    #[must_use]
    pub fn contact_events(&self) -> &[ContactEvent] {
        &self.state.events.list[..self.state.registers.events as usize]
    }
}

impl HostedInput {
    fn mass(&self) -> Option<BodyMass> {
        let moments = Vec3::from_array(self.moments);
        let centre = Vec3::from_array(self.centre);
        let frame = Pose::new(Quat::from_array(self.axes), centre).normalised(WORLD_REACH_M)?;
        if self.mass_kg == 0.0 {
            return Some(BodyMass {
                centre,
                axes: frame.rotation,
                ..BodyMass::default()
            });
        }
        let range = 1e-9..=1e9;
        let good = [self.mass_kg, moments.x, moments.y, moments.z]
            .iter()
            .all(|number| range.contains(number));
        good.then(|| BodyMass {
            mass_kg: self.mass_kg,
            inverse_mass: 1.0 / self.mass_kg,
            centre,
            moments,
            inverse_moments: 1.0 / moments,
            axes: frame.rotation,
        })
    }
}

fn is_within(v: Vec3, limit: f32) -> bool {
    v.abs().cmple(Vec3::splat(limit)).all()
}
