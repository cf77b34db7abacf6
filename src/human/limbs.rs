//! Arms, legs, trunk and neck of a body of a given height.

use arrayvec::ArrayVec;
use glam::{Quat, Vec3};

use super::lengths as l;
use super::ranges::{self, JointLimits};
use super::{JointDef, LIMB_JOINTS_MAX, about, hinges_of, mirrored_point};
use crate::geometry::chain::Hinge;
use crate::geometry::reach_cone::ReachCone;
use crate::limits::{CHAIN_HINGES_MAX, REACH_CONE_EDGES_MAX};
use crate::math::{self, Pose};

/// Shortest body, in metres; shorter ones count as this tall.
const HEIGHT_M_MIN: f32 = 0.3;

/// Tallest body, in metres; taller ones count as this tall.
const HEIGHT_M_MAX: f32 = 3.0;

/// A chain of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Limb {
    /// Pelvis to chest: one ball at the waist.
    Spine,
    /// Chest to head: one ball between the shoulders.
    Neck,
    /// Seven hinges.
    LeftArm,
    /// Seven hinges.
    RightArm,
    /// Six hinges.
    LeftLeg,
    /// Six hinges.
    RightLeg,
}

impl Limb {
    /// All limbs; each comes after the one it hangs on.
    pub const ALL: [Self; 6] = [
        Self::Spine,
        Self::Neck,
        Self::LeftArm,
        Self::RightArm,
        Self::LeftLeg,
        Self::RightLeg,
    ];
}

/// What a limb's first joint hangs on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Base {
    /// The root: the pelvis, or the whole trunk of a body without spine.
    Root,
    /// The last link of [`Limb::Spine`].
    Spine,
}

/// The joints and lengths of a limb.
#[derive(Clone, Debug, PartialEq)]
pub struct LimbDef {
    /// What the first joint's rest pose is relative to.
    pub base: Base,
    /// From the base on.
    pub joints: ArrayVec<JointDef, LIMB_JOINTS_MAX>,
    /// Lengths of the limb's bones in metres: upper arm, forearm, hand; thigh, shank, foot; waist to
    /// shoulders; shoulders to the top of the head.
    pub bones_m: ArrayVec<f32, 3>,
    /// The limb's end in the frame of the last link: fingertips, toes, midway between the shoulders,
    /// top of the head.
    pub tip: Vec3,
}

impl LimbDef {
    /// The joints as hinges.
    #[must_use]
    pub fn hinges(&self) -> ArrayVec<Hinge, CHAIN_HINGES_MAX> {
        hinges_of(&self.joints)
    }
}

/// A limb of a body of `height_m` metres with a spine. The height is kept between 0.3 m and 3 m; a NaN
/// counts as the least.
#[must_use]
pub fn limb(limb: Limb, height_m: f32) -> LimbDef {
    build(limb, height_m, true)
}

/// A limb of a body whose trunk is one rigid root: [`limb`] with the neck and the arms on the root. The
/// spine itself stays as it is.
#[must_use]
pub fn limb_on_root(limb: Limb, height_m: f32) -> LimbDef {
    build(limb, height_m, false)
}

fn build(limb: Limb, height_m: f32, on_spine: bool) -> LimbDef {
    let height = math::clamp(height_m, HEIGHT_M_MIN, HEIGHT_M_MAX);
    match limb {
        Limb::Spine => spine(height),
        Limb::Neck => neck(height, on_spine),
        Limb::RightArm => right_arm(height, on_spine),
        Limb::LeftArm => mirrored(&right_arm(height, on_spine)),
        Limb::RightLeg => right_leg(height),
        Limb::LeftLeg => mirrored(&right_leg(height)),
    }
}

/// Joints given by where they are at zero angles in the root's frame.
struct Run {
    base: Base,
    last: Pose,
    joints: ArrayVec<JointDef, LIMB_JOINTS_MAX>,
}

impl Run {
    fn new(base: Base, height: f32) -> Self {
        let last = match base {
            Base::Root => Pose::IDENTITY,
            Base::Spine => upright(waist(height)),
        };
        Self {
            base,
            last,
            joints: ArrayVec::new(),
        }
    }

    fn hinge(&mut self, at: Vec3, axis: Vec3, limits: &JointLimits) {
        let at = Pose::new(Quat::IDENTITY, at);
        self.joints.push(JointDef::Hinge(Hinge {
            rest: at.seen_from(&self.last),
            axis,
            low_rad: limits.low_rad(),
            high_rad: limits.high_rad(),
        }));
        self.last = at;
    }

    fn ball(&mut self, at: Pose, twist: &JointLimits, visible: Vec3, corners: &[Vec3]) {
        let inside = |v: Vec3| at.quat().conjugate() * v;
        let corners: ArrayVec<Vec3, REACH_CONE_EDGES_MAX> =
            corners.iter().map(|&corner| inside(corner)).collect();
        let cone = ReachCone::new(inside(visible), &corners);
        self.joints.push(JointDef::Ball {
            rest: at.seen_from(&self.last),
            twist_low_rad: twist.low_rad(),
            twist_high_rad: twist.high_rad(),
            cone: cone.expect("the tables below make cones"),
        });
        self.last = at;
    }

    fn end(self, bones_m: &[f32], tip: Vec3) -> LimbDef {
        let tip = Pose::new(Quat::IDENTITY, tip).seen_from(&self.last);
        LimbDef {
            base: self.base,
            joints: self.joints,
            bones_m: bones_m.iter().copied().collect(),
            tip: tip.translation(),
        }
    }
}

fn mirrored(limb: &LimbDef) -> LimbDef {
    LimbDef {
        base: limb.base,
        joints: limb.joints.iter().map(JointDef::mirrored).collect(),
        bones_m: limb.bones_m.clone(),
        tip: mirrored_point(limb.tip),
    }
}

/// Height above the root.
fn above(fraction: f32, height: f32) -> f32 {
    (fraction - l::HIP_HEIGHT) * height
}

fn waist(height: f32) -> Vec3 {
    Vec3::new(0.0, above(l::WAIST_HEIGHT, height), 0.0)
}

/// A ball's rest frame whose limb points up; its X is the avatar's right, its Y ahead.
fn upright(at: Vec3) -> Pose {
    Pose::new(about(Vec3::X, -90_f32.to_radians()), at)
}

/// A ball's rest frame whose limb hangs down; its X is the avatar's right turned by `yaw_deg` about +Y.
fn hanging(at: Vec3, yaw_deg: f32) -> Pose {
    let turn = about(Vec3::Y, yaw_deg.to_radians()) * about(Vec3::X, 90_f32.to_radians());
    Pose::new(turn, at)
}

fn trunk_base(on_spine: bool) -> Base {
    if on_spine { Base::Spine } else { Base::Root }
}

/// Corners of a cone about +Y from how far it goes forward, backward and sideways, in degrees: on the
/// four sides and between them.
fn bending_cone(flexion: &JointLimits, lateral: &JointLimits) -> [Vec3; 8] {
    let between = |a: f32, b: f32| 0.5 * (a + b);
    let (fore, back, side) = (flexion.high_deg, -flexion.low_deg, lateral.high_deg);
    let corner = |turn_deg: f32, tilt_deg: f32| {
        let (turn, tilt) = (turn_deg.to_radians(), tilt_deg.to_radians());
        let out = math::sin(tilt);
        Vec3::new(
            math::sin(turn) * out,
            math::cos(tilt),
            -math::cos(turn) * out,
        )
    };
    [
        corner(0.0, fore),
        corner(45.0, between(fore, side)),
        corner(90.0, side),
        corner(135.0, between(back, side)),
        corner(180.0, back),
        corner(225.0, between(back, side)),
        corner(270.0, side),
        corner(315.0, between(fore, side)),
    ]
}

fn spine(height: f32) -> LimbDef {
    let mut run = Run::new(Base::Root, height);
    let corners = bending_cone(&ranges::SPINE_FLEXION, &ranges::SPINE_LATERAL);
    let at = upright(waist(height));
    run.ball(at, &ranges::SPINE_ROTATION, Vec3::Y, &corners);
    let tip = Vec3::new(0.0, above(l::SHOULDER_HEIGHT, height), 0.0);
    run.end(&[(l::SHOULDER_HEIGHT - l::WAIST_HEIGHT) * height], tip)
}

fn neck(height: f32, on_spine: bool) -> LimbDef {
    let mut run = Run::new(trunk_base(on_spine), height);
    let corners = bending_cone(&ranges::NECK_FLEXION, &ranges::NECK_LATERAL);
    let at = upright(Vec3::new(0.0, above(l::SHOULDER_HEIGHT, height), 0.0));
    run.ball(at, &ranges::NECK_ROTATION, Vec3::Y, &corners);
    let top = Vec3::new(0.0, above(1.0, height), 0.0);
    run.end(&[l::HEAD_AND_NECK * height], top)
}

/// The right arm's direction at so many degrees from straight sideways toward straight ahead, and so
/// many above the horizon.
fn aside_and_up(ahead_deg: f32, up_deg: f32) -> Vec3 {
    let (ahead, up) = (ahead_deg.to_radians(), up_deg.to_radians());
    let level = math::cos(up);
    Vec3::new(
        math::cos(ahead) * level,
        math::sin(up),
        -math::sin(ahead) * level,
    )
}

/// Where the right upper arm points at the ends of its ranges, going round: behind, behind and sideways,
/// overhead, across the body, before the body, down. Edges are straight cuts, so corners stand up to
/// 10 degrees beyond the ranges where the range's end shall lie inside.
fn shoulder_corners() -> [Vec3; 10] {
    [
        aside_and_up(-90.0, -30.0),
        aside_and_up(-60.0, -30.0),
        aside_and_up(-30.0, -15.0),
        aside_and_up(-30.0, 20.0),
        aside_and_up(-45.0, 50.0),
        aside_and_up(-90.0, 80.0),
        aside_and_up(160.0, 75.0),
        aside_and_up(130.0, 40.0),
        aside_and_up(130.0, -45.0),
        aside_and_up(-150.0, -75.0),
    ]
}

fn right_arm(height: f32, on_spine: bool) -> LimbDef {
    let bones = [l::UPPER_ARM, l::FOREARM, l::HAND].map(|bone| bone * height);
    let aside = l::SHOULDER_ASIDE * height;
    let shoulder = Vec3::new(aside, above(l::SHOULDER_HEIGHT, height), 0.0);
    let elbow = shoulder - Vec3::Y * bones[0];
    let wrist = elbow - Vec3::Y * bones[1];
    let mut run = Run::new(trunk_base(on_spine), height);
    run.ball(
        hanging(shoulder, 140.0),
        &ranges::SHOULDER_ROTATION,
        aside_and_up(45.0, -10.0),
        &shoulder_corners(),
    );
    run.hinge(elbow, Vec3::X, &ranges::ELBOW_FLEXION);
    run.hinge(elbow, Vec3::Y, &ranges::FOREARM_PRONATION);
    run.hinge(wrist, Vec3::NEG_Z, &ranges::WRIST_FLEXION);
    run.hinge(wrist, Vec3::X, &ranges::WRIST_RADIAL);
    run.end(&bones, wrist - Vec3::Y * bones[2])
}

/// The right thigh's direction at so many degrees of flexion and abduction.
fn flexed_and_aside(flexion_deg: f32, aside_deg: f32) -> Vec3 {
    let (flexion, aside) = (flexion_deg.to_radians(), aside_deg.to_radians());
    let across = math::cos(aside);
    Vec3::new(
        math::sin(aside),
        -math::cos(flexion) * across,
        -math::sin(flexion) * across,
    )
}

/// Where the right thigh points at the ends of its ranges, going round. A bent hip opens wider.
fn hip_corners() -> [Vec3; 8] {
    [
        flexed_and_aside(-30.0, -15.0),
        flexed_and_aside(-30.0, 25.0),
        flexed_and_aside(-10.0, 46.0),
        flexed_and_aside(60.0, 50.0),
        flexed_and_aside(120.0, 40.0),
        flexed_and_aside(123.0, -15.0),
        flexed_and_aside(60.0, -30.0),
        flexed_and_aside(0.0, -31.0),
    ]
}

fn right_leg(height: f32) -> LimbDef {
    let hip = Vec3::new(l::HIP_ASIDE * height, 0.0, 0.0);
    let knee = hip - Vec3::Y * (l::THIGH * height);
    let ankle = knee - Vec3::Y * (l::SHANK * height);
    let mut run = Run::new(Base::Root, height);
    run.ball(
        hanging(hip, 0.0),
        &ranges::HIP_ROTATION,
        flexed_and_aside(40.0, 5.0),
        &hip_corners(),
    );
    run.hinge(knee, Vec3::NEG_X, &ranges::KNEE_FLEXION);
    run.hinge(ankle, Vec3::X, &ranges::ANKLE_DORSIFLEXION);
    run.hinge(ankle, Vec3::NEG_Z, &ranges::FOOT_INVERSION);
    let ahead = l::FOOT_BEFORE_ANKLE * l::FOOT_LENGTH * height;
    let toes = ankle - Vec3::new(0.0, l::ANKLE_HEIGHT * height, ahead);
    run.end(
        &[l::THIGH, l::SHANK, l::FOOT_LENGTH].map(|bone| bone * height),
        toes,
    )
}
