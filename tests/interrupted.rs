//! Runs that are interrupted or killed say how to go on, lose nothing that was finished and leave nothing half written; and
//! what stands in a record's place without being one is left alone.
#![cfg(unix)]

use assert_cmd::cargo::cargo_bin;
use std::fs;
use std::os::unix::process::ExitStatusExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;
use tempfile::TempDir;

/// Forty trials of 20 simulated seconds: enough that a run is never over before it is interrupted.
const STUDY: &str = "
reenact: 1
name: tiny
title: A tiny study
license: CC-BY-4.0
study: prior-map
seed: 7
trials: 40
robot: kobuki.urdf
world: {file: basic.yaml, layers: [walls]}
start: {x-m: 3, y-m: 2, heading-deg: 0}
factors:
  prior: [none]
parameters:
  mission: {time-limit-s: 20}
";

struct Place(TempDir);

impl Place {
    fn new() -> Self {
        let place = Self(tempfile::tempdir().unwrap());
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        fs::copy(root.join("robots/kobuki.urdf"), place.path("kobuki.urdf")).unwrap();
        fs::copy(root.join("worlds/basic.yaml"), place.path("basic.yaml")).unwrap();
        fs::write(place.path("tiny.yaml"), STUDY).unwrap();
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn command(&self, words: &[&str]) -> Command {
        let mut command = Command::new(cargo_bin!("reenact"));
        command
            .current_dir(self.0.path())
            .env("REENACT_STORE", self.path("store"))
            .args(words)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        command
    }

    fn run(&self, words: &[&str]) -> Output {
        self.command(words).output().unwrap()
    }

    /// Files of the store whose names end so.
    fn stored(&self, ending: &str) -> Vec<PathBuf> {
        let folders = fs::read_dir(self.path("store")).into_iter().flatten();
        let files = folders.flat_map(|folder| fs::read_dir(folder.unwrap().path()).unwrap());
        let mut files: Vec<_> = files.map(|file| file.unwrap().path()).collect();
        files.retain(|file| file.to_string_lossy().ends_with(ending));
        files.sort();
        files
    }

    /// Everything with this in its name below the folder.
    fn named(&self, part: &str) -> Vec<PathBuf> {
        let (mut found, mut folders) = (Vec::new(), vec![self.0.path().to_owned()]);
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                found.extend(path.to_string_lossy().contains(part).then(|| path.clone()));
                folders.extend(path.is_dir().then_some(path));
            }
        }
        found
    }

    /// Begins `command` and waits until a few trials are in the store.
    fn begun(&self, command: &str) -> Child {
        let mut child = self.command(&[command, "tiny.yaml", "--jobs", "1"]).spawn().unwrap();
        while self.stored(".json").len() < 3 {
            assert!(child.try_wait().unwrap().is_none(), "it ended by itself");
            std::thread::sleep(Duration::from_millis(5));
        }
        child
    }
}

fn send(signal: &str, child: &Child) {
    let mut kill = Command::new("kill");
    assert!(kill.args([signal, &child.id().to_string()]).status().unwrap().success());
}

fn text(bytes: Vec<u8>) -> String {
    String::from_utf8(bytes).unwrap()
}

#[test]
fn an_interrupted_run_says_how_to_go_on_and_leaves_nothing_half_written() {
    for (command, signal, number) in [("run", "-INT", 2), ("run", "-TERM", 15), ("lock", "-INT", 2)]
    {
        let place = Place::new();
        let child = place.begun(command);
        send(signal, &child);
        let output = child.wait_with_output().unwrap();
        let (stdout, stderr) = (text(output.stdout), text(output.stderr));
        // A shell tells it as 128 and the signal's number.
        assert_eq!((stdout.as_str(), output.status.signal()), ("", Some(number)), "{stderr}");
        let kept = stderr
            .strip_prefix("interrupted: ")
            .and_then(|rest| {
                rest.strip_suffix(
                    " of 40 trials of tiny are kept; the same command goes on where it was\n",
                )
            })
            .and_then(|kept| kept.parse::<usize>().ok())
            .unwrap_or_else(|| panic!("{stderr}"));
        let stored = place.stored(".json").len();
        assert!((3..=40).contains(&kept) && kept <= stored, "{kept} told, {stored} kept");
        assert_eq!(place.named(".partial-"), [] as [PathBuf; 0]);
        let plan = text(place.run(&["plan", "tiny.yaml"]).stdout);
        let says = format!("40 trials: {stored} done, {} to do", 40 - stored);
        assert!(plan.contains(&says), "every stored trial is taken up again: {plan}");
    }
}

#[test]
fn what_killed_runs_left_half_written_is_swept_and_nothing_else() {
    let place = Place::new();
    let child = place.begun("run");
    send("-KILL", &child);
    child.wait_with_output().unwrap();
    let stored = place.stored(".json");
    // As one that was at its file just then leaves it, and one of another machine that may still be at work.
    let folder = stored[0].parent().unwrap();
    let (old, live) = (folder.join(".partial-aBcDeF"), folder.join(".partial-0badcafe-aBcDeF"));
    fs::write(&old, "half").unwrap();
    fs::write(&live, "half").unwrap();
    let long_ago = std::time::SystemTime::UNIX_EPOCH;
    fs::File::options().write(true).open(&old).unwrap().set_modified(long_ago).unwrap();
    let output = place.run(&["run", "tiny.yaml", "--trials", "3", "--format", "json"]);
    assert_eq!((text(output.stderr).as_str(), output.status.code()), ("", Some(0)));
    let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(told["cached"], 3, "a kill loses nothing that was finished");
    assert_eq!(place.named(".partial-"), [live]);
}

/// Every shape but a file, in the places of finished records: each is named, its trial is run again and not kept.
#[test]
fn what_is_no_file_in_a_record_s_place_is_named_and_left_alone() {
    let place = Place::new();
    let words = ["run", "tiny.yaml", "--trials", "4", "--format", "json"];
    let results = |output: &Output| {
        let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        (told["results_digest"].clone(), told["cached"].as_u64().unwrap())
    };
    let (undisturbed, _) = results(&place.run(&words));
    let records = place.stored(".json");
    assert_eq!(records.len(), 4);
    for record in &records[..3] {
        fs::remove_file(record).unwrap();
    }
    assert!(Command::new("mkfifo").arg(&records[0]).status().unwrap().success());
    fs::create_dir(&records[1]).unwrap();
    std::os::unix::fs::symlink(&records[2], &records[2]).unwrap();
    for _ in 0..2 {
        let output = place.run(&words);
        assert_eq!(results(&output), (undisturbed.clone(), 1));
        assert_eq!(output.status.code(), Some(0));
        let found = ["a pipe", "a folder", "a symbolic link that leads nowhere"];
        let says: Vec<String> = records
            .iter()
            .zip(found)
            .map(|(record, found)| {
                format!(
                    "warning: trial store: expected the record of a trial in `{}`, found {found}: it is left alone, and its \
                     trial is run each time and not kept; remove it\n",
                    record.display()
                )
            })
            .collect();
        assert_eq!(text(output.stderr), says.concat());
    }
}
