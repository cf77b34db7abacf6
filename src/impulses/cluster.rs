//! Rigid clusters: the finish when impulses were not enough.
//!
//! Two bodies that still approach are taken for one rigid body from here on: the motion that keeps their
//! momentum and angular momentum, or that of the body among them that nothing moves. Every merger makes
//! one cluster less, so it ends, and no contact of a cluster approaches. Merging takes energy only, as a
//! plastic impact does.

use glam::{Mat3, Vec3};

use super::solver::Problem;
use crate::math;
use crate::state::rows::{Mover, Row};

/// Marks the label of a cluster with a body that nothing moves.
const HELD: u32 = 1 << 31;

/// Merges what approaches faster than `allowed` says, in m/s; how many mergers that took.
///
/// `centres` are the bodies' centres of mass, `cluster` is scratch of the same length. Cost: a pass over
/// rows and movers for each merger.
pub(super) fn run(
    problem: &mut Problem,
    centres: &[Vec3],
    cluster: &mut [u32],
    allowed: impl Fn(&Row) -> f32,
) -> u32 {
    let mut merged = 0;
    if fastest(problem, None, &allowed).is_none() {
        return merged;
    }
    for (body, label) in cluster.iter_mut().enumerate() {
        let held = u32::from(!problem.movers[body].is_movable());
        *label = (body as u32) | (held * HELD);
    }
    while let Some(index) = fastest(problem, Some(cluster), &allowed) {
        let row = problem.rows[index];
        join(problem, centres, cluster, &row);
        merged += 1;
        if merged as usize > problem.rows.len() {
            break;
        }
    }
    merged
}

/// The row that most exceeds what is allowed and that a merger can help.
fn fastest(
    problem: &Problem,
    cluster: Option<&[u32]>,
    allowed: &impl Fn(&Row) -> f32,
) -> Option<usize> {
    let mut found = None;
    let mut most = problem.tolerance;
    for (index, row) in problem.rows.iter().enumerate() {
        let approach = -problem.relative_velocity(row).dot(row.normal);
        let excess = approach - allowed(row);
        let apart = cluster.is_none_or(|labels| may_join(labels, row));
        if excess > most && apart {
            most = excess;
            found = Some(index);
        }
    }
    found
}

/// Two clusters that nothing moves have nothing to give.
fn may_join(cluster: &[u32], row: &Row) -> bool {
    let [a, b] = [row.body_a, row.body_b].map(|body| cluster[body as usize]);
    a != b && (a & b & HELD) == 0
}

fn join(problem: &mut Problem, centres: &[Vec3], cluster: &mut [u32], row: &Row) {
    let labels = [row.body_a, row.body_b].map(|body| cluster[body as usize]);
    let fixed = labels.map(|label| {
        (0..cluster.len())
            .find(|&body| cluster[body] == label && !problem.movers[body].is_movable())
    });
    let motion = match fixed {
        [None, None] => common_motion(problem, centres, cluster, labels),
        // The surface of A relative to that of B is prescribed.
        [Some(body), _] => Rigid::drift(problem, cluster, labels[0], body, row.prescribed),
        [None, Some(body)] => Rigid::drift(problem, cluster, labels[1], body, -row.prescribed),
    };
    for body in 0..cluster.len() {
        if labels.contains(&cluster[body]) {
            cluster[body] = labels[0] | (labels[1] & HELD);
            motion.give(&mut problem.movers[body], centres[body]);
        }
    }
}

/// A rigid motion: velocity of a point, and angular velocity.
struct Rigid {
    centre: Vec3,
    velocity: Vec3,
    spin: Vec3,
}

impl Rigid {
    /// The motion of a cluster that holds the unmovable `body`: that of its movable bodies if it has any,
    /// else what is prescribed to its surface.
    fn drift(
        problem: &Problem,
        cluster: &[u32],
        label: u32,
        body: usize,
        prescribed: Vec3,
    ) -> Self {
        let held = (0..cluster.len())
            .find(|&other| cluster[other] == label && problem.movers[other].is_movable());
        let velocity = held.map_or(prescribed, |other| problem.movers[other].velocity);
        debug_assert!(!problem.movers[body].is_movable());
        Self {
            centre: Vec3::ZERO,
            velocity,
            spin: Vec3::ZERO,
        }
    }

    fn give(&self, mover: &mut Mover, centre: Vec3) {
        if mover.is_movable() {
            mover.velocity = self.velocity + self.spin.cross(centre - self.centre);
            if mover.inverse_inertia != Mat3::ZERO {
                mover.spin = self.spin;
            }
        }
    }
}

fn common_motion(problem: &Problem, centres: &[Vec3], cluster: &[u32], labels: [u32; 2]) -> Rigid {
    let members = || (0..cluster.len()).filter(|&body| labels.contains(&cluster[body]));
    let (mut mass, mut moment, mut momentum) = (0.0, Vec3::ZERO, Vec3::ZERO);
    for body in members() {
        let own = 1.0 / problem.movers[body].inverse_mass;
        mass += own;
        moment += centres[body] * own;
        momentum += problem.movers[body].velocity * own;
    }
    let centre = moment / mass;
    let (mut inertia, mut angular) = (Mat3::ZERO, Vec3::ZERO);
    for body in members() {
        let mover = &problem.movers[body];
        let own = 1.0 / mover.inverse_mass;
        let arm = centres[body] - centre;
        angular += arm.cross(mover.velocity * own);
        inertia += (Mat3::IDENTITY * arm.length_squared() - outer(arm)) * own;
        if mover.inverse_inertia.determinant() > 0.0 {
            let turning = mover.inverse_inertia.inverse();
            angular += turning * mover.spin;
            inertia += turning;
        }
    }
    let spin = if inertia.determinant() > 0.0 {
        inertia.inverse() * angular
    } else {
        Vec3::ZERO
    };
    let spin = if math::length(spin).is_finite() {
        spin
    } else {
        Vec3::ZERO
    };
    Rigid {
        centre,
        velocity: momentum / mass,
        spin,
    }
}

fn outer(v: Vec3) -> Mat3 {
    Mat3::from_cols(v * v.x, v * v.y, v * v.z)
}
