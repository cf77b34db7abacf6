//! Reach cones: the directions that the limb of a ball joint may take.
//!
//! Wilhelms and Van Gelder 2001, "Fast and Easy Reach-Cone Joint Limits": a polygon of great arcs on
//! the unit sphere and a point inside that sees all of it. The lines of sight to the corners cut the
//! sphere into lunes; a direction lies in one of them, and is allowed when it is on the inner side of
//! that lune's arc. The polygon need not be convex and may be wider than a hemisphere.
//!
//! Where the paper bisects toward the last allowed direction, [`ReachCone::nearest`] gives the nearest
//! allowed one: it needs no history, so equal questions have equal answers.

use core::fmt;

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::limits::REACH_CONE_EDGES_MAX;
use crate::math::{atan2, direction, length, sqrt_f64};

/// Shortest edge, least angle between an edge and the visible point, and least rest of an edge to half
/// a turn, as sines.
const SINE_MIN: f32 = 1e-3;

/// What is left of a unit vector in the plane of an arc has no direction when it is shorter than this.
const FOOT_MIN: f64 = 1e-12;

/// Why corners make no cone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConeError {
    /// Fewer than three corners.
    TooFew,
    /// More than [`REACH_CONE_EDGES_MAX`] corners.
    TooMany,
    /// A corner or the visible point is zero or not finite.
    NoDirection,
    /// Neighbouring corners are less than a milliradian apart, or less from opposite.
    Edge,
    /// The visible point does not see every edge from the same side, by a milliradian at least.
    NotVisible,
    /// The polygon goes more than once around the visible point.
    Winding,
}

impl fmt::Display for ConeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::TooFew => "a reach cone needs at least three corners",
            Self::TooMany => "more corners than REACH_CONE_EDGES_MAX",
            Self::NoDirection => "a corner or the visible point has no direction",
            Self::Edge => "neighbouring corners are equal or opposite",
            Self::NotVisible => "the visible point does not see every edge from inside",
            Self::Winding => "the polygon goes around the visible point more than once",
        })
    }
}

impl core::error::Error for ConeError {}

/// Allowed directions of a limb, in the frame of the joint's parent.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct ReachCone {
    /// Unit vector that sees all edges.
    visible: Vec3,
    /// Unit vectors, counter-clockwise seen from outside the sphere; unused ones are zero.
    corners: [Vec3; REACH_CONE_EDGES_MAX],
    count: u32,
}

impl ReachCone {
    /// A cone by directions of any length: its corners in order, either way round, and a point inside
    /// from which every edge is seen.
    ///
    /// # Errors
    /// See [`ConeError`].
    pub fn new(visible: Vec3, corners: &[Vec3]) -> Result<Self, ConeError> {
        if corners.len() < 3 {
            return Err(ConeError::TooFew);
        }
        if corners.len() > REACH_CONE_EDGES_MAX {
            return Err(ConeError::TooMany);
        }
        let mut cone = Self {
            visible: direction(visible).ok_or(ConeError::NoDirection)?,
            corners: [Vec3::ZERO; REACH_CONE_EDGES_MAX],
            count: corners.len() as u32,
        };
        for (place, &corner) in cone.corners.iter_mut().zip(corners) {
            *place = direction(corner).ok_or(ConeError::NoDirection)?;
        }
        let (a, b) = cone.edge(0);
        if cone.visible.dot(a.cross(b)) < 0.0 {
            cone.corners[..corners.len()].reverse();
        }
        cone.check()?;
        Ok(cone)
    }

    fn check(&self) -> Result<(), ConeError> {
        let mut turned = 0.0;
        for index in 0..self.count() {
            let (a, b) = self.edge(index);
            let normal = a.cross(b);
            if length(normal) < SINE_MIN {
                return Err(ConeError::Edge);
            }
            let inside = self.visible.dot(normal);
            if inside < SINE_MIN * length(normal) {
                return Err(ConeError::NotVisible);
            }
            let aside = |p: Vec3| p - self.visible * self.visible.dot(p);
            turned += atan2(inside, aside(a).dot(aside(b)));
        }
        let once = turned < 1.5 * core::f32::consts::TAU;
        once.then_some(()).ok_or(ConeError::Winding)
    }

    /// The corners, counter-clockwise seen from outside the sphere.
    #[must_use]
    pub fn corners(&self) -> &[Vec3] {
        &self.corners[..self.count()]
    }

    /// The point that sees all edges.
    #[must_use]
    pub fn visible(&self) -> Vec3 {
        self.visible
    }

    fn count(&self) -> usize {
        (self.count as usize).min(REACH_CONE_EDGES_MAX)
    }

    /// The ends of an edge.
    fn edge(&self, index: usize) -> (Vec3, Vec3) {
        let next = if index + 1 == self.count() {
            0
        } else {
            index + 1
        };
        (self.corners[index], self.corners[next])
    }

    /// Whether a direction of any length is allowed; the boundary is, up to rounding.
    ///
    /// Cost: one product a corner, and three more.
    #[must_use]
    pub fn contains(&self, limb: Vec3) -> bool {
        let Some((&last, _)) = self.corners().split_last() else {
            return false;
        };
        let (limb, visible) = (limb.as_dvec3(), self.visible.as_dvec3());
        // On which side of the line of sight to a corner the limb is: limb . (visible x corner).
        let across = limb.cross(visible);
        let (mut a, mut above_a) = (last, across.dot(last.as_dvec3()));
        for &b in self.corners() {
            let above_b = across.dot(b.as_dvec3());
            if above_a >= 0.0 && above_b <= 0.0 {
                // Products of f32 are exact in f64: edges of a milliradian are as sharp as long ones.
                return limb.dot(a.as_dvec3().cross(b.as_dvec3())) >= 0.0;
            }
            (a, above_a) = (b, above_b);
        }
        false
    }

    /// The allowed unit vector nearest to a unit vector: itself when it is allowed, else a point of the
    /// boundary; of several, that of the first edge.
    ///
    /// Cost: one projection an edge.
    #[must_use]
    pub fn nearest(&self, limb: Vec3) -> Vec3 {
        if self.contains(limb) {
            return limb;
        }
        // By chords: the cosine of half a milliradian is one in f32.
        let far = |found: Vec3| (limb - found).length_squared();
        let mut best = self.corners[0];
        let mut least = far(best);
        for index in 0..self.count() {
            let (a, b) = self.edge(index);
            let found = nearest_of_arc(a, b, limb);
            if far(found) < least {
                (best, least) = (found, far(found));
            }
        }
        best
    }

    /// How far a unit vector is outside, in radians; zero when it is allowed.
    #[must_use]
    pub fn outside_rad(&self, limb: Vec3) -> f32 {
        if self.contains(limb) {
            return 0.0;
        }
        let nearest = self.nearest(limb);
        atan2(length(limb.cross(nearest)), limb.dot(nearest))
    }
}

/// The point of the shorter arc from `a` to `b` that is nearest to a unit vector.
///
/// In f64: of a limb that is nearly at right angles to the arc's plane little is left in it, and a short arc's
/// plane is what f32 rounds most.
fn nearest_of_arc(a: Vec3, b: Vec3, limb: Vec3) -> Vec3 {
    let far = |end: Vec3| (limb - end).length_squared();
    let nearer_end = if far(b) < far(a) { b } else { a };
    let (a, b, limb) = (a.as_dvec3(), b.as_dvec3(), limb.as_dvec3());
    let normal = a.cross(b);
    let foot = limb - normal * (normal.dot(limb) / normal.length_squared());
    let between = a.cross(foot).dot(normal) > 0.0 && foot.cross(b).dot(normal) > 0.0;
    let length = sqrt_f64(foot.length_squared());
    if between && length > FOOT_MIN {
        (foot / length).as_vec3()
    } else {
        nearer_end
    }
}
