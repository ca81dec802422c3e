//! `spread`: how far cell means lie apart.

use super::cells::Where;
use super::gather::{Bench, Draft, Evidence, Group, varies};
use super::measuring::Spread;
use super::metric::Metric;
use super::verdict::Effect;
use crate::stats::bootstrap::{bootstrap, bootstrap_shares};
use crate::stats::proportion::Proportion;
use crate::stats::real;
use crate::stats::summary::mean;

/// Largest less smallest mean.
fn spread_of(means: &[f64]) -> f64 {
    let most = means.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    most - means.iter().copied().fold(f64::INFINITY, f64::min)
}

/// By resampling trials within cells. A spread of noisy means is biased upwards, the more so the fewer trials;
/// between two pools of equal size the bias about cancels, against a bound it makes the test cautious.
pub(super) fn spread(bench: &Bench<'_>, form: &Spread) -> Vec<Draft> {
    let mut drafts = Vec::new();
    for name in &form.metric.0 {
        let metric = Metric::named(name);
        for pins in form.for_each.combinations() {
            let base = form.r#where.pinned(&pins);
            let cells_of = |base: &Where| -> Vec<Where> {
                form.across.combinations().iter().map(|cell| base.pinned(cell)).collect()
            };
            let mut cells = cells_of(&base);
            let first = cells.len();
            let (about, limit) = match (&form.than, form.at_most) {
                (Some(other), _) => {
                    let other = base.replaced(other);
                    cells.extend(cells_of(&other));
                    let across = &form.across;
                    (format!("spread of {metric} across {across}: ({base}) < ({other})"), 0.0)
                }
                (None, limit) => {
                    let limit = limit.unwrap_or(f64::INFINITY);
                    let across = &form.across;
                    (format!("spread of {metric} across {across}: ({base}) at most {limit}"), limit)
                }
            };
            let gathered = bench.gather(&cells, &metric);
            let evidence =
                gathered.groups.and_then(|groups| resampled(bench, &about, &groups, first, limit));
            drafts.push(Draft {
                about,
                test: "bootstrap",
                cells: gathered.numbers,
                conditions: gathered.conditions,
                evidence,
                notes: gathered.notes,
            });
        }
    }
    drafts
}

fn resampled(
    bench: &Bench<'_>,
    about: &str,
    groups: &[Group],
    first: usize,
    limit: f64,
) -> Result<Evidence, String> {
    if first < 2 {
        return Err("one cell has no spread".to_owned());
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
        effect: Some(Effect {
            name: if compared { "spread-difference" } else { "spread" },
            value: found.estimate,
            interval: found.interval,
            standardised: None,
        }),
    })
}
