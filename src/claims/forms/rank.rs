//! `rank`: one cell is `first` (highest) or `last` of those across a factor, or all stand in `descending` order.
//!
//! ```yaml
//! id: D2b
//! ours: from B random is the worst
//! paper-table: supports
//! expect:
//!   rank:
//!     metric: success
//!     where: {start: B}
//!     across: {strategy: [random, frontier, normalized-frontier]}
//!     order: {last: random}
//! ```

use super::declare::form;
use super::difference::compare;
use super::form::Form;
use super::scope::Scope;
use crate::claims::cells::{ForEach, Values, Where};
use crate::claims::faults::Faults;
use crate::claims::gather::{Bench, Draft};
use crate::claims::metric::Metric;
use crate::claims::terms::{Side, Terms, Test};
use crate::document::quoted;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

form! {
    /// `rank`.
    pub struct Ranking {
        /// What is measured.
        pub metric: Values,
        /// Holds for every cell.
        #[serde(default)]
        pub r#where: Where,
        /// One factor and the values that are ranked.
        pub across: Where,
        /// The order claimed.
        pub order: Order,
        /// Repeated over these.
        #[serde(default)]
        pub for_each: ForEach,
    }
    terms {
        /// As for `greater`.
        test,
        sides, alpha, correction, at_least, minimum_n, censored,
    }
}

/// The order of cells across a factor.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Order {
    /// This value has the highest metric.
    First(String),
    /// This value has the lowest metric.
    Last(String),
    /// Each of these is higher than the next.
    Descending(Vec<String>),
}

impl Ranking {
    /// Returns the pairs of values that the order states, the higher first.
    fn pairs<'a>(&'a self, values: &'a Values) -> Vec<(&'a str, &'a str)> {
        match &self.order {
            Order::First(best) => values
                .0
                .iter()
                .filter(|v| *v != best)
                .map(|v| (best.as_str(), v.as_str()))
                .collect(),
            Order::Last(worst) => values
                .0
                .iter()
                .filter(|v| *v != worst)
                .map(|v| (v.as_str(), worst.as_str()))
                .collect(),
            Order::Descending(order) => {
                order.windows(2).map(|pair| (pair[0].as_str(), pair[1].as_str())).collect()
            }
        }
    }
}

impl Form for Ranking {
    fn terms(&self) -> Terms {
        self.shared_terms()
    }

    fn scope(&self) -> Scope<'_> {
        Scope::across(&self.metric, &self.r#where, &self.across, &self.for_each)
    }

    fn ranks(&self) -> bool {
        self.test == Some(Test::MannWhitney)
    }

    fn check<'a>(&'a self, faults: &mut Faults<'a>) {
        faults.across(&self.across);
        faults.unless(self.across.0.len() == 1, "/across", || {
            format!("expected one factor, found {}", self.across.0.len())
        });
        let ranked: Vec<&String> = self.across.0.values().flat_map(|v| &v.0).collect();
        let (named, enough) = match &self.order {
            Order::First(value) | Order::Last(value) => (std::slice::from_ref(value), true),
            Order::Descending(values) => (&values[..], values.len() >= 2),
        };
        faults.unless(enough, "/order", || "expected two values or more".to_owned());
        for value in named {
            if !ranked.contains(&value) {
                let message = format!("`{}` is not among those ranked", quoted(value));
                faults.unknown("/order", message, value, ranked.iter().copied());
            }
        }
    }

    fn judge(&self, bench: &Bench<'_>) -> Vec<Draft> {
        let Some((factor, values)) = self.across.0.iter().next() else { return Vec::new() };
        let with = |base: &Where, value: &str| {
            base.pinned(&[(factor.clone(), value.to_owned())].into_iter().collect())
        };
        let pairs = self.pairs(values);
        let mut drafts = Vec::new();
        for metric in &self.metric.0 {
            for pins in self.for_each.combinations() {
                let base = self.r#where.pinned(&pins);
                for &(high, low) in &pairs {
                    let cells = [with(&base, high), with(&base, low)];
                    drafts.push(compare(bench, &Metric::named(metric), &cells, Side::Greater));
                }
            }
        }
        drafts
    }
}
