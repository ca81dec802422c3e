//! Our cells beside the paper's: `correlation-with-published`, `rmse-with-published`.

use super::cells::{Values, Where};
use super::gather::{Bench, Draft, Evidence, Group};
use super::measuring::{Correlation, Rmse};
use super::metric::Metric;
use super::published::{read, selection};
use super::verdict::{CellNumbers, Effect};
use crate::math::ln;
use crate::stats::bootstrap::bootstrap;
use crate::stats::distribution::{normal_sf, student_t_quantile};
use crate::stats::proportion::{Proportion, newcombe};
use crate::stats::rank::{pearson, spearman, spearman_interval, spearman_permutation};
use crate::stats::summary::mean;
use crate::stats::{length, real};
use std::collections::BTreeMap;

/// A printed number with our runs of the same cell. Published numbers are in the metric's unit.
struct Pair {
    pins: BTreeMap<String, String>,
    metric: Metric,
    published: f64,
    sd: Option<f64>,
    n: Option<u64>,
    ours: Group,
}

/// Pairs in the order of the table, the numbers used, and notes on what has no counterpart.
struct Paired {
    pairs: Result<Vec<Pair>, String>,
    cells: Vec<CellNumbers>,
    notes: Vec<String>,
}

fn pair_up(
    bench: &Bench<'_>,
    metrics: &Values,
    published: &str,
    scale: f64,
    only: &Where,
) -> Paired {
    let (mut pairs, mut cells, mut reason) = (Vec::new(), Vec::new(), None);
    let (mut lacking, mut conditions) = (Vec::new(), Vec::new());
    let rows = bench
        .context
        .published
        .get(published)
        .ok_or_else(|| format!("there is no published table `{published}`"))
        .and_then(|table| {
            read(table, &bench.observations.factors)
                .map_err(|fault| format!("published table `{published}`: {fault}"))
        });
    let rows = match rows {
        Ok(rows) => rows,
        Err(fault) => return Paired { pairs: Err(fault), cells, notes: Vec::new() },
    };
    for name in &metrics.0 {
        let metric = Metric::named(name);
        reason = reason.or_else(|| bench.observations.lacks(&metric));
        for row in &rows {
            let wanted = row.metric.as_ref().is_none_or(|m| m == name)
                && only.admits(|factor| row.pins.get(factor).map(String::as_str));
            let (true, Some(value)) = (wanted, row.value) else { continue };
            let cell = selection(&row.pins);
            let (ours, mut numbers, fault) = bench.group(&cell, &metric);
            if numbers.reached == 0 && bench.observations.lacks(&metric).is_none() {
                lacking.push(cell.to_string());
            } else {
                reason = reason.or(fault);
                for &i in &ours.conditions {
                    if conditions.contains(&(i, name)) {
                        let name = bench.observations.name(i);
                        reason = reason
                            .or(Some(format!("two published cells pool the condition {name}")));
                    }
                    conditions.push((i, name));
                }
                let published = value * scale;
                numbers.cell = format!("{metric}: {}", numbers.cell);
                numbers.published = Some(published);
                cells.push(numbers);
                let sd = row.sd.map(|sd| sd * scale);
                let (metric, pins) = (metric.clone(), row.pins.clone());
                pairs.push(Pair { pins, metric, published, sd, n: row.n, ours });
            }
        }
    }
    let mut distinct: Vec<usize> = conditions.iter().map(|(i, _)| *i).collect();
    distinct.sort_unstable();
    distinct.dedup();
    reason = reason.or_else(|| bench.shared_noise(&distinct));
    let notes = if lacking.is_empty() {
        Vec::new()
    } else {
        vec![format!(
            "{} published cells have no runs to compare: {}",
            lacking.len(),
            lacking.join("; ")
        )]
    };
    Paired { pairs: reason.map_or(Ok(pairs), Err), cells, notes }
}

fn too_few(cells: usize, minimum: u64) -> Option<String> {
    ((cells as u64) < minimum.max(4))
        .then(|| format!("{cells} cells to compare, fewer than the minimum of {}", minimum.max(4)))
}

pub(super) fn correlation(bench: &Bench<'_>, form: &Correlation) -> Draft {
    let ratio =
        form.ratio_to.as_ref().map(|base| format!(" as log ratio to ({base})")).unwrap_or_default();
    let about = format!(
        "{}{ratio} against published `{}`: correlation at least {}",
        form.metric.0.join(" and "),
        form.published,
        form.at_least
    );
    let mut paired = pair_up(bench, &form.metric, &form.published, form.scale, &form.r#where);
    let mut notes = paired.notes;
    let evidence = paired.pairs.and_then(|pairs| {
        let (x, y) = match &form.ratio_to {
            None => pairs.iter().map(|p| (p.published, p.ours.summary.mean)).unzip(),
            Some(base) => {
                let (x, y, lost) = log_ratios(&pairs, base);
                if lost > 0 {
                    notes.push(format!("{lost} cells have no positive base to take a ratio to"));
                }
                (x, y)
            }
        };
        too_few(x.len(), form.minimum_n).map_or(Ok(()), Err)?;
        correlated(bench, &about, &x, &y, form.at_least)
    });
    paired.cells.truncate(MOST_CELLS);
    Draft { about, test: "spearman", cells: paired.cells, conditions: Vec::new(), evidence, notes }
}

/// More cells than any paper prints; a bound on what a verdict lists.
const MOST_CELLS: usize = 1000;

/// Log ratios to the base cell, published and ours, and how many cells have none.
fn log_ratios(pairs: &[Pair], base: &Where) -> (Vec<f64>, Vec<f64>, usize) {
    let pins = base.combinations().into_iter().next().unwrap_or_default();
    let (mut x, mut y, mut lost) = (Vec::new(), Vec::new(), 0);
    for pair in pairs {
        let mut wanted = pair.pins.clone();
        wanted.extend(pins.clone());
        if wanted == pair.pins {
            continue;
        }
        let base = pairs.iter().find(|p| p.pins == wanted && p.metric == pair.metric);
        match base {
            Some(base)
                if base.published > 0.0
                    && pair.published > 0.0
                    && base.ours.summary.mean > 0.0
                    && pair.ours.summary.mean > 0.0 =>
            {
                x.push(ln(pair.published / base.published));
                y.push(ln(pair.ours.summary.mean / base.ours.summary.mean));
            }
            _ => lost += 1,
        }
    }
    (x, y, lost)
}

/// Evidence that the rank correlation reaches a level: its interval (Bonett and Wright 2000) above the level,
/// and a permutation p-value against none at all.
fn correlated(
    bench: &Bench<'_>,
    about: &str,
    x: &[f64],
    y: &[f64],
    level: f64,
) -> Result<Evidence, String> {
    let r = spearman(x, y);
    if r.is_nan() {
        return Err("one side is the same in every cell, so there is no correlation".to_owned());
    }
    let mut stream = bench.stream(about);
    let permuted = spearman_permutation(x, y, bench.context.permutations, &mut stream).greater;
    let fisher = |r: f64| 0.5 * ln((1.0 + r) / (1.0 - r));
    let standard_error = ((1.0 + r * r / 2.0) / (length(x) - 3.0)).sqrt();
    let z = (fisher(r) - fisher(level)) / standard_error;
    let (mx, my) = (mean(x), mean(y));
    let xy: f64 = x.iter().zip(y).map(|(a, b)| (a - mx) * (b - my)).sum();
    let xx: f64 = x.iter().map(|a| (a - mx) * (a - mx)).sum();
    Ok(Evidence {
        p_for: normal_sf(z).max(permuted),
        p_against: normal_sf(-z),
        statistics: vec![
            ("cells", length(x)),
            ("permutation-p", permuted),
            ("pearson", pearson(x, y)),
            ("slope", xy / xx),
        ],
        effect: Some(Effect {
            name: "spearman",
            value: r,
            interval: spearman_interval(r, x.len() as u64, bench.confidence()),
            standardised: None,
        }),
    })
}

pub(super) fn rmse(bench: &Bench<'_>, form: &Rmse) -> Draft {
    let about = format!(
        "{} against published `{}`: root mean square difference at most {}",
        form.metric.0.join(" and "),
        form.published,
        form.at_most
    );
    let mut paired = pair_up(bench, &form.metric, &form.published, form.scale, &form.r#where);
    let evidence = paired.pairs.and_then(|pairs| {
        too_few(pairs.len(), form.minimum_n).map_or(Ok(()), Err)?;
        Ok(distance(bench, &about, &pairs, form))
    });
    paired.cells.truncate(MOST_CELLS);
    let (cells, notes) = (paired.cells, paired.notes);
    Draft { about, test: "bootstrap-over-cells", cells, conditions: Vec::new(), evidence, notes }
}

fn distance(bench: &Bench<'_>, about: &str, pairs: &[Pair], form: &Rmse) -> Evidence {
    let differences: Vec<f64> = pairs.iter().map(|p| p.ours.summary.mean - p.published).collect();
    let squares: Vec<f64> = differences.iter().map(|d| d * d).collect();
    let found = bootstrap(
        &[&squares],
        |drawn| mean(&drawn[0]).sqrt(),
        bench.context.resamples,
        bench.confidence(),
        &mut bench.stream(about),
    );
    let count =
        |holds: &dyn Fn(f64) -> bool| found.statistics.iter().filter(|&&x| holds(x)).count() as u64;
    let share = |n: u64| (real(n) + 1.0) / (length(&found.statistics) + 1.0);
    let mut statistics = vec![("cells", length(pairs)), ("bias", mean(&differences))];
    // What guesses score that know the paper's means and nothing else.
    let published: Vec<f64> = pairs.iter().map(|p| p.published).collect();
    let ours: Vec<f64> = pairs.iter().map(|p| p.ours.summary.mean).collect();
    let skill = |guess: &[f64]| {
        let errors: Vec<f64> =
            guess.iter().zip(&published).map(|(g, p)| (g - p) * (g - p)).collect();
        1.0 - mean(&squares) / mean(&errors)
    };
    statistics.push(("skill-over-constant", skill(&vec![mean(&published); pairs.len()])));
    if !form.baseline.is_empty() {
        let published_means = group_means(pairs, &published, &form.baseline);
        let our_means = group_means(pairs, &ours, &form.baseline);
        statistics.push(("skill-over-baseline-means", skill(&published_means)));
        let within = |values: &[f64], means: &[f64]| -> Vec<f64> {
            values.iter().zip(means).map(|(v, m)| v - m).collect()
        };
        let contrast = pearson(&within(&published, &published_means), &within(&ours, &our_means));
        statistics.push(("within-baseline-correlation", contrast));
    }
    let expected: Option<Vec<f64>> = pairs.iter().map(replicate_variance).collect();
    if let Some(expected) = expected {
        statistics.push(("replicate-rmse", mean(&expected).sqrt()));
    }
    let inside: Option<Vec<f64>> =
        pairs.iter().map(|p| predicted(p).map(|is| f64::from(u8::from(is)))).collect();
    if let Some(inside) = inside {
        statistics.push(("inside-prediction-interval", mean(&inside)));
    }
    Evidence {
        p_for: share(count(&|x| x >= form.at_most)),
        p_against: share(count(&|x| x <= form.at_most)),
        statistics,
        effect: Some(Effect {
            name: "rmse",
            value: found.estimate,
            interval: found.interval,
            standardised: None,
        }),
    }
}

/// For each pair the mean of `values` over the pairs that agree with it in `factors`.
fn group_means(pairs: &[Pair], values: &[f64], factors: &[String]) -> Vec<f64> {
    let key = |pair: &Pair| -> Vec<Option<String>> {
        let pins = factors.iter().map(|f| pair.pins.get(f).cloned());
        pins.chain([Some(pair.metric.to_string())]).collect()
    };
    let mut groups: BTreeMap<Vec<Option<String>>, Vec<f64>> = BTreeMap::new();
    for (pair, value) in pairs.iter().zip(values) {
        groups.entry(key(pair)).or_default().push(*value);
    }
    pairs.iter().map(|pair| mean(&groups[&key(pair)])).collect()
}

/// Variance of the difference between the paper's cell and an exact replicate of it with our runs.
fn replicate_variance(pair: &Pair) -> Option<f64> {
    let variance = if pair.metric.is_share() {
        pair.published * (1.0 - pair.published)
    } else {
        pair.sd? * pair.sd?
    };
    Some(variance * (1.0 / real(pair.n?) + 1.0 / length(&pair.ours.values)))
}

/// Whether our mean lies where the paper's spread and runs put 95 % of replicates.
fn predicted(pair: &Pair) -> Option<bool> {
    let n = pair.n?;
    if let Some(ours) = pair.ours.proportion {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a share of runs times runs"
        )]
        let successes = (pair.published.clamp(0.0, 1.0) * real(n)).round() as u64;
        let interval = newcombe(ours, Proportion::new(successes, n), 0.95);
        return Some(interval.low <= 0.0 && interval.high >= 0.0);
    }
    if n < 2 {
        return None;
    }
    let half = student_t_quantile(0.975, real(n) - 1.0) * replicate_variance(pair)?.sqrt();
    Some((pair.ours.summary.mean - pair.published).abs() <= half)
}
