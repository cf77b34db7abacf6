//! Cyclic coordinate descent, the method of Schmidl and Lin 2004, section 4.
//!
//! Of the first link from the root that misses a goal, the mean of the missed points (equation 2) is to
//! move out of the planes (equation 3); joint by joint, from that link to the root, the angle that
//! brings it nearest is taken.
//!
//! The formulas are mended. Equation 4 projects along a letter that is not the axis, and the arc cosine
//! of equation 5 has no sign, needs unit vectors and is zero below 3.5e-4 rad in f32. With u and v from
//! the joint to the point and to its goal, and a the axis, the angle is
//! atan2(a . (u x v), u . v - (a . u)(a . v)).

use glam::Vec3;

use super::goal::{Angles, Goal, Reached, Task, worst_m};
use crate::geometry::chain::{Placed, Posture, posture};
use crate::math;

/// Takes up to `steps` sweeps over the joints, starting from `angles`, which stay within the limits.
///
/// A step is one sweep: forward kinematics and one rotation a hinge.
pub fn cyclic_descent(task: &Task, angles: &mut [f32], steps: u32) -> Reached {
    let mut q = task.start(angles);
    let mut placed = posture(task.hinges, &task.root, &q);
    let mut missed_m = worst_m(task.goals, &placed);
    let mut used = 0;
    while missed_m > task.tolerance_m && used < steps {
        sweep(task, &placed, &mut q);
        placed = posture(task.hinges, &task.root, &q);
        missed_m = worst_m(task.goals, &placed);
        used += 1;
    }
    for (angle, &found) in angles.iter_mut().zip(&q) {
        *angle = found;
    }
    Reached {
        steps: used,
        missed_m,
    }
}

fn sweep(task: &Task, placed: &Posture, q: &mut Angles) {
    let Some((link, mut at, goal)) = effector(task, placed) else {
        return;
    };
    for index in (0..=link.min(placed.len() - 1)).rev() {
        let Placed { origin, axis, .. } = placed[index];
        let hinge = &task.hinges[index];
        let turn = angle_between(axis, at - origin, goal - origin);
        let angle = hinge.kept(q[index] + turn);
        let turn = math::quat_from_rotation_vector(axis * (angle - q[index]));
        at = origin + turn * (at - origin);
        q[index] = angle;
    }
}

/// The first link that misses a goal, the mean of its missed points, and where that is to be.
fn effector(task: &Task, placed: &Posture) -> Option<(usize, Vec3, Vec3)> {
    let misses = |goal: &&Goal| goal.missed_m(placed) > task.tolerance_m;
    let link = task
        .goals
        .iter()
        .filter(misses)
        .map(|goal| goal.link)
        .min()?;
    let (mut sum, mut count) = (Vec3::ZERO, 0.0);
    let (mut exact, mut out, mut weights) = (Vec3::ZERO, Vec3::ZERO, 0.0);
    for goal in task.goals.iter().filter(|goal| goal.link == link) {
        let missed = goal.missed_m(placed);
        if goal.is_exact {
            exact -= goal.normal * goal.above_m(placed);
        } else if missed > 0.0 {
            out += goal.normal * (missed * missed);
            weights += missed;
        }
        if goal.is_exact || missed > 0.0 {
            sum += goal.at(placed);
            count += 1.0;
        }
    }
    let at = sum / count;
    let out = if weights > 0.0 { out / weights } else { out };
    Some((link, at, at + exact + out))
}

/// The angle about a unit axis that turns the part of `u` across it into the direction of that of `v`.
fn angle_between(axis: Vec3, u: Vec3, v: Vec3) -> f32 {
    math::atan2(axis.dot(u.cross(v)), u.dot(v) - axis.dot(u) * axis.dot(v))
}
