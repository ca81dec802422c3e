//! What can be typed about studies: to run, check, plan, lock and vary them.

use super::{DataFormat, Format, LimitsArgs, SelectArgs};
use crate::cli::load::Given;
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of its own")]
pub(in crate::cli) struct RunArgs {
    /// Manifests to run, one after another
    #[arg(required = true)]
    pub(in crate::cli) manifests: Vec<PathBuf>,
    /// Threads [default: all processors]
    #[arg(short, long, value_name = "N")]
    pub(in crate::cli) jobs: Option<usize>,
    /// Where bundles are written
    #[arg(short, long, value_name = "DIR", default_value = "artifacts")]
    pub(in crate::cli) out: PathBuf,
    #[command(flatten)]
    pub(in crate::cli) select: SelectArgs,
    /// Do not read or write the store of finished trials
    #[arg(long)]
    pub(in crate::cli) no_cache: bool,
    #[command(flatten)]
    pub(in crate::cli) lock: AgainstLockArgs,
    /// Execute every trial twice, without the store; exit with 3 if they differ
    #[arg(long)]
    pub(in crate::cli) twice: bool,
    /// Only run trials and keep them in the store; seal nothing. For workers that share a store: a `run` without this option seals
    #[arg(long, conflicts_with_all = ["no_cache", "twice", "capsule", "locked", "probe", "out"])]
    pub(in crate::cli) no_seal: bool,
    /// Seal the source of this program into the bundle as data, for readers in ten years
    #[arg(long)]
    pub(in crate::cli) capsule: bool,
    #[command(flatten)]
    pub(in crate::cli) limits: LimitsArgs,
    /// How the answer is written
    #[arg(long, value_enum, default_value = "human")]
    pub(in crate::cli) format: Format,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct MergeArgs {
    /// The bundles of `run --shard I/N`, in any order; one may be given twice
    #[arg(required = true)]
    pub(in crate::cli) shards: Vec<PathBuf>,
    /// Where the bundle is written: a folder, or a file ending in .zip
    #[arg(short, long, value_name = "DIR|FILE.zip", default_value = "artifacts")]
    pub(in crate::cli) out: PathBuf,
    #[command(flatten)]
    pub(in crate::cli) limits: LimitsArgs,
    /// How the answer is written
    #[arg(long, value_enum, default_value = "human")]
    pub(in crate::cli) format: DataFormat,
}

/// Whether and how the lock is held against a run.
#[derive(Debug, Args)]
pub(in crate::cli) struct AgainstLockArgs {
    /// Compare with the lock beside the manifest; exit with 1 if results drifted
    #[arg(long)]
    pub(in crate::cli) locked: bool,
    /// Only run trial 0 of every condition anew and compare it with the lock; seal nothing
    #[arg(long, requires = "locked")]
    pub(in crate::cli) probe: bool,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct CheckArgs {
    /// Manifests to check
    #[arg(required = true)]
    pub(in crate::cli) manifests: Vec<PathBuf>,
    /// How the answer is written
    #[arg(long, value_enum, default_value = "human")]
    pub(in crate::cli) format: DataFormat,
    /// Replace a value of the manifest (repeatable)
    #[arg(long, value_name = "PATH=VALUE")]
    pub(in crate::cli) set: Vec<String>,
    /// A folder outside their own that robot and world files may refer to (repeatable)
    #[arg(long, value_name = "FOLDER")]
    pub(in crate::cli) allow: Vec<PathBuf>,
}

impl CheckArgs {
    /// Returns what is said of the manifests.
    pub(in crate::cli) fn given(&self) -> Given<'_> {
        Given { set: &self.set, allow: &self.allow }
    }
}

#[derive(Debug, Args)]
pub(in crate::cli) struct PlanArgs {
    /// The manifest
    pub(in crate::cli) manifest: PathBuf,
    #[command(flatten)]
    pub(in crate::cli) select: SelectArgs,
    /// Print what the key of this trial is made of: 8 hex digits of it, or CONDITION/NUMBER
    #[arg(long, value_name = "TRIAL")]
    pub(in crate::cli) explain: Option<String>,
    /// Show how likely the planned trials, and other numbers of trials, are to decide each claim
    #[arg(long, conflicts_with = "explain")]
    pub(in crate::cli) power: bool,
    /// How the answer is written
    #[arg(long, value_enum, default_value = "human", conflicts_with = "explain")]
    pub(in crate::cli) format: DataFormat,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct LockArgs {
    /// Manifests to lock, one after another
    #[arg(required = true)]
    pub(in crate::cli) manifests: Vec<PathBuf>,
    /// How the answer is written
    #[arg(long, value_enum, default_value = "human")]
    pub(in crate::cli) format: DataFormat,
    /// Threads [default: all processors]
    #[arg(short, long, value_name = "N")]
    pub(in crate::cli) jobs: Option<usize>,
    /// Do not read or write the store of finished trials
    #[arg(long)]
    pub(in crate::cli) no_cache: bool,
    /// A folder outside their own that robot and world files may refer to (repeatable)
    #[arg(long, value_name = "FOLDER")]
    pub(in crate::cli) allow: Vec<PathBuf>,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct VaryArgs {
    /// The manifest; what is found is written beside it, as NAME.sensitivity.csv (with `--joint`, NAME.multiverse.csv)
    pub(in crate::cli) manifest: PathBuf,
    /// Change all these settings at once instead of one at a time, in N draws of a Latin hypercube over their ranges
    #[arg(long, value_name = "N")]
    pub(in crate::cli) joint: Option<usize>,
    /// Seed of the draws, which the table records; the trials keep the manifest's [default: the manifest's]
    #[arg(long, value_name = "S", requires = "joint")]
    pub(in crate::cli) seed: Option<u64>,
    /// Trials per condition, of the values chosen too [default: the manifest's]
    #[arg(long, value_name = "N")]
    pub(in crate::cli) trials: Option<u32>,
    /// Threads [default: all processors]
    #[arg(short, long, value_name = "N")]
    pub(in crate::cli) jobs: Option<usize>,
    /// Do not read or write the store of finished trials
    #[arg(long)]
    pub(in crate::cli) no_cache: bool,
    /// A folder outside their own that robot and world files may refer to (repeatable)
    #[arg(long, value_name = "FOLDER")]
    pub(in crate::cli) allow: Vec<PathBuf>,
    /// How the answer is written
    #[arg(long, value_enum, default_value = "human")]
    pub(in crate::cli) format: DataFormat,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct InferArgs {
    /// A manifest with `infer:`
    pub(in crate::cli) manifest: PathBuf,

    /// Threads [default: all processors]
    #[arg(short, long, value_name = "N")]
    pub(in crate::cli) jobs: Option<usize>,

    /// Where the bundle is written
    #[arg(short, long, value_name = "DIR", default_value = "artifacts")]
    pub(in crate::cli) out: PathBuf,

    #[command(flatten)]
    pub(in crate::cli) select: SelectArgs,

    /// Do not read or write the store of finished proposals
    #[arg(long)]
    pub(in crate::cli) no_cache: bool,

    #[command(flatten)]
    pub(in crate::cli) limits: LimitsArgs,

    /// How the answer is written
    #[arg(long, value_enum, default_value = "human")]
    pub(in crate::cli) format: Format,
}

impl From<&InferArgs> for RunArgs {
    fn from(args: &InferArgs) -> Self {
        let InferArgs { manifest, jobs, out, select, no_cache, limits, format } = args;
        Self {
            manifests: vec![manifest.clone()],
            jobs: *jobs,
            out: out.clone(),
            select: select.clone(),
            no_cache: *no_cache,
            lock: AgainstLockArgs { locked: false, probe: false },
            twice: false,
            no_seal: false,
            capsule: false,
            limits: *limits,
            format: *format,
        }
    }
}
