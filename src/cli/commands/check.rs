//! `reenact check`: parse and resolve everything, simulate nothing.

use crate::cli::args::CheckArgs;
use crate::cli::calibrate::Calibrator;
use crate::cli::exit::{Exit, Failure};
use crate::cli::load;
use crate::cli::terminal::{Terminal, counted};
use crate::plan::Plan;

/// Checks every manifest and lists all faults of all of them.
pub(in crate::cli) fn run(args: &CheckArgs, terminal: Terminal) -> Result<Exit, Failure> {
    let mut failures = Vec::new();
    for manifest in &args.manifests {
        match load::manifest(manifest, &args.set, Calibrator::StandIn, terminal) {
            Ok(loaded) => {
                let conditions = loaded.experiment.conditions.len();
                let inputs = loaded.experiment.inputs.len();
                let plan = Plan::of(loaded.experiment);
                terminal.result(&format!(
                    "{}: {} of {} in {}, {}",
                    manifest.display(),
                    counted(plan.trials.len(), "trial"),
                    plan.experiment.name,
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
