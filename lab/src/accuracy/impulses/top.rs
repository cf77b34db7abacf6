//! Euler's equations of a free body in f64: an independent reference for turning without torque.

use glam::DVec3;

/// Change of the body's angular velocity, in its own axes: I w' = (I w) x w.
fn change(inertia: DVec3, spin: DVec3) -> DVec3 {
    (inertia * spin).cross(spin) / inertia
}

/// One step of Runge and Kutta's fourth order.
fn step(inertia: DVec3, spin: DVec3, dt_s: f64) -> DVec3 {
    let k1 = change(inertia, spin);
    let k2 = change(inertia, spin + 0.5 * dt_s * k1);
    let k3 = change(inertia, spin + 0.5 * dt_s * k2);
    let k4 = change(inertia, spin + dt_s * k3);
    spin + dt_s / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
}

/// Step of the reference in seconds: its error over a flip is below 1e-9 s.
const STEP_S: f64 = 1e-3;

/// Time between two flips in seconds: of the spin about the second axis through zero, from one to the
/// next. None when there are none within `limit_s`.
pub fn flip_s(inertia: DVec3, spin: DVec3, limit_s: f64) -> Option<f64> {
    let mut now = spin;
    let mut first = None;
    for index in 0..(limit_s / STEP_S) as u64 {
        let next = step(inertia, now, STEP_S);
        if (now.y < 0.0) != (next.y < 0.0) {
            let time = index as f64 * STEP_S + crossing(inertia, now);
            match first {
                None => first = Some(time),
                Some(first) => return Some(time - first),
            }
        }
        now = next;
    }
    None
}

/// When the second spin passes zero within a step from here, by Newton's method on the step's length.
fn crossing(inertia: DVec3, from: DVec3) -> f64 {
    let mut time = 0.0;
    for _ in 0..6 {
        let there = step(inertia, from, time);
        time -= there.y / change(inertia, there).y;
    }
    time
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flips_come_as_in_the_hard_cases() {
        let found = flip_s(DVec3::new(1.0, 2.0, 3.0), DVec3::new(0.01, 1.0, 0.01), 60.0);
        let found = found.unwrap();
        assert!((found - 19.552_867).abs() < 1e-6, "{found}");
    }
}
