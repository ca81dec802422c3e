//! How many claims of a study hold.

use super::verdict::{ClaimVerdict, Judgement};

/// How many claims of a study hold. A function of the verdicts alone: no lock enters, so blessing a new lock
/// cannot change it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Score {
    /// Claims with evidence for them.
    pub supported: usize,
    /// Claims with evidence against them.
    pub contradicted: usize,
    /// Claims with evidence for neither.
    pub inconclusive: usize,
    /// Claims that could not be tested.
    pub cannot_be_tested: usize,
}

impl Score {
    /// Counts `verdicts`, whosever words they are on.
    pub fn of<'a>(verdicts: impl IntoIterator<Item = &'a ClaimVerdict>) -> Self {
        let found: Vec<Judgement> = verdicts.into_iter().map(|v| v.judgement).collect();
        let count = |j| found.iter().filter(|found| **found == j).count();
        Self {
            supported: count(Judgement::Supported),
            contradicted: count(Judgement::Contradicted),
            inconclusive: count(Judgement::Inconclusive),
            cannot_be_tested: count(Judgement::CannotBeTested),
        }
    }
}

impl Score {
    /// Returns the number of all claims.
    pub fn all(&self) -> usize {
        self.supported + self.contradicted + self.inconclusive + self.cannot_be_tested
    }

    /// Says the counts, `what` being what is counted: `2 of 3 claims of the paper supported, ...`.
    pub fn in_words(&self, what: &str) -> String {
        format!(
            "{} of {} {what} supported, {} contradicted, {} inconclusive, {} cannot be tested",
            self.supported,
            self.all(),
            self.contradicted,
            self.inconclusive,
            self.cannot_be_tested
        )
    }

    /// Says what the verdicts say of the paper, and apart from it what they say of our own checks: one line each, those of
    /// nothing left out.
    pub fn lines(verdicts: &[ClaimVerdict]) -> Vec<String> {
        let of = |papers: bool, what: &str| {
            let score = Self::of(verdicts.iter().filter(|v| v.says.is_some() == papers));
            (score.all() > 0).then(|| score.in_words(what))
        };
        let (papers, ours) = (of(true, "claims of the paper"), of(false, "checks of our own"));
        [papers, ours].into_iter().flatten().collect()
    }
}
