//! Slaps of the avatar's arm at a plate of 20 mm: does anything end behind it?

use palpable::human::Limb;
use palpable::limits::OVERLAP_SLOP_M;
use palpable::memory::PieceId;
use palpable::world::World;

use super::play::play_and;
use super::scenes::of_slap;
use super::{Figure, refused};
use crate::avatar::AvatarPlan;
use crate::avatar::motions::{ArmSlap, Obstacle};
use crate::hand_scene::SceneError;
use crate::reference;
use crate::report::{ArmSlaps, Quantiles};

/// Plays slaps and counts those that went through the plate: a corner of the arm lies behind the plate
/// within its outline in any frame, or the overlap is deeper than promised.
///
/// # Errors
/// [`SceneError`] names what the world refused.
pub fn run(
    plan: &AvatarPlan,
    slaps: &[ArmSlap],
    mut tick: impl FnMut(),
) -> Result<ArmSlaps, SceneError> {
    let figure = Figure::of_avatar(plan);
    let arm = plan
        .chain(Limb::RightArm)
        .ok_or_else(|| SceneError("an avatar without an arm".to_owned()))?;
    let mut total = ArmSlaps {
        slaps: slaps.len() as u32,
        speed_min: f64::INFINITY,
        speed_max: 0.0,
        tunnelled_speeds: Vec::new(),
        touched: 0,
        overlap_mm_max: 0.0,
        overlap_own_mm_max: 0.0,
        beyond_limits_rad_max: 0.0,
        frame_time_us: None,
    };
    let mut times = Vec::new();
    for slap in slaps {
        let speed = f64::from(slap.speed);
        total.speed_min = total.speed_min.min(speed);
        total.speed_max = total.speed_max.max(speed);
        let mut behind = false;
        let played = play_and(&of_slap(&figure, slap), |world, ids| {
            behind |= is_behind(&figure, world, &ids.pieces, arm, &slap.plate)?;
            Ok(())
        })?;
        let mut deepest_mm: f64 = 0.0;
        for sample in &played.samples {
            deepest_mm = deepest_mm.max(sample.found.fixed_mm);
            total.overlap_own_mm_max = total.overlap_own_mm_max.max(sample.found.own_mm);
            total.beyond_limits_rad_max = total.beyond_limits_rad_max.max(sample.beyond_rad);
        }
        total.touched += u32::from(played.samples.iter().any(|s| s.contacts > 0));
        times.extend(played.samples.iter().map(|s| s.time_us));
        total.overlap_mm_max = total.overlap_mm_max.max(deepest_mm);
        if behind || deepest_mm > 1e3 * f64::from(OVERLAP_SLOP_M) {
            total.tunnelled_speeds.push(speed);
        }
        tick();
    }
    total.frame_time_us = Quantiles::from_samples(&mut times);
    Ok(total)
}

/// Whether a corner of the arm is behind a plate, within its outline.
fn is_behind(
    figure: &Figure,
    world: &World,
    pieces: &[PieceId],
    arm: usize,
    plate: &Obstacle,
) -> Result<bool, SceneError> {
    let to_plate = reference::Pose::from_f32(plate.pose.rotation, plate.pose.position);
    let [thick, high, wide] = plate.half_m.map(f64::from);
    for (piece, &id) in figure.pieces.iter().zip(pieces) {
        if piece.link.is_none_or(|(chain, _)| chain != arm) {
            continue;
        }
        let pose = world.piece_pose(id).map_err(|why| refused("piece", why))?;
        let pose = reference::Pose::from_f32(pose.rotation, pose.position);
        for point in &piece.points {
            let corner = pose.rotation * glam::DVec3::from_array(point.map(f64::from));
            let corner = to_plate.rotation.inverse() * (corner + pose.position - to_plate.position);
            let inside = corner.y.abs() < high && corner.z.abs() < wide;
            if inside && corner.x > thick - f64::from(OVERLAP_SLOP_M) {
                return Ok(true);
            }
        }
    }
    Ok(false)
}
