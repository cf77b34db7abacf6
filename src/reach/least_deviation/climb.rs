//! The way up where a height bends more than the change of the angles does.
//!
//! Near a posture where little slope is left, as that of an arm nearly straight along a plane's normal, second
//! derivatives say which way a point rises: two joints together may lift it where each alone does not. The
//! least change |d|^2 / 2 with a height g . d + d H d / 2 is d = l (1 - l H)^-1 g with that multiplier l,
//! below the inverse of the largest eigenvalue of H, at which the height is enough (More 1993,
//! "Generalizations of the trust region problem"). The largest height for a change so long is on the same
//! curve, which serves for ways too long for one step, too. The height grows with l all along.
//!
//! Joints that came to a limit stay there while l grows: curvature counts among what is left. Goals that press
//! together are taken for one, each weighted with the force that it presses with where all are taken for
//! straight.

use super::TURN_MAX;
use super::metric::{Factor, Metric, Wide, product};
use super::program::{Program, kept};
use crate::math;
use crate::reach::goal::Task;

/// How many multipliers are tried.
const CLIMB_PASSES: u32 = 12;

/// How often joints come to a limit for one multiplier.
const LIMIT_PASSES: u32 = 4;

/// Least curvature on a climb, that of the change of the angles being one.
const PIVOT_MIN: f64 = 0.02;

/// The same that is certain for the first multiplier, with all joints free.
const FIRST_PIVOT_MIN: f64 = 0.2;

/// A climb is found when it gains what is needed, or turns a joint by what a step may, to within this factor.
const EXCESS_MAX: f64 = 1.25;

/// Most that the multiplier grows by at once.
const GROWTH_MAX: f64 = 4.0;

/// A tangent less steep than this part of the first one says nothing of how far a way is to be stretched.
const STEEP_MIN: f64 = 0.25;

/// What the pressing goals ask for, taken for one.
struct Ascent<const W: usize> {
    /// Derivatives of the height.
    pull: Wide<W>,
    /// Second derivatives of the height, negated.
    bent: Metric<W>,
    need: f64,
}

impl<const W: usize> Ascent<W> {
    /// What turns gain on their tangent, and what they lose against it.
    fn gain(&self, turns: &Wide<W>) -> (f64, f64) {
        (product(&self.pull, turns), 0.5 * self.bent.square(turns))
    }

    /// What turns gain as a part of the need, or the widest as a part of what a step may turn, if that is more.
    fn enough(&self, turns: &Wide<W>) -> f64 {
        let widest = turns.iter().map(|turn| turn.abs());
        let widest = widest.fold(0.0, math::max_f64);
        let (along, aside) = self.gain(turns);
        math::max_f64(widest / f64::from(TURN_MAX), (along - aside) / self.need)
    }

    /// The part t of a way, near one, that gains the need: t along - t2 aside, by Newton's method. One where
    /// there is none, as on ways that are no longer only because a step is not.
    fn stretch(&self, turns: &Wide<W>) -> f64 {
        let (along, aside) = self.gain(turns);
        let mut t = 1.0;
        for _ in 0..3 {
            let steep = along - 2.0 * t * aside;
            if steep <= STEEP_MIN * along {
                return 1.0;
            }
            t -= (t * along - t * t * aside - self.need) / steep;
        }
        if (1.0 / EXCESS_MAX..=EXCESS_MAX).contains(&t) {
            t
        } else {
            1.0
        }
    }
}

/// Turns, and which joints are at no limit there.
#[derive(Clone)]
struct Rest<const W: usize> {
    turns: Wide<W>,
    free: [bool; W],
}

impl<const W: usize> Program<W> {
    /// Finds the turns that gain what the pressing goals need, or as much as a step can. `bent` is the curvature
    /// with a `part` of the forces. Returns whether there are such; the program is as it was where not.
    ///
    /// Cost: at most eight factorisations for each of twelve multipliers; three of one each as a rule.
    pub(super) fn climb(
        &mut self,
        task: &Task,
        straight: &Metric<W>,
        bent: &Metric<W>,
        part: f64,
    ) -> bool {
        let ascent = self.ascent(bent, part);
        let start = Rest {
            turns: [0.0; W],
            free: [true; W],
        };
        let mut last = start.clone();
        let (mut low, mut high) = (0.0, f64::INFINITY);
        let first = (1.0 - FIRST_PIVOT_MIN) / ascent.bent.most(self.joints);
        let mut force = math::min_f64(first, part);
        for _ in 0..CLIMB_PASSES {
            let rest = self
                .settled(task, straight, &ascent, force, start.clone())
                .or_else(|| self.settled(task, straight, &ascent, force, last.clone()));
            let mut growth = None;
            if let Some(rest) = rest {
                let enough = ascent.enough(&rest.turns);
                if (1.0 / EXCESS_MAX..=EXCESS_MAX).contains(&enough) {
                    return self.take(&ascent, &rest.turns);
                }
                growth = (enough < 1.0).then_some(1.0 / enough);
                last = rest;
            }
            match growth {
                Some(_) => low = force,
                None => high = force,
            }
            force = match growth {
                Some(growth) if high == f64::INFINITY => force * math::min_f64(growth, GROWTH_MAX),
                _ => 0.5 * (low + high),
            };
        }
        false
    }

    fn ascent(&self, bent: &Metric<W>, part: f64) -> Ascent<W> {
        let mut ascent = Ascent {
            pull: [0.0; W],
            bent: bent.times(1.0 / part),
            need: 0.0,
        };
        let goals = self.lines.iter().take(self.goal_lines);
        for line in goals.filter(|line| line.presses) {
            for j in 0..W {
                ascent.pull[j] += line.row[j] * line.force;
            }
            ascent.need += line.need * line.force;
        }
        ascent
    }

    /// The turns for one multiplier, from what is at its limits; none where there is too little curvature.
    fn settled(
        &self,
        task: &Task,
        straight: &Metric<W>,
        ascent: &Ascent<W>,
        force: f64,
        mut rest: Rest<W>,
    ) -> Option<Rest<W>> {
        let metric = straight.with(&ascent.bent, force, self.joints);
        let slope = core::array::from_fn(|j| self.slope[j] - force * ascent.pull[j]);
        for _ in 0..LIMIT_PASSES {
            let factor = Factor::new(&metric, &rest.free, self.joints);
            if factor.least_pivot() < PIVOT_MIN {
                return None;
            }
            rest.turns = factor.downhill(&metric, &slope, &rest.turns);
            let mut changed = false;
            for (index, hinge) in task.hinges.iter().enumerate().take(self.joints) {
                let turn = kept(hinge, self.q[index], rest.turns[index]);
                if turn != rest.turns[index] {
                    rest.turns[index] = turn;
                    rest.free[index] = false;
                    changed = true;
                }
            }
            if !changed {
                break;
            }
        }
        Some(rest)
    }

    /// Takes turns that gain about enough; whether they are within the cones' edges, which bend in a way of
    /// their own.
    fn take(&mut self, ascent: &Ascent<W>, turns: &Wide<W>) -> bool {
        let t = ascent.stretch(turns);
        let turns = turns.map(|turn| turn * t);
        let mut edges = self.lines.iter().skip(self.goal_lines);
        if edges.any(|edge| product(&edge.row, &turns) < edge.need) {
            return false;
        }
        self.turns = turns;
        true
    }
}
