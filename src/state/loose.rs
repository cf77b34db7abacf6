//! Where loose bodies are, and how far they may come.

use glam::Vec3;

use crate::limits::{LOOSE_MARGIN_M, PAIR_MARGIN_M, SPEED_MAX, SPIN_MAX};
use crate::math::{self, Pose};
use crate::state::State;
use crate::state::bodies::is_loose;
use crate::state::pieces::{Bounds, PiecesOf};

/// Angular velocity of a loose body in the world, in rad/s.
pub(crate) fn spin(state: &State, body: usize) -> Vec3 {
    let bodies = &state.bodies;
    bodies.mass[body].inverse_inertia(bodies.pose[body].quat()) * bodies.momentum[body].angular
}

/// The farthest that a body's surface is from its centre of mass, in metres.
pub(crate) fn reach_m(state: &State, body: usize) -> f32 {
    let centre = state.bodies.mass[body].centre;
    let mut reach = 0.0;
    for piece in PiecesOf::new(state.pieces.next, state.bodies.first_piece[body]) {
        let arm = math::length(state.pieces.local[piece].translation() - centre);
        reach = math::max(reach, arm + state.pieces.shape[piece].reach);
    }
    reach
}

/// A box around all that a loose body may touch in the frame, impulses aside.
pub(crate) fn near(state: &State, body: usize, dt_s: f32) -> Bounds {
    let mut own = Bounds::EMPTY;
    for piece in PiecesOf::new(state.pieces.next, state.bodies.first_piece[body]) {
        own = own.union(state.pieces.bounds[piece]);
    }
    if state.bodies.momentum[body].asleep == 1 {
        return own.grown(LOOSE_MARGIN_M);
    }
    let (mass, load) = (&state.bodies.mass[body], &state.bodies.load[body]);
    let gained = math::length(load.force) * mass.inverse_mass * dt_s;
    let fall = math::length(state.registers.gravity) * dt_s;
    let speed = math::length(state.bodies.momentum[body].velocity) + fall + gained;
    let spun = if load.torque == Vec3::ZERO {
        0.0
    } else {
        math::length(mass.inverse_inertia(state.bodies.pose[body].quat()) * load.torque) * dt_s
    };
    let turn = math::min(math::length(spin(state, body)) + spun, SPIN_MAX) * reach_m(state, body);
    own.grown((math::min(speed, SPEED_MAX) + turn) * dt_s + LOOSE_MARGIN_M + PAIR_MARGIN_M)
}

/// Whether a loose body may come into a box within the frame, impulses aside.
pub(crate) fn may_come(state: &State, bounds: &Bounds, dt_s: f32) -> bool {
    (0..state.registers.body_slots as usize)
        .any(|body| is_loose(state, body) && near(state, body, dt_s).overlaps(bounds))
}

/// Whether a piece of a loose body is in a box where the body is now.
pub(crate) fn is_in(state: &State, body: usize, bounds: &Bounds) -> bool {
    PiecesOf::new(state.pieces.next, state.bodies.first_piece[body])
        .any(|piece| piece_bounds(state, piece).overlaps(bounds))
}

/// The box of a piece of a loose body where it is now.
pub(crate) fn piece_bounds(state: &State, piece: usize) -> Bounds {
    Bounds::of(&state.pieces.shape[piece], &piece_pose(state, piece))
}

/// Where a piece of a loose body is now.
pub(crate) fn piece_pose(state: &State, piece: usize) -> Pose {
    let body = state.pieces.body[piece] as usize;
    state.bodies.pose[body].then(&state.pieces.local[piece])
}
