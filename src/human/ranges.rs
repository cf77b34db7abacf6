//! How far human joints go, in degrees, and where the numbers come from.
//!
//! Zero is the neutral zero position of the American Academy of Orthopaedic Surgeons except where a
//! row says otherwise: standing, arms hanging, legs straight, feet at right angles, fingers straight.
//!
//! Sources by group:
//! * arms, legs, neck, trunk, fingers, thumb's phalanges: American Academy of Orthopaedic Surgeons 1965,
//!   "Joint Motion: Method of Measuring and Recording", as quoted in the tables of Norkin and White,
//!   "Measurement of Joint Motion". Only those quotations were at hand;
//! * base of the thumb: Cooney, Lucca, Chao and Linscheid 1981, "The kinesiology of the thumb
//!   trapeziometacarpal joint": 53 degrees of flexion and extension, 42 of abduction and adduction, 17 of
//!   axial rotation in all. Where they lie relative to a straight hand is not said; here they are halved.
//!
//! These are means of healthy adults. A supple person goes further.

/// The range of one motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointLimits {
    /// The motion, named after its positive direction.
    pub motion: &'static str,
    /// Least angle in degrees.
    pub low_deg: f32,
    /// Largest angle in degrees.
    pub high_deg: f32,
}

impl JointLimits {
    const fn new(motion: &'static str, low_deg: f32, high_deg: f32) -> Self {
        Self {
            motion,
            low_deg,
            high_deg,
        }
    }

    /// Least angle in radians.
    #[must_use]
    pub const fn low_rad(&self) -> f32 {
        self.low_deg.to_radians()
    }

    /// Largest angle in radians.
    #[must_use]
    pub const fn high_rad(&self) -> f32 {
        self.high_deg.to_radians()
    }
}

/// Extension 60, flexion 180.
pub const SHOULDER_FLEXION: JointLimits = JointLimits::new("shoulder flexion", -60.0, 180.0);
/// Adduction 45 in front of the body, abduction 180.
pub const SHOULDER_ABDUCTION: JointLimits = JointLimits::new("shoulder abduction", -45.0, 180.0);
/// In the horizontal plane from straight sideways. Handbooks quote 30 to 45 backward and 130 to 135
/// forward; the lower numbers are used, so that the swing's poles lie outside the cone.
pub const SHOULDER_HORIZONTAL: JointLimits =
    JointLimits::new("shoulder horizontal flexion", -30.0, 130.0);
/// Medial 70, lateral 90.
pub const SHOULDER_ROTATION: JointLimits =
    JointLimits::new("shoulder lateral rotation", -70.0, 90.0);
/// Flexion 150.
pub const ELBOW_FLEXION: JointLimits = JointLimits::new("elbow flexion", 0.0, 150.0);
/// Supination 80, pronation 80, from the thumb pointing forward.
pub const FOREARM_PRONATION: JointLimits = JointLimits::new("forearm pronation", -80.0, 80.0);
/// Extension 70, flexion 80.
pub const WRIST_FLEXION: JointLimits = JointLimits::new("wrist flexion", -70.0, 80.0);
/// Ulnar deviation 30, radial deviation 20.
pub const WRIST_RADIAL: JointLimits = JointLimits::new("wrist radial deviation", -30.0, 20.0);

/// Extension 30, flexion 120.
pub const HIP_FLEXION: JointLimits = JointLimits::new("hip flexion", -30.0, 120.0);
/// Adduction 30, abduction 45.
pub const HIP_ABDUCTION: JointLimits = JointLimits::new("hip abduction", -30.0, 45.0);
/// Medial 45, lateral 45.
pub const HIP_ROTATION: JointLimits = JointLimits::new("hip lateral rotation", -45.0, 45.0);
/// Flexion 135.
pub const KNEE_FLEXION: JointLimits = JointLimits::new("knee flexion", 0.0, 135.0);
/// Plantar flexion 50, dorsiflexion 20.
pub const ANKLE_DORSIFLEXION: JointLimits = JointLimits::new("ankle dorsiflexion", -50.0, 20.0);
/// Eversion 15, inversion 35.
pub const FOOT_INVERSION: JointLimits = JointLimits::new("foot inversion", -15.0, 35.0);

/// Extension 45, flexion 45.
pub const NECK_FLEXION: JointLimits = JointLimits::new("neck flexion", -45.0, 45.0);
/// 45 to each side.
pub const NECK_LATERAL: JointLimits = JointLimits::new("neck lateral flexion", -45.0, 45.0);
/// 60 to each side.
pub const NECK_ROTATION: JointLimits = JointLimits::new("neck rotation", -60.0, 60.0);
/// Extension 25 (the source says 20 to 30), flexion 80.
pub const SPINE_FLEXION: JointLimits = JointLimits::new("trunk flexion", -25.0, 80.0);
/// 35 to each side.
pub const SPINE_LATERAL: JointLimits = JointLimits::new("trunk lateral flexion", -35.0, 35.0);
/// 45 to each side.
pub const SPINE_ROTATION: JointLimits = JointLimits::new("trunk rotation", -45.0, 45.0);

/// 20 to each side.
pub const KNUCKLE_SPREAD: JointLimits = JointLimits::new("knuckle spread", -20.0, 20.0);
/// Hyperextension 45, flexion 90.
pub const KNUCKLE_FLEXION: JointLimits = JointLimits::new("knuckle flexion", -45.0, 90.0);
/// Middle joint of a finger: flexion 100.
pub const MIDDLE_FLEXION: JointLimits = JointLimits::new("middle flexion", 0.0, 100.0);
/// Last joint of a finger: flexion 90.
pub const LAST_FLEXION: JointLimits = JointLimits::new("last flexion", 0.0, 90.0);

/// Half of 53 each way from the rest pose.
pub const THUMB_BASE_FLEXION: JointLimits = JointLimits::new("thumb flexion", -26.5, 26.5);
/// Half of 42 each way from the rest pose.
pub const THUMB_BASE_ABDUCTION: JointLimits = JointLimits::new("thumb abduction", -21.0, 21.0);
/// Half of 17 each way from the rest pose.
pub const THUMB_BASE_ROTATION: JointLimits = JointLimits::new("thumb rotation", -8.5, 8.5);
/// Thumb's knuckle: flexion 50.
pub const THUMB_KNUCKLE_FLEXION: JointLimits = JointLimits::new("thumb knuckle flexion", 0.0, 50.0);
/// Thumb's last joint: hyperextension 20, flexion 80.
pub const THUMB_LAST_FLEXION: JointLimits = JointLimits::new("thumb last flexion", -20.0, 80.0);

/// Every row.
pub const TABLE: [JointLimits; 29] = [
    SHOULDER_FLEXION,
    SHOULDER_ABDUCTION,
    SHOULDER_HORIZONTAL,
    SHOULDER_ROTATION,
    ELBOW_FLEXION,
    FOREARM_PRONATION,
    WRIST_FLEXION,
    WRIST_RADIAL,
    HIP_FLEXION,
    HIP_ABDUCTION,
    HIP_ROTATION,
    KNEE_FLEXION,
    ANKLE_DORSIFLEXION,
    FOOT_INVERSION,
    NECK_FLEXION,
    NECK_LATERAL,
    NECK_ROTATION,
    SPINE_FLEXION,
    SPINE_LATERAL,
    SPINE_ROTATION,
    KNUCKLE_SPREAD,
    KNUCKLE_FLEXION,
    MIDDLE_FLEXION,
    LAST_FLEXION,
    THUMB_BASE_FLEXION,
    THUMB_BASE_ABDUCTION,
    THUMB_BASE_ROTATION,
    THUMB_KNUCKLE_FLEXION,
    THUMB_LAST_FLEXION,
];
