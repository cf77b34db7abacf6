//! Slaps of the avatar's arm at a plate of 20 mm: does anything end behind it?

use palpable::human::Limb;
use palpable::limits::OVERLAP_SLOP_M;
use palpable::memory::PieceId;
use palpable::world::World;

use super::judge::{OWN_MM_MAX, at, depth_m, solids_of};
use super::play::{Sample, play_and};
use super::scenes::{corners, of_slap};
use super::{Figure, FigureIds, FigurePiece, refused};
use crate::avatar::motions::{ArmSlap, Obstacle};
use crate::avatar::{AvatarPlan, Link, Target};
use crate::hand_scene::SceneError;
use crate::reference::{self, Solid};
use crate::report::{ArmSlaps, Quantiles};

/// Overlap on the straight way between two frames that no piece of an arm stays below on a way through the
/// plate, in millimetres: half the plate. The kernel's own way may bend round the plate's edge within a
/// frame, where the straight one cuts the corner.
const THROUGH_MM: f64 = 10.0;

/// Places between two frames that are looked at.
const BETWEEN: u32 = 32;

/// Plays slaps and counts those that went through the plate: the published overlap is deeper than promised,
/// or the straight way of the angles from one published frame to the next leads through the plate. An arm
/// that slides off the plate's edge and swings on may end behind it, too: those are counted apart.
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
        let mut between_mm: f64 = 0.0;
        let mut before = slap.target(0);
        let played = play_and(&of_slap(&figure, slap), |world, ids| {
            let now = published(world, ids)?;
            let deepest = arm.deepest_between_mm(plan, [&before, &now], &slap.plate)?;
            between_mm = between_mm.max(deepest);
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
        total.overlap_between_mm_max = total.overlap_between_mm_max.max(between_mm);
        let slop_mm = 1e3 * f64::from(OVERLAP_SLOP_M);
        if deepest_mm > slop_mm || between_mm > THROUGH_MM {
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

    /// Deepest overlap with the plate on the straight way of the angles between two frames.
    fn deepest_between_mm(
        &self,
        plan: &AvatarPlan,
        [from, to]: [&Target; 2],
        plate: &Obstacle,
    ) -> Result<f64, SceneError> {
        let wall = Solid::from_f32(&corners(plate.half_m), 0.0);
        let wall = wall.map_err(|why| refused("plate", why))?;
        let wall = at((&wall, &plate.pose));
        let mut between = to.clone();
        let mut deepest: f64 = 0.0;
        for step in 1..BETWEEN {
            let share = step as f32 / BETWEEN as f32;
            let angles = from.angles[self.chain].iter().zip(&to.angles[self.chain]);
            between.angles[self.chain] = angles.map(|(a, b)| a + share * (b - a)).collect();
            let poses = plan.piece_poses(&between);
            for (index, pose) in poses.iter().enumerate() {
                if matches!(plan.pieces[index].link, Link::Behind { chain, .. } if chain == self.chain)
                {
                    deepest = deepest.max(depth_m(&at((&self.solids[index], pose)), &wall));
                }
            }
        }
        Ok(1e3 * deepest)
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
