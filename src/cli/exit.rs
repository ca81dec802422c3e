//! How a command ends.

use crate::verify::Verdict;

/// Exit codes, the same for every command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exit {
    /// 0: the answer is yes.
    Yes,
    /// 1: the answer is no (a damaged bundle, a difference, drift).
    No,
    /// 2: the request was not understood (usage, manifest, input file).
    NotUnderstood,
    /// 3: we failed (the file system, a full disk, a panicked trial, a bug).
    Failed,
}

impl Exit {
    /// Returns the number with which the process ends.
    pub fn code(self) -> u8 {
        match self {
            Self::Yes => 0,
            Self::No => 1,
            Self::NotUnderstood => 2,
            Self::Failed => 3,
        }
    }
}

impl From<Verdict> for Exit {
    fn from(verdict: Verdict) -> Self {
        match verdict.exit_code() {
            0 => Self::Yes,
            1 => Self::No,
            2 => Self::NotUnderstood,
            _ => Self::Failed,
        }
    }
}

/// Why a command gave up, with its message for stderr.
#[derive(Debug)]
pub(super) struct Failure {
    pub(super) exit: Exit,
    /// One or more whole reports, each ending in a line feed, or a bare sentence.
    pub(super) message: String,
}

impl Failure {
    /// Creates the failure of a request that was not understood.
    pub(super) fn not_understood(message: impl std::fmt::Display) -> Self {
        Self { exit: Exit::NotUnderstood, message: message.to_string() }
    }

    /// Creates the failure of a command whose request was right: the fault is ours.
    pub(super) fn failed(message: impl std::fmt::Display) -> Self {
        Self { exit: Exit::Failed, message: message.to_string() }
    }
}
