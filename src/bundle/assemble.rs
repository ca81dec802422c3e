//! From a plan and its records to everything a bundle says: the one function that `run` seals with and
//! `verify` derives with.

use super::content::{Author, BundleContent, Citation, SealedCondition, SealedInput};
use super::figures;
use crate::claims::{self, Claim, Verdict};
use crate::plan::{ENGINE_VERSION, Plan, Selection};
use crate::studies::{Findings, Outcome, StudyKind, TableLayout, TrialRecord, coverage_tables};
use serde_json::{Value, json};

/// The content of the bundle of `plan`, whose trials yielded `records` (in plan order).
///
/// # Errors
/// Where a claim cannot be judged at all, in words; resolution has refused such manifests before.
pub fn assemble(
    plan: &Plan,
    study_yaml: &[u8],
    selection: &Selection,
    records: &[TrialRecord],
) -> Result<BundleContent, String> {
    let experiment = &plan.experiment;
    let mut resolved = plan.resolved_json();
    if plan.partial
        && let Value::Object(map) = &mut resolved
    {
        map.insert("selection".to_owned(), selection.to_json());
    }
    let inputs = experiment.inputs.iter().map(|input| SealedInput {
        name: input.name.clone(),
        as_written: input.as_written.clone(),
        bytes: input.bytes.to_vec(),
        license: input.license.clone(),
    });
    let cite = experiment.cite.as_ref().map(|cite| Citation {
        text: cite
            .section
            .as_ref()
            .map_or_else(|| cite.paper.clone(), |section| format!("{}, {section}", cite.paper)),
        url: cite.doi.as_ref().map(|doi| format!("https://doi.org/{doi}")),
    });
    let description = match &experiment.cite {
        Some(cite) => format!("{}. Re-enacts {}.", experiment.title, cite.paper),
        None => format!("{}.", experiment.title),
    };
    Ok(BundleContent {
        name: experiment.name.clone(),
        title: experiment.title.clone(),
        description,
        cite,
        authors: experiment
            .authors
            .iter()
            .map(|author| Author {
                name: author.name.clone(),
                affiliation: author.affiliation.clone(),
                affiliation_url: None,
                orcid: author.orcid.clone(),
            })
            .collect(),
        license: experiment.license.clone().unwrap_or_else(|| "No licence stated".to_owned()),
        seed: experiment.seed,
        engine: ENGINE_VERSION.to_owned(),
        study_yaml: study_yaml.to_vec(),
        resolved,
        inputs: inputs.collect(),
        conditions: sealed_conditions(plan, records),
        results: results(plan, records)?,
        partial: plan.partial,
    })
}

/// The claims of `plan`'s manifest.
///
/// # Errors
/// Where one is none, in words.
pub fn claims(plan: &Plan) -> Result<Vec<Claim>, String> {
    let read = |written: &Value| {
        serde_json::from_value(written.clone()).map_err(|e| format!("claim: {e}"))
    };
    plan.experiment.claims.iter().map(read).collect()
}

/// The verdicts on the claims of `plan`'s manifest about the study, as `results/claims.json` holds them: none for
/// partial runs. Claims about the machine are judged by [`super::wall_time`].
///
/// # Errors
/// Where a claim cannot be judged at all, in words.
pub fn verdicts(plan: &Plan, records: &[TrialRecord]) -> Result<Vec<Verdict>, String> {
    if plan.partial {
        return Ok(Vec::new());
    }
    let experiment = &plan.experiment;
    let context =
        claims::Context::new(&experiment.published, &experiment.shared_noise, experiment.seed);
    let factors = factors(plan);
    let trials = findings(plan, records, &factors).trials();
    let about_the_study = claims(plan)?.into_iter().filter(|claim| !claim.circumstance);
    about_the_study.map(|claim| claims::judge(&claim, &trials, &context)).collect()
}

/// Factors with their values, as results name them.
pub fn factors(plan: &Plan) -> Vec<(String, Vec<String>)> {
    plan.experiment.factors.iter().map(|f| (f.name.clone(), f.values.clone())).collect()
}

/// What tables and figures of `plan` are made from.
pub fn findings<'a>(
    plan: &'a Plan,
    records: &'a [TrialRecord],
    factors: &'a [(String, Vec<String>)],
) -> Findings<'a> {
    let experiment = &plan.experiment;
    let calibration = experiment.conditions.iter().find_map(|(_, setup)| setup.calibration());
    Findings { factors, records, published: &experiment.published, calibration }
}

fn sealed_conditions(plan: &Plan, records: &[TrialRecord]) -> Vec<SealedCondition> {
    let mut conditions: Vec<SealedCondition> = Vec::new();
    for (spec, record) in plan.trials.iter().zip(records) {
        let slug = spec.condition.slug();
        if conditions.last().is_none_or(|last| last.slug != slug) {
            let label = spec.condition.to_string();
            conditions.push(SealedCondition { slug, label, records: Vec::new(), failed: 0 });
        }
        if let Some(last) = conditions.last_mut() {
            last.records.push(record.to_line());
            last.failed += usize::from(record.outcome == Outcome::Panicked);
        }
    }
    conditions
}

fn results(plan: &Plan, records: &[TrialRecord]) -> Result<Vec<(String, Vec<u8>)>, String> {
    let factors = factors(plan);
    let findings = findings(plan, records, &factors);
    let mut files = vec![("trials.csv".to_owned(), findings.trials().to_csv().into_bytes())];
    let experiment = &plan.experiment;
    match experiment.kind {
        StudyKind::PriorMap => {
            files.push(("series.csv".to_owned(), findings.series().to_csv().into_bytes()));
        }
        StudyKind::Deadline => {}
    }
    for request in &experiment.tables {
        let path = |extension| format!("tables/{}.{extension}", request.id);
        let mut note = String::new();
        let (tidy, print) = match &request.layout {
            TableLayout::CoverageTable(wanted) => {
                (findings.coverage_table(wanted), findings.coverage_table_in_print(wanted))
            }
            TableLayout::AgreementTable(wanted) => {
                let tables = coverage_tables(&experiment.tables);
                let print = findings.agreement_table_in_print(wanted, &tables);
                (findings.agreement_table(wanted, &tables), print)
            }
            TableLayout::EffectsTable(wanted) => {
                let (print, more) = findings.effects_table_in_print(wanted);
                if more > 0 {
                    note = format!("\n{more} more in {}.csv\n", request.id);
                }
                (findings.effects_table(wanted), print)
            }
            TableLayout::MeasuresTable(wanted) => {
                (findings.measures_table(wanted), findings.measures_table_in_print(wanted))
            }
            TableLayout::OutcomeTable(wanted) => {
                (findings.outcome_table(wanted), findings.outcome_table_in_print(wanted))
            }
            TableLayout::ManeuverTable(wanted) => {
                let table = findings.maneuver_table(wanted);
                (table.clone(), table)
            }
        };
        files.push((path("csv"), tidy.to_csv().into_bytes()));
        let print = format!("# {}\n\n{}{note}", request.title, print.to_markdown());
        files.push((path("md"), print.into_bytes()));
    }
    for request in &experiment.figures {
        let svg = figures::draw(plan, &findings, request).svg;
        files.push((format!("figures/{}.svg", request.id), svg.into_bytes()));
    }
    files.push(("claims.json".to_owned(), verdicts_json(&verdicts(plan, records)?)));
    Ok(files)
}

/// A list of verdicts as bundles hold it.
pub(super) fn verdicts_json(verdicts: &[Verdict]) -> Vec<u8> {
    let list: Vec<Value> = verdicts.iter().map(Verdict::to_json).collect();
    (crate::json::canonical(&json!(list)) + "\n").into_bytes()
}
