//! Ways: how bodies go through a frame, leg by leg.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::geometry::linkage::LinkPath;
use crate::geometry::motion::{Motion, Track, interpolate};
use crate::limits::{GAP_LOST_M, GAP_LOST_PART, LEGS_MAX, WORLD_REACH_M};
use crate::math::{self, Pose};
use crate::memory::columns::columns;
use crate::state::State;
use crate::state::bodies::{BodyKind, DrivenReport};
use crate::state::chains::{joints_of, linkage, slot_range};
use crate::state::contacts::Pair;
use crate::state::pieces::Bounds;

/// One straight part of a driven body's way through a frame.
///
/// The root goes from `from` toward `to` (positions linearly, orientations by normalised linear
/// interpolation) as far as `reached`; the pieces' local poses go from `local_from` to `local_to`,
/// both measured as a share of the way from the frame's first to its last local poses.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct Leg {
    pub from: Pose,
    pub to: Pose,
    pub local_from: f32,
    pub local_to: f32,
    /// Share of this leg that was found clear.
    pub reached: f32,
    /// Share of the frame at which the leg ends; it starts where the one before ends.
    pub end_time: f32,
}

columns! {
    /// Ways of driven bodies: scratch of one frame.
    pub(crate) struct Legs(capacities) {
        /// [`LEGS_MAX`] for every body slot.
        legs: [Leg; capacities.bodies * LEGS_MAX as u32],
        count: [u32; capacities.bodies],
        /// Where the coupling wants the body.
        wanted: [Pose; capacities.bodies],
        /// Share of the way to the target local poses that the body has gone.
        local_share: [f32; capacities.bodies],
        /// A box around everything the body can touch on its way.
        whole: [Bounds; capacities.bodies],
        /// Share of the frame at which a loose object stopped the body; 1 when none did.
        stop_time: [f32; capacities.bodies],
        /// Where other driven bodies are to keep out of a driven piece: its pose before its body has moved
        /// through the frame, and the one it came to after that.
        ahead: [Pose; capacities.pieces],
        /// Box of that pose in the world.
        ahead_bounds: [Bounds; capacities.pieces],
    }
}

impl Legs<'_> {
    /// The legs of a body, in order.
    pub(crate) fn of(&self, body: usize) -> &[Leg] {
        let first = body * LEGS_MAX;
        &self.legs[first..first + self.count[body] as usize]
    }

    /// Adds a leg; there is room by construction.
    pub(crate) fn push(&mut self, body: usize, leg: Leg) {
        let count = self.count[body] as usize;
        debug_assert!(count < LEGS_MAX);
        self.legs[body * LEGS_MAX + count] = leg;
        self.count[body] += 1;
    }
}

/// How a body's root, its links and its pieces' local poses move.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BodyTrack {
    pub root: Track,
    /// Shares of the way from the published to the target local poses.
    pub local_from: f32,
    pub local_to: f32,
    /// The leg whose angles the links take, at the root's shares.
    pub leg: usize,
}

/// Where a driven body is on its way through the frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Position {
    pub root: Pose,
    /// Share of the way from the published to the target local poses.
    pub local: f32,
    /// The leg whose angles the links have, and at which share of it.
    pub leg: usize,
    pub share: f32,
}

impl Position {
    /// The same place as the body's root sees it.
    pub(crate) const fn in_root(&self) -> Self {
        Self {
            root: Pose::IDENTITY,
            ..*self
        }
    }

    /// The body staying there.
    pub(crate) const fn still(&self) -> BodyTrack {
        BodyTrack {
            root: Track {
                from: self.root,
                to: self.root,
                start: self.share,
                end: self.share,
            },
            local_from: self.local,
            local_to: self.local,
            leg: self.leg,
        }
    }
}

impl BodyTrack {
    /// The same way as the body's root sees it: only links and local poses move.
    pub(crate) const fn in_root(&self) -> Self {
        Self {
            root: Track {
                from: Pose::IDENTITY,
                to: Pose::IDENTITY,
                start: self.root.start,
                end: self.root.end,
            },
            ..*self
        }
    }
}

/// The place in the world that is nearest to one.
pub(crate) fn in_world(place: Vec3) -> Vec3 {
    let edge = Vec3::splat(WORLD_REACH_M);
    math::max_each(math::min_each(place, edge), -edge)
}

/// Where the piece is that a driven piece meets, if it does not move: a fixed one, or one of another
/// driven body.
pub(crate) fn obstacle_pose(state: &State, piece: usize) -> Pose {
    if state.pieces.body_kind[piece] == BodyKind::Driven.code() {
        state.legs.ahead[piece]
    } else {
        state.pieces.world[piece]
    }
}

/// The box of that piece.
pub(crate) fn obstacle_bounds(state: &State, piece: usize) -> Bounds {
    if state.pieces.body_kind[piece] == BodyKind::Driven.code() {
        state.legs.ahead_bounds[piece]
    } else {
        state.pieces.bounds[piece]
    }
}

/// What f32 may lose of the gap of a driven body's pair on a leg, beyond what the slop takes, in metres; the
/// first piece is at `pose` at that time. Nothing for pieces of some metres within 100 m of the origin.
pub(crate) fn lost_m(state: &State, pair: &Pair, leg: &BodyTrack, pose: &Pose, time: f32) -> f32 {
    let own = is_own(state, pair);
    let [a, b] = [pair.a, pair.b].map(|piece| &state.pieces.shape[piece as usize]);
    let (from, to) = (leg.root.from, leg.root.to);
    let root = if own {
        0.0
    } else {
        math::max(largest(from.translation()), largest(to.translation()))
    };
    let at = pose.translation();
    let turns = from.rotation != to.rotation || moves_in_body(state, pair.a as usize);
    // Its turns are rounded four times.
    let lost = |arm: f32| {
        let turned = if turns { 4.0 * (arm + a.reach) } else { 0.0 };
        let numbers = root + largest(at) + turned + b.radius;
        math::max(0.0, GAP_LOST_PART * numbers - GAP_LOST_M)
    };
    let most = lost(2.0 * (largest(at) + root));
    if own || most == 0.0 {
        return most;
    }
    lost(math::length(at - leg.root.at(time).translation()))
}

fn largest(v: Vec3) -> f32 {
    math::max(v.x.abs(), math::max(v.y.abs(), v.z.abs()))
}

/// Whether a piece may move as its body's root sees it.
fn moves_in_body(state: &State, piece: usize) -> bool {
    let pieces = &state.pieces;
    pieces.link[piece] != 0 || pieces.local[piece] != pieces.local_target[piece]
}

/// Whether both pieces of a pair belong to one body.
pub(crate) fn is_own(state: &State, pair: &Pair) -> bool {
    state.pieces.body[pair.a as usize] == state.pieces.body[pair.b as usize]
}

/// The motions of the pieces of a driven body's pair on a leg, both in the root's frame when the body
/// owns both, else in the world.
pub(crate) fn pair_motions<'a>(
    state: &'a State,
    pair: &Pair,
    leg: &BodyTrack,
) -> (Motion<'a>, Motion<'a>) {
    let (a, b) = (pair.a as usize, pair.b as usize);
    if is_own(state, pair) {
        let leg = leg.in_root();
        (piece_motion(state, a, &leg), piece_motion(state, b, &leg))
    } else {
        (
            piece_motion(state, a, leg),
            Motion::still(obstacle_pose(state, b)),
        )
    }
}

/// Where the pieces of a driven body's pair are, both in the root's frame when the body owns both, else in
/// the world.
pub(crate) fn pair_poses(state: &State, pair: &Pair, at: &Position) -> [Pose; 2] {
    let (a, b) = (pair.a as usize, pair.b as usize);
    if is_own(state, pair) {
        [a, b].map(|piece| piece_pose(state, piece, &at.in_root()))
    } else {
        [piece_pose(state, a, at), obstacle_pose(state, b)]
    }
}

/// The whole way between the two ends of a leg.
pub(crate) const fn track(from: &Position, to: &Position) -> BodyTrack {
    BodyTrack {
        root: Track::between(from.root, to.root),
        local_from: from.local,
        local_to: to.local,
        leg: from.leg,
    }
}

/// Where one piece of a body is.
pub(crate) fn piece_pose(state: &State, piece: usize, at: &Position) -> Pose {
    let pieces = &state.pieces;
    let local = interpolate(&pieces.local[piece], &pieces.local_target[piece], at.local);
    match pieces.link[piece].checked_sub(1) {
        None => at.root.then(&local),
        Some(joint) => {
            let link = link_path(state, joint as usize, at.leg).at(at.share);
            at.root.then(&link).then(&local)
        }
    }
}

/// The motion of one piece of a body that moves so.
pub(crate) fn piece_motion<'a>(state: &'a State, piece: usize, track: &BodyTrack) -> Motion<'a> {
    let pieces = &state.pieces;
    let core_reach = state.pieces.shape[piece].core_reach();
    let (from, to) = (pieces.local[piece], pieces.local_target[piece]);
    let local = if from == to {
        Track::still(from)
    } else {
        Track {
            from,
            to,
            start: track.local_from,
            end: track.local_to,
        }
    };
    match pieces.link[piece].checked_sub(1) {
        None => Motion::new(track.root, local, core_reach),
        Some(joint) => {
            let path = link_path(state, joint as usize, track.leg);
            Motion::of_link(track.root, path, local, core_reach)
        }
    }
}

/// What of a body stays where it is on a way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rests {
    /// The root, and whether that is where it was published.
    root: bool,
    root_is_shown: bool,
    /// All local poses, and whether those are the published ones.
    locals: bool,
    locals_are_shown: bool,
}

impl Rests {
    /// Looks at a way. Holds until angles or another way are looked at. Cost: two comparisons a joint.
    pub(crate) fn on(state: &mut State, body: usize, track: &BodyTrack) -> Self {
        let mut next = state.bodies.first_chain[body];
        while let Some(chain) = next.checked_sub(1) {
            let chain = chain as usize;
            let [turns, leaves] = first_not_at_rest(state, chain, track.leg);
            state.ways.turns[chain] = turns;
            state.ways.leaves[chain] = leaves;
            next = state.chains.next[chain];
        }
        let root = track.root.from == track.root.to;
        let locals = track.local_from == track.local_to;
        Self {
            root,
            root_is_shown: root && track.root.from == state.bodies.pose[body],
            locals,
            locals_are_shown: locals && track.local_from == 0.0,
        }
    }

    /// Whether a piece rests in the world.
    pub(crate) fn piece(&self, state: &State, piece: usize) -> bool {
        self.root && self.in_root(state, piece)
    }

    /// Whether the root rests where it was published.
    pub(crate) const fn root_is_shown(&self) -> bool {
        self.root_is_shown
    }

    /// Whether the root rests: what pieces do in the world they do in its frame.
    pub(crate) const fn root(&self) -> bool {
        self.root
    }

    /// Whether a piece's local pose rests.
    pub(crate) fn local(&self, state: &State, piece: usize) -> bool {
        self.locals || local_rests(state, piece)
    }

    /// Whether a piece rests as its body's root sees it.
    pub(crate) fn in_root(&self, state: &State, piece: usize) -> bool {
        self.local(state, piece) && comes_before(state, piece, state.ways.turns)
    }

    /// Whether a piece rests where it was published in the world.
    pub(crate) fn where_shown(&self, state: &State, piece: usize) -> bool {
        self.root_is_shown && self.where_shown_in_root(state, piece)
    }

    /// The same as its body's root sees it.
    pub(crate) fn where_shown_in_root(&self, state: &State, piece: usize) -> bool {
        (self.locals_are_shown || local_rests(state, piece))
            && comes_before(state, piece, state.ways.leaves)
    }
}

/// Whether a piece is on a link before the given joint of its chain.
pub(crate) fn comes_before(state: &State, piece: usize, joints: &[u32]) -> bool {
    let link = state.pieces.link[piece];
    link.checked_sub(1)
        .is_none_or(|joint| is_before(state, joint as usize, joints))
}

/// Whether a joint is before the given one of its chain.
pub(crate) fn is_before(state: &State, joint: usize, joints: &[u32]) -> bool {
    (joint as u32) < joints[state.joints.chain[joint] as usize]
}

fn local_rests(state: &State, piece: usize) -> bool {
    state.pieces.local[piece] == state.pieces.local_target[piece]
}

/// The first joint of a chain whose link does not rest on a leg, and the first whose link does not rest where it
/// was published; those of the chain that it hangs on are known.
fn first_not_at_rest(state: &State, chain: usize, leg: usize) -> [u32; 2] {
    let slot = slot_range(state, leg).start;
    let range = joints_of(state, chain);
    let first = range.start as u32;
    let (from, to) = (
        &state.ways.from[slot..][range.clone()],
        &state.ways.to[slot..][range.clone()],
    );
    let known = [&*state.ways.turns, &*state.ways.leaves];
    let [base_rests, base_stays] = known.map(|known| {
        let base = state.chains.base[chain].checked_sub(1);
        base.is_none_or(|joint| is_before(state, joint as usize, known))
    });
    let turns = first + equal_until(from, to);
    let leaves = turns.min(first + equal_until(from, &state.joints.angle[range]));
    [
        if base_rests { turns } else { first },
        if base_stays { leaves } else { first },
    ]
}

/// The first place at which two columns differ; their length when there is none.
fn equal_until(a: &[f32], b: &[f32]) -> u32 {
    let differing = |bits, (a, b): (&f32, &f32)| bits | (a.to_bits() ^ b.to_bits());
    let is_equal = a.iter().zip(b).fold(0, differing) == 0;
    if is_equal {
        // Most chains rest, and this comparison has no branches.
        return a.len() as u32;
    }
    let differs = a.iter().zip(b).position(|(a, b)| a != b);
    differs.unwrap_or(a.len()) as u32
}

fn link_path<'a>(state: &'a State, joint: usize, leg: usize) -> LinkPath<'a> {
    let slot = slot_range(state, leg);
    let at = slot.start + joint;
    LinkPath {
        linkage: linkage(state),
        joint,
        from: &state.ways.from[slot.clone()],
        to: &state.ways.to[slot],
        from_pose: state.ways.from_link[at],
        to_pose: state.ways.to_link[at],
    }
}

/// A box around a piece's whole way.
pub(crate) fn swept_bounds(state: &State, piece: usize, motion: &Motion) -> Bounds {
    let shape = &state.pieces.shape[piece];
    Bounds::of(shape, &motion.at(0.0))
        .union(Bounds::of(shape, &motion.at(1.0)))
        .grown(motion.bulge_m())
}

/// Where a driven body is at a share of the frame.
pub(crate) fn driven_at(legs: &[Leg], start: &Pose, time: f32) -> Position {
    let mut begun = 0.0;
    let mut last = Position {
        root: *start,
        local: 0.0,
        leg: 0,
        share: 0.0,
    };
    for (index, leg) in legs.iter().enumerate() {
        if time < leg.end_time {
            let part = (time - begun) / (leg.end_time - begun);
            return leg.at(index, leg.reached * part);
        }
        begun = leg.end_time;
        last = leg.at(index, leg.reached);
    }
    last
}

/// Where a driven body comes to in the frame; `None` when it stays where it was.
pub(crate) fn comes_to(state: &State, body: usize) -> Option<Position> {
    let start = state.bodies.pose[body];
    let stop = state.legs.stop_time[body];
    let moves = state.legs.count[body] > 0 && stop > 0.0 && !stops_in_leap(state, body);
    moves.then(|| driven_at(state.legs.of(body), &start, stop))
}

/// Where a driven body is that stays where it was.
pub(crate) fn stays(state: &State, body: usize) -> Position {
    driven_at(&[], &state.bodies.pose[body], 0.0)
}

/// Whether a loose object stopped a body that leaves overlap or snaps to its tracker, of which only the end is
/// known to be clear: the body stays where it was. A snap's leg begins where it ends.
fn stops_in_leap(state: &State, body: usize) -> bool {
    let leaves = state.bodies.report[body].flags & DrivenReport::OVERLAPS != 0;
    let first = state.legs.of(body).first();
    first.is_some_and(|leg| {
        let leaps = leaves || leg.from != state.bodies.pose[body];
        leaps && state.legs.stop_time[body] < leg.end_time
    })
}

impl Leg {
    /// Where the body is at a share of this leg, the `index`-th of its way.
    pub(crate) fn at(&self, index: usize, share: f32) -> Position {
        Position {
            root: interpolate(&self.from, &self.to, share),
            local: if share >= 1.0 {
                self.local_to
            } else {
                self.local_from + (self.local_to - self.local_from) * share
            },
            leg: index,
            share,
        }
    }
}
