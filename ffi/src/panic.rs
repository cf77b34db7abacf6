//! No panic crosses into C, and no float environment of C's crosses into the kernel.

use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::environment::Environment;
use crate::status::{PALP_PANICKED, palp_status};

/// What a call came to inside the library; both sides go back to the host as they are.
pub(crate) type Outcome = Result<palp_status, palp_status>;

/// Runs a call and turns a panic into [`PALP_PANICKED`].
///
/// The block behind the call may be half changed after a panic; that is what the status says.
pub(crate) fn guarded(call: impl FnOnce() -> Outcome) -> palp_status {
    guarded_or(PALP_PANICKED, || match call() {
        Ok(status) | Err(status) => status,
    })
}

/// Runs a call that has no status to return; `panicked` instead of a panic.
pub(crate) fn guarded_or<T>(panicked: T, call: impl FnOnce() -> T) -> T {
    let _restored = Environment::standard();
    catch_unwind(AssertUnwindSafe(call)).unwrap_or(panicked)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_a_status() {
        assert_eq!(guarded(|| panic!("as a test")), PALP_PANICKED);
        assert_eq!(guarded_or(7, || panic!("as a test")), 7);
    }

    #[test]
    fn both_outcomes_pass() {
        assert_eq!(guarded(|| Ok(3)), 3);
        assert_eq!(guarded(|| Err(-3)), -3);
    }
}
