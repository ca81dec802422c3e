//! Collects what is wrong with a manifest, each fault once, at the place it is written.

use super::input::WrittenIn;
use crate::document::{Diagnostic, FaultList, Severity, Tree};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Where a fault stands, its message and its label.
type Told = (Option<(Arc<str>, usize)>, String, String);

/// Faults of one manifest.
pub(super) struct Faults<'a> {
    /// The manifest's tree, overrides included.
    pub(super) tree: &'a Tree,
    list: FaultList,
    /// Where faults stand and what they say, so that each is told once.
    known: BTreeSet<Told>,
}

impl<'a> Faults<'a> {
    pub(super) fn new(tree: &'a Tree) -> Self {
        Self { tree, list: FaultList::default(), known: BTreeSet::new() }
    }

    /// Makes an error at the value that `pointer` names, not yet collected.
    pub(super) fn fault(&self, pointer: &str, message: impl Into<String>) -> Diagnostic {
        if self.is_full() {
            return Diagnostic::placeless(message);
        }
        self.tree.fault(self.tree.place(pointer), message)
    }

    /// Makes an error at the key of the value that `pointer` names, not yet collected.
    pub(super) fn key_fault(&self, pointer: &str, message: impl Into<String>) -> Diagnostic {
        if self.is_full() {
            return Diagnostic::placeless(message);
        }
        self.tree.fault(self.tree.key_place(pointer), message)
    }

    /// Collects an error at a value.
    pub(super) fn at(&mut self, pointer: &str, message: impl Into<String>, label: &str) {
        let fault = self.fault(pointer, message).label(label);
        self.push(fault);
    }

    /// Collects an error at a key.
    pub(super) fn at_key(&mut self, pointer: &str, message: impl Into<String>, label: &str) {
        let fault = self.key_fault(pointer, message).label(label);
        self.push(fault);
    }

    /// Collects a warning at a key.
    pub(super) fn warn_at_key(&mut self, pointer: &str, message: impl Into<String>, label: &str) {
        let fault = if self.list.is_full(Severity::Warning) {
            Diagnostic::placeless(message)
        } else {
            self.key_fault(pointer, message).label(label)
        };
        self.push(fault.warning());
    }

    /// Collects a fault; one that several conditions share is kept once.
    pub(super) fn push(&mut self, fault: Diagnostic) {
        let place =
            fault.place.as_ref().map(|(source, span)| (Arc::clone(&source.name), span.start));
        if self.known.insert((place, fault.message.clone(), fault.label.clone())) {
            self.list.push(fault);
        }
    }

    /// Returns whether a further error is only counted: to look for its place and for what was meant takes longer than
    /// all the rest.
    pub(super) fn is_full(&self) -> bool {
        self.list.is_full(Severity::Error)
    }

    pub(super) fn extend(&mut self, faults: impl IntoIterator<Item = Diagnostic>) {
        for fault in faults {
            self.push(fault);
        }
    }

    /// Returns what a path at `pointer` is relative to.
    pub(super) fn written_in(&self, pointer: &str) -> WrittenIn {
        match self.tree.place(pointer).source {
            0 => WrittenIn::Manifest,
            _ => WrittenIn::CommandLine,
        }
    }

    pub(super) fn any_error(&self) -> bool {
        self.list.any_error()
    }

    /// Returns all faults: those of the manifest in its order, then those of other files.
    pub(super) fn finish(self) -> Vec<Diagnostic> {
        let mut list = self.list.finish();
        let rank = |fault: &Diagnostic| {
            let place = fault.place.as_ref();
            let own = place.and_then(|(source, span)| {
                self.tree.sources.iter().position(|s| s == source).map(|i| (i, span.start))
            });
            own.unwrap_or((usize::MAX, 0))
        };
        list.sort_by_key(rank);
        list
    }
}

/// Returns `pointer` one step further, as RFC 6901 writes it.
pub(super) fn step(pointer: &str, key: &str) -> String {
    format!("{pointer}/{}", key.replace('~', "~0").replace('/', "~1"))
}
