//! The `reenact` command: see `reenact --help`, or the library's documentation for how it is made.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(reenact::cli::run(std::env::args_os()).code())
}
