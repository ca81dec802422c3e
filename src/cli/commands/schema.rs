//! `reenact schema`: what editors complete and check by, and what scripts read answers by.

use crate::cli::args::{SchemaArgs, SchemaOf};
use crate::cli::exit::Exit;
use crate::cli::terminal::Terminal;
use crate::{document, manifest, world};

/// Returns the JSON Schema of an answer, which is committed beside the program: programs of others are written against it.
macro_rules! answer {
    ($name:literal) => {
        include_str!(concat!("../../../schemas/answers/", $name, ".schema.json"))
    };
}

/// Prints a JSON Schema.
pub(in crate::cli) fn run(args: &SchemaArgs, terminal: Terminal) -> Exit {
    let text = match args.of {
        SchemaOf::Manifest => &format!("{:#}", manifest::schema(None)),
        SchemaOf::World => &format!("{:#}", document::schema_of::<world::document::WorldDoc>()),
        SchemaOf::Run => answer!("run"),
        SchemaOf::RunNoSeal => answer!("run-no-seal"),
        SchemaOf::RunProbe => answer!("run-probe"),
        SchemaOf::Check => answer!("check"),
        SchemaOf::Plan => answer!("plan"),
        SchemaOf::PlanPower => answer!("plan-power"),
        SchemaOf::Verify => answer!("verify"),
        SchemaOf::Diff => answer!("diff"),
        SchemaOf::Lock => answer!("lock"),
        SchemaOf::Report => answer!("report"),
        SchemaOf::Export => answer!("export"),
        SchemaOf::Submit => answer!("submit"),
        SchemaOf::Vary => answer!("vary"),
        SchemaOf::VaryJoint => answer!("vary-joint"),
        SchemaOf::Replay => answer!("replay"),
        SchemaOf::Show => answer!("show"),
        SchemaOf::Import => answer!("import"),
        SchemaOf::Init => answer!("init"),
        SchemaOf::CacheSize => answer!("cache-size"),
        SchemaOf::CacheVerify => answer!("cache-verify"),
    };
    terminal.result(text);
    Exit::Yes
}
