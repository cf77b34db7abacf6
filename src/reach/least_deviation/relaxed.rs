//! Angles near the least deviation, taken nearer to it without a step.
//!
//! The conditions of Karush (1939) and of Kuhn and Tucker (1951): the goals' planes are kept, and the change from the
//! tracked angles is what the goals on their planes press the joints to, but for joints that a limit holds. What is left
//! of it is minus the gradient of the cost along the planes, and the joints give way to it once: where heights bend less
//! than the change of the angles bears, which nearness means, that leaves less of it.

use core::ops::Range;

use arrayvec::ArrayVec;

use crate::geometry::chain::{BOUNDARY_RAD, Hinge, Posture};
use crate::limits::CHAIN_HINGES_MAX;
use crate::math;
use crate::reach::goal::{Angles, Row, Task};

/// Most goals that may press; with more, a step decides.
const PRESSING_MAX: usize = 4;

/// How often the forces are balanced against each other.
const SWEEPS: u32 = 8;

/// A limb nearer to an edge of its cone than this may be held by it, in radians.
const EDGE_RAD: f32 = 1e-3;

/// Angles that take the links to `placed` and miss no goal by more than `near_m.start`, with the joints given way to
/// what pushes them; goals that are met by no more than `near_m.end` may press. None where a joint is pushed by more than
/// `push_rad.end`; where none is by more than `push_rad.start`, or a ball would leave its cone, they stay as they are.
/// Where soft goals, goals to be met exactly or the edge of a reach cone may have a say, there are none.
///
/// Cost: the slopes of at most four goals, whose forces a few sweeps of projected Gauss-Seidel find.
pub(crate) fn relaxed(
    task: &Task,
    q: &Angles,
    placed: &Posture,
    near_m: Range<f32>,
    push_rad: Range<f32>,
) -> Option<Angles> {
    let rows = pressing(task, placed, &near_m)?;
    let mut balls = task.used_balls().iter();
    let may_be_held = balls.any(|ball| {
        let limb = ball.limb(q);
        let mut walls = ball.walls(limb).into_iter();
        walls.any(|wall| wall.dot(limb) < EDGE_RAD)
    });
    if may_be_held {
        return None;
    }
    let mut push = [0.0; CHAIN_HINGES_MAX];
    let mut free = [false; CHAIN_HINGES_MAX];
    for (joint, (angle, wanted)) in q.iter().zip(task.wanted).enumerate() {
        let hinge = &task.hinges[joint];
        push[joint] = wanted - angle;
        free[joint] = hinge.low_rad < *angle && *angle < hinge.high_rad;
    }
    balance(&rows, &free, &mut push);
    let (mut next, mut most) = (q.clone(), 0.0);
    for (joint, angle) in next.iter_mut().enumerate() {
        let hinge = &task.hinges[joint];
        if !is_held(hinge, *angle, push[joint]) {
            most = math::max(most, push[joint].abs());
            *angle = hinge.kept(*angle + push[joint]);
        }
    }
    if most > push_rad.end {
        return None;
    }
    let mut balls = task.used_balls().iter();
    let is_within = balls.all(|ball| ball.outside_rad(&next) <= BOUNDARY_RAD);
    Some(if most > push_rad.start && is_within {
        next
    } else {
        q.clone()
    })
}

/// Whether a limit holds a joint against a push.
fn is_held(hinge: &Hinge, angle: f32, push: f32) -> bool {
    (angle <= hinge.low_rad && push <= 0.0) || (angle >= hinge.high_rad && push >= 0.0)
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
