//! What the columns mean. Split by who reads them, not by the thing they belong to.

pub mod bodies;
pub mod chains;
pub mod contacts;
pub mod events;
pub(crate) mod islands;
pub(crate) mod looks;
pub(crate) mod loose;
pub mod materials;
pub mod pieces;
pub(crate) mod purse;
pub mod rows;
pub(crate) mod touches;
pub(crate) mod ways;

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::memory::Capacities;
use crate::memory::columns::{Uncut, column_bytes};
use crate::memory::hash::StateHash;
use crate::memory::header::Header;

use bodies::Bodies;
use chains::{AngleWays, Chains, Joints};
use contacts::{ContactPoints, Pairs};
use events::{Events, EventsNow};
use islands::Islands;
use looks::Looks;
use materials::{BUILT_IN_MATERIALS, Materials};
use pieces::{Pieces, Pools};
use rows::Rows;
use touches::{Touches, TouchesBefore};
use ways::Legs;

/// The few numbers of a world that are not a column.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct Registers {
    /// Frames stepped so far.
    pub frame: u64,
    /// Acceleration of loose bodies, in m/s2.
    pub gravity: Vec3,
    /// One past the highest body slot ever used.
    pub body_slots: u32,
    /// One past the highest piece slot ever used.
    pub piece_slots: u32,
    /// Lanes, faces, edges and loop entries in use.
    pub lanes: u32,
    pub faces: u32,
    pub edges: u32,
    pub loops: u32,
    /// Vertices in use.
    pub vertices: u32,
    /// Materials in use beyond the built-in ones.
    pub materials: u32,
    /// Contacts that the host can read.
    pub contacts: u32,
    /// One while the host may have made overlap: it placed or changed something since the last frame,
    /// or a driven body still overlaps.
    pub disturbed: u32,
    /// One past the highest chain slot ever used.
    pub chain_slots: u32,
    /// Joints in use.
    pub joints: u32,
    /// Driven bodies in use.
    pub driven: u32,
    /// Dynamic and hosted bodies in use.
    pub loose: u32,
    /// Contacts of loose bodies that are remembered.
    pub touches: u32,
    /// Contact events of the last frame.
    pub events: u32,
    /// Pairs of pieces that touch.
    pub touching: u32,
    /// The most that was ever in use at once.
    pub high_water: Capacities,
}

/// All columns of a world.
pub(crate) struct State<'a> {
    pub header: &'a mut Header,
    pub registers: &'a mut Registers,
    pub bodies: Bodies<'a>,
    pub pieces: Pieces<'a>,
    pub pools: Pools<'a>,
    pub materials: Materials<'a>,
    pub contacts: ContactPoints<'a>,
    pub chains: Chains<'a>,
    pub joints: Joints<'a>,
    pub touches: Touches<'a>,
    pub events: Events<'a>,
    pub looks: Looks<'a>,
    /// Scratch of a frame; means nothing between frames.
    pub pairs: Pairs<'a>,
    /// Scratch of a frame; means nothing between frames.
    pub islands: Islands<'a>,
    /// Scratch of a frame; means nothing between frames.
    pub rows: Rows<'a>,
    /// Scratch of a frame; means nothing between frames.
    pub before: TouchesBefore<'a>,
    /// Scratch of a frame; means nothing between frames.
    pub events_now: EventsNow<'a>,
    /// Scratch of a frame; means nothing between frames.
    pub legs: Legs<'a>,
    /// Scratch of a frame; means nothing between frames.
    pub ways: AngleWays<'a>,
}

impl<'a> State<'a> {
    /// Bytes of the block with these capacities, which are within bounds.
    pub(crate) const fn bytes(capacities: &Capacities) -> u64 {
        Self::lasting_bytes(capacities)
            + Pairs::bytes(capacities)
            + Islands::bytes(capacities)
            + Rows::bytes(capacities)
            + TouchesBefore::bytes(capacities)
            + EventsNow::bytes(capacities)
            + Legs::bytes(capacities)
            + AngleWays::bytes(capacities)
    }

    /// Bytes of what outlives a frame, columns one behind the other.
    pub(crate) const fn lasting_bytes(capacities: &Capacities) -> u64 {
        column_bytes(size_of::<Header>(), 1)
            + column_bytes(size_of::<Registers>(), 1)
            + Bodies::bytes(capacities)
            + Pieces::bytes(capacities)
            + Pools::bytes(capacities)
            + Materials::bytes(capacities)
            + ContactPoints::bytes(capacities)
            + Chains::bytes(capacities)
            + Joints::bytes(capacities)
            + Touches::bytes(capacities)
            + Events::bytes(capacities)
            + Looks::bytes(capacities)
    }

    /// Cuts a block that was judged long enough and aligned.
    pub(crate) fn cut(memory: &'a mut [u8], capacities: &Capacities) -> Self {
        let mut uncut = Uncut(memory);
        Self {
            header: &mut uncut.column(1)[0],
            registers: &mut uncut.column(1)[0],
            bodies: Bodies::cut(&mut uncut, capacities),
            pieces: Pieces::cut(&mut uncut, capacities),
            pools: Pools::cut(&mut uncut, capacities),
            materials: Materials::cut(&mut uncut, capacities),
            contacts: ContactPoints::cut(&mut uncut, capacities),
            chains: Chains::cut(&mut uncut, capacities),
            joints: Joints::cut(&mut uncut, capacities),
            touches: Touches::cut(&mut uncut, capacities),
            events: Events::cut(&mut uncut, capacities),
            looks: Looks::cut(&mut uncut, capacities),
            pairs: Pairs::cut(&mut uncut, capacities),
            islands: Islands::cut(&mut uncut, capacities),
            rows: Rows::cut(&mut uncut, capacities),
            before: TouchesBefore::cut(&mut uncut, capacities),
            events_now: EventsNow::cut(&mut uncut, capacities),
            legs: Legs::cut(&mut uncut, capacities),
            ways: AngleWays::cut(&mut uncut, capacities),
        }
    }

    /// Calls `visitor` with every column that outlives a frame, in the order of the block.
    pub(crate) fn visit(&self, visitor: &mut impl FnMut(&[u8])) {
        self.visit_with(self.registers, visitor);
    }

    fn visit_with(&self, registers: &Registers, visitor: &mut impl FnMut(&[u8])) {
        visitor(bytemuck::bytes_of(self.header));
        visitor(bytemuck::bytes_of(registers));
        self.bodies.visit(visitor);
        self.pieces.visit(visitor);
        self.pools.visit(visitor);
        self.materials.visit(visitor);
        self.contacts.visit(visitor);
        self.chains.visit(visitor);
        self.joints.visit(visitor);
        self.touches.visit(visitor);
        self.events.visit(visitor);
        self.looks.visit(visitor);
    }

    /// Calls `visitor` with every column that outlives a frame, for writing.
    pub(crate) fn visit_mut(&mut self, visitor: &mut impl FnMut(&mut [u8])) {
        visitor(bytemuck::bytes_of_mut(self.header));
        visitor(bytemuck::bytes_of_mut(self.registers));
        self.bodies.visit_mut(visitor);
        self.pieces.visit_mut(visitor);
        self.pools.visit_mut(visitor);
        self.materials.visit_mut(visitor);
        self.contacts.visit_mut(visitor);
        self.chains.visit_mut(visitor);
        self.joints.visit_mut(visitor);
        self.touches.visit_mut(visitor);
        self.events.visit_mut(visitor);
        self.looks.visit_mut(visitor);
    }

    /// Materials there is room for, the built-in ones included.
    pub(crate) fn material_stride(&self) -> usize {
        (self.header.capacities.materials + BUILT_IN_MATERIALS) as usize
    }

    /// Hash of everything that outlives a frame but the count of frames, which would hide that
    /// everything rests.
    pub(crate) fn hash(&self) -> u64 {
        let timeless = Registers {
            frame: 0,
            ..*self.registers
        };
        let mut hash = StateHash::new();
        self.visit_with(&timeless, &mut |bytes| hash.bytes(bytes));
        hash.value()
    }

    /// Hash of everything that outlives a frame.
    pub(crate) fn checksum(&self) -> u64 {
        let mut hash = StateHash::new();
        self.visit(&mut |bytes| hash.bytes(bytes));
        hash.value()
    }

    /// Raises the high-water marks of what is in use outside frames.
    pub(crate) fn note_use(&mut self) {
        let registers = &mut *self.registers;
        let mark = &mut registers.high_water;
        mark.bodies = mark.bodies.max(registers.body_slots);
        mark.pieces = mark.pieces.max(registers.piece_slots);
        mark.vertices = mark.vertices.max(registers.vertices);
        mark.materials = mark.materials.max(registers.materials);
        mark.joints = mark.joints.max(registers.joints);
        mark.chains = mark.chains.max(registers.chain_slots);
    }
}
