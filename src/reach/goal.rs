//! What a chain is asked for: points of links at planes, and the tracked angles.

use arrayvec::ArrayVec;
use glam::Vec3;

use crate::geometry::chain::{Ball, Hinge, Placed, Posture};
use crate::limits::{CHAIN_GOALS_MAX, CHAIN_HINGES_MAX};
use crate::math::{self, Pose};

/// A point of a link that is to be on, or on the outer side of, a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// Index of the link: that behind the hinge of the same index.
    pub link: usize,
    /// The point in the link's frame, in metres.
    pub point: Vec3,
    /// Unit normal of the plane, in the frame of the root's parent.
    pub normal: Vec3,
    /// The plane's distance from the origin along the normal, in metres.
    pub height_m: f32,
    /// Whether the point is to be on the plane, not beyond it.
    pub is_exact: bool,
    /// What missing it costs: a miss of x metres counts as much as changing the angles by
    /// x / sqrt(softness) radians. Zero asks without compromise. In m2/rad2.
    pub softness: f32,
}

/// Derivatives of a goal's height by the angles, in metres per radian.
pub(super) type Row = [f32; CHAIN_HINGES_MAX];

impl Goal {
    /// Three goals that ask for one place.
    #[must_use]
    pub fn place(link: usize, point: Vec3, place: Vec3) -> [Self; 3] {
        Vec3::AXES.map(|normal| Self {
            link,
            point,
            normal,
            height_m: normal.dot(place),
            is_exact: true,
            softness: 0.0,
        })
    }

    /// Whether the goal has to be met.
    #[must_use]
    pub fn is_hard(&self) -> bool {
        let is_soft = self.softness > 0.0;
        !is_soft
    }

    /// Whether missing it to either side costs something, and no more than that.
    pub(super) fn is_spring(&self) -> bool {
        self.is_exact && !self.is_hard()
    }

    /// What missing a soft goal costs, in rad2; nothing for a hard one.
    pub(super) fn soft_cost(&self, posture: &Posture) -> f32 {
        if self.is_hard() {
            return 0.0;
        }
        let missed = self.missed_m(posture);
        0.5 * missed * missed / self.softness
    }

    /// Where the point is. A link that does not exist stands still at the origin.
    pub(super) fn at(&self, posture: &Posture) -> Vec3 {
        posture
            .get(self.link)
            .map_or(Vec3::ZERO, |placed| placed.link.point(self.point))
    }

    /// Height of the point above the plane, in metres.
    pub(super) fn above_m(&self, posture: &Posture) -> f32 {
        self.normal.dot(self.at(posture)) - self.height_m
    }

    /// How far the goal is from met, in metres.
    #[must_use]
    pub fn missed_m(&self, posture: &Posture) -> f32 {
        let above = self.above_m(posture);
        if self.is_exact {
            above.abs()
        } else {
            math::max(-above, 0.0)
        }
    }

    /// Whether both ask for the same point.
    pub(super) fn is_beside(&self, other: &Self) -> bool {
        self.link == other.link && self.point == other.point
    }

    /// How the point turns with each hinge.
    pub(super) fn levers(&self, posture: &Posture) -> Levers {
        let mut levers = Levers {
            at: self.at(posture),
            by: [Vec3::ZERO; CHAIN_HINGES_MAX],
            hinges: posture.len().min(self.link.saturating_add(1)),
        };
        let moving = posture.iter().take(levers.hinges);
        for (by, Placed { axis, link }) in levers.by.iter_mut().zip(moving) {
            *by = axis.cross(levers.at - link.translation());
        }
        levers
    }

    pub(super) fn row(&self, levers: &Levers) -> Row {
        let mut row = [0.0; CHAIN_HINGES_MAX];
        for (slot, by) in row.iter_mut().zip(&levers.by) {
            *slot = self.normal.dot(*by);
        }
        row
    }
}

/// A point and how it turns with the hinges.
pub(super) struct Levers {
    /// Where the point is.
    pub at: Vec3,
    /// Derivatives of its place by the angles, in metres per radian.
    by: [Vec3; CHAIN_HINGES_MAX],
    /// How many hinges, from the root on, move it.
    hinges: usize,
}

impl Levers {
    /// Those of the hinges that move the point, from the root on.
    pub(super) fn by(&self) -> &[Vec3] {
        &self.by[..self.hinges]
    }

    /// How far the point goes along its tangent, in metres.
    pub(super) fn along(&self, turned: &Row) -> Vec3 {
        let ways = self
            .by()
            .iter()
            .zip(turned)
            .map(|(by, turned)| *by * *turned);
        ways.fold(Vec3::ZERO, |sum, way| sum + way)
    }

    /// How far the point leaves its tangent when the joints turn, to second order, in metres.
    pub(super) fn aside(&self, posture: &Posture, turned: &Row) -> Vec3 {
        let (mut spin, mut sum) = (Vec3::ZERO, Vec3::ZERO);
        for ((hinge, by), turned) in posture.iter().zip(self.by()).zip(turned) {
            let own = hinge.axis * *turned;
            sum += (2.0 * spin + own).cross(*by * *turned);
            spin += own;
        }
        0.5 * sum
    }
}

/// The most that any hard goal is from met, in metres.
#[must_use]
pub fn worst_m(goals: &[Goal], posture: &Posture) -> f32 {
    goals
        .iter()
        .filter(|goal| goal.is_hard())
        .fold(0.0, |worst, goal| math::max(worst, goal.missed_m(posture)))
}

/// What a chain is to do.
#[derive(Clone, Copy, Debug)]
pub struct Task<'a> {
    /// The chain; at most [`CHAIN_HINGES_MAX`] hinges are used.
    pub hinges: &'a [Hinge],
    /// Ball joints of the chain, at most [`CHAIN_HINGES_MAX`] / 3.
    pub balls: &'a [Ball],
    /// Where the chain begins.
    pub root: Pose,
    /// The tracked angles in radians.
    pub wanted: &'a [f32],
    /// At most [`crate::limits::CHAIN_GOALS_MAX`] are used.
    pub goals: &'a [Goal],
    /// A goal is met when it is missed by no more than this, in metres.
    pub tolerance_m: f32,
}

impl Task<'_> {
    /// How many hinges have angles.
    pub(super) fn joints(&self, angles: &[f32]) -> usize {
        let both = self.hinges.len().min(angles.len());
        both.min(self.wanted.len()).min(CHAIN_HINGES_MAX)
    }

    /// The goals that are used.
    pub(super) fn used_goals(&self) -> &[Goal] {
        &self.goals[..self.goals.len().min(CHAIN_GOALS_MAX)]
    }

    /// The balls that are used.
    pub(super) fn used_balls(&self) -> &[Ball] {
        &self.balls[..self.balls.len().min(CHAIN_BALLS_MAX)]
    }

    /// Angles to begin with, within the limits.
    pub(super) fn start(&self, angles: &[f32]) -> Angles {
        let kept = self.hinges.iter().zip(angles).map(|(h, &q)| h.kept(q));
        let mut q: Angles = kept.take(self.joints(angles)).collect();
        for ball in self.used_balls() {
            if !ball.kept_with(self.hinges, &mut q) {
                ball.rest(self.hinges, &mut q);
            }
        }
        q
    }

    /// Takes angles into the limits; whether that was possible.
    pub(super) fn admit(&self, q: &mut Angles) -> bool {
        for (angle, hinge) in q.iter_mut().zip(self.hinges) {
            *angle = hinge.kept(*angle);
        }
        let mut balls = self.used_balls().iter();
        balls.all(|ball| ball.kept_with(self.hinges, q))
    }

    /// Half the sum of squared changes from the tracked angles.
    pub(super) fn deviation(&self, q: &Angles) -> f32 {
        let change = q.iter().zip(self.wanted).map(|(q, wanted)| q - wanted);
        change.map(|change| 0.5 * change * change).sum()
    }

    /// What missing the soft goals costs, in rad2.
    pub(super) fn soft_cost(&self, posture: &Posture) -> f32 {
        let goals = self.used_goals().iter();
        goals.map(|goal| goal.soft_cost(posture)).sum()
    }
}

/// How a solver ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reached {
    /// Steps used.
    pub steps: u32,
    /// The most that any hard goal is from met, in metres.
    pub missed_m: f32,
}

/// Angles of a chain.
pub(super) type Angles = ArrayVec<f32, CHAIN_HINGES_MAX>;

/// Most ball joints of one chain.
pub(super) const CHAIN_BALLS_MAX: usize = CHAIN_HINGES_MAX / 3;
