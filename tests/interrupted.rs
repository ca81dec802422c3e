//! Runs that are interrupted or killed say how to go on, lose nothing that was finished and leave nothing half written; and
//! what stands among the files of records without being one is left alone.
#![cfg(unix)]

use crate::sandbox::{Answer, Sandbox, TINY};
use std::fs;
use std::os::unix::process::ExitStatusExt as _;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// Creates the tiny study with forty trials of one cell: enough that a run is never over before it is interrupted.
fn place() -> Sandbox {
    let cells = "prior: [none, floor-plan]\nprior-maps:\n  floor-plan: {floor-plan-of: world}\n";
    let study = TINY.replace("trials: 3", "trials: 40").replace(cells, "prior: [none]\n");
    Sandbox::new().with_study(&study)
}

/// Returns the files below a folder with this in their names.
fn named(place: &Sandbox, below: &str, part: &str) -> Vec<PathBuf> {
    let mut files = place.files(below);
    files.retain(|file| file.file_name().unwrap().to_string_lossy().contains(part));
    files
}

/// Begins `command` and waits until a few trials are in the store.
fn begun(place: &Sandbox, command: &str) -> Child {
    let mut command = place.command(&[command, "tiny.yaml", "--jobs", "1"]);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    while place.records("store").len() < 3 {
        assert!(child.try_wait().unwrap().is_none(), "it ended by itself");
        std::thread::sleep(Duration::from_millis(5));
    }
    child
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
        let place = place();
        let child = begun(&place, command);
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
        let stored = place.records("store").len();
        assert!((3..=40).contains(&kept) && kept <= stored, "{kept} told, {stored} kept");
        assert_eq!(named(&place, "", ".partial-"), [] as [PathBuf; 0]);
        let plan = place.run(&["plan", "tiny.yaml"]).stdout;
        let says = format!("40 trials: {stored} done, {} to do", 40 - stored);
        assert!(plan.contains(&says), "every stored trial is taken up again: {plan}");
    }
}

#[test]
fn what_killed_runs_left_half_written_is_swept_and_nothing_else() {
    let place = place();
    let child = begun(&place, "run");
    send("-KILL", &child);
    child.wait_with_output().unwrap();
    // As one of a version that kept a file for each record leaves it, and one of another machine that may still be at work.
    let folder = place.path("store/ab");
    fs::create_dir(&folder).unwrap();
    let (old, live) = (folder.join(".partial-aBcDeF"), folder.join(".partial-0badcafe-aBcDeF"));
    fs::write(&old, "half").unwrap();
    fs::write(&live, "half").unwrap();
    let long_ago = std::time::SystemTime::UNIX_EPOCH;
    fs::File::options().write(true).open(&old).unwrap().set_modified(long_ago).unwrap();
    let answer = place.done(&["run", "tiny.yaml", "--trials", "3", "--format", "json"]);
    let told: serde_json::Value = serde_json::from_str(&answer).unwrap();
    assert_eq!(told["cached"], 3, "a kill loses nothing that was finished");
    assert_eq!(named(&place, "", ".partial-"), [live]);
}

/// Every shape but a file, among the files of records: each is named, and what the others hold is used.
#[test]
fn what_is_no_file_of_records_is_named_and_left_alone() {
    let place = place();
    let words = ["run", "tiny.yaml", "--trials", "4", "--format", "json"];
    let results = |answer: &Answer| {
        let told: serde_json::Value = serde_json::from_str(&answer.stdout).unwrap();
        (told["results_digest"].clone(), told["cached"].as_u64().unwrap())
    };
    let (undisturbed, _) = results(&place.run(&words));
    assert_eq!(place.records("store").len(), 4);
    let odd = ["a", "b", "c"].map(|name| place.path(&format!("store/segments/{name}.jsonl")));
    assert!(Command::new("mkfifo").arg(&odd[0]).status().unwrap().success());
    fs::create_dir(&odd[1]).unwrap();
    std::os::unix::fs::symlink(&odd[2], &odd[2]).unwrap();
    for _ in 0..2 {
        let answer = place.run(&words);
        assert_eq!((results(&answer), answer.code), ((undisturbed.clone(), 4), 0));
        let found = ["a pipe", "a folder", "a symbolic link that leads nowhere"];
        let says: Vec<String> = odd
            .iter()
            .zip(found)
            .map(|(path, found)| {
                format!(
                    "warning: trial store: expected a file of records at `{}`, found {found}: it is left alone; remove it\n",
                    path.display()
                )
            })
            .collect();
        assert_eq!(answer.stderr, says.concat());
    }
}
