//! Chains of hinges, and where their links are for given angles.

use core::f32::consts::{PI, TAU};

use arrayvec::ArrayVec;
use bytemuck::{Pod, Zeroable};
use glam::{Quat, Vec3};

use super::reach_cone::ReachCone;
use crate::limits::CHAIN_HINGES_MAX;
use crate::math::{self, Pose};

/// A hinge between two links. A ball joint is three hinges in one place, see [`Ball`].
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Hinge {
    /// Pose of the hinge in the frame of the link before it, or of the chain's root.
    pub rest: Pose,
    /// Unit axis in the hinge's frame.
    pub axis: Vec3,
    /// Least angle in radians.
    pub low_rad: f32,
    /// Largest angle in radians.
    pub high_rad: f32,
}

impl Hinge {
    /// The angle within the limits that is nearest to one.
    #[inline]
    #[must_use]
    pub fn kept(&self, angle_rad: f32) -> f32 {
        math::clamp(angle_rad, self.low_rad, self.high_rad)
    }

    /// The frame of the link behind the hinge, in the frame of what the hinge hangs on.
    #[inline]
    #[must_use]
    pub fn behind(&self, angle_rad: f32) -> Pose {
        Pose::new(self.turned(angle_rad), self.rest.translation())
    }

    /// Its orientation. A hinge that is not turned at rest, as most, costs no product.
    #[inline]
    fn turned(&self, angle_rad: f32) -> Quat {
        let turn = turn_about(self.axis, angle_rad);
        if self.rest.rotation == Pose::IDENTITY.rotation {
            turn
        } else {
            self.rest.quat() * turn
        }
    }

    /// The same in the frame of what `base` is given in, its orientation of unit length to rounding: the second
    /// and the third hinge of a ball rest where the one before them is, which costs nothing.
    #[inline]
    pub(crate) fn placed(&self, base: &Pose, angle_rad: f32) -> Pose {
        let mut place = base.translation();
        if self.rest.position != [0.0; 3] {
            place += base.quat() * self.rest.translation();
        }
        let turn = base.quat() * self.turned(angle_rad);
        Pose::new(math::renormalised(turn), place)
    }
}

/// The reach cone of a ball joint: three hinges in one place with the axes X, Y and Z of one frame, the
/// first one's rest pose. Z turned by the first two is the limb; the third is its twist.
///
/// At angles a and b of the first two the limb is (sin b, -sin a cos b, cos a cos b) in that frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Index of the first of the three hinges.
    pub first: usize,
    /// Where the limb may point, in the frame of the first hinge's rest.
    pub cone: ReachCone,
}

/// How many hinges a ball has; the last is the twist.
const BALL_HINGES: usize = 3;

/// What counts as on the boundary of a reach cone, in radians: some units of rounding.
pub(crate) const BOUNDARY_RAD: f32 = 1e-6;

/// Below this sine of the angle to a pole the first angle has no say.
const POLE_SINE: f32 = 1e-6;

impl Ball {
    /// The angles of the ball among those of the chain; none when the chain ends before.
    fn own(&self, angles: &[f32]) -> Option<[f32; BALL_HINGES]> {
        let from = angles.get(self.first..)?;
        Some([*from.first()?, *from.get(1)?, *from.get(2)?])
    }

    /// The limb's unit direction in the cone's frame, at angles of the whole chain. Z where the chain
    /// ends before the ball does.
    #[must_use]
    pub fn limb(&self, angles: &[f32]) -> Vec3 {
        self.own(angles).map_or(Vec3::Z, |[a, b, _]| limb_at(a, b))
    }

    /// How far the limb is outside the cone, in radians, at angles of the whole chain.
    #[must_use]
    pub fn outside_rad(&self, angles: &[f32]) -> f32 {
        self.cone.outside_rad(self.limb(angles))
    }

    /// The ball's three angles for a limb's unit direction, twice, the nearer to those of the chain
    /// first.
    ///
    /// A direction has two pairs of angles, (a, b) and (a + pi, pi - b), each modulo a turn. The nearer
    /// pair keeps the twist. The other has half a turn more of it, so that what follows does not flip.
    /// At the poles, b = +-90 degrees, every a will do, and the chain's is kept.
    #[must_use]
    pub fn aimed(&self, limb: Vec3, angles: &[f32]) -> [[f32; BALL_HINGES]; 2] {
        aimed_from(limb, self.own(angles).unwrap_or_default())
    }

    /// Takes the limb to the nearest direction that the cone allows, at angles of the whole chain. What
    /// is allowed, up to rounding, stays to the bit.
    pub fn kept(&self, angles: &mut [f32]) {
        let limb = self.limb(angles);
        if self.cone.outside_rad(limb) <= BOUNDARY_RAD {
            return;
        }
        let [near, _] = self.aimed(self.cone.nearest(limb), angles);
        self.place(angles, near);
    }

    /// The same within the ranges of the hinges, too; whether that was found. Where it was not, the
    /// hinges' ranges are kept and the cone is not.
    ///
    /// Cost: at most eight projections.
    pub fn kept_with(&self, hinges: &[Hinge], angles: &mut [f32]) -> bool {
        let Some(own_hinges) = hinges.get(self.first..self.first.saturating_add(BALL_HINGES))
        else {
            return true;
        };
        if self.own(angles).is_none() {
            return true;
        }
        let clamped = |own: [f32; BALL_HINGES]| {
            let mut kept = own;
            for (angle, hinge) in kept.iter_mut().zip(own_hinges) {
                *angle = hinge.kept(*angle);
            }
            kept
        };
        for _ in 0..ALTERNATIONS_MAX {
            let limb = self.limb(angles);
            if self.cone.outside_rad(limb) <= BOUNDARY_RAD {
                return true;
            }
            let nearest = self.cone.nearest(limb);
            let both = self.aimed(nearest, angles);
            // Whole turns off, the angles may be within the ranges.
            let others = aimed_from(nearest, self.middle(own_hinges, angles));
            let mut all = both.into_iter().chain(others);
            let fits = all.find(|own| clamped(*own) == *own);
            self.place(angles, fits.unwrap_or(clamped(both[0])));
        }
        self.outside_rad(angles) <= BOUNDARY_RAD
    }

    /// The middle of the first two hinges' ranges, and the twist.
    fn middle(&self, own_hinges: &[Hinge], angles: &[f32]) -> [f32; BALL_HINGES] {
        let mut own = self.own(angles).unwrap_or_default();
        for (angle, hinge) in own.iter_mut().zip(own_hinges).take(BALL_HINGES - 1) {
            *angle = 0.5 * (math::max(hinge.low_rad, -TAU) + math::min(hinge.high_rad, TAU));
        }
        own
    }

    /// Takes the limb to the point that sees all of the cone, or as near as the hinges' ranges allow.
    pub fn rest(&self, hinges: &[Hinge], angles: &mut [f32]) {
        let own_hinges = hinges.get(self.first..).unwrap_or_default();
        let both = aimed_from(self.cone.visible(), self.middle(own_hinges, angles));
        let off = |own: &[f32; BALL_HINGES]| {
            let off = own.iter().zip(own_hinges);
            off.map(|(&q, hinge)| (q - hinge.kept(q)).abs())
                .sum::<f32>()
        };
        let nearer = usize::from(off(&both[1]) < off(&both[0]));
        let mut own = both[nearer];
        for (angle, hinge) in own.iter_mut().zip(own_hinges) {
            *angle = hinge.kept(*angle);
        }
        self.place(angles, own);
    }

    /// The ball's angles for a rotation of what follows it against its rest frame: the limb's swing, and
    /// the twist that is left. Of equal ones those nearest to the chain's.
    pub fn set_turn(&self, turn: Quat, angles: &mut [f32]) {
        let Some([_, _, twist_now]) = self.own(angles) else {
            return;
        };
        let [[a, b, _], _] = self.aimed(turn * Vec3::Z, angles);
        let swing = turn_about(Vec3::X, a) * turn_about(Vec3::Y, b);
        let rest = swing.conjugate() * turn;
        let twist = turns_nearest(2.0 * math::atan2(rest.z, rest.w), twist_now);
        self.place(angles, [a, b, twist]);
    }

    /// Writes the ball's angles, by whole turns within the ranges of its swing.
    fn place(&self, angles: &mut [f32], own: [f32; BALL_HINGES]) {
        let [a, b, twist] = own;
        let a = if a.abs() > SWING_RAD {
            turns_nearest(a, 0.0)
        } else {
            a
        };
        let own = [a, turns_nearest(b, 0.0), twist];
        for (angle, found) in angles.iter_mut().skip(self.first).zip(own) {
            *angle = found;
        }
    }

    /// Derivatives of the limb by the first two angles.
    pub(crate) fn limb_slopes(&self, angles: &[f32]) -> [Vec3; 2] {
        let [a, b, _] = self.own(angles).unwrap_or_default();
        let ((sin_a, cos_a), (sin_b, cos_b)) = (math::sin_cos(a), math::sin_cos(b));
        [
            Vec3::new(0.0, -cos_a * cos_b, -sin_a * cos_b),
            Vec3::new(cos_b, sin_a * sin_b, -cos_a * sin_b),
        ]
    }

    /// Inward unit normals of the cone's edges where a limb is: of the edge of its lune, and of the one
    /// behind the nearer corner where the cone is convex there.
    pub(crate) fn walls(&self, limb: Vec3) -> ArrayVec<Vec3, 2> {
        let (corners, visible) = (self.cone.corners(), self.cone.visible());
        let count = corners.len();
        let mut walls = ArrayVec::new();
        let next = |index: usize| if index + 1 == count { 0 } else { index + 1 };
        let in_lune = |&index: &usize| {
            let (a, b) = (corners[index], corners[next(index)]);
            limb.dot(visible.cross(a)) >= 0.0 && limb.dot(b.cross(visible)) >= 0.0
        };
        let Some(index) = (0..count).find(in_lune) else {
            return walls;
        };
        let (a, b) = (corners[index], corners[next(index)]);
        let beyond = corners[next(next(index))];
        let before = corners[if index == 0 { count - 1 } else { index - 1 }];
        let (other, inside) = if limb.dot(a) > limb.dot(b) {
            (before.cross(a), b)
        } else {
            (b.cross(beyond), a)
        };
        walls.extend(math::direction(a.cross(b)));
        let is_convex = other.dot(inside) > 0.0 && other.dot(limb) > -POLE_SINE;
        walls.extend(math::direction(other).filter(|_| is_convex));
        walls
    }
}

/// See [`Ball::aimed`].
fn aimed_from(limb: Vec3, [a_now, b_now, twist]: [f32; BALL_HINGES]) -> [[f32; BALL_HINGES]; 2] {
    let across = math::sqrt(limb.y * limb.y + limb.z * limb.z);
    let b = math::atan2(limb.x, across);
    let a = if across > POLE_SINE {
        math::atan2(-limb.y, limb.z)
    } else if math::cos(b_now) < 0.0 {
        a_now - PI
    } else {
        a_now
    };
    let pairs = [(a, b), (a + PI, PI - b)];
    let pairs = pairs.map(|(a, b)| (turns_nearest(a, a_now), turns_nearest(b, b_now)));
    let far = |(a, b): (f32, f32)| (a - a_now) * (a - a_now) + (b - b_now) * (b - b_now);
    let swapped = far(pairs[1]) < far(pairs[0]);
    let (near, other) = if swapped {
        (pairs[1], pairs[0])
    } else {
        (pairs[0], pairs[1])
    };
    let flipped = if twist > 0.0 { twist - PI } else { twist + PI };
    [[near.0, near.1, twist], [other.0, other.1, flipped]]
}

/// How often cone and hinges are asked in turn.
const ALTERNATIONS_MAX: u32 = 8;

/// The limb of a ball joint with these angles of its first two hinges, in the first one's rest frame.
#[must_use]
pub fn limb_at(a: f32, b: f32) -> Vec3 {
    let ((sin_a, cos_a), (sin_b, across)) = (math::sin_cos(a), math::sin_cos(b));
    Vec3::new(sin_b, -sin_a * across, cos_a * across)
}

/// The angle that differs from `angle` by whole turns and is within half a turn of `near`.
pub(crate) fn turns_nearest(angle: f32, near: f32) -> f32 {
    let mut angle = angle;
    for _ in 0..4 {
        if angle - near > PI {
            angle -= TAU;
        } else if near - angle > PI {
            angle += TAU;
        }
    }
    angle
}

/// Where one hinge and the link behind it are, in the frame of the root's parent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// Unit axis.
    pub axis: Vec3,
    /// The link's frame: the hinge's, turned by its angle. Its origin is on the axis.
    pub link: Pose,
}

/// Every hinge of a chain, from the root on.
pub type Posture = ArrayVec<Placed, CHAIN_HINGES_MAX>;

/// Forward kinematics. Hinges beyond [`CHAIN_HINGES_MAX`], or without an angle, are left out.
///
/// Cost: one pose composition and one rotation a hinge.
#[must_use]
pub fn posture(hinges: &[Hinge], root: &Pose, angles: &[f32]) -> Posture {
    let mut placed = Posture::new();
    place(hinges, root, angles, &mut placed);
    placed
}

/// The same into a posture, whatever it was.
pub(crate) fn place(hinges: &[Hinge], root: &Pose, angles: &[f32], placed: &mut Posture) {
    let mut link = *root;
    placed.clear();
    for (hinge, &angle) in hinges.iter().zip(angles).take(CHAIN_HINGES_MAX) {
        link = hinge.placed(&link, angle);
        placed.push(Placed {
            axis: link.quat() * hinge.axis,
            link,
        });
    }
}

fn turn_about(axis: Vec3, angle: f32) -> Quat {
    let (sine, cosine) = math::sin_cos(0.5 * angle);
    let v = axis * sine;
    Quat::from_xyzw(v.x, v.y, v.z, cosine)
}

/// One joint as a chain is made from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JointDef {
    /// A joint with one axis.
    Hinge(Hinge),
    /// Three hinges in one place with the axes X, Y and Z of the rest frame: [`Ball`].
    Ball {
        /// Pose of the joint in the frame of the link before it, or of what the chain hangs on.
        rest: Pose,
        /// Least twist about the limb in radians.
        twist_low_rad: f32,
        /// Largest twist about the limb in radians.
        twist_high_rad: f32,
        /// Where the limb, Z turned by the first two hinges, may point, in the rest frame.
        cone: ReachCone,
    },
}

/// How far the first angle of a ball's swing may go, in radians; the second half a turn. The cone decides:
/// an arm raised past overhead goes beyond half a turn without a jump.
pub const SWING_RAD: f32 = 1.5 * PI;

impl JointDef {
    /// One, or three for a ball.
    #[must_use]
    pub const fn hinge_count(&self) -> usize {
        match self {
            Self::Hinge(_) => 1,
            Self::Ball { .. } => 3,
        }
    }

    /// Pose in the frame of the link before it.
    #[must_use]
    pub const fn rest(&self) -> Pose {
        match self {
            Self::Hinge(hinge) => hinge.rest,
            Self::Ball { rest, .. } => *rest,
        }
    }

    /// The joint as hinges. A ball's first two are as wide as the swing can be; its cone limits them.
    #[must_use]
    pub fn hinges(&self) -> ArrayVec<Hinge, 3> {
        let one = |rest, axis, low_rad, high_rad| Hinge {
            rest,
            axis,
            low_rad,
            high_rad,
        };
        match *self {
            Self::Hinge(hinge) => ArrayVec::from_iter([hinge]),
            Self::Ball {
                rest,
                twist_low_rad,
                twist_high_rad,
                ..
            } => ArrayVec::from([
                one(rest, Vec3::X, -SWING_RAD, SWING_RAD),
                one(Pose::IDENTITY, Vec3::Y, -PI, PI),
                one(Pose::IDENTITY, Vec3::Z, twist_low_rad, twist_high_rad),
            ]),
        }
    }
}
