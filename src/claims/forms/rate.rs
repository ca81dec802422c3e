//! `rate`: of the same trials, one quantity is lower or higher than another, each summed per trial or `per` something
//! else; by bootstrap over trials.
//!
//! ```yaml
//! id: D7b
//! says: >-
//!   more aggressive maneuvers, thus possibly also increasing the number of failures due to collisions
//!   with the environment
//! paper-table: silent
//! expect:
//!   rate:
//!     of: {metric: fast-collisions, per: fast-maneuvers}
//!     direction: greater
//!     than: {metric: slow-collisions, per: slow-maneuvers}
//! ```

use super::declare::form;
use super::difference::directed;
use super::form::Form;
use super::scope::Scope;
use crate::claims::cannot_test::CannotTest;
use crate::claims::cells::{ForEach, Where};
use crate::claims::faults::Faults;
use crate::claims::gather::{Bench, Draft, Evidence};
use crate::claims::metric::Metric;
use crate::claims::terms::{Side, Sides, Terms};
use crate::claims::verdict::{CellNumbers, EffectSize};
use crate::stats::bootstrap::bootstrap;
use crate::stats::{Tails, real};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;

form! {
    /// `rate`.
    pub struct Rate {
        /// The first quantity.
        pub of: Quantity,
        /// Which side it lies on.
        pub direction: Side,
        /// The second, of the same trials.
        pub than: Quantity,
        /// The cell or pool.
        #[serde(default)]
        pub r#where: Where,
        /// Repeated over these.
        #[serde(default)]
        pub for_each: ForEach,
    }
    terms {
        alpha, correction, at_least,
        /// Trials without which nothing is judged.
        minimum_n,
    }
}

/// A quantity counted over trials: a sum, by default per trial.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Quantity {
    /// What is summed: a measure, or a share of trials.
    pub metric: String,
    /// What it is divided by; default the number of trials.
    pub per: Option<String>,
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.metric)?;
        self.per.iter().try_for_each(|per| write!(f, " per {per}"))
    }
}

impl Form for Rate {
    fn terms(&self) -> Terms {
        self.shared_terms()
    }

    fn scope(&self) -> Scope<'_> {
        let named = [
            ("/of/metric", Some(&self.of.metric)),
            ("/of/per", self.of.per.as_ref()),
            ("/than/metric", Some(&self.than.metric)),
            ("/than/per", self.than.per.as_ref()),
        ];
        let there = named.into_iter().filter_map(|(path, name)| Some((path, name?)));
        let measured = there.map(|(path, name)| (path.to_owned(), name.as_str())).collect();
        Scope::cell(measured, &self.r#where, &self.for_each)
    }

    fn check<'a>(&'a self, faults: &mut Faults<'a>) {
        for (path, quantity) in [("/of/per", &self.of), ("/than/per", &self.than)] {
            let share = quantity.per.as_ref().is_some_and(|m| Metric::named(m).is_share());
            faults.unless(!share, path, || {
                "expected a measure; a share is counted per trial anyway".to_owned()
            });
        }
    }

    /// Compares by resampling trials within conditions, so that what happened in one trial stays together: its maneuvers, or
    /// that a trial which ended one way did not end the other.
    fn judge(&self, bench: &Bench<'_>) -> Vec<Draft> {
        let sign = if self.direction == Side::Less { "<" } else { ">" };
        let judged = |cell: Where| {
            let about = format!("{} {sign} {} in ({cell})", self.of, self.than);
            let [first, second] = [&self.of, &self.than].map(|of| gathered(bench, &cell, of));
            let (cells, conditions) = ([first.cells, second.cells].concat(), first.conditions);
            let evidence = first.parts.and_then(|first| {
                let second = second.parts?;
                compared(bench, &about, self, &first, &second)
            });
            Draft { about, test: "bootstrap", cells, conditions, evidence, notes: Vec::new() }
        };
        self.scope().pools().into_iter().map(judged).collect()
    }
}

/// What one trial adds to a quantity and to what it is counted per.
type Part = (f64, f64);

struct Gathered {
    cells: Vec<CellNumbers>,
    conditions: Vec<usize>,
    /// By condition and trial.
    parts: Result<Vec<Vec<Part>>, CannotTest>,
}

fn gathered(bench: &Bench<'_>, cell: &Where, quantity: &Quantity) -> Gathered {
    let metrics: Vec<Metric> = [Some(&quantity.metric), quantity.per.as_ref()]
        .into_iter()
        .flatten()
        .map(|m| Metric::named(m))
        .collect();
    let (mut cells, mut conditions, mut fault) = (Vec::new(), Vec::new(), None);
    for metric in &metrics {
        let mut found = bench.gather(std::slice::from_ref(cell), metric);
        for numbers in &mut found.numbers {
            numbers.cell = format!("{metric}: {}", numbers.cell);
        }
        cells.append(&mut found.numbers);
        conditions = found.conditions;
        fault = fault.or(found.groups.err());
    }
    let readings = |i: usize, metric: &Metric| -> Vec<f64> {
        bench.observations.readings(&[i], metric).values.into_iter().flatten().collect()
    };
    let parts = conditions.iter().map(|&i| {
        let amounts = readings(i, &metrics[0]);
        match metrics.get(1) {
            Some(per) => amounts.into_iter().zip(readings(i, per)).collect(),
            None => amounts.into_iter().map(|amount| (amount, 1.0)).collect(),
        }
    });
    let parts = parts.collect();
    Gathered { cells, conditions, parts: fault.map_or(Ok(parts), Err) }
}

fn compared(
    bench: &Bench<'_>,
    about: &str,
    form: &Rate,
    first: &[Vec<Part>],
    second: &[Vec<Part>],
) -> Result<Evidence, CannotTest> {
    let seen: Vec<Vec<f64>> =
        first.iter().map(|trials| (0..trials.len() as u64).map(real).collect()).collect();
    let rate = |parts: &[Vec<Part>], drawn: &[Vec<f64>]| {
        let (mut amount, mut per) = (0.0, 0.0);
        for (trials, places) in parts.iter().zip(drawn) {
            for &place in places {
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "a place among trials"
                )]
                let part = trials[place as usize];
                amount += part.0;
                per += part.1;
            }
        }
        amount / per
    };
    let rates = [rate(first, &seen), rate(second, &seen)];
    for (quantity, rate) in [&form.of, &form.than].into_iter().zip(rates) {
        if !rate.is_finite() {
            let per = quantity.per.as_deref().unwrap_or("trials").to_owned();
            return Err(CannotTest::NoRate { per, quantity: quantity.to_string() });
        }
    }
    let samples: Vec<&[f64]> = seen.iter().map(Vec::as_slice).collect();
    let found = bootstrap(
        &samples,
        |drawn| {
            let difference = rate(first, drawn) - rate(second, drawn);
            // A draw in which one of them is no number speaks for neither side.
            if difference.is_finite() { difference } else { 0.0 }
        },
        bench.context.resamples,
        bench.confidence(),
        &mut bench.stream(about),
    );
    let resamples = real(found.statistics.len() as u64);
    let count = |holds: fn(f64) -> bool| {
        real(found.statistics.iter().filter(|&&x| holds(x)).count() as u64)
    };
    let share = |count: f64| (count + 1.0) / (resamples + 1.0);
    let tails = Tails {
        less: share(count(|x| x >= 0.0)),
        greater: share(count(|x| x <= 0.0)),
        two_sided: f64::NAN,
    };
    let (p_for, p_against) = directed(tails, found.estimate, form.direction, Sides::One);
    Ok(Evidence {
        p_for,
        p_against,
        statistics: vec![("first", rates[0]), ("second", rates[1]), ("resamples", resamples)],
        effect: Some(EffectSize::new("rate-difference", found.estimate, found.interval)),
    })
}
