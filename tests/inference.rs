//! Inferences from the outside: the whole text, the same bytes for any number of threads, sealed and verified like any study.

use crate::adversary::forger;
use crate::sandbox::Sandbox;
use reenact::bundle::{Form, Limits, Tree, archive};
#[cfg(unix)]
use std::{process::Stdio, time::Duration};

/// Two buildings, few walks.
pub(crate) const TINY: &str = "
reenact: 1
name: tiny
title: A tiny inference
license: CC-BY-4.0
study: deadline
seed: 11
trials: 1
robot: robots/pioneer3at.urdf
world: {generate: {family: office-floor, seed: {factor: building}}}
start: A
factors: {building: [1, 2]}
parameters:
  mission: {simulation: graph}
  graph: {entry-hazard: 0.03, corridor-hazard: 0.001, corridor-slow-s: 12, corridor-fast-s: 8, door-slow-s: 12, door-fast-s: 8}
published:
  success-percent: manifests/reference/deadline-success.csv
  collision-percent: manifests/reference/deadline-collision.csv
infer:
  observed: {reached: success-percent, collided: collision-percent}
  by: [start, deadline-s, strategy]
  left-out:
    - {where: {start: C, deadline-s: 563, strategy: random}, why: booked otherwise}
  priors:
    rules.frontier.ties: {values: [uniform, nearest], literal: uniform}
    graph.entry-hazard: {log-uniform: [0.005, 0.08]}
  concentration: [12]
  walks: 2
  points: 3
  draws: 2
  simulated-tables: 2
  hold-out: [chequerboard, start]
  baseline: [start, strategy]
";

/// The digest of its results. To be minted anew only where a change of proposals or of their tables is meant, with a line in
/// the CHANGELOG that says why.
const GOLDEN: &str =
    "results sha256:38c69bbbd27508ebf6600308dd53f9ba75fc6954d568ef1d08991a0ddcf69f44";

fn desk() -> Sandbox {
    let desk = Sandbox::pinned().with_files(&[
        "robots/pioneer3at.urdf",
        "manifests/reference/deadline-success.csv",
        "manifests/reference/deadline-collision.csv",
    ]);
    desk.write("tiny.yaml", TINY);
    desk
}

/// Makes the inference, which may take long enough to tell how far it is, and returns its stdout.
fn inferred(desk: &Sandbox, more: &[&str]) -> String {
    let answer = desk.run(&[&["infer", "tiny.yaml"], more].concat());
    assert_eq!(answer.code, 0, "{}", answer.stderr);
    answer.stdout
}

fn digest(stdout: &str) -> &str {
    stdout.lines().find(|line| line.starts_with("results sha256:")).unwrap()
}

#[test]
fn an_inference_says_what_it_found_and_what_it_is_worth() {
    let stdout = inferred(&desk(), &["-j", "1", "--no-cache"]);
    let (text, _) = stdout.split_once("2 trials:").unwrap();
    insta::assert_snapshot!(text);
    assert_eq!(
        digest(&stdout),
        GOLDEN,
        "the bytes of an inference changed; where a change of proposals or of their tables is meant, mint the digest here anew and \
         say why in the CHANGELOG; where it is not, this is a fault of determinism"
    );
}

/// However it is run: on one thread or two, and one building long before the other.
#[test]
fn threads_and_order_leave_no_mark_and_it_verifies_to_the_top() {
    let desk = desk();
    let one = inferred(&desk, &["-j", "1", "--no-cache"]);
    let two = inferred(&desk, &["-j", "2", "--no-cache"]);
    assert_eq!(digest(&one), digest(&two));
    let part = inferred(&desk, &["--only", "building=2"]);
    assert!(part.contains("1 trial: 1 proposed"), "{part}");
    assert_ne!(digest(&part), digest(&one), "one building says less than two");
    let (whole, cached) = told(&desk);
    assert_eq!((whole.as_str(), cached), (&digest(&one)["results ".len()..], 1));
    let bundle = two.lines().last().unwrap();
    let verified = desk.run(&["verify", bundle, "--level", "5"]);
    assert_eq!(verified.code, 0, "{}{}", verified.stdout, verified.stderr);
    assert!(verified.stdout.contains("reached level 5"), "{}", verified.stdout);
}

/// Everything is made right again but what would have to be proposed again: that it does not follow is seen at level 3.
#[test]
fn draws_and_proposals_that_nobody_made_are_refused() {
    let desk = desk();
    let bundle = inferred(&desk, &[]);
    let bytes = std::fs::read(desk.path(bundle.lines().last().unwrap())).unwrap();
    let honest = archive::read(&bytes, &Limits::default()).unwrap().tree;
    let verified = |tree: &Tree, level: &str| {
        desk.write("forged.zip", archive::write(tree, "forged", Form::Bag));
        let answer = desk.run(&["verify", "forged.zip", "--level", level]);
        (answer.stdout, answer.code)
    };
    let table = "data/results/tables/posterior.csv";

    let mut tree = honest.clone();
    forger::set_cell(&mut tree, table, 1, "rmse", "1.5");
    let (said, code) = verified(&tree, "1");
    assert_eq!(code, 1, "{said}");
    assert!(said.contains(table), "{said}");

    forger::reseal(&mut tree);
    let (said, code) = verified(&tree, "3");
    assert_eq!(code, 1, "{said}");
    let expected = "data/results/tables/posterior.csv: expected `";
    assert!(
        said.contains(expected) && said.contains("column `rmse`, as the records give"),
        "{said}"
    );

    // A proposal that likes its building better, and all that follows from it: nothing but another proposal tells.
    let mut tree = honest;
    forger::set_records(&mut tree, "1", |records| {
        records[0]["measures"]["evidence-00"] = serde_json::json!(-1.5);
    });
    forger::reseal(&mut tree);
    let forged = forger::rederive(tree);
    let (said, code) = verified(&forged, "3");
    assert_eq!(code, 0, "{said}");
    let (said, code) = verified(&forged, "5");
    assert_eq!(code, 1, "{said}");
    assert!(said.contains("evidence-00"), "{said}");
}

/// Returns what a whole inference says of itself: its digest, and how many proposals it found in the store.
fn told(desk: &Sandbox) -> (String, u64) {
    let told = inferred(desk, &["--format", "json"]);
    let told: serde_json::Value = serde_json::from_str(&told).unwrap();
    (told["results_digest"].as_str().unwrap().to_owned(), told["cached"].as_u64().unwrap())
}

#[cfg(unix)]
#[test]
fn a_killed_inference_goes_on_where_it_was() {
    let study = TINY.replace("building: [1, 2]", "building: [1, 2, 3, 4]");
    let (killed, undisturbed) = (desk(), desk());
    for desk in [&killed, &undisturbed] {
        desk.write("tiny.yaml", &study);
    }
    let mut child = killed
        .command(&["infer", "tiny.yaml", "-j", "1"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    while killed.records("store").is_empty() {
        assert!(child.try_wait().unwrap().is_none(), "it ended before anything was stored");
        std::thread::sleep(Duration::from_millis(2));
    }
    child.kill().unwrap();
    let _ = child.wait().unwrap();
    let stored = killed.records("store").len() as u64;
    let (digest, cached) = told(&killed);
    assert_eq!(cached, stored, "a kill loses nothing that was finished");
    assert!((1..4).contains(&stored), "{stored} of 4 were stored");
    assert_eq!((digest, 0), told(&undisturbed));
}

#[test]
fn a_manifest_without_a_question_is_refused() {
    let desk = Sandbox::pinned().with_demo();
    let answer = desk.run(&["infer", "demo/demo.yaml"]);
    assert_eq!(
        (answer.stderr.as_str(), answer.code),
        (
            "error: demo/demo.yaml: there is nothing to infer; add `infer:` with the table that is to be explained and what is not \
             known (docs/inference.md)\n",
            2
        )
    );
}
