//! Planning a leg of a whole skeleton: the root first, then chain by chain, bases before what hangs on
//! them, the deepest first; and once more where a chain asks the root to give way.

use arrayvec::ArrayVec;

use super::limb::{self, Limb, Solved};
use super::root::{self, HalfSpaces};
use super::{Hold, Plan};
use crate::geometry::chain::{BOUNDARY_RAD, limb_at};
use crate::geometry::linkage::angle_at;
use crate::geometry::motion::interpolate;
use crate::limits::{CHAIN_HINGES_MAX, CHAINS_PER_BODY_MAX, GAP_FLOOR_M, GAP_REST_M};
use crate::math;
use crate::state::State;
use crate::state::chains::{
    ChainOptions, ChainReport, End, ball_at, chains_of, cone_slot, joints_of, place_links,
    slot_range,
};
use crate::state::contacts::least_certified;
use crate::state::purse::Purse;
use crate::state::ways::{Position, is_own};

/// How far a chain may swing toward its contact planes between the ends of a leg, in metres: what the
/// rest gap leaves above the floor, less a part for what linear bounds lose.
pub(super) const SWING_M: f32 = 0.6 * (GAP_REST_M - GAP_FLOOR_M);

/// Shortest part of the wanted way that a leg is planned for.
const SHARE_MIN: f32 = 0.05;

/// Whether a chain's links are moved by the root alone.
pub(super) fn goes_with_root(state: &State, chain: usize) -> bool {
    state.ways.held[chain] == 1 || state.chains.options[chain].has(ChainOptions::RIGID)
}

/// Sets the angles at the end of a leg to the wanted ones.
pub(crate) fn propose(state: &mut State, body: usize, leg: usize) {
    set_wanted(state, body, leg);
    place_links(state, body, leg, End::To, Some(leg));
}

/// The same for a leg whose links were placed in this frame: where no angle changes they stay.
fn propose_again(state: &mut State, body: usize, leg: usize) {
    if set_wanted(state, body, leg) {
        place_links(state, body, leg, End::To, Some(leg));
    }
}

/// Whether that changed any angle.
fn set_wanted(state: &mut State, body: usize, leg: usize) -> bool {
    let slot = slot_range(state, leg).start;
    let chains: Chains = chains_of(state, body).collect();
    let mut changed = false;
    for chain in chains {
        for joint in joints_of(state, chain) {
            let wanted = if state.ways.held[chain] == 1 {
                state.ways.from[slot + joint]
            } else {
                state.ways.wanted[joint]
            };
            let to = &mut state.ways.to[slot + joint];
            changed |= to.to_bits() != wanted.to_bits();
            *to = wanted;
        }
    }
    changed
}

/// Sets the angles at the end of a leg to those at its start.
pub(crate) fn stay(state: &mut State, body: usize, leg: usize) {
    let slot = slot_range(state, leg);
    let chains: Chains = chains_of(state, body).collect();
    for chain in chains {
        for joint in joints_of(state, chain) {
            let at = slot.start + joint;
            state.ways.to[at] = state.ways.from[at];
            state.ways.to_link[at] = state.ways.from_link[at];
        }
    }
}

/// The largest share of a leg, no more than `reached`, at which every ball is within its cone: angles
/// between two allowed postures need not be allowed where a cone's edges are not straight in them.
pub(crate) fn within_cones(state: &State, body: usize, leg: usize, reached: f32) -> f32 {
    let mut share = reached;
    for _ in 0..CONE_HALVINGS_MAX {
        if share <= 0.0 || share >= 1.0 || are_within_cones(state, body, leg, share) {
            return share;
        }
        share *= 0.5;
    }
    0.0
}

/// Writes the posture that a body has on its way, with its balls taken into their cones, where it is to be as
/// another leg's; false when there is none within the ranges.
pub(crate) fn bend_into_cones(state: &mut State, body: usize, at: &Position, leg: usize) -> bool {
    let (slot, into) = (
        slot_range(state, at.leg).start,
        slot_range(state, leg).start,
    );
    let chains: Chains = chains_of(state, body).collect();
    let mut all = true;
    for chain in chains {
        let joints = joints_of(state, chain);
        let mut angles: ArrayVec<f32, CHAIN_HINGES_MAX> = joints
            .clone()
            .map(|joint| {
                let at_joint = slot + joint;
                angle_at(state.ways.from[at_joint], state.ways.to[at_joint], at.share)
            })
            .collect();
        for joint in joints.clone() {
            if let Some(ball) = ball_at(state, joint, joints.start) {
                all &= ball.kept_with(&state.joints.hinge[joints.clone()], &mut angles);
            }
        }
        for (joint, angle) in joints.zip(angles) {
            state.ways.from[into + joint] = angle;
            state.ways.to[into + joint] = angle;
        }
    }
    place_links(state, body, leg, End::From, None);
    place_links(state, body, leg, End::To, Some(leg));
    all
}

/// Gives a body the posture of one leg all along another.
pub(crate) fn copy_posture(state: &mut State, body: usize, leg: usize, into: usize) {
    let (slot, into) = (slot_range(state, leg).start, slot_range(state, into).start);
    let chains: Chains = chains_of(state, body).collect();
    for chain in chains {
        for joint in joints_of(state, chain) {
            let (from, to) = (slot + joint, into + joint);
            for angle in [&mut *state.ways.from, &mut *state.ways.to] {
                angle[to] = angle[from];
            }
            for link in [&mut *state.ways.from_link, &mut *state.ways.to_link] {
                link[to] = link[from];
            }
        }
    }
}

/// How often the share of a leg is halved to bring balls into their cones.
const CONE_HALVINGS_MAX: u32 = 10;

/// Whether every ball of a body is within its cone at a share of a leg.
pub(crate) fn are_within_cones(state: &State, body: usize, leg: usize, share: f32) -> bool {
    let slot = slot_range(state, leg).start;
    chains_of(state, body).all(|chain| {
        joints_of(state, chain).all(|joint| {
            let at = slot + joint;
            let angle = |at: usize| angle_at(state.ways.from[at], state.ways.to[at], share);
            let rests = |at: usize| state.ways.from[at] == state.ways.to[at];
            // A ball that does not swing is as near to its cone's edge as it was.
            state.joints.ball[joint] == 0
                || (rests(at) && rests(at + 1))
                || state.joints.cone[cone_slot(joint)]
                    .outside_rad(limb_at(angle(at), angle(at + 1)))
                    <= BOUNDARY_RAD
        })
    })
}

/// Holds the chains of the pair that blocks the way; false when there are none that move.
pub(crate) fn hold_blocked(state: &mut State, pairs: usize) -> bool {
    let Some(index) = least_certified(&state.pairs.list[..pairs]) else {
        return false;
    };
    let pair = state.pairs.list[index];
    let pieces = if is_own(state, &pair) {
        [pair.a, pair.b]
    } else {
        [pair.a, pair.a]
    };
    let mut found = false;
    for piece in pieces {
        if let Some(joint) = state.pieces.link[piece as usize].checked_sub(1) {
            let chain = state.joints.chain[joint as usize] as usize;
            if state.ways.held[chain] == 0 {
                state.ways.held[chain] = 1;
                state.chains.report[chain].flags |= ChainReport::HELD;
                found = true;
            }
        }
    }
    found
}

pub(super) type Chains = ArrayVec<usize, CHAINS_PER_BODY_MAX>;

pub(super) fn plan(
    state: &mut State,
    body: usize,
    pairs: usize,
    at: &Position,
    wanted: &Position,
    hold: Hold,
    steps: &mut Purse,
) -> Plan {
    let mut planner = Planner {
        body,
        pairs,
        at: *at,
        hold,
        share: 1.0,
    };
    let (plan, swing_m) = planner.plan(state, wanted, steps);
    if swing_m <= SWING_M {
        return plan;
    }
    // The swing grows with the square of the way.
    planner.share = math::max(0.9 * math::sqrt(SWING_M / swing_m), SHARE_MIN);
    let part = Position {
        root: interpolate(&at.root, &wanted.root, planner.share),
        local: at.local + (wanted.local - at.local) * planner.share,
        ..*wanted
    };
    planner.plan(state, &part, steps).0
}

struct Planner {
    body: usize,
    pairs: usize,
    at: Position,
    hold: Hold,
    /// Part of the way to the wanted angles.
    share: f32,
}

impl Planner {
    /// The plan, and how far its chains swing toward their planes on the way, in metres.
    fn plan(&self, state: &mut State, wanted: &Position, steps: &mut Purse) -> (Plan, f32) {
        propose_again(state, self.body, self.at.leg);
        let mut missed = HalfSpaces::new();
        let mut plan = self.root(state, wanted, &missed);
        let mut found = self.chains(state, wanted, &plan.goal, steps, &mut missed);
        if !missed.is_empty() && !self.hold.root {
            let none = HalfSpaces::new();
            let planes = core::mem::replace(&mut missed, none);
            plan = self.root(state, wanted, &planes);
            found = self.chains(state, wanted, &plan.goal, steps, &mut missed);
        }
        plan.bent |= found.bent;
        plan.share = self.share;
        (plan, found.swing_m)
    }

    fn root(&self, state: &State, wanted: &Position, missed: &HalfSpaces) -> Plan {
        if self.hold.root {
            let goal = Position {
                root: self.at.root,
                local: self.at.local,
                ..*wanted
            };
            return Plan {
                goal,
                bent: true,
                share: 1.0,
            };
        }
        root::plan(state, self.pairs, &self.at, wanted, self.hold.turn, missed)
    }

    /// Solves the chains for a root. Adds to `missed` what they could not keep out of.
    fn chains(
        &self,
        state: &mut State,
        wanted: &Position,
        goal: &Position,
        steps: &mut Purse,
        missed: &mut HalfSpaces,
    ) -> Solved {
        let mut all = Solved::default();
        let mut left: Chains = chains_of(state, self.body).collect();
        let mut first = true;
        while let Some(place) = next(state, &left) {
            let chain = left.remove(place);
            state.chains.led[chain] = u32::from(first);
            first = false;
            let mut limb = Limb {
                chain,
                pairs: self.pairs,
                at: self.at,
                goal: *goal,
                wanted: *wanted,
                share: self.share,
            };
            let solved = limb::solve(state, &mut limb, steps, missed);
            all.bent |= solved.bent;
            all.swing_m = math::max(all.swing_m, solved.swing_m);
        }
        all
    }
}

/// A chain that was solved first stays first until another is deeper by this factor.
const LEAD: f32 = 1.25;

/// How urgent a chain is: how deep it was when it was last solved, or a number drawn from frame and chain.
fn urgency(state: &State, chain: usize) -> f32 {
    if state.chains.options[chain].has(ChainOptions::SHUFFLED) {
        let seed = state
            .registers
            .frame
            .wrapping_mul(64)
            .wrapping_add(chain as u64);
        return (seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as f32;
    }
    let lead = if state.chains.led[chain] == 1 {
        LEAD
    } else {
        1.0
    };
    lead * state.chains.depth[chain]
}

/// The place in the list of the chain to solve next: of those whose base is solved the most urgent, the
/// first of those that tie.
fn next(state: &State, left: &Chains) -> Option<usize> {
    let is_ready = |chain: usize| {
        let base = state.chains.base[chain].checked_sub(1);
        base.is_none_or(|joint| {
            let under = state.joints.chain[joint as usize] as usize;
            !left.contains(&under)
        })
    };
    let mut best: Option<(usize, f32)> = None;
    for (place, &chain) in left.iter().enumerate() {
        let urgent = urgency(state, chain);
        if is_ready(chain) && best.is_none_or(|(_, most)| urgent > most) {
            best = Some((place, urgent));
        }
    }
    best.map(|(place, _)| place)
}
