//! What verification notices.

use crate::bundle::Fault;
use serde::{Serialize, Serializer};

/// The rungs of the ladder, in order of what they ask and cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// The archive is safe to open.
    Safe,
    /// Every listed file is there unchanged, and no other.
    Fixity,
    /// The bundle's parts agree with one another.
    Coherent,
    /// Tables, figures and verdicts follow from the trial records, trials from the manifest.
    Derived,
    /// Trials drawn with the reviewer's seed give the same bytes again.
    Sampled,
    /// Every trial gives the same bytes again.
    Full,
    /// The verdicts hold when the whole study is run with fresh seeds.
    Replicated,
}

impl Level {
    /// Every level, lowest first.
    pub const ALL: [Self; 7] = [
        Self::Safe,
        Self::Fixity,
        Self::Coherent,
        Self::Derived,
        Self::Sampled,
        Self::Full,
        Self::Replicated,
    ];

    /// Returns the level of that number, 0 to 6.
    pub fn from_number(number: u8) -> Option<Self> {
        Self::ALL.get(usize::from(number)).copied()
    }

    /// Returns the level's number.
    pub fn number(self) -> u8 {
        self as u8
    }

    /// Returns the level's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Safe => "safe",
            Self::Fixity => "fixity",
            Self::Coherent => "coherent",
            Self::Derived => "derived",
            Self::Sampled => "sampled",
            Self::Full => "full",
            Self::Replicated => "replicated",
        }
    }
}

impl std::fmt::Display for Level {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} ({})", self.number(), self.name())
    }
}

impl Serialize for Level {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_u8(self.number())
    }
}

/// How much a finding weighs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Severity {
    /// The bundle is not what it says; at level 6, a verdict that does not hold with fresh seeds.
    Error,
    /// This program cannot judge that far; another version may.
    Obstacle,
    /// We failed, which says nothing of the bundle.
    Failure,
    /// Worth knowing.
    Note,
}

/// One thing noticed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// The level that noticed it.
    pub level: Level,
    /// How much it weighs.
    pub severity: Severity,
    /// The file, relative to the bag's root, with a line where one is meant.
    pub path: String,
    /// What should be there.
    pub expected: String,
    /// What is there.
    pub found: String,
    /// What it may mean or what to do next; empty where the two say it all.
    pub hint: String,
}

impl Finding {
    /// Creates the finding of `fault`, noticed at `level`.
    pub fn new(level: Level, severity: Severity, fault: Fault) -> Self {
        let Fault { path, expected, found, hint } = fault;
        Self { level, severity, path, expected, found, hint }
    }
}

impl std::fmt::Display for Finding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let severity = match self.severity {
            Severity::Error => "error",
            Severity::Obstacle => "obstacle",
            Severity::Failure => "failure",
            Severity::Note => "note",
        };
        write!(f, "{severity} at level {}: {}", self.level.number(), self.path)?;
        write!(f, ": expected {}, found {}", self.expected, self.found)?;
        if self.hint.is_empty() { Ok(()) } else { write!(f, " ({})", self.hint) }
    }
}
