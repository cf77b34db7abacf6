//! The contacts of an event, and one impulse at one of them.

use core::ops::Range;

use glam::{Mat3, Vec3};

use super::Stretch;
use super::movers::{centre_pose, is_stopped, spin};
use super::sweep::{measure, prescribed};
use crate::frame::FrameReport;
use crate::geometry::manifold::Contact;
use crate::limits::{
    APPROACH_MIN, BOUNCE_MIN, GAP_FLOOR_M, GAP_RESTORED, LOOSE_BAND_M, LOOSE_REST_M,
    RESTORING_SPEED_MAX,
};
use crate::math;
use crate::state::State;
use crate::state::bodies::BodyKind;
use crate::state::contacts::{Constraint, ContactPoint, Pair};
use crate::state::purse::Purse;

/// Finds the contacts of all pairs at the start of a stretch; how many constraints there are, `None`
/// when the units ran out.
pub(super) fn gather(
    state: &mut State,
    pairs: usize,
    stretch: &Stretch,
    purse: &mut Purse,
    report: &mut FrameReport,
) -> Option<usize> {
    let mut count = 0;
    for index in 0..pairs {
        if !purse.take() {
            return None;
        }
        let Some(measured) = measure(state, index, stretch) else {
            continue;
        };
        let pair = state.pairs.list[index];
        for contact in measured.contacts {
            let contact = Contact {
                point: measured.pose_b.point(contact.point),
                normal: measured.pose_b.quat() * contact.normal,
                ..contact
            };
            let constraint = constraint(state, index as u32, &pair, &contact, stretch);
            match state.pairs.constraints.get_mut(count) {
                Some(slot) => *slot = constraint,
                None => {
                    report.set(FrameReport::FULL_CONTACTS);
                    return Some(count);
                }
            }
            count += 1;
            let mark = &mut state.registers.high_water.contacts;
            *mark = (*mark).max(count as u32);
        }
    }
    Some(count)
}

fn constraint(
    state: &State,
    index: u32,
    pair: &Pair,
    contact: &Contact,
    stretch: &Stretch,
) -> Constraint {
    let (a, b) = (pair.a as usize, pair.b as usize);
    let stride = state.material_stride();
    let surface = state
        .materials
        .pair(stride, state.pieces.material[a], state.pieces.material[b]);
    let mut made = Constraint {
        pair: index,
        body_a: state.pieces.body[a],
        body_b: state.pieces.body[b],
        impulses: 0,
        point: contact.point,
        normal: contact.normal,
        gap: contact.gap,
        prescribed_a: prescribed(state, a, contact.point, stretch),
        prescribed_b: prescribed(state, b, contact.point, stretch),
        target: 0.0,
        restitution: surface.restitution,
        friction: surface.friction,
        impulse: Vec3::ZERO,
    };
    made.target = target(state, &made, stretch);
    made
}

/// The least normal velocity that a contact must have.
///
/// Slow approach: the gap may close to the rest gap by the end of the stretch, no further, and gaps
/// within a band above it count as closed: otherwise a body rocks from corner to corner for ever. Fast
/// approach: nothing until the surfaces meet, then Newton's restitution.
fn target(state: &State, constraint: &Constraint, stretch: &Stretch) -> f32 {
    let normal_velocity = relative_velocity(state, constraint).dot(constraint.normal);
    let seconds = stretch.seconds();
    let fall = 2.0 * math::length(state.registers.gravity) * stretch.dt_s;
    let bounces = -normal_velocity > math::max(fall, BOUNCE_MIN);
    let spare = constraint.gap - LOOSE_REST_M;
    if spare < LOOSE_BAND_M {
        let bounced = if bounces {
            -normal_velocity * constraint.restitution
        } else {
            0.0
        };
        math::max(bounced, restoring(constraint.gap, seconds))
    } else if bounces {
        f32::NEG_INFINITY
    } else {
        -spare / seconds
    }
}

/// The speed that gives a contact back some of its rest gap. It feeds energy in, so it waits until
/// the gap is nearly gone.
fn restoring(gap: f32, seconds: f32) -> f32 {
    if gap > 2.0 * GAP_FLOOR_M {
        return 0.0;
    }
    math::min(
        (LOOSE_REST_M - gap) * GAP_RESTORED / seconds,
        RESTORING_SPEED_MAX,
    )
}

/// Velocity of A's surface relative to B's at a contact, in m/s.
pub(super) fn relative_velocity(state: &State, constraint: &Constraint) -> Vec3 {
    let a = surface_velocity(state, constraint.body_a as usize, constraint.point);
    let b = surface_velocity(state, constraint.body_b as usize, constraint.point);
    a + constraint.prescribed_a - b - constraint.prescribed_b
}

fn surface_velocity(state: &State, body: usize, point: Vec3) -> Vec3 {
    if state.bodies.kind[body] != BodyKind::Dynamic.code() {
        return Vec3::ZERO;
    }
    let arm = point - centre_pose(state, body).translation();
    state.bodies.momentum[body].velocity + spin(state, body).cross(arm)
}

/// What one body adds to the matrix K that turns an impulse into a change of relative velocity
/// (Mirtich 1996, equation 8): 1/m - [r] I^-1 [r], with [r] the cross-product matrix.
fn mobility(state: &State, body: usize, point: Vec3) -> Mat3 {
    let movable = state.bodies.kind[body] == BodyKind::Dynamic.code()
        && !is_stopped(state, body, 1.0 - f32::EPSILON);
    if !movable {
        return Mat3::ZERO;
    }
    let mass = &state.bodies.mass[body];
    let arm = point - centre_pose(state, body).translation();
    let cross = Mat3::from_cols(
        Vec3::new(0.0, arm.z, -arm.y),
        Vec3::new(-arm.z, 0.0, arm.x),
        Vec3::new(arm.y, -arm.x, 0.0),
    );
    let inertia = mass.inverse_inertia(state.bodies.pose[body].quat());
    Mat3::from_diagonal(Vec3::splat(mass.inverse_mass)) - cross * inertia * cross
}

/// Brings a contact to its target; whether that took an impulse.
///
/// What is solved for is the contact's whole impulse of this event, so that a contact that was pushed
/// too hard gives some back. First the impulse that also stops all sliding, j + K^-1 (target n - v);
/// where Coulomb's cone does not hold it, the impulse on the cone against the slip that reaches the
/// target (the paper's equation 10 alone reverses slip and can create energy).
pub(super) fn push(state: &mut State, index: usize) -> bool {
    let constraint = state.pairs.constraints[index];
    let (a, b) = (constraint.body_a as usize, constraint.body_b as usize);
    state.pairs.constraints[index].impulses += 1;
    let k = mobility(state, a, constraint.point) + mobility(state, b, constraint.point);
    let Some(whole) = whole_impulse(&constraint, relative_velocity(state, &constraint), &k) else {
        return false;
    };
    let change = whole - constraint.impulse;
    apply(state, a, constraint.point, change);
    apply(state, b, constraint.point, -change);
    state.pairs.constraints[index].impulse = whole;
    true
}

/// Pushes all approaching contacts of one pair, from `first` to `end`, by one impulse at their middle;
/// whether there were two or more. What lands flat so keeps its orientation, where corner after corner
/// would turn it.
pub(super) fn push_together(state: &mut State, first: usize, end: usize) -> bool {
    let mut middle = state.pairs.constraints[first];
    middle.point = Vec3::ZERO;
    middle.prescribed_a = Vec3::ZERO;
    middle.prescribed_b = Vec3::ZERO;
    middle.target = 0.0;
    let mut count = 0.0;
    for index in first..end {
        let contact = &state.pairs.constraints[index];
        if approaches(state, contact) {
            middle.point += contact.point;
            middle.prescribed_a += contact.prescribed_a;
            middle.prescribed_b += contact.prescribed_b;
            middle.target += contact.target;
            count += 1.0;
        }
    }
    if count < 2.0 {
        return false;
    }
    middle.point /= count;
    middle.prescribed_a /= count;
    middle.prescribed_b /= count;
    middle.target /= count;
    push_middle(state, &middle, first..end, count)
}

/// Applies the impulse of the middle and shares it out among the approaching contacts.
fn push_middle(state: &mut State, middle: &Constraint, contacts: Range<usize>, count: f32) -> bool {
    let (a, b) = (middle.body_a as usize, middle.body_b as usize);
    let k = mobility(state, a, middle.point) + mobility(state, b, middle.point);
    let Some(whole) = whole_impulse(middle, relative_velocity(state, middle), &k) else {
        return false;
    };
    for index in contacts {
        if approaches(state, &state.pairs.constraints[index]) {
            state.pairs.constraints[index].impulse += whole / count;
        }
    }
    apply(state, a, middle.point, whole);
    apply(state, b, middle.point, -whole);
    true
}

/// Whether a contact's normal velocity is below its target.
fn approaches(state: &State, contact: &Constraint) -> bool {
    let velocity = relative_velocity(state, contact).dot(contact.normal);
    contact.target - velocity > APPROACH_MIN
}

fn whole_impulse(constraint: &Constraint, velocity: Vec3, k: &Mat3) -> Option<Vec3> {
    let n = constraint.normal;
    let along = n.dot(*k * n);
    if along <= 0.0 {
        return None;
    }
    // What the contact's normal velocity lacks when none of its impulse were there.
    let missing = constraint.target - velocity.dot(n) + n.dot(*k * constraint.impulse);
    if missing <= 0.0 {
        return Some(Vec3::ZERO);
    }
    let frictionless = n * (missing / along);
    let Some(inverse) = inverse(k) else {
        return Some(frictionless);
    };
    let sticking = constraint.impulse + inverse * (n * constraint.target - velocity);
    let normal_part = sticking.dot(n);
    let slip_part = sticking - n * normal_part;
    let slip = math::length(slip_part);
    if normal_part > 0.0 && slip <= constraint.friction * normal_part {
        return Some(sticking);
    }
    // Against the slip that there would be without this contact's own impulse: the sticking impulse
    // points elsewhere when K couples the directions.
    let free = velocity - *k * constraint.impulse;
    let Some(against) = math::direction(n * free.dot(n) - free) else {
        return Some(frictionless);
    };
    let on_cone = n + against * constraint.friction;
    let gain = n.dot(*k * on_cone);
    // Painleve: friction that jams the contact instead of opening it is left out.
    if gain <= 0.1 * along {
        return Some(frictionless);
    }
    Some(on_cone * (missing / gain))
}

fn inverse(k: &Mat3) -> Option<Mat3> {
    let determinant = k.determinant();
    (determinant > 1e-20).then(|| k.inverse())
}

fn apply(state: &mut State, body: usize, point: Vec3, impulse: Vec3) {
    if state.bodies.kind[body] != BodyKind::Dynamic.code()
        || is_stopped(state, body, 1.0 - f32::EPSILON)
    {
        return;
    }
    let arm = point - centre_pose(state, body).translation();
    let mass = state.bodies.mass[body].inverse_mass;
    let momentum = &mut state.bodies.momentum[body];
    momentum.velocity += impulse * mass;
    momentum.angular += arm.cross(impulse);
}

/// Writes the contacts that carried an impulse where the host can read them.
pub(super) fn record(state: &mut State, constraints: usize, report: &mut FrameReport) {
    for index in 0..constraints {
        let made = state.pairs.constraints[index];
        let normal_impulse = made.impulse.dot(made.normal);
        if normal_impulse <= 0.0 {
            continue;
        }
        let pair = state.pairs.list[made.pair as usize];
        let point = ContactPoint {
            piece_a: state.pieces.id(pair.a),
            piece_b: state.pieces.id(pair.b),
            point: made.point.to_array(),
            normal: made.normal.to_array(),
            gap_m: made.gap,
            impulse_n_s: normal_impulse,
        };
        if !crate::state::contacts::add(state, point) {
            report.set(FrameReport::FULL_CONTACTS);
        }
    }
}
