//! The optimum in f64: the least change of the tracked angles that meets the goals.
//!
//! An augmented Lagrangian (Hestenes 1969, Powell 1969) over the box of the hinges' ranges, each
//! subproblem by a projected Gauss-Newton method with line search (Bertsekas 1982), from several
//! postures. Nothing is taken from the kernel but the chain's description: kinematics, derivatives and
//! the cone's edges are worked out here. Cones must be convex.

use glam::{DQuat, DVec3};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use super::cases::{Case, angles};
use super::chains::Chain;

/// A goal counts as met up to this, in metres.
const MET_M: f64 = 1e-6;

/// A row of the problem: value and slopes; it is to be zero, or zero at least.
struct Row {
    value: f64,
    slopes: Vec<f64>,
    is_exact: bool,
}

/// One chain, one case, in f64.
pub struct Problem<'a> {
    chain: &'a Chain,
    case: &'a Case,
    wanted: Vec<f64>,
    low: Vec<f64>,
    high: Vec<f64>,
    /// Inward normals of the balls' edges.
    edges: Vec<(usize, DVec3)>,
}

impl<'a> Problem<'a> {
    /// The problem of a case.
    pub fn new(chain: &'a Chain, case: &'a Case) -> Self {
        let mut edges = vec![];
        for ball in &chain.balls {
            let corners: Vec<DVec3> = ball.cone.corners().iter().map(|c| c.as_dvec3()).collect();
            for (index, corner) in corners.iter().enumerate() {
                let next = corners[(index + 1) % corners.len()];
                edges.push((ball.first, corner.cross(next).normalize()));
            }
        }
        let of = |get: fn(&palpable::geometry::chain::Hinge) -> f32| {
            chain.hinges.iter().map(|h| f64::from(get(h))).collect()
        };
        Self {
            chain,
            case,
            wanted: case.wanted.iter().map(|&q| q.into()).collect(),
            low: of(|h| h.low_rad),
            high: of(|h| h.high_rad),
            edges,
        }
    }

    /// Origins, axes and the frames behind the hinges.
    fn placed(&self, q: &[f64]) -> Vec<(DVec3, DVec3, DQuat)> {
        let root = &self.chain.root;
        let (mut turn, mut at) = (root.quat().as_dquat(), root.translation().as_dvec3());
        let mut placed = vec![];
        for (hinge, &angle) in self.chain.hinges.iter().zip(q) {
            at += turn * hinge.rest.translation().as_dvec3();
            turn = (turn * hinge.rest.quat().as_dquat()).normalize();
            let axis = hinge.axis.as_dvec3();
            let seen = turn * axis;
            turn = (turn * DQuat::from_axis_angle(axis, angle)).normalize();
            placed.push((at, seen, turn));
        }
        placed
    }

    /// The goals' rows, in metres.
    fn goals(&self, q: &[f64]) -> Vec<Row> {
        let placed = self.placed(q);
        let row = |goal: &palpable::reach::goal::Goal| {
            let normal = goal.normal.as_dvec3();
            let (at, _, turn) = placed[goal.link];
            let point = at + turn * goal.point.as_dvec3();
            let mut slopes = vec![0.0; q.len()];
            for (slope, (at, axis, _)) in slopes.iter_mut().zip(&placed[..=goal.link]) {
                *slope = normal.dot(axis.cross(point - *at));
            }
            Row {
                value: normal.dot(point) - f64::from(goal.height_m),
                slopes,
                is_exact: goal.is_exact,
            }
        };
        self.case.goals.iter().map(row).collect()
    }

    /// The cones' rows, as sines.
    fn cones(&self, q: &[f64]) -> Vec<Row> {
        let row = |&(first, normal): &(usize, DVec3)| {
            let (sin_a, cos_a) = q[first].sin_cos();
            let (sin_b, cos_b) = q[first + 1].sin_cos();
            let limb = DVec3::new(sin_b, -sin_a * cos_b, cos_a * cos_b);
            let mut slopes = vec![0.0; q.len()];
            slopes[first] = normal.dot(DVec3::new(0.0, -cos_a * cos_b, -sin_a * cos_b));
            slopes[first + 1] = normal.dot(DVec3::new(cos_b, sin_a * sin_b, -cos_a * sin_b));
            Row {
                value: normal.dot(limb),
                slopes,
                is_exact: false,
            }
        };
        self.edges.iter().map(row).collect()
    }

    /// Rows with their stiffness and multiplier; soft goals have the stiffness that they ask for.
    fn terms(&self, q: &[f64], hold: &Hold) -> Vec<(Row, f64, f64)> {
        let mut terms = vec![];
        for (index, row) in self.goals(q).into_iter().enumerate() {
            let softness = f64::from(self.case.goals[index].softness);
            let (stiffness, force) = if hold.closest {
                (1.0, 0.0)
            } else if softness > 0.0 {
                (1.0 / softness, 0.0)
            } else {
                (hold.stiffness, hold.forces[index])
            };
            terms.push((row, stiffness, force));
        }
        let count = terms.len();
        for (index, row) in self.cones(q).into_iter().enumerate() {
            terms.push((row, hold.stiffness, hold.forces[count + index]));
        }
        terms
    }

    /// The augmented Lagrangian with its slope and Gauss-Newton matrix.
    fn value(&self, q: &[f64], hold: &Hold) -> f64 {
        let change = q.iter().zip(&self.wanted).map(|(q, w)| (q - w).powi(2));
        let mut value = 0.5 * hold.weight() * change.sum::<f64>();
        for (row, stiffness, force) in self.terms(q, hold) {
            let pressed = pressed(&row, stiffness, force);
            value += 0.5 * pressed * pressed / stiffness;
        }
        value
    }

    fn slope(&self, q: &[f64], hold: &Hold) -> (Vec<f64>, Vec<Vec<f64>>) {
        let n = q.len();
        let weight = hold.weight();
        let mut slope: Vec<f64> = (0..n).map(|j| weight * (q[j] - self.wanted[j])).collect();
        let mut matrix = vec![vec![0.0; n]; n];
        for j in 0..n {
            matrix[j][j] = weight;
        }
        for (row, stiffness, force) in self.terms(q, hold) {
            let pressed = pressed(&row, stiffness, force);
            if pressed == 0.0 {
                continue;
            }
            for i in 0..n {
                slope[i] += pressed * row.slopes[i];
                for j in 0..n {
                    matrix[i][j] += stiffness * row.slopes[i] * row.slopes[j];
                }
            }
        }
        (slope, matrix)
    }

    /// Projected Gauss-Newton steps until none is worth it.
    fn minimise(&self, q: &mut Vec<f64>, hold: &Hold) {
        let mut value = self.value(q, hold);
        for _ in 0..60 {
            let (slope, matrix) = self.slope(q, hold);
            let at_limit = |j: usize| {
                (q[j] <= self.low[j] && slope[j] > 0.0) || (q[j] >= self.high[j] && slope[j] < 0.0)
            };
            let free: Vec<usize> = (0..q.len()).filter(|&j| !at_limit(j)).collect();
            let step = newton(&matrix, &slope, &free);
            let most = step.iter().fold(0.0_f64, |most, s| most.max(s.abs()));
            let mut share = (0.6 / most).min(1.0);
            let mut moved = false;
            for _ in 0..30 {
                let trial: Vec<f64> = (0..q.len())
                    .map(|j| (q[j] - share * step[j]).clamp(self.low[j], self.high[j]))
                    .collect();
                let found = self.value(&trial, hold);
                if found < value {
                    moved = value - found > 1e-14 * value;
                    (*q, value) = (trial, found);
                    break;
                }
                share *= 0.5;
            }
            if !moved || share * most < 1e-10 {
                break;
            }
        }
    }

    /// From one posture: where the goals hold and the change is least nearby, if they can be met.
    fn held(&self, start: &[f64]) -> Option<Vec<f64>> {
        let mut hold = Hold {
            stiffness: 1e2,
            forces: vec![0.0; self.case.goals.len() + self.edges.len()],
            closest: false,
        };
        let mut q = start.to_vec();
        let mut before = f64::INFINITY;
        for _ in 0..24 {
            self.minimise(&mut q, &hold);
            let missed = self.missed(&q);
            if missed < 0.01 * MET_M {
                break;
            }
            for (index, (row, stiffness, force)) in self.terms(&q, &hold).into_iter().enumerate() {
                hold.forces[index] = pressed(&row, stiffness, force);
            }
            if missed > 0.25 * before {
                hold.stiffness = (10.0 * hold.stiffness).min(1e9);
            }
            before = missed;
        }
        (self.missed(&q) <= MET_M).then_some(q)
    }

    /// The most that a hard goal or a cone is missed by.
    fn missed(&self, q: &[f64]) -> f64 {
        let of = |row: &Row| {
            if row.is_exact {
                row.value.abs()
            } else {
                (-row.value).max(0.0)
            }
        };
        let goals = self.goals(q);
        let hard = goals.iter().zip(&self.case.goals);
        let hard = hard
            .filter(|(_, goal)| goal.is_hard())
            .map(|(row, _)| of(row));
        let cones = self.cones(q);
        hard.chain(cones.iter().map(of)).fold(0.0, f64::max)
    }

    /// The least change found from the tracked angles and from `starts` random postures.
    pub fn least(&self, random: &mut Pcg64Mcg, starts: u32) -> Option<Vec<f64>> {
        let mut best = self.held(&self.wanted);
        for _ in 0..starts {
            let start: Vec<f64> = angles(random, self.chain, 0.0)
                .into_iter()
                .map(f64::from)
                .collect();
            // Half of them half way: near optima are more likely.
            let near = random.random_range(0..2) == 1;
            let start = if near {
                let pairs = start.iter().zip(&self.wanted);
                pairs.map(|(a, b)| 0.5 * (a + b)).collect()
            } else {
                start
            };
            if let Some(found) = self.held(&start) {
                let better = |old: &Vec<f64>| self.change(&found) < self.change(old);
                if best.as_ref().is_none_or(better) {
                    best = Some(found);
                }
            }
        }
        best
    }

    /// The least distance from the place that the goals ask for, in metres.
    pub fn closest_m(&self, random: &mut Pcg64Mcg, starts: u32) -> f64 {
        let mut best = f64::INFINITY;
        for round in 0..=starts {
            let mut q = if round == 0 {
                self.wanted.clone()
            } else {
                let start = angles(random, self.chain, 0.0);
                start.into_iter().map(f64::from).collect()
            };
            let hold = Hold {
                stiffness: 1e4,
                forces: vec![0.0; self.case.goals.len() + self.edges.len()],
                closest: true,
            };
            self.minimise(&mut q, &hold);
            best = best.min(self.distance_m(&q));
        }
        best
    }

    /// How far the goals are from met, all together, in metres.
    pub fn distance_m(&self, q: &[f64]) -> f64 {
        let squares = self.goals(q).into_iter().map(|row| {
            let missed = if row.is_exact {
                row.value
            } else {
                row.value.min(0.0)
            };
            missed * missed
        });
        squares.sum::<f64>().sqrt()
    }

    /// The length of the change from the tracked angles.
    pub fn change(&self, q: &[f64]) -> f64 {
        let squares = q.iter().zip(&self.wanted).map(|(q, w)| (q - w).powi(2));
        squares.sum::<f64>().sqrt()
    }

    /// What a posture costs with soft goals, in rad2.
    pub fn cost(&self, q: &[f64]) -> f64 {
        let soft = self.goals(q).into_iter().zip(&self.case.goals);
        let soft = soft.filter(|(_, goal)| !goal.is_hard()).map(|(row, goal)| {
            let missed = if row.is_exact {
                row.value
            } else {
                row.value.min(0.0)
            };
            0.5 * missed * missed / f64::from(goal.softness)
        });
        0.5 * self.change(q).powi(2) + soft.sum::<f64>()
    }
}

/// How strongly and with which multipliers rows are held.
struct Hold {
    stiffness: f64,
    forces: Vec<f64>,
    /// Only the distance counts.
    closest: bool,
}

impl Hold {
    fn weight(&self) -> f64 {
        if self.closest { 1e-9 } else { 1.0 }
    }
}

/// The multiplier that a row asks for; zero where it does not press.
fn pressed(row: &Row, stiffness: f64, force: f64) -> f64 {
    let pressed = force + stiffness * row.value;
    if row.is_exact {
        pressed
    } else {
        pressed.min(0.0)
    }
}

/// The Newton step of the free joints, by elimination.
fn newton(matrix: &[Vec<f64>], slope: &[f64], free: &[usize]) -> Vec<f64> {
    let n = free.len();
    let mut m: Vec<Vec<f64>> = free
        .iter()
        .map(|&i| free.iter().map(|&j| matrix[i][j]).collect())
        .collect();
    let mut right: Vec<f64> = free.iter().map(|&i| slope[i]).collect();
    for i in 0..n {
        for k in i + 1..n {
            let factor = m[k][i] / m[i][i];
            for j in i..n {
                m[k][j] -= factor * m[i][j];
            }
            right[k] -= factor * right[i];
        }
    }
    for i in (0..n).rev() {
        for j in i + 1..n {
            right[i] -= m[i][j] * right[j];
        }
        right[i] /= m[i][i];
    }
    let mut step = vec![0.0; slope.len()];
    for (&j, found) in free.iter().zip(right) {
        step[j] = found;
    }
    step
}
