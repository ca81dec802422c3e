//! Collects what is wrong with a manifest, each fault once, at the place it is written.

use super::crossing::Factor;
use super::inputs::WrittenIn;
use crate::document::{Diagnostic, FaultList, Severity, Tree, known_or_near, quoted};
use crate::studies::FactorValue;
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

    /// An error at the value that `pointer` names, not yet collected.
    pub(super) fn fault(&self, pointer: &str, message: impl Into<String>) -> Diagnostic {
        if self.is_full() {
            return Diagnostic::placeless(message);
        }
        self.tree.fault(self.tree.place(pointer), message)
    }

    /// An error at the key of the value that `pointer` names, not yet collected.
    pub(super) fn key_fault(&self, pointer: &str, message: impl Into<String>) -> Diagnostic {
        if self.is_full() {
            return Diagnostic::placeless(message);
        }
        self.tree.fault(self.tree.key_place(pointer), message)
    }

    /// What may have been meant by `word`, for a fault that is told.
    pub(super) fn near(&self, word: &str, known: &[&str]) -> String {
        if self.is_full() { String::new() } else { known_or_near(word, known) }
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

    /// Collects a fault; conditions that share one share its telling.
    pub(super) fn push(&mut self, fault: Diagnostic) {
        let place =
            fault.place.as_ref().map(|(source, span)| (Arc::clone(&source.name), span.start));
        if self.known.insert((place, fault.message.clone(), fault.label.clone())) {
            self.list.push(fault);
        }
    }

    /// Whether a further error is only counted: to look for its place and for what was meant takes longer than all the rest.
    pub(super) fn is_full(&self) -> bool {
        self.list.is_full(Severity::Error)
    }

    pub(super) fn extend(&mut self, faults: impl IntoIterator<Item = Diagnostic>) {
        for fault in faults {
            self.push(fault);
        }
    }

    /// What a path at `pointer` is relative to.
    pub(super) fn written_in(&self, pointer: &str) -> WrittenIn {
        match self.tree.place(pointer).source {
            0 => WrittenIn::Manifest,
            _ => WrittenIn::CommandLine,
        }
    }

    /// Whether `value` is one of the factor `name`; a fault at `pointer` where it is not.
    pub(super) fn check_level(
        &mut self,
        factors: &[Factor],
        name: &str,
        value: &FactorValue,
        pointer: &str,
    ) -> bool {
        let Some(factor) = self.check_factor(factors, name, pointer, true) else { return false };
        if factor.values.contains(&value.0) {
            return true;
        }
        let known: Vec<&str> = factor.values.iter().map(String::as_str).collect();
        let fault = self
            .fault(pointer, format!("`{value}` is not a value of the factor `{name}`"))
            .label("unknown value")
            .help(self.near(&value.0, &known));
        self.push(fault);
        false
    }

    /// The factor `name`; a fault at `pointer` (or its key) where there is none.
    pub(super) fn check_factor<'f>(
        &mut self,
        factors: &'f [Factor],
        name: &str,
        pointer: &str,
        at_key: bool,
    ) -> Option<&'f Factor> {
        let found = factors.iter().find(|factor| factor.name == name);
        if found.is_none() {
            let known: Vec<&str> = factors.iter().map(|f| f.name.as_str()).collect();
            let message = format!("unknown factor `{name}`");
            let fault = if at_key {
                self.key_fault(pointer, message)
            } else {
                self.fault(pointer, message)
            };
            let help = self.near(name, &known);
            self.push(fault.label("not a key of `factors`").help(help));
        }
        found
    }

    /// Faults of a `values` mapping at `pointer` whose keys should be those of `factor`: all of them where it is to be
    /// `complete`.
    pub(super) fn check_levels<'k>(
        &mut self,
        keys: impl IntoIterator<Item = &'k String>,
        factor: &Factor,
        pointer: &str,
        complete: bool,
    ) {
        let known: Vec<&str> = factor.values.iter().map(String::as_str).collect();
        let levels: BTreeSet<&str> = known.iter().copied().collect();
        let (mut written, mut meant) = (BTreeSet::new(), BTreeSet::new());
        for key in keys {
            written.insert(key.as_str());
            if levels.contains(key.as_str()) {
                continue;
            }
            let mut help = String::new();
            if !self.is_full() {
                help = known_or_near(key, &known);
                meant.extend(crate::document::suggestion(key, known.iter().copied()));
            }
            let fault = self
                .key_fault(
                    &step(pointer, key),
                    format!("`{}` is not a value of the factor `{}`", quoted(key), factor.name),
                )
                .label("unknown value")
                .help(help);
            self.push(fault);
        }
        for level in known.iter().filter(|_| complete) {
            // A misspelled value is one fault, not two.
            if !written.contains(level) && !meant.contains(level) {
                let level = quoted(level);
                let message = format!("`{level}`, a value of `{}`, has no entry here", factor.name);
                let fault =
                    self.key_fault(pointer, message).label(format!("expected `{level}: ...`"));
                self.push(fault);
            }
        }
    }

    pub(super) fn any_error(&self) -> bool {
        self.list.any_error()
    }

    /// All faults: those of the manifest in its order, then those of other files.
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

/// `pointer` one step further, as RFC 6901 writes it.
pub(super) fn step(pointer: &str, key: &str) -> String {
    format!("{pointer}/{}", key.replace('~', "~0").replace('/', "~1"))
}
