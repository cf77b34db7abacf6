//! What a convex piece is made of.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::math::{LANE_WIDTH, max, min};

/// The places of a lane.
const PLACES: [f32; LANE_WIDTH] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];

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

/// Products of eight vertices with a direction.
#[inline]
fn dots(lane: &Lane, direction: Vec3) -> [f32; LANE_WIDTH] {
    core::array::from_fn(|i| {
        lane.x[i] * direction.x + lane.y[i] * direction.y + lane.z[i] * direction.z
    })
}

/// The vertex with the largest product, the first of those that tie. Lanes are counted in f32, which
/// is exact there and is selected by the mask that compares the products.
///
/// The order of the reductions is one that compilers turn into vectors of four; inlined, vectors of
/// two were seen.
#[inline(never)]
fn support_of(lanes: &[Lane], direction: Vec3) -> Support {
    let mut best = [f32::NEG_INFINITY; LANE_WIDTH];
    let mut places = [0.0; LANE_WIDTH];
    let mut start = 0.0;
    for lane in lanes {
        let dots = dots(lane, direction);
        for i in 0..LANE_WIDTH {
            let better = dots[i] > best[i];
            best[i] = if better { dots[i] } else { best[i] };
            places[i] = if better { start } else { places[i] };
        }
        start += LANE_WIDTH as f32;
    }
    let [a, b, c, d] = [0, 1, 2, 3].map(|i| max(best[i], best[i + 4]));
    let reach = max(max(a, b), max(c, d));
    for i in 0..LANE_WIDTH {
        let place = places[i] + PLACES[i];
        places[i] = if best[i] == reach { place } else { start };
    }
    let [a, b, c, d] = [0, 1, 2, 3].map(|i| min(places[i], places[i + 4]));
    let first = min(min(a, b), min(c, d));
    Support {
        index: if first < start { first as usize } else { 0 },
        reach,
    }
}
