//! Damaged snapshots and blocks: refused by name, or a world that steps.
//!
//! The checksums are no signatures. Who can compute them can forge a state that the kernel would never make,
//! and nothing is promised of that; nor is it of a block whose columns were written to behind its head, which
//! has no checksum of its own. So the damage to a block is to its head alone.
//!
//!     cargo +nightly fuzz run --fuzz-dir tests/fuzz snapshot -- -max_total_time=180
#![no_main]

use libfuzzer_sys::fuzz_target;
use palpable_simulation::damage::damage;
use palpable_simulation::draw::Bytes;

fuzz_target!(|data: &[u8]| damage(&mut Bytes::new(data)).expect("a promise"));
