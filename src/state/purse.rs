//! Units of work that a stage may still spend, and the time that the frame has for them.

use core::cell::Cell;

use crate::limits::PARTS_PER_UNIT;

/// What is left of a frame's time by the prices of a cost table, and the host's clock as a backstop.
///
/// Time by prices is arithmetic, so it ends at the same unit on every machine. A clock does not, and what
/// it cut is replayed from the units that were spent. For that, whatever was refused once is refused for
/// the rest of the stage.
pub(crate) struct Account<'a> {
    left_ns: Cell<u64>,
    /// Kept back for the stage to come.
    kept_ns: Cell<u64>,
    clock: Option<&'a dyn Fn() -> u64>,
    ends_ns: u64,
    is_closed: Cell<bool>,
    was_closed: Cell<bool>,
    is_short: Cell<bool>,
    is_late: Cell<bool>,
}

impl<'a> Account<'a> {
    /// So many nanoseconds by prices; `u64::MAX` for a frame without a deadline. A clock is asked before
    /// all units whether they would by their price be over before `ends_ns`.
    pub(crate) fn new(left_ns: u64, clock: Option<&'a dyn Fn() -> u64>, ends_ns: u64) -> Self {
        Self {
            left_ns: Cell::new(left_ns),
            kept_ns: Cell::new(0),
            clock,
            ends_ns,
            is_closed: Cell::new(false),
            was_closed: Cell::new(false),
            is_short: Cell::new(false),
            is_late: Cell::new(false),
        }
    }

    /// Keeps one part in `share` of what is left for the stage to come.
    pub(crate) fn keep_back(&self, share: u64) {
        self.kept_ns.set(self.left_ns.get() / share);
    }

    /// The next stage begins.
    pub(crate) fn next_stage(&self) {
        self.kept_ns.set(0);
        self.was_closed.set(self.is_closed.get());
        self.is_closed.set(self.is_late.get());
    }

    fn pay(&self, ns: u64) -> bool {
        if self.is_closed.get() {
            return false;
        }
        if self
            .clock
            .is_some_and(|clock| clock().saturating_add(ns) >= self.ends_ns)
        {
            self.is_late.set(true);
            self.is_closed.set(true);
            return false;
        }
        let left = self.left_ns.get();
        if left.saturating_sub(self.kept_ns.get()) < ns {
            self.is_short.set(true);
            self.is_closed.set(true);
            return false;
        }
        self.left_ns.set(left - ns);
        true
    }

    /// Whether prices or the clock ended the work of the stage before. What it left is not taken up again
    /// in the same frame: it could not be told from the units where it ended.
    pub(crate) fn was_closed(&self) -> bool {
        self.was_closed.get()
    }

    /// Whether prices ended work early.
    pub(crate) fn is_short(&self) -> bool {
        self.is_short.get()
    }

    /// Whether the clock ended it.
    pub(crate) fn is_late(&self) -> bool {
        self.is_late.get()
    }
}

/// Units that a stage may still spend.
///
/// Once it was asked for more than there is, it is closed: as many units as were spent then lead to the
/// same end, whatever the limit was.
pub(crate) struct Purse<'a> {
    account: &'a Account<'a>,
    price_ns: u32,
    left: u32,
    spent: u32,
    /// What is left of the last unit that was taken in parts.
    parts: u32,
    is_closed: bool,
}

impl<'a> Purse<'a> {
    /// So many units at a price each.
    pub(crate) fn new(account: &'a Account<'a>, price_ns: u32, units: u32) -> Self {
        Self {
            account,
            price_ns,
            left: units,
            spent: 0,
            parts: 0,
            is_closed: false,
        }
    }

    /// Takes some units, all or none; false when there are too few, from then on for ever.
    pub(crate) fn take(&mut self, units: u32) -> bool {
        let ns = u64::from(self.price_ns) * u64::from(units);
        let taken = !self.is_closed && units <= self.left && self.account.pay(ns);
        if taken {
            self.left -= units;
            self.spent += units;
        } else {
            self.is_closed = true;
        }
        taken
    }

    /// Takes parts of a unit, of which [`PARTS_PER_UNIT`] make one, all or none.
    pub(crate) fn take_parts(&mut self, parts: u32) -> bool {
        let missing = parts.saturating_sub(self.parts);
        let units = missing.div_ceil(PARTS_PER_UNIT);
        if units > 0 && !self.take(units) {
            return false;
        }
        self.parts = self.parts + units * PARTS_PER_UNIT - parts;
        true
    }

    pub(crate) fn spent(&self) -> u32 {
        self.spent
    }

    /// Whether anything was refused.
    pub(crate) fn is_closed(&self) -> bool {
        self.is_closed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_a_unit_are_used_up_before_the_next_is_taken() {
        let account = Account::new(u64::MAX, None, u64::MAX);
        let mut purse = Purse::new(&account, 1, 2);
        for _ in 0..2 * PARTS_PER_UNIT {
            assert!(purse.take_parts(1));
        }
        assert_eq!(purse.spent(), 2);
        assert!(!purse.take_parts(1));
    }

    #[test]
    fn what_was_refused_once_is_refused_for_the_rest_of_the_stage() {
        let account = Account::new(100, None, u64::MAX);
        let mut dear = Purse::new(&account, 60, 9);
        let mut cheap = Purse::new(&account, 1, 9);
        assert!(dear.take(1));
        assert!(!dear.take(1));
        assert!(!cheap.take(1));
        account.next_stage();
        assert!(Purse::new(&account, 1, 9).take(9));
        assert!(!cheap.take(1), "a closed purse stays closed");
    }

    #[test]
    fn what_is_kept_back_is_there_for_the_next_stage() {
        let account = Account::new(100, None, u64::MAX);
        account.keep_back(4);
        let mut first = Purse::new(&account, 5, 99);
        while first.take(1) {}
        assert_eq!(first.spent(), 15);
        account.next_stage();
        let mut second = Purse::new(&account, 5, 99);
        while second.take(1) {}
        assert_eq!(second.spent(), 5);
    }

    #[test]
    fn a_late_frame_stays_late() {
        let now = Cell::new(0);
        let clock = || {
            now.set(now.get() + 1);
            now.get()
        };
        let account = Account::new(u64::MAX, Some(&clock), 4);
        let mut purse = Purse::new(&account, 0, 99);
        while purse.take(1) {}
        assert_eq!(purse.spent(), 3);
        account.next_stage();
        assert!(account.was_closed() && account.is_late() && !account.is_short());
    }

    #[test]
    fn units_that_would_not_be_over_in_time_are_not_begun() {
        let clock = || 40;
        let account = Account::new(u64::MAX, Some(&clock), 100);
        let mut purse = Purse::new(&account, 10, 99);
        assert!(purse.take(5));
        assert!(!purse.take(6), "they would be over at the end");
        assert_eq!(purse.spent(), 5);
        assert!(account.is_late());
    }
}
