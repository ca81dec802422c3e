//! The evaluator's part of a page: which badge asks for what, the commands for this very bundle, and how long they take.
//!
//! Badges are those of ACM's "Artifact Review and Badging", version 1.1; levels are the rungs of `verify`'s ladder.

use crate::bundle::Circumstance;
use serde::Serialize;

/// Trials that level 4 draws where nothing else is said.
const SAMPLE: u64 = 59;

/// Simulated seconds per second and processor that are assumed where a bundle does not tell: what `plan` assumes too.
const RATE: f64 = 300.0;

/// What an evaluator does with one bundle.
#[derive(Debug, Clone, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Evaluation {
    /// Where the expected times come from.
    pub basis: String,
    /// The badges, from the least to the most demanding.
    pub badges: Vec<Badge>,
}

/// One badge.
#[derive(Debug, Clone, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Badge {
    /// Identifier: `functional`.
    pub id: String,
    /// Its name: `Artifacts Evaluated: Functional`.
    pub name: String,
    /// What it certifies.
    pub asks: String,
    /// What to tick, one sentence each.
    pub checks: Vec<String>,
    /// What to run.
    pub commands: Vec<Command>,
}

/// A command line to copy.
#[derive(Debug, Clone, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Command {
    /// What it does, as an imperative: `check every checksum and re-derive the tables`.
    pub purpose: String,
    /// The line itself.
    pub line: String,
    /// How long it takes: `about 3 min`.
    pub time: String,
}

/// The bundle that is evaluated.
#[derive(Debug, Clone, Copy)]
pub(super) struct Evaluated<'a> {
    /// Its file name.
    pub(super) file: &'a str,
    /// A trial of it, as `replay` takes it.
    pub(super) trial: &'a str,
    /// Its trials.
    pub(super) trials: u64,
    /// Simulated time of all of them (s).
    pub(super) sim_seconds: f64,
    /// Whether it holds a part of its study only, of which level 6 judges nothing.
    pub(super) partial: bool,
    /// Whether claims were judged.
    pub(super) judged: bool,
    /// The circumstances of the run, where they are told.
    pub(super) circumstance: Option<&'a Circumstance>,
}

/// Returns the evaluator's part for `of`.
pub(super) fn evaluation(of: Evaluated<'_>) -> Evaluation {
    let (seconds, basis) = whole_study(of);
    let file = of.file;
    let sampled = SAMPLE.min(of.trials.max(1));
    #[expect(clippy::cast_precision_loss, reason = "an estimate")]
    let sample_seconds = seconds * sampled as f64 / of.trials.max(1) as f64;
    let command = |purpose: &str, line: String, time: String| Command {
        purpose: purpose.to_owned(),
        line,
        time,
    };
    let badge = |id: &str, name: &str, asks: &str, checks: &[&str], commands| Badge {
        id: id.to_owned(),
        name: name.to_owned(),
        asks: asks.to_owned(),
        checks: checks.iter().map(|check| (*check).to_owned()).collect(),
        commands,
    };
    let again = "The trials are executed with the same program and the same seeds; run it on a machine of your own.";
    let fresh = if of.partial {
        Vec::new()
    } else {
        let purpose = if of.judged {
            "run the whole study again with fresh seeds, and judge every claim anew (level 6)"
        } else {
            "run the whole study again with fresh seeds (level 6); no claim is judged, so that means and shares are compared"
        };
        let line = format!("reenact verify --level 6 {file}");
        vec![command(purpose, line, in_words(2.0 * seconds))]
    };
    let verdicts = if of.partial {
        "Level 6 asks whether verdicts hold with fresh seeds; this bundle holds a part of its study, and nothing is judged by a \
         part."
    } else {
        "Level 6 holds: the verdicts are not those of one lucky seed. It uses the same program and worlds, so that it is \
         necessary for this badge and not sufficient."
    };
    let badges = vec![
        badge(
            "available",
            "Artifacts Available",
            "The artifact lies in a public archive that will keep it, under an identifier of its own.",
            &[
                "The bundle has a DOI (Zenodo, figshare, an institution's archive), not only a link.",
                "The results digest printed in the paper is the one on this page.",
            ],
            vec![command(
                "check that the archive is safe and that nothing changed since it was sealed (level 1)",
                format!("reenact verify --level 1 {file}"),
                "under a second".to_owned(),
            )],
        ),
        badge(
            "functional",
            "Artifacts Evaluated: Functional",
            "The artifact is documented, consistent, complete and can be exercised.",
            &[
                "Documented: this page and the bundle's README say what was run and what the numbers do not show.",
                "Consistent and complete: level 3 holds; every table, figure and verdict follows from the trial records.",
                "Exercisable: trials drawn with your own seed give the same bytes again (level 4).",
            ],
            vec![
                command(
                    "check every file and derive every table, figure and verdict anew (level 3)",
                    format!("reenact verify {file}"),
                    "seconds".to_owned(),
                ),
                command(
                    &format!(
                        "execute {sampled} trials again, drawn with a seed of yours (level 4)"
                    ),
                    format!("reenact verify --level 4 --sample {sampled} --sample-seed 1 {file}"),
                    in_words(sample_seconds),
                ),
            ],
        ),
        badge(
            "reusable",
            "Artifacts Evaluated: Reusable",
            "The artifact is so well documented and structured that others can build on it.",
            &[
                "Manifest, robots, worlds and published numbers lie open in the bundle, each with its licence.",
                "Every choice that the paper leaves open has a reason on this page.",
                "Any trial can be looked at, step by step.",
            ],
            vec![
                command(
                    "look at one trial as it happened",
                    format!("reenact replay {file} {} --html trial.html", of.trial),
                    "seconds".to_owned(),
                ),
                command(
                    "unpack everything to read it or to build on it",
                    format!("reenact export {file} --dir --out unpacked"),
                    "under a second".to_owned(),
                ),
            ],
        ),
        badge(
            "reproduced",
            "Results Reproduced",
            "Another team obtained the main results with the authors' artifacts.",
            &[again, "Level 5 holds: every record, table and verdict is the same, bit for bit."],
            vec![command(
                "execute every trial again (level 5)",
                format!("reenact verify --level 5 {file}"),
                in_words(seconds),
            )],
        ),
        badge(
            "replicated",
            "Results Replicated",
            "Another team obtained the main results without the authors' artifacts.",
            &[verdicts, "The claims hold in an implementation, simulator or building of your own."],
            fresh,
        ),
    ];
    Evaluation { basis, badges }
}

/// Returns how long it takes to execute every trial (s), and how that is known.
fn whole_study(of: Evaluated<'_>) -> (f64, String) {
    if let Some((seconds, jobs)) = of.circumstance.and_then(|told| recorded(told, of.trials)) {
        let basis = format!(
            "Expected times are those of the recorded run, which took {} with {jobs} threads for {} trials.",
            in_words(seconds),
            of.trials
        );
        return (seconds, basis);
    }
    let seconds = of.sim_seconds / (2.0 * RATE);
    let basis = format!(
        "The bundle does not tell how long its trials took. Expected times are for two processors that simulate {RATE} times \
         faster than real time each; yours may well do several times that or, with a particle filter, a third of it."
    );
    (seconds, basis)
}

/// Returns the wall time (s) of a run that executed all `trials` itself, and its threads; `None` where it took some
/// from a store, or does not say.
fn recorded(told: &Circumstance, trials: u64) -> Option<(f64, u64)> {
    let fact = |name: &str| {
        let (_, value) = told.environment.iter().find(|(known, _)| known == name)?;
        value.parse::<u64>().ok()
    };
    let seconds = u32::try_from(told.ended.0 - told.started.0).ok()?;
    let all = fact(crate::bundle::format::SIMULATED_TRIALS)? == trials;
    all.then_some((f64::from(seconds).max(1.0), fact("jobs")?))
}

/// Writes a duration as `about 40 s`, `about 3 min`, `about 2 h`.
fn in_words(seconds: f64) -> String {
    let (amount, unit) = match seconds {
        s if s < 5.0 => return "a few seconds".to_owned(),
        s if s < 90.0 => (s, "s"),
        s if s < 5400.0 => (s / 60.0, "min"),
        s => (s / 3600.0, "h"),
    };
    format!("about {}\u{a0}{unit}", amount.ceil())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bundle::Moment;

    fn circumstance(simulated: &str) -> Circumstance {
        let facts = [("jobs", "2"), (crate::bundle::format::SIMULATED_TRIALS, simulated)];
        let environment = facts.map(|(name, value)| (name.to_owned(), value.to_owned())).to_vec();
        Circumstance {
            ended: Moment(1180),
            environment,
            ..Circumstance::reproducible(Moment(1000))
        }
    }

    fn of(circumstance: Option<&Circumstance>) -> Evaluation {
        evaluation(Evaluated {
            file: "a-12345678.zip",
            trial: "none/0",
            trials: 118,
            sim_seconds: 36_000.0,
            partial: false,
            judged: true,
            circumstance,
        })
    }

    fn times(evaluation: &Evaluation) -> Vec<&str> {
        evaluation.badges.iter().flat_map(|b| &b.commands).map(|c| c.time.as_str()).collect()
    }

    #[test]
    fn times_are_scaled_from_a_run_that_executed_everything() {
        let told = of(Some(&circumstance("118")));
        assert_eq!(
            told.basis,
            "Expected times are those of the recorded run, which took about 3\u{a0}min with 2 threads for 118 trials."
        );
        let expected = [
            "under a second",
            "seconds",
            "about 2\u{a0}min",
            "seconds",
            "under a second",
            "about 3\u{a0}min",
            "about 6\u{a0}min",
        ];
        assert_eq!(times(&told), expected);
        let lines = told.badges.iter().flat_map(|b| &b.commands).map(|c| c.line.as_str());
        assert!(lines.clone().all(|line| line.contains("a-12345678.zip")));
        assert!(lines.into_iter().any(|line| line.contains("--sample 59")));
    }

    #[test]
    fn a_run_that_took_trials_from_a_store_tells_nothing_about_time() {
        for told in [None, Some(&circumstance("17")), Some(&Circumstance::reproducible(Moment(0)))]
        {
            let told = of(told);
            assert!(told.basis.starts_with("The bundle does not tell"));
            assert_eq!(times(&told)[5], "about 60\u{a0}s", "36000 s at 600");
        }
    }

    #[test]
    fn spans_are_said_in_one_unit() {
        assert_eq!(
            [3.0, 40.0, 100.0, 9000.0].map(in_words),
            ["a few seconds", "about 40\u{a0}s", "about 2\u{a0}min", "about 3\u{a0}h"]
        );
    }
}
