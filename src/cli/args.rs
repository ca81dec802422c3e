//! What can be typed.

use crate::verify::Rows;
use clap::{Args, CommandFactory as _, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

/// Re-enact published robot-exploration experiments, exactly
#[derive(Debug, Parser)]
#[command(name = "reenact", version, max_term_width = 100, arg_required_else_help = true)]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub(super) command: Command,
}

/// A value that its option does not take.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
enum ValueError {
    #[error("expected a number of rows or `all`")]
    Rows,
    #[error("expected a number above 0")]
    Rate,
}

/// Reads how many rows `--robustness` asks for.
fn rows(text: &str) -> Result<Rows, ValueError> {
    match text {
        "all" => Ok(Rows::All),
        number => number.parse().map(Rows::Drawn).map_err(|_| ValueError::Rows),
    }
}

/// The clap command, for completions and for the test that holds it together.
pub fn command() -> clap::Command {
    Arguments::command()
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Simulate every trial of a manifest and seal a bundle
    Run(RunArgs),
    /// Parse and resolve everything, simulate nothing, report every fault
    Check(CheckArgs),
    /// List the trials that would run, or explain one
    Plan(PlanArgs),
    /// Check a bundle: safe, intact, coherent, derived, re-executed, replicated
    Verify(VerifyArgs),
    /// Put a signature into an attestation that `verify` wrote
    Attest(AttestArgs),
    /// Tell what changed between two bundles or locks
    Diff(DiffArgs),
    /// Write down what a manifest's run yields, so that drift is found
    Lock(LockArgs),
    /// Try a manifest's claims at the other values that its assumptions state
    Vary(VaryArgs),
    /// Write a bundle as one offline HTML page
    Report(ReportArgs),
    /// Write a bundle in another form
    Export(ExportArgs),
    /// Re-enact archived trials with full recording
    Replay(ReplayArgs),
    /// Draw a robot, world, prior map or occupancy grid, and say what was understood
    Show(ShowArgs),
    /// Solve a constrained MDP given as JSON
    SolveCmdp(SolveCmdpArgs),
    /// Print the JSON Schema of manifests or worlds
    Schema(SchemaArgs),
    /// Print shell completions
    Completions(CompletionsArgs),
    /// Write a working starter manifest
    Init(InitArgs),
    /// Look after the store of finished trials
    Cache(CacheArgs),
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

/// Which part of a study, and what is changed in it.
#[derive(Debug, Args)]
pub(super) struct SelectArgs {
    /// Only conditions with these values (repeatable); the bundle says it is partial
    #[arg(long, value_name = "FACTOR=VALUE[,VALUE]")]
    pub(super) only: Vec<String>,
    /// Trials per condition instead of the manifest's; the bundle says it is partial
    #[arg(long, value_name = "N")]
    pub(super) trials: Option<u32>,
    /// Only every N-th trial, beginning with the I-th
    #[arg(long, value_name = "I/N")]
    pub(super) shard: Option<String>,
    /// Replace a value of the manifest (repeatable), as in `--set world.file=PATH`
    #[arg(long, value_name = "PATH=VALUE")]
    pub(super) set: Vec<String>,
}

#[derive(Debug, Args)]
pub(super) struct RunArgs {
    /// Manifests to run, one after another
    #[arg(required = true)]
    pub(super) manifests: Vec<PathBuf>,
    /// Threads [default: all processors]
    #[arg(short, long, value_name = "N")]
    pub(super) jobs: Option<usize>,
    /// Where bundles land
    #[arg(short, long, value_name = "DIR", default_value = "artifacts")]
    pub(super) out: PathBuf,
    #[command(flatten)]
    pub(super) select: SelectArgs,
    /// Neither read nor write the store of finished trials
    #[arg(long)]
    pub(super) no_cache: bool,
    #[command(flatten)]
    pub(super) lock: AgainstLockArgs,
    /// Execute every trial twice, without the store; a difference ends with 3
    #[arg(long)]
    pub(super) twice: bool,
    /// Seal the source of this program into the bundle as data, for readers in ten years
    #[arg(long)]
    pub(super) capsule: bool,
    /// How the answer is written
    #[arg(long, value_enum, default_value = "human")]
    pub(super) format: Format,
}

/// Whether and how the lock is held against a run.
#[derive(Debug, Args)]
pub(super) struct AgainstLockArgs {
    /// Compare with the lock beside the manifest; drift ends with 1
    #[arg(long)]
    pub(super) locked: bool,
    /// Only run trial 0 of every condition anew and compare it with the lock; seal nothing
    #[arg(long, requires = "locked")]
    pub(super) probe: bool,
}

#[derive(Debug, Args)]
pub(super) struct CheckArgs {
    /// Manifests to check
    #[arg(required = true)]
    pub(super) manifests: Vec<PathBuf>,
    /// Replace a value of the manifest (repeatable)
    #[arg(long, value_name = "PATH=VALUE")]
    pub(super) set: Vec<String>,
}

#[derive(Debug, Args)]
pub(super) struct PlanArgs {
    /// The manifest
    pub(super) manifest: PathBuf,
    #[command(flatten)]
    pub(super) select: SelectArgs,
    /// Print what the key of this trial is made of: 8 hex digits of it, or CONDITION/NUMBER
    #[arg(long, value_name = "TRIAL")]
    pub(super) explain: Option<String>,
    /// Say how likely the planned trials, and other numbers of them, are to decide each claim
    #[arg(long, conflicts_with = "explain")]
    pub(super) power: bool,
    /// How `--power` is written
    #[arg(long, value_enum, default_value = "human", requires = "power")]
    pub(super) format: Format,
}

#[derive(Debug, Args)]
pub(super) struct VerifyArgs {
    /// The bundle: a zip or a folder
    pub(super) bundle: PathBuf,
    /// How far to climb: 0 safe, 1 intact, 2 coherent, 3 derived, 4 sampled, 5 re-executed in full, 6 replicated with
    /// fresh seeds
    #[arg(long, value_name = "0..6", default_value_t = 3)]
    pub(super) level: u8,
    /// Trials to draw at level 4, 1 or more
    #[arg(long, value_name = "N", default_value_t = 59)]
    pub(super) sample: usize,
    /// Rows of the robustness table (`sensitivity:`) to run again from level 4 on, each a run of the study at another value
    /// of one setting: a number or `all` [default: 1 at level 4, 3 at level 5]
    #[arg(long, value_name = "N|all", value_parser = rows)]
    pub(super) robustness: Option<Rows>,
    /// The reviewer's seed for drawing them, and the experiment's at level 6 [default: a fresh one, printed]
    #[arg(long, value_name = "S")]
    pub(super) sample_seed: Option<u64>,
    /// Keys that may vouch for the bundle: an OpenSSH `allowed_signers` file or a minisign public key
    #[arg(long, value_name = "FILE")]
    pub(super) trust: Option<PathBuf>,
    /// A signature that lies beside the bundle rather than in it
    #[arg(long, value_name = "FILE", requires = "trust")]
    pub(super) signature: Option<PathBuf>,
    /// Where the bundle holds, write an attestation of that (an in-toto Statement in a DSSE envelope), and beside it, as
    /// FILE.pae, the bytes to sign
    #[arg(long, value_name = "FILE")]
    pub(super) attest: Option<PathBuf>,
    /// An attestation of this bundle, which one of the trusted keys must have signed
    #[arg(long, value_name = "FILE", requires = "trust")]
    pub(super) attestation: Option<PathBuf>,
    /// Threads for re-execution [default: all processors]
    #[arg(short, long, value_name = "N")]
    pub(super) jobs: Option<usize>,
    /// How the answer is written
    #[arg(long, value_enum, default_value = "human")]
    pub(super) format: Format,
}

#[derive(Debug, Args)]
pub(super) struct AttestArgs {
    /// The attestation, as `verify --attest` wrote it; the signature is put into this file
    pub(super) attestation: PathBuf,
    /// A signature of FILE.pae by `ssh-keygen -Y sign -n reenact` or minisign
    #[arg(long, value_name = "FILE")]
    pub(super) signature: PathBuf,
}

#[derive(Debug, Args)]
pub(super) struct DiffArgs {
    /// The old one: a bundle (zip or folder) or a .lock file
    pub(super) a: PathBuf,
    /// The new one
    pub(super) b: PathBuf,
    /// By how much a metric (or, without METRIC, any number) may differ (repeatable): 0.5, 1%, distance-m=0.5
    #[arg(long, value_name = "[METRIC=]NUMBER[%]")]
    pub(super) tolerance: Vec<String>,
    /// How the answer is written
    #[arg(long, value_enum, default_value = "human")]
    pub(super) format: DiffFormat,
    /// Write the answer to this file
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
    /// Show a bundle that fails its check all the same, under a banner
    #[arg(long)]
    pub(super) unchecked: bool,
}

/// How differences are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum DiffFormat {
    /// For people
    Human,
    /// One compact line of JSON
    Json,
    /// One self-contained page
    Html,
}

#[derive(Debug, Args)]
pub(super) struct LockArgs {
    /// Manifests to lock, one after another
    #[arg(required = true)]
    pub(super) manifests: Vec<PathBuf>,
    /// Threads [default: all processors]
    #[arg(short, long, value_name = "N")]
    pub(super) jobs: Option<usize>,
    /// Neither read nor write the store of finished trials
    #[arg(long)]
    pub(super) no_cache: bool,
}

#[derive(Debug, Args)]
pub(super) struct VaryArgs {
    /// The manifest; what is found is written beside it, as NAME.sensitivity.csv
    pub(super) manifest: PathBuf,
    /// Trials per condition, of the values chosen too [default: the manifest's]
    #[arg(long, value_name = "N")]
    pub(super) trials: Option<u32>,
    /// Threads [default: all processors]
    #[arg(short, long, value_name = "N")]
    pub(super) jobs: Option<usize>,
    /// Neither read nor write the store of finished trials
    #[arg(long)]
    pub(super) no_cache: bool,
}

#[derive(Debug, Args)]
pub(super) struct ReportArgs {
    /// The bundle
    pub(super) bundle: PathBuf,
    /// The page to write [default: the bundle's name with .html, in this folder]
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
    /// Show a bundle that fails its check all the same, under a banner
    #[arg(long)]
    pub(super) unchecked: bool,
}

#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of its own")]
pub(super) struct ExportArgs {
    /// The bundle
    pub(super) bundle: PathBuf,
    /// A zip without a top folder, as some importers want it
    #[arg(long, group = "form")]
    pub(super) flat: bool,
    /// A zip of the RO-Crate alone
    #[arg(long, group = "form")]
    pub(super) rocrate: bool,
    /// A folder
    #[arg(long, group = "form")]
    pub(super) dir: bool,
    /// Put this signature of its `tagmanifest-sha256.txt` into it
    #[arg(long, value_name = "FILE", conflicts_with = "rocrate")]
    pub(super) signature: Option<PathBuf>,
    /// Where to write it [default: this folder]
    #[arg(short, long, value_name = "DIR", default_value = ".")]
    pub(super) out: PathBuf,
    /// Write a bundle that fails its check all the same
    #[arg(long)]
    pub(super) unchecked: bool,
}

#[derive(Debug, Args)]
pub(super) struct ReplayArgs {
    /// The bundle
    pub(super) bundle: PathBuf,
    /// One trial, or two to play side by side: 8 hex digits of a key, or CONDITION/NUMBER
    #[arg(required = true, num_args = 1..=2, value_name = "TRIAL")]
    pub(super) trials: Vec<String>,
    /// Write a page in which it plays
    #[arg(long, value_name = "FILE")]
    pub(super) html: Option<PathBuf>,
    /// Write a still picture
    #[arg(long, value_name = "FILE")]
    pub(super) svg: Option<PathBuf>,
    /// Write the first trial as a bag of ROS 2 messages (MCAP), as Foxglove and `ros2 bag` read it
    #[arg(long, value_name = "FILE")]
    pub(super) mcap: Option<PathBuf>,
    /// Scans per second in the bag, at most [default: all that were taken]
    #[arg(long, value_name = "HZ", requires = "mcap", value_parser = rate)]
    pub(super) scan_rate: Option<f64>,
    /// Deadline study: write the constrained MDP of every plan of the first trial into this folder, for `solve-cmdp`
    #[arg(long, value_name = "DIR")]
    pub(super) plans: Option<PathBuf>,
    /// The instant of the still picture (s) [default: the end]
    #[arg(long, value_name = "SECONDS", requires = "svg")]
    pub(super) at: Option<f64>,
    /// Prior-map study: ... or when this coverage (percent) was first reached
    #[arg(long, value_name = "PERCENT", requires = "svg", conflicts_with = "at")]
    pub(super) at_coverage: Option<f64>,
    /// Leave frontiers and the planned path out of the still picture: map, path travelled and robot alone
    #[arg(long, requires = "svg", conflicts_with = "decision")]
    pub(super) plain: bool,
    /// Prior-map study: instead of a still, draw what the candidate of this choice (from 1) promises, with and without prior
    #[arg(long, value_name = "CHOICE", requires = "svg", conflicts_with_all = ["at", "at_coverage"])]
    pub(super) decision: Option<usize>,
    /// Which candidate of that choice, from 1 [default: the chosen one]
    #[arg(long, value_name = "CANDIDATE", requires = "decision")]
    pub(super) gain: Option<usize>,
    /// Show a bundle that fails its check all the same, under a banner
    #[arg(long)]
    pub(super) unchecked: bool,
}

/// Reads a rate in Hz.
fn rate(text: &str) -> Result<f64, ValueError> {
    let rate = text.parse().ok().filter(|rate: &f64| rate.is_finite() && *rate > 0.0);
    rate.ok_or(ValueError::Rate)
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
    /// The folder of a model that a Gazebo world's meshes are named by (repeatable)
    #[arg(long, value_name = "NAME=FOLDER", conflicts_with = "generate")]
    pub(super) models: Vec<String>,
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
}

#[derive(Debug, Args)]
pub(super) struct CacheArgs {
    #[command(subcommand)]
    pub(super) action: CacheAction,
}

#[derive(Debug, Clone, Copy, Subcommand)]
pub(super) enum CacheAction {
    /// Print where it is
    Dir,
    /// Print how many trials it holds and how large it is
    Size,
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_command_line_holds_together() {
        super::command().debug_assert();
    }
}
