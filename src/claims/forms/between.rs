//! `between`: the mean (or `median`, `p95`, `least`) of a cell lies between bounds; with `relative-to`, its relative
//! difference from another cell.
//!
//! ```yaml
//! id: P6
//! says: >-
//!   a speed-up for covering 70 % of the free area of 25 % wrt the use of no prior knowledge for the
//!   furnished version and of almost 40 % for the unfurnished one
//! paper-table: supports
//! expect:
//!   between:
//!     metric: time-s-at-70
//!     where: {prior: floor-plan}
//!     relative-to: {prior: none}
//!     low: -0.45
//!     high: -0.10
//! ```

use super::bounds::{Bounds, share_level};
use super::declare::form;
use super::form::Form;
use super::scope::Scope;
use crate::claims::cannot_test::CannotTest;
use crate::claims::cells::{ForEach, Values, Where};
use crate::claims::faults::Faults;
use crate::claims::gather::{Bench, COUNT, Draft, Evidence, Group, varies};
use crate::claims::metric::Metric;
use crate::claims::terms::Terms;
use crate::claims::verdict::EffectSize;
use crate::math::{exp, exp_m1, ln, ln_1p};
use crate::stats::bootstrap::bootstrap;
use crate::stats::distribution::{
    binomial_sf_inclusive, normal_quantile, normal_sf, student_t_quantile, student_t_sf,
};
use crate::stats::means::mean_interval;
use crate::stats::summary::quantile;
use crate::stats::{Interval, real};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

form! {
    /// `between`.
    #[schemars(rename = "Level")]
    pub struct Between {
        /// What is measured.
        pub metric: Values,
        /// The cell or pool.
        #[serde(default)]
        pub r#where: Where,
        /// If given, the bounds are on `mean / mean of this cell - 1`.
        pub relative_to: Option<Where>,
        /// Repeated over these.
        #[serde(default)]
        pub for_each: ForEach,
        /// Which number of the sample.
        #[serde(default)]
        pub statistic: Statistic,
        /// Lower bound, if any.
        pub low: Option<f64>,
        /// Upper bound, if any.
        pub high: Option<f64>,
    }
    terms {
        /// Level of each one-sided test.
        alpha,
        correction, at_least, minimum_n, censored,
    }
}

/// Which number of a sample is meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Statistic {
    /// The mean, or the share.
    #[default]
    Mean,
    /// The median.
    Median,
    /// The 95th percentile.
    P95,
    /// The least of all: a best run, of which nothing is estimated.
    Least,
}

impl Between {
    fn bounds(&self) -> Bounds {
        Bounds { low: self.low, high: self.high }
    }

    /// Returns what is held against the bounds in words, and the name of its test.
    fn about(&self, metric: &Metric, cell: &Where, base: Option<&Where>) -> (String, &'static str) {
        let words = self.bounds().words();
        match (base, self.statistic) {
            (Some(base), _) => {
                (format!("{metric}: ({cell}) relative to ({base}) {words}"), "log-ratio")
            }
            (None, Statistic::Mean) if metric.is_share() => {
                (format!("{metric}: ({cell}) {words}"), "score")
            }
            (None, Statistic::Mean) => (format!("mean {metric}: ({cell}) {words}"), "t"),
            (None, Statistic::Median) => (format!("median {metric}: ({cell}) {words}"), "binomial"),
            (None, Statistic::P95) => (format!("p95 {metric}: ({cell}) {words}"), "binomial"),
            (None, Statistic::Least) => (format!("least {metric}: ({cell}) {words}"), COUNT),
        }
    }

    fn weigh(
        &self,
        bench: &Bench<'_>,
        about: &str,
        groups: &[Group],
    ) -> Result<Evidence, CannotTest> {
        let bounds = self.bounds();
        match (groups, self.statistic) {
            ([a, b], _) => relative(bench, a, b, bounds),
            ([a, ..], Statistic::Mean) => match a.proportion {
                Some(share) => Ok(share_level(share, bounds, bench.confidence())),
                None => mean_level(a, bounds, bench.confidence()),
            },
            ([a, ..], Statistic::Median) => Ok(quantile_level(bench, about, a, 0.5, bounds)),
            ([a, ..], Statistic::P95) => Ok(quantile_level(bench, about, a, 0.95, bounds)),
            ([a, ..], Statistic::Least) => least_level(bench, about, a, bounds),
            ([], _) => Err(CannotTest::NoCell),
        }
    }
}

impl Form for Between {
    fn terms(&self) -> Terms {
        self.shared_terms()
    }

    fn scope(&self) -> Scope<'_> {
        let base = self.relative_to.as_ref().map(|cell| ("/relative-to", cell));
        let named = [("/where", &self.r#where)].into_iter().chain(base);
        Scope::repeated(self.metric.as_metrics(), named, &self.for_each, |pins| {
            let cells = self.relative_to.iter().chain([&self.r#where]);
            cells.map(|cell| cell.pinned(pins)).collect::<Vec<_>>()
        })
    }

    fn ranks(&self) -> bool {
        self.statistic != Statistic::Mean
    }

    fn check<'a>(&'a self, faults: &mut Faults<'a>) {
        let share = self.metric.0.iter().any(|m| Metric::named(m).is_share());
        self.bounds().check(share && self.relative_to.is_none(), faults);
        let mean = self.statistic == Statistic::Mean;
        faults.unless(mean || !share, "/statistic", || "a share has a mean only".to_owned());
        faults.unless(mean || self.relative_to.is_none(), "/statistic", || {
            "relative differences are of means".to_owned()
        });
        let low = self.low.into_iter().chain(self.high).fold(0.0, f64::min);
        faults.unless(self.relative_to.is_none() || low > -1.0, "/low", || {
            format!("a relative difference is above -1, found {low}")
        });
    }

    fn judge(&self, bench: &Bench<'_>) -> Vec<Draft> {
        let mut drafts = Vec::new();
        for name in &self.metric.0 {
            let metric = Metric::named(name);
            for pins in self.for_each.combinations() {
                let cell = self.r#where.pinned(&pins);
                let base = self.relative_to.as_ref().map(|base| base.pinned(&pins));
                let (about, test) = self.about(&metric, &cell, base.as_ref());
                let cells: Vec<Where> = [cell].into_iter().chain(base).collect();
                drafts.push(bench.draft(about, test, &cells, &metric, |about, groups| {
                    self.weigh(bench, about, groups)
                }));
            }
        }
        drafts
    }
}

fn mean_level(group: &Group, bounds: Bounds, confidence: f64) -> Result<Evidence, CannotTest> {
    varies(&[group])?;
    let (p_for, p_against) = bounds.hold(|bound| {
        let t = (group.summary.mean - bound) / group.summary.variance_of_mean().sqrt();
        let df = real(group.summary.n) - 1.0;
        (student_t_sf(t, df), student_t_sf(-t, df))
    });
    let interval = mean_interval(group.summary, confidence);
    let effect = EffectSize::new("mean", group.summary.mean, interval);
    Ok(Evidence { p_for, p_against, statistics: Vec::new(), effect: Some(effect) })
}

/// Looks whether the least value lies within the bounds; its interval is of what other runs would have had for theirs.
fn least_level(
    bench: &Bench<'_>,
    about: &str,
    group: &Group,
    bounds: Bounds,
) -> Result<Evidence, CannotTest> {
    if group.values.is_empty() {
        return Err(CannotTest::NoCell);
    }
    let least = |values: &[f64]| values.iter().copied().fold(f64::INFINITY, f64::min);
    let found = bootstrap(
        &[&group.values],
        |drawn| least(&drawn[0]),
        bench.context.resamples,
        bench.confidence(),
        &mut bench.stream(about),
    );
    let is_within = bounds.low.is_none_or(|low| low <= found.estimate)
        && bounds.high.is_none_or(|high| found.estimate <= high);
    let (p_for, p_against) = if is_within { (0.0, 1.0) } else { (1.0, 0.0) };
    let effect = EffectSize::new("least", found.estimate, found.interval);
    Ok(Evidence { p_for, p_against, statistics: Vec::new(), effect: Some(effect) })
}

/// Weighs a quantile without any distribution: of n values, the number below the true q-quantile is binomial (n, q).
fn quantile_level(
    bench: &Bench<'_>,
    about: &str,
    group: &Group,
    q: f64,
    bounds: Bounds,
) -> Evidence {
    let n = group.values.len() as u64;
    let (p_for, p_against) = bounds.hold(|bound| {
        let above_it = group.values.iter().filter(|&&x| x > bound).count() as u64;
        let below_it = group.values.iter().filter(|&&x| x < bound).count() as u64;
        (binomial_sf_inclusive(above_it, n, 1.0 - q), binomial_sf_inclusive(below_it, n, q))
    });
    let found = bootstrap(
        &[&group.values],
        |drawn| quantile(&drawn[0], q),
        bench.context.resamples,
        bench.confidence(),
        &mut bench.stream(about),
    );
    let name = if q == 0.5 { "median" } else { "p95" };
    let effect = EffectSize::new(name, found.estimate, found.interval);
    Evidence { p_for, p_against, statistics: Vec::new(), effect: Some(effect) }
}

/// Weighs the relative difference by the logarithm of the ratio and its delta-method variance: of shares (Katz et al.
/// 1978) normal, of means with Satterthwaite's degrees of freedom.
fn relative(
    bench: &Bench<'_>,
    a: &Group,
    b: &Group,
    bounds: Bounds,
) -> Result<Evidence, CannotTest> {
    let (ma, mb) = (a.summary.mean, b.summary.mean);
    if !(ma > 0.0 && mb > 0.0) {
        return Err(CannotTest::NotPositive);
    }
    let (va, vb, df) = if let Some((p, q)) = a.proportion.zip(b.proportion) {
        let va = (1.0 - p.share()) / real(p.successes);
        let vb = (1.0 - q.share()) / real(q.successes);
        (va, vb, None)
    } else {
        varies(&[a, b])?;
        let va = a.summary.variance_of_mean() / (ma * ma);
        let vb = b.summary.variance_of_mean() / (mb * mb);
        let (sa, sb) = (va / (va + vb), vb / (va + vb));
        let df = sa * sa / (real(a.summary.n) - 1.0) + sb * sb / (real(b.summary.n) - 1.0);
        (va, vb, Some(1.0 / df))
    };
    let (ln_ratio, se) = (ln(ma / mb), (va + vb).sqrt());
    if se == 0.0 {
        return Err(CannotTest::RatioOfOnes);
    }
    let tail = |z: f64| df.map_or_else(|| normal_sf(z), |df| student_t_sf(z, df));
    let (p_for, p_against) = bounds.hold(|bound| {
        let z = (ln_ratio - ln_1p(bound)) / se;
        (tail(z), tail(-z))
    });
    let p = 0.5 + 0.5 * bench.confidence();
    let half = se * df.map_or_else(|| normal_quantile(p), |df| student_t_quantile(p, df));
    let interval = Interval {
        low: exp_m1(ln_ratio - half),
        high: exp_m1(ln_ratio + half),
        confidence: bench.confidence(),
    };
    let value = exp(ln_ratio) - 1.0;
    let effect = EffectSize::new("relative-difference", value, interval);
    Ok(Evidence { p_for, p_against, statistics: Vec::new(), effect: Some(effect) })
}
