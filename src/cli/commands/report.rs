//! `reenact report`: one page of a bundle.

use crate::cli::args::{DataFormat, ReportArgs};
use crate::cli::exit::{Exit, Failure};
use crate::cli::terminal::Terminal;
use crate::cli::{checked, load};
use crate::report;
use crate::verify::plan_of;
use serde_json::json;
use std::path::PathBuf;

/// Writes the page.
pub(in crate::cli) fn run(args: &ReportArgs, terminal: Terminal) -> Result<Exit, Failure> {
    let checked::Checked { bundle, words, banner } =
        checked::bundle(&args.bundle, args.unchecked, args.limits)?;
    let (plan, selection) = plan_of(&bundle).map_err(Failure::not_understood)?;
    let mut content = report::content_of(&bundle, &plan, &selection)
        .map_err(|error| Failure { exit: Exit::No, message: error.to_string() })?;
    content.checked.clone_from(&words);
    let output = args.output.clone().unwrap_or_else(|| {
        let stem = format!("{}-{}", bundle.name(), bundle.results_digest().short());
        PathBuf::from(stem).with_extension("html")
    });
    let mut page = report::page(&content);
    if let Some(banner) = &banner {
        page = report::page_under_banner(&page, banner);
    }
    load::write(&output, page.as_bytes())?;
    terminal.result(&match args.format {
        DataFormat::Human => format!("{words}\n{}", output.display()),
        DataFormat::Json => json!({
            "path": output,
            "results_digest": format!("sha256:{}", bundle.results_digest()),
            "checked": words,
        })
        .to_string(),
    });
    Ok(Exit::Yes)
}
