//! Level 6: fresh seeds, and what they may and may not say.

use super::*;

fn replicate(tree: Tree, claims: &'static str, seed: u64) -> Report {
    let options = Options { level: Level::Replicated, sample: 0, rows: None, seed };
    climb(Ok(Archive::of(Form::Bag, tree)), &options, &Engine { claims, ..ENGINE })
}

fn told(report: &Report) -> Vec<String> {
    report.findings.iter().map(ToString::to_string).collect()
}

#[test]
fn verdicts_that_hold_with_fresh_seeds_reach_the_top() {
    let report = replicate(sample::sealed().tree, ENGINE.claims, 8);
    assert_eq!((report.reached, report.verdict()), (Some(Level::Replicated), Verdict::Holds));
    let human = report.to_human();
    let end = "  5 full       passed\n  6 replicated passed\nall 6 trials gave the same bytes again\nrun again with the \
               experiment's seed 8: of 1 claims 1 have the same verdict\n  P1: supported (no reason given), now supported (no \
               reason given)\n";
    assert!(human.contains(end), "{human}");
    assert!(
        human.ends_with(
            "reached level 6 (replicated) of level 6 (replicated): the bundle is what it says\n"
        ),
        "{human}"
    );
    assert_eq!(report, replicate(sample::sealed().tree, ENGINE.claims, 8), "the seed repeats it");
    let json: serde_json::Value = serde_json::from_str(&report.to_json()).unwrap();
    assert_eq!(json["replication"]["seed"], 8);
    assert_eq!(json["replication"]["claims"][0]["standing"], "holds");
}

#[test]
fn the_opposite_verdict_breaks_the_level_but_not_the_bundle() {
    let opposite = r#"[{"id":"P1","verdict":"contradicted","reason":"p 2e-3"}]"#;
    let report = replicate(sample::sealed().tree, opposite, 8);
    assert_eq!((report.reached, report.verdict()), (Some(Level::Full), Verdict::NotReplicated));
    assert_eq!(
        told(&report),
        [
            "error at level 6: data/results/claims.json: expected `P1` supported again (no reason given), found contradicted (p \
          2e-3) (where the sealed verdict is right, chance does this in at most alpha of all runs: another `--sample-seed` \
          tells)"
        ]
    );
    assert!(report.to_human().ends_with(
        "reached level 5 (full) of level 6 (replicated): the bundle is what it says, but not every verdict holds with fresh \
         seeds\n"
    ));
    assert!(report.to_junit().contains("failures=\"1\""));
}

#[test]
fn a_claim_that_is_no_longer_decided_is_noted() {
    let open = r#"[{"id":"P1","verdict":"inconclusive","reason":"p 0.2"}]"#;
    let report = replicate(sample::sealed().tree, open, 8);
    assert_eq!((report.reached, report.verdict()), (Some(Level::Replicated), Verdict::Holds));
    assert_eq!(
        told(&report),
        [
            "note at level 6: data/results/claims.json: expected `P1` supported again (no reason given), found inconclusive (p \
          0.2) (not the opposite: the number of trials decides it in some runs and not in others)"
        ]
    );
}

#[test]
fn without_a_verdict_there_is_nothing_to_replicate() {
    let begin = "obstacle at level 6: data/study.resolved.json: expected";
    let same_seed = replicate(sample::sealed().tree, ENGINE.claims, 7);
    assert_eq!(
        told(&same_seed),
        [format!(
            "{begin} a seed that the study was not run with, found 7 (the same seed gives the same trials; choose another \
             `--sample-seed`, or none)"
        )]
    );
    assert_eq!((same_seed.reached, same_seed.verdict()), (Some(Level::Full), Verdict::Unanswered));

    // The parts as the ladder hands them over: the sample's own content is never partial and never without claims.
    let sealed = |change: fn(&mut BundleContent)| {
        let mut content = sample::content();
        change(&mut content);
        let tree = crate::bundle::seal(&content, &sample::circumstance()).unwrap().tree;
        Bundle::open(Archive::of(Form::Bag, tree)).unwrap()
    };
    let judged = |bundle: &Bundle| {
        let study = Study { bundle, seed: 7, claims: "[]" };
        let (replication, findings) = replication::check(bundle, &study, 8);
        let findings: Vec<_> = findings.iter().map(|(_, fault)| fault.to_string()).collect();
        (replication, findings)
    };
    let (replication, findings) = judged(&sealed(|content| content.partial = true));
    assert_eq!(replication, None, "nothing is run");
    assert_eq!(
        findings,
        [
            "data/study.resolved.json: expected a whole study, found part of one (no claim is judged on a part, so there is no \
          verdict to replicate)"
        ]
    );
    let (replication, findings) = judged(&sealed(|content| {
        let claims = content.results.iter_mut().find(|(path, _)| path == "claims.json");
        claims.unwrap().1 = b"[]\n".to_vec();
    }));
    assert_eq!(
        findings,
        [
            "data/results/claims.json: expected claims to judge again, found none (the fresh numbers are compared with the \
          sealed ones, which decides nothing)"
        ]
    );
    let words = replication.unwrap().in_words();
    assert!(
        words.starts_with(
            "run again with the experiment's seed 8: the study makes no claim, so there is no verdict to replicate\n"
        ) && words.contains(" of 4 means and shares lie where chance explains"),
        "{words}"
    );
}
