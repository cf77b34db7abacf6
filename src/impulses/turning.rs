//! Free rotation of a rigid body.
//!
//! In double precision: what a single step loses in single precision would bring a tumbling body's flips
//! forward or back by seconds.

use glam::{DQuat, DVec3, Quat, Vec3};

use crate::math;
use crate::state::bodies::BodyMass;

/// Passes of the midpoint rule's fixed point. Each gains a factor of the angle turned.
const PASSES: u32 = 4;

/// The farthest that a body turns in one step of the midpoint rule, in radians, while there are steps left.
const STEP_RAD: f64 = 0.25;

/// Most steps of the midpoint rule.
const STEPS_MAX: f64 = 64.0;

/// Moments count as equal when they differ by less than this part.
const EQUAL_PART: f32 = 1e-5;

/// Where a body that has this angular momentum, constant in the world, is turned to after `seconds`.
///
/// A body with two equal moments turns about its axis while the axis turns about the angular momentum,
/// exactly (Goldstein, "Classical Mechanics", section 5.6). For all others the implicit midpoint rule on
/// the rotation group (Hairer, Lubich and Wanner 2006, "Geometric Numerical Integration", section VII.5):
/// the angular velocity is that of the middle of the turn. It is symmetric in time; the angular momentum
/// is a state of its own and does not change at all, and the energy is put right after every step.
///
/// Cost: 64 steps at the most, one for each quarter of a radian.
pub(super) fn turned(mass: &BodyMass, from: Quat, angular: Vec3, seconds: f32) -> Quat {
    if angular == Vec3::ZERO || mass.inverse_mass == 0.0 {
        return from;
    }
    let seconds = f64::from(seconds);
    let start = from.as_dquat();
    let angular = angular.as_dvec3();
    let spin = mass.spin(start, angular);
    if spin == DVec3::ZERO {
        return from;
    }
    let energy = angular.dot(spin);
    let q = match axis_of(mass) {
        Some(axis) => with_energy(
            mass,
            gyrate(mass, start, angular, axis, seconds),
            angular,
            energy,
        ),
        None => step_by_step(mass, start, angular, energy, seconds),
    };
    let scale = 1.0 / math::sqrt_f64(q.length_squared());
    if !scale.is_finite() {
        return from;
    }
    Quat::from_xyzw(
        (q.x * scale) as f32,
        (q.y * scale) as f32,
        (q.z * scale) as f32,
        (q.w * scale) as f32,
    )
}

/// A body's free turn with an angular momentum, constant in the world, for so many seconds.
pub(super) struct Turn<'a> {
    pub mass: &'a BodyMass,
    pub from: Quat,
    pub angular: Vec3,
    pub seconds: f32,
}

impl Turn<'_> {
    /// The angular momentum of a body that was to have `angular` at the end of this turn, but was stopped at
    /// the orientation `here`, on the way between two poses that was certified: the nearest with the same length
    /// and the same energy. It stays as it is where the energy differs by rounding only.
    ///
    /// Cost: that of [`turned`], and eight steps towards the energy.
    pub(super) fn angular_at(&self, here: Quat, angular: Vec3) -> Vec3 {
        if here == self.from || self.mass.inverse_mass == 0.0 {
            return angular;
        }
        let there = turned(self.mass, self.from, self.angular, self.seconds);
        let (here, wide) = (here.as_dquat(), angular.as_dvec3());
        let energy_at = |q: DQuat, angular: DVec3| angular.dot(self.mass.spin(q, angular));
        let energy = energy_at(there.as_dquat(), wide);
        let off = energy_at(here, wide) - energy;
        if off * off <= ROUNDED_PART * ROUNDED_PART * energy * energy {
            return angular;
        }
        // Turning the angular momentum back is turning the body on.
        let mut fitting = here;
        for _ in 0..FITTING_PASSES {
            fitting = with_energy(self.mass, fitting, wide, energy);
        }
        let back = here * fitting.conjugate();
        let square = back.length_squared();
        let mut fitted = back * wide / square;
        let least = energy_at(here, fitted);
        if least > energy {
            fitted *= math::sqrt_f64(energy / least);
        }
        let fitted = fitted.as_vec3();
        if fitted.is_finite() { fitted } else { angular }
    }
}

/// Energies that differ by less than this part are equal but for rounding.
const ROUNDED_PART: f64 = 1e-6;

/// Rounds of two steps each in which the angular momentum finds its energy.
const FITTING_PASSES: u32 = 4;

/// The principal axis about which a body is round: the one whose moment is unlike the two others.
fn axis_of(mass: &BodyMass) -> Option<usize> {
    let moments = mass.moments.to_array();
    (0..3).find(|&axis| {
        let (a, b) = (moments[(axis + 1) % 3], moments[(axis + 2) % 3]);
        (a - b).abs() <= EQUAL_PART * math::max(a, b)
    })
}

/// The free motion of a round body: with e its axis, and I the moment across it, the angular velocity is
/// L / I and, along the axis, what is left of it.
fn gyrate(mass: &BodyMass, from: DQuat, angular: DVec3, axis: usize, seconds: f64) -> DQuat {
    let inverse = mass.inverse_moments.as_dvec3().to_array();
    let across = 0.5 * (inverse[(axis + 1) % 3] + inverse[(axis + 2) % 3]);
    let own = Quat::from_array(mass.axes).as_dquat();
    let mut unit = [0.0; 3];
    unit[axis] = 1.0;
    let local = own * DVec3::from_array(unit) / own.length_squared();
    let e = from * local / from.length_squared();
    let own_spin = (inverse[axis] - across) * angular.dot(e);
    turn(angular * across, seconds) * turn(e * own_spin, seconds) * from
}

fn step_by_step(mass: &BodyMass, start: DQuat, angular: DVec3, energy: f64, seconds: f64) -> DQuat {
    let least = math::min(mass.moments.x, math::min(mass.moments.y, mass.moments.z));
    let fastest = math::sqrt_f64(angular.length_squared()) / f64::from(least);
    let angle = fastest * seconds;
    let mut steps = 1.0;
    while steps < STEPS_MAX && angle > STEP_RAD * steps {
        steps += 1.0;
    }
    let step = seconds / steps;
    let mut q = start;
    let mut left = steps;
    while left > 0.0 {
        q = with_energy(mass, midpoint(mass, q, angular, step), angular, energy);
        left -= 1.0;
    }
    q
}

fn midpoint(mass: &BodyMass, start: DQuat, angular: DVec3, seconds: f64) -> DQuat {
    let mut spin = mass.spin(start, angular);
    for _ in 0..PASSES {
        let better = mass.spin(turn(spin, 0.5 * seconds) * start, angular);
        let settled = (better - spin).length_squared() <= 1e-24 * spin.length_squared();
        spin = better;
        if settled {
            break;
        }
    }
    turn(spin, seconds) * start
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
