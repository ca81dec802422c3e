//! The forms a bundle comes in, and the bundles that `.ci/full` hands to validators that others wrote.
//!
//! Every kind of bundle is left in `target/tmp/standards/`: `.ci/validate-bundle.sh target/tmp/standards/*.zip`.

use assert_cmd::cargo::cargo_bin;
use reenact::bundle::{
    Bundle, Circumstance, Form, Limits, Moment, archive, assemble, format, seal,
};
use reenact::studies::TrialRecord;
use reenact::verify::{Level, Options, Reenactment, Verdict, climb, plan_of};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// Two cells of three trials of 20 simulated seconds, with all that a manifest may ask for.
const STUDY: &str = "
reenact: 1
name: tiny
title: A tiny study
cite: {paper: 'A. Author, On corridors, 2020', section: section 4, doi: 10.1000/182}
authors: [{name: A. Researcher, affiliation: Example Robotics Lab, orcid: 0000-0002-1825-0097}]
license: CC-BY-4.0
license-of: {robots/kobuki.urdf: BSD-3-Clause}
study: prior-map
seed: 7
trials: 3
robot: robots/kobuki.urdf
world: {file: worlds/basic.yaml, layers: [walls]}
start: {x-m: 3, y-m: 2, heading-deg: 0}
factors:
  prior: [none, floor-plan]
prior-maps:
  floor-plan: {floor-plan-of: world}
parameters:
  mission: {time-limit-s: 20}
tables:
  - id: table-1
    title: Distance travelled (m) at levels of coverage
    coverage-table: {metric: distance-m, at: [50], by: prior, baseline: none}
figures:
  - id: figure-1
    title: Coverage over time
    coverage-curve: {against: time-s, by: prior}
claims:
  - id: T1
    says: within 20 s the robot drives at least 5 m
    paper-table: silent
    expect: {between: {metric: distance-m, where: {prior: none}, low: 5, minimum-n: 3}}
";

struct Place {
    folder: TempDir,
}

impl Place {
    fn new() -> Self {
        let place = Self { folder: tempfile::tempdir().unwrap() };
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        for file in ["robots/kobuki.urdf", "worlds/basic.yaml"] {
            let copy = place.path(file);
            fs::create_dir_all(copy.parent().unwrap()).unwrap();
            fs::copy(root.join(file), copy).unwrap();
        }
        fs::write(place.path("tiny.yaml"), STUDY).unwrap();
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn output(&self, words: &[&str]) -> Output {
        Command::new(cargo_bin!("reenact"))
            .current_dir(self.folder.path())
            .env("REENACT_STORE", self.path("store"))
            .args(words)
            .output()
            .unwrap()
    }

    /// The last line that a command prints.
    #[track_caller]
    fn last_line(&self, words: &[&str]) -> String {
        let output = self.output(words);
        assert!(output.status.success(), "{words:?}: {output:?}");
        String::from_utf8(output.stdout).unwrap().lines().last().unwrap().to_owned()
    }

    /// The results digest that `verify` computes.
    #[track_caller]
    fn verified(&self, bundle: &str) -> String {
        let output = self.output(&["verify", bundle, "--format", "json"]);
        assert!(output.status.success(), "{bundle}: {output:?}");
        let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        report["results-digest"].as_str().unwrap().to_owned()
    }
}

fn keep(name: &str, zip: &[u8]) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("standards");
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join(name), zip).unwrap();
}

#[test]
fn every_form_is_written_and_read_and_leads_back() {
    let place = Place::new();
    let bundle = place.last_line(&["run", "tiny.yaml"]);
    let original = fs::read(place.path(&bundle)).unwrap();
    keep("claims.zip", &original);
    let results = place.verified(&bundle);
    for (form, name) in
        [("--flat", "flat"), ("--rocrate", "crate"), ("--dir", "folder"), ("", "bag")]
    {
        let words = ["export", &bundle, "--out", name, form];
        let words = if form.is_empty() { &words[..4] } else { &words[..] };
        let exported = place.last_line(words);
        assert_eq!(place.verified(&exported), results, "{exported}");
        if let Ok(zip) = fs::read(place.path(&exported)) {
            keep(&format!("{name}.zip"), &zip);
        }
        // And back again: a crate has lost its bag and gets a new one.
        let back = place.last_line(&["export", &exported, "--out", "back"]);
        assert_eq!(place.verified(&back), results, "from {exported}");
        let is_original = fs::read(place.path(&back)).unwrap() == original;
        assert_eq!(is_original, name != "crate", "from {exported}");
        if name == "crate" {
            keep("bagged-again.zip", &fs::read(place.path(&back)).unwrap());
        }
    }
}

#[test]
fn a_part_of_a_study_is_a_bundle_too() {
    let place = Place::new();
    let words = ["run", "tiny.yaml", "--only", "prior=floor-plan", "--trials", "1"];
    let bundle = place.last_line(&words);
    place.verified(&bundle);
    keep("partial.zip", &fs::read(place.path(&bundle)).unwrap());
}

/// A trial that failed to run is sealed with its cause: the bundle is what it says, and its claim cannot be tested.
#[test]
fn a_study_with_a_failed_trial_is_a_bundle_too() {
    let place = Place::new();
    let path = place.last_line(&["run", "tiny.yaml"]);
    let zip = fs::read(place.path(&path)).unwrap();
    let whole = Bundle::read(&zip, &Limits::default()).unwrap();
    let (plan, selection) = plan_of(&whole).unwrap();
    let mut records = whole.records().unwrap();
    records[1] = TrialRecord::panicked(&plan.trials[1], "index out of bounds".to_owned());
    let content = assemble::assemble(&plan, whole.study_yaml(), &selection, &records).unwrap();
    let circumstance = Circumstance {
        version: format::VERSION.to_owned(),
        started: Moment(1_768_478_400),
        ended: Moment(1_768_478_460),
        environment: vec![("jobs".to_owned(), "2".to_owned())],
        files: Vec::new(),
    };
    let zip = seal(&content, &circumstance).unwrap().zip(Form::Bag);
    let claims = Bundle::read(&zip, &Limits::default()).unwrap();
    let claims: serde_json::Value =
        serde_json::from_slice(claims.result("claims.json").unwrap()).unwrap();
    assert_eq!(claims[0]["verdict"], "cannot-be-tested");
    let options = Options { level: Level::Derived, sample: 0, rows: None, seed: 0 };
    let pipeline = Reenactment::new(1).unwrap();
    let report = climb(archive::read(&zip, &Limits::default()), &options, &pipeline);
    assert_eq!(report.verdict(), Verdict::Holds, "{}", report.to_human());
    keep("failed.zip", &zip);
}
