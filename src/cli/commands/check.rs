//! `reenact check`: parse and resolve everything, simulate nothing.

use crate::cli::args::CheckArgs;
use crate::cli::calibrate::Calibrator;
use crate::cli::exit::{Exit, Failure};
use crate::cli::load;
use crate::cli::terminal::{Terminal, counted};
use crate::plan::{Plan, Selection};

/// Checks every manifest and lists all faults of all of them.
pub(in crate::cli) fn run(args: &CheckArgs, terminal: Terminal) -> Result<Exit, Failure> {
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
