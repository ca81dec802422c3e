//! The tampering suite: every damage is found at the rung that should find it, and named.

mod answers;
mod executed;
mod previous;
mod replicated;

use super::*;
use crate::bundle::{Archive, Bundle, BundleContent, Form, Limits, Tree, archive, sample};
use crate::runner::RunError;
use crate::studies::TrialRecord;

/// The sample study's own pipeline: keys follow from the seed in the manifest, records from the keys.
struct Engine {
    version: &'static str,
    /// `claims.json` of fresh runs.
    claims: &'static str,
}

const ENGINE: Engine =
    Engine { version: sample::ENGINE, claims: r#"[{"id":"P1","verdict":"supported"}]"# };

struct Study<'a> {
    bundle: &'a Bundle,
    seed: u64,
    claims: &'static str,
}

impl Pipeline for Engine {
    fn engine(&self) -> &str {
        self.version
    }

    fn replan<'a>(&'a self, bundle: &'a Bundle) -> Result<Box<dyn Replanned + 'a>, ReplanError> {
        let text = std::str::from_utf8(bundle.study_yaml()).map_err(|_| ReplanError::NotText)?;
        let seed = text.lines().find_map(|line| line.strip_prefix("seed: ")?.parse().ok());
        Ok(Box::new(Study {
            bundle,
            seed: seed.ok_or(ReplanError::Faulty(Vec::new()))?,
            claims: self.claims,
        }))
    }
}

impl Study<'_> {
    fn fresh(&self) -> Vec<(&'static str, TrialRecord)> {
        ["none", "floor-plan"]
            .into_iter()
            .flat_map(|prior| {
                (0..3).map(move |trial| (prior, sample::record(self.seed, prior, trial)))
            })
            .collect()
    }
}

impl Replanned for Study<'_> {
    fn trials(&self) -> Vec<PlannedTrial> {
        let planned = |(slug, record): (&str, TrialRecord)| PlannedTrial {
            key: record.key,
            slug: slug.to_owned(),
            trial: record.trial,
        };
        self.fresh().into_iter().map(planned).collect()
    }

    fn content(&self) -> Result<BundleContent, ContentError> {
        let records = self.bundle.records().map_err(ContentError::Records)?;
        let of =
            |prior: &str| records.iter().filter(|r| r.condition[0].1 == prior).cloned().collect();
        let conditions = ["none", "floor-plan"].map(|prior| (prior, of(prior)));
        Ok(sample::content_of(self.bundle.study_yaml(), self.seed, &conditions))
    }

    fn execute(&self, indices: &[usize]) -> Result<Vec<String>, RunError> {
        let fresh = self.fresh();
        Ok(indices.iter().map(|&i| fresh[i].1.to_line()).collect())
    }

    fn replicate(&self, seed: u64) -> Result<BundleContent, ReplicateError> {
        let records = |prior| (0..3).map(|trial| sample::record(seed, prior, trial)).collect();
        let conditions = ["none", "floor-plan"].map(|prior| (prior, records(prior)));
        let mut content = sample::content_of(self.bundle.study_yaml(), seed, &conditions);
        content.results.retain(|(path, _)| path != "claims.json");
        content.results.push(("claims.json".into(), self.claims.into()));
        Ok(content)
    }
}

fn climb_to(level: Level, tree: Tree) -> Report {
    let options = Options { level, sample: 6, rows: None, seed: 1 };
    climb(Ok(Archive { form: Form::Bag, tree }), &options, &ENGINE)
}

fn edit(tree: &mut Tree, path: &str, change: impl FnOnce(String) -> String) {
    let text = String::from_utf8(tree[path].clone()).unwrap();
    let changed = change(text.clone());
    assert_ne!(changed, text, "the edit must change {path}");
    tree.insert(path.to_owned(), changed.into_bytes());
}

/// Damages the sample, climbs to `level`, and asserts the rung reached and every finding.
#[track_caller]
fn damaged(
    level: Level,
    reached: Option<Level>,
    expected: &[&str],
    damage: impl FnOnce(&mut Tree),
) {
    let mut tree = sample::sealed().tree;
    damage(&mut tree);
    let report = climb_to(level, tree);
    let findings: Vec<_> = report.findings.iter().map(ToString::to_string).collect();
    let short: Vec<_> = findings.iter().map(|text| shorten(text)).collect();
    assert_eq!(short, expected);
    assert_eq!(report.reached, reached);
    assert_eq!(report.verdict(), Verdict::Broken);
}

/// Digests depend on every byte of the sample; that one stands there is what matters.
fn shorten(text: &str) -> String {
    let (mut out, mut run) = (String::new(), String::new());
    for c in text.chars().chain([' ']) {
        if c.is_ascii_hexdigit() {
            run.push(c);
            continue;
        }
        out.push_str(if run.len() == 64 { "*" } else { &run });
        run.clear();
        out.push(c);
    }
    out.pop();
    out
}

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
fn a_flipped_byte_is_found_at_every_level_that_looks() {
    damaged(
        Level::Derived,
        Some(Level::Safe),
        &[
            "error at level 1: data/results/tables/distance.csv: expected sha256:*, as manifest-sha256.txt says, found \
             sha256:*",
            "error at level 2: data/ro-crate-metadata.json: expected results digest sha256:*, found sha256:*",
            "error at level 2: data/ro-crate-metadata.json: expected sha256 * for `results/tables/distance.csv`, as the file \
             is, found *",
            "error at level 2: bag-info.txt: expected Results-Digest: sha256:*, found sha256:*",
            "error at level 3: data/results/tables/distance.csv: expected the columns coverage, distance-m, as the records \
             give, found the columns Coverage, distance-m",
        ],
        |tree| tree.get_mut("data/results/tables/distance.csv").unwrap()[0] ^= 0x20,
    );
}

#[test]
fn missing_and_extra_files_are_found() {
    damaged(
        Level::Fixity,
        Some(Level::Safe),
        &[
            "error at level 1: data/trials/none.jsonl: expected a file, as manifest-sha256.txt lists it, found none",
        ],
        |tree| assert!(tree.remove("data/trials/none.jsonl").is_some()),
    );
    damaged(
        Level::Fixity,
        Some(Level::Safe),
        &[
            "error at level 1: data/results/extra.csv: expected only files that manifest-sha256.txt lists, found an unlisted \
           file",
        ],
        |tree| assert!(tree.insert("data/results/extra.csv".into(), b"x".to_vec()).is_none()),
    );
    damaged(
        Level::Fixity,
        Some(Level::Safe),
        &[
            "error at level 1: run.sh: expected only files that tagmanifest-sha256.txt lists, found an unlisted file",
        ],
        |tree| assert!(tree.insert("run.sh".into(), b"x".to_vec()).is_none()),
    );
    damaged(
        Level::Fixity,
        Some(Level::Safe),
        &["error at level 1: tagmanifest-sha256.txt: expected a list of digests, found no file"],
        |tree| assert!(tree.remove("tagmanifest-sha256.txt").is_some()),
    );
    let mut signed = sample::sealed().tree;
    let signature = include_bytes!("../../tests/signatures/minisign.minisig");
    signed.insert("tagmanifest-sha256.txt.minisig".into(), signature.to_vec());
    assert_eq!(climb_to(Level::Derived, signed).verdict(), Verdict::Holds, "signatures come later");
}

/// No list holds the digest of a signature: what lies in its place is one, or is refused.
#[test]
fn nothing_rides_along_as_a_signature() {
    let hint = "(no list holds the digest of a signature, so it must be one and nothing more)";
    let ssh = include_str!("../../tests/signatures/ed25519.sig");
    for (path, content, found) in [
        ("tagmanifest-sha256.txt.minisig", "sh install.sh".to_owned(), "something else"),
        ("tagmanifest-sha256.txt.minisig", ssh.to_owned(), "an OpenSSH signature"),
        ("tagmanifest-sha256.txt.sig", format!("{ssh}run me"), "one that cannot be read ("),
    ] {
        let mut tree = sample::sealed().tree;
        tree.insert(path.to_owned(), content.into_bytes());
        let report = climb_to(Level::Fixity, tree);
        let errors = report.findings.iter().filter(|f| f.severity == Severity::Error);
        let told: Vec<String> = errors.map(ToString::to_string).collect();
        let kind = if path.contains("minisig") { "a minisign" } else { "an OpenSSH" };
        let says = format!("error at level 1: {path}: expected {kind} signature, found {found}");
        assert!(
            told.len() == 1 && told[0].starts_with(&says) && told[0].ends_with(hint),
            "{told:?}"
        );
    }
}

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
fn truncated_and_misplaced_records_are_found() {
    let mut tree = sample::sealed().tree;
    let records = tree.get_mut("data/trials/none.jsonl").unwrap();
    records.truncate(records.len() - 40);
    sample::recompute(&mut tree);
    let report = climb_to(Level::Coherent, tree);
    let findings: Vec<_> = report.findings.iter().map(ToString::to_string).collect();
    assert_eq!(findings.len(), 2);
    assert_eq!(
        findings[0],
        "error at level 2: data/trials/none.jsonl: expected a line feed at its end, found none (the file may have been cut \
         short)"
    );
    assert!(
        findings[1].starts_with(
            "error at level 2: data/trials/none.jsonl:3: expected a trial record, found EOF while"
        ),
        "{}",
        findings[1]
    );
    assert_eq!(report.reached, Some(Level::Fixity));

    damaged(
        Level::Coherent,
        Some(Level::Fixity),
        &[
            "error at level 2: data/trials/none.jsonl:1: expected trial 0, found trial 1",
            "error at level 2: data/trials/none.jsonl:2: expected trial 2, found trial 0",
            "error at level 2: data/trials/none.jsonl:3: expected trial 1, found trial 2",
        ],
        |tree| {
            edit(tree, "data/trials/none.jsonl", |text| {
                let lines: Vec<_> = text.lines().collect();
                format!("{}\n{}\n{}\n", lines[1], lines[0], lines[2])
            });
            sample::recompute(tree);
        },
    );
    damaged(
        Level::Coherent,
        Some(Level::Fixity),
        &[
            "error at level 2: data/trials/none.jsonl:2: expected a key of its own, found that of data/trials/none.jsonl:1",
        ],
        |tree| {
            edit(tree, "data/trials/none.jsonl", |text| {
                let lines: Vec<_> = text.lines().collect();
                let copy = lines[0].replace("\"trial\":0", "\"trial\":1");
                format!("{}\n{copy}\n{}\n", lines[0], lines[2])
            });
            sample::recompute(tree);
        },
    );
    damaged(
        Level::Coherent,
        Some(Level::Fixity),
        &[
            "error at level 2: data/trials/none.jsonl: expected 3 records, as the resolved study says, found 2",
        ],
        |tree| {
            edit(tree, "data/trials/none.jsonl", |text| {
                text.split_inclusive('\n').take(2).collect()
            });
            sample::recompute(tree);
        },
    );
    damaged(
        Level::Coherent,
        Some(Level::Fixity),
        &[
            "error at level 2: data/inputs/a.yaml: expected sha256:*, as the resolved study says of `../worlds/a.yaml`, found \
           sha256:*",
        ],
        |tree| {
            edit(tree, "data/inputs/a.yaml", |text| text.replace("[1]", "[2]"));
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

/// A bundle forged as well as can be: one record invented, and everything that follows from it derived by the program
/// itself.
fn forged() -> Tree {
    let mut records = sample::records();
    let distance = records[0].1[1].measures.get_mut("distance-m-at-90").unwrap();
    *distance = Some(0.25);
    let content = sample::content_of(sample::STUDY.as_bytes(), 7, &records);
    crate::bundle::seal(&content, &sample::circumstance()).unwrap().tree
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

#[test]
fn what_cannot_be_judged_is_no_damage() {
    let mut tree = sample::sealed().tree;
    edit(&mut tree, "bag-info.txt", |text| text.replace("Bundle-Format: 2", "Bundle-Format: 3"));
    let report = climb_to(Level::Derived, tree);
    assert_eq!(report.verdict(), Verdict::Unanswered);
    assert_eq!(report.reached, Some(Level::Safe));
    assert!(report.findings[0].to_string().starts_with(
        "obstacle at level 1: bag-info.txt: expected bundle format 2 or older, found bundle format 3 (this is reenact "
    ));

    let opened = archive::read(sample::zip(), &Limits::default());
    let options = Options { level: Level::Full, sample: 1, rows: None, seed: 1 };
    let report = climb(opened, &options, &Engine { version: "test-2", ..ENGINE });
    assert_eq!((report.verdict(), report.reached), (Verdict::Unanswered, Some(Level::Coherent)));
}

/// What follows from engine and format is not derived in a way that another format had.
#[test]
fn an_older_format_is_judged_to_level_2() {
    let mut tree = sample::sealed().tree;
    for path in ["data/study.resolved.json", "bag-info.txt"] {
        let (from, to) = match path {
            "bag-info.txt" => ("Bundle-Format: 2", "Bundle-Format: 1"),
            _ => ("\"bundle-format\": 2", "\"bundle-format\": 1"),
        };
        edit(&mut tree, path, |text| text.replace(from, to));
    }
    sample::recompute(&mut tree);
    let report = climb_to(Level::Derived, tree);
    let told: Vec<String> = report.findings.iter().map(ToString::to_string).collect();
    assert_eq!(
        told,
        [
            "obstacle at level 3: data/study.resolved.json: expected bundle format 2, found bundle format 1 (levels 0 to 2 can be \
          judged here; tables and descriptions followed from the records in another way then, so the rest is for the program \
          that sealed the bundle, or run its study.yaml again)"
        ]
    );
    assert_eq!((report.verdict(), report.reached), (Verdict::Unanswered, Some(Level::Coherent)));
}

/// Neither another version nor missing times turn the description into something that nobody derives.
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

#[test]
fn hostile_archives_fail_at_level_0() {
    let zip = sample::zip_of(&[("b/bagit.txt", b""), ("../evil", b"x")]);
    let options = Options { level: Level::Derived, sample: 0, rows: None, seed: 0 };
    let report = climb(archive::read(&zip, &Limits::default()), &options, &ENGINE);
    assert_eq!((report.reached, report.verdict()), (None, Verdict::Broken));
    assert_eq!(
        report.to_human(),
        "  0 safe      failed\n  1 fixity    not judged\n  2 coherent  not judged\n  3 derived   not judged\nerror at level 0: \
         ../evil: expected a safe relative path, found a path that climbs out of its folder\nreached no level of level 3 \
         (derived): the bundle is not what it says\n"
    );
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

/// The calendar may be set back during a run, or be wrong from the start. The bag tells what the clock told, and nothing
/// that is verified depends on it.
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
