//! Pieces: convex parts of bodies, and the pools their vertices lie in.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::geometry::convex::{Convex, Edge, Face, Lane};
use crate::geometry::warm::WarmFeature;
use crate::math::{self, Pose};
use crate::memory::columns::columns;
use crate::memory::ids::PieceId;

/// Where a piece's vertices, faces, edges and loops lie in the pools, and its bounds.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Shape {
    pub first_lane: u32,
    pub lanes: u32,
    pub vertices: u32,
    pub first_face: u32,
    pub faces: u32,
    pub first_edge: u32,
    pub edges: u32,
    pub first_loop: u32,
    pub loops: u32,
    pub radius: f32,
    /// The farthest that the surface is from the piece's own origin, in metres.
    pub reach: f32,
    pub centre: Vec3,
    pub half_extents: Vec3,
    /// One when the core is its bounding box, else zero.
    pub is_box: u32,
}

/// Which driven pieces pass through each other: of pieces of two driven bodies, or of two chains of one,
/// those pass of which one belongs to a group that the other passes through. Fixed and dynamic bodies
/// stop every piece.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct Groups {
    /// A bit for each group that the piece belongs to.
    pub member_of: u32,
    /// A bit for each group that it passes through.
    pub passes: u32,
}

impl Groups {
    pub(crate) const fn pass(self, other: Self) -> bool {
        (self.member_of & other.passes) | (self.passes & other.member_of) != 0
    }
}

/// An axis-aligned box in the world.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct Bounds {
    pub low: Vec3,
    pub high: Vec3,
}

impl Bounds {
    /// Holds nothing, overlaps nothing.
    pub(crate) const EMPTY: Self = Self {
        low: Vec3::splat(f32::INFINITY),
        high: Vec3::splat(f32::NEG_INFINITY),
    };

    /// Holds everything.
    pub(crate) const ALL: Self = Self {
        low: Vec3::splat(f32::NEG_INFINITY),
        high: Vec3::splat(f32::INFINITY),
    };

    /// The bounds of a shape at a pose: its box turned, boxed again, and rounded.
    pub(crate) fn of(shape: &Shape, pose: &Pose) -> Self {
        let m = pose.matrix();
        let half = m.x_axis.abs() * shape.half_extents.x
            + m.y_axis.abs() * shape.half_extents.y
            + m.z_axis.abs() * shape.half_extents.z
            + Vec3::splat(shape.radius);
        let centre = m * shape.centre + pose.translation();
        // Rounding of f32 at these coordinates, so that the box truly holds the piece.
        let slack = (centre.abs() + half) * (4.0 * f32::EPSILON);
        Self {
            low: centre - half - slack,
            high: centre + half + slack,
        }
    }

    pub(crate) fn union(self, other: Self) -> Self {
        Self {
            low: math::min_each(self.low, other.low),
            high: math::max_each(self.high, other.high),
        }
    }

    pub(crate) fn grown(self, by: f32) -> Self {
        Self {
            low: self.low - Vec3::splat(by),
            high: self.high + Vec3::splat(by),
        }
    }

    /// A lower bound of the distance between things in the two boxes; negative when they overlap.
    pub(crate) fn gap(&self, other: &Self) -> f32 {
        let apart = math::max_each(self.low - other.high, other.low - self.high);
        math::max(apart.x, math::max(apart.y, apart.z))
    }

    /// How far apart the surfaces in two boxes are at least that overlap by less than `radii`, the sum of their
    /// rounding radii, and the direction from the other into this along which they are: the distance of the boxes
    /// of their cores, less the rounding. Negative where nothing is known, and then of no direction.
    pub(crate) fn apart(&self, other: &Self, radii: f32) -> (f32, Vec3) {
        let above = self.low - other.high + Vec3::splat(radii);
        let below = other.low - self.high + Vec3::splat(radii);
        let way = math::max_each(above, Vec3::ZERO) - math::max_each(below, Vec3::ZERO);
        let length = math::length(way);
        if length == 0.0 {
            return (-radii, Vec3::ZERO);
        }
        (length * (1.0 - 4.0 * f32::EPSILON) - radii, way / length)
    }

    pub(crate) fn contains(&self, other: &Self) -> bool {
        self.low.cmple(other.low).all() && self.high.cmpge(other.high).all()
    }

    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        (self.low.x <= other.high.x)
            & (self.high.x >= other.low.x)
            & (self.low.y <= other.high.y)
            & (self.high.y >= other.low.y)
            & (self.low.z <= other.high.z)
            & (self.high.z >= other.low.z)
    }
}

/// Where the last search between a driven piece and one that it touched ended, for the next one to begin there.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Touched {
    pub other: PieceId,
    pub feature: WarmFeature,
}

columns! {
    /// One entry for every piece slot.
    pub(crate) struct Pieces(capacities) {
        generation: [u32; capacities.pieces],
        /// Body index.
        body: [u32; capacities.pieces],
        /// [`crate::state::bodies::BodyKind`] of the body, so that a pass over boxes needs nothing else; zero when free.
        body_kind: [u32; capacities.pieces],
        /// Next piece of the same body, index plus one.
        next: [u32; capacities.pieces],
        material: [u32; capacities.pieces],
        density: [f32; capacities.pieces],
        shape: [Shape; capacities.pieces],
        /// The joint whose link the piece is on, index plus one; zero for the body's root.
        link: [u32; capacities.pieces],
        /// Which [`Groups`] the piece belongs to and passes through.
        groups: [Groups; capacities.pieces],
        /// Published pose in the frame of the body or of the link.
        local: [Pose; capacities.pieces],
        /// Where the tracker wants it in that frame.
        local_target: [Pose; capacities.pieces],
        /// Published pose in the world.
        world: [Pose; capacities.pieces],
        /// Box of the published pose in the world.
        bounds: [Bounds; capacities.pieces],
        /// The same in the body's frame, for bodies with chains.
        own_bounds: [Bounds; capacities.pieces],
        /// The last piece that a driven piece touched.
        touched: [Touched; capacities.pieces],
    }
}

columns! {
    /// Vertices, faces and edges of all pieces, without gaps.
    pub(crate) struct Pools(capacities) {
        lanes: [Lane; capacities.lanes()],
        faces: [Face; capacities.faces()],
        edges: [Edge; capacities.edges()],
        loops: [u16; capacities.loops()],
    }
}

impl Pieces<'_> {
    /// The id of the piece in a slot.
    pub(crate) fn id(&self, slot: u32) -> PieceId {
        PieceId::new(slot as usize, self.generation[slot as usize])
    }
}

fn range<T>(pool: &[T], first: u32, count: u32) -> &[T] {
    &pool[first as usize..first as usize + count as usize]
}

/// Copies `items` to position `first` of a pool.
fn put<T: Copy>(pool: &mut [T], first: u32, items: &[T]) {
    pool[first as usize..first as usize + items.len()].copy_from_slice(items);
}

/// Closes the gap of `count` items at `first` in a pool with `used` items.
fn close_gap<T: Copy + Zeroable>(pool: &mut [T], first: u32, count: u32, used: u32) {
    let (first, count, used) = (first as usize, count as usize, used as usize);
    pool.copy_within(first + count..used, first);
    pool[used - count..used].fill(T::zeroed());
}

/// How much of each pool is in use.
#[derive(Clone, Copy)]
pub(crate) struct PoolUse {
    pub lanes: u32,
    pub faces: u32,
    pub edges: u32,
    pub loops: u32,
}

impl Pools<'_> {
    /// The shape as geometry sees it.
    #[inline]
    pub(crate) fn convex(&self, shape: &Shape) -> Convex<'_> {
        Convex {
            lanes: range(self.lanes, shape.first_lane, shape.lanes),
            vertex_count: shape.vertices as usize,
            faces: range(self.faces, shape.first_face, shape.faces),
            edges: range(self.edges, shape.first_edge, shape.edges),
            loops: range(self.loops, shape.first_loop, shape.loops),
            radius: shape.radius,
            centre: shape.centre,
            half_extents: shape.half_extents,
            is_box: shape.is_box != 0,
        }
    }

    /// Whether a convex of this size fits behind what is in use.
    pub(crate) fn has_room(&self, used: &PoolUse, convex: &Convex) -> bool {
        let fits = |used: u32, more: usize, room: usize| used as usize + more <= room;
        fits(used.lanes, convex.lanes.len(), self.lanes.len())
            && fits(used.faces, convex.faces.len(), self.faces.len())
            && fits(used.edges, convex.edges.len(), self.edges.len())
            && fits(used.loops, convex.loops.len(), self.loops.len())
    }

    /// Copies a convex that fits behind what is in use.
    pub(crate) fn append(&mut self, used: &PoolUse, convex: &Convex) -> Shape {
        put(self.lanes, used.lanes, convex.lanes);
        put(self.faces, used.faces, convex.faces);
        put(self.edges, used.edges, convex.edges);
        put(self.loops, used.loops, convex.loops);
        Shape {
            first_lane: used.lanes,
            lanes: convex.lanes.len() as u32,
            vertices: convex.vertex_count as u32,
            first_face: used.faces,
            faces: convex.faces.len() as u32,
            first_edge: used.edges,
            edges: convex.edges.len() as u32,
            first_loop: used.loops,
            loops: convex.loops.len() as u32,
            radius: convex.radius,
            reach: convex.core_reach() + convex.radius,
            centre: convex.centre,
            half_extents: convex.half_extents,
            is_box: u32::from(convex.is_box),
        }
    }

    /// Takes a shape out; everything behind it moves down.
    pub(crate) fn remove(&mut self, used: &PoolUse, shape: &Shape) {
        close_gap(self.lanes, shape.first_lane, shape.lanes, used.lanes);
        close_gap(self.faces, shape.first_face, shape.faces, used.faces);
        close_gap(self.edges, shape.first_edge, shape.edges, used.edges);
        close_gap(self.loops, shape.first_loop, shape.loops, used.loops);
    }
}

impl Shape {
    /// The farthest that the core is from the piece's own origin, in metres.
    pub(crate) fn core_reach(&self) -> f32 {
        self.reach - self.radius
    }

    /// Moves this shape's ranges down behind a shape that was taken out.
    pub(crate) fn move_down(&mut self, removed: &Self) {
        let down = |first: &mut u32, from: u32, by: u32| {
            if *first > from {
                *first -= by;
            }
        };
        down(&mut self.first_lane, removed.first_lane, removed.lanes);
        down(&mut self.first_face, removed.first_face, removed.faces);
        down(&mut self.first_edge, removed.first_edge, removed.edges);
        down(&mut self.first_loop, removed.first_loop, removed.loops);
    }
}

/// The pieces of a body, in the order they were added.
#[derive(Clone)]
pub(crate) struct PiecesOf<'a> {
    next: &'a [u32],
    current: u32,
}

impl<'a> PiecesOf<'a> {
    pub(crate) fn new(next: &'a [u32], first: u32) -> Self {
        Self {
            next,
            current: first,
        }
    }
}

impl Iterator for PiecesOf<'_> {
    type Item = usize;

    fn next(&mut self) -> Option<usize> {
        let index = self.current.checked_sub(1)? as usize;
        self.current = self.next[index];
        Some(index)
    }
}
