//! Bundles for the commands that show, compare or hand on what they hold: each is checked to level 3 first, and what that
//! found is the first thing said.

use super::args::LimitsArgs;
use super::exit::{Exit, Failure};
use super::load;
use crate::bundle::{Bundle, shell_word, visible};
use crate::verify::{
    Level, Options, Reenactment, Report, Reviewer, Severity, Verdict, climb_and_keep,
};
use std::path::Path;

/// Faults that a refusal lists.
const FAULTS_LISTED: usize = 10;

/// A bundle and what checking it found.
pub(super) struct Checked {
    pub(super) bundle: Bundle,
    /// What was found, on one line.
    pub(super) words: String,
    /// What must stand over whatever is shown of it; `None` where it is what it says.
    pub(super) banner: Option<String>,
}

/// Why a bundle is not gone on with.
pub(super) struct Refused {
    pub(super) failure: Failure,
    /// Whether it could be read at all.
    pub(super) is_read: bool,
}

impl From<Refused> for Failure {
    fn from(refused: Refused) -> Self {
        refused.failure
    }
}

/// Opens and checks the bundle at `path`. One that is not what it says is refused, unless it is wanted `unchecked`.
pub(super) fn bundle(path: &Path, unchecked: bool, limits: LimitsArgs) -> Result<Checked, Refused> {
    to_level(Level::Derived, path, unchecked, limits)
}

/// Opens and checks the bundle at `path` to `level`, which must be one that executes nothing.
pub(super) fn to_level(
    level: Level,
    path: &Path,
    unchecked: bool,
    limits: LimitsArgs,
) -> Result<Checked, Refused> {
    let unread = |failure| Refused { failure, is_read: false };
    // Nothing is executed, so one thread does and no seed is needed.
    let pipeline = Reenactment::new(1).map_err(Failure::failed).map_err(unread)?;
    let options = Options { level, sample: 1, rows: None, seed: 0 };
    let opened = load::archive(path, limits).map_err(unread)?;
    let (report, bundle) = climb_and_keep(&Reviewer::anonymous(), opened, &options, &pipeline);
    let Some(bundle) = bundle else { return Err(unread(refused(path, &report, None))) };
    let brief = report.in_brief();
    if brief.is_refused && !unchecked {
        let failure = refused(path, &report, Some("; `--unchecked` shows it anyway"));
        return Err(Refused { failure, is_read: true });
    }
    Ok(Checked { bundle, words: brief.words, banner: brief.banner })
}

/// Creates the refusal, with the first faults and what to do.
fn refused(path: &Path, report: &Report, way_out: Option<&str>) -> Failure {
    let name = path.display().to_string();
    let severity = match report.verdict() {
        Verdict::Broken => Severity::Error,
        _ => Severity::Obstacle,
    };
    let faults: Vec<_> = report.of(severity).collect();
    let reached = report.reached_in_words();
    let (exit, answer) = match severity {
        Severity::Error => (Exit::No, "the bundle is not what it says"),
        _ if report.verdict() == Verdict::Failed => (Exit::Failed, "this program failed"),
        _ => (Exit::NotUnderstood, "this program cannot judge the bundle"),
    };
    let asked = report.asked;
    let mut message = format!("error: {name}: {answer}: reached {reached} of level {asked}\n");
    for fault in faults.iter().take(FAULTS_LISTED) {
        // Further lines are set in, so that none can pass for one of ours.
        let fault = visible(fault.to_string().trim_end()).replace('\n', "\n    ");
        message.push_str(&format!("{fault}\n"));
    }
    if faults.len() > FAULTS_LISTED {
        message.push_str(&format!("... and {} more\n", faults.len() - FAULTS_LISTED));
    }
    let word = shell_word(&name).unwrap_or(name);
    let way_out = way_out.unwrap_or_default();
    message
        .push_str(&format!("`reenact verify {word}` lists everything that was found{way_out}\n"));
    Failure { exit, message }
}
