//! Inferences from trials from the outside: the whole text, the same bytes for any number of threads, sealed and verified like any
//! study, with ordinary tables beside.

use crate::adversary::forger;
use crate::sandbox::Sandbox;
use reenact::bundle::{Form, Limits, archive};

/// Two choices in the apartment without furniture, two runs each, with and without its floor plan.
const TINY: &str = "
reenact: 1
name: tiny
title: A tiny inference from trials
license: CC-BY-4.0
study: prior-map
seed: 7
trials: 2
robot: robots/kobuki.urdf
world: {file: worlds/basic.yaml, layers: [walls]}
start: {x-m: 3, y-m: 2}
factors:
  reselect: [on-arrival, continuous]
  candidate: [middle, nearest-to-centroid]
  prior: [none, floor-plan]
prior-maps:
  floor-plan: {floor-plan-of: world}
parameters:
  sensing: {range-m: 10, range-noise-sd-m: 0.01}
  mapping: {no-return: nothing}
  exploration: {reselect: {factor: reselect}, candidate: {factor: candidate}}
  mission: {stop-at-coverage-percent: 95, start-jitter-m: 0.1, start-jitter-deg: 5}
published:
  distance-m: {file: manifests/reference/prior-table-1-basic-unfurnished.csv, for-all: [reselect, candidate]}
tables:
  - id: distance
    title: Distance travelled (m)
    coverage-table:
      {metric: distance-m, at: [70, 95], by: prior, baseline: none, rows: [reselect, candidate], published: distance-m}
infer:
  choices:
    reselect: {literal: on-arrival, why: section 3.1}
    candidate: {literal: middle}
  observed: {distance-m: distance-m}
  by: [prior]
  left-out:
    - {where: {prior: none, coverage-percent: 70}, why: so that one is}
  model-error: [0.05, 0.2]
  arm-error: [0, 0.2]
  table-error: [0]
  simulated-tables: 20
  hold-out: [chequerboard, arm]
  baseline: [coverage-percent]
";

fn desk() -> Sandbox {
    let desk = Sandbox::pinned().with_files(&[
        "robots/kobuki.urdf",
        "worlds/basic.yaml",
        "manifests/reference/prior-table-1-basic-unfurnished.csv",
    ]);
    desk.write("tiny.yaml", TINY);
    desk
}

fn inferred(desk: &Sandbox, more: &[&str]) -> String {
    let answer = desk.run(&[&["infer", "tiny.yaml"], more].concat());
    assert_eq!(answer.code, 0, "{}", answer.stderr);
    answer.stdout
}

fn digest(stdout: &str) -> &str {
    stdout.lines().find(|line| line.starts_with("results sha256:")).unwrap()
}

/// All tables of the bundle as documents have them, one after the other.
fn documents(desk: &Sandbox, stdout: &str) -> String {
    let bytes = std::fs::read(desk.path(stdout.lines().last().unwrap())).unwrap();
    let tree = archive::read(&bytes, &Limits::default()).unwrap().tree;
    let tables =
        ["summary", "choices", "combinations", "cells", "held-out", "simulated", "replicate"];
    tables
        .map(|id| {
            let path = format!("data/results/tables/{id}.md");
            String::from_utf8(tree.get(&path).unwrap().clone()).unwrap()
        })
        .join("\n")
}

#[test]
fn an_inference_from_trials_says_what_it_found_and_what_it_is_worth() {
    let desk = desk();
    let one = inferred(&desk, &["-j", "1", "--no-cache"]);
    let (text, _) = one.split_once("16 trials:").unwrap();
    insta::assert_snapshot!("terminal", text);
    insta::assert_snapshot!("documents", documents(&desk, &one));
    let two = inferred(&desk, &["-j", "2"]);
    assert_eq!(digest(&one), digest(&two), "threads leave no mark");
    // The trials are trials like any other: the same manifest without a question finds them all in the store.
    let (without, _) = TINY.split_once("infer:").unwrap();
    desk.write("tiny.yaml", without);
    let answer = desk.run(&["run", "tiny.yaml", "--format", "json"]);
    let told: serde_json::Value = serde_json::from_str(&answer.stdout).unwrap();
    assert_eq!((told["trials"].as_u64(), told["cached"].as_u64()), (Some(16), Some(16)));
}

#[test]
fn what_does_not_follow_from_the_trials_is_refused_at_level_3() {
    let desk = desk();
    let stdout = inferred(&desk, &[]);
    let bundle = stdout.lines().last().unwrap();
    let verified = desk.run(&["verify", bundle, "--level", "4", "--sample", "2"]);
    assert_eq!(verified.code, 0, "{}{}", verified.stdout, verified.stderr);
    let bytes = std::fs::read(desk.path(bundle)).unwrap();
    let mut tree = archive::read(&bytes, &Limits::default()).unwrap().tree;
    forger::set_cell(&mut tree, "data/results/tables/choices.csv", 1, "posterior", "0.99");
    forger::reseal(&mut tree);
    desk.write("forged.zip", archive::write(&tree, "forged", Form::Bag));
    let answer = desk.run(&["verify", "forged.zip", "--level", "3"]);
    assert_eq!(answer.code, 1, "{}", answer.stdout);
    let (expected, found) =
        ("data/results/tables/choices.csv: expected `", "column `posterior`, as the records give");
    assert!(answer.stdout.contains(expected) && answer.stdout.contains(found), "{}", answer.stdout);
}

#[test]
fn a_part_of_the_design_infers_from_what_it_has() {
    let desk = desk();
    let stdout = inferred(&desk, &["--only", "prior=floor-plan"]);
    assert!(stdout.contains("cells that count"), "{stdout}");
    let documents = documents(&desk, &stdout);
    let counted = documents.lines().find(|line| line.starts_with("| cells that count "));
    let counted: Vec<&str> = counted.unwrap().split('|').map(str::trim).collect();
    assert_eq!(counted, ["", "cells that count", "4", ""], "{documents}");
    // Of one value there is nothing to tell.
    let stdout = inferred(&desk, &["--only", "reselect=continuous"]);
    assert!(stdout.contains("From 8 trials in physics: 2 combinations"), "{stdout}");
}
