//! Postures that people can type in, and smooth motion between them.

use std::sync::LazyLock;

use glam::{Quat, Vec3};
use palpable::human::{Limb, lengths, limb_on_root, mirrored_ball_angles, swing_near};

/// Body height of all scripted motions, in metres.
pub const MOTION_HEIGHT_M: f32 = 1.75;

/// A posture of one arm in words that fit both sides, in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Arm {
    /// Where the upper arm points: from straight sideways toward straight ahead and across.
    pub(super) ahead: f32,
    /// Above the horizon; -90 hangs.
    pub(super) up: f32,
    /// Lateral rotation from the ball's zero.
    pub(super) twist: f32,
    pub(super) elbow: f32,
    pub(super) pronation: f32,
}

/// Arm that hangs.
pub(super) const HANGING: Arm = Arm {
    ahead: 90.0,
    up: -90.0,
    twist: 0.0,
    elbow: 0.0,
    pronation: 0.0,
};

/// An arm that points without twist.
pub(super) const fn arm(ahead: f32, up: f32, elbow: f32) -> Arm {
    Arm {
        ahead,
        up,
        elbow,
        ..HANGING
    }
}

impl Arm {
    /// The seven angles of the right or left arm.
    pub(super) fn angles(&self, is_left: bool) -> [f32; 7] {
        let [ahead, up] = [self.ahead, self.up].map(f32::to_radians);
        let level = up.cos();
        let limb = Vec3::new(ahead.cos() * level, up.sin(), -ahead.sin() * level);
        let [a, b] = shoulder_swing(limb);
        let ball = [a, b, self.twist.to_radians()];
        let [a, b, c] = if is_left {
            mirrored_ball_angles(ball)
        } else {
            ball
        };
        let [elbow, pronation] = [self.elbow, self.pronation].map(f32::to_radians);
        [a, b, c, elbow, pronation, 0.0, 0.0]
    }
}

/// Root frame to the right shoulder's rest frame.
static TO_SHOULDER: LazyLock<Quat> = LazyLock::new(|| {
    let arm = limb_on_root(Limb::RightArm, MOTION_HEIGHT_M);
    arm.joints[0].rest().quat().conjugate()
});

/// The swing of a right arm along a unit vector of the root's frame. The first angle is continuous from
/// behind the body over the front to overhead and beyond.
pub(super) fn shoulder_swing(limb: Vec3) -> [f32; 2] {
    let (a, b) = swing_near(*TO_SHOULDER * limb, -std::f32::consts::FRAC_PI_2);
    [a, b]
}

/// A posture of one leg, in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Leg {
    pub(super) flexion: f32,
    pub(super) knee: f32,
}

/// Leg that stands.
pub(super) const STANDING: Leg = Leg {
    flexion: 0.0,
    knee: 0.0,
};

impl Leg {
    /// The six angles of either leg.
    pub(super) fn angles(&self) -> [f32; 6] {
        let [flexion, knee] = [self.flexion, self.knee].map(f32::to_radians);
        [flexion, 0.0, 0.0, knee, 0.0, 0.0]
    }
}

/// Values at frames, and smooth rests and changes between them.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Track<const N: usize> {
    keys: Vec<(u32, [f32; N])>,
}

impl<const N: usize> Track<N> {
    /// Keys in the order of their frames.
    pub(super) fn new(keys: &[(u32, [f32; N])]) -> Self {
        assert!(!keys.is_empty(), "a track has keys");
        assert!(keys.is_sorted_by(|a, b| a.0 < b.0), "keys in order");
        Self {
            keys: keys.to_vec(),
        }
    }

    /// The same for ever.
    pub(super) fn still(value: [f32; N]) -> Self {
        Self::new(&[(0, value)])
    }

    /// Cubic ease between keys: it starts and ends without speed, half as fast again in the middle.
    pub(super) fn at(&self, frame: u32) -> [f32; N] {
        let next = self.keys.partition_point(|key| key.0 <= frame);
        if next == 0 {
            return self.keys[0].1;
        }
        let (from, first) = self.keys[next - 1];
        let Some(&(to, second)) = self.keys.get(next) else {
            return first;
        };
        let t = (frame - from) as f32 / (to - from) as f32;
        let weight = t * t * (3.0 - 2.0 * t);
        std::array::from_fn(|i| first[i] + weight * (second[i] - first[i]))
    }
}

/// Height of the hips of the standing avatar, in metres.
pub(super) const STANDING_HIP_M: f32 = lengths::HIP_HEIGHT * MOTION_HEIGHT_M;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tracks_pass_through_their_keys() {
        let track = Track::new(&[(10, [1.0]), (20, [3.0]), (40, [-1.0])]);
        for (frame, value) in [
            (0, 1.0),
            (10, 1.0),
            (15, 2.0),
            (20, 3.0),
            (30, 1.0),
            (99, -1.0),
        ] {
            assert_eq!(track.at(frame), [value]);
        }
    }

    #[test]
    fn hanging_is_zero() {
        for angle in HANGING.angles(false) {
            assert!(angle.abs() < 1e-6);
        }
    }
}
