//! `reenact show`: draw an input and say what was understood.

use crate::cli::args::ShowArgs;
use crate::cli::exit::{Exit, Failure};
use crate::cli::load;
use crate::cli::terminal::Terminal;
use crate::report::show;
use std::path::{Path, PathBuf};

/// Draws one file.
pub(in crate::cli) fn run(args: &ShowArgs, terminal: Terminal) -> Result<Exit, Failure> {
    let bytes = load::bytes(&args.file)?;
    let folder = args.file.parent().unwrap_or(Path::new(""));
    let name = args.file.display().to_string();
    let mut fetch = |path: &str| load::bytes(&folder.join(path)).map_err(|f| f.message);
    let height = args.height.unwrap_or(show::CUT_HEIGHT);
    let drawing = show::draw(&name, &bytes, height, &mut fetch).map_err(|faults| {
        terminal.diagnostics(&faults);
        Failure::not_understood(format!("{name}: {}", Terminal::count(&faults)))
    })?;
    terminal.diagnostics(&drawing.warnings);
    let output = args.output.clone().unwrap_or_else(|| {
        let stem = args.file.file_stem().unwrap_or_default();
        PathBuf::from(stem).with_extension("svg")
    });
    let is_png = output.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
    match (is_png, &drawing.png) {
        (true, Some(png)) => load::write(&output, png)?,
        (true, None) => {
            return Err(Failure::not_understood(
                "only maps are drawn as PNG: name an .svg file for robots and worlds",
            ));
        }
        (false, _) => load::write(&output, drawing.svg.as_bytes())?,
    }
    terminal.result(&drawing.text);
    terminal.note(&format!("wrote {}", output.display()));
    Ok(Exit::Yes)
}
