//! `spread`: largest less smallest cell mean across a factor is below that of another pool, or `at-most` a
//! bound; by bootstrap.
//!
//! ```yaml
//! id: D5
//! says: >-
//!   The semantic strategies, on the contrary, appear to have a performance that is less dependent on the
//!   start location
//! paper-table: contradicts
//! expect:
//!   spread:
//!     metric: success
//!     where: {strategy: corridors-first}
//!     across: {start: [A, B, C]}
//!     than: {strategy: frontier}
//! ```

use super::declare::form;
use super::form::Form;
use super::scope::Scope;
use crate::claims::cannot_test::CannotTest;
use crate::claims::cells::{ForEach, Values, Where};
use crate::claims::faults::Faults;
use crate::claims::gather::{Bench, Draft, Evidence, Group, varies};
use crate::claims::metric::Metric;
use crate::claims::terms::Terms;
use crate::claims::verdict::EffectSize;
use crate::stats::bootstrap::{bootstrap, bootstrap_shares};
use crate::stats::proportion::Proportion;
use crate::stats::real;
use crate::stats::summary::mean;

form! {
    /// `spread`.
    pub struct Spread {
        /// What is measured.
        pub metric: Values,
        /// Holds for every cell.
        #[serde(default)]
        pub r#where: Where,
        /// The cells: every combination.
        pub across: Where,
        /// If given, the spread is below that of the cells with these factors replaced.
        pub than: Option<Where>,
        /// If given, the spread is at most this, in the metric's unit.
        pub at_most: Option<f64>,
        /// Repeated over these.
        #[serde(default)]
        pub for_each: ForEach,
    }
    terms { alpha, correction, at_least, minimum_n, censored, }
}

impl Spread {
    fn cells(&self, base: &Where) -> Vec<Where> {
        self.across.combinations().iter().map(|cell| base.pinned(cell)).collect()
    }
}

impl Form for Spread {
    fn terms(&self) -> Terms {
        self.shared_terms()
    }

    fn scope(&self) -> Scope<'_> {
        let than = self.than.as_ref().map(|cell| ("/than", cell));
        let named = [("/where", &self.r#where), ("/across", &self.across)].into_iter().chain(than);
        Scope::repeated(self.metric.as_metrics(), named, &self.for_each, |pins| {
            let base = self.r#where.pinned(pins);
            let other = self.than.iter().map(|than| base.replaced(than));
            let pools = other.chain([base.clone()]).map(|cell| cell.replaced(&self.across));
            pools.collect::<Vec<_>>()
        })
    }

    fn check<'a>(&'a self, faults: &mut Faults<'a>) {
        faults.across(&self.across);
        faults.unless(self.than.is_some() != self.at_most.is_some(), "/than", || {
            "expected either `than` or `at-most`".to_owned()
        });
        self.at_most.iter().for_each(|bound| faults.margin("/at-most", *bound));
    }

    /// Compares by resampling trials within cells. A spread of noisy means is biased upwards, the more so the fewer trials;
    /// between two pools of equal size the bias about cancels, against a bound it makes the test cautious.
    fn judge(&self, bench: &Bench<'_>) -> Vec<Draft> {
        let across = &self.across;
        let mut drafts = Vec::new();
        for name in &self.metric.0 {
            let metric = Metric::named(name);
            for pins in self.for_each.combinations() {
                let base = self.r#where.pinned(&pins);
                let mut cells = self.cells(&base);
                let first = cells.len();
                let about = format!("spread of {metric} across {across}: ({base})");
                let (about, limit) = if let Some(other) = &self.than {
                    let other = base.replaced(other);
                    cells.extend(self.cells(&other));
                    (format!("{about} < ({other})"), 0.0)
                } else {
                    let limit = self.at_most.unwrap_or(f64::INFINITY);
                    (format!("{about} at most {limit}"), limit)
                };
                drafts.push(bench.draft(about, "bootstrap", &cells, &metric, |about, groups| {
                    resampled(bench, about, groups, first, limit)
                }));
            }
        }
        drafts
    }
}

/// Returns the largest mean less the smallest.
fn spread_of(means: &[f64]) -> f64 {
    let most = means.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    most - means.iter().copied().fold(f64::INFINITY, f64::min)
}

fn resampled(
    bench: &Bench<'_>,
    about: &str,
    groups: &[Group],
    first: usize,
    limit: f64,
) -> Result<Evidence, CannotTest> {
    if first < 2 {
        return Err(CannotTest::OneCellHasNoSpread);
    }
    varies(&groups.iter().collect::<Vec<_>>())?;
    let compared = first < groups.len();
    let statistic = |means: &[f64]| {
        let other = if compared { spread_of(&means[first..]) } else { 0.0 };
        spread_of(&means[..first]) - other
    };
    let (resamples, confidence) = (bench.context.resamples, bench.confidence());
    let mut stream = bench.stream(about);
    let shares: Option<Vec<Proportion>> = groups.iter().map(|g| g.proportion).collect();
    let found = if let Some(shares) = shares {
        bootstrap_shares(&shares, statistic, resamples, confidence, &mut stream)
    } else {
        let samples: Vec<&[f64]> = groups.iter().map(|g| g.values.as_slice()).collect();
        let of_samples = |drawn: &[Vec<f64>]| {
            statistic(&drawn.iter().map(|sample| mean(sample)).collect::<Vec<_>>())
        };
        bootstrap(&samples, of_samples, resamples, confidence, &mut stream)
    };
    let resamples = real(found.statistics.len() as u64);
    let above = found.statistics.iter().filter(|&&x| x >= limit).count() as u64;
    let below = found.statistics.iter().filter(|&&x| x <= limit).count() as u64;
    let share = |count: u64| (real(count) + 1.0) / (resamples + 1.0);
    Ok(Evidence {
        p_for: share(above),
        p_against: share(below),
        statistics: vec![("resamples", resamples)],
        effect: Some(EffectSize::new(
            if compared { "spread-difference" } else { "spread" },
            found.estimate,
            found.interval,
        )),
    })
}
