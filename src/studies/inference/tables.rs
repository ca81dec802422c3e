//! What an inference found, as tables.

use super::columns::declared;
use super::posterior::{Held, Predicted, PredictedTime};
use super::rows::{Row, Shape, odds, of_rows, rounded};
use super::words;
use super::{InferenceTable, Posterior, Prior, Shown, shown};
use crate::stats::importance::quantile;
use crate::stats::{length, real};
use crate::studies::exhibit::{Layout, Set};
use crate::studies::{Columns, Findings, TableRequest};
use crate::table::Value;

impl Layout for InferenceTable {
    type Cell = Row;

    fn cells(&self, findings: &Findings<'_>, _: &[TableRequest]) -> Vec<Row> {
        let Some(posterior) = Posterior::of(findings) else { return Vec::new() };
        match self.show {
            Shown::Summary => summary(&posterior),
            Shown::Choices => choices(&posterior),
            Shown::Numbers => numbers(&posterior),
            Shown::Cells => cells(&posterior),
            Shown::Times => times(&posterior),
            Shown::HeldOut => held_out(&posterior),
            Shown::Simulated => simulated(&posterior),
            Shown::Posterior => draws(&posterior, findings),
        }
    }

    fn columns<'a>(&'a self, findings: &Findings<'_>) -> Columns<'a, Row> {
        of_rows(declared(self.show, findings))
    }

    fn set(&self, cells: &[Row], findings: &Findings<'_>) -> Set {
        let most = if self.show == Shown::Posterior { 5 } else { usize::MAX };
        Shape {
            declared: declared(self.show, findings),
            keys: keys(self.show, findings),
            most,
            about: "At graph level",
            decimals: if matches!(self.show, Shown::Numbers | Shown::Posterior) { 4 } else { 2 },
        }
        .set(cells)
    }

    fn answer(&self, cells: &[Row]) -> Option<String> {
        match self.show {
            Shown::Summary => words::summary_in_words(cells),
            Shown::Cells => Some(words::never_matched(cells)),
            Shown::Times => Some(words::times_never_matched(cells)),
            Shown::Choices => Some(words::literal_in_words(cells)),
            Shown::HeldOut => words::held_in_words(cells),
            Shown::Simulated => words::simulated_in_words(cells),
            Shown::Numbers | Shown::Posterior => None,
        }
    }
}

/// Returns how many columns name a row.
fn keys(show: Shown, findings: &Findings<'_>) -> usize {
    match show {
        Shown::Summary | Shown::Numbers | Shown::Simulated | Shown::Posterior => 1,
        Shown::Choices | Shown::HeldOut => 2,
        Shown::Cells | Shown::Times => {
            Posterior::of(findings).map_or(1, |p| p.inference().observed.factors.len())
        }
    }
}

fn summary(posterior: &Posterior<'_>) -> Vec<Row> {
    let (tried, effective, largest) = posterior.worth();
    let draws = posterior.draws();
    let of_draws: Vec<f64> = draws.iter().map(|kept| posterior.distance(kept.drawn)).collect();
    let of_prior: Vec<f64> =
        posterior.prior().iter().map(|drawn| posterior.distance(drawn)).collect();
    let at = |values: &[f64], share: f64| quantile(values, &vec![1.0; values.len()], share);
    let mut rows: Vec<Row> = Vec::new();
    let mut row = |what: &str, value: f64, unit: &str| {
        let value = value.is_finite().then_some(value);
        let what = if unit.is_empty() { what.to_owned() } else { format!("{what} ({unit})") };
        rows.push(vec![what.into(), value.map(crate::studies::findings::rounded).into()]);
    };
    row("proposals", real(tried as u64), "");
    row("effective number of proposals", effective, "");
    row("largest weight", largest, "");
    row("distance of the posterior's expectations to the print", posterior.fit(), "points");
    row("distance of a posterior draw, median", at(&of_draws, 0.5), "points");
    row("distance of a prior draw, least", at(&of_prior, 0.0), "points");
    row("distance of a prior draw, 5 %", at(&of_prior, 0.05), "points");
    row("distance of a prior draw, median", at(&of_prior, 0.5), "points");
    let closer = of_prior.iter().filter(|d| **d <= at(&of_draws, 0.5)).count();
    row(
        "share of prior draws as near as the median posterior draw",
        real(closer as u64) / length(&of_prior),
        "",
    );
    row(
        "share of tables made by prior draws that are farther from the prior than the print",
        posterior.prior_tail(),
        "",
    );
    row("logarithm of the evidence", posterior.ln_evidence(), "");
    let likeliest = posterior.likeliest().map(ToString::to_string).unwrap_or_default();
    rows.push(vec![
        format!("building of the largest weight: {likeliest}").into(),
        Value::from(crate::studies::findings::rounded(largest)),
    ]);
    rows
}

fn choices(posterior: &Posterior<'_>) -> Vec<Row> {
    let priors = posterior.inference().priors.iter().enumerate();
    let rows = |(index, prior): (usize, &Prior)| {
        let values: Vec<String> = prior.values().iter().map(shown).collect();
        let before = vec![1.0 / length(&values).max(1.0); values.len()];
        let after = posterior.probabilities(index);
        odds(&prior.path, &values, &before, &after, prior.literal)
    };
    priors.flat_map(rows).collect()
}

fn numbers(posterior: &Posterior<'_>) -> Vec<Row> {
    let inference = posterior.inference();
    let placed = posterior.shared().proposing().placements(inference).len();
    let draws = posterior.draws();
    let mut rows = Vec::new();
    for (index, prior) in inference.priors.iter().enumerate() {
        if !prior.is_continuous() {
            continue;
        }
        let after: Vec<f64> = draws.iter().map(|kept| kept.drawn.values[placed + index]).collect();
        let mut row: Row = vec![prior.path.as_str().into()];
        row.extend([0.05, 0.5, 0.95].map(|at| rounded(prior.at(at))));
        row.extend(
            [0.05, 0.5, 0.95].map(|at| rounded(quantile(&after, &vec![1.0; after.len()], at))),
        );
        rows.push(row);
    }
    rows
}

fn cells(posterior: &Posterior<'_>) -> Vec<Row> {
    let observed = &posterior.inference().observed;
    let each = |(cell, predicted): (&super::ObservedCell, Predicted)| {
        let mut row: Row = cell.levels.iter().map(|level| level.as_str().into()).collect();
        row.push(rounded(cell.percent()));
        row.push(rounded(predicted.expected));
        row.extend(predicted.interval.map(rounded));
        row.extend(predicted.range.map(rounded));
        row.push(rounded(predicted.tail));
        row.push(cell.left_out.then(|| "yes".to_owned()).into());
        row
    };
    observed.cells.iter().zip(posterior.cells()).map(each).collect()
}

fn times(posterior: &Posterior<'_>) -> Vec<Row> {
    let each = |(cell, predicted): (&super::ObservedCell, PredictedTime)| {
        let mut row: Row = cell.levels.iter().map(|level| level.as_str().into()).collect();
        row.push(cell.time_s.map_or(Value::Missing, rounded));
        row.push(rounded(predicted.expected));
        row.extend(predicted.interval.map(rounded));
        row.push(rounded(predicted.tail));
        row.push(cell.left_out.then(|| "yes".to_owned()).into());
        row
    };
    posterior.times().into_iter().map(each).collect()
}

fn held_out(posterior: &Posterior<'_>) -> Vec<Row> {
    let row = |held: Held| -> Row {
        vec![
            held.kind.as_str().into(),
            held.name.as_str().into(),
            i64::try_from(held.cells).unwrap_or_default().into(),
            rounded(held.rmse),
            rounded(held.constant),
            held.means.map_or(Value::Missing, rounded),
            rounded(held.effective),
        ]
    };
    posterior.held_out().into_iter().map(row).collect()
}

fn simulated(posterior: &Posterior<'_>) -> Vec<Row> {
    let each = |(path, ranks): (String, Vec<f64>)| -> Row {
        let known: Vec<f64> = ranks.into_iter().filter(|rank| rank.is_finite()).collect();
        let mean = known.iter().sum::<f64>() / length(&known);
        let variance = known.iter().map(|r| (r - mean) * (r - mean)).sum::<f64>()
            / (length(&known) - 1.0).max(1.0);
        let covered = known.iter().filter(|rank| (0.05..=0.95).contains(*rank)).count();
        vec![
            path.into(),
            i64::try_from(known.len()).unwrap_or_default().into(),
            rounded(mean),
            rounded(variance.sqrt()),
            rounded(100.0 * real(covered as u64) / length(&known)),
        ]
    };
    posterior.ranks().into_iter().map(each).collect()
}

fn draws(posterior: &Posterior<'_>, findings: &Findings<'_>) -> Vec<Row> {
    let inference = posterior.inference();
    let proposing = posterior.shared().proposing();
    let placed = proposing.placements(inference).len();
    let each = |(number, kept): (usize, super::posterior::Kept<'_>)| {
        let mut row: Row = vec![i64::try_from(number).unwrap_or_default().into()];
        row.push(rounded(kept.weight));
        row.extend(findings.factor_values(kept.condition));
        for value in &kept.drawn.values[..placed] {
            match proposing.place(kept.setup, *value) {
                Some((name, [x, y])) => row.extend([name.into(), rounded(x), rounded(y)]),
                None => row.extend([Value::Missing, Value::Missing, Value::Missing]),
            }
        }
        for (prior, value) in inference.priors.iter().zip(&kept.drawn.values[placed..]) {
            row.push(if prior.is_continuous() {
                rounded(*value)
            } else {
                shown(&prior.written(*value)).into()
            });
        }
        let concentration = inference.concentration.get(kept.drawn.trust()).copied();
        row.push(concentration.into());
        row.push(rounded(posterior.distance(kept.drawn)));
        row
    };
    posterior.draws().into_iter().enumerate().map(each).collect()
}
