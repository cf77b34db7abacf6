//! Names for things in a world. Zero names nothing, and a name outlives what it names without harm.

use bytemuck::{Pod, Zeroable};

macro_rules! id {
    ($(#[$meta:meta])* $name:ident) => {
        $(#[$meta])*
        ///
        /// All zeros is null. After the thing is removed, the id is stale and refused.
        #[repr(C)]
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Pod, Zeroable)]
        pub struct $name {
            /// Index of the slot plus one; zero is null.
            pub index1: u32,
            /// How often the slot has been used; odd while it is in use.
            pub generation: u32,
        }

        impl $name {
            /// Names nothing.
            pub const NULL: Self = Self { index1: 0, generation: 0 };

            pub(crate) const fn new(index: usize, generation: u32) -> Self {
                Self { index1: index as u32 + 1, generation }
            }

            /// The slot's index if the id is alive among slots with these generations.
            pub(crate) fn find(self, generations: &[u32]) -> Option<usize> {
                let index = self.index1.checked_sub(1)? as usize;
                let alive = is_alive(self.generation) && *generations.get(index)? == self.generation;
                alive.then_some(index)
            }
        }
    };
}

id! {
    /// Names a body of a world.
    BodyId
}
id! {
    /// Names a piece of a body.
    PieceId
}
id! {
    /// Names a chain of joints of a body.
    ChainId
}

/// Whether a slot of this generation is in use.
#[inline]
pub(crate) const fn is_alive(generation: u32) -> bool {
    generation & 1 == 1
}

/// The lowest slot that is not in use.
pub(crate) fn free_slot(generations: &[u32]) -> Option<usize> {
    generations
        .iter()
        .position(|&generation| !is_alive(generation))
}
