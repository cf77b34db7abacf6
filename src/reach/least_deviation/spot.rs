//! A posture that a search came to, and what it is worth.

use crate::geometry::chain::{Posture, place};
use crate::math;
use crate::reach::goal::{Angles, Task};

/// A gain smaller than this part of what is missed is none.
const GAIN_MIN: f32 = 1e-4;

/// A cost lowered by less than this part is not.
const CHEAPER_MIN: f32 = 1e-6;

pub(super) struct Spot {
    pub(super) q: Angles,
    pub(super) placed: Posture,
    /// The most that a hard goal is missed by, in metres.
    pub(super) missed_m: f32,
    /// Whether all hard goals are met.
    pub(super) is_met: bool,
    /// Sum of the squares of what hard goals are missed by, in m2.
    pub(super) shortfall: f32,
    /// Half the sum of squared changes, and what missing soft goals costs, in rad2.
    pub(super) cost: f32,
    /// Sum of what hard goals are missed by, in metres.
    missed_sum_m: f32,
    /// Whether the task has soft goals.
    pub(super) is_soft: bool,
}

impl Spot {
    /// One that is not anywhere yet.
    pub(super) const fn nowhere() -> Self {
        Self {
            q: Angles::new_const(),
            placed: Posture::new_const(),
            missed_m: 0.0,
            is_met: false,
            shortfall: 0.0,
            cost: 0.0,
            missed_sum_m: 0.0,
            is_soft: false,
        }
    }

    /// Becomes the spot at some angles.
    pub(super) fn go_to(&mut self, task: &Task, q: Angles) {
        place(task.hinges, &task.root, &q, &mut self.placed);
        self.q = q;
        self.measure(task);
    }

    /// The same for angles that take the links there.
    pub(super) fn be_at(&mut self, task: &Task, q: Angles, placed: &Posture) {
        self.placed.clone_from(placed);
        self.q = q;
        self.measure(task);
    }

    /// Says what the spot is worth for a task.
    pub(super) fn measure(&mut self, task: &Task) {
        let (mut most, mut squares, mut sum) = (0.0, 0.0, 0.0);
        let mut cost = task.deviation(&self.q);
        let mut is_soft = false;
        for goal in task.used_goals() {
            if goal.is_hard() {
                let missed = goal.missed_m(&self.placed);
                most = math::max(missed, most);
                squares += missed * missed;
                sum += missed;
            } else {
                is_soft = true;
                cost += goal.soft_cost(&self.placed);
            }
        }
        self.missed_m = most;
        self.is_met = most <= task.tolerance_m;
        self.shortfall = squares;
        self.cost = cost;
        self.missed_sum_m = sum;
        self.is_soft = is_soft;
    }

    /// Whether an exact hard goal is missed.
    pub(super) fn misses_exactly(&self, task: &Task) -> bool {
        let goals = task.used_goals().iter();
        let mut exact = goals.filter(|goal| goal.is_exact && goal.is_hard());
        exact.any(|goal| goal.missed_m(&self.placed) > task.tolerance_m)
    }

    /// Whether this is worth going to from another spot: it meets the goals, or comes nearer to them;
    /// from goals met, it costs less with them met, a metre missed counting `penalty` rad2. Soft goals
    /// are strong springs, along which steps leave the hard ones a little: there the cost decides alone,
    /// and the next step mends the rest.
    pub(super) fn betters(&self, other: &Self, penalty: f32) -> bool {
        if !other.is_met {
            return self.is_met || self.shortfall < other.shortfall * (1.0 - GAIN_MIN);
        }
        let merit = |spot: &Self| spot.cost + penalty * spot.missed_sum_m;
        (self.is_met || self.is_soft) && merit(self) < merit(other) * (1.0 - CHEAPER_MIN)
    }
}
