//! `reenact diff`: what changed between two bundles or locks.

use super::locked;
use crate::cli::args::{DiffArgs, DiffFormat};
use crate::cli::exit::{Exit, Failure};
use crate::cli::load;
use crate::cli::terminal::Terminal;
use crate::compare::{Account, Extent, Tolerances, compare};
use crate::{json, report};
use std::path::Path;

/// Compares two sides.
pub(in crate::cli) fn run(args: &DiffArgs, terminal: Terminal) -> Result<Exit, Failure> {
    let tolerances = Tolerances::parse(&args.tolerance).map_err(Failure::not_understood)?;
    let (a, b) = (side(&args.a, terminal)?, side(&args.b, terminal)?);
    let comparison =
        compare(&a, &b, Extent::Whole, &tolerances).map_err(Failure::not_understood)?;
    let (a, b) = (args.a.display().to_string(), args.b.display().to_string());
    let text = match args.format {
        DiffFormat::Human => comparison.to_human([&a, &b]),
        DiffFormat::Json => json::canonical(&comparison.to_json()) + "\n",
        DiffFormat::Html => report::difference_page(&comparison, [&a, &b]),
    };
    match &args.output {
        Some(path) => {
            load::write(path, text.as_bytes())?;
            terminal.result(&path.display().to_string());
        }
        None => terminal.result(&text),
    }
    Ok(if comparison.is_same() { Exit::Yes } else { Exit::No })
}

/// What one side says: a lock by its name, a bundle otherwise. One that cannot be read leaves the question open, which is
/// no answer of ours: 2, not 1.
fn side(path: &Path, terminal: Terminal) -> Result<Account, Failure> {
    if path.extension().is_some_and(|extension| extension == "lock") {
        return Ok(locked::read(&load::text(path)?, terminal)?.account().clone());
    }
    let bundle = load::bundle(path).map_err(|failure| match failure.exit {
        Exit::No => Failure::not_understood(failure.message),
        _ => failure,
    })?;
    Account::of_bundle(&bundle).map_err(|faults| {
        let first = faults.first().map(ToString::to_string).unwrap_or_default();
        Failure::not_understood(format!("{}: {first}", path.display()))
    })
}
