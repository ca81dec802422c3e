//! Published cells, each with our runs of the same cell.

use crate::claims::cannot_test::CannotTest;
use crate::claims::cells::{Values, Where};
use crate::claims::gather::{Bench, Group};
use crate::claims::metric::Metric;
use crate::claims::published::{PublishedCell, read, selection};
use crate::claims::verdict::CellNumbers;
use crate::math::ln;
use crate::stats::summary::Summary;
use std::collections::BTreeMap;

/// A printed number with our runs of the same cell. Published numbers are in the metric's unit.
pub(super) struct Pair {
    pub(super) pins: BTreeMap<String, String>,
    pub(super) metric: Metric,
    pub(super) published: f64,
    pub(super) sd: Option<f64>,
    pub(super) n: Option<u64>,
    pub(super) ours: Group,
}

/// Pairs in the order of the table, the numbers used, and notes on what has no counterpart.
pub(super) struct Paired {
    pub(super) pairs: Result<Vec<Pair>, CannotTest>,
    pub(super) cells: Vec<CellNumbers>,
    pub(super) notes: Vec<String>,
}

pub(super) fn pair_up(
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
        .ok_or_else(|| CannotTest::NoPublishedTable(published.to_owned()))
        .and_then(|table| {
            read(table, &bench.observations.factors)
                .map_err(|error| CannotTest::PublishedTable { table: published.to_owned(), error })
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
                        reason = reason.or(Some(CannotTest::InTwoPublishedCells(name)));
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

/// Returns what keeps the metrics of a claim from being found in a table, if anything does.
fn unclear(metrics: &Values, published: &str, rows: &[PublishedCell]) -> Option<CannotTest> {
    if rows.iter().all(|row| row.coverage.is_none()) {
        return None;
    }
    let mut quantities: Vec<&str> = Vec::new();
    for name in &metrics.0 {
        let Some((quantity, _)) = name.rsplit_once("-at-") else {
            let (table, metric) = (published.to_owned(), name.clone());
            return Some(CannotTest::NoCoverage { table, metric });
        };
        if !quantities.contains(&quantity) {
            quantities.push(quantity);
        }
    }
    let named = rows.iter().all(|row| row.metric.is_some());
    (quantities.len() > 1 && !named).then(|| CannotTest::OneQuantity {
        table: published.to_owned(),
        quantities: quantities.join(" and "),
    })
}

/// A published number beside ours, and whose runs ours is of: several coverages are of the same runs.
pub(super) struct Point<'a> {
    pub(super) runs: &'a BTreeMap<String, String>,
    pub(super) x: f64,
    pub(super) y: f64,
    /// Of a log ratio: the two pairs it is of, that of the base last.
    pub(super) of: Option<(&'a Pair, &'a Pair)>,
}

impl<'a> Point<'a> {
    /// Returns a pair as it is.
    pub(super) fn of(pair: &'a Pair) -> Self {
        Self { runs: &pair.pins, x: pair.published, y: pair.ours.summary.mean, of: None }
    }
}

/// Returns the places of equal `runs`, in the order of their first: what is measured on the same runs is not independent.
pub(super) fn clusters<'a>(
    runs: impl Iterator<Item = &'a BTreeMap<String, String>>,
) -> Vec<Vec<usize>> {
    let mut found: Vec<(&BTreeMap<String, String>, Vec<usize>)> = Vec::new();
    for (i, runs) in runs.enumerate() {
        match found.iter_mut().find(|(known, _)| *known == runs) {
            Some((_, places)) => places.push(i),
            None => found.push((runs, vec![i])),
        }
    }
    found.into_iter().map(|(_, places)| places).collect()
}

/// Returns the log ratios to the base cell, published and ours, and how many cells have none.
pub(super) fn log_ratios<'a>(pairs: &'a [Pair], base: &Where) -> (Vec<Point<'a>>, usize) {
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
                    of: Some((pair, base)),
                });
            }
            _ => lost += 1,
        }
    }
    (points, lost)
}

/// Returns what the paper prints of a cell, with the number of our runs; `None` where it prints no spread or too few runs.
pub(super) fn printed(pair: &Pair) -> Option<(Summary, u64)> {
    let (sd, n) = (pair.sd?, pair.n.filter(|n| *n >= 2)?);
    Some((Summary { n, mean: pair.published, sd }, pair.ours.summary.n))
}
