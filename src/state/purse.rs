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

    /// Takes some units, at most those that are left.
    pub(crate) fn spend(&mut self, units: u32) {
        let units = units.min(self.left);
        self.left -= units;
        self.spent += units;
    }

    pub(crate) fn left(&self) -> u32 {
        self.left
    }

    pub(crate) fn spent(&self) -> u32 {
        self.spent
    }
}
