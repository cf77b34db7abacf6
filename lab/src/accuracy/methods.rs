//! The methods that are compared: each answers the same question for the same f32 numbers.

use glam::{DQuat, DVec3, Vec3};
use palpable::geometry::convex::{Convex, Edge, Face, Lane};
use palpable::geometry::hull::{HullBuilder, HullError, HullView};
use palpable::geometry::separation::{Separation, separation, separation_again};
use palpable::geometry::warm::WarmStart;
use palpable::math::Pose;
use serde::Serialize;

use super::generate::{Pair, solids};
use super::local_walk::{self, Found, Mesh, Start, walk};
use super::shapes::Shape;
use crate::reference::Solid;

/// Who answers, and whether it may use the answer for the first poses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Palpable's `separation` without a seed, at the first poses.
    Palpable,
    /// Palpable's `separation_again` at the second poses, from where the first search ended.
    PalpableWarm,
    /// parry3d in f32, a fresh `query::contact` at the first poses.
    ParryF32,
    /// parry3d in f32 at the second poses, started in the first normal's direction.
    ParryF32Warm,
    /// parry3d in f64, a fresh `query::contact` at the first poses.
    ParryF64,
    /// parry3d in f64 at the second poses, started in the first normal's direction.
    ParryF64Warm,
    /// The paper's local walk from the direction between the centres, at the first poses.
    LocalWalk,
    /// The paper's local walk at the second poses, from where the first walk ended.
    LocalWalkWarm,
}

impl Method {
    /// All methods in the order of the tables.
    pub const ALL: [Self; 8] = [
        Self::Palpable,
        Self::ParryF32,
        Self::ParryF64,
        Self::LocalWalk,
        Self::PalpableWarm,
        Self::ParryF32Warm,
        Self::ParryF64Warm,
        Self::LocalWalkWarm,
    ];

    /// The method's name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Palpable => "Palpable",
            Self::PalpableWarm => "Palpable, warm",
            Self::ParryF32 => "parry f32",
            Self::ParryF32Warm => "parry f32, warm",
            Self::ParryF64 => "parry f64",
            Self::ParryF64Warm => "parry f64, warm",
            Self::LocalWalk => "local walk",
            Self::LocalWalkWarm => "local walk, warm",
        }
    }

    /// Whether the second poses are asked for.
    pub fn is_warm(self) -> bool {
        matches!(
            self,
            Self::PalpableWarm | Self::ParryF32Warm | Self::ParryF64Warm | Self::LocalWalkWarm
        )
    }

    /// Whether the method is for pieces that overlap, and is not asked about others.
    pub fn needs_overlap(self) -> bool {
        matches!(self, Self::LocalWalk | Self::LocalWalkWarm)
    }
}

/// What a method says of a pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// The gap in metres; minus the depth if the pieces overlap.
    pub gap_m: f64,
    /// From B into A.
    pub normal: DVec3,
}

impl From<Found> for Answer {
    fn from(found: Found) -> Self {
        Self {
            gap_m: -found.overlap_m,
            normal: found.normal,
        }
    }
}

/// A core of the kernel that owns its parts.
#[derive(Clone, Debug)]
pub struct Core {
    lanes: Vec<Lane>,
    vertex_count: usize,
    faces: Vec<Face>,
    edges: Vec<Edge>,
    loops: Vec<u16>,
    centre: Vec3,
    half_extents: Vec3,
    is_box: bool,
}

impl Core {
    /// Builds the kernel's core of a shape.
    ///
    /// # Errors
    /// As the builder's.
    pub fn new(builder: &mut HullBuilder, shape: &Shape) -> Result<Self, HullError> {
        let view = match shape.half_extents {
            Some(half) => builder.cuboid(Vec3::from_array(half))?,
            None => builder.build(&shape.points)?,
        };
        Ok(Self::owned(&view))
    }

    fn owned(view: &HullView) -> Self {
        Self {
            lanes: view.lanes.to_vec(),
            vertex_count: view.vertex_count,
            faces: view.faces.to_vec(),
            edges: view.edges.to_vec(),
            loops: view.loops.to_vec(),
            centre: view.centre,
            half_extents: view.half_extents,
            is_box: view.is_box,
        }
    }

    /// The core without rounding.
    pub fn convex(&self) -> Convex<'_> {
        Convex {
            lanes: &self.lanes,
            vertex_count: self.vertex_count,
            faces: &self.faces,
            edges: &self.edges,
            loops: &self.loops,
            radius: 0.0,
            centre: self.centre,
            half_extents: self.half_extents,
            is_box: self.is_box,
        }
    }
}

fn kernel(cores: &[Core; 2], poses: &[Pose; 2]) -> Answer {
    let [a, b] = cores.each_ref().map(Core::convex);
    let found = separation(&a, &b, &poses[0], &poses[1], Vec3::ZERO);
    of_kernel(&found)
}

fn kernel_again(cores: &[Core; 2], poses: &[Pose; 2], warm: &mut WarmStart) -> Answer {
    let [a, b] = cores.each_ref().map(Core::convex);
    let found = separation_again(&a, &b, &poses[0], &poses[1], warm);
    of_kernel(&found)
}

fn of_kernel(found: &Separation) -> Answer {
    Answer {
        gap_m: f64::from(found.gap_m),
        normal: found.normal.as_dvec3(),
    }
}

macro_rules! parry {
    ($module:ident, $parry:ident, $real:ty, $unit:expr) => {
        mod $module {
            use $parry::math::{Pose, Rotation, Vector};
            use $parry::query::gjk::{GJKResult, VoronoiSimplex};
            use $parry::query::{contact, details};
            use $parry::shape::SharedShape;

            use super::{Answer, DVec3, Shape};

            /// A box as a box, anything else as a convex polyhedron; none if parry refuses.
            pub(super) fn shape(shape: &Shape) -> Option<SharedShape> {
                if let Some([x, y, z]) = shape.half_extents {
                    return Some(SharedShape::cuboid(
                        <$real>::from(x),
                        <$real>::from(y),
                        <$real>::from(z),
                    ));
                }
                let points: Vec<Vector> = shape
                    .points
                    .iter()
                    .map(|p| Vector::from_array(p.map(<$real>::from)))
                    .collect();
                SharedShape::convex_hull(&points)
            }

            pub(super) fn pose(pose: &palpable::math::Pose) -> Pose {
                let [x, y, z, w] = pose.rotation.map(<$real>::from);
                let unit: fn(Rotation) -> Rotation = $unit;
                Pose::from_parts(
                    Vector::from_array(pose.position.map(<$real>::from)),
                    unit(Rotation::from_xyzw(x, y, z, w)),
                )
            }

            #[allow(clippy::unnecessary_cast)]
            fn wide(v: Vector) -> DVec3 {
                DVec3::new(v.x as f64, v.y as f64, v.z as f64)
            }

            #[allow(clippy::unnecessary_cast)]
            pub(super) fn cold(
                shapes: &[SharedShape; 2],
                poses: &[Pose; 2],
                reach_m: f64,
            ) -> Option<Answer> {
                let [a, b] = shapes;
                let reach = reach_m as $real;
                let found = contact(&poses[0], &**a, &poses[1], &**b, reach).ok()??;
                Some(Answer {
                    gap_m: found.dist as f64,
                    normal: -wide(found.normal1),
                })
            }

            #[allow(clippy::unnecessary_cast)]
            pub(super) fn warm(
                shapes: &[SharedShape; 2],
                poses: &[Pose; 2],
                reach_m: f64,
                normal: DVec3,
            ) -> Option<Answer> {
                let inward =
                    Vector::new(-normal.x as $real, -normal.y as $real, -normal.z as $real);
                let found = details::contact_support_map_support_map_with_params(
                    &poses[0].inv_mul(&poses[1]),
                    shapes[0].as_support_map()?,
                    shapes[1].as_support_map()?,
                    reach_m as $real,
                    &mut VoronoiSimplex::new(),
                    Some(poses[0].rotation.inverse() * inward),
                );
                let GJKResult::ClosestPoints(on_a, on_b, outward) = found else {
                    return None;
                };
                Some(Answer {
                    gap_m: (on_b - on_a).dot(outward) as f64,
                    normal: -wide(poses[0].rotation * outward),
                })
            }
        }
    };
}

parry!(single, parry3d, f32, |rotation| rotation);
parry!(double, parry3d_f64, f64, |rotation| rotation.normalize());

/// A pair made ready for every method; what a library refuses to build is missing.
pub struct Ready {
    cores: Option<[Core; 2]>,
    poses: [[Pose; 2]; 2],
    single: Option<[parry3d::shape::SharedShape; 2]>,
    single_poses: [[parry3d::math::Pose; 2]; 2],
    double: Option<[parry3d_f64::shape::SharedShape; 2]>,
    double_poses: [[parry3d_f64::math::Pose; 2]; 2],
    /// Farther apart than this is not asked for, in metres.
    reach_m: f64,
    /// Normals of the first poses: parry f32's, parry f64's.
    first: [DVec3; 2],
    /// Where the kernel's search at the first poses ended.
    first_start: WarmStart,
    meshes: Option<[Mesh; 2]>,
    exact_poses: [[(DQuat, DVec3); 2]; 2],
    /// Where the walk at the first poses ended.
    first_walk: Option<Found>,
}

/// `prediction` of parry, relative to the sum of both sizes and the distance of the origins.
const REACH: f64 = 2.0;

impl Ready {
    /// Builds every library's shapes.
    pub fn new(pair: &Pair, builder: &mut HullBuilder) -> Self {
        let [a, b] = &pair.shapes;
        let both = |a: Option<Core>, b: Option<Core>| Some([a?, b?]);
        let cores = both(Core::new(builder, a).ok(), Core::new(builder, b).ok());
        let solids = solids(&pair.shapes);
        let single = guarded(|| Some([single::shape(a)?, single::shape(b)?])).flatten();
        let double = guarded(|| Some([double::shape(a)?, double::shape(b)?])).flatten();
        let mut ready = Self {
            cores,
            poses: pair.poses,
            single,
            single_poses: pair.poses.map(|two| two.map(|pose| single::pose(&pose))),
            double,
            double_poses: pair.poses.map(|two| two.map(|pose| double::pose(&pose))),
            reach_m: reach_m(pair, &solids),
            first: [DVec3::Y; 2],
            first_start: WarmStart::new(),
            meshes: meshes(&solids),
            exact_poses: pair.poses.map(|two| two.each_ref().map(exact)),
            first_walk: None,
        };
        ready.first_walk = ready.walk(0, None);
        if let Some(cores) = &ready.cores {
            kernel_again(cores, &ready.poses[0], &mut ready.first_start);
        }
        let parry = [Method::ParryF32, Method::ParryF64];
        for (place, method) in parry.into_iter().enumerate() {
            if let Some(answer) = ready.ask_guarded(method).flatten() {
                ready.first[place] = answer.normal;
            }
        }
        ready
    }

    /// The method's answer, or none if it has none. The libraries' own panics come through.
    #[inline]
    pub fn ask(&self, method: Method) -> Option<Answer> {
        let [cold, warm] = [0, 1];
        match method {
            Method::Palpable => Some(kernel(self.cores.as_ref()?, &self.poses[cold])),
            Method::PalpableWarm => {
                let mut start = self.first_start;
                Some(kernel_again(
                    self.cores.as_ref()?,
                    &self.poses[warm],
                    &mut start,
                ))
            }
            Method::ParryF32 => single::cold(
                self.single.as_ref()?,
                &self.single_poses[cold],
                self.reach_m,
            ),
            Method::ParryF32Warm => single::warm(
                self.single.as_ref()?,
                &self.single_poses[warm],
                self.reach_m,
                self.first[0],
            ),
            Method::ParryF64 => double::cold(
                self.double.as_ref()?,
                &self.double_poses[cold],
                self.reach_m,
            ),
            Method::ParryF64Warm => double::warm(
                self.double.as_ref()?,
                &self.double_poses[warm],
                self.reach_m,
                self.first[1],
            ),
            Method::LocalWalk => self.walk(cold, None).map(Answer::from),
            Method::LocalWalkWarm => self.walk(warm, self.first_walk.as_ref()).map(Answer::from),
        }
    }

    /// The walk from where the last one ended, or from the direction between the centres.
    fn walk(&self, at: usize, last: Option<&Found>) -> Option<Found> {
        let pair = local_walk::Pair::new(self.meshes.as_ref()?, &self.exact_poses[at]);
        let start = last.map_or_else(|| Start::between_centres(&pair), Start::at);
        Some(walk(&pair, &start))
    }

    /// As [`Ready::ask`]; none outside if the method panicked.
    pub fn ask_guarded(&self, method: Method) -> Option<Option<Answer>> {
        guarded(|| self.ask(method))
    }
}

fn guarded<T>(work: impl FnOnce() -> T) -> Option<T> {
    std::panic::catch_unwind(std::panic::AssertUnwindSafe(work)).ok()
}

fn meshes([a, b]: &[Solid; 2]) -> Option<[Mesh; 2]> {
    Some([Mesh::new(a)?, Mesh::new(b)?])
}

fn reach_m(pair: &Pair, solids: &[Solid; 2]) -> f64 {
    let sizes = solids.each_ref().map(Solid::size);
    let [a, b] = pair.poses[0].map(|pose| pose.translation().as_dvec3());
    REACH * (sizes[0] + sizes[1] + a.distance(b))
}

/// The pose as the reference takes it.
pub fn exact(pose: &Pose) -> (DQuat, DVec3) {
    let [x, y, z, w] = pose.rotation.map(f64::from);
    (
        DQuat::from_xyzw(x, y, z, w).normalize(),
        pose.translation().as_dvec3(),
    )
}
