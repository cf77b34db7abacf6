//! What a scene consists of, before any engine sees it: fixed and loose things, hands, and what their
//! trackers see in every frame.

use std::sync::Arc;

use glam::Vec3;
use palpable::human::{mirrored_point, mirrored_pose};
use palpable::math::Pose;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::gallery::SceneryObject;
use crate::hand::{Hand, HandPose};

/// Frames a second.
pub const RATE_HZ: f32 = 90.0;

/// Coulomb's coefficient of loose things against everything, and in the peer of everything.
pub const FRICTION: f32 = 0.5;

/// Mass of a hand in kg, and the stiffness that pulls it to its tracker in N/m: those of the kernel's
/// default coupling, so that both engines press equally hard.
pub const HAND_MASS_KG: f32 = palpable::state::bodies::Coupling::DEFAULT.mass_kg;
/// See [`HAND_MASS_KG`].
pub const HAND_STIFFNESS_N_PER_M: f32 =
    palpable::state::bodies::Coupling::DEFAULT.stiffness_n_per_m;

/// A rigid hand: convex parts in the wrist's frame.
#[derive(Clone, Debug)]
pub struct HandModel {
    /// What the parts are.
    pub names: Vec<String>,
    /// Points of each part in its own frame, in metres.
    pub points: Vec<Vec<[f32; 3]>>,
    /// Each part's pose in the wrist's frame.
    pub locals: Vec<Pose>,
}

impl HandModel {
    /// The right hand of the lab, between two of its poses.
    #[must_use]
    pub fn right(hand: &Hand, from: HandPose, to: HandPose, weight: f64) -> Self {
        let places = hand.blend(from, to, weight);
        Self {
            names: hand.parts.iter().map(|part| part.name.clone()).collect(),
            points: hand.parts.iter().map(|p| p.vertices.clone()).collect(),
            locals: places
                .iter()
                .map(|place| Pose {
                    rotation: place.orientation.as_quat().to_array(),
                    position: place.position.as_vec3().to_array(),
                })
                .collect(),
        }
    }

    /// The same hand of the other side.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let mirror = |p: &[f32; 3]| mirrored_point(Vec3::from_array(*p)).to_array();
        Self {
            names: self.names.clone(),
            points: self
                .points
                .iter()
                .map(|part| part.iter().map(mirror).collect())
                .collect(),
            locals: self.locals.iter().map(mirrored_pose).collect(),
        }
    }

    /// How far the hand with its wrist at `wrist` goes along a direction from the origin, in metres.
    #[must_use]
    pub fn reach_m(&self, wrist: &Pose, along: Vec3) -> f32 {
        let parts = self.points.iter().zip(&self.locals);
        let points = parts.flat_map(|(points, local)| {
            let at = wrist.then(local);
            points
                .iter()
                .map(move |&p| at.point(Vec3::from_array(p)).dot(along))
        });
        points.fold(f32::NEG_INFINITY, f32::max)
    }
}

/// Something that never moves.
#[derive(Clone, Debug)]
pub struct Fixed {
    /// Its shape and place.
    pub object: SceneryObject,
    /// The frame before which it is taken away.
    pub until: Option<u32>,
}

/// Shape of a loose thing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LooseShape {
    /// A sphere of this radius in metres.
    Sphere(f32),
    /// A box of these half extents in metres.
    Box([f32; 3]),
}

impl LooseShape {
    /// Volume in m3.
    #[must_use]
    pub fn volume_m3(self) -> f32 {
        match self {
            Self::Sphere(r) => 4.0 / 3.0 * std::f32::consts::PI * r * r * r,
            Self::Box([x, y, z]) => 8.0 * x * y * z,
        }
    }

    /// Points whose hull, rounded by the radius, is the shape.
    #[must_use]
    pub fn points(self) -> (Vec<[f32; 3]>, f32) {
        match self {
            Self::Sphere(radius) => (vec![[0.0; 3]], radius),
            Self::Box(half) => (corners(half), 0.0),
        }
    }
}

/// Something that falls and is pushed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loose {
    /// Its shape.
    pub shape: LooseShape,
    /// Its mass in kg.
    pub mass_kg: f32,
    /// Where it is at first.
    pub pose: Pose,
}

/// A hand and what its tracker sees.
#[derive(Clone, Debug)]
pub struct Tracked {
    /// The hand.
    pub model: Arc<HandModel>,
    /// The wrist's pose in every frame; the hand starts at the first one.
    pub wrist: Vec<Pose>,
}

/// A scene for any engine.
#[derive(Clone, Debug)]
pub struct Setting {
    /// Fixed things.
    pub fixed: Vec<Fixed>,
    /// Loose things.
    pub loose: Vec<Loose>,
    /// Hands; all are tracked for equally many frames.
    pub hands: Vec<Tracked>,
}

impl Setting {
    /// Frames to play.
    #[must_use]
    pub fn frames(&self) -> u32 {
        self.hands.first().map_or(0, |hand| hand.wrist.len() as u32)
    }
}

/// What makes one tracker of a scene another than the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Perturbation {
    /// Shift of the start, in metres.
    pub offset: Vec3,
    /// Turn about +Y, in radians.
    pub heading_rad: f32,
    /// For whatever a scene varies of its own, 0 to 1.
    pub share: f32,
}

impl Perturbation {
    /// The tracker as the scene describes it.
    pub const NONE: Self = Self {
        offset: Vec3::ZERO,
        heading_rad: 0.0,
        share: 0.5,
    };
}

/// Largest shift along each axis, in metres.
const OFFSET_M: f32 = 0.003;
/// Largest turn.
const HEADING_DEG: f32 = 3.0;

/// Perturbations of a seed.
#[must_use]
pub fn perturbations(seed: u64, count: usize) -> Vec<Perturbation> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut draw = |half: f32| random.random_range(-half..half);
    let each = |_| Perturbation {
        offset: Vec3::from_array([(); 3].map(|()| draw(OFFSET_M))),
        heading_rad: draw(HEADING_DEG.to_radians()),
        share: 0.5 + draw(0.5),
    };
    (0..count).map(each).collect()
}

/// Corners of a box.
#[must_use]
pub fn corners([x, y, z]: [f32; 3]) -> Vec<[f32; 3]> {
    let sign = |corner: u8, bit: u8| if corner >> bit & 1 == 0 { -1.0 } else { 1.0 };
    (0..8)
        .map(|c| [sign(c, 0) * x, sign(c, 1) * y, sign(c, 2) * z])
        .collect()
}
