//! Faults as a check finds them, not yet tied to their source.

use crate::document::MOST_FAULTS;
use crate::document::node::Place;
use std::collections::BTreeSet;

/// Faults in the order of the reading: the first ones, and how many there are.
#[derive(Default)]
pub(super) struct Faults {
    pub(super) list: Vec<Fault>,
    /// Places of unknown keys: one is met as often as there are choices around it.
    pub(super) unknown: BTreeSet<Place>,
    /// How many faults there are but for unknown keys.
    pub(super) others: usize,
}

impl Faults {
    pub(super) fn count(&self) -> usize {
        self.others + self.unknown.len()
    }

    /// Returns whether a further fault is only counted: to put it into words could take longer than all the rest.
    pub(super) fn is_full(&self) -> bool {
        self.list.len() >= MOST_FAULTS
    }

    /// Takes the fault that `made` puts into words, or counts it.
    pub(super) fn push(&mut self, made: impl FnOnce() -> Fault) {
        self.others += 1;
        self.tell(made);
    }

    /// Collects the fault of an unknown key at `place`, once for each place.
    pub(super) fn push_unknown(&mut self, place: Place, made: impl FnOnce() -> Fault) {
        if self.unknown.insert(place) {
            self.tell(made);
        }
    }

    pub(super) fn tell(&mut self, made: impl FnOnce() -> Fault) {
        if !self.is_full() {
            self.list.push(made());
        }
    }

    /// Takes what another reading of a part found.
    pub(super) fn append(&mut self, mut found: Self) {
        self.others += found.others;
        let told = self.unknown.clone();
        self.unknown.append(&mut found.unknown);
        let room = MOST_FAULTS.saturating_sub(self.list.len());
        let fresh = found.list.into_iter().filter(|fault| !told.contains(&fault.place));
        self.list.extend(fresh.take(room));
    }
}

/// A fault that is not yet tied to its source.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Fault {
    pub(super) place: Place,
    pub(super) message: String,
    pub(super) label: String,
    pub(super) help: Option<String>,
}

impl Fault {
    pub(super) fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    pub(super) fn at(mut self, place: Place) -> Self {
        self.place = place;
        self
    }
}
