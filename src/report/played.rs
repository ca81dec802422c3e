//! A trial of a bundle, played again, and whether it gave the record that the bundle holds.

use super::Note;
use crate::bundle::{Bundle, Fault};
use crate::plan::Plan;
use crate::studies::recording::Recording;
use crate::studies::{self, TrialSpec};

/// A trial that was re-enacted.
#[derive(Debug, Clone)]
pub struct Played {
    /// What readers of a page call it.
    pub title: String,
    /// What it showed.
    pub recording: Recording,
    /// Whether its record equals the archived one, in words.
    pub note: Note,
}

/// What a re-enactment writes down.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sensing {
    /// What a page shows.
    Shown,
    /// Every scan as well.
    EveryScan,
}

/// Re-enacts the trial `spec` of `plan`, which is the plan of `bundle`.
///
/// # Errors
/// Where the bundle's records cannot be read.
pub fn play(
    bundle: &Bundle,
    plan: &Plan,
    spec: &TrialSpec,
    sensing: Sensing,
) -> Result<Played, Fault> {
    let name = format!("{}/{}", spec.condition.slug(), spec.trial);
    let (record, mut recording) = match sensing {
        Sensing::EveryScan => studies::reenact_sensing(spec),
        Sensing::Shown => studies::reenact(spec),
    };
    let good =
        bundle.record(&spec.key)?.is_some_and(|archived| archived.to_line() == record.to_line());
    let found = if good { "equals" } else { "DIFFERS from" };
    let text = format!("{name}: the re-enacted record {found} the archived one");
    // Readers of the page see labels; whoever asks for the trial again needs its name.
    let title = plan.experiment.labels.title(&spec.condition, spec.trial);
    recording.title = title.unwrap_or_else(|| name.clone());
    recording.name = name;
    Ok(Played { title: recording.title.clone(), recording, note: Note { text, good } })
}
