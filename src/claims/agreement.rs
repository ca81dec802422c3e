//! Our cells beside the paper's: `correlation-with-published`, `rmse-with-published`.

use super::cells::{Values, Where};
use super::gather::{Bench, Draft, Evidence, Group};
use super::measuring::{Correlation, Rmse};
use super::metric::Metric;
use super::published::{PublishedCell, read, selection};
use super::verdict::{CellNumbers, Effect};
use crate::math::ln;
use crate::stats::bootstrap::bootstrap;
use crate::stats::distribution::{normal_sf, student_t_quantile};
use crate::stats::proportion::{Proportion, newcombe};
use crate::stats::rank::{midranks, pearson, spearman, spearman_interval, spearman_permutation};
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
    reason = reason.or_else(|| unclear(metrics, published, &rows));
    for name in &metrics.0 {
        let metric = Metric::named(name);
        reason = reason.or_else(|| bench.observations.lacks(&metric));
        for row in &rows {
            let wanted = row.speaks_of(name)
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

/// What keeps the metrics of a claim from being found in a table, if anything does.
fn unclear(metrics: &Values, published: &str, rows: &[PublishedCell]) -> Option<String> {
    if rows.iter().all(|row| row.coverage.is_none()) {
        return None;
    }
    let mut quantities: Vec<&str> = Vec::new();
    for name in &metrics.0 {
        let Some((quantity, _)) = name.rsplit_once("-at-") else {
            return Some(format!(
                "the published table `{published}` tells coverages, and `{name}` is at none; name metrics as \
                 `{name}-at-80`"
            ));
        };
        if !quantities.contains(&quantity) {
            quantities.push(quantity);
        }
    }
    let told = rows.iter().all(|row| row.metric.is_some());
    (quantities.len() > 1 && !told).then(|| {
        format!(
            "the published table `{published}` holds one quantity, and the claim compares it with {}",
            quantities.join(" and ")
        )
    })
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
        let points = match &form.ratio_to {
            None => pairs
                .iter()
                .map(|p| Point { runs: &p.pins, x: p.published, y: p.ours.summary.mean })
                .collect(),
            Some(base) => {
                let (points, lost) = log_ratios(&pairs, base);
                if lost > 0 {
                    notes.push(format!("{lost} cells have no positive base to take a ratio to"));
                }
                points
            }
        };
        too_few(points.len(), form.minimum_n).map_or(Ok(()), Err)?;
        correlated(bench, &about, &points, form.at_least)
    });
    paired.cells.truncate(MOST_CELLS);
    Draft { about, test: "spearman", cells: paired.cells, conditions: Vec::new(), evidence, notes }
}

/// More cells than any paper prints; a bound on what a verdict lists.
const MOST_CELLS: usize = 1000;

/// A published number beside ours, and whose runs ours is of: several coverages are of the same runs.
struct Point<'a> {
    runs: &'a BTreeMap<String, String>,
    x: f64,
    y: f64,
}

/// The places of equal `runs`, in the order of their first: what is measured on the same runs is not independent.
fn clusters<'a>(runs: impl Iterator<Item = &'a BTreeMap<String, String>>) -> Vec<Vec<usize>> {
    let mut found: Vec<(&BTreeMap<String, String>, Vec<usize>)> = Vec::new();
    for (i, runs) in runs.enumerate() {
        match found.iter_mut().find(|(known, _)| *known == runs) {
            Some((_, places)) => places.push(i),
            None => found.push((runs, vec![i])),
        }
    }
    found.into_iter().map(|(_, places)| places).collect()
}

/// Log ratios to the base cell, published and ours, and how many cells have none.
fn log_ratios<'a>(pairs: &'a [Pair], base: &Where) -> (Vec<Point<'a>>, usize) {
    let pins = base.combinations().into_iter().next().unwrap_or_default();
    let (mut points, mut lost) = (Vec::new(), 0);
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
                points.push(Point {
                    runs: &pair.pins,
                    x: ln(pair.published / base.published),
                    y: ln(pair.ours.summary.mean / base.ours.summary.mean),
                });
            }
            _ => lost += 1,
        }
    }
    (points, lost)
}

/// Evidence that the rank correlation reaches a level: its interval (Bonett and Wright 2000) above the level,
/// and a permutation p-value against none at all. Cells that are measured on the same runs count as one in both:
/// the interval has the width that independent ones of their number would give, and their mean ranks are permuted.
fn correlated(
    bench: &Bench<'_>,
    about: &str,
    points: &[Point<'_>],
    level: f64,
) -> Result<Evidence, String> {
    let (x, y): (Vec<f64>, Vec<f64>) = points.iter().map(|p| (p.x, p.y)).unzip();
    let (x, y) = (&x[..], &y[..]);
    let r = spearman(x, y);
    if r.is_nan() {
        return Err("one side is the same in every cell, so there is no correlation".to_owned());
    }
    let clusters = clusters(points.iter().map(|p| p.runs));
    if clusters.len() < 4 {
        return Err(format!(
            "the cells are of {} independent conditions, fewer than the 4 that a correlation needs",
            clusters.len()
        ));
    }
    let mean_ranks = |values: &[f64]| -> Vec<f64> {
        let ranks = midranks(values);
        let of = |places: &Vec<usize>| mean(&places.iter().map(|&i| ranks[i]).collect::<Vec<_>>());
        clusters.iter().map(of).collect()
    };
    let mut stream = bench.stream(about);
    let permuted = spearman_permutation(
        &mean_ranks(x),
        &mean_ranks(y),
        bench.context.permutations,
        &mut stream,
    )
    .greater;
    let fisher = |r: f64| 0.5 * ln((1.0 + r) / (1.0 - r));
    let standard_error = ((1.0 + r * r / 2.0) / (length(&clusters) - 3.0)).sqrt();
    let z = (fisher(r) - fisher(level)) / standard_error;
    let (mx, my) = (mean(x), mean(y));
    let xy: f64 = x.iter().zip(y).map(|(a, b)| (a - mx) * (b - my)).sum();
    let xx: f64 = x.iter().map(|a| (a - mx) * (a - mx)).sum();
    Ok(Evidence {
        p_for: normal_sf(z).max(permuted),
        p_against: normal_sf(-z),
        statistics: vec![
            ("cells", length(x)),
            ("independent-cells", length(&clusters)),
            ("permutation-p", permuted),
            ("pearson", pearson(x, y)),
            ("slope", xy / xx),
        ],
        effect: Some(Effect {
            name: "spearman",
            value: r,
            interval: spearman_interval(r, clusters.len() as u64, bench.confidence()),
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
    // Cells that are measured on the same runs are drawn together.
    let clusters = clusters(pairs.iter().map(|p| &p.pins));
    let sums: Vec<f64> =
        clusters.iter().map(|places| places.iter().map(|&i| squares[i]).sum()).collect();
    let sizes: Vec<f64> = clusters.iter().map(|places| length(places)).collect();
    let places: Vec<f64> = (0..clusters.len()).map(|i| real(i as u64)).collect();
    let found = bootstrap(
        &[&places],
        |drawn| {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "places of clusters"
            )]
            let total = |of: &[f64]| drawn[0].iter().map(|&i| of[i as usize]).sum::<f64>();
            (total(&sums) / total(&sizes)).sqrt()
        },
        bench.context.resamples,
        bench.confidence(),
        &mut bench.stream(about),
    );
    let count =
        |holds: &dyn Fn(f64) -> bool| found.statistics.iter().filter(|&&x| holds(x)).count() as u64;
    let share = |n: u64| (real(n) + 1.0) / (length(&found.statistics) + 1.0);
    let mut statistics = vec![
        ("cells", length(pairs)),
        ("independent-cells", length(&clusters)),
        ("bias", mean(&differences)),
    ];
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
