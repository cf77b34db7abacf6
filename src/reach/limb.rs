//! Solving one chain of a skeleton for its contacts.

mod foreseen;

use arrayvec::ArrayVec;
use glam::Vec3;

use super::cyclic_descent::cyclic_descent_paid;
use super::goal::{Goal, Reached, Task};
use super::least_deviation::least_deviation_paid;
use super::root::{HalfSpaces, add, nearest_outside};
use super::skeleton::{SWING_M, goes_with_root};
use super::touch::{Goals, Place, Touches, deepest_m};
use crate::geometry::chain::{Ball, Posture, posture};
use crate::geometry::linkage::angle_at;
use crate::limits::{CHAIN_GOALS_MAX, CHAIN_HINGES_MAX, REACH_STEPS_PER_LEG_MAX, STILL_M};
use crate::math::{self, Pose};
use crate::state::State;
use crate::state::chains::{
    ChainOptions, ChainReport, End, ball_at, joints_of, place_chain, slot_range,
};
use crate::state::purse::Purse;
use crate::state::ways::Position;

/// A contact plane is kept when it is violated by no more than this, in metres: far below the rest gap.
const TOLERANCE_M: f32 = 2e-6;

/// A chain that violates a plane by more than this asks the root to give way, in metres.
const MISSED_M: f32 = 2e-5;

/// What a tip that is off its place costs against the angles, in m2/rad2: a radian of change is worth a
/// hundredth of a millimetre at arm's length.
const TIP_SOFTNESS: f32 = 1e-5;

/// How far a sliding tip's planes may be missed before the last steps, in metres.
const SLIDING_M: f32 = 5e-4;

/// Most steps of a frame that slide a tip; what is left follows in the next one.
const SLIDING_STEPS: u32 = 4;

/// Points of a chain nearer to its tip than this move with it, in metres, and so do those of links that
/// begin where the tip's link does.
const TIP_NEAR_M: f32 = 0.15;

/// Links that begin nearer to each other than this begin in one place, in metres.
const SAME_PLACE_M: f32 = 1e-3;

/// How often the lowest points of the touching pieces are looked for again.
const ROUNDS: u32 = 3;

/// One chain on one leg.
pub(super) struct Limb {
    pub chain: usize,
    pub pairs: usize,
    pub at: Position,
    pub goal: Position,
    pub wanted: Position,
    /// Part of the way to the wanted angles and tip.
    pub share: f32,
}

/// What solving chains came to.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Solved {
    /// Contact changed the angles.
    pub bent: bool,
    /// How far a goal's point swings toward its plane between the ends of the leg, in metres.
    pub swing_m: f32,
}

type Angles = ArrayVec<f32, CHAIN_HINGES_MAX>;

/// Finds a chain's angles at the end of the leg and places its links. Without contact they are the
/// wanted ones, and no step is spent.
pub(super) fn solve(
    state: &mut State,
    limb: &mut Limb,
    steps: &mut Purse,
    missed: &mut HalfSpaces,
) -> Solved {
    let joints = joints_of(state, limb.chain);
    let slot = slot_range(state, limb.at.leg).start;
    let place = Place {
        chain: limb.chain,
        first_joint: joints.start,
        at: limb.at,
        goal: limb.goal,
    };
    let touches = if goes_with_root(state, limb.chain) {
        Touches::new()
    } else {
        place.touches(state, limb.pairs)
    };
    if touches.is_empty() && is_proposed(state, limb) {
        return Solved::default();
    }
    let from: Angles = state.ways.from[slot..][joints.clone()]
        .iter()
        .copied()
        .collect();
    let mut wanted: Angles = from.clone();
    if state.ways.held[limb.chain] == 0 {
        for (index, angle) in wanted.iter_mut().enumerate() {
            *angle = angle_at(*angle, state.ways.wanted[joints.start + index], limb.share);
        }
        if limb.share < 1.0 {
            // Between two allowed postures there may be some that are not.
            for joint in joints.clone() {
                if let Some(ball) = ball_at(state, joint, joints.start) {
                    ball.kept(&mut wanted);
                }
            }
        }
    }
    let (angles, solved) = if touches.is_empty() {
        (wanted, Solved::default())
    } else {
        let problem = Problem::new(state, limb, &place, &touches, &wanted);
        problem.solve(state, &from, steps, missed)
    };
    let proposed = &mut state.ways.to[slot..][joints];
    let is_placed = *proposed == angles[..] && state.chains.base[limb.chain] == 0;
    if !is_placed {
        proposed.copy_from_slice(&angles);
        place_chain(state, limb.chain, limb.at.leg, End::To, Some(limb.at.leg));
    }
    solved
}

/// Whether a chain that touches nothing has its angles at the end of the leg, and its links there, already.
fn is_proposed(state: &State, limb: &Limb) -> bool {
    let joints = joints_of(state, limb.chain);
    let slot = slot_range(state, limb.at.leg).start;
    let wanted = if state.ways.held[limb.chain] == 0 {
        &state.ways.wanted[joints.clone()]
    } else {
        &state.ways.from[slot..][joints.clone()]
    };
    limb.share == 1.0
        && state.chains.base[limb.chain] == 0
        && state.ways.to[slot..][joints] == *wanted
}

/// A chain's task while it is put together.
struct Problem<'p> {
    limb: &'p Limb,
    place: &'p Place,
    touches: &'p Touches,
    wanted: &'p Angles,
    base: Pose,
    balls: ArrayVec<Ball, { CHAIN_HINGES_MAX / 3 }>,
    goals: Goals,
    /// How many of the goals are the tip's.
    soft: usize,
    /// Where the tip is wanted, in the solver's frame.
    tip: Vec3,
}

impl<'p> Problem<'p> {
    fn new(
        state: &State,
        limb: &'p Limb,
        place: &'p Place,
        touches: &'p Touches,
        wanted: &'p Angles,
    ) -> Self {
        let first = place.first_joint;
        let slot = slot_range(state, limb.at.leg).start;
        let root = place.root();
        let base = match state.chains.base[limb.chain].checked_sub(1) {
            Some(joint) => root.then(&state.ways.to_link[slot + joint as usize]),
            None => root,
        };
        let balls = joints_of(state, limb.chain).filter_map(|joint| ball_at(state, joint, first));
        let mut new = Self {
            limb,
            place,
            touches,
            wanted,
            base,
            balls: balls.take(CHAIN_HINGES_MAX / 3).collect(),
            goals: Goals::new(),
            soft: 0,
            tip: Vec3::ZERO,
        };
        new.hold_tip(state);
        new
    }

    /// Asks for the tip's place, along which contact lets it slide.
    fn hold_tip(&mut self, state: &State) {
        let options = &state.chains.options[self.limb.chain];
        if !options.has(ChainOptions::HOLDS_TIP) {
            return;
        }
        let last = joints_of(state, self.limb.chain).end - 1;
        let slot = slot_range(state, self.limb.at.leg).start;
        let tip = Vec3::from_array(options.tip);
        let from = self
            .limb
            .at
            .root
            .point(state.ways.from_link[slot + last].point(tip));
        let to = state.ways.tip[self.limb.chain];
        self.tip = self.place.point(from + (to - from) * self.limb.share);
        for goal in Goal::place(last - self.place.first_joint, tip, self.tip) {
            let softness = TIP_SOFTNESS;
            self.goals.push(Goal { softness, ..goal });
        }
        self.soft = self.goals.len();
    }

    /// Moves the tip's goals by the least translation that takes the touching points near it out of their
    /// planes, with its link turned as in a posture: where the paper's equation 3 wants it.
    fn project_tip(&mut self, posture: &Posture) {
        if self.soft == 0 {
            return;
        }
        let at = self.goals[0].at(posture);
        let mut planes = HalfSpaces::new();
        for goal in &self.goals[self.soft..] {
            let aside = goal.at(posture) - at;
            let tip_link = posture[self.goals[0].link].link.translation();
            let own = posture[goal.link].link.translation() - tip_link;
            let goes_along = math::length(own) <= SAME_PLACE_M;
            if goes_along || math::length(aside) <= TIP_NEAR_M {
                let above = goal.normal.dot(self.tip + aside) - goal.height_m;
                add(&mut planes, goal.normal, -above);
            }
        }
        let out = nearest_outside(&planes).unwrap_or(Vec3::ZERO);
        let place = self.tip + out;
        let Some(normal) = math::direction(out) else {
            for (goal, axis) in self.goals.iter_mut().zip(Vec3::AXES) {
                goal.normal = axis;
                goal.height_m = axis.dot(place);
                goal.softness = TIP_SOFTNESS;
            }
            return;
        };
        // How far out it is, the planes and the angles say; where along them, the tip does.
        let first = math::perpendicular(normal);
        let along = [first, normal.cross(first), normal];
        for (goal, axis) in self.goals.iter_mut().zip(along) {
            goal.normal = axis;
            goal.height_m = axis.dot(place);
            goal.softness = if axis == normal { 1.0 } else { TIP_SOFTNESS };
        }
    }

    fn task<'t>(&'t self, state: &'t State) -> Task<'t> {
        Task {
            hinges: &state.joints.hinge[joints_of(state, self.limb.chain)],
            balls: &self.balls,
            root: self.base,
            wanted: self.wanted,
            goals: &self.goals,
            tolerance_m: TOLERANCE_M,
        }
    }

    fn posture(&self, state: &State, angles: &[f32]) -> Posture {
        let hinges = &state.joints.hinge[joints_of(state, self.limb.chain)];
        posture(hinges, &self.base, angles)
    }

    /// Adds the goals of the lowest points of the touching pieces; whether there were new ones.
    fn look(&mut self, state: &State, posture: &Posture) -> bool {
        let mut found = false;
        for touch in self.touches {
            let link = &posture[touch.link()].link;
            found |= self.place.add_goal(state, touch, link, &mut self.goals);
        }
        found
    }

    fn solve(
        mut self,
        state: &mut State,
        from: &Angles,
        steps: &mut Purse,
        missed: &mut HalfSpaces,
    ) -> (Angles, Solved) {
        let (start, wanted) = (self.posture(state, from), self.posture(state, self.wanted));
        self.look(state, &start);
        self.look(state, &wanted);
        let depth = deepest_m(&self.goals, &wanted);
        self.project_tip(&start);
        state.chains.depth[self.limb.chain] = depth;
        if depth <= TOLERANCE_M {
            let solved = self.swing(state, from, self.wanted, [&start, &wanted]);
            return (self.wanted.clone(), solved);
        }
        let foreseen = if self.descends(state) || self.soft > 0 {
            None
        } else {
            self.foreseen(state)
        };
        let (angles, posture, mut reached) =
            foreseen.unwrap_or_else(|| self.rounds(state, from, &start, &wanted, steps));
        if state.chains.report[self.limb.chain].flags & ChainReport::CUT != 0 {
            // A chain that was cut asks nothing of the root: it goes on in the next frame.
            reached = 0.0;
        }
        self.report(state, &posture, reached, missed);
        let mut solved = self.swing(state, from, &angles, [&start, &posture]);
        solved.bent = true;
        if self.is_still(state, from, &angles) {
            return (from.clone(), solved);
        }
        (angles, solved)
    }

    /// Whether the chain is solved by the paper's method.
    fn descends(&self, state: &State) -> bool {
        state.chains.options[self.limb.chain].method == ChainOptions::CYCLIC_DESCENT
    }

    /// Solves, looks for lower points, and solves again, from angles that take the links to `start`; the angles,
    /// where they take the links and what is missed there.
    fn rounds(
        &mut self,
        state: &mut State,
        from: &Angles,
        start: &Posture,
        wanted: &Posture,
        steps: &mut Purse,
    ) -> (Angles, Posture, f32) {
        let chain = self.limb.chain;
        let descends = self.descends(state);
        let mut angles = if descends {
            self.begun(state, wanted)
        } else {
            from.clone()
        };
        let (mut posture, mut missed_m) = (start.clone(), 0.0);
        for _ in 0..ROUNDS {
            let most = REACH_STEPS_PER_LEG_MAX;
            let mut refused = false;
            let mut pay = || {
                let paid = steps.take(1);
                refused |= !paid;
                paid
            };
            let task = self.task(state);
            let found;
            if descends {
                found = cyclic_descent_paid(&task, &mut angles, most, &mut pay);
                posture = self.posture(state, &angles);
            } else if self.soft == 0 {
                (found, posture) =
                    least_deviation_paid(&task, &mut angles, most, Some(&posture), &mut pay);
            } else {
                (found, posture) = slid(&task, self.soft, &mut angles, most, &posture, &mut pay);
            }
            state.chains.report[chain].steps += found.steps;
            if refused {
                state.chains.report[chain].flags |= ChainReport::CUT;
            }
            missed_m = found.missed_m;
            self.project_tip(&posture);
            if !self.look(state, &posture) || deepest_m(&self.goals, &posture) <= TOLERANCE_M {
                break;
            }
        }
        (angles, posture, missed_m)
    }

    /// Writes down what is missed, and asks the root for it.
    fn report(&self, state: &mut State, posture: &Posture, missed_m: f32, missed: &mut HalfSpaces) {
        let report = &mut state.chains.report[self.limb.chain];
        report.flags |= ChainReport::BENT;
        report.missed_m = missed_m;
        if missed_m <= MISSED_M {
            return;
        }
        report.flags |= ChainReport::MISSED;
        if !state.chains.options[self.limb.chain].has(ChainOptions::MOVES_ROOT) {
            return;
        }
        let moved = self.limb.goal.root.translation() - self.limb.wanted.root.translation();
        for goal in &self.goals[self.soft..] {
            let short = goal.missed_m(posture);
            if short > MISSED_M {
                add(missed, goal.normal, short + goal.normal.dot(moved));
            }
        }
    }

    /// How far the goals' points swing toward their planes half way, compared to the links at both ends.
    /// Where that is certain to be no more than a leg may have, it is not looked at.
    fn swing(&self, state: &State, from: &Angles, to: &Angles, ends: [&Posture; 2]) -> Solved {
        if self.sag_m(state, from, to) <= SWING_M {
            return Solved::default();
        }
        let middle: Angles = from.iter().zip(to).map(|(a, b)| 0.5 * (a + b)).collect();
        let middle = self.posture(state, &middle);
        let swing_m = self.goals[self.soft..].iter().fold(0.0, |most, goal| {
            let mean = 0.5 * (goal.above_m(ends[0]) + goal.above_m(ends[1]));
            math::max(mean - goal.above_m(&middle), most)
        });
        Solved {
            bent: false,
            swing_m,
        }
    }

    /// A bound of how far a goal's point is half way from the middle of its straight way: an eighth of its largest
    /// acceleration, which is as in [`crate::geometry::linkage`].
    fn sag_m(&self, state: &State, from: &Angles, to: &Angles) -> f32 {
        let reach_squared = self.goals[self.soft..].iter();
        let reach_squared = reach_squared.map(|goal| goal.point.length_squared());
        let mut arm = math::sqrt(reach_squared.fold(0.0, math::max));
        let rate = |index: usize| (from[index] - to[index]).abs();
        let mut before: f32 = (0..from.len()).map(rate).sum();
        let (mut speed, mut acceleration) = (0.0, 0.0);
        for index in (0..from.len()).rev() {
            let w = rate(index);
            before = math::max(before - w, 0.0);
            speed += w * arm;
            acceleration += w * (2.0 * before * arm + speed);
            arm += state.joints.length[self.place.first_joint + index];
        }
        0.125 * acceleration
    }

    /// Whether no point of the chain would move by as much as is worth a step.
    fn is_still(&self, state: &State, from: &Angles, to: &Angles) -> bool {
        let length: f32 = joints_of(state, self.limb.chain)
            .map(|joint| state.joints.length[joint])
            .sum();
        let turned: f32 = from.iter().zip(to).map(|(a, b)| (a - b).abs()).sum();
        turned * math::max(length, 0.1) < STILL_M
    }
}

/// Slides a tip that is held along the contact planes: the least deviation with the planes kept loosely,
/// since they bend under it, and then the least change from there that keeps them.
fn slid(
    task: &Task,
    soft: usize,
    angles: &mut Angles,
    steps: u32,
    known: &Posture,
    pay: &mut dyn FnMut() -> bool,
) -> (Reached, Posture) {
    let loose = Task {
        tolerance_m: SLIDING_M,
        ..*task
    };
    let most = steps.min(SLIDING_STEPS);
    let (first, posture) = least_deviation_paid(&loose, angles, most, Some(known), pay);
    let wanted = angles.clone();
    let tight = Task {
        wanted: &wanted,
        goals: &task.goals[soft..],
        ..*task
    };
    let most = steps - first.steps.min(steps);
    let (second, posture) = least_deviation_paid(&tight, angles, most, Some(&posture), pay);
    let reached = Reached {
        steps: first.steps + second.steps,
        missed_m: second.missed_m,
    };
    (reached, posture)
}

const _: () = assert!(super::touch::TOUCHES_MAX + 3 < CHAIN_GOALS_MAX);
