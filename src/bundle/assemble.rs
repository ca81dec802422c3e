//! From a plan and its records to everything a bundle says: the one function that `run` seals with and
//! `verify` derives with.

use super::content::{BundleContent, Person, Publication, SealedCondition, SealedInput};
use super::{format, wall_time};
use crate::claims::multiverse::Explanation;
use crate::claims::observations::TrialsTableError;
use crate::claims::{self, ClaimVerdict, Observations};
use crate::json::AsWritten;
use crate::manifest::InputKind;
use crate::plan::{Plan, Selection, engine_version};
use crate::studies::{Dictionary, Exhibit, Findings, Outcome, TrialRecord};
use crate::table::{Column, DescribedTable, Table};
use serde_json::json;

/// Makes the content of the bundle of `plan`, whose trials yielded `records` (in plan order).
///
/// # Errors
/// Where no claim can be judged by such records; resolution has refused such manifests before.
pub fn assemble(
    plan: &Plan,
    study_yaml: &[u8],
    selection: &Selection,
    records: &[TrialRecord],
) -> Result<BundleContent, TrialsTableError> {
    let verdicts = verdicts(plan, records)?;
    Ok(assemble_judged(plan, study_yaml, selection, records, &verdicts))
}

/// Makes the content of the bundle of `plan` where its claims are judged already: `verdicts` are those of [`verdicts`].
pub fn assemble_judged(
    plan: &Plan,
    study_yaml: &[u8],
    selection: &Selection,
    records: &[TrialRecord],
    verdicts: &[ClaimVerdict],
) -> BundleContent {
    let experiment = &plan.experiment;
    let mut resolved = plan.resolved();
    if plan.partial {
        resolved.selection = AsWritten::of(selection);
    }
    let inputs = experiment.inputs.iter().map(|input| SealedInput {
        name: input.name.clone(),
        as_written: input.as_written.clone(),
        bytes: input.bytes.to_vec(),
        license: input.license.clone(),
    });
    let cite = experiment.cite.as_ref().map(|cite| Publication {
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
    let sealed_at = |as_written: &str| {
        let input = experiment.inputs.iter().find(|input| input.as_written == as_written)?;
        Some(format!("{}{}", format::INPUTS, input.name))
    };
    let (results, mut tables) = results(plan, records, verdicts);
    tables.extend(described_inputs(plan));
    // What was found before what was given.
    tables.sort_by_key(|table| (table.path.starts_with(format::INPUTS), table.path.clone()));
    BundleContent {
        name: experiment.name.clone(),
        title: experiment.title.clone(),
        description,
        cite,
        authors: experiment
            .authors
            .iter()
            .map(|author| Person {
                name: author.name.clone(),
                affiliation: author.affiliation.clone(),
                affiliation_url: None,
                orcid: author.orcid.as_deref().map(orcid_address),
            })
            .collect(),
        license: experiment.license.clone().unwrap_or_else(|| "No licence stated".to_owned()),
        seed: experiment.seed,
        engine: engine_version(experiment.kind),
        study_yaml: study_yaml.to_vec(),
        resolved,
        inputs: inputs.collect(),
        conditions: sealed_conditions(plan, records),
        results,
        tables,
        robustness: experiment.sensitivity.as_ref().and_then(|known| sealed_at(&known.as_written)),
        multiverse: experiment.multiverse.as_ref().and_then(|known| sealed_at(&known.as_written)),
        partial: plan.partial,
    }
}

/// Judges the claims of `plan`'s manifest about the study and returns the verdicts as `results/claims.json` holds them:
/// none for partial runs. Claims about the machine are judged by [`super::wall_time`].
///
/// # Errors
/// Where no claim can be judged by such records.
pub fn verdicts(
    plan: &Plan,
    records: &[TrialRecord],
) -> Result<Vec<ClaimVerdict>, TrialsTableError> {
    if plan.partial {
        return Ok(Vec::new());
    }
    let experiment = &plan.experiment;
    let context =
        claims::Context::new(&experiment.published, &experiment.shared_noise, experiment.seed);
    let trials = findings(plan, records).trials();
    let about_the_study: Vec<_> =
        experiment.claims.iter().filter(|claim| !claim.circumstance).collect();
    if about_the_study.is_empty() {
        return Ok(Vec::new());
    }
    // Read once: to read thousands of trials takes longer than to judge a claim by them.
    let observations = Observations::read(&trials)?;
    let judged = about_the_study
        .into_iter()
        .map(|claim| claims::judge_observations(claim, &observations, &context));
    Ok(judged.collect())
}

/// Returns what tables and figures of `plan` are made from.
pub fn findings<'a>(plan: &'a Plan, records: &'a [TrialRecord]) -> Findings<'a> {
    let experiment = &plan.experiment;
    Findings::new(&experiment.factors, records, &experiment.published).designed(experiment.design())
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
            last.failed += usize::from(record.outcome == Outcome::PANICKED);
        }
    }
    conditions
}

/// Writes an author's ORCID iD, in whatever form a manifest gives it, as the address that identifies a person.
fn orcid_address(written: &str) -> String {
    let id = written.rsplit('/').next().unwrap_or(written);
    format!("https://orcid.org/{id}")
}

/// Files under `results/`: paths there, and bytes; and what the columns of their tables say.
type Results = (Vec<(String, Vec<u8>)>, Vec<DescribedTable>);

fn results(plan: &Plan, records: &[TrialRecord], verdicts: &[ClaimVerdict]) -> Results {
    let experiment = &plan.experiment;
    let findings = findings(plan, records);
    let further_outcomes = further_outcomes(plan);
    let dictionary = dictionary(plan, &further_outcomes);
    let in_results = |path: &str| format!("{}{path}", format::RESULTS);
    let trials = findings.trials();
    let words = ("Trials", "one trial, in plan order");
    let mut described = vec![DescribedTable {
        key: vec!["key".to_owned()],
        ..DescribedTable::of(&trials, in_results("trials.csv"), words, |name| {
            dictionary.of_trials(name)
        })
    }];
    if measures_the_machine(plan) {
        let path = format!("{}wall-times.csv", format::CIRCUMSTANCES);
        let words = ("Wall times", "one trial, in plan order");
        let columns = wall_time::columns(&experiment.factors);
        described.push(DescribedTable {
            key: vec!["key".to_owned()],
            ..DescribedTable::of(&Table::new(columns), path, words, |name| {
                dictionary.of_wall_times(name)
            })
        });
    }
    let mut files = vec![("trials.csv".to_owned(), trials.to_csv().into_bytes())];
    if experiment.kind.has_series() {
        let series = findings.series();
        let row = "one point of a trial's curve: where coverage first crosses a whole percent, and every 10 s";
        described.push(DescribedTable::of(
            &series,
            in_results("series.csv"),
            ("Curves of the trials", row),
            |name| dictionary.of_series(name),
        ));
        files.push(("series.csv".to_owned(), series.to_csv().into_bytes()));
    }
    for request in &experiment.tables {
        let exhibit = request.exhibit(&findings, &experiment.tables);
        let path = |extension| format!("tables/{}.{extension}", request.id);
        described.push(described_table(&exhibit, in_results(&path("csv"))));
        files.push((path("csv"), exhibit.tidy.to_csv().into_bytes()));
        files.push((path("md"), in_markdown(&exhibit).into_bytes()));
    }
    for request in &experiment.figures {
        if let Some(drawn) = request.draw(&findings, &experiment.tables) {
            files.push((format!("figures/{}.svg", request.id), drawn.svg.into_bytes()));
        }
    }
    files.push(("claims.json".to_owned(), verdicts_json(verdicts)));
    if let Some(known) = &experiment.multiverse {
        let explanation = known.table.explanation();
        let tidy = explanation.tidy();
        described.push(DescribedTable {
            key: vec!["claim".to_owned(), "setting".to_owned()],
            ..DescribedTable::of(
                &tidy,
                in_results("multiverse.csv"),
                ("Claims and choices", "one claim and one choice that all draws change"),
                Explanation::tidy_column,
            )
        });
        files.push(("multiverse.csv".to_owned(), tidy.to_csv().into_bytes()));
        files.push(("multiverse.md".to_owned(), explanation.to_markdown().into_bytes()));
    }
    (files, described)
}

/// Returns how trials of `plan` can end besides the study's own ways.
fn further_outcomes(plan: &Plan) -> Vec<Outcome> {
    let mut found = Vec::new();
    for condition in &plan.experiment.conditions {
        for outcome in condition.setup.further_outcomes() {
            if !found.contains(outcome) {
                found.push(*outcome);
            }
        }
    }
    found
}

fn dictionary<'a>(plan: &'a Plan, further_outcomes: &'a [Outcome]) -> Dictionary<'a> {
    let experiment = &plan.experiment;
    Dictionary { kind: experiment.kind, factors: &experiment.factors, further_outcomes }
}

/// Returns what the data dictionary says of `exhibit`, whose tidy form lies at `path`.
pub(crate) fn described_table(exhibit: &Exhibit, path: String) -> DescribedTable {
    DescribedTable {
        path,
        title: exhibit.title.clone(),
        row: "one cell of the printed table".to_owned(),
        key: Vec::new(),
        columns: exhibit.columns.clone(),
    }
}

/// Returns `exhibit` as a document: its lines, and below them what they leave out and what the marks beside the paper's numbers mean.
pub(crate) fn in_markdown(exhibit: &Exhibit) -> String {
    let answer = exhibit.answer.iter().map(|answer| format!("{answer}\n\n"));
    let answer: String = answer.collect();
    let mut text = format!("# {}\n\n{answer}{}", exhibit.title, exhibit.print().to_markdown());
    if exhibit.set.more > 0 {
        text.push_str(&format!("\n{} more in {}.csv\n", exhibit.set.more, exhibit.id));
    }
    if let Some(rules) = exhibit.rules() {
        text.push_str(&format!("\nMarks: {rules}.\n"));
    }
    text
}

/// Returns whether the run measures the machine.
fn measures_the_machine(plan: &Plan) -> bool {
    !plan.partial && plan.experiment.claims.iter().any(|claim| claim.circumstance)
}

/// Describes the columns of the inputs in CSV: the paper's own numbers, the calibration of maneuvers, and what became
/// of the claims at other values of the assumptions.
fn described_inputs(plan: &Plan) -> Vec<DescribedTable> {
    let further_outcomes = further_outcomes(plan);
    let dictionary = dictionary(plan, &further_outcomes);
    let mut described: Vec<DescribedTable> = Vec::new();
    for input in &plan.experiment.inputs {
        let path = format!("{}{}", format::INPUTS, input.name);
        // Two paths may lead to one file.
        if format::media_type(&path) != "text/csv" || described.iter().any(|t| t.path == path) {
            continue;
        }
        let text = std::str::from_utf8(&input.bytes).ok();
        let Some(table) = text.and_then(|text| Table::from_csv(text).ok()) else { continue };
        described.push(match input.kind {
            InputKind::Passages => {
                let words = ("Passages of the calibration", "one isolated passage, in plan order");
                DescribedTable::of(&table, path, words, Dictionary::of_passages)
            }
            InputKind::Maneuvers => {
                let words = ("Calibration of the maneuvers", "one maneuver");
                DescribedTable::of(&table, path, words, Dictionary::of_calibration)
            }
            InputKind::Robustness => {
                let words = ("Claims at other values of the assumptions", "one claim at one value");
                DescribedTable::of(&table, path, words, Dictionary::of_sensitivity)
            }
            InputKind::Multiverse => {
                let words = ("Claims at draws of all assumptions together", "one draw");
                DescribedTable::of(&table, path, words, Dictionary::of_multiverse)
            }
            // Nothing else is read as a CSV; what a calibration reads so are the paper's numbers, too.
            InputKind::PublishedNumbers
            | InputKind::Calibration
            | InputKind::Settings
            | InputKind::Robot
            | InputKind::World
            | InputKind::Prior => {
                let words = ("Numbers that the paper prints", "one printed number");
                DescribedTable::of(&table, path, words, |name| {
                    dictionary.of_published(name).or_else(|| cell_of_observed(plan, name))
                })
            }
        });
    }
    described
}

/// Describes a column that tells apart the cells of the table that an inference observes.
fn cell_of_observed(plan: &Plan, name: &str) -> Option<Column> {
    let by = plan.experiment.document.node("/infer/by")?.to_json();
    let is_level = by.as_array()?.iter().any(|level| level == name);
    is_level.then(|| Column::text(name, "Level of the paper's table: tells its cells apart"))
}

/// Writes a list of verdicts as bundles hold it.
pub(super) fn verdicts_json(verdicts: &[ClaimVerdict]) -> Vec<u8> {
    (crate::json::canonical(&json!(verdicts)) + "\n").into_bytes()
}
