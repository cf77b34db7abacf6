//! How bodies move through a stretch of the frame.

use glam::{Quat, Vec3};

use super::Stretch;
use super::turning::{Turn, turned};
use crate::geometry::motion::{Motion, Track};
use crate::limits::{SPEED_MAX, SPIN_MAX, WORLD_REACH_M};
use crate::math::{self, Pose};
use crate::state::State;
use crate::state::bodies::{BodyKind, is_loose_kind, share_within};
use crate::state::loose::spin;
use crate::state::rows::Mover;
use crate::state::ways::{BodyTrack, driven_at, piece_motion, piece_pose};

/// Slows a body that is faster than any scene needs, and stops one that left the world: beyond its
/// reach there is nothing that f32 could tell apart. It falls asleep there, and what it reaches back with is in
/// the way as before.
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
        state.legs.stop_time[body] = 0.0;
    }
}

fn at_most(v: Vec3, length: f32) -> Vec3 {
    if v.length_squared() <= length * length {
        return v;
    }
    let wide = v.as_dvec3();
    (wide * share_within(wide, length)).as_vec3()
}

/// The frame at a loose body's centre of mass, with the body's orientation.
pub(super) fn centre_pose(state: &State, body: usize) -> Pose {
    let pose = &state.bodies.pose[body];
    Pose::new(pose.quat(), pose.point(state.bodies.mass[body].centre))
}

/// Whether a body stands still from `time` on: it sleeps or was stopped.
pub(super) fn is_stopped(state: &State, body: usize, time: f32) -> bool {
    state.legs.stop_time[body] <= time || state.bodies.momentum[body].asleep == 1
}

/// Whether a loose body answers impulses in the stretch that starts at `time`.
pub(super) fn is_free(state: &State, body: usize, time: f32) -> bool {
    is_loose_kind(state.bodies.kind[body]) && !is_stopped(state, body, time)
}

/// A loose body's motion as the solver sees it; one that stands still cannot be moved.
pub(super) fn mover(state: &State, body: usize, time: f32) -> Mover {
    if !is_free(state, body, time) {
        return Mover::default();
    }
    let mass = &state.bodies.mass[body];
    let inverse_inertia = mass.inverse_inertia(state.bodies.pose[body].quat());
    Mover {
        velocity: state.bodies.momentum[body].velocity,
        spin: inverse_inertia * state.bodies.momentum[body].angular,
        inverse_mass: mass.inverse_mass,
        inverse_inertia,
    }
}

/// The angular momentum that goes with a change of a mover's spin.
pub(super) fn angular_after(state: &State, body: usize, before: Vec3, change: Vec3) -> Vec3 {
    if change == Vec3::ZERO {
        return before;
    }
    before + state.bodies.mass[body].inertia(state.bodies.pose[body].quat()) * change
}

/// The angular momentum after the impacts of an event.
fn angular_begun(state: &State, body: usize) -> Vec3 {
    let before = state.bodies.momentum[body].angular;
    let change = state.rows.begun[body].spin - spin(state, body);
    angular_after(state, body, before, change)
}

/// Slows a body that forces and impulses made faster than any scene needs, and stops one whose masses, speeds
/// and arms made numbers that f32 does not hold.
fn keep_slow(state: &mut State, body: usize) {
    let is_slow = |mover: &Mover| {
        mover.velocity.length_squared() <= SPEED_MAX * SPEED_MAX
            && mover.spin.length_squared() <= SPIN_MAX * SPIN_MAX
    };
    if is_slow(&state.rows.begun[body]) && is_slow(&state.rows.movers[body]) {
        return;
    }
    let is_finite = |mover: &Mover| mover.velocity.is_finite() && mover.spin.is_finite();
    let finite = is_finite(&state.rows.begun[body]) && is_finite(&state.rows.movers[body]);
    for mover in [&mut state.rows.begun[body], &mut state.rows.movers[body]] {
        if finite {
            mover.velocity = at_most(mover.velocity, SPEED_MAX);
            mover.spin = at_most(mover.spin, SPIN_MAX);
        } else {
            mover.velocity = Vec3::ZERO;
            mover.spin = Vec3::ZERO;
        }
    }
    if !finite {
        state.bodies.momentum[body].velocity = Vec3::ZERO;
        state.bodies.momentum[body].angular = Vec3::ZERO;
    }
}

/// The velocity that a body sets out with on its way through a stretch. At even speed it is the one at the
/// end, though what changed it acts over the whole stretch.
fn setting_out(state: &State, body: usize) -> Vec3 {
    if state.rows.even[body] == 1 {
        state.rows.movers[body].velocity
    } else {
        state.rows.begun[body].velocity
    }
}

/// Writes down where a loose body is at the end of a stretch, given its motion at both ends: velocity and
/// angular momentum change evenly in between.
pub(super) fn aim(state: &mut State, body: usize, stretch: &Stretch) {
    keep_slow(state, body);
    let from = centre_pose(state, body);
    let (begun, ended) = (state.rows.begun[body], state.rows.movers[body]);
    let before = angular_begun(state, body);
    let after = angular_after(state, body, before, ended.spin - begun.spin);
    let seconds = stretch.seconds();
    let mean = if state.rows.even[body] == 1 {
        after
    } else {
        0.5 * (before + after)
    };
    let way = (setting_out(state, body) + ended.velocity) * (0.5 * seconds);
    let turn = turned(&state.bodies.mass[body], from.quat(), mean, seconds);
    state.islands.angular[body] = after;
    state.islands.goal[body] = Pose::new(turn, from.translation() + way);
}

/// The motion of any piece through a stretch; loose ones of the island were aimed.
pub(super) fn motion<'a>(state: &'a State, piece: usize, stretch: &Stretch) -> Motion<'a> {
    let body = state.pieces.body[piece] as usize;
    let kind = state.pieces.body_kind[piece];
    if is_loose_kind(kind) && state.islands.label[body] == stretch.island {
        loose_motion(state, piece, body, stretch)
    } else if kind == BodyKind::Driven.code() {
        piece_motion(state, piece, &driven_track(state, body, stretch))
    } else if is_loose_kind(kind) {
        Motion::still(state.bodies.pose[body].then(&state.pieces.local[piece]))
    } else {
        Motion::still(state.pieces.world[piece])
    }
}

fn loose_motion<'a>(state: &'a State, piece: usize, body: usize, stretch: &Stretch) -> Motion<'a> {
    let from = centre_pose(state, body);
    let stopped = is_stopped(state, body, stretch.from);
    let to = if stopped {
        from
    } else {
        state.islands.goal[body]
    };
    let local = &state.pieces.local[piece];
    let in_centre = local.moved(-state.bodies.mass[body].centre);
    let motion = Motion::new(
        Track::between(from, to),
        Track::still(in_centre),
        state.pieces.shape[piece].core_reach(),
    );
    if stopped {
        return motion;
    }
    let gained = state.rows.movers[body].velocity - setting_out(state, body);
    motion.bowed(gained * (0.5 * stretch.seconds()))
}

/// Where a piece is at the start of a stretch.
pub(super) fn piece_at(state: &State, piece: usize, stretch: &Stretch) -> Pose {
    let body = state.pieces.body[piece] as usize;
    let kind = state.pieces.body_kind[piece];
    if is_loose_kind(kind) {
        state.bodies.pose[body].then(&state.pieces.local[piece])
    } else if kind == BodyKind::Driven.code() {
        let stop = math::min(state.legs.stop_time[body], stretch.from);
        let start = state.bodies.pose[body];
        piece_pose(state, piece, &driven_at(state.legs.of(body), &start, stop))
    } else {
        state.pieces.world[piece]
    }
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

/// Moves the island's loose bodies through the share `reached` of a stretch.
pub(super) fn advance(state: &mut State, stretch: &Stretch, reached: f32) {
    let mut next = Some(stretch.island as usize);
    while let Some(body) = next {
        next = state.islands.next[body].checked_sub(1).map(|n| n as usize);
        if is_free(state, body, stretch.from) {
            advance_one(state, body, stretch, reached);
        }
    }
}

fn advance_one(state: &mut State, body: usize, stretch: &Stretch, reached: f32) {
    let from = centre_pose(state, body);
    let goal = state.islands.goal[body];
    let (begun, ended) = (&state.rows.begun[body], &state.rows.movers[body]);
    let bow = (ended.velocity - setting_out(state, body)) * (0.5 * stretch.seconds());
    let gained = ended.velocity - begun.velocity;
    let straight = (setting_out(state, body) + ended.velocity) * (0.5 * stretch.seconds());
    let way = straight * reached + bow * (reached * reached - reached);
    let turn = Track::between(from, goal).at(reached).quat();
    // Far from the origin rounding is larger than many an event's way, and would add up.
    let at = Pose::new(
        turn,
        from.translation() + (way + state.islands.rounded[body]),
    );
    let (velocity, angular) = if reached >= 1.0 {
        (ended.velocity, state.islands.angular[body])
    } else {
        let before = angular_begun(state, body);
        let gained_angular = (state.islands.angular[body] - before) * reached;
        let mean = if state.rows.even[body] == 1 {
            state.islands.angular[body]
        } else {
            before + 0.5 * gained_angular
        };
        let free = Turn {
            mass: &state.bodies.mass[body],
            from: from.quat(),
            angular: mean,
            seconds: stretch.seconds() * reached,
        };
        (
            begun.velocity + gained * reached,
            free.angular_at(at.quat(), before + gained_angular),
        )
    };
    state.bodies.momentum[body].velocity = velocity;
    state.bodies.momentum[body].angular = angular;
    if reached > 0.0 {
        if at != from {
            state.bodies.pose[body] = origin_of(state, body, &at);
        }
        let gone = centre_pose(state, body).translation() - from.translation();
        state.islands.rounded[body] += way - gone;
    }
}

/// The body's pose for a pose of the frame at its centre of mass.
fn origin_of(state: &State, body: usize, centre: &Pose) -> Pose {
    let rotation: Quat = centre.quat();
    let here = state.bodies.mass[body].centre;
    Pose::new(rotation, centre.translation() - rotation * here)
}

/// Has the bodies of the pair that blocked the way wait for the next frame: the driven one, or else the loose
/// ones, with what speed they have. A body of another island is let be. Whether the loose ones wait for each
/// other, or for what does not move.
pub(super) fn wait_blocked(state: &mut State, blocked: usize, time: f32) -> bool {
    let pair = state.islands.pairs[blocked];
    let bodies = [pair.a, pair.b].map(|piece| state.pieces.body[piece as usize] as usize);
    if pair.foreign == 1 {
        state.legs.stop_time[bodies[0]] = math::min(state.legs.stop_time[bodies[0]], time);
        return false;
    }
    let driven = |body: &usize| state.bodies.kind[*body] == BodyKind::Driven.code();
    let stops = |state: &mut State, body: usize| {
        let stop = &mut state.legs.stop_time[body];
        let runs = *stop > time;
        *stop = math::min(*stop, time);
        runs
    };
    let stopped = bodies
        .into_iter()
        .find(driven)
        .is_some_and(|body| stops(state, body));
    if !stopped {
        for body in bodies {
            if is_loose_kind(state.bodies.kind[body]) {
                stops(state, body);
            }
        }
    }
    !stopped
}

/// Stops every body of an island: its frame ends early.
pub(super) fn stop_all(state: &mut State, island: usize, time: f32) {
    let mut next = Some(island);
    while let Some(body) = next {
        next = state.islands.next[body].checked_sub(1).map(|n| n as usize);
        state.legs.stop_time[body] = math::min(state.legs.stop_time[body], time);
    }
}
