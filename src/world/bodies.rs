//! Adding, removing, placing and reading bodies.

use glam::Vec3;

use super::World;
use crate::limits::{SPEED_MAX, SPIN_MAX, WORLD_REACH_M};
use crate::math::Pose;
use crate::memory::ids::free_slot;
use crate::memory::{BodyId, PieceId};
use crate::publish::place_pieces;
use crate::recording::{CallKind, List, calls};
use crate::state::bodies::{
    BodyKind, BodyMass, Coupling, Displacement, DrivenReport, HostedImpulse, Load, Momentum,
    Settled, Tracker, Waiting, Yielding, is_loose_kind, share_within,
};
use crate::state::pieces::PiecesOf;

/// What a body is made from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyDef {
    /// What moves it.
    pub kind: BodyKind,
    /// Where it is.
    pub pose: Pose,
    /// The spring of a driven body; not looked at for others.
    pub coupling: Coupling,
}

impl BodyDef {
    /// A body of this kind at this pose, with the default coupling.
    #[must_use]
    pub const fn new(kind: BodyKind, pose: Pose) -> Self {
        Self {
            kind,
            pose,
            coupling: Coupling::DEFAULT,
        }
    }
}

/// Why a body was not added.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AddBodyError {
    /// No room: raise [`crate::memory::Capacities::bodies`].
    Full,
    /// A number is not finite, a coordinate is beyond [`WORLD_REACH_M`], or the orientation has no
    /// length.
    BadPose,
    /// [`Coupling::is_valid`] says no.
    BadCoupling,
}

/// Why something was not done to a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyError {
    /// The id names no body of this world.
    Stale,
    /// The body is of a kind that this cannot be done to.
    WrongKind,
    /// A number is not finite, a coordinate is beyond [`WORLD_REACH_M`], or an orientation has no
    /// length. The last good value stays.
    BadPose,
    /// There are not as many poses as the body has pieces.
    WrongCount,
    /// A velocity is not finite or too fast.
    BadVelocity,
    /// A force, a torque or an impulse is not finite or too large.
    BadForce,
    /// A mass or a moment of inertia is not one, or is out of range.
    BadMass,
    /// Two bodies are needed, and both ids name the same one.
    SameBody,
}

impl World<'_> {
    /// Adds a body without pieces.
    ///
    /// # Errors
    /// [`AddBodyError`].
    pub fn add_body(&mut self, def: &BodyDef) -> Result<BodyId, AddBodyError> {
        self.recorded(
            CallKind::AddBody,
            |to| calls::put_body(to, def),
            |world| world.take_body(def),
        )
    }

    fn take_body(&mut self, def: &BodyDef) -> Result<BodyId, AddBodyError> {
        let pose = def
            .pose
            .normalised(WORLD_REACH_M)
            .ok_or(AddBodyError::BadPose)?;
        if def.kind == BodyKind::Driven && !def.coupling.is_valid() {
            return Err(AddBodyError::BadCoupling);
        }
        let bodies = &mut self.state.bodies;
        let slot = free_slot(bodies.generation).ok_or(AddBodyError::Full)?;
        bodies.generation[slot] = bodies.generation[slot].wrapping_add(1);
        bodies.kind[slot] = def.kind.code();
        bodies.first_piece[slot] = 0;
        bodies.pose[slot] = pose;
        bodies.mass[slot] = BodyMass::default();
        bodies.momentum[slot] = Momentum::default();
        bodies.tracker[slot] = Tracker {
            target: pose,
            previous: pose,
            lost_s: 0.0,
            fresh: 0,
            seen: 0,
        };
        bodies.coupling[slot] = def.coupling;
        bodies.displacement[slot] = Displacement::default();
        bodies.report[slot] = DrivenReport::default();
        bodies.settled[slot] = Settled::default();
        bodies.waiting[slot] = Waiting::default();
        bodies.load[slot] = Load::default();
        bodies.hosted[slot] = HostedImpulse::default();
        bodies.yielding[slot] = Yielding::default();
        let id = BodyId::new(slot, bodies.generation[slot]);
        bodies.first_chain[slot] = 0;
        self.state.registers.driven += u32::from(def.kind == BodyKind::Driven);
        self.state.registers.loose += u32::from(is_loose_kind(def.kind.code()));
        let slots = &mut self.state.registers.body_slots;
        *slots = (*slots).max(slot as u32 + 1);
        self.state.note_use();
        Ok(id)
    }

    /// Removes a body and its pieces. Cost: one pass over the pools for each piece.
    ///
    /// # Errors
    /// [`BodyError::Stale`].
    pub fn remove_body(&mut self, id: BodyId) -> Result<(), BodyError> {
        self.recorded(
            CallKind::RemoveBody,
            |to| to.pod(&id),
            |world| world.drop_body(id),
        )
    }

    fn drop_body(&mut self, id: BodyId) -> Result<(), BodyError> {
        let body = self.body_index(id)?;
        while self.state.bodies.first_piece[body] != 0 {
            let piece = self.state.bodies.first_piece[body] as usize - 1;
            self.remove_piece_at(piece);
        }
        self.remove_chains(body);
        self.state.looks.forget(body);
        self.state.looks.patience[body] = 0;
        if self.state.bodies.kind[body] == BodyKind::Driven.code() {
            self.state.registers.driven -= 1;
        }
        if is_loose_kind(self.state.bodies.kind[body]) {
            self.state.registers.loose -= 1;
        }
        let bodies = &mut self.state.bodies;
        bodies.generation[body] = bodies.generation[body].wrapping_add(1);
        bodies.kind[body] = 0;
        Ok(())
    }

    pub(crate) fn body_index(&self, id: BodyId) -> Result<usize, BodyError> {
        id.find(self.state.bodies.generation)
            .ok_or(BodyError::Stale)
    }

    pub(crate) fn index_of_kind(&self, id: BodyId, kind: BodyKind) -> Result<usize, BodyError> {
        let body = self.body_index(id)?;
        if self.state.bodies.kind[body] != kind.code() {
            return Err(BodyError::WrongKind);
        }
        Ok(body)
    }

    /// Puts a body elsewhere at once, without a way there. A driven body forgets its displacement, a
    /// dynamic one keeps its velocity and wakes. Overlap made so is reported by the next frame and
    /// never gets deeper.
    ///
    /// # Errors
    /// [`BodyError::Stale`], [`BodyError::BadPose`].
    pub fn place_body(&mut self, id: BodyId, pose: &Pose) -> Result<(), BodyError> {
        self.recorded(
            CallKind::PlaceBody,
            |to| {
                to.pod(&id);
                to.pod(pose);
            },
            |world| world.take_place(id, pose),
        )
    }

    fn take_place(&mut self, id: BodyId, pose: &Pose) -> Result<(), BodyError> {
        let body = self.body_index(id)?;
        let pose = pose.normalised(WORLD_REACH_M).ok_or(BodyError::BadPose)?;
        let bodies = &mut self.state.bodies;
        bodies.pose[body] = pose;
        bodies.displacement[body] = Displacement::default();
        bodies.tracker[body].target = pose;
        bodies.tracker[body].previous = pose;
        bodies.momentum[body].asleep = 0;
        bodies.momentum[body].still_s = 0.0;
        place_pieces(&mut self.state, body);
        self.wake_all();
        Ok(())
    }

    /// Wakes every dynamic body, and has the next frame look for overlap: the world changed.
    pub(crate) fn wake_all(&mut self) {
        self.state.registers.disturbed = 1;
        for momentum in self.state.bodies.momentum.iter_mut() {
            momentum.asleep = 0;
            momentum.still_s = 0.0;
        }
        for yielding in self.state.bodies.yielding.iter_mut() {
            yielding.leans = 0;
        }
    }

    /// Sets a dynamic body's velocity (of its centre of mass, m/s) and angular velocity (rad/s, in
    /// the world), and wakes it.
    ///
    /// # Errors
    /// [`BodyError`]; [`BodyError::BadVelocity`] for a coordinate that is not finite or beyond
    /// [`SPEED_MAX`] or [`SPIN_MAX`].
    pub fn set_velocity(
        &mut self,
        id: BodyId,
        linear: [f32; 3],
        angular: [f32; 3],
    ) -> Result<(), BodyError> {
        self.recorded(
            CallKind::SetVelocity,
            |to| {
                to.pod(&id);
                to.pod(&[linear, angular]);
            },
            |world| world.take_velocity(id, linear, angular),
        )
    }

    fn take_velocity(
        &mut self,
        id: BodyId,
        linear: [f32; 3],
        angular: [f32; 3],
    ) -> Result<(), BodyError> {
        let body = self.index_of_kind(id, BodyKind::Dynamic)?;
        let (linear, angular) = (Vec3::from_array(linear), Vec3::from_array(angular));
        let within = |v: Vec3, limit: f32| v.abs().cmple(Vec3::splat(limit)).all();
        if !within(linear, SPEED_MAX) || !within(angular, SPIN_MAX) {
            return Err(BodyError::BadVelocity);
        }
        let inertia = self.state.bodies.mass[body].inertia(self.state.bodies.pose[body].quat());
        self.state.bodies.momentum[body] = Momentum {
            velocity: linear,
            angular: inertia * angular,
            ..Momentum::default()
        };
        self.wake_one(body);
        Ok(())
    }

    /// A dynamic body's velocity in m/s and angular velocity in rad/s, in the world.
    ///
    /// # Errors
    /// [`BodyError::Stale`], [`BodyError::WrongKind`].
    pub fn velocity(&self, id: BodyId) -> Result<([f32; 3], [f32; 3]), BodyError> {
        let body = self.index_of_kind(id, BodyKind::Dynamic)?;
        let bodies = &self.state.bodies;
        let rotation = bodies.pose[body].quat().as_dquat();
        let angular = bodies.momentum[body].angular.as_dvec3();
        let spin = bodies.mass[body].spin(rotation, angular);
        // A needle that tumbles may come to turn about its length faster than f32 holds.
        let spin = (spin * share_within(spin, f32::MAX)).as_vec3();
        Ok((bodies.momentum[body].velocity.to_array(), spin.to_array()))
    }

    /// Mass of a dynamic body in kg.
    ///
    /// # Errors
    /// [`BodyError::Stale`], [`BodyError::WrongKind`].
    pub fn mass_kg(&self, id: BodyId) -> Result<f32, BodyError> {
        let body = self.index_of_kind(id, BodyKind::Dynamic)?;
        Ok(self.state.bodies.mass[body].mass_kg)
    }

    /// Tells where a driven body's tracker is. Call it every frame; a frame without it counts the
    /// tracker as lost and keeps the last target.
    ///
    /// # Errors
    /// [`BodyError`]. With [`BodyError::BadPose`] the tracker counts as lost this frame.
    pub fn set_target(&mut self, id: BodyId, target: &Pose) -> Result<(), BodyError> {
        self.recorded(
            CallKind::SetTarget,
            |to| {
                to.pod(&id);
                to.pod(target);
            },
            |world| world.take_target(id, target),
        )
    }

    pub(super) fn take_target(&mut self, id: BodyId, target: &Pose) -> Result<(), BodyError> {
        let body = self.index_of_kind(id, BodyKind::Driven)?;
        let target = target.normalised(WORLD_REACH_M).ok_or(BodyError::BadPose)?;
        let tracker = &mut self.state.bodies.tracker[body];
        tracker.target = target;
        tracker.fresh = 1;
        tracker.seen = 1;
        Ok(())
    }

    /// Tells where a driven body's pieces are to be in its frame, in the order they were added: the
    /// fingers of a tracked hand. They move there over the frame, as far as contact allows.
    ///
    /// # Errors
    /// [`BodyError`]; on an error no piece has a new target.
    pub fn set_piece_targets(&mut self, id: BodyId, poses: &[Pose]) -> Result<(), BodyError> {
        self.set_listed_targets(id, List::Given(poses))
    }

    /// The same with poses that lie anywhere.
    pub(crate) fn set_listed_targets(
        &mut self,
        id: BodyId,
        poses: List<Pose>,
    ) -> Result<(), BodyError> {
        let most = self.state.header.capacities.pieces as usize;
        self.recorded(
            CallKind::SetPieceTargets,
            |to| {
                to.pod(&id);
                poses.put(to, most);
            },
            |world| world.take_piece_targets(id, poses),
        )
    }

    fn take_piece_targets(&mut self, id: BodyId, poses: List<Pose>) -> Result<(), BodyError> {
        let body = self.index_of_kind(id, BodyKind::Driven)?;
        let first = self.state.bodies.first_piece[body];
        if PiecesOf::new(self.state.pieces.next, first).count() != poses.len() {
            return Err(BodyError::WrongCount);
        }
        if poses.iter().any(|p| p.normalised(WORLD_REACH_M).is_none()) {
            return Err(BodyError::BadPose);
        }
        let pieces = &mut self.state.pieces;
        for (piece, pose) in PiecesOf::new(pieces.next, first).zip(poses.iter()) {
            if let Some(pose) = pose.normalised(WORLD_REACH_M)
                && pieces.local_target[piece] != pose
            {
                pieces.local_target[piece] = pose;
                self.state.bodies.settled[body].is_settled = 0;
            }
        }
        Ok(())
    }

    /// The published pose of a body.
    ///
    /// # Errors
    /// [`BodyError::Stale`].
    pub fn pose(&self, id: BodyId) -> Result<Pose, BodyError> {
        Ok(self.state.bodies.pose[self.body_index(id)?])
    }

    /// What the last frame did to a driven body.
    ///
    /// # Errors
    /// [`BodyError::Stale`], [`BodyError::WrongKind`].
    pub fn driven_report(&self, id: BodyId) -> Result<DrivenReport, BodyError> {
        let body = self.index_of_kind(id, BodyKind::Driven)?;
        Ok(self.state.bodies.report[body])
    }

    /// The published pose of a piece in the world.
    ///
    /// # Errors
    /// [`BodyError::Stale`].
    pub fn piece_pose(&self, id: PieceId) -> Result<Pose, BodyError> {
        let piece = id
            .find(self.state.pieces.generation)
            .ok_or(BodyError::Stale)?;
        Ok(self.state.pieces.world[piece])
    }

    /// The published poses of all piece slots in the world: index an id's `index1 - 1`. Slots that are
    /// not in use hold anything.
    #[must_use]
    pub fn piece_poses(&self) -> &[Pose] {
        self.state.pieces.world
    }
}
