//! Names of a manifest: how they are written, the factors and their values, and what may have been meant by a near miss.

use super::faults::{Faults, step};
use crate::document::{known_or_near, quoted, suggestion};
use crate::factor::Factor;
use crate::studies::FactorValue;
use std::collections::BTreeSet;

/// Suggests a name like `name` that [`is_kebab`].
pub(super) fn kebab(name: &str) -> String {
    let lower = name.to_ascii_lowercase();
    let parts: Vec<&str> =
        lower.split(|c: char| !c.is_ascii_alphanumeric()).filter(|p| !p.is_empty()).collect();
    if parts.is_empty() { "a-name".to_owned() } else { parts.join("-") }
}

/// Returns whether `name` is of lower-case letters, digits and single hyphens between them.
pub(super) fn is_kebab(name: &str) -> bool {
    name.split('-').all(|part| {
        !part.is_empty() && part.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit())
    })
}

impl Faults<'_> {
    /// Returns what may have been meant by `word`, for a fault that is kept.
    pub(super) fn near(&self, word: &str, known: &[&str]) -> String {
        if self.is_full() { String::new() } else { known_or_near(word, known) }
    }

    /// Collects that `word`, the value at `pointer`, is none of `known`.
    pub(super) fn unknown(
        &mut self,
        pointer: &str,
        message: String,
        label: &str,
        word: &str,
        known: &[&str],
    ) {
        let fault = self.fault(pointer, message).label(label).help(self.near(word, known));
        self.push(fault);
    }

    /// Collects that `word`, the key at `pointer`, is none of `known`.
    pub(super) fn unknown_key(
        &mut self,
        pointer: &str,
        message: String,
        label: &str,
        word: &str,
        known: &[&str],
    ) {
        let fault = self.key_fault(pointer, message).label(label).help(self.near(word, known));
        self.push(fault);
    }

    /// Returns whether `value` is one of the factor `name`; collects a fault at `pointer` where it is not.
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
        let message = format!("`{value}` is not a value of the factor `{name}`");
        self.unknown(pointer, message, "unknown value", &value.0, &known);
        false
    }

    /// Returns the factor `name`; collects a fault at `pointer` (or its key) where there is none.
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
            let tell = if at_key { Self::unknown_key } else { Self::unknown };
            tell(self, pointer, message, "not a key of `factors`", name, &known);
        }
        found
    }

    /// Collects the faults of a `values` mapping at `pointer` whose keys should be those of `factor`: all of them where
    /// it is to be `complete`.
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
            if !self.is_full() {
                meant.extend(suggestion(key, known.iter().copied()));
            }
            let message =
                format!("`{}` is not a value of the factor `{}`", quoted(key), factor.name);
            self.unknown_key(&step(pointer, key), message, "unknown value", key, &known);
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
}
