//! What one side says, by meaning: the half of a bundle, or the part of it that a lock keeps.

use super::Settings;
use crate::bundle::{Bundle, BundlePath, Fault};
use crate::claims::{ClaimVerdict, Judgement};
use crate::digest::{FileDigest, Hasher, ResultsDigest, Sha256Digest, TrialKey};
use crate::studies::inference::of_draws;
use crate::studies::{Measures, Outcome, TrialRecord};
use serde::Deserialize;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

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
    /// Names of the measures that any trial which this side holds says something of.
    pub measures: BTreeSet<String>,
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
    /// Digest of its record's line.
    pub sha256: Sha256Digest,
    /// What its record says; nothing of a trial that is the same on both sides, where there are many.
    pub told: Option<Box<Told>>,
}

/// What the record of a trial says, without its curve.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Told {
    /// Why it ended.
    pub outcome: String,
    /// How, in words, where the outcome alone does not say.
    pub cause: String,
    /// Its measures with their units in the names, and `sim-seconds`.
    pub measures: Measures,
    /// Its state hashes.
    pub chain: Vec<String>,
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

impl Told {
    fn of(record: TrialRecord) -> Self {
        let mut measures = record.measures;
        if record.outcome == Outcome::PROPOSED {
            // Hundreds of proposals would say more than a lock can hold; the digest of the record pins all of it.
            measures.retain(|name| !of_draws(name));
        }
        measures.insert(SIM_SECONDS, Some(record.sim_seconds));
        let outcome = record.outcome.name().to_owned();
        Self { outcome, cause: record.cause, measures, chain: record.chain }
    }
}

impl TrialAccount {
    /// Returns what its record says; an empty one where that is not known here.
    pub fn told(&self) -> &Told {
        static NOTHING: Told = Told {
            outcome: String::new(),
            cause: String::new(),
            measures: Measures::new(),
            chain: Vec::new(),
        };
        self.told.as_deref().unwrap_or(&NOTHING)
    }
}

/// How many trials two bundles may have together for everything to be told of each.
const FEW: usize = 20_000;

impl Account {
    /// Returns the account of a bundle.
    ///
    /// # Errors
    /// Every line that is not a record, and `results/claims.json` where it is not a list of verdicts.
    pub fn of_bundle(bundle: &Bundle) -> Result<Self, Vec<Fault>> {
        Self::telling(bundle, |_| true)
    }

    /// Returns the accounts of two bundles; where these are large, what records say is told of trials alone that the other does not
    /// have as they are.
    ///
    /// # Errors
    /// As [`Self::of_bundle`].
    pub fn of_bundles(a: &Bundle, b: &Bundle) -> [Result<Self, Vec<Fault>>; 2] {
        let trials = |bundle: &Bundle| -> usize {
            bundle.conditions().iter().map(|c| bundle.record_count(&c.slug)).sum()
        };
        if trials(a) + trials(b) <= FEW {
            return [a, b].map(Self::of_bundle);
        }
        let digests = |bundle: &Bundle| {
            let mut digests: Vec<Sha256Digest> = Vec::with_capacity(trials(bundle));
            for condition in bundle.conditions() {
                bundle.record_lines(&condition.slug, |line| {
                    digests.push(Sha256Digest::of(line.text));
                    true
                });
            }
            digests.sort_unstable();
            digests
        };
        let only_in = |bundle: &Bundle, other: Vec<Sha256Digest>| {
            Self::telling(bundle, |line| other.binary_search(line).is_err())
        };
        [(a, b), (b, a)].map(|(one, other)| only_in(one, digests(other)))
    }

    /// Returns the account of a bundle, with what those records say whose digests `tells` wants.
    fn telling(bundle: &Bundle, tells: impl Fn(&Sha256Digest) -> bool) -> Result<Self, Vec<Fault>> {
        let mut measures: BTreeSet<String> = BTreeSet::from([SIM_SECONDS.to_owned()]);
        let mut faults = Vec::new();
        let mut conditions = Vec::new();
        for entry in bundle.conditions() {
            let (mut known, mut all) = (Vec::new(), Hasher::new());
            bundle.record_lines(&entry.slug, |line| {
                all.update(line.text).update("\n");
                match TrialRecord::from_line(line.text) {
                    Ok(record) => {
                        for name in record.measures.names() {
                            if !measures.contains(name) {
                                measures.insert(name.to_owned());
                            }
                        }
                        let (key, number) = (record.key, record.trial);
                        let sha256 = Sha256Digest::of(line.text);
                        let told = tells(&sha256).then(|| Box::new(Told::of(record)));
                        known.push(TrialAccount { key, number, sha256, told });
                    }
                    Err(problem) => {
                        faults.push(Fault::new(
                            line.place(),
                            "a trial record",
                            problem.to_string(),
                        ));
                    }
                }
                true
            });
            let (slug, records) = (entry.slug.clone(), all.digest());
            conditions.push(ConditionAccount { slug, trials: known.len(), records, known });
        }
        let results = bundle.result_files().map(|(path, file)| {
            let digest = FileDigest(file.digest());
            // What is not in memory has a line for each trial, and these are compared by themselves.
            let text = file.held().and_then(|bytes| std::str::from_utf8(bytes).ok());
            let text = text.map(str::to_owned);
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
            measures,
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
