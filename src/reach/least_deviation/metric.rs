//! The metric of a program: second derivatives of its cost, and its factors.

use glam::Vec3;

use super::program::NARROW;
use crate::geometry::chain::Posture;
use crate::limits::CHAIN_HINGES_MAX;
use crate::math;

/// Soft goals of 1e-5 m2/rad2 against changes of angles mean forces of 1e4 that cancel: f32 would not do.
pub(super) type Wide<const W: usize> = [f64; W];

/// Most that one joint is stiffened, the change of the angles being one.
const SPRING_MAX: f64 = 10.0;

/// Sums over points of the lever of each joint across the pull at the point.
pub(super) type Torques = [Vec3; CHAIN_HINGES_MAX];

/// A symmetric matrix over the joints.
#[derive(Clone)]
pub(super) struct Metric<const W: usize> {
    rows: [Wide<W>; W],
    /// Whether it is the unit matrix, that of the change of the angles alone.
    is_unit: bool,
}

impl<const W: usize> Metric<W> {
    /// That of the change of the angles alone.
    pub(super) fn new() -> Self {
        let mut new = Self::flat();
        for joint in 0..W {
            new.rows[joint][joint] = 1.0;
        }
        new.is_unit = true;
        new
    }

    pub(super) const fn flat() -> Self {
        Self {
            rows: [[0.0; W]; W],
            is_unit: false,
        }
    }

    pub(super) const fn is_unit(&self) -> bool {
        self.is_unit
    }

    /// The largest entry.
    pub(super) fn largest(&self) -> f64 {
        let all = self.rows.iter().flatten();
        all.fold(0.0, |most, entry| math::max_f64(entry.abs(), most))
    }

    pub(super) fn diagonal(&self, joint: usize) -> f64 {
        self.rows[joint][joint]
    }

    pub(super) fn row_times(&self, joint: usize, x: &Wide<W>) -> f64 {
        product(&self.rows[joint], x)
    }

    /// A multiple of it.
    pub(super) fn times(&self, by: f64) -> Self {
        Self {
            rows: self.rows.map(|row| row.map(|entry| entry * by)),
            is_unit: false,
        }
    }

    /// No eigenvalue is larger (Gershgorin 1931).
    pub(super) fn most(&self, joints: usize) -> f64 {
        let rows = self.rows.iter().take(joints);
        let sums = rows.map(|row| row.iter().map(|x| x.abs()).sum::<f64>());
        sums.fold(0.0, math::max_f64)
    }

    /// The square of some turns.
    pub(super) fn square(&self, x: &Wide<W>) -> f64 {
        let rows = self.rows.iter().zip(x);
        rows.map(|(row, x_i)| x_i * product(row, x)).sum()
    }

    /// Adds the square of a row.
    pub(super) fn add_square(&mut self, row: &Wide<W>, stiffness: f64, joints: usize) {
        self.is_unit = false;
        for i in 0..joints {
            let part = row[i] * stiffness;
            for j in 0..W {
                self.rows[i][j] += part * row[j];
            }
        }
    }

    /// The second derivatives of points' places along their pulls. Hinge i, nearer to the root than j, turns
    /// the levers of j about its own axis, so the torques say it all: a_i x by_j . pull = a_i . (by_j x pull).
    pub(super) fn curved(torques: &Torques, placed: &Posture) -> Self {
        let mut new = Self::flat();
        for (i, hinge) in placed.iter().enumerate() {
            for j in i..placed.len() {
                let bend = f64::from(hinge.axis.dot(torques[j]));
                new.rows[i][j] = bend;
                new.rows[j][i] = bend;
            }
        }
        new
    }

    /// Adds a part of its largest entry to the diagonal, where it has more than the change of the angles.
    pub(super) fn damp(&mut self, part: f64, joints: usize) {
        if self.is_unit {
            return;
        }
        let added = part * self.largest();
        for joint in 0..joints {
            self.rows[joint][joint] += added;
        }
    }

    /// The same with a part of a curvature.
    pub(super) fn with(&self, bent: &Self, part: f64, joints: usize) -> Self {
        let mut whole = self.clone();
        whole.is_unit = false;
        for i in 0..joints {
            for j in 0..W {
                whole.rows[i][j] += part * bent.rows[i][j];
            }
        }
        whole
    }

    /// Adds to the diagonal alone what leaves no direction without curvature: `along` each joint alone what
    /// holds it there, up to a bound; else the least that is certain to be no less (Gershgorin 1931).
    pub(super) fn hold(&mut self, bent: &Self, along: bool, joints: usize) {
        self.is_unit = false;
        for i in 0..joints {
            self.rows[i][i] += if along {
                math::max_f64(0.0, math::min_f64(bent.rows[i][i], SPRING_MAX))
            } else {
                bent.rows[i].iter().map(|x| x.abs()).sum::<f64>()
            };
        }
    }
}

/// The factors of a metric among free joints: U^T D^-1 U, U having D on its diagonal.
pub(super) struct Factor<const W: usize> {
    upper: [Wide<W>; W],
    inverse: Wide<W>,
    free: [bool; W],
    joints: usize,
    is_unit: bool,
}

impl<const W: usize> Factor<W> {
    pub(super) fn new(metric: &Metric<W>, free: &[bool; W], joints: usize) -> Self {
        let mut new = Self {
            upper: metric.rows,
            inverse: [1.0; W],
            free: *free,
            joints,
            is_unit: metric.is_unit,
        };
        if !metric.is_unit {
            new.eliminate();
        }
        new
    }

    fn eliminate(&mut self) {
        for k in 0..self.joints {
            if !self.free[k] {
                self.upper[k] = [0.0; W];
                for i in 0..self.joints {
                    self.upper[i][k] = 0.0;
                }
                self.upper[k][k] = 1.0;
            }
        }
        for k in 0..self.joints {
            let pivot = self.upper[k];
            self.inverse[k] = 1.0 / pivot[k];
            for i in k + 1..self.joints {
                let part = pivot[i] * self.inverse[k];
                for j in 0..W {
                    self.upper[i][j] -= part * pivot[j];
                }
            }
        }
    }

    /// The joints that it is among.
    pub(super) const fn free(&self) -> &[bool; W] {
        &self.free
    }

    /// The factors among other joints, of the same metric.
    pub(super) fn among(self, metric: &Metric<W>, free: &[bool; W]) -> Self {
        if self.free == *free {
            return self;
        }
        Self::new(metric, free, self.joints)
    }

    /// The least pivot; negative where one is not a number.
    pub(super) fn least_pivot(&self) -> f64 {
        let pivots = (0..self.joints).map(|k| self.upper[k][k]);
        pivots.fold(f64::INFINITY, |least, pivot| {
            if pivot >= least {
                least
            } else if pivot > 0.0 {
                pivot
            } else {
                -1.0
            }
        })
    }

    /// What a push turns: nothing of the joints that are not free.
    pub(super) fn solved(&self, push: &Wide<W>) -> Wide<W> {
        let mut x = *push;
        for joint in 0..W {
            if !self.free[joint] {
                x[joint] = 0.0;
            }
        }
        if self.is_unit {
            return x;
        }
        for k in 0..self.joints {
            let part = x[k] * self.inverse[k];
            for i in k + 1..self.joints {
                x[i] -= part * self.upper[k][i];
            }
        }
        for k in (0..self.joints).rev() {
            let mut sum = x[k];
            for i in k + 1..self.joints {
                sum -= self.upper[k][i] * x[i];
            }
            x[k] = sum * self.inverse[k];
        }
        x
    }

    /// The turns of least cost, the joints that are not free keeping theirs.
    pub(super) fn downhill(&self, metric: &Metric<W>, slope: &Wide<W>, turns: &Wide<W>) -> Wide<W> {
        let mut held = [0.0; W];
        let mut push = [0.0; W];
        for joint in 0..self.joints {
            if !self.free[joint] {
                held[joint] = turns[joint];
            }
            push[joint] = -slope[joint];
        }
        if !metric.is_unit {
            for joint in 0..self.joints {
                if held[joint] != 0.0 {
                    for i in 0..W {
                        push[i] -= metric.rows[joint][i] * held[joint];
                    }
                }
            }
        }
        let mut x = self.solved(&push);
        for joint in 0..W {
            x[joint] += held[joint];
        }
        x
    }
}

/// Eight sums side by side, then one fixed tree.
pub(super) fn product<const W: usize>(a: &Wide<W>, b: &Wide<W>) -> f64 {
    let mut s = [0.0; NARROW];
    for k in 0..NARROW {
        s[k] = a[k] * b[k];
    }
    for k in NARROW..W {
        s[k - NARROW] += a[k] * b[k];
    }
    ((s[0] + s[4]) + (s[1] + s[5])) + ((s[2] + s[6]) + (s[3] + s[7]))
}
