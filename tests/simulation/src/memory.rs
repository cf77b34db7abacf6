//! Memory for worlds.

use palpable::memory::{BLOCK_ALIGNMENT, Capacities};

/// One cache line.
#[repr(C, align(64))]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Line([u8; BLOCK_ALIGNMENT]);

/// A block for a world, aligned as a world needs it.
#[derive(Clone)]
pub struct Block(Vec<Line>);

impl Block {
    /// A zeroed block for these capacities.
    #[must_use]
    pub fn new(capacities: &Capacities) -> Self {
        Self(vec![
            Line([0; BLOCK_ALIGNMENT]);
            capacities.bytes().div_ceil(BLOCK_ALIGNMENT)
        ])
    }

    /// The block's bytes.
    pub fn bytes(&mut self) -> &mut [u8] {
        bytemuck::cast_slice_mut(&mut self.0)
    }
}
