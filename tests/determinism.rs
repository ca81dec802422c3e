//! The determinism contract, as far as one machine can test it quickly: how a study is run leaves no mark on its results.
//!
//! `.ci/determinism.sh` compares compilers' settings, instruction sets and architectures.

use crate::sandbox::{Answer, PINNED, Sandbox, TINY};
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::LazyLock;
use std::thread;
use std::time::{Duration, Instant};

/// Creates a folder with a study of two trials with and two without a floor plan, each to its end.
fn place() -> Sandbox {
    let (study, _) = TINY.split_once("parameters:").unwrap();
    Sandbox::new().with_study(&study.replace("trials: 3", "trials: 2"))
}

/// Returns the command of a run of the study.
fn run(place: &Sandbox, more: &[&str]) -> Command {
    place.command(&[&["run", "tiny.yaml", "--format", "json"], more].concat())
}

/// Counts the records in the store.
fn stored(place: &Sandbox) -> usize {
    place.records("store").len()
}

/// What a run said of itself.
struct Told {
    results_digest: String,
    cached: u64,
}

fn finished(command: &mut Command) -> Told {
    let answer = Answer::of(command);
    assert_eq!(answer.code, 0, "{}", answer.stderr);
    let told: serde_json::Value = serde_json::from_str(&answer.stdout).unwrap();
    let results_digest = told["results_digest"].as_str().unwrap().to_owned();
    assert!(results_digest.starts_with("sha256:"), "{results_digest}");
    Told { results_digest, cached: told["cached"].as_u64().unwrap() }
}

/// The digest of an undisturbed run on one thread.
static UNDISTURBED: LazyLock<String> =
    LazyLock::new(|| finished(&mut run(&place(), &["--no-cache", "--jobs", "1"])).results_digest);

#[test]
fn threads_directory_locale_and_time_zone_leave_no_mark() {
    let elsewhere = place();
    let told = finished(
        run(&elsewhere, &["--no-cache", "--jobs", "3"])
            .env("LC_ALL", "tr_TR.UTF-8")
            .env("LANG", "tr_TR.UTF-8")
            .env("TZ", "Asia/Kathmandu"),
    );
    assert_eq!(told.results_digest, *UNDISTURBED);
    assert_eq!(stored(&elsewhere), 0, "`--no-cache` wrote to the store");
}

/// Under `SOURCE_DATE_EPOCH` not only the results but the whole zip is the same, byte for byte.
#[test]
fn source_date_epoch_makes_whole_bundles_equal() {
    let bundle = |command: &mut Command| {
        let answer = Answer::of(command.env("SOURCE_DATE_EPOCH", PINNED));
        assert_eq!(answer.code, 0, "{}", answer.stderr);
        let told: serde_json::Value = serde_json::from_str(&answer.stdout).unwrap();
        let path = PathBuf::from(told["bundle"].as_str().unwrap());
        (path.file_name().unwrap().to_owned(), fs::read(path).unwrap())
    };
    let (here, elsewhere) = (place(), place());
    let first = bundle(&mut run(&here, &["--jobs", "1"]));
    let plain = run(&elsewhere, &["--jobs", "2", "--no-cache", "--out", "deep/in/here"]);
    let mut masked = if cfg!(unix) {
        let mut masked = Command::new("sh");
        elsewhere.dress(&mut masked).args(["-c", "umask 077 && exec \"$0\" \"$@\""]);
        masked.arg(plain.get_program()).args(plain.get_args());
        masked
    } else {
        plain
    };
    let second = bundle(
        masked
            .env("LC_ALL", "tr_TR.UTF-8")
            .env("LANG", "tr_TR.UTF-8")
            .env("TZ", "Asia/Kathmandu")
            .env("USER", "somebody")
            .env("HOSTNAME", "elsewhere"),
    );
    assert_eq!(first.0, second.0);
    assert!(
        first.1 == second.1,
        "two zips of {} and {} bytes differ",
        first.1.len(),
        second.1.len()
    );
}

#[test]
fn another_seed_does_leave_a_mark() {
    let told = finished(&mut run(&place(), &["--no-cache", "--set", "seed=8"]));
    assert_ne!(told.results_digest, *UNDISTURBED);
}

#[test]
fn a_half_filled_store_leaves_no_mark() {
    let place = place();
    // The second condition first, so that the whole study meets its trials in another order.
    let part = finished(&mut run(&place, &["--only", "prior=floor-plan"]));
    assert_ne!(part.results_digest, *UNDISTURBED);
    assert_eq!(stored(&place), 2);
    let whole = finished(&mut run(&place, &["--jobs", "2"]));
    assert_eq!((whole.cached, whole.results_digest), (2, UNDISTURBED.clone()));
}

#[test]
fn a_killed_run_resumes_to_the_same_results() {
    let place = place();
    let mut child =
        run(&place, &["--jobs", "1"]).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let patience = Duration::from_secs(120);
    #[expect(clippy::disallowed_methods, reason = "a test's patience is wall time")]
    let began = Instant::now();
    while stored(&place) == 0 {
        assert!(began.elapsed() < patience, "no trial was stored within {patience:?}");
        assert_eq!(child.try_wait().unwrap(), None, "the run ended without storing a trial");
        thread::sleep(Duration::from_millis(2));
    }
    child.kill().unwrap(); // SIGKILL on Unix
    child.wait().unwrap();
    let stored = stored(&place);
    assert!(
        (1..4).contains(&stored),
        "{stored} of 4 trials stored: the run was not killed halfway"
    );
    assert!(!place.path("artifacts").exists(), "a killed run left a bundle");
    let resumed = finished(&mut run(&place, &[]));
    assert_eq!((resumed.cached, resumed.results_digest), (stored as u64, UNDISTURBED.clone()));
}
