//! Saving a world's state and rolling back to it.

use super::World;
use crate::memory::SnapshotError;
use crate::memory::hash::StateHash;
use crate::memory::header::Header;
use crate::recording::CallKind;

/// The checksum that ends a snapshot.
const CHECKSUM_BYTES: usize = 8;

impl World<'_> {
    /// Bytes of a snapshot: the state without the scratch of a frame.
    #[must_use]
    pub fn snapshot_bytes(&self) -> usize {
        let mut bytes = CHECKSUM_BYTES;
        self.state.visit(&mut |column| bytes += column.len());
        bytes
    }

    /// Copies the state into `buffer`; how many bytes were written.
    ///
    /// # Errors
    /// [`SnapshotError::TooSmall`].
    pub fn save(&self, buffer: &mut [u8]) -> Result<usize, SnapshotError> {
        if buffer.len() < self.snapshot_bytes() {
            return Err(SnapshotError::TooSmall);
        }
        let mut end = 0;
        self.save_in_pieces(&mut |piece| {
            buffer[end..end + piece.len()].copy_from_slice(piece);
            end += piece.len();
        });
        Ok(end)
    }

    /// Hands a snapshot on in pieces, the checksum last.
    pub(crate) fn save_in_pieces(&self, put: &mut impl FnMut(&[u8])) {
        self.state.visit(put);
        put(&self.state.checksum().to_le_bytes());
    }

    /// Rolls back to a snapshot of a world with the same capacities, this one or another. On an
    /// error nothing has changed.
    ///
    /// # Errors
    /// [`SnapshotError`] when the buffer holds no such snapshot.
    pub fn load(&mut self, buffer: &[u8]) -> Result<(), SnapshotError> {
        let looked_at = buffer.len().min(self.snapshot_bytes());
        self.recorded(
            CallKind::Load,
            |to| to.bytes(&buffer[..looked_at]),
            |world| world.take_snapshot(buffer),
        )
    }

    fn take_snapshot(&mut self, buffer: &[u8]) -> Result<(), SnapshotError> {
        let header = Header::read_snapshot(buffer)?;
        if header != *self.state.header {
            return Err(SnapshotError::OtherLayout);
        }
        if buffer.len() < self.snapshot_bytes() {
            return Err(SnapshotError::TooSmall);
        }
        self.check(buffer)?;
        let mut end = 0;
        self.state.visit_mut(&mut |column| {
            column.copy_from_slice(&buffer[end..end + column.len()]);
            end += column.len();
        });
        Ok(())
    }

    /// Whether the columns of a snapshot are what was saved.
    fn check(&self, buffer: &[u8]) -> Result<(), SnapshotError> {
        let mut hash = StateHash::new();
        let mut end = 0;
        self.state.visit(&mut |column| {
            hash.bytes(&buffer[end..end + column.len()]);
            end += column.len();
        });
        if buffer[end..end + CHECKSUM_BYTES] == hash.value().to_le_bytes() {
            Ok(())
        } else {
            Err(SnapshotError::Damaged)
        }
    }
}
