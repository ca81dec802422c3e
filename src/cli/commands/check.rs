//! `reenact check`: parse and resolve everything, simulate nothing.

use crate::cli::args::{CheckArgs, DataFormat};
use crate::cli::calibrate::Calibrator;
use crate::cli::exit::{Exit, Failure};
use crate::cli::load;
use crate::cli::terminal::{Terminal, counted};
use crate::document::{Diagnostic, Severity};
use crate::plan::{Plan, Selection};
use serde_json::{Value, json};
use std::path::Path;

/// Checks every manifest and lists all faults of all of them.
pub(in crate::cli) fn run(args: &CheckArgs, terminal: Terminal) -> Result<Exit, Failure> {
    if args.format == DataFormat::Json {
        return Ok(answered(args, terminal));
    }
    let mut failures = Vec::new();
    for manifest in &args.manifests {
        match load::manifest(manifest, args.given(), Calibrator::StandIn, terminal) {
            Ok(loaded) => {
                let experiment = &loaded.experiment;
                let (conditions, inputs) = (experiment.conditions.len(), experiment.inputs.len());
                // Counted, not planned: nobody asks for the keys.
                let trials = Plan::size(experiment, &Selection::default());
                let trials = usize::try_from(trials).unwrap_or(usize::MAX);
                terminal.result(&format!(
                    "{}: {} of {} in {}, {}",
                    manifest.display(),
                    counted(trials, "trial"),
                    experiment.name,
                    counted(conditions, "condition"),
                    counted(inputs, "input file"),
                ));
            }
            Err(failure) => failures.push(failure),
        }
    }
    let worst = failures.iter().map(|f| f.exit.code()).max();
    match worst {
        None => Ok(Exit::Yes),
        Some(_) if failures.len() == 1 => Err(failures.remove(0)),
        Some(code) => {
            for failure in &failures {
                terminal.failure(&failure.message);
            }
            Ok(if code == 3 { Exit::Failed } else { Exit::NotUnderstood })
        }
    }
}

/// Answers a line of JSON for each manifest, in which all its faults and warnings stand.
fn answered(args: &CheckArgs, terminal: Terminal) -> Exit {
    let mut exit = Exit::Yes;
    for manifest in &args.manifests {
        let (answer, one) = line(manifest, args, terminal);
        terminal.result(&answer.to_string());
        if one.code() > exit.code() {
            exit = one;
        }
    }
    exit
}

fn line(manifest: &Path, args: &CheckArgs, terminal: Terminal) -> (Value, Exit) {
    let path = manifest.display().to_string();
    let refused = |faults: &[Diagnostic], exit| {
        let faults: Vec<Value> = faults.iter().map(fault).collect();
        (json!({"manifest": path, "ok": false, "faults": faults}), exit)
    };
    match load::resolved(manifest, args.given(), Calibrator::StandIn, terminal) {
        Ok(Ok((loaded, warnings))) => {
            let experiment = &loaded.experiment;
            let answer = json!({
                "manifest": path,
                "ok": true,
                "faults": warnings.iter().map(fault).collect::<Vec<_>>(),
                "name": experiment.name,
                "trials": Plan::size(experiment, &Selection::default()),
                "conditions": experiment.conditions.len(),
                "inputs": experiment.inputs.len(),
            });
            (answer, Exit::Yes)
        }
        Ok(Err(faults)) => refused(&faults, Exit::NotUnderstood),
        Err(Failure { exit, message }) => refused(&[Diagnostic::placeless(message)], exit),
    }
}

fn fault(diagnostic: &Diagnostic) -> Value {
    let Diagnostic { severity, message, place, label, help, count } = diagnostic;
    let at = place.as_ref().map(|(source, span)| (source, source.line_and_column(span.start)));
    json!({
        "severity": match severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
        },
        "message": message,
        "label": label,
        "help": help,
        "file": at.map(|(source, _)| &*source.name),
        "line": at.map(|(_, (line, _))| line),
        "column": at.map(|(_, (_, column))| column),
        "count": count,
    })
}
