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
//!
//! Two things are added. A ball joint swings as one: the least rotation from u to v is asked of its
//! limb, which goes to the nearest direction that the reach cone allows, so that it slides along the
//! boundary. And soft goals are descended on once the hard ones are met, as if they were hard; where
//! that leaves hard ones, the next sweeps mend it. The softness says which of the postures that meet
//! the hard goals is kept: the one whose soft goals cost least.
//!
//! In a world the sweeps begin where contact is likely to have the chain: at the wanted angles with as much of what it
//! added to them in the last frame as takes the lowest goal to its plane, by one secant (two forward kinematics more).
//! Contact presses from frame to frame much alike, so that most sweeps are made where it begins, as in the paper's
//! figure 7. The posture then depends on how the chain came there, as it does in the paper.

use core::f32::consts::PI;

use glam::{Quat, Vec3};

use super::goal::{Angles, Goal, Reached, Task, worst_m};
use crate::geometry::chain::{Ball, Placed, Posture, posture};
use crate::math;

/// Sweeps without gain after which soft goals are left as they are.
const IDLE_SWEEPS_MAX: u32 = 4;

/// Takes up to `steps` sweeps over the joints, starting from `angles`, which stay within the limits.
///
/// A step is one sweep: forward kinematics and one rotation a hinge. With soft goals the best posture
/// on the way is kept, and the sweeps end when four in a row have not bettered it.
pub fn cyclic_descent(task: &Task, angles: &mut [f32], steps: u32) -> Reached {
    cyclic_descent_paid(task, angles, steps, &mut || true)
}

/// The same, with every sweep paid for; it ends where paying is refused.
pub(super) fn cyclic_descent_paid(
    task: &Task,
    angles: &mut [f32],
    steps: u32,
    pay: &mut dyn FnMut() -> bool,
) -> Reached {
    let mut q = task.start(angles);
    let mut placed = posture(task.hinges, &task.root, &q);
    let mut best = (q.clone(), worst_m(task.goals, &placed));
    let mut best_cost = task.soft_cost(&placed);
    let (mut used, mut idle) = (0, 0);
    while used < steps && idle < IDLE_SWEEPS_MAX {
        let Some(effector) = effector(task, &placed) else {
            break;
        };
        if !pay() {
            break;
        }
        sweep(task, &placed, &mut q, effector);
        placed = posture(task.hinges, &task.root, &q);
        used += 1;
        let missed_m = worst_m(task.goals, &placed);
        let cost = task.soft_cost(&placed);
        let was_met = best.1 <= task.tolerance_m;
        let is_met = missed_m <= task.tolerance_m;
        let cheaper = is_met && cost < best_cost;
        if (!was_met && missed_m < best.1) || cheaper {
            (best, best_cost) = ((q.clone(), missed_m), cost);
            idle = 0;
        } else if was_met {
            idle += 1;
        }
    }
    let (found, missed_m) = best;
    for (angle, &found) in angles.iter_mut().zip(&found) {
        *angle = found;
    }
    Reached {
        steps: used,
        missed_m,
    }
}

/// A point of a link and where it is to be.
struct Effector {
    link: usize,
    at: Vec3,
    goal: Vec3,
}

fn sweep(task: &Task, placed: &Posture, q: &mut Angles, effector: Effector) {
    let Effector { link, mut at, goal } = effector;
    let Some(last) = placed.len().checked_sub(1) else {
        return;
    };
    let mut index = link.min(last);
    loop {
        let ball = task.used_balls().iter().find(|ball| {
            let swings = ball.first <= index && index <= ball.first.saturating_add(1);
            swings && ball.first.saturating_add(2) <= last
        });
        match ball {
            Some(ball) if index > ball.first => {
                swing(task, ball, placed, q, &mut at, goal);
                index = ball.first;
            }
            // A link between a ball's hinges, which no limb has: it stays.
            Some(_) => {}
            None => turn(task, &placed[index], q, index, &mut at, goal),
        }
        let Some(next) = index.checked_sub(1) else {
            break;
        };
        index = next;
    }
}

/// Turns one hinge.
fn turn(task: &Task, placed: &Placed, q: &mut Angles, index: usize, at: &mut Vec3, goal: Vec3) {
    let Placed { axis, link } = *placed;
    let origin = link.translation();
    let turn = angle_between(axis, *at - origin, goal - origin);
    let angle = task.hinges[index].kept(q[index] + turn);
    let turn = math::quat_from_rotation_vector(axis * (angle - q[index]));
    *at = origin + turn * (*at - origin);
    q[index] = angle;
}

/// Swings a ball's limb by the least rotation that brings the point nearest, as far as cone and hinges
/// allow.
fn swing(task: &Task, ball: &Ball, placed: &Posture, q: &mut Angles, at: &mut Vec3, goal: Vec3) {
    let Placed { link, axis } = placed[ball.first];
    let origin = link.translation();
    let frame = link.quat() * math::quat_from_rotation_vector(Vec3::X * -q[ball.first]);
    let least = least_rotation(*at - origin, goal - origin, axis);
    let limb = frame.conjugate() * (least * (frame * ball.limb(q)));
    let Some(limb) = math::direction(limb) else {
        return;
    };
    let before = swung(q[ball.first], q[ball.first + 1]);
    let allowed = ball.cone.nearest(limb);
    let mut next = q.clone();
    let [near, _] = ball.aimed(allowed, q);
    for (angle, found) in next.iter_mut().skip(ball.first).zip(near) {
        *angle = found;
    }
    if !task.admit(&mut next) {
        return;
    }
    *q = next;
    let turned = swung(q[ball.first], q[ball.first + 1]) * before.conjugate();
    *at = origin + frame * (turned * (frame.conjugate() * (*at - origin)));
}

/// The rotation of a ball's first two hinges.
fn swung(a: f32, b: f32) -> Quat {
    let about = math::quat_from_rotation_vector;
    about(Vec3::X * a) * about(Vec3::Y * b)
}

/// The least rotation that takes the direction of `u` into that of `v`; of opposite ones, about
/// `otherwise`.
fn least_rotation(u: Vec3, v: Vec3, otherwise: Vec3) -> Quat {
    let across = u.cross(v);
    match math::direction(across) {
        Some(axis) => {
            let angle = math::atan2(math::length(across), u.dot(v));
            math::quat_from_rotation_vector(axis * angle)
        }
        None if u.dot(v) < 0.0 => math::quat_from_rotation_vector(otherwise * PI),
        None => Quat::IDENTITY,
    }
}

/// The first link that misses a goal, the mean of its missed points, and where that is to be. Soft goals
/// are asked once all hard ones are met.
fn effector(task: &Task, placed: &Posture) -> Option<Effector> {
    let misses = |goal: &&Goal| goal.missed_m(placed) > task.tolerance_m;
    let first = |hard: bool| {
        let goals = task.used_goals().iter().filter(|g| g.is_hard() == hard);
        goals.filter(misses).map(|goal| goal.link).min()
    };
    let (link, hard) = match first(true) {
        Some(link) => (link, true),
        None => (first(false)?, false),
    };
    let (mut sum, mut count) = (Vec3::ZERO, 0.0);
    let (mut exact, mut out, mut weights) = (Vec3::ZERO, Vec3::ZERO, 0.0);
    let asks = |goal: &&Goal| goal.link == link && goal.is_hard() == hard;
    for goal in task.used_goals().iter().filter(asks) {
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
    Some(Effector {
        link,
        at,
        goal: at + exact + out,
    })
}

/// The angle about a unit axis that turns the part of `u` across it into the direction of that of `v`.
fn angle_between(axis: Vec3, u: Vec3, v: Vec3) -> f32 {
    math::atan2(axis.dot(u.cross(v)), u.dot(v) - axis.dot(u) * axis.dot(v))
}
