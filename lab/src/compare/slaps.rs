//! Slaps at a plate of 20 mm, fingers or palm first: what is left behind it?

use std::sync::Arc;

use glam::{DVec3, Quat, Vec3};
use palpable::math::Pose;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::judging::{Reading, largest, reference_pose};
use super::play::Shot;
use super::scenes::block;
use super::setting::{HandModel, RATE_HZ, Setting, Tracked};
use crate::hand::{Hand, HandPose};

/// Speeds in m/s, in turn.
pub const SPEEDS: [f32; 3] = [5.0, 10.0, 20.0];

/// Half the plate's thickness in metres; its near face is at the origin.
const PLATE_HALF_M: f32 = 0.01;
/// How far before the plate the wrist starts and how far behind it its tracker stops, in metres.
const BEFORE_M: f32 = 0.6;
const BEHIND_M: f32 = 0.5;
/// How long the tracker stays there, in seconds.
const AFTER_S: f32 = 0.5;
/// Largest shift along the plate in metres, and largest turn.
const ASIDE_M: f32 = 0.03;
const TURN_DEG: f32 = 10.0;

/// One slap along -Z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slap {
    /// In m/s.
    pub speed: f32,
    /// The palm goes first; else the fingers.
    pub palm_first: bool,
    /// Share of a frame's way that the start is shifted by.
    pub share: f32,
    /// Where on the plate, in metres.
    pub aside: Vec3,
    /// Turn about +Y, in radians.
    pub turn_rad: f32,
}

/// The first slaps of a seed: every speed with either side first, in turn.
#[must_use]
pub fn slaps(seed: u64, count: usize) -> Vec<Slap> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut draw = |half: f32| random.random_range(-half..half);
    let each = |index: usize| Slap {
        speed: SPEEDS[index % SPEEDS.len()],
        palm_first: index / SPEEDS.len() % 2 == 1,
        share: 0.5 + draw(0.5),
        aside: Vec3::new(draw(ASIDE_M), draw(ASIDE_M), 0.0),
        turn_rad: draw(TURN_DEG.to_radians()),
    };
    (0..count).map(each).collect()
}

impl Slap {
    /// The plate, the hand and its tracker.
    #[must_use]
    pub fn setting(&self, hand: &Hand) -> Setting {
        let plate = block(
            "plate",
            Vec3::NEG_Z * PLATE_HALF_M,
            [1.0, 1.0, PLATE_HALF_M],
        );
        let quarter = std::f32::consts::FRAC_PI_2;
        let first = if self.palm_first { quarter } else { 0.0 };
        let turn = Quat::from_rotation_y(self.turn_rad) * Quat::from_rotation_x(first);
        let moving_s = (BEFORE_M + BEHIND_M) / self.speed;
        let frames = ((moving_s + AFTER_S) * RATE_HZ).ceil() as u32;
        let wrist = |frame: u32| {
            let way = self.speed * (frame as f32 + self.share) / RATE_HZ;
            let ahead = BEFORE_M - way.min(BEFORE_M + BEHIND_M);
            Pose::new(turn, self.aside + Vec3::Z * ahead)
        };
        let model = HandModel::right(hand, HandPose::Flat, HandPose::Relaxed, 0.5);
        Setting {
            fixed: vec![plate],
            loose: Vec::new(),
            hands: vec![Tracked {
                model: Arc::new(model),
                wrist: (0..frames).map(wrist).collect(),
            }],
        }
    }
}

/// What slaps showed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Slapped {
    /// Parts whose middle is behind the middle of the plate at the end.
    pub left_behind: u32,
    /// Parts of which a corner was seen behind the plate in some frame.
    pub seen_behind: u32,
    /// Deepest overlap in any frame, in millimetres.
    pub overlap_mm: f64,
}

impl Slapped {
    /// Reads one slap off what was published.
    #[must_use]
    pub fn of(setting: &Setting, shots: &[Shot], readings: &[Reading]) -> Self {
        let model = &setting.hands[0].model;
        let mut slapped = Self::default();
        for (part, points) in model.points.iter().enumerate() {
            let depths = |shot: &Shot| depths_m(points, &shot.hands[0][part]);
            let last = shots.last().map(|shot| depths(shot).0);
            let far = 2.0 * f64::from(PLATE_HALF_M);
            let left = last.is_some_and(|middle| middle > 0.5 * far);
            let seen = shots.iter().any(|shot| depths(shot).1 > far);
            slapped.left_behind += u32::from(left);
            slapped.seen_behind += u32::from(seen);
        }
        slapped.overlap_mm = largest(readings.iter().map(|reading| reading.hand_fixed_mm));
        slapped
    }

    /// Adds another slap.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            left_behind: self.left_behind + other.left_behind,
            seen_behind: self.seen_behind + other.seen_behind,
            overlap_mm: self.overlap_mm.max(other.overlap_mm),
        }
    }
}

/// How far behind the plate's near face a part's middle and its farthest corner are, in metres.
fn depths_m(points: &[[f32; 3]], pose: &Pose) -> (f64, f64) {
    let pose = reference_pose(pose);
    let depth = |p: &[f32; 3]| {
        let corner = DVec3::from_array(p.map(f64::from));
        -(pose.rotation * corner + pose.position).z
    };
    let middle = points.iter().map(depth).sum::<f64>() / points.len() as f64;
    let farthest = points.iter().map(depth).fold(f64::NEG_INFINITY, f64::max);
    (middle, farthest)
}
