//! What the tracker sees: the hand's way through the paper's phases, scripted.
//!
//! Idle motion, slide over the table one way, slide back, push the ball over the table: 3653 frames at
//! 60 Hz. The wrist goes between key frames on a smooth step; the fingers blend between poses.

use glam::{DQuat, DVec3};
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;

use crate::hand::HandPose;

/// Frames of the whole script.
pub const FRAMES: u32 = 3653;

/// Frames a second.
pub const RATE_HZ: f64 = 60.0;

/// Standard deviation of the tracker's position noise, in metres.
pub const NOISE_M: f64 = 0.2e-3;

/// Standard deviation of the tracker's orientation noise, in radians.
pub const NOISE_RAD: f64 = 0.1 * std::f64::consts::PI / 180.0;

/// Names and first frames of the phases.
pub const PHASES: [(&str, u32); 4] = [
    ("idle", 0),
    ("slide over the table", 600),
    ("slide back", 1500),
    ("push the ball", 2400),
];

/// What the tracker sees in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandTarget {
    /// Orientation of the wrist.
    pub orientation: DQuat,
    /// Position of the wrist in metres.
    pub position: DVec3,
    /// The pose that the fingers come from, the one they go to, and how far they are.
    pub from: HandPose,
    /// See `from`.
    pub to: HandPose,
    /// See `from`; 0 to 1.
    pub weight: f64,
    /// Nothing is within reach: the published hand must be exactly here.
    pub free: bool,
    /// The tracker has not moved for long enough that a hand in contact must be at rest.
    pub resting: bool,
}

/// A key frame: frame, wrist position, turn about +Y in degrees, and finger pose.
type Key = (u32, [f64; 3], f64, HandPose);

use HandPose::{Flat, Pinch, Point, Relaxed};

/// The palm is pressed this far below where it would touch, by these heights over the top of 0.75 m.
const KEYS: &[Key] = &[
    (0, [0.0, 1.15, -0.05], 0.0, Relaxed),
    (120, [0.15, 1.25, -0.1], 20.0, Point),
    (240, [-0.1, 1.3, -0.05], -15.0, Relaxed),
    (360, [0.05, 1.2, 0.05], 10.0, Pinch),
    (480, [-0.1, 1.15, -0.1], 0.0, Flat),
    (600, [-0.4, 1.0, -0.2], 0.0, Flat),
    (700, [-0.5, 0.83, -0.2], 0.0, Flat),
    (780, [-0.5, 0.735, -0.2], 0.0, Flat),
    (1000, [-0.1, 0.73, -0.22], 10.0, Relaxed),
    (1150, [0.15, 0.74, -0.18], -10.0, Flat),
    (1350, [0.5, 0.735, -0.2], 0.0, Relaxed),
    (1500, [0.5, 0.735, -0.2], 0.0, Relaxed),
    (1700, [0.15, 0.72, -0.2], 15.0, Point),
    (1900, [-0.15, 0.74, -0.22], -15.0, Relaxed),
    (2150, [-0.5, 0.735, -0.2], 0.0, Flat),
    (2300, [-0.5, 0.735, -0.2], 0.0, Flat),
    (2400, [-0.6, 1.0, -0.4], -45.0, Relaxed),
    (2520, [-0.65, 0.84, -0.72], -90.0, Relaxed),
    (2580, [-0.6, 0.81, -0.72], -90.0, Relaxed),
    (2800, [0.4, 0.81, -0.72], -90.0, Relaxed),
    (2900, [0.4, 0.81, -0.72], -90.0, Relaxed),
    (3000, [0.3, 1.15, -0.5], -45.0, Flat),
    (3150, [0.0, 1.2, -0.1], 0.0, Point),
    (3300, [0.1, 1.25, 0.0], 10.0, Relaxed),
    (3652, [0.0, 1.15, -0.05], 0.0, Relaxed),
];

/// Frames in which nothing is within reach of the hand.
const FREE: [(u32, u32); 2] = [(0, 600), (3150, 3653)];

/// Frames in which a still tracker has kept the hand in contact for at least half a second.
const RESTING: [(u32, u32); 2] = [(1385, 1500), (2185, 2300)];

/// The script with or without tracker noise.
pub struct Script {
    noise: Option<Pcg64Mcg>,
}

impl Script {
    /// A script; with a seed, the tracker is noisy.
    #[must_use]
    pub fn new(noise_seed: Option<u64>) -> Self {
        Self {
            noise: noise_seed.map(Pcg64Mcg::seed_from_u64),
        }
    }

    /// What the tracker sees in a frame. Noise is drawn anew with every call.
    pub fn target(&mut self, frame: u32) -> HandTarget {
        let mut target = clean(frame);
        if let Some(noise) = &mut self.noise {
            target.position += NOISE_M * normal(noise);
            let turn = DQuat::from_scaled_axis(NOISE_RAD * normal(noise));
            target.orientation = (turn * target.orientation).normalize();
            target.resting = false;
        }
        target
    }
}

fn normal(noise: &mut Pcg64Mcg) -> DVec3 {
    let mut draw = || noise.sample::<f64, _>(StandardNormal);
    DVec3::new(draw(), draw(), draw())
}

fn clean(frame: u32) -> HandTarget {
    let next = KEYS
        .iter()
        .position(|key| key.0 > frame)
        .unwrap_or(KEYS.len() - 1);
    let (from, to) = (KEYS[next - 1], KEYS[next]);
    let share = f64::from(frame.min(to.0) - from.0) / f64::from(to.0 - from.0);
    let eased = share * share * (3.0 - 2.0 * share);
    let turn = from.2 + (to.2 - from.2) * eased;
    let within = |ranges: &[(u32, u32)]| ranges.iter().any(|r| (r.0..r.1).contains(&frame));
    HandTarget {
        orientation: DQuat::from_rotation_y(turn.to_radians()),
        position: DVec3::from(from.1).lerp(DVec3::from(to.1), eased),
        from: from.3,
        to: to.3,
        weight: eased,
        free: within(&FREE),
        resting: within(&RESTING),
    }
}
