//! The finished hull: vertices in lanes, faces, edges, loops.

use arrayvec::ArrayVec;
use bytemuck::Zeroable;
use glam::Vec3;

use super::HullView;
use super::merge::Groups;
use super::mesh::{Mesh, NONE};
use crate::geometry::convex::{Edge, Face, Lane};
use crate::geometry::double::{self, Vec3d};
use crate::limits::{
    PIECE_EDGES_MAX, PIECE_FACES_MAX, PIECE_LANES_MAX, PIECE_LOOPS_MAX, PIECE_VERTICES_MAX,
};
use crate::math::LANE_WIDTH;

/// A triangle and one of its edges.
type HalfEdge = (u16, u8);

#[derive(Clone, Debug)]
pub(super) struct Output {
    lanes: ArrayVec<Lane, PIECE_LANES_MAX>,
    vertex_count: usize,
    faces: ArrayVec<Face, PIECE_FACES_MAX>,
    edges: ArrayVec<Edge, PIECE_EDGES_MAX>,
    loops: ArrayVec<u16, PIECE_LOOPS_MAX>,
    centre: Vec3,
    half_extents: Vec3,
    is_box: bool,
    /// The vertex made of each point, or `NONE`.
    vertex_of: [u16; PIECE_VERTICES_MAX],
    starts: ArrayVec<HalfEdge, PIECE_FACES_MAX>,
    /// The last face whose walk met this one.
    met_by: [u16; PIECE_FACES_MAX],
}

impl Output {
    pub const fn new() -> Self {
        Self {
            lanes: ArrayVec::new_const(),
            vertex_count: 0,
            faces: ArrayVec::new_const(),
            edges: ArrayVec::new_const(),
            loops: ArrayVec::new_const(),
            centre: Vec3::ZERO,
            half_extents: Vec3::ZERO,
            is_box: false,
            vertex_of: [NONE; PIECE_VERTICES_MAX],
            starts: ArrayVec::new_const(),
            met_by: [NONE; PIECE_FACES_MAX],
        }
    }

    pub fn view(&self) -> HullView<'_> {
        HullView {
            lanes: &self.lanes,
            vertex_count: self.vertex_count,
            faces: &self.faces,
            edges: &self.edges,
            loops: &self.loops,
            centre: self.centre,
            half_extents: self.half_extents,
            is_box: self.is_box,
        }
    }

    /// The given points as vertices, without faces and edges.
    pub fn set_vertices(&mut self, points: impl Iterator<Item = [f32; 3]>) {
        self.lanes.clear();
        self.vertex_count = 0;
        self.faces.clear();
        self.edges.clear();
        self.loops.clear();
        for point in points {
            self.push_vertex(point);
        }
        self.pad();
        self.set_box();
    }

    fn push_vertex(&mut self, p: [f32; 3]) {
        let column = self.vertex_count % LANE_WIDTH;
        if column == 0 {
            self.lanes.push(Lane::zeroed());
        }
        put(&mut self.lanes[self.vertex_count / LANE_WIDTH], column, p);
        self.vertex_count += 1;
    }

    fn pad(&mut self) {
        let first = self.vertex(0).to_array();
        for index in self.vertex_count..self.lanes.len() * LANE_WIDTH {
            put(
                &mut self.lanes[index / LANE_WIDTH],
                index % LANE_WIDTH,
                first,
            );
        }
    }

    /// The bounding box; rounded outward so that it holds every vertex.
    fn set_box(&mut self) {
        let mut low = self.vertex(0);
        let mut high = low;
        for index in 0..self.vertex_count {
            low = low.min(self.vertex(index));
            high = high.max(self.vertex(index));
        }
        let (low, high) = (double::from_vec3(low), double::from_vec3(high));
        self.centre = double::to_vec3(double::scale(double::add(low, high), 0.5));
        let centre = double::from_vec3(self.centre);
        let up = double::sub(high, centre);
        let down = double::sub(centre, low);
        let half = |axis: usize| {
            round_up(if up[axis] > down[axis] {
                up[axis]
            } else {
                down[axis]
            })
        };
        self.half_extents = Vec3::new(half(0), half(1), half(2));
        self.is_box = self.vertex_count == 8 && (0..8).all(|index| self.is_corner(index));
    }

    /// Whether a vertex is a corner of the bounding box. Eight different vertices that are make it up.
    fn is_corner(&self, index: usize) -> bool {
        let centre = double::from_vec3(self.centre);
        let half = double::from_vec3(self.half_extents);
        let arm = double::sub(double::from_vec3(self.vertex(index)), centre);
        (0..3).all(|axis| arm[axis].abs() == half[axis])
    }

    fn vertex(&self, index: usize) -> Vec3 {
        self.view().convex(0.0).vertex(index)
    }

    fn point(&self, index: u16) -> Vec3d {
        double::from_vec3(self.vertex(index as usize))
    }

    fn corners(&self, face: &Face) -> &[u16] {
        let first = face.first_loop as usize;
        &self.loops[first..first + face.loop_count as usize]
    }

    pub fn push_edge(&mut self, vertices: [u16; 2], faces: [u16; 2]) {
        self.edges.push(Edge { vertices, faces });
    }

    /// A face with the given loop of vertices.
    pub fn push_face(&mut self, corners: impl Iterator<Item = u16>) {
        let first = self.loops.len();
        self.loops.extend(corners);
        self.finish_face(first);
    }

    /// Makes a face of the loop entries from `first` on.
    fn finish_face(&mut self, first: usize) {
        let normal = double::to_vec3(double::unit(self.area_vector(&self.loops[first..])));
        self.faces.push(Face {
            normal,
            offset: round_up(self.reach(double::from_vec3(normal))),
            first_loop: first as u16,
            loop_count: (self.loops.len() - first) as u16,
        });
    }

    /// Newell's normal, relative to the loop's first vertex.
    fn area_vector(&self, corners: &[u16]) -> Vec3d {
        let origin = self.point(corners[0]);
        let mut sum = [0.0; 3];
        for pair in corners[1..].windows(2) {
            let a = double::sub(self.point(pair[0]), origin);
            let b = double::sub(self.point(pair[1]), origin);
            sum = double::add(sum, double::cross(a, b));
        }
        sum
    }

    /// How far the vertices reach along a normal.
    fn reach(&self, normal: Vec3d) -> f64 {
        let mut reach = f64::NEG_INFINITY;
        for index in 0..self.vertex_count {
            let along = double::dot(normal, self.point(index as u16));
            reach = if along > reach { along } else { reach };
        }
        reach
    }

    /// Takes the hull over from the mesh and its groups, every one of whose corners must be
    /// between three groups or more. Whether the result is a convex polytope.
    pub fn collect(&mut self, mesh: &Mesh, groups: &Groups, points: &[[f32; 3]]) -> bool {
        self.name_vertices(mesh);
        self.set_vertices(
            (0..points.len())
                .filter(|&i| mesh.on_hull[i])
                .map(|i| points[i]),
        );
        self.find_starts(mesh, groups);
        self.met_by = [NONE; PIECE_FACES_MAX];
        let mut simple = true;
        for face in 0..groups.count {
            simple &= self.walk(mesh, groups, face);
        }
        simple && self.satisfies_euler() && self.loops_are_convex()
    }

    fn name_vertices(&mut self, mesh: &Mesh) {
        let mut count = 0;
        for point in 0..PIECE_VERTICES_MAX {
            self.vertex_of[point] = if mesh.on_hull[point] { count } else { NONE };
            count += u16::from(mesh.on_hull[point]);
        }
    }

    /// Where to start around each group: at its lowest vertex.
    fn find_starts(&mut self, mesh: &Mesh, groups: &Groups) {
        self.starts.clear();
        self.starts.extend((0..groups.count).map(|_| (NONE, 0)));
        for (index, triangle) in mesh.triangles.iter().enumerate() {
            for edge in 0..3 {
                let group = groups.of[index];
                if triangle.alive && groups.of[triangle.across[edge] as usize] != group {
                    self.offer_start(mesh, group as usize, (index as u16, edge as u8));
                }
            }
        }
    }

    fn offer_start(&mut self, mesh: &Mesh, group: usize, candidate: HalfEdge) {
        let best = self.starts[group];
        if best.0 == NONE || tail(mesh, candidate) < tail(mesh, best) {
            self.starts[group] = candidate;
        }
    }

    /// Writes the loop of one face and its edges to later faces; whether the face is a polygon
    /// that meets no other face twice.
    fn walk(&mut self, mesh: &Mesh, groups: &Groups, face: usize) -> bool {
        let first = self.loops.len();
        let start = self.starts[face];
        let mut at = start;
        let mut simple = true;
        loop {
            let next = next_around(mesh, groups, at);
            simple &= self.step(mesh, groups, at, next);
            at = next;
            if at == start || self.loops.len() == PIECE_LOOPS_MAX {
                break;
            }
        }
        self.finish_face(first);
        simple && self.loops.len() >= first + 3
    }

    fn step(&mut self, mesh: &Mesh, groups: &Groups, at: HalfEdge, next: HalfEdge) -> bool {
        let ends = [at, next].map(|half| self.vertex_of[tail(mesh, half) as usize]);
        let face = groups.of[at.0 as usize];
        let other = groups.of[mesh.triangles[at.0 as usize].across[at.1 as usize] as usize];
        self.loops.push(ends[0]);
        if face < other {
            self.push_edge(ends, [face, other]);
        }
        let met = self.met_by[other as usize] == face;
        self.met_by[other as usize] = face;
        !met
    }

    fn satisfies_euler(&self) -> bool {
        let solid = self.vertex_count >= 4 && self.faces.len() >= 4;
        solid && self.vertex_count + self.faces.len() == self.edges.len() + 2
    }

    fn loops_are_convex(&self) -> bool {
        self.faces.iter().all(|face| {
            let corners = self.corners(face);
            let normal = double::from_vec3(face.normal);
            let before = corners.iter().cycle().skip(corners.len() - 1);
            let after = corners.iter().cycle().skip(1);
            let mut turns = before.zip(corners).zip(after);
            turns.all(|((&a, &b), &c)| {
                let [a, b, c] = [a, b, c].map(|i| self.point(i));
                let turn = double::cross(double::sub(b, a), double::sub(c, b));
                double::dot(turn, normal) > 0.0
            })
        })
    }

    /// Whether every corner is within `distance` of its faces' planes, which all vertices are below: the
    /// normal of a face as thin as rounding may point anywhere across it.
    pub fn touches_planes(&self, distance: f64) -> bool {
        self.faces.iter().all(|face| {
            let normal = double::from_vec3(face.normal);
            let least = self.reach(normal) - distance;
            let mut corners = self.corners(face).iter();
            corners.all(|&corner| double::dot(normal, self.point(corner)) >= least)
        })
    }

    /// Whether no point is farther than `distance` from the hull.
    pub fn holds(&self, points: &[[f32; 3]], distance: f64) -> bool {
        let mut left_out = (0..points.len()).filter(|&i| self.vertex_of[i] == NONE);
        left_out.all(|i| self.distance_within(double::from_array(points[i]), distance))
    }

    /// Whether the point is inside or within `distance` of a face, above or below its plane: beside a
    /// sharp edge rounding decides which of its faces a point is above.
    fn distance_within(&self, point: Vec3d, distance: f64) -> bool {
        let mut inside = true;
        for face in &self.faces {
            let origin = self.point(self.corners(face)[0]);
            let height = double::dot(double::from_vec3(face.normal), double::sub(point, origin));
            inside &= height <= 0.0;
            let near = height <= distance && height >= -distance;
            if near && self.face_distance(face, point, height) <= distance {
                return true;
            }
        }
        inside
    }

    /// Distance of a point at the given height over a face's plane from the face.
    fn face_distance(&self, face: &Face, point: Vec3d, height: f64) -> f64 {
        let corners = self.corners(face);
        let normal = double::from_vec3(face.normal);
        let mut nearest = f64::INFINITY;
        for (i, &corner) in corners.iter().enumerate() {
            let a = self.point(corner);
            let along = double::sub(self.point(corners[(i + 1) % corners.len()]), a);
            let to_point = double::sub(point, a);
            if double::dot(double::cross(along, to_point), normal) < 0.0 {
                let distance = segment_distance(along, to_point);
                nearest = if distance < nearest {
                    distance
                } else {
                    nearest
                };
            }
        }
        if nearest < f64::INFINITY {
            nearest
        } else {
            height
        }
    }
}

/// Distance of a point from the segment from the origin to `end`.
fn segment_distance(end: Vec3d, point: Vec3d) -> f64 {
    let t = double::dot(end, point) / double::dot(end, end);
    let t = if t < 0.0 { 0.0 } else { t };
    let t = if t > 1.0 { 1.0 } else { t };
    double::length(double::sub(point, double::scale(end, t)))
}

fn put(lane: &mut Lane, column: usize, p: [f32; 3]) {
    lane.x[column] = p[0];
    lane.y[column] = p[1];
    lane.z[column] = p[2];
}

/// The nearest f32 that is not below `x`.
fn round_up(x: f64) -> f32 {
    let near = (x + 0.0) as f32;
    if f64::from(near) < x {
        near.next_up()
    } else {
        near
    }
}

fn tail(mesh: &Mesh, (triangle, edge): HalfEdge) -> u16 {
    mesh.triangles[triangle as usize].corners[edge as usize]
}

/// The edge of the same group's rim that starts where this one ends.
fn next_around(mesh: &Mesh, groups: &Groups, (triangle, edge): HalfEdge) -> HalfEdge {
    let group = groups.of[triangle as usize];
    let head = mesh.triangles[triangle as usize].corners[(edge as usize + 1) % 3];
    let mut at = triangle;
    loop {
        let here = &mesh.triangles[at as usize];
        let edge = here.edge_from(head);
        let over = here.across[edge];
        if groups.of[over as usize] != group {
            return (at, edge as u8);
        }
        at = over;
    }
}
