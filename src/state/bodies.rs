//! Bodies: rigid unions of pieces, and how each kind of body moves.

use bytemuck::{Pod, Zeroable};
use glam::{DQuat, DVec3, Mat3, Quat, Vec3};

use crate::limits::{SPEED_MAX, SPIN_MAX};
use crate::math::{self, Pose};
use crate::memory::columns::columns;
use crate::memory::ids::is_alive;
use crate::state::State;

/// What moves a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyKind {
    /// Nothing; only the host places it.
    Fixed = 1,
    /// Impulses and gravity.
    Dynamic = 2,
    /// A tracker, through a coupling, and never into fixed bodies.
    Driven = 3,
    /// The host's own physics engine: the host writes its pose and velocity before each frame, and reads
    /// back the impulses that it got.
    Hosted = 4,
}

impl BodyKind {
    pub(crate) const fn code(self) -> u32 {
        self as u32
    }
}

/// The spring between a tracker and a driven body: m x'' = -K x - R x', where x is how far contact
/// holds the body away from its tracker (Schmidl and Lin 2004, section 4, in displacement form).
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Coupling {
    /// Mass m in kg: how the driven body answers its own spring, and how hard it hits.
    pub mass_kg: f32,
    /// Stiffness K in N/m.
    pub stiffness_n_per_m: f32,
    /// Damping R in N s/m.
    pub damping_n_s_per_m: f32,
    /// How far tracker and body may be apart before the body counts as detached, in metres.
    pub divergence_m: f32,
    /// What happens beyond that: one of the `SNAP_*` constants.
    pub snap: u32,
    /// How long a lost tracker's last target is kept before the body counts as lost, in seconds.
    pub grace_s: f32,
    /// How the body pushes loose ones: one of the `PUSH_*` constants.
    pub push: u32,
}

impl Coupling {
    /// A detached body stays where contact holds it, and is reported.
    pub const SNAP_NEVER: u32 = 0;
    /// A detached body jumps to its tracker as soon as nothing is in the way there.
    pub const SNAP_WHEN_FREE: u32 = 1;
    /// A detached body jumps to the place nearest to its tracker where nothing is in the way, as soon as there is one
    /// within half of [`Self::divergence_m`]: one that stands on a floor, or whose tracker is in a table top, does so
    /// too. It turns and bends as it is tracked.
    pub const SNAP_NEAR: u32 = 2;
    /// The body pushes what is free as if it had no end of mass: without lag.
    pub const PUSH_WITHOUT_LAG: u32 = 0;
    /// The body pushes with the mass of its spring, and gives way to what is heavy, from the frame after the
    /// first touch on. What it hits in the middle of a frame it hits without giving way.
    pub const PUSH_WITH_MASS: u32 = 1;
    /// Critically damped, settles in about 0.1 s, reports as detached beyond 0.3 m.
    pub const DEFAULT: Self = Self {
        mass_kg: 0.4,
        stiffness_n_per_m: 1000.0,
        damping_n_s_per_m: 40.0,
        divergence_m: 0.3,
        snap: Self::SNAP_NEVER,
        grace_s: 0.1,
        push: Self::PUSH_WITHOUT_LAG,
    };

    /// Whether the spring is one that f32 can integrate: mass 1e-6 to 1e6 kg, stiffness 0 to 1e9 N/m,
    /// damping 0 to 1e9 N s/m, divergence above zero, grace not negative.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        let range = 0.0..=1e9;
        (1e-6..=1e6).contains(&self.mass_kg)
            && range.contains(&self.stiffness_n_per_m)
            && range.contains(&self.damping_n_s_per_m)
            && self.divergence_m > 0.0
            && self.grace_s >= 0.0
            && self.snap <= Self::SNAP_NEAR
            && self.push <= Self::PUSH_WITH_MASS
    }
}

impl Default for Coupling {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// What a body weighs.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct BodyMass {
    pub mass_kg: f32,
    /// Zero for a body without mass.
    pub inverse_mass: f32,
    /// Centre of mass in the body's frame.
    pub centre: Vec3,
    /// Principal moments, and their inverses (zero for a body without mass).
    pub moments: Vec3,
    pub inverse_moments: Vec3,
    /// Rotation of the principal axes in the body's frame.
    pub axes: [f32; 4],
}

impl BodyMass {
    /// The inertia about the centre of mass, in the world, of a body turned by `rotation`.
    pub(crate) fn inertia(&self, rotation: Quat) -> Mat3 {
        let turned = Mat3::from_quat(rotation * Quat::from_array(self.axes));
        turned * Mat3::from_diagonal(self.moments) * turned.transpose()
    }

    /// The angular velocity that goes with an angular momentum, both in the world, of a body turned by
    /// `rotation`.
    pub(crate) fn spin(&self, rotation: DQuat, angular: DVec3) -> DVec3 {
        // What weighs nothing has no axes either: impulses may have left it angular momentum.
        if angular == DVec3::ZERO || self.inverse_moments == Vec3::ZERO {
            return DVec3::ZERO;
        }
        let axes = rotation * Quat::from_array(self.axes).as_dquat();
        // Of whatever length the quaternion is by rounding.
        let square = axes.length_squared();
        let own = axes.conjugate() * angular / square;
        axes * (own * self.inverse_moments.as_dvec3()) / square
    }

    /// The inverse inertia about the centre of mass, in the world, of a body turned by `rotation`.
    pub(crate) fn inverse_inertia(&self, rotation: Quat) -> Mat3 {
        let turned = Mat3::from_quat(rotation * Quat::from_array(self.axes));
        turned * Mat3::from_diagonal(self.inverse_moments) * turned.transpose()
    }
}

/// How a dynamic body moves.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Momentum {
    /// Velocity of the centre of mass, in m/s.
    pub velocity: Vec3,
    /// Angular momentum about the centre of mass in the world, in kg m2/s.
    pub angular: Vec3,
    /// How long the body has been still, in seconds; a driven one among loose ones, how long it has stayed.
    pub still_s: f32,
    /// One while the body sleeps.
    pub asleep: u32,
    /// Bodies that fell asleep together have the same number, and wake together.
    pub nap: u32,
}

impl Momentum {
    /// Adds an impulse at an arm from the centre of mass, both in the world.
    pub(crate) fn strike(&mut self, mass: &BodyMass, rotation: Quat, impulse: Vec3, arm: Vec3) {
        let gained = impulse.as_dvec3() * f64::from(mass.inverse_mass);
        let angular = self.angular.as_dvec3() + arm.cross(impulse).as_dvec3();
        let velocity = self.velocity.as_dvec3() + gained;
        self.set(mass, rotation, velocity, angular);
    }

    /// Keeps how every point of a body moves whose mass is no longer what it was.
    pub(crate) fn reweigh(&mut self, before: &BodyMass, now: &BodyMass, rotation: Quat) {
        if self.angular == Vec3::ZERO || before == now {
            return;
        }
        let spin = before.spin(rotation.as_dquat(), self.angular.as_dvec3());
        let moved = rotation.as_dquat() * (now.centre - before.centre).as_dvec3();
        let velocity = self.velocity.as_dvec3() + spin.cross(moved);
        let angular = now.inertia(rotation).as_dmat3() * spin;
        self.set(now, rotation, velocity, angular);
    }

    /// Sets out with a velocity and an angular momentum, no faster than [`SPEED_MAX`] and [`SPIN_MAX`].
    fn set(&mut self, mass: &BodyMass, rotation: Quat, velocity: DVec3, angular: DVec3) {
        let spin = mass.spin(rotation.as_dquat(), angular);
        self.velocity = (velocity * share_within(velocity, SPEED_MAX)).as_vec3();
        self.angular = (angular * share_within(spin, SPIN_MAX)).as_vec3();
    }
}

/// The share of a vector that is no longer than a length.
pub(crate) fn share_within(v: DVec3, length: f32) -> f64 {
    let (is, most) = (math::sqrt_f64(v.length_squared()), f64::from(length));
    if is > most { most / is } else { 1.0 }
}

/// What the host makes a loose body feel in the next frame.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Load {
    /// In newtons.
    pub force: Vec3,
    /// About the centre of mass, in newton metres, in the world.
    pub torque: Vec3,
}

/// What the kernel's bodies did to a hosted body in a frame.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct HostedImpulse {
    /// In newton seconds, in the world.
    pub impulse_n_s: [f32; 3],
    /// About the centre of mass, in newton metre seconds, in the world.
    pub angular_n_m_s: [f32; 3],
    /// Mean of the contacts' points, weighted by their normal impulses; zero when there were none. The two impulses above are all that an engine needs; this is where they came from.
    pub point: [f32; 3],
    /// Sum of the contacts' normal impulses, in newton seconds.
    pub push_n_s: f32,
    /// Contacts that carried an impulse.
    pub contacts: u32,
}

/// How a driven body gave way to loose ones in the last frame.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Yielding {
    /// One when it took part with its coupling's mass, two when it kept its turn and its pieces too.
    pub level: u32,
    /// The mass that a body held by its coupling has over a frame, in kg.
    pub mass_kg: f32,
    /// Velocity of the root in the last frame, in m/s.
    pub velocity: Vec3,
    /// Impulse of loose bodies on it in the last frame, in newton seconds.
    pub reaction: Vec3,
    /// One while it rests on loose bodies that sleep.
    pub leans: u32,
}

/// What is known of a driven body's tracker.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct Tracker {
    pub target: Pose,
    /// The target of the frame before.
    pub previous: Pose,
    /// How long the tracker has been lost, in seconds.
    pub lost_s: f32,
    /// One when a valid target was set since the last frame.
    pub fresh: u32,
    /// One once any valid target was set.
    pub seen: u32,
}

/// How far contact holds a driven body away from its tracker, and how fast that changes.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Displacement {
    /// From the target to the body, in metres.
    pub offset: Vec3,
    /// Rate of the offset, in m/s.
    pub velocity: Vec3,
    /// Rotation vector from the target to the body, in the world.
    pub rotation: Vec3,
    /// Rate of the rotation vector, in rad/s.
    pub spin: Vec3,
}

impl Displacement {
    pub(crate) fn is_zero(&self) -> bool {
        *self == Self::default()
    }
}

/// What a frame did to a driven body.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct DrivenReport {
    /// Bits of [`DrivenReport::TOUCHING`] and the others.
    pub flags: u32,
    /// How far contact holds the body from its target, in metres.
    pub displacement_m: f32,
    /// Force of the coupling on the hand, in newtons, in the world: the haptic signal.
    pub force_n: [f32; 3],
    /// Mean force of loose bodies on the body over the frame, in newtons, in the world. A body that pushes
    /// without lag feels it here alone; one that gives way feels it in its coupling too.
    pub reaction_n: [f32; 3],
}

impl DrivenReport {
    /// Contact bent or ended the body's way.
    pub const TOUCHING: u32 = 1;
    /// The body stayed exactly where it was.
    pub const HELD: u32 = 1 << 1;
    /// The body is farther from its tracker than [`Coupling::divergence_m`].
    pub const DETACHED: u32 = 1 << 2;
    /// The tracker has been lost for longer than [`Coupling::grace_s`].
    pub const LOST: u32 = 1 << 3;
    /// The budget ended the body's way early, or a loose body did between two postures within the reach cones; the
    /// rest follows next frame.
    pub const CUT: u32 = 1 << 4;
    /// The host placed things so that the body overlaps a fixed one, and no way out was found yet.
    pub const OVERLAPS: u32 = 1 << 5;
    /// There was no room for the body's pairs: it stayed where it was.
    pub const POOL_FULL: u32 = 1 << 6;
    /// There was no room for all contacts that the host can read.
    pub const CONTACTS_FULL: u32 = 1 << 7;
}

/// A frame in which a driven body did not move, though its tracker wants it elsewhere: what asked for it,
/// and what was found. The same questions need not be asked again.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Settled {
    /// One when all below holds.
    pub is_settled: u32,
    /// One when the body moved in the last frame.
    pub moved: u32,
    pub wanted: Pose,
    /// Where the tracker saw it.
    pub tracked: Pose,
    /// Flags of the body's report.
    pub flags: u32,
    /// Where its contacts lie among those that the host can read.
    pub first_contact: u32,
    pub contacts: u32,
    /// Which of the driven bodies it was in the order of the last frame.
    pub turn: u32,
}

/// What a body still waits for.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Waiting {
    /// Frames in a row that ended before a driven body was through, since it last went first, or before a loose
    /// one moved at all.
    pub frames: u32,
    /// Frames of those that ended before a driven body was through in which it went first: in every other one it
    /// does without what there may never be enough units for.
    pub turns: u32,
    /// One while the body overlaps where the host put it.
    pub overlaps: u32,
    /// How much less than all events of a frame a loose body's island is given: it was cut before.
    pub hurry: u32,
}

columns! {
    /// One entry for every body slot.
    pub(crate) struct Bodies(capacities) {
        generation: [u32; capacities.bodies],
        /// [`BodyKind`] as a number.
        kind: [u32; capacities.bodies],
        /// First piece, index plus one.
        first_piece: [u32; capacities.bodies],
        /// First chain, index plus one.
        first_chain: [u32; capacities.bodies],
        /// Published pose.
        pose: [Pose; capacities.bodies],
        mass: [BodyMass; capacities.bodies],
        momentum: [Momentum; capacities.bodies],
        load: [Load; capacities.bodies],
        hosted: [HostedImpulse; capacities.bodies],
        yielding: [Yielding; capacities.bodies],
        tracker: [Tracker; capacities.bodies],
        coupling: [Coupling; capacities.bodies],
        displacement: [Displacement; capacities.bodies],
        report: [DrivenReport; capacities.bodies],
        settled: [Settled; capacities.bodies],
        waiting: [Waiting; capacities.bodies],
    }
}

/// Whether bodies of this kind answer impulses: dynamic and hosted ones.
pub(crate) const fn is_loose_kind(kind: u32) -> bool {
    kind == BodyKind::Dynamic.code() || kind == BodyKind::Hosted.code()
}

/// Whether a slot holds a body that answers impulses.
pub(crate) fn is_loose(state: &State, body: usize) -> bool {
    is_alive(state.bodies.generation[body]) && is_loose_kind(state.bodies.kind[body])
}

/// Whether a slot holds a body of a kind.
pub(crate) fn is_body_of(state: &State, body: usize, kind: BodyKind) -> bool {
    is_alive(state.bodies.generation[body]) && state.bodies.kind[body] == kind.code()
}
