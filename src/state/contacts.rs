//! Pairs of pieces that may touch within a frame, and the contacts that were found.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::geometry::warm::WarmFeature;
use crate::limits::{BOXES_PER_UNIT, PARTS_PER_UNIT, QUERY_LANES};
use crate::memory::columns::columns;
use crate::memory::ids::PieceId;
use crate::state::State;
use crate::state::pieces::{Bounds, Shape};

/// Two pieces that may touch within this frame.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct Pair {
    /// Piece of the body that moves.
    pub a: u32,
    /// The other piece.
    pub b: u32,
    /// A lower bound of the gap at `gap_time`, less what is lost, in metres.
    pub gap: f32,
    /// What f32 may lose of the gap so far from the origin, in metres.
    pub lost: f32,
    /// Share of the current leg at which `gap` holds.
    pub gap_time: f32,
    /// Share of the current leg that is known to be clear.
    pub clear_until: f32,
    /// Normal of the last plane found between the two, from B into A, in the world; zero if none.
    pub normal: Vec3,
    /// The feature that `normal` came from.
    pub feature: WarmFeature,
    /// Midway between the surfaces where `gap` was measured, in the world.
    pub point: Vec3,
    /// One when the pair bent the current leg.
    pub bends: u32,
    /// The gap at which it did.
    pub bending_gap: f32,
    /// One when `gap` and `normal` were measured at the very pose that the leg starts from.
    pub measured: u32,
    /// One while the pieces come apart after an impact.
    pub bounced: u32,
    /// One when the other piece belongs to another island: it is kept clear of, and nothing more.
    pub foreign: u32,
}

/// A contact that the host can read after a frame.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct ContactPoint {
    /// Piece of the driven or dynamic body.
    pub piece_a: PieceId,
    /// Piece of the other body.
    pub piece_b: PieceId,
    /// Midway between the surfaces, in the world, in metres.
    pub point: [f32; 3],
    /// From B into A, unit length.
    pub normal: [f32; 3],
    /// Signed distance of the surfaces in metres; negative is overlap.
    pub gap_m: f32,
    /// Impulse on A along the normal during the frame, in newton seconds; zero for driven against fixed.
    pub impulse_n_s: f32,
    /// Fastest approach of the surfaces in the frame before an impulse, in m/s; zero for driven against
    /// fixed.
    pub approach_m_s: f32,
    /// Speed of the surfaces along each other, in m/s.
    pub slide_m_s: f32,
}

columns! {
    /// Pairs of the frame: scratch.
    pub(crate) struct Pairs(capacities) {
        list: [Pair; capacities.pairs],
        /// Box around each piece's way through the frame.
        swept: [Bounds; capacities.pieces],
        /// How far any point of each piece goes on a leg, in metres, and how far as its own root sees it;
        /// negative while that is not known.
        way: [f32; capacities.pieces],
        own_way: [f32; capacities.pieces],
        /// Which of its body's pieces each piece is.
        number: [u32; capacities.pieces],
    }
}

/// Units of a distance query between two pieces.
pub(crate) const fn query_units(a: &Shape, b: &Shape) -> u32 {
    1 + (a.lanes + b.lanes) / (QUERY_LANES + 1)
}

/// Parts of a unit for looking through so many pairs, for each of which a box or a way is worked out.
pub(crate) const fn scan_parts(pairs: usize) -> u32 {
    (pairs / 16) as u32
}

/// Parts of a unit for finding the least certified of so many pairs.
pub(crate) const fn choice_parts(pairs: usize) -> u32 {
    (pairs / 128) as u32
}

/// Parts of a unit for so many tests of two boxes.
pub(crate) fn box_parts(tests: usize) -> u32 {
    let per_part = (BOXES_PER_UNIT / PARTS_PER_UNIT) as usize;
    tests.div_ceil(per_part) as u32
}

/// The pair that is certified clear for the shortest time, the first of those that tie.
pub(crate) fn least_certified(pairs: &[Pair]) -> Option<usize> {
    let mut least = 0;
    for (index, pair) in pairs.iter().enumerate() {
        if pair.clear_until < pairs[least].clear_until {
            least = index;
        }
    }
    (!pairs.is_empty()).then_some(least)
}

columns! {
    /// Contacts of the last frame, for the host.
    pub(crate) struct ContactPoints(capacities) {
        list: [ContactPoint; capacities.contacts],
    }
}

/// Adds a contact for the host; false when there is no room.
pub(crate) fn add(state: &mut State, point: ContactPoint) -> bool {
    let count = state.registers.contacts as usize;
    let Some(slot) = state.contacts.list.get_mut(count) else {
        return false;
    };
    *slot = point;
    state.registers.contacts += 1;
    let mark = &mut state.registers.high_water.contacts;
    *mark = (*mark).max(state.registers.contacts);
    true
}

/// There was no room for all pairs: raise [`crate::memory::Capacities::pairs`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PairsFull;

/// Adds a pair of which nothing is known yet.
pub(crate) fn push(
    pairs: &mut [Pair],
    count: &mut usize,
    high_water: &mut u32,
    a: usize,
    b: usize,
) -> Result<(), PairsFull> {
    let slot = pairs.get_mut(*count).ok_or(PairsFull)?;
    *slot = Pair {
        a: a as u32,
        b: b as u32,
        ..Pair::zeroed()
    };
    *count += 1;
    *high_water = (*high_water).max(*count as u32);
    Ok(())
}
