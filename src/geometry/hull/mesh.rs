//! The exact hull of points on a grid as a closed mesh of triangles.
//!
//! Quickhull (Barber, Dobkin and Huhdanpaa 1996) with two departures: predicates are exact
//! integers, so the visible region is always a disk and no facet needs mending, and the point taken
//! next is the farthest of all, so that points within the tolerance of the hull are left out.

use arrayvec::ArrayVec;

use super::grid::{self, Cell};
use crate::geometry::double::{self, Vec3d};
use crate::limits::{PIECE_FACES_MAX, PIECE_VERTICES_MAX};

/// No triangle, no group.
pub(super) const NONE: u16 = u16::MAX;

/// Owner of a point whose triangle has just been removed.
const ORPHAN: u16 = NONE - 1;

#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    /// Point indices, counter-clockwise from outside.
    pub corners: [u16; 3],
    /// `across[i]` is the triangle over the edge from corner i to the next.
    pub across: [u16; 3],
    /// Outward, as long as twice the area, exact.
    pub normal: Cell,
    /// One over the normal's length.
    inverse_length: f64,
    pub alive: bool,
    seen: bool,
}

impl Triangle {
    fn new(cells: &[Cell], corners: [u16; 3], across: [u16; 3]) -> Self {
        let [a, b, c] = corners.map(|i| cells[i as usize]);
        let normal = grid::cross(grid::sub(b, a), grid::sub(c, a));
        Self {
            corners,
            across,
            normal,
            inverse_length: 1.0 / double::length(grid::to_double(normal)),
            alive: true,
            seen: false,
        }
    }

    /// Six times the volume between the triangle and the point; positive outside.
    #[inline]
    pub fn side(&self, cells: &[Cell], point: Cell) -> i128 {
        grid::dot(
            self.normal,
            grid::sub(point, cells[self.corners[0] as usize]),
        )
    }

    /// Height of the point over the triangle's plane, in cells.
    fn height(&self, cells: &[Cell], point: Cell) -> f64 {
        self.side(cells, point) as f64 * self.inverse_length
    }

    /// Which edge starts at the given corner.
    pub fn edge_from(&self, corner: u16) -> usize {
        if self.corners[0] == corner {
            0
        } else if self.corners[1] == corner {
            1
        } else {
            2
        }
    }

    /// The corner that is not on the edge.
    pub fn opposite(&self, edge: usize) -> u16 {
        self.corners[(edge + 2) % 3]
    }

    pub fn area_vector(&self) -> Vec3d {
        grid::to_double(self.normal)
    }
}

/// An edge between what the new point sees and what it does not.
#[derive(Clone, Copy, Debug)]
struct Rim {
    tail: u16,
    head: u16,
    outside: u16,
}

#[derive(Clone, Debug)]
pub(super) struct Mesh {
    pub triangles: ArrayVec<Triangle, PIECE_FACES_MAX>,
    free: ArrayVec<u16, PIECE_FACES_MAX>,
    seen: ArrayVec<u16, PIECE_FACES_MAX>,
    made: ArrayVec<u16, PIECE_FACES_MAX>,
    horizon: ArrayVec<Rim, PIECE_VERTICES_MAX>,
    /// The new triangle whose rim edge starts at this point.
    spoke: [u16; PIECE_VERTICES_MAX],
    /// A triangle that the point is above, or `NONE`.
    owner: [u16; PIECE_VERTICES_MAX],
    /// How far above, in cells.
    height: [f64; PIECE_VERTICES_MAX],
    pub on_hull: [bool; PIECE_VERTICES_MAX],
}

impl Mesh {
    pub const fn new() -> Self {
        Self {
            triangles: ArrayVec::new_const(),
            free: ArrayVec::new_const(),
            seen: ArrayVec::new_const(),
            made: ArrayVec::new_const(),
            horizon: ArrayVec::new_const(),
            spoke: [NONE; PIECE_VERTICES_MAX],
            owner: [NONE; PIECE_VERTICES_MAX],
            height: [0.0; PIECE_VERTICES_MAX],
            on_hull: [false; PIECE_VERTICES_MAX],
        }
    }

    /// Makes the hull of the active points; those within `tolerance` cells of it may be left
    /// out. `false` when the points are thinner than `thickness_min` cells.
    pub fn build(
        &mut self,
        cells: &[Cell],
        active: &[bool; PIECE_VERTICES_MAX],
        tolerance: f64,
        thickness_min: f64,
    ) -> bool {
        let Some(simplex) = simplex(cells, active, thickness_min) else {
            return false;
        };
        self.start(cells, simplex);
        while self.sweep(cells, active, tolerance) {
            while let Some(point) = self.farthest(cells.len()) {
                self.insert(cells, point, tolerance);
            }
        }
        self.mark_corners();
        true
    }

    fn start(&mut self, cells: &[Cell], [a, b, c, d]: [u16; 4]) {
        self.triangles.clear();
        self.free.clear();
        self.owner = [NONE; PIECE_VERTICES_MAX];
        self.on_hull = [false; PIECE_VERTICES_MAX];
        for point in [a, b, c, d] {
            self.on_hull[point as usize] = true;
        }
        let across = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];
        let corners = [[a, b, c], [b, a, d], [c, b, d], [a, c, d]];
        for i in 0..4 {
            self.triangles
                .push(Triangle::new(cells, corners[i], across[i]));
        }
    }

    /// Finds an owner for every active point that is outside; whether there is one.
    fn sweep(
        &mut self,
        cells: &[Cell],
        active: &[bool; PIECE_VERTICES_MAX],
        tolerance: f64,
    ) -> bool {
        self.made.clear();
        let alive = (0..self.triangles.len()).filter(|&t| self.triangles[t].alive);
        self.made.extend(alive.map(|t| t as u16));
        for point in 0..cells.len() {
            if active[point] && !self.on_hull[point] {
                self.adopt(cells, point, tolerance);
            }
        }
        self.owner[..cells.len()].iter().any(|&owner| owner != NONE)
    }

    fn farthest(&self, count: usize) -> Option<u16> {
        let mut best = None;
        let mut height = 0.0;
        for point in 0..count {
            if self.owner[point] != NONE && self.height[point] > height {
                best = Some(point as u16);
                height = self.height[point];
            }
        }
        best
    }

    fn insert(&mut self, cells: &[Cell], point: u16, tolerance: f64) {
        self.look(cells, point);
        self.orphan(cells.len());
        self.owner[point as usize] = NONE;
        self.on_hull[point as usize] = true;
        self.cap(cells, point);
        for orphan in 0..cells.len() {
            if self.owner[orphan] == ORPHAN {
                self.adopt(cells, orphan, tolerance);
            }
        }
    }

    /// Collects the triangles that the point is strictly above, and the rim around them.
    fn look(&mut self, cells: &[Cell], point: u16) {
        self.seen.clear();
        self.horizon.clear();
        self.see(self.owner[point as usize]);
        let mut next = 0;
        while next < self.seen.len() {
            let triangle = self.triangles[self.seen[next] as usize];
            for edge in 0..3 {
                self.look_over(cells, point, &triangle, edge);
            }
            next += 1;
        }
    }

    fn see(&mut self, triangle: u16) {
        self.triangles[triangle as usize].seen = true;
        self.seen.push(triangle);
    }

    fn look_over(&mut self, cells: &[Cell], point: u16, from: &Triangle, edge: usize) {
        let outside = from.across[edge];
        let neighbour = &self.triangles[outside as usize];
        if neighbour.seen {
            return;
        }
        if neighbour.side(cells, cells[point as usize]) > 0 {
            self.see(outside);
            return;
        }
        self.horizon.push(Rim {
            tail: from.corners[edge],
            head: from.corners[(edge + 1) % 3],
            outside,
        });
    }

    /// Takes the points of the seen triangles away from them, and the triangles from the mesh.
    fn orphan(&mut self, count: usize) {
        for owner in &mut self.owner[..count] {
            if *owner != NONE && self.triangles[*owner as usize].seen {
                *owner = ORPHAN;
            }
        }
        for &triangle in &self.seen {
            self.triangles[triangle as usize].alive = false;
            self.free.push(triangle);
        }
    }

    /// Closes the mesh with a fan from the rim to the point.
    fn cap(&mut self, cells: &[Cell], point: u16) {
        self.made.clear();
        for i in 0..self.horizon.len() {
            self.add_to_fan(cells, point, self.horizon[i]);
        }
        for i in 0..self.made.len() {
            let this = self.made[i];
            let next = self.spoke[self.triangles[this as usize].corners[1] as usize];
            self.triangles[this as usize].across[1] = next;
            self.triangles[next as usize].across[2] = this;
        }
    }

    fn add_to_fan(&mut self, cells: &[Cell], point: u16, rim: Rim) {
        let corners = [rim.tail, rim.head, point];
        let triangle = Triangle::new(cells, corners, [rim.outside, NONE, NONE]);
        let index = self.place(triangle);
        let outside = &mut self.triangles[rim.outside as usize];
        outside.across[outside.edge_from(rim.head)] = index;
        self.spoke[rim.tail as usize] = index;
        self.made.push(index);
    }

    fn place(&mut self, triangle: Triangle) -> u16 {
        if let Some(index) = self.free.pop() {
            self.triangles[index as usize] = triangle;
            return index;
        }
        self.triangles.push(triangle);
        (self.triangles.len() - 1) as u16
    }

    /// Gives the point to the new triangle that it is farthest above, if any.
    fn adopt(&mut self, cells: &[Cell], point: usize, tolerance: f64) {
        self.owner[point] = NONE;
        self.height[point] = tolerance;
        for &index in &self.made {
            let height = self.triangles[index as usize].height(cells, cells[point]);
            if height > self.height[point] {
                self.owner[point] = index;
                self.height[point] = height;
            }
        }
    }

    fn mark_corners(&mut self) {
        self.on_hull = [false; PIECE_VERTICES_MAX];
        for triangle in self.triangles.iter().filter(|t| t.alive) {
            for corner in triangle.corners {
                self.on_hull[corner as usize] = true;
            }
        }
    }
}

/// Four corners of a large tetrahedron, the first three counter-clockwise seen from outside.
fn simplex(
    cells: &[Cell],
    active: &[bool; PIECE_VERTICES_MAX],
    thickness_min: f64,
) -> Option<[u16; 4]> {
    let squared = |v: Cell| double::dot(grid::to_double(v), grid::to_double(v));
    let best = |score: &dyn Fn(Cell) -> f64| farthest(cells, active, score);
    let (a, _) = best(&squared);
    let first = cells[a];
    let (b, length_squared) = best(&|p| squared(grid::sub(p, first)));
    let side = grid::sub(cells[b], first);
    let (c, area_squared) = best(&|p| squared(grid::cross(side, grid::sub(p, first))));
    let normal = grid::cross(side, grid::sub(cells[c], first));
    let volume = |p: Cell| grid::dot(normal, grid::sub(p, first));
    let (d, six_volume) = best(&|p| (volume(p) as f64).abs());
    let thinnest = thickness_min * thickness_min;
    let flat = area_squared <= thinnest * length_squared
        || six_volume * six_volume <= thinnest * area_squared;
    if flat {
        return None;
    }
    let (b, c) = if volume(cells[d]) > 0 { (c, b) } else { (b, c) };
    Some([a, b, c, d].map(|i| i as u16))
}

/// The active point with the largest score, ties to the lowest index.
fn farthest(
    cells: &[Cell],
    active: &[bool; PIECE_VERTICES_MAX],
    score: &dyn Fn(Cell) -> f64,
) -> (usize, f64) {
    let mut best = (0, -1.0);
    for (index, &cell) in cells.iter().enumerate() {
        let candidate = if active[index] { score(cell) } else { -1.0 };
        if candidate > best.1 {
            best = (index, candidate);
        }
    }
    best
}
