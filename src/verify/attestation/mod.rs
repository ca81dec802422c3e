//! What a reviewer can sign and publish: which bundle was checked, how far, by what, when, and what was noticed.
//!
//! In the field's form: an in-toto Statement about the bundle's list of digests, in a DSSE envelope. Reenact writes it
//! unsigned and reads no private key; `ssh-keygen -Y sign` signs the bytes that DSSE says, and the signature is put in.

mod dsse;
mod reading;
mod statement;

pub use dsse::Envelope;
pub use reading::Attestation;

use super::{EarlierAgain, Level, Report, Verdict};
use crate::bundle::{Moment, format};
use crate::json;
use statement::{Digests, Note, Predicate, Replicated, Rung, Sampled, Statement, Subject};

/// The most bytes that an envelope may have.
pub const LONGEST: u64 = 1 << 20;

/// Why there is nothing to attest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum AttestError {
    /// The check was held against an attestation that is not good.
    #[error("the attestation that was given is refused")]
    Refused,
    /// It holds less far than was asked.
    #[error("the bundle holds to level {reached} and not to level {asked}, as was asked")]
    NotSoFar {
        /// How far it holds.
        reached: Level,
        /// How far was asked.
        asked: Level,
    },
    /// Not even level 0 holds.
    #[error("the bundle holds to no level and not to level {asked}, as was asked")]
    Nowhere {
        /// How far was asked.
        asked: Level,
    },
    /// There is no bag.
    #[error("a crate without its bag has no bundle id to attest; check the bundle itself")]
    NoBag,
}

impl Report {
    /// Returns the attestation of a check that holds, unsigned: the same check gives the same bytes.
    ///
    /// # Errors
    /// Where there is nothing to attest.
    pub fn attest(&self, date: Moment) -> Result<Envelope, AttestError> {
        let (asked, reached) = (self.asked, self.reached);
        let (Some(level), Verdict::Holds) = (reached, self.verdict()) else {
            return Err(match reached {
                Some(reached) if reached == asked => AttestError::Refused,
                Some(reached) => AttestError::NotSoFar { reached, asked },
                None => AttestError::Nowhere { asked },
            });
        };
        let (Some(id), Some(results), Some(study), Some(departure)) =
            (self.bundle_id, self.results_digest, self.study_digest, &self.departure)
        else {
            return Err(AttestError::NoBag);
        };
        let notes = self.findings.iter().map(|finding| Note {
            level: finding.level.number(),
            path: finding.path.clone(),
            expected: finding.expected.clone(),
            found: finding.found.clone(),
            hint: finding.hint.clone(),
        });
        let levels = self.states().into_iter().map(|state| Rung {
            level: state["level"].as_u64().unwrap_or_default(),
            name: state["name"].as_str().unwrap_or_default().to_owned(),
            state: state["state"].as_str().unwrap_or_default().to_owned(),
        });
        let predicate = Predicate {
            bundle_id: format!("sha256:{id}"),
            results_digest: format!("sha256:{results}"),
            study_digest: format!("sha256:{study}"),
            study: self.name.clone().unwrap_or_default(),
            partial: departure.partial,
            overrides: departure.overrides.clone(),
            selection: departure.selection.as_ref().map(json::value_of),
            verdict: statement::HOLDS.to_owned(),
            level: level.number(),
            level_name: level.name().to_owned(),
            levels: levels.collect(),
            sample: self.sample.as_ref().map(|sample| Sampled {
                executed: sample.executed,
                equal: sample.equal,
                of: sample.of,
                seed: sample.seed.map(|seed| seed.to_string()),
                bound: sample.bound(),
                in_words: sample.in_words(),
            }),
            earlier: self.earlier.iter().map(EarlierAgain::in_words).collect(),
            replication: self.replication.as_ref().map(|replication| Replicated {
                seed: replication.seed.to_string(),
                in_words: replication.in_words(),
            }),
            signed: self.signed.clone(),
            notes: notes.collect(),
            not_checked: self.unchecked.clone(),
            engine: self.engine.clone().unwrap_or_default(),
            program: format!("reenact {}", format::VERSION),
            date: statement::written(date),
        };
        let subject = Subject {
            name: Some(format::TAG_MANIFEST.to_owned()),
            digest: Digests { sha256: id.to_string() },
        };
        Ok(Envelope::unsigned(&Statement::about(subject, predicate)))
    }
}
