//! Where two pieces touch: up to four contacts from one normal.
//!
//! If the normal is that of a face, the face, edge or point of the other piece that lies against
//! it is clipped by the sides of that face (Sutherland and Hodgman 1974), and four of the corners
//! that stand for the whole patch are kept. Otherwise the witness points make the one contact.

use arrayvec::ArrayVec;
use glam::{Mat3, Vec3};

use super::convex::{Convex, Face};
use super::distance::Distance;
use super::penetration::CorePenetration;
use crate::limits::{MANIFOLD_CONTACTS_MAX, PIECE_VERTICES_MAX};
use crate::math::{Pose, length};

/// A face counts as lying across the normal when the cosine between them is at least this: an
/// angle of 1.1 degrees. A normal that comes from a face is within 1e-6 of it, one from a distance
/// query within 1e-3.
pub const ALIGNED_COSINE: f32 = 0.9998;

/// Contacts closer together than this part of the smaller piece's size are one contact.
pub const MERGE_PART: f32 = 1e-4;

/// Most corners of a clipped face: each side of one face adds at most one corner to the other.
const CORNERS_MAX: usize = 2 * PIECE_VERTICES_MAX;

/// A place where two pieces touch or nearly touch, in the frame of B.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Midway between the two surfaces, in metres.
    pub point: Vec3,
    /// Unit normal from B into A.
    pub normal: Vec3,
    /// Distance of the surfaces along the normal in metres, radii included; negative when they
    /// overlap.
    pub gap: f32,
}

/// How two cores lie to each other, in the frame of B: what a manifold is made from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoreGap {
    /// Unit normal from B into A.
    pub normal: Vec3,
    /// Distance of the cores along the normal in metres, radii left out; negative when they
    /// overlap.
    pub gap: f32,
    /// Witness point on A's core.
    pub point_a: Vec3,
    /// Witness point on B's core.
    pub point_b: Vec3,
}

impl From<&CorePenetration> for CoreGap {
    fn from(found: &CorePenetration) -> Self {
        Self {
            normal: found.normal,
            gap: -found.depth,
            point_a: found.point_a,
            point_b: found.point_b,
        }
    }
}

impl From<&Distance> for CoreGap {
    fn from(found: &Distance) -> Self {
        Self {
            normal: found.normal,
            gap: found.lower_m,
            point_a: found.point_a,
            point_b: found.point_b,
        }
    }
}

/// The contacts of two pieces whose gap is at most `margin_m` metres.
///
/// `a_in_b` is the pose of A in the frame of B, `core` the answer of a penetration or distance
/// query at that pose. The first contact is the deepest. Empty when the pieces are farther apart
/// than the margin.
///
/// Cost: one pass over the faces of both, then (n + m) m steps for faces of n and m corners.
#[must_use]
pub fn manifold(
    a: &Convex,
    b: &Convex,
    a_in_b: &Pose,
    core: &CoreGap,
    margin_m: f32,
) -> ArrayVec<Contact, MANIFOLD_CONTACTS_MAX> {
    let radii = a.radius + b.radius;
    let mut kept = ArrayVec::new();
    if core.gap - radii > margin_m {
        return kept;
    }
    let touch = Touch {
        a: Placed::new(a, a_in_b),
        b: Placed::new(b, &Pose::IDENTITY),
        core,
        reach: margin_m + radii,
    };
    let mut corners = Corners::new();
    touch.collect(&mut corners);
    let merge = MERGE_PART * crate::math::min(a.size(), b.size());
    touch.include_witness(&mut corners, merge);
    for index in spread(&corners, core.normal, merge) {
        kept.push(contact(&corners[index], core.normal, a.radius, b.radius));
    }
    kept
}

/// A point midway between the cores and how far apart they are there.
#[derive(Clone, Copy)]
struct Corner {
    middle: Vec3,
    gap: f32,
}

type Corners = ArrayVec<Corner, CORNERS_MAX>;
type Polygon = ArrayVec<Vec3, CORNERS_MAX>;

/// The rounded surfaces leave the middle of the cores by half the difference of the radii.
fn contact(corner: &Corner, normal: Vec3, radius_a: f32, radius_b: f32) -> Contact {
    Contact {
        point: corner.middle + normal * (0.5 * (radius_b - radius_a)),
        normal,
        gap: corner.gap - (radius_a + radius_b),
    }
}

/// A piece and where it is in the frame of B.
struct Placed<'p, 'a> {
    piece: &'p Convex<'a>,
    rotation: Mat3,
    position: Vec3,
}

impl<'p, 'a> Placed<'p, 'a> {
    fn new(piece: &'p Convex<'a>, pose: &Pose) -> Self {
        Self {
            piece,
            rotation: pose.matrix(),
            position: pose.translation(),
        }
    }

    fn vertex(&self, index: usize) -> Vec3 {
        self.rotation * self.piece.vertex(index) + self.position
    }

    /// The face whose normal is nearest to a unit direction, and the cosine between them.
    fn face_along(&self, direction: Vec3) -> Option<(&'p Face, f32)> {
        let local = self.rotation.transpose() * direction;
        let mut best: Option<(&Face, f32)> = None;
        for face in self.piece.faces {
            let cosine = face.normal.dot(local);
            if best.is_none_or(|(_, most)| cosine > most) {
                best = Some((face, cosine));
            }
        }
        best
    }

    /// The corners of the face that lies most against `direction`, or the whole of a core that
    /// has no faces.
    fn feature_along(&self, direction: Vec3, polygon: &mut Polygon) {
        if let Some((face, _)) = self.face_along(direction) {
            for &index in self.piece.face_loop(face) {
                polygon.push(self.vertex(index as usize));
            }
            return;
        }
        for index in 0..self.piece.vertex_count {
            polygon.push(self.vertex(index));
        }
    }
}

/// Which piece has the face that the other is clipped by.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Reference {
    A,
    B,
}

struct Touch<'p, 'a, 'b> {
    a: Placed<'p, 'a>,
    b: Placed<'p, 'b>,
    core: &'p CoreGap,
    /// Cores farther apart than this are out of the margin.
    reach: f32,
}

impl Touch<'_, '_, '_> {
    fn collect(&self, corners: &mut Corners) {
        let normal = self.core.normal;
        let of_a = self.a.face_along(-normal);
        let of_b = self.b.face_along(normal);
        let cosine_a = of_a.map_or(0.0, |(_, cosine)| cosine);
        let cosine_b = of_b.map_or(0.0, |(_, cosine)| cosine);
        // Within rounding B's face is preferred, so that the choice does not flicker.
        let reference_a = cosine_a > cosine_b + 1e-5;
        match (of_a, of_b) {
            (Some((face, cosine)), _) if reference_a && cosine >= ALIGNED_COSINE => {
                self.clip(Reference::A, face, corners);
            }
            (_, Some((face, cosine))) if !reference_a && cosine >= ALIGNED_COSINE => {
                self.clip(Reference::B, face, corners);
            }
            (None, None) => self.along_segments(corners),
            _ => {}
        }
    }

    /// Clips the feature of the other piece by the sides of a face and keeps what is in reach.
    fn clip(&self, reference: Reference, face: &Face, corners: &mut Corners) {
        let (holder, other, outward) = match reference {
            Reference::A => (&self.a, &self.b, -self.core.normal),
            Reference::B => (&self.b, &self.a, self.core.normal),
        };
        let plane_normal = holder.rotation * face.normal;
        let ring = holder.piece.face_loop(face);
        let corner = |k: usize| holder.vertex(ring[k % ring.len()] as usize);
        let mut polygon = Polygon::new();
        other.feature_along(-plane_normal, &mut polygon);
        let mut clipped = Polygon::new();
        for k in 0..ring.len() {
            let start = corner(k);
            let side = (corner(k + 1) - start).cross(outward);
            clip_by_plane(&polygon, side, start, &mut clipped);
            core::mem::swap(&mut polygon, &mut clipped);
        }
        let anchor = corner(0);
        for &point in &polygon {
            let gap = plane_normal.dot(point - anchor) / plane_normal.dot(outward);
            self.push(point - outward * (0.5 * gap), gap, corners);
        }
    }

    /// Two nearly parallel segments touch along an interval; its ends are the contacts.
    fn along_segments(&self, corners: &mut Corners) {
        if self.a.piece.vertex_count < 2 || self.b.piece.vertex_count < 2 {
            return;
        }
        let (start_a, start_b) = (self.a.vertex(0), self.b.vertex(0));
        let (along_a, along_b) = (self.a.vertex(1) - start_a, self.b.vertex(1) - start_b);
        let cosine = along_a.dot(along_b) / (length(along_a) * length(along_b));
        if cosine.is_nan() || cosine.abs() < ALIGNED_COSINE {
            return;
        }
        let squared = along_b.length_squared();
        let at = |point: Vec3| along_b.dot(point - start_b) / squared;
        let (first, last) = (at(start_a), at(start_a + along_a));
        for end in [0.0, 1.0] {
            let t = crate::math::clamp(
                end,
                crate::math::min(first, last),
                crate::math::max(first, last),
            );
            if !(0.0..=1.0).contains(&t) {
                continue;
            }
            let on_b = start_b + along_b * t;
            let on_a = start_a + along_a * ((t - first) / (last - first));
            let gap = self.core.normal.dot(on_a - on_b);
            self.push((on_a + on_b) * 0.5, gap, corners);
        }
    }

    fn push(&self, middle: Vec3, gap: f32, corners: &mut Corners) {
        if gap <= self.reach && !corners.is_full() {
            corners.push(Corner { middle, gap });
        }
    }

    /// Adds the witness points when no corner is as deep: the deepest place is always a contact.
    fn include_witness(&self, corners: &mut Corners, merge: f32) {
        let deep_enough = self.core.gap + merge;
        if corners.iter().any(|corner| corner.gap <= deep_enough) {
            return;
        }
        let middle = (self.core.point_a + self.core.point_b) * 0.5;
        if corners.is_full() {
            corners.pop();
        }
        corners.push(Corner {
            middle,
            gap: self.core.gap,
        });
    }
}

/// Keeps the part of a convex polygon (or of a segment or point) on the inner side of a plane.
fn clip_by_plane(polygon: &Polygon, side: Vec3, start: Vec3, clipped: &mut Polygon) {
    clipped.clear();
    let count = polygon.len();
    // A segment is not a closed ring: its one edge is visited once.
    let edges = if count == 2 { 1 } else { count };
    let outside = |point: Vec3| side.dot(point - start);
    for k in 0..count {
        let (here, there) = (polygon[k], polygon[(k + 1) % count]);
        let (p, q) = (outside(here), outside(there));
        if p <= 0.0 && !clipped.is_full() {
            clipped.push(here);
        }
        let crosses = (p < 0.0 && q > 0.0) || (p > 0.0 && q < 0.0);
        if k < edges && crosses && !clipped.is_full() {
            clipped.push(here + (there - here) * (p / (p - q)));
        }
    }
}

/// Up to four corners that stand for all: the deepest, the farthest from it, the one that makes
/// the largest triangle, the one farthest outside that triangle. Ties go to the lowest index.
fn spread(corners: &Corners, normal: Vec3, merge: f32) -> ArrayVec<usize, MANIFOLD_CONTACTS_MAX> {
    let mut kept = ArrayVec::new();
    let at = |index: usize| corners[index].middle;
    let Some((deepest, _)) = most(corners, |corner| -corner.gap) else {
        return kept;
    };
    kept.push(deepest);
    let first = at(deepest);
    let Some((farthest, squared)) = most(corners, |c| (c.middle - first).length_squared()) else {
        return kept;
    };
    if squared <= merge * merge {
        return kept;
    }
    kept.push(farthest);
    let second = at(farthest);
    let area = |from: Vec3, to: Vec3, p: Vec3| (to - from).cross(p - from).dot(normal);
    let thin = merge * length(second - first);
    let third = most(corners, |c| area(first, second, c.middle).abs());
    let Some((widest, _)) = third.filter(|&(_, twice)| twice > thin) else {
        return kept;
    };
    kept.push(widest);
    let third = at(widest);
    let turn = if area(first, second, third) > 0.0 {
        1.0
    } else {
        -1.0
    };
    let outside = |c: &Corner| {
        let of = |from: Vec3, to: Vec3| -turn * area(from, to, c.middle);
        let of_sides = [of(first, second), of(second, third), of(third, first)];
        crate::math::max(of_sides[0], crate::math::max(of_sides[1], of_sides[2]))
    };
    if let Some((last, _)) = most(corners, outside).filter(|&(_, twice)| twice > thin) {
        kept.push(last);
    }
    kept
}

/// The corner with the largest value, and the value; ties to the lowest index.
fn most(corners: &Corners, value: impl Fn(&Corner) -> f32) -> Option<(usize, f32)> {
    let mut best: Option<(usize, f32)> = None;
    for (index, corner) in corners.iter().enumerate() {
        let now = value(corner);
        if best.is_none_or(|(_, before)| now > before) {
            best = Some((index, now));
        }
    }
    best
}
