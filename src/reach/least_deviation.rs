//! The angles nearest to the tracked ones that meet all goals.
//!
//! Least sum of squared changes from the tracked angles, and what missing the soft goals costs, subject
//! to the hard goals' planes, the joint limits and the reach cones: sequential quadratic programming
//! with goals and cones linearised and the second derivatives of the Lagrangian. A step is taken only if it
//! gets nearer to the goals, or, with the goals met, lowers the cost; it is halved otherwise.
//!
//! The first step starts from the tracked angles. Where it misses, because the planes of the goals bend
//! with the angles, the next ones are the least changes from where it came to: a Newton method for the
//! goals alone, which converges where further steps from the tracked angles would swing from side to
//! side. Once the goals are met, steps pull toward the tracked angles again.
//!
//! Contacts push shoulders, whose radius is the whole arm, and a soft goal out of reach pulls with all that
//! it is missed by: second derivatives count. With them a step leaves about its own square to be turned, and
//! a chain that follows its tracker from frame to frame takes one: the search ends where that square is
//! small. What goals that have to be met exactly leave would not be mended by a later frame, and their
//! search goes on. Where a push bends more than the change of the angles bears, as at a saddle of its height,
//! a host's search climbs along the curve of least changes for a height with second derivatives (More 1993,
//! "Generalizations of the trust region problem"). Where a step gains little all the same, one joint is turned
//! alone.
//!
//! Newton's method stalls at a straight arm whose goal is toward its shoulder, at joints on their limits
//! and out of reach. It is damped more when a step fails (Levenberg 1944). Where exact goals still are
//! not met it begins again from the middle of the ranges and from fixed postures, [`RESTARTS_MAX`]
//! times. The nearest posture is kept. Pushes, which any frame may ask for, are not restarted: they
//! would make a chain jump. Those that no joint can answer, since none moves their point or all that do are at their
//! limits, are missed, and the others and the tracked angles are gone on to.

mod alone;
mod climb;
mod eased;
mod metric;
mod program;
mod relaxed;
mod spot;

pub use program::PASSES_MAX;
pub(crate) use relaxed::relaxed;

use arrayvec::ArrayVec;

use super::goal::{Angles, Goal, Levers, Reached, Task};
use crate::geometry::chain::Posture;
use crate::limits::{CHAIN_GOALS_MAX, CHAIN_HINGES_MAX};
use crate::math;
use alone::turned_alone;
use eased::eased;
use program::{NARROW, Program};
use spot::Spot;

/// Most that an angle changes in one step, in radians: beyond it the linearised goals mean little.
const TURN_MAX: f32 = 0.7;

/// A step that would turn no joint by more than this ends the search, in radians.
const TURN_MIN: f32 = 1e-4;

/// Of a step toward missed goals that would turn no joint by more than this rounding is left, in radians.
const TURN_NONE: f32 = 1e-6;

/// What a Newton step that turns no joint by more than this leaves to be turned is about its square, less
/// than what ends the search.
const TURN_SURE: f32 = 1.5e-2;

/// How often a step is halved.
const HALVINGS_MAX: u32 = 4;

/// Where a step leaves more than this part of the squared shortfall, one joint is tried alone.
const LAG: f32 = 0.5;

/// Damping of a step, as a part of the largest entry of its matrix's diagonal: least, first after a
/// failure, most, and by what factor it grows and shrinks.
const DAMPING: f32 = 1e-6;
/// Soft goals bear on hard ones with forces of 1e4, which times the damping is what these give way.
const DAMPING_SOFT: f32 = 1e-11;
const DAMPING_RAISED: f32 = 1e-3;
const DAMPING_MAX: f32 = 1.0;
const DAMPING_FACTOR: f32 = 10.0;

/// How often a search for exact goals begins again.
pub const RESTARTS_MAX: u32 = 3;

/// With fewer steps left no search begins again.
const RESTART_STEPS_MIN: u32 = 6;

/// A search that climbs does so in its first steps. Where that is not enough, as among joints that come to their
/// limits again and again, it goes on as one that follows.
const CLIMB_STEPS: u32 = 6;

/// A search that follows climbs where it is missed by more than this, in metres: there a way out is long anyway.
const CLIMB_DEEP_M: f32 = 2e-2;

/// In so many steps the missed distance is to fall to half, or the search begins again.
const STALL_STEPS: u32 = 4;

/// Takes up to `steps` steps from `angles`, which stay within the limits.
///
/// A step is one linearisation, at most three times [`PASSES_MAX`] factorisations of a matrix with as
/// many rows as goals and two for each ball, as many and eight more of one with as many rows as joints, for
/// pushes up to a hundred more of those, and at most six forward kinematics; near the goals it is one
/// solution and one forward kinematics. With all goals met at the tracked angles no step is taken. Fewer than
/// six steps left mean no restart.
pub fn least_deviation(task: &Task, angles: &mut [f32], steps: u32) -> Reached {
    search(task, angles, steps, None, Manner::Climbs, &mut || true).0
}

/// The same for a chain that follows its tracker from frame to frame, as the world's do.
///
/// It climbs out of deep pushes alone, of more than 20 mm: one a millimetre deep at a saddle would turn a joint by ten
/// degrees and more from one frame to the next, where the root may give way instead.
pub fn least_deviation_following(task: &Task, angles: &mut [f32], steps: u32) -> Reached {
    least_deviation_paid(task, angles, steps, None, &mut || true).0
}

/// The same with every step paid for; it ends where paying is refused. Where the angles take the links may be
/// known, and is told.
pub(crate) fn least_deviation_paid(
    task: &Task,
    angles: &mut [f32],
    steps: u32,
    known: Option<&Posture>,
    pay: &mut dyn FnMut() -> bool,
) -> (Reached, Posture) {
    search(task, angles, steps, known, Manner::Follows, pay)
}

/// How a search for pushes goes on where their height bends more than the change of the angles bears.
#[derive(Clone, Copy, PartialEq)]
enum Manner {
    /// Along the curve of least changes, however far that is.
    Climbs,
    /// With less of the curvature, or one joint alone, unless it is deep.
    Follows,
}

impl Manner {
    /// Whether a step climbs, counted from one, where goals are missed by as much.
    fn climbs(self, step: u32, missed_m: f32) -> bool {
        step <= CLIMB_STEPS && (self == Self::Climbs || missed_m > CLIMB_DEEP_M)
    }
}

fn search(
    task: &Task,
    angles: &mut [f32],
    steps: u32,
    known: Option<&Posture>,
    manner: Manner,
    pay: &mut dyn FnMut() -> bool,
) -> (Reached, Posture) {
    let mut slots: [Spot; 5] = core::array::from_fn(|_| Spot::nowhere());
    let [here, next, aside, kept, mut best] = slots.each_mut();
    let mut spots = Spots {
        here,
        next,
        aside,
        kept,
    };
    let start = task.start(angles);
    match known {
        Some(placed) if start[..] == *angles => spots.here.be_at(task, start, placed),
        _ => spots.here.go_to(task, start),
    }
    let mut used = 0;
    if !(spots.here.is_met && spots.here.cost == 0.0) {
        used = descend(task, &mut spots, steps, false, manner, pay);
        let mut restart = 0;
        while restart < RESTARTS_MAX
            && steps - used >= RESTART_STEPS_MIN
            && spots.here.misses_exactly(task)
        {
            core::mem::swap(&mut spots.here, &mut best);
            let q = restarted(task, best.q.len(), restart);
            spots.here.go_to(task, q);
            used += descend(task, &mut spots, steps - used, false, manner, pay);
            if !spots.here.is_met && spots.here.shortfall >= best.shortfall {
                core::mem::swap(&mut spots.here, &mut best);
            }
            restart += 1;
        }
        if restart > 0 && !spots.here.is_met {
            used += descend(task, &mut spots, steps - used, true, manner, pay);
        }
        used += pass_by(task, &mut spots, steps - used, manner, pay);
    }
    for (angle, &found) in angles.iter_mut().zip(&spots.here.q) {
        *angle = found;
    }
    let reached = Reached {
        steps: used,
        missed_m: spots.here.missed_m,
    };
    (reached, spots.here.placed.clone())
}

/// Goes on to the least deviation where pushes that are missed are those that no joint can answer: they are not to keep
/// the joints from where they are wanted.
fn pass_by(
    task: &Task,
    spots: &mut Spots,
    steps: u32,
    manner: Manner,
    pay: &mut dyn FnMut() -> bool,
) -> u32 {
    if spots.here.is_met || spots.here.is_soft {
        return 0;
    }
    let Some(goals) = eased(task, spots.here) else {
        return 0;
    };
    let others = Task {
        goals: &goals,
        ..*task
    };
    spots.here.measure(&others);
    let used = descend(&others, spots, steps, false, manner, pay);
    spots.here.measure(task);
    used
}

/// Where a search is and goes. Spots are long: they change places and are not moved.
struct Spots<'s> {
    here: &'s mut Spot,
    next: &'s mut Spot,
    /// Another one to go to.
    aside: &'s mut Spot,
    /// Where the goals were last met before a step left them.
    kept: &'s mut Spot,
}

impl Spots<'_> {
    /// Goes to the next one; whether that leaves goals that were met, and where they were is kept.
    fn go_on(&mut self) -> bool {
        let leaves = self.here.is_met && !self.next.is_met;
        if leaves {
            core::mem::swap(&mut self.here, &mut self.kept);
        }
        core::mem::swap(&mut self.here, &mut self.next);
        leaves
    }
}

/// Steps from a spot until nothing is gained; how many there were. Unless it is `patient`, it ends where
/// exact goals come nearer too slowly, if steps are left to begin again.
fn descend(
    task: &Task,
    spots: &mut Spots,
    steps: u32,
    patient: bool,
    manner: Manner,
    pay: &mut dyn FnMut() -> bool,
) -> u32 {
    let is_soft = spots.here.is_soft;
    let least_damping = if is_soft { DAMPING_SOFT } else { DAMPING };
    let mut damping = least_damping;
    let (mut used, mut mark, mut since) = (0, spots.here.shortfall, 0);
    let mut left = false;
    while used < steps && pay() {
        used += 1;
        let was_met = spots.here.is_met;
        let restores = used > 1 && !was_met;
        let climbs = manner.climbs(used, spots.here.missed_m);
        let Step { turned, is_newton } = match step(task, spots, restores, climbs, damping) {
            Ok(step) => step,
            Err(turned) => {
                let is_far = is_soft && turned > TURN_SURE;
                // More damping makes a short step shorter.
                let is_short = restores && turned <= TURN_NONE;
                if (was_met && !is_far) || is_short || damping >= DAMPING_MAX {
                    break;
                }
                damping = math::max(damping * DAMPING_FACTOR, DAMPING_RAISED);
                continue;
            }
        };
        left |= spots.go_on();
        let spot = &*spots.here;
        damping = math::max(damping / DAMPING_FACTOR, least_damping);
        let is_sure = is_newton && turned <= TURN_SURE && !asks_exactly(task);
        if spot.is_met && (is_sure || (was_met && turned <= TURN_MIN)) {
            break;
        }
        since += 1;
        if spot.shortfall < 0.25 * mark {
            (mark, since) = (spot.shortfall, 0);
        }
        let stalls = !patient && since >= STALL_STEPS && steps - used >= RESTART_STEPS_MIN;
        if stalls && spot.misses_exactly(task) {
            break;
        }
        if left && spot.is_met && spot.cost >= spots.kept.cost {
            break;
        }
    }
    if left && (!spots.here.is_met || spots.kept.cost <= spots.here.cost) {
        core::mem::swap(&mut spots.here, &mut spots.kept);
    }
    used
}

/// What one step, to the next spot, comes to.
struct Step {
    /// The most that a joint turned, in radians.
    turned: f32,
    /// Whether it is a whole step of Newton's method.
    is_newton: bool,
}

/// One step, to the next spot; where it is not worth going, the most that it would turn a joint, in radians.
fn step(
    task: &Task,
    spots: &mut Spots,
    restores: bool,
    climbs: bool,
    damping: f32,
) -> Result<Step, f32> {
    if spots.here.q.len() <= NARROW {
        step_of::<NARROW>(task, spots, restores, climbs, damping)
    } else {
        step_of::<CHAIN_HINGES_MAX>(task, spots, restores, climbs, damping)
    }
}

/// The same by a program for at most `W` joints.
fn step_of<const W: usize>(
    task: &Task,
    spots: &mut Spots,
    restores: bool,
    climbs: bool,
    damping: f32,
) -> Result<Step, f32> {
    let spot = &*spots.here;
    let points = task.used_goals().chunk_by(Goal::is_beside);
    let levers: ArrayVec<Levers, CHAIN_GOALS_MAX> = points
        .map(|beside| beside[0].levers(&spot.placed))
        .collect();
    let mut program = Program::<W>::at(spot);
    program.linearise(task, spot, &levers, restores, damping);
    program.solve(task);
    // What goals that have to be met exactly press with far from them is not what they press with there.
    let along = restores || asks_exactly(task);
    // Away from the goals of pushes, which are the whole task.
    let climbs = climbs && !spot.is_met && !spot.is_soft && !asks_exactly(task);
    let is_newton = program.bend(task, &spot.placed, &levers, along, climbs);
    let angles = program.angles();
    let Some(is_whole) = guarded(task, spots, &angles, program.penalty()) else {
        return Err(most_turned(&spots.here.q, &angles));
    };
    Ok(Step {
        turned: most_turned(&spots.here.q, &spots.next.q),
        is_newton: is_newton && is_whole && !restores,
    })
}

/// Whether anything has to be met to both sides: what is left of that no later frame mends.
fn asks_exactly(task: &Task) -> bool {
    let mut hard = task.used_goals().iter().filter(|goal| goal.is_hard());
    hard.any(|goal| goal.is_exact)
}

fn most_turned(from: &Angles, to: &[f32]) -> f32 {
    let turned = from.iter().zip(to).map(|(a, b)| (a - b).abs());
    turned.fold(0.0, math::max)
}

/// Finds the longest part of the way to a program's angles that is worth going, as the next spot; whether it is all
/// of it.
fn guarded(task: &Task, spots: &mut Spots, to: &Angles, penalty: f32) -> Option<bool> {
    let Spots {
        here, next, aside, ..
    } = spots;
    let most = most_turned(&here.q, to);
    let mut share = if most > TURN_MAX {
        TURN_MAX / most
    } else {
        1.0
    };
    // What ends the search is not halved.
    let halvings = if here.is_met && most <= TURN_MIN {
        0
    } else {
        HALVINGS_MAX
    };
    for _ in 0..=halvings {
        let part = |(a, b): (&f32, &f32)| {
            if share == 1.0 {
                *b
            } else {
                a + (b - a) * share
            }
        };
        let trial = here.q.iter().zip(to).map(part).collect();
        if is_worth(task, here, trial, penalty, next) {
            let lags = !next.is_met && next.shortfall > LAG * here.shortfall;
            let alone = if lags { turned_alone(task, here) } else { None };
            let goes_alone = alone.is_some_and(|q| is_worth(task, next, q, penalty, aside));
            if goes_alone {
                core::mem::swap(next, aside);
            }
            return Some(share == 1.0 && !goes_alone);
        }
        share *= 0.5;
    }
    let alone = turned_alone(task, here)?;
    is_worth(task, here, alone, penalty, next).then_some(false)
}

/// Goes to some angles taken into the limits, from a spot; whether that is worth it.
fn is_worth(task: &Task, from: &Spot, mut q: Angles, penalty: f32, to: &mut Spot) -> bool {
    task.admit(&mut q) && {
        to.go_to(task, q);
        to.betters(from, penalty)
    }
}

/// Angles to begin again from: the middle of the ranges, then two fixed ones in the middle halves.
fn restarted(task: &Task, joints: usize, restart: u32) -> Angles {
    let share = |joint: usize| {
        let place = (restart as usize) * (joint + 1);
        if restart == 0 {
            0.5
        } else {
            // The golden ratio's multiples fill the interval evenly.
            let multiple = place as f32 * 0.618_034;
            0.25 + 0.5 * (multiple - multiple as u32 as f32)
        }
    };
    let widest = core::f32::consts::PI;
    let at = |(joint, hinge): (usize, &crate::geometry::chain::Hinge)| {
        let low = math::clamp(hinge.low_rad, -widest, widest);
        let high = math::clamp(hinge.high_rad, -widest, widest);
        low + (high - low) * share(joint)
    };
    let q: Angles = task
        .hinges
        .iter()
        .take(joints)
        .enumerate()
        .map(at)
        .collect();
    task.start(&q)
}
