//! 6 impulses: what the loose objects do.
//!
//! Dynamic bodies move to the end of the frame while driven bodies follow the way that stage 5 found
//! clear, as movers that impulses do not change. Events come in the order of time: impulses are
//! solved for the contacts at hand, conservative advancement finds how far everybody stays clear with
//! those velocities, everybody moves there, and so on. Where an object cannot get out of the way of
//! a driven body, the driven body stops at that time.

mod movers;
mod patch;
mod queue;
mod solve;
mod sweep;

use glam::Vec3;

use crate::frame::FrameReport;
use crate::limits::{EVENTS_MAX, IMPULSE_UNITS_MAX, SLEEP_S, STALLS_MAX, STILL_SPEED};
use crate::math;
use crate::state::State;
use crate::state::bodies::{BodyKind, is_body_of};
use crate::state::purse::Purse;

/// A stretch of the frame: shares of the frame, and its length in seconds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stretch {
    pub from: f32,
    pub to: f32,
    pub dt_s: f32,
}

impl Stretch {
    pub(crate) fn seconds(&self) -> f32 {
        (self.to - self.from) * self.dt_s
    }
}

/// Moves the loose bodies through the frame. Spends at most `units`.
pub(crate) fn run(state: &mut State, dt_s: f32, units: u32, report: &mut FrameReport) {
    let mut purse = Purse::new(units.min(IMPULSE_UNITS_MAX));
    if !begin(state, dt_s) {
        return;
    }
    sweep::begin(state);
    let mut pairs = None;
    let mut time = 0.0;
    let mut stalls = 0;
    for _ in 0..EVENTS_MAX {
        let stretch = Stretch {
            from: time,
            to: next_break(state, time),
            dt_s,
        };
        let Some(reached) = event(state, &stretch, &mut pairs, &mut purse, report) else {
            break;
        };
        let progress = reached - time;
        time = reached;
        if time >= 1.0 {
            break;
        }
        stalls = if progress <= 1e-4 { stalls + 1 } else { 0 };
        if stalls > STALLS_MAX {
            movers::stop_blocked(state, time);
            stalls = 0;
        }
    }
    if time < 1.0 {
        movers::stop_all(state, time);
        report.set(FrameReport::IMPULSES_CUT);
        report.lost_s = (1.0 - time) * dt_s;
    }
    finish(state, dt_s);
    report.impulse_units = purse.spent();
}

/// One event: solve, advance, move. The share of the frame that was reached; `None` when the units
/// ran out before anybody could move.
fn event(
    state: &mut State,
    stretch: &Stretch,
    pairs: &mut Option<usize>,
    purse: &mut Purse,
    report: &mut FrameReport,
) -> Option<f32> {
    if !sweep::update(state, stretch, pairs) {
        report.set(FrameReport::FULL_PAIRS);
    }
    let count = (*pairs)?;
    let constraints = solve::gather(state, count, stretch, purse, report)?;
    report.impulses += patch::run(state, constraints);
    report.impulses += queue::run(state, constraints, purse);
    solve::record(state, constraints, report);
    if !sweep::update(state, stretch, pairs) {
        report.set(FrameReport::FULL_PAIRS);
    }
    let count = (*pairs)?;
    let reached = sweep::run(state, count, stretch, purse);
    movers::advance_all(state, stretch, reached);
    Some(if reached >= 1.0 {
        stretch.to
    } else {
        stretch.from + (stretch.to - stretch.from) * reached
    })
}

/// The first end of a driven body's leg after `time`, or the end of the frame.
fn next_break(state: &State, time: f32) -> f32 {
    let mut next = 1.0;
    for body in 0..state.registers.body_slots as usize {
        if is_body_of(state, body, BodyKind::Driven) {
            for leg in state.legs.of(body) {
                if leg.end_time > time {
                    next = math::min(next, leg.end_time);
                }
            }
        }
    }
    next
}

/// Wakes what is about to be touched and kicks what is awake; false when nothing is awake.
fn begin(state: &mut State, dt_s: f32) -> bool {
    let kick = state.registers.gravity * dt_s;
    let mut dynamic = false;
    for body in 0..state.registers.body_slots as usize {
        dynamic |= is_body_of(state, body, BodyKind::Dynamic);
    }
    if !dynamic {
        return false;
    }
    let mut any_awake = false;
    for body in 0..state.registers.body_slots as usize {
        if !is_body_of(state, body, BodyKind::Dynamic) {
            continue;
        }
        state.legs.stop_time[body] = 1.0;
        if state.bodies.momentum[body].asleep == 1 && movers::is_disturbed(state, body, dt_s) {
            wake(state, body);
        }
        if state.bodies.momentum[body].asleep == 0 {
            state.bodies.momentum[body].velocity += kick;
            movers::keep_sane(state, body);
            any_awake = true;
        }
    }
    any_awake
}

pub(crate) fn wake(state: &mut State, body: usize) {
    let momentum = &mut state.bodies.momentum[body];
    momentum.asleep = 0;
    momentum.still_s = 0.0;
}

/// Counts how long bodies have been still and puts them to sleep.
fn finish(state: &mut State, dt_s: f32) {
    for body in 0..state.registers.body_slots as usize {
        if is_body_of(state, body, BodyKind::Dynamic) && state.bodies.momentum[body].asleep == 0 {
            let still = surface_speed(state, body) < STILL_SPEED;
            let momentum = &mut state.bodies.momentum[body];
            momentum.still_s = if still { momentum.still_s + dt_s } else { 0.0 };
            if momentum.still_s >= SLEEP_S {
                momentum.asleep = 1;
                momentum.velocity = Vec3::ZERO;
                momentum.angular = Vec3::ZERO;
            }
        }
    }
}

/// Upper bound of the speed of any point of a dynamic body, in m/s.
fn surface_speed(state: &State, body: usize) -> f32 {
    let speed = math::length(state.bodies.momentum[body].velocity);
    let spin = math::length(movers::spin(state, body));
    speed + spin * movers::reach_m(state, body)
}
