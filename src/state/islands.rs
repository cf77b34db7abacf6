//! Islands: loose bodies, and the driven ones among them, that may touch each other within a frame.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::geometry::motion::Course;
use crate::math::Pose;
use crate::memory::columns::columns;
use crate::state::State;
use crate::state::contacts::Pair;
use crate::state::pieces::Bounds;

/// The label of bodies that are in no island.
pub(crate) const NONE: u32 = u32::MAX;

/// How a driven body gives way to an object that cannot get out of its way.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct GiveWay {
    /// Whether the body's way is to be planned again: one of the constants, or zero.
    pub replans: u32,
    /// One when its turn, its pieces and its links are to stay as they are.
    pub holds: u32,
    /// The root's way through the frame, in metres.
    pub way: Vec3,
}

impl GiveWay {
    /// The way is to be planned again.
    pub(crate) const ASKED: u32 = 1;
    /// It was.
    pub(crate) const DONE: u32 = 2;
}

columns! {
    /// Scratch of the loose bodies' frame.
    pub(crate) struct Islands(capacities) {
        /// The smallest slot among the bodies of an island.
        label: [u32; capacities.bodies],
        /// The next body of the same island, slot plus one.
        next: [u32; capacities.bodies],
        /// One for the smallest slot of an island that went through the frame.
        went: [u32; capacities.bodies],
        /// A box around all that a body may touch within the frame.
        near: [Bounds; capacities.bodies],
        /// Pairs of the island at hand.
        pairs: [Pair; capacities.pairs],
        /// Box around each piece's way, grown.
        swept: [Bounds; capacities.pieces],
        /// How fast a piece moves at the most in a stretch.
        course: [Course; capacities.pieces],
        /// One while that is known.
        has_course: [u32; capacities.pieces],
        /// Where the frame of a body's centre of mass is at the end of the stretch.
        goal: [Pose; capacities.bodies],
        /// Angular momentum at the end of the stretch, in kg m2/s.
        angular: [Vec3; capacities.bodies],
        /// Centre of mass at the start of the stretch.
        centre: [Vec3; capacities.bodies],
        gives: [GiveWay; capacities.bodies],
        /// What rounding took from a loose body's way through the frame so far, in metres.
        rounded: [Vec3; capacities.bodies],
    }
}

/// The bodies of an island.
pub(crate) struct Members<'a> {
    next: &'a [u32],
    current: u32,
}

impl<'a> Members<'a> {
    pub(crate) fn of(state: &'a State, island: usize) -> Self {
        Self {
            next: state.islands.next,
            current: island as u32 + 1,
        }
    }
}

impl Iterator for Members<'_> {
    type Item = usize;

    fn next(&mut self) -> Option<usize> {
        let body = self.current.checked_sub(1)? as usize;
        self.current = self.next[body];
        Some(body)
    }
}
