//! Bytes decide what a host does, call by call and frame by frame; every frame is judged as the simulator
//! judges it.
//!
//!     cargo +nightly fuzz run --fuzz-dir tests/fuzz api -- -max_total_time=180 -max_len=8192
#![no_main]

use libfuzzer_sys::fuzz_target;
use palpable_simulation::draw::Bytes;
use palpable_simulation::play::play;
use palpable_simulation::tally::Tally;

/// Most frames of a scene: bytes that say nothing are used up one by one.
const FRAMES: u32 = 2000;

fuzz_target!(|data: &[u8]| {
    if let Err(finding) = play(&mut Bytes::new(data), FRAMES, &mut Tally::default()) {
        panic!("{finding}");
    }
});
