//! Arm slaps: the right arm swings at hand speeds of 5 to 20 m/s at a plate of 20 mm.

use glam::{Mat3, Quat, Vec3};
use palpable::human::balls_of;
use palpable::math::Pose;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::motions::{Obstacle, RATE_HZ};
use super::track::{MOTION_HEIGHT_M, shoulder_swing};
use super::{AvatarPlan, Style, Target, Trunk};
use palpable::human::Limb;

/// Slaps of one seed.
pub const SLAP_COUNT: usize = 200;

/// Half extents of the plate, in metres; its first axis is its normal.
const PLATE_HALF_M: [f32; 3] = [0.01, 0.15, 0.15];

/// Frames before the arm moves.
const LEAD_FRAMES: u32 = 5;

/// Frames after it has stopped.
const REST_FRAMES: u32 = 10;

/// The whole swing, in radians; the plate is in its middle.
const SWING_RAD: std::ops::Range<f32> = 1.3..1.9;

/// Room that the plate keeps from the body's middle line and from the other arm's, in metres.
const ROOM_M: [f32; 2] = [0.45, 0.30];

/// Half of the step over which the hand's speed is measured, in radians.
const STEP_RAD: f32 = 0.01;

/// One slap. The arm's speed is not bounded by [`super::motions::JOINT_SPEED_MAX`].
#[derive(Clone, Debug, PartialEq)]
pub struct ArmSlap {
    /// Speed of the hand's middle when it meets the plate, in m/s.
    pub speed: f32,
    /// The plate; its +X axis is the way the hand comes.
    pub plate: Obstacle,
    /// Frames of the motion.
    pub frames: u32,
    start: Vec3,
    axis: Vec3,
    swing_rad: f32,
    rate_rad_s: f32,
    elbow_rad: f32,
    neutral: Target,
}

impl ArmSlap {
    /// Root and angles at a frame: still, then an even swing, then still.
    #[must_use]
    pub fn target(&self, frame: u32) -> Target {
        self.target_at(frame as f32 / RATE_HZ)
    }

    /// Root and angles at a time in seconds after frame 0.
    #[must_use]
    pub fn target_at(&self, time_s: f32) -> Target {
        let moving_s = (time_s - LEAD_FRAMES as f32 / RATE_HZ).max(0.0);
        self.after((self.rate_rad_s * moving_s).min(self.swing_rad))
    }

    /// When the hand's middle meets the plate's, in seconds after frame 0.
    #[must_use]
    pub fn meeting_s(&self) -> f32 {
        LEAD_FRAMES as f32 / RATE_HZ + 0.5 * self.swing_rad / self.rate_rad_s
    }

    fn after(&self, turned_rad: f32) -> Target {
        let limb = Quat::from_axis_angle(self.axis, turned_rad) * self.start;
        let mut target = self.neutral.clone();
        let [a, b] = shoulder_swing(limb);
        target.angles[RIGHT_ARM][..2].copy_from_slice(&[a, b]);
        target.angles[RIGHT_ARM][3] = self.elbow_rad;
        target
    }
}

/// Index of the right arm's chain in a plan with a rigid trunk.
const RIGHT_ARM: usize = 2;

/// [`SLAP_COUNT`] slaps of a seed for [`Trunk::Rigid`] and [`MOTION_HEIGHT_M`]. Each starts free of its
/// plate and would end behind it; the whole way lies in the shoulder's cone.
#[must_use]
pub fn slaps(seed: u64) -> Vec<ArmSlap> {
    let plan = AvatarPlan::new(MOTION_HEIGHT_M, Style::Hulls, Trunk::Rigid);
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut found = Vec::new();
    while found.len() < SLAP_COUNT {
        found.extend(attempt(&plan, &mut random));
    }
    found
}

fn attempt(plan: &AvatarPlan, random: &mut Pcg64Mcg) -> Option<ArmSlap> {
    let speed = random.random_range(5.0..20.0);
    let swing_rad = random.random_range(SWING_RAD);
    let elbow_rad = random.random_range(0.0..0.6);
    let (start, other) = (direction(random), direction(random));
    let axis = start.cross(other).try_normalize()?;
    let mut slap = ArmSlap {
        speed,
        plate: Obstacle {
            pose: Pose::IDENTITY,
            half_m: PLATE_HALF_M,
        },
        frames: 0,
        start,
        axis,
        swing_rad,
        rate_rad_s: 1.0,
        elbow_rad,
        neutral: plan.neutral(),
    };
    if !is_allowed(plan, &slap) {
        return None;
    }
    let hand = |turned_rad| middle_of_hand(plan, &slap.after(turned_rad));
    let half = 0.5 * swing_rad;
    let at = hand(half)?;
    let metres_a_rad = (hand(half + STEP_RAD)? - hand(half - STEP_RAD)?) / (2.0 * STEP_RAD);
    let way = metres_a_rad.try_normalize()?;
    let side = axis.cross(way).try_normalize()?;
    let frame = Mat3::from_cols(way, side, way.cross(side));
    slap.plate.pose = Pose::new(Quat::from_mat3(&frame), at);
    slap.rate_rad_s = speed / metres_a_rad.length();
    let moving = (swing_rad / slap.rate_rad_s * RATE_HZ).ceil() as u32;
    slap.frames = LEAD_FRAMES + moving + REST_FRAMES;
    has_room(plan, &slap, at).then_some(slap)
}

fn direction(random: &mut Pcg64Mcg) -> Vec3 {
    let height: f32 = random.random_range(-1.0..1.0);
    let turn: f32 = random.random_range(0.0..std::f32::consts::TAU);
    let across = (1.0 - height * height).sqrt();
    Vec3::new(across * turn.cos(), height, across * turn.sin())
}

/// Whether the whole swing lies within the shoulder's cone.
fn is_allowed(plan: &AvatarPlan, slap: &ArmSlap) -> bool {
    let ball = balls_of(&plan.chains[RIGHT_ARM].joints)[0];
    (0..=32).all(|step| {
        let target = slap.after(slap.swing_rad * step as f32 / 32.0);
        let [a, b] = [0, 1].map(|hinge| target.angles[RIGHT_ARM][hinge]);
        ball.cone.contains(palpable::geometry::chain::limb_at(a, b))
    })
}

fn middle_of_hand(plan: &AvatarPlan, target: &Target) -> Option<Vec3> {
    let hand = plan
        .pieces
        .iter()
        .position(|piece| piece.name == "right hand")?;
    Some(plan.piece_poses(target)[hand].translation())
}

/// Whether the plate keeps away from the rest of the body, the arm starts before it and the hand ends
/// behind it.
fn has_room(plan: &AvatarPlan, slap: &ArmSlap, hand: Vec3) -> bool {
    let left = plan.tip(Limb::LeftArm, &slap.neutral).unwrap_or_default();
    let aside_m = |line: Vec3| Vec3::new(hand.x - line.x, 0.0, hand.z - line.z).length();
    if aside_m(Vec3::ZERO) < ROOM_M[0] || aside_m(left) < ROOM_M[1] {
        return false;
    }
    let ahead = |point: Vec3| {
        let inside = slap.plate.pose.quat().conjugate() * (point - hand);
        let beside = inside.y.abs().max(inside.z.abs()) > PLATE_HALF_M[1] + 0.05;
        (inside.x, beside)
    };
    let start = slap.after(0.0);
    let poses = plan.piece_poses(&start);
    let starts_free = plan.pieces.iter().zip(&poses).all(|(piece, pose)| {
        piece.points.iter().all(|&point| {
            let (x, beside) = ahead(pose.point(point.into()));
            x < -0.05 || beside
        })
    });
    let end = middle_of_hand(plan, &slap.after(slap.swing_rad));
    starts_free && end.is_some_and(|end| ahead(end).0 > 0.1)
}
