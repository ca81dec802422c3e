//! What can be typed.

mod bundles;
mod engines;
mod examples;
mod studies;

pub(super) use bundles::{
    AttestArgs, CrateEdition, DiffArgs, DiffFormat, ExportArgs, LimitsArgs, ReplayArgs, ReportArgs,
    VerifyArgs,
};
pub(super) use engines::{Engine, SubmitArgs};
pub(super) use studies::{CheckArgs, InferArgs, LockArgs, MergeArgs, PlanArgs, RunArgs, VaryArgs};

use super::load::Given;
use clap::{Args, CommandFactory as _, Parser, Subcommand, ValueEnum};
use std::ffi::OsString;
use std::path::PathBuf;

/// Re-enact published robot-exploration experiments, exactly
#[derive(Debug, Parser)]
#[command(
    name = "reenact",
    version,
    max_term_width = 100,
    arg_required_else_help = true,
    after_help = examples::ALL
)]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub(super) command: Command,
}

impl Arguments {
    /// Reads what was typed, the first word being the program's name.
    pub(super) fn read(words: impl IntoIterator<Item = OsString>) -> Result<Self, clap::Error> {
        Self::try_parse_from(with_its_edition(words))
    }
}

/// Joins `--rocrate` and the edition after it to one word. Its value may be left out, and a bundle may follow: clap would take that
/// for the value.
fn with_its_edition(words: impl IntoIterator<Item = OsString>) -> Vec<OsString> {
    let mut out: Vec<OsString> = Vec::new();
    for word in words {
        let edition = word.to_str().filter(|word| {
            word.contains('.') && word.bytes().all(|b| b.is_ascii_digit() || b == b'.')
        });
        match (out.last_mut(), edition) {
            (Some(last), Some(edition)) if last == "--rocrate" => {
                last.push("=");
                last.push(edition);
            }
            _ => out.push(word),
        }
    }
    out
}

/// Returns the clap command, for completions and for the test that holds it together.
pub fn command() -> clap::Command {
    Arguments::command()
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Simulate every trial of a manifest and seal a bundle
    #[command(after_help = examples::RUN)]
    Run(RunArgs),
    /// Seal the bundles of a study's shards as the one bundle of the whole
    #[command(after_help = examples::MERGE)]
    Merge(MergeArgs),
    /// Submit the shards of a study to Slurm or Kubernetes, and a job that seals them
    #[command(after_help = examples::SUBMIT)]
    Submit(SubmitArgs),
    /// Parse and resolve everything, simulate nothing, report every fault
    #[command(after_help = examples::CHECK)]
    Check(CheckArgs),
    /// List the trials that would run, or explain one
    #[command(after_help = examples::PLAN)]
    Plan(PlanArgs),
    /// Check a bundle: safe, intact, coherent, derived, re-executed, replicated
    #[command(after_help = examples::VERIFY)]
    Verify(VerifyArgs),
    /// Put a signature into an attestation that `verify` wrote
    #[command(after_help = examples::ATTEST)]
    Attest(AttestArgs),
    /// Show what changed between two bundles or locks
    #[command(after_help = examples::DIFF)]
    Diff(DiffArgs),
    /// Record what a manifest's run yields, so that drift is noticed
    #[command(after_help = examples::LOCK)]
    Lock(LockArgs),
    /// Try a manifest's claims at the other values that its assumptions state
    #[command(after_help = examples::VARY)]
    Vary(VaryArgs),
    /// Infer what a paper leaves unsaid from a table that it prints
    #[command(after_help = examples::INFER)]
    Infer(InferArgs),
    /// Write a bundle as one offline HTML page
    #[command(after_help = examples::REPORT)]
    Report(ReportArgs),
    /// Write a bundle in another form
    #[command(after_help = examples::EXPORT)]
    Export(ExportArgs),
    /// Re-enact archived trials with full recording
    #[command(after_help = examples::REPLAY)]
    Replay(ReplayArgs),
    /// Draw a robot, world, prior map or occupancy grid, and say what was understood
    #[command(after_help = examples::SHOW)]
    Show(ShowArgs),
    /// Solve a constrained MDP given as JSON
    #[command(after_help = examples::SOLVE_CMDP)]
    SolveCmdp(SolveCmdpArgs),
    /// Print the JSON Schema of manifests, of worlds or of an answer
    #[command(after_help = examples::SCHEMA)]
    Schema(SchemaArgs),
    /// Print shell completions
    #[command(after_help = examples::COMPLETIONS)]
    Completions(CompletionsArgs),
    /// Write the manual pages
    #[command(after_help = examples::MAN)]
    Man(ManArgs),
    /// Write a Gazebo world or a `map_server` map as world YAML
    #[command(after_help = examples::IMPORT)]
    Import(ImportArgs),
    /// Write a working starter manifest
    #[command(after_help = examples::INIT)]
    Init(InitArgs),
    /// Manage the store of finished trials
    #[command(after_help = examples::CACHE)]
    Cache(CacheArgs),
}

impl Command {
    /// Returns which part of a study it is about, where it is about one.
    pub(super) fn select(&mut self) -> Option<&mut SelectArgs> {
        match self {
            Self::Run(args) => Some(&mut args.select),
            Self::Plan(args) => Some(&mut args.select),
            Self::Infer(args) => Some(&mut args.select),
            _ => None,
        }
    }
}

/// How answers are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Format {
    /// For people
    Human,
    /// One compact line of JSON per manifest or bundle
    Json,
    /// JUnit XML, for CI
    Junit,
}

/// How answers are written that are no tests.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum DataFormat {
    /// For people
    Human,
    /// One compact line of JSON
    Json,
}

/// Which part of a study, and what is changed in it.
#[derive(Debug, Clone, Args)]
pub(super) struct SelectArgs {
    /// Only conditions with these values (repeatable); the bundle says it is partial
    #[arg(long, value_name = "FACTOR=VALUE[,VALUE]")]
    pub(super) only: Vec<String>,
    /// Trials per condition instead of the manifest's; the bundle says it is partial
    #[arg(long, value_name = "N")]
    pub(super) trials: Option<u32>,
    /// Only the I-th of N parts of about the same cost, for as many machines; `auto` where Slurm, Kubernetes or AWS Batch says
    /// which (`auto/N` where it does not say of how many)
    #[arg(long, value_name = "I/N|auto[/N]")]
    pub(super) shard: Option<String>,
    /// Replace a value of the manifest (repeatable), as in `--set world.file=PATH`
    #[arg(long, value_name = "PATH=VALUE")]
    pub(super) set: Vec<String>,
    /// A folder outside their own that robot and world files may refer to (repeatable)
    #[arg(long, value_name = "FOLDER")]
    pub(super) allow: Vec<PathBuf>,
}

impl SelectArgs {
    /// Returns what is said of the manifest itself.
    pub(super) fn given(&self) -> Given<'_> {
        Given { set: &self.set, allow: &self.allow }
    }
}

#[derive(Debug, Args)]
pub(super) struct ShowArgs {
    /// A robot (URDF), world (YAML, SDF) or map (`map_server` YAML)
    #[arg(required_unless_present = "generate", conflicts_with = "generate")]
    pub(super) file: Option<PathBuf>,
    /// Instead of a file: a building of this family
    #[arg(long, value_enum, value_name = "FAMILY")]
    pub(super) generate: Option<FamilyArg>,
    /// Which building of the family
    #[arg(long, default_value_t = 0, requires = "generate")]
    pub(super) seed: u64,
    /// The drawing to write (.svg, or .png for grids; .yaml writes a building of a family as a world file)
    /// [default: the file's name with .svg, in this folder]
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
    /// Cut worlds at this height (m)
    #[arg(long, value_name = "METRES")]
    pub(super) height: Option<f64>,
    /// The folder of a model or package that a world's or robot's files name (repeatable)
    #[arg(long, value_name = "NAME=FOLDER", conflicts_with = "generate")]
    pub(super) models: Vec<String>,
    /// A folder that holds the folders of a Gazebo world's models (repeatable)
    #[arg(long, value_name = "FOLDER", conflicts_with = "generate")]
    pub(super) model_path: Vec<String>,
    /// A folder outside their own that robot and world files may refer to (repeatable)
    #[arg(long, value_name = "FOLDER", conflicts_with = "generate")]
    pub(super) allow: Vec<PathBuf>,
    /// An argument of a robot's xacro (repeatable)
    #[arg(long, value_name = "NAME=VALUE", conflicts_with = "generate")]
    pub(super) argument: Vec<String>,
    /// Layers of a world to draw beside its walls [default: all]
    #[arg(long, value_delimiter = ',', value_name = "LAYERS", conflicts_with = "generate")]
    pub(super) layers: Option<Vec<String>>,
    /// Instead of a world: what is derived from it as prior knowledge
    #[arg(long, value_enum, value_name = "PRIOR", conflicts_with = "generate")]
    pub(super) derive: Option<DerivedArg>,
    /// Side of a derived prior's cells (m)
    #[arg(long, value_name = "METRES", default_value_t = 0.1, requires = "derive")]
    pub(super) resolution: f64,
    /// A `map_server` map to lay over the world
    #[arg(long, value_name = "MAP", conflicts_with_all = ["generate", "derive"])]
    pub(super) over: Option<PathBuf>,
    /// The start that the map's origin is relative to: x,y (m) in the world
    #[arg(
        long,
        value_delimiter = ',',
        num_args = 1,
        value_name = "X,Y",
        requires = "over",
        allow_hyphen_values = true
    )]
    pub(super) start: Option<Vec<f64>>,
    /// How the answer is written
    #[arg(long, value_enum, default_value = "human")]
    pub(super) format: DataFormat,
}

#[derive(Debug, Args)]
pub(super) struct ImportArgs {
    /// A Gazebo world (`.world`, `.sdf`) or the YAML of a `map_server` map
    pub(super) file: PathBuf,
    /// The world YAML to write [default: the file's name with .world.yaml, in this folder]
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
    /// Overwrite an existing file
    #[arg(long)]
    pub(super) force: bool,
    /// Where meshes and what leans are cut (m): the height of the scanner
    #[arg(long, value_name = "METRES", default_value_t = 0.2)]
    pub(super) height: f64,
    /// The folder of a model that a Gazebo world's meshes are named by (repeatable)
    #[arg(long, value_name = "NAME=FOLDER")]
    pub(super) models: Vec<String>,
    /// A folder that holds folders of models (repeatable)
    #[arg(long, value_name = "FOLDER")]
    pub(super) model_path: Vec<String>,
    /// A folder outside their own that robot and world files may refer to (repeatable)
    #[arg(long, value_name = "FOLDER")]
    pub(super) allow: Vec<PathBuf>,
    /// What the unknown cells of a map are
    #[arg(long, value_enum, value_name = "AS", default_value = "occupied")]
    pub(super) unknown: UnknownArg,
    /// How the answer is written
    #[arg(long, value_enum, default_value = "human")]
    pub(super) format: DataFormat,
}

/// What the unknown cells of a map are.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum UnknownArg {
    /// Walls where they border on free floor
    Occupied,
    /// Floor
    Free,
}

/// Prior knowledge derived from a world.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum DerivedArg {
    /// Everything solid at the lidar's height
    FloorPlan,
    /// Of that what can be touched from outside
    Footprint,
    /// The box around it
    BoundingBox,
}

/// Families of buildings.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum FamilyArg {
    /// Floors like that of the deadline study
    OfficeFloor,
}

#[derive(Debug, Args)]
pub(super) struct SolveCmdpArgs {
    /// The problem: states, actions, absorbing, initial, transitions, primary, secondary
    pub(super) file: PathBuf,
}

#[derive(Debug, Args)]
pub(super) struct SchemaArgs {
    /// Of what
    #[arg(value_enum, default_value = "manifest")]
    pub(super) of: SchemaOf,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum SchemaOf {
    /// Manifests
    Manifest,
    /// World YAML files
    World,
    /// Answers of `run`, `merge` and `infer` with `--format json`
    Run,
    /// Of `run --no-seal`
    RunNoSeal,
    /// Of `run --locked --probe`
    RunProbe,
    /// Of `check`
    Check,
    /// Of `plan`
    Plan,
    /// Of `plan --power`
    PlanPower,
    /// Of `verify`
    Verify,
    /// Of `diff`
    Diff,
    /// Of `lock`
    Lock,
    /// Of `report`
    Report,
    /// Of `export`
    Export,
    /// Of `submit`
    Submit,
    /// Of `vary`
    Vary,
    /// Of `vary --joint`
    VaryJoint,
    /// Of `replay`
    Replay,
    /// Of `show`
    Show,
    /// Of `import`
    Import,
    /// Of `init`
    Init,
    /// Of `cache size`
    CacheSize,
    /// Of `cache verify`
    CacheVerify,
}

#[derive(Debug, Args)]
pub(super) struct ManArgs {
    /// The folder to write them to
    pub(super) folder: PathBuf,
}

#[derive(Debug, Args)]
pub(super) struct CompletionsArgs {
    /// For which shell
    pub(super) shell: clap_complete::Shell,
}

#[derive(Debug, Args)]
pub(super) struct InitArgs {
    /// Name of the study: lower-case letters, digits and hyphens
    pub(super) name: String,
    /// A robot of your own (URDF, xacro or SDF) instead of the starter's
    #[arg(long, value_name = "FILE")]
    pub(super) robot: Option<PathBuf>,
    /// A world of your own: world YAML, a Gazebo world or the YAML of a `map_server` map
    #[arg(long, value_name = "FILE")]
    pub(super) world: Option<PathBuf>,
    /// The YAML of a `map_server` map that the robot knows beforehand, in the world's frame
    #[arg(long, value_name = "FILE")]
    pub(super) map: Option<PathBuf>,
    /// Where the robot begins: x,y (m) or x,y,heading (degrees) [default: in the largest room]
    #[arg(
        long,
        value_delimiter = ',',
        num_args = 1,
        value_name = "X,Y[,HEADING]",
        allow_hyphen_values = true
    )]
    pub(super) start: Option<Vec<f64>>,
    /// A folder of models that a Gazebo world includes (repeatable)
    #[arg(long, value_name = "FOLDER", requires = "world")]
    pub(super) model_path: Vec<PathBuf>,
    /// The folder of one model (repeatable)
    #[arg(long, value_name = "NAME=FOLDER", requires = "world")]
    pub(super) models: Vec<String>,
    /// The folder of a package that the robot's files name (repeatable)
    #[arg(long, value_name = "NAME=FOLDER", requires = "robot")]
    pub(super) packages: Vec<String>,
    /// A folder outside their own that robot and world files may refer to (repeatable)
    #[arg(long, value_name = "FOLDER")]
    pub(super) allow: Vec<PathBuf>,
    /// How the answer is written
    #[arg(long, value_enum, default_value = "human")]
    pub(super) format: DataFormat,
}

#[derive(Debug, Args)]
pub(super) struct CacheArgs {
    #[command(subcommand)]
    pub(super) action: CacheAction,
}

#[derive(Debug, Clone, Subcommand)]
pub(super) enum CacheAction {
    /// Print where it is
    Dir,
    /// Print how many trials it holds and how large it is
    Size(CacheFormatArgs),
    /// Remove what has not been written to for some days; trials that are needed again are simulated again
    Prune(PruneArgs),
    /// Check every record against its digest, and records of one trial against each other
    Verify(CacheFormatArgs),
    /// Merge small files, without duplicate and damaged records; safe while other processes run
    Gc,
    /// Write records to one file, to move them to another store
    Export(CacheExportArgs),
    /// Import a file that `export` wrote: all of it, or nothing if anything is wrong with it
    Import(CacheImportArgs),
}

#[derive(Debug, Clone, Args)]
pub(super) struct CacheFormatArgs {
    /// How the answer is written
    #[arg(long, value_enum, default_value = "human")]
    pub(super) format: DataFormat,
}

#[derive(Debug, Clone, Args)]
pub(super) struct CacheExportArgs {
    /// Manifests whose trials are wanted, as far as they are there [default: all there is]
    pub(super) manifests: Vec<PathBuf>,
    /// The file to write
    #[arg(short, long, value_name = "PACK")]
    pub(super) output: PathBuf,
    /// Replace a value of the manifests (repeatable)
    #[arg(long, value_name = "PATH=VALUE", requires = "manifests")]
    pub(super) set: Vec<String>,
    /// A folder outside their own that robot and world files may refer to (repeatable)
    #[arg(long, value_name = "FOLDER", requires = "manifests")]
    pub(super) allow: Vec<PathBuf>,
}

#[derive(Debug, Clone, Args)]
pub(super) struct CacheImportArgs {
    /// The files to import
    #[arg(required = true)]
    pub(super) packs: Vec<PathBuf>,
}

#[derive(Debug, Clone, Copy, Args)]
#[group(required = true)]
pub(super) struct PruneArgs {
    /// What has not been written to for this many days
    #[arg(long, value_name = "DAYS")]
    pub(super) older_than: Option<u32>,
    /// Everything
    #[arg(long)]
    pub(super) all: bool,
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_command_line_holds_together() {
        super::command().debug_assert();
    }
}
