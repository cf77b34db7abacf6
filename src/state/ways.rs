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
use crate::state::chains::{linkage, slot_range};
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

/// Whether a piece stays where it is on a way. Cost: a comparison for each hinge from its link to the root.
pub(crate) fn rests(state: &State, piece: usize, track: &BodyTrack) -> bool {
    let pieces = &state.pieces;
    let local_rests =
        track.local_from == track.local_to || pieces.local[piece] == pieces.local_target[piece];
    track.root.from == track.root.to
        && local_rests
        && link_rests(state, pieces.link[piece], track.leg)
}

fn link_rests(state: &State, link: u32, leg: usize) -> bool {
    let slot = slot_range(state, leg).start;
    let mut next = link;
    while let Some(joint) = next.checked_sub(1) {
        let at = slot + joint as usize;
        if state.ways.from[at] != state.ways.to[at] {
            return false;
        }
        next = state.joints.parent[joint as usize];
    }
    true
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
/// known to be clear: the body stays where it was. A snap's leg begins at the tracker.
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
