//! Locks, probes and differences as people meet them: whole texts and exit codes.

use crate::sandbox::{Answer, Sandbox, repository};
use std::fs;
use std::path::Path;

/// Probes one condition.
const PROBE: [&str; 6] = ["run", "demo/demo.yaml", "--locked", "--probe", "--only", "prior=none"];

/// Creates a folder with the starter study, one trial of half a minute a condition.
fn desk() -> Sandbox {
    let desk = Sandbox::pinned().with_demo();
    let short = "trials: 1\nparameters: {mission: {time-limit-s: 30}}";
    let text = desk.read("demo/demo.yaml");
    // Nothing is claimed: verdicts are not what drifts here.
    let (text, _) = text.split_once("claims:\n").unwrap();
    desk.write("demo/demo.yaml", text.replace("trials: 10", short));
    desk
}

/// Returns what the lock has of the condition `slug`.
fn locked(desk: &Sandbox, slug: &str) -> serde_json::Value {
    let lock: serde_json::Value = serde_json::from_str(&desk.read("demo/demo.lock")).unwrap();
    let conditions = lock["conditions"].as_array().unwrap();
    conditions.iter().find(|c| c["slug"] == slug).unwrap().clone()
}

/// Returns `text` with short digests, simulated seconds and the number of settings hidden.
fn redacted(text: &str) -> String {
    let mut out = String::new();
    for line in text.split_inclusive('\n') {
        let line = match line.split_once(" after ") {
            Some((head, rest)) if rest.ends_with(" s\n") => format!("{head} after N s\n"),
            _ if line.starts_with("  settings ") => "  settings              N  same\n".to_owned(),
            _ => line.to_owned(),
        };
        let mut parts = line.split("sha256:");
        out.push_str(parts.next().unwrap_or_default());
        for part in parts {
            let digits = part.bytes().take_while(u8::is_ascii_hexdigit).count();
            out.push_str("sha256:X");
            out.push_str(&part[digits..]);
        }
    }
    out
}

/// One desk takes every step, as its trials take a while.
#[test]
fn a_lock_is_written_probed_found_drifting_and_blessed_again() {
    let desk = desk();

    // Without a lock there is nothing to be held against.
    let answer = desk.run(&["run", "demo/demo.yaml", "--locked", "--probe"]);
    let says = "error: cannot read `demo/demo.lock`: no such file; `--locked` needs a lock: write it with `reenact lock \
                demo/demo.yaml` and commit it\n";
    assert_eq!((answer.stdout.as_str(), answer.stderr.as_str(), answer.code), ("", says, 2));

    let answer = desk.run(&["lock", "demo/demo.yaml"]);
    let wrote = "\
wrote demo/demo.lock: 2 trials of 2 conditions, results sha256:X
commit it; `reenact run --locked --probe demo/demo.yaml` finds drift
";
    assert_eq!(
        (redacted(&answer.stdout), answer.stderr.as_str(), answer.code),
        (wrote.to_owned(), "", 0)
    );
    let blessed = desk.read("demo/demo.lock");

    let answer = desk.run(&["lock", "demo/demo.yaml"]);
    assert_eq!((answer.stdout.as_str(), answer.code), ("demo/demo.lock is up to date\n", 0));

    // A run by the lock, and one without it: the same results, the same score, the same bundle.
    let free = desk.run(&["run", "demo/demo.yaml", "--out", "free"]);
    let held = desk.run(&["run", "demo/demo.yaml", "--out", "held", "--locked"]);
    assert_eq!((held.stderr.as_str(), held.code), ("", 0));
    assert!(
        held.stdout.contains("\neverything is as in demo/demo.lock\nresults sha256:"),
        "{}",
        held.stdout
    );
    let name = free.stdout.lines().last().unwrap().trim_start_matches("free/").to_owned();
    let bytes = |folder: &str| fs::read(desk.path(folder).join(&name)).unwrap();
    assert!(bytes("free") == bytes("held"), "a lock left its mark on the bundle");

    // The lock's chain altered at one step: found by the probe, which does not read the store.
    let chain = locked(&desk, "none")["first-trial"]["chain"][0].as_str().unwrap().to_owned();
    let hashes: Vec<&str> = chain.split(' ').collect();
    desk.edit("demo/demo.lock", hashes[1], "00000000deadbeef");
    let answer = desk.run(&["run", "demo/demo.yaml", "--locked", "--probe"]);
    let key = locked(&desk, "none")["first-trial"]["key"].as_str().unwrap()[..8].to_owned();
    let drift = format!(
        "\
DRIFT  none/0        time-limit after N s
same   floor-plan/0  time-limit after N s

demo/demo.yaml has drifted from demo/demo.lock (trial 0 of every condition)

  inputs                2  same
  manifest                 same
  engine                   same
  settings              N  same
  conditions            2  same
  trials                2  1 changed

trials
  none/0: sha256:X (same key {key}, other bytes; states first differ between 10 s and 20 s of simulated time)

cause: same inputs, same engine version, same settings, other bytes: either the program changed what a trial yields and \
         its engine version was not raised (docs/determinism.md), or a trial is not deterministic (`reenact run --twice \
         demo/demo.yaml` finds out)
If this is meant, write the lock anew with `reenact lock demo/demo.yaml` and say why in CHANGELOG.md.

"
    );
    assert_eq!(redacted(&answer.stdout), drift);
    let says = "error: demo/demo.yaml has drifted from demo/demo.lock\n";
    assert_eq!((answer.stderr.as_str(), answer.code), (says, 1));

    // Whatever the lock says, a run prints the same and scores the same.
    let again = desk.run(&["run", "demo/demo.yaml", "--out", "free"]);
    let results = |answer: &Answer| {
        let summary = |line: &&str| !line.contains(" simulated in ");
        answer.stdout.lines().filter(summary).map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(results(&again), results(&free));

    // Blessed again: what changes is told, with the duty that comes with it.
    let answer = desk.run(&["lock", "demo/demo.yaml"]);
    assert!(
        answer.stdout.ends_with(
            "\nchanged: trials (1)\n\nwrote demo/demo.lock anew: the reason belongs in CHANGELOG.md, in the same commit\n"
        ),
        "{}",
        answer.stdout
    );
    assert_eq!(answer.code, 0);
    assert_eq!(desk.read("demo/demo.lock"), blessed);

    // As it should be, in both forms.
    let answer = desk.run(&["run", "demo/demo.yaml", "--locked", "--probe"]);
    let same = "\
same   none/0        time-limit after N s
same   floor-plan/0  time-limit after N s
trial 0 of every condition is as in demo/demo.lock
";
    assert_eq!(
        (redacted(&answer.stdout), answer.stderr.as_str(), answer.code),
        (same.to_owned(), "", 0)
    );
    let answer = desk.run(&[&PROBE[..], &["--format", "json"]].concat());
    let mut line: serde_json::Value = serde_json::from_str(&answer.stdout).unwrap();
    line["wall_seconds"] = 0.into();
    assert_eq!(
        line,
        serde_json::json!({
            "manifest": "demo/demo.yaml", "lock": "demo/demo.lock", "probe": true, "drift": null, "wall_seconds": 0,
            "conditions": [{"condition": "none", "same": true}],
        })
    );
    assert_eq!(answer.code, 0);

    // What a merge left behind is no lock, and is written anew.
    desk.write("demo/demo.lock", format!("<<<<<<< ours\n{blessed}=======\n>>>>>>> theirs\n"));
    let answer = desk.run(&["lock", "demo/demo.yaml"]);
    let wrote = "wrote demo/demo.lock anew: the old one could not be read; the reason belongs in CHANGELOG.md, in the same \
                 commit\n";
    assert_eq!((answer.stdout.as_str(), answer.code), (wrote, 0));
    assert_eq!(desk.read("demo/demo.lock"), blessed);
}

#[test]
fn a_parameter_that_changed_is_named_by_probe_and_run_and_the_bundles_are_told_apart() {
    let desk = desk();
    assert_eq!(desk.run(&["lock", "demo/demo.yaml"]).code, 0);
    let range = ["--set", "parameters.sensing.range-m=6"];
    let answer = desk.run(&[&PROBE[..], &range].concat());
    assert_eq!(answer.code, 1);
    for line in [
        "\nsettings\n  overrides: [] -> [\"parameters.sensing.range-m=6\"]\n  parameters.sensing.range-m: ",
        " -> 6 (in every condition)\n",
        "\ncause: settings changed, by the manifest, by `--set` or by other defaults\nIf this is meant, ",
    ] {
        assert!(answer.stdout.contains(line), "{line}\nis not in\n{}", answer.stdout);
    }

    // A run that drifts is sealed all the same: the bundle is what to look at.
    let plain = ["run", "demo/demo.yaml", "--only", "prior=none", "--format", "json"];
    let old: serde_json::Value = serde_json::from_str(&desk.run(&plain).stdout).unwrap();
    let answer = desk.run(&[&plain[..], &range[..], &["--locked"]].concat());
    let new: serde_json::Value = serde_json::from_str(&answer.stdout).unwrap();
    assert_eq!((answer.code, &new["drift"]["causes"]), (1, &serde_json::json!(["settings"])));
    assert_eq!(old.get("drift"), None, "the key is there under --locked only");
    let (old, new) = (old["bundle"].as_str().unwrap(), new["bundle"].as_str().unwrap());

    assert_eq!(desk.run(&["diff", old, old]).code, 0);
    let answer = desk.run(&["diff", old, new]);
    assert_eq!((answer.stderr.as_str(), answer.code), ("", 1));
    let line = "checked to level 3 (derived): the bundle is what it says";
    assert!(
        answer.stdout.starts_with(&format!("{old}: {line}\n{new}: {line}\n")),
        "{}",
        answer.stdout
    );
    assert!(answer.stdout.contains("\nno two trials have the same key "), "{}", answer.stdout);
    let json = desk.run(&["diff", old, new, "--format", "json"]);
    assert_eq!((json.stdout.lines().count(), json.code), (1, 1));
    assert_eq!(json.stderr, format!("{old}: {line}\n{new}: {line}\n"), "stdout is for programs");
    let told: serde_json::Value = serde_json::from_str(&json.stdout).unwrap();
    assert_eq!(told["matching"], serde_json::json!({"by_key": 0, "by_number": 1}));
    let answer = desk.run(&["diff", old, new, "--format", "html", "-o", "d.html"]);
    let says = format!("{old}: {line}\n{new}: {line}\nd.html\n");
    assert_eq!((answer.stdout, answer.code), (says, 1));
    assert!(desk.read("d.html").contains("<h1>What changed</h1>"));
    let answer = desk.run(&["diff", old, "demo/demo.lock"]);
    assert_eq!(answer.code, 1);
    assert!(answer.stdout.contains("\n  floor-plan: new, 1 trial\n"), "{}", answer.stdout);
}

#[test]
fn requests_about_drift_that_are_not_understood_end_with_2() {
    let desk = desk();
    desk.write("new.lock", "{\"lock-format\": 7}\n");
    desk.write("demo/demo.lock", "{\"lock-format\": 7}\n");
    desk.write("x.zip", "hello");
    for (words, says) in [
        (
            vec!["run", "demo/demo.yaml", "--locked", "--trials", "1"],
            "error: `--locked` compares whole conditions, so it goes with neither `--trials` nor `--shard`; choose \
             conditions with `--only`, or run trial 0 of each with `--probe`\n",
        ),
        (
            vec!["diff", "new.lock", "new.lock"],
            "error: lock format 7 is newer than this program\n --> new.lock:1:17\n  |\n1 | {\"lock-format\": 7}\n  |                 \
             ^ expected 1 or less\n  |\n  = help: install a newer reenact, or delete the lock and write it anew with \
             `reenact lock`\n\nerror: new.lock: 1 error\n",
        ),
        (vec!["diff", "nope.zip", "x.zip"], "error: cannot read `nope.zip`: no such file\n"),
        (
            vec!["diff", "x.zip", "x.zip", "--tolerance", "much"],
            "error: `--tolerance much`: expected METRIC=NUMBER, METRIC=NUMBER% or one number for all, as in `--tolerance \
             distance-m=0.5` or `--tolerance 1%`; numbers are 0 or more\n",
        ),
    ] {
        let answer = desk.run(&words);
        assert_eq!((answer.stderr.as_str(), answer.code), (says, 2), "{words:?}");
        assert_eq!(answer.stdout, "", "{words:?}");
    }
    assert_eq!(
        desk.run(&["diff", "x.zip", "x.zip"]).code,
        2,
        "a damaged bundle leaves the question open"
    );
    assert_eq!(desk.run(&["run", "demo/demo.yaml", "--probe"]).code, 2, "--probe needs --locked");
    assert_eq!(
        desk.run(&["lock", "demo/demo.yaml"]).code,
        2,
        "an older program takes nothing back"
    );
    assert_eq!(desk.read("demo/demo.lock"), "{\"lock-format\": 7}\n");
    assert_eq!(desk.run(&["run", "demo/demo.yaml", "--locked"]).code, 2);
}

#[test]
fn every_trial_twice_gives_the_same_bytes() {
    let desk = desk();
    let answer = desk.run(&["run", "demo/demo.yaml", "--only", "prior=none", "--twice"]);
    assert_eq!((answer.stderr.as_str(), answer.code), ("", 0));
    assert!(
        answer
            .stdout
            .contains("\nevery trial was executed twice and gave the same bytes\nresults sha256:"),
        "{}",
        answer.stdout
    );
    assert!(!desk.path("store").exists(), "--twice leaves the store alone");
}

/// What `.ci/run` probes: every shipped manifest has a lock of its bytes and its inputs' bytes as they are now.
#[test]
fn every_shipped_manifest_has_a_lock_that_is_current() {
    use reenact::compare::Lock;
    use reenact::digest::{FileDigest, Sha256Digest};
    use reenact::document::Source;
    use reenact::plan::engine_version;
    use reenact::studies::StudyKind;

    let folder = repository().join("manifests");
    let digest = |path: &Path| FileDigest(Sha256Digest::of(fs::read(path).unwrap()));
    let mut manifests = 0;
    for entry in fs::read_dir(&folder).unwrap() {
        let manifest = entry.unwrap().path();
        if manifest.extension().is_none_or(|extension| extension != "yaml") {
            continue;
        }
        manifests += 1;
        let name = manifest.file_name().unwrap().to_str().unwrap();
        let advice = format!(
            "write the lock anew with `reenact lock manifests/{name}` and say why in CHANGELOG.md"
        );
        let path = manifest.with_extension("lock");
        let text = fs::read_to_string(&path).unwrap_or_else(|e| panic!("{name}: {e}; {advice}"));
        let lock = Lock::read(&Source::new(path.display().to_string(), text))
            .unwrap_or_else(|error| panic!("{name}: {error:?}; {advice}"));
        let account = lock.account();
        assert_eq!(account.manifest, digest(&manifest), "{name} changed; {advice}");
        let source = fs::read_to_string(&manifest).unwrap();
        let study = source.lines().find_map(|line| line.strip_prefix("study: "));
        let kind = StudyKind::named(study.unwrap()).unwrap();
        assert_eq!(account.engine, engine_version(kind), "{name}: another engine; {advice}");
        // What a calibration, an inference or an earlier exploration showed is made by running it, and is no file beside the manifest.
        let made = |path: &str| {
            let endings = [".maneuvers.csv", ".passages.csv", ".proposals.jsonl", ".draws.csv"];
            endings.iter().any(|ending| path.ends_with(ending)) || path.starts_with("previous-map-")
        };
        let files = account.inputs.iter().filter(|(path, _)| !made(path));
        for (input, locked) in files {
            assert_eq!(*locked, digest(&folder.join(input)), "{name}: {input} changed; {advice}");
        }
    }
    assert!(manifests > 0);
}
