//! Lists that a host gives as slices, or that lie in a log.

use super::pen::Put;
use super::words::Words;
use crate::math::Pose;

/// What lists are made of.
pub(crate) trait Element: Copy {
    /// Bytes of an element in a log.
    const BYTES: usize;
    /// Writes an element.
    fn put(&self, to: &mut dyn Put);
    /// Reads an element.
    fn read(words: &mut Words) -> Option<Self>;
}

impl Element for u32 {
    const BYTES: usize = 4;

    fn put(&self, to: &mut dyn Put) {
        to.pod(self);
    }

    fn read(words: &mut Words) -> Option<Self> {
        words.pod()
    }
}

impl Element for Pose {
    const BYTES: usize = 28;

    fn put(&self, to: &mut dyn Put) {
        to.pod(self);
    }

    fn read(words: &mut Words) -> Option<Self> {
        words.pod()
    }
}

/// One and a pose, or zero and the pose at the origin.
impl Element for Option<Pose> {
    const BYTES: usize = 32;

    fn put(&self, to: &mut dyn Put) {
        to.pod(&u32::from(self.is_some()));
        to.pod(&self.unwrap_or_default());
    }

    fn read(words: &mut Words) -> Option<Self> {
        let is_known = words.pod::<u32>()? != 0;
        let pose = words.pod()?;
        Some(is_known.then_some(pose))
    }
}

/// A list of the host's, or one that lies in a log, where nothing is aligned.
#[derive(Clone, Copy)]
pub(crate) enum List<'a, T> {
    Given(&'a [T]),
    Recorded(&'a [u8]),
}

impl<'a, T: Element> List<'a, T> {
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Given(entries) => entries.len(),
            Self::Recorded(bytes) => bytes.len() / T::BYTES,
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.len() == 0
    }

    pub(crate) fn get(&self, index: usize) -> Option<T> {
        match self {
            Self::Given(entries) => entries.get(index).copied(),
            Self::Recorded(bytes) => {
                let first = index.checked_mul(T::BYTES)?;
                T::read(&mut Words::new(bytes.get(first..)?))
            }
        }
    }

    pub(crate) fn iter(self) -> impl Iterator<Item = T> + 'a
    where
        T: 'a,
    {
        (0..self.len()).map_while(move |index| self.get(index))
    }

    /// Writes the list, cut behind the first entry beyond `most`.
    pub(crate) fn put(&self, to: &mut dyn Put, most: usize) {
        let count = self.len().min(most.saturating_add(1));
        to.pod(&(count as u32));
        for entry in self.iter().take(count) {
            entry.put(to);
        }
    }

    /// Reads a list, which stays where it is.
    pub(crate) fn read(words: &mut Words<'a>) -> Option<Self> {
        let count = words.pod::<u32>()? as usize;
        let bytes = words.bytes(count.checked_mul(T::BYTES)?)?;
        Some(Self::Recorded(bytes))
    }
}
