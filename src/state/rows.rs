//! Contacts of loose bodies as the solver of impulses sees them.

use bytemuck::{Pod, Zeroable};
use glam::{Mat3, Vec3};

use crate::memory::columns::columns;

/// How a body moves, and what it resists impulses with.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Mover {
    /// Velocity of the centre of mass, in m/s.
    pub velocity: Vec3,
    /// Angular velocity in the world, in rad/s.
    pub spin: Vec3,
    /// In 1/kg; zero for a body that impulses do not move.
    pub inverse_mass: f32,
    /// About the centre of mass, along the world's axes, in 1/(kg m2); zero for a body that impulses do
    /// not turn.
    pub inverse_inertia: Mat3,
}

/// What stands still, and what impulses neither move nor turn: the default of a matrix is one, not zero.
impl Default for Mover {
    fn default() -> Self {
        Self::zeroed()
    }
}

impl Mover {
    /// Velocity of the body's point that is `arm` from its centre of mass, in m/s.
    #[inline]
    #[must_use]
    pub fn velocity_at(&self, arm: Vec3) -> Vec3 {
        self.velocity + self.spin.cross(arm)
    }

    /// What the body adds to the matrix K that turns an impulse at `arm` into a change of velocity there
    /// (Mirtich 1996, equation 8): 1/m - R I^-1 R, with R the cross-product matrix of the arm.
    #[must_use]
    pub fn mobility(&self, arm: Vec3) -> Mat3 {
        let cross = Mat3::from_cols(
            Vec3::new(0.0, arm.z, -arm.y),
            Vec3::new(-arm.z, 0.0, arm.x),
            Vec3::new(arm.y, -arm.x, 0.0),
        );
        Mat3::from_diagonal(Vec3::splat(self.inverse_mass)) - cross * self.inverse_inertia * cross
    }

    /// Changes the body's motion by an impulse, in newton seconds, at `arm`.
    #[inline]
    pub fn push(&mut self, arm: Vec3, impulse: Vec3) {
        self.velocity += impulse * self.inverse_mass;
        self.spin += self.inverse_inertia * arm.cross(impulse);
    }

    /// Whether impulses move the body.
    #[inline]
    #[must_use]
    pub fn is_movable(&self) -> bool {
        self.inverse_mass > 0.0
    }
}

/// One contact between two bodies.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Row {
    /// Index of the mover that impulses push along the normal.
    pub body_a: u32,
    /// Index of the other mover.
    pub body_b: u32,
    /// Index of the first row between the same two pieces; they follow each other.
    pub manifold: u32,
    /// From B into A, unit length.
    pub normal: Vec3,
    /// From A's centre of mass to the contact, in metres.
    pub arm_a: Vec3,
    /// From B's centre of mass to the contact.
    pub arm_b: Vec3,
    /// Velocity of A's surface relative to B's that impulses do not change, in m/s.
    pub prescribed: Vec3,
    /// Least normal velocity that the contact must have, in m/s; minus infinity for none.
    pub target: f32,
    /// Least speed of approach that bounces, in m/s; infinity when none does.
    pub bounce: f32,
    /// Speed after an impact over speed before, 0 to 1.
    pub restitution: f32,
    /// Coulomb's coefficient, 0 and up.
    pub friction: f32,
    /// Least normal impulse, in newton seconds: what a coupling presses with.
    pub least: f32,
    /// Height of the contact against gravity, in metres: for the order from below.
    pub height: f32,
    /// Impulse on A, in newton seconds.
    pub impulse: Vec3,
    /// How often an impulse was applied here.
    pub pushes: u32,
    /// K of both bodies, its inverse (zero when there is none), and n.K n.
    pub(crate) mobility: Mat3,
    pub(crate) inverse: Mat3,
    pub(crate) along: f32,
    /// Next row of the same body A or B, index plus one.
    pub(crate) next_a: u32,
    pub(crate) next_b: u32,
    /// Place in the queue, plus one, and what it was put there by.
    pub(crate) place: u32,
    pub(crate) key: f32,
    /// Impulse before the last sweep, and the direction that sweeps go on in.
    pub(crate) before: Vec3,
    pub(crate) heading: Vec3,
    /// Midway between the surfaces, in the world.
    pub(crate) point: Vec3,
    /// Impulse of the event's impacts.
    pub(crate) struck: Vec3,
    /// One when the row's patch stopped its body, with impulses that are in the mover already.
    pub(crate) rests: u32,
    /// The touch that the row belongs to, index plus one.
    pub(crate) touch: u32,
    /// Signed distance of the surfaces, in metres.
    pub(crate) gap: f32,
    /// Index of the pair among the island's.
    pub(crate) pair: u32,
}

columns! {
    /// Scratch of the solver of impulses.
    pub(crate) struct Rows(capacities) {
        rows: [Row; capacities.contacts],
        queue: [u32; capacities.contacts],
        movers: [Mover; capacities.bodies],
        /// Motion at the start of the stretch, impacts included.
        begun: [Mover; capacities.bodies],
        /// First row of each body, index plus one.
        first: [u32; capacities.bodies],
        /// One when a body moves at even speed through the stretch.
        even: [u32; capacities.bodies],
        /// Label of the rigid cluster that a body is in.
        cluster: [u32; capacities.bodies],
    }
}
