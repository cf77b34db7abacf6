//! 4 reach: a way around the contacts.
//!
//! A body's root is bent along its contact planes; the chains of a skeleton answer with their joint
//! angles, and what a chain cannot evade the root does. Two methods solve a chain, with one interface and
//! one unit of work, a step: the paper's cyclic coordinate descent with mended formulas
//! ([`cyclic_descent`]), and the least deviation from the tracked angles ([`least_deviation`]). A host may
//! call them with goals of its own.

pub mod cyclic_descent;
pub mod goal;
pub mod least_deviation;
mod limb;
mod root;
mod skeleton;
mod touch;

pub(crate) use skeleton::{
    are_within_cones, bend_into_cones, copy_posture, hold_blocked, propose, stay, within_cones,
};

use root::HalfSpaces;

use crate::state::State;
use crate::state::chains::has_chains;
use crate::state::purse::Purse;
use crate::state::ways::Position;

/// Where the next leg goes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plan {
    pub goal: Position,
    /// Contact changed the goal.
    pub bent: bool,
    /// How much of the way to the wanted position the goal stands for: a chain that would swing through
    /// its contact planes on the way goes in parts.
    pub share: f32,
}

/// What is not to change, because it was found to be in the way.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Hold {
    /// The root's turn and the local poses.
    pub turn: bool,
    /// The root altogether.
    pub root: bool,
}

/// Plans the next leg of a driven body that is at `at`. Spends steps of the chains' solvers.
pub(crate) fn plan(
    state: &mut State,
    body: usize,
    pairs: usize,
    at: &Position,
    wanted: &Position,
    hold: Hold,
    steps: &mut Purse,
) -> Plan {
    if has_chains(state, body) {
        skeleton::plan(state, body, pairs, at, wanted, hold, steps)
    } else {
        root::plan(state, pairs, at, wanted, hold.turn, &HalfSpaces::new())
    }
}
