//! A frame's time, and what work costs on the host's machine.

use bytemuck::{Pod, Zeroable};

use crate::limits::{BOXES_PER_UNIT, PARTS_PER_UNIT};
use crate::memory::ids::is_alive;
use crate::state::State;
use crate::state::bodies::BodyKind;

/// What work costs on the host's machine, in nanoseconds: measured worst cases with a margin, not
/// guarantees. The lab's `calibrate` measures one.
///
/// A unit's price covers all that the stage does between two units.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct CostTable {
    /// A frame of an empty world.
    pub frame_ns: u32,
    /// Each body, whatever it does.
    pub body_ns: u32,
    /// Each piece, whatever it does.
    pub piece_ns: u32,
    /// Each chain, whatever it does.
    pub chain_ns: u32,
    /// Each [`BOXES_PER_UNIT`] tests of two boxes against each other.
    pub boxes_ns: u32,
    /// A unit of [`super::Budget::advance_units`].
    pub advance_unit_ns: u32,
    /// A unit of [`super::Budget::impulse_units`].
    pub impulse_unit_ns: u32,
    /// A step of [`super::Budget::reach_steps`].
    pub reach_step_ns: u32,
}

/// How long a frame may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Deadline {
    /// From the start of the step to its end, in nanoseconds. The frame's floor is paid first, see
    /// [`crate::world::World::floor_ns`]; driven bodies have the rest but for a quarter that is kept for
    /// awake loose bodies, which have what is left then.
    pub time_ns: u64,
    /// What work costs.
    pub costs: CostTable,
}

/// What is in a world, as far as a frame pays for it whatever happens.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Census {
    /// Bodies in use.
    pub bodies: u32,
    /// Pieces in use.
    pub pieces: u32,
    /// Driven bodies.
    pub driven: u32,
    /// Pieces of driven bodies.
    pub driven_pieces: u32,
    /// Dynamic and hosted bodies.
    pub loose: u32,
    /// Chains in use.
    pub chains: u32,
}

impl Census {
    /// Counts. Cost: a pass over bodies, pieces and chains.
    pub(crate) fn of(state: &State) -> Self {
        let mut census = Self {
            driven: state.registers.driven,
            loose: state.registers.loose,
            ..Self::default()
        };
        for body in 0..state.registers.body_slots as usize {
            census.bodies += u32::from(is_alive(state.bodies.generation[body]));
        }
        let driven = BodyKind::Driven.code();
        for &kind in &state.pieces.body_kind[..state.registers.piece_slots as usize] {
            census.pieces += u32::from(kind != 0);
            census.driven_pieces += u32::from(kind == driven);
        }
        for chain in 0..state.registers.chain_slots as usize {
            census.chains += u32::from(is_alive(state.chains.generation[chain]));
        }
        census
    }

    /// Most tests of two boxes that a frame makes whatever happens: every driven piece against all, loose bodies
    /// against bodies, to find the islands, and those for who stays behind.
    #[must_use]
    pub fn box_tests(&self) -> u64 {
        let [bodies, pieces, loose] = [self.bodies, self.pieces, self.loose].map(u64::from);
        u64::from(self.driven_pieces) * pieces + 2 * loose * bodies + self.stray_tests()
    }

    /// Most tests of two boxes for which driven bodies stay behind, where loose ones stopped some and the units ran
    /// out: as many as take all driven pieces against each other.
    pub(crate) fn stray_tests(&self) -> u64 {
        if self.loose > 0 && self.driven > 1 {
            u64::from(self.driven_pieces) * u64::from(self.driven_pieces)
        } else {
            0
        }
    }
}

impl CostTable {
    /// The price of what a frame does whatever happens.
    #[must_use]
    pub fn floor_ns(&self, census: &Census) -> u64 {
        let of = |price: u32, count: u32| u64::from(price) * u64::from(count);
        let boxes = census.box_tests().div_ceil(u64::from(BOXES_PER_UNIT));
        u64::from(self.frame_ns)
            + of(self.body_ns, census.bodies)
            + of(self.piece_ns, census.pieces)
            + of(self.chain_ns, census.chains)
            + u64::from(self.boxes_ns) * boxes
    }

    /// The price of a frame that spends all of a budget.
    #[must_use]
    pub fn worst_ns(&self, census: &Census, budget: &super::Budget) -> u64 {
        let of = |price: u32, count: u32| u64::from(price) * u64::from(count);
        self.floor_ns(census)
            .saturating_add(of(self.advance_unit_ns, budget.advance_units))
            .saturating_add(of(self.impulse_unit_ns, budget.impulse_units))
            .saturating_add(of(self.reach_step_ns, budget.reach_steps))
    }
}

const _: () = assert!(BOXES_PER_UNIT.is_multiple_of(PARTS_PER_UNIT));
