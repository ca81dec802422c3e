//! Why something changed, as far as the comparison can tell, and what to do about drift from a lock.

use super::{Comparison, Discrepancy, Extent};
use serde::Serialize;

/// What could explain the differences, from what is cheapest to check.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cause {
    /// An input file has other bytes.
    Inputs,
    /// Another engine ran the trials.
    Engine,
    /// A setting has another value.
    Settings,
    /// The manifest has other bytes.
    Manifest,
    /// Nothing above explains that trials have other bytes: the engine changed unnoticed, or is not deterministic.
    Unexplained,
    /// The trials are the same and nothing above changed, but what is made of them did.
    Derivation,
}

impl Comparison {
    /// Returns what could explain the differences; nothing where there are none.
    pub fn causes(&self) -> Vec<Cause> {
        let any = |is: fn(&Discrepancy) -> bool| self.discrepancies.iter().any(is);
        let asked = [
            (Cause::Inputs, any(|d| matches!(d, Discrepancy::Input { .. }))),
            (Cause::Engine, any(|d| matches!(d, Discrepancy::Engine { .. }))),
            (
                Cause::Settings,
                any(|d| matches!(d, Discrepancy::Setting { .. } | Discrepancy::Condition { .. })),
            ),
        ];
        let mut causes: Vec<Cause> =
            asked.into_iter().filter_map(|(cause, holds)| holds.then_some(cause)).collect();
        let explained = !causes.is_empty();
        if any(|d| matches!(d, Discrepancy::Manifest { .. })) {
            causes.push(Cause::Manifest);
        }
        let broken = any(|d| matches!(d, Discrepancy::Trial(trial) if trial.is_broken()));
        if broken || (self.trials_differ() && !explained) {
            causes.push(Cause::Unexplained);
        }
        if causes.is_empty() && !self.is_same() {
            causes.push(Cause::Derivation);
        }
        causes
    }

    fn trials_differ(&self) -> bool {
        let is_trial =
            |d: &Discrepancy| matches!(d, Discrepancy::Trial(_) | Discrepancy::Records { .. });
        self.discrepancies.iter().any(is_trial)
    }
}

/// Writes the message about a run of `manifest` that drifted from `lock`: what changed, the cheapest cause first, and how
/// to re-bless. `comparison` has the lock on its first side.
pub fn drift(comparison: &Comparison, manifest: &str, lock: &str) -> String {
    let mut text = match comparison.extent {
        Extent::FirstTrials => {
            format!("{manifest} has drifted from {lock} (trial 0 of every condition)\n\n")
        }
        Extent::Conditions => {
            format!("{manifest} has drifted from {lock} (conditions of `--only`)\n\n")
        }
        Extent::Whole => format!("{manifest} has drifted from {lock}\n\n"),
    };
    text.push_str(&comparison.details());
    let causes = comparison.causes();
    for cause in &causes {
        text.push_str(&format!("cause: {}\n", sentence(*cause, comparison, manifest)));
    }
    if !comparison.trials_differ() && causes != [Cause::Derivation] {
        text.push_str(
            "every trial that was run is the same all the same
",
        );
    }
    text.push_str(&format!(
        "If this is meant, write the lock anew with `reenact lock {manifest}` and say why in CHANGELOG.md.\n"
    ));
    text
}

fn sentence(cause: Cause, comparison: &Comparison, manifest: &str) -> String {
    match cause {
        Cause::Inputs => "input files changed".to_owned(),
        Cause::Engine => format!(
            "another engine: the lock is of engine {}, this program has engine {}",
            comparison.a.engine, comparison.b.engine
        ),
        Cause::Settings => {
            "settings changed, by the manifest, by `--set` or by other defaults".to_owned()
        }
        Cause::Manifest => "the manifest's text changed".to_owned(),
        Cause::Unexplained => format!(
            "same inputs, same engine version, same settings, other bytes: either the program changed what a trial \
             yields and its engine version was not raised (docs/determinism.md), or a trial is not deterministic \
             (`reenact run --twice {manifest}` finds out)"
        ),
        Cause::Derivation => {
            "the trials are the same; the program makes other tables, figures or verdicts of them"
                .to_owned()
        }
    }
}
