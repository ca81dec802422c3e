//! The tampering suite: every damage is found at the rung that should find it, and named.

mod answers;
mod damaged;
mod executed;
mod forged;
mod honest;
mod parts;
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
    fn engine(&self, _: &Bundle) -> String {
        self.version.to_owned()
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
            slug: slug.into(),
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
    climb(Ok(Archive::of(Form::Bag, tree)), &options, &ENGINE)
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

/// Hides digests, which depend on every byte of the sample; that one stands there is what matters.
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

/// Makes a bundle forged as well as can be: one record invented, and everything that follows from it derived by the
/// program itself.
fn forged() -> Tree {
    let mut records = sample::records();
    let measures = &mut records[0].1[1].measures;
    assert!(measures.number("distance-m-at-90").is_some());
    measures.insert("distance-m-at-90", Some(0.25));
    let content = sample::content_of(sample::STUDY.as_bytes(), 7, &records);
    crate::bundle::seal(&content, &sample::circumstance()).unwrap().tree
}
