//! What a call came to, in a form that can be compared.

use bytemuck::{Pod, Zeroable};

use super::pen::words_of;
use crate::frame::FrameReport;
use crate::memory::{BodyId, ChainId, PieceId, SnapshotError};
use crate::state::materials::Material;
use crate::world::{
    AddBodyError, AddChainError, AddPieceError, BodyError, ChainError, HostedError, JointUse,
    MaterialError, SetJointsError, World,
};

/// What a call came to. Equal calls on equal worlds have equal outcomes.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct Outcome {
    /// Zero when the call was accepted; else its error's place in the error's enum, counted from one.
    pub refusal: u32,
    /// For a frame: the report's flags.
    pub flags: u32,
    value: [u32; 2],
    /// For a frame: units spent on driven bodies.
    pub advance_units: u32,
    /// For a frame: units spent on loose objects.
    pub impulse_units: u32,
    /// For a frame: steps spent on chains.
    pub reach_steps: u32,
    /// For a frame: contacts that the host can read.
    pub contacts: u32,
}

impl Outcome {
    /// What the call gave back: for a frame the hash of the state behind it ([`World::hash`]); an id as its
    /// index plus its generation times 2^32; the bits of a float; for joints whether the root was good, plus
    /// the pieces kept times 2^32.
    #[must_use]
    pub const fn value(&self) -> u64 {
        self.value[0] as u64 | (self.value[1] as u64) << 32
    }

    fn accepted(value: [u32; 2]) -> Self {
        Self {
            value,
            ..Self::default()
        }
    }

    fn refused(refusal: u32) -> Self {
        Self {
            refusal,
            ..Self::default()
        }
    }
}

/// What a call gives back.
pub(crate) trait Told {
    /// The same in a form that can be compared, of a call on this world.
    fn outcome(&self, world: &World) -> Outcome;
}

/// What an accepted call gives back.
trait Value {
    fn words(&self) -> [u32; 2];
}

impl Value for () {
    fn words(&self) -> [u32; 2] {
        [0; 2]
    }
}

impl Value for f32 {
    fn words(&self) -> [u32; 2] {
        [self.to_bits(), 0]
    }
}

impl Value for Material {
    fn words(&self) -> [u32; 2] {
        [self.0, 0]
    }
}

impl Value for JointUse {
    fn words(&self) -> [u32; 2] {
        [u32::from(self.root), self.pieces_kept]
    }
}

macro_rules! ids {
    ($($id:ident),*) => {
        $(impl Value for $id {
            fn words(&self) -> [u32; 2] {
                [self.index1, self.generation]
            }
        })*
    };
}
ids!(BodyId, PieceId, ChainId);

/// Why a call was refused.
trait Refusal {
    /// Its place in its enum, counted from one.
    fn number(&self) -> u32;
}

macro_rules! refusals {
    ($($error:ident),*) => {
        $(impl Refusal for $error {
            fn number(&self) -> u32 {
                *self as u32 + 1
            }
        })*
    };
}
refusals!(
    AddBodyError,
    AddChainError,
    AddPieceError,
    BodyError,
    ChainError,
    MaterialError,
    SetJointsError,
    SnapshotError
);

impl Refusal for HostedError {
    fn number(&self) -> u32 {
        self.error.number()
    }
}

impl<T: Value, E: Refusal> Told for Result<T, E> {
    fn outcome(&self, _: &World) -> Outcome {
        match self {
            Ok(value) => Outcome::accepted(value.words()),
            Err(error) => Outcome::refused(error.number()),
        }
    }
}

impl Told for () {
    fn outcome(&self, _: &World) -> Outcome {
        Outcome::default()
    }
}

impl Told for FrameReport {
    fn outcome(&self, world: &World) -> Outcome {
        Outcome {
            refusal: 0,
            flags: self.flags,
            value: words_of(world.hash()),
            advance_units: self.advance_units,
            impulse_units: self.impulse_units,
            reach_steps: self.reach_steps,
            contacts: self.contacts,
        }
    }
}
