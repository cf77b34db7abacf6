//! Publish: poses for the host to draw.

use crate::geometry::linkage::angle_at;
use crate::geometry::motion::interpolate;
use crate::math::{self, Pose, displacement_of};
use crate::state::State;
use crate::state::bodies::{BodyKind, Coupling, Displacement, DrivenReport, is_body_of, is_loose};
use crate::state::chains::{ChainOptions, has_chains, joints_of, linkage, next_chain, slot_range};
use crate::state::islands::NONE;
use crate::state::pieces::{Bounds, PiecesOf};
use crate::state::ways::{Position, comes_to};
use glam::Vec3;

/// Writes the published poses of everything that moved.
pub(crate) fn run(state: &mut State, dt_s: f32) {
    for body in 0..state.registers.body_slots as usize {
        if is_body_of(state, body, BodyKind::Driven) {
            let before = state.bodies.pose[body].translation();
            publish_driven(state, body);
            report_reaction(state, body, dt_s);
            let is_cut = state.bodies.report[body].flags & DrivenReport::CUT != 0;
            state.looks.age(body, is_cut);
            let moved = state.bodies.pose[body].translation() - before;
            state.bodies.yielding[body].velocity = moved / dt_s;
        } else if is_loose(state, body) && moved(state, body) {
            place_pieces(state, body);
        }
    }
}

/// Whether a loose body may have moved: it is awake, or fell asleep at the end of this frame.
fn moved(state: &State, body: usize) -> bool {
    state.bodies.momentum[body].asleep == 0 || state.islands.label[body] != NONE
}

fn report_reaction(state: &mut State, body: usize, dt_s: f32) {
    let reaction = state.bodies.yielding[body].reaction / dt_s;
    // A sum of finite impulses over a short frame need not be.
    if reaction.is_finite() {
        state.bodies.report[body].reaction_n = reaction.to_array();
    }
}

fn publish_driven(state: &mut State, body: usize) {
    let reached = comes_to(state, body);
    if let Some(reached) = &reached {
        state.bodies.pose[body] = reached.root;
        move_locals(state, body, reached.local);
        if has_chains(state, body) {
            move_links(state, body, reached);
        }
        place_pieces(state, body);
    }
    settle(state, body, reached.is_some());
    settle_chains(state, body);
}

/// Moves the published local poses by a share of their way to the targets.
fn move_locals(state: &mut State, body: usize, share: f32) {
    let first = state.bodies.first_piece[body];
    let pieces = &mut state.pieces;
    for piece in PiecesOf::new(pieces.next, first) {
        pieces.local[piece] = interpolate(&pieces.local[piece], &pieces.local_target[piece], share);
    }
}

/// Publishes the angles that a driven body has where it came to.
fn move_links(state: &mut State, body: usize, reached: &Position) {
    let slot = slot_range(state, reached.leg).start;
    let mut chain = state.bodies.first_chain[body];
    while let Some(index) = chain.checked_sub(1) {
        for joint in joints_of(state, index as usize) {
            let (from, to) = (state.ways.from[slot + joint], state.ways.to[slot + joint]);
            state.joints.angle[joint] = angle_at(from, to, reached.share);
        }
        chain = next_chain(state, index as usize);
    }
    place_published_links(state, body);
}

/// Recomputes the links of a body from its published angles.
pub(crate) fn place_published_links(state: &mut State, body: usize) {
    let mut chain = state.bodies.first_chain[body];
    while let Some(index) = chain.checked_sub(1) {
        for joint in joints_of(state, index as usize) {
            let behind = linkage(state).behind(joint, state.joints.angle[joint]);
            let link = match state.joints.parent[joint].checked_sub(1) {
                Some(parent) => state.joints.link[parent as usize].then(&behind),
                None => behind,
            };
            state.joints.link[joint] =
                Pose::new(math::renormalised(link.quat()), link.translation());
        }
        chain = next_chain(state, index as usize);
    }
}

fn place_links_in_world(state: &mut State, body: usize) {
    let pose = state.bodies.pose[body];
    let mut chain = state.bodies.first_chain[body];
    while let Some(index) = chain.checked_sub(1) {
        for joint in joints_of(state, index as usize) {
            state.joints.world[joint] = pose.then(&state.joints.link[joint]);
        }
        chain = next_chain(state, index as usize);
    }
}

/// Recomputes the world poses of a body's links, and the poses and boxes of its pieces.
pub(crate) fn place_pieces(state: &mut State, body: usize) {
    let pose = state.bodies.pose[body];
    let skeleton = has_chains(state, body);
    if skeleton {
        place_links_in_world(state, body);
    }
    let first = state.bodies.first_piece[body];
    let (pieces, joints) = (&mut state.pieces, &state.joints);
    for piece in PiecesOf::new(pieces.next, first) {
        let world = if skeleton && pieces.link[piece] != 0 {
            joints.world[pieces.link[piece] as usize - 1].then(&pieces.local[piece])
        } else {
            pose.then(&pieces.local[piece])
        };
        pieces.world[piece] = world;
        pieces.bounds[piece] = Bounds::of(&pieces.shape[piece], &world);
    }
}

/// Writes down how far contact holds each chain from its tracked angles and its tracked tip.
fn settle_chains(state: &mut State, body: usize) {
    let mut chain = state.bodies.first_chain[body];
    while let Some(index) = chain.checked_sub(1) {
        let index = index as usize;
        let mut most = 0.0;
        for joint in joints_of(state, index) {
            let joints = &mut state.joints;
            let deviation = joints.angle[joint] - joints.target[joint];
            if joints.angle[joint] != state.ways.wanted[joint] {
                joints.deviation[joint] = deviation;
            }
            most = math::max(most, deviation.abs());
        }
        state.chains.report[index].deviation_rad = most;
        settle_tip(state, index);
        chain = next_chain(state, index);
    }
}

fn settle_tip(state: &mut State, chain: usize) {
    let options = &state.chains.options[chain];
    if options.has(ChainOptions::HOLDS_TIP) {
        let last = joints_of(state, chain).end - 1;
        let tip = state.joints.world[last].point(Vec3::from_array(options.tip));
        state.chains.tip_offset[chain] = tip - state.chains.tip_tracked[chain];
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
