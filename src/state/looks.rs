//! Looks: what driven bodies that a frame cut know of their gaps, so that the next frame goes on from there.
//!
//! A gap depends on where its two pieces are and on nothing else. So it is written down with their poses, and
//! holds as it is while they stay. When they have moved, whoever moved them, at least what they cannot have
//! used up of it is left.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::geometry::motion::{Motion, Track};
use crate::limits::{GAP_TOUCHING_M, LOOK_FRAMES_MAX};
use crate::math::{self, Pose};
use crate::memory::columns::columns;
use crate::memory::ids::PieceId;
use crate::state::State;
use crate::state::contacts::{Pair, scan_parts};
use crate::state::pieces::PiecesOf;
use crate::state::purse::Purse;
use crate::state::ways::{Position, is_own, lost_m, pair_poses};

/// What a distance query found out about two pieces.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct Look {
    /// Piece of the body that was cut.
    a: PieceId,
    /// The other piece.
    b: PieceId,
    /// Where they were: in the root's frame for pieces of one body.
    poses: [Pose; 2],
    /// A lower bound of the gap there, less what is lost, in metres.
    gap: f32,
    lost: f32,
    /// As [`Pair`] has them.
    normal: Vec3,
    point: Vec3,
    measured: u32,
}

columns! {
    /// What is known of the gaps of driven bodies that the last frame cut.
    pub(crate) struct Looks(capacities) {
        /// Those of one body follow each other, in the order of its pairs; no gaps between bodies.
        list: [Look; capacities.pairs],
        /// Where those of a body begin, and how many there are.
        first: [u32; capacities.bodies],
        count: [u32; capacities.bodies],
        /// Where the body's root was.
        root: [Pose; capacities.bodies],
        /// How many frames in a row may be through before they are forgotten: as many as were cut. A frame
        /// that is through may only be so because of what it knew.
        patience: [u32; capacities.bodies],
    }
}

impl Looks<'_> {
    /// Notes whether a frame was cut before a body was through.
    #[inline]
    pub(crate) fn age(&mut self, body: usize, is_cut: bool) {
        if is_cut || self.patience[body] > 0 || self.count[body] > 0 {
            self.count_frame(body, is_cut);
        }
    }

    #[cold]
    fn count_frame(&mut self, body: usize, is_cut: bool) {
        let patience = &mut self.patience[body];
        if is_cut {
            *patience = (*patience + 1).min(LOOK_FRAMES_MAX);
            return;
        }
        *patience = patience.saturating_sub(1);
        if *patience == 0 {
            self.forget(body);
        }
    }

    /// How many there are of all bodies.
    fn used(&self) -> usize {
        self.count.iter().sum::<u32>() as usize
    }

    /// Forgets what is known of a body's gaps.
    #[cold]
    pub(crate) fn forget(&mut self, body: usize) {
        let count = core::mem::take(&mut self.count[body]);
        if count == 0 {
            return;
        }
        let first = self.first[body];
        let used = self.used() + count as usize;
        self.list
            .copy_within((first + count) as usize..used, first as usize);
        for other in self.first.iter_mut() {
            if *other > first {
                *other -= count;
            }
        }
    }
}

/// Writes down what is known of a body's pairs where it is, as far as there is room.
#[cold]
pub(crate) fn keep(state: &mut State, body: usize, pairs: usize, at: &Position) {
    state.looks.forget(body);
    let first = state.looks.used();
    let mut count = 0;
    for index in 0..pairs {
        let pair = state.pairs.list[index];
        let is_known = pair.measured == 1 || pair.gap > GAP_TOUCHING_M;
        // What boxes tell apart has no normal, and takes no query in the next frame either.
        if pair.normal == Vec3::ZERO || !is_known {
            continue;
        }
        let look = Look {
            a: state.pieces.id(pair.a),
            b: state.pieces.id(pair.b),
            poses: pair_poses(state, &pair, at),
            gap: pair.gap,
            lost: pair.lost,
            normal: pair.normal,
            point: pair.point,
            measured: pair.measured,
        };
        let Some(slot) = state.looks.list.get_mut(first + count) else {
            break;
        };
        *slot = look;
        count += 1;
    }
    state.looks.first[body] = first as u32;
    state.looks.count[body] = count as u32;
    state.looks.root[body] = at.root;
}

/// Takes the parts of a unit for looking through what is known of a body, and for closing the gap that it leaves
/// among what is known of others; false when there are too few, and always in a frame without units.
pub(crate) fn pays(state: &State, body: usize, purse: &mut Purse) -> bool {
    let closed = state.looks.used() / 8;
    purse.take_parts(1 + scan_parts(state.looks.count[body] as usize + closed))
}

/// Fills in what is known of a body's pairs, of which nothing else is known yet, where it is now.
#[cold]
pub(crate) fn recall(state: &mut State, body: usize, pairs: usize, at: &Position) {
    number_pieces(state, body);
    let same_root = state.looks.root[body] == at.root;
    let mut next = state.looks.first[body] as usize;
    let end = next + state.looks.count[body] as usize;
    for index in 0..pairs {
        let pair = state.pairs.list[index];
        let place = place_of(state, pair.a, pair.b);
        while next < end && is_before(state, body, &state.looks.list[next], place) {
            next += 1;
        }
        if next == end {
            return;
        }
        let look = state.looks.list[next];
        if [look.a, look.b] == [pair.a, pair.b].map(|piece| state.pieces.id(piece)) {
            state.pairs.list[index] = recalled(state, pair, &look, at, same_root);
        }
    }
}

/// A pair with what is left of the gap that it had.
fn recalled(state: &State, pair: Pair, look: &Look, at: &Position, same_root: bool) -> Pair {
    let poses = pair_poses(state, &pair, at);
    let pieces = [pair.a, pair.b].map(|piece| piece as usize);
    let moved_by = |i: usize| {
        let reach = state.pieces.shape[pieces[i]].core_reach();
        distance(look.poses[i], poses[i], reach)
    };
    let moved = moved_by(0) + moved_by(1);
    let lost = math::max(look.lost, lost_m(state, &pair, &at.still(), &poses[0], 0.0));
    let gap = look.gap - (lost - look.lost) - moved;
    let holds = moved == 0.0 && (same_root || !is_own(state, &pair));
    if !holds && gap <= GAP_TOUCHING_M {
        return pair;
    }
    Pair {
        gap,
        lost,
        normal: look.normal,
        point: look.point,
        measured: if holds { look.measured } else { 0 },
        ..pair
    }
}

/// The farthest that a point of a piece is from where it was, in metres.
fn distance(was: Pose, is: Pose, core_reach_m: f32) -> f32 {
    if was == is {
        return 0.0;
    }
    let way = Motion::new(
        Track::between(was, is),
        Track::still(Pose::IDENTITY),
        core_reach_m,
    );
    let numbers = was.translation().abs() + is.translation().abs();
    let rounding = 4.0 * f32::EPSILON * (numbers.element_sum() + core_reach_m);
    way.way_m() + rounding
}

/// Numbers the pieces of a body in their order.
fn number_pieces(state: &mut State, body: usize) {
    let pieces = PiecesOf::new(state.pieces.next, state.bodies.first_piece[body]);
    for (number, piece) in pieces.enumerate() {
        state.pairs.number[piece] = number as u32;
    }
}

/// Where a pair stands among those of its body: with others first, by its own pieces' order.
fn place_of(state: &State, a: u32, b: u32) -> (bool, u32, u32) {
    let own = state.pieces.body[a as usize] == state.pieces.body[b as usize];
    let number = |piece: u32| state.pairs.number[piece as usize];
    (own, number(a), if own { number(b) } else { b })
}

/// Whether what is known is of a pair before that one, or of pieces that are no more.
fn is_before(state: &State, body: usize, look: &Look, place: (bool, u32, u32)) -> bool {
    let [Some(a), Some(b)] = [look.a, look.b].map(|id| id.find(state.pieces.generation)) else {
        return true;
    };
    state.pieces.body[a] as usize != body || place_of(state, a as u32, b as u32) < place
}
