//! Pairs of pieces of one body: links of its chains with each other and with its root.

use crate::limits::PAIR_MARGIN_M;
use crate::state::State;
use crate::state::chains::{ChainOptions, chains_of};
use crate::state::contacts::{PairsFull, push};
use crate::state::pieces::{Bounds, PiecesOf};
use crate::state::ways::{BodyTrack, Rests, piece_motion, swept_bounds};

/// Adds the pairs of a body's own pieces that may touch. They are looked for in the root's frame, in
/// which the root's motion does not show.
pub(super) fn collect(
    state: &mut State,
    body: usize,
    track: &BodyTrack,
    rests: &Rests,
    count: &mut usize,
) -> Result<(), PairsFull> {
    if !meets_itself(state, body) {
        return Ok(());
    }
    let in_root = track.in_root();
    let mut first = state.bodies.first_piece[body];
    while let Some(piece) = first.checked_sub(1) {
        let piece = piece as usize;
        let bounds = if rests.where_shown_in_root(state, piece) {
            state.pieces.own_bounds[piece]
        } else if rests.in_root(state, piece) {
            let shape = &state.pieces.shape[piece];
            Bounds::of(shape, &piece_motion(state, piece, &in_root).at(0.0))
        } else {
            swept_bounds(state, piece, &piece_motion(state, piece, &in_root))
        };
        let bounds = bounds.grown(PAIR_MARGIN_M);
        state.ways.swept[piece] = bounds;
        let mut second = state.bodies.first_piece[body];
        while second != first {
            let other = second as usize - 1;
            if bounds.overlaps(&state.ways.swept[other]) && may_meet(state, piece, other) {
                let mark = &mut state.registers.high_water.pairs;
                push(state.pairs.list, count, mark, piece, other)?;
            }
            second = state.pieces.next[other];
        }
        first = state.pieces.next[piece];
    }
    Ok(())
}

/// Whether the boxes that were looked at hold this way too.
pub(super) fn cover(state: &State, body: usize, track: &BodyTrack, rests: &Rests) -> bool {
    if !meets_itself(state, body) {
        return true;
    }
    let in_root = track.in_root();
    PiecesOf::new(state.pieces.next, state.bodies.first_piece[body]).all(|piece| {
        // Every box that was looked at holds the place where the piece is.
        rests.in_root(state, piece) || {
            let motion = piece_motion(state, piece, &in_root);
            state.ways.swept[piece].contains(&swept_bounds(state, piece, &motion))
        }
    })
}

fn meets_itself(state: &State, body: usize) -> bool {
    chains_of(state, body).any(|chain| state.chains.options[chain].has(ChainOptions::MEETS_BODY))
}

/// Whether two pieces of a body keep out of each other: they are on different chains, or one is on the
/// root, they are no neighbours, and the host did not let them pass.
fn may_meet(state: &State, a: usize, b: usize) -> bool {
    let links = [a, b].map(|piece| state.pieces.link[piece]);
    let chains = links.map(|link| Some(state.joints.chain[link.checked_sub(1)? as usize]));
    let meets = |chain: Option<u32>| {
        chain.is_none_or(|c| state.chains.options[c as usize].has(ChainOptions::MEETS_BODY))
    };
    chains[0] != chains[1]
        && chains.into_iter().all(meets)
        && !state.pieces.groups[a].pass(state.pieces.groups[b])
        && before(state, links[0]) != Some(origin(state, links[1]))
        && before(state, links[1]) != Some(origin(state, links[0]))
}

/// The first of the hinges with the same centre, index plus one; zero for the root.
fn origin(state: &State, link: u32) -> u32 {
    let mut link = link;
    while let Some(joint) = link.checked_sub(1) {
        if state.joints.length[joint as usize] > 0.0 {
            break;
        }
        link = state.joints.parent[joint as usize];
    }
    link
}

/// The neighbour of a link toward the root, as [`origin`] names it; nothing for the root.
fn before(state: &State, link: u32) -> Option<u32> {
    let joint = origin(state, link).checked_sub(1)?;
    Some(origin(state, state.joints.parent[joint as usize]))
}
