//! `reenact completions`: for bash, zsh, fish, elvish and PowerShell.

use crate::cli::args::{self, CompletionsArgs};
use crate::cli::exit::Exit;
use crate::cli::terminal::Terminal;

/// Prints completions.
pub(in crate::cli) fn run(args: &CompletionsArgs, terminal: Terminal) -> Exit {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut args::command(), "reenact", &mut script);
    terminal.result(&String::from_utf8_lossy(&script));
    Exit::Yes
}
