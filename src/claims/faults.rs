//! What is wrong with a claim, said where it is written; and the checks that several forms share.

use super::cells::{Than, Where};
use crate::document::{known_or_near, quoted};
use crate::factor::Factor;
use std::collections::BTreeSet;

/// What there is to speak of in a study.
#[derive(Debug, Clone, Copy)]
pub struct Known<'a> {
    /// The factors and their values.
    pub factors: &'a [Factor],
    /// `success`, `outcome:NAME` and columns of the trials.
    pub metrics: &'a [String],
    /// Names of published tables.
    pub published: &'a [String],
}

/// What is wrong with a claim.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ClaimFault<'a> {
    /// JSON pointer of it in the claim: `/expect/less/where/start/1`, the second value where a list of them is written. Empty
    /// where it is the claim itself.
    pub pointer: String,
    /// Whether it is the key there and not its value.
    pub at_key: bool,
    /// What is wrong.
    pub message: String,
    /// The name that is unknown, and those that are known.
    pub unknown: Option<(String, Vec<&'a str>)>,
}

impl ClaimFault<'_> {
    pub(super) fn new(pointer: impl Into<String>, message: impl Into<String>) -> Self {
        Self { pointer: pointer.into(), at_key: false, message: message.into(), unknown: None }
    }

    /// Returns what may have been meant, where a name is unknown.
    pub fn help(&self) -> Option<String> {
        self.unknown.as_ref().map(|(name, known)| known_or_near(name, known))
    }
}

/// What is wrong with one claim, as it is found.
pub(super) struct Faults<'a> {
    known: Known<'a>,
    /// Pointer of what paths are relative to.
    pub(super) base: String,
    pub(super) found: Vec<ClaimFault<'a>>,
}

impl<'a> Faults<'a> {
    pub(super) fn new(known: Known<'a>) -> Self {
        Self { known, base: String::new(), found: Vec::new() }
    }

    pub(super) fn add(&mut self, path: &str, message: String) {
        self.found.push(ClaimFault::new(format!("{}{path}", self.base), message));
    }

    pub(super) fn unless(&mut self, holds: bool, path: &str, message: impl FnOnce() -> String) {
        if !holds {
            self.add(path, message());
        }
    }

    /// Adds the fault of a name that is not among `known`.
    pub(super) fn unknown(
        &mut self,
        path: &str,
        message: String,
        name: &str,
        known: impl Iterator<Item = &'a String>,
    ) {
        let unknown = Some((name.to_owned(), known.map(String::as_str).collect()));
        let fault = ClaimFault::new(format!("{}{path}", self.base), message);
        self.found.push(ClaimFault { unknown, ..fault });
    }

    /// Adds the fault of a factor that does not exist, named by a value or by a key.
    pub(super) fn unknown_factor(&mut self, path: &str, name: &str, at_key: bool) {
        let known = self.known.factors.iter().map(|factor| factor.name.as_str()).collect();
        let unknown = Some((name.to_owned(), known));
        let message = format!("unknown factor `{}`", quoted(name));
        let fault = ClaimFault::new(format!("{}{path}", self.base), message);
        self.found.push(ClaimFault { at_key, unknown, ..fault });
    }

    pub(super) fn values_of(&self, factor: &str) -> Option<&'a [String]> {
        let found = self.known.factors.iter().find(|known| known.name == factor);
        found.map(|known| &known.values[..])
    }

    pub(super) fn selection(&mut self, path: &str, selection: &Where) {
        for (factor, values) in &selection.0 {
            let path = format!("{path}/{}", factor.replace('~', "~0").replace('/', "~1"));
            let Some(known) = self.values_of(factor) else {
                self.unknown_factor(&path, factor, true);
                continue;
            };
            self.unless(!values.0.is_empty(), &path, || "expected a value, found none".to_owned());
            let mut listed = BTreeSet::new();
            for (i, value) in values.0.iter().enumerate() {
                let path = format!("{path}/{i}");
                if !listed.insert(value) {
                    self.add(&path, format!("the value `{}` is listed twice", quoted(value)));
                } else if !known.contains(value) {
                    let message =
                        format!("`{}` is not a value of the factor `{factor}`", quoted(value));
                    self.unknown(&path, message, value, known.iter());
                }
            }
        }
    }

    /// Checks a metric that is named.
    pub(super) fn metric(&mut self, path: &str, name: &str) {
        let known = self.known.metrics;
        if !known.iter().any(|metric| metric == name) {
            let message = format!("unknown metric `{}`", quoted(name));
            self.unknown(path, message, name, known.iter());
        }
    }

    /// Checks a published table that is named.
    pub(super) fn table(&mut self, path: &str, name: &str) {
        let known = self.known.published;
        if !known.iter().any(|table| table == name) {
            let message = format!("unknown published table `{}`", quoted(name));
            self.unknown(path, message, name, known.iter());
        }
    }

    pub(super) fn margin(&mut self, path: &str, margin: f64) {
        self.unless(margin > 0.0 && margin.is_finite(), path, || {
            format!("expected a positive number, found {margin}")
        });
    }

    pub(super) fn across(&mut self, across: &Where) {
        let cells = across.count();
        self.unless(cells >= 2, "/across", || format!("expected two cells or more, found {cells}"));
    }

    /// Checks the factors taken one by one on the other side of a comparison.
    pub(super) fn each(&mut self, path: &str, than: &Than) {
        for factor in &than.each {
            self.unless(than.r#where.0.contains_key(factor), path, || {
                format!("`{factor}` is not among the factors of `where`")
            });
        }
    }
}
