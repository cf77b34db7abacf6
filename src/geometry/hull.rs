//! Making a convex piece's core: the hull of points, or a sphere, capsule or box directly.
//!
//! This is done once per piece, not in a frame. The method, in three steps:
//!
//! 1. The points are put on an integer grid 16 times finer than f32 at the hull's size, where
//!    quickhull with exact predicates gives a closed mesh of triangles: no case is degenerate.
//! 2. Triangles that are flat together within [`FLATNESS`] are merged; points that are then no
//!    corner of three faces are left out, and step 1 is repeated without them.
//! 3. The result is checked: Euler's formula, convex loops, no two faces with two common edges,
//!    corners within [`DEVIATION_MAX`] of planes that all vertices are below, no input point farther
//!    outside. If a check fails, everything is done again with a tolerance four times finer, in the
//!    end with none. What fails even then is refused.
//!
//! Near an edge of a small angle t a point may be within a tolerance of both planes and yet 1 / t times as
//! far from the hull, so sharp edges need tolerances down to a cell of the grid. Below that, points on
//! a line make triangles with normals that only rounding to the grid decided.

mod grid;
mod merge;
mod mesh;
mod output;

use core::fmt;

use glam::Vec3;

use self::grid::Grid;
use self::merge::Groups;
use self::mesh::Mesh;
use self::output::Output;
use super::convex::{Convex, Edge, Face, Lane};
use crate::limits::{PIECE_REACH_M, PIECE_VERTICES_MAX};

/// How thick a slab may be in which triangles count as one flat face, relative to the hull's size.
///
/// Rounding the corners of a flat face to f32 spreads them by up to sqrt(3) half spacings to
/// either side, 1e-7 of the size when the frame's origin is inside; this is four times that.
pub const FLATNESS: f64 = 4e-7;

/// How far an input point may be outside the hull at most, relative to the hull's size.
pub const DEVIATION_MAX: f64 = 1e-6;

/// Points in a slab or a rod about this thin, relative to their size, have no volume.
pub const THICKNESS_MIN: f64 = 1e-6;

/// Points closer together than this, in metres, have no volume: products of such lengths would
/// leave the range of f32.
pub const SIZE_M_MIN: f64 = 1e-6;

const _: () = assert!(FLATNESS * 2.0 < DEVIATION_MAX);
const _: () = assert!(FLATNESS * 2.0 < THICKNESS_MIN);

/// The tolerances tried in turn, relative to the hull's size. The last but one is about a cell.
const LADDER: [f64; 6] = [
    FLATNESS,
    FLATNESS / 4.0,
    FLATNESS / 16.0,
    FLATNESS / 64.0,
    FLATNESS / 256.0,
    0.0,
];

/// How often a hull is made again without its spare points before the tolerance is lowered.
const REBUILDS_MAX: usize = 8;

/// Why points make no hull.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HullError {
    /// Fewer than four points.
    TooFew,
    /// More than [`PIECE_VERTICES_MAX`] points.
    TooMany,
    /// A coordinate is not a number or infinite.
    NotFinite,
    /// A coordinate is beyond [`PIECE_REACH_M`].
    TooLarge,
    /// The points lie in a plane, on a line or in one place: see [`THICKNESS_MIN`] and
    /// [`SIZE_M_MIN`]. Or they are so nearly there that no hull passes its checks.
    Degenerate,
}

impl fmt::Display for HullError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::TooFew => "a hull needs at least four points",
            Self::TooMany => "more points than PIECE_VERTICES_MAX",
            Self::NotFinite => "a coordinate is not finite",
            Self::TooLarge => "a coordinate is beyond PIECE_REACH_M",
            Self::Degenerate => "the points have no volume",
        })
    }
}

impl core::error::Error for HullError {}

/// A finished core, borrowed from its builder. Lengths in metres; see [`Convex`] for the parts.
#[derive(Clone, Copy, Debug)]
pub struct HullView<'a> {
    /// The vertices in the order of the input, padded by copies of the first.
    pub lanes: &'a [Lane],
    /// Number of vertices without the padding.
    pub vertex_count: usize,
    /// The faces, none for spheres and capsules.
    pub faces: &'a [Face],
    /// The edges, each once.
    pub edges: &'a [Edge],
    /// Vertex indices of all faces; each loop starts at its lowest vertex.
    pub loops: &'a [u16],
    /// Centre of the bounding box.
    pub centre: Vec3,
    /// Half the size of the bounding box, rounded up so that it holds every vertex.
    pub half_extents: Vec3,
    /// Whether the core is its bounding box, to the bit.
    pub is_box: bool,
}

impl<'a> HullView<'a> {
    /// The piece with this core and a rounding radius in metres.
    #[must_use]
    pub fn convex(&self, radius: f32) -> Convex<'a> {
        Convex {
            lanes: self.lanes,
            vertex_count: self.vertex_count,
            faces: self.faces,
            edges: self.edges,
            loops: self.loops,
            radius,
            centre: self.centre,
            half_extents: self.half_extents,
            is_box: self.is_box,
        }
    }
}

/// Room to make a core in, to be used again and again. About 140 kB
/// ([`HullBuilder::BYTES`]) without pointers: it may live on the stack or in a static.
#[derive(Clone, Debug)]
pub struct HullBuilder {
    grid: Grid,
    mesh: Mesh,
    groups: Groups,
    active: [bool; PIECE_VERTICES_MAX],
    output: Output,
}

impl Default for HullBuilder {
    fn default() -> Self {
        Self::new()
    }
}

impl HullBuilder {
    /// Size of the builder in bytes.
    pub const BYTES: usize = size_of::<Self>();

    /// An empty builder.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            grid: Grid::new(),
            mesh: Mesh::new(),
            groups: Groups::new(),
            active: [false; PIECE_VERTICES_MAX],
            output: Output::new(),
        }
    }

    /// The convex hull of points in metres, in any order, with duplicates, collinear and coplanar
    /// ones among them.
    ///
    /// Vertices are those input points that are corners, bit for bit and in input order. Every
    /// vertex is inside every face's plane, evaluated exactly; every input point is within
    /// [`DEVIATION_MAX`] of the hull. Equal input gives equal bits.
    ///
    /// # Errors
    /// See [`HullError`]; sizes are judged relative to the points' bounding box.
    ///
    /// # Cost
    /// One hull takes at most n^2 steps, in practice n log n; it is made once, twice when points
    /// lie on faces or edges, and never more than 48 times.
    pub fn build(&mut self, points: &[[f32; 3]]) -> Result<HullView<'_>, HullError> {
        self.grid.fill(points, SIZE_M_MIN)?;
        for tolerance in LADDER {
            if self.attempt(points, tolerance)? {
                return Ok(self.output.view());
            }
        }
        Err(HullError::Degenerate)
    }

    /// Makes the hull with a tolerance relative to its size; whether the result may be used.
    fn attempt(&mut self, points: &[[f32; 3]], tolerance: f64) -> Result<bool, HullError> {
        self.active = [true; PIECE_VERTICES_MAX];
        let tolerance = tolerance * self.grid.size;
        for _ in 0..REBUILDS_MAX {
            self.triangulate(tolerance)?;
            self.groups.gather(&self.mesh, &self.grid.cells, tolerance);
            if !self.drop_spare() {
                return Ok(self.finish(points));
            }
        }
        Ok(false)
    }

    fn triangulate(&mut self, tolerance: f64) -> Result<(), HullError> {
        let thickness_min = THICKNESS_MIN * self.grid.size;
        let cells = &self.grid.cells;
        let solid = self
            .mesh
            .build(cells, &self.active, tolerance, thickness_min);
        solid.then_some(()).ok_or(HullError::Degenerate)
    }

    /// Leaves out all but the corners of three faces or more; whether that changes the mesh.
    fn drop_spare(&mut self) -> bool {
        let mut dropped = false;
        for point in 0..PIECE_VERTICES_MAX {
            let corner = self.mesh.on_hull[point];
            let spare = corner && self.groups.degree[point] < 3;
            self.active[point] = corner && !spare;
            dropped |= spare;
        }
        dropped
    }

    fn finish(&mut self, points: &[[f32; 3]]) -> bool {
        let deviation_m = DEVIATION_MAX * self.grid.size_m;
        self.output.collect(&self.mesh, &self.groups, points)
            && self.output.touches_planes(deviation_m)
            && self.output.holds(points, deviation_m)
    }

    /// The core of a sphere: its centre, in metres.
    ///
    /// # Errors
    /// `NotFinite`, `TooLarge`.
    pub fn sphere(&mut self, centre: Vec3) -> Result<HullView<'_>, HullError> {
        check(centre)?;
        self.output.set_vertices([centre.to_array()].into_iter());
        Ok(self.output.view())
    }

    /// The core of a capsule: the segment from `a` to `b`, in metres; a sphere's when they are equal.
    ///
    /// # Errors
    /// `NotFinite`, `TooLarge`.
    pub fn capsule(&mut self, a: Vec3, b: Vec3) -> Result<HullView<'_>, HullError> {
        check(a)?;
        check(b)?;
        if a == b {
            return self.sphere(a);
        }
        self.output
            .set_vertices([a.to_array(), b.to_array()].into_iter());
        self.output.push_edge([0, 1], [0, 0]);
        Ok(self.output.view())
    }

    /// A box about the origin with the given half extents, in metres. Faces are -x +x -y +y -z +z;
    /// bits 0, 1 and 2 of a vertex index are set where x, y and z are positive.
    ///
    /// # Errors
    /// `NotFinite`, `TooLarge`, `Degenerate` when a half extent is not positive or too small for
    /// the others.
    pub fn cuboid(&mut self, half_extents: Vec3) -> Result<HullView<'_>, HullError> {
        check(half_extents)?;
        let size_m = 2.0 * f64::from(crate::math::length(half_extents));
        let thinnest_m = 2.0 * f64::from(half_extents.min_element());
        if size_m < SIZE_M_MIN || thinnest_m <= THICKNESS_MIN * size_m {
            return Err(HullError::Degenerate);
        }
        self.output
            .set_vertices((0..8).map(|i| corner(half_extents, i)));
        for corners in CUBOID_LOOPS {
            self.output.push_face(corners.into_iter());
        }
        for (vertices, faces) in CUBOID_EDGES {
            self.output.push_edge(vertices, faces);
        }
        Ok(self.output.view())
    }
}

fn check(point: Vec3) -> Result<(), HullError> {
    if !point.is_finite() {
        return Err(HullError::NotFinite);
    }
    if point.abs().max_element() > PIECE_REACH_M {
        return Err(HullError::TooLarge);
    }
    Ok(())
}

/// A corner of a box; the index's bits say which coordinates are positive.
fn corner(half_extents: Vec3, index: usize) -> [f32; 3] {
    let sign = |bit: usize| if index >> bit & 1 == 1 { 1.0 } else { -1.0 };
    [
        half_extents.x * sign(0),
        half_extents.y * sign(1),
        half_extents.z * sign(2),
    ]
}

const CUBOID_LOOPS: [[u16; 4]; 6] = [
    [0, 4, 6, 2],
    [1, 3, 7, 5],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 2, 3, 1],
    [4, 5, 7, 6],
];

const CUBOID_EDGES: [([u16; 2], [u16; 2]); 12] = [
    ([0, 4], [0, 2]),
    ([4, 6], [0, 5]),
    ([6, 2], [0, 3]),
    ([2, 0], [0, 4]),
    ([1, 3], [1, 4]),
    ([3, 7], [1, 3]),
    ([7, 5], [1, 5]),
    ([5, 1], [1, 2]),
    ([0, 1], [2, 4]),
    ([5, 4], [2, 5]),
    ([6, 7], [3, 5]),
    ([3, 2], [3, 4]),
];
