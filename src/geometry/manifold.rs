//! Where two pieces touch: up to four contacts from one normal.
//!
//! If the normal is that of a face, the face, edge or point of the other piece that lies against
//! it is clipped by the sides of that face (Sutherland and Hodgman 1974), and four of the corners
//! that stand for the whole patch are kept. If two edges lie along each other, the ends of the
//! stretch that they share are. Otherwise the witness points make the one contact.
//!
//! Which four are kept is not up to rounding: `spread` asks only for the corner that reaches
//! farthest some way. Where sides lie along each other they cross anywhere, but such a crossing is
//! between true corners and reaches farthest no way.

use core::f32::consts::FRAC_1_SQRT_2;

use arrayvec::ArrayVec;
use glam::{Mat3, Vec3};

use super::convex::{Convex, Face};
use super::distance::Distance;
use super::penetration::CorePenetration;
use crate::limits::{MANIFOLD_CONTACTS_MAX, OVERLAP_SLOP_M, PIECE_VERTICES_MAX};
use crate::math::{Pose, clamp, direction, length, max, min, perpendicular, sqrt};

/// A face counts as lying across the normal when the cosine between them is at least this: an
/// angle of 1.1 degrees. A normal that comes from a face is within 1e-6 of it, one from a distance
/// query within 1e-3.
pub const ALIGNED_COSINE: f32 = 0.9998;

/// Edges lie along each other when the cosine between them is at least this: an angle of 11 degrees.
/// The stretch that they share gets shorter as the angle grows, and here is a few times
/// [`Touch::sideways`].
const PARALLEL_COSINE: f32 = 0.98;

/// Contacts closer together than this part of the smaller piece's size are one contact. Corners whose
/// gaps differ by less, and by less than [`OVERLAP_SLOP_M`], are equally deep.
pub const MERGE_PART: f32 = 1e-4;

/// Two directions at right angles in the frame of B. Every patch is looked at along one of them, for
/// no other reason than that it stays the same when the patch trembles. Across each axis the first is
/// 3 degrees or more off the multiples of 15 and 22.5 degrees, at which sides of patches are common.
const WAYS: [Vec3; 2] = [
    Vec3::new(0.779_011, 0.565_951, 0.270_005),
    Vec3::new(0.327_482, 0.0, -0.944_857),
];

/// A patch is looked at another way when it is more than this many times longer there. Across a side a
/// patch is short, and which end of that side comes first would be up to the jitter.
const LONGER: f32 = 1.05;

/// How much of its distance from the line between the first two contacts a corner may lack if it is
/// farther along that line: parallel sides have two corners at one distance.
const LEAN_PART: f32 = 0.125;

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
/// query at that pose. Empty when the pieces are farther apart than the margin.
///
/// The first contact is the deepest of those given, and the pieces are nowhere deeper by more than
/// twice [`MERGE_PART`] of the smaller one's size.
///
/// Cost: one pass over the faces of both, then (n + m) m steps for faces of n and m corners and twelve
/// passes over the n + m corners of the patch; without a face along the normal one pass over the
/// vertices and edges of both.
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
        merge: MERGE_PART * min(a.size(), b.size()),
    };
    let mut corners = Corners::new();
    touch.collect(&mut corners);
    touch.include_witness(&mut corners);
    for index in spread(&corners, core.normal, touch.merge) {
        kept.push(contact(&corners[index], core.normal, a.radius, b.radius));
    }
    deepest_first(&mut kept);
    kept
}

fn deepest_first(contacts: &mut [Contact]) {
    for index in 1..contacts.len() {
        if contacts[index].gap < contacts[0].gap {
            contacts.swap(0, index);
        }
    }
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

    /// The ends of the edge that lies most across `direction`, of those at the vertex that reaches
    /// farthest along it. A sphere has none.
    fn edge_across(&self, direction: Vec3) -> Option<[Vec3; 2]> {
        let local = self.rotation.transpose() * direction;
        let farthest = self.piece.support(local).index as u16;
        let mut best: Option<([u16; 2], f32)> = None;
        for edge in self.piece.edges {
            if !edge.vertices.contains(&farthest) {
                continue;
            }
            let [start, end] = edge.vertices.map(|v| self.piece.vertex(v as usize));
            let along = end - start;
            let drop = along.dot(local).abs() / length(along);
            if best.is_none_or(|(_, least)| drop < least) {
                best = Some((edge.vertices, drop));
            }
        }
        best.map(|(ends, _)| ends.map(|v| self.vertex(v as usize)))
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
    /// Contacts closer together than this are one.
    merge: f32,
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
            _ => self.along_edges(corners),
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
        // The references change places, not what is behind them: a polygon takes 12 KB.
        let (mut polygon, mut clipped) = (&mut Polygon::new(), &mut Polygon::new());
        other.feature_along(-plane_normal, polygon);
        for k in 0..ring.len() {
            let start = corner(k);
            let side = (corner(k + 1) - start).cross(outward);
            clip_by_plane(polygon, side, start, clipped);
            core::mem::swap(&mut polygon, &mut clipped);
        }
        let anchor = corner(0);
        for &point in polygon.iter() {
            let gap = plane_normal.dot(point - anchor) / plane_normal.dot(outward);
            self.push(point - outward * (0.5 * gap), gap, corners);
        }
    }

    /// Two edges along each other touch in a stretch; its ends are the contacts.
    ///
    /// Places are told by how far along the edges they are and how far beside each other, so that
    /// the stretch is a segment that can be clipped.
    fn along_edges(&self, corners: &mut Corners) {
        let normal = self.core.normal;
        let (Some(a), Some(b)) = (self.a.edge_across(-normal), self.b.edge_across(normal)) else {
            return;
        };
        let Some(axis) = common_axis(a, b) else {
            return;
        };
        let (span_a, span_b) = (span(a, b[0], axis), span(b, b[0], axis));
        let from = max(min(span_a[0], span_a[1]), min(span_b[0], span_b[1]));
        let to = min(max(span_a[0], span_a[1]), max(span_b[0], span_b[1]));
        if from > to {
            return;
        }
        let beside = normal.cross(axis);
        let apart = |x: f32| point_at(a, span_a, x) - point_at(b, span_b, x);
        let mut stretch = Polygon::new();
        for x in [from, to] {
            stretch.push(Vec3::new(x, apart(x).dot(beside), 0.0));
        }
        let mut clipped = Polygon::new();
        let edge = Vec3::Y * self.sideways();
        clip_by_plane(&stretch, Vec3::Y, edge, &mut clipped);
        clip_by_plane(&clipped, Vec3::NEG_Y, -edge, &mut stretch);
        for place in &stretch {
            let (on_a, on_b) = (point_at(a, span_a, place.x), point_at(b, span_b, place.x));
            self.push((on_a + on_b) * 0.5, normal.dot(on_a - on_b), corners);
        }
    }

    /// How far beside each other points of two edges may be and still touch. Their distance is then
    /// more than the gap along the normal by at most the merging distance (Pythagoras).
    fn sideways(&self) -> f32 {
        sqrt(self.merge * (2.0 * max(self.core.gap, 0.0) + self.merge))
    }

    fn push(&self, middle: Vec3, gap: f32, corners: &mut Corners) {
        if gap <= self.reach && !corners.is_full() {
            corners.push(Corner { middle, gap });
        }
    }

    /// Adds the witness points when no corner is as deep: the deepest place is always a contact.
    fn include_witness(&self, corners: &mut Corners) {
        let deep_enough = self.core.gap + self.merge;
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

/// The unit vector midway between the directions of two edges, if they lie along each other.
fn common_axis(a: [Vec3; 2], b: [Vec3; 2]) -> Option<Vec3> {
    let (along_a, along_b) = (direction(a[1] - a[0])?, direction(b[1] - b[0])?);
    let cosine = along_a.dot(along_b);
    if cosine.abs() < PARALLEL_COSINE {
        return None;
    }
    direction(along_b + along_a * if cosine > 0.0 { 1.0 } else { -1.0 })
}

/// How far along an axis the ends of an edge are, from an origin.
fn span(edge: [Vec3; 2], origin: Vec3, axis: Vec3) -> [f32; 2] {
    edge.map(|end| axis.dot(end - origin))
}

/// The point of an edge whose place along the axis is `x`.
fn point_at(edge: [Vec3; 2], span: [f32; 2], x: f32) -> Vec3 {
    let t = clamp((x - span[0]) / (span[1] - span[0]), 0.0, 1.0);
    edge[0] + (edge[1] - edge[0]) * t
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

/// Up to four corners that stand for all: the two ends of the patch one way, then the farthest from
/// the line between them on either side. If one side is bare, the last is the one farthest outside the
/// triangle of the others.
///
/// Each but the last is the corner that reaches farthest along some vector, and the vectors come from the
/// patch as a whole and from the frame of B. So a corner that is there by rounding only is never
/// preferred to one that is not.
///
/// The patch lies within a parallelogram: two sides through the first two corners, the others along the
/// line between them. The kept corners span half of it, less what [`LEAN_PART`] takes away.
fn spread(corners: &Corners, normal: Vec3, merge: f32) -> ArrayVec<usize, MANIFOLD_CONTACTS_MAX> {
    let mut kept = ArrayVec::new();
    let Some([first, second]) = ends(corners, normal, merge) else {
        return kept;
    };
    kept.push(first);
    let from = corners[first].middle;
    let line = corners[second].middle - from;
    if line.length_squared() <= merge * merge {
        return kept;
    }
    kept.push(second);
    let across = normal.cross(line);
    let thin = merge * length(line);
    for side in [1.0, -1.0] {
        kept.extend(outermost(corners, from, line * side, across * side, thin));
    }
    if let [_, _, third] = kept[..] {
        let triangle = [first, second, third].map(|index| corners[index].middle);
        kept.extend(farthest_outside(corners, triangle, normal, thin));
    }
    kept
}

/// The two ends of a patch along one of the [`WAYS`], the deeper one first.
///
/// Both the way and the depth count: over the whole patch the way counts as much as the difference of
/// gaps below which corners are equally deep. On a flat patch gaps change evenly, and what is asked for
/// is still the corner that reaches farthest along a vector.
fn ends(corners: &Corners, normal: Vec3, merge: f32) -> Option<[usize; 2]> {
    let origin = corners.first()?.middle;
    let (way, length) = view(corners, normal);
    let level = min(merge, OVERLAP_SLOP_M) / max(length, merge);
    let favour = |c: &Corner| level * way.dot(c.middle - origin) - c.gap;
    let (first, _) = most(corners, favour)?;
    let (second, _) = most(corners, |c| -favour(c))?;
    let away = |c: &Corner| (c.middle - corners[first].middle).length_squared();
    if away(&corners[second]) > merge * merge {
        return Some([first, second]);
    }
    most(corners, away).map(|(second, _)| [first, second])
}

/// The way along which a patch is looked at, across the normal, and how long it is that way: one of the
/// [`WAYS`], or of those at 90, 45 and 135 degrees with it.
fn view(corners: &Corners, normal: Vec3) -> (Vec3, f32) {
    // One of the two is at an angle of 45 degrees or more with the normal.
    let along_normal = WAYS.map(|way| way.dot(normal));
    let pick = usize::from(along_normal[0].abs() > 0.9);
    let flat = WAYS[pick] - normal * along_normal[pick];
    let way = direction(flat).unwrap_or_else(|| perpendicular(normal));
    let other = normal.cross(way);
    let mut best = (way, extent(corners, way));
    for way in [
        other,
        (way + other) * FRAC_1_SQRT_2,
        (way - other) * FRAC_1_SQRT_2,
    ] {
        let length = extent(corners, way);
        if length > LONGER * best.1 {
            best = (way, length);
        }
    }
    best
}

/// How far the corners reach along a vector, from the first to the last.
fn extent(corners: &Corners, along: Vec3) -> f32 {
    let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
    for corner in corners {
        let reach = along.dot(corner.middle);
        low = min(low, reach);
        high = max(high, reach);
    }
    high - low
}

/// The corner farthest from a line on the side of `across`, leaning to the end of the line. None when
/// the corners are nowhere farther than `thin`, in units of the length of `across`.
fn outermost(corners: &Corners, from: Vec3, line: Vec3, across: Vec3, thin: f32) -> Option<usize> {
    let (_, wide) = most(corners, |c| across.dot(c.middle - from))?;
    if wide <= thin {
        return None;
    }
    // Along the line corners differ by its extent at most, so no more than the part of `wide` is lost.
    let leaning = across + line * (LEAN_PART * wide / extent(corners, line));
    most(corners, |c| leaning.dot(c.middle - from)).map(|(index, _)| index)
}

/// The corner that makes the largest triangle with a side of another that it is outside of. None when
/// twice its area is at most `thin`.
fn farthest_outside(
    corners: &Corners,
    [first, second, third]: [Vec3; 3],
    normal: Vec3,
    thin: f32,
) -> Option<usize> {
    let area = |from: Vec3, to: Vec3, p: Vec3| (to - from).cross(p - from).dot(normal);
    let turn = if area(first, second, third) > 0.0 {
        1.0
    } else {
        -1.0
    };
    let outside = |c: &Corner| {
        let of = |from: Vec3, to: Vec3| -turn * area(from, to, c.middle);
        max(of(second, third), of(third, first))
    };
    let (last, twice) = most(corners, outside)?;
    (twice > thin).then_some(last)
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
