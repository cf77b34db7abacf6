//! Free rotation of a rigid body.
//!
//! In double precision: what a single step loses in single precision would bring a tumbling body's flips
//! forward or back by seconds.

use glam::{DQuat, DVec3, Quat, Vec3};

use crate::math;
use crate::state::bodies::BodyMass;

/// Passes of the midpoint rule's fixed point. Each gains a factor of the angle turned.
const PASSES: u32 = 4;

/// Where a body that has this angular momentum, constant in the world, is turned to after `seconds`.
///
/// The implicit midpoint rule on the rotation group (Hairer, Lubich and Wanner 2006, "Geometric Numerical
/// Integration", section VII.5): the angular velocity is that of the middle of the turn. It is symmetric
/// in time; the angular momentum is a state of its own and does not change at all, and the energy is put
/// right at the end.
pub(super) fn turned(mass: &BodyMass, from: Quat, angular: Vec3, seconds: f32) -> Quat {
    if angular == Vec3::ZERO || mass.inverse_mass == 0.0 {
        return from;
    }
    let seconds = f64::from(seconds);
    let start = from.as_dquat();
    let angular = angular.as_dvec3();
    let is_ball = mass.moments.x == mass.moments.y && mass.moments.y == mass.moments.z;
    let mut spin = mass.spin(start, angular);
    if !is_ball {
        for _ in 0..PASSES {
            let better = mass.spin(turn(spin, 0.5 * seconds) * start, angular);
            let settled = (better - spin).length_squared() <= 1e-24 * spin.length_squared();
            spin = better;
            if settled {
                break;
            }
        }
    }
    if spin == DVec3::ZERO {
        return from;
    }
    let mut q = turn(spin, seconds) * start;
    if !is_ball {
        q = with_energy(mass, q, angular, angular.dot(mass.spin(start, angular)));
    }
    let scale = 1.0 / math::sqrt_f64(q.length_squared());
    Quat::from_xyzw(
        (q.x * scale) as f32,
        (q.y * scale) as f32,
        (q.z * scale) as f32,
        (q.w * scale) as f32,
    )
}

/// The nearest orientation with this energy, twice the kinetic one: turning the body by a small p changes
/// that by 2 p.(w x L). The midpoint rule alone loses it where a body turns far in one step.
fn with_energy(mass: &BodyMass, from: DQuat, angular: DVec3, energy: f64) -> DQuat {
    let mut q = from;
    for _ in 0..2 {
        let spin = mass.spin(q, angular);
        let gradient = spin.cross(angular);
        let steep = gradient.length_squared();
        let missing = energy - angular.dot(spin);
        if steep <= 1e-20 * energy * energy || missing == 0.0 {
            break;
        }
        let step = gradient * (0.5 * missing / steep);
        let length = math::sqrt_f64(step.length_squared());
        let step = if length > 0.1 {
            step * (0.1 / length)
        } else {
            step
        };
        q = turn(step, 1.0) * q;
    }
    q
}

/// The rotation by a constant angular velocity.
fn turn(spin: DVec3, seconds: f64) -> DQuat {
    let rate = math::sqrt_f64(spin.length_squared());
    let half = 0.5 * seconds * rate;
    if half < 1e-9 {
        let v = spin * (0.5 * seconds);
        return DQuat::from_xyzw(v.x, v.y, v.z, 1.0);
    }
    let (sine, cosine) = math::sin_cos_f64(half);
    let v = spin * (sine / rate);
    DQuat::from_xyzw(v.x, v.y, v.z, cosine)
}
