//! The depth of cores that overlap, by all separating axes.
//!
//! The gap along a direction is a lower bound of the signed distance, and the greatest gap over
//! the facet normals of the Minkowski difference is the signed distance of overlapping cores. Those
//! normals are the face normals of both and the crossings of their edges' normal arcs (Gregorius
//! 2013, "The separating axis test between convex polyhedra").
//!
//! Pruning never changes the answer: a direction n cannot have a gap above
//! n . (centre of A - centre of B) minus the radii of balls about the centres inside the cores.

use super::features::between_lines;
use super::hull::Edge;
use super::near;
use super::relative::Relative;
use glam::DVec3;

/// Arcs that miss each other by less than this still count as crossing; every candidate that could
/// win is measured against all vertices, so a false crossing does no harm.
const CROSSING_TOLERANCE: f64 = 1e-9;
const SLACK_RELATIVE: f64 = 1e-12;

/// The direction of greatest gap, in metres and in the frame of `a`.
pub(super) struct Deepest {
    /// Zero or less for cores that touch or overlap.
    pub gap: f64,
    /// From `b` to `a`, of length one.
    pub normal: DVec3,
    /// Points of the two cores with `points[0] - points[1] = gap * normal`.
    pub points: [DVec3; 2],
}

#[derive(Clone, Copy)]
enum Feature {
    FaceOfA,
    FaceOfB,
    Edges([DVec3; 2], [DVec3; 2]),
}

/// The greatest gap over all facet normals.
pub(super) fn deepest(pair: &Relative) -> Deepest {
    let mut search = Search::new(pair);
    search.faces();
    search.edges();
    search.flat_sums();
    search.finish()
}

/// The normals of all facets of the Minkowski difference, with the gap along each.
/// There may be more: each still bounds the signed distance from below.
pub(super) fn facets(pair: &Relative) -> Vec<(DVec3, f64)> {
    let mut search = Search::new(pair);
    search.keep_all = Some(Vec::new());
    search.faces();
    search.edges();
    search.flat_sums();
    search.keep_all.unwrap_or_default()
}

struct Search<'a, 'b> {
    pair: &'b Relative<'a>,
    centres: DVec3,
    inner: f64,
    slack: f64,
    gap: f64,
    normal: DVec3,
    feature: Feature,
    keep_all: Option<Vec<(DVec3, f64)>>,
}

impl<'a, 'b> Search<'a, 'b> {
    fn new(pair: &'b Relative<'a>) -> Self {
        let centres = pair.between_centres();
        let normal = if centres.length() > 0.0 {
            centres.normalize()
        } else {
            DVec3::X
        };
        let slack = SLACK_RELATIVE * pair.scale;
        Self {
            pair,
            centres,
            inner: pair.a.inner() + pair.b.inner(),
            slack,
            gap: pair.gap_along(normal) - slack,
            normal,
            feature: Feature::FaceOfA,
            keep_all: None,
        }
    }

    /// Whether a direction with this component along the centres can beat the best gap.
    fn may_win(&self, along_centres: f64) -> bool {
        self.keep_all.is_some() || along_centres - self.inner + self.slack >= self.gap
    }

    fn offer(&mut self, normal: DVec3, gap: f64, feature: Feature) {
        if let Some(kept) = &mut self.keep_all {
            kept.push((normal, gap));
        }
        if gap > self.gap {
            self.gap = gap;
            self.normal = normal;
            self.feature = feature;
        }
    }

    fn faces(&mut self) {
        let pair = self.pair;
        for face in pair.a.faces() {
            let normal = -face.normal;
            if self.may_win(normal.dot(self.centres)) {
                let gap = -face.offset - normal.dot(pair.support_of_b(normal));
                self.offer(normal, gap, Feature::FaceOfA);
            }
        }
        for face in pair.b.faces() {
            let normal = pair.rotation * face.normal;
            if self.may_win(normal.dot(self.centres)) {
                let offset = face.offset + normal.dot(pair.offset);
                let gap = normal.dot(pair.a.support(-normal)) - offset;
                self.offer(normal, gap, Feature::FaceOfB);
            }
        }
    }

    fn edges(&mut self) {
        let a: Vec<Edge> = self.pair.a.edges().iter().map(opposite).collect();
        let b: Vec<Edge> = self
            .pair
            .b
            .edges()
            .iter()
            .map(|e| carried(self.pair, e))
            .collect();
        let mut a = self.promising(a);
        let b = self.promising(b);
        a.sort_by(|x, y| y.1.total_cmp(&x.1));
        for (e, bound) in &a {
            if self.may_win(*bound) {
                b.iter().for_each(|(f, _)| self.edge_pair(e, f));
            }
        }
    }

    fn promising(&self, edges: Vec<Edge>) -> Vec<(Edge, f64)> {
        let bounded = edges.into_iter().map(|e| {
            let bound = most_along(&e, self.centres);
            (e, bound)
        });
        bounded.filter(|&(_, bound)| self.may_win(bound)).collect()
    }

    fn edge_pair(&mut self, e: &Edge, f: &Edge) {
        if !arcs_cross(e, f) {
            return;
        }
        let Some(across) = near::square_part(e.direction, f.direction) else {
            return;
        };
        let normal = e.direction.cross(across);
        let side = normal.dot(f.normals[0] + f.normals[1]);
        if side > -1e-6 {
            self.edge_axis(normal, e, f);
        }
        if side < 1e-6 {
            self.edge_axis(-normal, e, f);
        }
    }

    fn edge_axis(&mut self, normal: DVec3, e: &Edge, f: &Edge) {
        let at_most = normal.dot(e.ends[0] - f.ends[0]);
        if self.keep_all.is_some() || at_most > self.gap {
            self.offer(
                normal,
                self.pair.gap_along(normal),
                Feature::Edges(e.ends, f.ends),
            );
        }
    }

    /// Without a face on either side the sum of the cores may be flat: a point, a segment or a
    /// parallelogram.
    fn flat_sums(&mut self) {
        if !self.pair.a.faces().is_empty() || !self.pair.b.faces().is_empty() {
            return;
        }
        let of_a = self.pair.a.edges().first().map(|e| e.direction);
        let of_b = self
            .pair
            .b
            .edges()
            .first()
            .map(|e| self.pair.rotation * e.direction);
        let across = of_a
            .or(of_b)
            .map_or(DVec3::X, |d| d.any_orthonormal_vector());
        for normal in [across, -across] {
            self.offer(normal, self.pair.gap_along(normal), Feature::FaceOfA);
        }
    }

    fn finish(self) -> Deepest {
        let Self { pair, normal, .. } = self;
        let gap = pair.gap_along(normal);
        let [a, b] = pair.support(normal);
        let points = match self.feature {
            Feature::FaceOfA => [b + normal * gap, b],
            Feature::FaceOfB => [a, a - normal * gap],
            Feature::Edges(e, f) => between_lines(e, f)
                .filter(|[p, q]| (*p - *q - normal * gap).length() <= self.slack)
                .unwrap_or([b + normal * gap, b]),
        };
        Deepest {
            gap,
            normal,
            points,
        }
    }
}

/// The edge with its arc mirrored: normals of A's edges as seen from B.
fn opposite(edge: &Edge) -> Edge {
    Edge {
        normals: edge.normals.map(|n| -n),
        ..*edge
    }
}

fn carried(pair: &Relative, edge: &Edge) -> Edge {
    Edge {
        ends: edge.ends.map(|p| pair.carry(p)),
        direction: pair.rotation * edge.direction,
        normals: edge.normals.map(|n| pair.rotation * n),
    }
}

/// The greatest component along `vector` of any unit normal on the edge's arc.
fn most_along(edge: &Edge, vector: DVec3) -> f64 {
    let slack = -1e-9 * vector.length();
    let [first, last] = edge.normals;
    let after_first = first.cross(vector).dot(edge.direction) >= slack;
    let before_last = vector.cross(last).dot(edge.direction) >= slack;
    if after_first && before_last {
        return vector.reject_from_normalized(edge.direction).length();
    }
    first.dot(vector).max(last.dot(vector))
}

fn arcs_cross(e: &Edge, f: &Edge) -> bool {
    let of_f = f.normals.map(|n| n.dot(e.direction));
    if same_side(of_f) {
        return false;
    }
    let of_e = e.normals.map(|n| n.dot(f.direction));
    !same_side(of_e) && !same_side([of_f[0], -of_e[1]])
}

fn same_side([x, y]: [f64; 2]) -> bool {
    let both_above = x > CROSSING_TOLERANCE && y > CROSSING_TOLERANCE;
    let both_below = x < -CROSSING_TOLERANCE && y < -CROSSING_TOLERANCE;
    both_above || both_below
}
