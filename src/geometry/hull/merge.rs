//! Triangles of a mesh gathered into flat faces.
//!
//! A group is grown from the largest triangle left, by one neighbour at a time. Its normal is
//! the sum of its triangles' area vectors, and it stays a group while all its corners lie within one
//! slab of the tolerance's thickness across that normal. The sum is the right normal: it is a mean of
//! normals whose planes all support the hull, so a vertex far outside the group cannot rise above the
//! group's plane by more than the slab, however small the group is. (A normal fitted to a small
//! group's corners would be off by the slab times the hull's size over the group's.)
//!
//! Triangles are taken in the order of a shelling, so that a group is always a disk.

use arrayvec::ArrayVec;

use super::grid::{self, Cell};
use super::mesh::{Mesh, NONE};
use crate::geometry::double::{self, Vec3d};
use crate::limits::{PIECE_FACES_MAX, PIECE_VERTICES_MAX};

#[derive(Clone, Debug)]
pub(super) struct Groups {
    /// The group of every triangle.
    pub of: [u16; PIECE_FACES_MAX],
    pub count: usize,
    /// How many edges between groups end at each point.
    pub degree: [u16; PIECE_VERTICES_MAX],
    seeds: ArrayVec<u16, PIECE_FACES_MAX>,
    members: ArrayVec<u16, PIECE_FACES_MAX>,
    corners: ArrayVec<u16, PIECE_VERTICES_MAX>,
    /// The last group that each point was a corner of.
    holder: [u16; PIECE_VERTICES_MAX],
    area: Vec3d,
}

impl Groups {
    pub const fn new() -> Self {
        Self {
            of: [NONE; PIECE_FACES_MAX],
            count: 0,
            degree: [0; PIECE_VERTICES_MAX],
            seeds: ArrayVec::new_const(),
            members: ArrayVec::new_const(),
            corners: ArrayVec::new_const(),
            holder: [NONE; PIECE_VERTICES_MAX],
            area: [0.0; 3],
        }
    }

    /// Puts every triangle into a group that is flat within `tolerance` cells.
    pub fn gather(&mut self, mesh: &Mesh, cells: &[Cell], tolerance: f64) {
        self.of = [NONE; PIECE_FACES_MAX];
        self.holder = [NONE; PIECE_VERTICES_MAX];
        self.count = 0;
        self.list_seeds(mesh);
        for i in 0..self.seeds.len() {
            if self.of[self.seeds[i] as usize] == NONE {
                self.grow(mesh, cells, self.seeds[i], tolerance);
            }
        }
        self.count_degrees(mesh);
    }

    /// All triangles, the largest first.
    fn list_seeds(&mut self, mesh: &Mesh) {
        self.seeds.clear();
        let alive = (0..mesh.triangles.len()).filter(|&t| mesh.triangles[t].alive);
        self.seeds.extend(alive.map(|t| t as u16));
        let area = |t: u16| {
            let normal = mesh.triangles[t as usize].normal;
            grid::dot(normal, normal)
        };
        self.seeds
            .sort_unstable_by(|&a, &b| area(b).cmp(&area(a)).then(a.cmp(&b)));
    }

    fn grow(&mut self, mesh: &Mesh, cells: &[Cell], seed: u16, tolerance: f64) {
        self.members.clear();
        self.corners.clear();
        self.area = [0.0; 3];
        self.count += 1;
        self.take(mesh, seed);
        loop {
            let before = self.members.len();
            self.pass(mesh, cells, tolerance);
            if self.members.len() == before {
                return;
            }
        }
    }

    fn group(&self) -> u16 {
        (self.count - 1) as u16
    }

    fn take(&mut self, mesh: &Mesh, triangle: u16) {
        let group = self.group();
        self.of[triangle as usize] = group;
        self.members.push(triangle);
        let triangle = &mesh.triangles[triangle as usize];
        self.area = double::add(self.area, triangle.area_vector());
        for corner in triangle.corners {
            if self.holder[corner as usize] != group {
                self.holder[corner as usize] = group;
                self.corners.push(corner);
            }
        }
    }

    fn pass(&mut self, mesh: &Mesh, cells: &[Cell], tolerance: f64) {
        let mut next = 0;
        while next < self.members.len() {
            for neighbour in mesh.triangles[self.members[next] as usize].across {
                let free = self.of[neighbour as usize] == NONE;
                if free
                    && self.stays_disk(mesh, neighbour)
                    && self.stays_flat(mesh, cells, neighbour, tolerance)
                {
                    self.take(mesh, neighbour);
                }
            }
            next += 1;
        }
    }

    /// Whether the group with the triangle is still a disk: they share two edges, or one edge
    /// and nothing else.
    fn stays_disk(&self, mesh: &Mesh, triangle: u16) -> bool {
        let triangle = &mesh.triangles[triangle as usize];
        let inside = |edge: &usize| self.of[triangle.across[*edge] as usize] == self.group();
        let mut shared = (0..3).filter(inside);
        match (shared.next(), shared.next()) {
            (Some(edge), None) => self.holder[triangle.opposite(edge) as usize] != self.group(),
            _ => true,
        }
    }

    fn stays_flat(&self, mesh: &Mesh, cells: &[Cell], triangle: u16, tolerance: f64) -> bool {
        let new = &mesh.triangles[triangle as usize];
        if tolerance == 0.0 {
            let seed = &mesh.triangles[self.members[0] as usize];
            return new
                .corners
                .iter()
                .all(|&c| seed.side(cells, cells[c as usize]) == 0);
        }
        let area = double::add(self.area, new.area_vector());
        if double::dot(new.area_vector(), area) <= 0.0 {
            return false;
        }
        let corners = self.corners.iter().chain(&new.corners);
        spread_within(corners, cells, double::unit(area), tolerance)
    }

    fn count_degrees(&mut self, mesh: &Mesh) {
        self.degree = [0; PIECE_VERTICES_MAX];
        for &t in &self.seeds {
            let triangle = &mesh.triangles[t as usize];
            for edge in 0..3 {
                if self.of[triangle.across[edge] as usize] != self.of[t as usize] {
                    self.degree[triangle.corners[edge] as usize] += 1;
                }
            }
        }
    }
}

/// Whether the points lie in a slab of the given thickness across the unit normal.
fn spread_within<'a>(
    points: impl DoubleEndedIterator<Item = &'a u16>,
    cells: &[Cell],
    normal: Vec3d,
    thickness: f64,
) -> bool {
    let mut low = f64::INFINITY;
    let mut high = f64::NEG_INFINITY;
    for &point in points.rev() {
        let height = double::dot(normal, grid::to_double(cells[point as usize]));
        low = if height < low { height } else { low };
        high = if height > high { height } else { high };
        if high - low > thickness {
            return false;
        }
    }
    true
}
