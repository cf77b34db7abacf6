//! A convex piece: the hull of points plus a rounding radius, and a piece at a pose.

use super::hull::{self, Boundary, Edge, Face};
use glam::{DMat3, DQuat, DVec3};

/// Why a solid was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SolidError {
    /// There were no points.
    Empty,
    /// A coordinate or the radius is infinite or not a number.
    NotFinite,
    /// The radius is negative.
    NegativeRadius,
}

impl std::fmt::Display for SolidError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Empty => "a solid needs at least one point",
            Self::NotFinite => "a coordinate or the radius is not finite",
            Self::NegativeRadius => "the radius is negative",
        })
    }
}

impl std::error::Error for SolidError {}

const LANES: usize = 4;
type Block = [[f64; LANES]; 3];

/// The convex hull of points (the core) plus a rounding radius, in its own frame, in metres.
///
/// One point with a radius is a sphere, two are a capsule. Points may repeat and may lie on common
/// lines and planes.
#[derive(Clone, Debug)]
pub struct Solid {
    boundary: Boundary,
    blocks: Vec<Block>,
    radius: f64,
    centre: DVec3,
    reach: f64,
    inner: f64,
    low: DVec3,
    high: DVec3,
}

impl Solid {
    /// Builds the hull of `points` in metres, rounded by `radius` in metres.
    ///
    /// The cost is about `n * n` plane tests for `n` points.
    pub fn new(points: &[DVec3], radius: f64) -> Result<Self, SolidError> {
        if points.is_empty() {
            return Err(SolidError::Empty);
        }
        if !radius.is_finite() || !points.iter().all(|p| p.is_finite()) {
            return Err(SolidError::NotFinite);
        }
        if radius < 0.0 {
            return Err(SolidError::NegativeRadius);
        }
        Ok(Self::from_boundary(hull::boundary(points), radius))
    }

    /// Builds the hull of `points` as the kernel stores them: f32, in metres.
    pub fn from_f32(points: &[[f32; 3]], radius: f32) -> Result<Self, SolidError> {
        let points: Vec<DVec3> = points
            .iter()
            .map(|p| DVec3::from_array(p.map(f64::from)))
            .collect();
        Self::new(&points, f64::from(radius))
    }

    fn from_boundary(boundary: Boundary, radius: f64) -> Self {
        let vertices = &boundary.vertices;
        let low = vertices.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = vertices
            .iter()
            .copied()
            .fold(DVec3::NEG_INFINITY, DVec3::max);
        let centre = vertices.iter().sum::<DVec3>() / vertices.len() as f64;
        let reach = vertices
            .iter()
            .map(|&v| (v - centre).length())
            .fold(0.0, f64::max);
        let inner = boundary
            .faces
            .iter()
            .map(|f| f.offset - f.normal.dot(centre));
        let inner = inner.reduce(f64::min).unwrap_or(0.0).max(0.0);
        let blocks = blocks(vertices);
        Self {
            boundary,
            blocks,
            radius,
            centre,
            reach,
            inner,
            low,
            high,
        }
    }

    /// The core's vertices, in metres.
    pub fn vertices(&self) -> &[DVec3] {
        &self.boundary.vertices
    }

    /// The core's faces, coplanar triangles merged. A segment and a point have none.
    pub fn faces(&self) -> &[Face] {
        &self.boundary.faces
    }

    /// The core's edges between different planes.
    pub fn edges(&self) -> &[Edge] {
        &self.boundary.edges
    }

    /// The core's boundary as counter-clockwise triangles of vertex indices; a flat core has one side.
    pub fn triangles(&self) -> &[[usize; 3]] {
        &self.boundary.triangles
    }

    /// The rounding radius, in metres.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The length of the core's box diagonal, in metres.
    pub fn size(&self) -> f64 {
        (self.high - self.low).length()
    }

    /// The mean of the core's vertices.
    pub(super) fn centre(&self) -> DVec3 {
        self.centre
    }

    /// The core lies in a ball of this radius about the centre.
    pub(super) fn reach(&self) -> f64 {
        self.reach
    }

    /// The core contains a ball of this radius about the centre.
    pub(super) fn inner(&self) -> f64 {
        self.inner
    }

    /// The vertex farthest along `direction`.
    pub(super) fn support(&self, direction: DVec3) -> DVec3 {
        let mut best = [f64::NEG_INFINITY; LANES];
        let mut at = [0_u64; LANES];
        for (index, [x, y, z]) in self.blocks.iter().enumerate() {
            for lane in 0..LANES {
                let dot = x[lane] * direction.x + y[lane] * direction.y + z[lane] * direction.z;
                let better = dot > best[lane];
                best[lane] = if better { dot } else { best[lane] };
                at[lane] = if better { index as u64 } else { at[lane] };
            }
        }
        let lane = (1..LANES).fold(0, |l, other| if best[other] > best[l] { other } else { l });
        let block = &self.blocks[at[lane] as usize];
        DVec3::new(block[0][lane], block[1][lane], block[2][lane])
    }
}

fn blocks(vertices: &[DVec3]) -> Vec<Block> {
    vertices
        .chunks(LANES)
        .map(|chunk| {
            let lane = |i: usize| chunk[i.min(chunk.len() - 1)];
            [0, 1, 2].map(|axis| std::array::from_fn(|i| lane(i)[axis]))
        })
        .collect()
}

/// A pose: first rotate, then translate.
#[derive(Clone, Copy, Debug)]
pub struct Pose {
    /// Of length one.
    pub rotation: DQuat,
    /// In metres.
    pub position: DVec3,
}

impl Pose {
    /// No rotation, no translation.
    pub const IDENTITY: Self = Self {
        rotation: DQuat::IDENTITY,
        position: DVec3::ZERO,
    };

    /// A pose with its rotation normalised.
    ///
    /// # Panics
    /// If the rotation has no length or a component is not finite.
    pub fn new(rotation: DQuat, position: DVec3) -> Self {
        let length = rotation.length();
        assert!(
            length.is_finite() && length > 0.0,
            "the rotation has no direction"
        );
        assert!(position.is_finite(), "the position is not finite");
        Self {
            rotation: rotation / length,
            position,
        }
    }

    /// A pose from the kernel's f32 quaternion `x y z w` and position, normalised in f64.
    ///
    /// # Panics
    /// As [`Pose::new`].
    pub fn from_f32(rotation_xyzw: [f32; 4], position: [f32; 3]) -> Self {
        Self::new(
            DQuat::from_array(rotation_xyzw.map(f64::from)),
            DVec3::from_array(position.map(f64::from)),
        )
    }
}

/// A solid at a pose.
#[derive(Clone, Copy, Debug)]
pub struct Placed<'a> {
    solid: &'a Solid,
    rotation: DMat3,
    position: DVec3,
}

impl<'a> Placed<'a> {
    /// Puts `solid` at a pose; the rotation is normalised.
    ///
    /// # Panics
    /// If the rotation has no length or a component is not finite.
    pub fn new(solid: &'a Solid, rotation: DQuat, position: DVec3) -> Self {
        let pose = Pose::new(rotation, position);
        Self {
            solid,
            rotation: DMat3::from_quat(pose.rotation),
            position: pose.position,
        }
    }

    /// Puts `solid` at `pose`.
    pub fn at(solid: &'a Solid, pose: Pose) -> Self {
        Self::new(solid, pose.rotation, pose.position)
    }

    /// Puts `solid` at a pose whose rotation is known to be one.
    pub(crate) fn turned(solid: &'a Solid, rotation: DMat3, position: DVec3) -> Self {
        Self {
            solid,
            rotation,
            position,
        }
    }

    /// The same, moved by `translation` in metres.
    pub fn moved(self, translation: DVec3) -> Self {
        Self {
            position: self.position + translation,
            ..self
        }
    }

    /// The solid.
    pub fn solid(&self) -> &'a Solid {
        self.solid
    }

    /// The rotation from the solid's frame to the world.
    pub fn rotation(&self) -> DMat3 {
        self.rotation
    }

    /// The solid's origin in the world, in metres.
    pub fn position(&self) -> DVec3 {
        self.position
    }

    /// A box that contains the rounded solid: its low and high corners in the world, in metres.
    pub fn bounds(&self) -> [DVec3; 2] {
        let middle = 0.5 * (self.solid.low + self.solid.high);
        let half = 0.5 * (self.solid.high - self.solid.low);
        let spread = self.rotation.x_axis.abs() * half.x
            + self.rotation.y_axis.abs() * half.y
            + self.rotation.z_axis.abs() * half.z
            + DVec3::splat(self.solid.radius);
        let middle = self.rotation * middle + self.position;
        [middle - spread, middle + spread]
    }

    pub(super) fn world_centre(&self) -> DVec3 {
        self.rotation * self.solid.centre + self.position
    }
}
