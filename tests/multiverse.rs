//! All assumptions drawn at once, by the program as its users run it: what it says and writes, and that nobody has to believe it.

use crate::sandbox::{Answer, Sandbox, TINY};
use crate::schemas::assert_answers;
use std::fs;

/// Returns the tiny study with two choices left open, of which the first decides the first claim.
fn study() -> String {
    let parameters = TINY.replace(
        "mission: {time-limit-s: 20}",
        "mission: {time-limit-s: {value: 20, why: unstated, range: [4, 24]}}\n  \
         mapping: {origin: {value: corner, why: unstated, range: [centre]}}",
    );
    assert_ne!(parameters, TINY);
    format!(
        "{parameters}claims:
  - id: T1
    says: the robot drives at least 3 m
    paper-table: silent
    expect: {{between: {{metric: distance-m, where: {{prior: none}}, low: 3, minimum-n: 3}}}}
  - id: T2
    says: nobody travels a kilometre
    paper-table: silent
    expect: {{between: {{metric: distance-m, high: 1000, minimum-n: 3}}}}
"
    )
}

/// Returns the answer to `vary tiny.yaml` with these words, which must be yes.
fn drawn(at: &Sandbox, words: &[&str]) -> String {
    let words: Vec<&str> = ["vary", "tiny.yaml"].iter().chain(words).copied().collect();
    let Answer { stdout, stderr, code, .. } = at.run(&words);
    assert_eq!(code, 0, "{stderr}");
    stdout
}

#[test]
fn draws_are_made_told_and_written() {
    let at = Sandbox::pinned().with_study(&study());
    insta::assert_snapshot!(drawn(&at, &["--joint", "16"]));
    let table = at.read("tiny.multiverse.csv");
    assert_eq!(table.lines().count(), 18, "{table}");
    insta::assert_snapshot!("the_table_of_the_draws", table);

    // Neither the store, nor the number of threads, nor whether the manifest names it changes a byte.
    at.write("tiny.yaml", study() + "multiverse: tiny.multiverse.csv\n");
    fs::remove_dir_all(at.path("store")).unwrap();
    let again = drawn(&at, &["--joint", "16", "--jobs", "1"]);
    assert!(!again.contains("add `multiverse"), "{again}");
    assert_eq!(at.read("tiny.multiverse.csv"), table);
    let Answer { stderr, code, .. } = at.run(&["check", "tiny.yaml"]);
    assert_eq!((stderr.as_str(), code), ("", 0));

    // Another seed makes other draws of the same trials.
    drawn(&at, &["--joint", "2", "--seed", "8", "--trials", "1"]);
    let other = at.read("tiny.multiverse.csv");
    assert!(other.lines().nth(1).unwrap().starts_with("chosen,8,1,,"), "{other}");

    // What was drawn over other ranges is out of date: said, by the first draw that is not what the seed draws now.
    at.write("tiny.multiverse.csv", &table);
    at.edit("tiny.yaml", "range: [4, 24]", "range: [4, 30]");
    let answer = at.run(&["check", "tiny.yaml"]);
    let first = answer.stderr.lines().next().unwrap();
    let expected = "warning: `tiny.multiverse.csv` is out of date: draw 0 is not parameters.mission.time-limit-s at ";
    assert!(answer.code == 0 && first.starts_with(expected), "{answer:?}");
}

#[test]
fn draws_that_the_manifest_refuses_are_named_and_counted_for_nothing() {
    let open =
        "exploration: {strategy: {value: utility, why: unstated, range: [topo-metric-tour]}}";
    let at = Sandbox::pinned()
        .with_study(&study().replace("claims:\n", &format!("  {open}\nclaims:\n")));
    insta::assert_snapshot!(drawn(&at, &["--joint", "4", "--trials", "3"]));
}

#[test]
fn what_cannot_be_drawn_is_refused_in_a_sentence() {
    let at = Sandbox::pinned().with_study(&study());
    for (words, expected) in [
        (vec!["--joint", "0"], "error: `--joint` must be at least 1, found 0\n"),
        (
            vec!["--joint", "1000000"],
            "error: `--joint` must be less than 1000000 for 2 choices and 2 claims, found 1000000\n",
        ),
        (
            vec!["--joint", "2", "--seed", "9223372036854775808"],
            "error: `--seed` must be at most 9223372036854775807 to be recorded in a table, found 9223372036854775808; give a \
             smaller one\n",
        ),
    ] {
        let words: Vec<&str> = ["vary", "tiny.yaml"].into_iter().chain(words).collect();
        let Answer { stdout, stderr, code, .. } = at.run(&words);
        assert_eq!((stdout.as_str(), stderr.as_str(), code), ("", expected, 2));
    }
    at.edit("tiny.yaml", "seed: 7", "seed: 18446744073709551615");
    let Answer { stderr, code, .. } = at.run(&["vary", "tiny.yaml", "--joint", "2"]);
    let expected = "error: the manifest's seed must be at most 9223372036854775807 to be recorded in a table, found \
                    18446744073709551615; give another for the draws with `--seed`\n";
    assert_eq!((stderr.as_str(), code), (expected, 2));
    at.write("tiny.yaml", TINY);
    let Answer { stderr, code, .. } = at.run(&["vary", "tiny.yaml", "--joint", "2"]);
    assert!(code == 2 && stderr.contains("no assumption states a `range`"), "{stderr}");
}

#[test]
fn a_multiverse_table_is_the_authors_word_until_its_draws_are_done_again() {
    let at = Sandbox::pinned().with_study(&(study() + "multiverse: tiny.multiverse.csv\n"));
    drawn(&at, &["--joint", "8"]);
    let honest = at.read("tiny.multiverse.csv");
    let sealed = || {
        let answer = at.run(&["run", "tiny.yaml"]);
        assert_eq!(answer.code, 0, "{}", answer.stderr);
        answer.last_line().to_owned()
    };
    let bundle = sealed();
    let verify = |bundle: &str, more: &[&str]| {
        let words = ["verify", bundle, "--sample-seed", "5"];
        at.run(&words.iter().chain(more).copied().collect::<Vec<_>>())
    };
    let last = |answer: &Answer| (answer.code, answer.last_line().to_owned());
    assert_eq!(
        last(&verify(&bundle, &[])),
        (
            0,
            "reached level 3 (derived) of level 3 (derived): the bundle is what it says; the multiverse table is the author's \
             word"
                .to_owned()
        )
    );
    let answer = verify(&bundle, &["--level", "4", "--robustness", "all"]);
    assert!(answer.stdout.contains("\nall 9 rows of the multiverse table gave the same again\n"));
    assert_eq!(
        last(&answer),
        (
            0,
            "reached level 4 (sampled) of level 4 (sampled): the bundle is what it says".to_owned()
        )
    );
    let exported = at.run(&["export", &bundle, "--dir", "-o", "unpacked"]);
    let folder = format!("{}/data/results", exported.last_line());
    let document = at.read(&format!("{folder}/multiverse.md"));
    assert!(document.starts_with("# Claims where all choices change at once\n"), "{document}");
    let tidy = at.read(&format!("{folder}/multiverse.csv"));
    assert_eq!(tidy.lines().count(), 5, "{tidy}");
    at.run(&["report", &bundle, "-o", "page.html"]);
    assert!(at.read("page.html").contains("id=\"multiverse\""));

    // A verdict typed by hand, a value that no seed drew, and a refusal that nobody gave.
    let row = honest.lines().nth(4).unwrap();
    let with = |column: usize, text: &str| {
        let mut fields: Vec<&str> = row.split(',').collect();
        assert_ne!(fields[column], text);
        fields[column] = text;
        honest.replace(row, &fields.join(","))
    };
    let refused = {
        let fields: Vec<&str> = row.split(',').collect();
        let empty = [
            fields[0],
            fields[1],
            fields[2],
            "too short",
            "",
            fields[5],
            fields[6],
            "",
            "",
            "",
            "",
        ];
        honest.replace(row, &empty.join(","))
    };
    for (forged, says) in [
        (with(9, "contradicted"), "for the claim T2, at draw 2, found contradicted"),
        (with(5, "17.5"), ", as seed 7 draws it, at draw 2, found at 17.5"),
        (refused, "expected verdicts, at draw 2, found refused: too short"),
    ] {
        at.write("tiny.multiverse.csv", forged);
        let Answer { code, stdout, .. } =
            verify(&sealed(), &["--level", "5", "--robustness", "all"]);
        let place = "error at level 4: data/inputs/tiny.multiverse.csv:5: ";
        let hint =
            "(the multiverse table was not made by these runs: `reenact vary --joint` makes it)";
        let found = stdout.lines().find(|line| line.starts_with(place)).unwrap_or_default();
        assert!(code == 1 && found.contains(says) && found.ends_with(hint), "{stdout}");
        let counted =
            "\n1 of 9 rows of the multiverse table gave something else than the bundle holds\n";
        assert!(stdout.contains(counted), "{stdout}");
    }
}

#[test]
fn what_is_found_is_told_to_programs_in_one_line() {
    let at = Sandbox::pinned().with_study(&study());
    let one = drawn(&at, &["--format", "json"]);
    let one = &assert_answers("vary", &one)[0];
    assert_eq!(
        (&one["path"], &one["named_in_manifest"]),
        (&"tiny.sensitivity.csv".into(), &false.into())
    );
    assert_eq!(one["verdicts"], serde_json::json!({"T1": "supported", "T2": "supported"}));
    let told: Vec<String> = one["attempts"]
        .as_array()
        .unwrap()
        .iter()
        .map(|tried| format!("{} {}: {}", tried["setting"], tried["tried"], tried["changes"]))
        .collect();
    assert_eq!(
        told,
        [
            r#""parameters.mapping.origin" "centre": []"#,
            r#""parameters.mission.time-limit-s" "4": [{"claim":"T1","from":"supported","to":"cannot-be-tested"},{"claim":"T2","from":"supported","to":"cannot-be-tested"}]"#,
            r#""parameters.mission.time-limit-s" "24": []"#,
        ]
    );

    at.write("tiny.yaml", study() + "multiverse: tiny.multiverse.csv\n");
    let all = drawn(&at, &["--joint", "16", "--format", "json"]);
    let all = &assert_answers("vary-joint", &all)[0];
    assert_eq!((&all["draws"], &all["seed"]), (&16.into(), &7.into()));
    assert_eq!(
        (&all["named_in_manifest"], &all["records_digest"]),
        (&true.into(), &one["records_digest"])
    );
    let claim = &all["claims"][0];
    assert_eq!(
        (&claim["claim"], &claim["most_by"]),
        (&"T1".into(), &"parameters.mission.time-limit-s".into())
    );
    let count = |key: &str| claim[key].as_u64().unwrap();
    let counted = count("supported") + count("contradicted") + count("inconclusive");
    assert_eq!(counted + count("cannot_be_tested"), 16, "{claim}");
}
