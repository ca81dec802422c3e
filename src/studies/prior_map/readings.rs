//! Which reading explains the printed tables: what each leaves of a cell unexplained, beside what an exact replicate and two
//! blind guesses would.

mod layout;

use super::agreement::{RESAMPLES, TableAgreement, agreement, arms_stream};
use super::requests::{CoverageTable, Metric, ReadingsTable};
use super::results::CoverageCell;
use crate::math::{exp, ln};
use crate::rng::Seeds;
use crate::stats::compatibility::{Agreement, Ours, Printed};
use crate::stats::real;
use crate::stats::summary::{Summary, mean};
use crate::stats::unexplained::{Difference, unexplained};
use crate::studies::Findings;
use std::collections::BTreeSet;

/// Whose numbers stand in for a reading's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Whose {
    /// Our runs of the reading.
    Ours,
    /// Made up: those of a laboratory that repeats the paper's experiment exactly, with as many runs as ours.
    Replicate,
    /// Made up: a guess that looks at no run.
    Guess,
}

impl Whose {
    /// Returns the name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ours => "ours",
            Self::Replicate => "replicate",
            Self::Guess => "guess",
        }
    }
}

/// How near one reading comes to the printed cells of one table.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadingScore {
    /// `all` of the table, or the factor's value that the part has.
    pub scope: String,
    /// Id of the coverage table; [`SPEED`] for the mean speeds behind two of them.
    pub quantity: String,
    /// The reading, or what stands in for one.
    pub reading: String,
    /// Whose numbers these are.
    pub whose: Whose,
    /// Cells with a mean on both sides.
    pub cells: u64,
    /// tau, and the interval of it; `None` of speeds, whose spread is not printed.
    pub tau: Option<(f64, Option<(f64, f64)>)>,
    /// In what share of resampled arms this reading is the nearest of ours; `None` where readings have cells in other arms.
    pub nearest: Option<f64>,
    /// Mean log of our cells over the paper's.
    pub bias: f64,
    /// Root mean square of that log.
    pub rms: f64,
    /// How many cells lie inside the paper's prediction interval, of how many.
    pub inside: Option<(u64, u64)>,
    /// Slope, Pearson's correlation, score and skill of the log ratios to the baseline.
    pub ratios: Option<[f64; 4]>,
    /// Median of our standard deviation over the paper's.
    pub spread: Option<f64>,
}

/// The quantity of distance over time.
pub const SPEED: &str = "speed";

/// Draws of an exact replicate.
const REPLICATES: u32 = 40;

/// One part of a table, for one reading or for what stands in.
struct Part<'a> {
    scope: &'a str,
    id: &'a str,
    table: &'a CoverageTable,
    readings: &'a [String],
}

impl Part<'_> {
    fn agreement(&self, cells: &[CoverageCell], among: &[CoverageCell]) -> TableAgreement {
        let baseline = self.table.baseline.as_ref().map(|baseline| baseline.0.as_str());
        agreement(self.id, (self.scope, self.scope), (cells, among), baseline, self.readings)
    }

    fn score(&self, reading: &str, whose: Whose, found: &TableAgreement) -> ReadingScore {
        let absolute = &found.absolute;
        let interval = absolute.unexplained.interval.map(|i| (i.low, i.high));
        ReadingScore {
            scope: self.scope.to_owned(),
            quantity: self.id.to_owned(),
            reading: reading.to_owned(),
            whose,
            cells: absolute.logs.len() as u64,
            tau: (!absolute.cells.is_empty()).then_some((absolute.unexplained.tau, interval)),
            nearest: None,
            bias: mean(&absolute.logs),
            rms: root_mean_square(&absolute.logs),
            inside: Some(found.cells_inside),
            ratios: (found.ratios > 0).then_some([
                found.line.slope,
                found.pearson,
                found.rmse,
                found.skill,
            ]),
            spread: Some(absolute.spread),
        }
    }
}

impl Findings<'_> {
    /// Scores the readings that a request compares, by the coverage tables that it names among `tables`.
    pub fn reading_scores(
        &self,
        wanted: &ReadingsTable,
        tables: &[(&str, &CoverageTable)],
    ) -> Vec<ReadingScore> {
        let mut scopes = vec![("all".to_owned(), None)];
        for factor in &wanted.within {
            let values = self.values_of(factor);
            // One value is the whole once more.
            let several = values.len() > 1;
            scopes.extend(
                values
                    .into_iter()
                    .filter(|_| several)
                    .map(|value| (format!("{factor}={value}"), Some((factor.clone(), value)))),
            );
        }
        let mut found = Vec::new();
        for (scope, only) in &scopes {
            let named = tables.iter().filter(|(id, _)| wanted.tables.iter().any(|t| t == id));
            let mut by_metric: Vec<(Metric, Vec<CoverageCell>)> = Vec::new();
            for (id, table) in named {
                let in_scope = |cell: &CoverageCell| {
                    wanted.only.iter().all(|(f, v)| cell.rows.value(f) == Some(v.0.as_str()))
                        && only.as_ref().is_none_or(|level| cell.rows.contains(level))
                };
                let cells: Vec<CoverageCell> =
                    self.coverage_cells(table).into_iter().filter(in_scope).collect();
                let readings = self.readings(table);
                let part = Part { scope, id, table, readings: &readings };
                found.extend(self.scores_of(&wanted.by, &part, &cells));
                by_metric.push((table.metric, cells));
            }
            let of = |metric| by_metric.iter().find(|(known, _)| *known == metric);
            if let (Some((_, way)), Some((_, time))) = (of(Metric::DistanceM), of(Metric::TimeS)) {
                for reading in self.values_of(&wanted.by) {
                    found.extend(speeds(scope, (&wanted.by, &reading), way, time));
                }
            }
        }
        found
    }

    fn scores_of(&self, by: &str, part: &Part<'_>, cells: &[CoverageCell]) -> Vec<ReadingScore> {
        let levels = self.values_of(by);
        let of_level = |level: &String| {
            let level = (by.to_owned(), level.clone());
            cells.iter().filter(|cell| cell.rows.contains(&level)).cloned().collect::<Vec<_>>()
        };
        let parts: Vec<Vec<CoverageCell>> = levels.iter().map(of_level).collect();
        let agreements: Vec<TableAgreement> =
            parts.iter().map(|own| part.agreement(own, cells)).collect();
        let sets: Vec<_> = agreements.iter().map(|a| a.absolute.cells.clone()).collect();
        let paired = unexplained(&sets, RESAMPLES, 0.95, &mut arms_stream());
        let are_alike = on_the_same_arms(&sets);
        let mut scores = Vec::new();
        for ((level, agreement), paired) in levels.iter().zip(&agreements).zip(&paired) {
            if !agreement.absolute.logs.is_empty() {
                let own = part.score(level, Whose::Ours, agreement);
                scores.push(ReadingScore { nearest: are_alike.then_some(paired.nearest), ..own });
            }
        }
        // What the paper prints is the same whatever the reading; the fullest one says of which cells.
        let Some(fullest) =
            parts.iter().max_by_key(|own| own.iter().filter(|c| c.ours.is_some()).count())
        else {
            return scores;
        };
        scores.extend(replicate(part, fullest));
        scores.extend(guess(part, "as-without-prior", &as_without_prior(part.table, fullest)));
        scores.extend(guess(part, "one-number-a-coverage", &one_number(fullest)));
        scores
    }
}

/// Returns whether the sets that have cells have them in the same arms: only then is one nearer than another.
fn on_the_same_arms(sets: &[Vec<Difference>]) -> bool {
    let arms = |set: &Vec<Difference>| set.iter().map(|cell| cell.arm).collect::<BTreeSet<_>>();
    let mut found = sets.iter().filter(|set| !set.is_empty()).map(arms);
    let first = found.next();
    found.all(|arms| Some(&arms) == first.as_ref())
}

/// Returns a cell with `ours` in the place of our runs' summary.
fn with(cell: &CoverageCell, ours: Summary) -> CoverageCell {
    let printed = cell.published.map(|(value, sd, n)| Printed { value, sd, n: n.map(count) });
    CoverageCell {
        ours: Some(ours),
        trials: ours.n,
        agreement: Agreement::between(Ok(Ours::Mean(ours)), printed),
        tests: None,
        ..cell.clone()
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count of runs")]
fn count(n: f64) -> u64 {
    n.max(0.0) as u64
}

/// Scores exact replicates of the printed cells, as many runs each as ours: cells drawn about the printed means, each on its
/// own, by the printed spread. Means over the draws.
fn replicate(part: &Part<'_>, cells: &[CoverageCell]) -> Option<ReadingScore> {
    let mut stream = Seeds::new(0, Vec::new()).stream("readings/replicate");
    let mut draws: Vec<ReadingScore> = Vec::new();
    for _ in 0..REPLICATES {
        let drawn: Vec<CoverageCell> = cells
            .iter()
            .filter_map(|cell| {
                let (ours, (mean, sd, n)) = (cell.ours?, cell.published?);
                let (sd, n) = (sd?, n?);
                let error = sd * (1.0 / n + 1.0 / real(ours.n)).sqrt() / mean;
                let mean = mean * exp(error * stream.normal());
                Some(with(cell, Summary { n: ours.n, mean, sd }))
            })
            .collect();
        draws.push(part.score("exact-replicate", Whose::Replicate, &part.agreement(&drawn, cells)));
    }
    let over = |of: &dyn Fn(&ReadingScore) -> f64| {
        mean(&draws.iter().map(of).filter(|x| x.is_finite()).collect::<Vec<f64>>())
    };
    let first = draws.first().filter(|first| first.cells > 0)?;
    let taus = over(&|draw| draw.tau.map_or(f64::NAN, |tau| tau.0));
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "cells of a table")]
    let inside =
        over(&|draw| draw.inside.map_or(f64::NAN, |(inside, _)| real(inside))).round() as u64;
    let ratio =
        |i: usize| over(&move |draw: &ReadingScore| draw.ratios.map_or(f64::NAN, |all| all[i]));
    Some(ReadingScore {
        tau: Some((taus, None)),
        bias: over(&|draw| draw.bias),
        rms: over(&|draw| draw.rms),
        inside: first.inside.map(|(_, of)| (inside, of)),
        ratios: first.ratios.map(|_| [ratio(0), ratio(1), ratio(2), ratio(3)]),
        ..first.clone()
    })
}

fn guess(part: &Part<'_>, name: &str, cells: &[CoverageCell]) -> Option<ReadingScore> {
    let found = part.agreement(cells, cells);
    (!found.absolute.logs.is_empty()).then(|| ReadingScore {
        // A guess has no runs, whose number an interval would need, and no spread.
        inside: None,
        ratios: None,
        spread: None,
        ..part.score(name, Whose::Guess, &found)
    })
}

/// Guesses every printed cell with prior knowledge by the printed one without: knowledge moves nothing.
fn as_without_prior(table: &CoverageTable, cells: &[CoverageCell]) -> Vec<CoverageCell> {
    let Some(baseline) = table.baseline.as_ref().map(|baseline| baseline.0.as_str()) else {
        return Vec::new();
    };
    let without = |cell: &CoverageCell| {
        let base = cells.iter().find(|base| {
            base.by == baseline && base.rows == cell.rows && base.percent == cell.percent
        });
        base.and_then(|base| base.published)
    };
    let others = cells.iter().filter(|cell| cell.by != baseline && cell.published.is_some());
    let guessed = others.filter_map(|cell| {
        let (mean, sd, n) = without(cell)?;
        Some(with(cell, Summary { n: count(n?), mean, sd: sd? }))
    });
    guessed.collect()
}

/// Guesses every printed cell by the geometric mean of all printed cells at its coverage: a curve of growth, and nothing of
/// buildings or knowledge.
fn one_number(cells: &[CoverageCell]) -> Vec<CoverageCell> {
    let printed = |cell: &CoverageCell| cell.published.filter(|(mean, ..)| *mean > 0.0);
    let guessed = cells.iter().filter(|cell| cell.published.is_some()).map(|cell| {
        let alike = cells.iter().filter(|other| other.percent == cell.percent);
        let logs: Vec<f64> = alike.filter_map(printed).map(|(mean, ..)| ln(mean)).collect();
        // As if of very many runs without spread: all that it misses by is its own.
        with(cell, Summary { n: 1_000_000, mean: exp(mean(&logs)), sd: 0.0 })
    });
    guessed.collect()
}

/// Scores the mean speeds to each coverage, distance over time, which nobody tuned.
fn speeds(
    scope: &str,
    (by, reading): (&str, &str),
    way: &[CoverageCell],
    time: &[CoverageCell],
) -> Option<ReadingScore> {
    let level = (by.to_owned(), reading.to_owned());
    let logs: Vec<f64> = way
        .iter()
        .filter(|cell| cell.rows.contains(&level))
        .filter_map(|way| {
            let time = time.iter().find(|time| {
                time.rows == way.rows && time.by == way.by && time.percent == way.percent
            })?;
            let ours = way.ours?.mean / time.ours?.mean;
            let printed = way.published?.0 / time.published?.0;
            let log = ln(ours / printed);
            log.is_finite().then_some(log)
        })
        .collect();
    (!logs.is_empty()).then(|| ReadingScore {
        scope: scope.to_owned(),
        quantity: SPEED.to_owned(),
        reading: reading.to_owned(),
        whose: Whose::Ours,
        cells: logs.len() as u64,
        tau: None,
        nearest: None,
        bias: mean(&logs),
        rms: root_mean_square(&logs),
        inside: None,
        ratios: None,
        spread: None,
    })
}

fn root_mean_square(values: &[f64]) -> f64 {
    mean(&values.iter().map(|x| x * x).collect::<Vec<f64>>()).sqrt()
}

#[cfg(test)]
mod tests;
