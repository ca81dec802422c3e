//! What can be typed about engines that run the shards of a study.

use super::{DataFormat, SelectArgs};
use clap::{Args, ValueEnum};
use std::num::NonZero;
use std::path::PathBuf;

/// An engine that laboratories have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum Engine {
    /// An array job, and a job that seals when all of it has ended well
    Slurm,
    /// An Indexed Job, and a suspended one that seals: printed for `kubectl apply -f -`
    Kubernetes,
}

/// A value that cannot stand in a job's description.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("expected letters, digits and any of _ - . , : + = @ % /, found `{0}`")]
pub(in crate::cli) struct NoWord(String);

/// Reads a value that is handed on to an engine as it is.
fn word(text: &str) -> Result<String, NoWord> {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_-.,:+=@%/".contains(c);
    if !text.is_empty() && text.chars().all(is_plain) {
        Ok(text.to_owned())
    } else {
        Err(NoWord(text.to_owned()))
    }
}

#[derive(Debug, Args)]
pub(in crate::cli) struct SubmitArgs {
    /// The manifest
    pub(in crate::cli) manifest: PathBuf,
    /// What runs the shards
    #[arg(long, value_enum)]
    pub(in crate::cli) engine: Engine,
    /// How many shards to split the study into
    #[arg(long, value_name = "N")]
    pub(in crate::cli) shards: NonZero<u32>,
    /// A folder outside their own that robot and world files may refer to (repeatable)
    #[arg(long, value_name = "FOLDER")]
    pub(in crate::cli) allow: Vec<PathBuf>,
    /// Print what would be submitted, without submitting or writing anything
    #[arg(long)]
    pub(in crate::cli) dry_run: bool,
    /// Only conditions with these values (repeatable)
    #[arg(long, value_name = "FACTOR=VALUE[,VALUE]")]
    pub(in crate::cli) only: Vec<String>,
    /// Trials per condition instead of the manifest's
    #[arg(long, value_name = "N")]
    pub(in crate::cli) trials: Option<u32>,
    /// Replace a value of the manifest (repeatable)
    #[arg(long, value_name = "PATH=VALUE")]
    pub(in crate::cli) set: Vec<String>,
    /// Where the bundle is written
    #[arg(short, long, value_name = "DIR", default_value = "artifacts")]
    pub(in crate::cli) out: PathBuf,
    /// Processors of a shard, and its threads
    #[arg(long, value_name = "N", default_value = "1")]
    pub(in crate::cli) cpus: NonZero<u32>,
    /// Memory of a shard, as the engine writes it (2G for Slurm, 2Gi for Kubernetes)
    #[arg(long, value_name = "SIZE", value_parser = word)]
    pub(in crate::cli) memory: Option<String>,
    /// At most this many shards at a time
    #[arg(long, value_name = "N")]
    pub(in crate::cli) throttle: Option<NonZero<u32>>,
    #[command(flatten)]
    pub(in crate::cli) slurm: SlurmArgs,
    #[command(flatten)]
    pub(in crate::cli) kubernetes: KubernetesArgs,
    /// How the answer is written
    #[arg(long, value_enum, default_value = "human", conflicts_with = "dry_run")]
    pub(in crate::cli) format: DataFormat,
}

/// What Slurm is told besides.
#[derive(Debug, Args)]
#[command(next_help_heading = "Slurm")]
pub(in crate::cli) struct SlurmArgs {
    /// The partition
    #[arg(long, value_name = "NAME", value_parser = word)]
    pub(in crate::cli) partition: Option<String>,
    /// The account that pays
    #[arg(long, value_name = "NAME", value_parser = word)]
    pub(in crate::cli) account: Option<String>,
    /// Time limit of a shard (`4:00:00`); one that reaches it is run again with the trials that are left
    #[arg(long, value_name = "TIME", value_parser = word)]
    pub(in crate::cli) time: Option<String>,
    /// Where scripts and logs are kept [default: NAME.slurm, in this folder]
    #[arg(long, value_name = "DIR")]
    pub(in crate::cli) scripts: Option<PathBuf>,
}

/// What Kubernetes is told besides.
#[derive(Debug, Args)]
#[command(next_help_heading = "Kubernetes")]
pub(in crate::cli) struct KubernetesArgs {
    /// An image that has this program in its search path
    #[arg(long, value_name = "IMAGE", value_parser = word)]
    pub(in crate::cli) image: Option<String>,
    /// The volume that all pods share (the name of a PersistentVolumeClaim): manifest, inputs, store and bundle are on it
    #[arg(long, value_name = "NAME", value_parser = word)]
    pub(in crate::cli) claim: Option<String>,
    /// Where it is mounted; the manifest's path is relative to it
    #[arg(long, value_name = "PATH", value_parser = word, default_value = "/study")]
    pub(in crate::cli) mount: String,
}

impl From<&SubmitArgs> for SelectArgs {
    fn from(args: &SubmitArgs) -> Self {
        let SubmitArgs { only, trials, set, allow, .. } = args;
        let (only, set, allow) = (only.clone(), set.clone(), allow.clone());
        Self { only, trials: *trials, shard: None, set, allow }
    }
}
