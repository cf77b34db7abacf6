//! Writing a log's head and records to a sink.

use arrayvec::ArrayVec;
use bytemuck::Pod;

use super::{FORMAT_VERSION, HEAD_BYTES, MAGIC, Sink};
use crate::memory::header::LAYOUT_VERSION;
use crate::world::World;

/// Bytes that are handed to a sink at once, at least: most records fit.
const BUFFER_BYTES: usize = 256;

/// Takes the bytes of a payload: to count them, or to write them.
pub(crate) trait Put {
    /// Takes bytes as they are.
    fn bytes(&mut self, bytes: &[u8]);
}

impl dyn Put + '_ {
    /// Takes a number, or a struct that is made of words of 4 bytes.
    pub(crate) fn pod<T: Pod>(&mut self, value: &T) {
        const { assert!(align_of::<T>() == 4) };
        for word in bytemuck::bytes_of(value).chunks_exact(4) {
            let mut little = [word[0], word[1], word[2], word[3]];
            if cfg!(target_endian = "big") {
                little.reverse();
            }
            self.bytes(&little);
        }
    }

    /// Takes a list, cut behind the first entry beyond `most`.
    pub(crate) fn list<T: Pod>(&mut self, entries: &[T], most: usize) {
        let entries = &entries[..entries.len().min(most + 1)];
        self.pod(&(entries.len() as u32));
        for entry in entries {
            self.pod(entry);
        }
    }
}

/// FNV-1a of 32 bits (Fowler, Noll and Vo): a byte that changes always changes it.
pub(super) struct Checksum(u32);

impl Checksum {
    pub(super) const fn new() -> Self {
        Self(0x811c_9dc5)
    }

    pub(super) fn bytes(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u32::from(byte)).wrapping_mul(0x0100_0193);
        }
    }

    pub(super) const fn value(&self) -> [u8; 4] {
        self.0.to_le_bytes()
    }
}

/// Counts the bytes of a payload.
struct Count(u64);

impl Put for Count {
    fn bytes(&mut self, bytes: &[u8]) {
        self.0 += bytes.len() as u64;
    }
}

/// Writes to a sink, in pieces that are worth a call.
struct Pen<'s> {
    sink: &'s mut dyn Sink,
    buffer: ArrayVec<u8, BUFFER_BYTES>,
    checksum: Checksum,
}

impl<'s> Pen<'s> {
    fn new(sink: &'s mut dyn Sink) -> Self {
        Self {
            sink,
            buffer: ArrayVec::new(),
            checksum: Checksum::new(),
        }
    }

    fn write(&mut self, bytes: &[u8]) {
        if self.buffer.try_extend_from_slice(bytes).is_ok() {
            return;
        }
        self.flush();
        if self.buffer.try_extend_from_slice(bytes).is_err() {
            self.sink.bytes(bytes);
        }
    }

    fn flush(&mut self) {
        if !self.buffer.is_empty() {
            self.sink.bytes(&self.buffer);
            self.buffer.clear();
        }
    }

    /// Writes the checksum of all before.
    fn end(mut self) {
        let checksum = self.checksum.value();
        self.write(&checksum);
        self.flush();
    }
}

impl Put for Pen<'_> {
    fn bytes(&mut self, bytes: &[u8]) {
        self.checksum.bytes(bytes);
        self.write(bytes);
    }
}

/// A number of 8 bytes as two words.
pub(super) const fn words_of(number: u64) -> [u32; 2] {
    [number as u32, (number >> 32) as u32]
}

/// Writes a record. `put` is called twice, the first time to learn the length.
pub(super) fn record(sink: &mut dyn Sink, kind: u32, put: &impl Fn(&mut dyn Put)) {
    let mut count = Count(0);
    put(&mut count);
    let mut pen = Pen::new(sink);
    let to: &mut dyn Put = &mut pen;
    to.pod(&kind);
    to.pod(&words_of(count.0));
    put(to);
    pen.end();
}

/// Writes the head of a log, and the state.
pub(super) fn head(world: &World, sink: &mut dyn Sink) {
    let mut pen = Pen::new(sink);
    let to: &mut dyn Put = &mut pen;
    to.bytes(&MAGIC);
    to.pod(&[FORMAT_VERSION, LAYOUT_VERSION]);
    to.pod(&world.capacities());
    to.pod(&words_of(world.snapshot_bytes() as u64));
    pen.end();
    world.save_in_pieces(&mut |piece| sink.bytes(piece));
}

const _: () = assert!(HEAD_BYTES == MAGIC.len() + 2 * 4 + 8 * 4 + 8 + 4);
