//! What was drawn, and what became of the claims.

use super::choice::Choice;
use crate::claims::sensitivity::in_words;
use crate::claims::verdict::{ClaimVerdict, Judgement, rounded};
use crate::digest::Sha256Digest;
use crate::document::{Diagnostic, Severity};
use crate::stats::summary::mean;
use serde_json::Value;

/// The verdicts at every draw and at the values that the manifest chose.
#[derive(Debug, Clone, PartialEq)]
pub struct Multiverse {
    /// Seed of the Latin hypercube; the trials' own is the manifest's throughout.
    pub seed: u64,
    /// Trials per condition of every draw.
    pub trials: u32,
    /// Paths of the settings that are drawn together.
    pub settings: Vec<String>,
    /// Ids of the claims that are judged.
    pub claims: Vec<String>,
    /// The run at the values that the manifest chose; never refused.
    pub chosen: Draw,
    /// The draws, the first of which has the number 0.
    pub draws: Vec<Draw>,
}

/// One draw: a value for every setting, and what was found there.
#[derive(Debug, Clone, PartialEq)]
pub struct Draw {
    /// Which one; `None` for the values that the manifest chose.
    pub number: Option<usize>,
    /// The value of every setting, as [`in_words`].
    pub values: Vec<String>,
    /// What was found.
    pub found: Found,
}

/// What was found at a draw.
#[derive(Debug, Clone, PartialEq)]
pub enum Found {
    /// The study ran, and its claims were judged.
    Judged {
        /// Of the records of all its trials, in plan order.
        records: Sha256Digest,
        /// What each claim's verdict was, in the order of the table's claims.
        verdicts: Vec<Verdict>,
    },
    /// The manifest's own checks refuse these values together, for this reason.
    Refused(String),
}

/// What was found of one claim at one draw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Verdict {
    /// The verdict.
    pub judgement: Judgement,
    /// The size of what it was judged by: the mean effect of its comparisons, where all have one of the same name.
    pub estimate: Option<f64>,
}

impl std::fmt::Display for Draw {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.number {
            Some(number) => write!(f, "at draw {number}"),
            None => f.write_str("at the values that the manifest chose"),
        }
    }
}

impl Verdict {
    /// Returns what a table keeps of `verdict`.
    pub fn of(verdict: &ClaimVerdict) -> Self {
        let effects: Option<Vec<_>> =
            verdict.comparisons.iter().map(|comparison| comparison.effect.as_ref()).collect();
        let effects = effects.unwrap_or_default();
        let is_one = effects.first().is_some_and(|first| {
            effects.iter().all(|effect| effect.name == first.name && effect.value.is_finite())
        });
        let values: Vec<f64> = effects.iter().map(|effect| effect.value).collect();
        // As many digits as verdicts are written with.
        let estimate = is_one.then(|| rounded(mean(&values)).as_f64()).flatten();
        Self { judgement: verdict.judgement, estimate }
    }
}

impl Found {
    /// Returns what `verdicts` and the digest of their `records` say.
    pub fn judged(verdicts: &[ClaimVerdict], records: Sha256Digest) -> Self {
        Self::Judged { records, verdicts: verdicts.iter().map(Verdict::of).collect() }
    }

    /// Creates the refusal for this `reason`, on one line.
    pub fn refused(reason: &str) -> Self {
        Self::Refused(reason.split_whitespace().collect::<Vec<_>>().join(" "))
    }

    /// Creates the refusal by a manifest that has these `faults`, for the first error among them.
    pub fn refused_by(faults: &[Diagnostic]) -> Self {
        let errors = faults.iter().filter(|fault| fault.severity == Severity::Error);
        let reason = errors.map(|fault| match fault.label.as_str() {
            "" => fault.message.clone(),
            label => format!("{}: {label}", fault.message),
        });
        Self::refused(
            &reason.into_iter().next().unwrap_or_else(|| "for no reason given".to_owned()),
        )
    }
}

impl Multiverse {
    /// Creates what was found at the `chosen` values of `choices`, with no draw yet; `verdicts` are on its claims.
    pub fn new(
        (seed, trials): (u64, u32),
        choices: &[Choice],
        (verdicts, records): (&[ClaimVerdict], Sha256Digest),
    ) -> Self {
        let chosen = Draw {
            number: None,
            values: choices.iter().map(|choice| in_words(&choice.chosen)).collect(),
            found: Found::judged(verdicts, records),
        };
        Self {
            seed,
            trials,
            settings: choices.iter().map(|choice| choice.setting.clone()).collect(),
            claims: verdicts.iter().map(|verdict| verdict.id.clone()).collect(),
            chosen,
            draws: Vec::new(),
        }
    }

    /// Adds what was `found` at the next draw.
    pub fn push(&mut self, values: &[Value], found: Found) {
        let number = Some(self.draws.len());
        self.draws.push(Draw { number, values: values.iter().map(in_words).collect(), found });
    }

    /// Returns every run that the table rests on: the one at the chosen values first.
    pub fn runs(&self) -> impl Iterator<Item = &Draw> {
        std::iter::once(&self.chosen).chain(&self.draws)
    }

    /// Returns the draws that were refused, each with its reason.
    pub fn refused(&self) -> impl Iterator<Item = (&Draw, &str)> {
        self.draws.iter().filter_map(|draw| match &draw.found {
            Found::Refused(reason) => Some((draw, reason.as_str())),
            Found::Judged { .. } => None,
        })
    }

    /// Returns the draws that were judged, each with the verdicts on the claims.
    pub fn judged(&self) -> impl Iterator<Item = (&Draw, &[Verdict])> {
        self.draws.iter().filter_map(|draw| match &draw.found {
            Found::Judged { verdicts, .. } => Some((draw, verdicts.as_slice())),
            Found::Refused(_) => None,
        })
    }

    /// Returns what `run --set` needs to do `draw` again; without them a manifest's own table stays out of it.
    pub fn overrides(&self, draw: &Draw, choices: &[Choice]) -> Vec<String> {
        let trials = format!("trials={}", self.trials);
        let mut set = vec!["sensitivity=null".to_owned(), "multiverse=null".to_owned(), trials];
        if draw.number.is_some() {
            for (setting, words) in self.settings.iter().zip(&draw.values) {
                let choice = choices.iter().find(|choice| choice.setting == *setting);
                let value = choice.map_or_else(|| words.clone(), |choice| choice.value_of(words));
                set.push(format!("{setting}={value}"));
            }
        }
        set
    }

    /// Draws the Latin hypercube of the table's seed over `choices` again: for every setting its values, as [`in_words`]; nothing
    /// for a setting that is none of them.
    pub fn drawn_again(&self, choices: &[Choice]) -> Vec<Option<Vec<String>>> {
        let drawn = |setting: &String| {
            let choice = choices.iter().find(|choice| choice.setting == *setting)?;
            Some(choice.draw(self.seed, self.draws.len()).iter().map(in_words).collect())
        };
        self.settings.iter().map(drawn).collect()
    }

    /// Finds the first setting at which `draw` has another value than was `drawn` again ([`Self::drawn_again`]): in words, that
    /// and what the table says.
    pub fn misdrawn(&self, draw: &Draw, drawn: &[Option<Vec<String>>]) -> Option<(String, String)> {
        let number = draw.number?;
        for ((setting, found), again) in self.settings.iter().zip(&draw.values).zip(drawn) {
            let expected = again.as_ref().and_then(|values| values.get(number));
            if let Some(expected) = expected.filter(|expected| *expected != found) {
                let by = format!("{setting} at {expected}, as seed {} draws it", self.seed);
                return Some((by, format!("at {found}")));
            }
        }
        None
    }

    /// Finds the first difference between what `draw` says and what was `found` when it was done again: what that gave, and
    /// what the table says.
    pub fn difference(&self, draw: &Draw, found: &Found) -> Option<(String, String)> {
        match (&draw.found, found) {
            (Found::Refused(said), Found::Refused(again)) => {
                (said != again).then(|| (format!("refused: {again}"), format!("refused: {said}")))
            }
            (Found::Refused(said), Found::Judged { .. }) => {
                Some(("verdicts".to_owned(), format!("refused: {said}")))
            }
            (Found::Judged { .. }, Found::Refused(again)) => {
                Some((format!("refused: {again}"), "verdicts".to_owned()))
            }
            (
                Found::Judged { records, verdicts },
                Found::Judged { records: records_again, verdicts: again },
            ) => {
                let words = |verdict: Option<&Verdict>| {
                    let Some(verdict) = verdict else { return "no verdict".to_owned() };
                    let estimate = verdict.estimate.map(|x| format!(" ({x})")).unwrap_or_default();
                    format!("{}{estimate}", verdict.judgement)
                };
                for (i, claim) in self.claims.iter().enumerate() {
                    let (said, again) = (verdicts.get(i), again.get(i));
                    if said != again {
                        let again = format!("{} for the claim {claim}", words(again));
                        return Some((again, words(said)));
                    }
                }
                (records != records_again).then(|| {
                    (format!("records sha256:{records_again}"), format!("sha256:{records}"))
                })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claims::multiverse::table::tests::sample;
    use serde_json::json;

    fn choices() -> [Choice; 2] {
        [
            Choice::new("parameters.pilot.stop-m", &json!(0.05), &[json!(0.1)], false),
            Choice::new("parameters.pilot.heading", &json!("compass"), &[json!("walls")], false),
        ]
    }

    #[test]
    fn a_draw_is_told_as_what_does_it_again() {
        let table = sample();
        assert_eq!(
            table.overrides(&table.draws[1], &choices()),
            [
                "sensitivity=null",
                "multiverse=null",
                "trials=15",
                "parameters.pilot.stop-m=0.07",
                "parameters.pilot.heading=\"walls\""
            ]
        );
        assert_eq!(
            table.overrides(&table.chosen, &choices()),
            ["sensitivity=null", "multiverse=null", "trials=15"]
        );
    }

    #[test]
    fn values_that_no_seed_drew_are_found() {
        let mut table = sample();
        let drawn = table.drawn_again(&choices());
        for (i, draw) in table.draws.iter_mut().enumerate() {
            draw.values = drawn.iter().map(|values| values.as_ref().unwrap()[i].clone()).collect();
        }
        assert!(table.runs().all(|draw| table.misdrawn(draw, &drawn).is_none()));
        let honest = table.draws[1].values[0].clone();
        table.draws[1].values[0] = "0.06".to_owned();
        let expected = (
            format!("parameters.pilot.stop-m at {honest}, as seed 7 draws it"),
            "at 0.06".to_owned(),
        );
        assert_eq!(table.misdrawn(&table.draws[1], &drawn), Some(expected));
    }

    #[test]
    fn what_came_out_otherwise_is_told() {
        let table = sample();
        let (judged, refused) = (&table.draws[0], &table.draws[2]);
        assert_eq!(table.difference(judged, &judged.found), None);
        assert_eq!(table.difference(refused, &refused.found), None);
        let told = |draw: &Draw, found: &Found| table.difference(draw, found).unwrap();
        let pair = |again: &str, said: &str| (again.to_owned(), said.to_owned());
        assert_eq!(told(refused, &judged.found), pair("verdicts", "refused: it is too near"));
        assert_eq!(
            told(judged, &Found::refused("no  room\nleft")),
            pair("refused: no room left", "verdicts")
        );
        let Found::Judged { records, verdicts } = &judged.found else { panic!("it is judged") };
        let mut other = verdicts.clone();
        other[1].estimate = Some(0.5);
        let other = Found::Judged { records: *records, verdicts: other };
        assert_eq!(
            told(judged, &other),
            pair("inconclusive (0.5) for the claim D2", "inconclusive (-0.25)")
        );
        let records = Sha256Digest::of("others");
        let other = Found::Judged { records, verdicts: verdicts.clone() };
        assert!(told(judged, &other).0.starts_with("records sha256:"));
    }
}
