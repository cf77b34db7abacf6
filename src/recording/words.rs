//! Reading the payload of a record, word by word.

use arrayvec::ArrayVec;
use bytemuck::Pod;

/// What is left of a payload.
pub(crate) struct Words<'l>(&'l [u8]);

impl<'l> Words<'l> {
    pub(crate) const fn new(bytes: &'l [u8]) -> Self {
        Self(bytes)
    }

    /// The next bytes as they are; `None` when there are not as many.
    pub(crate) fn bytes(&mut self, count: usize) -> Option<&'l [u8]> {
        let (bytes, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(bytes)
    }

    /// The next number, or struct that is made of words of 4 bytes.
    pub(crate) fn pod<T: Pod>(&mut self) -> Option<T> {
        const { assert!(align_of::<T>() == 4) };
        let bytes = self.bytes(size_of::<T>())?;
        let mut value = T::zeroed();
        let native = bytemuck::bytes_of_mut(&mut value);
        native.copy_from_slice(bytes);
        if cfg!(target_endian = "big") {
            native.chunks_exact_mut(4).for_each(<[u8]>::reverse);
        }
        Some(value)
    }

    /// The next number of 8 bytes.
    pub(crate) fn long(&mut self) -> Option<u64> {
        let [low, high] = self.pod::<[u32; 2]>()?;
        Some(u64::from(low) | u64::from(high) << 32)
    }

    /// The next list; `None` when it is longer than `N`, which is one more than any that is accepted.
    pub(crate) fn list<T: Pod, const N: usize>(&mut self) -> Option<ArrayVec<T, N>> {
        let mut list = ArrayVec::new();
        for _ in 0..self.pod::<u32>()? {
            list.try_push(self.pod()?).ok()?;
        }
        Some(list)
    }

    /// All that is left.
    pub(crate) fn rest(&mut self) -> &'l [u8] {
        core::mem::take(&mut self.0)
    }

    /// Nothing may be left: a payload is as long as its arguments.
    pub(crate) fn end(&self) -> Option<()> {
        self.0.is_empty().then_some(())
    }
}
