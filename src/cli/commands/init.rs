//! `reenact init`: a working starter study in a folder of its own.

use crate::cli::args::InitArgs;
use crate::cli::exit::{Exit, Failure};
use crate::cli::load;
use crate::cli::terminal::Terminal;
use std::path::PathBuf;

const MANIFEST: &str = include_str!("init/study.yaml");
const WORLD: &str = include_str!("../../../worlds/basic.yaml");
const ROBOT: &str = include_str!("../../../robots/kobuki.urdf");

/// Writes the starter study `NAME/NAME.yaml` with its robot and world.
pub(in crate::cli) fn run(args: &InitArgs, terminal: Terminal) -> Result<Exit, Failure> {
    let name = &args.name;
    let plain = |b: u8| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'-';
    if !name.starts_with(|c: char| c.is_ascii_lowercase()) || !name.bytes().all(plain) {
        return Err(Failure::not_understood(format!(
            "`{name}` is no name for a study: use lower-case letters, digits and hyphens, a letter first"
        )));
    }
    let folder = PathBuf::from(name);
    if folder.exists() {
        return Err(Failure::not_understood(format!(
            "`{name}` exists already; choose another name"
        )));
    }
    let manifest = folder.join(format!("{name}.yaml"));
    load::write(&manifest, MANIFEST.replace("STUDY-NAME", name).as_bytes())?;
    load::write(&folder.join("apartment.yaml"), WORLD.as_bytes())?;
    load::write(&folder.join("kobuki.urdf"), ROBOT.as_bytes())?;
    terminal.result(&format!("reenact run {}", manifest.display()));
    Ok(Exit::Yes)
}
