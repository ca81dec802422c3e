//! The forms a bundle comes in, and the bundles that `.ci/full` hands to validators that others wrote.
//!
//! Every kind of bundle is left in `target/tmp/standards/`: `.ci/validate-bundle.sh target/tmp/standards/*.zip`.

use crate::adversary::study::STUDY;
use crate::sandbox::Sandbox;
use reenact::bundle::{
    Bundle, Circumstance, Form, Limits, Moment, archive, assemble, format, seal,
};
use reenact::studies::TrialRecord;
use reenact::verify::{Level, Options, Reenactment, Verdict, climb, plan_of};
use std::fs;
use std::path::Path;

/// Creates the adversary's honest study, with the rest of what a manifest may ask for.
fn place() -> Sandbox {
    let authors = "authors: [{name: A. Researcher}]";
    let more =
        "cite: {paper: 'A. Author, On corridors, 2020', section: section 4, doi: 10.1000/182}
authors: [{name: A. Researcher, affiliation: Example Robotics Lab, orcid: 0000-0002-1825-0097}]
license-of: {robots/kobuki.urdf: BSD-3-Clause}";
    assert!(STUDY.contains(authors));
    Sandbox::new().with_study(&STUDY.replace(authors, more))
}

#[test]
fn an_edition_that_no_crate_has_is_refused() {
    let place = place();
    let answer = place.run(&["export", "any.zip", "--rocrate", "1.2"]);
    assert_eq!((answer.code, &*answer.stdout), (2, ""));
    assert_eq!(
        answer.stderr,
        "error: invalid value '1.2' for '--rocrate[=<EDITION>]'\n  [possible values: 1.1, 1.3]\n\n  \
         tip: a similar value exists: '1.3'\n\nFor more information, try '--help'.\n"
    );
}

/// Returns the last line that a command prints.
#[track_caller]
fn last_line(place: &Sandbox, words: &[&str]) -> String {
    let answer = place.run(words);
    assert_eq!(answer.code, 0, "{words:?}: {answer:?}");
    answer.last_line().to_owned()
}

/// Returns the results digest that `verify` computes.
#[track_caller]
fn verified(place: &Sandbox, bundle: &str) -> String {
    let answer = place.run(&["verify", bundle, "--format", "json"]);
    assert_eq!(answer.code, 0, "{bundle}: {answer:?}");
    let report: serde_json::Value = serde_json::from_str(&answer.stdout).unwrap();
    report["results_digest"].as_str().unwrap().to_owned()
}

fn keep(name: &str, zip: &[u8]) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("standards");
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join(name), zip).unwrap();
}

#[test]
fn every_form_is_written_and_read_and_leads_back() {
    let place = place();
    let bundle = last_line(&place, &["run", "tiny.yaml"]);
    let original = fs::read(place.path(&bundle)).unwrap();
    keep("claims.zip", &original);
    let results = verified(&place, &bundle);
    for (form, name) in [
        (&["--flat"][..], "flat"),
        (&["--rocrate"], "crate"),
        (&["--rocrate", "1.3"], "crate-1-3"),
        (&["--dir"], "folder"),
        (&[], "bag"),
    ] {
        let words = [&["export", &bundle, "--out", name], form].concat();
        let exported = last_line(&place, &words);
        assert_eq!(verified(&place, &exported), results, "{exported}");
        if let Ok(zip) = fs::read(place.path(&exported)) {
            keep(&format!("{name}.zip"), &zip);
        }
        // And back again: a crate has lost its bag and gets a new one.
        let back = last_line(&place, &["export", &exported, "--out", "back"]);
        assert_eq!(verified(&place, &back), results, "from {exported}");
        let is_original = fs::read(place.path(&back)).unwrap() == original;
        assert_eq!(is_original, !name.starts_with("crate"), "from {exported}");
        if name == "crate" {
            keep("bagged-again.zip", &fs::read(place.path(&back)).unwrap());
        }
    }
}

#[test]
fn a_part_of_a_study_is_a_bundle_too() {
    let place = place();
    let words = ["run", "tiny.yaml", "--only", "prior=floor-plan", "--trials", "1"];
    let bundle = last_line(&place, &words);
    verified(&place, &bundle);
    keep("partial.zip", &fs::read(place.path(&bundle)).unwrap());
}

/// A trial that failed to run is sealed with its cause: the bundle is what it says, and its claim cannot be tested.
#[test]
fn a_study_with_a_failed_trial_is_a_bundle_too() {
    let place = place();
    let path = last_line(&place, &["run", "tiny.yaml"]);
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
