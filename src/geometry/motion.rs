//! How a piece moves over a stretch of time, and bounds on how fast.
//!
//! Time runs from 0 to 1 over the stretch. A piece hangs on a root (a body's frame) by a local
//! pose, and both move at once.

use bytemuck::{Pod, Zeroable};
use glam::{Quat, Vec3};

use super::linkage::{LinkPath, PathBounds};
use crate::math::{self, Pose};

/// The way of one frame: positions linear, orientations by normalised linear interpolation along
/// the shorter arc. Only the part from `start` to `end` (shares of the whole way) is travelled.
#[derive(Clone, Copy, Debug)]
pub struct Track {
    /// Pose at share 0.
    pub from: Pose,
    /// Pose at share 1.
    pub to: Pose,
    /// Share of the way at time 0.
    pub start: f32,
    /// Share of the way at time 1.
    pub end: f32,
}

/// Bounds of a track's motion per unit of time.
#[derive(Clone, Copy, Debug)]
struct TrackBounds {
    /// Linear velocity, constant over the track.
    linear: Vec3,
    /// Largest angular speed in radians.
    angular: f32,
    /// Largest length of the second derivative of the rotation matrix.
    curvature: f32,
}

impl Track {
    /// A frame that stays where it is.
    #[must_use]
    pub const fn still(pose: Pose) -> Self {
        Self {
            from: pose,
            to: pose,
            start: 0.0,
            end: 0.0,
        }
    }

    /// The whole way between two poses.
    #[must_use]
    pub const fn between(from: Pose, to: Pose) -> Self {
        Self {
            from,
            to,
            start: 0.0,
            end: 1.0,
        }
    }

    /// The same turn at the origin.
    #[must_use]
    pub const fn turning(&self) -> Self {
        Self {
            from: Pose {
                position: [0.0; 3],
                ..self.from
            },
            to: Pose {
                position: [0.0; 3],
                ..self.to
            },
            ..*self
        }
    }

    /// The pose at a time in 0..=1.
    #[inline]
    #[must_use]
    pub fn at(&self, time: f32) -> Pose {
        interpolate(&self.from, &self.to, self.share(time))
    }

    /// The share of the way that is done at a time in 0..=1.
    #[inline]
    fn share(&self, time: f32) -> f32 {
        if time >= 1.0 {
            self.end
        } else {
            self.start + (self.end - self.start) * time
        }
    }

    /// With q the normalised interpolation and half-angle f between the ends, the angular speed is
    /// 2 sin f / |q|^2 <= 4 tan(f/2) = W, and its rate is at most W^3 / 4 (largest at an end).
    fn bounds(&self) -> TrackBounds {
        if self.start == self.end || self.from == self.to {
            return TrackBounds {
                linear: Vec3::ZERO,
                angular: 0.0,
                curvature: 0.0,
            };
        }
        let span = self.end - self.start;
        let (a, b) = (self.from.quat(), self.to.quat());
        let chord = (math::nearer_sign(b, a) - a).length_squared();
        let tangent_squared = chord / math::max(4.0 - chord, 1e-3);
        let whole = 4.0 * math::sqrt(tangent_squared);
        TrackBounds {
            linear: (self.to.translation() - self.from.translation()) * span,
            angular: whole * span,
            curvature: (whole * whole + 0.25 * whole * whole * whole) * span * span,
        }
    }
}

/// A pose between two poses; exactly `from` at 0 and exactly `to` at 1.
#[must_use]
pub fn interpolate(from: &Pose, to: &Pose, share: f32) -> Pose {
    if share <= 0.0 || from == to {
        return *from;
    }
    if share >= 1.0 {
        return *to;
    }
    let p = from.translation() + (to.translation() - from.translation()) * share;
    Pose::new(interpolate_rotation(from.quat(), to.quat(), share), p)
}

fn interpolate_rotation(from: Quat, to: Quat, share: f32) -> Quat {
    if from == to {
        return from;
    }
    let to = math::nearer_sign(to, from);
    math::renormalised(from + (to - from) * share)
}

/// How fast a piece moves at the most, per unit of time: what its parting from others is judged by.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Course {
    /// Linear velocity that the whole root shares.
    pub linear: Vec3,
    /// Largest speed of any point of the piece beyond `linear`.
    pub turning: f32,
    /// How far the way's middle is from the straight one, times -4: the root is `bow (t^2 - t)` beside it.
    pub bow: Vec3,
}

impl Course {
    /// Upper bound of the speed at which the gap to B along `normal`, from B into A, shrinks from `time` on.
    #[must_use]
    pub fn approach(&self, b: &Self, normal: Vec3, time: f32) -> f32 {
        let linear = normal.dot(b.linear - self.linear);
        let bow = normal.dot(b.bow - self.bow);
        let bowed = math::max(bow, (2.0 * time - 1.0) * bow);
        math::max(0.0, linear + self.turning + b.turning + bowed)
    }

    /// Upper bound of the way of any point of the piece over the whole time, in metres.
    #[must_use]
    pub fn way_m(&self) -> f32 {
        math::length(self.linear) + self.turning + math::length(self.bow)
    }
}

/// How a piece moves: by its root, with a link of its root's skeleton, and within that frame.
#[derive(Clone, Copy, Debug)]
pub struct Motion<'a> {
    root: Track,
    link: Option<LinkPath<'a>>,
    local: Track,
    /// How fast any point of the piece is.
    pub course: Course,
    /// Largest acceleration of any point of the piece, the bow's aside.
    pub acceleration: f32,
}

impl<'a> Motion<'a> {
    /// The motion of a piece whose core lies within `core_reach_m` of its own origin.
    ///
    /// A point x of the piece is at p(t) + R(t) (l(t) + L(t) x), so its second derivative is
    /// R'' (l + L x) + 2 R' (l' + L' x) + R L'' x: p and l move linearly.
    #[must_use]
    pub fn new(root: Track, local: Track, core_reach_m: f32) -> Self {
        Self::with(root, None, local, core_reach_m)
    }

    /// The motion of a piece on a link. The link's shares are those of the root's track.
    ///
    /// Cost: two passes over the hinges between the link and the root.
    #[must_use]
    pub fn of_link(root: Track, link: LinkPath<'a>, local: Track, core_reach_m: f32) -> Self {
        Self::with(root, Some(link), local, core_reach_m)
    }

    fn with(root: Track, link: Option<LinkPath<'a>>, local: Track, core_reach_m: f32) -> Self {
        let (r, l) = (root.bounds(), local.bounds());
        let arm = arm_m(&local) + core_reach_m;
        let path = link.map_or(PathBounds::default(), |link| link.bounds(arm));
        let arm = math::max(path.arm, arm);
        let span = root.end - root.start;
        let own_speed = math::length(l.linear) + l.angular * core_reach_m;
        let local_speed = own_speed + path.speed * span;
        Self {
            root,
            link,
            local,
            course: Course {
                linear: r.linear,
                turning: r.angular * arm + local_speed,
                bow: Vec3::ZERO,
            },
            acceleration: r.curvature * arm
                + 2.0 * r.angular * local_speed
                + l.curvature * core_reach_m
                + span * (path.acceleration * span + 2.0 * path.angular * own_speed),
        }
    }

    /// The same motion along a parabola: `bow (t^2 - t)` beside the straight way, half the constant
    /// acceleration over the whole time.
    #[must_use]
    pub fn bowed(mut self, bow: Vec3) -> Self {
        self.course.bow = bow;
        self
    }

    /// A piece that does not move.
    #[must_use]
    pub fn still(pose: Pose) -> Self {
        Self {
            root: Track::still(pose),
            link: None,
            local: Track::still(Pose::IDENTITY),
            course: Course::default(),
            acceleration: 0.0,
        }
    }

    /// The piece's pose in the world at a time in 0..=1.
    #[inline]
    #[must_use]
    pub fn at(&self, time: f32) -> Pose {
        let mut root = self.root.at(time);
        let bow = self.course.bow;
        if bow != Vec3::ZERO {
            root = root.moved(bow * (time * time - time));
        }
        if let Some(link) = &self.link {
            root = root.then(&link.at(self.root.share(time)));
        }
        if self.local.to == Pose::IDENTITY && self.local.from == Pose::IDENTITY {
            return root;
        }
        root.then(&self.local.at(time))
    }

    /// How far any point of the piece can be from the straight line between its ends, in metres.
    #[must_use]
    pub fn bulge_m(&self) -> f32 {
        0.125 * self.acceleration + 0.25 * math::length(self.course.bow)
    }

    /// Upper bound of the way of any point of the piece over the whole time, in metres.
    #[must_use]
    pub fn way_m(&self) -> f32 {
        self.course.way_m()
    }
}

/// The farthest that the local frame's origin gets from the root's, in metres.
fn arm_m(local: &Track) -> f32 {
    let from = math::length(local.from.translation());
    if local.start == 0.0 && local.end == 0.0 {
        return from;
    }
    math::max(from, math::length(local.to.translation()))
}
