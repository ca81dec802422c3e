//! `equivalent`: the difference of two cells lies inside a margin (two one-sided tests: Newcombe's interval
//! for shares, Welch's test for measures). A large p-value of a test for a difference is never taken for equality.
//!
//! ```yaml
//! id: D4
//! says: >-
//!   as the deadline becomes more stringent its advantage seems to vanish and it becomes more or less
//!   comparable to the topological frontier
//! paper-table: contradicts
//! expect:
//!   equivalent:
//!     metric: success
//!     where: {strategy: normalized-frontier}
//!     to: {where: {strategy: frontier}}
//!     margin: 0.1
//!     minimum-n: 50
//! ```

use super::declare::form;
use super::form::Form;
use super::margin::{pair, test_name};
use super::scope::Scope;
use crate::claims::cells::{ForEach, Than, Values, Where};
use crate::claims::faults::Faults;
use crate::claims::gather::{Bench, Draft, Evidence};
use crate::claims::metric::Metric;
use crate::claims::terms::Terms;

form! {
    /// `equivalent`.
    pub struct Equivalence {
        /// What is measured.
        pub metric: Values,
        /// The first cell or pool.
        #[serde(default)]
        pub r#where: Where,
        /// The other side.
        pub to: Than,
        /// Repeated over these, on both sides.
        #[serde(default)]
        pub for_each: ForEach,
        /// Largest difference that still counts as equal, in the metric's unit (shares: 0.1 is ten points).
        pub margin: f64,
    }
    terms {
        /// Level of each of the two one-sided tests.
        alpha,
        correction, at_least, minimum_n, censored,
    }
}

impl Form for Equivalence {
    fn terms(&self) -> Terms {
        self.shared_terms()
    }

    fn scope(&self) -> Scope<'_> {
        let named = [("/where", &self.r#where), ("/to/where", &self.to.r#where)];
        Scope::two_cells(&self.metric, named, &self.for_each)
    }

    fn check<'a>(&'a self, faults: &mut Faults<'a>) {
        faults.each("/to/each", &self.to);
        faults.margin("/margin", self.margin);
    }

    fn judge(&self, bench: &Bench<'_>) -> Vec<Draft> {
        let margin = self.margin;
        let mut drafts = Vec::new();
        for name in &self.metric.0 {
            let metric = Metric::named(name);
            for pins in self.for_each.combinations() {
                for other in self.to.cells() {
                    let cells = [self.r#where.pinned(&pins), other.pinned(&pins)];
                    let about =
                        format!("{metric}: ({}) = ({}) within {margin}", cells[0], cells[1]);
                    drafts.push(bench.draft(
                        about,
                        test_name(&metric),
                        &cells,
                        &metric,
                        |_, groups| {
                            let (found, effect) = pair(bench, &groups[0], &groups[1], margin)?;
                            Ok(Evidence {
                                p_for: found.inside,
                                p_against: found.beyond,
                                statistics: vec![("margin", margin)],
                                effect: Some(effect),
                            })
                        },
                    ));
                }
            }
        }
        drafts
    }
}
