//! Driven bodies through one frame: the first of the two loops of Schmidl and Lin 2004, figure 3.
//!
//! Measure what touches (3 contacts), plan a leg that stays outside the contact planes (4 reach), go as
//! much of it as is certified clear (5 advance), and again from there, until the body is where its
//! coupling wants it, nothing is gained any more, or the budget is spent.

use glam::Vec3;

use crate::frame::FrameReport;
use crate::geometry::motion::interpolate;
use crate::limits::{ADVANCE_UNITS_MAX, LEGS_MAX, PAIR_MARGIN_M, ROUNDS_MAX, STILL_M};
use crate::math;
use crate::reach::{self, Plan};
use crate::state::State;
use crate::state::bodies::{BodyKind, Coupling, Displacement, DrivenReport, is_body_of};
use crate::state::contacts::PairsFull;
use crate::state::pieces::PiecesOf;
use crate::state::purse::Purse;
use crate::state::ways::{BodyTrack, Leg, Position, piece_motion, track};
use crate::{advance, contacts, pairs};

/// Moves every driven body as far as its way is clear. Spends at most `units`, one for each
/// distance query; what it spent.
pub(crate) fn run(state: &mut State, units: u32, report: &mut FrameReport) -> u32 {
    let mut left = units;
    let mut overlaps = 0;
    for body in 0..state.registers.body_slots as usize {
        if is_body_of(state, body, BodyKind::Driven) {
            let mut purse = Purse::new(left.min(ADVANCE_UNITS_MAX));
            let flags = go(state, body, &mut purse);
            overlaps |= flags & DrivenReport::OVERLAPS;
            state.bodies.report[body].flags |= flags;
            report.flags |= frame_flags(flags);
            left -= purse.spent();
        }
    }
    state.registers.disturbed = u32::from(overlaps != 0);
    units - left
}

/// What the frame's report says of a body's flags.
fn frame_flags(flags: u32) -> u32 {
    let says = |flag: u32, frame: u32| if flags & flag == 0 { 0 } else { frame };
    says(DrivenReport::CUT, FrameReport::ADVANCE_CUT)
        | says(DrivenReport::POOL_FULL, FrameReport::FULL_PAIRS)
        | says(DrivenReport::CONTACTS_FULL, FrameReport::FULL_CONTACTS)
        | says(DrivenReport::OVERLAPS, FrameReport::OVERLAP)
}

/// Puts a detached body at its tracker when its coupling says so and nothing is in the way there.
fn snap(state: &mut State, body: usize, purse: &mut Purse) -> Option<u32> {
    let coupling = state.bodies.coupling[body];
    let away = math::length(state.bodies.displacement[body].offset);
    if coupling.snap != Coupling::SNAP_WHEN_FREE || away <= coupling.divergence_m {
        return None;
    }
    let target = Position {
        root: state.bodies.tracker[body].target,
        local: 1.0,
    };
    let count = pairs::collect_driven(state, body, &track(&target, &target)).ok()?;
    let measured = contacts::measure_touching(state, count, &target, purse);
    let free = measured && !contacts::touches_any(state, count) && !pairs::loose_near(state, body);
    if !free {
        return None;
    }
    state.bodies.displacement[body] = Displacement::default();
    state.legs.wanted[body] = target.root;
    push_leg(state, body, &target, &target, 1.0);
    Some(0)
}

/// Plans and walks the legs of one body's way; the flags to report.
fn go(state: &mut State, body: usize, purse: &mut Purse) -> u32 {
    let start = Position {
        root: state.bodies.pose[body],
        local: 0.0,
    };
    let wanted = Position {
        root: state.legs.wanted[body],
        local: 1.0,
    };
    let rests = start.root == wanted.root && locals_rest(state, body);
    if rests && state.registers.disturbed == 0 {
        return 0;
    }
    if let Some(flags) = snap(state, body, purse) {
        return flags;
    }
    match walk(state, body, start, wanted, purse) {
        Ok(flags) => flags,
        Err(PairsFull) => {
            state.legs.count[body] = 0;
            DrivenReport::POOL_FULL | DrivenReport::HELD
        }
    }
}

fn locals_rest(state: &State, body: usize) -> bool {
    let pieces = &state.pieces;
    PiecesOf::new(pieces.next, state.bodies.first_piece[body])
        .all(|piece| pieces.local[piece] == pieces.local_target[piece])
}

fn walk(
    state: &mut State,
    body: usize,
    start: Position,
    wanted: Position,
    purse: &mut Purse,
) -> Result<u32, PairsFull> {
    let pairs = pairs::collect_driven(state, body, &track(&start, &wanted))?;
    if pairs == 0 {
        push_leg(state, body, &start, &wanted, 1.0);
        return Ok(0);
    }
    let mut walk = Walk {
        body,
        at: start,
        wanted,
        pairs,
        covered: Cover::between(&start, &wanted),
        flags: 0,
        keep_turn: false,
    };
    walk.leave_overlap(state, purse)?;
    for _ in 0..ROUNDS_MAX {
        let has_room = (state.legs.count[body] as usize) < LEGS_MAX;
        if !has_room || walk.leg(state, purse)? == Next::Done {
            break;
        }
    }
    if !contacts::record(state, walk.pairs) {
        walk.flags |= DrivenReport::CONTACTS_FULL;
    }
    Ok(walk.flags | held(state, body))
}

/// A body on its way.
struct Walk {
    body: usize,
    at: Position,
    wanted: Position,
    /// How many pairs there are, and the ways that they suffice for.
    pairs: usize,
    covered: Cover,
    flags: u32,
    /// The turn and the local poses were in the way at once: bend the translation alone.
    keep_turn: bool,
}

/// Whether another leg may gain something.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Next {
    Leg,
    Done,
}

impl Walk {
    /// Gets out of overlap that the host made.
    fn leave_overlap(&mut self, state: &mut State, purse: &mut Purse) -> Result<(), PairsFull> {
        let measured = contacts::measure_touching(state, self.pairs, &self.at, purse);
        if !measured || !contacts::overlaps(state, self.pairs) {
            return Ok(());
        }
        self.flags |= DrivenReport::OVERLAPS;
        if let Some(root) = contacts::way_out(state, self.pairs, &self.at.root, purse) {
            let local = self.at.local;
            self.at = push_leg(state, self.body, &self.at, &Position { root, local }, 1.0);
            self.collect(state, &self.wanted.clone())?;
        }
        Ok(())
    }

    fn collect(&mut self, state: &mut State, goal: &Position) -> Result<(), PairsFull> {
        self.pairs = pairs::collect_driven(state, self.body, &track(&self.at, goal))?;
        self.covered = Cover::between(&self.at, goal);
        Ok(())
    }

    /// Measures what touches where the body is; false when the units ran out.
    fn measure(&mut self, state: &mut State, purse: &mut Purse) -> bool {
        let measured = contacts::measure_touching(state, self.pairs, &self.at, purse);
        if !measured {
            self.flags |= DrivenReport::CUT;
        }
        measured
    }

    /// Plans a leg along the contacts and walks as much of it as is clear.
    fn leg(&mut self, state: &mut State, purse: &mut Purse) -> Result<Next, PairsFull> {
        if !self.measure(state, purse) {
            return Ok(Next::Done);
        }
        contacts::mark_touching(state, self.pairs);
        let plan = reach::plan(state, self.pairs, &self.at, &self.wanted, self.keep_turn);
        if !self.covered.holds(&self.at, &plan.goal) {
            self.collect(state, &plan.goal)?;
            if !self.measure(state, purse) {
                return Ok(Next::Done);
            }
        }
        if plan.bent {
            self.flags |= DrivenReport::TOUCHING;
        }
        Ok(self.sweep(state, &plan, purse))
    }

    /// Walks a planned leg as far as it is clear and worth a step.
    fn sweep(&mut self, state: &mut State, plan: &Plan, purse: &mut Purse) -> Next {
        let leg = track(&self.at, &plan.goal);
        let way = way_m(state, self.body, &leg);
        if plan.bent && way < STILL_M {
            return Next::Done;
        }
        let swept = advance::run(state, self.pairs, &leg, purse);
        let taken = swept.reached >= 1.0 || swept.reached * way >= STILL_M;
        if taken {
            self.at = push_leg(state, self.body, &self.at, &plan.goal, swept.reached);
        }
        advance::carry_over(
            state,
            self.pairs,
            &leg,
            if taken { swept.reached } else { 0.0 },
        );
        if swept.cut {
            self.flags |= DrivenReport::CUT;
        }
        if swept.cut || swept.reached >= 1.0 {
            return Next::Done;
        }
        self.flags |= DrivenReport::TOUCHING;
        self.keep_turn = !taken && plan.bent;
        Next::Leg
    }
}

fn held(state: &State, body: usize) -> u32 {
    if state.legs.count[body] == 0 {
        DrivenReport::HELD
    } else {
        0
    }
}

/// The longest way of any point of the body.
fn way_m(state: &State, body: usize, leg: &BodyTrack) -> f32 {
    let mut way = 0.0;
    for piece in PiecesOf::new(state.pieces.next, state.bodies.first_piece[body]) {
        way = math::max(way, piece_motion(state, piece, leg).way_m());
    }
    way
}

/// Adds a leg and gives where it ends. Time is shared out as if the body covered each leg's whole
/// length in what was left of the frame.
fn push_leg(
    state: &mut State,
    body: usize,
    from: &Position,
    goal: &Position,
    reached: f32,
) -> Position {
    let begun = state.legs.of(body).last().map_or(0.0, |leg| leg.end_time);
    state.legs.push(
        body,
        Leg {
            from: from.root,
            to: goal.root,
            local_from: from.local,
            local_to: goal.local,
            reached,
            end_time: if reached >= 1.0 {
                1.0
            } else {
                begun + (1.0 - begun) * reached
            },
        },
    );
    let local = if reached >= 1.0 {
        goal.local
    } else {
        from.local + (goal.local - from.local) * reached
    };
    state.legs.local_share[body] = local;
    Position {
        root: interpolate(&from.root, &goal.root, reached),
        local,
    }
}

/// Ways for which the pairs at hand are all there can be.
struct Cover {
    low: Vec3,
    high: Vec3,
}

impl Cover {
    fn between(at: &Position, goal: &Position) -> Self {
        let (from, to) = (at.root.translation(), goal.root.translation());
        Self {
            low: math::min_each(from, to) - Vec3::splat(PAIR_MARGIN_M),
            high: math::max_each(from, to) + Vec3::splat(PAIR_MARGIN_M),
        }
    }

    /// Whether the boxes that were paired hold this way too: turn and local poses lie between those
    /// that were swept, so only the root's translation can leave them.
    fn holds(&self, at: &Position, goal: &Position) -> bool {
        let inside = |p: Vec3| p.cmpge(self.low).all() && p.cmple(self.high).all();
        inside(at.root.translation()) && inside(goal.root.translation())
    }
}
