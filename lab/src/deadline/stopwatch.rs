//! Time of frames: of the thread's processor, and by the wall.

use std::time::Instant;

use cpu_time::ThreadTime;
use palpable::frame::FrameReport;

/// How long a frame took, in nanoseconds.
#[derive(Clone, Copy, Debug, Default)]
pub struct Taken {
    /// On the processor.
    pub cpu_ns: u64,
    /// By the wall.
    pub wall_ns: u64,
}

/// Times a frame. The clock's own cost is in it.
pub fn timed(step: impl FnOnce() -> FrameReport) -> (FrameReport, Taken) {
    let wall = Instant::now();
    let begun = ThreadTime::now();
    let report = step();
    let cpu_ns = begun.elapsed().as_nanos() as u64;
    let wall_ns = wall.elapsed().as_nanos() as u64;
    (report, Taken { cpu_ns, wall_ns })
}

/// A loop of arithmetic that touches no memory: what it takes beyond its length is the machine's doing.
#[derive(Clone, Copy, Debug)]
pub struct Loop {
    ns_per_turn: f64,
}

/// Turns of a loop whose length is measured, and how often that is done: the shortest counts.
const TURNS: u64 = 10_000;
const TRIES: usize = 200;

impl Loop {
    /// A loop whose turns are timed on this machine.
    #[must_use]
    pub fn measured() -> Self {
        let shortest = (0..TRIES).map(|_| turn(TURNS)).min().unwrap_or(0);
        Self {
            ns_per_turn: shortest.max(1) as f64 / TURNS as f64,
        }
    }

    /// Runs for so many nanoseconds; what it took on the processor, in nanoseconds.
    #[must_use]
    pub fn run(&self, ns: u64) -> u64 {
        turn((ns as f64 / self.ns_per_turn) as u64)
    }
}

/// The time on the processor of so many turns, in nanoseconds.
fn turn(turns: u64) -> u64 {
    let begun = ThreadTime::now();
    let mut number = 1_u64;
    for _ in 0..turns {
        number = std::hint::black_box(number.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 1);
    }
    std::hint::black_box(number);
    begun.elapsed().as_nanos() as u64
}

/// Memory that is walked through so that a frame finds its own gone from the caches.
pub struct Eviction(Vec<u64>);

/// More than the second level of any processor that a headset or a desktop has.
const EVICTION_BYTES: usize = 8 << 20;

impl Default for Eviction {
    fn default() -> Self {
        Self(vec![1; EVICTION_BYTES / size_of::<u64>()])
    }
}

impl Eviction {
    /// Touches every line.
    pub fn run(&mut self) -> u64 {
        let mut sum = 0;
        for line in self.0.iter_mut().step_by(8) {
            *line = line.wrapping_mul(5).wrapping_add(1);
            sum ^= *line;
        }
        std::hint::black_box(sum)
    }
}
