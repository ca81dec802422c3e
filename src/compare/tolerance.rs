//! How much a number may differ before that counts as change: declared by whoever compares, nothing by default.

use crate::document::suggestion;
use std::collections::BTreeMap;
use std::collections::BTreeSet;
use thiserror::Error;

/// By how much two numbers may differ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tolerance {
    /// In the number's own unit.
    Absolute(f64),
    /// As a fraction of the larger magnitude, so that it does not matter which side comes first.
    Relative(f64),
}

impl Tolerance {
    /// Returns whether `a` and `b` are near enough.
    pub fn admits(self, a: f64, b: f64) -> bool {
        let bound = match self {
            Self::Absolute(bound) => bound,
            Self::Relative(fraction) => fraction * a.abs().max(b.abs()),
        };
        a == b || (a - b).abs() <= bound
    }

    fn parse(written: &str) -> Option<Self> {
        let (number, percent) = match written.strip_suffix('%') {
            Some(number) => (number, true),
            None => (written, false),
        };
        let number: f64 =
            number.trim().parse().ok().filter(|n: &f64| n.is_finite() && *n >= 0.0)?;
        Some(if percent { Self::Relative(number / 100.0) } else { Self::Absolute(number) })
    }
}

/// Tolerances as declared: one for every number, others for single metrics.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Tolerances {
    every: Option<Tolerance>,
    metrics: BTreeMap<String, Tolerance>,
}

/// Why a tolerance cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum ToleranceError {
    /// It is no number.
    #[error(
        "`--tolerance {0}`: expected METRIC=NUMBER, METRIC=NUMBER% or one number for all, as in `--tolerance \
         distance-m=0.5` or `--tolerance 1%`; numbers are 0 or more"
    )]
    NotATolerance(String),
    /// No side has such a metric.
    #[error("`--tolerance {name}=...`: neither side has a metric `{name}`{hint}")]
    UnknownMetric {
        /// The name written.
        name: String,
        /// A suggestion or what is known.
        hint: String,
    },
}

impl Tolerances {
    /// Reads tolerances as the command line writes them.
    ///
    /// # Errors
    /// The first text that is not a tolerance.
    pub fn parse(written: &[String]) -> Result<Self, ToleranceError> {
        let mut tolerances = Self::default();
        for text in written {
            let bad = || ToleranceError::NotATolerance(text.clone());
            match text.split_once('=') {
                Some((metric, number)) if !metric.is_empty() => {
                    let tolerance = Tolerance::parse(number).ok_or_else(bad)?;
                    tolerances.metrics.insert(metric.to_owned(), tolerance);
                }
                _ => tolerances.every = Some(Tolerance::parse(text).ok_or_else(bad)?),
            }
        }
        Ok(tolerances)
    }

    /// Returns whether none is declared: then every byte counts.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// Returns the tolerance of the metric `name`: its own, else that of the metric it is a level of (`distance-m` for
    /// `distance-m-at-90`), else the one for all.
    pub fn of(&self, name: &str) -> Option<Tolerance> {
        let base = name.rsplit_once("-at-").map(|(base, _)| base);
        let own = self.metrics.get(name).or_else(|| self.metrics.get(base?));
        own.copied().or(self.every)
    }

    /// Returns whether the change of `name` from `a` to `b` is admitted.
    pub fn admits(&self, name: &str, a: f64, b: f64) -> bool {
        a == b || self.of(name).is_some_and(|tolerance| tolerance.admits(a, b))
    }

    /// Holds the declared metrics against those that there are.
    ///
    /// # Errors
    /// The first that is unknown.
    pub(super) fn check(&self, known: &BTreeSet<&str>) -> Result<(), ToleranceError> {
        let mut names: BTreeSet<&str> = known.clone();
        names.extend(known.iter().filter_map(|name| Some(name.rsplit_once("-at-")?.0)));
        match self.metrics.keys().find(|name| !names.contains(name.as_str())) {
            None => Ok(()),
            Some(name) => {
                let hint = if let Some(near) = suggestion(name, names.iter().copied()) {
                    format!(": did you mean `{near}`?")
                } else {
                    let all: Vec<&str> = names.into_iter().collect();
                    format!(" (known: {})", all.join(", "))
                };
                Err(ToleranceError::UnknownMetric { name: name.clone(), hint })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_declaration_counts_and_both_directions_are_equal() {
        let written = ["1%", "distance-m=0.5", "distance-m-at-90=2"].map(str::to_owned);
        let tolerances = Tolerances::parse(&written).unwrap();
        for (name, a, b, admitted) in [
            ("distance-m-at-90", 10.0, 12.0, true),
            ("distance-m-at-80", 10.0, 12.0, false),
            ("distance-m-at-80", 10.0, 10.5, true),
            ("time-s", 100.0, 99.0, true),
            ("time-s", 99.0, 100.0, true),
            ("time-s", 98.9, 100.0, false),
            ("time-s", 0.0, 0.0, true),
        ] {
            assert_eq!(tolerances.admits(name, a, b), admitted, "{name} {a} {b}");
        }
        assert!(!Tolerances::default().admits("x", 1.0, 1.0 + f64::EPSILON));
    }

    #[test]
    fn what_is_no_tolerance_is_told() {
        for bad in ["", "x", "=1", "a=", "a=-1", "a=inf", "5%%"] {
            assert_eq!(
                Tolerances::parse(&[bad.to_owned()]).unwrap_err().to_string(),
                format!(
                    "`--tolerance {bad}`: expected METRIC=NUMBER, METRIC=NUMBER% or one number for all, as in `--tolerance \
                     distance-m=0.5` or `--tolerance 1%`; numbers are 0 or more"
                )
            );
        }
        let known = BTreeSet::from(["distance-m-at-90", "time-s"]);
        let check = |text: &str| Tolerances::parse(&[text.to_owned()]).unwrap().check(&known);
        assert_eq!(check("distance-m=1"), Ok(()));
        assert_eq!(
            check("tme-s=1").unwrap_err().to_string(),
            "`--tolerance tme-s=...`: neither side has a metric `tme-s`: did you mean `time-s`?"
        );
        assert_eq!(
            check("energy=1").unwrap_err().to_string(),
            "`--tolerance energy=...`: neither side has a metric `energy` (known: distance-m, distance-m-at-90, time-s)"
        );
    }
}
