//! What can be typed about bundles: to verify, compare, report, export and replay them.

use super::{DataFormat, Format};
use crate::bundle::Limits;
use crate::verify::Rows;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// A value that its option does not take.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
enum ValueError {
    #[error("expected a number of rows or `all`")]
    Rows,
    #[error("expected a number above 0")]
    Rate,
    #[error("expected a width in millimetres from 60mm to 300mm, such as 88mm")]
    Width,
    #[error("expected a size such as 500M, 8G or a number of bytes")]
    Size,
}

/// Reads how many rows `--robustness` asks for.
fn rows(text: &str) -> Result<Rows, ValueError> {
    match text {
        "all" => Ok(Rows::All),
        number => number.parse().map(Rows::Drawn).map_err(|_| ValueError::Rows),
    }
}

/// Reads a rate in Hz.
fn rate(text: &str) -> Result<f64, ValueError> {
    let rate = text.parse().ok().filter(|rate: &f64| rate.is_finite() && *rate > 0.0);
    rate.ok_or(ValueError::Rate)
}

/// Reads the width of a figure in print (mm).
fn print_width(text: &str) -> Result<f64, ValueError> {
    let number = text.strip_suffix("mm").ok_or(ValueError::Width)?;
    let width: f64 = number.trim_end().parse().map_err(|_| ValueError::Width)?;
    (60.0..=300.0).contains(&width).then_some(width).ok_or(ValueError::Width)
}

/// Reads a size in bytes, or with one of the letters K, M, G and T of that many times 1024.
fn size(text: &str) -> Result<u64, ValueError> {
    let (number, shift) = match text.char_indices().next_back() {
        Some((at, letter)) if letter.is_ascii_alphabetic() => {
            let place = "KMGT".find(letter.to_ascii_uppercase()).ok_or(ValueError::Size)?;
            (&text[..at], 10 * (place + 1))
        }
        _ => (text, 0),
    };
    let number: u64 = number.parse().map_err(|_| ValueError::Size)?;
    let bytes = number.checked_mul(1 << shift).filter(|bytes| *bytes > 0);
    bytes.ok_or(ValueError::Size)
}

/// How much a bundle may ask of its reader.
#[derive(Debug, Clone, Copy, Args)]
pub(in crate::cli) struct LimitsArgs {
    /// The largest bundle to accept, by the size of its files unpacked: 500M, 8G
    #[arg(long, value_name = "SIZE", default_value = "4G", value_parser = size)]
    pub(in crate::cli) max_size: u64,
}

impl LimitsArgs {
    /// Returns the limits to be kept to.
    pub(in crate::cli) fn limits(self) -> Limits {
        Limits { bytes: self.max_size, ..Limits::default() }
    }
}

#[derive(Debug, Args)]
pub(in crate::cli) struct VerifyArgs {
    /// The bundle: a zip or a folder
    pub(in crate::cli) bundle: PathBuf,
    /// How far to climb: 0 safe, 1 intact, 2 coherent, 3 derived, 4 sampled, 5 re-executed in full, 6 replicated with
    /// fresh seeds
    #[arg(long, value_name = "0..6", default_value_t = 3)]
    pub(in crate::cli) level: u8,
    /// Trials to draw at level 4, 1 or more
    #[arg(long, value_name = "N", default_value_t = 59)]
    pub(in crate::cli) sample: usize,
    /// Rows of the robustness table (`sensitivity:`) and of the multiverse table (`multiverse:`) to run again from level 4 on,
    /// each a run of the study at other values of its settings: a number or `all` [default: 1 at level 4, 3 at level 5]
    #[arg(long, value_name = "N|all", value_parser = rows)]
    pub(in crate::cli) robustness: Option<Rows>,
    /// The reviewer's seed for drawing them, and the experiment's at level 6 [default: a fresh one, printed]
    #[arg(long, value_name = "S")]
    pub(in crate::cli) sample_seed: Option<u64>,
    /// Keys that may vouch for the bundle: an OpenSSH `allowed_signers` file or a minisign public key
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) trust: Option<PathBuf>,
    /// A signature that lies beside the bundle rather than in it
    #[arg(long, value_name = "FILE", requires = "trust")]
    pub(in crate::cli) signature: Option<PathBuf>,
    /// Where the bundle holds, write an attestation of that (an in-toto Statement in a DSSE envelope), and beside it, as
    /// FILE.pae, the bytes to sign
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) attest: Option<PathBuf>,
    /// An attestation of this bundle, which one of the trusted keys must have signed
    #[arg(long, value_name = "FILE", requires = "trust")]
    pub(in crate::cli) attestation: Option<PathBuf>,
    #[command(flatten)]
    pub(in crate::cli) limits: LimitsArgs,
    /// Threads for re-execution [default: all processors]
    #[arg(short, long, value_name = "N")]
    pub(in crate::cli) jobs: Option<usize>,
    /// How the answer is written
    #[arg(long, value_enum, default_value = "human")]
    pub(in crate::cli) format: Format,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct AttestArgs {
    /// The attestation, as `verify --attest` wrote it; the signature is put into this file
    pub(in crate::cli) attestation: PathBuf,
    /// A signature of FILE.pae by `ssh-keygen -Y sign -n reenact` or minisign
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) signature: PathBuf,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct DiffArgs {
    /// The old one: a bundle (zip or folder) or a .lock file
    pub(in crate::cli) a: PathBuf,
    /// The new one
    pub(in crate::cli) b: PathBuf,
    /// By how much a metric (or, without METRIC, any number) may differ (repeatable): 0.5, 1%, distance-m=0.5
    #[arg(long, value_name = "[METRIC=]NUMBER[%]")]
    pub(in crate::cli) tolerance: Vec<String>,
    /// How the answer is written
    #[arg(long, value_enum, default_value = "human")]
    pub(in crate::cli) format: DiffFormat,
    /// Write the answer to this file
    #[arg(short, long, value_name = "FILE")]
    pub(in crate::cli) output: Option<PathBuf>,
    #[command(flatten)]
    pub(in crate::cli) limits: LimitsArgs,
    /// Show a bundle that fails its check anyway, under a banner
    #[arg(long)]
    pub(in crate::cli) unchecked: bool,
}

/// How differences are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum DiffFormat {
    /// For people
    Human,
    /// One compact line of JSON
    Json,
    /// One self-contained page
    Html,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct ReportArgs {
    /// The bundle
    pub(in crate::cli) bundle: PathBuf,
    /// The page to write [default: the bundle's name with .html, in this folder]
    #[arg(short, long, value_name = "FILE")]
    pub(in crate::cli) output: Option<PathBuf>,
    /// How the answer is written
    #[arg(long, value_enum, default_value = "human")]
    pub(in crate::cli) format: DataFormat,
    #[command(flatten)]
    pub(in crate::cli) limits: LimitsArgs,
    /// Show a bundle that fails its check anyway, under a banner
    #[arg(long)]
    pub(in crate::cli) unchecked: bool,
}

/// Which RO-Crate specification, and with it which edition of the profiles, a crate keeps to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum CrateEdition {
    /// RO-Crate 1.1, Workflow RO-Crate 1.0, Run Crate profiles 0.5
    #[value(name = "1.1")]
    V1_1,
    /// RO-Crate 1.3, Workflow RO-Crate 1.1, Run Crate profiles 0.6
    #[value(name = "1.3")]
    V1_3,
}

#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of its own")]
pub(in crate::cli) struct ExportArgs {
    /// The bundle
    pub(in crate::cli) bundle: PathBuf,
    /// A zip without a top folder, as some importers want it
    #[arg(long, group = "form")]
    pub(in crate::cli) flat: bool,
    /// A zip of the RO-Crate alone: 1.1 with the Run Crate profiles 0.5, or 1.3 with the profiles 0.6 [default: 1.1]
    #[arg(long, group = "form", value_enum, value_name = "EDITION", num_args = 0..=1, require_equals = true,
          default_missing_value = "1.1", hide_possible_values = true)]
    pub(in crate::cli) rocrate: Option<CrateEdition>,
    /// A folder
    #[arg(long, group = "form")]
    pub(in crate::cli) dir: bool,
    /// A folder of LaTeX: every table with booktabs beside the paper's numbers, every number by its name in `numbers.tex`
    #[arg(long, group = "form", conflicts_with = "signature")]
    pub(in crate::cli) latex: bool,
    /// The appendix that artifact committees ask for, as Markdown and as LaTeX: what it is, how to check it for each badge and how
    /// long that takes, what is to come out
    #[arg(long, group = "form", conflicts_with = "signature")]
    pub(in crate::cli) appendix: bool,
    /// Its figures for print, laid out for the width: of each an SVG, a PDF, and a CSV of what is drawn, into this folder
    #[arg(long, group = "form", value_name = "DIR", conflicts_with_all = ["signature", "out"])]
    pub(in crate::cli) figures: Option<PathBuf>,
    /// How wide a figure stands in print, 60mm to 300mm: a column of IEEE's is 88mm, a page 180mm [default: 88mm]
    #[arg(long, value_name = "MM", requires = "figures", value_parser = print_width)]
    pub(in crate::cli) width: Option<f64>,
    /// A site for any host of files, into this folder: the bundle, the page that checks it in a browser, its report, and an index
    #[arg(long, group = "form", value_name = "DIR", requires = "page", conflicts_with = "out")]
    pub(in crate::cli) site: Option<PathBuf>,
    /// The page that checks bundles, as `.ci/page` in the source builds it
    #[arg(long, value_name = "FILE", requires = "site")]
    pub(in crate::cli) page: Option<PathBuf>,
    /// Put this signature of its `tagmanifest-sha256.txt` into it
    #[arg(long, value_name = "FILE", conflicts_with = "rocrate")]
    pub(in crate::cli) signature: Option<PathBuf>,
    /// Where to write it [default: this folder]
    #[arg(short, long, value_name = "DIR", default_value = ".")]
    pub(in crate::cli) out: PathBuf,
    /// How the answer is written
    #[arg(long, value_enum, default_value = "human")]
    pub(in crate::cli) format: DataFormat,
    #[command(flatten)]
    pub(in crate::cli) limits: LimitsArgs,
    /// Write a bundle that fails its check anyway
    #[arg(long)]
    pub(in crate::cli) unchecked: bool,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct ReplayArgs {
    /// The bundle
    pub(in crate::cli) bundle: PathBuf,
    /// One trial, or two to play side by side: 8 hex digits of a key, or CONDITION/NUMBER
    #[arg(required = true, num_args = 1..=2, value_name = "TRIAL")]
    pub(in crate::cli) trials: Vec<String>,
    /// Write a page in which it plays
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) html: Option<PathBuf>,
    /// Write a still picture
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) svg: Option<PathBuf>,
    /// Write the first trial as a bag of ROS 2 messages (MCAP), as Foxglove and `ros2 bag` read it
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) mcap: Option<PathBuf>,
    /// Write the map that the robot of the first trial ended with, as ROS' `map_server` reads it: this YAML, and an image
    /// (PGM) beside it
    #[arg(long, value_name = "FILE.yaml")]
    pub(in crate::cli) map: Option<PathBuf>,
    /// Scans per second in the bag, at most [default: all that were taken]
    #[arg(long, value_name = "HZ", requires = "mcap", value_parser = rate)]
    pub(in crate::cli) scan_rate: Option<f64>,
    /// Deadline study: write the constrained MDP of every plan of the first trial into this folder, for `solve-cmdp`
    #[arg(long, value_name = "DIR")]
    pub(in crate::cli) plans: Option<PathBuf>,
    /// The instant of the still picture (s) [default: the end]
    #[arg(long, value_name = "SECONDS", requires = "svg")]
    pub(in crate::cli) at: Option<f64>,
    /// Prior-map study: ... or when this coverage (percent) was first reached
    #[arg(long, value_name = "PERCENT", requires = "svg", conflicts_with = "at")]
    pub(in crate::cli) at_coverage: Option<f64>,
    /// Leave frontiers and the planned path out of the still picture: map, path travelled and robot alone
    #[arg(long, requires = "svg", conflicts_with = "decision")]
    pub(in crate::cli) plain: bool,
    /// Prior-map study: instead of a still, draw what the candidate of this choice (from 1) promises, with and without prior
    #[arg(long, value_name = "CHOICE", requires = "svg", conflicts_with_all = ["at", "at_coverage"])]
    pub(in crate::cli) decision: Option<usize>,
    /// Which candidate of that choice, from 1 [default: the chosen one]
    #[arg(long, value_name = "CANDIDATE", requires = "decision")]
    pub(in crate::cli) gain: Option<usize>,
    /// How the answer is written
    #[arg(long, value_enum, default_value = "human")]
    pub(in crate::cli) format: DataFormat,
    #[command(flatten)]
    pub(in crate::cli) limits: LimitsArgs,
    /// Show a bundle that fails its check anyway, under a banner
    #[arg(long)]
    pub(in crate::cli) unchecked: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_in_print_have_their_unit() {
        let read = |text: &str| print_width(text).map_err(|e| e.to_string());
        assert_eq!((read("88mm"), read("180 mm"), read("62.5mm")), (Ok(88.0), Ok(180.0), Ok(62.5)));
        for text in ["", "88", "mm", "3.5in", "59mm", "301mm", "NaNmm"] {
            let expected = "expected a width in millimetres from 60mm to 300mm, such as 88mm";
            assert_eq!(read(text), Err(expected.to_owned()), "{text}");
        }
    }

    #[test]
    fn sizes_are_read_as_people_write_them() {
        let read = |text: &str| size(text).map_err(|e| e.to_string());
        assert_eq!(read("123"), Ok(123));
        assert_eq!((read("1k"), read("500M"), read("8G")), (Ok(1024), Ok(500 << 20), Ok(8 << 30)));
        for text in ["", "G", "0", "-1", "1.5G", "8 G", "8GB", "99999999999T"] {
            let expected = "expected a size such as 500M, 8G or a number of bytes";
            assert_eq!(read(text), Err(expected.to_owned()), "{text}");
        }
    }
}
