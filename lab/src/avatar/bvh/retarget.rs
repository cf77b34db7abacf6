//! From places of joints to the avatar's root and angles.

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use glam::{Mat3, Quat, Vec3};
use palpable::geometry::chain::posture;
use palpable::human::{JointDef, Limb, ball_angles, hinges_of, lengths, swing_near};
use palpable::math::Pose;

use super::names::{Role, find};
use super::read::{BvhError, Fault, Motion};
use crate::avatar::{AvatarPlan, Target};

/// Below this sine of its bend, an elbow or knee tells no twist: 10 degrees.
const BEND_SINE_MIN: f32 = 0.17;

/// One frame of a motion on an avatar.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Root and angles, within all limits.
    pub target: Target,
    /// How many hinges, swings and twists had to be changed to be within their limits.
    pub clamped: u32,
}

impl Motion {
    /// The motion on an avatar, frame by frame; times are those of the file, `frame_s` apart.
    ///
    /// # Errors
    /// [`Fault::Missing`] names the first joint that no known name fits, [`Fault::Flat`] a bone without
    /// length.
    pub fn frames(&self, plan: &AvatarPlan) -> Result<Vec<Frame>, BvhError> {
        let map = Map::new(self)?;
        let first = self.places(0, &map);
        let legs_m: f32 = first.sides.iter().map(Side::leg_length).sum();
        if legs_m < 1e-6 {
            return Err(BvhError::whole(Fault::Flat("a leg")));
        }
        let leg = (lengths::THIGH + lengths::SHANK) * plan.height_m;
        let scale = 2.0 * leg / legs_m;
        let all: Vec<Places> = (0..self.frame_count())
            .map(|frame| self.places(frame, &map))
            .collect();
        let ankles = all.iter().flat_map(|p| p.sides.iter().map(|s| s.foot.y));
        let lowest = scale * ankles.fold(f32::INFINITY, f32::min);
        let ground = lengths::ANKLE_HEIGHT * plan.height_m - lowest;
        let start = scale * first.hips();
        let origin = Vec3::new(start.x, -ground, start.z);
        let mut twists = [0.0; 4];
        let one = |places: &Places| {
            let wanted = pose(plan, places, scale, origin, &mut twists);
            let wanted = wanted.ok_or(BvhError::whole(Fault::Flat("the trunk")))?;
            let (target, clamped) = plan.kept(&wanted);
            Ok(Frame { target, clamped })
        };
        all.iter().map(one).collect()
    }

    fn places(&self, frame: usize, map: &Map) -> Places {
        let all = self.positions(frame);
        let at = |joint: usize| all[joint].as_vec3();
        Places {
            neck: map.neck.map(at),
            sides: map.sides.map(|side| Side {
                arm: at(side[0]),
                forearm: at(side[1]),
                hand: at(side[2]),
                thigh: at(side[3]),
                shank: at(side[4]),
                foot: at(side[5]),
                toe: at(side[6]),
            }),
        }
    }
}

/// Indices of the joints that are needed.
struct Map {
    /// Neck and head.
    neck: [usize; 2],
    /// Left, then right; in the order of [`Side`].
    sides: [[usize; 7]; 2],
}

impl Map {
    fn new(motion: &Motion) -> Result<Self, BvhError> {
        let names: Vec<String> = motion.joints.iter().map(|j| j.name.clone()).collect();
        let need = |role, side, what| {
            find(&names, role, side).ok_or(BvhError::whole(Fault::Missing(what)))
        };
        let end_of = |joint: usize| motion.joints.iter().position(|j| j.parent == Some(joint));
        let side = |side: char| {
            let side = Some(side);
            let forearm = need(Role::ForeArm, side, "a forearm")?;
            let foot = need(Role::Foot, side, "a foot")?;
            let hand = find(&names, Role::Hand, side).or_else(|| end_of(forearm));
            let toe = find(&names, Role::Toe, side).or_else(|| end_of(foot));
            Ok([
                need(Role::Arm, side, "an upper arm")?,
                forearm,
                hand.ok_or(BvhError::whole(Fault::Missing("a hand")))?,
                need(Role::Thigh, side, "a thigh")?,
                need(Role::Shank, side, "a shank")?,
                foot,
                toe.ok_or(BvhError::whole(Fault::Missing("toes")))?,
            ])
        };
        Ok(Self {
            neck: [
                need(Role::Neck, None, "the neck")?,
                need(Role::Head, None, "the head")?,
            ],
            sides: [side('l')?, side('r')?],
        })
    }
}

/// Places of the joints of one side, in the file's unit.
#[derive(Clone, Copy)]
struct Side {
    arm: Vec3,
    forearm: Vec3,
    hand: Vec3,
    thigh: Vec3,
    shank: Vec3,
    foot: Vec3,
    toe: Vec3,
}

impl Side {
    fn leg_length(&self) -> f32 {
        self.thigh.distance(self.shank) + self.shank.distance(self.foot)
    }
}

/// Places of all joints of a frame.
struct Places {
    neck: [Vec3; 2],
    sides: [Side; 2],
}

impl Places {
    fn hips(&self) -> Vec3 {
        0.5 * (self.sides[0].thigh + self.sides[1].thigh)
    }

    fn shoulders(&self) -> Vec3 {
        0.5 * (self.sides[0].arm + self.sides[1].arm)
    }
}

/// A frame with a given up and, as near as can be, a given right.
fn upright(up: Vec3, right: Vec3) -> Option<Quat> {
    let up = up.try_normalize()?;
    let right = (right - up * up.dot(right)).try_normalize()?;
    Some(Quat::from_mat3(&Mat3::from_cols(
        right,
        up,
        right.cross(up),
    )))
}

/// The posture of a frame before its limits are kept. `twists` are those of the arms and legs of the frame
/// before.
fn pose(
    plan: &AvatarPlan,
    places: &Places,
    scale: f32,
    origin: Vec3,
    twists: &mut [f32; 4],
) -> Option<Target> {
    let [left, right] = &places.sides;
    let up = places.shoulders() - places.hips();
    let turn = upright(up, right.thigh - left.thigh)?;
    let chest = upright(up, right.arm - left.arm)?;
    let root = Pose::new(turn, scale * places.hips() - origin);
    let bends = plan.chain(Limb::Spine).is_some();
    let trunk = if bends { chest } else { turn };
    let mut target = plan.neutral();
    target.root = root;
    for (index, chain) in plan.chains.iter().enumerate() {
        let base = match chain.limb {
            Limb::Spine | Limb::LeftLeg | Limb::RightLeg => turn,
            _ => trunk,
        };
        let rest = neutral_ball(plan, chain.limb);
        let inside = |v: Vec3| (base * rest).conjugate() * v;
        let bones = match chain.limb {
            Limb::LeftArm => Some((left.arm, left.forearm, left.hand, 0)),
            Limb::RightArm => Some((right.arm, right.forearm, right.hand, 1)),
            Limb::LeftLeg => Some((left.thigh, left.shank, left.foot, 2)),
            Limb::RightLeg => Some((right.thigh, right.shank, right.foot, 3)),
            Limb::Spine | Limb::Neck => None,
        };
        let angles = &mut target.angles[index];
        if let Some((a, b, c, slot)) = bones {
            let (upper, lower) = (inside(b - a), inside(c - b));
            let bent = limb(&chain.joints, upper, lower, slot >= 2, &mut twists[slot]);
            angles[..4].copy_from_slice(&bent);
        } else if chain.limb == Limb::Neck {
            let up = inside(places.neck[1] - places.neck[0]).normalize_or(Vec3::Z);
            (angles[0], angles[1]) = swing_near(up, 0.0);
        } else {
            let within = rest.conjugate() * (turn.conjugate() * chest) * rest;
            angles.copy_from_slice(&ball_angles(within));
        }
    }
    for (limb, side) in [(Limb::LeftLeg, left), (Limb::RightLeg, right)] {
        ankle(plan, limb, side.toe - side.foot, &mut target);
    }
    Some(target)
}

/// Orientation of a limb's ball at zero angles in the root's frame.
fn neutral_ball(plan: &AvatarPlan, limb: Limb) -> Quat {
    let rest = |limb: Limb| {
        let chain = plan.chain(limb).map(|chain| &plan.chains[chain]);
        chain.map_or(Quat::IDENTITY, |chain| chain.joints[0].rest().quat())
    };
    match limb {
        Limb::Neck | Limb::LeftArm | Limb::RightArm => rest(Limb::Spine) * rest(limb),
        _ => rest(limb),
    }
}

/// Swing, twist and bend of a ball and the hinge behind it, from two bones in the ball's frame. An almost
/// straight limb keeps the twist that it had. A knee that bends forward is a bend below zero, not half a
/// turn of the thigh.
fn limb(joints: &[JointDef], upper: Vec3, lower: Vec3, is_leg: bool, twist: &mut f32) -> [f32; 4] {
    let JointDef::Hinge(hinge) = joints[1] else {
        return [0.0; 4];
    };
    let upper = upper.normalize_or(Vec3::Z);
    let (a, b) = swing_near(upper, if is_leg { 0.0 } else { -FRAC_PI_2 });
    let unswung = (Quat::from_rotation_x(a) * Quat::from_rotation_y(b)).conjugate();
    let lower = unswung * lower.normalize_or(upper);
    let mut bend = lower.truncate().length().atan2(lower.z);
    if bend.sin() > BEND_SINE_MIN {
        let axis = hinge.rest.quat() * hinge.axis;
        let out = axis.cross(Vec3::Z);
        let mut turned = within_half_turn(lower.y.atan2(lower.x) - out.y.atan2(out.x));
        if is_leg && turned.abs() > FRAC_PI_2 {
            turned = within_half_turn(turned + PI);
            bend = -bend;
        }
        *twist = nearest_turn(turned, *twist);
    }
    [a, b, *twist, bend]
}

fn within_half_turn(angle: f32) -> f32 {
    angle - TAU * (angle / TAU).round()
}

/// The angle, or it a turn further or back when that is nearer to another one and within three quarters of
/// a turn: a twist that leaves its range on one side does not come in on the other.
fn nearest_turn(angle: f32, near: f32) -> f32 {
    let candidates = [angle - TAU, angle + TAU];
    let within = candidates.into_iter().filter(|a| a.abs() <= 1.5 * PI);
    within.fold(angle, |best, other| {
        if (other - near).abs() < (best - near).abs() {
            other
        } else {
            best
        }
    })
}

/// Dorsiflexion from where the toes are.
fn ankle(plan: &AvatarPlan, limb: Limb, foot: Vec3, target: &mut Target) {
    let Some(index) = plan.chain(limb) else {
        return;
    };
    let chain = &plan.chains[index];
    let hinges = hinges_of(&chain.joints);
    let links = posture(&hinges, &target.root, &target.angles[index]);
    let foot = links[4].link.quat().conjugate() * foot;
    let across = |v: Vec3| (v.y).atan2(-v.z);
    let angle = across(foot) - across(chain.tip);
    target.angles[index][4] = within_half_turn(angle);
}
