//! Driven bodies through one frame: the first of the two loops of Schmidl and Lin 2004, figure 3.
//!
//! Measure what touches (3 contacts), plan a leg that stays outside the contact planes (4 reach), go as
//! much of it as is certified clear (5 advance), and again from there, until the body is where its
//! coupling wants it, nothing is gained any more, or the budget is spent.

pub(crate) mod apart;
mod cones;
mod followers;
mod line;
mod settled;
mod snap;

pub(crate) use cones::stop_within_cones;

use glam::Vec3;

use crate::frame::{FrameReport, Spending};
use crate::geometry::linkage::angle_at;
use crate::limits::{
    ADVANCE_UNITS_MAX, GAP_TOUCHING_M, LEGS_MAX, PAIR_MARGIN_M, PLAN_UNITS, ROUNDS_MAX, STILL_M,
    WAY_OUT_ROUNDS_MAX,
};
use crate::math::{self, Pose};
use crate::reach::{self, Hold, Plan};
use crate::state::State;
use crate::state::bodies::{BodyKind, DrivenReport, is_loose};
use crate::state::chains::{
    ChainReport, End, chains_of, has_chains, joints_of, next_chain, place_links, slot_range,
};
use crate::state::contacts::{PairsFull, box_parts};
use crate::state::islands::GiveWay;
use crate::state::looks;
use crate::state::loose;
use crate::state::pieces::{Bounds, PiecesOf};
use crate::state::purse::Purse;
use crate::state::ways::{Leg, Position, comes_to, driven_at, in_world, piece_pose, track};
use crate::{advance, contacts, pairs};
use line::Line;
use snap::snap;

/// Moves every driven body as far as its way is clear. Spends at most the spending's units, one for each
/// distance query, and its steps, one for each of a chain's solver.
///
/// Bodies go one after the other, those first that wait since earlier frames; each keeps out of the others
/// where they are at that time, so that none overlaps another at the end.
pub(crate) fn run(state: &mut State, spending: &Spending, report: &mut FrameReport) {
    if state.registers.driven > 1 {
        look_ahead(state);
    }
    let mut disturbed = 0;
    let mut line = Line::new(spending.focus);
    while let Some(body) = line.next(state) {
        let mut purses = purses(spending, report);
        let is_settled = line.is_as_before && settled::is_settled(state, body);
        let flags = if is_settled {
            settled::repeat(state, body)
        } else {
            state.bodies.settled[body].first_contact = state.registers.contacts;
            let flags = go(state, body, spending.dt_s, &mut purses);
            settled::note(state, body, flags);
            flags
        };
        disturbed |= flags & DrivenReport::OVERLAPS;
        if state.registers.disturbed == 1 {
            // Nobody may have looked yet.
            disturbed |= flags & (DrivenReport::CUT | DrivenReport::POOL_FULL);
        }
        state.bodies.report[body].flags |= flags;
        purses.book(flags, report);
        if chains_cut(state, body) > 0 {
            report.set(FrameReport::REACH_CUT);
        }
        if state.registers.driven > 1 {
            step_ahead(state, body);
        }
    }
    line.end(state, report);
    state.registers.disturbed = u32::from(disturbed != 0);
}

/// Plans the ways of driven bodies anew that loose objects do not get out of the way of: the root as far as
/// the impulses say, and fixed bodies as ever.
pub(crate) fn give_way(state: &mut State, spending: &Spending, report: &mut FrameReport) {
    for body in 0..state.registers.body_slots as usize {
        if state.islands.gives[body].replans == GiveWay::ASKED {
            let mut purses = purses(spending, report);
            let mut flags = yield_once(state, body, &mut purses) | DrivenReport::TOUCHING;
            if meets_another_island(state, body) {
                state.legs.count[body] = 0;
                state.legs.local_share[body] = 0.0;
                flags |= DrivenReport::HELD;
            }
            state.bodies.report[body].flags |= flags;
            state.bodies.settled[body].moved = u32::from(state.legs.count[body] > 0);
            state.bodies.settled[body].is_settled = 0;
            purses.book(flags, report);
            state.islands.gives[body].replans = GiveWay::DONE;
            if state.registers.driven > 1 {
                step_ahead(state, body);
            }
        }
    }
}

/// Whether a way that was planned anew leads to loose bodies that were not near the first one: they sleep, or
/// go through the frame in an island of their own, and do not look out for it. Those that went already may be
/// where impulses took them.
fn meets_another_island(state: &State, body: usize) -> bool {
    let whole = state.legs.whole[body];
    let island = state.islands.label[body];
    state.legs.count[body] > 0
        && (0..state.registers.body_slots as usize).any(|other| {
            is_loose(state, other)
                && state.islands.label[other] != island
                && (state.islands.near[other].overlaps(&whole)
                    || loose::is_in(state, other, &whole))
        })
}

fn yield_once(state: &mut State, body: usize, purses: &mut Purses) -> u32 {
    let start = Position {
        root: state.bodies.pose[body],
        local: 0.0,
        leg: 0,
        share: 0.0,
    };
    let way = state.islands.gives[body].way;
    let planned = driven_at(state.legs.of(body), &start.root, 1.0);
    let holds = state.islands.gives[body].holds == 1;
    let only_moves = planned.root.quat() == start.root.quat()
        && locals_rest(state, body)
        && angles_rest(state, body);
    state.legs.count[body] = 0;
    state.legs.local_share[body] = 0.0;
    if math::length(way) < STILL_M && (holds || only_moves) {
        return DrivenReport::HELD;
    }
    let goal = Position {
        root: Pose::new(
            if holds { start.root } else { planned.root }.quat(),
            in_world(start.root.translation() + way),
        ),
        local: if holds { 0.0 } else { planned.local },
        leg: 0,
        share: 1.0,
    };
    if holds {
        for chain in 0..state.registers.chain_slots as usize {
            let own = state.chains.body[chain] as usize == body;
            state.ways.held[chain] |= u32::from(own);
        }
    }
    let contacts = state.registers.contacts;
    // What was not overlapped at first is by now only by where another driven body was to come to.
    let overlaps = state.bodies.report[body].flags & DrivenReport::OVERLAPS != 0;
    let flags = match walk(state, body, start, goal, overlaps, purses) {
        Ok(flags) => flags,
        Err(PairsFull) => {
            state.legs.count[body] = 0;
            DrivenReport::POOL_FULL | DrivenReport::HELD
        }
    };
    // What the body touches was recorded when it first planned its way.
    state.registers.contacts = contacts;
    flags
}

/// Notes the driven bodies that came to rest on sleeping objects.
pub(crate) fn lean(state: &mut State) {
    for body in 0..state.registers.body_slots as usize {
        let leans = state.bodies.yielding[body].leans == 1 && comes_to(state, body).is_none();
        if leans && state.bodies.settled[body].is_settled == 0 {
            settled::remember(state, body, state.bodies.report[body].flags);
        }
    }
}

/// Takes the units for collecting a body's pairs; false when there are too few.
fn pays_for_pairs(state: &State, body: usize, purse: &mut Purse) -> bool {
    let own = PiecesOf::new(state.pieces.next, state.bodies.first_piece[body]).count();
    let tests = own * state.registers.piece_slots as usize;
    purse.take_parts(2 * own as u32 + box_parts(tests))
}

/// How many chains of a body were left without the steps that they asked for.
fn chains_cut(state: &State, body: usize) -> u32 {
    let is_cut = |&chain: &usize| state.chains.report[chain].flags & ChainReport::CUT != 0;
    chains_of(state, body).filter(is_cut).count() as u32
}

fn clear_chain_reports(state: &mut State, body: usize) {
    let mut next = state.bodies.first_chain[body];
    while let Some(chain) = next.checked_sub(1) {
        state.chains.report[chain as usize] = ChainReport::default();
        next = next_chain(state, chain as usize);
    }
}

/// What is left for one body.
fn purses<'a>(spending: &Spending<'a>, report: &FrameReport) -> Purses<'a> {
    let (account, costs) = (spending.account, &spending.costs);
    let units = spending.budget.advance_units - report.advance_units;
    let steps = spending.budget.reach_steps - report.reach_steps;
    let open = u32::from(!account.was_closed());
    let units = open * units.min(ADVANCE_UNITS_MAX);
    Purses {
        units: Purse::new(account, costs.advance_unit_ns, units),
        steps: Purse::new(account, costs.reach_step_ns, open * steps),
    }
}

/// What one driven body may spend.
struct Purses<'a> {
    units: Purse<'a>,
    steps: Purse<'a>,
}

impl Purses<'_> {
    /// Writes down what was spent and what came of it.
    fn book(&self, flags: u32, report: &mut FrameReport) {
        report.flags |= frame_flags(flags);
        report.advance_units += self.units.spent();
        report.reach_steps += self.steps.spent();
    }
}

/// Driven bodies keep out of each other where they are before the frame.
fn look_ahead(state: &mut State) {
    for piece in 0..state.registers.piece_slots as usize {
        if state.pieces.body_kind[piece] == BodyKind::Driven.code() {
            state.legs.ahead[piece] = state.pieces.world[piece];
            state.legs.ahead_bounds[piece] = state.pieces.bounds[piece];
        }
    }
}

/// Bodies that go later keep out of where this one came to.
fn step_ahead(state: &mut State, body: usize) {
    let reached = driven_at(state.legs.of(body), &state.bodies.pose[body], 1.0);
    place_ahead(state, body, &reached);
}

/// Writes down where a body's pieces come to.
fn place_ahead(state: &mut State, body: usize, at: &Position) {
    let mut next = state.bodies.first_piece[body];
    while let Some(piece) = next.checked_sub(1) {
        let piece = piece as usize;
        let pose = piece_pose(state, piece, at);
        state.legs.ahead[piece] = pose;
        state.legs.ahead_bounds[piece] = Bounds::of(&state.pieces.shape[piece], &pose);
        next = state.pieces.next[piece];
    }
}

/// What the frame's report says of a body's flags.
fn frame_flags(flags: u32) -> u32 {
    let says = |flag: u32, frame: u32| if flags & flag == 0 { 0 } else { frame };
    says(DrivenReport::CUT, FrameReport::ADVANCE_CUT)
        | says(DrivenReport::POOL_FULL, FrameReport::FULL_PAIRS)
        | says(DrivenReport::CONTACTS_FULL, FrameReport::FULL_CONTACTS)
        | says(DrivenReport::OVERLAPS, FrameReport::OVERLAP)
}

/// Plans and walks the legs of one body's way; the flags to report.
fn go(state: &mut State, body: usize, dt_s: f32, purses: &mut Purses) -> u32 {
    clear_chain_reports(state, body);
    let start = Position {
        root: state.bodies.pose[body],
        local: 0.0,
        leg: 0,
        share: 0.0,
    };
    let wanted = Position {
        root: state.legs.wanted[body],
        local: 1.0,
        leg: 0,
        share: 1.0,
    };
    let rests = start.root == wanted.root && locals_rest(state, body) && angles_rest(state, body);
    if rests && state.registers.disturbed == 0 {
        return 0;
    }
    if snap(state, body, dt_s, &mut purses.units) {
        return 0;
    }
    match walk(state, body, start, wanted, true, purses) {
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

fn angles_rest(state: &State, body: usize) -> bool {
    chains_of(state, body)
        .flat_map(|chain| joints_of(state, chain))
        .all(|joint| state.joints.angle[joint] == state.ways.wanted[joint])
}

/// Plans and walks legs; `overlaps` has it look for overlap that the host made, and leave it.
fn walk(
    state: &mut State,
    body: usize,
    start: Position,
    wanted: Position,
    overlaps: bool,
    purses: &mut Purses,
) -> Result<u32, PairsFull> {
    let pairs = look_along(state, body, &start, &wanted)?;
    if pairs == 0 {
        push_leg(state, body, &start, &wanted, 1.0, 1.0);
        return Ok(0);
    }
    let mut walk = Walk::new(body, start, wanted, pairs);
    walk.resume(state, &mut purses.units);
    if overlaps {
        walk.leave_overlap(state, &mut purses.units)?;
    }
    for _ in 0..ROUNDS_MAX {
        let has_room = (state.legs.count[body] as usize) < LEGS_MAX;
        if !has_room || walk.leg(state, purses)? == Next::Done {
            break;
        }
    }
    walk.keep(state, &purses.units);
    pairs::remember(state, walk.pairs);
    if !contacts::record(state, walk.pairs) {
        walk.flags |= DrivenReport::CONTACTS_FULL;
    }
    Ok(walk.flags | held(state, body))
}

/// Collects the pairs of a body's way, its chains going from their angles to the wanted ones.
fn look_along(
    state: &mut State,
    body: usize,
    from: &Position,
    to: &Position,
) -> Result<usize, PairsFull> {
    if has_chains(state, body) {
        reach::propose(state, body, 0);
    }
    pairs::collect_driven(state, body, &track(from, to))
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
    hold: Hold,
    /// The last frame was cut, and what it knew of the gaps counts.
    resumes: bool,
    /// There were too few units for that: it is left to the next frame.
    defers: bool,
}

/// Whether another leg may gain something.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Next {
    Leg,
    Done,
}

impl Walk {
    fn new(body: usize, at: Position, wanted: Position, pairs: usize) -> Self {
        Self {
            body,
            at,
            wanted,
            pairs,
            covered: Cover::between(&at, &wanted),
            flags: 0,
            hold: Hold::default(),
            resumes: false,
            defers: false,
        }
    }

    /// Goes on from what the frame before knew of the gaps, when it was cut.
    fn resume(&mut self, state: &mut State, purse: &mut Purse) {
        if state.looks.count[self.body] == 0 {
            return;
        }
        self.resumes = looks::pays(state, self.body, purse);
        self.defers = !self.resumes;
        if self.resumes {
            looks::recall(state, self.body, self.pairs, &self.at);
        }
    }

    /// Leaves to the next frame what is known of the gaps, when this one was cut.
    fn keep(&self, state: &mut State, purse: &Purse) {
        if (purse.is_closed() || self.resumes) && !self.defers {
            looks::keep(state, self.body, self.pairs, &self.at);
        }
    }

    /// Gets out of overlap that the host made, all at once. Every other turn of a body that waits
    /// goes without the search, for which there may never be enough units: its legs then lead out as far as they
    /// are clear.
    fn leave_overlap(&mut self, state: &mut State, purse: &mut Purse) -> Result<(), PairsFull> {
        let measured = contacts::measure_touching(state, self.pairs, &self.at, purse);
        if !measured || !contacts::overlaps(state, self.pairs) {
            return Ok(());
        }
        self.flags |= DrivenReport::OVERLAPS;
        if state.bodies.waiting[self.body].turns % 2 == 1 {
            return Ok(());
        }
        looks::keep(state, self.body, self.pairs, &self.at);
        if let Some(root) = self.way_out(state, purse)? {
            let bends = has_chains(state, self.body);
            if bends {
                reach::stay(state, self.body, self.at.leg);
            }
            let goal = Position {
                root,
                share: 1.0,
                ..self.at
            };
            self.at = push_leg(state, self.body, &self.at, &goal, 1.0, 1.0);
            self.wanted.leg = self.at.leg;
            if bends {
                reach::propose(state, self.body, self.at.leg);
            }
        }
        self.collect(state, &self.wanted.clone())?;
        if self.resumes || purse.is_closed() {
            looks::recall(state, self.body, self.pairs, &self.at);
        }
        Ok(())
    }

    /// Where the body gets clear of what it overlaps and of whatever else is there; `None` when no such
    /// place was found. Most are found among the few pieces that are as near as the overlap is deep, and are the
    /// nearest of all then. A place among others is looked for again with these, and with those that were too far
    /// away to be paired.
    fn way_out(&mut self, state: &mut State, purse: &mut Purse) -> Result<Option<Pose>, PairsFull> {
        let mut within_m = 2.0 * contacts::depth_m(state, self.pairs) + GAP_TOUCHING_M;
        for _ in 0..WAY_OUT_ROUNDS_MAX {
            let Some(root) = contacts::way_out(state, self.pairs, &self.at, within_m, purse) else {
                return Ok(None);
            };
            within_m = f32::INFINITY;
            // With the angles that it has: on its way out the links stay as they are.
            let goal = Position { root, ..self.at };
            if !self.pays_for_pairs(state, purse) {
                return Ok(None);
            }
            self.collect(state, &goal)?;
            match contacts::is_clear(state, self.pairs, &goal, purse) {
                Some(false) => {}
                clear => return Ok(clear.map(|_| root)),
            }
        }
        Ok(None)
    }

    fn collect(&mut self, state: &mut State, goal: &Position) -> Result<(), PairsFull> {
        self.pairs = pairs::collect_driven(state, self.body, &track(&self.at, goal))?;
        self.covered = Cover::between(&self.at, goal);
        Ok(())
    }

    /// Collects pairs for another way. What is known of them is not lost when frames are short of units.
    fn collect_again(&mut self, state: &mut State, goal: &Position) -> Result<(), PairsFull> {
        if self.resumes {
            looks::keep(state, self.body, self.pairs, &self.at);
        }
        pairs::remember(state, self.pairs);
        self.collect(state, goal)?;
        if self.resumes {
            looks::recall(state, self.body, self.pairs, &self.at);
        }
        Ok(())
    }

    /// Takes the units for collecting pairs once more; false when there are too few.
    fn pays_for_pairs(&mut self, state: &State, purse: &mut Purse) -> bool {
        let paid = pays_for_pairs(state, self.body, purse);
        if !paid {
            self.flags |= DrivenReport::CUT;
        }
        paid
    }

    /// Whether the pairs at hand are all that a leg on which no piece goes farther than `way_m` can meet.
    fn covers(&self, state: &mut State, goal: &Position, way_m: f32) -> bool {
        if !has_chains(state, self.body) {
            return self.covered.holds(&self.at, goal);
        }
        self.covered.reaches(way_m)
            || (self.covered.holds(&self.at, goal)
                && pairs::cover(state, self.body, &track(&self.at, goal)))
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
    fn leg(&mut self, state: &mut State, purses: &mut Purses) -> Result<Next, PairsFull> {
        if !self.measure(state, &mut purses.units) {
            return Ok(Next::Done);
        }
        contacts::mark_touching(state, self.pairs);
        self.wanted.leg = self.at.leg;
        let plan = reach::plan(
            state,
            self.body,
            self.pairs,
            &self.at,
            &self.wanted,
            self.hold,
            &mut purses.steps,
        );
        let way_m = advance::measure_ways(state, self.body, &track(&self.at, &plan.goal));
        if !self.covers(state, &plan.goal, way_m) {
            if !self.pays_for_pairs(state, &mut purses.units) {
                return Ok(Next::Done);
            }
            self.collect_again(state, &plan.goal)?;
            if !self.measure(state, &mut purses.units) {
                return Ok(Next::Done);
            }
        }
        if plan.bent {
            self.flags |= DrivenReport::TOUCHING;
            if !purses.units.take(PLAN_UNITS) {
                self.flags |= DrivenReport::CUT;
                return Ok(Next::Done);
            }
        }
        if plan.bent && way_m < STILL_M {
            return Ok(Next::Done);
        }
        Ok(self.sweep(state, &plan, way_m, &mut purses.units))
    }

    /// Walks a planned leg, on which no piece goes farther than `way_m`, as far as it is clear and worth a step.
    fn sweep(&mut self, state: &mut State, plan: &Plan, way_m: f32, purse: &mut Purse) -> Next {
        let leg = track(&self.at, &plan.goal);
        let mut swept = advance::run(state, self.pairs, &leg, purse);
        if has_chains(state, self.body) {
            swept.reached = reach::within_cones(state, self.body, self.at.leg, swept.reached);
        }
        let taken = swept.reached >= 1.0 || swept.reached * way_m >= STILL_M;
        if taken {
            self.covered.gone_m += way_m;
            let share = plan.share;
            self.at = push_leg(state, self.body, &self.at, &plan.goal, swept.reached, share);
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
        if swept.cut || (swept.reached >= 1.0 && plan.share >= 1.0) {
            return Next::Done;
        }
        if swept.reached < 1.0 {
            self.flags |= DrivenReport::TOUCHING;
            self.hold_what_blocks(state, taken, plan);
        }
        Next::Leg
    }

    /// When a bent leg gained nothing, what blocked it stays as it is from here on.
    fn hold_what_blocks(&mut self, state: &mut State, taken: bool, plan: &Plan) {
        let stuck = !taken && plan.bent;
        if !has_chains(state, self.body) {
            self.hold.turn = stuck;
        } else if stuck && !reach::hold_blocked(state, self.pairs) {
            self.hold.root = self.hold.turn;
            self.hold.turn = true;
        }
    }
}

fn held(state: &State, body: usize) -> u32 {
    if state.legs.count[body] == 0 {
        DrivenReport::HELD
    } else {
        0
    }
}

/// Adds a leg, of which `reached` was found clear, and gives where it ends. Time is shared out as if the
/// body covered each leg's whole length in what was left of the frame; `share` of that for a leg that
/// stands for a part of the way.
fn push_leg(
    state: &mut State,
    body: usize,
    from: &Position,
    goal: &Position,
    reached: f32,
    share: f32,
) -> Position {
    let begun = state.legs.of(body).last().map_or(0.0, |leg| leg.end_time);
    let done = reached * share;
    let leg = Leg {
        from: from.root,
        to: goal.root,
        local_from: from.local,
        local_to: goal.local,
        reached,
        end_time: if done >= 1.0 {
            1.0
        } else {
            begun + (1.0 - begun) * done
        },
    };
    state.legs.push(body, leg);
    let end = leg.at(from.leg, reached);
    state.legs.local_share[body] = end.local;
    hand_over(state, body, from.leg, reached);
    Position {
        leg: from.leg + 1,
        share: 0.0,
        ..end
    }
}

/// Starts the next leg's angles where this one's end.
fn hand_over(state: &mut State, body: usize, leg: usize, reached: f32) {
    if !has_chains(state, body) {
        return;
    }
    let (slot, next) = (
        slot_range(state, leg).start,
        slot_range(state, leg + 1).start,
    );
    let mut chain = state.bodies.first_chain[body];
    while let Some(index) = chain.checked_sub(1) {
        for joint in joints_of(state, index as usize) {
            let (from, to) = (state.ways.from[slot + joint], state.ways.to[slot + joint]);
            state.ways.from[next + joint] = angle_at(from, to, reached);
            state.ways.from_link[next + joint] = state.ways.to_link[slot + joint];
        }
        chain = next_chain(state, index as usize);
    }
    if reached < 1.0 {
        place_links(state, body, leg + 1, End::From, Some(leg));
    }
    reach::stay(state, body, leg + 1);
}

/// Ways for which the pairs at hand are all there can be.
struct Cover {
    low: Vec3,
    high: Vec3,
    /// How far pieces may have gone since the pairs were collected, in metres.
    gone_m: f32,
}

/// Pieces that went no farther than this, in metres, are within the boxes that were paired, which begin around
/// them: the margin, less what rounding may lose.
const COVERED_M: f32 = 0.9 * PAIR_MARGIN_M;

impl Cover {
    fn between(at: &Position, goal: &Position) -> Self {
        let (from, to) = (at.root.translation(), goal.root.translation());
        Self {
            low: math::min_each(from, to) - Vec3::splat(PAIR_MARGIN_M),
            high: math::max_each(from, to) + Vec3::splat(PAIR_MARGIN_M),
            gone_m: 0.0,
        }
    }

    /// Whether the boxes that were paired hold the pieces wherever they go by so much from where they are.
    fn reaches(&self, way_m: f32) -> bool {
        self.gone_m + way_m <= COVERED_M
    }

    /// Whether the boxes that were paired hold this way too: turn and local poses lie between those
    /// that were swept, so only the root's translation can leave them.
    fn holds(&self, at: &Position, goal: &Position) -> bool {
        let inside = |p: Vec3| p.cmpge(self.low).all() && p.cmple(self.high).all();
        inside(at.root.translation()) && inside(goal.root.translation())
    }
}
