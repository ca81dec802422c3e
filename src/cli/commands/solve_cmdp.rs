//! `reenact solve-cmdp`: the planner, open to inspection.

use crate::cli::args::SolveCmdpArgs;
use crate::cli::exit::{Exit, Failure};
use crate::cli::load;
use crate::cli::terminal::Terminal;
use crate::cmdp::{DocumentError, solve_document};

/// Solves one problem; `infeasible` is an answer like any other.
pub(in crate::cli) fn run(args: &SolveCmdpArgs, terminal: Terminal) -> Result<Exit, Failure> {
    let source = load::text(&args.file)?;
    match solve_document(&source.text) {
        Ok(line) => {
            terminal.result(&line);
            Ok(Exit::Yes)
        }
        Err(error @ DocumentError::Unsolved(_)) => {
            Err(Failure::failed(format!("{}: {error}", source.name)))
        }
        Err(error) => Err(Failure::not_understood(format!("{}: {error}", source.name))),
    }
}
