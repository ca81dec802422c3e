//! `reenact diff`: what changed between two bundles or locks.

use super::locked;
use crate::cli::args::{DiffArgs, DiffFormat};
use crate::cli::exit::{Exit, Failure};
use crate::cli::terminal::Terminal;
use crate::cli::{checked, load};
use crate::compare::{Account, Extent, Tolerances, compare};
use crate::{json, report};
use std::path::Path;

/// Compares two sides.
pub(in crate::cli) fn run(args: &DiffArgs, terminal: Terminal) -> Result<Exit, Failure> {
    let tolerances = Tolerances::parse(&args.tolerance).map_err(Failure::not_understood)?;
    let (a, b) = sides(args, terminal)?;
    let sides = [&a, &b];
    let words: Vec<&str> = sides.iter().filter_map(|side| side.words.as_deref()).collect();
    let banners: Vec<&str> = sides.iter().filter_map(|side| side.banner.as_deref()).collect();
    let (words, banner) = (words.join("\n"), banners.join("; "));
    let comparison = compare(&a.account, &b.account, Extent::Whole, &tolerances)
        .map_err(Failure::not_understood)?;
    let (a, b) = (args.a.display().to_string(), args.b.display().to_string());
    let text = match args.format {
        DiffFormat::Human => comparison.to_human([&a, &b]),
        DiffFormat::Json => json::canonical(&comparison.to_json()) + "\n",
        DiffFormat::Html => {
            let page = report::difference_page(&comparison, [&a, &b]);
            if banner.is_empty() { page } else { report::page_under_banner(&page, &banner) }
        }
    };
    // Where stdout is for programs, what was found of the bundles is for people.
    if args.output.is_none() && args.format != DiffFormat::Human {
        terminal.note(&words);
    } else if !words.is_empty() {
        terminal.result(&words);
    }
    match &args.output {
        Some(path) => {
            load::write(path, text.as_bytes())?;
            terminal.result(&path.display().to_string());
        }
        None => terminal.result(&text),
    }
    Ok(if comparison.is_same() { Exit::Yes } else { Exit::No })
}

/// One side.
struct Side {
    account: Account,
    /// What checking it found; nothing for a lock.
    words: Option<String>,
    banner: Option<String>,
}

/// What one side is, before anything is told of it.
enum Opened {
    Lock(Box<Account>),
    Bundle(Box<checked::Checked>),
}

/// Reads what both sides say: a lock by its name, a bundle otherwise.
fn sides(args: &DiffArgs, terminal: Terminal) -> Result<(Side, Side), Failure> {
    let paths = [&args.a, &args.b];
    let (a, b) = (opened(&args.a, args, terminal)?, opened(&args.b, args, terminal)?);
    let accounts = match (&a, &b) {
        (Opened::Bundle(a), Opened::Bundle(b)) => Account::of_bundles(&a.bundle, &b.bundle),
        _ => [&a, &b].map(|side| match side {
            Opened::Lock(account) => Ok(Account::clone(account)),
            Opened::Bundle(checked) => Account::of_bundle(&checked.bundle),
        }),
    };
    let mut sides = Vec::new();
    for ((account, opened), path) in accounts.into_iter().zip([a, b]).zip(paths) {
        let named = |text: String| format!("{}: {text}", path.display());
        let account = account.map_err(|faults| {
            let first = faults.first().map(ToString::to_string).unwrap_or_default();
            Failure::not_understood(named(first))
        })?;
        let (words, banner) = match opened {
            Opened::Lock(_) => (None, None),
            Opened::Bundle(checked) => (Some(named(checked.words)), checked.banner.map(named)),
        };
        sides.push(Side { account, words, banner });
    }
    let b = sides.pop().expect("there are two");
    Ok((sides.pop().expect("there are two"), b))
}

fn opened(path: &Path, args: &DiffArgs, terminal: Terminal) -> Result<Opened, Failure> {
    if path.extension().is_some_and(|extension| extension == "lock") {
        let account = locked::read(&load::text(path)?, terminal)?.account().clone();
        return Ok(Opened::Lock(Box::new(account)));
    }
    let checked = checked::bundle(path, args.unchecked, args.limits).map_err(|refused| {
        // One that cannot be read leaves the question open, which is no answer of ours: 2, not 1.
        if refused.failure.exit == Exit::No && !refused.is_read {
            Failure::not_understood(refused.failure.message)
        } else {
            refused.into()
        }
    })?;
    Ok(Opened::Bundle(Box::new(checked)))
}
