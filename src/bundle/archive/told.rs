//! How many faults are told: whoever made an archive chooses their number.

use crate::bundle::Fault;

/// Faults that are told one by one.
const TOLD: usize = 100;

/// Faults found: the first are kept, the others counted.
#[derive(Debug, Default)]
pub(super) struct Faults {
    first: Vec<Fault>,
    more: usize,
}

impl Faults {
    pub(super) fn is_empty(&self) -> bool {
        self.first.is_empty()
    }

    pub(super) fn push(&mut self, fault: Fault) {
        if self.first.len() < TOLD {
            self.first.push(fault);
        } else {
            self.more += 1;
        }
    }

    /// Returns `value` where there are no faults, and the faults otherwise.
    pub(super) fn or<T>(self, value: T) -> Result<T, Self> {
        if self.is_empty() { Ok(value) } else { Err(self) }
    }
}

impl Extend<Fault> for Faults {
    fn extend<I: IntoIterator<Item = Fault>>(&mut self, faults: I) {
        faults.into_iter().for_each(|fault| self.push(fault));
    }
}

impl From<Fault> for Faults {
    fn from(fault: Fault) -> Self {
        Self { first: vec![fault], more: 0 }
    }
}

impl From<Faults> for Vec<Fault> {
    fn from(Faults { mut first, more }: Faults) -> Self {
        if more > 0 {
            first.push(Fault::new("(archive)", "no fault", format!("{more} more like these")));
        }
        first
    }
}

/// Returns the first of `faults`, and how many more there are.
pub fn told(faults: Vec<Fault>) -> Vec<Fault> {
    let mut kept = Faults::default();
    kept.extend(faults);
    kept.into()
}
