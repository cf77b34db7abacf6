//! 5 advance: how far along a leg a driven body's pairs stay clear.
//!
//! Conservative advancement from one certified pose to the next: every pose on the way is known to be
//! safe, so the way may be cut anywhere.

use crate::geometry::time_of_contact::MovingPair;
use crate::limits::{GAP_FLOOR_M, STEP_MIN_M};
use crate::math;
use crate::state::State;
use crate::state::contacts::{Pair, choice_parts, least_certified, query_units, scan_parts};
use crate::state::purse::Purse;
use crate::state::ways::{BodyTrack, Rests, is_own, lost_m, pair_motions, piece_motion};

/// How far a leg was found clear.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Swept {
    /// Share of the leg, 0 to 1.
    pub reached: f32,
    /// The budget ended the sweep.
    pub cut: bool,
}

/// Advances a body whose ways on the leg are measured until a pair blocks the way, all are clear to the end, or the budget runs out.
///
/// Always takes the pair that is certified for the shortest time and certifies it further, so that
/// only the pairs that matter are queried, and the body may stop at any time at the least certified
/// share.
pub(crate) fn run(state: &mut State, pairs: usize, leg: &BodyTrack, purse: &mut Purse) -> Swept {
    if !purse.take_parts(scan_parts(pairs)) {
        return Swept {
            reached: 0.0,
            cut: true,
        };
    }
    start(state, pairs, leg);
    loop {
        let Some(next) = least_certified(&state.pairs.list[..pairs]) else {
            return Swept {
                reached: 1.0,
                cut: false,
            };
        };
        let time = state.pairs.list[next].clear_until;
        if time >= 1.0 {
            return Swept {
                reached: 1.0,
                cut: false,
            };
        }
        let pair = &state.pairs.list[next];
        let [a, b] = [pair.a, pair.b].map(|piece| &state.pieces.shape[piece as usize]);
        let units = query_units(a, b);
        if !purse.take_parts(choice_parts(pairs)) || !purse.take(units) {
            return Swept {
                reached: time,
                cut: true,
            };
        }
        if certify(state, next, leg, time) {
            return Swept {
                reached: time,
                cut: false,
            };
        }
    }
}

/// What is known of the gaps, as shares of this leg.
fn start(state: &mut State, pairs: usize, leg: &BodyTrack) {
    for index in 0..pairs {
        let pair = state.pairs.list[index];
        let way = way_of(state, &pair, leg);
        let slack = pair.gap - GAP_FLOOR_M;
        let until = if slack > 0.0 {
            math::min(slack / math::max(way, 1e-30), 1.0)
        } else {
            0.0
        };
        let pair = &mut state.pairs.list[index];
        pair.clear_until = until;
        pair.gap_time = 0.0;
    }
}

/// How far the pieces of a body go on a leg, in metres: written down for its pairs; the farthest of them.
pub(crate) fn measure_ways(state: &mut State, body: usize, leg: &BodyTrack) -> f32 {
    let rests = Rests::on(state, body, leg);
    let mut farthest = 0.0;
    let mut next = state.bodies.first_piece[body];
    while let Some(piece) = next.checked_sub(1) {
        let piece = piece as usize;
        let way = if rests.piece(state, piece) {
            0.0
        } else {
            piece_motion(state, piece, leg).way_m()
        };
        state.pairs.way[piece] = way;
        state.pairs.own_way[piece] = if rests.root() {
            way
        } else if rests.in_root(state, piece) {
            0.0
        } else {
            -1.0
        };
        farthest = math::max(farthest, way);
        next = state.pieces.next[piece];
    }
    farthest
}

/// How much nearer the pieces of a pair can come on the whole leg, in metres.
fn way_of(state: &mut State, pair: &Pair, leg: &BodyTrack) -> f32 {
    let (a, b) = (pair.a as usize, pair.b as usize);
    if is_own(state, pair) {
        own_way(state, a, leg) + own_way(state, b, leg)
    } else {
        state.pairs.way[a]
    }
}

/// How far a piece goes as its own root sees it. Worked out once a leg.
fn own_way(state: &mut State, piece: usize, leg: &BodyTrack) -> f32 {
    if state.pairs.own_way[piece] < 0.0 {
        state.pairs.own_way[piece] = piece_motion(state, piece, &leg.in_root()).way_m();
    }
    state.pairs.own_way[piece]
}

/// Certifies a pair beyond `time`; true when it cannot be, so that it blocks the way.
fn certify(state: &mut State, index: usize, leg: &BodyTrack, time: f32) -> bool {
    let pair = state.pairs.list[index];
    let (a, b) = (pair.a as usize, pair.b as usize);
    let (motion_a, motion_b) = pair_motions(state, &pair, leg);
    let way = motion_a.way_m() + motion_b.way_m();
    let moving = MovingPair {
        a: state.pools.convex(&state.pieces.shape[a]),
        b: state.pools.convex(&state.pieces.shape[b]),
        motion_a,
        motion_b,
    };
    let lost = lost_m(state, &pair, leg, &moving.motion_a.at(time), time);
    let floor_m = GAP_FLOOR_M + lost;
    let mut feature = pair.feature;
    let mut found = moving.clear_until(time, floor_m, &mut feature, 0.0);
    found.clear_until = moving.clear_nearby(time, floor_m, &found);
    if is_own(state, &pair) {
        let root = leg.root.at(time);
        found.normal = root.quat() * found.normal;
        found.point = root.point(found.point);
    }
    let pair = &mut state.pairs.list[index];
    pair.feature = feature;
    pair.gap = found.gap_m - lost;
    pair.lost = lost;
    pair.gap_time = time;
    pair.normal = found.normal;
    pair.point = found.point;
    pair.clear_until = math::max(time, found.clear_until);
    let gained = (pair.clear_until - time) * way;
    pair.clear_until < 1.0 && gained < STEP_MIN_M
}

/// Carries what is known of the gaps over to the next leg, which starts at share `reached` of this
/// one: the pair that blocked was measured right there, the others have at least what the motion
/// leaves them.
pub(crate) fn carry_over(state: &mut State, pairs: usize, leg: &BodyTrack, reached: f32) {
    for index in 0..pairs {
        let pair = state.pairs.list[index];
        let moved = (reached - pair.gap_time) * way_of(state, &pair, leg);
        let pair = &mut state.pairs.list[index];
        if moved != 0.0 {
            pair.gap -= moved.abs();
            pair.measured = 0;
        } else {
            pair.measured = u32::from(pair.normal != glam::Vec3::ZERO);
        }
    }
}
