//! A binary heap over rows that knows where each row is, so that a row can be moved when its key changes.
//!
//! `heap` holds row indices, most urgent first; [`Row::place`] is the way back. Rows with a key of zero are
//! not in it. Cost of a change: the depth of the heap.

use crate::state::rows::Row;

/// How many rows are queued.
pub(super) struct Queue {
    length: usize,
}

/// Whether row `a` goes before row `b`: larger key, then smaller index.
fn before(rows: &[Row], a: u32, b: u32) -> bool {
    let (key_a, key_b) = (rows[a as usize].key, rows[b as usize].key);
    key_a > key_b || (key_a == key_b && a < b)
}

impl Queue {
    /// Queues every row whose key is above zero.
    pub(super) fn build(heap: &mut [u32], rows: &mut [Row]) -> Self {
        let mut length = 0;
        for index in 0..rows.len() {
            if rows[index].key > 0.0 {
                heap[length] = index as u32;
                length += 1;
                rows[index].place = length as u32;
            }
        }
        let queue = Self { length };
        for place in (0..length / 2).rev() {
            queue.sink(heap, rows, place);
        }
        queue
    }

    /// The most urgent row.
    pub(super) fn top(&self, heap: &[u32]) -> Option<usize> {
        (self.length > 0).then(|| heap[0] as usize)
    }

    /// Gives a row a new key, and its place by it; a key of zero takes it out.
    pub(super) fn set(&mut self, heap: &mut [u32], rows: &mut [Row], index: usize, key: f32) {
        let queued = rows[index].place > 0;
        if queued && key == rows[index].key {
            return;
        }
        rows[index].key = key;
        if key > 0.0 {
            if !queued {
                heap[self.length] = index as u32;
                self.length += 1;
                rows[index].place = self.length as u32;
            }
            let place = self.rise(heap, rows, rows[index].place as usize - 1);
            self.sink(heap, rows, place);
        } else if queued {
            self.remove(heap, rows, index);
        }
    }

    fn remove(&mut self, heap: &mut [u32], rows: &mut [Row], index: usize) {
        let place = rows[index].place as usize - 1;
        rows[index].place = 0;
        self.length -= 1;
        if place < self.length {
            put(heap, rows, place, heap[self.length]);
            let place = self.rise(heap, rows, place);
            self.sink(heap, rows, place);
        }
    }

    /// Moves a row up while it goes before its parent; where it ends.
    fn rise(&self, heap: &mut [u32], rows: &mut [Row], mut place: usize) -> usize {
        let row = heap[place];
        while place > 0 {
            let parent = (place - 1) / 2;
            if !before(rows, row, heap[parent]) {
                break;
            }
            put(heap, rows, place, heap[parent]);
            place = parent;
        }
        put(heap, rows, place, row);
        place
    }

    /// Moves a row down while a child goes before it.
    fn sink(&self, heap: &mut [u32], rows: &mut [Row], mut place: usize) {
        let row = heap[place];
        loop {
            let mut child = 2 * place + 1;
            if child >= self.length {
                break;
            }
            if child + 1 < self.length && before(rows, heap[child + 1], heap[child]) {
                child += 1;
            }
            if !before(rows, heap[child], row) {
                break;
            }
            put(heap, rows, place, heap[child]);
            place = child;
        }
        put(heap, rows, place, row);
    }
}

fn put(heap: &mut [u32], rows: &mut [Row], place: usize, row: u32) {
    heap[place] = row;
    rows[row as usize].place = place as u32 + 1;
}
