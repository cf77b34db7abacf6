//! Two cores in the frame of the first, so that accuracy does not depend on where the pair is.

use super::solid::{Placed, Solid};
use glam::{DMat3, DVec3};

/// The cores of a pair: `a` in its own frame, `b` carried into that frame.
pub(super) struct Relative<'a> {
    pub a: &'a Solid,
    pub b: &'a Solid,
    /// From the frame of `b` to the frame of `a`.
    pub rotation: DMat3,
    /// The origin of `b` in the frame of `a`.
    pub offset: DVec3,
    /// Both sizes and the distance together, in metres: rounding errors are relative to this.
    pub scale: f64,
}

impl<'a> Relative<'a> {
    pub fn new(a: &Placed<'a>, b: &Placed<'a>) -> Self {
        let back = a.rotation().transpose();
        let offset = back * (b.position() - a.position());
        let (a, rotation, b) = (a.solid(), back * b.rotation(), b.solid());
        let mut pair = Self {
            a,
            b,
            rotation,
            offset,
            scale: 0.0,
        };
        pair.scale = a.reach() + b.reach() + pair.between_centres().length();
        pair
    }

    /// From the centre of `b` to the centre of `a`.
    pub fn between_centres(&self) -> DVec3 {
        self.a.centre() - self.carry(self.b.centre())
    }

    /// A point of `b` in the frame of `a`.
    pub fn carry(&self, point: DVec3) -> DVec3 {
        self.rotation * point + self.offset
    }

    /// The vertices of `a` and `b` that are nearest along `normal`, which points from `b` to `a`.
    pub fn support(&self, normal: DVec3) -> [DVec3; 2] {
        [self.a.support(-normal), self.support_of_b(normal)]
    }

    /// The vertex of `b` that is farthest along `normal`.
    pub fn support_of_b(&self, normal: DVec3) -> DVec3 {
        self.carry(self.b.support(self.rotation.transpose() * normal))
    }

    /// The gap between the cores along `normal`, in metres; minus the overlap if they overlap.
    pub fn gap_along(&self, normal: DVec3) -> f64 {
        let [a, b] = self.support(normal);
        normal.dot(a - b)
    }
}
