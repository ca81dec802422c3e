//! Honest bundles hold as far as they are asked, and what cannot be judged is no damage.

use super::*;

#[test]
fn an_honest_bundle_reaches_every_level_it_is_asked_for() {
    for level in Level::ALL {
        let report = climb_to(level, sample::sealed().tree);
        assert_eq!(report.findings, [], "{level}");
        assert_eq!((report.reached, report.verdict()), (Some(level), Verdict::Holds));
    }
    for form in [Form::Bag, Form::Flat] {
        let opened = archive::read(&sample::sealed().zip(form), &Limits::default());
        let options = Options { level: Level::Full, sample: 0, rows: None, seed: 0 };
        assert_eq!(climb(opened, &options, &ENGINE).verdict(), Verdict::Holds);
    }
    let opened = archive::read(&sample::sealed().zip(Form::Crate), &Limits::default());
    let report =
        climb(opened, &Options { level: Level::Derived, sample: 0, rows: None, seed: 0 }, &ENGINE);
    assert_eq!((report.verdict(), report.findings), (Verdict::Holds, Vec::new()));
    assert_eq!(report.unchecked, Vec::<String>::new(), "a bare crate is described like any other");
}

#[test]
fn what_cannot_be_judged_is_no_damage() {
    let mut tree = sample::sealed().tree;
    edit(&mut tree, "bag-info.txt", |text| text.replace("Bundle-Format: 4", "Bundle-Format: 6"));
    let report = climb_to(Level::Derived, tree);
    assert_eq!(report.verdict(), Verdict::Unanswered);
    assert_eq!(report.reached, Some(Level::Safe));
    assert!(report.findings[0].to_string().starts_with(
        "obstacle at level 1: bag-info.txt: expected bundle format 5 or older, found bundle format 6 (this is reenact "
    ));

    let opened = archive::read(sample::zip(), &Limits::default());
    let options = Options { level: Level::Full, sample: 1, rows: None, seed: 1 };
    let report = climb(opened, &options, &Engine { version: "test-2", ..ENGINE });
    assert_eq!((report.verdict(), report.reached), (Verdict::Unanswered, Some(Level::Coherent)));
}

/// Checks that what follows from engine and format is not derived as another format had it.
#[test]
fn an_older_format_is_judged_to_level_2() {
    let mut tree = sample::sealed().tree;
    for path in ["data/study.resolved.json", "bag-info.txt"] {
        let (from, to) = match path {
            "bag-info.txt" => ("Bundle-Format: 4", "Bundle-Format: 1"),
            _ => ("\"bundle-format\": 4", "\"bundle-format\": 1"),
        };
        edit(&mut tree, path, |text| text.replace(from, to));
    }
    sample::recompute(&mut tree);
    let report = climb_to(Level::Derived, tree);
    let told: Vec<String> = report.findings.iter().map(ToString::to_string).collect();
    assert_eq!(
        told,
        [
            "obstacle at level 3: data/study.resolved.json: expected bundle format 4 or 5, found bundle format 1 (levels 0 to 2 can be \
          judged here; tables and descriptions followed from the records in another way then, so the rest is for the program \
          that sealed the bundle, or run its study.yaml again)"
        ]
    );
    assert_eq!((report.verdict(), report.reached), (Verdict::Unanswered, Some(Level::Coherent)));
}

#[test]
fn reports_say_the_same_in_three_forms() {
    let report = climb_to(Level::Full, forged());
    let human = report.to_human();
    assert!(
        human.contains("  3 derived   passed\n  4 sampled   failed\n  5 full      failed\n"),
        "{human}"
    );
    assert!(human.ends_with(
        "1 of 6 trials gave other bytes than the bundle holds\nnot checked: time and host of the run\nreached level 3 (derived) of level 5 (full): the bundle is \
         not what it says\n"
    ));
    let json: serde_json::Value = serde_json::from_str(&report.to_json()).unwrap();
    assert_eq!(json["verdict"], "broken");
    assert_eq!((json["reached"].as_u64(), json["asked"].as_u64()), (Some(3), Some(5)));
    assert_eq!(json["findings"][0]["path"], "data/trials/none.jsonl:2");
    assert_eq!(json["sample"]["equal"], 5);
    assert!(!report.to_json().contains('\n'));
    let junit = report.to_junit();
    let document = roxmltree::Document::parse(&junit).unwrap();
    let count = |tag: &str| document.descendants().filter(|node| node.has_tag_name(tag)).count();
    assert_eq!((count("testcase"), count("failure"), count("skipped")), (6, 2, 0), "{junit}");
    let honest = climb_to(Level::Sampled, sample::sealed().tree).to_human();
    assert!(honest.ends_with(
        "all 6 trials gave the same bytes again\nnot checked: time and host of the run\nreached level 4 (sampled) of level 4 (sampled): the bundle is what it \
         says\n"
    ));
}

/// Checks that a calendar that is set back during a run, or wrong from the start, breaks no bundle. The bag repeats
/// what the clock showed, and nothing that is verified depends on it.
#[test]
fn a_clock_that_runs_backwards_breaks_no_bundle() {
    for (started, ended) in [(1_768_478_400, 1_768_470_000), (0, 0), (253_402_300_799, 0)] {
        let circumstance = crate::bundle::Circumstance {
            started: crate::bundle::Moment(started),
            ended: crate::bundle::Moment(ended),
            ..sample::circumstance()
        };
        let sealed = crate::bundle::seal(&sample::content(), &circumstance).unwrap();
        assert_eq!(sealed.results_digest, sample::sealed().results_digest);
        let report = climb_to(Level::Full, sealed.tree);
        assert_eq!((report.findings.as_slice(), report.verdict()), (&[][..], Verdict::Holds));
    }
}
