//! Our cells beside the paper's: `correlation-with-published`, `rmse-with-published`.

use super::cells::Where;
use super::gather::{Bench, Draft, Evidence};
use super::measuring::{Correlation, Rmse};
use super::pairing::{Pair, Point, clusters, log_ratios, pair_up, printed};
use super::verdict::Effect;
use crate::math::ln;
use crate::stats::agreement;
use crate::stats::bootstrap::{Bootstrapped, bootstrap};
use crate::stats::distribution::{normal_sf, student_t_quantile};
use crate::stats::proportion::{Proportion, newcombe};
use crate::stats::rank::{midranks, pearson, spearman, spearman_interval, spearman_permutation};
use crate::stats::summary::mean;
use crate::stats::{length, real};
use std::collections::BTreeMap;

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
                .map(|p| Point { runs: &p.pins, x: p.published, y: p.ours.summary.mean, of: None })
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
    let ratio =
        form.ratio_to.as_ref().map(|base| format!(" as log ratio to ({base})")).unwrap_or_default();
    let about = format!(
        "{}{ratio} against published `{}`: root mean square difference at most {}",
        form.metric.0.join(" and "),
        form.published,
        form.at_most
    );
    let mut paired = pair_up(bench, &form.metric, &form.published, form.scale, &form.r#where);
    let mut notes = paired.notes;
    let evidence = paired.pairs.and_then(|pairs| match &form.ratio_to {
        None => {
            too_few(pairs.len(), form.minimum_n).map_or(Ok(()), Err)?;
            Ok(distance(bench, &about, &pairs, form))
        }
        Some(base) => {
            let (points, lost) = log_ratios(&pairs, base);
            if lost > 0 {
                notes.push(format!("{lost} cells have no positive base to take a ratio to"));
            }
            too_few(points.len(), form.minimum_n).map_or(Ok(()), Err)?;
            Ok(distance_of_ratios(bench, &about, &points, base, form.at_most))
        }
    });
    paired.cells.truncate(MOST_CELLS);
    let cells = paired.cells;
    Draft { about, test: "bootstrap-over-cells", cells, conditions: Vec::new(), evidence, notes }
}

/// The root of the mean of `squares` with its interval, `clusters` of them drawn together.
fn resampled(
    bench: &Bench<'_>,
    about: &str,
    squares: &[f64],
    clusters: &[Vec<usize>],
) -> Bootstrapped {
    let sums: Vec<f64> =
        clusters.iter().map(|places| places.iter().map(|&i| squares[i]).sum()).collect();
    let sizes: Vec<f64> = clusters.iter().map(|places| length(places)).collect();
    let places: Vec<f64> = (0..clusters.len()).map(|i| real(i as u64)).collect();
    bootstrap(
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
    )
}

/// Evidence that a root mean square difference is at most a bound, from its resamples.
fn bounded(found: &Bootstrapped, at_most: f64, statistics: Vec<(&'static str, f64)>) -> Evidence {
    let count =
        |holds: &dyn Fn(f64) -> bool| found.statistics.iter().filter(|&&x| holds(x)).count() as u64;
    let share = |n: u64| (real(n) + 1.0) / (length(&found.statistics) + 1.0);
    Evidence {
        p_for: share(count(&|x| x >= at_most)),
        p_against: share(count(&|x| x <= at_most)),
        statistics,
        effect: Some(Effect {
            name: "rmse",
            value: found.estimate,
            interval: found.interval,
            standardised: None,
        }),
    }
}

/// Log ratios: those with a base in common are one block, as whatever befell the base befell all of them.
fn distance_of_ratios(
    bench: &Bench<'_>,
    about: &str,
    points: &[Point<'_>],
    base: &Where,
    at_most: f64,
) -> Evidence {
    let (x, y): (Vec<f64>, Vec<f64>) = points.iter().map(|p| (p.x, p.y)).unzip();
    let squares: Vec<f64> = x.iter().zip(&y).map(|(x, y)| (x - y) * (x - y)).collect();
    let bases: Vec<BTreeMap<String, String>> = points
        .iter()
        .map(|point| {
            let mut pins = point.runs.clone();
            pins.retain(|factor, _| !base.0.contains_key(factor));
            pins
        })
        .collect();
    let blocks = clusters(bases.iter());
    let found = resampled(bench, about, &squares, &blocks);
    let line = agreement::line(
        &x.iter().copied().zip(y.iter().copied()).collect::<Vec<_>>(),
        &blocks,
        bench.confidence(),
    );
    let mut statistics = vec![
        ("cells", length(points)),
        ("independent-cells", length(&blocks)),
        ("bias", mean(&y) - mean(&x)),
        ("slope", line.slope),
        ("pearson", pearson(&x, &y)),
        ("spearman", spearman(&x, &y)),
        ("skill-over-constant", agreement::skill_over_constant(&y, &x)),
    ];
    let inside: Vec<f64> = points
        .iter()
        .filter_map(|point| {
            let (above, below) = point.of?;
            let (above, below) = (printed(above)?, printed(below)?);
            let half = agreement::log_ratio_half_width(above, below, 0.95);
            Some(f64::from(u8::from((point.y - point.x).abs() <= half)))
        })
        .collect();
    if !inside.is_empty() {
        statistics.push(("inside-prediction-interval", mean(&inside)));
        statistics.push(("cells-with-interval", length(&inside)));
    }
    bounded(&found, at_most, statistics)
}

fn distance(bench: &Bench<'_>, about: &str, pairs: &[Pair], form: &Rmse) -> Evidence {
    let differences: Vec<f64> = pairs.iter().map(|p| p.ours.summary.mean - p.published).collect();
    let squares: Vec<f64> = differences.iter().map(|d| d * d).collect();
    // Cells that are measured on the same runs are drawn together.
    let clusters = clusters(pairs.iter().map(|p| &p.pins));
    let found = resampled(bench, about, &squares, &clusters);
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
    bounded(&found, form.at_most, statistics)
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
