//! How far along a stretch everybody stays clear of the loose bodies.

use glam::Vec3;

use super::Stretch;
use super::movers::{is_stopped, motion};
use crate::frame::FrameReport;
use crate::frame::budget::Purse;
use crate::geometry::time_of_contact::MovingPair;
use crate::limits::{GAP_FLOOR_M, LOOSE_MARGIN_M, STEP_MIN_M};
use crate::math;
use crate::pairs;
use crate::state::State;
use crate::state::bodies::BodyKind;
use crate::state::contacts::Pair;
use crate::state::pieces::Bounds;

/// A box around a piece's whole way through a stretch.
pub(super) fn swept_bounds(state: &State, piece: usize, stretch: &Stretch) -> Bounds {
    if state.pieces.body_kind[piece] == BodyKind::Fixed.code() {
        return state.pieces.bounds[piece];
    }
    pairs::swept_bounds(state, piece, &motion(state, piece, stretch))
}

/// Writes the pairs that may touch in a stretch and have a loose body in them; how many there are,
/// `None` when there is no room: raise [`crate::memory::Capacities::pairs`].
pub(super) fn collect(
    state: &mut State,
    stretch: &Stretch,
    report: &mut FrameReport,
) -> Option<usize> {
    let slots = state.registers.piece_slots as usize;
    for piece in 0..slots {
        if state.pieces.body_kind[piece] != 0 {
            state.pairs.swept[piece] = swept_bounds(state, piece, stretch).grown(LOOSE_MARGIN_M);
        }
    }
    let mut count = 0;
    for a in 0..slots {
        if is_loose(state, a) {
            for b in 0..slots {
                if may_touch(state, a, b) {
                    if pairs::push(state, &mut count, a, b).is_err() {
                        report.set(FrameReport::FULL_PAIRS);
                        return None;
                    }
                }
            }
        }
    }
    Some(count)
}

/// Whether a piece belongs to a dynamic body that is awake.
fn is_loose(state: &State, piece: usize) -> bool {
    state.pieces.body_kind[piece] == BodyKind::Dynamic.code()
        && state.bodies.momentum[state.pieces.body[piece] as usize].asleep == 0
}

fn may_touch(state: &State, a: usize, b: usize) -> bool {
    let pieces = &state.pieces;
    let apart = pieces.body_kind[b] == 0 || pieces.body[a] == pieces.body[b];
    let twice = a > b && is_loose(state, b);
    !apart && !twice && state.pairs.swept[a].overlaps(&state.pairs.swept[b])
}

/// Advances all pairs; the share of the stretch that everybody stays clear for. The pair that
/// blocked the way is noted.
pub(super) fn run(state: &mut State, pairs: usize, stretch: &Stretch, purse: &mut Purse) -> f32 {
    loop {
        let Some(next) = least_certified(state, pairs) else {
            return 1.0;
        };
        let time = state.pairs.list[next].clear_until;
        if time >= 1.0 {
            return 1.0;
        }
        state.pairs.blocking[0] = next as u32;
        if !purse.take() || certify(state, next, stretch, time) {
            return time;
        }
    }
}

fn least_certified(state: &State, pairs: usize) -> Option<usize> {
    let list = &state.pairs.list[..pairs];
    let mut least = 0;
    for (index, pair) in list.iter().enumerate() {
        if pair.clear_until < list[least].clear_until {
            least = index;
        }
    }
    (!list.is_empty()).then_some(least)
}

/// Certifies a pair beyond `time`; true when it cannot be, so that it blocks the way.
fn certify(state: &mut State, index: usize, stretch: &Stretch, time: f32) -> bool {
    let pair = state.pairs.list[index];
    let moving = moving_pair(state, &pair, stretch);
    let found = moving.clear_until(time, GAP_FLOOR_M, pair.normal);
    let way = moving.motion_a.way_m() + moving.motion_b.way_m();
    let pair = &mut state.pairs.list[index];
    pair.normal = found.normal;
    pair.clear_until = math::max(time, found.clear_until);
    pair.clear_until < 1.0 && (pair.clear_until - time) * way < STEP_MIN_M
}

/// The pair as geometry sees it through a stretch.
pub(super) fn moving_pair<'a>(state: &'a State, pair: &Pair, stretch: &Stretch) -> MovingPair<'a> {
    let (a, b) = (pair.a as usize, pair.b as usize);
    MovingPair {
        a: state.pools.convex(&state.pieces.shape[a]),
        b: state.pools.convex(&state.pieces.shape[b]),
        motion_a: motion(state, a, stretch),
        motion_b: motion(state, b, stretch),
    }
}

/// The velocity that a piece's motion gives the point `at` of the world, impulses aside, in m/s: the
/// mean over the stretch for driven pieces, zero for all others.
pub(super) fn prescribed(state: &State, piece: usize, at: Vec3, stretch: &Stretch) -> Vec3 {
    let body = state.pieces.body[piece] as usize;
    let driven = state.pieces.body_kind[piece] == BodyKind::Driven.code();
    if !driven || is_stopped(state, body, stretch.from) {
        return Vec3::ZERO;
    }
    let motion = motion(state, piece, stretch);
    let (from, to) = (motion.at(0.0), motion.at(1.0));
    let material = from.quat().conjugate() * (at - from.translation());
    (to.point(material) - at) / stretch.seconds()
}
