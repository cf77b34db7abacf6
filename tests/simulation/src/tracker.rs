//! Trackers of random hosts: they move as people do, and go wrong as trackers do.

use glam::{Quat, Vec3};
use palpable::math::Pose;
use palpable::memory::BodyId;

use crate::draw::Draw;

/// How far a tracker strays from the scene's centre before it turns back, in metres.
const STRAYS_M: f32 = 1.4;

/// What one tracker sees, frame by frame.
#[derive(Clone, Debug)]
pub struct Tracker {
    /// The driven body.
    pub body: BodyId,
    /// Where it is seen.
    pub pose: Pose,
    /// In m/s.
    velocity: Vec3,
    /// In rad/s.
    spin: Vec3,
    /// Frames until it sets out anew.
    left: u32,
    /// Frames for which it sees nothing.
    lost: u32,
    /// Whether it trembles.
    noisy: bool,
}

/// What a tracker tells in a frame.
#[derive(Clone, Copy, Debug)]
pub enum Seen {
    /// Nothing.
    Lost,
    /// A pose.
    Pose(Pose),
    /// A pose with something wrong.
    Bad(Pose),
}

impl Tracker {
    /// A tracker of a body that is at this pose.
    #[must_use]
    pub const fn new(body: BodyId, pose: Pose) -> Self {
        Self {
            body,
            pose,
            velocity: Vec3::ZERO,
            spin: Vec3::ZERO,
            left: 0,
            lost: 0,
            noisy: false,
        }
    }

    /// What is seen after `dt_s` seconds; something goes wrong about once in `clean` frames.
    pub fn see(&mut self, draw: &mut impl Draw, dt_s: f32, home: Vec3, clean: u32) -> Seen {
        if self.left == 0 {
            self.set_out(draw, home);
        }
        self.left -= 1;
        self.go_on(dt_s);
        if self.lost > 0 {
            self.lost -= 1;
            return Seen::Lost;
        }
        if draw.once_in(clean) {
            return self.go_wrong(draw, home);
        }
        if self.noisy {
            let trembling = self.pose.moved(2e-4 * draw.vector());
            return Seen::Pose(trembling);
        }
        Seen::Pose(self.pose)
    }

    fn go_on(&mut self, dt_s: f32) {
        let turn = Quat::from_scaled_axis(self.spin * dt_s) * self.pose.quat();
        let at = self.pose.translation() + self.velocity * dt_s;
        self.pose = Pose::new(turn.normalize(), at);
    }

    fn set_out(&mut self, draw: &mut impl Draw, home: Vec3) {
        self.left = 1 + draw.below(30);
        self.noisy = draw.once_in(4);
        let speed = [0.0, 0.1, 0.5, 1.0, 2.0, 5.0, 10.0, 30.0][draw.below(8) as usize];
        let away = self.pose.translation() - home;
        let toward = if away.length() > STRAYS_M {
            -away.normalize()
        } else {
            draw.vector()
        };
        self.velocity = speed * toward;
        self.spin = [0.0, 0.5, 3.0, 20.0][draw.below(4) as usize] * draw.vector();
    }

    fn go_wrong(&mut self, draw: &mut impl Draw, home: Vec3) -> Seen {
        match draw.below(6) {
            0 => {
                self.lost = draw.below(40);
                Seen::Lost
            }
            1 => Seen::Bad(draw.bad_pose()),
            2 => {
                // The other sign, and another length.
                let scale = [-1.0, 1e-3, 1e3, -1e-18][draw.below(4) as usize];
                let rotation = self.pose.rotation.map(|part| scale * part);
                Seen::Bad(Pose {
                    rotation,
                    ..self.pose
                })
            }
            3 => {
                self.pose = self.pose.moved(0.3 * draw.vector());
                Seen::Pose(self.pose)
            }
            4 => {
                let far = [1.0, 5.0, 1024.0][draw.below(3) as usize];
                let leap = draw.pose(far);
                self.left = 0;
                Seen::Bad(leap)
            }
            _ => {
                self.pose = draw.pose(1.0).moved(home);
                Seen::Pose(self.pose)
            }
        }
    }
}
