//! Pairs of an island, and how far along a stretch everybody stays clear.

use arrayvec::ArrayVec;
use glam::Vec3;

use super::Stretch;
use super::movers::{is_stopped, motion, piece_at};
use crate::geometry::manifold::{Contact, manifold};
use crate::geometry::motion::{Course, Track};
use crate::geometry::separation::core_gap_beyond;
use crate::geometry::time_of_contact::MovingPair;
use crate::limits::{
    FAR_ACCURACY, GAP_FLOOR_M, LOOSE_ACCURACY, LOOSE_DEEP_M, LOOSE_MARGIN_M, LOOSE_STEP_MIN_M,
    LOOSE_STILL_M, MANIFOLD_CONTACTS_MAX, PAIR_MARGIN_M,
};
use crate::math::{self, Pose};
use crate::state::State;
use crate::state::bodies::{BodyKind, is_loose_kind};
use crate::state::contacts::{self, Pair, PairsFull, box_parts, query_units};
use crate::state::loose;
use crate::state::pieces::Bounds;
use crate::state::purse::Purse;
use crate::state::ways::{self, BodyTrack, Leg, Position, piece_pose};

/// Parts of a unit for judging a pair by its planes: two support queries, where a distance query takes some four
/// times as many.
const PLANES_PARTS: u32 = 2;

/// Boxes around the ways of all pieces that are not the island's own loose ones, through the whole frame:
/// they do not change with impulses.
///
/// Takes part of a unit for every few pieces; false when there is none.
pub(super) fn begin(state: &mut State, island: u32, purse: &mut Purse) -> bool {
    if !purse.take_parts(box_parts(state.registers.piece_slots as usize)) {
        return false;
    }
    for piece in 0..state.registers.piece_slots as usize {
        let kind = state.pieces.body_kind[piece];
        let body = state.pieces.body[piece] as usize;
        let own = is_loose_kind(kind) && state.islands.label[body] == island;
        if !own {
            let bounds = if kind == BodyKind::Driven.code() {
                if !purse.take_parts(state.legs.count[body]) {
                    return false;
                }
                driven_bounds(state, piece)
            } else if is_loose_kind(kind) {
                loose::piece_bounds(state, piece)
            } else if kind == 0 {
                Bounds::EMPTY
            } else {
                state.pieces.bounds[piece]
            };
            state.islands.swept[piece] = bounds.grown(LOOSE_MARGIN_M);
        }
    }
    true
}

/// A box around a driven piece's whole way through the frame. A leg begins where the one before it ended, and the
/// first one where the piece is, unless the body snaps.
fn driven_bounds(state: &State, piece: usize) -> Bounds {
    let body = state.pieces.body[piece] as usize;
    let shape = &state.pieces.shape[piece];
    let legs = state.legs.of(body);
    let mut begun = state.pieces.bounds[piece];
    let mut bounds = begun;
    for (index, leg) in legs.iter().enumerate() {
        let motion = ways::piece_motion(state, piece, &leg_track(leg, index));
        if index == 0 && leg.from != state.bodies.pose[body] {
            begun = Bounds::of(shape, &motion.at(0.0));
        }
        let ended = Bounds::of(shape, &motion.at(1.0));
        bounds = bounds.union(begun.union(ended).grown(motion.bulge_m()));
        begun = ended;
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

/// Brings the pairs up to what may touch in a stretch; they are none when units run out, or when there is
/// no room, which is an error: raise [`crate::memory::Capacities::pairs`].
///
/// The boxes are grown, so that the pairs mostly stay as they are from event to event, with what is
/// known of them.
pub(super) fn update(
    state: &mut State,
    stretch: &Stretch,
    count: &mut Option<usize>,
    purse: &mut Purse,
) -> Result<(), PairsFull> {
    let mut covered = count.is_some();
    let mut next = Some(stretch.island as usize);
    while let Some(body) = next {
        next = state.islands.next[body].checked_sub(1).map(|n| n as usize);
        if !is_loose_kind(state.bodies.kind[body]) {
            continue;
        }
        let mut piece = state.bodies.first_piece[body];
        while let Some(index) = piece.checked_sub(1) {
            if !purse.take_parts(1) {
                *count = None;
                return Ok(());
            }
            let index = index as usize;
            let way = ways::swept_bounds(state, index, &motion(state, index, stretch));
            let bounds = way.grown(LOOSE_MARGIN_M);
            if !covered || !state.islands.swept[index].contains(&bounds) {
                state.islands.swept[index] = bounds.grown(PAIR_MARGIN_M);
                covered = false;
            }
            piece = state.pieces.next[index];
        }
    }
    if !covered {
        *count = None;
        *count = collect(state, stretch.island, purse)?;
    }
    Ok(())
}

/// Writes the pairs whose boxes overlap and that have a loose piece of the island; `None` when the units
/// ran out.
fn collect(state: &mut State, island: u32, purse: &mut Purse) -> Result<Option<usize>, PairsFull> {
    let mut count = 0;
    let tests = box_parts(state.registers.piece_slots as usize);
    let mut next = Some(island as usize);
    while let Some(body) = next {
        next = state.islands.next[body].checked_sub(1).map(|n| n as usize);
        if is_loose_kind(state.bodies.kind[body]) {
            let mut piece = state.bodies.first_piece[body];
            while let Some(index) = piece.checked_sub(1) {
                if !purse.take_parts(tests) {
                    return Ok(None);
                }
                collect_piece(state, island, body, index as usize, &mut count)?;
                piece = state.pieces.next[index as usize];
            }
        }
    }
    Ok(Some(count))
}

fn collect_piece(
    state: &mut State,
    island: u32,
    body: usize,
    a: usize,
    count: &mut usize,
) -> Result<(), PairsFull> {
    for b in 0..state.registers.piece_slots as usize {
        let Some(foreign) = may_touch(state, island, body, a, b) else {
            continue;
        };
        let mark = &mut state.registers.high_water.pairs;
        contacts::push(state.islands.pairs, count, mark, a, b)?;
        state.islands.pairs[*count - 1].foreign = u32::from(foreign);
    }
    Ok(())
}

/// Whether two pieces may touch, and whether the second belongs to another island.
fn may_touch(state: &State, island: u32, body: usize, a: usize, b: usize) -> Option<bool> {
    let kind = state.pieces.body_kind[b];
    if kind == 0 || !state.islands.swept[a].overlaps(&state.islands.swept[b]) {
        return None;
    }
    let other = state.pieces.body[b] as usize;
    let own = state.islands.label[other] == island;
    let loose = is_loose_kind(kind);
    // Each pair of loose bodies once.
    let twice = loose && own && other <= body;
    (other != body && !twice && moves(state, body, other, own))
        .then_some(!own && kind != BodyKind::Fixed.code())
}

/// Whether either of two bodies moves in this frame: those that are rationed do not.
fn moves(state: &State, body: usize, other: usize, own: bool) -> bool {
    let kind = state.bodies.kind[other];
    let is_mover = kind == BodyKind::Driven.code() || (is_loose_kind(kind) && own);
    !is_stopped(state, body, 0.0) || (is_mover && !is_stopped(state, other, 0.0))
}

/// A pair that is close at the start of a stretch.
pub(super) struct Measured {
    /// In the frame of B.
    pub contacts: ArrayVec<Contact, MANIFOLD_CONTACTS_MAX>,
    pub pose_a: Pose,
    pub pose_b: Pose,
}

/// Where a piece is at the start of a stretch. Pairs come in the order of their first pieces, so the last
/// one is mostly asked for again.
#[derive(Clone, Copy)]
pub(super) struct Place {
    piece: usize,
    pose: Pose,
    bounds: Bounds,
}

impl Place {
    fn of(state: &State, piece: usize, stretch: &Stretch) -> Self {
        let pose = piece_at(state, piece, stretch);
        Self {
            piece,
            pose,
            bounds: Bounds::of(&state.pieces.shape[piece], &pose),
        }
    }
}

/// Measures the gap of a pair at the start of a stretch, by its boxes when they tell enough. `last` is where the
/// first piece of the pair before is.
///
/// Answers what the contacts are made from, or nothing when the pieces are farther apart than loose
/// contacts are, or when the units ran out: the pair stays unmeasured then.
pub(super) fn measure(
    state: &mut State,
    index: usize,
    stretch: &Stretch,
    last: &mut Option<Place>,
    purse: &mut Purse,
) -> Option<Measured> {
    if !purse.take_parts(1) {
        return None;
    }
    let pair = state.islands.pairs[index];
    let (a, b) = (pair.a as usize, pair.b as usize);
    let place_a = match last {
        Some(place) if place.piece == a => *place,
        _ => *last.insert(Place::of(state, a, stretch)),
    };
    let place_b = Place::of(state, b, stretch);
    let (shape_a, shape_b) = (&state.pieces.shape[a], &state.pieces.shape[b]);
    let radii = shape_a.radius + shape_b.radius;
    let (apart, normal) = place_a.bounds.apart(&place_b.bounds, radii);
    if apart > LOOSE_MARGIN_M {
        let pair = &mut state.islands.pairs[index];
        pair.gap = apart;
        pair.normal = normal;
        pair.measured = 1;
        return None;
    }
    if !purse.take(query_units(shape_a, shape_b)) {
        return None;
    }
    let mut feature = pair.feature;
    let (a, b) = (state.pools.convex(shape_a), state.pools.convex(shape_b));
    let (pose_a, pose_b) = (place_a.pose, place_b.pose);
    let a_in_b = pose_a.seen_from(&pose_b);
    let core = core_gap_beyond(&a, &b, &a_in_b, &mut feature, LOOSE_MARGIN_M, FAR_ACCURACY);
    let gap = core.gap - radii;
    let contacts = if gap <= LOOSE_MARGIN_M && pair.foreign == 0 {
        manifold(&a, &b, &a_in_b, &core, LOOSE_MARGIN_M)
    } else {
        ArrayVec::new()
    };
    let pair = &mut state.islands.pairs[index];
    pair.feature = feature;
    pair.gap = gap;
    pair.measured = 1;
    pair.bounced = 0;
    pair.normal = pose_b.quat() * core.normal;
    Some(Measured {
        contacts,
        pose_a,
        pose_b,
    })
}

/// How far a sweep came, as a share of the stretch, and the pair that ended it.
pub(super) struct Swept {
    pub reached: f32,
    /// Nothing when there is no pair at all.
    pub blocked: Option<usize>,
}

/// Advances all pairs; how long everybody stays clear.
pub(super) fn run(state: &mut State, pairs: usize, stretch: &Stretch, purse: &mut Purse) -> Swept {
    if !purse.take_parts(contacts::scan_parts(pairs)) {
        return Swept {
            reached: 0.0,
            blocked: None,
        };
    }
    start(state, pairs, stretch, purse);
    loop {
        let Some(next) = contacts::least_certified(&state.islands.pairs[..pairs]) else {
            return Swept {
                reached: 1.0,
                blocked: None,
            };
        };
        let time = state.islands.pairs[next].clear_until;
        let over = time >= 1.0
            || !pays_for(state, next, pairs, purse)
            || certify(state, next, stretch, time);
        if over {
            return Swept {
                reached: math::min(time, 1.0),
                blocked: Some(next),
            };
        }
    }
}

/// Takes the units for certifying a pair.
fn pays_for(state: &State, index: usize, pairs: usize, purse: &mut Purse) -> bool {
    let pair = &state.islands.pairs[index];
    let [a, b] = [pair.a, pair.b].map(|piece| &state.pieces.shape[piece as usize]);
    purse.take_parts(contacts::choice_parts(pairs)) && purse.take(query_units(a, b))
}

/// How long the gaps at the start last at the most. Pairs that are new are measured first.
fn start(state: &mut State, pairs: usize, stretch: &Stretch, purse: &mut Purse) {
    for pair in &state.islands.pairs[..pairs] {
        state.islands.has_course[pair.a as usize] = 0;
        state.islands.has_course[pair.b as usize] = 0;
    }
    let mut last = None;
    for index in 0..pairs {
        if state.islands.pairs[index].measured == 0 {
            measure(state, index, stretch, &mut last, purse);
        }
        let pair = state.islands.pairs[index];
        state.islands.pairs[index].clear_until = if is_unsure(state, &pair, stretch) {
            0.0
        } else {
            lasts(state, &pair, stretch, purse)
        };
    }
}

/// How long the gap of a pair lasts by what is known of it at the start of a stretch: as fast as it closes at the
/// most, and where that is not enough and units are left, between the planes that it was measured between.
fn lasts(state: &mut State, pair: &Pair, stretch: &Stretch, purse: &mut Purse) -> f32 {
    let a = course(state, pair.a as usize, stretch);
    let b = course(state, pair.b as usize, stretch);
    let floor = floor_m(state, pair, stretch);
    let slack = pair.gap - floor;
    let closing = a.approach(&b, pair.normal, 0.0);
    if slack > closing || a.way_m() + b.way_m() < LOOSE_STILL_M {
        return 1.0;
    }
    if pair.measured == 0 || !purse.take_parts(PLANES_PARTS) {
        return math::clamp(slack / math::max(closing, 1e-30), 0.0, 1.0);
    }
    moving_pair(state, pair, stretch).clear_from(0.0, floor, pair.normal, pair.gap)
}

/// Whether a loose body moves towards a driven one of another island, which may yet stop anywhere on its way.
/// It is outside the box around that way so far, and stays there when it stops.
pub(super) fn is_unsure(state: &State, pair: &Pair, stretch: &Stretch) -> bool {
    pair.foreign == 1
        && state.pieces.body_kind[pair.b as usize] == BodyKind::Driven.code()
        && !is_stopped(
            state,
            state.pieces.body[pair.a as usize] as usize,
            stretch.from,
        )
}

/// Carries what is known of the gaps over to a stretch that begins at the share `reached` of this one: what
/// the motion leaves of them at least. Pairs that may be close are to be measured again.
pub(super) fn carry_over(state: &mut State, pairs: usize, reached: f32) {
    for pair in &mut state.islands.pairs[..pairs] {
        let [a, b] = [pair.a, pair.b].map(|piece| &state.islands.course[piece as usize]);
        pair.gap -= a.approach(b, pair.normal, 0.0) * reached;
        if pair.gap <= LOOSE_MARGIN_M {
            pair.measured = 0;
        }
    }
}

/// How fast a piece moves in a stretch. Worked out once a sweep.
fn course(state: &mut State, piece: usize, stretch: &Stretch) -> Course {
    if state.islands.has_course[piece] == 0 {
        state.islands.course[piece] = motion(state, piece, stretch).course;
        state.islands.has_course[piece] = 1;
    }
    state.islands.course[piece]
}

/// The gap that a pair's way does not undercut. One that is closer already, because the host put it there,
/// may come a hair closer, mostly once a frame: else it could not slide. What bounces may not, or every bounce would go deeper, and neither
/// may what overlaps by more than [`LOOSE_DEEP_M`], unless the host's engine has a hand in it.
fn floor_m(state: &State, pair: &Pair, stretch: &Stretch) -> f32 {
    let kind_of = |piece: u32| state.pieces.body_kind[piece as usize];
    let hosted = [pair.a, pair.b]
        .map(kind_of)
        .contains(&BodyKind::Hosted.code());
    let may = hosted || pair.gap > -LOOSE_DEEP_M;
    if pair.measured == 1 && pair.bounced == 0 && may {
        let hair = if stretch.from == 0.0 {
            LOOSE_STEP_MIN_M
        } else {
            LOOSE_STILL_M
        };
        math::min(GAP_FLOOR_M, pair.gap - hair)
    } else {
        GAP_FLOOR_M
    }
}

/// Certifies a pair beyond `time`; true when it cannot be, so that it blocks the way.
fn certify(state: &mut State, index: usize, stretch: &Stretch, time: f32) -> bool {
    let pair = state.islands.pairs[index];
    if is_unsure(state, &pair, stretch) {
        return true;
    }
    let moving = moving_pair(state, &pair, stretch);
    let mut feature = pair.feature;
    let found = moving.clear_until(
        time,
        floor_m(state, &pair, stretch),
        &mut feature,
        LOOSE_ACCURACY,
    );
    let way = moving.motion_a.way_m() + moving.motion_b.way_m();
    let pair = &mut state.islands.pairs[index];
    pair.feature = feature;
    pair.clear_until = math::max(time, found.clear_until);
    pair.clear_until < 1.0 && (pair.clear_until - time) * way < LOOSE_STEP_MIN_M
}

/// The pair as geometry sees it through a stretch.
fn moving_pair<'a>(state: &'a State, pair: &Pair, stretch: &Stretch) -> MovingPair<'a> {
    let (a, b) = (pair.a as usize, pair.b as usize);
    MovingPair {
        a: state.pools.convex(&state.pieces.shape[a]),
        b: state.pools.convex(&state.pieces.shape[b]),
        motion_a: motion(state, a, stretch),
        motion_b: motion(state, b, stretch),
    }
}

/// The velocity that a piece's motion gives the point `at` of the world, impulses aside, in m/s: the
/// mean over the stretch for driven pieces, zero for all others. A body that holds its turn and its pieces
/// moves with its root alone.
pub(super) fn prescribed(
    state: &State,
    piece: usize,
    at: Vec3,
    holds: bool,
    stretch: &Stretch,
) -> Vec3 {
    let body = state.pieces.body[piece] as usize;
    let driven = state.pieces.body_kind[piece] == BodyKind::Driven.code();
    if !driven || is_stopped(state, body, stretch.from) {
        return Vec3::ZERO;
    }
    if holds {
        return root_velocity(state, body, stretch);
    }
    let motion = motion(state, piece, stretch);
    let (from, to) = (motion.at(0.0), motion.at(1.0));
    let material = from.quat().conjugate() * (at - from.translation());
    (to.point(material) - at) / stretch.seconds()
}

/// The mean velocity of a driven body's root through the whole rest of the frame, in m/s.
pub(super) fn root_velocity(state: &State, body: usize, stretch: &Stretch) -> Vec3 {
    let legs = state.legs.of(body);
    let start = state.bodies.pose[body];
    let from = ways::driven_at(legs, &start, stretch.from).root;
    let to = ways::driven_at(legs, &start, 1.0).root;
    let seconds = (1.0 - stretch.from) * stretch.dt_s;
    (to.translation() - from.translation()) / seconds
}

/// How far a driven piece's point `at` is from where its trackers want it within the body, in metres: its
/// turn, its own pose and its link.
pub(super) fn withheld(state: &State, piece: usize, at: Vec3) -> Vec3 {
    let body = state.pieces.body[piece] as usize;
    let here = state.pieces.world[piece];
    let material = here.quat().conjugate() * (at - here.translation());
    let pose = state.bodies.pose[body];
    let wanted = Position {
        root: Pose::new(state.legs.wanted[body].quat(), pose.translation()),
        local: 1.0,
        leg: 0,
        share: 1.0,
    };
    piece_pose(state, piece, &wanted).point(material) - at
}
