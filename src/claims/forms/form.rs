//! What every form of expectation answers, so that nothing else has to know which forms there are.

use super::scope::Scope;
use crate::claims::faults::Faults;
use crate::claims::gather::{Bench, Draft};
use crate::claims::terms::{Terms, Test};

/// A form of expectation.
pub(in crate::claims) trait Form {
    /// Returns what it has in common with other forms, its own defaults filled in.
    fn terms(&self) -> Terms;

    /// Returns the metrics and the trials that it looks at.
    fn scope(&self) -> Scope<'_>;

    /// Returns whether trials judge it, so that it has to name a metric.
    fn needs_metric(&self) -> bool {
        true
    }

    /// Returns whether `test` is one of the tests that it can be judged by.
    fn has_test(&self, test: Test) -> bool {
        !matches!(test, Test::CochranArmitage | Test::Spearman)
    }

    /// Returns whether it looks at ranks, in which runs that never reached the measure have a place: the last.
    fn ranks(&self) -> bool {
        false
    }

    /// Adds the faults that only this form can have.
    fn check<'a>(&'a self, faults: &mut Faults<'a>);

    /// Compares what the form states: one draft for each comparison.
    fn judge(&self, bench: &Bench<'_>) -> Vec<Draft>;
}
