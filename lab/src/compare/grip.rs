//! Two hands that hold a box between their palms; and where a hand meets a box or a ball.

use std::sync::Arc;

use glam::{Quat, Vec3};
use palpable::math::Pose;

use super::judging::reference_pose;
use super::scenes::{block, ease, frames};
use super::setting::{
    Fixed, HandModel, Loose, LooseShape, Perturbation, Setting, Tracked, corners,
};
use crate::reference::{Placed, Solid, signed_distance};

/// Half an edge of the box in metres, its mass in kg, and where its middle is.
const BOX_HALF_M: f32 = 0.03;
const BOX_KG: f32 = 0.2;
const BOX_AT: Vec3 = Vec3::new(0.0, 0.8, 0.0);
/// Half extents of the pedestal in metres; thin, so that the hands have room beside it.
const PEDESTAL_HALF_M: [f32; 3] = [0.01, 0.2, 0.02];

/// The hands close over this time, the pedestal goes, and the scene ends, in seconds.
const CLOSE_S: f32 = 1.0;
const PEDESTAL_S: f32 = 2.0;
const END_S: f32 = 18.0;
/// The box is carried up and then aside from these times on, each way taking so long, in seconds. At its
/// fastest the way is gone at 0.2 m/s.
const UP_S: f32 = 6.0;
const ASIDE_S: f32 = 9.0;
const WAY_S: f32 = std::f32::consts::FRAC_PI_2;
/// Each way of the carried box, in metres.
const WAY_M: f32 = 0.2;

/// Each hand starts this far from the box and ends this far inside it, in metres.
const OPEN_M: f32 = 0.05;
const INSIDE_M: f32 = 0.01;
/// The box's middle on the palm, across and along the hand, in metres.
const PALM_M: [f32; 2] = [0.012, -0.1];
/// One hand points up and the other down by this, so that the thumbs pass each other.
const TILT_RAD: f32 = 0.52;

/// First frame without pedestal.
#[must_use]
pub fn pedestal_frame() -> u32 {
    frames(PEDESTAL_S)
}

/// Frames in which the trackers are still and have been for a second.
#[must_use]
pub fn still_frames(carried: bool) -> std::ops::Range<u32> {
    let moved_s = if carried { ASIDE_S + WAY_S } else { PEDESTAL_S };
    frames(moved_s + 1.0)..frames(END_S)
}

/// How far the trackers have carried the box in a frame.
#[must_use]
pub fn carried_m(frame: u32) -> Vec3 {
    let way = |from_s: f32| WAY_M * ease(frame, frames(from_s), frames(WAY_S));
    Vec3::new(way(ASIDE_S), way(UP_S), 0.0)
}

/// Two hands, a box and its pedestal.
#[must_use]
pub fn setting(right: HandModel, tracker: &Perturbation, carried: bool) -> Setting {
    let left = right.mirrored();
    let top = BOX_AT - Vec3::Y * (BOX_HALF_M + palpable::limits::LOOSE_REST_M);
    let half_y = PEDESTAL_HALF_M[1];
    let pedestal = Fixed {
        until: Some(pedestal_frame()),
        ..block("pedestal", top - Vec3::Y * half_y, PEDESTAL_HALF_M)
    };
    Setting {
        fixed: vec![pedestal],
        loose: vec![Loose {
            shape: LooseShape::Box([BOX_HALF_M; 3]),
            mass_kg: BOX_KG,
            pose: Pose::new(Quat::IDENTITY, BOX_AT),
        }],
        hands: vec![
            holding(right, tracker, 1.0, carried),
            holding(left, tracker, -1.0, carried),
        ],
    }
}

/// A hand whose palm closes on the box from the side that `side` is on along +X.
fn holding(model: HandModel, tracker: &Perturbation, side: f32, carried: bool) -> Tracked {
    let quarter = std::f32::consts::FRAC_PI_2;
    let turn = Quat::from_rotation_x(side * TILT_RAD)
        * Quat::from_rotation_y(tracker.heading_rad)
        * Quat::from_rotation_z(-side * quarter);
    let [across, along] = PALM_M;
    let palm = turn * Vec3::new(side * across, 0.0, along);
    let shift = Vec3::new(0.0, tracker.offset.y, side * tracker.offset.z);
    let middle = Pose::new(turn, shift - palm);
    let touching = touching_box_m(&model, &middle, side);
    let wrist = |frame: u32| {
        let closed = ease(frame, 0, frames(CLOSE_S));
        let out = touching + OPEN_M - (OPEN_M + INSIDE_M) * closed;
        let way = if carried {
            carried_m(frame)
        } else {
            Vec3::ZERO
        };
        middle.moved(BOX_AT + Vec3::X * (side * out) + way)
    };
    Tracked {
        wrist: (0..frames(END_S)).map(wrist).collect(),
        model: Arc::new(model),
    }
}

fn touching_box_m(model: &HandModel, wrist: &Pose, side: f32) -> f32 {
    let points = corners([BOX_HALF_M; 3]);
    touching_m(model, wrist, Vec3::X * side, &points, 0.0)
}

/// How far along +Z a hand must be moved so that it just touches a ball on the floor at the origin, in
/// metres.
#[must_use]
pub fn touching_ball_m(model: &HandModel, wrist: &Pose, radius_m: f32) -> f32 {
    let centre = Vec3::Y * radius_m;
    touching_m(model, wrist, Vec3::Z, &[centre.to_array()], radius_m)
}

/// How far out the search for the touch begins, in metres, and how often it halves its interval.
const FARTHEST_M: f32 = 0.4;
const HALVINGS: u32 = 24;

/// How far along `out` a hand must be moved so that it just touches a rounded hull, in metres.
fn touching_m(
    model: &HandModel,
    wrist: &Pose,
    out: Vec3,
    points: &[[f32; 3]],
    radius_m: f32,
) -> f32 {
    let solid = |points: &[[f32; 3]], radius_m| {
        Solid::from_f32(points, radius_m).expect("parts and things are solids")
    };
    let thing = solid(points, radius_m);
    let thing = Placed::at(&thing, reference_pose(&Pose::IDENTITY));
    let parts: Vec<Solid> = model.points.iter().map(|p| solid(p, 0.0)).collect();
    let is_apart = |far: f32| {
        let wrist = wrist.moved(out * far);
        parts.iter().zip(&model.locals).all(|(part, local)| {
            let part = Placed::at(part, reference_pose(&wrist.then(local)));
            signed_distance(&part, &thing).value > 0.0
        })
    };
    let (mut inside, mut outside) = (0.0, FARTHEST_M);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (inside + outside);
        let far = if is_apart(middle) {
            &mut outside
        } else {
            &mut inside
        };
        *far = middle;
    }
    outside
}
