//! What an inference from trials found, as tables.

use super::checks::likeliest;
use super::columns::declared;
use super::posterior::{Answer, Held};
use super::{FromTrialsTable, ModelError, Part, Predicted, PrintedMean, words};
use crate::math::exp;
use crate::stats::importance::{effective_size, quantile};
use crate::stats::{length, real};
use crate::studies::exhibit::{Layout, Set};
use crate::studies::inference::rows::{Row, Shape, odds, of_rows, rounded};
use crate::studies::{Columns, Findings, TableRequest};
use crate::table::Value;

/// Combinations that readers see; the tidy form has all.
const SHOWN: usize = 10;
/// Probability from which on an alternative of what cells have in common is still entertained.
const ENTERTAINED: f64 = 0.01;

impl Layout for FromTrialsTable {
    type Cell = Row;

    fn cells(&self, findings: &Findings<'_>, _: &[TableRequest]) -> Vec<Row> {
        let Some(answer) = Answer::of(findings) else { return Vec::new() };
        match self.show {
            Part::Summary => summary(&answer),
            Part::Choices => choices(&answer),
            Part::Combinations => combinations(&answer),
            Part::Cells => cells(&answer),
            Part::HeldOut => answer.held_out().iter().map(held_out).collect(),
            Part::Simulated => simulated(&answer),
            Part::Replicate => replicate(&answer),
        }
    }

    fn columns<'a>(&'a self, findings: &Findings<'_>) -> Columns<'a, Row> {
        of_rows(declared(self.show, findings.from_trials).0)
    }

    fn set(&self, cells: &[Row], findings: &Findings<'_>) -> Set {
        let (declared, keys) = declared(self.show, findings.from_trials);
        let most = if self.show == Part::Combinations { SHOWN } else { usize::MAX };
        Shape { declared, keys, most, about: "From trials", decimals: 2 }.set(cells)
    }

    fn answer(&self, cells: &[Row]) -> Option<String> {
        match self.show {
            Part::Summary => words::summary(cells),
            Part::Choices => words::choices(cells),
            Part::Combinations => None,
            Part::Cells => words::never_matched(cells),
            Part::HeldOut => words::held_out(cells),
            Part::Simulated => words::simulated(cells),
            Part::Replicate => words::replicate(cells),
        }
    }
}

fn count(number: usize) -> Value {
    i64::try_from(number).unwrap_or(i64::MAX).into()
}

fn summary(answer: &Answer<'_>) -> Vec<Row> {
    let weights = answer.weights();
    let best = likeliest(&weights);
    let distances = answer.distances();
    let alike = vec![1.0; distances.len()];
    let at = |share: f64| 100.0 * quantile(&distances, &alike, share);
    let (cells, table) = (answer.model.trained(|_| true), answer.model.table());
    let fit = Answer::distance(&cells, &table, |cell| answer.expected(cell, &weights));
    let errors = answer.errors();
    let allowed = answer.question().errors();
    let over = |of: &dyn Fn(&ModelError) -> f64| -> f64 {
        errors.iter().zip(&allowed).map(|(weight, error)| weight * of(error)).sum()
    };
    let largest = allowed.iter().map(|error| error.cell).fold(0.0, f64::max);
    let made = answer.simulated();
    let nearer = distances.iter().filter(|distance| **distance <= fit).count();
    let runs: u64 = answer.combinations().iter().map(|own| own.runs).sum();
    let mut rows: Vec<Row> = Vec::new();
    let mut row = |what: &str, value: f64, unit: &str| {
        let what = if unit.is_empty() { what.to_owned() } else { format!("{what} ({unit})") };
        rows.push(vec![what.into(), rounded(value)]);
    };
    row("combinations", length(answer.combinations()), "");
    row("runs of them", real(runs), "");
    row("cells that count", length(&cells), "");
    row("effective number of combinations", effective_size(&weights), "");
    row("largest weight", weights[best], "");
    row("error of a cell, posterior mean", 100.0 * over(&|error| error.cell), "%");
    row("error that cells of an arm have in common", 100.0 * over(&|error| error.arm), "%");
    row("error that all cells have in common", 100.0 * over(&|error| error.table), "%");
    let at_end = over(&|error| f64::from(u8::from(error.cell >= largest)));
    row("probability of the largest error of a cell allowed", at_end, "");
    row("distance of the posterior's expectations to the print", 100.0 * fit, "%");
    row("distance of the likeliest combination", 100.0 * distances[best], "%");
    row("distance of a combination, least", at(0.0), "%");
    row("distance of a combination, 5 %", at(0.05), "%");
    row("distance of a combination, median", at(0.5), "%");
    row(
        "share of combinations as near as the posterior's expectations",
        real(nearer as u64) / length(&distances),
        "",
    );
    row(
        "share of tables made by the prior that are farther from it than the print",
        answer.prior_tail(&made),
        "",
    );
    row("logarithm of the evidence", Answer::ln_evidence(&answer.ln_likelihoods), "");
    rows.push(vec![
        format!("combination of the largest weight: {}", answer.named(best)).into(),
        rounded(weights[best]),
    ]);
    rows
}

fn choices(answer: &Answer<'_>) -> Vec<Row> {
    let (before, after) = (answer.before(), answer.weights());
    let each = answer.question().choices.iter().enumerate();
    let mut assumed = answer.by_shared_error();
    assumed.retain(|(probability, _)| *probability >= ENTERTAINED);
    let rows = |(index, choice): (usize, &super::Choice)| {
        let [before, after] = [&before, &after].map(|weights| answer.probabilities(index, weights));
        let mut rows = odds(&choice.name, &choice.values, &before, &after, choice.literal);
        for (value, row) in rows.iter_mut().enumerate() {
            let by = assumed.iter().map(|(_, weights)| answer.probabilities(index, weights)[value]);
            let (least, most) =
                by.fold((1.0_f64, 0.0_f64), |(least, most), own| (least.min(own), most.max(own)));
            row.extend([rounded(least), rounded(most)]);
        }
        rows
    };
    each.flat_map(rows).collect()
}

fn combinations(answer: &Answer<'_>) -> Vec<Row> {
    let (weights, distances) = (answer.weights(), answer.distances());
    let mut order: Vec<usize> = (0..weights.len()).collect();
    order.sort_by(|a, b| weights[*b].total_cmp(&weights[*a]));
    let counted = answer.model.trained(|_| true);
    let mut sum = 0.0;
    let mut row = |(rank, index): (usize, usize)| {
        let own = &answer.combinations()[index];
        sum += weights[index];
        let mut row: Row = vec![count(rank + 1)];
        row.extend(answer.named(index).iter().map(|(_, value)| Value::from(value.as_str())));
        row.extend([rounded(weights[index]), rounded(sum), rounded(100.0 * distances[index])]);
        row.push(count(counted.iter().filter(|cell| own.cells[**cell].is_none()).count()));
        row.push(i64::try_from(own.runs).unwrap_or(i64::MAX).into());
        row
    };
    order.into_iter().enumerate().map(&mut row).collect()
}

fn cells(answer: &Answer<'_>) -> Vec<Row> {
    let each = |(cell, predicted): (&PrintedMean, Option<Predicted>)| {
        let mut row: Row = cell.levels.iter().map(|level| level.as_str().into()).collect();
        row.push(rounded(cell.mean));
        let number = |of: &dyn Fn(&Predicted) -> f64| predicted.as_ref().map_or(f64::NAN, of);
        row.extend([
            rounded(number(&|p| p.expected)),
            rounded(number(&|p| p.interval[0])),
            rounded(number(&|p| p.interval[1])),
            rounded(number(&|p| p.range[0])),
            rounded(number(&|p| p.range[1])),
            rounded(number(&|p| p.tail)),
        ]);
        row.push(cell.left_out.then(|| "yes".to_owned()).into());
        row
    };
    answer.question().observed.cells.iter().zip(answer.cells()).map(each).collect()
}

fn held_out(held: &Held<'_>) -> Row {
    vec![
        held.part.kind.as_str().into(),
        held.part.name.as_str().into(),
        count(held.cells),
        rounded(100.0 * held.rms),
        rounded(100.0 * held.constant),
        held.means.map_or(Value::Missing, |means| rounded(100.0 * means)),
        rounded(held.effective),
    ]
}

fn simulated(answer: &Answer<'_>) -> Vec<Row> {
    let made = answer.simulated();
    let name = |choice: Option<usize>| {
        choice.map_or("combination", |index| answer.question().choices[index].name.as_str())
    };
    answer
        .found(&made)
        .into_iter()
        .map(|found| {
            vec![
                name(found.choice).into(),
                count(made.len()),
                rounded(100.0 * found.likeliest),
                rounded(100.0 * found.by_chance),
                rounded(100.0 * found.promised),
                rounded(100.0 * found.covered),
                rounded(found.region),
            ]
        })
        .collect()
}

fn replicate(answer: &Answer<'_>) -> Vec<Row> {
    let found = answer.replicates();
    let quantiles = |values: &[f64]| {
        let alike = vec![1.0; values.len()];
        [0.05, 0.5, 0.95].map(|at| rounded(quantile(values, &alike, at)))
    };
    let best = answer
        .ln_likelihoods
        .iter()
        .map(|errors| crate::stats::importance::ln_mean_exp(errors))
        .fold(f64::NEG_INFINITY, f64::max);
    let evidence = Answer::ln_evidence(&answer.ln_likelihoods);
    let mut rows: Vec<Row> = Vec::new();
    let mut row = |what: &str, printed: f64, values: &[f64]| {
        let mut row: Row = vec![what.into(), Value::Missing, rounded(printed)];
        row.extend(quantiles(values));
        row.push(Value::Missing);
        rows.push(row);
    };
    row("log evidence, all combinations", evidence, &found.ln_evidence);
    row("log evidence, likeliest combination", best, &[]);
    row("log evidence, exact replicate in place of our runs", f64::NAN, &found.ln_exact);
    let against = |ours: f64| -> Vec<f64> { found.ln_exact.iter().map(|ln| ln - ours).collect() };
    row("log odds, exact replicate to all combinations", f64::NAN, &against(evidence));
    row("log odds, exact replicate to the likeliest", f64::NAN, &against(best));
    let weights = answer.weights();
    for (index, choice) in answer.question().choices.iter().enumerate() {
        let after = answer.probabilities(index, &weights);
        let drawn = &found.probabilities[index];
        let draws = drawn.first().map_or(0, Vec::len);
        for (value, name) in choice.values.iter().enumerate() {
            let wins = (0..draws).filter(|draw| {
                let shares: Vec<f64> = drawn.iter().map(|shares| shares[*draw]).collect();
                likeliest(&shares) == value
            });
            let share = 100.0 * real(wins.count() as u64) / real(draws as u64);
            let mut row: Row =
                vec![choice.name.as_str().into(), name.as_str().into(), rounded(after[value])];
            row.extend(quantiles(&drawn[value]));
            row.push(rounded(share));
            rows.push(row);
        }
    }
    rows
}

/// Returns odds as readers see them, from their logarithm.
pub(super) fn odds_in_words(ln_odds: f64) -> String {
    let odds = exp(ln_odds);
    if odds >= 1000.0 {
        format!("10^{:.0} to 1", ln_odds / std::f64::consts::LN_10)
    } else if odds >= 1.0 {
        format!("{odds:.1} to 1")
    } else {
        format!("1 to {:.1}", 1.0 / odds)
    }
}
