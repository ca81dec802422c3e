//! The determinism contract, as far as one machine can test it quickly: how a study is run leaves no mark on its results.
//!
//! `.ci/determinism.sh` compares compilers' settings, instruction sets and architectures.

use assert_cmd::cargo::cargo_bin;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::LazyLock;
use std::thread;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Two trials with and two without a floor plan, in the smallest world.
const STUDY: &str = "
reenact: 1
name: short
title: A short study
license: CC-BY-4.0
study: prior-map
seed: 7
trials: 2
robot: robots/kobuki.urdf
world: {file: worlds/basic.yaml, layers: [walls]}
start: {x-m: 3, y-m: 2, heading-deg: 0}
factors:
  prior: [none, floor-plan]
prior-maps:
  floor-plan: {floor-plan-of: world}
";

/// A folder of its own with the study, a robot, a world, a store and a place for bundles.
struct Place {
    folder: TempDir,
}

impl Place {
    fn new() -> Self {
        let place = Self { folder: tempfile::tempdir().unwrap() };
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        for file in ["robots/kobuki.urdf", "worlds/basic.yaml"] {
            let copy = place.path(file);
            fs::create_dir_all(copy.parent().unwrap()).unwrap();
            fs::copy(root.join(file), copy).unwrap();
        }
        fs::write(place.path("short.yaml"), STUDY).unwrap();
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// `reenact run short.yaml` in this folder, with its own store.
    fn run(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(cargo_bin!("reenact"));
        command
            .current_dir(self.folder.path())
            .env("REENACT_STORE", self.path("store"))
            .args(["run", "short.yaml", "--format", "json"])
            .args(arguments);
        command
    }

    /// Records in the store.
    fn stored(&self) -> usize {
        let Ok(folders) = fs::read_dir(self.path("store")) else { return 0 };
        let records = |folder: PathBuf| {
            fs::read_dir(folder).map_or(0, |entries| {
                entries
                    .filter(|e| {
                        e.as_ref().is_ok_and(|e| e.path().extension().is_some_and(|x| x == "json"))
                    })
                    .count()
            })
        };
        folders.map(|folder| records(folder.unwrap().path())).sum()
    }
}

/// What a run said of itself.
struct Told {
    results_digest: String,
    cached: u64,
}

fn finished(command: &mut Command) -> Told {
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let results_digest = told["results_digest"].as_str().unwrap().to_owned();
    assert!(results_digest.starts_with("sha256:"), "{results_digest}");
    Told { results_digest, cached: told["cached"].as_u64().unwrap() }
}

/// The digest of an undisturbed run on one thread.
static UNDISTURBED: LazyLock<String> = LazyLock::new(|| {
    finished(&mut Place::new().run(&["--no-cache", "--jobs", "1"])).results_digest
});

#[test]
fn threads_directory_locale_and_time_zone_leave_no_mark() {
    let elsewhere = Place::new();
    let told = finished(
        elsewhere
            .run(&["--no-cache", "--jobs", "3"])
            .env("LC_ALL", "tr_TR.UTF-8")
            .env("LANG", "tr_TR.UTF-8")
            .env("TZ", "Asia/Kathmandu"),
    );
    assert_eq!(told.results_digest, *UNDISTURBED);
    assert_eq!(elsewhere.stored(), 0, "`--no-cache` wrote to the store");
}

/// Under `SOURCE_DATE_EPOCH` not only the results but the whole zip is the same, byte for byte.
#[test]
fn source_date_epoch_makes_whole_bundles_equal() {
    let bundle = |command: &mut Command| {
        let output = command.env("SOURCE_DATE_EPOCH", "1600000000").output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let path = PathBuf::from(told["bundle"].as_str().unwrap());
        (path.file_name().unwrap().to_owned(), fs::read(path).unwrap())
    };
    let (here, elsewhere) = (Place::new(), Place::new());
    let first = bundle(&mut here.run(&["--jobs", "1"]));
    let plain = elsewhere.run(&["--jobs", "2", "--no-cache", "--out", "deep/in/here"]);
    let mut masked = if cfg!(unix) {
        let mut masked = Command::new("sh");
        masked.args(["-c", "umask 077 && exec \"$0\" \"$@\""]).arg(plain.get_program());
        masked.args(plain.get_args()).current_dir(elsewhere.folder.path());
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
    let told = finished(&mut Place::new().run(&["--no-cache", "--set", "seed=8"]));
    assert_ne!(told.results_digest, *UNDISTURBED);
}

#[test]
fn a_half_filled_store_leaves_no_mark() {
    let place = Place::new();
    // The second condition first, so that the whole study meets its trials in another order.
    let part = finished(&mut place.run(&["--only", "prior=floor-plan"]));
    assert_ne!(part.results_digest, *UNDISTURBED);
    assert_eq!(place.stored(), 2);
    let whole = finished(&mut place.run(&["--jobs", "2"]));
    assert_eq!((whole.cached, whole.results_digest), (2, UNDISTURBED.clone()));
}

#[test]
fn a_killed_run_resumes_to_the_same_results() {
    let place = Place::new();
    let mut child =
        place.run(&["--jobs", "1"]).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let patience = Duration::from_secs(120);
    #[expect(clippy::disallowed_methods, reason = "a test's patience is wall time")]
    let began = Instant::now();
    while place.stored() == 0 {
        assert!(began.elapsed() < patience, "no trial was stored within {patience:?}");
        assert_eq!(child.try_wait().unwrap(), None, "the run ended without storing a trial");
        thread::sleep(Duration::from_millis(2));
    }
    child.kill().unwrap(); // SIGKILL on Unix
    child.wait().unwrap();
    let stored = place.stored();
    assert!(
        (1..4).contains(&stored),
        "{stored} of 4 trials stored: the run was not killed halfway"
    );
    assert!(!place.path("artifacts").exists(), "a killed run left a bundle");
    let resumed = finished(&mut place.run(&[]));
    assert_eq!((resumed.cached, resumed.results_digest), (stored as u64, UNDISTURBED.clone()));
}
