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
