//! What a study rests on and other runs made: a forged table of robustness, a poisoned store and a calibration of itself are told,
//! by the program as its users run it.

use crate::sandbox::{Answer, Sandbox, TINY};
use reenact::runner::TrialStore;
use reenact::store::DirectoryStore;
use std::fs;
use std::path::Path;

/// Returns the tiny study with another value of one assumption, and a claim.
fn study() -> String {
    format!(
        "{TINY}  sensing: {{range-noise-sd-m: {{value: 0.01, why: unstated, range: [0.05]}}}}
claims:
  - id: T1
    says: within 20 s the robot drives at least 5 m
    paper-table: silent
    expect: {{between: {{metric: distance-m, where: {{prior: none}}, low: 5, minimum-n: 3}}}}
"
    )
}

/// Returns the bundle of a run, which must succeed.
fn sealed(at: &Sandbox, words: &[&str]) -> String {
    let answer = at.run(words);
    assert_eq!(answer.code, 0, "{}", answer.stderr);
    answer.last_line().to_owned()
}

#[test]
fn a_robustness_table_is_the_authors_word_until_its_runs_are_done_again() {
    let named = study() + "sensitivity: tiny.sensitivity.csv\n";
    let at = Sandbox::pinned().with_study(&named);
    let varied = at.run(&["vary", "tiny.yaml"]);
    assert_eq!(varied.code, 0, "{}", varied.stderr);
    let honest = at.read("tiny.sensitivity.csv");
    let bundle = sealed(&at, &["run", "tiny.yaml"]);
    let verify = |bundle: &str, more: &[&str]| {
        let words: Vec<&str> = ["verify", bundle, "--sample-seed", "5"]
            .into_iter()
            .chain(more.iter().copied())
            .collect();
        at.run(&words)
    };
    let answer = verify(&bundle, &[]);
    assert_eq!(
        (answer.code, answer.last_line()),
        (
            0,
            "reached level 3 (derived) of level 3 (derived): the bundle is what it says; the robustness table is the author's \
             word"
        )
    );
    let answer = verify(&bundle, &["--level", "4"]);
    assert_eq!(
        (answer.code, answer.last_line()),
        (
            0,
            "reached level 4 (sampled) of level 4 (sampled): the bundle is what it says; the robustness table is the author's \
             word but for 1 of its 2 rows"
        )
    );
    let answer = verify(&bundle, &["--level", "4", "--robustness", "all"]);
    assert_eq!(answer.code, 0);
    let says = "\nall 2 rows of the robustness table gave the same again\n";
    assert!(answer.stdout.contains(says), "{answer:?}");
    assert_eq!(
        answer.last_line(),
        "reached level 4 (sampled) of level 4 (sampled): the bundle is what it says"
    );

    // A verdict typed by hand, over digests of runs that were done; then digests of runs that were not.
    let row = honest.lines().nth(1).unwrap().to_owned();
    let mut fields: Vec<&str> = row.split(',').collect();
    let found = fields[6].to_owned();
    assert_ne!(found, "contradicted");
    fields[6] = "contradicted";
    let verdict = honest.replace(&row, &fields.join(","));
    let digest = honest.lines().nth(1).unwrap().rsplit(',').next().unwrap();
    let runs = honest.replace(digest, &"0123456789abcdef".repeat(4));
    for (forged, says) in [
        (
            verdict,
            format!(
                "expected {found} for the claim T1, with parameters.sensing.range-noise-sd-m at 0.05, found contradicted"
            ),
        ),
        (
            runs,
            format!(
                "expected records sha256:{digest}, with parameters.sensing.range-noise-sd-m at 0.05, found \
                 sha256:{}",
                "0123456789abcdef".repeat(4)
            ),
        ),
    ] {
        assert_ne!(forged, honest);
        at.write("tiny.sensitivity.csv", forged);
        let bundle = sealed(&at, &["run", "tiny.yaml"]);
        let Answer { code, stdout, .. } = verify(&bundle, &["--level", "5"]);
        let hint = "(the robustness table was not made by these runs: `reenact vary` makes it)";
        let finding =
            format!("error at level 4: data/inputs/tiny.sensitivity.csv: {says} {hint}\n");
        assert!(code == 1 && stdout.contains(&finding), "{stdout}");
        assert!(
            stdout.contains(
                "\n1 of 2 rows of the robustness table gave something else than the bundle holds\n"
            ),
            "{stdout}"
        );
    }

    // A table without digests of runs is read, and its verdicts are judged again all the same.
    let cells = |line: &str| line.split(',').take(7).collect::<Vec<_>>().join(",") + "\n";
    let by_hand: String = honest.lines().map(cells).collect();
    let by_hand = by_hand.replace(&format!("{found}\n"), "contradicted\n");
    at.write("tiny.sensitivity.csv", by_hand);
    let bundle = sealed(&at, &["run", "tiny.yaml"]);
    let Answer { code, stdout, .. } = verify(&bundle, &["--level", "5"]);
    assert!(code == 1 && stdout.contains(" for the claim T1, "), "{stdout}");
}

/// Puts every record of the honest store, with its first measure changed, into another store.
fn poison(honest: &Path, other: &Path, keys: &[reenact::digest::TrialKey]) {
    let (from, to) = (DirectoryStore::new(honest), DirectoryStore::new(other));
    for key in keys {
        let mut record = from.get(key).unwrap().unwrap();
        let halved = record.measures.iter().map(|(name, value)| (name, value.map(|v| 0.5 * v)));
        record.measures = halved.collect();
        to.put(&record).unwrap();
    }
}

#[test]
fn a_poisoned_store_is_found_before_anything_is_sealed() {
    let at = Sandbox::pinned().with_study(&study());
    let bundle = sealed(&at, &["run", "tiny.yaml"]);
    let zip = fs::read(at.path(&bundle)).unwrap();
    let limits = reenact::bundle::Limits::default();
    let records = reenact::bundle::Bundle::read(&zip, &limits).unwrap().records().unwrap();
    let keys: Vec<_> = records.iter().map(|record| record.key).collect();

    let Answer { code, stdout, .. } = at.run(&["run", "tiny.yaml"]);
    assert_eq!(code, 0);
    let says = "(6 from the store, 3 of them executed again: the same bytes)";
    let unwrapped = stdout.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(unwrapped.contains(says), "{stdout}");

    poison(&at.path("store"), &at.path("poisoned"), &keys);
    fs::remove_dir_all(at.path("store")).unwrap();
    fs::rename(at.path("poisoned"), at.path("store")).unwrap();
    fs::remove_file(at.path(&bundle)).unwrap();
    let Answer { code, stderr, .. } = at.run(&["run", "tiny.yaml"]);
    assert_eq!(code, 3, "{stderr}");
    let end = "with the same states throughout; 3 of 3 records that were drawn differ: the store was changed, or another \
               program wrote it, so nothing is sealed; remove the store (`reenact cache dir` says where it is), or run with \
               --no-cache\n";
    assert!(stderr.starts_with("error: trial ") && stderr.ends_with(end), "{stderr}");
    assert!(!at.path(&bundle).exists());
    assert_eq!(at.run(&["run", "tiny.yaml", "--no-cache"]).code, 0);
}

/// Returns a manifest of the deadline study that names `calibration`.
fn deadline(calibration: &str) -> String {
    format!(
        "reenact: 1\nname: d\ntitle: D\nstudy: deadline\nseed: 1\ntrials: 1\nrobot: ../robots/pioneer3at.urdf\n\
         world: {{file: ../worlds/engineering-building.yaml}}\nstart: A\ncalibration: {calibration}\n\
         settings: settings/deadline.yaml\nparameters: {{mission: {{task: exploration, deadline-s: 68}}}}\n"
    )
}

#[test]
fn a_calibration_of_itself_is_found_before_anything_runs() {
    let at = Sandbox::new().with_files(&[
        "robots/pioneer3at.urdf",
        "worlds/engineering-building.yaml",
        "manifests/settings/deadline.yaml",
    ]);
    at.write("manifests/a.yaml", deadline("b.yaml"));
    at.write("manifests/b.yaml", deadline("a.yaml"));
    at.write("manifests/self.yaml", deadline("self.yaml"));
    for (manifest, other, asks) in [("a", "b", "a"), ("self", "self", "self")] {
        let path = format!("manifests/{manifest}.yaml");
        for command in ["check", "run"] {
            let Answer { code, stderr, .. } = at.run(&[command, &path]);
            assert_eq!(code, 2, "{stderr}");
            let says = format!(
                "`{other}.yaml` is read as a calibration and asks for the calibration `{asks}.yaml`"
            );
            assert!(stderr.contains(&says), "{stderr}");
            let help = "a calibration measures isolated passages: `mission: {task: passage}`, no `calibration`";
            assert!(stderr.contains(help), "{stderr}");
        }
    }
    assert!(!at.path("store").exists(), "nothing was simulated");
}
