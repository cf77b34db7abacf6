//! Convex hulls of at most so many vertices that still contain every point.

use std::collections::BTreeSet;

use glam::{DMat3, DVec3};
use parry3d_f64::math::Vector;
use parry3d_f64::transformation::try_convex_hull;

use super::HandError;

/// How far a point may lie outside a hull that is said to contain it, in metres: rounding, a tenth of a micrometre.
const CONTAINS_SLOP_M: f64 = 1e-7;

/// Faces below this area, in square metres, have no dependable normal; their neighbours bound the hull.
const FACE_AREA_M2_MIN: f64 = 1e-13;

/// Volume over the cube of the diagonal below which a hull is a plane figure.
const FLATNESS: f64 = 1e-6;

/// A half-space `normal . x <= offset` that bounds a hull, and the area of its face.
#[derive(Clone, Copy, Debug)]
struct Plane {
    normal: DVec3,
    offset_m: f64,
    area_m2: f64,
}

impl Plane {
    fn through([a, b, c]: [DVec3; 3]) -> Option<Self> {
        let cross = (b - a).cross(c - a);
        let area_m2 = 0.5 * cross.length();
        (area_m2 > FACE_AREA_M2_MIN).then(|| {
            let normal = cross.normalize();
            let offset_m = normal.dot(a + b + c) / 3.0;
            Self {
                normal,
                offset_m,
                area_m2,
            }
        })
    }

    fn excess_m(&self, point: DVec3) -> f64 {
        self.normal.dot(point) - self.offset_m
    }
}

/// A closed convex surface.
#[derive(Clone, Debug)]
pub(super) struct Hull {
    pub(super) vertices: Vec<DVec3>,
    /// Counter-clockwise seen from outside.
    pub(super) faces: Vec<[usize; 3]>,
    planes: Vec<Plane>,
}

impl Hull {
    /// The exact hull of the points; an error if they are fewer than four or lie in a plane.
    pub(super) fn new(points: &[DVec3]) -> Result<Self, HandError> {
        let input: Vec<Vector> = points
            .iter()
            .map(|point| Vector::from_array(point.to_array()))
            .collect();
        let (vertices, faces) =
            try_convex_hull(&input).map_err(|error| HandError::Hull(format!("{error:?}")))?;
        let vertices: Vec<DVec3> = vertices
            .iter()
            .map(|vertex| DVec3::from_array(vertex.to_array()))
            .collect();
        let faces: Vec<[usize; 3]> = faces
            .iter()
            .map(|face| face.map(|vertex| vertex as usize))
            .collect();
        let planes: Vec<Plane> = faces
            .iter()
            .filter_map(|face| Plane::through(face.map(|vertex| vertices[vertex])))
            .collect();
        let hull = Self {
            vertices,
            faces,
            planes,
        };
        if hull.is_flat() {
            Err(HandError::Hull("points in a plane".to_owned()))
        } else if hull.contains_all(points) {
            Ok(hull)
        } else {
            Err(HandError::Hull("points outside their hull".to_owned()))
        }
    }

    /// The largest distance by which the point passes a face plane, in metres; negative inside.
    pub(super) fn excess_m(&self, point: DVec3) -> f64 {
        self.planes
            .iter()
            .map(|plane| plane.excess_m(point))
            .fold(f64::NEG_INFINITY, f64::max)
    }

    fn is_flat(&self) -> bool {
        let low = self
            .vertices
            .iter()
            .copied()
            .fold(DVec3::INFINITY, DVec3::min);
        let high = self
            .vertices
            .iter()
            .copied()
            .fold(DVec3::NEG_INFINITY, DVec3::max);
        self.volume_m3() <= FLATNESS * low.distance(high).powi(3)
    }

    fn volume_m3(&self) -> f64 {
        let volume = |face: &[usize; 3]| {
            let [a, b, c] = face.map(|vertex| self.vertices[vertex]);
            a.dot(b.cross(c)) / 6.0
        };
        self.faces.iter().map(volume).sum()
    }

    fn contains_all(&self, points: &[DVec3]) -> bool {
        points
            .iter()
            .all(|&point| self.excess_m(point) <= CONTAINS_SLOP_M)
    }

    fn edges(&self) -> BTreeSet<[usize; 2]> {
        self.faces
            .iter()
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
            .map(|[a, b]| [a.min(b), a.max(b)])
            .collect()
    }

    fn planes_around(&self, edge: [usize; 2]) -> Vec<Plane> {
        self.faces
            .iter()
            .filter(|face| face.iter().any(|vertex| edge.contains(vertex)))
            .filter_map(|face| Plane::through(face.map(|vertex| self.vertices[vertex])))
            .collect()
    }

    fn collapsed(&self, collapse: &Collapse) -> Result<Self, HandError> {
        let kept = (0..self.vertices.len()).filter(|vertex| !collapse.edge.contains(vertex));
        let points: Vec<DVec3> = kept
            .map(|vertex| self.vertices[vertex])
            .chain([collapse.vertex])
            .collect();
        Self::new(&points)
    }
}

/// An edge and the vertex that would replace both its ends.
#[derive(Clone, Copy, Debug)]
struct Collapse {
    edge: [usize; 2],
    vertex: DVec3,
    added_m3: f64,
}

/// A hull of at most `vertices_max` vertices that contains all points: the exact hull if that is small enough,
/// otherwise one grown outward by edge collapses, the one that adds the least volume first.
///
/// Progressive hulls, Sander et al. 2000, "Silhouette clipping". Unlike there the hull is rebuilt after each collapse,
/// so it stays convex.
pub(super) fn enclose(points: &[DVec3], vertices_max: usize) -> Result<Hull, HandError> {
    let mut hull = Hull::new(&distinct(points))?;
    while hull.vertices.len() > vertices_max {
        hull = with_a_vertex_less(&hull, points)?;
    }
    Ok(hull)
}

fn with_a_vertex_less(hull: &Hull, points: &[DVec3]) -> Result<Hull, HandError> {
    let mut collapses: Vec<Collapse> = hull
        .edges()
        .into_iter()
        .filter_map(|edge| cheapest_collapse(hull, edge))
        .collect();
    collapses.sort_by(|a, b| a.added_m3.total_cmp(&b.added_m3));
    collapses
        .iter()
        .filter_map(|collapse| hull.collapsed(collapse).ok())
        .find(|next| next.vertices.len() < hull.vertices.len() && next.contains_all(points))
        .ok_or_else(|| HandError::Hull("no edge can be collapsed".to_owned()))
}

/// The vertex outside all planes around the edge that adds the least volume.
///
/// The added volume is a sum of tetrahedra over those faces, linear in the vertex, so the optimum of this small linear
/// program lies where three planes meet; all triples are tried.
fn cheapest_collapse(hull: &Hull, edge: [usize; 2]) -> Option<Collapse> {
    let planes = hull.planes_around(edge);
    let mut best: Option<Collapse> = None;
    for triple in triples(planes.len()) {
        let Some(vertex) = meeting_point(triple.map(|plane| planes[plane])) else {
            continue;
        };
        let added_m3 = planes
            .iter()
            .map(|plane| plane.area_m2 * plane.excess_m(vertex))
            .sum::<f64>()
            / 3.0;
        let better = best.is_none_or(|best| added_m3 < best.added_m3);
        if better && planes.iter().all(|plane| plane.excess_m(vertex) >= -1e-10) {
            best = Some(Collapse {
                edge,
                vertex,
                added_m3,
            });
        }
    }
    best
}

fn triples(count: usize) -> impl Iterator<Item = [usize; 3]> {
    (0..count)
        .flat_map(move |a| (a + 1..count).flat_map(move |b| (b + 1..count).map(move |c| [a, b, c])))
}

fn meeting_point(planes: [Plane; 3]) -> Option<DVec3> {
    let [a, b, c] = planes.map(|plane| plane.normal);
    let rows = DMat3::from_cols(a, b, c).transpose();
    let offsets = DVec3::from_array(planes.map(|plane| plane.offset_m));
    (rows.determinant().abs() > 1e-6).then(|| rows.inverse() * offsets)
}

fn distinct(points: &[DVec3]) -> Vec<DVec3> {
    let mut seen = BTreeSet::new();
    let fresh = |point: &&DVec3| seen.insert(point.to_array().map(f64::to_bits));
    points.iter().filter(fresh).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ball(count: usize) -> Vec<DVec3> {
        let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
        let point = |index: usize| {
            let height = 1.0 - (2 * index + 1) as f64 / count as f64;
            let (sin, cos) = (golden * index as f64).sin_cos();
            0.01 * DVec3::new(
                cos * (1.0 - height * height).sqrt(),
                height,
                sin * (1.0 - height * height).sqrt(),
            )
        };
        (0..count).map(point).collect()
    }

    #[test]
    fn a_small_hull_stays_exact() {
        let points = ball(32);
        let hull = enclose(&points, 32).unwrap();
        assert_eq!(hull.vertices.len(), 32);
        assert!(hull.vertices.iter().all(|vertex| points.contains(vertex)));
    }

    #[test]
    fn a_large_hull_grows_outward_and_little() {
        let points = ball(200);
        let exact = Hull::new(&points).unwrap();
        let hull = enclose(&points, 32).unwrap();
        assert!(hull.vertices.len() <= 32);
        assert!(
            points
                .iter()
                .all(|&point| hull.excess_m(point) <= CONTAINS_SLOP_M)
        );
        assert!(hull.volume_m3() > exact.volume_m3());
        assert!(hull.volume_m3() < 1.25 * exact.volume_m3());
    }

    #[test]
    fn flat_and_few_points_are_refused() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.4]];
        let square = square.map(|[x, y]| DVec3::new(x, y, 0.3));
        assert!(enclose(&square, 32).is_err());
        assert!(enclose(&square[..2], 32).is_err());
    }
}
