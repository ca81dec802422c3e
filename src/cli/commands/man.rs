//! `reenact man`: one page for the program and one for each of its commands.

use crate::cli::args::{self, ManArgs};
use crate::cli::exit::{Exit, Failure};
use crate::cli::load;
use crate::cli::terminal::{Terminal, counted};
use clap_mangen::Man;

/// Writes the pages.
pub(in crate::cli) fn run(args: &ManArgs, terminal: Terminal) -> Result<Exit, Failure> {
    let mut program = args::command();
    program.build();
    let mut pages = vec![("reenact".to_owned(), program.clone())];
    collect(&program, "reenact", &mut pages);
    for (name, command) in &pages {
        let mut page = Vec::new();
        // It is named by the whole way to it, as one looks it up: `man reenact-cache-size`.
        Man::new(command.clone())
            .render(&mut page)
            .map_err(|error| Failure::failed(format!("cannot write `{name}.1`: {error}")))?;
        load::write(&args.folder.join(format!("{name}.1")), &page)?;
    }
    terminal.result(&format!("{} in {}", counted(pages.len(), "page"), args.folder.display()));
    Ok(Exit::Yes)
}

fn collect(command: &clap::Command, name: &str, pages: &mut Vec<(String, clap::Command)>) {
    for below in command.get_subcommands().filter(|below| below.get_name() != "help") {
        let name = format!("{name}-{}", below.get_name());
        pages.push((name.clone(), below.clone()));
        collect(below, &name, pages);
    }
}
