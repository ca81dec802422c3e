//! `every`: each single trial meets a condition, which may be the value of a factor. No test: one trial that does
//! not meet it contradicts the claim.
//!
//! ```yaml
//! id: D10
//! says: a trial is considered a failure if the robot has not reached the target location by the given deadline
//! paper-table: supports
//! expect: {every: {that: {metric: time-s, at-most: deadline-s}, censored: reached-only}}
//! ```

use super::condition::{That, conditioned};
use super::declare::form;
use super::form::Form;
use super::scope::Scope;
use crate::claims::cells::{ForEach, Where};
use crate::claims::faults::Faults;
use crate::claims::gather::{Bench, COUNT, Draft, Evidence};
use crate::claims::terms::Terms;

form! {
    /// `every`.
    pub struct Every {
        /// What each trial must meet.
        pub that: That,
        /// Which trials.
        #[serde(default)]
        pub r#where: Where,
        /// Repeated over these.
        #[serde(default)]
        pub for_each: ForEach,
    }
    terms {
        /// Trials without which nothing is judged.
        minimum_n,
        /// What becomes of runs that did not reach the measure; `reached-only` leaves them out.
        censored,
    }
}

impl Form for Every {
    /// Returns the shared terms. Nothing is estimated, so there is no level; the usual one stands for it.
    fn terms(&self) -> Terms {
        self.shared_terms()
    }

    fn scope(&self) -> Scope<'_> {
        Scope::cell(self.that.measured(), &self.r#where, &self.for_each)
    }

    fn ranks(&self) -> bool {
        true
    }

    fn check<'a>(&'a self, faults: &mut Faults<'a>) {
        self.that.check(faults);
    }

    /// Counts the trials that do not meet the condition: nothing is estimated.
    fn judge(&self, bench: &Bench<'_>) -> Vec<Draft> {
        let judged = |cell: Where| {
            let about = format!("every trial with {}: ({cell})", self.that);
            conditioned(bench, &cell, &self.that, about, COUNT, |share| {
                let all = share.successes == share.trials;
                let (p_for, p_against) = if all { (0.0, 1.0) } else { (1.0, 0.0) };
                Evidence { p_for, p_against, statistics: Vec::new(), effect: None }
            })
        };
        self.scope().pools().into_iter().map(judged).collect()
    }
}
