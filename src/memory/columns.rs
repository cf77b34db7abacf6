//! Cutting a block into columns.
//!
//! [`columns!`] declares a group of columns once and derives from that list its size in bytes, the
//! cut, and the visit that hashing and snapshots use, so the three can never disagree.

use bytemuck::Pod;

use super::BLOCK_ALIGNMENT;

/// Bytes that a column of `count` elements of `size` bytes takes in the block.
pub(crate) const fn column_bytes(size: usize, count: u32) -> u64 {
    (size as u64 * count as u64).next_multiple_of(BLOCK_ALIGNMENT as u64)
}

/// The part of the block that is not yet cut.
pub(crate) struct Uncut<'a>(pub &'a mut [u8]);

impl<'a> Uncut<'a> {
    /// Cuts the next column off. The block was checked to be long enough and aligned.
    pub(crate) fn column<T: Pod>(&mut self, count: u32) -> &'a mut [T] {
        let used = size_of::<T>() * count as usize;
        let taken = column_bytes(size_of::<T>(), count) as usize;
        let (column, rest) = core::mem::take(&mut self.0).split_at_mut(taken);
        self.0 = rest;
        bytemuck::cast_slice_mut(&mut column[..used])
    }
}

/// Declares a group of columns: `field: [Type; count]`, the count an expression over the capacities.
macro_rules! columns {
    (
        $(#[$meta:meta])*
        $visibility:vis struct $name:ident($capacities:ident) {
            $( $(#[$field_meta:meta])* $field:ident: [$type:ty; $count:expr], )*
        }
    ) => {
        $(#[$meta])*
        $visibility struct $name<'a> {
            $( $(#[$field_meta])* $visibility $field: &'a mut [$type], )*
        }

        impl<'a> $name<'a> {
            /// Bytes that these columns take.
            $visibility const fn bytes($capacities: &$crate::memory::Capacities) -> u64 {
                0 $( + $crate::memory::columns::column_bytes(size_of::<$type>(), $count) )*
            }

            /// Cuts these columns off the block.
            $visibility fn cut(
                uncut: &mut $crate::memory::columns::Uncut<'a>,
                $capacities: &$crate::memory::Capacities,
            ) -> Self {
                Self { $( $field: uncut.column::<$type>($count), )* }
            }

            /// Calls `visitor` with the bytes of each column in turn.
            #[allow(dead_code, reason = "scratch groups are never visited")]
            $visibility fn visit(&self, visitor: &mut impl FnMut(&[u8])) {
                $( visitor(bytemuck::cast_slice(self.$field)); )*
            }

            /// Calls `visitor` with the bytes of each column in turn, for writing.
            #[allow(dead_code, reason = "scratch groups are never visited")]
            $visibility fn visit_mut(&mut self, visitor: &mut impl FnMut(&mut [u8])) {
                $( visitor(bytemuck::cast_slice_mut(self.$field)); )*
            }
        }
    };
}
pub(crate) use columns;
