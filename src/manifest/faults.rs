//! Collects what is wrong with a manifest, each fault once, at the place it is written.

use super::crossing::{Factor, known_or_near};
use super::inputs::WrittenIn;
use crate::document::{Diagnostic, Severity, Tree};
use crate::studies::FactorValue;

/// Faults of one manifest.
pub(super) struct Faults<'a> {
    /// The manifest's tree, overrides included.
    pub(super) tree: &'a Tree,
    list: Vec<Diagnostic>,
}

impl<'a> Faults<'a> {
    pub(super) fn new(tree: &'a Tree) -> Self {
        Self { tree, list: Vec::new() }
    }

    /// An error at the value that `pointer` names, not yet collected.
    pub(super) fn fault(&self, pointer: &str, message: impl Into<String>) -> Diagnostic {
        if self.is_full() {
            // It is only counted: to look for its place would take time that grows with the manifest.
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

    /// Collects a fault; conditions that share one share its telling.
    pub(super) fn push(&mut self, fault: Diagnostic) {
        if !self.list.contains(&fault) {
            self.list.push(fault);
        }
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
        let known: Vec<&str> = factor.values.iter().map(String::as_str).collect();
        if known.contains(&value.0.as_str()) {
            return true;
        }
        let fault = self
            .fault(pointer, format!("`{value}` is not a value of the factor `{name}`"))
            .label("unknown value")
            .help(known_or_near(&value.0, &known));
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
            self.push(fault.label("not a key of `factors`").help(known_or_near(name, &known)));
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
        let mut written = Vec::new();
        let mut meant = Vec::new();
        for key in keys {
            written.push(key.as_str());
            if known.contains(&key.as_str()) {
                continue;
            }
            let help = known_or_near(key, &known);
            meant.extend(crate::document::suggestion(key, known.iter().copied()));
            let fault = self
                .key_fault(
                    &step(pointer, key),
                    format!("`{key}` is not a value of the factor `{}`", factor.name),
                )
                .label("unknown value")
                .help(help);
            self.push(fault);
        }
        for level in known.iter().filter(|_| complete) {
            // A misspelled value is one fault, not two.
            if !written.contains(level) && !meant.contains(level) {
                let message = format!("`{level}`, a value of `{}`, has no entry here", factor.name);
                let fault =
                    self.key_fault(pointer, message).label(format!("expected `{level}: ...`"));
                self.push(fault);
            }
        }
    }

    pub(super) fn any_error(&self) -> bool {
        self.list.iter().any(|fault| fault.severity == Severity::Error)
    }

    /// All faults: those of the manifest in its order, then those of other files.
    pub(super) fn finish(self) -> Vec<Diagnostic> {
        let mut list = self.list;
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
