//! `reenact vary`: the claims of a manifest, judged again with one assumption at a time moved to each other value that
//! its `range` states, or with all of them drawn together.

mod joint;

use super::execution::{Execution, Times, jobs};
use crate::bundle::assemble;
use crate::claims::ClaimVerdict;
use crate::claims::sensitivity::{Attempt, Flip, Sensitivity, in_words};
use crate::cli::args::{DataFormat, VaryArgs};
use crate::cli::exit::{Exit, Failure};
use crate::cli::terminal::{Terminal, counted};
use crate::cli::{interrupt, load};
use crate::digest::Sha256Digest;
use crate::manifest::{Assumption, Experiment};
use crate::plan::Plan;
use crate::provenance::Environment;
use crate::studies::records_digest;
use serde_json::{Map, Value, json};
use std::path::Path;

/// Tries every assumption of a manifest that has a range, and writes the verdicts beside the manifest.
pub(in crate::cli) fn run(
    args: &VaryArgs,
    environment: &Environment,
    terminal: Terminal,
) -> Result<Exit, Failure> {
    interrupt::watch(terminal);
    jobs(args.jobs, terminal)?;
    if args.trials == Some(0) {
        return Err(Failure::not_understood("`--trials` must be at least 1, found 0"));
    }
    let execution = Execution::new(args.jobs, args.no_cache, environment)?;
    let study = Study { args, execution, terminal };
    let chosen = study.experiment(&[])?;
    study.check(&chosen)?;
    if let Some(draws) = args.joint {
        return study.draw(chosen, draws);
    }
    let assumptions: Vec<Assumption> =
        chosen.assumptions.iter().filter(|a| !a.range.is_empty()).cloned().collect();
    let trials = chosen.trials;
    let values: usize = assumptions.iter().map(|a| a.range.len()).sum();
    let (at_chosen, chosen_records) = study.verdicts(chosen)?;
    let mut found = Sensitivity::default();
    for assumption in &assumptions {
        for value in &assumption.range {
            let attempt = Attempt {
                setting: assumption.path.clone(),
                chosen: in_words(&assumption.value),
                tried: in_words(value),
                trials,
            };
            if terminal.is_watched() {
                let number = found.attempts().len() + 1;
                terminal
                    .note(&format!("{number}/{values}: {} at {}", attempt.setting, attempt.tried));
            }
            // JSON is YAML too.
            let moved = study.experiment(&[format!("{}={value}", assumption.path)])?;
            let (at_tried, records) = study.verdicts(moved)?;
            found.push(&attempt, (&at_chosen, chosen_records), (&at_tried, records));
            if args.format == DataFormat::Human {
                terminal.result(&line(&attempt, &found.flips(&attempt)));
            }
        }
    }
    let path = args.manifest.with_extension("sensitivity.csv");
    let is_named = study.write(&path, &found.to_csv(), "sensitivity")?;
    if args.format == DataFormat::Json {
        let attempts = found.attempts();
        let answer = json!({
            "manifest": args.manifest,
            "path": path,
            "named_in_manifest": is_named,
            "trials_per_condition": trials,
            "verdicts": verdicts_of(&at_chosen),
            "records_digest": format!("sha256:{chosen_records}"),
            "attempts": attempts.iter().map(|a| attempted(a, &found.flips(a))).collect::<Vec<_>>(),
        });
        terminal.result(&answer.to_string());
        return Ok(Exit::Yes);
    }
    let advice = advice(is_named, &path, "sensitivity");
    terminal.result(&format!(
        "wrote {}: {} judged at {} of {}, {} per condition{advice}\n",
        path.display(),
        counted(at_chosen.len(), "claim"),
        counted(values, "other value"),
        counted(assumptions.len(), "setting"),
        counted(trials as usize, "trial"),
    ));
    Ok(Exit::Yes)
}

/// A manifest that is run again and again with other values.
struct Study<'a> {
    args: &'a VaryArgs,
    execution: Execution,
    terminal: Terminal,
}

impl Study<'_> {
    /// Refuses a manifest in which nothing is left open, or nothing claimed.
    fn check(&self, chosen: &Experiment) -> Result<(), Failure> {
        let name = self.args.manifest.display();
        if chosen.assumptions.iter().all(|assumption| assumption.range.is_empty()) {
            return Err(Failure::not_understood(format!(
                "{name}: no assumption states a `range`; write other values that could as well have been chosen, as in \
                 `{{value: 0.05, why: ..., range: [0.02, 0.1]}}`"
            )));
        }
        if chosen.claims.is_empty() {
            return Err(Failure::not_understood(format!("{name}: there is no claim to judge")));
        }
        Ok(())
    }

    /// Reads the experiment with these values replaced.
    fn experiment(&self, set: &[String]) -> Result<Experiment, Failure> {
        let calibrator = self.execution.calibrator();
        let given = load::Given { set: &self.overrides(set), allow: &self.args.allow };
        load::manifest(&self.args.manifest, given, calibrator, self.terminal)
            .map(|loaded| loaded.experiment)
    }

    /// Adds what holds for every run. What an earlier call found is not read: it may not exist yet.
    fn overrides(&self, set: &[String]) -> Vec<String> {
        let mut set = set.to_vec();
        set.extend(["sensitivity=null", "multiverse=null"].map(str::to_owned));
        set.extend(self.args.trials.map(|n| format!("trials={n}")));
        set
    }

    /// Returns the verdicts on the claims of `experiment`, and the digest of the records that they follow from.
    fn verdicts(
        &self,
        experiment: Experiment,
    ) -> Result<(Vec<ClaimVerdict>, Sha256Digest), Failure> {
        let plan = Plan::of(experiment);
        let records = self.execution.execute(&plan, Times::Once, self.terminal)?;
        let verdicts = assemble::verdicts(&plan, &records).map_err(Failure::failed)?;
        Ok((verdicts, records_digest(&records)))
    }

    /// Writes what was found beside the manifest; returns whether the manifest names it, under `key`.
    fn write(&self, path: &Path, table: &str, key: &str) -> Result<bool, Failure> {
        let source = load::text(&self.args.manifest)?;
        let tree = crate::document::read(&source);
        let is_named = tree.is_ok_and(|tree| tree.root.get(key).is_some());
        load::write(path, table.as_bytes())?;
        Ok(is_named)
    }
}

/// Says what to do where the manifest does not name the table at `path` under `key`.
fn advice(is_named: bool, path: &Path, key: &str) -> String {
    if is_named {
        return String::new();
    }
    format!(
        "\nadd `{key}: {}` to the manifest, so that bundles and reports tell it",
        file_name(path)
    )
}

/// Returns each claim's verdict by the claim's id.
fn verdicts_of(verdicts: &[ClaimVerdict]) -> Map<String, Value> {
    verdicts.iter().map(|v| (v.id.clone(), v.judgement.to_string().into())).collect()
}

/// Writes one attempt for programs.
fn attempted(attempt: &Attempt, flips: &[Flip]) -> Value {
    let flip = |flip: &Flip| json!({"claim": flip.claim, "from": flip.from.to_string(), "to": flip.to.to_string()});
    json!({
        "setting": attempt.setting,
        "chosen": attempt.chosen,
        "tried": attempt.tried,
        "changes": flips.iter().map(flip).collect::<Vec<_>>(),
    })
}

/// Writes one attempt in a line, and one more for every verdict that it changes.
fn line(attempt: &Attempt, flips: &[Flip]) -> String {
    let what = format!("{} {} -> {}", attempt.setting, attempt.chosen, attempt.tried);
    if flips.is_empty() {
        return format!("{what}: no verdict changes\n");
    }
    let mut text = format!("{what}:\n");
    for flip in flips {
        text.push_str(&format!("  {}: {} -> {}\n", flip.claim, flip.from, flip.to));
    }
    text
}

fn file_name(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}
