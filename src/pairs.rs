//! 2 pairs: which pieces may touch this frame.
//!
//! Boxes swept over the frame, all against all: up to about 256 boxes nothing is faster, and it
//! does not care about coherence. A mover's own box is tested first, so that a hand in free air
//! costs one pass over the pieces' boxes.

use core::ops::Range;

use crate::geometry::motion::{Motion, Track};
use crate::geometry::warm::WarmFeature;
use crate::limits::PAIR_MARGIN_M;
use crate::math::{self, Pose};
use crate::memory::ids::is_alive;
use crate::state::State;
use crate::state::bodies::BodyKind;
use crate::state::contacts::Pair;
use crate::state::pieces::{Bounds, PiecesOf};

/// There was no room for all pairs: raise [`crate::memory::Capacities::pairs`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PairsFull;

/// How a body's root and its pieces' local poses move.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BodyTrack {
    pub root: Track,
    /// Shares of the way from the published to the target local poses.
    pub local_from: f32,
    pub local_to: f32,
}

impl BodyTrack {
    pub(crate) fn still(pose: Pose, local: f32) -> Self {
        Self {
            root: Track::still(pose),
            local_from: local,
            local_to: local,
        }
    }
}

/// The motion of one piece of a body that moves so.
pub(crate) fn piece_motion(state: &State, piece: usize, track: &BodyTrack) -> Motion {
    let pieces = &state.pieces;
    let shape = &state.pieces.shape[piece];
    let local = Track {
        from: pieces.local[piece],
        to: pieces.local_target[piece],
        start: track.local_from,
        end: track.local_to,
    };
    Motion::new(track.root, local, shape.core_reach())
}

/// A box around a piece's whole way.
pub(crate) fn swept_bounds(state: &State, piece: usize, motion: &Motion) -> Bounds {
    let shape = &state.pieces.shape[piece];
    Bounds::of(shape, &motion.at(0.0))
        .union(Bounds::of(shape, &motion.at(1.0)))
        .grown(motion.bulge_m())
}

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

/// Adds a pair of which nothing is known yet.
pub(crate) fn push(
    state: &mut State,
    count: &mut usize,
    a: usize,
    b: usize,
) -> Result<(), PairsFull> {
    let slot = state.pairs.list.get_mut(*count).ok_or(PairsFull)?;
    *slot = Pair {
        a: a as u32,
        b: b as u32,
        gap: 0.0,
        gap_time: 0.0,
        clear_until: 0.0,
        normal: glam::Vec3::ZERO,
        feature: WarmFeature::new(),
        point: glam::Vec3::ZERO,
        bends: 0,
        bending_gap: 0.0,
        measured: 0,
    };
    *count += 1;
    let mark = &mut state.registers.high_water.pairs;
    *mark = (*mark).max(*count as u32);
    Ok(())
}

/// Bodies of one kind that are in use, in the order of their slots.
pub(crate) fn is_body_of(state: &State, body: usize, kind: BodyKind) -> bool {
    is_alive(state.bodies.generation[body]) && state.bodies.kind[body] == kind.code()
}
