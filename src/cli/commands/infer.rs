//! `reenact infer`: everything that `run` does with a manifest that has an `infer:`, and nothing with any other.

use super::run;
use crate::cli::args::{InferArgs, RunArgs};
use crate::cli::exit::{Exit, Failure};
use crate::cli::load;
use crate::cli::terminal::Terminal;
use crate::document;
use crate::provenance::Environment;

/// Makes every proposal of a manifest and seals what follows from them.
pub(in crate::cli) fn run(
    args: &InferArgs,
    environment: &Environment,
    terminal: Terminal,
) -> Result<Exit, Failure> {
    let source = load::text(&args.manifest)?;
    let infers = document::read(&source).is_ok_and(|tree| tree.root.get("infer").is_some());
    if !infers {
        return Err(Failure::not_understood(format!(
            "{}: there is nothing to infer; add `infer:` with the table that is to be explained and what is not known (docs/inference.md)",
            args.manifest.display()
        )));
    }
    run::run(&RunArgs::from(args), environment, terminal)
}
