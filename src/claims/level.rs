//! `between`, `share` and `every`: one quantity against bounds.

use super::cells::Where;
use super::gather::{Bench, COUNT, Draft, Evidence, Group, varies};
use super::measuring::{Bound, Every, Level, Share, That};
use super::metric::Metric;
use super::terms::{Censored, Statistic};
use super::verdict::Effect;
use crate::math::{exp, exp_m1, ln, ln_1p};
use crate::stats::Interval;
use crate::stats::bootstrap::bootstrap;
use crate::stats::distribution::{
    binomial_sf_inclusive, normal_quantile, normal_sf, student_t_quantile, student_t_sf,
};
use crate::stats::means::mean_interval;
use crate::stats::proportion::{Proportion, wilson};
use crate::stats::real;
use crate::stats::summary::quantile;

/// The bounds of a form.
#[derive(Clone, Copy)]
struct Bounds {
    low: Option<f64>,
    high: Option<f64>,
}

impl Bounds {
    /// p-values of "inside" and "outside" from those of "above" and "below" a bound.
    fn hold(self, tails: impl Fn(f64) -> (f64, f64)) -> (f64, f64) {
        let low = self.low.map(&tails);
        let high = self.high.map(|bound| {
            let (above, below) = tails(bound);
            (below, above)
        });
        if low.is_none() && high.is_none() {
            // Nothing is claimed, so nothing is shown.
            return (1.0, 1.0);
        }
        let given = || low.iter().chain(&high);
        (
            given().map(|(inside, _)| *inside).fold(0.0, f64::max),
            given().map(|(_, outside)| *outside).fold(1.0, f64::min),
        )
    }

    fn words(self) -> String {
        match (self.low, self.high) {
            (Some(low), Some(high)) => format!("between {low} and {high}"),
            (Some(low), None) => format!("at least {low}"),
            (None, Some(high)) => format!("at most {high}"),
            (None, None) => "anything".to_owned(),
        }
    }
}

pub(super) fn between(bench: &Bench<'_>, form: &Level) -> Vec<Draft> {
    let bounds = Bounds { low: form.low, high: form.high };
    let mut drafts = Vec::new();
    for name in &form.metric.0 {
        let metric = Metric::named(name);
        for pins in form.for_each.combinations() {
            let cell = form.r#where.pinned(&pins);
            let base = form.relative_to.as_ref().map(|base| base.pinned(&pins));
            let words = bounds.words();
            let (about, test) = match (&base, form.statistic) {
                (Some(base), _) => {
                    (format!("{metric}: ({cell}) relative to ({base}) {words}"), "log-ratio")
                }
                (None, Statistic::Mean) if metric.is_share() => {
                    (format!("{metric}: ({cell}) {words}"), "score")
                }
                (None, Statistic::Mean) => (format!("mean {metric}: ({cell}) {words}"), "t"),
                (None, Statistic::Median) => {
                    (format!("median {metric}: ({cell}) {words}"), "binomial")
                }
                (None, Statistic::P95) => (format!("p95 {metric}: ({cell}) {words}"), "binomial"),
            };
            let cells: Vec<Where> = [cell].into_iter().chain(base).collect();
            let gathered = bench.gather(&cells, &metric);
            let evidence = gathered.groups.and_then(|groups| match (&groups[..], form.statistic) {
                ([a, b], _) => relative(bench, a, b, bounds),
                ([a, ..], Statistic::Mean) => match a.proportion {
                    Some(share) => Ok(share_level(share, bounds, bench.confidence())),
                    None => mean_level(a, bounds, bench.confidence()),
                },
                ([a, ..], Statistic::Median) => Ok(quantile_level(bench, &about, a, 0.5, bounds)),
                ([a, ..], Statistic::P95) => Ok(quantile_level(bench, &about, a, 0.95, bounds)),
                ([], _) => Err("there is no cell to measure".to_owned()),
            });
            drafts.push(Draft {
                about,
                test,
                cells: gathered.numbers,
                conditions: gathered.conditions,
                evidence,
                notes: gathered.notes,
            });
        }
    }
    drafts
}

/// Score test of a share, which Wilson's interval inverts.
fn share_level(share: Proportion, bounds: Bounds, confidence: f64) -> Evidence {
    let (p_for, p_against) = bounds.hold(|bound| {
        let z = (share.share() - bound) / (bound * (1.0 - bound) / real(share.trials)).sqrt();
        // At 0 and 1 the score has no variance: the data are on the bound, or on its only side.
        if z.is_nan() { (0.5, 0.5) } else { (normal_sf(z), normal_sf(-z)) }
    });
    let interval = wilson(share, confidence);
    let effect = Effect { name: "share", value: share.share(), interval, standardised: None };
    Evidence { p_for, p_against, statistics: Vec::new(), effect: Some(effect) }
}

fn mean_level(group: &Group, bounds: Bounds, confidence: f64) -> Result<Evidence, String> {
    varies(&[group])?;
    let (p_for, p_against) = bounds.hold(|bound| {
        let t = (group.summary.mean - bound) / group.summary.variance_of_mean().sqrt();
        let df = real(group.summary.n) - 1.0;
        (student_t_sf(t, df), student_t_sf(-t, df))
    });
    let interval = mean_interval(group.summary, confidence);
    let effect = Effect { name: "mean", value: group.summary.mean, interval, standardised: None };
    Ok(Evidence { p_for, p_against, statistics: Vec::new(), effect: Some(effect) })
}

/// Distribution-free: of n values, the number below the true q-quantile is binomial (n, q).
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
    let effect =
        Effect { name, value: found.estimate, interval: found.interval, standardised: None };
    Evidence { p_for, p_against, statistics: Vec::new(), effect: Some(effect) }
}

/// Relative difference by the logarithm of the ratio and its delta-method variance: of shares (Katz et al.
/// 1978) normal, of means with Satterthwaite's degrees of freedom.
fn relative(bench: &Bench<'_>, a: &Group, b: &Group, bounds: Bounds) -> Result<Evidence, String> {
    let (ma, mb) = (a.summary.mean, b.summary.mean);
    if !(ma > 0.0 && mb > 0.0) {
        return Err("a relative difference needs two positive means".to_owned());
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
        return Err("both shares are one, so their ratio has no known spread".to_owned());
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
    let effect = Effect { name: "relative-difference", value, interval, standardised: None };
    Ok(Evidence { p_for, p_against, statistics: Vec::new(), effect: Some(effect) })
}

pub(super) fn share(bench: &Bench<'_>, form: &Share) -> Vec<Draft> {
    let bounds = Bounds { low: form.low, high: form.high };
    debug_assert_eq!(bench.terms.censored, Censored::Worst, "a run that never got there counts");
    let about = format!("share with {}", form.that);
    let cells = form.for_each.combinations();
    let cells = cells.iter().map(|pins| form.r#where.pinned(pins));
    cells
        .map(|cell| {
            let about = format!("{about}: ({cell}) {}", bounds.words());
            let level = |share| Ok(share_level(share, bounds, bench.confidence()));
            conditioned(bench, &cell, &form.that, about, "score", level)
        })
        .collect()
}

/// Nothing is estimated: a trial that does not meet the condition is there or not.
pub(super) fn every(bench: &Bench<'_>, form: &Every) -> Vec<Draft> {
    let cells = form.for_each.combinations();
    let cells = cells.iter().map(|pins| form.r#where.pinned(pins));
    cells
        .map(|cell| {
            let about = format!("every trial with {}: ({cell})", form.that);
            conditioned(bench, &cell, &form.that, about, COUNT, |share| {
                let all = share.successes == share.trials;
                let (p_for, p_against) = if all { (0.0, 1.0) } else { (1.0, 0.0) };
                Ok(Evidence { p_for, p_against, statistics: Vec::new(), effect: None })
            })
        })
        .collect()
}

/// Counts the trials of `cell` that meet a condition and weighs their share.
fn conditioned(
    bench: &Bench<'_>,
    cell: &Where,
    that: &That,
    about: String,
    test: &'static str,
    weigh: impl Fn(Proportion) -> Result<Evidence, String>,
) -> Draft {
    let metric = Metric::named(&that.metric);
    let gathered = bench.gather(std::slice::from_ref(cell), &metric);
    let mut cells = gathered.numbers;
    let evidence = gathered.groups.and_then(|_| {
        let share = met(bench, that, &metric, &gathered.conditions)?;
        for cell in &mut cells {
            cell.successes = Some(share.successes);
        }
        weigh(share)
    });
    Draft { about, test, cells, conditions: gathered.conditions, evidence, notes: gathered.notes }
}

/// How many of the trials that count meet `that`. A run that never reached the measure meets nothing, and counts
/// unless only those that did are looked at.
fn met(
    bench: &Bench<'_>,
    that: &That,
    metric: &Metric,
    conditions: &[usize],
) -> Result<Proportion, String> {
    let (mut met, mut counted) = (0, 0);
    for &i in conditions {
        let limit =
            |bound: &Option<Bound>| bound.as_ref().map(|bound| limit(bench, bound, i)).transpose();
        let (low, high) = (limit(&that.at_least)?, limit(&that.at_most)?);
        let meets = |reading: f64| {
            if metric.is_share() {
                return reading == 1.0;
            }
            low.is_none_or(|low| reading >= low) && high.is_none_or(|high| reading <= high)
        };
        for reading in bench.observations.readings(&[i], metric).values {
            counted +=
                u64::from(reading.is_some() || bench.terms.censored != Censored::ReachedOnly);
            met += u64::from(reading.is_some_and(meets));
        }
    }
    Ok(Proportion::new(met, counted))
}

/// A bound in one condition.
fn limit(bench: &Bench<'_>, bound: &Bound, condition: usize) -> Result<f64, String> {
    match bound {
        Bound::Number(number) => Ok(*number),
        Bound::Factor(factor) => {
            let value = bench.observations.value(condition, factor);
            value.and_then(|text| text.parse().ok()).ok_or_else(|| {
                format!(
                    "the factor `{factor}` is no number in ({})",
                    bench.observations.name(condition)
                )
            })
        }
    }
}
