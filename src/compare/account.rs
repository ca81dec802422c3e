//! What one side says, by meaning: the half of a bundle, or the part of it that a lock keeps.

use super::Settings;
use crate::bundle::{Bundle, BundlePath, Fault};
use crate::claims::{ClaimVerdict, Judgement};
use crate::digest::{FileDigest, ResultsDigest, Sha256Digest, TrialKey};
use crate::studies::{Measures, TrialRecord};
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;

/// One side of a comparison.
#[derive(Debug, Clone, PartialEq)]
pub struct Account {
    /// Whether a lock says it, which holds less than a bundle.
    pub is_lock: bool,
    /// The study's short name.
    pub name: String,
    /// The engine that ran the trials.
    pub engine: String,
    /// Whether only part of the study was run.
    pub partial: bool,
    /// Digest of the manifest's bytes.
    pub manifest: FileDigest,
    /// What came out, as one digest.
    pub results_digest: ResultsDigest,
    /// Digest of every input, by the path by which the study names it.
    pub inputs: BTreeMap<String, FileDigest>,
    /// What was asked, with nothing left to guess.
    pub settings: Settings,
    /// The cells, in plan order.
    pub conditions: Vec<ConditionAccount>,
    /// Everything under `results/`, by its path there.
    pub results: BTreeMap<String, ResultFile>,
    /// The verdict on each claim, by its id.
    pub claims: BTreeMap<String, Judgement>,
}

/// A cell.
#[derive(Debug, Clone, PartialEq)]
pub struct ConditionAccount {
    /// Its file name under `trials/`, without extension.
    pub slug: String,
    /// How many trials it has.
    pub trials: usize,
    /// Digest of all its records' lines.
    pub records: Sha256Digest,
    /// The trials that this side holds: all of them in a bundle, trial 0 in a lock.
    pub known: Vec<TrialAccount>,
}

/// A trial, without its curve.
#[derive(Debug, Clone, PartialEq)]
pub struct TrialAccount {
    /// Its identity.
    pub key: TrialKey,
    /// Its number within the condition.
    pub number: u32,
    /// Why it ended.
    pub outcome: String,
    /// How, in words, where the outcome alone does not say.
    pub cause: String,
    /// Its measures with their units in the names, and `sim-seconds`.
    pub measures: Measures,
    /// Its state hashes.
    pub chain: Vec<String>,
    /// Digest of its record's line.
    pub sha256: Sha256Digest,
}

/// A file under `results/`.
#[derive(Debug, Clone, PartialEq)]
pub struct ResultFile {
    /// Digest of its bytes.
    pub digest: FileDigest,
    /// Its text, where this side holds it and it is one.
    pub text: Option<String>,
}

/// The measure that stands for a record's simulated time (s).
pub(super) const SIM_SECONDS: &str = "sim-seconds";

impl TrialAccount {
    /// Returns the account of a record.
    fn of(record: TrialRecord, line: &str) -> Self {
        let mut measures = record.measures;
        measures.insert(SIM_SECONDS, Some(record.sim_seconds));
        Self {
            key: record.key,
            number: record.trial,
            outcome: record.outcome.name().to_owned(),
            cause: record.cause,
            measures,
            chain: record.chain,
            sha256: Sha256Digest::of(line),
        }
    }
}

impl Account {
    /// Returns the account of a bundle.
    ///
    /// # Errors
    /// Every line that is not a record, and `results/claims.json` where it is not a list of verdicts.
    pub fn of_bundle(bundle: &Bundle) -> Result<Self, Vec<Fault>> {
        let mut faults = Vec::new();
        let mut conditions = Vec::new();
        for entry in bundle.conditions() {
            let (mut known, mut all) = (Vec::new(), String::new());
            for (i, line) in bundle.record_lines(&entry.slug).enumerate() {
                all.push_str(line);
                all.push('\n');
                match TrialRecord::from_line(line) {
                    Ok(record) => known.push(TrialAccount::of(record, line)),
                    Err(problem) => faults.push(Fault::new(
                        BundlePath::records(&entry.slug).line(i + 1),
                        "a trial record",
                        problem.to_string(),
                    )),
                }
            }
            let (slug, records) = (entry.slug.clone(), Sha256Digest::of(&all));
            conditions.push(ConditionAccount { slug, trials: known.len(), records, known });
        }
        let results = bundle.results().map(|(path, bytes)| {
            let digest = FileDigest(Sha256Digest::of(bytes));
            let text = std::str::from_utf8(bytes).ok().map(str::to_owned);
            (path.to_owned(), ResultFile { digest, text })
        });
        let results: BTreeMap<_, _> = results.collect();
        let verdicts = verdicts(&results).map_err(|fault| faults.push(fault)).unwrap_or_default();
        let claims = verdicts.into_iter().map(|verdict| (verdict.id, verdict.judgement)).collect();
        if !faults.is_empty() {
            return Err(faults);
        }
        Ok(Self {
            is_lock: false,
            name: bundle.name().to_owned(),
            engine: bundle.engine().to_owned(),
            partial: bundle.is_partial(),
            manifest: FileDigest(Sha256Digest::of(bundle.study_yaml())),
            results_digest: bundle.results_digest(),
            inputs: bundle
                .inputs()
                .iter()
                .map(|input| (input.as_written.clone(), input.sha256))
                .collect(),
            settings: Settings::of(bundle.resolved()),
            conditions,
            results,
            claims,
        })
    }

    /// Returns the cell called `slug`.
    pub fn condition(&self, slug: &str) -> Option<&ConditionAccount> {
        self.conditions.iter().find(|condition| condition.slug == slug)
    }
}

/// Reads the verdict on every claim; none where this side holds no claims.
pub(super) fn verdicts(results: &BTreeMap<String, ResultFile>) -> Result<Vec<ClaimVerdict>, Fault> {
    let fault =
        |found: String| Fault::new(BundlePath::result("claims.json"), "a list of verdicts", found);
    let Some(file) = results.get("claims.json") else { return Ok(Vec::new()) };
    let text = file.text.as_deref().unwrap_or_default();
    let list: Vec<Value> = serde_json::from_str(text).map_err(|e| fault(e.to_string()))?;
    let read = |claim: &Value| {
        ClaimVerdict::deserialize(claim).map_err(|e| fault(claim.to_string()).hint(e.to_string()))
    };
    list.iter().map(read).collect()
}
