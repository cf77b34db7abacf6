//! Slaps of the avatar's arm at a plate of 20 mm: does anything end behind it?

use palpable::human::Limb;
use palpable::limits::OVERLAP_SLOP_M;
use palpable::math::Pose;
use palpable::memory::PieceId;
use palpable::world::World;

use super::judge::{OWN_MM_MAX, at, depth_m, solids_of};
use super::play::{Sample, play_and};
use super::scenes::{corners, of_slap};
use super::{Figure, FigureIds, FigurePiece, refused};
use crate::avatar::motions::{ArmSlap, Obstacle};
use crate::avatar::{AvatarPlan, Link, PiecePlan, Target};
use crate::hand_scene::SceneError;
use crate::reference::{self, Solid};
use crate::report::{ArmSlaps, Quantiles};

/// What a piece may lack of the overlap that it has halfway through the plate, in metres, for the turning
/// between two places.
const ROUNDING_M: f64 = 5e-4;

/// Places between two frames that are looked at.
const BETWEEN: u32 = 32;

/// Plays slaps and counts those that went through the plate: the published overlap is deeper than promised,
/// or the straight way of the angles from one published frame to the next leads through the plate. Halfway
/// through, a piece overlaps by half of the plate and of its own width. The kernel's own way may bend round
/// the plate's edge within a frame, where the straight one cuts the corner and overlaps by less; an arm that
/// slides off the edge and swings on may end behind the plate, too: those are counted apart.
///
/// # Errors
/// [`SceneError`] names what the world refused.
pub fn run(
    plan: &AvatarPlan,
    slaps: &[ArmSlap],
    mut tick: impl FnMut(),
) -> Result<ArmSlaps, SceneError> {
    let figure = Figure::of_avatar(plan);
    let arm = Arm::new(plan, &figure)?;
    let mut total = ArmSlaps {
        slaps: slaps.len() as u32,
        speed_min: f64::INFINITY,
        speed_max: 0.0,
        tunnelled_speeds: Vec::new(),
        behind: 0,
        touched: 0,
        overlap_mm_max: 0.0,
        overlap_between_mm_max: 0.0,
        overlap_own_mm_max: 0.0,
        began_in_itself: 0,
        beyond_limits_rad_max: 0.0,
        frame_time_us: None,
    };
    let mut times = Vec::new();
    for slap in slaps {
        let speed = f64::from(slap.speed);
        total.speed_min = total.speed_min.min(speed);
        total.speed_max = total.speed_max.max(speed);
        let mut behind = false;
        let mut between = Between::default();
        let mut before = slap.target(0);
        let played = play_and(&of_slap(&figure, slap), |world, ids| {
            let now = published(world, ids)?;
            between = between.and(arm.between(plan, [&before, &now], &slap.plate)?);
            before = now;
            behind |= arm.is_behind(&figure, world, &ids.pieces, &slap.plate)?;
            Ok(())
        })?;
        let samples = &played.samples;
        let most = |value: fn(&Sample) -> f64| samples.iter().map(value).fold(0.0, f64::max);
        let deepest_mm = most(|s| s.found.fixed_mm);
        if samples.first().is_some_and(|s| s.found.own_mm > OWN_MM_MAX) {
            total.began_in_itself += 1;
            total.overlap_own_mm_max = total.overlap_own_mm_max.max(most(|s| s.found.own_grown_mm));
        } else {
            total.overlap_own_mm_max = total.overlap_own_mm_max.max(most(|s| s.found.own_mm));
        }
        total.beyond_limits_rad_max = total.beyond_limits_rad_max.max(most(|s| s.beyond_rad));
        total.touched += u32::from(samples.iter().any(|s| s.contacts > 0));
        times.extend(samples.iter().map(|s| s.time_us));
        total.overlap_mm_max = total.overlap_mm_max.max(deepest_mm);
        total.overlap_between_mm_max = total.overlap_between_mm_max.max(1e3 * between.deepest_m);
        let slop_mm = 1e3 * f64::from(OVERLAP_SLOP_M);
        if deepest_mm > slop_mm || between.goes_through {
            total.tunnelled_speeds.push(speed);
        }
        total.behind += u32::from(behind);
        tick();
    }
    total.frame_time_us = Quantiles::from_samples(&mut times);
    Ok(total)
}

fn published(world: &World, ids: &FigureIds) -> Result<Target, SceneError> {
    let root = world.pose(ids.body).map_err(|why| refused("root", why))?;
    let angles = ids.chains.iter().map(|&chain| {
        let angles = world.angles(chain).map_err(|why| refused("chain", why))?;
        Ok(angles.to_vec())
    });
    let angles = angles.collect::<Result<_, SceneError>>()?;
    Ok(Target { root, angles })
}

/// What was seen on the straight way between two frames.
#[derive(Clone, Copy, Debug, Default)]
struct Between {
    /// Deepest overlap with the plate.
    deepest_m: f64,
    /// Whether a piece came to the middle of the plate.
    goes_through: bool,
}

impl Between {
    fn and(self, other: Self) -> Self {
        Self {
            deepest_m: self.deepest_m.max(other.deepest_m),
            goes_through: self.goes_through || other.goes_through,
        }
    }
}

/// How far a piece extends along a plate's normal, in metres.
fn along_normal_m(piece: &PiecePlan, pose: &Pose, plate: &Obstacle) -> [f64; 2] {
    let [pose, to] =
        [pose, &plate.pose].map(|pose| reference::Pose::from_f32(pose.rotation, pose.position));
    let normal = to.rotation * glam::DVec3::X;
    let along = piece.points.iter().map(|point| {
        let corner = pose.rotation * glam::DVec3::from_array(point.map(f64::from));
        normal.dot(corner + pose.position - to.position)
    });
    let radius = f64::from(piece.radius_m);
    along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
        [low.min(x - radius), high.max(x + radius)]
    })
}

/// The right arm's pieces.
struct Arm {
    chain: usize,
    solids: Vec<Solid>,
}

impl Arm {
    fn new(plan: &AvatarPlan, figure: &Figure) -> Result<Self, SceneError> {
        let chain = plan.chain(Limb::RightArm);
        Ok(Self {
            chain: chain.ok_or_else(|| refused("slap", "no right arm"))?,
            solids: solids_of(figure)?,
        })
    }

    fn has(&self, piece: &FigurePiece) -> bool {
        piece.link.is_some_and(|(chain, _)| chain == self.chain)
    }

    /// Follows the straight way of the angles between two frames.
    fn between(
        &self,
        plan: &AvatarPlan,
        [from, to]: [&Target; 2],
        plate: &Obstacle,
    ) -> Result<Between, SceneError> {
        let wall = Solid::from_f32(&corners(plate.half_m), 0.0);
        let wall = wall.map_err(|why| refused("plate", why))?;
        let wall = at((&wall, &plate.pose));
        let [thick_m, ..] = plate.half_m.map(|half| 2.0 * f64::from(half));
        let mut on_way = to.clone();
        let mut found = Between::default();
        let mut middles = vec![None; plan.pieces.len()];
        for step in 0..BETWEEN {
            let share = step as f32 / BETWEEN as f32;
            let angles = from.angles[self.chain].iter().zip(&to.angles[self.chain]);
            on_way.angles[self.chain] = angles.map(|(a, b)| a + share * (b - a)).collect();
            for (index, pose) in plan.piece_poses(&on_way).iter().enumerate() {
                let piece = &plan.pieces[index];
                if !matches!(piece.link, Link::Behind { chain, .. } if chain == self.chain) {
                    continue;
                }
                let [low, high] = along_normal_m(piece, pose, plate);
                let middle = 0.5 * (low + high);
                let step_m = middles[index].map_or(0.0, |last: f64| (middle - last).abs());
                middles[index] = Some(middle);
                let depth_m = depth_m(&at((&self.solids[index], pose)), &wall);
                // The place nearest to halfway is at most half a step from there.
                let halfway_m = 0.5 * (thick_m + high - low - step_m) - ROUNDING_M;
                found = found.and(Between {
                    deepest_m: depth_m,
                    goes_through: depth_m >= halfway_m,
                });
            }
        }
        Ok(found)
    }

    /// Whether a corner of the arm is behind a plate, within its outline.
    fn is_behind(
        &self,
        figure: &Figure,
        world: &World,
        pieces: &[PieceId],
        plate: &Obstacle,
    ) -> Result<bool, SceneError> {
        let to_plate = reference::Pose::from_f32(plate.pose.rotation, plate.pose.position);
        let [thick, high, wide] = plate.half_m.map(f64::from);
        for (piece, &id) in figure.pieces.iter().zip(pieces) {
            if !self.has(piece) {
                continue;
            }
            let pose = world.piece_pose(id).map_err(|why| refused("piece", why))?;
            let pose = reference::Pose::from_f32(pose.rotation, pose.position);
            for point in &piece.points {
                let corner = pose.rotation * glam::DVec3::from_array(point.map(f64::from));
                let corner =
                    to_plate.rotation.inverse() * (corner + pose.position - to_plate.position);
                let inside = corner.y.abs() < high && corner.z.abs() < wide;
                if inside && corner.x > thick - f64::from(OVERLAP_SLOP_M) {
                    return Ok(true);
                }
            }
        }
        Ok(false)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::avatar::motions::{MOTION_HEIGHT_M, RATE_HZ, slaps};

    use crate::avatar::{Style, Trunk};

    #[test]
    fn an_arm_that_swings_through_the_plate_is_seen() {
        let plan = AvatarPlan::new(MOTION_HEIGHT_M, Style::Hulls, Trunk::Rigid);
        let figure = Figure::of_avatar(&plan);
        let arm = Arm::new(&plan, &figure).unwrap();
        for slap in slaps(1).iter().take(20) {
            // A frame's way of the tracker, with the plate in its middle.
            let half_s = 0.5 / RATE_HZ;
            let [from, to] = [-half_s, half_s].map(|s| slap.target_at(slap.meeting_s() + s));
            let found = arm.between(&plan, [&from, &to], &slap.plate).unwrap();
            assert!(found.goes_through, "{found:?} at {} m/s", slap.speed);
        }
    }
}
