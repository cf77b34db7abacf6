//! How deep two cores overlap: the exact least translation that parts them, by enumeration of
//! separating axes.
//!
//! [`super::separation`] finds the same with less work by growing a polytope, and turns to this where
//! that gives up. The way out of unions needs all axes up to a depth, not only the least: this knows
//! them.
//!
//! The difference of two convex solids is a polytope whose faces come from the faces of A, the
//! faces of B and those pairs of edges whose arcs cross on the Gauss sphere (Gregorius 2013, "The
//! Separating Axis Test between Convex Polyhedra"). The nearest of those planes is the answer.
//! Three things differ from the usual implementations:
//!
//! * **No absolute tolerance.** Arcs are compared by the signs of four dot products. A sign that
//!   noise decided wrongly does no harm, see below.
//! * **Every axis that wins was verified** by the supports of both cores along it. The depth
//!   returned is therefore the overlap along a real direction: never less than the penetration
//!   depth, up to the rounding of one dot product. Errors can only make it larger.
//! * **Pruning is exact.** For a point c inside B whose nearest face is r away, the overlap along
//!   n of an edge or face of A through v is at least n . (c - v) + r. An edge is left out when no
//!   n of its arc can beat the best depth so far, and the same with A and B exchanged. It is
//!   also left out when one vertex of the other core is deep enough below both of its faces.
//!
//! # Nearly parallel edges
//!
//! Let the directions of two edges of length l and m differ by a small angle t. Their face of the
//! difference is a parallelogram of width w = min(l, m) sin t. If the answer lies on it, its foot
//! is within w of a long side, and the plane of the neighbour behind that side passes within
//! sqrt(d^2 + w^2) <= d + w of the origin. So leaving the pair out costs at most w; at the bound
//! [`PARALLEL_SINE`] that is 1e-6 of the shorter edge. Above the bound the axis is off by about
//! e / t, where e is the rounding of the directions, but it turns about the common direction of
//! the edges, and the parallelogram is only w wide across it: the depth changes by e min(l, m),
//! which is the accuracy of f32 itself. The same argument covers a sign decided by noise, because
//! then the crossing lies that close to the end of an arc, and the end is the normal of a face,
//! which is tested.

pub(crate) mod boxes;

use arrayvec::ArrayVec;
use glam::{Mat3, Vec3};

use crate::geometry::convex::{Convex, Edge, Lane};
use crate::geometry::relative::Relative;
use crate::limits::PIECE_FACES_MAX;
use crate::math::{LANE_WIDTH, Pose, direction, length, max, min, perpendicular};

/// Two edges are parallel when the sine of their angle is at most this.
pub const PARALLEL_SINE: f32 = 1e-6;

/// Segments meet when they are closer than this part of their sizes and distance.
const MEETING_PART: f32 = 2e-7;

/// How much too large pruning takes its bounds, as a part of the pieces' sizes.
///
/// Rounding moves heights by 1e-7 of the size s, and where the normals of an edge differ by an
/// angle t it moves the best axis between them by 1e-7 s / t. That axis is better than the normals
/// by at most s t^2 / 8. The lesser of both is largest for t near 0.01, where it is 1.1e-5 s.
const PRUNING_PART: f32 = 2e-5;

/// An edge is a blade when the sum of its normals, squared, is less than this: when its solid's angle is
/// less than 0.01.
///
/// Rounding of heights by 1e-7 of the size s hides, between nearly opposite normals, a height of
/// 1e-7 s / t for the solid's angle t. Down to this t that is within [`PRUNING_PART`].
const BLADE_SUM_SQUARED: f32 = 1e-4;

/// Lanes of B's edges that are compared with all edges of A before the next ones are loaded.
const EDGE_LANES_MAX: usize = 32;

/// Which features of the cores the axis comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Feature {
    /// A face of A; the normal is opposite to the face's.
    FaceA(u16),
    /// A face of B; the normal is the face's.
    FaceB(u16),
    /// An edge of A and an edge of B.
    Edges(u16, u16),
    /// Neither core is a solid: the closest points of two points or segments.
    Points,
}

/// How deep two cores overlap, in the frame of B.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CorePenetration {
    /// Unit vector from B into A: moving A by `depth` along it parts the cores.
    pub normal: Vec3,
    /// Overlap along the normal in metres. Negative when the axis parts the cores by that much: a
    /// lower bound of their distance, and the distance itself when neither core is a solid.
    pub depth: f32,
    /// Where the axis comes from.
    pub feature: Feature,
    /// A point at the bottom of the overlap, on A's face or edge if the axis is that feature's.
    pub point_a: Vec3,
    /// The point opposite to it at the top of the overlap. Where faces lie on each other in a cross, one
    /// of the two points may be beside its core, in its supporting plane.
    pub point_b: Vec3,
}

/// The depth of two cores, rounding radii left out.
///
/// `a_in_b` is the pose of A in the frame of B. The least overlap over all axes, exact up to f32
/// rounding of the coordinates; where several axes tie, the first in the order of faces of B,
/// faces of A, edges wins unless the seed already reached the same depth.
///
/// Cost: at most [`worst_steps`].
#[must_use]
pub fn core_penetration(a: &Convex, b: &Convex, a_in_b: &Pose) -> CorePenetration {
    core_penetration_until(a, b, a_in_b, f32::NEG_INFINITY)
}

/// As [`core_penetration`], but the first axis whose depth is at most `enough_m` is returned.
///
/// With `enough_m` zero this answers "do the cores overlap" and stops at the first axis that parts
/// them. Cost: at most [`worst_steps`].
#[must_use]
pub fn core_penetration_until(
    a: &Convex,
    b: &Convex,
    a_in_b: &Pose,
    enough_m: f32,
) -> CorePenetration {
    core_penetration_in(a, b, &Relative::from(a_in_b), enough_m)
}

/// As [`core_penetration_until`], from the pose in f64.
pub(crate) fn core_penetration_in(
    a: &Convex,
    b: &Convex,
    a_in_b: &Relative,
    enough_m: f32,
) -> CorePenetration {
    if a.faces.is_empty() && b.faces.is_empty() {
        return closest_of_segments(a, b, a_in_b);
    }
    if let Some(pair) = boxes::Boxes::of(a, b, a_in_b) {
        return pair.penetration(a, b, &pair.least(f64::from(enough_m)));
    }
    Search::new(a, b, a_in_b, Least::new(enough_m)).run()
}

/// Calls `visit` with the normal and overlap of every axis whose overlap is at most `cap_m`.
///
/// Together these half-spaces bound the difference of the cores within that distance. Nothing is
/// visited when neither core is a solid. Cost: at most [`worst_steps`].
pub(crate) fn axes_within(
    a: &Convex,
    b: &Convex,
    a_in_b: &Pose,
    cap_m: f32,
    visit: &mut dyn FnMut(Vec3, f32),
) {
    let a_in_b = Relative::from(a_in_b);
    let mut search = Search::new(a, b, &a_in_b, Within { cap_m, visit });
    search.all_faces();
    search.all_edges();
}

/// What to do with the axes that a search finds.
trait Sink {
    /// Axes with more overlap than this are of no interest.
    fn cap(&self) -> f32;
    /// Whether the search may stop.
    fn done(&self) -> bool;
    /// Takes an axis whose overlap was measured.
    fn take(&mut self, axis: &Axis);
}

/// Keeps the axis of least overlap; the first of those that tie.
struct Least {
    best: Axis,
    enough: f32,
}

impl Least {
    fn new(enough: f32) -> Self {
        let best = Axis {
            normal: Vec3::Y,
            depth: f32::INFINITY,
            feature: Feature::Points,
            vertex_a: 0,
            vertex_b: 0,
        };
        Self { best, enough }
    }
}

impl Sink for Least {
    fn cap(&self) -> f32 {
        self.best.depth
    }

    fn done(&self) -> bool {
        self.best.depth <= self.enough
    }

    fn take(&mut self, axis: &Axis) {
        if axis.depth < self.best.depth {
            self.best = *axis;
        }
    }
}

/// Hands on every axis up to a cap.
struct Within<'v> {
    cap_m: f32,
    visit: &'v mut dyn FnMut(Vec3, f32),
}

impl Sink for Within<'_> {
    fn cap(&self) -> f32 {
        self.cap_m
    }

    fn done(&self) -> bool {
        false
    }

    fn take(&mut self, axis: &Axis) {
        if axis.depth <= self.cap_m {
            (self.visit)(axis.normal, axis.depth);
        }
    }
}

/// Most lane operations that one call spends: dot products with one lane of vertices, or
/// comparisons of an edge with one lane of edges.
///
/// Faces of each against the vertices of the other, all edges of A against the lanes of B's edges,
/// and as many verifications as [`verifications_max`] allows.
#[must_use]
pub const fn worst_steps(
    vertices: (usize, usize),
    faces: (usize, usize),
    edges: (usize, usize),
) -> usize {
    let lanes = (
        vertices.0.div_ceil(LANE_WIDTH),
        vertices.1.div_ceil(LANE_WIDTH),
    );
    let of_faces = (faces.0 + 1) * lanes.1 + (faces.1 + 1) * lanes.0;
    let of_edges = edges.0 * edges.1.div_ceil(LANE_WIDTH);
    let of_verification = verifications_max(edges) * (lanes.0 + lanes.1);
    of_faces + of_edges + of_verification
}

/// Most edge axes that are verified by supports in one call.
///
/// A verification happens when an axis seems to improve the best depth. In an order that knows
/// nothing of depths that is the logarithm of the number of axes; this bound is never met except
/// by pieces built to meet it, and then axes are left out and the depth is an upper bound.
#[must_use]
pub const fn verifications_max(edges: (usize, usize)) -> usize {
    64 + 2 * (edges.0 + edges.1)
}

/// A point inside a core and a distance that the core's surface keeps from it.
#[derive(Clone, Copy)]
struct Heart {
    centre: Vec3,
    radius: f32,
}

impl Heart {
    /// The mean of the vertices, those that fill up the last lane included.
    fn of(piece: &Convex) -> Self {
        let mut sum = Lane {
            x: [0.0; LANE_WIDTH],
            y: [0.0; LANE_WIDTH],
            z: [0.0; LANE_WIDTH],
        };
        for lane in piece.lanes {
            for i in 0..LANE_WIDTH {
                sum.x[i] += lane.x[i];
                sum.y[i] += lane.y[i];
                sum.z[i] += lane.z[i];
            }
        }
        let mut total = Vec3::ZERO;
        for i in 0..LANE_WIDTH {
            total += Vec3::new(sum.x[i], sum.y[i], sum.z[i]);
        }
        let centre = total / (piece.lanes.len() * LANE_WIDTH) as f32;
        let mut radius = f32::INFINITY;
        for face in piece.faces {
            let inside = face.offset - face.normal.dot(centre);
            radius = if inside < radius { inside } else { radius };
        }
        let solid = radius > 0.0 && radius < f32::INFINITY;
        let radius = if solid { radius } else { 0.0 };
        Self { centre, radius }
    }
}

/// How far the heart of the other core is outside each face of a piece, and with it how little
/// overlap the axes of faces and edges can have.
struct Heights<'p, 'a, 'o> {
    piece: &'p Convex<'a>,
    /// Radius of the other core's heart, less what rounding may hide.
    radius: f32,
    /// What rounding may hide.
    rounding: f32,
    /// Centre of the other core's heart.
    centre: Vec3,
    outside: ArrayVec<f32, PIECE_FACES_MAX>,
    other: &'p Convex<'o>,
    /// Turn and shift from the other piece's frame into this one's.
    turn: Mat3,
    shift: Vec3,
    /// The other piece's deepest vertex below each face that was tested, or [`UNTESTED`].
    deepest: ArrayVec<u16, PIECE_FACES_MAX>,
}

/// In place of a vertex index: the face was not tested.
const UNTESTED: u16 = u16::MAX;

impl<'p, 'a, 'o> Heights<'p, 'a, 'o> {
    fn new(
        piece: &'p Convex<'a>,
        other: &'p Convex<'o>,
        turn: Mat3,
        shift: Vec3,
        rounding: f32,
    ) -> Self {
        let heart = Heart::of(other);
        let centre = turn * heart.centre + shift;
        Self {
            piece,
            radius: heart.radius - rounding,
            rounding,
            centre,
            outside: piece
                .faces
                .iter()
                .map(|face| face.normal.dot(centre) - face.offset)
                .collect(),
            other,
            turn,
            shift,
            deepest: piece.faces.iter().map(|_| UNTESTED).collect(),
        }
    }

    /// Whether an edge is worth comparing with those of the other piece.
    fn matters(&self, edge: &Edge, cap: f32) -> bool {
        self.edge_matters(edge, cap) && !self.vertex_covers(edge, cap)
    }

    /// Whether a vertex of the other piece shows that no axis between the normals of an edge's faces
    /// has overlap below `cap`.
    ///
    /// With p and q its depths below the faces, its depth below the plane through the edge with
    /// normal x n1 + y n2 is x p + y q. A unit vector between the normals has x and y not negative
    /// and x + y >= 1, so the overlap is at least min(p, q) if that is not negative.
    fn vertex_covers(&self, edge: &Edge, cap: f32) -> bool {
        let faces = edge.faces.map(usize::from);
        let enough = max(cap, 0.0) + self.rounding;
        faces.iter().any(|&tested| {
            let deepest = self.deepest[tested];
            if deepest == UNTESTED {
                return false;
            }
            let vertex = self.turn * self.other.vertex(deepest as usize) + self.shift;
            faces.iter().all(|&index| {
                let face = &self.piece.faces[index];
                face.offset - face.normal.dot(vertex) >= enough
            })
        })
    }

    /// Least overlap that the axis of a face can have.
    fn face_bound(&self, index: usize) -> f32 {
        self.radius - self.outside[index]
    }

    /// Whether an axis between the normals of an edge's two faces can have overlap below `cap`.
    ///
    /// The faces' planes meet in the edge, so their heights are the products of their normals with
    /// one vector, from the edge to the heart. The largest product of a unit vector between the
    /// normals is that of one of them, or the length of the vector's projection onto their plane
    /// if that lies between them. With c the cosine of the normals and q = 1 - c that is
    /// ((m1 - m2)^2 + 2 q m1 m2) / (q (2 - q)), squared. Of a blade the heights do not tell that length.
    fn edge_matters(&self, edge: &Edge, cap: f32) -> bool {
        let (f1, f2) = (edge.faces[0] as usize, edge.faces[1] as usize);
        let (m1, m2) = (self.outside[f1], self.outside[f2]);
        let bound = self.radius - cap;
        if m1 > bound || m2 > bound {
            return true;
        }
        let (n1, n2) = (self.piece.faces[f1].normal, self.piece.faces[f2].normal);
        if (n1 + n2).length_squared() < BLADE_SUM_SQUARED {
            return self.blade_matters(edge, bound);
        }
        if m1 <= 0.0 && m2 <= 0.0 {
            return false;
        }
        let q = 0.5 * (n1 - n2).length_squared();
        let between = m1 - m2 + q * m2 > 0.0 && m2 - m1 + q * m1 > 0.0;
        let squared = (m1 - m2) * (m1 - m2) + 2.0 * q * m1 * m2;
        between && squared > bound * bound * (q * (2.0 - q))
    }

    /// Whether the heart is farther from an edge's line than `bound`: no height over a plane through the
    /// edge is more than that distance.
    fn blade_matters(&self, edge: &Edge, bound: f32) -> bool {
        let [start, end] = edge.vertices.map(|index| self.piece.vertex(index as usize));
        let along = end - start;
        let area_squared = along.cross(self.centre - start).length_squared();
        bound < 0.0 || area_squared > bound * bound * along.length_squared()
    }
}

/// Eight edges of B; unused places are zero and cross nothing.
#[derive(Clone, Copy)]
struct EdgeLane {
    along: [[f32; LANE_WIDTH]; 3],
    first: [[f32; LANE_WIDTH]; 3],
    second: [[f32; LANE_WIDTH]; 3],
    index: [u16; LANE_WIDTH],
}

impl EdgeLane {
    const EMPTY: Self = Self {
        along: [[0.0; LANE_WIDTH]; 3],
        first: [[0.0; LANE_WIDTH]; 3],
        second: [[0.0; LANE_WIDTH]; 3],
        index: [0; LANE_WIDTH],
    };

    fn set(&mut self, place: usize, edge: &Arc, index: usize) {
        for axis in 0..3 {
            self.along[axis][place] = edge.along[axis];
            self.first[axis][place] = edge.first[axis];
            self.second[axis][place] = edge.second[axis];
        }
        self.index[place] = index as u16;
    }
}

/// An edge: a point, the vector to its other end, the normals of the faces beside it.
#[derive(Clone, Copy)]
struct Arc {
    start: Vec3,
    along: Vec3,
    first: Vec3,
    second: Vec3,
}

impl Arc {
    fn of(piece: &Convex, edge: &Edge) -> Self {
        let start = piece.vertex(edge.vertices[0] as usize);
        let along = piece.vertex(edge.vertices[1] as usize) - start;
        if piece.faces.is_empty() {
            return Self {
                start,
                along,
                first: Vec3::ZERO,
                second: Vec3::ZERO,
            };
        }
        Self {
            start,
            along,
            first: piece.faces[edge.faces[0] as usize].normal,
            second: piece.faces[edge.faces[1] as usize].normal,
        }
    }
}

/// Which of the two cores is a segment, whose arc is a whole circle.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Arcs {
    Both,
    OnlyA,
    OnlyB,
}

struct Search<'p, 'a, 'b, S> {
    a: Heights<'p, 'a, 'b>,
    b: Heights<'p, 'b, 'a>,
    rotation: Mat3,
    inverse: Mat3,
    position: Vec3,
    verifications_left: usize,
    sink: S,
}

/// An axis and the supports that verified it.
#[derive(Clone, Copy)]
struct Axis {
    normal: Vec3,
    depth: f32,
    feature: Feature,
    vertex_a: usize,
    vertex_b: usize,
}

impl<'p, 'a, 'b, S: Sink> Search<'p, 'a, 'b, S> {
    fn new(a: &'p Convex<'a>, b: &'p Convex<'b>, a_in_b: &Relative, sink: S) -> Self {
        let rotation = a_in_b.turn.as_mat3();
        let inverse = rotation.transpose();
        let position = a_in_b.shift.as_vec3();
        let rounding = PRUNING_PART * (a.size() + b.size());
        Self {
            a: Heights::new(a, b, inverse, -(inverse * position), rounding),
            b: Heights::new(b, a, rotation, position, rounding),
            rotation,
            inverse,
            position,
            verifications_left: verifications_max((a.edges.len(), b.edges.len())),
            sink,
        }
    }

    /// Tests the face with the least bound first, so that the others are pruned early.
    fn seed(&mut self) {
        let mut least = f32::INFINITY;
        let mut seed = Feature::Points;
        for index in 0..self.b.outside.len() {
            let bound = self.b.face_bound(index);
            if bound < least {
                (least, seed) = (bound, Feature::FaceB(index as u16));
            }
        }
        for index in 0..self.a.outside.len() {
            let bound = self.a.face_bound(index);
            if bound < least {
                (least, seed) = (bound, Feature::FaceA(index as u16));
            }
        }
        match seed {
            Feature::FaceA(index) => self.try_face_a(index as usize),
            Feature::FaceB(index) => self.try_face_b(index as usize),
            Feature::Edges(..) | Feature::Points => {}
        }
    }

    fn all_faces(&mut self) {
        for index in 0..self.b.outside.len() {
            if self.sink.done() {
                return;
            }
            if self.b.face_bound(index) < self.sink.cap() {
                self.try_face_b(index);
            }
        }
        for index in 0..self.a.outside.len() {
            if self.sink.done() {
                return;
            }
            if self.a.face_bound(index) < self.sink.cap() {
                self.try_face_a(index);
            }
        }
    }

    /// Tests a face of B; its own side is known, so the support of A alone can rule it out.
    fn try_face_b(&mut self, index: usize) {
        let face = &self.b.piece.faces[index];
        let support = self.a.piece.support(self.inverse * -face.normal);
        self.b.deepest[index] = support.index as u16;
        let low = support.reach;
        if low + face.offset - face.normal.dot(self.position) < self.sink.cap() {
            self.try_axis(face.normal, Feature::FaceB(index as u16));
        }
    }

    /// Tests a face of A; its own side is known, so the support of B alone can rule it out.
    fn try_face_a(&mut self, index: usize) {
        let face = &self.a.piece.faces[index];
        let normal = self.rotation * -face.normal;
        let support = self.b.piece.support(normal);
        self.a.deepest[index] = support.index as u16;
        let high = support.reach;
        if high + face.offset - normal.dot(self.position) < self.sink.cap() {
            self.try_axis(normal, Feature::FaceA(index as u16));
        }
    }

    /// Measures the overlap along a unit vector by the supports of both cores.
    fn try_axis(&mut self, normal: Vec3, feature: Feature) {
        let low = self.a.piece.support(self.inverse * -normal);
        let high = self.b.piece.support(normal);
        let from = self.point_of_a(low.index);
        self.sink.take(&Axis {
            normal,
            depth: normal.dot(self.b.piece.vertex(high.index) - from),
            feature,
            vertex_a: low.index,
            vertex_b: high.index,
        });
    }

    fn point_of_a(&self, index: usize) -> Vec3 {
        self.rotation * self.a.piece.vertex(index) + self.position
    }

    fn all_edges(&mut self) {
        let arcs = match (self.a.outside.is_empty(), self.b.outside.is_empty()) {
            (true, _) => Arcs::OnlyB,
            (_, true) => Arcs::OnlyA,
            _ => Arcs::Both,
        };
        let mut lanes = ArrayVec::<EdgeLane, EDGE_LANES_MAX>::new();
        let mut next = 0;
        while next < self.b.piece.edges.len() && !self.sink.done() {
            lanes.clear();
            next = self.load_edges_of_b(next, &mut lanes);
            if lanes.is_empty() {
                return;
            }
            for index in 0..self.a.piece.edges.len() {
                if self.sink.done() {
                    return;
                }
                let edge = &self.a.piece.edges[index];
                if arcs == Arcs::OnlyB || self.a.matters(edge, self.sink.cap()) {
                    let arc = self.arc_of_a(index);
                    self.against_lanes(&arc, index, &lanes, arcs);
                }
            }
        }
    }

    fn arc_of_a(&self, index: usize) -> Arc {
        let arc = Arc::of(self.a.piece, &self.a.piece.edges[index]);
        Arc {
            start: self.rotation * arc.start + self.position,
            along: self.rotation * arc.along,
            first: self.rotation * arc.first,
            second: self.rotation * arc.second,
        }
    }

    /// Fills the lanes with edges of B from index `next` on; returns the first that was not seen.
    fn load_edges_of_b(
        &self,
        next: usize,
        lanes: &mut ArrayVec<EdgeLane, EDGE_LANES_MAX>,
    ) -> usize {
        let edges = self.b.piece.edges;
        let segment = self.b.outside.is_empty();
        let mut place = LANE_WIDTH;
        for index in next..edges.len() {
            if !segment && !self.b.matters(&edges[index], self.sink.cap()) {
                continue;
            }
            if place == LANE_WIDTH {
                if lanes.is_full() {
                    return index;
                }
                lanes.push(EdgeLane::EMPTY);
                place = 0;
            }
            if let Some(lane) = lanes.last_mut() {
                lane.set(place, &Arc::of(self.b.piece, &edges[index]), index);
            }
            place += 1;
        }
        edges.len()
    }

    fn against_lanes(&mut self, edge: &Arc, index: usize, lanes: &[EdgeLane], arcs: Arcs) {
        for lane in lanes {
            let hits = match arcs {
                Arcs::Both => crossings(edge, lane),
                Arcs::OnlyA => straddles(
                    &dots(&lane.along, edge.first),
                    &dots(&lane.along, edge.second),
                ),
                Arcs::OnlyB => straddles(
                    &dots(&lane.first, edge.along),
                    &dots(&lane.second, edge.along),
                ),
            };
            let mut bits = hits;
            while bits != 0 {
                let place = bits.trailing_zeros() as usize;
                bits &= bits - 1;
                self.try_edges(edge, index, lane.index[place] as usize, arcs);
            }
        }
    }

    /// Tests the axis of two edges whose arcs cross.
    fn try_edges(&mut self, edge: &Arc, index_a: usize, index_b: usize, arcs: Arcs) {
        let other = Arc::of(self.b.piece, &self.b.piece.edges[index_b]);
        let cross = edge.along.cross(other.along);
        let sine_squared = cross.length_squared();
        let scale = edge.along.length_squared() * other.along.length_squared();
        if sine_squared <= PARALLEL_SINE * PARALLEL_SINE * scale {
            return;
        }
        let side = match arcs {
            Arcs::OnlyB => other.first.dot(edge.along),
            Arcs::Both | Arcs::OnlyA => edge.first.dot(other.along),
        };
        let Some(axis) = direction(cross) else {
            return;
        };
        let normal = if side > 0.0 { -axis } else { axis };
        let seems = normal.dot(other.start - edge.start);
        if seems < self.sink.cap() && self.verifications_left > 0 {
            self.verifications_left -= 1;
            let feature = Feature::Edges(index_a as u16, index_b as u16);
            self.try_axis(normal, feature);
        }
    }
}

impl Search<'_, '_, '_, Least> {
    fn run(mut self) -> CorePenetration {
        self.seed();
        self.all_faces();
        self.all_edges();
        self.answer()
    }

    fn answer(&self) -> CorePenetration {
        let best = &self.sink.best;
        let (point_a, point_b) = match best.feature {
            Feature::Edges(index_a, index_b) => {
                let edge = self.arc_of_a(index_a as usize);
                let other = Arc::of(self.b.piece, &self.b.piece.edges[index_b as usize]);
                closest_points(edge.start, edge.along, other.start, other.along)
            }
            _ => self.points_of_face(best),
        };
        CorePenetration {
            normal: best.normal,
            depth: best.depth,
            feature: best.feature,
            point_a,
            point_b,
        }
    }

    /// The points of a face's axis: a vertex of the other core and the point of the face opposite to it.
    /// Where a face or edge lies on the face that point may be beside it; then a vertex of the face's
    /// own core is taken, if it is less beside the other one.
    fn points_of_face(&self, best: &Axis) -> (Vec3, Vec3) {
        let below = self.point_of_a(best.vertex_a);
        let above = self.b.piece.vertex(best.vertex_b);
        let shift = best.normal * best.depth;
        let (of_a, of_b) = ((below, below + shift), (above - shift, above));
        let beside_b = outside_box(self.b.piece, of_a.1);
        let beside_a = outside_box(self.a.piece, self.inverse * (of_b.0 - self.position));
        let take_b = match best.feature {
            Feature::FaceA(_) => beside_a <= beside_b + self.a.rounding,
            _ => beside_b > beside_a + self.a.rounding,
        };
        if take_b { of_b } else { of_a }
    }
}

/// How far a point is outside the bounding box of a core in whose frame it is, along one axis.
fn outside_box(piece: &Convex, point: Vec3) -> f32 {
    let beside = (point - piece.centre).abs() - piece.half_extents;
    max(beside.max_element(), 0.0)
}

/// Dot products of eight vectors with one.
#[inline]
fn dots(lane: &[[f32; LANE_WIDTH]; 3], v: Vec3) -> [f32; LANE_WIDTH] {
    let mut result = [0.0; LANE_WIDTH];
    for i in 0..LANE_WIDTH {
        result[i] = lane[0][i] * v.x + lane[1][i] * v.y + lane[2][i] * v.z;
    }
    result
}

/// Places where the two numbers have opposite signs, as bits.
#[inline]
fn straddles(p: &[f32; LANE_WIDTH], q: &[f32; LANE_WIDTH]) -> u32 {
    let mut bits = 0;
    for i in 0..LANE_WIDTH {
        let apart = (p[i] > 0.0 && q[i] < 0.0) || (p[i] < 0.0 && q[i] > 0.0);
        bits |= u32::from(apart) << i;
    }
    bits
}

/// Places of the lane whose arcs, negated, cross the arc of `edge`, as bits.
///
/// With a1, a2, d the normals and direction of A's edge and b1, b2, e those of B's: the ends of
/// each arc lie on both sides of the other's plane, and on the same half of the sphere, exactly
/// when b1.d, -b2.d, a1.e and -a2.e all have the same sign.
#[inline]
fn crossings(edge: &Arc, lane: &EdgeLane) -> u32 {
    let mut cross = [0.0; LANE_WIDTH];
    for i in 0..LANE_WIDTH {
        let dot =
            |v: &[[f32; LANE_WIDTH]; 3], w: Vec3| v[0][i] * w.x + v[1][i] * w.y + v[2][i] * w.z;
        let p1 = dot(&lane.first, edge.along);
        let p2 = -dot(&lane.second, edge.along);
        let q1 = dot(&lane.along, edge.first);
        let q2 = -dot(&lane.along, edge.second);
        let least = min(min(p1, p2), min(q1, q2));
        let most = max(max(p1, p2), max(q1, q2));
        cross[i] = max(least, -most);
    }
    let pairs: [f32; 4] = core::array::from_fn(|i| max(cross[i], cross[i + 4]));
    if max(max(pairs[0], pairs[1]), max(pairs[2], pairs[3])) <= 0.0 {
        return 0;
    }
    let mut bits = 0;
    for i in 0..LANE_WIDTH {
        bits |= u32::from(cross[i] > 0.0) << i;
    }
    bits
}

/// The closest points of two cores that are points or segments.
fn closest_of_segments(a: &Convex, b: &Convex, a_in_b: &Relative) -> CorePenetration {
    let (start_a, along_a) = (a.vertex(0), a.extent());
    let (start_b, along_b) = (b.vertex(0), b.extent());
    let along_a = (a_in_b.turn * along_a.as_dvec3()).as_vec3();
    let start_a = a_in_b.point(start_a).as_vec3();
    let (point_a, point_b) = closest_points(start_a, along_a, start_b, along_b);
    let between = point_a - point_b;
    // Between segments that meet there is only a rounding error, which has no direction.
    let noise = MEETING_PART * (a.size() + b.size() + length(a_in_b.shift.as_vec3()));
    let normal = direction(between)
        .filter(|_| length(between) > noise)
        .unwrap_or_else(|| normal_of_crossing(along_a, along_b));
    CorePenetration {
        normal,
        depth: -length(between),
        feature: Feature::Points,
        point_a,
        point_b,
    }
}

/// A unit vector at right angles to two vectors, either of which may be zero.
pub(crate) fn normal_of_crossing(d: Vec3, e: Vec3) -> Vec3 {
    let cross = d.cross(e);
    let scale = d.length_squared() * e.length_squared();
    if cross.length_squared() > PARALLEL_SINE * PARALLEL_SINE * scale
        && let Some(normal) = direction(cross)
    {
        return normal;
    }
    let longer = if d.length_squared() >= e.length_squared() {
        d
    } else {
        e
    };
    direction(longer).map_or(Vec3::Y, perpendicular)
}

/// The closest points of the segments p + s d and q + t e with s and t in [0, 1].
///
/// Ericson 2005, "Real-Time Collision Detection", 5.1.9, with a relative test for parallel ones.
pub(crate) fn closest_points(p: Vec3, d: Vec3, q: Vec3, e: Vec3) -> (Vec3, Vec3) {
    let r = p - q;
    let (dd, ee, de) = (d.length_squared(), e.length_squared(), d.dot(e));
    let (dr, er) = (d.dot(r), e.dot(r));
    let unit = |x: f32| crate::math::clamp(x, 0.0, 1.0);
    if dd <= 0.0 || ee <= 0.0 {
        let s = if dd > 0.0 { unit(-dr / dd) } else { 0.0 };
        let t = if ee > 0.0 { unit(er / ee) } else { 0.0 };
        return (p + d * s, q + e * t);
    }
    let area = d.cross(e).length_squared();
    let crossing = area > PARALLEL_SINE * PARALLEL_SINE * dd * ee;
    let s = if crossing {
        unit((de * er - dr * ee) / area)
    } else {
        0.0
    };
    let t = (de * s + er) / ee;
    if (0.0..=1.0).contains(&t) {
        return (p + d * s, q + e * t);
    }
    let t = unit(t);
    let s = unit((de * t - dr) / dd);
    (p + d * s, q + e * t)
}
