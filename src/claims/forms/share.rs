//! `share`: the share of trials that meet a condition lies between bounds. A run that never reached the
//! measure does not meet it.
//!
//! ```yaml
//! id: D11
//! ours: half of the runs of frontier arrive within five minutes
//! expect:
//!   share:
//!     that: {metric: time-s, at-most: 300}
//!     where: {strategy: frontier}
//!     low: 0.5
//! ```

use super::bounds::{Bounds, share_level};
use super::condition::{That, conditioned};
use super::declare::form;
use super::form::Form;
use super::scope::Scope;
use crate::claims::cells::{ForEach, Where};
use crate::claims::faults::Faults;
use crate::claims::gather::{Bench, Draft};
use crate::claims::terms::{Censored, Terms};

form! {
    /// `share`.
    pub struct Share {
        /// What a trial must meet to count.
        pub that: That,
        /// The cell or pool.
        #[serde(default)]
        pub r#where: Where,
        /// Repeated over these.
        #[serde(default)]
        pub for_each: ForEach,
        /// Lower bound of the share, if any.
        pub low: Option<f64>,
        /// Upper bound of the share, if any.
        pub high: Option<f64>,
    }
    terms {
        /// Level of each one-sided test.
        alpha,
        correction, at_least, minimum_n,
    }
}

impl Share {
    fn bounds(&self) -> Bounds {
        Bounds { low: self.low, high: self.high }
    }
}

impl Form for Share {
    /// Returns the shared terms. A run that never got there counts.
    fn terms(&self) -> Terms {
        Terms { censored: Censored::Worst, ..self.shared_terms() }
    }

    fn scope(&self) -> Scope<'_> {
        Scope::cell(self.that.measured(), &self.r#where, &self.for_each)
    }

    fn ranks(&self) -> bool {
        true
    }

    fn check<'a>(&'a self, faults: &mut Faults<'a>) {
        self.bounds().check(true, faults);
        self.that.check(faults);
    }

    fn judge(&self, bench: &Bench<'_>) -> Vec<Draft> {
        let bounds = self.bounds();
        let judged = |cell: Where| {
            let about = format!("share with {}: ({cell}) {}", self.that, bounds.words());
            conditioned(bench, &cell, &self.that, about, "score", |share| {
                share_level(share, bounds, bench.confidence())
            })
        };
        self.scope().pools().into_iter().map(judged).collect()
    }
}
