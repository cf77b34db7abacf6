//! Two boxes: fifteen axes (Gottschalk, Lin and Manocha 1996, "OBBTree") in double precision, where
//! nothing cancels that f32 coordinates can hold. Edges are parallel by the same relative bound as
//! those of other solids.

use glam::DVec3;

use super::{CorePenetration, Feature, PARALLEL_SINE};
use crate::geometry::convex::Convex;
use crate::geometry::manifold::CoreGap;
use crate::geometry::relative::Relative;
use crate::math::sqrt_f64;

/// Points are as far apart as an axis proves when the difference is at most this part of the sum of
/// the half extents.
const NOISE_PART: f64 = 1e-14;

/// A box whose sides are square to its own frame.
#[derive(Clone, Copy, Debug)]
struct Cuboid {
    centre: DVec3,
    half: DVec3,
}

impl Cuboid {
    #[inline]
    fn of(piece: &Convex) -> Self {
        Self {
            centre: piece.centre.as_dvec3(),
            half: piece.half_extents.as_dvec3(),
        }
    }
}

/// Most projections in search of a foot: none are needed when nothing is parallel, few when the feet
/// are not only corners.
const PROJECTIONS_MAX: u32 = 8;

/// Which of the fifteen axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    FaceB(usize),
    FaceA(usize),
    /// The axis of A's edges, that of B's.
    Edges(usize, usize),
}

/// Two boxes, seen from the centre of the second.
pub(crate) struct Boxes {
    a: Cuboid,
    b: Cuboid,
    /// The axes of A.
    axes: [DVec3; 3],
    /// The centre of A.
    offset: DVec3,
}

/// The axis of least overlap of two boxes.
pub(crate) struct Least {
    kind: Kind,
    /// From B into A.
    pub(crate) normal: DVec3,
    /// Negative when the axis parts the boxes.
    pub(crate) depth: f64,
}

impl Boxes {
    /// Both pieces as boxes, if they are.
    #[inline]
    pub(crate) fn of(a: &Convex, b: &Convex, a_in_b: &Relative) -> Option<Self> {
        if !(a.is_box && b.is_box) {
            return None;
        }
        let (a, b) = (Cuboid::of(a), Cuboid::of(b));
        let turn = &a_in_b.turn;
        Some(Self {
            offset: *turn * a.centre + a_in_b.shift - b.centre,
            a,
            b,
            axes: [turn.x_axis, turn.y_axis, turn.z_axis],
        })
    }

    /// How far apart the boxes are, or how deep: exact up to what f64 loses. `None` where no axis of
    /// features decides it: they touch, or their nearest features are two corners, or a corner and an
    /// edge, or features are parallel and no points were found on both.
    #[inline]
    pub(crate) fn core_gap(&self) -> Option<CoreGap> {
        let least = self.least(f64::NEG_INFINITY);
        let noise = NOISE_PART * (self.a.half.element_sum() + self.b.half.element_sum());
        let (on_a, on_b) = if least.depth > 0.0 {
            self.deepest_points(&least, noise)?
        } else {
            self.nearest_points(&least, noise)?
        };
        Some(CoreGap {
            normal: least.normal.as_vec3(),
            gap: -least.depth as f32,
            point_a: (on_a + self.b.centre).as_vec3(),
            point_b: (on_b + self.b.centre).as_vec3(),
        })
    }

    /// The first of the axes with least overlap: faces of B, faces of A, edges. The edges are left
    /// out when a face has at most `enough`.
    pub(crate) fn least(&self, enough: f64) -> Least {
        let (mut depth, mut kind) = (f64::INFINITY, Kind::FaceB(0));
        for k in 0..3 {
            let across = self.along_axes_of_a(k).abs().dot(self.a.half);
            let overlap = self.b.half[k] + across - self.offset[k].abs();
            if overlap < depth {
                (depth, kind) = (overlap, Kind::FaceB(k));
            }
        }
        for i in 0..3 {
            let across = self.axes[i].abs().dot(self.b.half);
            let overlap = self.a.half[i] + across - self.axes[i].dot(self.offset).abs();
            if overlap < depth {
                (depth, kind) = (overlap, Kind::FaceA(i));
            }
        }
        if depth > enough {
            self.edges(&mut depth, &mut kind);
        }
        Least {
            kind,
            normal: self.normal(kind),
            depth,
        }
    }

    /// Coordinate `k` of the axes of A.
    #[inline]
    fn along_axes_of_a(&self, k: usize) -> DVec3 {
        DVec3::new(self.axes[0][k], self.axes[1][k], self.axes[2][k])
    }

    /// The nine axes of edges. Overlaps are compared by their squares times the squared length of
    /// the axis, so that only those that win cost a square root.
    #[inline]
    fn edges(&self, depth: &mut f64, kind: &mut Kind) {
        const NEXT: [usize; 3] = [1, 2, 0];
        const LAST: [usize; 3] = [2, 0, 1];
        let least = f64::from(PARALLEL_SINE) * f64::from(PARALLEL_SINE);
        for i in 0..3 {
            let (i1, i2) = (NEXT[i], LAST[i]);
            let d = self.axes[i];
            for j in 0..3 {
                let (j1, j2) = (NEXT[j], LAST[j]);
                let squared = d[j1] * d[j1] + d[j2] * d[j2];
                let of_a = self.a.half[i1] * self.axes[i2][j].abs()
                    + self.a.half[i2] * self.axes[i1][j].abs();
                let of_b = self.b.half[j1] * d[j2].abs() + self.b.half[j2] * d[j1].abs();
                let between = self.offset[j1] * d[j2] - self.offset[j2] * d[j1];
                let overlap = of_a + of_b - between.abs();
                let nearer = overlap * overlap.abs() < *depth * depth.abs() * squared;
                if nearer && squared > least {
                    *depth = overlap / sqrt_f64(squared);
                    *kind = Kind::Edges(i, j);
                }
            }
        }
    }

    /// The unit vector of an axis, from B into A.
    fn normal(&self, kind: Kind) -> DVec3 {
        let axis = match kind {
            Kind::FaceB(k) => DVec3::AXES[k],
            Kind::FaceA(i) => self.axes[i],
            Kind::Edges(i, j) => {
                let cross = self.axes[i].cross(DVec3::AXES[j]);
                cross / sqrt_f64(cross.length_squared())
            }
        };
        if axis.dot(self.offset) < 0.0 {
            -axis
        } else {
            axis
        }
    }

    /// The answer for an axis, in the frame of B.
    pub(crate) fn penetration(&self, a: &Convex, b: &Convex, least: &Least) -> CorePenetration {
        let (point_a, point_b) = self.points(least);
        CorePenetration {
            normal: least.normal.as_vec3(),
            depth: least.depth as f32,
            feature: self.feature(a, b, least),
            point_a: (point_a + self.b.centre).as_vec3(),
            point_b: (point_b + self.b.centre).as_vec3(),
        }
    }

    /// For each axis of A, whether the corner that reaches lowest is at its high end.
    #[inline]
    fn low_corner_of_a(&self, normal: DVec3) -> [bool; 3] {
        core::array::from_fn(|m| self.axes[m].dot(normal) < 0.0)
    }

    /// For each axis of B, whether the corner that reaches highest is at its high end.
    #[inline]
    fn high_corner_of_b(normal: DVec3) -> [bool; 3] {
        core::array::from_fn(|m| normal[m] > 0.0)
    }

    /// A point at the bottom of A and the one opposite, from the centre of B.
    fn points(&self, least: &Least) -> (DVec3, DVec3) {
        let at_high = self.low_corner_of_a(least.normal);
        let signed = |high: bool, half: f64| if high { half } else { -half };
        let free = match least.kind {
            Kind::Edges(i, _) => i,
            _ => 3,
        };
        let mut low = self.offset;
        for m in 0..3 {
            if m != free {
                low += self.axes[m] * signed(at_high[m], self.a.half[m]);
            }
        }
        let Kind::Edges(i, j) = least.kind else {
            return (low, low + least.normal * least.depth);
        };
        let at_high = Self::high_corner_of_b(least.normal);
        let mut high = DVec3::ZERO;
        for m in 0..3 {
            if m != j {
                high[m] = signed(at_high[m], self.b.half[m]);
            }
        }
        self.closest(low, i, high, j)
    }

    /// The closest points of an edge of A about `low` and an edge of B about `high`.
    fn closest(&self, low: DVec3, i: usize, high: DVec3, j: usize) -> (DVec3, DVec3) {
        let (d, e) = (self.axes[i], DVec3::AXES[j]);
        let (a, b) = (self.a.half[i], self.b.half[j]);
        let between = low - high;
        let cosine = d[j];
        let sine_squared = d.cross(e).length_squared();
        let kept = |x: f64, limit: f64| {
            let x = if x < limit { x } else { limit };
            if x > -limit { x } else { -limit }
        };
        let s = kept((cosine * between[j] - between.dot(d)) / sine_squared, a);
        let t = kept(cosine * s + between[j], b);
        let s = kept(cosine * t - between.dot(d), a);
        (low + d * s, high + e * t)
    }

    fn feature(&self, a: &Convex, b: &Convex, least: &Least) -> Feature {
        let low = self.low_corner_of_a(least.normal);
        let high = Self::high_corner_of_b(least.normal);
        match least.kind {
            Kind::FaceB(k) => Feature::FaceB(faces_of(b)[k][usize::from(high[k])]),
            Kind::FaceA(i) => Feature::FaceA(faces_of(a)[i][usize::from(low[i])]),
            Kind::Edges(i, j) => Feature::Edges(edge_of(a, i, low), edge_of(b, j, high)),
        }
    }

    /// Points of both boxes that are the depth apart along the normal: a corner of one and its foot on
    /// the face of the other. Where edges or faces are parallel to that face, the corner is moved along
    /// them to where it has a foot: by projections from box to box, which `None` says were too few.
    fn deepest_points(&self, least: &Least, noise: f64) -> Option<(DVec3, DVec3)> {
        let across = least.normal * least.depth;
        let on_b = match least.kind {
            Kind::Edges(..) => return Some(self.points(least)),
            Kind::FaceA(_) => self.corner_of_b(Self::high_corner_of_b(least.normal)),
            Kind::FaceB(_) => self.points(least).1.clamp(-self.b.half, self.b.half),
        };
        let mut on_b = on_b;
        for _ in 0..PROJECTIONS_MAX {
            let on_a = self.in_a(on_b - across);
            on_b = (on_a + across).clamp(-self.b.half, self.b.half);
            if (on_a + across - on_b).length_squared() <= noise * noise {
                return Some((on_a, on_b));
            }
        }
        None
    }

    /// A corner of B by the ends of its axes.
    #[inline]
    fn corner_of_b(&self, high: [bool; 3]) -> DVec3 {
        let at = |m: usize| {
            if high[m] {
                self.b.half[m]
            } else {
                -self.b.half[m]
            }
        };
        DVec3::new(at(0), at(1), at(2))
    }

    /// The point of A nearest to one, both from the centre of B.
    fn in_a(&self, point: DVec3) -> DVec3 {
        let from = point - self.offset;
        let mut nearest = self.offset;
        for m in 0..3 {
            let half = self.a.half[m];
            nearest += self.axes[m] * self.axes[m].dot(from).clamp(-half, half);
        }
        nearest
    }

    /// Two points, from the centre of B, that are as far apart as the axis proves, within `noise`: the
    /// nearest features are those of the axis.
    fn nearest_points(&self, least: &Least, noise: f64) -> Option<(DVec3, DVec3)> {
        let (on_a, on_b) = match least.kind {
            Kind::Edges(..) => self.points(least),
            Kind::FaceB(_) => {
                let (low, _) = self.points(least);
                (low, low.clamp(-self.b.half, self.b.half))
            }
            Kind::FaceA(_) => {
                let corner = self.corner_of_b(Self::high_corner_of_b(least.normal));
                (self.in_a(corner), corner)
            }
        };
        let upper_squared = (on_a - on_b).length_squared();
        let limit = noise - least.depth;
        (upper_squared <= limit * limit).then_some((on_a, on_b))
    }
}

/// Indices of a box's faces at the low and the high end of each axis.
fn faces_of(piece: &Convex) -> [[u16; 2]; 3] {
    let mut faces = [[0; 2]; 3];
    for (index, face) in piece.faces.iter().enumerate() {
        for axis in 0..3 {
            if face.normal[axis].abs() == 1.0 {
                faces[axis][usize::from(face.normal[axis] > 0.0)] = index as u16;
            }
        }
    }
    faces
}

/// The edge of a box along an axis, at the given ends of the two others.
fn edge_of(piece: &Convex, axis: usize, high: [bool; 3]) -> u16 {
    let faces = faces_of(piece);
    let face = |m: usize| faces[m % 3][usize::from(high[m % 3])];
    let (first, second) = (face(axis + 1), face(axis + 2));
    let beside = |faces: [u16; 2]| faces == [first, second] || faces == [second, first];
    let found = piece.edges.iter().position(|edge| beside(edge.faces));
    found.unwrap_or(0) as u16
}
