//! The store as people look after it: whole or not, tidied up, moved to another site.

use crate::sandbox::{Answer, Sandbox, TINY};
use std::fs;

fn place() -> Sandbox {
    let place = Sandbox::pinned().with_study(TINY);
    place.done(&["run", "tiny.yaml", "--no-seal"]);
    place
}

/// Runs `words` on another store.
fn there(place: &Sandbox, words: &[&str]) -> Answer {
    Answer::of(place.command(words).env("REENACT_STORE", place.path("there")))
}

#[test]
fn a_store_is_verified_and_tidied_up() {
    let place = place();
    assert_eq!(
        place.done(&["cache", "verify"]),
        "6 trials in 1 file, every record has its digest\n"
    );
    let segments = place.path("store/segments");
    let whole = place.records("store").concat();
    let damaged = whole.lines().next().unwrap().replacen("\"trial\":0", "\"trial\":1", 1);
    assert!(!whole.contains(&damaged));
    fs::write(segments.join("pack-0.jsonl"), format!("{whole}{damaged}\n{{}}\n{{\"key\":\"12"))
        .unwrap();
    let path = segments.join("pack-0.jsonl");
    let (path, key) = (path.display(), &damaged[8..72]);
    let answer = place.run(&["cache", "verify"]);
    assert_eq!(
        (answer.stdout.as_str(), answer.code),
        (
            format!(
                "{path}:7: expected a whole record, found a record of {key} that does not have its digest\n\
                 {path}:8: expected a whole record, found something that is no record\n\
                 {path}:9: expected a whole record, found a line that was never finished\n\
                 6 trials in 2 files, every record has its digest; 6 records of them again, the same; 3 faults: no run uses them; \
                 `reenact cache gc` removes what is damaged\n"
            )
            .as_str(),
            1
        )
    );
    let told = place.run(&["cache", "verify", "--format", "json"]).stdout;
    let told: serde_json::Value = serde_json::from_str(&told).unwrap();
    assert_eq!(
        (&told["trials"], &told["repeated"], &told["files"]),
        (&6.into(), &6.into(), &2.into())
    );
    assert_eq!((&told["unfinished"], &told["damage"][1]["line"]), (&0.into(), &8.into()));
    let freed = whole.len() + damaged.len() + 1 + 3 + 10;
    assert_eq!(
        place.done(&["cache", "gc"]),
        format!(
            "put 2 files together: 6 records, 6 more that were there twice, 3 damaged lines; {freed} bytes freed\n"
        )
    );
    assert_eq!(
        place.done(&["cache", "verify"]),
        "6 trials in 1 file, every record has its digest\n"
    );
    let nothing = "put 0 files together: 0 records, 0 more that were there twice, 0 damaged lines; 0 bytes freed\n";
    assert_eq!(place.done(&["cache", "gc"]), nothing);
    let sealed = place.done(&["run", "tiny.yaml", "--format", "json"]);
    assert!(sealed.contains("\"cached\":6,"), "{sealed}");
}

#[test]
fn records_move_to_another_site_whole_or_not_at_all() {
    let place = place();
    assert_eq!(place.done(&["cache", "export", "-o", "all.pack"]), "all.pack: 6 trials\n");
    let some = ["cache", "export", "tiny.yaml", "--set", "seed=8", "--output", "some.pack"];
    let answer = place.run(&some);
    assert_eq!(
        (answer.stderr.as_str(), answer.code),
        ("error: the store has none of these trials, so `some.pack` is not written\n", 2)
    );
    let export = ["cache", "export", "tiny.yaml", "-o", "tiny.pack"];
    assert_eq!(place.done(&export), "tiny.pack: 6 of 6 trials\n");
    assert_eq!(
        fs::read(place.path("all.pack")).unwrap(),
        fs::read(place.path("tiny.pack")).unwrap()
    );
    let pack = place.read("all.pack");
    place.write("cut.pack", &pack[..pack.len() - 50]);
    let import = ["cache", "import", "all.pack"];
    let refused = there(&place, &["cache", "import", "cut.pack"]);
    assert_eq!(
        (refused.stderr.as_str(), refused.code),
        (
            "error: cut.pack: line 8: expected the last line of a pack, found the end of the file: it did not arrive whole; fetch \
             it again\n",
            1
        )
    );
    let refused = there(&place, &["cache", "import", "tiny.yaml"]);
    assert_eq!(
        (refused.stderr.as_str(), refused.code),
        (
            "error: tiny.yaml: line 1: expected a pack of records (`reenact cache export`), found something else\n",
            2
        )
    );
    assert_eq!(there(&place, &["cache", "size"]).stdout, "0 trials, 0 bytes\n");
    assert_eq!(there(&place, &import).stdout, "all.pack: 6 records, 6 of them new\n");
    assert_eq!(there(&place, &import).stdout, "all.pack: 6 records, 0 of them new\n");
    // With nothing simulated, both sites seal the same.
    let here = place.done(&["run", "tiny.yaml", "--out", "here", "--format", "json"]);
    let moved = there(&place, &["run", "tiny.yaml", "--out", "moved", "--format", "json"]);
    let digest = |line: &str| {
        let told: serde_json::Value = serde_json::from_str(line).unwrap();
        (told["results_digest"].clone(), told["cached"].clone())
    };
    assert_eq!(digest(&here), digest(&moved.stdout));
    assert_eq!(digest(&here).1, 6);
    let other = place.run(&["cache", "import", "absent.pack"]);
    assert_eq!(other.stderr, "error: cannot read `absent.pack`: no such file\n");
}
