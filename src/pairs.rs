//! 2 pairs: which pieces may touch this frame.
//!
//! Boxes swept over the frame, all against all: up to about 256 boxes nothing is faster, and it
//! does not care about coherence. A mover's own box is tested first, so that a hand in free air
//! costs one pass over the pieces' boxes.

use core::ops::Range;

use crate::limits::PAIR_MARGIN_M;
use crate::math;
use crate::state::State;
use crate::state::bodies::BodyKind;
use crate::state::contacts::{PairsFull, push};
use crate::state::pieces::{Bounds, PiecesOf};
use crate::state::ways::{BodyTrack, piece_motion, swept_bounds};

/// A box around everything a driven body can touch on a way, from its reach about its root alone.
fn whole_bounds(state: &State, body: usize, track: &BodyTrack) -> Bounds {
    let pieces = &state.pieces;
    let mut reach = 0.0;
    for piece in PiecesOf::new(pieces.next, state.bodies.first_piece[body]) {
        let arm = math::max(
            pieces.local[piece].translation().length_squared(),
            pieces.local_target[piece].translation().length_squared(),
        );
        reach = math::max(reach, math::sqrt(arm) + pieces.shape[piece].reach);
    }
    let (from, to) = (track.root.from.translation(), track.root.to.translation());
    Bounds {
        low: math::min_each(from, to),
        high: math::max_each(from, to),
    }
    .grown(reach + PAIR_MARGIN_M)
}

/// Writes the pairs of a driven body that moves so with fixed pieces; how many there are.
///
/// Cost: a pass over all pieces' boxes, and one for each piece of the body when anything is near.
pub(crate) fn collect_driven(
    state: &mut State,
    body: usize,
    track: &BodyTrack,
) -> Result<usize, PairsFull> {
    let whole = whole_bounds(state, body, track);
    state.legs.whole[body] = state.legs.whole[body].union(whole);
    let near = fixed_near(state, &whole);
    let mut count = 0;
    let mut current = if near.is_empty() {
        0
    } else {
        state.bodies.first_piece[body]
    };
    while current != 0 {
        let piece = current as usize - 1;
        let motion = piece_motion(state, piece, track);
        let bounds = swept_bounds(state, piece, &motion).grown(PAIR_MARGIN_M);
        for other in near.clone() {
            if is_fixed_near(state, other, &bounds) {
                push(state, &mut count, piece, other)?;
            }
        }
        current = state.pieces.next[piece];
    }
    Ok(count)
}

fn is_fixed_near(state: &State, piece: usize, bounds: &Bounds) -> bool {
    state.pieces.body_kind[piece] == BodyKind::Fixed.code()
        && state.pieces.bounds[piece].overlaps(bounds)
}

/// The range of slots that holds all fixed pieces near a box.
fn fixed_near(state: &State, bounds: &Bounds) -> Range<usize> {
    let mut slots = 0..state.registers.piece_slots as usize;
    let is_near = |&piece: &usize| is_fixed_near(state, piece, bounds);
    match slots.clone().find(is_near) {
        Some(low) => low..slots.rfind(is_near).map_or(low, |high| high + 1),
        None => 0..0,
    }
}

/// Whether a piece of a dynamic body is near the box around a driven body's way.
pub(crate) fn loose_near(state: &State, body: usize) -> bool {
    let whole = state.legs.whole[body];
    (0..state.registers.piece_slots as usize).any(|piece| {
        state.pieces.body_kind[piece] == BodyKind::Dynamic.code()
            && state.pieces.bounds[piece].overlaps(&whole)
    })
}
