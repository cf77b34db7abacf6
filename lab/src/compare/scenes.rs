//! The scenes of a rigid hand, as settings: what is there and where the trackers go.

use std::ops::Range;
use std::sync::Arc;

use glam::{Mat3, Quat, Vec3};
use palpable::math::Pose;

use super::grip;
use super::setting::{
    Fixed, HandModel, Loose, LooseShape, Perturbation, RATE_HZ, Setting, Tracked, corners,
};
use crate::gallery::{self, SceneryObject, SceneryPiece};
use crate::hand::{Hand, HandPose};

/// A scene of one or two rigid hands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Scene {
    /// Nothing is there, the hand goes to and fro at up to 2 m/s.
    Free,
    /// Flat hand 100 mm into a table for 5 s, then 0.5 m along it 50 mm deep.
    Press,
    /// A ball of 0.5 kg on a floor, pushed by the palm at 2 m/s.
    Push,
    /// The ball pushed against a wall, the tracker 50 to 100 mm farther.
    Trap,
    /// Two hands hold a box of 0.2 kg whose pedestal is taken away.
    Squeeze,
    /// The same, and carry it up and aside.
    Carry,
    /// In free air in the gallery.
    Idle,
}

impl Scene {
    /// All scenes.
    pub const ALL: [Self; 7] = [
        Self::Free,
        Self::Press,
        Self::Push,
        Self::Trap,
        Self::Squeeze,
        Self::Carry,
        Self::Idle,
    ];

    /// What happens, in a few words.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Free => "free motion at 2 m/s",
            Self::Press => "pressed into a table, then slid",
            Self::Push => "ball pushed at 2 m/s",
            Self::Trap => "ball trapped at a wall",
            Self::Squeeze => "two hands hold a box",
            Self::Carry => "two hands carry a box",
            Self::Idle => "idle in the gallery",
        }
    }

    /// The setting for one tracker.
    #[must_use]
    pub fn setting(self, hand: &Hand, tracker: &Perturbation) -> Setting {
        let flat = || HandModel::right(hand, HandPose::Flat, HandPose::Flat, 0.0);
        match self {
            Self::Free => free(flat(), tracker),
            Self::Press => press(flat(), tracker),
            Self::Push => push(flat(), tracker),
            Self::Trap => trap(flat(), tracker),
            Self::Squeeze => grip::setting(flat(), tracker, false),
            Self::Carry => grip::setting(flat(), tracker, true),
            Self::Idle => idle(flat(), tracker),
        }
    }
}

/// Frames of so many seconds.
pub(super) fn frames(seconds: f32) -> u32 {
    (seconds * RATE_HZ).round() as u32
}

/// From 0 to 1 over some frames, without a jump of the speed at either end.
pub(super) fn ease(frame: u32, first: u32, frames: u32) -> f32 {
    let t = frame.saturating_sub(first) as f32 / frames as f32;
    0.5 - 0.5 * (t.min(1.0) * std::f32::consts::PI).cos()
}

/// A fixed box that stays.
pub(super) fn block(name: &'static str, at: Vec3, half: [f32; 3]) -> Fixed {
    Fixed {
        object: SceneryObject {
            name,
            pose: Pose::new(Quat::IDENTITY, at),
            pieces: vec![SceneryPiece {
                points: corners(half),
                half_extents: Some(half),
                local: Pose::IDENTITY,
            }],
        },
        until: None,
    }
}

fn one_hand(fixed: Vec<Fixed>, loose: Vec<Loose>, model: HandModel, wrist: Vec<Pose>) -> Setting {
    let model = Arc::new(model);
    Setting {
        fixed,
        loose,
        hands: vec![Tracked { model, wrist }],
    }
}

fn heading(tracker: &Perturbation) -> Quat {
    Quat::from_rotation_y(tracker.heading_rad)
}

/// Length of the free motion, in seconds, its amplitude in metres and its largest speed in m/s.
const FREE_S: f32 = 5.0;
const FREE_M: f32 = 0.5;
const FREE_M_PER_S: f32 = 2.0;

fn free(model: HandModel, tracker: &Perturbation) -> Setting {
    let wrist = |frame: u32| {
        let phase = FREE_M_PER_S / FREE_M * frame as f32 / RATE_HZ;
        // From rest: no drive follows a jump of the speed.
        let along = heading(tracker) * Vec3::X * (FREE_M * (1.0 - phase.cos()));
        let turn = Quat::from_rotation_z(0.2 * (1.0 - phase.cos())) * heading(tracker);
        Pose::new(turn, Vec3::Y + tracker.offset + along)
    };
    let wrist = (0..frames(FREE_S)).map(wrist).collect();
    one_hand(Vec::new(), Vec::new(), model, wrist)
}

/// When the pressing tracker has arrived, when it rises, and when it begins and ends to slide.
pub const PRESS_FRAMES: [u32; 4] = [45, 495, 518, 608];
const PRESS_END: u32 = 638;
/// How high over the table the hand starts, and how deep its lowest point presses and slides, in metres.
const PRESS_M: [f32; 3] = [0.05, -0.10, -0.05];
const SLIDE_M: f32 = 0.5;

fn press(model: HandModel, tracker: &Perturbation) -> Setting {
    let table = block("table", Vec3::new(0.0, -0.02, 0.0), [0.8, 0.02, 0.5]);
    let turn = heading(tracker);
    let lowest = model.reach_m(&Pose::new(turn, Vec3::ZERO), Vec3::NEG_Y);
    let [above, pressed, sliding] = PRESS_M;
    let [arrived, risen_from, slides, slid] = PRESS_FRAMES;
    let wrist = |frame: u32| {
        let down = (pressed - above) * ease(frame, 0, arrived);
        let up = (sliding - pressed) * ease(frame, risen_from, slides - risen_from);
        let aside = SLIDE_M * (ease(frame, slides, slid - slides) - 0.5);
        let at = Vec3::new(aside, lowest + above + down + up, 0.1);
        let shift = Vec3::new(tracker.offset.x, 0.0, tracker.offset.z);
        Pose::new(turn, at + shift)
    };
    let wrist = (0..PRESS_END).map(wrist).collect();
    one_hand(vec![table], Vec::new(), model, wrist)
}

/// The ball's radius in metres and its mass in kg.
const BALL_M: f32 = 0.06;
const BALL_KG: f32 = 0.5;
/// The hand is on its edge, thumb up, fingers to the right, palm ahead; this much above the floor, and
/// the ball's middle this far along it, in metres.
const EDGE_M: f32 = 0.07;
const PALM_M: f32 = 0.075;

fn on_edge() -> Quat {
    Quat::from_mat3(&Mat3::from_cols(Vec3::NEG_Y, Vec3::Z, Vec3::NEG_X))
}

/// The wrist of a hand on its edge that just touches the ball, at the origin's floor, from behind.
fn edgewise(model: &HandModel, tracker: &Perturbation) -> Pose {
    let turn = heading(tracker) * on_edge();
    let shift = Vec3::new(tracker.offset.x, tracker.offset.y, 0.0);
    let at = heading(tracker) * Vec3::new(-PALM_M, EDGE_M, 0.0) + shift;
    let wrist = Pose::new(turn, at);
    wrist.moved(Vec3::Z * grip::touching_ball_m(model, &wrist, BALL_M))
}

fn floor() -> Fixed {
    block("floor", Vec3::new(0.0, -0.1, 0.0), [2.0, 0.1, 2.0])
}

fn ball(z: f32) -> Loose {
    Loose {
        shape: LooseShape::Sphere(BALL_M),
        mass_kg: BALL_KG,
        pose: Pose::at(0.0, BALL_M + palpable::limits::LOOSE_REST_M, z),
    }
}

/// Speed of the push in m/s, how it is reached in m/s2, how far before the ball it begins in metres, and
/// its length in seconds.
const PUSH_M_PER_S: f32 = 2.0;
const PUSH_M_PER_S2: f32 = 20.0;
const PUSH_BEFORE_M: f32 = 0.15;
const PUSH_S: f32 = 0.7;
/// First frame of the push that certainly has contact.
pub const PUSH_MEETS_FRAME: u32 = 12;

fn push(model: HandModel, tracker: &Perturbation) -> Setting {
    let touching = edgewise(&model, tracker);
    let wrist = |frame: u32| {
        let t = frame as f32 / RATE_HZ;
        let faster = t.min(PUSH_M_PER_S / PUSH_M_PER_S2);
        let way = 0.5 * PUSH_M_PER_S2 * faster * faster + PUSH_M_PER_S * (t - faster);
        touching.moved(Vec3::Z * (PUSH_BEFORE_M - way))
    };
    let wrist = (0..frames(PUSH_S)).map(wrist).collect();
    one_hand(vec![floor()], vec![ball(0.0)], model, wrist)
}

/// When the trapping tracker has arrived, and when the scene ends.
pub const TRAP_FRAMES: Range<u32> = 90..450;
/// The wall is this far behind the ball, the hand starts this far before it, and the tracker goes on so
/// far when the ball is at the wall, in metres.
const TRAP_GAP_M: f32 = 0.01;
const TRAP_BEFORE_M: f32 = 0.05;
const TRAP_BEYOND_M: Range<f32> = 0.05..0.10;

fn trap(model: HandModel, tracker: &Perturbation) -> Setting {
    let face = -BALL_M - TRAP_GAP_M;
    let wall = block("wall", Vec3::new(0.0, 0.5, face - 0.1), [1.0, 0.5, 0.1]);
    let touching = edgewise(&model, tracker);
    let beyond = TRAP_BEYOND_M.start + tracker.share * (TRAP_BEYOND_M.end - TRAP_BEYOND_M.start);
    let wrist = |frame: u32| {
        let way = TRAP_BEFORE_M + TRAP_GAP_M + beyond;
        let ahead = way * ease(frame, 0, TRAP_FRAMES.start) - TRAP_BEFORE_M;
        touching.moved(Vec3::NEG_Z * ahead)
    };
    let wrist = (0..TRAP_FRAMES.end).map(wrist).collect();
    one_hand(vec![floor(), wall], vec![ball(0.0)], model, wrist)
}

/// Length of idling in seconds, and how far the hand strolls in metres.
const IDLE_S: f32 = 5.0;
const IDLE_M: f32 = 0.25;

fn idle(model: HandModel, tracker: &Perturbation) -> Setting {
    let fixed = gallery::gallery().into_iter();
    let fixed = fixed.map(|object| Fixed {
        object,
        until: None,
    });
    let [x, y, z] = gallery::BALL_START;
    let ball = Loose {
        shape: LooseShape::Sphere(gallery::BALL_RADIUS_M),
        mass_kg: BALL_KG,
        pose: Pose::at(x, y, z),
    };
    let wrist = |frame: u32| {
        let t = frame as f32 / RATE_HZ;
        let [x, y, z, turn] = [1.3, 1.7, 0.9, 1.1].map(|rate: f32| 0.5 - 0.5 * (rate * t).cos());
        let stroll = Vec3::new(x, 0.5 * y, z);
        let turn = Quat::from_rotation_y(0.3 * turn) * heading(tracker);
        let middle = Vec3::new(0.0, 1.2, -0.05);
        Pose::new(turn, middle + tracker.offset + IDLE_M * stroll)
    };
    let wrist = (0..frames(IDLE_S)).map(wrist).collect();
    one_hand(fixed.collect(), vec![ball], model, wrist)
}
