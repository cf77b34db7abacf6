//! How deep the origin is in the difference of two cores: a polytope inside the difference grows at
//! the facet nearest the origin until that facet is one of the difference's own.
//!
//! The expanding polytope of van den Bergen 2001 ("Proximity Queries and Penetration Depth
//! Computation on 3D Game Objects"), with two departures:
//!
//! * **The certificate does not need a convex polytope.** Let a closed surface of triangles have the
//!   topology of a sphere and see the origin on the inner side of each of its planes. Projected onto
//!   a sphere about the origin it covers that sphere exactly once (the projection is a local
//!   homeomorphism of spheres), so it encloses a ball whose radius is the least distance of its
//!   planes, and so does the convex hull of its vertices, which are points of the difference. Rounding
//!   that makes the surface slightly dented is therefore harmless, and a surface that was found for
//!   other poses proves a depth at new ones after one pass over its planes.
//! * **Supports are chosen in f32, verified in f64.** A facet is final only when the corner that
//!   reaches farthest, in f64, is not beyond it.
//!
//! The depth that is returned was measured by the supports of both cores along the returned
//! normal; the ball shows that no other direction has less.

use arrayvec::ArrayVec;
use glam::{DVec3, Vec3};

use super::difference::{Corner, Difference};
use super::simplex::barycentric;
use super::warm::{WARM_CORNERS_MAX, WarmStart};
use crate::math::sqrt_f64;

/// Most corners of the polytope; pairs that need more are measured by enumeration.
const CORNERS_MAX: usize = 48;

/// Most facets: a closed surface of triangles with V corners has 2 V - 4 (Euler).
const FACETS_MAX: usize = 2 * CORNERS_MAX - 4;

/// Unit normals whose product is at least this belong to one plane.
const SAME_PLANE: f64 = 1.0 - 1e-12;

/// Of several directions with the same depth, the one that leans most toward this is the answer.
const PREFERRED: DVec3 = DVec3::new(0.267, 0.802, 0.535);

/// The depth of the origin in the difference of two cores.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Depth {
    /// Unit normal from B into A.
    pub normal: DVec3,
    /// Overlap along the normal, by the supports of both cores, in metres.
    pub depth_m: f64,
    /// A point of A, and the one of B that is the depth away along the normal.
    pub point_a: Vec3,
    pub point_b: Vec3,
}

/// The other side of a facet's edge: a facet and which of its edges.
#[derive(Clone, Copy)]
struct Across {
    facet: u8,
    edge: u8,
}

/// A triangle; edge i runs from vertex i to the next.
#[derive(Clone, Copy)]
struct Facet {
    vertices: [u8; 3],
    across: [Across; 3],
    /// Outward, of any length.
    normal: DVec3,
    normal_squared: f64,
    /// Product of the normal with the vertices.
    offset: f64,
    gone: bool,
}

/// A facet that no corner is beyond.
struct Final {
    facet: usize,
    outward: DVec3,
    depth_m: f64,
}

/// A closed surface of triangles around the origin whose corners are corners of the difference.
pub(crate) struct Polytope {
    corners: ArrayVec<Corner, CORNERS_MAX>,
    facets: ArrayVec<Facet, FACETS_MAX>,
    /// Squared distance of each facet's plane, negative where the origin is outside; infinite when the
    /// facet is gone or final.
    squared: ArrayVec<f64, FACETS_MAX>,
    /// Facets that are gone, to be used again.
    gone: ArrayVec<u8, FACETS_MAX>,
    /// Whether the facets know what is across their edges.
    is_linked: bool,
    grain_m: f64,
}

/// The vertices of a facet, and the facets and edges across its edges.
type Triangle = ([u8; 3], [(u8, u8); 3]);

/// Facets of a tetrahedron.
const TETRAHEDRON: [Triangle; 4] = [
    ([0, 1, 2], [(1, 2), (2, 2), (3, 2)]),
    ([0, 3, 1], [(3, 1), (2, 0), (0, 0)]),
    ([1, 3, 2], [(1, 1), (3, 0), (0, 1)]),
    ([2, 3, 0], [(2, 1), (1, 0), (0, 2)]),
];

/// The depth of a pair for which four corners are known, best with the origin inside.
///
/// `None` when the corners are flat, the origin is not inside the difference as far as f64 can tell, or the polytope would need more than [`CORNERS_MAX`] corners. Cost: one support query of
/// each core and a pass over the facets for every corner.
pub(crate) fn depth(
    pair: &Difference,
    corners: &[Corner],
    warm: Option<&mut WarmStart>,
) -> Option<Depth> {
    let mut polytope = Polytope::new(pair.grain_m());
    polytope.start(corners)?;
    let found = polytope.grow(pair)?;
    if let Some(warm) = warm {
        polytope.remember(&found, warm);
    }
    Some(polytope.answer(pair, &found))
}

/// As [`depth`], where the search for the nearest point ended on the origin without four corners about
/// it: the polytope starts with corners far apart, wherever the origin is. Cost: twelve support queries
/// of each core more.
pub(crate) fn depth_from_afar(
    pair: &Difference,
    corners: &[Corner],
    warm: Option<&mut WarmStart>,
) -> Option<Depth> {
    let mut known: ArrayVec<Corner, 16> = corners.iter().copied().take(4).collect();
    let look_along = |axis: DVec3, known: &mut ArrayVec<Corner, 16>| {
        known.extend([pair.lowest(axis), pair.lowest(-axis)]);
    };
    for axis in DVec3::AXES {
        look_along(axis, &mut known);
    }
    let p = known[0];
    let q = farthest(&known, |at| (at - p.at).length_squared());
    let along = q.at - p.at;
    let beside = along.any_orthogonal_vector();
    look_along(beside, &mut known);
    look_along(along.cross(beside), &mut known);
    let r = farthest(&known, |at| (at - p.at).cross(along).length_squared());
    let normal = along.cross(r.at - p.at);
    look_along(normal, &mut known);
    let s = farthest(&known, |at| normal.dot(at - p.at).abs());
    depth(pair, &[p, q, r, s], warm)
}

/// The first of the corners for which a measure is largest.
fn farthest(corners: &[Corner], measure: impl Fn(DVec3) -> f64) -> Corner {
    let mut best = (corners[0], measure(corners[0].at));
    for &corner in corners {
        let far = measure(corner.at);
        if far > best.1 {
            best = (corner, far);
        }
    }
    best.0
}

/// As [`depth`], from the surface that an earlier answer left; `None` also when it does not enclose the
/// origin any more.
pub(crate) fn depth_again(pair: &Difference, warm: &mut WarmStart) -> Option<Depth> {
    let mut polytope = Polytope::new(pair.grain_m());
    polytope.recall(pair, warm)?;
    let found = polytope.grow(pair)?;
    if polytope.is_linked {
        polytope.remember(&found, warm);
    }
    Some(polytope.answer(pair, &found))
}

impl Across {
    const NOWHERE: Self = Self { facet: 0, edge: 0 };
}

impl Facet {
    /// The two ends of an edge.
    #[inline]
    fn edge(&self, edge: usize) -> (u8, u8) {
        (
            self.vertices[edge],
            self.vertices[if edge == 2 { 0 } else { edge + 1 }],
        )
    }
}

impl Polytope {
    fn new(grain_m: f64) -> Self {
        Self {
            corners: ArrayVec::new(),
            facets: ArrayVec::new(),
            squared: ArrayVec::new(),
            gone: ArrayVec::new(),
            is_linked: true,
            grain_m,
        }
    }

    /// Starts with the surface that an earlier answer left.
    fn recall(&mut self, pair: &Difference, warm: &WarmStart) -> Option<()> {
        for corner in warm.corners(pair) {
            self.corners.try_push(corner?).ok()?;
        }
        for &vertices in warm.facets() {
            self.add(vertices, [Across::NOWHERE; 3])?;
        }
        self.is_linked = false;
        (!self.facets.is_empty()).then_some(())
    }

    /// Finds what is across every edge of a recalled surface.
    fn link(&mut self) -> Option<()> {
        const NONE: u8 = u8::MAX;
        let mut facet_of = [[NONE; WARM_CORNERS_MAX]; WARM_CORNERS_MAX];
        for (place, facet) in self.facets.iter().enumerate() {
            for edge in 0..3 {
                let (from, to) = facet.edge(edge);
                facet_of[usize::from(from)][usize::from(to)] = place as u8;
            }
        }
        for place in 0..self.facets.len() {
            for edge in 0..3 {
                let (from, to) = self.facets[place].edge(edge);
                let facet = facet_of[usize::from(to)][usize::from(from)];
                let across = self.facets.get(usize::from(facet))?;
                let edge_across = (0..3).find(|&edge| across.edge(edge) == (to, from))?;
                self.facets[place].across[edge] = Across {
                    facet,
                    edge: edge_across as u8,
                };
            }
        }
        self.is_linked = true;
        Some(())
    }

    /// Leaves the final facet, and the surface if there is room for it, to the next answer.
    fn remember(&self, found: &Final, warm: &mut WarmStart) {
        let feature = self.facets[found.facet]
            .vertices
            .map(|vertex| self.corners[usize::from(vertex)]);
        warm.feature.remember(&feature);
        warm.forget_surface();
        if self.remember_surface(warm).is_none() {
            warm.forget_surface();
        }
    }

    fn remember_surface(&self, warm: &mut WarmStart) -> Option<()> {
        const NONE: u8 = u8::MAX;
        let mut renamed = [NONE; CORNERS_MAX];
        for facet in self.facets.iter().filter(|facet| !facet.gone) {
            for vertex in facet.vertices.map(usize::from) {
                if renamed[vertex] == NONE {
                    renamed[vertex] = warm.remember_corner(&self.corners[vertex])?;
                }
            }
            warm.remember_facet(facet.vertices.map(|vertex| renamed[usize::from(vertex)]))?;
        }
        Some(())
    }

    /// Starts with a tetrahedron; `None` if it is flat.
    fn start(&mut self, corners: &[Corner]) -> Option<()> {
        let &[p, q, r, s] = corners else {
            return None;
        };
        let volume = (q.at - p.at).cross(r.at - p.at).dot(s.at - p.at);
        let (q, r) = if volume < 0.0 { (q, r) } else { (r, q) };
        self.corners.extend([p, q, r, s]);
        for (vertices, across) in TETRAHEDRON {
            let across = across.map(|(facet, edge)| Across { facet, edge });
            self.add(vertices, across)?;
        }
        Some(())
    }

    /// Adds a facet; `None` if it has no area, or there is no room.
    #[inline]
    fn add(&mut self, vertices: [u8; 3], across: [Across; 3]) -> Option<usize> {
        let [p, q, r] = vertices.map(|vertex| self.corners[usize::from(vertex)].at);
        let normal = (q - p).cross(r - p);
        let normal_squared = normal.length_squared();
        let offset = normal.dot(p);
        let squared = offset * offset.abs() / normal_squared;
        if !squared.is_finite() {
            return None;
        }
        let facet = Facet {
            vertices,
            across,
            normal,
            normal_squared,
            offset,
            gone: false,
        };
        if let Some(place) = self.gone.pop() {
            let place = usize::from(place);
            self.facets[place] = facet;
            self.squared[place] = squared;
            return Some(place);
        }
        self.facets.try_push(facet).ok()?;
        self.squared.push(squared);
        Some(self.facets.len() - 1)
    }

    /// The open facet that the origin is farthest outside of, or nearest to when it is inside all, and
    /// infinity if none is open.
    #[inline]
    fn nearest(&self) -> (usize, f64) {
        let (mut place, mut least) = (0, f64::INFINITY);
        for (index, &squared) in self.squared.iter().enumerate() {
            if squared < least {
                (place, least) = (index, squared);
            }
        }
        (place, least)
    }

    /// Grows until the origin is inside, the nearest facet is final, and all others at the same
    /// distance are. `None` where the cores turn out to be apart.
    fn grow(&mut self, pair: &Difference) -> Option<Final> {
        let mut best: Option<Final> = None;
        loop {
            let (place, squared) = self.nearest();
            if squared == f64::INFINITY {
                break;
            }
            let facet = &self.facets[place];
            let scale = 1.0 / sqrt_f64(facet.normal_squared);
            let (outward, distance) = (facet.normal * scale, facet.offset * scale);
            if let Some(best) = best.as_mut() {
                if distance > best.depth_m + self.grain_m {
                    break;
                }
                if outward.dot(best.outward) >= SAME_PLANE {
                    self.squared[place] = f64::INFINITY;
                    if self.foot_weight(place) > self.foot_weight(best.facet) {
                        best.facet = place;
                    }
                    continue;
                }
            }
            let within = distance + self.grain_m;
            let corner = pair.lowest(-outward);
            let reach = outward.dot(corner.at);
            if reach < -self.grain_m {
                return None;
            }
            if reach > within {
                self.expand(place, corner)?;
                continue;
            }
            self.squared[place] = f64::INFINITY;
            let preferred = best
                .as_ref()
                .is_none_or(|best| outward.dot(PREFERRED) < best.outward.dot(PREFERRED));
            if preferred {
                best = Some(Final {
                    facet: place,
                    outward,
                    depth_m: if reach > distance { reach } else { distance },
                });
            }
        }
        best
    }

    /// Replaces the facets that a corner sees, of which `first` is one, by a fan about the corner.
    fn expand(&mut self, first: usize, corner: Corner) -> Option<()> {
        if !self.is_linked {
            self.link()?;
        }
        let apex = u8::try_from(self.corners.len()).ok()?;
        self.corners.try_push(corner).ok()?;
        let mut horizon = ArrayVec::<Across, CORNERS_MAX>::new();
        self.remove_seen(first, corner.at, &mut horizon)?;
        let mut fan = ArrayVec::<u8, CORNERS_MAX>::new();
        let (mut begin, _) = self.ends(*horizon.last()?);
        for &beyond in &horizon {
            let (from, to) = self.ends(beyond);
            // The horizon is a single loop, or the surface was not closed.
            if to != begin {
                return None;
            }
            begin = from;
            let place = self.add([to, from, apex], [beyond, Across::NOWHERE, Across::NOWHERE])?;
            let facet = place as u8;
            self.facets[usize::from(beyond.facet)].across[usize::from(beyond.edge)] =
                Across { facet, edge: 0 };
            fan.push(facet);
        }
        let count = fan.len();
        for k in 0..count {
            let next = fan[if k + 1 == count { 0 } else { k + 1 }];
            self.facets[usize::from(fan[k])].across[1] = Across {
                facet: next,
                edge: 2,
            };
            self.facets[usize::from(next)].across[2] = Across {
                facet: fan[k],
                edge: 1,
            };
        }
        Some(())
    }

    /// The two ends of an edge.
    #[inline]
    fn ends(&self, edge: Across) -> (u8, u8) {
        self.facets[usize::from(edge.facet)].edge(edge.edge.into())
    }

    /// Takes out the facets that `eye` is beyond, from `first` on, and collects the edges around them
    /// in order, as edges of the facets that stay.
    fn remove_seen(
        &mut self,
        first: usize,
        eye: DVec3,
        horizon: &mut ArrayVec<Across, CORNERS_MAX>,
    ) -> Option<()> {
        let mut open = ArrayVec::<Across, FACETS_MAX>::new();
        self.remove(first);
        let [a, b, c] = self.facets[first].across;
        open.extend([c, b, a]);
        while let Some(edge) = open.pop() {
            let place = usize::from(edge.facet);
            let facet = &self.facets[place];
            if facet.gone {
                continue;
            }
            if !self.is_beyond(facet, eye) {
                horizon.try_push(edge).ok()?;
                continue;
            }
            let across = facet.across;
            self.remove(place);
            let at = usize::from(edge.edge);
            open.try_push(across[(at + 2) % 3]).ok()?;
            open.try_push(across[(at + 1) % 3]).ok()?;
        }
        Some(())
    }

    fn remove(&mut self, place: usize) {
        self.facets[place].gone = true;
        self.squared[place] = f64::INFINITY;
        self.gone.push(place as u8);
    }

    /// Whether a point is above a facet's plane by more than the grain.
    #[inline]
    fn is_beyond(&self, facet: &Facet, eye: DVec3) -> bool {
        let above = facet.normal.dot(eye) - facet.offset;
        above > 0.0 && above * above > self.grain_m * self.grain_m * facet.normal_squared
    }

    /// The weights of a facet's corners at the foot of the origin.
    fn foot(&self, place: usize) -> [f64; 3] {
        let [p, q, r] = self.facets[place]
            .vertices
            .map(|vertex| self.corners[usize::from(vertex)].at);
        barycentric(p, q, r)
    }

    /// The least of these weights: negative when the foot is outside the facet.
    fn foot_weight(&self, place: usize) -> f64 {
        let [p, q, r] = self.foot(place);
        let least = if p < q { p } else { q };
        if least < r { least } else { r }
    }

    fn answer(&self, pair: &Difference, found: &Final) -> Depth {
        let weights = self
            .foot(found.facet)
            .map(|w| if w > 0.0 { w } else { 0.0 });
        let sum: f64 = weights.iter().sum();
        let corners = self.facets[found.facet]
            .vertices
            .map(|vertex| self.corners[usize::from(vertex)]);
        let (point_a, point_b) = pair.witnesses(&corners, &weights.map(|w| w / sum));
        Depth {
            normal: -found.outward,
            depth_m: found.depth_m,
            point_a,
            point_b,
        }
    }
}
