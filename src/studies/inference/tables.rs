//! What an inference found, as tables.

use super::columns::declared;
use super::posterior::{Held, Predicted, PredictedTime};
use super::words;
use super::{InferenceTable, Posterior, Shown, shown};
use crate::stats::importance::quantile;
use crate::stats::{length, real};
use crate::studies::exhibit::{Grid, GridCell, GridRow, Layout, Lines, Measured, Set};
use crate::studies::{Columns, Findings, TableRequest};
use crate::table::{Column, Table, Value};

/// One row: what stands in the columns that the table declares.
pub(super) type Row = Vec<Value>;

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
        let declared = declared(self.show, findings);
        let each = |columns: Columns<'a, Row>, (at, column): (usize, Column)| {
            columns.with(column, move |row: &Row| row.get(at).cloned().unwrap_or(Value::Missing))
        };
        declared.into_iter().enumerate().fold(Columns::none(), each)
    }

    fn set(&self, cells: &[Row], findings: &Findings<'_>) -> Set {
        let declared = declared(self.show, findings);
        let keys = keys(self.show, findings);
        let mut lines = Table::new(declared.iter().map(|column| column.name.clone()));
        let most = if self.show == Shown::Posterior { 5 } else { usize::MAX };
        for row in cells.iter().take(most) {
            lines.push(row.iter().map(brief).collect());
        }
        let left: Vec<usize> = (0..declared.len())
            .filter(|at| cells.iter().any(|row| matches!(row.get(*at), Some(Value::Text(_)))))
            .collect();
        // A page has numbers in its cells, so that all words name the row.
        let naming: Vec<usize> =
            (0..declared.len()).filter(|at| *at < keys || left.contains(at)).collect();
        let numeric: Vec<usize> = (keys..declared.len())
            .filter(|at| cells.iter().any(|row| row[*at].as_f64().is_some()))
            .collect();
        let row = |row: &Row| GridRow {
            label: naming
                .iter()
                .filter(|at| row[**at] != Value::Missing)
                .map(|at| in_label(&declared[*at].name, &row[*at]))
                .collect::<Vec<_>>()
                .join(", "),
            cells: numeric
                .iter()
                .map(|at| GridCell {
                    ours: row[*at].as_f64().map(|mean| Measured { mean, sd: None, n: None }),
                    ..GridCell::default()
                })
                .collect(),
        };
        let meanings = numeric.iter().map(|at| {
            let Column { name, meaning, .. } = &declared[*at];
            format!("; {name}: {}{}", meaning[..1].to_lowercase(), &meaning[1..])
        });
        let grid = Grid {
            quantity: std::iter::once("At graph level".to_owned()).chain(meanings).collect(),
            decimals: if matches!(self.show, Shown::Numbers | Shown::Posterior) { 4 } else { 2 },
            row_header: naming
                .iter()
                .map(|at| declared[*at].name.as_str())
                .collect::<Vec<_>>()
                .join(", "),
            columns: numeric.iter().map(|at| declared[*at].name.clone()).collect(),
            rows: cells.iter().take(most).map(row).collect(),
            ..Grid::default()
        };
        Set {
            grid,
            print: None,
            lines: Lines::all(lines, keys, left),
            legend: Vec::new(),
            more: cells.len().saturating_sub(most),
        }
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

/// Returns a word as it stands in the name of a row: a bare `yes` says what is so.
fn in_label(column: &str, value: &Value) -> String {
    let word = value.to_string();
    if word == "yes" { column.to_owned() } else { word }
}

fn brief(value: &Value) -> Value {
    match value.as_f64() {
        Some(number) if number.fract() == 0.0 => value.clone(),
        // Hazards are small: two digits of them rather than none.
        Some(number) if number.abs() < 0.1 => {
            format!("{number:.1e}").parse::<f64>().unwrap_or(number).into()
        }
        Some(number) => format!("{number:.3}").into(),
        None => value.clone(),
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
    let mut rows = Vec::new();
    for (index, prior) in posterior.inference().priors.iter().enumerate() {
        let before = 1.0 / length(prior.values()).max(1.0);
        for (at, (value, after)) in
            prior.values().iter().zip(posterior.probabilities(index)).enumerate()
        {
            let odds = (after / (1.0 - after)) / (before / (1.0 - before));
            let literal = (prior.literal == Some(at)).then(|| "yes".to_owned());
            let number = |x: f64| x.is_finite().then(|| crate::studies::findings::rounded(x));
            rows.push(vec![
                prior.path.as_str().into(),
                shown(value).into(),
                number(before).into(),
                number(after).into(),
                number(odds).into(),
                literal.into(),
            ]);
        }
    }
    rows
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

fn rounded(number: f64) -> Value {
    number.is_finite().then(|| crate::studies::findings::rounded(number)).into()
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
