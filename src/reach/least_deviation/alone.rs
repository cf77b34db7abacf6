//! One joint turned alone, where turning all of them a little gains next to nothing.
//!
//! Near a stationary point of a goal's height the slopes say nothing of the way. Along one joint the
//! height is known exactly: g sin x + c (cos x - 1) after a turn by x, with the slope g and minus the
//! second derivative c.

use super::TURN_MAX;
use super::spot::Spot;
use crate::limits::CHAIN_HINGES_MAX;
use crate::math;
use crate::reach::goal::{Angles, Goal, Task};

/// The angles with that one joint turned that brings the goal missed most nearest; none when no hard
/// goal is missed.
///
/// Cost: one arc a joint.
pub(super) fn turned_alone(task: &Task, spot: &Spot) -> Option<Angles> {
    let goal = worst(task, spot)?;
    let need = -goal.above_m(&spot.placed);
    let levers = goal.levers(&spot.placed);
    let row = goal.row(&levers);
    let mut curvature = [0.0; CHAIN_HINGES_MAX];
    let moving = spot.placed.iter().zip(levers.by());
    for (slot, (hinge, by)) in curvature.iter_mut().zip(moving) {
        *slot = -goal.normal.dot(hinge.axis.cross(*by));
    }
    let mut best = (0, 0.0);
    let mut least = need.abs();
    for (joint, (hinge, &angle)) in task.hinges.iter().zip(&spot.q).enumerate() {
        let (slope, bend) = (row[joint], curvature[joint]);
        let turns = [turn_to(slope, bend, need), TURN_MAX, -TURN_MAX];
        for turn in turns {
            let turn = hinge.kept(angle + math::clamp(turn, -TURN_MAX, TURN_MAX)) - angle;
            let gain = slope * math::sin(turn) + bend * (math::cos(turn) - 1.0);
            let left = if goal.is_exact {
                (need - gain).abs()
            } else {
                math::max(need - gain, 0.0)
            };
            if left < least {
                (best, least) = ((joint, turn), left);
            }
        }
    }
    let mut q = spot.q.clone();
    *q.get_mut(best.0)? += best.1;
    Some(q)
}

fn worst<'a>(task: &Task<'a>, spot: &Spot) -> Option<&'a Goal> {
    let mut most = task.tolerance_m;
    let mut worst = None;
    for goal in task.goals.iter().filter(|goal| goal.is_hard()) {
        let missed = goal.missed_m(&spot.placed);
        if missed > most {
            (worst, most) = (Some(goal), missed);
        }
    }
    worst
}

/// The least turn that gains `need`, or that gains most.
fn turn_to(slope: f32, bend: f32, need: f32) -> f32 {
    let widest = math::sqrt(slope * slope + bend * bend);
    let middle = math::atan2(slope, bend);
    let share = (need + bend) / math::max(widest, f32::MIN_POSITIVE);
    if share >= 1.0 {
        return middle;
    }
    let share = math::max(share, -1.0);
    let aside = math::atan2(math::sqrt(1.0 - share * share), share);
    let (near, other) = (middle - aside, middle + aside);
    if near.abs() < other.abs() {
        near
    } else {
        other
    }
}
