//! The chains that are measured: an arm, a finger, an arm with a ball shoulder, and an avatar's five.

use std::f32::consts::PI;

use glam::{Quat, Vec3};
use palpable::geometry::chain::{Ball, Hinge};
use palpable::geometry::reach_cone::ReachCone;
use palpable::math::Pose;
use serde::Serialize;

/// A chain's shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Model {
    /// A shoulder of three hinges, an elbow, a forearm's twist, a wrist of two.
    Arm,
    /// A knuckle of two hinges and two hinges more.
    Finger,
    /// The arm with a reach cone instead of the shoulder's ranges.
    BallArm,
}

impl Model {
    /// All models.
    pub const ALL: [Self; 3] = [Self::Arm, Self::Finger, Self::BallArm];

    /// The model's name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Arm => "arm, 7 joints",
            Self::Finger => "finger, 4 joints",
            Self::BallArm => "arm, ball shoulder",
        }
    }

    /// The chain.
    pub fn chain(self) -> Chain {
        match self {
            Self::Arm => arm(),
            Self::Finger => finger(),
            Self::BallArm => ball_arm(),
        }
    }
}

/// A chain and the point at its end.
#[derive(Clone, Debug)]
pub struct Chain {
    /// Where the chain begins.
    pub root: Pose,
    /// Its hinges.
    pub hinges: Vec<Hinge>,
    /// Its ball joints.
    pub balls: Vec<Ball>,
    /// The end in the last link's frame, in metres.
    pub tip: Vec3,
    /// The links that pushes are given to.
    pub pushed: Vec<usize>,
    /// The joint whose zero makes the chain straight.
    pub bends: Vec<usize>,
}

impl Chain {
    /// The last link.
    pub fn last(&self) -> usize {
        self.hinges.len() - 1
    }
}

fn hinge(at: Vec3, axis: Vec3, low_rad: f32, high_rad: f32) -> Hinge {
    Hinge {
        rest: Pose::new(Quat::IDENTITY, at),
        axis,
        low_rad,
        high_rad,
    }
}

/// The 7-joint arm: 0.30 m, 0.26 m, and a tip 80 mm on.
pub fn arm() -> Chain {
    let (upper, fore) = (Vec3::NEG_Y * 0.30, Vec3::NEG_Y * 0.26);
    Chain {
        root: Pose::IDENTITY,
        hinges: vec![
            hinge(Vec3::ZERO, Vec3::X, -2.8, 1.0),
            hinge(Vec3::ZERO, Vec3::Z, -0.5, 2.8),
            hinge(Vec3::ZERO, Vec3::Y, -1.5, 1.5),
            hinge(upper, Vec3::X, -2.5, 0.0),
            hinge(Vec3::ZERO, Vec3::Y, -1.4, 1.4),
            hinge(fore, Vec3::X, -1.2, 1.2),
            hinge(Vec3::ZERO, Vec3::Z, -0.4, 0.6),
        ],
        balls: vec![],
        tip: Vec3::NEG_Y * 0.08,
        pushed: vec![3, 4, 6, 6],
        bends: vec![3, 5, 6],
    }
}

/// A forefinger: phalanges of 45, 25 and 22 mm.
fn finger() -> Chain {
    Chain {
        root: Pose::IDENTITY,
        hinges: vec![
            hinge(Vec3::ZERO, Vec3::Y, -0.35, 0.35),
            hinge(Vec3::ZERO, Vec3::X, -1.6, 0.5),
            hinge(Vec3::NEG_Z * 0.045, Vec3::X, -1.9, 0.0),
            hinge(Vec3::NEG_Z * 0.025, Vec3::X, -1.2, 0.1),
        ],
        balls: vec![],
        tip: Vec3::NEG_Z * 0.022,
        pushed: vec![2, 3, 3],
        bends: vec![2, 3],
    }
}

/// The arm with a ball at the shoulder: the limb is Z, X points up at rest.
fn ball_arm() -> Chain {
    let turned = Quat::from_rotation_x(0.5 * PI);
    let mut hinges = arm().hinges;
    for (hinge, axis) in hinges.iter_mut().zip(Vec3::AXES) {
        *hinge = Hinge {
            rest: Pose::IDENTITY,
            axis,
            low_rad: -PI,
            high_rad: PI,
        };
    }
    hinges[0].rest = Pose::new(turned, Vec3::ZERO);
    // The middle hinge stays short of its poles: each direction of the limb has one pair of angles.
    hinges[1].low_rad = -0.5 * PI;
    hinges[1].high_rad = 0.5 * PI;
    hinges[2].low_rad = -1.5;
    hinges[2].high_rad = 1.5;
    // From the limb's frame to the arm's, whose limb is -Y.
    hinges[3].rest = Pose::new(turned.conjugate(), Vec3::Z * 0.30);
    Chain {
        hinges,
        balls: vec![Ball {
            first: 0,
            cone: shoulder(),
        }],
        ..arm()
    }
}

/// Seven corners of a convex cone about (0.3, -0.3, 0.9), some 70 degrees wide.
fn shoulder() -> ReachCone {
    let axis = Vec3::new(0.3, -0.3, 0.9).normalize();
    let (u, v) = axis.any_orthonormal_pair();
    let spread = [1.1, 0.95, 1.15, 1.0, 0.9, 1.1, 1.0_f32];
    let corners: Vec<Vec3> = (0..7_u8)
        .zip(spread)
        .map(|(index, spread)| {
            let turn = 2.0 * PI * f32::from(index) / 7.0;
            let aside = u * turn.cos() + v * turn.sin();
            axis * spread.cos() + aside * spread.sin()
        })
        .collect();
    ReachCone::new(axis, &corners).expect("a convex cone about its axis")
}

/// An avatar's five chains: two arms, two legs, a neck.
pub fn avatar() -> Vec<Chain> {
    let at = |x: f32, y: f32| Pose::at(x, y, 0.0);
    let left = Chain {
        root: at(0.2, 1.4),
        ..arm()
    };
    let mut right = Chain {
        root: at(-0.2, 1.4),
        ..arm()
    };
    // Mirrored: the hinges about Y and Z turn the other way.
    for hinge in &mut right.hinges {
        if hinge.axis != Vec3::X {
            (hinge.low_rad, hinge.high_rad) = (-hinge.high_rad, -hinge.low_rad);
        }
    }
    vec![left, right, leg(0.1), leg(-0.1), neck()]
}

fn leg(aside: f32) -> Chain {
    let (thigh, shin) = (Vec3::NEG_Y * 0.42, Vec3::NEG_Y * 0.40);
    Chain {
        root: Pose::at(aside, 0.9, 0.0),
        hinges: vec![
            hinge(Vec3::ZERO, Vec3::X, -0.5, 2.0),
            hinge(Vec3::ZERO, Vec3::Z, -0.7, 0.7),
            hinge(Vec3::ZERO, Vec3::Y, -0.6, 0.6),
            hinge(thigh, Vec3::X, -2.3, 0.0),
            hinge(shin, Vec3::X, -0.6, 0.4),
            hinge(Vec3::ZERO, Vec3::Z, -0.3, 0.3),
        ],
        balls: vec![],
        tip: Vec3::new(0.0, -0.07, -0.12),
        pushed: vec![5],
        bends: vec![3],
    }
}

fn neck() -> Chain {
    Chain {
        root: Pose::at(0.0, 1.5, 0.0),
        hinges: vec![
            hinge(Vec3::ZERO, Vec3::Y, -1.2, 1.2),
            hinge(Vec3::Y * 0.06, Vec3::X, -0.7, 0.9),
            hinge(Vec3::Y * 0.06, Vec3::Z, -0.6, 0.6),
        ],
        balls: vec![],
        tip: Vec3::new(0.02, 0.12, -0.1),
        pushed: vec![2],
        bends: vec![1],
    }
}
