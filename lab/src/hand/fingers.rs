//! The articulated hand: the 18 parts on a wrist and five finger chains.
//!
//! The root is the wrist. Bones, knuckles and axes are those of the model's bind pose, whose frames follow
//! OpenXR: each joint flexes about its own -X and a knuckle spreads about its own +Y. Angles are zero in the
//! bind pose. Ranges are those of [`palpable::human::ranges`].

use glam::{DQuat, DVec3};
use palpable::geometry::chain::{Posture, posture};
use palpable::human::{Finger, FingerBones, FingerDef, JointDef, finger};
use palpable::math::Pose;

use super::joints::{JOINT_COUNT, joint_index};
use super::{Hand, HandPose, JointPose};

/// The joints of each finger that move, and its tip.
const FINGER_JOINTS: [[&str; 4]; 5] = [
    [
        "thumb-metacarpal",
        "thumb-phalanx-proximal",
        "thumb-phalanx-distal",
        "thumb-tip",
    ],
    [
        "index-finger-phalanx-proximal",
        "index-finger-phalanx-intermediate",
        "index-finger-phalanx-distal",
        "index-finger-tip",
    ],
    [
        "middle-finger-phalanx-proximal",
        "middle-finger-phalanx-intermediate",
        "middle-finger-phalanx-distal",
        "middle-finger-tip",
    ],
    [
        "ring-finger-phalanx-proximal",
        "ring-finger-phalanx-intermediate",
        "ring-finger-phalanx-distal",
        "ring-finger-tip",
    ],
    [
        "pinky-finger-phalanx-proximal",
        "pinky-finger-phalanx-intermediate",
        "pinky-finger-phalanx-distal",
        "pinky-finger-tip",
    ],
];

/// Most steps of a fit. Those of the recorded poses settle within 30.
const FIT_STEPS_MAX: u32 = 200;

/// A fit ends when no angle changes by more, in radians.
const FIT_STILL_RAD: f64 = 1e-9;

/// What a part moves with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FingerLink {
    /// The wrist.
    Root,
    /// What hangs behind a hinge.
    Behind {
        /// Index into [`ArticulatedHand::fingers`].
        finger: usize,
        /// Index of the hinge.
        hinge: usize,
    },
}

/// Where a part of the hand hangs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartPlace {
    /// What it moves with; the part's index is that of [`Hand::parts`].
    pub link: FingerLink,
    /// Pose of the part in that link's frame.
    pub local: Pose,
}

/// Angles of the five fingers, one a hinge, in radians.
pub type FingerAngles = [Vec<f32>; 5];

/// A hand with bending fingers.
#[derive(Clone, Debug, PartialEq)]
pub struct ArticulatedHand {
    /// Thumb to little finger.
    pub fingers: [FingerDef; 5],
    /// One for each part of the hand.
    pub parts: Vec<PartPlace>,
}

/// Angles that come nearest to a pose of the 26 joints.
#[derive(Clone, Debug, PartialEq)]
pub struct FingerFit {
    /// Within all limits.
    pub angles: FingerAngles,
    /// For each finger how far its second joint, third joint and tip are from the pose, in metres.
    pub residual_m: [[f64; 3]; 5],
}

impl FingerFit {
    /// Median and largest residual of the 15 points, in metres.
    #[must_use]
    pub fn median_and_max_m(&self) -> (f64, f64) {
        let mut all = self.residual_m.concat();
        all.sort_by(f64::total_cmp);
        (all[all.len() / 2], all[all.len() - 1])
    }
}

impl ArticulatedHand {
    /// The articulated form of a hand.
    ///
    /// # Panics
    /// Never for a loaded hand: every part is driven by the wrist, a palm bone or a finger's joint.
    #[must_use]
    pub fn new(hand: &Hand) -> Self {
        let rest = hand.joints(HandPose::Flat, HandPose::Flat, 0.0);
        let fingers: [FingerDef; 5] =
            std::array::from_fn(|index| finger(Finger::ALL[index], &bones(&rest, index)));
        let mut articulated = Self {
            fingers,
            parts: Vec::new(),
        };
        let links = articulated.postures(&Pose::IDENTITY, &articulated.rest());
        let place = |joint: usize| {
            let link = articulated.link_of(joint);
            let local = to_pose(&rest[joint]).seen_from(&link_pose(link, &Pose::IDENTITY, &links));
            PartPlace { link, local }
        };
        articulated.parts = hand.parts.iter().map(|part| place(part.joint)).collect();
        articulated
    }

    /// The fingers' joints as chains are made from them.
    #[must_use]
    pub fn joints(&self, finger: usize) -> Vec<JointDef> {
        let hinges = self.fingers[finger].hinges.iter();
        hinges.map(|&hinge| JointDef::Hinge(hinge)).collect()
    }

    /// Zero angles: the bind pose.
    #[must_use]
    pub fn rest(&self) -> FingerAngles {
        std::array::from_fn(|finger| vec![0.0; self.fingers[finger].hinges.len()])
    }

    /// Forward kinematics of the fingers.
    #[must_use]
    pub fn postures(&self, wrist: &Pose, angles: &FingerAngles) -> [Posture; 5] {
        std::array::from_fn(|finger| posture(&self.fingers[finger].hinges, wrist, &angles[finger]))
    }

    /// Where the parts are, in the order of [`Hand::parts`].
    #[must_use]
    pub fn part_poses(&self, wrist: &Pose, angles: &FingerAngles) -> Vec<Pose> {
        let links = self.postures(wrist, angles);
        let place = |part: &PartPlace| link_pose(part.link, wrist, &links).then(&part.local);
        self.parts.iter().map(place).collect()
    }

    /// The angles within all limits whose joints come nearest to those of a pose, in the sense of least
    /// squares, finger by finger: damped Gauss-Newton with limits, from the bind pose.
    ///
    /// `joints` are in the wrist's frame, as [`Hand::joints`] gives them.
    #[must_use]
    pub fn fit(&self, joints: &[JointPose; JOINT_COUNT]) -> FingerFit {
        let mut fit = FingerFit {
            angles: self.rest(),
            residual_m: [[0.0; 3]; 5],
        };
        for (index, def) in self.fingers.iter().enumerate() {
            let [_, second, third, tip] = finger_joints(index);
            let wanted = [second, third, tip].map(|joint| joints[joint].position);
            let angles = fit_finger(def, &wanted);
            let found = points(def, &angles);
            fit.residual_m[index] = std::array::from_fn(|i| found[i].distance(wanted[i]));
            fit.angles[index] = angles.iter().map(|&angle| angle as f32).collect();
        }
        fit
    }

    /// A fist: the pointing pose, with the index finger bent as the middle finger is. No fist was recorded.
    #[must_use]
    pub fn fist(&self, hand: &Hand) -> FingerAngles {
        let pointing = hand.joints(HandPose::Point, HandPose::Point, 0.0);
        let mut angles = self.fit(&pointing).angles;
        let bent = angles[2].clone();
        for (angle, (bent, hinge)) in angles[1]
            .iter_mut()
            .zip(bent.iter().zip(&self.fingers[1].hinges))
        {
            *angle = hinge.kept(*bent);
        }
        angles
    }

    fn link_of(&self, joint: usize) -> FingerLink {
        for finger in 0..5 {
            let bone = finger_joints(finger)[..3].iter().position(|&j| j == joint);
            if let Some(bone) = bone {
                let hinge = self.fingers[finger].bones[bone];
                return FingerLink::Behind { finger, hinge };
            }
        }
        FingerLink::Root
    }
}

fn finger_joints(finger: usize) -> [usize; 4] {
    FINGER_JOINTS[finger].map(|name| joint_index(name).expect("a WebXR joint"))
}

fn bones(rest: &[JointPose; JOINT_COUNT], finger: usize) -> FingerBones {
    let [first, second, third, tip] = finger_joints(finger);
    FingerBones {
        joints: [first, second, third].map(|joint| to_pose(&rest[joint])),
        tip: rest[tip].position.as_vec3(),
    }
}

fn to_pose(joint: &JointPose) -> Pose {
    Pose::new(joint.orientation.as_quat(), joint.position.as_vec3())
}

fn link_pose(link: FingerLink, wrist: &Pose, links: &[Posture; 5]) -> Pose {
    match link {
        FingerLink::Root => *wrist,
        FingerLink::Behind { finger, hinge } => links[finger][hinge].link,
    }
}

/// Second joint, third joint and tip of a finger in f64, in the wrist's frame.
fn points(def: &FingerDef, angles: &[f64]) -> [DVec3; 3] {
    let (mut turn, mut at) = (DQuat::IDENTITY, DVec3::ZERO);
    let mut found = [DVec3::ZERO; 3];
    for (index, (hinge, &angle)) in def.hinges.iter().zip(angles).enumerate() {
        at += turn * hinge.rest.translation().as_dvec3();
        turn *= hinge.rest.quat().as_dquat().normalize();
        turn *= DQuat::from_axis_angle(hinge.axis.as_dvec3().normalize(), angle);
        match def.bones {
            [_, second, _] if second == index => found[0] = at,
            [_, _, third] if third == index => found[1] = at,
            _ => {}
        }
    }
    found[2] = at + turn * def.tip.as_dvec3();
    found
}

fn errors(def: &FingerDef, angles: &[f64], wanted: &[DVec3; 3]) -> [f64; 9] {
    let found = points(def, angles);
    std::array::from_fn(|i| found[i / 3][i % 3] - wanted[i / 3][i % 3])
}

fn squares(errors: &[f64; 9]) -> f64 {
    errors.iter().map(|e| e * e).sum()
}

fn fit_finger(def: &FingerDef, wanted: &[DVec3; 3]) -> Vec<f64> {
    let mut angles = vec![0.0; def.hinges.len()];
    let mut damping = 1e-6;
    for _ in 0..FIT_STEPS_MAX {
        let here = errors(def, &angles, wanted);
        let next = step(def, &angles, wanted, &here, damping);
        if squares(&errors(def, &next, wanted)) > squares(&here) {
            damping *= 10.0;
            continue;
        }
        damping = f64::max(0.3 * damping, 1e-12);
        let moved = next.iter().zip(&angles).map(|(a, b)| (a - b).abs());
        let most = moved.fold(0.0, f64::max);
        angles = next;
        if most < FIT_STILL_RAD {
            break;
        }
    }
    angles
}

/// One damped Gauss-Newton step, with angles held that would leave their limits.
fn step(
    def: &FingerDef,
    angles: &[f64],
    wanted: &[DVec3; 3],
    here: &[f64; 9],
    damping: f64,
) -> Vec<f64> {
    const DELTA_RAD: f64 = 1e-6;
    let count = angles.len();
    let columns: Vec<[f64; 9]> = (0..count)
        .map(|index| {
            let shifted = |by: f64| {
                let mut moved = angles.to_vec();
                moved[index] += by;
                errors(def, &moved, wanted)
            };
            let (more, less) = (shifted(DELTA_RAD), shifted(-DELTA_RAD));
            std::array::from_fn(|i| (more[i] - less[i]) / (2.0 * DELTA_RAD))
        })
        .collect();
    let dot = |a: &[f64; 9], b: &[f64; 9]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let limits = |index: usize| {
        let hinge = &def.hinges[index];
        (f64::from(hinge.low_rad), f64::from(hinge.high_rad))
    };
    let is_free = |index: usize| {
        let (slope, (low, high)) = (dot(&columns[index], here), limits(index));
        !((angles[index] <= low && slope > 0.0) || (angles[index] >= high && slope < 0.0))
    };
    let free: Vec<usize> = (0..count).filter(|&index| is_free(index)).collect();
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for &i in &free {
        let mut row: Vec<f64> = free
            .iter()
            .map(|&j| dot(&columns[i], &columns[j]))
            .collect();
        row.push(-dot(&columns[i], here));
        let place = rows.len();
        row[place] += damping;
        rows.push(row);
    }
    let mut next = angles.to_vec();
    for (&index, change) in free.iter().zip(solved(rows)) {
        let (low, high) = limits(index);
        next[index] = (next[index] + change).clamp(low, high);
    }
    next
}

/// Solves a symmetric positive definite system given as rows with the right side last.
fn solved(mut rows: Vec<Vec<f64>>) -> Vec<f64> {
    let count = rows.len();
    for pivot in 0..count {
        for row in pivot + 1..count {
            let factor = rows[row][pivot] / rows[pivot][pivot];
            for column in pivot..=count {
                rows[row][column] -= factor * rows[pivot][column];
            }
        }
    }
    let mut found = vec![0.0; count];
    for row in (0..count).rev() {
        let known: f64 = (row + 1..count).map(|c| rows[row][c] * found[c]).sum();
        found[row] = (rows[row][count] - known) / rows[row][row];
    }
    found
}
