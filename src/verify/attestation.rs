//! What a reviewer can sign and publish: which bundle was checked, how far, by what, when.

use super::{Report, Verdict};
use crate::bundle::{Moment, format};
use crate::json;
use serde_json::json;

/// Version of the record.
const ATTESTATION: u64 = 1;

impl Report {
    /// The record as one line of canonical JSON with a final line feed: the same check gives the same bytes.
    ///
    /// # Errors
    /// Where there is nothing to attest, in words.
    pub fn attestation(&self, date: Moment) -> Result<String, String> {
        let (Some(level), Verdict::Holds) = (self.reached, self.verdict()) else {
            let reached =
                self.reached.map_or("no level".to_owned(), |level| format!("level {level}"));
            return Err(format!(
                "the bundle holds to {reached} and not to level {}, as was asked",
                self.asked
            ));
        };
        let (Some(id), Some(results)) = (self.bundle_id, self.results_digest) else {
            return Err(
                "a crate without its bag has no bundle id to attest; check the bundle itself"
                    .to_owned(),
            );
        };
        let sample = self.sample.as_ref().map(|sample| {
            json!({
                "executed": sample.executed,
                "of": sample.of,
                "seed": sample.seed,
                "bound": sample.bound(),
                "in-words": sample.in_words(),
            })
        });
        let replication = self.replication.as_ref().map(
            |replication| json!({"seed": replication.seed, "in-words": replication.in_words()}),
        );
        let record = json!({
            "reenact-attestation": ATTESTATION,
            "bundle-id": format!("sha256:{id}"),
            "results-digest": format!("sha256:{results}"),
            "study-digest": self.study_digest.map(|digest| format!("sha256:{digest}")),
            "study": self.name,
            "verdict": self.verdict(),
            "level": level,
            "level-name": level.name(),
            "sample": sample,
            "replication": replication,
            "signed": self.signed,
            "engine": self.engine,
            "program": format!("reenact {}", format::VERSION),
            "date": date.iso(),
        });
        Ok(json::canonical(&record) + "\n")
    }
}
