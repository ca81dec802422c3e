//! `reenact init`: a working starter study in a folder of its own, or one of somebody's own robot and world.

mod from_files;

use crate::cli::args::{DataFormat, InitArgs};
use crate::cli::calibrate::Calibrator;
use crate::cli::exit::{Exit, Failure};
use crate::cli::load;
use crate::cli::terminal::Terminal;
use crate::geometry::Pose;
use crate::json;
use crate::store;
use crate::units::Radians;
use from_files::Files;
use serde_json::json;
use std::path::{Path, PathBuf};

const MANIFEST: &str = include_str!("init/study.yaml");
const WORLD: &str = include_str!("../../../worlds/basic.yaml");
const ROBOT: &str = include_str!("../../../robots/kobuki.urdf");
const WORLD_NAME: &str = "apartment.yaml";
/// The schema by which editors complete and check the manifest, beside it: nothing has to be fetched.
const SCHEMA_NAME: &str = "manifest.schema.json";
const ROBOT_NAME: &str = "kobuki.urdf";

/// Where no world reaches (m): a start that is in nobody's way while the world is read.
const NOWHERE: f64 = 9e5;

/// Writes the study `NAME/NAME.yaml`, with the starter's robot and world where none are named.
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
    let schema = format!("{:#}\n", crate::manifest::schema(None));
    let mut written = vec![manifest.clone()];
    for (file, bytes, is_wanted) in [
        (ROBOT_NAME, ROBOT, args.robot.is_none()),
        (WORLD_NAME, WORLD, args.world.is_none()),
        (SCHEMA_NAME, &schema, true),
    ] {
        if is_wanted {
            let path = folder.join(file);
            load::write(&path, bytes.as_bytes())?;
            written.push(path);
        }
    }
    if args.robot.is_none() && args.world.is_none() && args.map.is_none() {
        load::write(&manifest, MANIFEST.replace("STUDY-NAME", name).as_bytes())?;
    } else {
        let text = of_files(args, &manifest, terminal).inspect_err(|_| {
            // Begun by this command and no study: in the way of the next attempt.
            store::discard(&folder);
        })?;
        load::write(&manifest, text.as_bytes())?;
        // Whatever is wrong is told now, with the file there to be mended.
        load::manifest(&manifest, given(args), Calibrator::StandIn, terminal)?;
    }
    terminal.result(&match args.format {
        DataFormat::Human => format!("reenact run {}", manifest.display()),
        DataFormat::Json => json!({"manifest": manifest, "written": written}).to_string(),
    });
    Ok(Exit::Yes)
}

/// Returns what is allowed to the files that `args` name.
fn given(args: &InitArgs) -> load::Given<'_> {
    load::Given { set: &[], allow: &args.allow }
}

/// Writes the manifest of the files that `args` name.
fn of_files(args: &InitArgs, manifest: &Path, terminal: Terminal) -> Result<String, Failure> {
    let robot_file = args.robot.as_deref().map_or_else(|| ROBOT_NAME.to_owned(), from_folder);
    let world_file = args.world.as_deref().map_or_else(|| WORLD_NAME.to_owned(), from_folder);
    let robot_entry = entry(&robot_file, &[("packages", folders(&args.packages, "--packages")?)]);
    let model_path: Vec<String> =
        args.model_path.iter().map(|folder| scalar(&from_folder(folder))).collect();
    let model_path = (!model_path.is_empty()).then(|| format!("[{}]", model_path.join(", ")));
    let models = folders(&args.models, "--models")?;
    let world_entry = format!(
        "{{{}}}",
        [
            Some(format!("file: {}", scalar(&world_file))),
            models.map(|models| format!("models: {models}")),
            model_path.map(|path| format!("model-path: {path}")),
        ]
        .into_iter()
        .flatten()
        .collect::<Vec<_>>()
        .join(", ")
    );
    // Robot and world are read as the manifest will have them read.
    let draft = format!(
        "reenact: 1\nname: {}\ntitle: draft\nstudy: wander\nseed: 1\ntrials: 1\nrobot: {robot_entry}\nworld: {world_entry}\n\
         start: {{x-m: {NOWHERE}, y-m: {NOWHERE}}}\n",
        args.name
    );
    // Its folder has to be there for paths that lead out of it.
    load::write(manifest, draft.as_bytes())?;
    let read = load::draft(manifest, draft, given(args), terminal)?;
    let Some(condition) = read.conditions.first() else {
        return Err(Failure::failed("a manifest without factors has one condition"));
    };
    let (robot, world) = (condition.setup.robot(), condition.setup.world());
    let start = match &args.start {
        Some(numbers) => started_at(numbers)?,
        None => from_files::start(robot, world).ok_or_else(|| {
            Failure::not_understood(
                "there is no place in this world where the robot fits; `reenact show` draws both, `--start X,Y` chooses one",
            )
        })?,
    };
    let files = Files {
        name: &args.name,
        robot_entry,
        robot_file,
        robot,
        world_entry,
        world_file,
        world,
        map_file: args.map.as_deref().map(|map| scalar(&from_folder(map))),
        start,
    };
    Ok(files.manifest())
}

/// Returns the path of `file` from the folder of the study, one below this one.
fn from_folder(file: &Path) -> String {
    let path = if file.is_absolute() { file.to_owned() } else { Path::new("..").join(file) };
    // Manifests separate folders in one way on every system.
    path.display().to_string().replace('\\', "/")
}

/// Returns the value of a key that is a `file` alone, or a mapping with what more there is.
fn entry(file: &str, more: &[(&str, Option<String>)]) -> String {
    let more: Vec<String> = more
        .iter()
        .filter_map(|(key, value)| Some(format!("{key}: {}", value.as_ref()?)))
        .collect();
    if more.is_empty() {
        scalar(file)
    } else {
        format!("{{file: {}, {}}}", scalar(file), more.join(", "))
    }
}

/// Returns the mapping of all `NAME=FOLDER` of an `option`; none where there are none.
fn folders(written: &[String], option: &str) -> Result<Option<String>, Failure> {
    let mut entries = Vec::new();
    for written in written {
        let Some((name, folder)) = written.split_once('=') else {
            return Err(Failure::not_understood(format!(
                "{option}: expected NAME=FOLDER, found `{written}`"
            )));
        };
        entries.push(format!("{}: {}", scalar(name), scalar(&from_folder(Path::new(folder)))));
    }
    Ok((!entries.is_empty()).then(|| format!("{{{}}}", entries.join(", "))))
}

/// Writes a text as YAML reads it anywhere.
fn scalar(text: &str) -> String {
    let is_plain = text.bytes().all(|b| b.is_ascii_alphanumeric() || b"._/-".contains(&b))
        && text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '.' || c == '/');
    if is_plain { text.to_owned() } else { json::canonical(&text.into()) }
}

fn started_at(numbers: &[f64]) -> Result<Pose, Failure> {
    match *numbers {
        [x, y] => Ok(Pose::new(x, y, 0.0)),
        [x, y, degrees] => Ok(Pose::new(x, y, Radians::from_degrees(degrees).get())),
        _ => Err(Failure::not_understood(format!(
            "--start: expected X,Y (m) or X,Y,HEADING (degrees), found {} numbers",
            numbers.len()
        ))),
    }
}
