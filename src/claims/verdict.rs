//! What judging a claim yields: the entries of `results/claims.json`, written and read by one type.
//!
//! Numbers are written to nine significant digits; NaN and infinities as `null`, which is read as NaN. Every key may be left out
//! but `id` and `verdict`.

use super::terms::Correction;
use super::words::PaperTable;
use crate::stats::Interval;
use schemars::JsonSchema;
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Value, json};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;

/// Names of the statistics that `also-at-n` adds for the first trials: their number, their p in the claimed direction,
/// uncorrected, and their effect.
pub(super) const FIRST_N: &str = "first-n";
pub(super) const FIRST_N_P: &str = "first-n-p";
pub(super) const FIRST_N_HEDGES_G: &str = "first-n-hedges-g";

/// The answer to a claim or to one of its comparisons.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
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

/// A name that the engine gives, or that was read.
pub type Name = Cow<'static, str>;

/// How a number of `claims.json` is written and read.
mod number {
    use crate::claims::verdict::rounded;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands over references")]
    pub(super) fn serialize<S: Serializer>(x: &f64, serializer: S) -> Result<S::Ok, S::Error> {
        rounded(*x).serialize(serializer)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
        Ok(Option::deserialize(deserializer)?.unwrap_or(f64::NAN))
    }

    pub(super) fn none() -> f64 {
        f64::NAN
    }
}

/// Writes a number of a field that is left out where there is none.
#[expect(clippy::ref_option, reason = "serde hands over references")]
fn given<S: Serializer>(x: &Option<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    x.map(rounded).serialize(serializer)
}

/// What was counted in one cell or pool.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub struct CellNumbers {
    /// The selection in words.
    #[serde(default)]
    pub cell: String,
    /// Runs in the cell.
    #[serde(default)]
    pub trials: u64,
    /// Runs that reached the measure; the rest are censored. For shares, all of them.
    #[serde(default)]
    pub reached: u64,
    /// Runs that count, for shares.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub successes: Option<u64>,
    /// Mean of those that reached it, or the share.
    #[serde(default, skip_serializing_if = "Option::is_none", serialize_with = "given")]
    pub mean: Option<f64>,
    /// Sample standard deviation of those that reached it, for measures.
    #[serde(default, skip_serializing_if = "Option::is_none", serialize_with = "given")]
    pub sd: Option<f64>,
    /// Median of those that reached it, for measures.
    #[serde(default, skip_serializing_if = "Option::is_none", serialize_with = "given")]
    pub median: Option<f64>,
    /// The paper's number for the cell, in the metric's unit, where it is compared with.
    #[serde(default, skip_serializing_if = "Option::is_none", serialize_with = "given")]
    pub published: Option<f64>,
}

/// The size of what was found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub struct EffectSize {
    /// Which measure of effect.
    #[serde(default)]
    pub name: Name,
    /// Its value, first cell less second.
    #[serde(with = "number", default = "number::none")]
    pub value: f64,
    /// The lower end of its interval.
    #[serde(with = "number", default = "number::none")]
    pub low: f64,
    /// The upper end.
    #[serde(with = "number", default = "number::none")]
    pub high: f64,
    /// The interval's; it matches the test: 1 - 2 alpha for one-sided, 1 - alpha for two-sided ones.
    #[serde(with = "number", default = "number::none")]
    pub confidence: f64,
    /// The same without unit, for a difference of means.
    #[serde(default, skip_serializing_if = "Option::is_none", serialize_with = "given")]
    pub hedges_g: Option<f64>,
}

impl EffectSize {
    pub(super) fn new(name: &'static str, value: f64, interval: Interval) -> Self {
        let Interval { low, high, confidence } = interval;
        Self { name: name.into(), value, low, high, confidence, hedges_g: None }
    }
}

/// The statistics of a test by name, in the order of the test.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Statistics(Vec<(Name, f64)>);

impl Statistics {
    /// Returns each name with its value.
    pub fn iter(&self) -> impl Iterator<Item = (&str, f64)> {
        self.0.iter().map(|(name, value)| (name.as_ref(), *value))
    }

    /// Returns the value of one of them.
    pub fn get(&self, name: &str) -> Option<f64> {
        self.iter().find(|(known, _)| *known == name).map(|(_, value)| value)
    }

    fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl FromIterator<(&'static str, f64)> for Statistics {
    fn from_iter<I: IntoIterator<Item = (&'static str, f64)>>(named: I) -> Self {
        Self(named.into_iter().map(|(name, value)| (name.into(), value)).collect())
    }
}

impl Serialize for Statistics {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        self.iter().try_for_each(|(name, value)| map.serialize_entry(name, &rounded(value)))?;
        map.end()
    }
}

impl<'de> Deserialize<'de> for Statistics {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let read = BTreeMap::<String, Option<f64>>::deserialize(deserializer)?;
        let named = read.into_iter().map(|(name, x)| (name.into(), x.unwrap_or(f64::NAN)));
        Ok(Self(named.collect()))
    }
}

/// One comparison of a claim.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub struct ComparisonVerdict {
    /// Metric and cells in words.
    #[serde(default)]
    pub about: String,
    /// What was found.
    #[serde(rename = "verdict")]
    pub judgement: Judgement,
    /// Why it cannot be tested, where it cannot.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// Name of the test.
    #[serde(default)]
    pub test: Name,
    /// What the test counted.
    #[serde(default, skip_serializing_if = "Statistics::is_empty")]
    pub statistics: Statistics,
    /// p-value of the claim's direction, as tested.
    #[serde(default, skip_serializing_if = "Option::is_none", serialize_with = "given")]
    pub p_for: Option<f64>,
    /// The same, corrected.
    #[serde(default, skip_serializing_if = "Option::is_none", serialize_with = "given")]
    pub p_for_corrected: Option<f64>,
    /// p-value of the opposite, as tested.
    #[serde(default, skip_serializing_if = "Option::is_none", serialize_with = "given")]
    pub p_against: Option<f64>,
    /// The same, corrected.
    #[serde(default, skip_serializing_if = "Option::is_none", serialize_with = "given")]
    pub p_against_corrected: Option<f64>,
    /// The effect and its interval.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effect: Option<EffectSize>,
    /// The numbers used.
    #[serde(default)]
    pub cells: Vec<CellNumbers>,
    /// Trials per condition that would have decided it with 80 % power, if what was seen is the truth.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub trials_to_decide: Option<u64>,
}

/// Says the statistics of a comparison with published numbers that a reader needs beside its effect: the skill over
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub struct ClaimVerdict {
    /// The claim's id.
    pub id: String,
    /// What the paper claims, in its words; none where the claim is ours.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub says: Option<String>,
    /// What we claim besides.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ours: Option<String>,
    /// Where the paper says so.
    #[serde(default)]
    pub cite: Option<String>,
    /// What the paper's own table shows, as the manifest states it.
    #[serde(default)]
    pub paper_table: PaperTable,
    /// What we find.
    #[serde(rename = "verdict")]
    pub judgement: Judgement,
    /// The judgement in a sentence.
    #[serde(default)]
    pub reason: String,
    /// Form of expectation.
    #[serde(default)]
    pub form: Name,
    /// Level of significance.
    #[serde(with = "number", default = "number::none")]
    pub alpha: f64,
    /// What keeps its comparisons honest.
    #[serde(default)]
    pub correction: Correction,
    /// The factor of draws, where each comparison is of one of its values and all of them are: then the claim holds in a share
    /// of draws.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub over: Option<String>,
    /// Comparisons that must hold.
    #[serde(default)]
    pub required: usize,
    /// Runs per cell without which nothing is judged.
    #[serde(default)]
    pub minimum_n: u64,
    /// All comparisons, those that could not be tested among them.
    #[serde(default)]
    pub comparisons: Vec<ComparisonVerdict>,
    /// What a reader should know beside it.
    #[serde(default)]
    pub notes: Vec<String>,
    /// Trials per condition that would have decided every open comparison.
    #[serde(default)]
    pub trials_to_decide: Option<u64>,
}

/// Rounds a number to nine significant digits: readable, and far finer than any verdict needs. JSON has no
/// infinity and no NaN; they become `null`.
pub fn rounded(x: f64) -> Value {
    if !x.is_finite() {
        return Value::Null;
    }
    let nine: f64 = format!("{x:.8e}").parse().expect("a float reads its own text");
    json!(nine)
}

impl ComparisonVerdict {
    /// Says what `also-at-n` asked for: effect and p at the paper's number of runs beside those at ours.
    pub fn at_both_numbers(&self) -> Option<String> {
        let (n, p) = (self.statistics.get(FIRST_N)?, self.statistics.get(FIRST_N_P)?);
        let of = |g: Option<f64>| g.map(|g| format!(", g {g:+.2}")).unwrap_or_default();
        let all = self.effect.as_ref().and_then(|effect| effect.hedges_g);
        let most = self.cells.iter().map(|cell| cell.reached).max().unwrap_or(0);
        let all = format!("at n = {most} p {:.1e}{}", self.p_for?, of(all));
        let first = of(self.statistics.get(FIRST_N_HEDGES_G));
        Some(format!("at n = {n} p {p:.1e}{first}; {all}"))
    }
}

impl ClaimVerdict {
    /// Counts the runs that never reached what they were compared by, and all runs, each cell once for each of its
    /// measures. `None` where all did.
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
    #[test]
    fn what_is_left_out_or_null_is_read_and_a_slip_is_refused() {
        let read: ClaimVerdict = serde_json::from_value(json!({
            "id": "P1", "verdict": "supported",
            "comparisons": [{"verdict": "supported", "effect": {"name": "mean", "value": 1.5, "high": null}}],
        }))
        .unwrap();
        let effect = read.comparisons[0].effect.as_ref().unwrap();
        assert_eq!((effect.name.as_ref(), effect.value), ("mean", 1.5));
        assert!(effect.low.is_nan() && effect.high.is_nan() && read.alpha.is_nan());
        assert_eq!(json!(read)["comparisons"][0]["effect"]["high"], Value::Null);
        for slip in [
            json!({"id": "P1"}),
            json!({"verdict": "supported"}),
            json!({"id": "P1", "verdict": "maybe"}),
            json!({"id": "P1", "verdict": "supported", "required": -1}),
        ] {
            assert!(serde_json::from_value::<ClaimVerdict>(slip.clone()).is_err(), "{slip}");
        }
    }
}
