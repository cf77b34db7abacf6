//! Points, poses and seeds of any bytes: hulls are made of them and their separation is checked.
//!
//!     cargo +nightly fuzz run --fuzz-dir tests/fuzz geometry -- -max_total_time=180
//!
//! The bytes of a failure, given to `replay` in `tests/fuzz_geometry.rs`, fail with the stable
//! toolchain too.
#![no_main]

#[path = "../../common/separations.rs"]
mod separations;

use std::cell::RefCell;

use arbitrary::Unstructured;
use separations::{Checker, Draw};
use libfuzzer_sys::fuzz_target;

struct Drawn<'b>(Unstructured<'b>);

impl Draw for Drawn<'_> {
    fn word(&mut self) -> u32 {
        self.0.arbitrary().unwrap_or(0)
    }
}

thread_local! {
    static CHECKER: RefCell<Checker> = RefCell::default();
}

fuzz_target!(|data: &[u8]| {
    CHECKER.with_borrow_mut(|checker| checker.check(&mut Drawn(Unstructured::new(data))));
});
