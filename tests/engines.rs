//! What is handed to engines of laboratories, whole; and the recipe that needs none.
#![cfg(unix)]

use crate::sandbox::{Answer, PROGRAM, Sandbox, TINY};
use serde_json::Value;
use std::fs;
use std::os::unix::fs::PermissionsExt as _;
use std::process::Command;

fn place() -> Sandbox {
    Sandbox::pinned().with_study(TINY)
}

/// Replaces what is another on every machine.
fn told(place: &Sandbox, text: &str) -> String {
    let here = fs::canonicalize(place.path("")).unwrap();
    let text = text.replace(PROGRAM, "PROGRAM").replace(here.to_str().unwrap(), "HERE");
    text.replace(place.path("").to_str().unwrap().trim_end_matches('/'), "HERE")
}

#[test]
fn a_slurm_job_is_printed_whole() {
    let place = place();
    let words = ["submit", "tiny.yaml", "--engine", "slurm", "--shards", "3", "--dry-run"];
    let more = [
        "--partition",
        "long",
        "--account",
        "lab-7",
        "--time",
        "4:00:00",
        "--memory",
        "2G",
        "--cpus",
        "2",
        "--throttle",
        "8",
        "--only",
        "prior=none",
        "--set",
        "title=It's tiny",
    ];
    let printed = place.done(&[&words[..], &more].concat());
    insta::assert_snapshot!("a_slurm_job", told(&place, &printed));
    let plain = place.done(&words);
    assert!(plain.starts_with(
        "# tiny.slurm/shards.sh\n#!/bin/sh\n#SBATCH --array=1-3\n#SBATCH --job-name=reenact-tiny\n"
    ));
    assert!(!place.path("tiny.slurm").exists(), "nothing is written");
}

#[test]
fn a_slurm_job_is_submitted_with_the_sealing_after_it() {
    let place = place();
    fs::create_dir(place.path("bin")).unwrap();
    let slurm = |script: &str| {
        place.write("bin/sbatch", script);
        fs::set_permissions(place.path("bin/sbatch"), fs::Permissions::from_mode(0o755)).unwrap();
    };
    let submit = |more: &[&str]| {
        let words = ["submit", "tiny.yaml", "--engine", "slurm", "--shards", "2"];
        let mut command = place.command(&[&words[..], more].concat());
        let path = format!("{}:/usr/bin:/bin", place.path("bin").display());
        Answer::of(command.env("PATH", path))
    };
    slurm("#!/bin/sh\necho \"$*\" >>asked\necho \"$((40 + $(wc -l <asked)));cluster\"\n");
    let answer = submit(&["--format", "json"]);
    crate::schemas::assert_answers("submit", &answer.stdout);
    assert_eq!((answer.stderr.as_str(), answer.code), ("", 0));
    let line: Value = serde_json::from_str(&answer.stdout).unwrap();
    assert_eq!((&line["array_job"], &line["seal_job"]), (&"41".into(), &"42".into()));
    assert_eq!((&line["shards"], &line["trials"]), (&2.into(), &6.into()));
    assert_eq!(
        place.read("asked"),
        "--parsable tiny.slurm/shards.sh\n--parsable --dependency=afterok:41 --kill-on-invalid-dep=yes tiny.slurm/seal.sh\n"
    );
    // What Slurm would do with them.
    let store = place.path("store");
    for task in ["1", "2"] {
        let mut command = Command::new("sh");
        let command =
            place.dress(command.arg("tiny.slurm/shards.sh")).env("SLURM_ARRAY_TASK_ID", task);
        let answer = Answer::of(command);
        let says = format!("shard {task}/2 of tiny: 3 trials, 3 simulated in ");
        assert!(answer.stdout.starts_with(&says) && answer.code == 0, "{answer:?}");
    }
    let mut command = Command::new("sh");
    let sealed = Answer::of(place.dress(command.arg("tiny.slurm/seal.sh")));
    assert!(sealed.stdout.contains("6 trials: 6 time-limit; 0 simulated in "), "{sealed:?}");
    assert!(place.files("artifacts").len() == 1 && store.is_dir());
    slurm("#!/bin/sh\necho 'sbatch: error: invalid partition specified: long' >&2\nexit 1\n");
    let answer = submit(&["--partition", "long"]);
    assert_eq!(
        (answer.stderr.as_str(), answer.code),
        (
            "error: `sbatch --parsable tiny.slurm/shards.sh` was refused: sbatch: error: invalid partition specified: long\n",
            3
        )
    );
    slurm("#!/bin/sh\ncase \"$*\" in *dependency*) echo no >&2; exit 1;; esac\necho 7\n");
    assert_eq!(
        submit(&[]).stderr,
        "error: `sbatch --parsable --dependency=afterok:7 --kill-on-invalid-dep=yes tiny.slurm/seal.sh` was refused: no; the array \
         is submitted as job 7: `scancel 7` takes it back, or run the manifest when it has ended\n"
    );
    fs::remove_file(place.path("bin/sbatch")).unwrap();
    let mut command = place.command(&["submit", "tiny.yaml", "--engine", "slurm", "--shards", "2"]);
    let answer = Answer::of(command.env("PATH", place.path("bin")));
    assert_eq!(
        (answer.stderr.as_str(), answer.code),
        (
            "error: cannot start `sbatch`: no such file; run this where Slurm's commands are, or see what it would do with \
             --dry-run\n",
            3
        )
    );
}

#[test]
fn a_kubernetes_job_is_printed_whole() {
    let place = place();
    let words = ["submit", "tiny.yaml", "--engine", "kubernetes", "--shards", "3"];
    let more = [
        "--dry-run",
        "--image",
        "lab.example/reenact:0.1.0",
        "--claim",
        "studies",
        "--memory",
        "2Gi",
        "--throttle",
        "2",
        "--trials",
        "2",
    ];
    let answer = place.run(&[&words[..], &more].concat());
    assert_eq!(answer.code, 0);
    assert_eq!(
        answer.stderr,
        "note: then `kubectl wait --for=condition=complete --timeout=-1s job/reenact-tiny`, and `kubectl patch \
         job/reenact-tiny-seal -p '{\"spec\":{\"suspend\":false}}'`\n"
    );
    insta::assert_snapshot!("a_kubernetes_job", answer.stdout);
    let refused = place.run(&words);
    assert_eq!(
        (refused.stderr.as_str(), refused.code),
        (
            "error: `--engine kubernetes` needs `--dry-run`, `--image` and `--claim`: it prints what `kubectl apply -f -` takes, \
             and talks to no cluster itself\n",
            2
        )
    );
}

/// The recipe of docs/scale.md, on one host: GNU parallel where it is there, xargs else, which runs the same lines.
#[test]
fn the_recipe_without_an_engine_gives_what_one_machine_gives() {
    let place = place();
    let alone =
        place.done(&["run", "tiny.yaml", "--no-cache", "--out", "alone", "--format", "json"]);
    let page = fs::read_to_string(crate::sandbox::repository().join("docs/scale.md")).unwrap();
    let recipe = page.split("## GNU parallel and ssh\n").nth(1).unwrap();
    let recipe = recipe.split("```\n").nth(1).unwrap();
    let has_parallel = Command::new("parallel").arg("--version").output().is_ok();
    let line = recipe.lines().find(|line| line.contains("parallel ")).unwrap();
    assert!(line.starts_with("seq 8 | parallel --jobs 4 "), "{line}");
    let script = if has_parallel {
        recipe.to_owned()
    } else {
        crate::sandbox::skipped("no GNU parallel here: the recipe runs by xargs");
        recipe.replace("parallel --jobs 4", "xargs -P 4 -I{}")
    };
    fs::create_dir(place.path("bin")).unwrap();
    std::os::unix::fs::symlink(PROGRAM, place.path("bin/reenact")).unwrap();
    let mut command = Command::new("sh");
    let path = format!("{}:/usr/bin:/bin", place.path("bin").display());
    let script = script
        .replace("study.yaml", "tiny.yaml")
        .replace("--shard {}/8", "--shard {}/8 --no-cache");
    let answer = Answer::of(place.dress(command.args(["-e", "-c", &script])).env("PATH", path));
    assert_eq!(answer.code, 0, "{answer:?}");
    let digest: Value = serde_json::from_str(&alone).unwrap();
    let says = format!("results {}\n", digest["results_digest"].as_str().unwrap());
    assert!(
        answer.stdout.contains("; of 8 shards, none simulated here, ")
            && answer.stdout.contains(&says),
        "{answer:?}"
    );
}

#[test]
fn what_no_engine_can_run_is_told_before_anything_waits() {
    let place = place();
    let submit = |more: &[&str]| {
        let words = ["submit", "tiny.yaml", "--engine", "slurm", "--dry-run"];
        let answer = place.run(&[&words[..], more].concat());
        (answer.stderr, answer.code)
    };
    let many =
        "error: `--shards` must be at most as many as there are trials, found 7 of 6 trials\n";
    assert_eq!(submit(&["--shards", "7"]), (many.to_owned(), 2));
    let (stderr, code) = submit(&["--shards", "2", "--time", "1 hour\n#SBATCH --uid=0"]);
    let says =
        "expected letters, digits and any of _ - . , : + = @ % /, found `1 hour\n#SBATCH --uid=0`";
    assert!(stderr.contains(says) && code == 2, "{stderr}");
    place.edit("tiny.yaml", "trials: 3", "trials: none");
    assert_eq!(submit(&["--shards", "2"]).1, 2);
}
