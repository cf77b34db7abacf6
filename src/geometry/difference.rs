//! The difference A - B of two cores: the set of all a - b, whose distance from the origin is the
//! distance of the cores, and whose depth at the origin is their penetration depth.

use glam::{DVec3, Vec3};

use super::convex::Convex;
use super::relative::Relative;
use crate::math::sqrt_f64;

/// A vertex of the difference and which vertices of A and B it comes from, in the frame of B.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corner {
    pub at: DVec3,
    pub vertex_a: u16,
    pub vertex_b: u16,
}

impl Corner {
    #[inline]
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        (self.vertex_a, self.vertex_b) == (other.vertex_a, other.vertex_b)
    }
}

/// Two cores and how the first lies in the frame of the second.
pub(crate) struct Difference<'p, 'a, 'b> {
    pub a: &'p Convex<'a>,
    pub b: &'p Convex<'b>,
    pub a_in_b: &'p Relative,
}

impl Difference<'_, '_, '_> {
    /// The corner of two vertices.
    #[inline]
    pub(crate) fn corner(&self, vertex_a: usize, vertex_b: usize) -> Corner {
        Corner {
            at: self.on_a(vertex_a) - self.on_b(vertex_b),
            vertex_a: vertex_a as u16,
            vertex_b: vertex_b as u16,
        }
    }

    /// The corner that reaches least along `along`, of any length.
    #[inline]
    pub(crate) fn lowest(&self, along: DVec3) -> Corner {
        let on_a = self.a.support_exact(-self.a_in_b.back(along));
        let on_b = self.b.support_exact(along);
        self.corner(on_a, on_b)
    }

    /// A direction from B toward A to start a search with: between the points that two projections
    /// from box to box lead to, or from the centre of one to the box of the other if the boxes overlap
    /// there, or between the centres.
    pub(crate) fn guess(&self) -> DVec3 {
        let (half_a, half_b) = (
            self.a.half_extents.as_dvec3(),
            self.b.half_extents.as_dvec3(),
        );
        let between = self.a_in_b.point(self.a.centre) - self.b.centre.as_dvec3();
        let on_b = kept(between, half_b);
        let on_a = kept(self.a_in_b.back(on_b - between), half_a);
        let on_a = self.a_in_b.turn * on_a + between;
        let apart = on_a - kept(on_a, half_b);
        let noticed = 1e-6 * (half_a.length_squared() + half_b.length_squared());
        if apart.length_squared() > noticed {
            return apart;
        }
        let above_b = between - on_b;
        if above_b.length_squared() > noticed {
            return above_b;
        }
        let back = self.a_in_b.back(-between);
        let above_a = self.a_in_b.turn * (kept(back, half_a) - back);
        if above_a.length_squared() > noticed {
            return above_a;
        }
        between
    }

    /// A vertex of A in the frame of B.
    #[inline]
    pub(crate) fn on_a(&self, vertex: usize) -> DVec3 {
        self.a_in_b.point(self.a.vertex(vertex))
    }

    /// A vertex of B.
    #[inline]
    pub(crate) fn on_b(&self, vertex: usize) -> DVec3 {
        self.b.vertex(vertex).as_dvec3()
    }

    /// The points of A and B that the weighted mean of some corners stands for.
    pub(crate) fn witnesses(&self, corners: &[Corner], weights: &[f64]) -> (Vec3, Vec3) {
        let (mut on_a, mut on_b) = (DVec3::ZERO, DVec3::ZERO);
        for (corner, &weight) in corners.iter().zip(weights) {
            on_a += self.a.vertex(corner.vertex_a.into()).as_dvec3() * weight;
            on_b += self.on_b(corner.vertex_b.into()) * weight;
        }
        let on_a = self.a_in_b.turn * on_a + self.a_in_b.shift;
        (on_a.as_vec3(), on_b.as_vec3())
    }

    /// What is as good as nothing for this pair, in metres: a part of the smaller piece, but no less
    /// than f64 loses on the larger one.
    pub(crate) fn grain_m(&self) -> f64 {
        let (a, b) = (f64::from(self.a.size()), f64::from(self.b.size()));
        let (small, large) = if a < b { (a, b) } else { (b, a) };
        let lost = 1e-14 * (large + sqrt_f64(self.a_in_b.shift.length_squared()));
        let part = 1e-11 * small;
        if part > lost { part } else { lost }
    }
}

/// The nearest point of a box about the origin.
#[inline]
fn kept(p: DVec3, half: DVec3) -> DVec3 {
    let kept = |x: f64, most: f64| {
        let x = if x < most { x } else { most };
        if x > -most { x } else { -most }
    };
    DVec3::new(kept(p.x, half.x), kept(p.y, half.y), kept(p.z, half.z))
}
