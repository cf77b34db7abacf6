//! What was published, judged in f64: overlap, lag behind the tracker, and motion from frame to frame.

use std::sync::Arc;

use glam::DVec3;
use palpable::limits::WORLD_REACH_M;
use palpable::math::Pose;

use super::play::Shot;
use super::setting::{HandModel, Setting};
use crate::hand_scene::{FIXED, HAND, SceneError};
use crate::reference::{self, Judge, Solid};

/// The judge's category of loose things.
pub const LOOSE: &str = "loose";

/// What one frame showed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reading {
    /// CPU time for telling the targets and stepping, in microseconds.
    pub time_us: f64,
    /// Deepest overlap of a hand and a fixed thing, in millimetres.
    pub hand_fixed_mm: f64,
    /// Deepest overlap of a hand and a loose thing, in millimetres.
    pub hand_loose_mm: f64,
    /// Deepest overlap of a loose thing and a fixed one, in millimetres.
    pub loose_fixed_mm: f64,
    /// How far any point of a hand is from where the tracker has it, in millimetres.
    pub lag_mm: f64,
    /// How far any point of a hand or a loose thing went since the frame before, in millimetres.
    pub moved_mm: f64,
}

/// Judges every frame that was published.
///
/// # Errors
/// [`SceneError`] names the piece that the reference refused.
pub fn judge(setting: &Setting, shots: &[Shot]) -> Result<Vec<Reading>, SceneError> {
    let mut readings: Vec<Reading> = Vec::new();
    let mut judge = judge_at(setting, 0)?;
    for (frame, shot) in shots.iter().enumerate() {
        let changes = |fixed: &super::setting::Fixed| fixed.until == Some(frame as u32);
        let changed = setting.fixed.iter().any(changes);
        if changed {
            judge = judge_at(setting, frame as u32)?;
        }
        let before = frame.checked_sub(1).map(|before| &shots[before]);
        let moved_mm = before.map_or(0.0, |before| moved_mm(setting, before, shot));
        let stayed = before.is_some_and(|b| b.hands == shot.hands && b.loose == shot.loose);
        let overlaps = match readings.last() {
            // The same bits get the same verdict.
            Some(last) if stayed && !changed => *last,
            _ => overlaps(&judge, shot),
        };
        readings.push(Reading {
            time_us: shot.spent.as_secs_f64() * 1e6,
            lag_mm: lag_mm(setting, shot, frame),
            moved_mm,
            ..overlaps
        });
    }
    Ok(readings)
}

fn overlaps(judge: &Judge, shot: &Shot) -> Reading {
    let poses: Vec<_> = shot.hands.iter().flatten().chain(&shot.loose).collect();
    let poses: Vec<_> = poses.into_iter().map(reference_pose).collect();
    let verdict = judge.frame(&poses);
    Reading {
        hand_fixed_mm: 1e3 * verdict.depth_between(HAND, FIXED),
        hand_loose_mm: 1e3 * verdict.depth_between(HAND, LOOSE),
        loose_fixed_mm: 1e3 * verdict.depth_between(LOOSE, FIXED),
        ..Reading::default()
    }
}

/// A pose for the reference.
#[must_use]
pub fn reference_pose(pose: &Pose) -> reference::Pose {
    reference::Pose::from_f32(pose.rotation, pose.position)
}

/// A judge of what is there in a frame.
fn judge_at(setting: &Setting, frame: u32) -> Result<Judge, SceneError> {
    let refused = |why| SceneError(format!("reference: {why:?}"));
    let mut judge = Judge::new();
    let there = |until: Option<u32>| until.is_none_or(|until| frame < until);
    for fixed in setting.fixed.iter().filter(|fixed| there(fixed.until)) {
        let object = &fixed.object;
        for piece in &object.pieces {
            let solid = Solid::from_f32(&piece.points, 0.0).map_err(refused)?;
            let at = reference_pose(&object.pose.then(&piece.local));
            judge.add_fixed(solid, FIXED_GROUP, FIXED, object.name, at);
        }
    }
    for (group, hand) in (0..).zip(&setting.hands) {
        for (points, name) in hand.model.points.iter().zip(&hand.model.names) {
            let solid = Solid::from_f32(points, 0.0).map_err(refused)?;
            judge.add_moving(Arc::new(solid), group, HAND, name);
        }
    }
    for (group, loose) in (LOOSE_GROUP..).zip(&setting.loose) {
        let (points, radius_m) = loose.shape.points();
        let solid = Solid::from_f32(&points, radius_m).map_err(refused)?;
        judge.add_moving(Arc::new(solid), group, LOOSE, LOOSE);
    }
    Ok(judge)
}

const FIXED_GROUP: u32 = 1000;
const LOOSE_GROUP: u32 = 2000;

/// The largest of some values that are not negative; one that is not a number counts as the largest.
pub(super) fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |most, value| {
        if value.is_nan() || value > most {
            value
        } else {
            most
        }
    })
}

/// The largest distance between the same point of a part at two poses, in millimetres; exactly zero for
/// equal bits.
fn apart_mm(points: &[[f32; 3]], one: &Pose, other: &Pose) -> f64 {
    if one == other {
        return 0.0;
    }
    let (one, other) = (reference_pose(one), reference_pose(other));
    let apart = |p: &[f32; 3]| {
        let p = DVec3::from_array(p.map(f64::from));
        let moved = one.rotation * p - other.rotation * p;
        1e3 * (moved + (one.position - other.position)).length()
    };
    largest(points.iter().map(apart))
}

fn hand_apart_mm(model: &HandModel, one: &[Pose], other: &[Pose]) -> f64 {
    let parts = model.points.iter().zip(one.iter().zip(other));
    largest(parts.map(|(points, (one, other))| apart_mm(points, one, other)))
}

fn moved_mm(setting: &Setting, before: &Shot, after: &Shot) -> f64 {
    let hands = setting.hands.iter().zip(&before.hands).zip(&after.hands);
    let hands = hands.map(|((hand, before), after)| hand_apart_mm(&hand.model, before, after));
    let loose = setting.loose.iter().zip(&before.loose).zip(&after.loose);
    let loose = loose.map(|((loose, before), after)| {
        let (mut points, radius_m) = loose.shape.points();
        points.extend([[radius_m, 0.0, 0.0], [0.0, radius_m, 0.0]]);
        apart_mm(&points, before, after)
    });
    largest(hands.chain(loose))
}

fn lag_mm(setting: &Setting, shot: &Shot, frame: usize) -> f64 {
    let hands = setting.hands.iter().zip(&shot.hands);
    let lags = hands.map(|(hand, parts)| {
        let wrist = normalised(&hand.wrist[frame]);
        let wanted: Vec<Pose> = hand
            .model
            .locals
            .iter()
            .map(|local| wrist.then(&normalised(local)))
            .collect();
        hand_apart_mm(&hand.model, &wanted, parts)
    });
    largest(lags)
}

fn normalised(pose: &Pose) -> Pose {
    pose.normalised(WORLD_REACH_M).unwrap_or(*pose)
}
