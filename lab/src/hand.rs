//! The hand that the scenes move: 18 convex parts cut from a skinned model, and poses to move them through.
//!
//! Everything is in the frame of the right hand's wrist, in metres, with OpenXR axes: fingers point along -Z, the
//! back of the hand is +Y, the thumb is on the -X side. Joints are counted as in `XrHandJointEXT`.
//!
//! Neighbouring parts overlap, also those of one finger and the next at their roots: hulls of a hand do. A scene
//! exempts the hand's own pairs from contact.
//!
//! The poses give rotations, the model gives bones: a pose recorded from another hand bends this one without
//! stretching it, so parts neither part nor run into each other. The four metacarpals inside the palm keep the model's
//! rotations, because the recorded poses have no rotations of their own for three of them.

mod coverage;
mod fingers;
mod hull;
mod joints;
mod model;
mod parts;
mod poses;
mod skeleton;

use std::fmt;

use glam::{DQuat, DVec3};

pub use coverage::Coverage;
pub use fingers::{ArticulatedHand, FingerAngles, FingerFit, FingerLink, PartPlace};
pub use joints::{JOINT_COUNT, JOINT_NAMES, PALM, WRIST, joint_index, joint_parent};
pub use model::HandMesh;
pub use parts::PART_COUNT;
pub use skeleton::JointPose;

use hull::Hull;
use skeleton::{LocalRotations, Skeleton};

/// The most vertices a part may have: what the kernel's cook aims at.
pub const PART_VERTICES_MAX: usize = 32;

/// Why the embedded hand could not be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum HandError {
    /// The model is not a skinned hand.
    Model(String),
    /// The poses are not the 25 joints of a hand.
    Poses(String),
    /// A joint has a name that WebXR does not know.
    Joint(String),
    /// A part has no hull within the vertex bound.
    Hull(String),
}

impl fmt::Display for HandError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Model(why) => write!(f, "hand model: {why}"),
            Self::Poses(why) => write!(f, "hand poses: {why}"),
            Self::Joint(name) => write!(f, "hand: no joint is named {name:?}"),
            Self::Hull(why) => write!(f, "hand part: {why}"),
        }
    }
}

impl std::error::Error for HandError {}

/// A pose of the whole hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum HandPose {
    /// The model's bind pose: fingers straight and spread a little.
    Flat,
    /// Fingers slightly bent.
    Relaxed,
    /// Tip of the thumb against the tip of the index finger.
    Pinch,
    /// Index finger straight, the other fingers in a fist.
    Point,
}

impl HandPose {
    /// All poses.
    pub const ALL: [Self; 4] = [Self::Flat, Self::Relaxed, Self::Pinch, Self::Point];
}

/// A convex part of the hand.
#[derive(Clone, Debug, PartialEq)]
pub struct HandPart {
    /// What it is, such as `index distal`.
    pub name: String,
    /// OpenXR index of the joint that drives it.
    pub joint: usize,
    /// 4 to 32 points in metres in the frame of that joint, all of them vertices of their convex hull.
    pub vertices: Vec<[f32; 3]>,
}

/// Where a part is, in metres, in the wrist's frame: the pose of its driving joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartPose {
    /// Unit quaternion.
    pub orientation: DQuat,
    /// Metres.
    pub position: DVec3,
}

/// A right hand of 18 convex parts.
#[derive(Clone, Debug)]
pub struct Hand {
    /// The parts, in a fixed order: wrist, palm, then thumb to pinky, each from the palm to the tip.
    pub parts: Vec<HandPart>,
    /// The mesh the parts were cut from, in its bind pose.
    pub mesh: HandMesh,
    /// The part of each of the mesh's triangles.
    pub triangle_parts: Vec<usize>,
    skeleton: Skeleton,
    poses: [LocalRotations; HandPose::ALL.len()],
}

impl Hand {
    /// Reads the embedded model and poses and cuts the parts.
    pub fn load() -> Result<Self, HandError> {
        let (mesh, bind) = model::read()?;
        let recorded = poses::read()?;
        let pose = |name: &str| {
            recorded
                .get(name)
                .ok_or_else(|| HandError::Poses(format!("no {name} pose")))
        };
        let (relaxed, pinch, point) = (pose("relaxed")?, pose("pinch")?, pose("point")?);
        let skeleton = Skeleton::new(&bind, relaxed.radius_m);
        let poses = [
            *skeleton.bind_rotations(),
            skeleton.retarget(&relaxed.orientation),
            skeleton.retarget(&pinch.orientation),
            skeleton.retarget(&point.orientation),
        ];
        let triangle_parts = parts::part_of_triangles(&mesh);
        let mut hand = Self {
            parts: Vec::new(),
            mesh,
            triangle_parts,
            skeleton,
            poses,
        };
        hand.parts = (0..PART_COUNT)
            .map(|part| hand.cut(part))
            .collect::<Result<_, _>>()?;
        Ok(hand)
    }

    /// Poses of the parts, in the order of `parts`, between two poses of the hand.
    ///
    /// Each joint's rotation relative to its parent takes the shortest arc. `weight` is 0 at `from` and 1 at `to` and is
    /// clamped to that range; a NaN counts as 0.
    #[must_use]
    pub fn blend(&self, from: HandPose, to: HandPose, weight: f64) -> Vec<PartPose> {
        self.part_poses(&self.joints(from, to, weight))
    }

    /// Poses of all 26 joints, in the order of `XrHandJointEXT`, between two poses of the hand, as in [`Hand::blend`].
    ///
    /// The tip joints lie where the model has them, about 12 mm inside the ends of its fingers.
    #[must_use]
    pub fn joints(&self, from: HandPose, to: HandPose, weight: f64) -> [JointPose; JOINT_COUNT] {
        let [from, to] = [from, to].map(|pose| &self.poses[pose as usize]);
        self.skeleton.forward(&skeleton::blend(from, to, weight))
    }

    /// Poses of the parts that are driven by these joints.
    #[must_use]
    pub fn part_poses(&self, joints: &[JointPose; JOINT_COUNT]) -> Vec<PartPose> {
        let pose = |part: &HandPart| PartPose {
            orientation: joints[part.joint].orientation,
            position: joints[part.joint].position,
        };
        self.parts.iter().map(pose).collect()
    }

    /// Positions of the mesh's vertices, in metres, skinned to these joints.
    #[must_use]
    pub fn skinned(&self, joints: &[JointPose; JOINT_COUNT]) -> Vec<DVec3> {
        let bind = self.bind_joints();
        let vertices = self.mesh.positions.iter().zip(&self.mesh.skin);
        vertices
            .map(|(&position, skin)| {
                let moved = |&(joint, weight): &(usize, f64)| {
                    weight * to_wrist(&joints[joint], to_joint(&bind[joint], position))
                };
                skin.iter().map(moved).sum()
            })
            .collect()
    }

    /// Measures the parts against the mesh; one millimetre of spacing takes some seconds.
    pub fn coverage(&self, spacing_m: f64) -> Result<Coverage, HandError> {
        let bind = self.bind_joints();
        let hull = |part: &HandPart| {
            let vertices = part
                .vertices
                .iter()
                .map(|vertex| DVec3::from(vertex.map(f64::from)));
            let points: Vec<DVec3> = vertices
                .map(|vertex| to_wrist(&bind[part.joint], vertex))
                .collect();
            Hull::new(&points)
        };
        self.measure(self.parts.iter().map(hull), spacing_m)
    }

    /// Measures the exact hulls, without the vertex bound: what the cut into parts costs by itself.
    pub fn coverage_of_exact_hulls(&self, spacing_m: f64) -> Result<Coverage, HandError> {
        let hull = |part| hull::enclose(&self.part_points(part), usize::MAX);
        self.measure((0..PART_COUNT).map(hull), spacing_m)
    }

    /// The mesh vertices that a part contains, in metres, in the wrist's frame in the bind pose.
    #[must_use]
    pub fn part_points(&self, part: usize) -> Vec<DVec3> {
        let triangles = self.mesh.triangles.iter().zip(&self.triangle_parts);
        triangles
            .filter(|(_, owner)| **owner == part)
            .flat_map(|(triangle, _)| triangle.map(|vertex| self.mesh.positions[vertex]))
            .collect()
    }

    fn measure(
        &self,
        hulls: impl Iterator<Item = Result<Hull, HandError>>,
        spacing_m: f64,
    ) -> Result<Coverage, HandError> {
        let hulls: Vec<Hull> = hulls.collect::<Result<_, _>>()?;
        coverage::measure(
            &self.mesh.positions,
            &self.mesh.triangles,
            &hulls,
            spacing_m,
        )
    }

    fn bind_joints(&self) -> [JointPose; JOINT_COUNT] {
        self.skeleton.forward(self.skeleton.bind_rotations())
    }

    fn cut(&self, part: usize) -> Result<HandPart, HandError> {
        let (name, driver, _) = parts::PARTS[part];
        let joint = joint_index(driver).ok_or_else(|| HandError::Joint(driver.to_owned()))?;
        let bind = self.bind_joints()[joint];
        let hull = hull::enclose(&self.part_points(part), PART_VERTICES_MAX)?;
        let local = hull.vertices.iter().map(|&vertex| to_joint(&bind, vertex));
        let vertices = local.map(|vertex| vertex.as_vec3().to_array()).collect();
        Ok(HandPart {
            name: name.to_owned(),
            joint,
            vertices,
        })
    }
}

fn to_joint(joint: &JointPose, point: DVec3) -> DVec3 {
    joint.orientation.inverse() * (point - joint.position)
}

fn to_wrist(joint: &JointPose, point: DVec3) -> DVec3 {
    joint.position + joint.orientation * point
}
