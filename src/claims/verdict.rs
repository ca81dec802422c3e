//! What judging a claim yields, and its canonical form in `results/claims.json`.

use super::words::{PaperTable, Words};
use crate::stats::Interval;
use serde_json::{Map, Value, json};
use std::fmt;

/// Names of the statistics that `also-at-n` tells of the first trials: their number, their p in the claimed direction,
/// uncorrected, and their effect.
pub(super) const FIRST_N: &str = "first-n";
pub(super) const FIRST_N_P: &str = "first-n-p";
pub(super) const FIRST_N_HEDGES_G: &str = "first-n-hedges-g";

/// The answer to a claim or to one of its comparisons.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Judgement {
    /// There is evidence for it.
    Supported,
    /// There is evidence against it.
    Contradicted,
    /// There is evidence for neither.
    Inconclusive,
    /// The trials cannot say, for a reason that is given.
    CannotBeTested,
}

impl Judgement {
    /// All of them.
    pub const ALL: [Self; 4] =
        [Self::Supported, Self::Contradicted, Self::Inconclusive, Self::CannotBeTested];
}

impl fmt::Display for Judgement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Supported => "supported",
            Self::Contradicted => "contradicted",
            Self::Inconclusive => "inconclusive",
            Self::CannotBeTested => "cannot-be-tested",
        })
    }
}

/// What was counted in one cell or pool.
#[derive(Debug, Clone, PartialEq)]
pub struct CellNumbers {
    /// The selection in words.
    pub cell: String,
    /// Runs in the cell.
    pub trials: u64,
    /// Runs that reached the measure; the rest are censored. For shares, all of them.
    pub reached: u64,
    /// Runs that count, for shares.
    pub successes: Option<u64>,
    /// Mean of those that reached it, or the share.
    pub mean: Option<f64>,
    /// Sample standard deviation of those that reached it, for measures.
    pub sd: Option<f64>,
    /// Median of those that reached it, for measures.
    pub median: Option<f64>,
    /// The paper's number for the cell, in the metric's unit, where it is compared with.
    pub published: Option<f64>,
}

/// The size of what was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Effect {
    /// Which measure of effect.
    pub name: &'static str,
    /// Its value, first cell less second.
    pub value: f64,
    /// Where it lies; the confidence matches the test: 1 - 2 alpha for one-sided, 1 - alpha for two-sided ones.
    pub interval: Interval,
    /// The same without unit (`hedges-g`), where there is one.
    pub standardised: Option<(&'static str, f64)>,
}

/// One comparison of a claim.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparisonVerdict {
    /// Metric and cells in words.
    pub about: String,
    /// What was found.
    pub judgement: Judgement,
    /// Why it cannot be tested, where it cannot.
    pub reason: Option<String>,
    /// Name of the test.
    pub test: &'static str,
    /// Name and value of the test's statistics.
    pub statistics: Vec<(&'static str, f64)>,
    /// p-value of the claim's direction, as tested and corrected.
    pub p_for: Option<(f64, f64)>,
    /// p-value of the opposite, as tested and corrected.
    pub p_against: Option<(f64, f64)>,
    /// The effect and its interval.
    pub effect: Option<Effect>,
    /// The numbers used.
    pub cells: Vec<CellNumbers>,
    /// Trials per condition that would have decided it with 80 % power, if what was seen is the truth.
    pub trials_to_decide: Option<u64>,
}

/// The statistics of a comparison with published numbers that a reader needs beside its effect, in words: the skill over
/// trivial predictors above all. Empty for other comparisons.
pub fn agreement_in_words<'a>(statistics: impl IntoIterator<Item = (&'a str, f64)>) -> String {
    const SHOWN: [(&str, &str); 7] = [
        ("slope", "slope"),
        ("pearson", "Pearson"),
        ("within-baseline-correlation", "correlation of contrasts"),
        ("skill-over-constant", "skill over a constant"),
        ("skill-over-baseline-means", "skill over the paper's own means"),
        ("inside-prediction-interval", "share of cells inside the paper's interval"),
        ("replicate-rmse", "an exact replicate's rmse"),
    ];
    let found: Vec<(&str, f64)> = statistics.into_iter().collect();
    let value = |name: &str| found.iter().find(|(known, _)| *known == name).map(|(_, x)| *x);
    let words: Vec<String> = SHOWN
        .iter()
        .filter_map(|(name, words)| value(name).map(|x| format!("{words} {x:.2}")))
        .collect();
    words.join(", ")
}

/// The verdict on a claim. What the paper says, what its own table shows and what we find stay three facts.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// The claim's id.
    pub id: String,
    /// What is claimed, by the paper or by us.
    pub words: Words,
    /// Where it says so.
    pub cite: Option<String>,
    /// What the paper's own table shows, as the manifest states it.
    pub paper_table: PaperTable,
    /// What we find.
    pub judgement: Judgement,
    /// The judgement in a sentence.
    pub reason: String,
    /// Form of expectation.
    pub form: &'static str,
    /// Level of significance.
    pub alpha: f64,
    /// `holm` or `none`.
    pub correction: &'static str,
    /// Comparisons that must hold.
    pub required: usize,
    /// Runs per cell without which nothing is judged.
    pub minimum_n: u64,
    /// All comparisons, those that could not be tested among them.
    pub comparisons: Vec<ComparisonVerdict>,
    /// What a reader should know beside it.
    pub notes: Vec<String>,
    /// Trials per condition that would have decided every open comparison.
    pub trials_to_decide: Option<u64>,
}

/// A number rounded to nine significant digits: readable, and far finer than any verdict needs. JSON has no
/// infinity and no NaN; they become `null`.
pub fn rounded(x: f64) -> Value {
    if !x.is_finite() {
        return Value::Null;
    }
    let nine: f64 = format!("{x:.8e}").parse().expect("a float reads its own text");
    json!(nine)
}

impl CellNumbers {
    fn to_json(&self) -> Value {
        let mut map = Map::new();
        map.insert("cell".into(), json!(self.cell));
        map.insert("trials".into(), json!(self.trials));
        map.insert("reached".into(), json!(self.reached));
        if let Some(successes) = self.successes {
            map.insert("successes".into(), json!(successes));
        }
        let numbers = [
            ("mean", self.mean),
            ("sd", self.sd),
            ("median", self.median),
            ("published", self.published),
        ];
        for (name, number) in numbers {
            if let Some(number) = number {
                map.insert(name.into(), rounded(number));
            }
        }
        Value::Object(map)
    }
}

impl Effect {
    fn to_json(&self) -> Value {
        let mut map = Map::new();
        map.insert("name".into(), json!(self.name));
        map.insert("value".into(), rounded(self.value));
        map.insert("low".into(), rounded(self.interval.low));
        map.insert("high".into(), rounded(self.interval.high));
        map.insert("confidence".into(), rounded(self.interval.confidence));
        if let Some((name, value)) = self.standardised {
            map.insert(name.into(), rounded(value));
        }
        Value::Object(map)
    }
}

impl ComparisonVerdict {
    /// What `also-at-n` asked for in words: effect and p at the paper's number of runs beside those at ours.
    pub fn at_both_numbers(&self) -> Option<String> {
        let found = |name: &str| self.statistics.iter().find(|(n, _)| *n == name).map(|(_, x)| *x);
        let (n, p) = (found(FIRST_N)?, found(FIRST_N_P)?);
        let of = |g: Option<f64>| g.map(|g| format!(", g {g:+.2}")).unwrap_or_default();
        let all = self.effect.as_ref().and_then(|effect| effect.standardised).map(|(_, g)| g);
        let most = self.cells.iter().map(|cell| cell.reached).max().unwrap_or(0);
        let all = format!("at n = {most} p {:.1e}{}", self.p_for?.0, of(all));
        Some(format!("at n = {n} p {p:.1e}{}; {all}", of(found(FIRST_N_HEDGES_G))))
    }

    fn to_json(&self) -> Value {
        let mut map = Map::new();
        map.insert("about".into(), json!(self.about));
        map.insert("verdict".into(), json!(self.judgement.to_string()));
        map.insert("test".into(), json!(self.test));
        map.insert("cells".into(), self.cells.iter().map(CellNumbers::to_json).collect());
        if let Some(reason) = &self.reason {
            map.insert("reason".into(), json!(reason));
        }
        for (name, p) in [("p-for", self.p_for), ("p-against", self.p_against)] {
            if let Some((raw, corrected)) = p {
                map.insert(name.into(), rounded(raw));
                map.insert(format!("{name}-corrected"), rounded(corrected));
            }
        }
        if let Some(effect) = &self.effect {
            map.insert("effect".into(), effect.to_json());
        }
        if !self.statistics.is_empty() {
            let statistics: Map<String, Value> =
                self.statistics.iter().map(|(n, x)| ((*n).to_owned(), rounded(*x))).collect();
            map.insert("statistics".into(), Value::Object(statistics));
        }
        if let Some(trials) = self.trials_to_decide {
            map.insert("trials-to-decide".into(), json!(trials));
        }
        Value::Object(map)
    }
}

impl Verdict {
    /// Runs that never reached what they were compared by, and all runs, each cell counted once for each of its measures.
    /// `None` where all did.
    pub fn censored(&self) -> Option<(u64, u64)> {
        let cells = self.comparisons.iter().flat_map(|comparison| &comparison.cells);
        let mut seen: Vec<(&str, u64, u64)> = Vec::new();
        for cell in cells {
            let one = (cell.cell.as_str(), cell.reached, cell.trials);
            if !seen.contains(&one) {
                seen.push(one);
            }
        }
        let all: u64 = seen.iter().map(|cell| cell.2).sum();
        let reached: u64 = seen.iter().map(|cell| cell.1).sum();
        (reached < all).then(|| (all - reached, all))
    }

    /// The entry of `results/claims.json`, statistics rounded to nine significant digits.
    pub fn to_json(&self) -> Value {
        json!({
            "id": self.id,
            self.words.key(): self.words.text(),
            "cite": self.cite,
            "paper-table": self.paper_table.to_string(),
            "verdict": self.judgement.to_string(),
            "reason": self.reason,
            "form": self.form,
            "alpha": rounded(self.alpha),
            "correction": self.correction,
            "required": self.required,
            "minimum-n": self.minimum_n,
            "comparisons": self.comparisons.iter().map(ComparisonVerdict::to_json).collect::<Vec<_>>(),
            "notes": self.notes,
            "trials-to-decide": self.trials_to_decide,
        })
    }
}

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
    pub fn of<'a>(verdicts: impl IntoIterator<Item = &'a Verdict>) -> Self {
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
    /// All of them.
    pub fn all(&self) -> usize {
        self.supported + self.contradicted + self.inconclusive + self.cannot_be_tested
    }

    /// The counts in words, `what` being what is counted: `2 of 3 claims of the paper supported, ...`.
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

    /// What the verdicts say of the paper, and apart from it what they say of our own checks: one line each, those of
    /// nothing left out.
    pub fn lines(verdicts: &[Verdict]) -> Vec<String> {
        let of = |wanted: fn(&Words) -> bool, what: &str| {
            let score = Self::of(verdicts.iter().filter(|verdict| wanted(&verdict.words)));
            (score.all() > 0).then(|| score.in_words(what))
        };
        let papers = of(|words| matches!(words, Words::Says(_)), "claims of the paper");
        let ours = of(|words| matches!(words, Words::Ours(_)), "checks of our own");
        [papers, ours].into_iter().flatten().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agreement_is_told_with_its_skill_and_nothing_else_is() {
        let told = agreement_in_words([
            ("skill-over-constant", -0.314_9),
            ("cells", 60.0),
            ("pearson", 0.604_7),
        ]);
        assert_eq!(told, "Pearson 0.60, skill over a constant -0.31");
        assert_eq!(agreement_in_words([("z", 2.0)]), "");
    }
}
