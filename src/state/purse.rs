//! Units of work that a stage may still spend.

/// Units that a stage may still spend.
pub(crate) struct Purse {
    left: u32,
    spent: u32,
}

impl Purse {
    pub(crate) fn new(units: u32) -> Self {
        Self {
            left: units,
            spent: 0,
        }
    }

    /// Takes one unit; false when there is none left.
    pub(crate) fn take(&mut self) -> bool {
        if self.left == 0 {
            return false;
        }
        self.left -= 1;
        self.spent += 1;
        true
    }

    pub(crate) fn spent(&self) -> u32 {
        self.spent
    }
}
