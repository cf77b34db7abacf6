//! 1 couple: where driven things want to be.
//!
//! A spring between tracker and body, m x'' = -K x - R x' (Schmidl and Lin 2004, section 4), where x
//! is the *displacement* of the body from its tracker and x' is relative to the tracker: the paper's
//! damping of the absolute velocity lags by R/K for every m/s. Contact alone displaces, so free
//! motion has no lag at all (promise P3). The spring is integrated exactly, so it is stable for every
//! time step.

use glam::Vec3;

use crate::limits::{DISPLACEMENT_MIN, DISPLACEMENT_RATE_MIN};
use crate::math::{self, Pose, displacement_of};
use crate::memory::ids::is_alive;
use crate::state::State;
use crate::state::bodies::{BodyKind, Coupling, Displacement, DrivenReport, Tracker};
use crate::state::chains::{ChainOptions, ball_at, joints_of, linkage, next_chain};
use crate::state::pieces::Bounds;
use crate::state::ways::in_world;

/// The spring's exact map over one time step: (x, v) -> (xx x + xv v, vx x + vv v).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringMap {
    /// How the old displacement enters the new one.
    pub xx: f32,
    /// How the old rate enters the new displacement, in seconds.
    pub xv: f32,
    /// How the old displacement enters the new rate, in 1/s.
    pub vx: f32,
    /// How the old rate enters the new rate.
    pub vv: f32,
}

impl SpringMap {
    /// The map of a valid coupling over `dt_s` seconds (0 or more, finite).
    ///
    /// With a = R/2m, w^2 = K/m - a^2: C = e^-ah cos(wh), S = e^-ah sin(wh)/w, and
    /// x' = (C + aS) x + S v, v' = -(K/m) S x + (C - aS) v. Above critical damping cos and sin become
    /// cosh and sinh, taken together with e^-ah so that nothing overflows.
    #[must_use]
    pub fn new(coupling: &Coupling, dt_s: f32) -> Self {
        let a = 0.5 * coupling.damping_n_s_per_m / coupling.mass_kg;
        let k = coupling.stiffness_n_per_m / coupling.mass_kg;
        let (c, s) = damped_cos_sin(a, k, dt_s);
        Self {
            xx: c + a * s,
            xv: s,
            vx: -k * s,
            vv: c - a * s,
        }
    }

    fn apply(&self, x: Vec3, v: Vec3) -> (Vec3, Vec3) {
        (self.xx * x + self.xv * v, self.vx * x + self.vv * v)
    }
}

/// e^-ah cos(wh) and e^-ah sin(wh)/w for w^2 = k - a^2 of either sign.
fn damped_cos_sin(a: f32, k: f32, h: f32) -> (f32, f32) {
    let w_squared = k - a * a;
    let z = w_squared * h * h;
    if z.abs() < 0.01 {
        // Two terms more than f32 can see.
        let c = 1.0 - z / 2.0 * (1.0 - z / 12.0 * (1.0 - z / 30.0));
        let s = 1.0 - z / 6.0 * (1.0 - z / 20.0 * (1.0 - z / 42.0));
        let decay = math::exp(-a * h);
        return (decay * c, decay * h * s);
    }
    let root = math::sqrt(z.abs());
    if z > 0.0 {
        let decay = math::exp(-a * h);
        return (decay * math::cos(root), decay * h * math::sin(root) / root);
    }
    // root - a h without its cancellation: (root^2 - (a h)^2) / (root + a h), and root^2 - (a h)^2 = -K/m h^2.
    let slow = math::exp(-k * h * h / (root + a * h));
    let fast = math::exp(-root - a * h);
    (0.5 * (slow + fast), 0.5 * h * (slow - fast) / root)
}

/// Finds where every driven body wants to be at the end of the frame.
pub(crate) fn run(state: &mut State, dt_s: f32) {
    for body in 0..state.registers.body_slots as usize {
        let driven = is_alive(state.bodies.generation[body])
            && state.bodies.kind[body] == BodyKind::Driven.code();
        if driven {
            couple(state, body, dt_s);
        }
    }
}

fn couple(state: &mut State, body: usize, dt_s: f32) {
    let bodies = &mut state.bodies;
    state.legs.count[body] = 0;
    state.legs.local_share[body] = 0.0;
    state.legs.stop_time[body] = 1.0;
    state.legs.whole[body] = Bounds::EMPTY;
    let coupling = bodies.coupling[body];
    let tracker = &mut bodies.tracker[body];
    bodies.report[body] = DrivenReport {
        flags: age(tracker, &coupling, dt_s),
        ..DrivenReport::default()
    };
    if tracker.seen == 0 {
        state.legs.wanted[body] = bodies.pose[body];
        couple_chains(state, body, dt_s);
        return;
    }
    let displacement = &mut bodies.displacement[body];
    come_nearer(displacement, tracker);
    tracker.previous = tracker.target;
    let spring = SpringMap::new(&coupling, dt_s);
    bodies.yielding[body].mass_kg = held_mass_kg(&coupling, &spring, dt_s);
    relax(displacement, &spring);
    state.legs.wanted[body] = displaced(&tracker.target, displacement);
    couple_chains(state, body, dt_s);
}

/// The mass m with which m u is the impulse K x h of a spring that is held at the displacement x, where u
/// is the mean velocity by which it would come back if let go: K h^2 / (1 - xx). For short time steps that
/// is twice the coupling's own mass.
fn held_mass_kg(coupling: &Coupling, spring: &SpringMap, dt_s: f32) -> f32 {
    let back = 1.0 - spring.xx;
    if back < 1e-6 {
        return 2.0 * coupling.mass_kg;
    }
    coupling.stiffness_n_per_m * dt_s * dt_s / back
}

/// Finds where the angles of a body's chains are wanted at the end of the frame: at their targets, less
/// what is left of the deviation that contact forced. The attraction is integrated exactly:
/// d' = -d / attraction.
fn couple_chains(state: &mut State, body: usize, dt_s: f32) {
    let mut next = state.bodies.first_chain[body];
    while let Some(chain) = next.checked_sub(1) {
        let chain = chain as usize;
        let options = state.chains.options[chain];
        let left = math::exp(-dt_s / math::max(options.attraction_s, 1e-6));
        couple_angles(state, chain, left);
        if options.has(ChainOptions::HOLDS_TIP) {
            couple_tip(state, body, chain, left);
        } else {
            state.ways.tip[chain] = Vec3::ZERO;
        }
        state.chains.report[chain].steps = 0;
        state.ways.held[chain] = 0;
        next = next_chain(state, chain);
    }
}

fn couple_angles(state: &mut State, chain: usize, left: f32) {
    let range = joints_of(state, chain);
    let (joints, ways) = (&mut state.joints, &mut state.ways);
    let target = &joints.target[range.clone()];
    let previous = &mut joints.previous[range.clone()];
    let deviation = &mut joints.deviation[range.clone()];
    let wanted = &mut ways.wanted[range.clone()];
    ways.from[range.clone()].copy_from_slice(&joints.angle[range.clone()]);
    ways.from_link[range.clone()].copy_from_slice(&joints.link[range.clone()]);
    // What the tracker itself came nearer, as for the root.
    let (mut along, mut square) = (0.0, 0.0);
    for ((deviation, target), previous) in deviation.iter().zip(target).zip(&*previous) {
        along += deviation * (target - previous);
        square += deviation * deviation;
    }
    previous.copy_from_slice(target);
    // The targets to the bit when there is no deviation.
    wanted.copy_from_slice(target);
    if square == 0.0 {
        deviation.fill(0.0);
        return;
    }
    let kept = left * (1.0 - math::clamp(along / square, 0.0, 1.0));
    let mut negligible = true;
    for deviation in &mut *deviation {
        *deviation *= kept;
        negligible &= deviation.abs() < DISPLACEMENT_MIN;
    }
    if negligible {
        deviation.fill(0.0);
        return;
    }
    for ((wanted, deviation), hinge) in wanted.iter_mut().zip(&*deviation).zip(&joints.hinge[range])
    {
        if *deviation != 0.0 {
            *wanted = hinge.kept(*wanted + deviation);
        }
    }
    keep_in_cones(state, chain);
}

/// Takes wanted angles that lie between allowed ones to allowed ones.
fn keep_in_cones(state: &mut State, chain: usize) {
    let joints = joints_of(state, chain);
    for joint in joints.clone() {
        if let Some(ball) = ball_at(state, joint, joints.start) {
            ball.kept(&mut state.ways.wanted[joints.clone()]);
        }
    }
}

/// Finds where a chain's tip is wanted: at its tracked place, less what is left of its offset.
fn couple_tip(state: &mut State, body: usize, chain: usize, left: f32) {
    let tip = Vec3::from_array(state.chains.options[chain].tip);
    let tracked = if state.chains.is_tip_seen[chain] == 1 {
        state.chains.tip_seen[chain]
    } else {
        let link = target_link(state, chain);
        state.legs.wanted[body].point(link.point(tip))
    };
    let step = tracked - state.chains.tip_tracked[chain];
    let offset = shortened(state.chains.tip_offset[chain], step) * left;
    state.chains.tip_tracked[chain] = tracked;
    state.ways.tip[chain] = tracked + offset;
}

/// Where a chain's last link is in the root's frame at the target angles. Up to the first joint that is not at its
/// target that is where it was published.
fn target_link(state: &State, chain: usize) -> Pose {
    let (joints, range) = (&state.joints, joints_of(state, chain));
    if state.chains.base[chain] != 0 {
        return linkage(state).link(range.end - 1, |joint| joints.target[joint]);
    }
    let is_there = |&joint: &usize| joints.angle[joint] == joints.target[joint];
    let shown = range.clone().take_while(is_there).last();
    let first = shown.map_or(range.start, |joint| joint + 1);
    let base = shown.map_or(Pose::IDENTITY, |joint| joints.link[joint]);
    (first..range.end).fold(base, |base, joint| {
        joints.hinge[joint].placed(&base, joints.target[joint])
    })
}

/// Counts how long the tracker has been lost; the flag of one lost for too long.
fn age(tracker: &mut Tracker, coupling: &Coupling, dt_s: f32) -> u32 {
    if tracker.fresh == 1 {
        tracker.fresh = 0;
        tracker.lost_s = 0.0;
        return 0;
    }
    tracker.lost_s = math::min(tracker.lost_s + dt_s, 1e6);
    if tracker.lost_s > coupling.grace_s {
        DrivenReport::LOST
    } else {
        0
    }
}

/// Takes off the displacement what the tracker itself came nearer since the last frame. Without it a
/// tracker that returns toward a body in contact would push the body ahead of it, off the surface.
fn come_nearer(displacement: &mut Displacement, tracker: &Tracker) {
    if displacement.is_zero() || tracker.target == tracker.previous {
        return;
    }
    let (moved, turned) = displacement_of(&tracker.previous, &tracker.target);
    displacement.offset = shortened(displacement.offset, moved);
    displacement.rotation = shortened(displacement.rotation, turned);
}

/// `x` shortened by the part of `step` along it, to no less than zero.
fn shortened(x: Vec3, step: Vec3) -> Vec3 {
    let square = x.length_squared();
    if square == 0.0 {
        return x;
    }
    x * (1.0 - math::clamp(x.dot(step) / square, 0.0, 1.0))
}

/// Lets the spring pull for one time step; what has become negligible becomes exactly zero.
fn relax(displacement: &mut Displacement, spring: &SpringMap) {
    if displacement.is_zero() {
        return;
    }
    let (offset, velocity) = spring.apply(displacement.offset, displacement.velocity);
    let (rotation, spin) = spring.apply(displacement.rotation, displacement.spin);
    let negligible = is_below(offset, DISPLACEMENT_MIN)
        && is_below(rotation, DISPLACEMENT_MIN)
        && is_below(velocity, DISPLACEMENT_RATE_MIN)
        && is_below(spin, DISPLACEMENT_RATE_MIN);
    *displacement = if negligible {
        Displacement::default()
    } else {
        Displacement {
            offset,
            velocity,
            rotation,
            spin,
        }
    };
}

fn is_below(v: Vec3, bound: f32) -> bool {
    v.x.abs() < bound && v.y.abs() < bound && v.z.abs() < bound
}

/// The target moved by the displacement, but not out of the world; the target itself, to the bit, when there
/// is none.
fn displaced(target: &Pose, displacement: &Displacement) -> Pose {
    if displacement.is_zero() {
        return *target;
    }
    let turned = if displacement.rotation == Vec3::ZERO {
        target.quat()
    } else {
        math::renormalised(math::quat_from_rotation_vector(displacement.rotation) * target.quat())
    };
    Pose::new(turned, in_world(target.translation() + displacement.offset))
}
