//! What a convex piece is made of.

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};
use wide::f32x8;

use crate::math::{LANE_WIDTH, max};

/// Eight vertices, one coordinate after the other, in metres.
///
/// The last lane of a piece is filled up with copies of the piece's first vertex.
#[repr(C, align(32))]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Lane {
    /// First coordinates.
    pub x: [f32; LANE_WIDTH],
    /// Second coordinates.
    pub y: [f32; LANE_WIDTH],
    /// Third coordinates.
    pub z: [f32; LANE_WIDTH],
}

/// A flat face: the plane `normal . p = offset` with the hull on its negative side.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Face {
    /// Outward unit normal.
    pub normal: Vec3,
    /// Distance of the plane from the frame's origin along the normal, in metres.
    pub offset: f32,
    /// Where the face's vertices start in the piece's loops.
    pub first_loop: u16,
    /// How many vertices the face has; they run counter-clockwise seen from outside.
    pub loop_count: u16,
}

/// An edge between two faces that are not parallel.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct Edge {
    /// The two ends, as vertex indices of the piece.
    pub vertices: [u16; 2],
    /// The two faces that meet here, as face indices of the piece. The first is the one whose loop
    /// runs from the first end to the second.
    pub faces: [u16; 2],
}

/// A convex piece in its own frame: the hull of its vertices (the core) and a rounding radius.
///
/// One vertex makes a sphere, two make a capsule; both have no faces (a capsule has one edge whose
/// two face indices are zero and mean nothing). Anything else is a solid with volume.
#[derive(Clone, Copy, Debug)]
pub struct Convex<'a> {
    /// The vertices, padded by copies of the first.
    pub lanes: &'a [Lane],
    /// Number of vertices without the padding.
    pub vertex_count: usize,
    /// The faces; empty for spheres and capsules.
    pub faces: &'a [Face],
    /// The edges.
    pub edges: &'a [Edge],
    /// Vertex indices of all faces, one loop after the other.
    pub loops: &'a [u16],
    /// Rounding radius in metres.
    pub radius: f32,
    /// Centre of the core's bounding box, in metres.
    pub centre: Vec3,
    /// Half the size of the core's bounding box, in metres.
    pub half_extents: Vec3,
    /// Whether the core is its bounding box, to the bit.
    pub is_box: bool,
}

/// A vertex and how far it reaches along the direction it was asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Support {
    /// Index of the vertex; the lowest of those that tie.
    pub index: usize,
    /// Dot product of the vertex and the direction.
    pub reach: f32,
}

impl Convex<'_> {
    /// The vertex with the given index.
    #[inline]
    #[must_use]
    pub fn vertex(&self, index: usize) -> Vec3 {
        let lane = &self.lanes[index / LANE_WIDTH];
        let i = index % LANE_WIDTH;
        Vec3::new(lane.x[i], lane.y[i], lane.z[i])
    }

    /// From the first vertex to the last: the whole of a segment, zero for a point.
    #[inline]
    pub(crate) fn extent(&self) -> Vec3 {
        self.vertex(self.vertex_count - 1) - self.vertex(0)
    }

    /// The vertex loop of a face, counter-clockwise seen from outside.
    #[inline]
    #[must_use]
    pub fn face_loop(&self, face: &Face) -> &[u16] {
        let first = face.first_loop as usize;
        &self.loops[first..first + face.loop_count as usize]
    }

    /// The vertex that reaches farthest along `direction` (any length), ties to the lowest index.
    ///
    /// Cost: one pass over the lanes.
    #[inline]
    #[must_use]
    pub fn support(&self, direction: Vec3) -> Support {
        support_of(self.lanes, direction)
    }

    /// Index of the vertex that reaches farthest along `direction`, compared in f64.
    ///
    /// Cost: one pass over the lanes, and one product in f64 for each vertex that f32 cannot tell from the
    /// best.
    #[inline]
    pub(crate) fn support_exact(&self, direction: DVec3) -> usize {
        support_exact_of(self, direction)
    }

    /// Radius of the smallest ball about the frame's origin that holds the bounding box of the
    /// core, in metres. The rounding radius is not in it.
    #[inline]
    #[must_use]
    pub fn core_reach(&self) -> f32 {
        crate::math::length(self.centre.abs() + self.half_extents)
    }

    /// The diagonal of the core's bounding box plus the rounding, in metres: the size that
    /// tolerances are relative to.
    #[inline]
    #[must_use]
    pub fn size(&self) -> f32 {
        2.0 * (crate::math::length(self.half_extents) + self.radius)
    }
}

/// Rounding of a product of a vertex and a direction in f32: three roundings of the coordinates'
/// products, two of the sum and one of the direction, each half of this.
const DOT_ROUNDING: f32 = 4.0 * f32::EPSILON;

/// Lanes whose products are kept at a time: as many as have places in 64 bits.
const CHUNK: usize = 8;

/// Products of up to [`CHUNK`] lanes with a direction.
///
/// Eight wide whatever the processor: two vectors of four in a baseline x86-64 build, with the same
/// bits. Built for x86-64-v3 the queries of `benches/stages.rs` were no faster (5 to 60 % slower on the
/// Xeon they were measured on), so nothing is dispatched at run time.
struct Products {
    of_lanes: [f32x8; CHUNK],
    count: usize,
    most: f32,
}

impl Products {
    #[inline(always)]
    fn of(lanes: &[Lane], direction: Vec3) -> Self {
        let [x, y, z] = [direction.x, direction.y, direction.z].map(f32x8::splat);
        let mut new = Self {
            of_lanes: [f32x8::ZERO; CHUNK],
            count: lanes.len(),
            most: f32::NEG_INFINITY,
        };
        let mut most = f32x8::splat(f32::NEG_INFINITY);
        for (lane, products) in lanes.iter().zip(&mut new.of_lanes) {
            *products = f32x8::new(lane.x) * x + f32x8::new(lane.y) * y + f32x8::new(lane.z) * z;
            most = most.fast_max(*products);
        }
        let m = most.as_array();
        new.most = max(
            max(max(m[0], m[4]), max(m[2], m[6])),
            max(max(m[1], m[5]), max(m[3], m[7])),
        );
        new
    }

    /// Places whose products are at least `least`, as bits.
    #[inline(always)]
    fn at_least(&self, least: f32) -> u64 {
        let least = f32x8::splat(least);
        let mut bits = 0;
        let mut shift = 0;
        for products in &self.of_lanes[..self.count] {
            bits |= u64::from(products.simd_ge(least).to_bitmask()) << (shift & 63);
            shift += LANE_WIDTH;
        }
        bits
    }
}

/// The vertex with the largest product, the first of those that tie.
#[inline(never)]
fn support_of(lanes: &[Lane], direction: Vec3) -> Support {
    let mut best = Support {
        index: 0,
        reach: f32::NEG_INFINITY,
    };
    let mut first = 0;
    for lanes in lanes.chunks(CHUNK) {
        let products = Products::of(lanes, direction);
        if products.most > best.reach {
            let place = products.at_least(products.most).trailing_zeros() as usize;
            let lane = &products.of_lanes[place / LANE_WIDTH % CHUNK];
            best = Support {
                index: first + place,
                reach: lane.as_array()[place % LANE_WIDTH],
            };
        }
        first += CHUNK * LANE_WIDTH;
    }
    best
}

/// As [`support_of`], compared in f64: candidates are those that f32 cannot tell from the best.
#[inline(never)]
fn support_exact_of(piece: &Convex, direction: DVec3) -> usize {
    let single = direction.as_vec3();
    let span = (piece.centre.abs() + piece.half_extents).dot(single.abs());
    let rounding = 2.0 * DOT_ROUNDING * span;
    if piece.lanes.len() <= CHUNK {
        let products = Products::of(piece.lanes, single);
        let hits = products.at_least(products.most - rounding);
        let first = hits.trailing_zeros() as usize;
        if hits & hits.wrapping_sub(1) == 0 {
            return first % (CHUNK * LANE_WIDTH);
        }
        let mut reach = f64::NEG_INFINITY;
        return exact_of_hits(piece, direction, 0, hits, &mut reach).unwrap_or(0);
    }
    let (mut index, mut reach, mut least) = (0, f64::NEG_INFINITY, f32::NEG_INFINITY);
    let mut first = 0;
    for lanes in piece.lanes.chunks(CHUNK) {
        let products = Products::of(lanes, single);
        least = max(least, products.most - rounding);
        if products.most >= least {
            let hits = products.at_least(least);
            index = exact_of_hits(piece, direction, first, hits, &mut reach).unwrap_or(index);
        }
        first += CHUNK * LANE_WIDTH;
    }
    index
}

/// The first vertex of those marked in `hits`, counted from `first` on, that reaches farthest, if it
/// reaches farther than `reach`, which it then becomes.
fn exact_of_hits(
    piece: &Convex,
    direction: DVec3,
    first: usize,
    mut hits: u64,
    reach: &mut f64,
) -> Option<usize> {
    let mut index = None;
    while hits != 0 {
        let candidate = first + hits.trailing_zeros() as usize;
        hits &= hits - 1;
        let product = piece.vertex(candidate).as_dvec3().dot(direction);
        if product > *reach {
            (index, *reach) = (Some(candidate), product);
        }
    }
    index
}
