//! From a plan and its records to everything a bundle says: the one function that `run` seals with and
//! `verify` derives with.

use super::account::{Account, Shown, ToldFigure};
use super::content::{BundleContent, Person, Publication, SealedCondition, SealedInput, in_parts};
use super::{Content, Gathered, InMemory, LargeFile, Scratch, Spool, format, wall_time};
use crate::claims::multiverse::Explanation;
use crate::claims::observations::TrialColumns;
use crate::claims::observations::TrialsTableError;
use crate::claims::{self, ClaimVerdict, Observations, tidy};
use crate::json::AsWritten;
use crate::manifest::InputKind;
use crate::plan::{Plan, Selection, engine_version};
use crate::studies::inference::InferenceDesign;
use crate::studies::{Dictionary, Exhibit, Findings, Ledger, Outcome, TrialRecord};
use crate::table::{Column, DescribedTable, Table, Value, csv_line};
use serde_json::json;
use std::collections::BTreeMap;
use std::io::{self, Write as _};
use std::sync::Arc;

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
    let Gathered { ledger, conditions } = Gathered::of(plan, records);
    let verdicts = verdicts_of(plan, &ledger)?;
    let asked = Asked { plan, study_yaml, selection };
    let content = assemble_judged(asked, &ledger, conditions, &verdicts, &InMemory::default());
    Ok(content.expect("memory takes every byte"))
}

/// What was asked: a plan, and what it was made from.
#[derive(Debug, Clone, Copy)]
pub struct Asked<'a> {
    /// The plan.
    pub plan: &'a Plan,
    /// The manifest, byte for byte.
    pub study_yaml: &'a [u8],
    /// The part of it that was run.
    pub selection: &'a Selection,
}

/// Makes the content of the bundle of what was `asked` where its claims are judged already: `ledger` and `conditions` were gathered
/// from the records, `verdicts` are those of [`verdicts_of`]. What is large is written to `scratch`.
///
/// # Errors
/// Where it cannot be written.
pub fn assemble_judged(
    Asked { plan, study_yaml, selection }: Asked<'_>,
    ledger: &Ledger,
    conditions: Vec<SealedCondition>,
    verdicts: &[ClaimVerdict],
    scratch: &dyn Scratch,
) -> io::Result<BundleContent> {
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
    let Results { held: results, large: large_results, mut tables, exhibits, figures } =
        results(plan, ledger, verdicts, !in_parts(&conditions), scratch)?;
    let account = Account::of(Shown {
        plan,
        ledger,
        conditions: conditions.len() as u64,
        partial: super::partial(plan, selection),
        verdicts,
        exhibits,
        figures,
    });
    tables.extend(described_inputs(plan));
    // What was found before what was given.
    tables.sort_by_key(|table| (table.path.starts_with(format::INPUTS), table.path.clone()));
    Ok(BundleContent {
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
        conditions,
        results,
        large_results,
        tables,
        robustness: experiment.sensitivity.as_ref().and_then(|known| sealed_at(&known.as_written)),
        multiverse: experiment.multiverse.as_ref().and_then(|known| sealed_at(&known.as_written)),
        partial: plan.partial,
        account,
    })
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
    verdicts_of(plan, &Ledger::of(records))
}

/// Does the same with the trials of `ledger`.
///
/// # Errors
/// As [`verdicts`].
pub fn verdicts_of(plan: &Plan, ledger: &Ledger) -> Result<Vec<ClaimVerdict>, TrialsTableError> {
    if plan.partial {
        return Ok(Vec::new());
    }
    let experiment = &plan.experiment;
    let context =
        claims::Context::new(&experiment.published, &experiment.shared_noise, experiment.seed)
            .over_draws(experiment.draws());
    let about_the_study: Vec<_> =
        experiment.claims.iter().filter(|claim| !claim.circumstance).collect();
    if about_the_study.is_empty() {
        return Ok(Vec::new());
    }
    // Read once: to read thousands of trials takes longer than to judge a claim by them.
    let observations = observed(plan, ledger)?;
    let judged = about_the_study
        .into_iter()
        .map(|claim| claims::judge_observations(claim, &observations, &context));
    Ok(judged.collect())
}

/// Returns the trials of `ledger` as claims are judged by them.
fn observed(plan: &Plan, ledger: &Ledger) -> Result<Observations, TrialsTableError> {
    let factors = &plan.experiment.factors;
    let measures = findings(plan, ledger).measures();
    let mut names: BTreeMap<&str, Arc<str>> = BTreeMap::new();
    let columns = ledger.groups().iter().map(|group| {
        let value = |name: &String| group.condition().value(name).unwrap_or_default().to_owned();
        let mut outcome = |outcome: Outcome| {
            let name = outcome.name();
            Arc::clone(names.entry(name).or_insert_with(|| name.into()))
        };
        TrialColumns {
            values: factors.iter().map(|factor| value(&factor.name)).collect(),
            numbers: group.entries().map(|trial| i64::from(trial.trial())).collect(),
            outcomes: group.entries().map(|trial| outcome(trial.outcome())).collect(),
            measures: group
                .measures()
                .map(|name| (name.to_owned(), group.column(name).collect()))
                .collect(),
        }
    });
    let factors = factors.iter().map(|factor| factor.name.clone()).collect();
    Observations::of_columns(factors, measures.into_iter().map(str::to_owned).collect(), columns)
}

/// Returns what tables and figures of `plan` are made from.
pub fn findings<'a>(plan: &'a Plan, ledger: &'a Ledger) -> Findings<'a> {
    let experiment = &plan.experiment;
    Findings::new(&experiment.factors, ledger, &experiment.published)
        .designed(experiment.design())
        .labelled(&experiment.labels)
        .inferring(experiment.from_trials.as_ref())
}

/// Writes an author's ORCID iD, in whatever form a manifest gives it, as the address that identifies a person.
fn orcid_address(written: &str) -> String {
    let id = written.rsplit('/').next().unwrap_or(written);
    format!("https://orcid.org/{id}")
}

/// Files under `results/`, by their paths there.
#[derive(Default)]
struct Results {
    held: Vec<(String, Vec<u8>)>,
    large: Vec<(String, LargeFile)>,
    /// What the columns of their tables say.
    tables: Vec<DescribedTable>,
    /// Their tables, as they are shown.
    exhibits: Vec<Exhibit>,
    /// Their figures, as they are told.
    figures: Vec<ToldFigure>,
}

impl Results {
    /// Adds the table of these columns and rows, which has a row for each trial or more.
    fn add_rows(
        &mut self,
        path: &str,
        columns: &[String],
        rows: impl Iterator<Item = Vec<Value>>,
        scratch: &dyn Scratch,
    ) -> io::Result<()> {
        let mut spool = Spool::new(scratch);
        spool.write_all(csv_line(columns.iter().cloned()).as_bytes())?;
        for row in rows {
            spool.write_all(csv_line(row.iter().map(ToString::to_string)).as_bytes())?;
        }
        match spool.finish()? {
            Content::Held(bytes) => self.held.push((path.to_owned(), bytes)),
            Content::Large(file) => self.large.push((path.to_owned(), file)),
        }
        Ok(())
    }
}

fn results(
    plan: &Plan,
    ledger: &Ledger,
    verdicts: &[ClaimVerdict],
    with_series: bool,
    scratch: &dyn Scratch,
) -> io::Result<Results> {
    let experiment = &plan.experiment;
    let mut found = Results::default();
    let findings = findings(plan, ledger);
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
    found.add_rows("trials.csv", &trials.columns, findings.trial_rows(), scratch)?;
    if with_series && experiment.kind.has_series() {
        let series = findings.series();
        let row = "one point of a trial's curve: where coverage first crosses a whole percent, and every 10 s";
        described.push(DescribedTable {
            joins: Some(("key", in_results("trials.csv"))),
            ..DescribedTable::of(
                &series,
                in_results("series.csv"),
                ("Curves of the trials", row),
                |name| dictionary.of_series(name),
            )
        });
        found.add_rows("series.csv", &series.columns, findings.series_rows(), scratch)?;
    }
    let files = &mut found.held;
    for request in &experiment.tables {
        let exhibit = request.exhibit(&findings, &experiment.tables);
        let path = |extension| format!("tables/{}.{extension}", request.id);
        described.push(described_table(&exhibit, in_results(&path("csv"))));
        files.push((path("csv"), exhibit.tidy.to_csv().into_bytes()));
        files.push((path("md"), in_markdown(&exhibit).into_bytes()));
        found.exhibits.push(exhibit);
    }
    for request in &experiment.figures {
        if let Some(drawn) = request.draw(&findings, &experiment.tables) {
            let path = format!("figures/{}.svg", request.id);
            found.figures.push(ToldFigure {
                path: in_results(&path),
                title: request.title.clone(),
                caption: drawn.caption.to_owned(),
                alt: drawn.alt,
            });
            files.push((path, drawn.svg.into_bytes()));
        }
    }
    files.push(("claims.json".to_owned(), verdicts_json(verdicts)));
    if !verdicts.is_empty() {
        let (claims, comparisons) = (tidy::claims(verdicts), tidy::comparisons(verdicts));
        described.push(DescribedTable {
            key: vec!["claim".to_owned()],
            ..DescribedTable::of(
                &claims,
                in_results("claims.csv"),
                ("Verdicts on the claims", "one claim, in the manifest's order"),
                tidy::claims_column,
            )
        });
        described.push(DescribedTable {
            key: vec!["claim".to_owned(), "comparison".to_owned()],
            joins: Some(("claim", in_results("claims.csv"))),
            ..DescribedTable::of(
                &comparisons,
                in_results("comparisons.csv"),
                ("Comparisons behind the verdicts", "one comparison of a claim"),
                tidy::comparisons_column,
            )
        });
        files.push(("claims.csv".to_owned(), claims.to_csv().into_bytes()));
        files.push(("comparisons.csv".to_owned(), comparisons.to_csv().into_bytes()));
    }
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
    found.tables = described;
    Ok(found)
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
        joins: None,
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
            InputKind::Draws => {
                let columns = columns_of_draws(plan);
                let words = ("Draws of the posterior", "one draw: a value of the factor of draws");
                DescribedTable::of(&table, path, words, |name| {
                    columns.iter().find(|column| column.name == name).cloned()
                })
            }
            // Nothing else is read as a CSV; what other manifests read so are the paper's numbers, too.
            InputKind::PublishedNumbers
            | InputKind::Calibration
            | InputKind::Inference
            | InputKind::Proposals
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

/// Describes the columns of the table of draws that the study runs.
fn columns_of_draws(plan: &Plan) -> Vec<Column> {
    let Some(run) = plan.experiment.inference() else { return Vec::new() };
    let conditions: Vec<_> = run.experiment.design().collect();
    let design = InferenceDesign::of(&run.experiment.factors, &conditions);
    design.map_or_else(Vec::new, |design| design.columns())
}

/// Describes a column that tells apart the cells of the table that an inference observes, the study's own or the one whose draws
/// it runs.
fn cell_of_observed(plan: &Plan, name: &str) -> Option<Column> {
    let inference = plan.experiment.inference().map(|run| &run.experiment.document);
    let mut by = [Some(&plan.experiment.document), inference]
        .into_iter()
        .flatten()
        .filter_map(|document| document.node("/infer/by"));
    let is_level = by.any(|by| by.to_json().as_array().is_some_and(|by| by.contains(&name.into())));
    is_level.then(|| Column::text(name, "Level of the paper's table: tells its cells apart"))
}

/// Writes a list of verdicts as bundles hold it.
pub(super) fn verdicts_json(verdicts: &[ClaimVerdict]) -> Vec<u8> {
    (crate::json::canonical(&json!(verdicts)) + "\n").into_bytes()
}
