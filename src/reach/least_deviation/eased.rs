//! Goals that no joint can answer.

use arrayvec::ArrayVec;

use super::program::UNMOVED;
use super::spot::Spot;
use crate::limits::CHAIN_GOALS_MAX;
use crate::reach::goal::{Goal, Task};

/// How much lower than its point a goal is asked for that no joint can answer, as a part of the tolerance: rounding
/// alone is not to press.
const EASED: f32 = 0.5;

/// A joint that is as near to the end of its range does not go on, in radians.
const ENDED_RAD: f32 = 1e-4;

/// The goals of a task with pushes that a spot misses, and that no joint can answer from there, lowered to what it
/// meets; `None` when there are none.
pub(super) fn eased(task: &Task, spot: &Spot) -> Option<ArrayVec<Goal, CHAIN_GOALS_MAX>> {
    let mut goals: ArrayVec<Goal, CHAIN_GOALS_MAX> = task.used_goals().iter().copied().collect();
    let mut any = false;
    for goal in &mut goals {
        let missed_m = goal.missed_m(&spot.placed);
        if missed_m > 0.0 && goal.is_hard() && !goal.is_exact && is_unanswered(task, spot, goal) {
            goal.height_m -= missed_m + EASED * task.tolerance_m;
            any = true;
        }
    }
    any.then_some(goals)
}

/// Whether no joint that is not at the end of its range brings a goal's point up.
fn is_unanswered(task: &Task, spot: &Spot, goal: &Goal) -> bool {
    let row = goal.row(&goal.levers(&spot.placed));
    let joints = row.iter().zip(&spot.q).zip(task.hinges);
    let squares = joints.map(|((&rise, &angle), hinge)| {
        let goes_on = if rise > 0.0 {
            angle < hinge.high_rad - ENDED_RAD
        } else {
            angle > hinge.low_rad + ENDED_RAD
        };
        if goes_on { rise * rise } else { 0.0 }
    });
    f64::from(squares.fold(0.0, |sum, square| sum + square)) < UNMOVED
}
