//! What pulls a dynamic body to a tracker in Rapier: a soft spring, or a velocity that arrives in time.

use rapier3d::prelude as rapier;

use super::setting::HAND_STIFFNESS_N_PER_M;

/// How a hand is pulled to its tracker.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drive {
    /// A critically damped spring of the kernel's stiffness, relative to the moving tracker.
    Soft,
    /// The velocity that arrives at the tracker at the end of the frame, as far as the force allows.
    Stiff,
}

/// The most that the stiff drive pulls with, in newtons and newton metres. With four times as much a
/// hand that presses trembles, and free motion gains nothing.
const STIFF_FORCE_N: f32 = 100.0;
/// See [`STIFF_FORCE_N`].
const STIFF_TORQUE_N_M: f32 = 2.0;

/// A drive with what it knows about its hand and its tracker.
pub struct HandDrive {
    drive: Drive,
    /// The tracker, and where it was a frame ago.
    target: rapier::Pose,
    before: rapier::Pose,
    /// What is pulled: centre of mass and principal moments in the body's frame.
    centre: rapier::Vector,
    moments: rapier::Vector,
    mass_kg: f32,
}

/// How far a pose is from another: of the centre of mass in metres, and a rotation vector in the world.
struct Off {
    along: rapier::Vector,
    around: rapier::Vector,
}

impl HandDrive {
    /// A drive of a body at rest whose principal axes are those of its frame.
    #[must_use]
    pub fn new(drive: Drive, wrist: rapier::Pose, mass: rapier::MassProperties) -> Self {
        Self {
            drive,
            target: wrist,
            before: wrist,
            centre: mass.local_com,
            moments: mass.principal_inertia(),
            mass_kg: mass.mass(),
        }
    }

    /// Takes a new frame's tracker.
    pub fn track(&mut self, target: rapier::Pose) {
        self.before = self.target;
        self.target = target;
    }

    /// Pulls the body for one of a frame's steps.
    pub fn pull(&self, body: &mut rapier::RigidBody, substep: u32, substeps: u32, step_s: f32) {
        match self.drive {
            Drive::Soft => self.pull_softly(body, substep, substeps, step_s),
            Drive::Stiff => self.pull_stiffly(body, substeps - substep, step_s),
        }
    }

    /// From one pose to another.
    fn off(&self, to: &rapier::Pose, from: &rapier::Pose) -> Off {
        let turn = to.rotation * from.rotation.inverse();
        let turn = if turn.w < 0.0 { -turn } else { turn };
        Off {
            along: to.transform_point(self.centre) - from.transform_point(self.centre),
            around: turn.to_scaled_axis(),
        }
    }

    /// The spring is relative to the tracker's own motion: damping of the absolute velocity would lag.
    fn pull_softly(&self, body: &mut rapier::RigidBody, substep: u32, substeps: u32, step_s: f32) {
        let share = substep as f32 / substeps as f32;
        let wanted = self.before.lerp(&self.target, share);
        let off = self.off(&wanted, body.position());
        let way = self.off(&self.target, &self.before);
        let frame_s = step_s * substeps as f32;
        let stiffness = HAND_STIFFNESS_N_PER_M / self.mass_kg;
        let damping = 2.0 * stiffness.sqrt();
        let pull = |off: rapier::Vector, way: rapier::Vector, velocity: rapier::Vector| {
            off * stiffness + (way / frame_s - velocity) * damping
        };
        let force = pull(off.along, way.along, body.linvel()) * self.mass_kg;
        let spin = pull(off.around, way.around, body.angvel());
        let rotation = *body.rotation();
        let torque = rotation * ((rotation.inverse() * spin) * self.moments);
        body.reset_forces(true);
        body.reset_torques(true);
        body.add_force(force, true);
        body.add_torque(torque, true);
    }

    fn pull_stiffly(&self, body: &mut rapier::RigidBody, steps_left: u32, step_s: f32) {
        let off = self.off(&self.target, body.position());
        let left_s = step_s * steps_left as f32;
        let faster = off.along / left_s - body.linvel();
        let faster = faster.clamp_length_max(STIFF_FORCE_N / self.mass_kg * step_s);
        let spin = off.around / left_s - body.angvel();
        let spin = spin.clamp_length_max(STIFF_TORQUE_N_M / self.moments.max_element() * step_s);
        body.set_linvel(body.linvel() + faster, true);
        body.set_angvel(body.angvel() + spin, true);
    }
}
