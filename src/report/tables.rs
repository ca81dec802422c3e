//! The tables of a study as the page shows them: ours beside the paper's, agreement marked.

use super::content::{Measured, ReportCell, ReportRow, ReportTable};
use crate::plan::Plan;
use crate::studies::deadline::ManeuverTable;
use crate::studies::outcomes::{OutcomeCell, OutcomeTable};
use crate::studies::prior_map::effects::Effect;
use crate::studies::prior_map::measures::MeasureCell;
use crate::studies::prior_map::results::CoverageCell;
use crate::studies::prior_map::{
    AgreementTable, CoverageTable, EffectsTable, MeasuresTable, Metric,
};
use crate::studies::{Findings, TableLayout, TableRequest, coverage_tables};

/// What the page shows of a requested table.
pub(super) fn table(findings: &Findings<'_>, request: &TableRequest, plan: &Plan) -> ReportTable {
    match &request.layout {
        TableLayout::CoverageTable(wanted) => coverage_table(findings, request, wanted, plan),
        TableLayout::AgreementTable(wanted) => agreement_table(findings, request, wanted, plan),
        TableLayout::EffectsTable(wanted) => effects_table(findings, request, wanted, plan),
        TableLayout::MeasuresTable(wanted) => measures_table(findings, request, wanted, plan),
        TableLayout::OutcomeTable(wanted) => outcome_table(findings, request, wanted, plan),
        TableLayout::ManeuverTable(wanted) => maneuver_table(findings, request, wanted),
    }
}

fn coverage_table(
    findings: &Findings<'_>,
    request: &TableRequest,
    wanted: &CoverageTable,
    plan: &Plan,
) -> ReportTable {
    let cells = findings.coverage_cells(wanted);
    let mut columns: Vec<String> = Vec::new();
    for cell in &cells {
        if !columns.contains(&cell.by) {
            columns.push(cell.by.clone());
        }
    }
    // The page takes the first column for the baseline.
    if let Some(baseline) = wanted.baseline.as_ref()
        && let Some(i) = columns.iter().position(|c| *c == baseline.0)
    {
        columns.swap(0, i);
    }
    let rows = cells.chunks(columns.len().max(1)).map(|line| {
        let label: Vec<String> = line
            .iter()
            .take(1)
            .flat_map(|cell| {
                let rows = cell.rows.iter().map(|(_, value)| value.clone());
                rows.chain([format!("{} %", cell.percent)])
            })
            .collect();
        let cell = |name: &String| {
            line.iter().find(|c| c.by == *name).map(report_cell).unwrap_or_default()
        };
        ReportRow { label: label.join(", "), cells: columns.iter().map(cell).collect() }
    });
    ReportTable {
        id: request.id.clone(),
        title: format!("{} (n = {} trials a cell)", request.title, trials_a_cell(plan)),
        source: source(plan, wanted.published.as_ref()),
        quantity: match wanted.metric {
            Metric::DistanceM => "distance travelled (m)".to_owned(),
            Metric::TimeS => "simulated time (s)".to_owned(),
        },
        beside: "paper".to_owned(),
        decimals: 2,
        row_header: wanted
            .rows
            .iter()
            .map(String::as_str)
            .chain(["coverage"])
            .collect::<Vec<_>>()
            .join(", "),
        rows: rows.collect(),
        columns,
    }
}

fn report_cell(cell: &CoverageCell) -> ReportCell {
    let ours =
        cell.ours.map(|s| Measured { mean: s.mean, sd: (s.n > 1).then_some(s.sd), n: Some(s.n) });
    let published = cell.published.map(|(mean, sd, n)| {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a count of runs"
        )]
        let n = n.map(|n| n.max(0.0) as u64);
        Measured { mean, sd, n }
    });
    ReportCell {
        ours,
        difference_percent: cell.difference_percent,
        published,
        published_difference_percent: cell.published_difference_percent,
        agreement: cell.agreement,
    }
}

/// One line a part of a table; the columns are its measures of agreement, each on its own.
fn agreement_table(
    findings: &Findings<'_>,
    request: &TableRequest,
    wanted: &AgreementTable,
    plan: &Plan,
) -> ReportTable {
    let tables = coverage_tables(&plan.experiment.tables);
    let share = |(inside, known): (u64, u64)| {
        #[expect(clippy::cast_precision_loss, reason = "counts of cells")]
        let share = inside as f64 / known as f64;
        (share, Some(known))
    };
    let rows = findings.agreement(wanted, &tables).into_iter().map(|part| {
        let numbers = [
            (part.line.slope, Some(part.ratios)),
            (part.line.intercept, None),
            (part.pearson, None),
            (part.spearman, None),
            (part.rmse, None),
            (part.skill, None),
            share(part.ratios_inside),
            share(part.cells_inside),
        ];
        let cell = |(mean, n): (f64, Option<u64>)| ReportCell {
            ours: mean.is_finite().then_some(Measured { mean, sd: None, n }),
            ..ReportCell::default()
        };
        ReportRow {
            label: format!("{}, {}", part.table, part.scope),
            cells: numbers.map(cell).to_vec(),
        }
    });
    ReportTable {
        id: request.id.clone(),
        title: request.title.clone(),
        source: String::new(),
        quantity: "of log ratios to the baseline, ours on the paper's".to_owned(),
        beside: "paper".to_owned(),
        decimals: 2,
        row_header: "table, part".to_owned(),
        rows: rows.collect(),
        columns: [
            "slope",
            "intercept",
            "Pearson",
            "Spearman",
            "rmse (the score)",
            "skill over the mean ratio",
            "share of ratios inside",
            "share of cells inside",
        ]
        .map(str::to_owned)
        .to_vec(),
    }
}

/// One line a level of a factor in a cell of the design; the coverages stand side by side. Beside each effect stands what
/// lies between the first level and the paper.
fn effects_table(
    findings: &Findings<'_>,
    request: &TableRequest,
    wanted: &EffectsTable,
    plan: &Plan,
) -> ReportTable {
    let effects = findings.effects(wanted);
    let rows = effects.chunks(wanted.at.len().max(1)).map(|line| {
        let label = line.first().map_or_else(String::new, |effect| {
            let choice = format!("{} {} for {}", effect.factor, effect.level, effect.against);
            let within = effect.within.iter().map(|(_, value)| value.clone());
            std::iter::once(choice).chain(within).collect::<Vec<_>>().join(", ")
        });
        let cell = |effect: &Effect| {
            let measured = |mean: f64, n: Option<u64>| Measured { mean, sd: None, n };
            ReportCell {
                ours: effect.percent_moved().map(|x| measured(x, Some(effect.runs.reached))),
                published: effect.gap_percent().map(|x| measured(x, None)),
                ..ReportCell::default()
            }
        };
        ReportRow { label, cells: line.iter().map(cell).collect() }
    });
    ReportTable {
        id: request.id.clone(),
        title: request.title.clone(),
        source: source(plan, wanted.published.as_ref()),
        quantity: format!(
            "effect on {} (%); gap: what lies between the first level and the paper (%)",
            wanted.metric.name()
        ),
        beside: "gap".to_owned(),
        decimals: 0,
        row_header: "level, in".to_owned(),
        rows: rows.collect(),
        columns: wanted.at.iter().map(|percent| format!("{percent} %")).collect(),
    }
}

/// One line a cell of the design; the measures stand side by side.
fn measures_table(
    findings: &Findings<'_>,
    request: &TableRequest,
    wanted: &MeasuresTable,
    plan: &Plan,
) -> ReportTable {
    let cells = findings.measure_cells(wanted);
    let rows = cells.chunks(wanted.measures.len().max(1)).map(|line| {
        let label: Vec<&str> = line
            .iter()
            .take(1)
            .flat_map(|cell| cell.rows.iter().map(|(_, value)| value.as_str()))
            .collect();
        let cell = |cell: &MeasureCell| {
            let measured = |mean: f64, sd: Option<f64>, n| Measured { mean, sd, n };
            ReportCell {
                ours: cell.ours.map(|s| measured(s.mean, (s.n > 1).then_some(s.sd), Some(s.n))),
                published: cell.published.map(|p| measured(p.value, p.sd, p.n)),
                agreement: cell.agreement,
                ..ReportCell::default()
            }
        };
        ReportRow { label: label.join(", "), cells: line.iter().map(cell).collect() }
    });
    ReportTable {
        id: request.id.clone(),
        title: request.title.clone(),
        source: source(plan, wanted.published.as_ref()),
        quantity: "measures of whole trials".to_owned(),
        beside: "paper".to_owned(),
        decimals: 1,
        row_header: wanted.rows.join(", "),
        rows: rows.collect(),
        columns: wanted.measures.clone(),
    }
}

fn outcome_table(
    findings: &Findings<'_>,
    request: &TableRequest,
    wanted: &OutcomeTable,
    plan: &Plan,
) -> ReportTable {
    let columns = findings.columns_of(wanted);
    let cells = findings.outcome_cells(wanted);
    let rows = cells.chunks(columns.len().max(1)).map(|line| {
        let label: Vec<&str> = line
            .iter()
            .take(1)
            .flat_map(|cell| cell.rows.iter().map(|(_, value)| value.as_str()))
            .collect();
        let cells = line.iter().map(outcome_cell).collect();
        ReportRow { label: label.join(", "), cells }
    });
    ReportTable {
        id: request.id.clone(),
        title: format!("{} (n = {} trials a cell)", request.title, trials_a_cell(plan)),
        source: source(plan, wanted.published.as_ref()),
        quantity: wanted.show.describe(),
        beside: "paper".to_owned(),
        decimals: 1,
        row_header: wanted.rows.join(", "),
        rows: rows.collect(),
        columns,
    }
}

/// The calibration's numbers stand where the paper's would: a cell compares what was expected with what was met.
fn maneuver_table(
    findings: &Findings<'_>,
    request: &TableRequest,
    wanted: &ManeuverTable,
) -> ReportTable {
    let measured = |mean: f64, n: u64| Measured { mean, sd: None, n: Some(n) };
    let rows = findings.maneuver_rows(wanted).into_iter().map(|row| {
        let cell = |expected: Option<f64>, met: Option<f64>, n: u64| ReportCell {
            ours: met.map(|met| measured(met, n)),
            published: expected.map(|expected| measured(expected, row.calibration_passages)),
            ..ReportCell::default()
        };
        ReportRow {
            label: row.name,
            cells: vec![
                cell(row.expected_time_s, row.met_time_s, row.arrived),
                cell(row.expected_failure_percent, row.met_failure_percent, row.passages),
            ],
        }
    });
    ReportTable {
        id: request.id.clone(),
        title: request.title.clone(),
        source: "the calibration experiment".to_owned(),
        quantity: "in the study's own trials".to_owned(),
        beside: "calibration".to_owned(),
        decimals: 2,
        row_header: "maneuver".to_owned(),
        rows: rows.collect(),
        columns: vec!["time (s)".to_owned(), "failure (%)".to_owned()],
    }
}

fn outcome_cell(cell: &OutcomeCell) -> ReportCell {
    let ours = cell.ours.map(|e| Measured { mean: e.value, sd: e.sd, n: Some(e.n) });
    let published = cell.published.map(|(mean, n)| Measured { mean, sd: None, n });
    ReportCell { ours, published, agreement: cell.agreement, ..ReportCell::default() }
}

/// Trials that were planned for a cell: fewer than the manifest's where `--trials` asked for fewer.
fn trials_a_cell(plan: &Plan) -> usize {
    plan.trials.chunk_by(|a, b| a.condition == b.condition).map(<[_]>::len).max().unwrap_or(0)
}

fn source(plan: &Plan, published: Option<&String>) -> String {
    let section = plan.experiment.cite.as_ref().and_then(|cite| cite.section.clone());
    published.and(section).unwrap_or_default()
}
