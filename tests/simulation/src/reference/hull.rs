//! The convex hull of points: triangles by insertion with exact predicates, then merged planes.
//!
//! Source: the beneath-and-beyond construction (Kallay 1981). A face is visible only when the new
//! point is strictly above it, decided exactly, so a horizon edge is never in line with the new
//! point and no degenerate triangle can arise.

use super::exact;
use glam::DVec3;
use std::collections::HashMap;

/// Hulls thinner than this times their length are taken as flat, and narrower ones as segments.
const FLAT_RELATIVE: f64 = 1e-14;
/// Triangles whose corners lie this times the length from a larger one's plane are merged into it.
const MERGE_RELATIVE: f64 = 1e-13;

/// A supporting plane: `normal . x <= offset` holds for every vertex, with equality on the face.
#[derive(Clone, Copy, Debug)]
pub struct Face {
    /// Outward, of length one.
    pub normal: DVec3,
    /// Distance of the plane from the origin along the normal, in metres.
    pub offset: f64,
}

/// An edge with the arc of normals that support it.
///
/// A flat hull has two edges per side, a segment has four in all: an arc never exceeds a half turn.
#[derive(Clone, Copy, Debug)]
pub struct Edge {
    /// The end points, in metres.
    pub ends: [DVec3; 2],
    /// Of length one, along `normals[0] x normals[1]`.
    pub direction: DVec3,
    /// The ends of the arc, outward and of length one.
    pub normals: [DVec3; 2],
}

/// The boundary of a convex hull.
#[derive(Clone, Debug, Default)]
pub(super) struct Boundary {
    pub vertices: Vec<DVec3>,
    pub triangles: Vec<[usize; 3]>,
    pub faces: Vec<Face>,
    pub edges: Vec<Edge>,
}

/// The boundary of the hull of `points`, which are finite and at least one.
pub(super) fn boundary(points: &[DVec3]) -> Boundary {
    let points = distinct(points);
    let first = points[0];
    let second = farthest(&points, |p| (p - first).length());
    let length = (second - first).length();
    if length == 0.0 {
        return Boundary {
            vertices: vec![first],
            ..Boundary::default()
        };
    }
    let along = (second - first) / length;
    let third = farthest(&points, |p| along.cross(p - first).length());
    let across = along.cross(third - first);
    if across.length() <= FLAT_RELATIVE * length {
        return segment(&points, along);
    }
    let normal = exact::cross(first, second, third).normalize();
    let fourth = farthest(&points, |p| normal.dot(p - first).abs());
    if normal.dot(fourth - first).abs() <= FLAT_RELATIVE * length {
        return polygon(&points, first, along, normal);
    }
    polytope(&points, [first, second, third, fourth], length)
}

fn distinct(points: &[DVec3]) -> Vec<DVec3> {
    let mut sorted: Vec<DVec3> = points.iter().map(|&p| p + DVec3::ZERO).collect();
    sorted.sort_by(compare);
    sorted.dedup();
    sorted
}

fn compare(a: &DVec3, b: &DVec3) -> std::cmp::Ordering {
    a.x.total_cmp(&b.x)
        .then(a.y.total_cmp(&b.y))
        .then(a.z.total_cmp(&b.z))
}

fn farthest(points: &[DVec3], measure: impl Fn(DVec3) -> f64) -> DVec3 {
    points
        .iter()
        .copied()
        .max_by(|&a, &b| measure(a).total_cmp(&measure(b)))
        .unwrap_or_default()
}

fn segment(points: &[DVec3], along: DVec3) -> Boundary {
    let ends = [
        farthest(points, |p| -along.dot(p)),
        farthest(points, |p| along.dot(p)),
    ];
    let direction = (ends[1] - ends[0]).normalize();
    let p = direction.any_orthonormal_vector();
    let q = direction.cross(p).normalize();
    let edges = [[p, q], [q, -p], [-p, -q], [-q, p]].map(|normals| Edge {
        ends,
        direction,
        normals,
    });
    Boundary {
        vertices: ends.to_vec(),
        edges: edges.to_vec(),
        ..Boundary::default()
    }
}

fn polygon(points: &[DVec3], origin: DVec3, along: DVec3, normal: DVec3) -> Boundary {
    let across = normal.cross(along).normalize();
    let mut flat: Vec<[f64; 2]> = points
        .iter()
        .map(|&p| [along.dot(p - origin), across.dot(p - origin)])
        .collect();
    let order = chain(&mut flat);
    let vertices: Vec<DVec3> = order.into_iter().map(|i| points[i]).collect();
    let count = vertices.len();
    let edges = (0..count)
        .flat_map(|i| polygon_edges([vertices[i], vertices[(i + 1) % count]], normal))
        .collect();
    let triangles = (1..count - 1).map(|i| [0, i, i + 1]).collect();
    let faces = vec![face(normal, &vertices), face(-normal, &vertices)];
    Boundary {
        vertices,
        triangles,
        faces,
        edges,
    }
}

/// Counter-clockwise hull indices in the plane. Source: Andrew 1979, monotone chain.
fn chain(flat: &mut [[f64; 2]]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..flat.len()).collect();
    order.sort_by(|&i, &j| {
        flat[i][0]
            .total_cmp(&flat[j][0])
            .then(flat[i][1].total_cmp(&flat[j][1]))
    });
    let mut lower = half_chain(flat, order.iter().copied());
    let mut upper = half_chain(flat, order.iter().rev().copied());
    lower.pop();
    upper.pop();
    lower.extend(upper);
    lower
}

fn half_chain(flat: &[[f64; 2]], order: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut chain: Vec<usize> = Vec::new();
    for i in order {
        while chain.len() >= 2
            && turn(flat, chain[chain.len() - 2], chain[chain.len() - 1], i) <= 0.0
        {
            chain.pop();
        }
        chain.push(i);
    }
    chain
}

fn turn(flat: &[[f64; 2]], a: usize, b: usize, c: usize) -> f64 {
    let [a, b, c] = [flat[a], flat[b], flat[c]];
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn polygon_edges(ends: [DVec3; 2], normal: DVec3) -> [Edge; 2] {
    let direction = (ends[1] - ends[0]).normalize();
    let outward = direction.cross(normal).normalize();
    [[normal, outward], [outward, -normal]].map(|normals| Edge {
        ends,
        direction,
        normals,
    })
}

fn face(normal: DVec3, vertices: &[DVec3]) -> Face {
    let offset = vertices
        .iter()
        .map(|&v| normal.dot(v))
        .fold(f64::NEG_INFINITY, f64::max);
    Face { normal, offset }
}

type Triangle = [usize; 3];

struct Builder<'a> {
    points: &'a [DVec3],
    triangles: Vec<Triangle>,
    alive: Vec<bool>,
    owner: HashMap<(usize, usize), usize>,
}

impl Builder<'_> {
    fn add(&mut self, triangle: Triangle) {
        for edge in sides(triangle) {
            self.owner.insert(edge, self.triangles.len());
        }
        self.triangles.push(triangle);
        self.alive.push(true);
    }

    fn sees(&self, point: usize, triangle: Triangle) -> bool {
        let [a, b, c] = triangle.map(|i| self.points[i]);
        exact::side(a, b, c, self.points[point]) > 0.0
    }

    fn insert(&mut self, point: usize) {
        let visible: Vec<usize> = (0..self.triangles.len())
            .filter(|&t| self.alive[t] && self.sees(point, self.triangles[t]))
            .collect();
        for &t in &visible {
            self.alive[t] = false;
        }
        for (i, j) in self.horizon(&visible) {
            self.add([i, j, point]);
        }
    }

    fn horizon(&self, visible: &[usize]) -> Vec<(usize, usize)> {
        visible
            .iter()
            .flat_map(|&t| sides(self.triangles[t]))
            .filter(|&(i, j)| self.alive[self.owner[&(j, i)]])
            .collect()
    }
}

fn sides([a, b, c]: Triangle) -> [(usize, usize); 3] {
    [(a, b), (b, c), (c, a)]
}

fn polytope(points: &[DVec3], seeds: [DVec3; 4], length: f64) -> Boundary {
    let triangles = triangulate(points, seeds);
    let (vertices, triangles) = compact(points, &triangles);
    merge(vertices, triangles, MERGE_RELATIVE * length)
}

fn triangulate(points: &[DVec3], seeds: [DVec3; 4]) -> Vec<Triangle> {
    let index = |p: DVec3| points.iter().position(|&q| q == p).unwrap_or(0);
    let [a, mut b, mut c, d] = seeds.map(index);
    if exact::side(points[a], points[b], points[c], points[d]) > 0.0 {
        std::mem::swap(&mut b, &mut c);
    }
    let mut builder = Builder {
        points,
        triangles: Vec::new(),
        alive: Vec::new(),
        owner: HashMap::new(),
    };
    for triangle in [[a, b, c], [a, c, d], [c, b, d], [b, a, d]] {
        builder.add(triangle);
    }
    for point in (0..points.len()).filter(|i| ![a, b, c, d].contains(i)) {
        builder.insert(point);
    }
    let alive = builder.alive;
    builder
        .triangles
        .into_iter()
        .zip(alive)
        .filter_map(|(t, alive)| alive.then_some(t))
        .collect()
}

fn compact(points: &[DVec3], triangles: &[Triangle]) -> (Vec<DVec3>, Vec<Triangle>) {
    let mut place = vec![usize::MAX; points.len()];
    let mut vertices = Vec::new();
    for &i in triangles.iter().flatten() {
        if place[i] == usize::MAX {
            place[i] = vertices.len();
            vertices.push(points[i]);
        }
    }
    (
        vertices,
        triangles.iter().map(|t| t.map(|i| place[i])).collect(),
    )
}

fn merge(vertices: Vec<DVec3>, triangles: Vec<Triangle>, tolerance: f64) -> Boundary {
    let planes = Planes::group(&vertices, &triangles, tolerance);
    let faces = planes
        .normals
        .iter()
        .map(|&normal| face(normal, &vertices))
        .collect();
    let edges = planes.edges();
    Boundary {
        vertices,
        triangles,
        faces,
        edges,
    }
}

/// Triangles grouped by the planes they share with larger neighbours.
struct Planes<'a> {
    vertices: &'a [DVec3],
    triangles: &'a [Triangle],
    owner: HashMap<(usize, usize), usize>,
    tolerance: f64,
    areas: Vec<DVec3>,
    group: Vec<Option<usize>>,
    normals: Vec<DVec3>,
}

impl<'a> Planes<'a> {
    fn group(vertices: &'a [DVec3], triangles: &'a [Triangle], tolerance: f64) -> Self {
        let owners = triangles.iter().enumerate();
        let owner = owners.flat_map(|(t, &triangle)| sides(triangle).map(|side| (side, t)));
        let corners = triangles.iter().map(|t| t.map(|i| vertices[i]));
        let mut planes = Self {
            vertices,
            triangles,
            owner: owner.collect(),
            tolerance,
            areas: corners.map(|[a, b, c]| exact::cross(a, b, c)).collect(),
            group: vec![None; triangles.len()],
            normals: Vec::new(),
        };
        for seed in planes.largest_first() {
            planes.grow(seed);
        }
        planes
    }

    fn largest_first(&self) -> Vec<usize> {
        let size = |t: usize| self.areas[t].length_squared();
        let mut order: Vec<usize> = (0..self.triangles.len()).collect();
        order.sort_by(|&i, &j| size(j).total_cmp(&size(i)).then(i.cmp(&j)));
        order
    }

    fn grow(&mut self, seed: usize) {
        if self.group[seed].is_some() {
            return;
        }
        let normal = unit(self.areas[seed]);
        let group = Some(self.normals.len());
        self.normals.push(normal);
        self.group[seed] = group;
        let mut open = vec![seed];
        while let Some(t) = open.pop() {
            for next in self.neighbours(t) {
                if self.group[next].is_none() && self.in_plane(next, normal, seed) {
                    self.group[next] = group;
                    open.push(next);
                }
            }
        }
    }

    fn neighbours(&self, triangle: usize) -> [usize; 3] {
        sides(self.triangles[triangle]).map(|(i, j)| self.owner[&(j, i)])
    }

    fn in_plane(&self, triangle: usize, normal: DVec3, seed: usize) -> bool {
        let origin = self.vertices[self.triangles[seed][0]];
        let height = |i: &usize| normal.dot(self.vertices[*i] - origin).abs();
        let mut corners = self.triangles[triangle].iter();
        normal.dot(self.areas[triangle]) >= 0.0 && corners.all(|i| height(i) <= self.tolerance)
    }

    fn edges(&self) -> Vec<Edge> {
        let owned = self.owner.iter().filter(|&(&(i, j), _)| i < j);
        let mut sides: Vec<_> = owned.map(|(&side, &t)| (side, t)).collect();
        sides.sort_unstable();
        sides
            .into_iter()
            .filter_map(|(side, t)| self.edge(side, t))
            .collect()
    }

    fn edge(&self, (i, j): (usize, usize), triangle: usize) -> Option<Edge> {
        let groups = [self.group[triangle]?, self.group[self.owner[&(j, i)]]?];
        let ends = [self.vertices[i], self.vertices[j]];
        let direction = (ends[1] - ends[0]).normalize();
        let normals = groups.map(|g| self.normals[g]);
        (groups[0] != groups[1]).then_some(Edge {
            ends,
            direction,
            normals,
        })
    }
}

fn unit(v: DVec3) -> DVec3 {
    let largest = v.abs().max_element();
    (v / largest).normalize()
}
