//! 2 pairs: which pieces may touch this frame.
//!
//! Boxes swept over the frame, all against all: up to about 256 boxes nothing is faster, and it
//! does not care about coherence. A mover's own box is tested first, so that a hand in free air
//! costs one pass over the pieces' boxes.

mod own;

use core::ops::Range;

use crate::geometry::motion::Motion;
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
    let mut reach = 0.0;
    for piece in PiecesOf::new(pieces.next, state.bodies.first_piece[body]) {
        let arm = math::max(
            pieces.local[piece].translation().length_squared(),
            pieces.local_target[piece].translation().length_squared(),
        );
        let mut own = math::sqrt(arm) + pieces.shape[piece].reach;
        if let Some(joint) = pieces.link[piece].checked_sub(1) {
            own += state.joints.arm[joint as usize];
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
    if has_chains(state, body) {
        note_boxes(state, body, track, &rests, near.is_empty());
    }
    if !near.is_empty() {
        collect_obstacles(state, body, track, &rests, &near, &mut count)?;
    }
    own::collect(state, body, &mut count)?;
    recall(state, count);
    Ok(count)
}

/// Adds the pairs of a driven body with obstacles that its pieces may touch; `near` are the slots of those that it
/// may touch as a whole.
fn collect_obstacles(
    state: &mut State,
    body: usize,
    track: &BodyTrack,
    rests: &Rests,
    near: &Range<usize>,
    count: &mut usize,
) -> Result<(), PairsFull> {
    let are_known = has_chains(state, body);
    let mut current = state.bodies.first_piece[body];
    while current != 0 {
        let piece = current as usize - 1;
        current = state.pieces.next[piece];
        let bounds = if are_known {
            state.pairs.swept[piece]
        } else {
            any_way(state, piece, track, rests).grown(PAIR_MARGIN_M)
        };
        for other in near.clone() {
            if is_obstacle_near(state, other, body, &bounds) && !pass(state, piece, other) {
                let mark = &mut state.registers.high_water.pairs;
                push(state.pairs.list, count, mark, piece, other)?;
            }
        }
    }
    Ok(())
}

/// Writes down the boxes of a skeleton's pieces that pairs are looked for with, in the world and in the root's
/// frame. Where no obstacle is near, everything in the world is far enough.
fn note_boxes(state: &mut State, body: usize, track: &BodyTrack, rests: &Rests, is_far: bool) {
    let meets = own::meets_itself(state, body);
    let in_root = track.in_root();
    let mut current = state.bodies.first_piece[body];
    while let Some(piece) = current.checked_sub(1) {
        let piece = piece as usize;
        current = state.pieces.next[piece];
        if is_far {
            state.pairs.swept[piece] = Bounds::ALL;
            if !meets {
                continue;
            }
        }
        let is_shown = rests.where_shown_in_root(state, piece);
        let (world, own) = if is_shown {
            let world = rests.root_is_shown().then_some(state.pieces.bounds[piece]);
            (world, state.pieces.own_bounds[piece])
        } else if rests.root() && rests.local(state, piece) {
            // What it does in the world it does in the root's frame.
            let motion = piece_motion(state, piece, &in_root);
            let boxes = end_boxes(state, piece, track, &motion);
            (Some(boxes[0]), boxes[1])
        } else if meets {
            let motion = piece_motion(state, piece, &in_root);
            (None, swept_bounds(state, piece, &motion))
        } else {
            (None, Bounds::EMPTY)
        };
        state.ways.swept[piece] = own.grown(PAIR_MARGIN_M);
        if !is_far {
            let world = world.unwrap_or_else(|| any_way(state, piece, track, rests));
            state.pairs.swept[piece] = world.grown(PAIR_MARGIN_M);
        }
    }
}

/// Boxes around the way of a piece whose root rests, in the world and in the root's frame.
fn end_boxes(state: &State, piece: usize, track: &BodyTrack, motion: &Motion) -> [Bounds; 2] {
    let shape = &state.pieces.shape[piece];
    let at = |time: f32| {
        let own = motion.at(time);
        let world = track.root.from.then(&own);
        [Bounds::of(shape, &world), Bounds::of(shape, &own)]
    };
    let begins_where_shown = track.leg == 0 && track.local_from == 0.0;
    let body = state.pieces.body[piece] as usize;
    let first = if begins_where_shown && track.root.from == state.bodies.pose[body] {
        [state.pieces.bounds[piece], state.pieces.own_bounds[piece]]
    } else {
        at(0.0)
    };
    let last = at(1.0);
    let bulge_m = motion.bulge_m();
    [0, 1].map(|frame| first[frame].union(last[frame]).grown(bulge_m))
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
