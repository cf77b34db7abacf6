//! 2 pairs: which pieces may touch this frame.
//!
//! Boxes swept over the frame, all against all: up to about 256 boxes nothing is faster, and it
//! does not care about coherence. A mover's own box is tested first, so that a hand in free air
//! costs one pass over the pieces' boxes.

mod own;

use core::ops::Range;

use crate::limits::PAIR_MARGIN_M;
use crate::math;
use crate::state::State;
use crate::state::bodies::BodyKind;
use crate::state::chains::has_chains;
use crate::state::contacts::{PairsFull, push};
use crate::state::pieces::{Bounds, PiecesOf, Touched};
use crate::state::ways::{BodyTrack, Rests, piece_motion, swept_bounds};

/// A box around everything a driven body can touch on a way, from its reach about its root alone.
fn whole_bounds(state: &State, body: usize, track: &BodyTrack) -> Bounds {
    let pieces = &state.pieces;
    let skeleton = has_chains(state, body);
    let mut reach = 0.0;
    for piece in PiecesOf::new(pieces.next, state.bodies.first_piece[body]) {
        let arm = math::max(
            pieces.local[piece].translation().length_squared(),
            pieces.local_target[piece].translation().length_squared(),
        );
        let mut own = math::sqrt(arm) + pieces.shape[piece].reach;
        if skeleton {
            own += arm_of_link(state, pieces.link[piece]);
        }
        reach = math::max(reach, own);
    }
    let (from, to) = (track.root.from.translation(), track.root.to.translation());
    Bounds {
        low: math::min_each(from, to),
        high: math::max_each(from, to),
    }
    .grown(reach + PAIR_MARGIN_M)
}

/// The farthest that a link can be from the root, in metres.
fn arm_of_link(state: &State, link: u32) -> f32 {
    let (mut arm, mut next) = (0.0, link);
    while let Some(joint) = next.checked_sub(1) {
        arm += state.joints.length[joint as usize];
        next = state.joints.parent[joint as usize];
    }
    arm
}

/// Writes the pairs of a driven body that moves so: with fixed pieces, with pieces of other driven
/// bodies where they are now, and of its own links with each other.
///
/// Cost: a pass over all pieces' boxes, one for each piece of the body when anything is near, and one
/// over the pairs of its own pieces when its chains meet each other.
pub(crate) fn collect_driven(
    state: &mut State,
    body: usize,
    track: &BodyTrack,
) -> Result<usize, PairsFull> {
    let whole = whole_bounds(state, body, track);
    state.legs.whole[body] = state.legs.whole[body].union(whole);
    let near = obstacles_near(state, body, &whole);
    let rests = Rests::on(state, body, track);
    let mut count = 0;
    let keeps = has_chains(state, body);
    let mut current = if near.is_empty() && !keeps {
        0
    } else {
        state.bodies.first_piece[body]
    };
    while current != 0 {
        let piece = current as usize - 1;
        current = state.pieces.next[piece];
        if near.is_empty() {
            state.pairs.swept[piece] = Bounds::ALL;
            continue;
        }
        let bounds = any_way(state, piece, track, &rests).grown(PAIR_MARGIN_M);
        if keeps {
            state.pairs.swept[piece] = bounds;
        }
        for other in near.clone() {
            if is_obstacle_near(state, other, body, &bounds) && !pass(state, piece, other) {
                let mark = &mut state.registers.high_water.pairs;
                push(state.pairs.list, &mut count, mark, piece, other)?;
            }
        }
    }
    if keeps {
        own::collect(state, body, track, &rests, &mut count)?;
    }
    recall(state, count);
    Ok(count)
}

/// Begins searches where those of earlier frames ended.
fn recall(state: &mut State, count: usize) {
    for pair in &mut state.pairs.list[..count] {
        let known = &state.pieces.touched[pair.a as usize];
        if known.other == state.pieces.id(pair.b) {
            pair.feature = known.feature;
        }
    }
}

/// Writes down where searches between pieces that touch ended.
pub(crate) fn remember(state: &mut State, count: usize) {
    for pair in &state.pairs.list[..count] {
        if pair.bends == 1 {
            state.pieces.touched[pair.a as usize] = Touched {
                other: state.pieces.id(pair.b),
                feature: pair.feature,
            };
        }
    }
}

/// A box around a piece wherever its root is on the way, and however far it has turned and moved within the
/// body there: contact may hold back the one and not the other.
fn any_way(state: &State, piece: usize, track: &BodyTrack, rests: &Rests) -> Bounds {
    if rests.where_shown(state, piece) {
        return state.pieces.bounds[piece];
    }
    let turned = |local_from: f32, local_to: f32| {
        let turning = BodyTrack {
            root: track.root.turning(),
            local_from,
            local_to,
            leg: track.leg,
        };
        swept_bounds(state, piece, &piece_motion(state, piece, &turning))
    };
    let (first, last) = (track.local_from, track.local_to);
    let mut turned_box = turned(first, last);
    if state.pieces.local[piece] != state.pieces.local_target[piece] {
        // Between these, a point of the piece is on straight lines but for what the first one bulges.
        turned_box = turned_box
            .union(turned(first, first))
            .union(turned(last, last));
    }
    let (from, to) = (track.root.from.translation(), track.root.to.translation());
    Bounds {
        low: turned_box.low + math::min_each(from, to),
        high: turned_box.high + math::max_each(from, to),
    }
}

fn pass(state: &State, piece: usize, other: usize) -> bool {
    state.pieces.body_kind[other] == BodyKind::Driven.code()
        && state.pieces.groups[piece].pass(state.pieces.groups[other])
}

fn is_obstacle_near(state: &State, piece: usize, body: usize, bounds: &Bounds) -> bool {
    let kind = state.pieces.body_kind[piece];
    if kind == BodyKind::Fixed.code() {
        return state.pieces.bounds[piece].overlaps(bounds);
    }
    kind == BodyKind::Driven.code()
        && state.registers.driven > 1
        && state.pieces.body[piece] as usize != body
        && state.legs.ahead_bounds[piece].overlaps(bounds)
}

/// The range of slots that holds all obstacles of a driven body near a box.
fn obstacles_near(state: &State, body: usize, bounds: &Bounds) -> Range<usize> {
    if state.registers.driven > 1 {
        slots_of(state, |&piece| is_obstacle_near(state, piece, body, bounds))
    } else {
        slots_of(state, |&piece| is_fixed_near(state, piece, bounds))
    }
}

/// The range of slots that holds all pieces that are near.
fn slots_of(state: &State, is_near: impl Fn(&usize) -> bool) -> Range<usize> {
    let mut slots = 0..state.registers.piece_slots as usize;
    match slots.clone().find(&is_near) {
        Some(low) => low..slots.rfind(&is_near).map_or(low, |high| high + 1),
        None => 0..0,
    }
}

fn is_fixed_near(state: &State, piece: usize, bounds: &Bounds) -> bool {
    state.pieces.body_kind[piece] == BodyKind::Fixed.code()
        && state.pieces.bounds[piece].overlaps(bounds)
}

/// Whether the pairs of a body with chains, collected for another way, hold for this one too, provided
/// that the root goes no farther. Where nothing at all was near, no piece can have come near anything.
pub(crate) fn cover(state: &mut State, body: usize, track: &BodyTrack) -> bool {
    let rests = Rests::on(state, body, track);
    PiecesOf::new(state.pieces.next, state.bodies.first_piece[body]).all(|piece| {
        let known = state.pairs.swept[piece];
        known == Bounds::ALL
            || if rests.where_shown(state, piece) {
                known.contains(&state.pieces.bounds[piece])
            } else {
                let motion = piece_motion(state, piece, track);
                known.contains(&swept_bounds(state, piece, &motion))
            }
    }) && own::cover(state, body, track, &rests)
}
