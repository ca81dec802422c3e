//! From records to a table of whole trials' measures, as the numbers of section 4.5.

use super::requests::MeasuresTable;
use crate::condition::Condition;
use crate::stats::compatibility::{Agreement, Ours, Printed};
use crate::stats::summary::Summary;
use crate::studies::columns::{Columns, whole};
use crate::studies::exhibit::{Abreast, Grid, GridCell, Layout, Lines, Measured, Set, Source};
use crate::studies::{Findings, TableRequest};
use crate::table::Column;

/// Mean and spread of one measure in one cell of the design, beside the paper's.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasureCell {
    /// Values of the row's factors.
    pub rows: Condition,
    /// The measure.
    pub measure: String,
    /// Trials of this cell, whether or not they have the measure.
    pub trials: u64,
    /// Those that have it; `None` where none does.
    pub ours: Option<Summary>,
    /// The paper's mean, with its standard deviation and runs where it prints them.
    pub published: Option<Printed>,
    /// How ours agrees with it, or why it cannot.
    pub agreement: Agreement,
}

/// Returns the measure whose least value over trials `name` asks for: `least:distance-m`.
pub fn least_of(name: &str) -> Option<&str> {
    name.strip_prefix("least:")
}

impl Findings<'_> {
    /// Returns the cells of a table: rows that were run, then measures.
    pub fn measure_cells(&self, request: &MeasuresTable) -> Vec<MeasureCell> {
        let cell = |rows: &Condition, measure: &String| {
            let here = self.matching(rows);
            let recorded = least_of(measure).unwrap_or(measure);
            let values: Vec<f64> = here.iter().filter_map(|r| r.number(recorded)).collect();
            let published = request.published.as_ref().and_then(|name| {
                let fixed = rows.clone().with("measure", measure);
                let (table, row) = self.published_row(name, &fixed)?;
                let number = |column: &str| table.value(row, column).as_f64();
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "a count of runs"
                )]
                let n = number("n").map(|n| n.max(0.0) as u64);
                Some(Printed { value: number("value")?, sd: number("sd"), n })
            });
            let least = values.iter().copied().reduce(f64::min).filter(|_| recorded != measure);
            let ours = match least {
                // One number of all trials, which has no spread.
                Some(mean) => Some(Summary { n: 1, mean, sd: f64::NAN }),
                None => (!values.is_empty()).then(|| Summary::of(&values)),
            };
            let found = ours.map(Ours::Mean).ok_or_else(|| self.absence(rows, here.len() as u64));
            MeasureCell {
                agreement: Agreement::between(found, published),
                rows: rows.clone(),
                measure: measure.clone(),
                trials: here.len() as u64,
                ours,
                published,
            }
        };
        let rows = self.ran(&request.rows);
        rows.iter().flat_map(|rows| request.measures.iter().map(|m| cell(rows, m))).collect()
    }
}

impl Layout for MeasuresTable {
    type Cell = MeasureCell;

    fn cells(&self, findings: &Findings<'_>, _: &[TableRequest]) -> Vec<MeasureCell> {
        findings.measure_cells(self)
    }

    fn columns<'a>(&'a self, findings: &Findings<'_>) -> Columns<'a, MeasureCell> {
        let unit = "that of measure";
        let number = |name: &str, meaning: &str| Column::number(name, unit, meaning);
        let unprinted = "the paper prints none";
        Columns::<MeasureCell>::none()
            .factors(&self.rows, findings, |cell| &cell.rows)
            .with(
                Column::of_values(
                    "measure",
                    "",
                    "The column of results/trials.csv that is summed up",
                    &self.measures,
                ),
                |cell| cell.measure.clone(),
            )
            .number(
                number("mean", "Mean over trials").empty_where("no trial has the measure"),
                |cell| cell.ours.map(|s| s.mean),
            )
            .number(
                number("sd", "Standard deviation over trials (n - 1)")
                    .at_least(0.0)
                    .empty_where("fewer than two trials have the measure"),
                |cell| cell.ours.filter(|s| s.n > 1).map(|s| s.sd),
            )
            .count("n", "Trials that have the measure; mean and sd are of these", |cell| {
                cell.ours.map_or(0, |s| s.n)
            })
            .count("trials", "All trials of the cell", |cell| cell.trials)
            .with(
                number("published", "The mean that the paper prints").empty_where(unprinted),
                |cell| cell.published.map(|p| p.value),
            )
            .with(
                number("published-sd", "The standard deviation that the paper prints")
                    .at_least(0.0)
                    .empty_where(unprinted),
                |cell| cell.published.and_then(|p| p.sd),
            )
            .with(
                Column::count("published-n", "The paper's number of runs").empty_where(unprinted),
                |cell| cell.published.and_then(|p| p.n).map(whole),
            )
            .agreement(unit, |cell| cell.agreement)
    }

    /// Sets one line a cell of the design; the measures stand side by side, the paper's in parentheses.
    fn set(&self, cells: &[MeasureCell], findings: &Findings<'_>) -> Set {
        let labels = findings.labels;
        let abreast = Abreast {
            cells,
            of: self.measures.len(),
            label: |cell: &MeasureCell| labels.values(&cell.rows),
        };
        let rows = labels.factors(&self.rows);
        let heads = rows.iter().chain(&self.measures).cloned().collect();
        let table = abreast.table(heads, |cell| [in_print(cell)]);
        let is_compared = cells.iter().any(|cell| cell.agreement.method().is_some());
        let papers = is_compared.then_some("in parentheses: the paper's");
        let legend = ["mean ± standard deviation of trials"].into_iter().chain(papers);
        let measured =
            |s: Summary| Measured { mean: s.mean, sd: (s.n > 1).then_some(s.sd), n: Some(s.n) };
        Set {
            grid: Grid {
                quantity: "measures of whole trials".to_owned(),
                beside: "paper",
                source: Source::of(self.published.as_ref()),
                decimals: 1,
                of_trials: false,
                row_header: rows.join(", "),
                columns: self.measures.clone(),
                rows: abreast.rows(|cell| GridCell {
                    ours: cell.ours.map(measured),
                    published: cell.published.map(Measured::from),
                    agreement: cell.agreement,
                    ..GridCell::default()
                }),
            },
            print: Some(table.clone()),
            lines: Lines::all(table, self.rows.len(), 0..self.rows.len()),
            legend: legend.map(str::to_owned).collect(),
            more: 0,
        }
    }
}

fn in_print(cell: &MeasureCell) -> String {
    let measured = |mean: f64, sd: Option<f64>| match sd {
        Some(sd) => format!("{mean:.1} ± {sd:.1}"),
        None => format!("{mean:.1}"),
    };
    let mut text = cell.ours.map_or_else(
        || "-".to_owned(),
        |ours| measured(ours.mean, (ours.n > 1).then_some(ours.sd)),
    );
    if let Some(paper) = cell.published {
        let mark = cell.agreement.mark();
        let space = if mark.is_empty() { "" } else { " " };
        text.push_str(&format!(" ({mark}{space}{})", measured(paper.value, paper.sd)));
    }
    let told = |ours: &Summary| ours.n < cell.trials && least_of(&cell.measure).is_none();
    if let Some(ours) = cell.ours.filter(told) {
        text.push_str(&format!(" [{} of {}]", ours.n, cell.trials));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::digest::{Sha256Digest, TrialKey};
    use crate::factor::Factor;
    use crate::studies::{Ledger, Outcome, TrialRecord};
    use crate::table::Table;
    use std::collections::BTreeMap;

    fn record(prior: &str, noise: &str, trial: u32, distance: Option<f64>) -> TrialRecord {
        TrialRecord {
            key: TrialKey(Sha256Digest::of(format!("{prior}{noise}{trial}"))),
            condition: Condition::from([("prior", prior), ("noise", noise)]),
            trial,
            outcome: Outcome::EXPLORED,
            cause: String::new(),
            measures: [("distance-m", distance)].into(),
            series: Vec::new(),
            sim_seconds: 1.0,
            chain: Vec::new(),
        }
    }

    #[test]
    fn a_row_is_a_cell_that_was_run_with_the_papers_number_beside_it() {
        let factors = [("prior", &["none", "graph"][..]), ("noise", &["0", "4"])]
            .map(|(name, values)| Factor::new(name, values.iter().copied()));
        let records = [
            record("none", "0", 0, Some(400.0)),
            record("none", "0", 1, None),
            record("graph", "0", 0, Some(240.0)),
            record("graph", "0", 1, Some(260.0)),
            record("graph", "4", 0, Some(390.0)),
        ];
        let csv =
            "prior,noise,measure,value,sd\ngraph,0,least:distance-m,239,\ngraph,0,time-s,1,\n";
        let published = BTreeMap::from([("section".to_owned(), Table::from_csv(csv).unwrap())]);
        let ledger = Ledger::of(&records);
        let findings = Findings::new(&factors, &ledger, &published);
        let wanted = MeasuresTable {
            measures: vec!["distance-m".to_owned(), "least:distance-m".to_owned()],
            rows: vec!["prior".to_owned(), "noise".to_owned()],
            published: Some("section".to_owned()),
        };
        let cells = findings.measure_cells(&wanted);
        assert_eq!(
            wanted.set(&cells, &findings).print.unwrap().to_csv(),
            "prior,noise,distance-m,least:distance-m\nnone,0,400.0 [1 of 2],400.0\n\
             graph,0,250.0 ± 14.1,240.0 (≈ 239.0)\ngraph,4,390.0,390.0\n"
        );
        let tidy = wanted.columns(&findings).table(&cells).to_csv();
        assert!(tidy.contains("graph,0,least:distance-m,240,,1,2,239,,,within-10-percent,relative-difference,,,0.41841\n"), "{tidy}");
    }
}
