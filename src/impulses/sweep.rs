//! How far along a stretch everybody stays clear of the loose bodies.

use arrayvec::ArrayVec;
use glam::Vec3;

use super::Stretch;
use super::movers::{is_stopped, motion};
use crate::geometry::manifold::{Contact, manifold};
use crate::geometry::motion::Track;
use crate::geometry::separation::core_gap_from;
use crate::geometry::time_of_contact::MovingPair;
use crate::limits::{
    GAP_FLOOR_M, LOOSE_ACCURACY, LOOSE_MARGIN_M, LOOSE_STEP_MIN_M, MANIFOLD_CONTACTS_MAX,
    PAIR_MARGIN_M,
};
use crate::math::{self, Pose};
use crate::state::State;
use crate::state::bodies::BodyKind;
use crate::state::contacts::{self, Pair};
use crate::state::pieces::Bounds;
use crate::state::purse::Purse;
use crate::state::ways::{self, BodyTrack, Leg};

/// A box around a piece's whole way through a stretch.
pub(super) fn swept_bounds(state: &State, piece: usize, stretch: &Stretch) -> Bounds {
    if state.pieces.body_kind[piece] == BodyKind::Fixed.code() {
        return state.pieces.bounds[piece];
    }
    ways::swept_bounds(state, piece, &motion(state, piece, stretch))
}

/// Boxes around the ways of all pieces that are not loose, through the whole frame: they do not change
/// with impulses.
pub(super) fn begin(state: &mut State) {
    for piece in 0..state.registers.piece_slots as usize {
        let kind = state.pieces.body_kind[piece];
        let bounds = if kind == BodyKind::Driven.code() {
            driven_bounds(state, piece)
        } else if kind == 0 {
            Bounds::EMPTY
        } else {
            state.pieces.bounds[piece]
        };
        state.pairs.swept[piece] = bounds.grown(LOOSE_MARGIN_M);
    }
}

/// A box around a driven piece's whole way through the frame.
fn driven_bounds(state: &State, piece: usize) -> Bounds {
    let body = state.pieces.body[piece] as usize;
    let mut bounds = state.pieces.bounds[piece];
    for (index, leg) in state.legs.of(body).iter().enumerate() {
        let track = leg_track(leg, index);
        bounds = bounds.union(ways::swept_bounds(
            state,
            piece,
            &ways::piece_motion(state, piece, &track),
        ));
    }
    bounds
}

/// The whole way of a leg, the `index`-th of its body.
fn leg_track(leg: &Leg, index: usize) -> BodyTrack {
    BodyTrack {
        root: Track {
            from: leg.from,
            to: leg.to,
            start: 0.0,
            end: leg.reached,
        },
        local_from: leg.local_from,
        local_to: leg.local_from + (leg.local_to - leg.local_from) * leg.reached,
        leg: index,
    }
}

/// Brings the pairs up to what may touch in a stretch; false when there is no room: raise
/// [`crate::memory::Capacities::pairs`].
///
/// The boxes are grown, so that the pairs mostly stay as they are from event to event, with what is
/// known of them.
pub(super) fn update(state: &mut State, stretch: &Stretch, count: &mut Option<usize>) -> bool {
    let slots = state.registers.piece_slots as usize;
    let mut covered = count.is_some();
    for piece in 0..slots {
        if is_loose(state, piece) {
            let bounds = swept_bounds(state, piece, stretch).grown(LOOSE_MARGIN_M);
            if !state.pairs.swept[piece].contains(&bounds) || !covered {
                state.pairs.swept[piece] = bounds.grown(PAIR_MARGIN_M);
                covered = false;
            }
        }
    }
    if !covered {
        *count = collect(state);
    }
    count.is_some()
}

/// Writes the pairs whose boxes overlap and that have a loose piece; `None` when there is no room.
fn collect(state: &mut State) -> Option<usize> {
    let slots = state.registers.piece_slots as usize;
    let mut count = 0;
    for a in 0..slots {
        if is_loose(state, a) {
            for b in 0..slots {
                if may_touch(state, a, b) {
                    contacts::push(state, &mut count, a, b).ok()?;
                }
            }
        }
    }
    Some(count)
}

/// Measures the gap of a pair at the start of a stretch, by its boxes when they tell enough.
///
/// Answers what the contacts are made from, or nothing when the pieces are farther apart than loose
/// contacts are.
pub(super) fn measure(state: &mut State, index: usize, stretch: &Stretch) -> Option<Measured> {
    let pair = state.pairs.list[index];
    let (a, b) = (pair.a as usize, pair.b as usize);
    let pose_a = motion(state, a, stretch).at(0.0);
    let pose_b = motion(state, b, stretch).at(0.0);
    let (shape_a, shape_b) = (&state.pieces.shape[a], &state.pieces.shape[b]);
    let apart = Bounds::of(shape_a, &pose_a).gap(&Bounds::of(shape_b, &pose_b));
    let mut feature = pair.feature;
    let found = (apart <= LOOSE_MARGIN_M).then(|| {
        let (a, b) = (state.pools.convex(shape_a), state.pools.convex(shape_b));
        let a_in_b = pose_a.seen_from(&pose_b);
        let core = core_gap_from(&a, &b, &a_in_b, &mut feature);
        Measured {
            contacts: manifold(&a, &b, &a_in_b, &core, LOOSE_MARGIN_M),
            gap: core.gap - a.radius - b.radius,
            normal: pose_b.quat() * core.normal,
            pose_b,
        }
    });
    let pair = &mut state.pairs.list[index];
    pair.feature = feature;
    pair.gap = found.as_ref().map_or(apart, |measured| measured.gap);
    pair.normal = found
        .as_ref()
        .map_or(pair.normal, |measured| measured.normal);
    found
}

/// A pair that is close at the start of a stretch.
pub(super) struct Measured {
    /// In the frame of B.
    pub contacts: ArrayVec<Contact, MANIFOLD_CONTACTS_MAX>,
    pub gap: f32,
    /// In the world.
    pub normal: Vec3,
    pub pose_b: Pose,
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
    start(state, pairs, stretch);
    loop {
        let Some(next) = state.pairs.least_certified(pairs) else {
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

/// How long the gaps that were measured at the start last at the most.
fn start(state: &mut State, pairs: usize, stretch: &Stretch) {
    for index in 0..pairs {
        let pair = state.pairs.list[index];
        let way = motion(state, pair.a as usize, stretch).way_m()
            + motion(state, pair.b as usize, stretch).way_m();
        let slack = pair.gap - GAP_FLOOR_M;
        state.pairs.list[index].clear_until = if slack > 0.0 {
            math::min(slack / math::max(way, 1e-30), 1.0)
        } else {
            0.0
        };
    }
}

/// Certifies a pair beyond `time`; true when it cannot be, so that it blocks the way.
fn certify(state: &mut State, index: usize, stretch: &Stretch, time: f32) -> bool {
    let pair = state.pairs.list[index];
    let moving = moving_pair(state, &pair, stretch);
    let mut feature = pair.feature;
    let found = moving.clear_until(time, GAP_FLOOR_M, &mut feature, LOOSE_ACCURACY);
    let way = moving.motion_a.way_m() + moving.motion_b.way_m();
    let pair = &mut state.pairs.list[index];
    pair.feature = feature;
    pair.normal = found.normal;
    pair.clear_until = math::max(time, found.clear_until);
    pair.clear_until < 1.0 && (pair.clear_until - time) * way < LOOSE_STEP_MIN_M
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
