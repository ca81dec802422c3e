//! `reenact show`: draw an input and say what was understood.

use crate::cli::args::{DataFormat, DerivedArg, FamilyArg, ShowArgs};
use crate::cli::exit::{Exit, Failure};
use crate::cli::load;
use crate::cli::terminal::Terminal;
use crate::document::{Diagnostic, Source};
use crate::geometry::Point;
use crate::report::show::{self, Derived, Drawing, FetchError, Over, RobotFiles};
use crate::robot::{FilePath as RobotPath, Files, Unfound};
use crate::store;
use crate::world::generate::{self, Family};
use crate::world::mesh;
use crate::world::sdf::{FilePath, Folders, Models, Root};
use serde_json::json;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Makes a generated building as the world file that it would be.
fn building(family: FamilyArg, seed: u64) -> Result<(PathBuf, Vec<u8>), Failure> {
    let FamilyArg::OfficeFloor = family;
    let doc = generate::document(Family::OfficeFloor, seed)
        .map_err(|problem| Failure::not_understood(problem.to_string()))?;
    Ok((PathBuf::from(format!("{}.yaml", doc.name)), doc.to_yaml().into_bytes()))
}

/// The models of a world: files in folders of the command line, or beside the world.
struct Shelf<'a> {
    beside: PathBuf,
    folders: Folders,
    given: load::Given<'a>,
}

impl Shelf<'_> {
    fn path_of(&self, path: &FilePath) -> PathBuf {
        match path.root {
            Root::World => self.beside.join(&path.path),
            Root::Models | Root::ModelPath => PathBuf::from(&path.path),
        }
    }
}

impl Models for Shelf<'_> {
    fn folders(&self) -> Folders {
        self.folders.clone()
    }

    fn read(&mut self, path: &FilePath) -> Result<Arc<[u8]>, String> {
        match store::read(&self.path_of(path), load::MOST_INPUT) {
            Ok(bytes) => Ok(bytes.into()),
            Err(error) => Err(store::reason(&error)),
        }
    }

    fn name(&self, path: &FilePath) -> String {
        self.path_of(path).display().to_string()
    }

    fn follows(&mut self, path: &FilePath) -> bool {
        self.given.allows(&self.path_of(path))
    }
}

/// Returns the models of a world that lies in the folder `beside`: in the folders that `models` give as `NAME=FOLDER`, and in
/// those of `path`; what lies in folders of `allow` may be named by any path.
pub(super) fn shelf<'a>(
    models: &[String],
    path: &[String],
    allow: &'a [PathBuf],
    beside: PathBuf,
) -> Result<impl Models + use<'a>, Failure> {
    let models = pairs(models, "--models: expected NAME=FOLDER")?;
    let given = load::Given { set: &[], allow };
    Ok(Shelf { beside, folders: Folders { models, path: path.to_vec() }, given })
}

/// Returns every `NAME=VALUE` of an option by its name; a fault begins with what was `expected`.
fn pairs(written: &[String], expected: &str) -> Result<BTreeMap<String, String>, Failure> {
    let pair = |written: &String| match written.split_once('=') {
        Some((name, value)) => Ok((name.to_owned(), value.to_owned())),
        None => Err(Failure::not_understood(format!("{expected}, found `{written}`"))),
    };
    written.iter().map(pair).collect()
}

/// The files that a robot names: by paths that lead from where it lies, or from folders of the command line.
struct RobotShelf<'a>(load::Given<'a>);

impl RobotShelf<'_> {
    fn bytes(file: &RobotPath) -> Result<Vec<u8>, Unfound> {
        store::read(Path::new(&file.path), load::MOST_INPUT)
            .map_err(|error| Unfound(store::reason(&error)))
    }
}

impl Files for RobotShelf<'_> {
    fn text(&mut self, file: &RobotPath) -> Result<Source, Unfound> {
        match String::from_utf8(Self::bytes(file)?) {
            Ok(text) => Ok(Source::new(file.path.as_str(), text)),
            Err(_) => Err(Unfound("it is not UTF-8 text".to_owned())),
        }
    }

    fn follows(&mut self, file: &RobotPath) -> bool {
        self.0.allows(Path::new(&file.path))
    }

    fn corners(&mut self, file: &RobotPath) -> Result<Vec<[f64; 3]>, Unfound> {
        let mesh = mesh::read(&file.path, &Self::bytes(file)?).map_err(|faults| {
            Unfound(faults.into_iter().next().map_or_else(String::new, |fault| fault.message))
        })?;
        Ok(mesh.parts.iter().flat_map(|part| &part.triangles).flatten().copied().collect())
    }
}

/// Draws what is asked for of the file `name`.
fn draw(
    args: &ShowArgs,
    file: &Path,
    name: &str,
    bytes: &[u8],
    terminal: Terminal,
) -> Result<Drawing, Failure> {
    let height = args.height.unwrap_or(show::CUT_HEIGHT);
    let beside = |file: &Path| file.parent().unwrap_or(Path::new("")).to_owned();
    let fetch_from = |folder: PathBuf| {
        move |path: &str| load::bytes(&folder.join(path)).map_err(|f| FetchError(f.message))
    };
    let told = |faults: Vec<Diagnostic>| {
        terminal.diagnostics(&faults);
        Failure::not_understood(format!("{name}: {}", Terminal::count(&faults)))
    };
    let packages = pairs(&args.models, "--models: expected NAME=FOLDER")?;
    let arguments = pairs(&args.argument, "--argument: expected NAME=VALUE")?;
    let mut shelf = shelf(&args.models, &args.model_path, &args.allow, beside(file))?;
    let mut world =
        || show::read_world(name, bytes, args.layers.as_deref(), &mut shelf).map_err(told);
    match (args.derive, &args.over) {
        (Some(kind), _) => {
            let kind = match kind {
                DerivedArg::FloorPlan => Derived::FloorPlan,
                DerivedArg::Footprint => Derived::Footprint,
                DerivedArg::BoundingBox => Derived::BoundingBox,
            };
            show::draw_derived(&world()?, kind, height, args.resolution).map_err(told)
        }
        (None, Some(map)) => {
            let start = match args.start.as_deref() {
                None => Point::ZERO,
                Some([x, y]) => Point::new(*x, *y),
                Some(other) => {
                    let message =
                        format!("--start: expected x,y (m), found {} numbers", other.len());
                    return Err(Failure::not_understood(message));
                }
            };
            let over = load::bytes(map)?;
            let map_name = map.display().to_string();
            let over = Over { name: &map_name, bytes: &over, start };
            show::draw_over(&world()?, height, over, &mut fetch_from(beside(map))).map_err(told)
        }
        (None, None) if args.layers.is_some() => Ok(show::draw_world(&world()?, height)),
        (None, None) => {
            let mut files = RobotShelf(load::Given { set: &[], allow: &args.allow });
            let mut robot =
                RobotFiles { packages: &packages, arguments: &arguments, files: &mut files };
            show::draw(name, bytes, height, &mut shelf, &mut robot, &mut fetch_from(beside(file)))
                .map_err(told)
        }
    }
}

/// Draws one file.
pub(in crate::cli) fn run(args: &ShowArgs, terminal: Terminal) -> Result<Exit, Failure> {
    let (file, bytes) = match (&args.file, args.generate) {
        (Some(file), _) => (file.clone(), load::bytes(file)?),
        (None, Some(family)) => building(family, args.seed)?,
        (None, None) => return Err(Failure::not_understood("show needs a file or `--generate`")),
    };
    let name = file.display().to_string();
    let drawing = draw(args, &file, &name, &bytes, terminal)?;
    terminal.diagnostics(&drawing.warnings);
    let output = args.output.clone().unwrap_or_else(|| {
        let stem = file.file_stem().unwrap_or_default();
        PathBuf::from(stem).with_extension("svg")
    });
    let ends_in = |ending: &str| output.extension().is_some_and(|e| e.eq_ignore_ascii_case(ending));
    match (ends_in("png"), &drawing.png) {
        (true, Some(png)) => load::write(&output, png)?,
        (true, None) => {
            return Err(Failure::not_understood(
                "only maps are drawn as PNG: name an .svg file for robots and worlds",
            ));
        }
        (false, _) if ends_in("yaml") && args.generate.is_some() => load::write(&output, &bytes)?,
        (false, _) if ends_in("yaml") => {
            return Err(Failure::not_understood(
                "only buildings of a family are written as YAML: name an .svg file for drawings",
            ));
        }
        (false, _) => load::write(&output, drawing.svg.as_bytes())?,
    }
    match args.format {
        DataFormat::Human => {
            terminal.result(&drawing.text);
            terminal.note(&format!("wrote {}", output.display()));
        }
        DataFormat::Json => {
            let answer = json!({
                "path": output,
                "kind": drawing.kind.name(),
                "described": drawing.text.lines().collect::<Vec<_>>(),
                "warnings": drawing.warnings.iter().map(|warning| warning.count).sum::<usize>(),
            });
            terminal.result(&answer.to_string());
        }
    }
    Ok(Exit::Yes)
}
