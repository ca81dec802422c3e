//! What a trial yields: one canonical JSON line.

use super::{Measures, Outcome};
use crate::condition::Condition;
use crate::digest::{Hasher, Sha256Digest, TrialKey};
use crate::json;
use serde::{Deserialize, Serialize};

/// One point of a trial's curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub struct SeriesPoint {
    /// Simulated time since the trial began (s).
    pub time_s: f64,
    /// Distance travelled (m).
    pub distance_m: f64,
    /// Coverage (percent, 0 to 100).
    pub coverage_percent: f64,
}

/// Bytes of the longest line that is read as a record: a day of simulated time takes half of that.
const LONGEST_LINE: usize = 4 << 20;

/// Computes the digest of records in plan order: of their lines, each ended by a line feed.
pub fn records_digest(records: &[TrialRecord]) -> Sha256Digest {
    let mut hasher = Hasher::new();
    for record in records {
        hasher.update(record.to_line()).update("\n");
    }
    hasher.digest()
}

/// What came out of one trial.
///
/// ```
/// use reenact::bundle::{Bundle, Limits};
/// use reenact::studies::TrialRecord;
///
/// let zip = std::fs::read("artifacts/quickstart-published.zip").unwrap();
/// let bundle = Bundle::read(&zip, &Limits::default()).unwrap();
/// let record = bundle.records().unwrap().remove(0);
/// // One state hash every 10 s, and a text that reads back to the same record.
/// assert!(record.chain.len() as f64 >= (record.sim_seconds / 10.0).floor());
/// assert_eq!(TrialRecord::from_line(&record.to_line()), Ok(record));
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct TrialRecord {
    /// The trial this belongs to.
    pub key: TrialKey,
    /// The cell to which it belongs.
    pub condition: Condition,
    /// Number within the cell, from 0.
    pub trial: u32,
    /// Why it ended.
    pub outcome: Outcome,
    /// How, in words, where the outcome alone does not say; empty otherwise.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub cause: String,
    /// Named measures with their unit in the name; `null` where a trial never got there.
    pub measures: Measures,
    /// The trial's curve, at the first crossing of every whole percent and at every 10 s.
    pub series: Vec<SeriesPoint>,
    /// Simulated time the trial took (s).
    pub sim_seconds: f64,
    /// State hashes, one every 10 s of simulated time, each over the state and its predecessor (16 hex
    /// digits): the first that differs names the first divergent step.
    pub chain: Vec<String>,
}

/// The reason why a line is no record of a trial.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RecordError {
    /// No trial has so much to say.
    #[error("a line of {bytes} bytes (at most {LONGEST_LINE} allowed)")]
    Long {
        /// Its length.
        bytes: usize,
    },
    /// It is not the JSON of a record; what the reader of JSON says.
    #[error("{0}")]
    NoRecord(String),
    /// An entry of the state chain is none.
    #[error("no state hash of 16 hex digits at /chain/{at}")]
    NoStateHash {
        /// Its place in the chain, from 0.
        at: usize,
    },
}

impl TrialRecord {
    /// Creates the record of a trial that panicked with `cause`.
    pub fn panicked(spec: &super::TrialSpec, cause: String) -> Self {
        Self {
            key: spec.key,
            condition: spec.condition.clone(),
            trial: spec.trial,
            outcome: Outcome::PANICKED,
            cause,
            measures: Measures::new(),
            series: Vec::new(),
            sim_seconds: 0.0,
            chain: Vec::new(),
        }
    }

    /// Writes the canonical line, without its line feed.
    pub fn to_line(&self) -> String {
        json::canonical_of(self)
    }

    /// Reads a line of whatever origin.
    ///
    /// # Errors
    /// Where it is not the JSON of a record, or one that no trial can have.
    pub fn from_line(line: &str) -> Result<Self, RecordError> {
        if line.len() > LONGEST_LINE {
            return Err(RecordError::Long { bytes: line.len() });
        }
        let record: Self =
            serde_json::from_str(line).map_err(|e| RecordError::NoRecord(e.to_string()))?;
        let is_hash = |hash: &String| {
            hash.len() == 16 && hash.bytes().all(|b| matches!(b, b'0'..=b'9' | b'a'..=b'f'))
        };
        match record.chain.iter().position(|hash| !is_hash(hash)) {
            Some(at) => Err(RecordError::NoStateHash { at }),
            None => Ok(record),
        }
    }

    /// Estimates how much memory it takes (bytes), never much less.
    pub fn weight(&self) -> usize {
        const ALLOCATION: usize = 32;
        let text = |text: &String| size_of::<String>() + ALLOCATION + text.len();
        size_of::<Self>()
            + text(&self.cause)
            + self.chain.iter().map(text).sum::<usize>()
            + self.condition.iter().map(|(name, value)| text(name) + text(value)).sum::<usize>()
            + self.measures.weight(ALLOCATION)
            + self.series.len() * size_of::<SeriesPoint>()
    }

    /// Says in words when the states of this record's trial and those of `other` first differ.
    pub fn parting(&self, other: &Self) -> String {
        match self.first_divergence(other) {
            Some(after) => format!(
                "whose states first differ between {after} s and {} s of simulated time",
                after + CHAIN_STEP_S
            ),
            None => "with the same states throughout".to_owned(),
        }
    }

    /// Returns the first instant (s of simulated time) after which this record and `other` differ, by their hash
    /// chains; `None` where the chains agree as far as both go.
    pub fn first_divergence(&self, other: &Self) -> Option<f64> {
        first_divergence(&self.chain, &other.chain)
    }
}

/// Simulated time between two hashes of a chain (s).
pub const CHAIN_STEP_S: f64 = 10.0;

/// Returns the first instant (s of simulated time) after which the trials of two hash chains differ, or one goes on
/// alone; `None` where the chains are the same.
pub fn first_divergence(a: &[String], b: &[String]) -> Option<f64> {
    let common = a.len().min(b.len());
    let first = (0..common).find(|&i| a[i] != b[i]).or((a.len() != b.len()).then_some(common))?;
    #[expect(clippy::cast_precision_loss, reason = "chains are short")]
    Some(first as f64 * CHAIN_STEP_S)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_that_no_trial_wrote_are_refused() {
        let line = |chain: &str, cause: &str| {
            format!(
                "{{\"key\":\"{}\",\"condition\":[],\"trial\":0,\"outcome\":\"stuck\",\"cause\":\"{cause}\",\"measures\":{{}},\
                 \"series\":[],\"sim-seconds\":1,\"chain\":[{chain}]}}",
                "0".repeat(64)
            )
        };
        let refusal = |line: String| TrialRecord::from_line(&line).unwrap_err().to_string();
        assert!(TrialRecord::from_line(&line("\"0123456789abcdef\"", "")).is_ok());
        assert_eq!(
            refusal(line("\"0123456789abcdef\",\"\"", "")),
            "no state hash of 16 hex digits at /chain/1"
        );
        let many: Vec<String> = (0..5000).map(|i| format!("\"m-{i}\":1")).collect();
        let record = line("", "").replace("{}", &format!("{{{}}}", many.join(",")));
        let said = refusal(record);
        assert!(said.starts_with("more than 4096 measures at line 1 column "), "{said}");
        let long = line("", &"x".repeat(LONGEST_LINE));
        assert_eq!(
            refusal(long.clone()),
            format!("a line of {} bytes (at most 4194304 allowed)", long.len())
        );
    }

    #[test]
    fn weight_counts_what_is_small_in_text_and_large_in_memory() {
        let mut record = TrialRecord::from_line(
            &format!("{{\"key\":\"{}\",\"condition\":[],\"trial\":0,\"outcome\":\"stuck\",\"measures\":{{}},\"series\":[],\
                      \"sim-seconds\":1,\"chain\":[]}}", "0".repeat(64)),
        )
        .unwrap();
        let empty = record.weight();
        record.measures = (0..1000).map(|i| (format!("{i:03}"), None)).collect();
        assert_eq!(record.weight() - empty, 1000 * (24 + 32 + 3 + 32));
    }
}
