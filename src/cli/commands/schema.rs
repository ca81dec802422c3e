//! `reenact schema`: what editors complete and check by.

use crate::cli::args::{SchemaArgs, SchemaOf};
use crate::cli::exit::Exit;
use crate::cli::terminal::Terminal;
use crate::{document, manifest, world};

/// Prints a JSON Schema.
pub(in crate::cli) fn run(args: &SchemaArgs, terminal: Terminal) -> Exit {
    let schema = match args.of {
        SchemaOf::Manifest => manifest::schema(None),
        SchemaOf::World => document::schema_of::<world::document::WorldDoc>(),
    };
    terminal.result(&format!("{schema:#}"));
    Exit::Yes
}
