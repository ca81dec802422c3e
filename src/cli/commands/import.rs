//! `reenact import`: a Gazebo world or a map as world YAML, to be read and edited.

use super::show::shelf;
use crate::cli::args::{DataFormat, ImportArgs, UnknownArg};
use crate::cli::exit::{Exit, Failure};
use crate::cli::load;
use crate::cli::terminal::{Terminal, counted};
use crate::document::{Diagnostic, Source};
use crate::report::show;
use crate::world::World;
use crate::world::document::{self, WorldDoc};
use crate::world::map_server::solid::{self, UnknownCells};
use crate::world::map_server::{self, Descriptor, Options};
use serde_json::json;
use std::path::{Path, PathBuf};

/// Writes the world.
pub(in crate::cli) fn run(args: &ImportArgs, terminal: Terminal) -> Result<Exit, Failure> {
    let file = &args.file;
    let output = args.output.clone().unwrap_or_else(|| {
        let stem = file.file_stem().unwrap_or_default().to_string_lossy();
        PathBuf::from(format!("{stem}.world.yaml"))
    });
    if output.exists() && !args.force {
        return Err(Failure::not_understood(format!(
            "`{}` exists already; name another file with `-o`, or write over it with `--force`",
            output.display()
        )));
    }
    let world = read(args, terminal)?;
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let source = format!("imported from {name} by reenact import, cut at {} m", args.height);
    let doc = WorldDoc::of(&world, source, args.height);
    let text = doc.to_yaml();
    load::write(&output, text.as_bytes())?;
    if args.format == DataFormat::Json {
        let written = Source::new(output.display().to_string(), text);
        let meaning = document::read(&written, None).map(|written| written.meaning());
        let meaning = meaning.map_err(|faults| Failure::failed(Terminal::count(&faults)))?;
        let answer = json!({
            "path": output,
            "world": world.name,
            "solids": world.solids.len(),
            "meaning": format!("sha256:{meaning}"),
        });
        terminal.result(&answer.to_string());
        return Ok(Exit::Yes);
    }
    terminal.result(&show::describe_world(&world, args.height));
    terminal.note(&format!(
        "wrote {} of {}",
        output.display(),
        counted(world.solids.len(), "solid")
    ));
    Ok(Exit::Yes)
}

fn read(args: &ImportArgs, terminal: Terminal) -> Result<World, Failure> {
    let (bytes, name) = (load::bytes(&args.file)?, args.file.display().to_string());
    let told = |faults: Vec<Diagnostic>| {
        terminal.diagnostics(&faults);
        Failure::not_understood(format!("{name}: {}", Terminal::count(&faults)))
    };
    let beside = args.file.parent().unwrap_or(Path::new("")).to_owned();
    let stem = args.file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    if let Ok(text) = std::str::from_utf8(&bytes)
        && map_server::is_descriptor(text)
    {
        let descriptor = Descriptor::read(&Source::new(name.as_str(), text)).map_err(told)?;
        terminal.diagnostics(descriptor.warnings());
        let image = load::bytes(&beside.join(descriptor.image()))?;
        let map = descriptor.map(descriptor.image(), &image, Options::default()).map_err(told)?;
        terminal.diagnostics(descriptor.doubt(&map).as_slice());
        let unknown = match args.unknown {
            UnknownArg::Occupied => UnknownCells::Occupied,
            UnknownArg::Free => UnknownCells::Free,
        };
        return Ok(solid::world(&stem, &map, unknown));
    }
    let mut models = shelf(&args.models, &args.model_path, &args.allow, beside)?;
    let mut world = show::read_world(&name, &bytes, None, &mut models).map_err(told)?;
    for warning in std::mem::take(&mut world.warnings) {
        terminal.warning(&warning);
    }
    Ok(world)
}
