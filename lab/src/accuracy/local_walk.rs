//! The paper's own penetration depth: a local walk over the faces of the Minkowski difference.
//!
//! Schmidl and Lin take the depth of convex parts from this incremental method. Source: Kim, Lin and
//! Manocha 2004, "Incremental penetration depth estimation between convex polytopes using
//! dual-space expansion" (first in 2002 as DEEP, "Dual-space expansion for estimating penetration
//! depth between convex polytopes"). Written from the published description:
//!
//! * A vertex of A and a vertex of B that support the same direction are a *hub*: a vertex of the
//!   Minkowski difference. On the Gauss sphere it is the overlap of both vertices' regions of
//!   normals, and the corners of that overlap are the faces of the difference at the hub: normals of
//!   A's faces within B's region, of B's within A's, and crossings of an arc of each.
//! * The walk takes the hub's face that is nearest to the origin and looks from that face's other
//!   hubs. As soon as one of them sees a nearer face, the walk goes there. A face none of whose hubs
//!   sees a nearer one ends it.
//!
//! That end is a local minimum. Its plane supports both pieces, so its overlap is never less than
//! the depth, but it may be more: how often, and by how much, is what the table is to show.
//!
//! Here vertices are f32 and all arithmetic is f64, so that what is found is the method's error and
//! not rounding's. The hulls, their edges and normals come from the reference. Of the published ways
//! to start, two are used: the direction between the centres, and the last frame's hub and normal.
//! For pieces apart the walk has no answer; the paper measures those in another way.

use std::collections::HashMap;

use glam::{DMat3, DQuat, DVec3};

use crate::reference::{Edge, Solid};

/// Sine of the angle up to which an edge counts as lying in a plane. The overlap of a face is taken
/// between the vertices that support it, so this decides only which faces are compared.
const LEVEL_SINE: f64 = 1e-9;
/// Edges with a smaller sine between them span no face.
const PARALLEL_SINE: f64 = 1e-12;
/// The walk ends after looking from this many hubs, four times what a pair of parallel octagons has.
pub const HUBS_MAX: usize = 4 * 64;

/// Vertices of A and of B, by their indices in the meshes.
pub type Hub = [usize; 2];

/// An edge as seen from one of its ends.
#[derive(Clone, Copy, Debug)]
struct Spoke {
    /// The vertex at the other end.
    to: usize,
    /// Towards it, of length one.
    along: DVec3,
    /// Outward normals of the faces on the left and on the right: every face at a vertex is the left
    /// one of one spoke.
    normals: [DVec3; 2],
}

impl Spoke {
    fn turned(&self, rotation: &DMat3) -> Self {
        Self {
            to: self.to,
            along: *rotation * self.along,
            normals: self.normals.map(|normal| *rotation * normal),
        }
    }
}

/// A hull that can be walked over, in its own frame and in metres.
#[derive(Clone, Debug)]
pub struct Mesh {
    vertices: Vec<DVec3>,
    /// The edges at each vertex, in no order.
    stars: Vec<Vec<Spoke>>,
    /// The mean of the vertices.
    centre: DVec3,
}

impl Mesh {
    /// The hull of a solid's core; none if that is a point.
    pub fn new(solid: &Solid) -> Option<Self> {
        let mut mesh = Self {
            vertices: Vec::new(),
            stars: Vec::new(),
            centre: DVec3::ZERO,
        };
        let mut places = HashMap::new();
        for edge in solid.edges() {
            mesh.add(edge, &mut places);
        }
        mesh.centre = mesh.vertices.iter().sum::<DVec3>() / mesh.vertices.len() as f64;
        (!mesh.vertices.is_empty()).then_some(mesh)
    }

    fn add(&mut self, edge: &Edge, places: &mut HashMap<[u64; 3], usize>) {
        let [p, q] = edge.ends.map(|point| {
            let bits = point.to_array().map(f64::to_bits);
            *places.entry(bits).or_insert_with(|| {
                self.vertices.push(point);
                self.stars.push(Vec::new());
                self.vertices.len() - 1
            })
        });
        let [left, right] = edge.normals;
        self.stars[p].push(Spoke {
            to: q,
            along: edge.direction,
            normals: [left, right],
        });
        self.stars[q].push(Spoke {
            to: p,
            along: -edge.direction,
            normals: [right, left],
        });
    }

    /// Climbs along edges to the vertex farthest along `direction`.
    fn climb(&self, from: usize, direction: DVec3) -> usize {
        let reach = |vertex: usize| direction.dot(self.vertices[vertex]);
        let mut at = (from, reach(from));
        loop {
            let around = self.stars[at.0].iter().map(|s| (s.to, reach(s.to)));
            let best = around.fold(at, |best, next| if next.1 > best.1 { next } else { best });
            if best.0 == at.0 {
                return at.0;
            }
            at = best;
        }
    }

    /// The vertices beside `vertex` that are as far along `normal`.
    fn level(&self, vertex: usize, normal: DVec3) -> impl Iterator<Item = usize> {
        let star = self.stars[vertex].iter();
        let is_level = move |spoke: &&Spoke| normal.dot(spoke.along).abs() <= LEVEL_SINE;
        star.filter(is_level).map(|spoke| spoke.to)
    }
}

/// Two meshes at their poses; everything is in the frame of A.
#[derive(Clone, Copy, Debug)]
pub struct Pair<'a> {
    meshes: &'a [Mesh; 2],
    /// From A's frame to the world.
    to_world: DMat3,
    /// From B's frame to A's.
    rotation: DMat3,
    /// B's origin in A's frame.
    offset: DVec3,
}

impl<'a> Pair<'a> {
    /// The meshes of A and B at their rotations, of length one, and positions in metres.
    pub fn new(meshes: &'a [Mesh; 2], poses: &[(DQuat, DVec3); 2]) -> Self {
        let [a, b] = poses.map(|(rotation, _)| DMat3::from_quat(rotation));
        Self {
            meshes,
            to_world: a,
            rotation: a.transpose() * b,
            offset: a.transpose() * (poses[1].1 - poses[0].1),
        }
    }

    fn carry(&self, point: DVec3) -> DVec3 {
        self.rotation * point + self.offset
    }

    /// From the hub's vertex of A to its vertex of B.
    fn between(&self, [a, b]: Hub) -> DVec3 {
        self.carry(self.meshes[1].vertices[b]) - self.meshes[0].vertices[a]
    }

    /// The face or start with this normal, taken between the vertices that support it.
    fn supported(&self, from: Hub, normal: DVec3) -> Facet {
        let hub = [
            self.meshes[0].climb(from[0], -normal),
            self.meshes[1].climb(from[1], self.rotation.transpose() * normal),
        ];
        Facet {
            normal,
            overlap_m: normal.dot(self.between(hub)),
            hub,
        }
    }
}

/// Where a walk starts.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    normal: DVec3,
    hub: Hub,
}

impl Start {
    /// From the direction between the centres, which is the mean of each hull's vertices; upward if
    /// they are the same.
    pub fn between_centres(pair: &Pair) -> Self {
        let [a, b] = pair.meshes;
        let between = a.centre - pair.carry(b.centre);
        Self::along(pair.to_world * between.try_normalize().unwrap_or(DVec3::Y))
    }

    /// From a direction in the world, of length one, from B into A.
    pub fn along(normal: DVec3) -> Self {
        Self {
            normal,
            hub: [0, 0],
        }
    }

    /// From where the last frame's walk ended, at the same meshes.
    pub fn at(last: &Found) -> Self {
        Self {
            normal: last.normal,
            hub: last.hub,
        }
    }
}

/// The face at which a walk ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// In the world, of length one, from B into A: moving A by the overlap along it parts the pieces.
    pub normal: DVec3,
    /// Overlap along the normal in metres: the penetration depth or more. Means nothing for pieces
    /// apart.
    pub overlap_m: f64,
    /// A hub of the face.
    pub hub: Hub,
    /// How many hubs were looked from, at most [`HUBS_MAX`].
    pub hubs_seen: usize,
}

/// Walks to a face of the Minkowski difference that has no nearer one around it.
///
/// Cost: the climb to the start, then for each of at most [`HUBS_MAX`] hubs all pairs of edges at
/// its two vertices.
pub fn walk(pair: &Pair, start: &Start) -> Found {
    let normal = pair.to_world.transpose() * start.normal;
    let mut walk = Walk::new(pair, pair.supported(start.hub, normal));
    let mut next = 0;
    while next < walk.corners.len() && walk.seen.len() < HUBS_MAX {
        let hub = walk.corners[next];
        if walk.sees_nearer(hub) {
            walk.corners.clear();
            walk.corners.push(walk.nearest.hub);
            next = 0;
        } else {
            walk.add_corners_beside(hub);
            next += 1;
        }
    }
    Found {
        normal: pair.to_world * walk.nearest.normal,
        overlap_m: walk.nearest.overlap_m,
        hub: walk.nearest.hub,
        hubs_seen: walk.seen.len(),
    }
}

/// A face of the Minkowski difference.
#[derive(Clone, Copy, Debug)]
struct Facet {
    /// From B into A, of length one.
    normal: DVec3,
    /// Distance of its plane from the origin.
    overlap_m: f64,
    /// One of its hubs.
    hub: Hub,
}

struct Walk<'a, 'b> {
    pair: &'b Pair<'a>,
    nearest: Facet,
    /// Hubs of the nearest face, the ones beside those visited so far.
    corners: Vec<Hub>,
    /// Hubs that were looked from. What they see is never nearer than the nearest face.
    seen: Vec<Hub>,
    /// The edges at one vertex of B, in the frame of A.
    star_of_b: Vec<Spoke>,
}

impl<'a, 'b> Walk<'a, 'b> {
    fn new(pair: &'b Pair<'a>, start: Facet) -> Self {
        Self {
            pair,
            nearest: start,
            corners: vec![start.hub],
            seen: Vec::new(),
            star_of_b: Vec::new(),
        }
    }

    /// Takes the nearest face at the hub if it is nearer than the one that is known.
    fn sees_nearer(&mut self, hub: Hub) -> bool {
        if self.seen.contains(&hub) {
            return false;
        }
        self.seen.push(hub);
        let Some(normal) = self.nearest_at(hub) else {
            return false;
        };
        let facet = self.pair.supported(hub, normal);
        let is_nearer = facet.overlap_m < self.nearest.overlap_m;
        if is_nearer {
            self.nearest = facet;
        }
        is_nearer
    }

    /// The normal of the nearest face at the hub; none if none is nearer than the one known.
    fn nearest_at(&mut self, hub: Hub) -> Option<DVec3> {
        let [mesh_a, mesh_b] = self.pair.meshes;
        let turned = |spoke: &Spoke| spoke.turned(&self.pair.rotation);
        self.star_of_b.clear();
        self.star_of_b
            .extend(mesh_b.stars[hub[1]].iter().map(turned));
        let (star_a, star_b) = (&mesh_a.stars[hub[0]], &self.star_of_b);
        let mut least = Least {
            between: self.pair.between(hub),
            overlap_m: self.nearest.overlap_m,
            normal: None,
        };
        for spoke in star_a {
            least.offer(-spoke.normals[0], |n| supports(star_b, n));
        }
        for spoke in star_b {
            least.offer(spoke.normals[0], |n| supports(star_a, -n));
        }
        for e in star_a {
            for normal in star_b.iter().filter_map(|f| crossing(e, f)) {
                least.offer(normal, |_| true);
            }
        }
        least.normal
    }

    /// Notes the hubs of the nearest face that share an edge of a piece with this one.
    fn add_corners_beside(&mut self, [a, b]: Hub) {
        let [mesh_a, mesh_b] = self.pair.meshes;
        let normal = self.nearest.normal;
        let of_a = mesh_a.level(a, normal).map(|a| [a, b]);
        let in_b = self.pair.rotation.transpose() * normal;
        let of_b = mesh_b.level(b, in_b).map(|b| [a, b]);
        for hub in of_a.chain(of_b) {
            if !self.corners.contains(&hub) {
                self.corners.push(hub);
            }
        }
    }
}

/// The nearest of the faces that were offered at one hub.
struct Least {
    between: DVec3,
    overlap_m: f64,
    normal: Option<DVec3>,
}

impl Least {
    fn offer(&mut self, normal: DVec3, is_face: impl Fn(DVec3) -> bool) {
        let overlap_m = normal.dot(self.between);
        if overlap_m < self.overlap_m && is_face(normal) {
            self.overlap_m = overlap_m;
            self.normal = Some(normal);
        }
    }
}

/// Whether no edge of the star leads farther along the direction.
fn supports(star: &[Spoke], direction: DVec3) -> bool {
    let mut spokes = star.iter();
    spokes.all(|spoke| direction.dot(spoke.along) <= LEVEL_SINE)
}

/// The direction that supports both an edge of A (from B's side) and one of B, if there is one: the
/// point where the edges' arcs cross on the Gauss sphere.
fn crossing(of_a: &Spoke, of_b: &Spoke) -> Option<DVec3> {
    let parts = |edge: DVec3, [p, q]: [DVec3; 2]| edge.dot(p) * edge.dot(q) < 0.0;
    if !parts(of_a.along, of_b.normals) || !parts(of_b.along, of_a.normals) {
        return None;
    }
    let across = of_a.along.cross(of_b.along);
    let sine = across.length();
    if sine < PARALLEL_SINE {
        return None;
    }
    let normal = across / sine;
    // The great circles meet in two opposite points; an arc is shorter than a half circle, so the
    // sum of its ends tells which of them is on it.
    let [a, b] = [of_a, of_b].map(|s| normal.dot(s.normals[0] + s.normals[1]));
    (a * b < 0.0).then(|| normal * b.signum())
}
