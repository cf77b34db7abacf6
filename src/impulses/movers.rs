//! How bodies move through a stretch of the frame.

use glam::{Quat, Vec3};

use super::Stretch;
use crate::geometry::motion::{Motion, Track};
use crate::limits::{LOOSE_MARGIN_M, SPEED_MAX, SPIN_MAX, WORLD_REACH_M};
use crate::math::{self, Pose};
use crate::state::State;
use crate::state::bodies::{BodyKind, is_body_of};
use crate::state::pieces::{Bounds, PiecesOf};
use crate::state::ways::{BodyTrack, driven_at, piece_motion};

/// Angular velocity of a dynamic body in the world, in rad/s.
pub(super) fn spin(state: &State, body: usize) -> Vec3 {
    let bodies = &state.bodies;
    bodies.mass[body].inverse_inertia(bodies.pose[body].quat()) * bodies.momentum[body].angular
}

/// Slows a body that is faster than any scene needs, and stops one that left the world: beyond its
/// reach there is nothing to touch, and nothing that f32 could tell apart.
pub(super) fn keep_sane(state: &mut State, body: usize) {
    let turn = spin(state, body);
    let pose = state.bodies.pose[body];
    let momentum = &mut state.bodies.momentum[body];
    momentum.velocity = at_most(momentum.velocity, SPEED_MAX);
    let fastest = math::length(turn);
    if fastest > SPIN_MAX {
        momentum.angular *= SPIN_MAX / fastest;
    }
    let p = pose.translation().abs();
    if math::max(p.x, math::max(p.y, p.z)) > WORLD_REACH_M {
        momentum.velocity = Vec3::ZERO;
        momentum.angular = Vec3::ZERO;
        momentum.asleep = 1;
    }
}

fn at_most(v: Vec3, length: f32) -> Vec3 {
    let is = math::length(v);
    if is > length { v * (length / is) } else { v }
}

/// The frame at a dynamic body's centre of mass, with the body's orientation.
pub(super) fn centre_pose(state: &State, body: usize) -> Pose {
    let pose = &state.bodies.pose[body];
    Pose::new(pose.quat(), pose.point(state.bodies.mass[body].centre))
}

/// Where that frame is after `seconds` with constant velocity and spin.
fn moved_centre(state: &State, body: usize, seconds: f32) -> Pose {
    let from = centre_pose(state, body);
    let velocity = state.bodies.momentum[body].velocity;
    let turn = math::quat_from_rotation_vector(spin(state, body) * seconds);
    Pose::new(
        turned(turn, from.quat()),
        from.translation() + velocity * seconds,
    )
}

fn turned(turn: Quat, from: Quat) -> Quat {
    if turn == Quat::IDENTITY {
        from
    } else {
        math::renormalised(turn * from)
    }
}

/// Whether a dynamic body stands still through a stretch: it sleeps or was stopped.
pub(super) fn is_stopped(state: &State, body: usize, time: f32) -> bool {
    state.legs.stop_time[body] <= time || state.bodies.momentum[body].asleep == 1
}

/// The motion of any piece through a stretch.
pub(super) fn motion<'a>(state: &'a State, piece: usize, stretch: &Stretch) -> Motion<'a> {
    let body = state.pieces.body[piece] as usize;
    let kind = state.pieces.body_kind[piece];
    if kind == BodyKind::Dynamic.code() {
        dynamic_motion(state, piece, body, stretch)
    } else if kind == BodyKind::Driven.code() {
        piece_motion(state, piece, &driven_track(state, body, stretch))
    } else {
        Motion::still(state.pieces.world[piece])
    }
}

fn dynamic_motion<'a>(
    state: &'a State,
    piece: usize,
    body: usize,
    stretch: &Stretch,
) -> Motion<'a> {
    let from = centre_pose(state, body);
    let to = if is_stopped(state, body, stretch.from) {
        from
    } else {
        moved_centre(state, body, stretch.seconds())
    };
    let local = &state.pieces.local[piece];
    let in_centre = local.moved(-state.bodies.mass[body].centre);
    Motion::new(
        Track::between(from, to),
        Track::still(in_centre),
        state.pieces.shape[piece].core_reach(),
    )
}

/// The part of a driven body's way that lies in a stretch, which does not cross the end of a leg.
pub(super) fn driven_track(state: &State, body: usize, stretch: &Stretch) -> BodyTrack {
    let stop = state.legs.stop_time[body];
    let start = state.bodies.pose[body];
    let legs = state.legs.of(body);
    if stop <= stretch.from {
        return driven_at(legs, &start, stop).still();
    }
    let mut begun = 0.0;
    for (index, leg) in legs.iter().enumerate() {
        if stretch.from < leg.end_time {
            let share = |time: f32| leg.reached * (time - begun) / (leg.end_time - begun);
            let local = |share: f32| leg.local_from + (leg.local_to - leg.local_from) * share;
            let end = if stretch.to >= leg.end_time {
                leg.reached
            } else {
                share(stretch.to)
            };
            let first = share(stretch.from);
            return BodyTrack {
                root: Track {
                    from: leg.from,
                    to: leg.to,
                    start: first,
                    end,
                },
                local_from: local(first),
                local_to: local(end),
                leg: index,
            };
        }
        begun = leg.end_time;
    }
    driven_at(legs, &start, 1.0).still()
}

/// Moves all dynamic bodies through the share `reached` of a stretch.
pub(super) fn advance_all(state: &mut State, stretch: &Stretch, reached: f32) {
    if reached <= 0.0 {
        return;
    }
    for body in 0..state.registers.body_slots as usize {
        let moves =
            is_body_of(state, body, BodyKind::Dynamic) && !is_stopped(state, body, stretch.from);
        if moves {
            let from = centre_pose(state, body);
            let to = moved_centre(state, body, stretch.seconds());
            let at = Track::between(from, to).at(reached);
            let centre = state.bodies.mass[body].centre;
            let origin = at.translation() - at.quat() * centre;
            state.bodies.pose[body] = Pose::new(at.quat(), origin);
        }
    }
}

/// Stops the bodies of the pair that last blocked the way: the driven one, or else the dynamic ones.
pub(super) fn stop_blocked(state: &mut State, time: f32) {
    let blocked = state.pairs.blocking[0];
    let pair = state.pairs.list[blocked as usize];
    let bodies = [pair.a, pair.b].map(|piece| state.pieces.body[piece as usize] as usize);
    let driven = bodies
        .into_iter()
        .find(|&body| state.bodies.kind[body] == BodyKind::Driven.code());
    match driven {
        Some(body) if state.legs.stop_time[body] > time => state.legs.stop_time[body] = time,
        _ => {
            for body in bodies {
                stop_dynamic(state, body, time);
            }
        }
    }
}

fn stop_dynamic(state: &mut State, body: usize, time: f32) {
    if state.bodies.kind[body] == BodyKind::Dynamic.code() {
        state.legs.stop_time[body] = math::min(state.legs.stop_time[body], time);
        state.bodies.momentum[body].velocity = Vec3::ZERO;
        state.bodies.momentum[body].angular = Vec3::ZERO;
    }
}

/// Stops everything that could meet a loose body: the frame ends early.
pub(super) fn stop_all(state: &mut State, time: f32) {
    for body in 0..state.registers.body_slots as usize {
        let kind = state.bodies.kind[body];
        let moves = kind == BodyKind::Driven.code() || kind == BodyKind::Dynamic.code();
        if moves {
            state.legs.stop_time[body] = math::min(state.legs.stop_time[body], time);
        }
    }
}

/// Whether something that moves comes near a sleeping body this frame.
pub(super) fn is_disturbed(state: &State, body: usize, dt_s: f32) -> bool {
    let whole = Stretch {
        from: 0.0,
        to: 1.0,
        dt_s,
    };
    let mut own = Bounds::EMPTY;
    for piece in PiecesOf::new(state.pieces.next, state.bodies.first_piece[body]) {
        own = own.union(state.pieces.bounds[piece]);
    }
    let own = own.grown(LOOSE_MARGIN_M);
    if driven_near(state, &own) {
        return true;
    }
    for piece in 0..state.registers.piece_slots as usize {
        let other = state.pieces.body[piece] as usize;
        if other != body && disturbs(state, piece, other, &own, &whole) {
            return true;
        }
    }
    false
}

fn disturbs(state: &State, piece: usize, other: usize, near: &Bounds, whole: &Stretch) -> bool {
    let kind = state.pieces.body_kind[piece];
    let awake = kind == BodyKind::Dynamic.code() && state.bodies.momentum[other].asleep == 0;
    awake && super::sweep::swept_bounds(state, piece, whole).overlaps(near)
}

/// Whether a driven body that moves this frame comes near a box.
fn driven_near(state: &State, near: &Bounds) -> bool {
    (0..state.registers.body_slots as usize).any(|body| {
        is_body_of(state, body, BodyKind::Driven)
            && state.legs.count[body] > 0
            && state.legs.whole[body].overlaps(near)
    })
}

/// The farthest that a body's surface is from its centre of mass, in metres.
pub(super) fn reach_m(state: &State, body: usize) -> f32 {
    let centre = state.bodies.mass[body].centre;
    let mut reach = 0.0;
    for piece in PiecesOf::new(state.pieces.next, state.bodies.first_piece[body]) {
        let arm = math::length(state.pieces.local[piece].translation() - centre);
        reach = math::max(reach, arm + state.pieces.shape[piece].reach);
    }
    reach
}
