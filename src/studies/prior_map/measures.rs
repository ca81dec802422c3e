//! From records to a table of whole trials' measures, as the numbers of section 4.5.

use super::requests::MeasuresTable;
use crate::stats::compatibility::{Agreement, Ours, Printed, rules};
use crate::stats::summary::Summary;
use crate::studies::findings::{AGREEMENT, Findings, agreement_values, rounded};
use crate::table::{Table, Value};

/// Mean and spread of one measure in one cell of the design, beside the paper's.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasureCell {
    /// Values of the row's factors.
    pub rows: Vec<(String, String)>,
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

impl Findings<'_> {
    /// The cells of a table: rows that were run, then measures.
    pub fn measure_cells(&self, request: &MeasuresTable) -> Vec<MeasureCell> {
        let cell = |rows: &Vec<(String, String)>, measure: &String| {
            let here = self.matching(rows);
            let values: Vec<f64> =
                here.iter().filter_map(|r| r.measures.get(measure).copied().flatten()).collect();
            let published = request.published.as_ref().and_then(|name| {
                let mut fixed = rows.clone();
                fixed.push(("measure".to_owned(), measure.clone()));
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
            let ours = (!values.is_empty()).then(|| Summary::of(&values));
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

    /// A requested table, tidy: one row a cell.
    pub fn measures_table(&self, wanted: &MeasuresTable) -> Table {
        let mut columns = wanted.rows.clone();
        let numbers =
            ["measure", "mean", "sd", "n", "trials", "published", "published-sd", "published-n"];
        columns.extend(numbers.map(str::to_owned));
        columns.extend(AGREEMENT.map(str::to_owned));
        let mut table = Table::new(columns);
        for cell in self.measure_cells(wanted) {
            let whole = |n: u64| i64::try_from(n).unwrap_or(i64::MAX);
            let mut row: Vec<Value> = cell.rows.iter().map(|(_, v)| v.as_str().into()).collect();
            row.push(cell.measure.as_str().into());
            row.push(cell.ours.map(|s| rounded(s.mean)).into());
            row.push(cell.ours.filter(|s| s.n > 1).map(|s| rounded(s.sd)).into());
            row.push(cell.ours.map_or(0, |s| whole(s.n)).into());
            row.push(whole(cell.trials).into());
            row.push(cell.published.map(|p| p.value).into());
            row.push(cell.published.and_then(|p| p.sd).into());
            row.push(cell.published.and_then(|p| p.n).map(whole).into());
            row.extend(agreement_values(cell.agreement));
            table.push(row);
        }
        table
    }

    /// What the marks of a table mean: the methods that occur in it.
    pub fn measures_rules(&self, wanted: &MeasuresTable) -> Option<String> {
        rules(self.measure_cells(wanted).into_iter().map(|cell| cell.agreement))
    }

    /// A requested table as people read it: the measures side by side, the paper's in parentheses.
    pub fn measures_table_in_print(&self, wanted: &MeasuresTable) -> Table {
        let mut table = Table::new(wanted.rows.iter().chain(&wanted.measures).cloned());
        for line in self.measure_cells(wanted).chunks(wanted.measures.len().max(1)) {
            let Some(first) = line.first() else { continue };
            let mut row: Vec<Value> = first.rows.iter().map(|(_, v)| v.as_str().into()).collect();
            row.extend(line.iter().map(|cell| Value::from(in_print(cell))));
            table.push(row);
        }
        table
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
    if let Some(ours) = cell.ours.filter(|ours| ours.n < cell.trials) {
        text.push_str(&format!(" [{} of {}]", ours.n, cell.trials));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::digest::{Sha256Digest, TrialKey};
    use crate::studies::{Outcome, TrialRecord};
    use std::collections::BTreeMap;

    fn record(prior: &str, noise: &str, trial: u32, distance: Option<f64>) -> TrialRecord {
        TrialRecord {
            key: TrialKey(Sha256Digest::of(format!("{prior}{noise}{trial}"))),
            condition: vec![
                ("prior".to_owned(), prior.to_owned()),
                ("noise".to_owned(), noise.to_owned()),
            ],
            trial,
            outcome: Outcome::EXPLORED,
            cause: String::new(),
            measures: BTreeMap::from([("distance-m".to_owned(), distance)]),
            series: Vec::new(),
            sim_seconds: 1.0,
            chain: Vec::new(),
        }
    }

    #[test]
    fn a_row_is_a_cell_that_was_run_with_the_papers_number_beside_it() {
        let factors =
            [("prior", &["none", "graph"][..]), ("noise", &["0", "4"])].map(|(name, values)| {
                (name.to_owned(), values.iter().map(|v| (*v).to_owned()).collect())
            });
        let records = [
            record("none", "0", 0, Some(400.0)),
            record("none", "0", 1, None),
            record("graph", "0", 0, Some(240.0)),
            record("graph", "0", 1, Some(260.0)),
            record("graph", "4", 0, Some(390.0)),
        ];
        let csv = "prior,noise,measure,value,sd\ngraph,0,distance-m,239,\ngraph,0,time-s,1,\n";
        let published = BTreeMap::from([("section".to_owned(), Table::from_csv(csv).unwrap())]);
        let findings = Findings::new(&factors, &records, &published);
        let wanted = MeasuresTable {
            measures: vec!["distance-m".to_owned()],
            rows: vec!["prior".to_owned(), "noise".to_owned()],
            published: Some("section".to_owned()),
        };
        let print = findings.measures_table_in_print(&wanted).to_csv();
        assert_eq!(
            print,
            "prior,noise,distance-m\nnone,0,400.0 [1 of 2]\ngraph,0,250.0 ± 14.1 (≈ 239.0)\ngraph,4,390.0\n"
        );
        let tidy = findings.measures_table(&wanted).to_csv();
        assert!(tidy.contains("graph,0,distance-m,250,14.1421,2,2,239,,,within-10-percent,relative-difference,,,4.60251\n"), "{tidy}");
    }
}
