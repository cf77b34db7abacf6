//! 6 impulses: what the loose objects do.
//!
//! Loose bodies move to the end of the frame while driven bodies follow the way that stage 5 found clear.
//! Who may touch whom makes islands, which go through the frame one after the other. Events come in the
//! order of time: impacts are answered at once, forces are found for what is left of the frame,
//! conservative advancement finds how far everybody stays clear with them, everybody moves there, and so
//! on. Speed changes evenly between events, so free fall and sliding are exact.
//!
//! Bodies move between two poses, along ways that can be certified. A stretch ends before a body turns too far for
//! that to be its way, and who is stopped on the way keeps the energy of its own motion. Pairs that no event
//! brings forward wait for the next frame.
//!
//! Where an object cannot get out of the way of a driven body, the driven body gives way: first by the
//! mass of its coupling, in the first event; later in the frame it stops.

mod cluster;
mod energy;
mod forces;
mod gather;
mod giving;
mod islands;
mod line;
mod movers;
mod queue;
mod respond;
mod rest;
pub mod solver;
mod spans;
mod stall;
mod sweep;
mod touch;
mod turning;

use crate::frame::{FrameReport, Spending};
use crate::limits::{CREEP_SHARE, EVENTS_MAX, IMPULSE_UNITS_MAX, STALL_SHARE, STALLS_MAX};
use crate::math;
use crate::state::State;
use crate::state::bodies::{BodyKind, HostedImpulse, Load, is_loose};
use crate::state::contacts::PairsFull;
use crate::state::islands::GiveWay;
use crate::state::purse::Purse;
use glam::Vec3;
use line::Line;
use sweep::Swept;

/// A stretch of an island's frame: shares of the frame, and its length in seconds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stretch {
    pub from: f32,
    pub to: f32,
    pub dt_s: f32,
    /// Whether driven bodies may still plan other ways: in an island's first event.
    pub is_first: bool,
    /// The island's label.
    pub island: u32,
    /// Where its touches begin, and how many there were in the frame before.
    pub first_touch: usize,
    pub touches_before: usize,
}

impl Stretch {
    pub(crate) fn seconds(&self) -> f32 {
        (self.to - self.from) * self.dt_s
    }
}

/// The loose bodies' way through a frame, island by island.
pub(crate) struct Loose<'a> {
    dt_s: f32,
    purse: Purse<'a>,
    line: Line,
    touches_before: usize,
}

/// An island whose first event is solved.
pub(crate) struct Island {
    stretch: Stretch,
    /// How many pairs there are, while they are known.
    pairs: Option<usize>,
    rows: usize,
}

/// Finds the islands of a frame; `None` when nothing is to move.
pub(crate) fn begin<'a>(state: &mut State, spending: &Spending<'a>) -> Option<Loose<'a>> {
    if state.registers.loose == 0 {
        return None;
    }
    for body in 0..state.registers.body_slots as usize {
        state.bodies.hosted[body] = HostedImpulse::default();
        state.islands.gives[body] = GiveWay::default();
    }
    let awake = islands::find(state, spending.dt_s);
    for yielding in state.bodies.yielding.iter_mut() {
        if yielding.leans == 0 {
            yielding.reaction = Vec3::ZERO;
        }
    }
    if !awake {
        return None;
    }
    Some(Loose {
        dt_s: spending.dt_s,
        purse: Purse::new(
            spending.account,
            spending.costs.impulse_unit_ns,
            spending.budget.impulse_units.min(IMPULSE_UNITS_MAX),
        ),
        line: Line::new(state, spending.focus),
        touches_before: touch::begin(state),
    })
}

/// Whether any loose body may move in this frame.
pub(crate) fn is_awake(state: &State) -> bool {
    state.registers.loose > 0
        && (0..state.registers.body_slots as usize)
            .any(|body| is_loose(state, body) && state.bodies.momentum[body].asleep == 0)
}

impl<'a> Loose<'a> {
    /// What units are left.
    pub(crate) fn purse(&mut self) -> &mut Purse<'a> {
        &mut self.purse
    }

    /// Solves the first event of the next island, after which driven bodies may have to plan their ways
    /// again; `None` when all islands are through.
    pub(crate) fn next(&mut self, state: &mut State, report: &mut FrameReport) -> Option<Island> {
        let label = self.line.next(state)?;
        Some(self.first_event(state, label, report))
    }

    fn first_event(&mut self, state: &mut State, label: usize, report: &mut FrameReport) -> Island {
        let stretch = Stretch {
            from: 0.0,
            to: next_break(state, label, 0.0),
            dt_s: self.dt_s,
            is_first: true,
            island: label as u32,
            first_touch: state.registers.touches as usize,
            touches_before: self.touches_before,
        };
        let mut island = Island {
            stretch,
            pairs: None,
            rows: 0,
        };
        line::ration(state, label);
        let begun = sweep::begin(state, stretch.island, &mut self.purse);
        if !begun || !island.solve(state, &mut self.purse, report) {
            island.pairs = None;
        }
        island
    }

    /// Moves an island to the end of the frame.
    pub(crate) fn run(&mut self, state: &mut State, mut island: Island, report: &mut FrameReport) {
        island.stretch.is_first = false;
        if replanned(state, island.stretch.island as usize) && island.pairs.is_some() {
            island.end_at(
                state,
                next_break(state, island.stretch.island as usize, 0.0),
            );
            island.pairs = None;
            if sweep::begin(state, island.stretch.island, &mut self.purse) {
                island.update(state, &mut self.purse, report);
            }
        }
        let time = island.go(state, &mut self.purse, report);
        let label = island.stretch.island as usize;
        if time < 1.0 {
            movers::stop_all(state, label, time);
            report.set(FrameReport::IMPULSES_CUT);
            report.lost_s = math::max(report.lost_s, (1.0 - time) * self.dt_s);
        }
        line::note(state, label, time, report);
        touch::record(state, &island.stretch, report);
        islands::rest(state, &island.stretch);
    }

    /// Ends the frame.
    pub(crate) fn end(self, state: &mut State, report: &mut FrameReport) {
        for load in state.bodies.load.iter_mut() {
            *load = Load::default();
        }
        report.impulse_units = self.purse.spent();
    }
}

/// Whether a driven body of an island planned its way again.
fn replanned(state: &State, island: usize) -> bool {
    crate::state::islands::Members::of(state, island)
        .any(|body| state.islands.gives[body].replans == GiveWay::DONE)
}

impl Island {
    /// Events up to the end of the frame; the share of the frame that was reached.
    fn go(&mut self, state: &mut State, purse: &mut Purse, report: &mut FrameReport) -> f32 {
        let (mut stalls, mut before) = (0, None);
        let full = line::full_events(state, self.stretch.island as usize);
        for event in 0..EVENTS_MAX {
            let from = self.stretch.from;
            self.end_turn(state, stalls);
            let Some(swept) = self.advance(state, purse, report) else {
                return from;
            };
            let time = self.stretch.from;
            if time >= 1.0 {
                return 1.0;
            }
            let blocked = swept.blocked.map(|pair| Self::pieces(state, pair));
            let creeps = blocked.is_some() && blocked == before;
            let least = if creeps { CREEP_SHARE } else { STALL_SHARE };
            stalls = if time - from <= least { stalls + 1 } else { 0 };
            before = blocked;
            let unsure = swept.blocked.is_some_and(|pair| {
                sweep::is_unsure(state, &state.islands.pairs[pair], &self.stretch)
            });
            if unsure {
                stalls = STALLS_MAX + 1;
            }
            if stalls > STALLS_MAX {
                if let Some(blocked) = swept.blocked {
                    stall::answer(state, &self.stretch, blocked, self.rows);
                }
                stalls = 0;
            }
            self.stretch.to = next_break(state, self.stretch.island as usize, time);
            if event >= full {
                self.go_on(state, &swept, time);
                continue;
            }
            touch::forget(state, &self.stretch);
            if !self.solve(state, purse, report) {
                return time;
            }
        }
        self.stretch.from
    }

    /// The pieces of a pair.
    fn pieces(state: &State, pair: usize) -> [u32; 2] {
        let pair = &state.islands.pairs[pair];
        [pair.a, pair.b]
    }

    /// Ends the stretch at a break that came into it, after its event was answered.
    fn end_at(&mut self, state: &mut State, time: f32) {
        if time < self.stretch.to {
            let Stretch { from, to, .. } = self.stretch;
            forces::shorten(state, self.rows, &self.stretch, (time - from) / (to - from));
            self.stretch.to = time;
            islands::aim(state, &self.stretch);
        }
    }

    /// Ends the stretch where the way between its two poses is no longer that of the body that turns most, and
    /// sooner after events that brought nobody forward. Not among driven bodies: they feed energy in and take it
    /// out, and each end is another event of all that they touch.
    fn end_turn(&mut self, state: &mut State, stalls: u32) {
        if giving::has_driven(state, self.stretch.island as usize) {
            return;
        }
        let share = spans::turns_for(state, &self.stretch, stalls);
        if share < 1.0 {
            let Stretch { from, to, .. } = self.stretch;
            self.end_at(state, from + (to - from) * share);
        }
    }

    /// Goes on without answering an event: who blocked the way waits for the next frame, with what speed it
    /// has, and all others keep theirs.
    fn go_on(&mut self, state: &mut State, swept: &Swept, time: f32) {
        if let Some(pair) = swept.blocked {
            movers::wait_blocked(state, pair, time);
        }
        sweep::carry_over(state, self.pairs.unwrap_or_default(), swept.reached);
        self.rows = 0;
        respond::ready(state, &self.stretch);
        islands::note_centres(state, self.stretch.island as usize);
        islands::aim(state, &self.stretch);
    }

    /// Brings the pairs up to what may touch in the stretch; there are none when units or room ran out.
    fn update(&mut self, state: &mut State, purse: &mut Purse, report: &mut FrameReport) {
        if sweep::update(state, &self.stretch, &mut self.pairs, purse) == Err(PairsFull) {
            report.set(FrameReport::FULL_PAIRS);
        }
    }

    /// Finds the contacts at hand and answers them; false when the units ran out or there was no room.
    fn solve(&mut self, state: &mut State, purse: &mut Purse, report: &mut FrameReport) -> bool {
        let stretch = self.stretch;
        islands::note_centres(state, stretch.island as usize);
        respond::ready(state, &stretch);
        islands::aim(state, &stretch);
        self.update(state, purse, report);
        let Some(pairs) = self.pairs else {
            return false;
        };
        let Some(rows) = gather::run(state, pairs, &stretch, purse, report) else {
            self.pairs = None;
            return false;
        };
        self.rows = rows;
        report.impulses += respond::run(state, rows, &stretch, purse);
        islands::aim(state, &stretch);
        true
    }

    /// Moves everybody as far as all stay clear; how far that was, and the pair that ended it if one did. `None`
    /// when nobody could move.
    fn advance(
        &mut self,
        state: &mut State,
        purse: &mut Purse,
        report: &mut FrameReport,
    ) -> Option<Swept> {
        self.pairs?;
        let stretch = self.stretch;
        self.update(state, purse, report);
        let mut swept = sweep::run(state, self.pairs?, &stretch, purse);
        let holds_for = spans::holds_for(state, self.rows, &stretch);
        if swept.reached >= 1.0 || swept.reached > holds_for {
            swept.blocked = None;
        }
        swept.reached = math::min(swept.reached, holds_for);
        touch::note_forces(state, self.rows, &stretch, swept.reached);
        movers::advance(state, &stretch, swept.reached);
        self.stretch.from = if swept.reached >= 1.0 {
            stretch.to
        } else {
            stretch.from + (stretch.to - stretch.from) * swept.reached
        };
        Some(swept)
    }
}

/// The first end of a driven body's leg after `time`, or the end of the frame.
fn next_break(state: &State, island: usize, time: f32) -> f32 {
    let mut next = 1.0;
    for body in crate::state::islands::Members::of(state, island) {
        if state.bodies.kind[body] == BodyKind::Driven.code() {
            for leg in state.legs.of(body) {
                if leg.end_time > time {
                    next = math::min(next, leg.end_time);
                }
            }
        }
    }
    next
}
