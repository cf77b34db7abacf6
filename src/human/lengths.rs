//! Lengths and heights of a standing body as fractions of its height.
//!
//! Drillis and Contini 1966, "Body Segment Parameters", as drawn in Winter, "Biomechanics and Motor
//! Control of Human Movement", figure 4.1; the drawing was read through works that quote it. Rows that
//! are our own choice say so.

/// Height of the ankles.
pub const ANKLE_HEIGHT: f32 = 0.039;
/// Height of the knees.
pub const KNEE_HEIGHT: f32 = 0.285;
/// Height of the hip joints.
pub const HIP_HEIGHT: f32 = 0.530;
/// Height of the shoulders.
pub const SHOULDER_HEIGHT: f32 = 0.818;
/// Height of the chin.
pub const CHIN_HEIGHT: f32 = 0.870;

/// Shoulder to elbow.
pub const UPPER_ARM: f32 = 0.186;
/// Elbow to wrist.
pub const FOREARM: f32 = 0.146;
/// Wrist to the tip of the longest finger.
pub const HAND: f32 = 0.108;
/// Hip to knee.
pub const THIGH: f32 = HIP_HEIGHT - KNEE_HEIGHT;
/// Knee to ankle.
pub const SHANK: f32 = KNEE_HEIGHT - ANKLE_HEIGHT;
/// Heel to toes.
pub const FOOT_LENGTH: f32 = 0.152;
/// Breadth of a foot.
pub const FOOT_BREADTH: f32 = 0.055;
/// Hips to shoulders.
pub const TRUNK: f32 = SHOULDER_HEIGHT - HIP_HEIGHT;
/// Shoulders to the top of the head.
pub const HEAD_AND_NECK: f32 = 1.0 - SHOULDER_HEIGHT;
/// Breadth of the shoulders.
pub const SHOULDER_BREADTH: f32 = 0.259;
/// Breadth of the hips.
pub const HIP_BREADTH: f32 = 0.191;

/// Midline to shoulder joint: half the breadth, as stick figures after the source have it.
pub const SHOULDER_ASIDE: f32 = 0.5 * SHOULDER_BREADTH;
/// Midline to hip joint: half the breadth less most of a thigh's radius. Our choice.
pub const HIP_ASIDE: f32 = 0.055;
/// Height of the one joint that stands for the trunk's vertebrae, about the fourth lumbar one. Our
/// choice.
pub const WAIST_HEIGHT: f32 = 0.600;
/// Share of the foot that lies before the ankle. Our choice.
pub const FOOT_BEFORE_ANKLE: f32 = 0.75;
