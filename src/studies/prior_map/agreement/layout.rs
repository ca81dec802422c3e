//! What is shown of how coverage tables agree with the paper's.

use super::{TableAgreement, in_scope, percent};
use crate::stats::{Interval, real};
use crate::studies::columns::Columns;
use crate::studies::exhibit::{Grid, GridCell, GridRow, Layout, Lines, Measured, Set, Source};
use crate::studies::prior_map::AgreementTable;
use crate::studies::{Findings, TableRequest, coverage_tables};
use crate::table::{Column, Table, Value};

impl Layout for AgreementTable {
    type Cell = TableAgreement;

    fn cells(&self, findings: &Findings<'_>, tables: &[TableRequest]) -> Vec<TableAgreement> {
        findings.agreement(self, &coverage_tables(tables))
    }

    fn columns<'a>(&'a self, _: &Findings<'_>) -> Columns<'a, TableAgreement> {
        let number = |name: &str, meaning: &str| {
            Column::number(name, "", meaning).empty_where("too few cells vary")
        };
        let correlation = |name, meaning| number(name, meaning).at_least(-1.0).at_most(1.0);
        let end = |name: &str, which: &str, of: &str, how: &str| {
            number(name, &format!("{which} end of the {of}'s 95 % interval ({how})"))
        };
        let tau = |of: fn(Interval) -> f64| {
            move |part: &TableAgreement| part.absolute.unexplained.interval.map(of)
        };
        let slope = |of: fn(Interval) -> f64| {
            move |part: &TableAgreement| part.line.intervals.map(|(slope, _)| of(slope))
        };
        let intercept = |of: fn(Interval) -> f64| {
            move |part: &TableAgreement| part.line.intervals.map(|(_, intercept)| of(intercept))
        };
        Columns::<TableAgreement>::none()
            .with(
                Column::text("table", "The coverage table that is compared with the paper's"),
                |part| part.table.clone(),
            )
            .with(
                Column::text("scope", "`all` of it, or the factor's value that the part has"),
                |part| part.scope.clone(),
            )
            .count("ratios", "Cells with a log ratio to their baseline on both sides", |part| {
                part.ratios
            })
            .count("missing", "Cells that the paper prints and no run of ours reached", |part| {
                part.missing
            })
            .count(
                "censored",
                "Cells with runs that never got there; their means are of those that did",
                |part| part.censored,
            )
            .count(
                "blocks",
                "Sets of cells with no run in common; intervals leave out one at a time",
                |part| part.blocks,
            )
            .number(
                Column::number(
                    "tau",
                    "",
                    "What neither side's sampling explains of a cell, as a share of it: 0 is perfect",
                )
                .at_least(0.0)
                .empty_where("the paper prints no spread of any cell"),
                |part| {
                    let absolute = &part.absolute;
                    (!absolute.cells.is_empty()).then_some(absolute.unexplained.tau)
                },
            )
            .number(
                end("tau-low", "Lower", "tau", ARMS).at_least(0.0),
                tau(|interval| interval.low),
            )
            .number(
                end("tau-high", "Upper", "tau", ARMS).at_least(0.0),
                tau(|interval| interval.high),
            )
            .number(
                Column::number(
                    "bias-percent",
                    "%",
                    "Geometric mean of our cells over the paper's, less one",
                )
                .empty_where("no cell has a mean on both sides"),
                |part| Some(percent(part.absolute.bias)).filter(|bias| bias.is_finite()),
            )
            .number(
                number(
                    "slope",
                    "Slope of our log ratios on the paper's: 1 agrees, below 1 our gains are smaller",
                ),
                |part| part.line.slope,
            )
            .number(end("slope-low", "Lower", "slope", BLOCKS), slope(|i| i.low))
            .number(end("slope-high", "Upper", "slope", BLOCKS), slope(|i| i.high))
            .number(number("intercept", "Intercept of that line: 0 agrees"), |part| {
                part.line.intercept
            })
            .number(end("intercept-low", "Lower", "intercept", BLOCKS), intercept(|i| i.low))
            .number(end("intercept-high", "Upper", "intercept", BLOCKS), intercept(|i| i.high))
            .number(correlation("pearson", "Pearson's correlation of the log ratios"), |part| {
                part.pearson
            })
            .number(correlation("spearman", "Spearman's correlation of the log ratios"), |part| {
                part.spearman
            })
            .number(
                number(
                    "rmse-log-ratio",
                    "Root mean square difference of the log ratios: 0 is perfect",
                )
                .at_least(0.0),
                |part| part.rmse,
            )
            .number(
                number(
                    "skill-over-mean-ratio",
                    "Skill over the paper's one mean ratio: 1 is perfect, 0 no better than that constant",
                )
                .at_most(1.0),
                |part| part.skill,
            )
            .number(number("mean-log-ratio", "Mean of our log ratios"), |part| part.mean)
            .number(
                number("published-mean-log-ratio", "Mean of the paper's log ratios"),
                |part| part.published_mean,
            )
            .count(
                "ratios-with-interval",
                "Log ratios around which the paper's spread and number of runs put a 95 % interval",
                |part| part.ratios_inside.1,
            )
            .count("ratios-inside", "How many of our log ratios lie inside it", |part| {
                part.ratios_inside.0
            })
            .count(
                "cells-with-interval",
                "Cells around whose printed mean they put a 95 % interval",
                |part| part.cells_inside.1,
            )
            .count("cells-inside", "How many of our cells lie inside it", |part| {
                part.cells_inside.0
            })
    }

    /// Sets one line a part of a table. The columns of the page are its measures of agreement, each on its own.
    fn set(&self, cells: &[TableAgreement], findings: &Findings<'_>) -> Set {
        let columns = [
            "tau",
            "bias (%)",
            "share of cells inside",
            "slope",
            "intercept",
            "Pearson",
            "Spearman",
            "rmse (the score)",
            "skill over the mean ratio",
            "share of ratios inside",
        ];
        let row = |part: &TableAgreement| GridRow {
            label: format!("{}, {}", part.table, in_scope(&part.scope, findings.labels)),
            cells: numbers(part).to_vec(),
        };
        let table = in_print(cells);
        Set {
            grid: Grid {
                quantity: "of log ratios to the baseline, ours on the paper's".to_owned(),
                beside: "paper",
                source: Source::Nowhere,
                decimals: 2,
                of_trials: false,
                row_header: "table, part".to_owned(),
                columns: columns.map(str::to_owned).to_vec(),
                rows: cells.iter().map(row).collect(),
            },
            print: Some(table.clone()),
            lines: Lines::all(table, 1, [0]),
            legend: vec![
                "tau: what neither side's sampling explains of a cell; bias: ours longer than the paper's; in: inside the paper's \
                 95 % prediction interval; slope to skill: log ratios to the baseline, ours on the paper's; rmse is the score, \
                 skill is over the paper's mean ratio"
                    .to_owned(),
            ],
            more: 0,
        }
    }
}

/// How intervals come about.
const BLOCKS: &str = "jackknife over blocks";
const ARMS: &str = "bootstrap over arms";

/// Returns the cells in the order of the page's columns.
fn numbers(part: &TableAgreement) -> [GridCell; 10] {
    let share = |(inside, known): (u64, u64)| (real(inside) / real(known), Some(known));
    let absolute = &part.absolute;
    let tau = if absolute.cells.is_empty() { f64::NAN } else { absolute.unexplained.tau };
    [
        (tau, Some(absolute.cells.len() as u64)),
        (percent(absolute.bias), None),
        share(part.cells_inside),
        (part.line.slope, Some(part.ratios)),
        (part.line.intercept, None),
        (part.pearson, None),
        (part.spearman, None),
        (part.rmse, None),
        (part.skill, None),
        share(part.ratios_inside),
    ]
    .map(|(mean, n)| GridCell {
        ours: mean.is_finite().then_some(Measured { mean, sd: None, n }),
        ..GridCell::default()
    })
}

/// Returns the lines, in 80 columns where names are short: each table, then its parts.
fn in_print(parts: &[TableAgreement]) -> Table {
    let columns =
        ["part", "tau %", "bias %", "cells in", "ratios", "slope", "r", "rmse", "skill", "in"];
    let mut table = Table::new(columns);
    for part in parts {
        let number = |x: f64| if x.is_finite() { format!("{x:.2}") } else { "-".to_owned() };
        let absolute = &part.absolute;
        let tau = match (absolute.cells.is_empty(), absolute.unexplained.interval) {
            (true, _) => "-".to_owned(),
            (_, Some(Interval { low, high, .. })) => format!(
                "{:.0} [{:.0}, {:.0}]",
                100.0 * absolute.unexplained.tau,
                100.0 * low,
                100.0 * high
            ),
            _ => format!("{:.0}", 100.0 * absolute.unexplained.tau),
        };
        let bias = if absolute.bias.is_finite() {
            format!("{:+.0}", percent(absolute.bias))
        } else {
            "-".to_owned()
        };
        let of = |(inside, known): (u64, u64)| format!("{inside}/{known}");
        let ratios = match part.missing {
            0 => part.ratios.to_string(),
            missing => format!("{} (-{missing})", part.ratios),
        };
        let texts = [
            part.name.clone(),
            tau,
            bias,
            of(part.cells_inside),
            ratios,
            number(part.line.slope),
            number(part.pearson),
            number(part.rmse),
            number(part.skill),
            of(part.ratios_inside),
        ];
        table.push(texts.map(Value::from).to_vec());
    }
    table
}
