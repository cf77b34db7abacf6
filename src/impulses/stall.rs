//! Pairs that no event brings forward.
//!
//! Where bodies slide on each other and turn, their surfaces part and meet again within micrometres, and the way
//! between two poses may take them nearer than their motion does. Shorter stretches are straighter and mostly
//! help ([`super::spans::turns_for`]). Who is blocked all the same waits for the next frame with what motion it
//! has. A pair that hardly came forward in the frame loses half of its turns and of its motion beside its common
//! centre, so that it comes free: what only drifts is no nearer at the end of its way. Its momentum stays, some of
//! its angular momentum does not, and its energy never rises. One that others push, that moves as one and is
//! blocked all the same, is jammed: it comes to rest. So does what is blocked among driven bodies, which press on
//! and give it back what speed it needs.
//!
//! Cost: a pass over the rows for each pair that waits.

use glam::Vec3;

use super::Stretch;
use super::giving::has_driven;
use super::movers::{mover, wait_blocked};
use crate::limits::{STALLED_SHARE, STILL_SPEED};
use crate::math;
use crate::state::State;
use crate::state::bodies::is_loose_kind;
use crate::state::loose::reach_m;
use crate::state::rows::Mover;

/// Has the pair that blocks the way wait, and takes from its motion if it hardly moved in the frame, or is among
/// driven bodies.
pub(super) fn answer(state: &mut State, stretch: &Stretch, blocked: usize, rows: usize) {
    let time = stretch.from;
    let pair = state.islands.pairs[blocked];
    let bodies = [pair.a, pair.b].map(|piece| state.pieces.body[piece as usize] as usize);
    let movers = bodies.map(|body| mover(state, body, time));
    if !wait_blocked(state, blocked, time) {
        return;
    }
    if has_driven(state, stretch.island as usize) {
        for body in bodies {
            still(state, body);
        }
        return;
    }
    if time > STALLED_SHARE {
        return;
    }
    let common = common_velocity(&movers);
    let beside = |side: usize| {
        let turning = math::length(movers[side].spin) * reach_m(state, bodies[side]);
        math::length(movers[side].velocity - common) + turning
    };
    let jammed = beside(0) + beside(1) < STILL_SPEED && is_held(state, rows, bodies);
    let common = if jammed { Vec3::ZERO } else { common };
    for side in [0, 1] {
        if movers[side].is_movable() {
            halve(state, bodies[side], common);
        }
    }
}

/// Whether something else pushes a pair.
fn is_held(state: &State, rows: usize, bodies: [usize; 2]) -> bool {
    let own = |body: u32| bodies.contains(&(body as usize));
    state.rows.rows[..rows].iter().any(|row| {
        let pushes = row.impulse != Vec3::ZERO || row.struck != Vec3::ZERO;
        pushes && own(row.body_a) != own(row.body_b)
    })
}

/// The velocity of the common centre of mass; zero beside what nothing moves.
fn common_velocity(movers: &[Mover; 2]) -> Vec3 {
    let [a, b] = movers;
    let both = a.inverse_mass + b.inverse_mass;
    if !(a.is_movable() && b.is_movable() && both.is_finite()) {
        return Vec3::ZERO;
    }
    a.velocity + (b.velocity - a.velocity) * (a.inverse_mass / both)
}

/// Takes all of a body's motion.
fn still(state: &mut State, body: usize) {
    if is_loose_kind(state.bodies.kind[body]) {
        state.bodies.momentum[body].velocity = Vec3::ZERO;
        state.bodies.momentum[body].angular = Vec3::ZERO;
    }
}

/// Takes half of a body's turn, and of its motion beside `common`.
fn halve(state: &mut State, body: usize, common: Vec3) {
    let momentum = &mut state.bodies.momentum[body];
    momentum.velocity = 0.5 * (momentum.velocity + common);
    momentum.angular *= 0.5;
}
