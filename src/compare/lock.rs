//! The lock: a small text beside a manifest that pins what its run yields.
//!
//! Canonical JSON in lines, so that a change reads well in a review: digests of everything, and of trial 0 of every
//! condition enough to find where a trial that changed left its old course.

use super::account::{Told, TrialAccount};
use super::{Account, ConditionAccount, ResultFile, Settings};
use crate::claims::Judgement;
use crate::digest::{FileDigest, ResultsDigest, Sha256Digest, TrialKey};
use crate::document::{self, Content, Diagnostic, Source};
use crate::json;
use crate::studies::{Measures, Outcome};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use thiserror::Error;

/// Version of the lock's format that this program writes, and the newest it reads.
pub const LOCK_FORMAT: u64 = 1;

/// Hashes of a chain in one line: a minute of simulated time.
const HASHES_PER_LINE: usize = 6;

const ABOUT: &str = "What a run of the manifest yields, written by `reenact lock`; not to be edited. \
                     The reason for a change belongs in CHANGELOG.md.";

/// What a lock says.
#[derive(Debug, Clone, PartialEq)]
pub struct Lock(Account);

/// Why a study cannot be locked.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum NotLockable {
    /// Only a part of it was run.
    #[error("expected the whole study, found a part of it: a lock pins all of it")]
    Partial,
    /// A trial panicked.
    #[error("trial {condition}/{number} panicked ({cause}): a panic is no result")]
    Panicked {
        /// The slug of its condition.
        condition: String,
        /// Its number there.
        number: u32,
        /// How, in words.
        cause: String,
    },
    /// A condition lacks its first trial.
    #[error("expected a trial 0 in the condition `{0}`, found none")]
    NoFirstTrial(String),
}

/// Why a lock cannot be read; every fault has its place.
#[derive(Debug, Clone, PartialEq)]
pub enum LockError {
    /// A newer program wrote it.
    Newer(Vec<Diagnostic>),
    /// It is no lock.
    Unreadable(Vec<Diagnostic>),
}

/// The lock as it is written.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
struct LockDocument {
    /// What this file is, for people.
    about: String,
    /// Version of the format.
    lock_format: u64,
    /// The study's short name.
    name: String,
    /// The engine that ran the trials.
    engine: String,
    /// SHA-256 of the manifest's bytes.
    #[schemars(with = "String")]
    manifest: FileDigest,
    /// Path as the study writes it, to SHA-256.
    #[schemars(with = "BTreeMap<String, String>")]
    inputs: BTreeMap<String, FileDigest>,
    /// What trials are run with, for the study as a whole.
    settings: BTreeMap<String, Value>,
    /// What trials are run with, alike in every condition.
    every_condition: BTreeMap<String, Value>,
    /// The cells, in plan order.
    conditions: Vec<LockedCondition>,
    /// Path under `results/` to SHA-256.
    #[schemars(with = "BTreeMap<String, String>")]
    results: BTreeMap<String, FileDigest>,
    /// Id to verdict.
    claims: BTreeMap<String, Judgement>,
    /// Digest of the result half of the bundle.
    #[schemars(with = "String")]
    results_digest: ResultsDigest,
}

#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
struct LockedCondition {
    /// Its file name under `trials/`, without extension.
    slug: String,
    /// How many trials it has.
    trials: usize,
    /// SHA-256 of `trials/<slug>.jsonl`.
    #[schemars(with = "String")]
    records: Sha256Digest,
    /// What its trials alone are run with.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    settings: BTreeMap<String, Value>,
    /// Its trial 0.
    first_trial: LockedTrial,
}

#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
struct LockedTrial {
    /// Its identity.
    #[schemars(with = "String")]
    key: TrialKey,
    /// Why it ended.
    outcome: String,
    /// How, in words.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    cause: String,
    /// SHA-256 of its record's line.
    #[schemars(with = "String")]
    sha256: Sha256Digest,
    /// Its measures.
    #[schemars(with = "BTreeMap<String, Option<f64>>")]
    measures: Measures,
    /// Its state hashes, a minute of simulated time in a line.
    chain: Vec<String>,
}

impl Lock {
    /// Makes the lock of the study of `account`.
    ///
    /// # Errors
    /// Where only a part of the study was run, or a trial panicked.
    pub fn of(account: &Account) -> Result<Self, NotLockable> {
        if account.partial {
            return Err(NotLockable::Partial);
        }
        let mut locked = account.clone();
        locked.is_lock = true;
        locked.settings = account.settings.of_trials();
        for condition in &mut locked.conditions {
            let slug = &condition.slug;
            let panicked = Outcome::PANICKED.name();
            if let Some(trial) = condition.known.iter().find(|t| t.told().outcome == panicked) {
                return Err(NotLockable::Panicked {
                    condition: slug.clone(),
                    number: trial.number,
                    cause: trial.told().cause.clone(),
                });
            }
            condition.known.retain(|trial| trial.number == 0);
            if condition.known.is_empty() {
                return Err(NotLockable::NoFirstTrial(slug.clone()));
            }
        }
        let first = locked.conditions.iter().flat_map(|condition| &condition.known);
        locked.measures =
            first.flat_map(|trial| trial.told().measures.names()).map(str::to_owned).collect();
        for file in locked.results.values_mut() {
            file.text = None;
        }
        Ok(Self(locked))
    }

    /// Returns what it says, as one side of a comparison.
    pub fn account(&self) -> &Account {
        &self.0
    }

    /// Returns the file's text.
    pub fn to_text(&self) -> String {
        let account = &self.0;
        let every_condition = account.settings.shared();
        let own = |slug: &str| {
            let mut values = account.settings.conditions.get(slug).cloned().unwrap_or_default();
            values.retain(|path, _| !every_condition.contains_key(path));
            values
        };
        let conditions = account.conditions.iter().filter_map(|condition| {
            Some(LockedCondition {
                slug: condition.slug.clone(),
                trials: condition.trials,
                records: condition.records,
                settings: own(&condition.slug),
                first_trial: written(condition.known.first()?),
            })
        });
        let document = LockDocument {
            about: ABOUT.to_owned(),
            lock_format: LOCK_FORMAT,
            name: account.name.clone(),
            engine: account.engine.clone(),
            manifest: account.manifest,
            inputs: account.inputs.clone(),
            settings: account.settings.study.clone(),
            conditions: conditions.collect(),
            every_condition,
            results: account.results.iter().map(|(p, file)| (p.clone(), file.digest)).collect(),
            claims: account.claims.clone(),
            results_digest: account.results_digest,
        };
        json::indented(&json::canonical_of(&document))
    }

    /// Reads a lock's text.
    ///
    /// # Errors
    /// Every fault; of a newer format nothing else is looked at.
    pub fn read(source: &Source) -> Result<Self, LockError> {
        let tree = document::read(source).map_err(LockError::Unreadable)?;
        if let Some(node) = tree.node("/lock-format")
            && let Content::Integer(version) = node.content
            && version > i128::from(LOCK_FORMAT)
        {
            let fault = tree
                .fault(node.place, format!("lock format {version} is newer than this program"))
                .label(format!("expected {LOCK_FORMAT} or less"))
                .help("install a newer reenact, or delete the lock and write it anew with `reenact lock`");
            return Err(LockError::Newer(vec![fault]));
        }
        let parsed = document::parse_tree::<LockDocument>(tree).map_err(LockError::Unreadable)?;
        if parsed.value.conditions.is_empty() {
            let fault = parsed
                .fault("/conditions", "a lock without conditions pins nothing")
                .help("write it anew with `reenact lock`");
            return Err(LockError::Unreadable(vec![fault]));
        }
        Ok(Self(account_of(parsed.value)))
    }
}

fn written(trial: &TrialAccount) -> LockedTrial {
    let told = trial.told();
    LockedTrial {
        key: trial.key,
        outcome: told.outcome.clone(),
        cause: told.cause.clone(),
        sha256: trial.sha256,
        measures: told.measures.clone(),
        chain: told.chain.chunks(HASHES_PER_LINE).map(|minute| minute.join(" ")).collect(),
    }
}

fn account_of(document: LockDocument) -> Account {
    let mut settings = Settings { study: document.settings, conditions: BTreeMap::new() };
    let (mut conditions, mut measures) = (Vec::new(), BTreeSet::new());
    for condition in document.conditions {
        let mut values = document.every_condition.clone();
        values.extend(condition.settings);
        settings.conditions.insert(condition.slug.clone(), values);
        let first = condition.first_trial;
        let chain = first.chain.iter().flat_map(|line| line.split_ascii_whitespace());
        let told = Told {
            outcome: first.outcome,
            cause: first.cause,
            chain: chain.map(str::to_owned).collect(),
            measures: first.measures,
        };
        measures.extend(told.measures.names().map(str::to_owned));
        let (key, sha256, told) = (first.key, first.sha256, Some(Box::new(told)));
        let known = vec![TrialAccount { key, number: 0, sha256, told }];
        conditions.push(ConditionAccount {
            slug: condition.slug,
            trials: condition.trials,
            records: condition.records,
            known,
        });
    }
    Account {
        is_lock: true,
        name: document.name,
        engine: document.engine,
        partial: false,
        manifest: document.manifest,
        results_digest: document.results_digest,
        inputs: document.inputs,
        settings,
        conditions,
        results: document
            .results
            .into_iter()
            .map(|(path, digest)| (path, ResultFile { digest, text: None }))
            .collect(),
        claims: document.claims,
        measures,
    }
}
