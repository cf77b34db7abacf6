//! Free rotation of a rigid body.

use glam::Quat;
use glam::Vec3;

use crate::math::{self, quat_from_rotation_vector, renormalised};
use crate::state::bodies::BodyMass;

/// Passes of the midpoint rule's fixed point. Each gains a factor of the angle turned.
const PASSES: u32 = 4;

/// Where a body that has this angular momentum, constant in the world, is turned to after `seconds`.
///
/// The implicit midpoint rule on the rotation group (Hairer, Lubich and Wanner 2006, "Geometric Numerical
/// Integration", section VII.5): the angular velocity is that of the middle of the turn. It is symmetric
/// in time, so that the energy has no trend; the angular momentum is a state of its own and does not
/// change at all.
pub(super) fn turned(mass: &BodyMass, from: Quat, angular: Vec3, seconds: f32) -> Quat {
    if angular == Vec3::ZERO {
        return from;
    }
    let half = 0.5 * seconds;
    let is_ball = mass.moments.x == mass.moments.y && mass.moments.y == mass.moments.z;
    let mut spin = mass.inverse_inertia(from) * angular;
    if !is_ball {
        for _ in 0..PASSES {
            let middle = quat_from_rotation_vector(spin * half) * from;
            let better = mass.inverse_inertia(middle) * angular;
            if better == spin {
                break;
            }
            spin = better;
        }
    }
    let angle = math::length(spin) * seconds;
    if angle == 0.0 {
        return from;
    }
    renormalised(quat_from_rotation_vector(spin * seconds) * from)
}
