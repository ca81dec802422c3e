//! What is shown of readings.

use super::{ReadingScore, SPEED, Whose};
use crate::labels::Labels;
use crate::stats::real;
use crate::studies::columns::Columns;
use crate::studies::exhibit::{Grid, GridCell, GridRow, Layout, Lines, Measured, Set, Source};
use crate::studies::prior_map::ReadingsTable;
use crate::studies::prior_map::agreement::{in_scope, percent};
use crate::studies::{Findings, TableRequest, coverage_tables};
use crate::table::{Column, Table, Value};

impl Layout for ReadingsTable {
    type Cell = ReadingScore;

    fn cells(&self, findings: &Findings<'_>, tables: &[TableRequest]) -> Vec<ReadingScore> {
        findings.reading_scores(self, &coverage_tables(tables))
    }

    fn columns<'a>(&'a self, _: &Findings<'_>) -> Columns<'a, ReadingScore> {
        let number = |name: &str, meaning: &str, empty: &str| {
            Column::number(name, "", meaning).empty_where(empty)
        };
        let no_tau = "the paper prints no spread, or these are speeds";
        let no_interval = "fewer than three arms, a guess or a replicate";
        let no_ratios = "a guess, speeds, or no cell has a ratio to its baseline";
        let ratio = |i: usize| move |score: &ReadingScore| score.ratios.map(|all| all[i]);
        Columns::<ReadingScore>::none()
            .with(
                Column::text("scope", "`all` of the table, or the factor's value that the part has"),
                |score| score.scope.clone(),
            )
            .with(
                Column::text("quantity", "The coverage table that is compared, or `speed`, distance over time"),
                |score| score.quantity.clone(),
            )
            .with(Column::text("reading", "The reading, or what stands in for one"), |score| {
                score.reading.clone()
            })
            .with(
                Column::text(
                    "whose",
                    "`ours`, or made up: a `replicate` of the paper's experiment with as many runs as ours, or a `guess` that looks \
                     at no run",
                ),
                |score| score.whose.name(),
            )
            .count("cells", "Cells with a mean on both sides", |score| score.cells)
            .number(
                number(
                    "tau",
                    "What neither side's sampling explains of a cell, as a share of it: 0 is perfect",
                    no_tau,
                )
                .at_least(0.0),
                |score| score.tau.map(|tau| tau.0),
            )
            .number(
                number("tau-low", "Lower end of its 95 % interval (bootstrap over arms)", no_interval)
                    .at_least(0.0),
                |score| score.tau.and_then(|tau| tau.1).map(|interval| interval.0),
            )
            .number(
                number("tau-high", "Upper end of its 95 % interval", no_interval).at_least(0.0),
                |score| score.tau.and_then(|tau| tau.1).map(|interval| interval.1),
            )
            .number(
                number(
                    "nearest",
                    "Share of the resamples in which this reading leaves the least unexplained of all",
                    "a guess or a replicate, or the readings have cells in different arms",
                )
                .at_least(0.0)
                .at_most(1.0),
                |score| score.nearest,
            )
            .number(
                Column::number(
                    "bias-percent",
                    "%",
                    "Geometric mean of our cells over the paper's, less one",
                )
                .empty_where("no cell"),
                |score| Some(percent(score.bias)),
            )
            .number(
                number("rms-log", "Root mean square log of our cells over the paper's", "no cell")
                    .at_least(0.0),
                |score| Some(score.rms),
            )
            .number(
                number(
                    "cells-with-interval",
                    "Cells around whose printed mean the paper's spread puts a 95 % prediction interval",
                    "a guess, or speeds",
                ),
                |score| score.inside.map(|(_, of)| real(of)),
            )
            .number(
                number("cells-inside", "How many of our cells lie inside it", "a guess, or speeds"),
                |score| score.inside.map(|(inside, _)| real(inside)),
            )
            .number(number("slope", "Slope of our log ratios to the baseline on the paper's", no_ratios), ratio(0))
            .number(number("pearson", "Pearson's correlation of the log ratios", no_ratios), ratio(1))
            .number(number("rmse-log-ratio", "Their root mean square difference: the score", no_ratios), ratio(2))
            .number(
                number("skill-over-mean-ratio", "Skill over the paper's one mean ratio", no_ratios),
                ratio(3),
            )
            .number(
                number(
                    "spread-ratio",
                    "Median over cells of our standard deviation over the paper's",
                    "a guess, speeds, or no spread is printed",
                ),
                |score| score.spread,
            )
    }

    fn set(&self, cells: &[ReadingScore], findings: &Findings<'_>) -> Set {
        let labels = findings.labels;
        let reading = |score: &ReadingScore| labels.value(&self.by, &score.reading).to_owned();
        let columns = [
            "tau",
            "bias",
            "share of cells inside",
            "slope",
            "Pearson",
            "rmse (the score)",
            "skill",
            "spread",
        ];
        let row = |score: &ReadingScore| GridRow {
            label: format!(
                "{}, {}, {}",
                in_scope(&score.scope, labels),
                score.quantity,
                reading(score)
            ),
            cells: numbers(score).to_vec(),
        };
        let table = in_print(cells, &self.by, labels);
        Set {
            grid: Grid {
                quantity: "of our cells beside the paper's".to_owned(),
                beside: "paper",
                source: Source::Nowhere,
                decimals: 2,
                of_trials: false,
                row_header: "part, table, reading".to_owned(),
                columns: columns.map(str::to_owned).to_vec(),
                rows: cells.iter().map(row).collect(),
            },
            print: Some(table.clone()),
            lines: Lines::all(table, 1, [0]),
            legend: vec![
                "tau: what neither side's sampling explains of a cell; near: how often the nearest of ours over resampled arms; \
                 bias: ours longer than the paper's; in: cells inside the paper's 95 % prediction interval; slope to skill: of log \
                 ratios to the baseline"
                    .to_owned(),
            ],
            more: 0,
        }
    }

    /// Says which reading leaves the least unexplained, by how much and how sure.
    fn answer(&self, cells: &[ReadingScore]) -> Option<String> {
        let whole = |whose: Whose, quantity: &str| -> Vec<&ReadingScore> {
            let of = |score: &&ReadingScore| {
                score.scope == "all" && score.whose == whose && score.quantity == quantity
            };
            cells.iter().filter(of).collect()
        };
        let mut sentences = Vec::new();
        for (i, id) in self.tables.iter().enumerate() {
            let mut ranked: Vec<(&ReadingScore, f64)> = whole(Whose::Ours, id)
                .into_iter()
                .filter_map(|score| Some((score, score.tau?.0)))
                .collect();
            ranked.sort_by(|a, b| a.1.total_cmp(&b.1));
            let (first, _) = *ranked.first()?;
            let told: Vec<String> = ranked.iter().map(|(score, _)| in_words(score)).collect();
            let what = if i == 0 { "stays unexplained" } else { "stays so" };
            sentences.push(format!("Of a cell of the table {id} {what}: {}.", told.join("; ")));
            if i == 0 {
                let beside: Vec<String> = [Whose::Replicate, Whose::Guess]
                    .into_iter()
                    .flat_map(|whose| whole(whose, id))
                    .filter_map(|score| {
                        Some(format!("{} {:.0} %", score.reading, 100.0 * score.tau?.0))
                    })
                    .collect();
                let beside = beside.join(", ");
                sentences.push(match first.nearest {
                    Some(share) => format!(
                        "{} is the nearest in {:.0} % of resampled arms; beside it stand {beside}.",
                        first.reading,
                        100.0 * share
                    ),
                    None => format!(
                        "Which is nearest is not told, as they have cells in different arms; beside them stand {beside}."
                    ),
                });
            }
        }
        let speeds: Vec<String> = whole(Whose::Ours, SPEED)
            .iter()
            .map(|score| format!("{} {:+.0} %", score.reading, percent(score.bias)))
            .collect();
        if !speeds.is_empty() {
            sentences.push(format!(
                "Mean speeds, which nobody tuned, are off by {}.",
                speeds.join(", ")
            ));
        }
        sentences.push(
            "This measure (tau) was chosen after the score of ratios had been seen; both stand in the table.".to_owned(),
        );
        Some(sentences.join(" "))
    }
}

fn in_words(score: &ReadingScore) -> String {
    let (tau, interval) = score.tau.unwrap_or_default();
    let interval = interval
        .map_or(String::new(), |(low, high)| format!(" [{:.0}, {:.0}]", 100.0 * low, 100.0 * high));
    format!("{} {:.0} %{interval}", score.reading, 100.0 * tau)
}

/// Returns the cells in the order of the page's columns.
fn numbers(score: &ReadingScore) -> [GridCell; 8] {
    let ratio = |i: usize| score.ratios.map(|all| all[i]);
    let inside = score.inside.map(|(inside, of)| (real(inside) / real(of), Some(of)));
    let plain = |mean: Option<f64>| mean.map(|mean| (mean, None));
    [
        score.tau.map(|tau| (tau.0, Some(score.cells))),
        Some((score.bias, None)),
        inside,
        plain(ratio(0)),
        plain(ratio(1)),
        plain(ratio(2)),
        plain(ratio(3)),
        plain(score.spread),
    ]
    .map(|found| GridCell {
        ours: found.filter(|(mean, _)| mean.is_finite()).map(|(mean, n)| Measured {
            mean,
            sd: None,
            n,
        }),
        ..GridCell::default()
    })
}

/// Returns the lines, in 80 columns where names are short.
fn in_print(scores: &[ReadingScore], by: &str, labels: &Labels) -> Table {
    let columns =
        ["part, reading", "tau %", "near", "bias %", "in", "slope", "r", "score", "skill"];
    let mut table = Table::new(columns);
    for score in scores {
        let number = |x: Option<f64>, digits: usize| match x {
            Some(x) if x.is_finite() => format!("{x:.digits$}"),
            _ => "-".to_owned(),
        };
        let tau = score.tau.map_or("-".to_owned(), |(tau, interval)| match interval {
            Some((low, high)) => {
                format!("{:.0} [{:.0}, {:.0}]", 100.0 * tau, 100.0 * low, 100.0 * high)
            }
            None => format!("{:.0}", 100.0 * tau),
        });
        let scope = if score.scope == "all" {
            String::new()
        } else {
            format!("{}, ", in_scope(&score.scope, labels))
        };
        let reading = labels.value(by, &score.reading);
        let ratio = |i: usize| number(score.ratios.map(|all| all[i]), 2);
        let texts = [
            format!("{scope}{}, {reading}", score.quantity),
            tau,
            number(score.nearest, 2),
            format!("{:+.0}", percent(score.bias)),
            score.inside.map_or("-".to_owned(), |(inside, of)| format!("{inside}/{of}")),
            ratio(0),
            ratio(1),
            ratio(2),
            ratio(3),
        ];
        table.push(texts.map(Value::from).to_vec());
    }
    table
}
