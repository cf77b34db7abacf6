//! Pairs of pieces of one body: links of its chains with each other and with its root.

use arrayvec::ArrayVec;

use crate::limits::CHAINS_PER_BODY_MAX;
use crate::state::State;
use crate::state::chains::{ChainOptions, chains_of};
use crate::state::contacts::{PairsFull, push};
use crate::state::pieces::{Bounds, PiecesOf};
use crate::state::ways::{BodyTrack, Rests, piece_motion, swept_bounds};

/// Pieces of one chain, or of the root, that follow each other in their body's list.
struct Run {
    /// The first of them and what follows the last, indices plus one.
    first: u32,
    end: u32,
    /// `None` for the root.
    chain: Option<u32>,
    /// There was no room for more runs, and this one goes on with others' pieces.
    is_mixed: bool,
    /// Around their boxes.
    bounds: Bounds,
}

/// As many runs as chains and the root have when each one's pieces follow each other.
type Runs = ArrayVec<Run, { CHAINS_PER_BODY_MAX + 1 }>;

/// Adds the pairs of a body's own pieces that may touch, whose boxes are known in the root's frame, in which the
/// root's motion does not show. Pieces of one chain do not meet.
pub(super) fn collect(state: &mut State, body: usize, count: &mut usize) -> Result<(), PairsFull> {
    if !meets_itself(state, body) {
        return Ok(());
    }
    let mut runs = Runs::new();
    let mut first = state.bodies.first_piece[body];
    while let Some(piece) = first.checked_sub(1) {
        let piece = piece as usize;
        let bounds = state.ways.swept[piece];
        let chain = chain_of(state, piece);
        for run in &runs {
            if (run.is_mixed || run.chain != chain) && run.bounds.overlaps(&bounds) {
                collect_with(state, piece, run, count)?;
            }
        }
        let next = state.pieces.next[piece];
        note(&mut runs, chain, &bounds, first, next);
        first = next;
    }
    Ok(())
}

/// Adds a piece to the last run if it goes on with it, or begins another one.
fn note(runs: &mut Runs, chain: Option<u32>, bounds: &Bounds, first: u32, end: u32) {
    let is_full = runs.is_full();
    match runs.last_mut() {
        Some(run) if run.chain == chain || is_full => {
            run.end = end;
            run.is_mixed |= run.chain != chain;
            run.bounds = run.bounds.union(*bounds);
        }
        _ => runs.push(Run {
            first,
            end,
            chain,
            is_mixed: false,
            bounds: *bounds,
        }),
    }
}

/// Adds the pairs of a piece with those of a run before it.
fn collect_with(
    state: &mut State,
    piece: usize,
    run: &Run,
    count: &mut usize,
) -> Result<(), PairsFull> {
    let bounds = state.ways.swept[piece];
    let mut second = run.first;
    while second != run.end {
        let other = second as usize - 1;
        if bounds.overlaps(&state.ways.swept[other]) && may_meet(state, piece, other) {
            let mark = &mut state.registers.high_water.pairs;
            push(state.pairs.list, count, mark, piece, other)?;
        }
        second = state.pieces.next[other];
    }
    Ok(())
}

/// The chain that a piece is on; nothing for the root.
fn chain_of(state: &State, piece: usize) -> Option<u32> {
    let joint = state.pieces.link[piece].checked_sub(1)?;
    Some(state.joints.chain[joint as usize])
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

pub(super) fn meets_itself(state: &State, body: usize) -> bool {
    chains_of(state, body).any(|chain| state.chains.options[chain].has(ChainOptions::MEETS_BODY))
}

/// Whether two pieces of a body keep out of each other: they are on different chains, or one is on the
/// root, they are no neighbours, and the host did not let them pass.
fn may_meet(state: &State, a: usize, b: usize) -> bool {
    let links = [a, b].map(|piece| state.pieces.link[piece]);
    let chains = [a, b].map(|piece| chain_of(state, piece));
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
