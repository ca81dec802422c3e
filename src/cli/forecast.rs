//! What a run asks of the machine, foretold before any trial is executed: the size of its bundle, memory, time and disk.
//!
//! It rests on the records that the store has of some of the plan's trials. Where it has none, what can be said of sizes is what no
//! bundle of so many trials goes below, and of time what the manifest lets expect.

use super::exit::Failure;
use super::load;
use super::terminal::counted;
use crate::bundle::{Limits, format};
use crate::plan::Plan;
use crate::runner::StoreError;
use crate::store::{self, Looked};
use crate::studies::inference::InferenceSetup;
use crate::studies::{StudyKind, TrialRecord};
use serde_json::{Value, json};
use std::path::Path;

/// Trials of one condition whose records are looked at.
const LOOKED_AT: usize = 3;
/// Conditions that are looked at.
const CONDITIONS: usize = 200;

/// Bytes of a record's line that every record has: key, outcome, number, one state hash and the names of them.
const LEAST_LINE: u64 = 220;
/// Bytes of a trial's row in `results/trials.csv` that every trial has: key, number and outcome.
const LEAST_ROW: u64 = 70;
/// Bytes of a number in a row.
const CELL: u64 = 12;
/// Bytes of a point of a curve in `results/series.csv`.
const POINT: u64 = 116;
/// Bytes of what a bundle holds beside inputs, records and tables of trials: its description alone has as many.
const REST: u64 = 40_000;

/// Memory (bytes) of the program itself, and of what it holds for each trial and for each of a trial's measures. Measured with
/// `wander` at ten thousand to a million trials (docs/performance.md).
const PROGRAM: u64 = 30 << 20;
const TRIAL: u64 = 190;
const MEASURE: u64 = 24;
/// Records that are in memory at a time, and how many bytes each takes for a byte of its line.
const AT_ONCE: u64 = 8192;
const UNFOLDED: u64 = 6;

/// What is known of a trial's record, on average.
#[derive(Debug, Clone, Copy, Default)]
struct Mean {
    line: f64,
    points: f64,
    measures: f64,
    sim_s: f64,
    records: usize,
}

impl Mean {
    fn add(&mut self, record: &TrialRecord) {
        self.records += 1;
        let weight = 1.0 / real(self.records as u64);
        let mix = |mean: &mut f64, value: usize| *mean += (real(value as u64) - *mean) * weight;
        mix(&mut self.line, record.to_line().len() + 1);
        mix(&mut self.points, record.series.len());
        mix(&mut self.measures, record.measures.len());
        self.sim_s += (record.sim_seconds - self.sim_s) * weight;
    }
}

/// What a run is expected to come to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Forecast {
    trials: u64,
    /// Records that it rests on; without any it is what nothing goes below.
    records: usize,
    /// Bytes of all files of the bundle.
    bundle: u64,
    /// Files of the bundle.
    files: u64,
    /// Bytes of memory at most.
    memory: u64,
    /// Simulated time of all trials (s).
    sim_s: f64,
    /// Simulated seconds for a second of one processor; `None` where trials are proposals of an inference, whose time is not that of
    /// what they simulate.
    pace: Option<f64>,
}

impl Forecast {
    /// Foretells the run of `plan` by what `store` has of it.
    pub(super) fn of(plan: &Plan, store: Option<&Looked<'_>>) -> Result<Self, StoreError> {
        let mut all = Mean::default();
        let mut conditions: Vec<(u64, Mean, f64)> = Vec::new();
        for (i, trials) in plan.trials.chunk_by(|a, b| a.condition == b.condition).enumerate() {
            let mut mean = Mean::default();
            for spec in trials.iter().take(LOOKED_AT).filter(|_| i < CONDITIONS) {
                if let Some(record) = store.map_or(Ok(None), |store| store.get(&spec.key))? {
                    mean.add(&record);
                    all.add(&record);
                }
            }
            conditions.push((trials.len() as u64, mean, trials[0].setup.estimated_seconds()));
        }
        let factors: usize = plan.experiment.factors.iter().map(|f| f.name.len() + 12).sum();
        let has_series = plan.experiment.kind.has_series();
        let (mut forecast, mut measures) = (Self::nothing(plan.experiment.kind), 0.0);
        for (trials, mean, expected_s) in conditions {
            let sim_s = if mean.records > 0 { mean.sim_s } else { expected_s };
            let mean = if mean.records > 0 { mean } else { all };
            let line = if mean.records > 0 { mean.line } else { real(LEAST_LINE + factors as u64) };
            let row = real(LEAST_ROW + factors as u64 / 2) + mean.measures * real(CELL);
            let curve = if has_series { mean.points * real(POINT) } else { 0.0 };
            let lines = whole(real(trials) * line);
            forecast.trials += trials;
            forecast.bundle += lines + whole(real(trials) * (row + curve));
            forecast.files += 1 + lines / format::PART;
            forecast.sim_s += real(trials) * sim_s;
            measures += real(trials) * mean.measures;
            let at_once = real(trials.min(AT_ONCE) * UNFOLDED) * line;
            forecast.memory = forecast.memory.max(PROGRAM + whole(at_once));
            if has_series {
                // Figures and tables are drawn from the curves: these stay in memory.
                forecast.memory += whole(real(trials) * mean.points * 24.0);
            }
        }
        forecast.bundle +=
            plan.experiment.inputs.iter().map(|input| input.bytes.len() as u64).sum::<u64>();
        forecast.memory += forecast.trials * TRIAL + whole(measures * real(MEASURE));
        forecast.records = all.records;
        if plan.trials.iter().any(|spec| spec.setup.of::<InferenceSetup>().is_some()) {
            forecast.pace = None;
        }
        Ok(forecast)
    }

    fn nothing(kind: StudyKind) -> Self {
        let (bundle, memory, pace) = (REST, PROGRAM, Some(kind.pace()));
        Self { trials: 0, records: 0, bundle, files: 30, memory, sim_s: 0.0, pace }
    }

    /// Returns how long all trials take one processor (h), where that can be said.
    fn core_hours(&self) -> Option<f64> {
        self.pace.map(|pace| self.sim_s / pace / 3600.0)
    }

    /// Says how long so many of the trials take on so many processors, where that can be said: `about 40 s on 2 processors`.
    pub(super) fn time_of(&self, trials: usize, processors: usize) -> Option<String> {
        let share = real(trials as u64) / real(self.trials.max(1));
        let seconds = self.core_hours()? * 3600.0 * share / real(processors.max(1) as u64);
        let time = match seconds {
            ..=90.0 => format!("{} s", seconds.ceil()),
            ..=5400.0 => format!("{:.0} min", seconds / 60.0),
            _ => format!("{:.1} h", seconds / 3600.0),
        };
        Some(format!("about {time} on {}", counted(processors, "processor")))
    }

    /// Says it in a line.
    pub(super) fn in_words(&self) -> String {
        let (bundle, memory) = (in_bytes(self.bundle), in_bytes(self.memory));
        let time = match self.core_hours() {
            None => "how long an inference takes is not foretold".to_owned(),
            Some(hours) if hours < 0.01 => "less than 0.01 core hours in all".to_owned(),
            Some(hours) => format!("some {hours:.2} core hours in all"),
        };
        if self.records == 0 {
            return format!(
                "bundle: at least {bundle} unpacked; memory: at least {memory}; {time} (by the manifest: no record of this plan is in \
                 the store; `reenact run --trials 1` puts one of each condition there)\n"
            );
        }
        format!(
            "bundle: about {bundle} unpacked; memory: about {memory}; {time} (by {} in the store)\n",
            counted(self.records, "record")
        )
    }

    /// Says it for programs: sizes in bytes, time in hours of one processor.
    pub(super) fn to_json(self) -> Value {
        json!({
            "records": self.records,
            "bundle_bytes": self.bundle,
            "memory_bytes": self.memory,
            "core_hours": self.core_hours(),
        })
    }

    /// Refuses a run whose bundle could not be sealed: by `limits`, or because `out` has no room for it.
    pub(super) fn admits(&self, limits: &Limits, out: &Path) -> Result<(), Failure> {
        let by = match self.records {
            0 => "at least".to_owned(),
            records => format!("about (by {} in the store)", counted(records, "record")),
        };
        let refused = |holds: String, expected: String, remedy: &str| {
            Err(Failure::not_understood(format!(
                "error: nothing was run: the bundle of {} would hold {by} {holds}: expected {expected}; {remedy}\n",
                counted(usize::try_from(self.trials).unwrap_or(usize::MAX), "trial")
            )))
        };
        if self.files > limits.entries as u64 {
            let expected = format!("at most {}, so that anyone can check it", limits.entries);
            return refused(format!("{} files", self.files), expected, PARTS);
        }
        if self.bundle > limits.bytes {
            let expected =
                format!("at most {}, so that anyone can check it", in_bytes(limits.bytes));
            let remedy = "run fewer trials (--trials), run the study in parts (--only), or allow it more with --max-size, as \
                          whoever checks it must too";
            return refused(format!("{} unpacked", in_bytes(self.bundle)), expected, remedy);
        }
        // The lines as they are, and the archive: a quarter of them, as a rule.
        let needed = self.bundle + self.bundle / 4;
        match store::room(out) {
            Some(room) if room < needed => {
                let expected = format!(
                    "{} free in `{}`, found {}",
                    in_bytes(needed),
                    load::shown(out),
                    in_bytes(room)
                );
                let remedy = "free some space, or choose another folder with --out";
                refused(format!("{} unpacked", in_bytes(self.bundle)), expected, remedy)
            }
            _ => Ok(()),
        }
    }

    /// Returns whether it is worth telling whoever only wanted to run.
    pub(super) fn is_large(&self) -> bool {
        self.trials > AT_ONCE
    }
}

/// What to do where a bundle would have too many files.
const PARTS: &str = "run the study in parts (--only)";

/// Writes a number of bytes as exactly as it deserves: `62 kB`, `4.1 MB`, `31 MB`, `5.1 GB`.
fn in_bytes(bytes: u64) -> String {
    let (kilo, mega, giga) = (real(bytes) / 1e3, real(bytes) / 1e6, real(bytes) / 1e9);
    match bytes {
        0..1_000_000 => format!("{kilo:.0} kB"),
        1_000_000..10_000_000 => format!("{mega:.1} MB"),
        10_000_000..1_000_000_000 => format!("{mega:.0} MB"),
        _ => format!("{giga:.1} GB"),
    }
}

#[expect(clippy::cast_precision_loss, reason = "an estimate")]
fn real(n: u64) -> f64 {
    n as f64
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "not negative, saturating"
)]
fn whole(x: f64) -> u64 {
    x.round() as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn large(trials: u64) -> Forecast {
        let nothing = Forecast::nothing(StudyKind::named("wander").unwrap());
        Forecast { trials, bundle: REST + 410 * trials, sim_s: 1.5 * real(trials), ..nothing }
    }

    #[test]
    fn sizes_are_as_exact_as_they_deserve() {
        let bytes = [0, 449_999, 4_100_000, 12_345_678, 999_000_000, 5_100_000_000];
        let words = ["0 kB", "450 kB", "4.1 MB", "12 MB", "999 MB", "5.1 GB"];
        assert_eq!(bytes.map(in_bytes), words);
    }

    #[test]
    fn what_could_not_be_sealed_is_refused_with_what_to_do() {
        let limits = Limits::default();
        let out = std::env::temp_dir();
        assert!(large(1000).admits(&limits, &out).is_ok());
        let refusal = |forecast: Forecast| forecast.admits(&limits, &out).unwrap_err();
        let too_large = refusal(large(20_000_000));
        assert_eq!(too_large.exit.code(), 2);
        assert_eq!(
            too_large.message,
            "error: nothing was run: the bundle of 20000000 trials would hold at least 8.2 GB unpacked: expected at most 4.3 GB, \
             so that anyone can check it; run fewer trials (--trials), run the study in parts (--only), or allow it more with \
             --max-size, as whoever checks it must too\n"
        );
        let many_files = refusal(Forecast { files: 20_001, records: 1, ..large(1) });
        assert_eq!(
            many_files.message,
            "error: nothing was run: the bundle of 1 trial would hold about (by 1 record in the store) 20001 files: expected at \
             most 20000, so that anyone can check it; run the study in parts (--only)\n"
        );
        let all = Limits { bytes: u64::MAX, ..limits };
        let no_room = Forecast { bundle: 1 << 60, ..large(1) }.admits(&all, &out);
        assert_eq!(no_room.is_err(), store::room(&out).is_some(), "an exabyte");
    }

    #[test]
    fn words_say_what_they_rest_on() {
        assert_eq!(
            large(1_000_000).in_words(),
            "bundle: at least 410 MB unpacked; memory: at least 31 MB; some 0.08 core hours in all (by the manifest: no record of \
             this plan is in the store; `reenact run --trials 1` puts one of each condition there)\n"
        );
        assert_eq!(
            Forecast { records: 6, ..large(1_000_000) }.in_words(),
            "bundle: about 410 MB unpacked; memory: about 31 MB; some 0.08 core hours in all (by 6 records in the store)\n"
        );
    }

    #[test]
    fn times_are_those_of_the_trials_and_processors_at_hand() {
        let forecast = large(1_000_000);
        let told =
            |forecast: Forecast, trials, processors| forecast.time_of(trials, processors).unwrap();
        assert_eq!(told(forecast, 1_000_000, 2), "about 2 min on 2 processors");
        assert_eq!(told(forecast, 1000, 1), "about 1 s on 1 processor");
        let slow = Forecast { pace: Some(400.0), ..large(10_000_000) };
        assert_eq!(told(slow, 10_000_000, 4), "about 2.6 h on 4 processors");
        let proposals = Forecast { pace: None, records: 1, ..large(81) };
        assert_eq!(proposals.time_of(81, 2), None);
        let words = "; how long an inference takes is not foretold (by 1 record in the store)\n";
        assert!(proposals.in_words().ends_with(words), "{}", proposals.in_words());
    }
}
