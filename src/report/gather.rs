//! A report's content, gathered from a sealed bundle and the plan made again from it.

use super::assumptions::{assumptions, tried_with};
use super::content::{
    Answer, Citation, Figure, Headline, OutcomeCount, ReportContent, ReportTable,
};
use super::evaluation::{Evaluated, evaluation};
use super::origin::provenance;
use super::{claim, multiverse};
use crate::bundle::{self, Bundle, Exhibited, Fault, Forgetful, Gathered, assemble};
use crate::claims::published;
use crate::plan::{Plan, Selection};
use crate::studies::{Exhibit, Findings, GridRow, Ledger};

/// Why a bundle gives no report.
#[derive(Debug, thiserror::Error)]
pub enum UnreadBundle {
    /// Lines of it are no records.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "))]
    Records(Vec<Fault>),
    /// It holds no list of verdicts where one should be.
    #[error(transparent)]
    Verdicts(#[from] claim::NoVerdicts),
}

/// Returns what the page of `bundle` says; `plan` and `selection` are those made again from it.
///
/// # Errors
/// Where the records or verdicts cannot be read.
pub fn content_of(
    bundle: &Bundle,
    plan: &Plan,
    selection: &Selection,
) -> Result<ReportContent, UnreadBundle> {
    let scratch = Forgetful::default();
    let Gathered { ledger, .. } = bundle.gathered(plan, &scratch).map_err(UnreadBundle::Records)?;
    let experiment = &plan.experiment;
    let findings = assemble::findings(plan, &ledger);
    let cite = experiment.cite.as_ref();
    let machine_verdicts =
        bundle.circumstance_files().find(|(path, _)| *path == "claims.json").map(|(_, b)| b);
    let factors: Vec<String> = experiment.factors.iter().map(|f| f.name.clone()).collect();
    // A table that cannot be read as numbers of cells marks nothing.
    let published = experiment.published.iter();
    let published = published
        .map(|(name, table)| (name.clone(), published::read(table, &factors).unwrap_or_default()))
        .collect();
    let rows = |path: &str, bytes: Option<&[u8]>| {
        claim::rows(path, bytes, &experiment.claims, &published, &experiment.labels)
    };
    let compared = claim::compared(bundle.result("claims.json"), &experiment.labels);
    let claims = rows("results/claims.json", bundle.result("claims.json"))?;
    let machine_claims = rows("circumstances/claims.json", machine_verdicts)?;
    let section = cite.and_then(|cite| cite.section.as_deref()).unwrap_or_default();
    let exhibits: Vec<Exhibit> = experiment
        .tables
        .iter()
        .map(|request| request.exhibit(&findings, &experiment.tables))
        .collect();
    let answers = exhibits.iter().filter_map(|exhibit| {
        let answer = exhibit.answer.clone()?;
        Some(Answer { table: exhibit.id.clone(), question: exhibit.title.clone(), answer })
    });
    let answers: Vec<Answer> = answers.collect();
    let tables: Vec<ReportTable> = exhibits
        .into_iter()
        .map(|exhibit| ReportTable::of(exhibit, section, trials_a_cell(plan)))
        .collect();
    let figures = figures(bundle, plan, &findings);
    let drawn: Vec<&str> = figures.iter().map(|figure| figure.id.as_str()).collect();
    let grids: Vec<&[GridRow]> = tables.iter().map(|table| &table.rows[..]).collect();
    let censored = claims.iter().filter(|c| c.numbers.contains(claim::CENSORED)).count();
    let shown = Exhibited { tables: &grids, figures: &drawn, censored };
    let limits = bundle::limits(plan, &ledger, shown);
    let headline = headline(bundle, plan, &ledger);
    let circumstance = bundle.circumstance();
    let trial = plan.trials.first().map(|t| format!("{}/{}", t.condition.slug(), t.trial));
    Ok(ReportContent {
        title: experiment.title.clone(),
        checked: String::new(),
        citation: Citation {
            paper: cite.map(|c| c.paper.clone()).unwrap_or_default(),
            section: cite.and_then(|c| c.section.clone()).unwrap_or_default(),
            doi: cite.and_then(|c| c.doi.clone()).unwrap_or_default(),
        },
        authors: experiment.authors.iter().map(|a| a.name.clone()).collect(),
        license: experiment.license.clone().unwrap_or_default(),
        limits,
        partial: bundle::partial(plan, selection),
        evaluation: evaluation(Evaluated {
            file: &format!("{}-{}.zip", bundle.name(), bundle.results_digest().short()),
            trial: trial.as_deref().unwrap_or_default(),
            trials: headline.trials,
            sim_seconds: headline.sim_seconds,
            partial: plan.partial,
            judged: !claims.is_empty(),
            circumstance: circumstance.as_ref(),
        }),
        answers,
        headline,
        tables,
        figures,
        claims,
        machine_claims,
        compared: compared.unwrap_or_default(),
        assumptions: assumptions(experiment),
        tried_with: tried_with(experiment),
        multiverse: multiverse::matrix(experiment),
        provenance: provenance(bundle, plan),
    })
}

/// Returns how many trials were planned for a cell: fewer than the manifest's where `--trials` asked for fewer.
fn trials_a_cell(plan: &Plan) -> usize {
    plan.trials.chunk_by(|a, b| a.condition == b.condition).map(<[_]>::len).max().unwrap_or(0)
}

fn headline(bundle: &Bundle, plan: &Plan, ledger: &Ledger) -> Headline {
    let mut outcomes: Vec<OutcomeCount> = Vec::new();
    for trial in ledger.entries() {
        let name = trial.outcome().name();
        match outcomes.iter_mut().find(|o| o.name == name) {
            Some(outcome) => outcome.count += 1,
            None => outcomes.push(OutcomeCount { name: name.to_owned(), count: 1 }),
        }
    }
    outcomes.sort_by(|a, b| b.count.cmp(&a.count).then(a.name.cmp(&b.name)));
    Headline {
        study: plan.experiment.kind.name().to_owned(),
        trials: ledger.len() as u64,
        conditions: bundle.conditions().len() as u64,
        outcomes,
        sim_seconds: ledger.sim_seconds(),
        seed: plan.experiment.seed,
        results_digest: bundle.results_digest().hex(),
        bundle_id: bundle.bundle_id().map(|id| id.hex()).unwrap_or_default(),
        engine_version: bundle.engine().to_owned(),
    }
}

fn figures(bundle: &Bundle, plan: &Plan, findings: &Findings<'_>) -> Vec<Figure> {
    plan.experiment
        .figures
        .iter()
        .filter_map(|request| {
            let file = format!("figures/{}.svg", request.id);
            let bytes = bundle.result(&file)?;
            let drawn = request.draw(findings, &plan.experiment.tables)?;
            Some(Figure {
                id: request.id.clone(),
                title: request.title.clone(),
                caption: drawn.caption.to_owned(),
                alt: drawn.alt,
                svg: String::from_utf8_lossy(bytes).into_owned(),
                file: format!("results/{file}"),
            })
        })
        .collect()
}
