//! Bundles whose checksums were made right again: what does not follow from the manifest is found.

use super::*;

#[test]
fn a_number_changed_with_every_checksum_recomputed_fails_at_level_3() {
    let distance = sample::record(7, "none", 1).measures["distance-m-at-90"].unwrap();
    let expected = format!(
        "error at level 3: data/results/trials.csv: expected `{distance}` in row 2, column `distance-m-at-90`, as the records \
         give, found `1.5`"
    );
    damaged(Level::Derived, Some(Level::Coherent), &[&expected], |tree| {
        edit(tree, "data/results/trials.csv", |text| {
            text.replacen(&format!("none,1,explored,{distance}"), "none,1,explored,1.5", 1)
        });
        sample::recompute(tree);
    });
    damaged(
        Level::Derived,
        Some(Level::Coherent),
        &[
            "error at level 3: data/results/claims.json: expected `\"supported\"` at /0/verdict, as the records give, found \
           `\"contradicted\"`",
        ],
        |tree| {
            edit(tree, "data/results/claims.json", |text| {
                text.replace("supported", "contradicted")
            });
            sample::recompute(tree);
        },
    );
    damaged(
        Level::Derived,
        Some(Level::Coherent),
        &[
            "error at level 3: data/results/extra.csv: expected only files that follow from the records, found one that does \
           not",
        ],
        |tree| {
            tree.insert("data/results/extra.csv".into(), b"x\n1\n".to_vec());
            edit(tree, "data/ro-crate-metadata.json", |text| {
                text.replacen(
                    "\"@graph\": [",
                    "\"@graph\": [{\"@id\": \"results/extra.csv\", \"@type\": \"File\", \"sha256\": \"\"},",
                    1,
                )
            });
            sample::recompute(tree);
        },
    );
}

#[test]
fn the_circumstance_half_cannot_tell_another_story() {
    damaged(
        Level::Derived,
        Some(Level::Coherent),
        &[
            "error at level 3: data/README.md: expected `# Corridors with and without a floor plan` in line 1, as the records \
           give, found `# Corridors without a floor plan`",
        ],
        |tree| {
            edit(tree, "data/README.md", |text| text.replacen("with and without", "without", 1));
            sample::recompute(tree);
        },
    );
    damaged(
        Level::Derived,
        Some(Level::Coherent),
        &[
            "error at level 3: data/ro-crate-metadata.json: expected `\"A. Researcher\"` at /@graph/11/name, as the records give, \
           found `\"Somebody Else\"`",
        ],
        |tree| {
            edit(tree, "data/ro-crate-metadata.json", |text| {
                text.replace("A. Researcher", "Somebody Else")
            });
            sample::recompute(tree);
        },
    );
}

#[test]
fn another_seed_makes_other_trials() {
    let mut tree = sample::sealed().tree;
    edit(&mut tree, "data/study.yaml", |text| text.replace("seed: 7", "seed: 8"));
    sample::recompute(&mut tree);
    let report = climb_to(Level::Derived, tree);
    assert_eq!(report.reached, Some(Level::Coherent));
    let first = report.findings[0].to_string();
    let (planned, sealed) = (sample::record(8, "none", 0).key, sample::record(7, "none", 0).key);
    assert_eq!(
        first,
        format!(
            "error at level 3: data/trials/none.jsonl:1: expected trial 0 with key {}, as the manifest plans, found trial 0 \
             with key {}, and 2 more (the manifest, an input, the seed or the record was changed after the run)",
            planned.short(),
            sealed.short()
        )
    );
}

#[test]
fn an_invented_record_passes_level_3_and_fails_when_executed() {
    assert_eq!(climb_to(Level::Derived, forged()).verdict(), Verdict::Holds);
    for level in [Level::Sampled, Level::Full] {
        let report = climb_to(level, forged());
        assert_eq!(report.reached, Some(Level::Derived));
        assert_eq!(report.findings.len(), 1);
        let record = sample::record(7, "none", 1);
        assert_eq!(
            report.findings[0].to_string(),
            format!(
                "error at level 4: data/trials/none.jsonl:2: expected `{}` at /measures/distance-m-at-90, as trial {} gives \
                 when executed again, found `0.25` (the states agree throughout: the record was changed, not the run)",
                record.measures["distance-m-at-90"].unwrap(),
                record.key.short()
            )
        );
        let sample = report.sample.as_ref().unwrap();
        assert_eq!((sample.executed, sample.equal, sample.of, sample.bound()), (6, 5, 6, None));
    }
}

/// Checks that neither another version nor missing times turn the description into something that nobody derives.
#[test]
fn a_description_is_derived_again_whatever_the_bag_says_of_the_run() {
    let forged_readme = |info: &dyn Fn(String) -> String, level| {
        let mut tree = sample::sealed().tree;
        edit(&mut tree, "data/README.md", |text| format!("{text}\n99 % better.\n"));
        edit(&mut tree, "bag-info.txt", info);
        sample::recompute(&mut tree);
        let report = climb_to(Level::Full, tree);
        let is_at = |f: &Finding| f.level == level && f.severity == Severity::Error;
        assert!(report.findings.iter().any(is_at), "{:?}", report.findings);
        assert_eq!(
            (report.verdict(), report.judged.contains(&Level::Full)),
            (Verdict::Broken, false)
        );
    };
    let version = crate::bundle::format::VERSION;
    let another = |text: String| text.replace(&format!("reenact {version}"), "reenact 0.1.1");
    forged_readme(&another, Level::Coherent);
    let started = |text: String| text.replace("Run-Started: 2026-01-15T12:00:00+00:00\n", "");
    forged_readme(&started, Level::Coherent);
    let none = |text: String| {
        let told = |line: &&str| !line.starts_with("Run-") && !line.starts_with("Bagging-Date");
        text.lines().filter(told).flat_map(|line| [line, "\n"]).collect()
    };
    forged_readme(&none, Level::Derived);
}
