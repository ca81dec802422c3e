//! The command line: words in, exit code out. The shell around the library; nothing imports it.
//!
//! Results go to stdout, progress and diagnostics to stderr.

mod args;
mod calibrate;
mod checked;
mod commands;
mod estimate;
mod exit;
mod fold;
mod forecast;
mod interrupt;
mod junit;
mod load;
mod opened;
mod progress;
mod shard;
mod terminal;

pub use args::command;
pub use exit::Exit;
pub use opened::{Opened, Unopened, open};

use crate::provenance::{self, Environment};
use args::{Arguments, Command};
use exit::Failure;
use std::ffi::OsString;
use std::panic::catch_unwind;
use std::path::PathBuf;
use terminal::Terminal;

/// Does what [`run`] does in the process of an interpreter, where `program` is the script that starts it: what is submitted
/// to other machines starts that.
pub fn run_as(program: PathBuf, words: impl IntoIterator<Item = OsString>) -> Exit {
    provenance::started_by(program);
    run(words)
}

/// Runs the command that `words` (the first being the program's name) ask for.
pub fn run(words: impl IntoIterator<Item = OsString>) -> Exit {
    let arguments = match Arguments::read(words) {
        Ok(arguments) => arguments,
        Err(error) => {
            // clap sends help and version to stdout and mistakes to stderr.
            let _ = error.print();
            return if error.use_stderr() { Exit::NotUnderstood } else { Exit::Yes };
        }
    };
    let environment = match Environment::read() {
        Ok(environment) => environment,
        Err(error) => {
            Terminal::plain().error(&error.to_string());
            return Exit::NotUnderstood;
        }
    };
    let terminal = Terminal::new(&environment);
    silence_panicking_trials();
    match catch_unwind(|| dispatch(arguments.command, &environment, terminal)) {
        Ok(Ok(_)) if Terminal::has_lost_results() => Exit::Failed,
        Ok(Ok(exit)) => exit,
        Ok(Err(Failure { exit, message })) => {
            terminal.failure(&message);
            exit
        }
        Err(_) => {
            terminal.error("this is a bug in reenact: please report it with the lines above");
            Exit::Failed
        }
    }
}

/// Silences the usual report of a panic in a trial, which becomes a record with its cause and is reported with the
/// results: the usual report would say it twice, in the middle of the progress bar.
fn silence_panicking_trials() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        let is_trial = std::thread::current().name().is_some_and(|n| n.starts_with("trial-"));
        if !is_trial {
            usual(panic);
        }
    }));
}

fn dispatch(
    mut command: Command,
    environment: &Environment,
    terminal: Terminal,
) -> Result<Exit, Failure> {
    if let Some(select) = command.select() {
        shard::place(select, environment)?;
    }
    match command {
        Command::Run(args) => commands::run::run(&args, environment, terminal),
        Command::Merge(args) => commands::merge::run(&args, environment, terminal),
        Command::Submit(args) => commands::submit::run(&args, environment, terminal),
        Command::Check(args) => commands::check::run(&args, terminal),
        Command::Plan(args) => commands::plan::run(&args, environment, terminal),
        Command::Verify(args) => commands::verify::run(&args, environment, terminal),
        Command::Attest(args) => commands::attest::run(&args, terminal),
        Command::Diff(args) => commands::diff::run(&args, terminal),
        Command::Lock(args) => commands::lock::run(&args, environment, terminal),
        Command::Vary(args) => commands::vary::run(&args, environment, terminal),
        Command::Infer(args) => commands::infer::run(&args, environment, terminal),
        Command::Report(args) => commands::report::run(&args, terminal),
        Command::Export(args) => commands::export::run(&args, terminal),
        Command::Replay(args) => commands::replay::run(&args, terminal),
        Command::Show(args) => commands::show::run(&args, terminal),
        Command::SolveCmdp(args) => commands::solve_cmdp::run(&args, terminal),
        Command::Schema(args) => Ok(commands::schema::run(&args, terminal)),
        Command::Man(args) => commands::man::run(&args, terminal),
        Command::Completions(args) => Ok(commands::completions::run(&args, terminal)),
        Command::Import(args) => commands::import::run(&args, terminal),
        Command::Init(args) => commands::init::run(&args, terminal),
        Command::Cache(args) => commands::cache::run(&args, environment, terminal),
    }
}
