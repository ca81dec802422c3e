//! Claims from the command line: their power before a run, their verdicts after it, and where each is kept.

use crate::sandbox::{Answer, PINNED, Sandbox};

/// Returns what the program wrote to stdout with its clock pinned; it must have ended well and said nothing else.
fn done_pinned(desk: &Sandbox, words: &[&str]) -> String {
    let answer = Answer::of(desk.command(words).env("SOURCE_DATE_EPOCH", PINNED));
    assert_eq!((answer.stderr.as_str(), answer.code), ("", 0));
    answer.stdout
}

/// Creates a starter study of two trials that makes these claims.
fn study(claims: &str) -> Sandbox {
    let desk = Sandbox::new().with_demo();
    let text = desk.read("demo/demo.yaml").replace("trials: 10", "trials: 5");
    let (text, _) = text.split_once("claims:\n").unwrap();
    desk.write("demo/demo.yaml", format!("{text}claims:\n{claims}"));
    desk
}

const PAGE: &str = include_str!("../docs/claims.md");

#[test]
fn power_is_answered_as_documented() {
    let blocks = PAGE.split("\n```yaml\n").skip(1).filter_map(|rest| rest.split_once("\n```\n"));
    let example = blocks.map(|(block, _)| block).find(|block| block.contains("power:")).unwrap();
    let desk = study(&format!("{example}\n"));
    let answer = done_pinned(&desk, &["plan", "demo/demo.yaml", "--power"]);
    assert!(
        PAGE.contains(&format!("\n```\n{answer}```\n")),
        "docs/claims.md should show:\n{answer}"
    );
    let words = ["plan", "demo/demo.yaml", "--power", "--format", "json"];
    let line: serde_json::Value = serde_json::from_str(&done_pinned(&desk, &words)).unwrap();
    assert_eq!((&line["planned"], &line["studies"]), (&5.into(), &200.into()));
    let claim = &line["claims"][0];
    assert_eq!((&claim["id"], &claim["enough"]), (&"P1".into(), &20.into()));
    assert_eq!(claim["ladder"].as_array().unwrap().len(), 2);
    assert_eq!(claim["planned"]["trials"], 5);
}

const CLAIMS: &str = "\
- id: P1
  says: the floor plan shortens exploration
  paper-table: supports
  expect: {less: {metric: distance-m-at-80, where: {prior: floor-plan}, than: {where: {prior: none}}}}
- id: P21
  says: a selection takes milliseconds
  paper-table: silent
  circumstance: true
  expect: {between: {metric: wall-time-s-per-selection, statistic: median, high: 1000, minimum-n: 2}}
";

/// Returns the bytes of a file of a bundle that was exported as a folder.
fn sealed(desk: &Sandbox, bundle: &str, path: &str) -> Option<String> {
    std::fs::read_to_string(desk.path(bundle).join("data").join(path)).ok()
}

#[test]
fn claims_about_the_machine_are_circumstances() {
    let desk = study(CLAIMS);
    let words = ["run", "demo/demo.yaml", "--set", "trials=1"];
    let measured = desk.done(&words);
    let told = "\
Claims of the paper
  claim  we find           paper's table
  P1     cannot be tested  supports
         (prior=floor-plan) has 1 runs to compare, fewer than the minimum of 10
reproduction: 0 of 1 claims of the paper supported, 0 contradicted, 0
inconclusive, 1 cannot be tested

Claims of the paper about the machine (not among the results)
  claim  we find           paper's table
  P21    inconclusive      silent
";
    assert!(measured.contains(told), "{measured}");
    let bundle = measured.lines().last().unwrap();
    let exported = desk.done(&["export", bundle, "--dir", "-o", "measured"]);
    let exported = exported.lines().last().unwrap();
    let results = sealed(&desk, exported, "results/claims.json").unwrap();
    assert!(results.contains("\"id\":\"P1\"") && !results.contains("P21"), "{results}");
    let verdicts = sealed(&desk, exported, "circumstances/claims.json").unwrap();
    assert!(verdicts.contains("\"id\":\"P21\"") && !verdicts.contains("\"P1\""), "{verdicts}");
    let times = sealed(&desk, exported, "circumstances/wall-times.csv").unwrap();
    let head = "key,prior,trial,outcome,wall-time-s,wall-time-s-per-selection,wall-time-s-longest-selection";
    assert_eq!((times.lines().next(), times.lines().count()), (Some(head), 3));
    // Verification derives everything else and says that it cannot derive this.
    let answer = desk.done(&["verify", bundle]);
    let note = "note at level 3: data/circumstances/: expected what follows from the records, found what the machine of \
                the run measured, and verdicts on it (no part of the results; checksums hold it, nothing can derive it again)";
    assert!(answer.contains(note), "{answer}");
    desk.done(&["report", bundle, "-o", "page.html"]);
    let page = desk.read("page.html");
    assert!(page.contains("id=\"claims\"") && page.contains("id=\"machine-claims\""));

    // From the store nothing is measured, and what was not measured is not passed over.
    let stored = desk.done(&words);
    let unmeasured = "  P21    cannot be tested  silent
         2 of 2 runs of (all trials) never reached wall-time-s-per-selection;
         say with `censored` whether those that did are compared (reached-only)
         or the others rank last (worst)
";
    assert!(stored.contains(unmeasured), "{stored}");

    // Pinned neither, and the results are the same; a lock, whatever it blesses, changes no score.
    desk.write("demo/demo.lock", "verdicts: {P1: supported}\n");
    let pinned = done_pinned(&desk, &words);
    let unmeasured = "  P21    cannot be tested  silent
         wall times are not measured where SOURCE_DATE_EPOCH is set
";
    assert!(pinned.contains(unmeasured), "{pinned}");
    let score =
        |answer: &str| answer.lines().find(|l| l.starts_with("reproduction:")).map(str::to_owned);
    assert_eq!(score(&pinned), score(&measured));
    let digest = |answer: &str| answer.lines().rev().nth(1).map(str::to_owned);
    assert_eq!(digest(&pinned), digest(&measured));
    let bundle = pinned.lines().last().unwrap();
    let exported = done_pinned(&desk, &["export", bundle, "--dir", "-o", "pinned"]);
    let exported = exported.lines().last().unwrap();
    assert_eq!(sealed(&desk, exported, "circumstances/wall-times.csv"), None);
    assert_eq!(sealed(&desk, exported, "results/claims.json"), Some(results));
}

#[test]
fn verdicts_that_hang_on_an_assumption_are_found_sealed_and_told() {
    let desk = study("\
- id: fast
  says: nine tenths are explored within minutes
  paper-table: silent
  expect: {between: {metric: time-s-at-90, statistic: median, high: 500, minimum-n: 2, censored: worst}}
- id: far
  says: nobody travels a kilometre
  paper-table: silent
  expect: {between: {metric: distance-m, statistic: median, high: 1000, minimum-n: 2}}
parameters:
  mission: {time-limit-s: {value: 600, range: [5, 900], why: nobody says when to give up}}
");
    let words = ["vary", "demo/demo.yaml", "--trials", "3"];
    let told = "\
parameters.mission.time-limit-s 600 -> 5:
  fast: supported -> contradicted
parameters.mission.time-limit-s 600 -> 900: no verdict changes
wrote demo/demo.sensitivity.csv: 2 claims judged at 2 other values of 1 setting, 3 trials per condition
add `sensitivity: demo.sensitivity.csv` to the manifest, so that bundles and reports tell it
";
    assert_eq!(done_pinned(&desk, &words), told);
    let table = desk.read("demo/demo.sensitivity.csv");
    assert_eq!(table.lines().count(), 5, "{table}");

    let text = desk.read("demo/demo.yaml") + "sensitivity: demo.sensitivity.csv\n";
    desk.write("demo/demo.yaml", &text);
    let again = done_pinned(&desk, &words);
    assert!(!again.contains("add `sensitivity"), "{again}");
    assert_eq!(desk.read("demo/demo.sensitivity.csv"), table);
    done_pinned(&desk, &["check", "demo/demo.yaml"]);

    // What was tried around another value is out of date: said, and not shown.
    desk.edit("demo/demo.yaml", "value: 600", "value: 700");
    let answer = desk.run(&["check", "demo/demo.yaml"]);
    let expected = "\
warning: `demo.sensitivity.csv` is out of date: parameters.mission.time-limit-s was tried around 600, it is 700 now";
    assert_eq!((answer.stderr.lines().next(), answer.code), (Some(expected), 0), "{answer:?}");
}
