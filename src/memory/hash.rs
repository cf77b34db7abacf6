//! A 64-bit hash of state. Not for secrets: it tells equal runs from unequal ones.

/// Takes bytes in words of eight, little endian, so that every processor gets the same value.
pub(crate) struct StateHash(u64);

impl StateHash {
    pub(crate) const fn new() -> Self {
        Self(0x9e37_79b9_7f4a_7c15)
    }

    fn word(&mut self, word: u64) {
        let mixed = (self.0 ^ word).wrapping_mul(0xd6e8_feb8_6659_fd93);
        self.0 = mixed ^ (mixed >> 32);
    }

    /// Takes a run of bytes; a last word that is not full is filled up with zeros.
    pub(crate) fn bytes(&mut self, bytes: &[u8]) {
        let mut words = bytes.chunks_exact(8);
        for word in &mut words {
            let mut full = [0; 8];
            full.copy_from_slice(word);
            self.word(u64::from_le_bytes(full));
        }
        let rest = words.remainder();
        if !rest.is_empty() {
            let mut full = [0; 8];
            full[..rest.len()].copy_from_slice(rest);
            self.word(u64::from_le_bytes(full));
        }
        self.word(bytes.len() as u64);
    }

    pub(crate) const fn value(&self) -> u64 {
        self.0
    }
}
