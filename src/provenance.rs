//! Clock, host and environment: the only user of all three.

mod array_task;

pub use array_task::{ArrayTask, ArrayTaskError};

use crate::bundle::wall_time::WallTime;
use crate::bundle::{Circumstance, Moment, format};
use crate::studies::Stopwatch;
use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::OnceLock;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};
use thiserror::Error;

/// Why the environment cannot be followed.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum EnvironmentError {
    /// `SOURCE_DATE_EPOCH` is no number of seconds.
    #[error("SOURCE_DATE_EPOCH: expected whole seconds since 1970-01-01, found `{0}`")]
    SourceDateEpoch(String),
    /// Nothing says where the store should be.
    #[error(
        "trial store: expected REENACT_STORE, XDG_CACHE_HOME or HOME to say where it is, found none of them set"
    )]
    NoStore,
    /// `REENACT_PROGRESS` names no form of progress.
    #[error(
        "REENACT_PROGRESS: expected `json`, found `{0}`; unset it for progress that people read"
    )]
    Progress(String),
    /// A path is no Unicode text, which no line of a log or a result could show.
    #[error("{0}: expected a path in UTF-8, found `{1}`, which is none")]
    NotUnicode(&'static str, String),
}

/// What the environment asks of the program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Environment {
    /// The instant that stands for now in everything sealed, if one is given.
    pub source_date_epoch: Option<Moment>,
    /// Where the trial store is: `REENACT_STORE`, else `$XDG_CACHE_HOME/reenact`, else `$HOME/.cache/reenact`.
    pub store: Result<PathBuf, EnvironmentError>,
    /// Whether colours are unwanted (`NO_COLOR` set and not empty).
    pub no_color: bool,
    /// Whether the locale says that the terminal reads UTF-8 (`LC_ALL`, else `LC_CTYPE`, else `LANG`).
    pub utf8: bool,
    /// Whether a program reads stderr, which wants progress as lines of JSON (`REENACT_PROGRESS=json`).
    pub progress_as_json: bool,
    /// Where the original worlds of the studies are, for the tests that compare with them.
    pub original_worlds: Option<PathBuf>,
    /// Which task of an array job this is, if it is one; what cannot be matters only to whoever asks for it.
    pub array_task: Result<Option<ArrayTask>, ArrayTaskError>,
}

impl Environment {
    /// Reads the process's environment.
    ///
    /// # Errors
    /// Where `SOURCE_DATE_EPOCH` is not a number, or `REENACT_PROGRESS` something else than `json`.
    pub fn read() -> Result<Self, EnvironmentError> {
        #[expect(clippy::disallowed_methods, reason = "this is the door to the environment")]
        Self::from_lookup(|name| std::env::var_os(name))
    }

    /// Reads an environment given as a function; empty values count as unset, as the XDG specification says.
    ///
    /// # Errors
    /// Where `SOURCE_DATE_EPOCH` is not a number, or `REENACT_PROGRESS` something else than `json`.
    pub fn from_lookup(
        lookup: impl Fn(&str) -> Option<OsString>,
    ) -> Result<Self, EnvironmentError> {
        let written = |name: &str| lookup(name).filter(|value| !value.is_empty());
        let lookup = |name: &str| written(name).map(|value| value.to_string_lossy().into_owned());
        let path = |name: &'static str| -> Option<Result<PathBuf, EnvironmentError>> {
            written(name).map(|value| {
                value.into_string().map(PathBuf::from).map_err(|value| {
                    EnvironmentError::NotUnicode(name, value.to_string_lossy().into_owned())
                })
            })
        };
        let source_date_epoch = lookup("SOURCE_DATE_EPOCH")
            .map(|text| {
                let seconds = text.parse().ok().filter(|s| (0..253_402_300_800).contains(s));
                seconds.map(Moment).ok_or(EnvironmentError::SourceDateEpoch(text))
            })
            .transpose()?;
        let progress_as_json = match lookup("REENACT_PROGRESS").as_deref() {
            None => false,
            Some("json") => true,
            Some(other) => return Err(EnvironmentError::Progress(other.to_owned())),
        };
        // Relative XDG paths are invalid and to be ignored.
        let cache = path("XDG_CACHE_HOME")
            .filter(|path| path.as_ref().map_or(true, |path| path.is_absolute()));
        let below = |path: Result<PathBuf, _>, folder: &str| path.map(|path| path.join(folder));
        Ok(Self {
            source_date_epoch,
            store: path("REENACT_STORE")
                .or_else(|| cache.map(|cache| below(cache, "reenact")))
                .or_else(|| path("HOME").map(|home| below(home, ".cache/reenact")))
                .unwrap_or(Err(EnvironmentError::NoStore)),
            no_color: lookup("NO_COLOR").is_some(),
            utf8: ["LC_ALL", "LC_CTYPE", "LANG"].into_iter().find_map(&lookup).is_some_and(
                |locale| {
                    let locale = locale.to_ascii_lowercase();
                    locale.contains("utf-8") || locale.contains("utf8")
                },
            ),
            progress_as_json,
            original_worlds: path("REENACT_ORIGINAL_WORLDS").and_then(Result::ok),
            array_task: ArrayTask::from_lookup(lookup),
        })
    }

    /// Returns where the trial store is.
    ///
    /// # Errors
    /// Where nothing says so, or not in UTF-8.
    pub fn store(&self) -> Result<&PathBuf, EnvironmentError> {
        self.store.as_ref().map_err(Clone::clone)
    }
}

/// A run's beginning: what its circumstances are told from.
#[derive(Debug, Clone, Copy)]
pub struct RunClock {
    started: Moment,
    instant: Instant,
}

impl RunClock {
    /// Starts the clock.
    #[expect(clippy::disallowed_methods, reason = "this is the door to the clock")]
    pub fn start() -> Self {
        Self { started: now(), instant: Instant::now() }
    }

    /// Returns the seconds since the start, whatever the calendar did meanwhile.
    pub fn elapsed_seconds(&self) -> f64 {
        self.instant.elapsed().as_secs_f64()
    }

    /// Returns what the clock shows now, whatever `SOURCE_DATE_EPOCH` says: by this it is judged whether a key is still
    /// valid. A clock that is set back while the program runs makes no key younger.
    pub fn now(&self) -> Moment {
        let elapsed = i64::try_from(self.instant.elapsed().as_secs()).unwrap_or(i64::MAX);
        Moment(self.started.0.saturating_add(elapsed))
    }

    /// Returns the circumstances of a run that ends now with `jobs` threads; under `SOURCE_DATE_EPOCH` nothing but that
    /// instant.
    pub fn circumstance(&self, environment: &Environment, jobs: usize) -> Circumstance {
        if let Some(epoch) = environment.source_date_epoch {
            return Circumstance::reproducible(epoch);
        }
        let mut facts = host();
        facts.push(("jobs".to_owned(), jobs.to_string()));
        Circumstance {
            version: format::VERSION.to_owned(),
            started: self.started,
            // Not the calendar's end: a clock that was set back must not end a run before it began.
            ended: self.now(),
            environment: facts,
            files: Vec::new(),
        }
    }
}

/// Times one trial and every choice of its mind.
#[derive(Debug)]
pub struct TrialWatch {
    began: Instant,
    asked: Instant,
    selections_s: Vec<f64>,
}

impl TrialWatch {
    /// Starts the watch: the trial begins.
    #[expect(clippy::disallowed_methods, reason = "this is the door to the clock")]
    pub fn start() -> Self {
        let began = Instant::now();
        Self { began, asked: began, selections_s: Vec::new() }
    }

    /// Stops the watch: the trial has ended.
    pub fn stop(self) -> WallTime {
        WallTime { trial_s: self.began.elapsed().as_secs_f64(), selections_s: self.selections_s }
    }
}

impl Stopwatch for TrialWatch {
    #[expect(clippy::disallowed_methods, reason = "this is the door to the clock")]
    fn asked(&mut self) {
        self.asked = Instant::now();
    }

    fn chose(&mut self) {
        self.selections_s.push(self.asked.elapsed().as_secs_f64());
    }
}

/// Returns the present moment; a clock before 1970 reads as 1970.
#[expect(clippy::disallowed_methods, reason = "this is the door to the clock")]
fn now() -> Moment {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs());
    Moment(i64::try_from(seconds).unwrap_or(0))
}

/// Returns how long ago `moment` was by this machine's clock; none where it is yet to come.
pub fn age(moment: SystemTime) -> Duration {
    moment.elapsed().unwrap_or_default()
}

/// Returns a name for the running kernel, the same from its start until its end; none where it gives itself none. The
/// name does not reveal who owns the machine.
pub fn kernel() -> Option<String> {
    let id = std::fs::read_to_string("/proc/sys/kernel/random/boot_id").ok()?;
    id.get(..8).filter(|id| id.bytes().all(|b| b.is_ascii_hexdigit())).map(str::to_owned)
}

/// What is typed to start this program, where that is not the executable of this process.
static PROGRAM: OnceLock<PathBuf> = OnceLock::new();

/// Says that `program` starts what runs in this process: a script, where the process is that of an interpreter. The first
/// that says so is believed.
pub fn started_by(program: PathBuf) {
    let _ = PROGRAM.set(program);
}

/// Returns where this program is.
///
/// # Errors
/// Where the system does not say.
pub fn program() -> std::io::Result<PathBuf> {
    match PROGRAM.get() {
        Some(program) => std::path::absolute(program),
        None => std::env::current_exe(),
    }
}

/// Lists facts about the host that matter and do not reveal who owns it: no names of users, hosts or folders.
pub fn host() -> Vec<(String, String)> {
    let mut facts = vec![
        ("os".to_owned(), std::env::consts::OS.to_owned()),
        ("architecture".to_owned(), std::env::consts::ARCH.to_owned()),
        ("build".to_owned(), if cfg!(debug_assertions) { "debug" } else { "release" }.to_owned()),
    ];
    facts.push(("processors".to_owned(), processors().to_string()));
    facts
}

/// Returns how many threads are started at once at most, whatever `--jobs` asks for: more of them only wait for one
/// another.
pub fn most_jobs() -> usize {
    (4 * processors()).max(64)
}

/// Returns how many processors are at our disposal: the default of `--jobs`.
pub fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

/// Draws a seed nobody could foresee, for the reviewer's sample where none is given.
pub fn unforeseen_seed() -> u64 {
    use std::hash::{BuildHasher as _, Hasher as _};
    // The standard library keys its hashers from the system's randomness.
    std::hash::RandomState::new().build_hasher().finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn environment(pairs: &[(&str, &str)]) -> Result<Environment, EnvironmentError> {
        Environment::from_lookup(|name| {
            pairs.iter().find(|(key, _)| *key == name).map(|(_, value)| (*value).into())
        })
    }

    #[test]
    fn the_store_is_where_the_nearest_variable_says() {
        let store = |pairs: &[(&str, &str)]| environment(pairs).unwrap().store;
        let all = [("REENACT_STORE", "/r"), ("XDG_CACHE_HOME", "/x"), ("HOME", "/h")];
        assert_eq!(store(&all), Ok("/r".into()));
        assert_eq!(store(&all[1..]), Ok("/x/reenact".into()));
        assert_eq!(store(&all[2..]), Ok("/h/.cache/reenact".into()));
        assert_eq!(
            store(&[("XDG_CACHE_HOME", "relative"), ("HOME", "/h")]),
            Ok("/h/.cache/reenact".into())
        );
        assert_eq!(
            environment(&[("HOME", "")]).unwrap().store().unwrap_err().to_string(),
            "trial store: expected REENACT_STORE, XDG_CACHE_HOME or HOME to say where it is, found none of them set"
        );
    }

    #[cfg(unix)]
    #[test]
    fn a_store_that_no_text_can_name_is_told_and_not_passed_over() {
        use std::os::unix::ffi::OsStringExt as _;
        let environment = Environment::from_lookup(|name| match name {
            "REENACT_STORE" => Some(OsString::from_vec(b"/tmp/st\xffre".to_vec())),
            "HOME" => Some("/h".into()),
            _ => None,
        });
        assert_eq!(
            environment.unwrap().store().unwrap_err().to_string(),
            "REENACT_STORE: expected a path in UTF-8, found `/tmp/st\u{fffd}re`, which is none"
        );
    }

    #[test]
    fn progress_is_for_people_unless_a_program_asks_for_it() {
        let asked = |value| environment(&[("REENACT_PROGRESS", value)]).map(|e| e.progress_as_json);
        assert_eq!([asked(""), asked("json")], [Ok(false), Ok(true)]);
        assert_eq!(
            asked("yes").unwrap_err().to_string(),
            "REENACT_PROGRESS: expected `json`, found `yes`; unset it for progress that people read"
        );
    }

    #[test]
    fn source_date_epoch_replaces_every_circumstance() {
        let pinned =
            environment(&[("SOURCE_DATE_EPOCH", "1768478400"), ("NO_COLOR", "1")]).unwrap();
        assert!(pinned.no_color);
        let circumstance = RunClock::start().circumstance(&pinned, 8);
        assert_eq!(circumstance, Circumstance::reproducible(Moment(1_768_478_400)));
        assert!(RunClock::start().now() > Moment(1_768_478_400), "the clock goes on");
        for bad in ["tomorrow", "-1", "1e9"] {
            let error = environment(&[("SOURCE_DATE_EPOCH", bad)]).unwrap_err();
            assert_eq!(
                error.to_string(),
                format!(
                    "SOURCE_DATE_EPOCH: expected whole seconds since 1970-01-01, found `{bad}`"
                )
            );
        }
    }

    #[test]
    fn a_watch_counts_choices_and_no_other_commands() {
        let mut watch = TrialWatch::start();
        watch.asked();
        watch.asked();
        watch.chose();
        let time = watch.stop();
        assert_eq!(time.selections_s.len(), 1);
        assert!((0.0..=time.trial_s).contains(&time.selections_s[0]), "{time:?}");
    }

    #[test]
    fn a_run_ends_after_it_began_and_names_nobody() {
        let circumstance = RunClock::start().circumstance(&environment(&[]).unwrap(), 3);
        assert!(
            circumstance.started <= circumstance.ended
                && circumstance.started > Moment(1_700_000_000)
        );
        let names: Vec<_> =
            circumstance.environment.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["os", "architecture", "build", "processors", "jobs"]);
        assert_ne!(unforeseen_seed(), unforeseen_seed());
    }
}
