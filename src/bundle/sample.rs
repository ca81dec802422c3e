//! A small bundle for tests, and tools to damage it.

use super::{
    Account, BundleContent, Circumstance, Content, FileRef, Form, Moment, Person, Publication,
    Question, Sealed, SealedCondition, ToldClaim, ToldFigure, ToldTable, Tree, bag, format,
    in_parts, seal, seal_inputs,
};
use crate::condition::Condition;
use crate::digest::{Sha256Digest, TrialKey};
use crate::plan::ResolvedStudy;
use crate::studies::{Outcome, TrialRecord};
use crate::table::{Column, DescribedTable, Table};
use std::io::{Cursor, Write as _};
use std::sync::OnceLock;

pub(crate) const ENGINE: &str = "test-1";
pub(crate) const STUDY: &str = "name: corridors\nseed: 7\n";

/// Returns the record that the pretended engine yields for a trial of the condition `prior`: a pure function of its
/// arguments.
pub(crate) fn record(seed: u64, prior: &str, trial: u32) -> TrialRecord {
    let key = Sha256Digest::of(format!("{ENGINE}/{seed}/{prior}/{trial}"));
    let distance = f64::from(key.0[0]) + 0.5;
    TrialRecord {
        key: TrialKey(key),
        condition: Condition::from([("prior", prior)]),
        trial,
        outcome: Outcome::EXPLORED,
        cause: String::new(),
        measures: [("distance-m-at-90".to_owned(), Some(distance))].into(),
        series: Vec::new(),
        sim_seconds: 20.0,
        chain: (0..2)
            .map(|i| Sha256Digest::of(format!("{key}/{i}")).hex()[..16].to_owned())
            .collect(),
    }
}

/// Makes results that follow from records.
pub(crate) fn results(records: &[TrialRecord]) -> Vec<(String, Vec<u8>)> {
    let mut trials = Table::new(["key", "prior", "trial", "outcome", "distance-m-at-90"]);
    let mut sum = 0.0;
    for record in records {
        let distance = record.measures["distance-m-at-90"];
        sum += distance.unwrap_or_default();
        trials.push(vec![
            record.key.hex().into(),
            record.condition[0].1.as_str().into(),
            i64::from(record.trial).into(),
            record.outcome.name().into(),
            distance.into(),
        ]);
    }
    let mut table = Table::new(["coverage", "distance-m"]);
    table.push(vec!["90%".into(), (sum / f64::from(u32::try_from(records.len()).unwrap())).into()]);
    vec![
        ("trials.csv".into(), trials.to_csv().into_bytes()),
        ("tables/distance.csv".into(), table.to_csv().into_bytes()),
        ("tables/distance.md".into(), table.to_markdown().into_bytes()),
        ("claims.json".into(), b"[{\"id\":\"P1\",\"verdict\":\"supported\"}]\n".to_vec()),
        ("figures/distance.svg".into(), b"<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"9\" height=\"9\"><title>Distance</title></svg>\n".to_vec()),
    ]
}

/// Describes the columns of the sample's tables.
pub(crate) fn tables() -> Vec<DescribedTable> {
    let table = |columns: &[&str]| Table::new(columns.iter().copied());
    let distance = |name: &str| Column::number(name, "m", "Way travelled at 90 %").at_least(0.0);
    let factor = ["none", "floor-plan"].map(str::to_owned);
    let describe = |name: &str| match name {
        "prior" => Some(Column::of_values(name, "", "Which prior", &factor)),
        "trial" => Some(Column::count(name, "Number in its condition")),
        "distance-m-at-90" => Some(distance(name).empty_where("it never got there")),
        "coverage" | "key" | "outcome" => Some(Column::text(name, "A name")),
        "distance-m" => Some(distance(name)),
        _ => None,
    };
    let trials = table(&["key", "prior", "trial", "outcome", "distance-m-at-90"]);
    let means = table(&["coverage", "distance-m"]);
    vec![
        DescribedTable {
            key: vec!["key".into()],
            ..DescribedTable::of(
                &trials,
                "results/trials.csv".into(),
                ("Trials", "a trial"),
                describe,
            )
        },
        DescribedTable::of(
            &means,
            "results/tables/distance.csv".into(),
            ("Means", "a mean"),
            describe,
        ),
    ]
}

/// Makes a resolved study that says no more than `document`.
pub(crate) fn resolved(document: serde_json::Value) -> ResolvedStudy {
    serde_json::from_value(document).unwrap()
}

fn lines_in_parts(records: &[TrialRecord]) -> Vec<Content> {
    let lines: Vec<String> = records.iter().map(TrialRecord::to_line).collect();
    in_parts(lines.iter().map(String::as_str))
}

/// Returns the content that sealing the sample study with `records` (by condition) yields.
pub(crate) fn content_of(
    study_yaml: &[u8],
    seed: u64,
    conditions: &[(&str, Vec<TrialRecord>)],
) -> BundleContent {
    let all: Vec<TrialRecord> =
        conditions.iter().flat_map(|(_, records)| records.clone()).collect();
    BundleContent {
        name: "corridors".into(),
        title: "Corridors with and without a floor plan".into(),
        description: "A robot explores corridors, with and without a floor plan.".into(),
        cite: Some(Publication {
            text: "A. Author, \"On corridors\", 2020".into(),
            url: Some("https://doi.org/10.1000/182".into()),
        }),
        authors: vec![Person {
            name: "A. Researcher".into(),
            affiliation: Some("Example Robotics Lab".into()),
            ..Person::default()
        }],
        license: "CC-BY-4.0".into(),
        seed,
        engine: ENGINE.into(),
        study_yaml: study_yaml.to_vec(),
        resolved: resolved(serde_json::json!({"seed": seed, "parameters": {"range-m": 8.5}})),
        inputs: seal_inputs([
            ("../worlds/a.yaml".into(), b"walls: [1]\n".to_vec(), None),
            (
                "../robots/r.urdf".into(),
                b"<robot name=\"r\"/>\n".to_vec(),
                Some("BSD-3-Clause".into()),
            ),
        ]),
        conditions: conditions
            .iter()
            .map(|(slug, records)| SealedCondition {
                slug: (*slug).into(),
                label: format!("prior={slug}"),
                trials: records.len(),
                failed: 0,
                parts: lines_in_parts(records),
            })
            .collect(),
        results: results(&all),
        large_results: Vec::new(),
        tables: tables(),
        robustness: None,
        multiverse: None,
        partial: false,
        account: account(),
    }
}

/// Tells what the sample found.
fn account() -> Account {
    Account {
        finding: "Of the paper's one claim, 1 holds here.".into(),
        limits: vec!["The corridors are invented.".into()],
        partial: None,
        claims: vec![ToldClaim {
            id: "P1".into(),
            words: "A floor plan shortens the way.".into(),
            is_ours: false,
            cite: "section 3".into(),
            verdict: "supported".into(),
            paper_table: "supports".into(),
        }],
        tables: vec![ToldTable {
            path: "results/tables/distance.csv".into(),
            title: "Distance".into(),
            answer: None,
            lines: Table::new(["coverage", "distance-m"]),
            more: 0,
            rules: None,
        }],
        figures: vec![ToldFigure {
            path: "results/figures/distance.svg".into(),
            title: "Distance".into(),
            caption: "One bar a prior.".into(),
            alt: "A bar chart.".into(),
        }],
        question: Some(Question {
            condition: vec![("prior".into(), "none".into())],
            outcomes: vec!["explored".into()],
            claim: Some("P1".into()),
        }),
    }
}

pub(crate) fn records() -> Vec<(&'static str, Vec<TrialRecord>)> {
    ["none", "floor-plan"]
        .map(|prior| (prior, (0..3).map(|trial| record(7, prior, trial)).collect()))
        .into()
}

pub(crate) fn content() -> BundleContent {
    content_of(STUDY.as_bytes(), 7, &records())
}

pub(crate) fn circumstance() -> Circumstance {
    Circumstance {
        version: format::VERSION.into(),
        started: Moment(1_768_478_400),
        ended: Moment(1_768_478_460),
        environment: vec![("os".into(), "linux".into()), ("jobs".into(), "2".into())],
        files: Vec::new(),
    }
}

pub(crate) fn sealed() -> Sealed {
    seal(&content(), &circumstance()).unwrap()
}

/// Returns the sample bundle, sealed once.
pub(crate) fn zip() -> &'static [u8] {
    static ZIP: OnceLock<Vec<u8>> = OnceLock::new();
    ZIP.get_or_init(|| sealed().zip(Form::Bag))
}

/// Makes a zip of just these entries, whatever their names.
pub(crate) fn zip_of(entries: &[(&str, &[u8])]) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in entries {
        zip.start_file(*name, zip::write::SimpleFileOptions::default()).unwrap();
        zip.write_all(bytes).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

/// Replaces every occurrence of `from` by `to`, of equal length.
pub(crate) fn replace(bytes: &mut [u8], from: &[u8], to: &[u8]) {
    assert_eq!(from.len(), to.len());
    for at in 0..=bytes.len() - from.len() {
        if bytes[at..].starts_with(from) {
            bytes[at..at + to.len()].copy_from_slice(to);
        }
    }
}

/// Makes every checksum of a tree right again: what a forger does. Digests and sizes in the crate's metadata, the
/// results digest wherever it stands, the bag's manifests and its count of bytes.
pub(crate) fn recompute(tree: &mut Tree) {
    fn held(tree: &Tree) -> impl Iterator<Item = (&String, FileRef<'_>)> {
        tree.iter().map(|(path, bytes)| (path, FileRef::Held(bytes)))
    }
    let text = |tree: &Tree, path: &str| String::from_utf8(tree[path].clone()).unwrap();
    let mut metadata: serde_json::Value =
        serde_json::from_slice(&tree["data/ro-crate-metadata.json"]).unwrap();
    let results = super::results_digest(tree);
    let study = Sha256Digest::of(&tree["data/study.resolved.json"]);
    for entity in metadata["@graph"].as_array_mut().unwrap() {
        let id = entity["@id"].as_str().unwrap().to_owned();
        if id == "#results-digest" {
            entity["value"] = format!("sha256:{results}").into();
        } else if id == "#study-digest" {
            entity["value"] = format!("sha256:{study}").into();
        } else if let (Some(bytes), true) =
            (tree.get(&format!("data/{id}")), entity.get("sha256").is_some())
        {
            entity["sha256"] = Sha256Digest::of(bytes).hex().into();
            entity["contentSize"] = bytes.len().to_string().into();
        }
    }
    tree.insert("data/ro-crate-metadata.json".into(), format!("{metadata:#}\n").into_bytes());
    let payload: Tree = tree
        .iter()
        .filter(|(p, _)| p.starts_with("data/"))
        .map(|(p, b)| (p.clone(), b.clone()))
        .collect();
    let octets: usize = payload.values().map(Vec::len).sum();
    let info: String = text(tree, format::BAG_INFO)
        .lines()
        .map(|line| match line.split_once(": ").unwrap() {
            ("Payload-Oxum", _) => format!("Payload-Oxum: {octets}.{}\n", payload.len()),
            ("Results-Digest", _) => format!("Results-Digest: sha256:{results}\n"),
            ("Study-Digest", _) => format!("Study-Digest: sha256:{study}\n"),
            _ => format!("{line}\n"),
        })
        .collect();
    tree.insert(format::BAG_INFO.into(), info.into_bytes());
    tree.insert(format::MANIFEST.into(), bag::manifest(held(&payload)).into_bytes());
    let tags: Tree = tree
        .iter()
        .filter(|(p, _)| !p.starts_with("data/") && *p != format::TAG_MANIFEST)
        .map(|(p, b)| (p.clone(), b.clone()))
        .collect();
    tree.insert(format::TAG_MANIFEST.into(), bag::manifest(held(&tags)).into_bytes());
}
