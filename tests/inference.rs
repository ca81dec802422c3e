//! Inferences from the outside: the whole text, the same bytes for any number of threads, sealed and verified like any study.

use crate::sandbox::Sandbox;

/// Two buildings, few walks.
const TINY: &str = "
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

/// The digest of its results. To be minted anew only where a change of the bytes of proposals is meant, with a line in the
/// CHANGELOG that says why.
const GOLDEN: &str = "results sha256:";

fn desk() -> Sandbox {
    let desk = Sandbox::pinned().with_files(&[
        "robots/pioneer3at.urdf",
        "manifests/reference/deadline-success.csv",
        "manifests/reference/deadline-collision.csv",
    ]);
    desk.write("tiny.yaml", TINY);
    desk
}

fn digest(stdout: &str) -> &str {
    stdout.lines().find(|line| line.starts_with("results sha256:")).unwrap()
}

#[test]
fn an_inference_says_what_it_found_and_what_it_is_worth() {
    let answer = desk().run(&["infer", "tiny.yaml", "-j", "1", "--no-cache"]);
    assert_eq!((answer.stderr.as_str(), answer.code), ("", 0));
    let (text, _) = answer.stdout.split_once("2 trials:").unwrap();
    insta::assert_snapshot!(text);
    let found = digest(&answer.stdout);
    assert!(
        found.starts_with(GOLDEN),
        "the bytes of proposals changed: {found}; where that is meant, mint the digest here anew and say why in the CHANGELOG"
    );
}

#[test]
fn it_is_the_same_for_any_number_of_threads_and_can_be_verified_to_the_top() {
    let desk = desk();
    let one = desk.done(&["infer", "tiny.yaml", "-j", "1", "--no-cache"]);
    let two = desk.done(&["infer", "tiny.yaml", "-j", "2"]);
    assert_eq!(digest(&one), digest(&two));
    let bundle = two.lines().last().unwrap().to_owned();
    let verified = desk.run(&["verify", &bundle, "--level", "5"]);
    assert_eq!(verified.code, 0, "{}{}", verified.stdout, verified.stderr);
    let part = desk.done(&["infer", "tiny.yaml", "--only", "building=2"]);
    assert!(part.contains("1 proposed"), "{part}");
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
