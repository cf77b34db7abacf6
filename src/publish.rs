//! Publish: poses for the host to draw.

use crate::geometry::motion::interpolate;
use crate::math::{self, displacement_of};
use crate::state::State;
use crate::state::bodies::{BodyKind, Coupling, Displacement, DrivenReport, is_body_of};
use crate::state::pieces::{Bounds, PiecesOf};
use crate::state::ways::driven_at;
use glam::Vec3;

/// Writes the published poses of everything that moved.
pub(crate) fn run(state: &mut State) {
    for body in 0..state.registers.body_slots as usize {
        if is_body_of(state, body, BodyKind::Driven) {
            publish_driven(state, body);
        } else if is_body_of(state, body, BodyKind::Dynamic)
            && state.bodies.momentum[body].asleep == 0
        {
            place_pieces(state, body);
        }
    }
}

fn publish_driven(state: &mut State, body: usize) {
    let start = state.bodies.pose[body];
    let stop = state.legs.stop_time[body];
    let (pose, share) = driven_at(state.legs.of(body), &start, stop);
    let moved = state.legs.count[body] > 0 && stop > 0.0;
    if moved {
        state.bodies.pose[body] = pose;
        move_locals(state, body, share);
        place_pieces(state, body);
    }
    settle(state, body, moved);
}

/// Moves the published local poses by a share of their way to the targets.
fn move_locals(state: &mut State, body: usize, share: f32) {
    let first = state.bodies.first_piece[body];
    let pieces = &mut state.pieces;
    for piece in PiecesOf::new(pieces.next, first) {
        pieces.local[piece] = interpolate(&pieces.local[piece], &pieces.local_target[piece], share);
    }
}

/// Recomputes the world poses and boxes of a body's pieces.
pub(crate) fn place_pieces(state: &mut State, body: usize) {
    let pose = state.bodies.pose[body];
    let first = state.bodies.first_piece[body];
    let pieces = &mut state.pieces;
    for piece in PiecesOf::new(pieces.next, first) {
        let world = pose.then(&pieces.local[piece]);
        pieces.world[piece] = world;
        pieces.bounds[piece] = Bounds::of(&pieces.shape[piece], &world);
    }
}

/// Writes down how far contact holds the body from its tracker, and how fast that changes: what the
/// spring did, less what contact took away from it.
fn settle(state: &mut State, body: usize, moved: bool) {
    let bodies = &mut state.bodies;
    if bodies.tracker[body].seen == 0 {
        return;
    }
    let pose = bodies.pose[body];
    let (offset, rotation) = displacement_of(&bodies.tracker[body].target, &pose);
    let wanted = bodies.displacement[body];
    let arrived = pose == state.legs.wanted[body];
    bodies.displacement[body] = if arrived {
        wanted
    } else {
        Displacement {
            offset,
            rotation,
            velocity: kept(wanted.velocity, offset - wanted.offset, moved),
            spin: kept(wanted.spin, rotation - wanted.rotation, moved),
        }
    };
    describe(
        &mut bodies.report[body],
        &bodies.coupling[body],
        &bodies.displacement[body],
    );
}

/// The rate that is left when contact corrected a displacement by `correction`: no part of it works
/// against the correction. None at all when the body did not move.
fn kept(rate: Vec3, correction: Vec3, moved: bool) -> Vec3 {
    if !moved {
        return Vec3::ZERO;
    }
    match math::direction(correction) {
        Some(along) => rate - along * math::min(rate.dot(along), 0.0),
        None => rate,
    }
}

fn describe(report: &mut DrivenReport, coupling: &Coupling, displacement: &Displacement) {
    let length = math::length(displacement.offset);
    report.displacement_m = length;
    report.force_n = (displacement.offset * coupling.stiffness_n_per_m).to_array();
    if length > coupling.divergence_m {
        report.flags |= DrivenReport::DETACHED;
    }
}
