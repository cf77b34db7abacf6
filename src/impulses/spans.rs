//! How long a stretch of time may be.

use glam::Vec3;

use super::Stretch;
use crate::limits::{
    CONTACT_SHARE_MIN, CONTACT_TURN_RAD, STALLED_TURN_PART, TURN_RAD, TURN_SHARE_MIN,
};
use crate::math;
use crate::state::State;
use crate::state::islands::Members;
/// The share of a stretch for which the contacts are where they were found: until a body that is pushed off
/// its centre has turned by [`CONTACT_TURN_RAD`].
pub(super) fn holds_for(state: &State, rows: usize, stretch: &Stretch) -> f32 {
    let mut share = 1.0;
    for row in &state.rows.rows[..rows] {
        for (body, arm) in [(row.body_a, row.arm_a), (row.body_b, row.arm_b)] {
            let mover = &state.rows.movers[body as usize];
            let off_centre = arm.cross(row.normal) != Vec3::ZERO;
            if mover.is_movable() && off_centre && row.impulse != Vec3::ZERO {
                let turn = math::length(mover.spin) * stretch.seconds();
                let angle = CONTACT_TURN_RAD;
                share = math::min(share, angle / math::max(turn, angle));
            }
        }
    }
    math::max(share, CONTACT_SHARE_MIN)
}

/// The share of a stretch in which no loose body turns by more than [`TURN_RAD`], or by a part of it after so many
/// events that brought nobody forward. What turns so fast that this were a small share of the frame turns farther.
pub(super) fn turns_for(state: &State, stretch: &Stretch, stalls: u32) -> f32 {
    let mut fastest = 0.0;
    for body in Members::of(state, stretch.island as usize) {
        for mover in [&state.rows.begun[body], &state.rows.movers[body]] {
            fastest = math::max(fastest, mover.spin.length_squared());
        }
    }
    let turn = math::sqrt(fastest) * stretch.seconds();
    let (mut most, mut least) = (TURN_RAD, TURN_SHARE_MIN);
    for _ in 0..stalls {
        most *= STALLED_TURN_PART;
        least *= STALLED_TURN_PART;
    }
    if turn <= most {
        return 1.0;
    }
    let least = least * stretch.dt_s / stretch.seconds();
    math::min(math::max(most / turn, least), 1.0)
}
