//! A report's content, gathered from a sealed bundle and the plan made again from it.

use super::content::{
    Assumption, Citation, ClaimRow, Command, Figure, Headline, InputRow, OutcomeCount,
    ReportContent,
};
use super::tables;
use crate::bundle::{Bundle, assemble, figures as drawings, format};
use crate::claims::verdict::agreement_in_words;
use crate::plan::Plan;
use crate::studies::{Findings, Outcome, StudyKind, TrialRecord};
use serde_json::Value;

/// What the page of `bundle` says, `plan` being the plan made again from it.
///
/// # Errors
/// Where the records or verdicts cannot be read, in words.
pub fn content_of(bundle: &Bundle, plan: &Plan) -> Result<ReportContent, String> {
    let records = bundle
        .records()
        .map_err(|faults| faults.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "))?;
    let experiment = &plan.experiment;
    let factors = assemble::factors(plan);
    let findings = assemble::findings(plan, &records, &factors);
    let cite = experiment.cite.as_ref();
    let machine_verdicts =
        bundle.circumstance_files().find(|(path, _)| *path == "claims.json").map(|(_, b)| b);
    Ok(ReportContent {
        title: experiment.title.clone(),
        citation: Citation {
            paper: cite.map(|c| c.paper.clone()).unwrap_or_default(),
            section: cite.and_then(|c| c.section.clone()).unwrap_or_default(),
        },
        authors: experiment.authors.iter().map(|a| a.name.clone()).collect(),
        license: experiment.license.clone().unwrap_or_default(),
        limits: limits(experiment.kind, &records),
        partial: plan.partial.then(|| {
            "only part of the study was run (--only, --trials or --shard); no claim is judged"
                .to_owned()
        }),
        headline: headline(bundle, plan, &records),
        tables: experiment
            .tables
            .iter()
            .map(|request| tables::table(&findings, request, plan))
            .collect(),
        figures: figures(bundle, plan, &findings),
        claims: claims("results/claims.json", bundle.result("claims.json"))?,
        machine_claims: claims("circumstances/claims.json", machine_verdicts)?,
        assumptions: experiment
            .assumptions
            .iter()
            .map(|a| Assumption {
                path: a.path.clone(),
                value: text_of(&a.value),
                why: a.why.clone(),
            })
            .collect(),
        inputs: bundle
            .inputs()
            .iter()
            .map(|input| InputRow {
                role: role(&input.as_written).to_owned(),
                written: input.as_written.clone(),
                sealed: input.path.clone(),
                sha256: input.sha256.hex(),
            })
            .collect(),
        commands: commands(bundle),
    })
}

fn limits(kind: StudyKind, records: &[TrialRecord]) -> Vec<String> {
    let mut limits = vec![
        "Simulated in two dimensions with Reenact's own worlds and robots: numbers are an analogue of the paper's, \
         whose runs used Gazebo and ROS."
            .to_owned(),
    ];
    let count = |wanted: fn(Outcome) -> bool| records.iter().filter(|r| wanted(r.outcome)).count();
    match kind {
        StudyKind::PriorMap => {
            let unfinished = count(|outcome| outcome != Outcome::Explored);
            if unfinished > 0 {
                limits.push(format!(
                    "{unfinished} of {} trials did not explore everything; cells say how many trials are behind a mean.",
                    records.len()
                ));
            }
        }
        StudyKind::Deadline => limits.push(
            "The paper's building is published as a picture only: this one is invented, after what the paper's tables \
             imply, so that none of its numbers is an independent test of the building."
                .to_owned(),
        ),
    }
    let panicked = count(|outcome| outcome == Outcome::Panicked);
    if panicked > 0 {
        limits.push(format!(
            "{panicked} trials failed to run: a fault of the program, not a result."
        ));
    }
    limits
}

fn headline(bundle: &Bundle, plan: &Plan, records: &[TrialRecord]) -> Headline {
    let mut outcomes: Vec<OutcomeCount> = Vec::new();
    for record in records {
        let name = record.outcome.name();
        match outcomes.iter_mut().find(|o| o.name == name) {
            Some(outcome) => outcome.count += 1,
            None => outcomes.push(OutcomeCount { name: name.to_owned(), count: 1 }),
        }
    }
    outcomes.sort_by(|a, b| b.count.cmp(&a.count).then(a.name.cmp(&b.name)));
    Headline {
        study: plan.resolved_json()["study"].as_str().unwrap_or_default().to_owned(),
        trials: records.len() as u64,
        conditions: bundle.conditions().len() as u64,
        outcomes,
        sim_seconds: records.iter().map(|r| r.sim_seconds).sum(),
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
            let bytes = bundle.result(&format!("figures/{}.svg", request.id))?;
            let drawn = drawings::draw(plan, findings, request);
            Some(Figure {
                id: request.id.clone(),
                title: request.title.clone(),
                caption: drawn.caption.to_owned(),
                alt: drawn.alt,
                svg: String::from_utf8_lossy(bytes).into_owned(),
            })
        })
        .collect()
}

fn claims(path: &str, bytes: Option<&[u8]>) -> Result<Vec<ClaimRow>, String> {
    let Some(bytes) = bytes else { return Ok(Vec::new()) };
    let verdicts: Vec<Value> = serde_json::from_slice(bytes).map_err(|e| format!("{path}: {e}"))?;
    let text = |v: &Value, key: &str| v[key].as_str().unwrap_or_default().to_owned();
    let row = |v: &Value| ClaimRow {
        id: text(v, "id"),
        says: text(v, "says"),
        cite: text(v, "cite"),
        verdict: text(v, "verdict"),
        numbers: numbers(v) + &censored(v),
        paper_table: text(v, "paper-table"),
    };
    Ok(verdicts.iter().map(row).collect())
}

/// The sentence that decided a verdict, and of a single comparison the effect with its interval.
fn numbers(verdict: &Value) -> String {
    let reason = verdict["reason"].as_str().unwrap_or_default().to_owned();
    let Some([only]) = verdict["comparisons"].as_array().map(Vec::as_slice) else { return reason };
    let effect = &only["effect"];
    let number = |key: &str| effect[key].as_f64().map(|x| format!("{x:.3}"));
    let name = effect["name"].as_str().map(|name| name.replace('-', " "));
    match (name, number("value"), number("low"), number("high")) {
        (Some(name), Some(value), Some(low), Some(high)) => {
            let statistics = only["statistics"].as_object().into_iter().flatten();
            let known = statistics.filter_map(|(name, x)| Some((name.as_str(), x.as_f64()?)));
            let agreement = agreement_in_words(known);
            let more = if agreement.is_empty() { reason } else { format!("{agreement}; {reason}") };
            format!("{name} {value} ({low} to {high}), {more}")
        }
        _ => reason,
    }
}

/// Runs that never reached what they were compared by, in words; empty where all did.
fn censored(verdict: &Value) -> String {
    let comparisons = verdict["comparisons"].as_array().map(Vec::as_slice).unwrap_or_default();
    let cells =
        comparisons.iter().filter_map(|comparison| comparison["cells"].as_array()).flatten();
    let mut seen: Vec<(&str, u64, u64)> = Vec::new();
    for cell in cells {
        let count = |key: &str| cell[key].as_u64().unwrap_or(0);
        let one = (cell["cell"].as_str().unwrap_or_default(), count("reached"), count("trials"));
        if !seen.contains(&one) {
            seen.push(one);
        }
    }
    let all: u64 = seen.iter().map(|cell| cell.2).sum();
    let reached: u64 = seen.iter().map(|cell| cell.1).sum();
    if reached < all {
        format!("; {} of {all} runs compared never reached the measure", all - reached)
    } else {
        String::new()
    }
}

fn commands(bundle: &Bundle) -> Vec<Command> {
    let file = format!("{}-{}.zip", bundle.name(), bundle.results_digest().short());
    let command = |purpose: &str, line: String| Command { purpose: purpose.to_owned(), line };
    vec![
        command(
            "check every checksum and derive every table anew",
            format!("reenact verify {file}"),
        ),
        command(
            "execute every trial again, bit for bit",
            format!("reenact verify --level 5 {file}"),
        ),
        command("run the study", format!("reenact run {}", format::STUDY)),
    ]
}

fn role(as_written: &str) -> &'static str {
    match as_written.rsplit('.').next() {
        Some("urdf") => "robot",
        Some("csv") => "published",
        Some("world" | "sdf") => "world",
        Some("png" | "pgm") => "prior",
        _ if as_written.contains("world") => "world",
        _ => "input",
    }
}

fn text_of(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}
