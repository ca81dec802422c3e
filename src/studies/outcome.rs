//! Why trials end: a study's own word, and what kind of end that is.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::borrow::Cow;
use std::fmt;

/// What kind of end a trial came to, the best first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// The robot did what it was sent for.
    Success,
    /// Its time was up.
    TimeUp,
    /// Nothing went wrong, and nothing went on.
    Idle,
    /// Something went wrong.
    Failure,
    /// The program failed: no result of any kind.
    Fault,
}

/// Why a trial ended.
#[derive(Clone, Copy)]
pub struct Outcome {
    name: &'static str,
    end: End,
    says: &'static str,
}

impl Outcome {
    /// The manifest's own time limit ended the trial.
    pub const TIME_LIMIT: Self =
        Self::new("time-limit", End::TimeUp, "the manifest's time limit was reached");
    /// An inference's trial held a building against the observed table.
    pub const PROPOSED: Self = Self::new(
        "proposed",
        End::Idle,
        "a building was held against the observed table; nothing was simulated",
    );
    /// The program failed inside the trial; the record says how. Never stored.
    pub const PANICKED: Self = Self::new("panicked", End::Fault, "the program failed");

    /// Creates an outcome called `name`, which `says` this of a trial. Studies list theirs in
    /// [`super::Study::outcomes`].
    pub(super) const fn new(name: &'static str, end: End, says: &'static str) -> Self {
        Self { name, end, says }
    }

    /// Returns the name in tables and records.
    pub fn name(self) -> &'static str {
        self.name
    }

    /// Returns what kind of end it is.
    pub fn end(self) -> End {
        self.end
    }

    /// Returns what it says of a trial, in words that follow a colon.
    pub fn says(self) -> &'static str {
        self.says
    }

    /// Returns every outcome of every study, each once: the studies' own in their order, then [`Self::PANICKED`].
    pub fn all() -> Vec<Self> {
        let mut all: Vec<Self> = Vec::new();
        for outcome in every() {
            if !all.contains(&outcome) {
                all.push(outcome);
            }
        }
        all
    }
}

/// Returns the outcomes of all studies, those twice that two have, and the one of no study.
fn every() -> impl Iterator<Item = Outcome> {
    let of_study =
        |study: &&dyn super::Study| [study.outcomes(), study.further_outcomes()].concat();
    let of_studies = super::STUDIES.iter().flat_map(of_study);
    of_studies.chain([Outcome::PROPOSED, Outcome::PANICKED])
}

impl PartialEq for Outcome {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for Outcome {}

impl fmt::Debug for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

impl Serialize for Outcome {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name)
    }
}

impl<'de> Deserialize<'de> for Outcome {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name: Cow<'_, str> = Cow::deserialize(deserializer)?;
        every().find(|outcome| outcome.name == name).ok_or_else(|| {
            let all = Self::all().into_iter();
            let known: Vec<String> = all.map(|outcome| format!("`{}`", outcome.name)).collect();
            // As serde says it of an enum.
            D::Error::custom(format!(
                "unknown variant `{name}`, expected one of {}",
                known.join(", ")
            ))
        })
    }
}

impl JsonSchema for Outcome {
    fn schema_name() -> Cow<'static, str> {
        "Outcome".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let known: Vec<serde_json::Value> = Self::all()
            .iter()
            .map(|outcome| {
                serde_json::json!({
                    "type": "string",
                    "const": outcome.name,
                    "description": format!("Where {}.", outcome.says),
                })
            })
            .collect();
        json_schema!({ "description": "Why a trial ended.", "oneOf": known })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claims::metric::{FAILED, SUCCESS};

    #[test]
    fn a_word_has_one_meaning_in_all_studies() {
        for study in super::super::STUDIES {
            for outcome in &[study.outcomes(), study.further_outcomes()].concat() {
                let same = Outcome::all().into_iter().find(|other| other == outcome).unwrap();
                assert_eq!((same.end, same.says), (outcome.end, outcome.says), "{outcome:?}");
                assert_ne!(outcome.end, End::Fault, "{outcome:?}");
            }
        }
        assert_eq!(Outcome::PANICKED.name(), FAILED);
    }

    #[test]
    fn claims_count_every_success() {
        let successes = Outcome::all().into_iter().filter(|outcome| outcome.end == End::Success);
        let successes: Vec<&str> = successes.map(Outcome::name).collect();
        assert_eq!(successes, SUCCESS);
    }

    #[test]
    fn outcomes_are_written_and_read_by_name() {
        for outcome in Outcome::all() {
            let text = serde_json::to_string(&outcome).unwrap();
            assert_eq!(serde_json::from_str::<Outcome>(&text).unwrap(), outcome);
        }
        assert_eq!(
            serde_json::from_str::<Outcome>("\"won\"").unwrap_err().to_string(),
            "unknown variant `won`, expected one of `reached`, `collided`, `late`, `stalled`, `explored`, `gave-up`, `stuck`, \
             `time-limit`, `covered`, `proposed`, `panicked`"
        );
    }
}
