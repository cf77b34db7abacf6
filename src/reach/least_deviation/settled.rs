//! Whether angles are those of least deviation already, without a step.
//!
//! The conditions of Karush (1939) and of Kuhn and Tucker (1951): the goals' planes are kept, and the change from the
//! tracked angles is what the goals on their planes press the joints to, but for joints that a limit holds.

use core::ops::Range;

use arrayvec::ArrayVec;

use crate::geometry::chain::Posture;
use crate::limits::CHAIN_HINGES_MAX;
use crate::math;
use crate::reach::goal::{Angles, Row, Task};

/// Most goals that may press; with more, a step decides.
const PRESSING_MAX: usize = 4;

/// How often the forces are balanced against each other.
const SWEEPS: u32 = 8;

/// A limb nearer to an edge of its cone than this may be held by it, in radians.
const EDGE_RAD: f32 = 1e-3;

/// Whether angles, which take the links to `placed`, leave no goal missed by more than `near_m.start` and no joint more
/// than `push_rad` of push that nothing holds; goals that are met by no more than `near_m.end` may press. Where soft
/// goals, goals to be met exactly or the edge of a reach cone may have a say, they are not.
///
/// Cost: the slopes of at most four goals, whose forces a few sweeps of projected Gauss-Seidel find.
pub(crate) fn is_least(
    task: &Task,
    q: &Angles,
    placed: &Posture,
    near_m: Range<f32>,
    push_rad: f32,
) -> bool {
    let Some(rows) = pressing(task, placed, &near_m) else {
        return false;
    };
    let may_be_held = task.used_balls().iter().any(|ball| {
        let limb = ball.limb(q);
        let mut walls = ball.walls(limb).into_iter();
        walls.any(|wall| wall.dot(limb) < EDGE_RAD)
    });
    if may_be_held {
        return false;
    }
    let mut push = [0.0; CHAIN_HINGES_MAX];
    let mut free = [false; CHAIN_HINGES_MAX];
    for (joint, (angle, wanted)) in q.iter().zip(task.wanted).enumerate() {
        let hinge = &task.hinges[joint];
        push[joint] = wanted - angle;
        free[joint] = hinge.low_rad < *angle && *angle < hinge.high_rad;
    }
    balance(&rows, &free, &mut push);
    q.iter().enumerate().all(|(joint, angle)| {
        let held = if free[joint] {
            false
        } else if *angle <= task.hinges[joint].low_rad {
            push[joint] <= 0.0
        } else {
            push[joint] >= 0.0
        };
        held || push[joint].abs() <= push_rad
    })
}

/// The slopes of the goals that may press; none when one is missed or not of that kind, or there are too many.
fn pressing(
    task: &Task,
    placed: &Posture,
    near_m: &Range<f32>,
) -> Option<ArrayVec<Row, PRESSING_MAX>> {
    let mut rows = ArrayVec::new();
    for goal in task.used_goals() {
        let above_m = goal.above_m(placed);
        if goal.is_exact || !goal.is_hard() || above_m < -near_m.start {
            return None;
        }
        if above_m <= near_m.end {
            rows.try_push(goal.row(&goal.levers(placed))).ok()?;
        }
    }
    Some(rows)
}

/// Adds to the joints' push what goals press with that only press, so that little is left of it where joints are free.
fn balance(rows: &[Row], free: &[bool; CHAIN_HINGES_MAX], push: &mut Row) {
    let over_free = |a: &Row, b: &Row| {
        let products = a.iter().zip(b).zip(free);
        products.fold(
            0.0,
            |sum, ((a, b), is_free)| if *is_free { sum + a * b } else { sum },
        )
    };
    let mut forces = [0.0; PRESSING_MAX];
    for _ in 0..SWEEPS {
        for (row, force) in rows.iter().zip(&mut forces) {
            let stiffness = math::max(over_free(row, row), f32::MIN_POSITIVE);
            let next = math::max(*force - over_free(row, push) / stiffness, 0.0);
            for (push, slope) in push.iter_mut().zip(row) {
                *push += (next - *force) * slope;
            }
            *force = next;
        }
    }
}
