//! What every form of expectation answers, so that nothing else has to know which forms there are.

use crate::claims::cells::Where;
use crate::claims::faults::Faults;
use crate::claims::gather::{Bench, Draft};
use crate::claims::terms::{Terms, Test};

/// A form of expectation. Pointers are JSON pointers from the form: `/than/where`.
pub(in crate::claims) trait Form {
    /// Returns what it has in common with other forms, its own defaults filled in.
    fn terms(&self) -> Terms;

    /// Returns the metrics measured, each with the pointer to where it is named.
    fn measured(&self) -> Vec<(String, &str)>;

    /// Returns whether trials judge it, so that it has to name a metric.
    fn needs_metric(&self) -> bool {
        true
    }

    /// Returns the name of the published table compared with, if there is one.
    fn published(&self) -> Option<&str> {
        None
    }

    /// Returns every selection of trials that it names, with the pointer to it.
    fn selections(&self) -> Vec<(String, &Where)>;

    /// Returns the pools of trials that it looks at, together: trials outside of them cannot matter. `plan --power` makes up
    /// no others.
    fn pools(&self) -> Vec<Where>;

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

    /// Compares: one draft for each comparison that the form states.
    fn judge(&self, bench: &Bench<'_>) -> Vec<Draft>;
}
