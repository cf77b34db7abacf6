//! Publish: poses for the host to draw.

use core::ops::Range;

use glam::Vec3;

use crate::geometry::linkage::angle_at;
use crate::geometry::motion::interpolate;
use crate::math::{self, Pose, displacement_of};
use crate::state::State;
use crate::state::bodies::{BodyKind, Coupling, Displacement, DrivenReport, is_body_of, is_loose};
use crate::state::chains::{ChainOptions, joints_of, next_chain, slot_range};
use crate::state::islands::NONE;
use crate::state::pieces::Bounds;
use crate::state::ways::{Position, comes_before, comes_to, is_before};

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
        let root_moves = state.bodies.pose[body] != reached.root;
        state.bodies.pose[body] = reached.root;
        move_links(state, body, reached, root_moves);
        move_pieces(state, body, reached.local, root_moves);
    }
    settle(state, body, reached.is_some());
    settle_chains(state, body);
}

/// Publishes the angles that a driven body has where it came to, and the links that they or the root moved.
/// Notes the first joint of each chain whose link moved in the body's frame.
fn move_links(state: &mut State, body: usize, reached: &Position, root_moves: bool) {
    let slot = slot_range(state, reached.leg).start;
    let mut chain = state.bodies.first_chain[body];
    while let Some(index) = chain.checked_sub(1) {
        let index = index as usize;
        let joints = joints_of(state, index);
        let angles = &mut state.joints.angle[joints.clone()];
        let ways = [&*state.ways.from, &*state.ways.to].map(|way| &way[slot..][joints.clone()]);
        let mut first = joints.end;
        for (place, angle) in angles.iter_mut().enumerate().rev() {
            let reached = angle_at(ways[0][place], ways[1][place], reached.share);
            if angle.to_bits() != reached.to_bits() {
                first = joints.start + place;
            }
            *angle = reached;
        }
        if state.chains.base[index]
            .checked_sub(1)
            .is_some_and(|joint| !is_before(state, joint as usize, state.ways.leaves))
        {
            first = joints.start;
        }
        state.ways.leaves[index] = first as u32;
        if reached.share >= 1.0 {
            let links = &state.ways.to_link[slot..][first..joints.end];
            state.joints.link[first..joints.end].copy_from_slice(links);
        } else {
            place_chain(state, first..joints.end);
        }
        let from = if root_moves { joints.start } else { first };
        place_chain_in_world(state, body, from..joints.end);
        chain = next_chain(state, index);
    }
}

/// Publishes the pieces that their link, the root or their way to their target local poses moved, by a share of
/// that way.
fn move_pieces(state: &mut State, body: usize, share: f32, root_moves: bool) {
    let mut next = state.bodies.first_piece[body];
    while let Some(piece) = next.checked_sub(1) {
        let piece = piece as usize;
        next = state.pieces.next[piece];
        let pieces = &mut state.pieces;
        let (before, target) = (pieces.local[piece], pieces.local_target[piece]);
        let local_moves = before != target;
        if local_moves {
            pieces.local[piece] = interpolate(&before, &target, share);
        }
        if root_moves || local_moves || !comes_before(state, piece, state.ways.leaves) {
            place_piece(state, body, piece);
        }
    }
}

/// Recomputes the links of a body from its published angles.
pub(crate) fn place_published_links(state: &mut State, body: usize) {
    let mut chain = state.bodies.first_chain[body];
    while let Some(index) = chain.checked_sub(1) {
        let joints = joints_of(state, index as usize);
        place_chain(state, joints);
        chain = next_chain(state, index as usize);
    }
}

/// Recomputes links of a chain, the last of its joints, from its published angles.
fn place_chain(state: &mut State, joints: Range<usize>) {
    for joint in joints {
        let joints = &mut state.joints;
        let parent = joints.parent[joint].checked_sub(1);
        let base = parent.map_or(Pose::IDENTITY, |parent| joints.link[parent as usize]);
        joints.link[joint] = joints.hinge[joint].placed(&base, joints.angle[joint]);
    }
}

fn place_chain_in_world(state: &mut State, body: usize, joints: Range<usize>) {
    let pose = state.bodies.pose[body];
    for joint in joints {
        state.joints.world[joint] = pose.then(&state.joints.link[joint]);
    }
}

/// Recomputes the world poses of a body's links, and the poses and boxes of its pieces.
pub(crate) fn place_pieces(state: &mut State, body: usize) {
    let mut chain = state.bodies.first_chain[body];
    while let Some(index) = chain.checked_sub(1) {
        let joints = joints_of(state, index as usize);
        place_chain_in_world(state, body, joints);
        chain = next_chain(state, index as usize);
    }
    let mut next = state.bodies.first_piece[body];
    while let Some(piece) = next.checked_sub(1) {
        place_piece(state, body, piece as usize);
        next = state.pieces.next[piece as usize];
    }
}

fn place_piece(state: &mut State, body: usize, piece: usize) {
    let (pieces, joints) = (&mut state.pieces, &state.joints);
    let shape = &pieces.shape[piece];
    let local = &pieces.local[piece];
    let link = pieces.link[piece].checked_sub(1);
    let world = match link {
        Some(joint) => joints.world[joint as usize].then(local),
        None => state.bodies.pose[body].then(local),
    };
    pieces.world[piece] = world;
    pieces.bounds[piece] = Bounds::of(shape, &world);
    if state.bodies.first_chain[body] != 0 {
        let own = link.map_or(*local, |joint| joints.link[joint as usize].then(local));
        pieces.own_bounds[piece] = Bounds::of(shape, &own);
    }
}

/// Writes down how far contact holds each chain from its tracked angles and its tracked tip.
fn settle_chains(state: &mut State, body: usize) {
    let mut chain = state.bodies.first_chain[body];
    while let Some(index) = chain.checked_sub(1) {
        let index = index as usize;
        let range = joints_of(state, index);
        let joints = &mut state.joints;
        let known = joints.angle[range.clone()]
            .iter()
            .zip(&joints.target[range.clone()])
            .zip(&state.ways.wanted[range.clone()]);
        let mut most = 0.0;
        let held = joints.deviation[range.clone()].iter_mut();
        let held = held.zip(&mut joints.pressed[range]);
        for ((kept, pressed), ((angle, target), wanted)) in held.zip(known) {
            let deviation = angle - target;
            if angle != wanted {
                *kept = deviation;
            }
            *pressed = angle - wanted;
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
