//! What the draws say: how many of them support each claim, and how much of a claim's change each choice explains by itself.

use super::draws::{Found, Multiverse, Verdict};
use crate::claims::verdict::Judgement;
use crate::rng::Seeds;
use crate::stats::Interval;
use crate::stats::proportion::{Proportion, wilson};
use crate::stats::variance_share::{Groups, Share, shares};

/// Draws without which no share of variance is told: fewer make two bins of less than four.
pub const LEAST_DRAWS: usize = 8;

/// A choice stands out where chance makes the largest share of all choices as large at most so often.
pub const STANDS_OUT: f64 = 0.05;

/// Random orders in which chance is looked at.
const ORDERS: u32 = 999;

/// Draws in a bin of a choice that is a number, at least.
const IN_A_BIN: usize = 4;

/// Bins of a choice that is a number, at most.
const MOST_BINS: usize = 8;

/// What the draws say of one claim.
#[derive(Debug, Clone, PartialEq)]
pub struct Explained {
    /// The claim's id.
    pub claim: String,
    /// Its verdict at the values that the manifest chose.
    pub chosen: Judgement,
    /// How many draws give each verdict, in the order of [`Judgement::ALL`].
    pub counts: [u64; 4],
    /// Where the share of all possible draws that support it lies, with 95 % confidence; `None` where no draw was judged.
    pub support: Option<Interval>,
    /// What is explained.
    pub quantity: Quantity,
    /// In how many draws that is known.
    pub known: usize,
    /// What each choice explains of it, in the order of the settings; `None` where it can explain nothing.
    pub shares: Vec<Option<Share>>,
}

/// What of a claim changes from draw to draw.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// The size of what it is judged by.
    Estimate,
    /// Whether it is supported.
    Support,
}

impl Quantity {
    /// Returns the word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Estimate => "estimate",
            Self::Support => "support",
        }
    }
}

impl Explained {
    /// Returns in how many draws the verdict is `judgement`.
    pub fn count(&self, judgement: Judgement) -> u64 {
        let place = Judgement::ALL.iter().position(|known| *known == judgement);
        place.map_or(0, |place| self.counts[place])
    }

    /// Returns how many draws were judged.
    pub fn judged(&self) -> u64 {
        self.counts.iter().sum()
    }

    /// Returns the share of draws that support the claim; `None` where none was judged.
    pub fn share(&self) -> Option<f64> {
        let judged = self.judged();
        (judged > 0).then(|| Proportion::new(self.count(Judgement::Supported), judged).share())
    }

    /// Returns whether the choice at `place` explains more than chance would.
    pub fn stands_out(&self, place: usize) -> bool {
        let share = self.shares.get(place).copied().flatten();
        share.is_some_and(|share| share.share > 0.0 && share.p <= STANDS_OUT)
    }

    /// Returns the place of the choice that explains most, and its share; `None` where none stands out.
    pub fn most(&self) -> Option<(usize, f64)> {
        let out = self.shares.iter().enumerate().filter(|(place, _)| self.stands_out(*place));
        let out = out.filter_map(|(place, share)| Some((place, share.as_ref()?.share)));
        // Of equal shares the first.
        out.reduce(|most, other| if other.1 > most.1 { other } else { most })
    }
}

/// What the draws say of every claim.
#[derive(Debug, Clone, PartialEq)]
pub struct Explanation<'a> {
    /// The draws.
    pub multiverse: &'a Multiverse,
    /// What they say, claim by claim.
    pub claims: Vec<Explained>,
}

impl Multiverse {
    /// Returns what the draws say of every claim.
    pub fn explanation(&self) -> Explanation<'_> {
        let claims = self.claims.iter().enumerate().map(|(i, id)| self.explain(i, id));
        Explanation { multiverse: self, claims: claims.collect() }
    }

    fn explain(&self, place: usize, id: &str) -> Explained {
        let verdict = |verdicts: &[Verdict]| verdicts.get(place).copied();
        let judged: Vec<(&[String], Verdict)> = self
            .judged()
            .filter_map(|(draw, verdicts)| Some((draw.values.as_slice(), verdict(verdicts)?)))
            .collect();
        let count =
            |of| judged.iter().filter(|(_, verdict)| verdict.judgement == of).count() as u64;
        let counts = Judgement::ALL.map(count);
        let all = judged.len() as u64;
        let supported = count(Judgement::Supported);
        let support = (all > 0).then(|| wilson(Proportion::new(supported, all), 0.95));
        let estimated: Vec<(&[String], f64)> = judged
            .iter()
            .filter_map(|(values, verdict)| Some((*values, verdict.estimate?)))
            .collect();
        // A verdict has four values; what it was judged by says more, where most draws have it.
        let (quantity, known) =
            if estimated.len() >= LEAST_DRAWS && 2 * estimated.len() >= judged.len() {
                (Quantity::Estimate, estimated)
            } else {
                let supports = |verdict: &Verdict| {
                    if verdict.judgement == Judgement::Supported { 1.0 } else { 0.0 }
                };
                let known = judged.iter().map(|(values, verdict)| (*values, supports(verdict)));
                (Quantity::Support, known.collect())
            };
        let shares = if known.len() < LEAST_DRAWS {
            vec![None; self.settings.len()]
        } else {
            let found: Vec<f64> = known.iter().map(|(_, value)| *value).collect();
            let factor = |setting: usize| {
                let values: Vec<&str> =
                    known.iter().map(|(values, _)| values[setting].as_str()).collect();
                groups(&values)
            };
            let factors: Vec<Groups> = (0..self.settings.len()).map(factor).collect();
            let coordinates = vec![("claim".to_owned(), id.to_owned())];
            let mut stream = Seeds::new(self.seed, coordinates).stream("multiverse-orders");
            shares(&found, &factors, ORDERS, &mut stream)
        };
        let chosen = match &self.chosen.found {
            Found::Judged { verdicts, .. } => verdict(verdicts).map(|verdict| verdict.judgement),
            Found::Refused(_) => None,
        };
        Explained {
            claim: id.to_owned(),
            chosen: chosen.unwrap_or(Judgement::CannotBeTested),
            counts,
            support,
            quantity,
            known: known.len(),
            shares,
        }
    }
}

/// Returns the groups that the values of one choice make: bins by rank where they are more different numbers than there are bins,
/// else equal ones together.
fn groups(values: &[&str]) -> Groups {
    let bins = (values.len() / IN_A_BIN).clamp(2, MOST_BINS);
    let numbers: Option<Vec<f64>> =
        values.iter().map(|value| value.parse().ok().filter(|x: &f64| x.is_finite())).collect();
    let by_name = Groups::of_names(values);
    match numbers {
        Some(numbers) if by_name.count() > bins => Groups::of_ranks(&numbers, bins),
        _ => by_name,
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::choice::Choice;
    use super::super::draws::Draw;
    use super::*;
    use crate::claims::sensitivity::in_words;
    use crate::digest::Sha256Digest;
    use serde_json::json;

    /// Returns a study of three choices, of which the first decides the claim `by-speed` (its estimate is three times the number),
    /// the second the claim `by-mode`, which has no estimate, and nothing the claim `always`.
    pub(in crate::claims::multiverse) fn known(count: usize) -> Multiverse {
        let choices = [
            Choice::new("parameters.drive.speed-m-s", &json!(0.5), &[json!(1.0)], false),
            Choice::new("parameters.mode", &json!("slow"), &[json!("fast")], false),
            Choice::new("parameters.idle", &json!(1.0), &[json!(0.0)], false),
        ];
        let found = |speed: f64, mode: &str| {
            let verdict = |yes: bool, estimate| Verdict {
                judgement: if yes { Judgement::Supported } else { Judgement::Contradicted },
                estimate,
            };
            Found::Judged {
                records: Sha256Digest::of("any"),
                verdicts: vec![
                    verdict(speed < 0.75, Some(3.0 * speed)),
                    verdict(mode == "slow", None),
                    verdict(true, Some(1.0)),
                ],
            }
        };
        let draws: Vec<Vec<serde_json::Value>> =
            choices.iter().map(|choice| choice.draw(7, count)).collect();
        let draw = |i: usize| Draw {
            number: Some(i),
            values: draws.iter().map(|values| in_words(&values[i])).collect(),
            found: found(draws[0][i].as_f64().unwrap(), draws[1][i].as_str().unwrap()),
        };
        Multiverse {
            seed: 7,
            trials: 3,
            settings: choices.iter().map(|choice| choice.setting.clone()).collect(),
            claims: ["by-speed", "by-mode", "always"].map(str::to_owned).to_vec(),
            chosen: Draw {
                number: None,
                values: choices.iter().map(|choice| in_words(&choice.chosen)).collect(),
                found: found(0.5, "slow"),
            },
            draws: (0..count).map(draw).collect(),
        }
    }

    #[test]
    fn what_decides_a_claim_explains_most_of_it() {
        let explained = known(48).explanation().claims;
        let [speed, mode, always] = &explained[..] else { panic!("three claims") };
        assert_eq!((speed.count(Judgement::Supported), speed.judged()), (24, 48));
        assert_eq!(speed.share(), Some(0.5));
        let interval = speed.support.unwrap();
        assert!((interval.low - 0.3639).abs() < 1e-4 && (interval.high - 0.6361).abs() < 1e-4);
        assert_eq!((speed.quantity, speed.known), (Quantity::Estimate, 48));
        let (place, share) = speed.most().unwrap();
        assert!(place == 0 && share > 0.95, "{speed:?}");
        assert!(!speed.stands_out(1) && !speed.stands_out(2), "{speed:?}");

        assert_eq!((mode.quantity, mode.most()), (Quantity::Support, Some((1, 1.0))));
        assert_eq!(always.counts, [48, 0, 0, 0]);
        assert_eq!(
            (always.most(), always.shares.clone()),
            (None, vec![None; 3]),
            "it never changes"
        );
    }

    #[test]
    fn few_draws_explain_nothing() {
        let explained = known(7).explanation().claims;
        assert!(explained.iter().all(|claim| claim.shares == [None, None, None]));
        assert_eq!(explained[0].judged(), 7);
        let none = known(0).explanation().claims;
        assert_eq!((none[0].support, none[0].share()), (None, None));
        assert_eq!(none[0].chosen, Judgement::Supported);
    }

    #[test]
    fn draws_that_were_refused_count_for_nothing() {
        let mut study = known(48);
        for draw in &mut study.draws[..8] {
            draw.found = Found::refused("too fast");
        }
        let explained = study.explanation().claims;
        assert!(explained.iter().all(|claim| claim.judged() == 40 && claim.known == 40));
        assert_eq!(explained[0].most().unwrap().0, 0);
    }

    #[test]
    fn numbers_are_binned_and_names_are_not() {
        let numbers: Vec<String> = (0..40).map(|i| format!("{}", f64::from(i) / 7.0)).collect();
        let numbers: Vec<&str> = numbers.iter().map(String::as_str).collect();
        assert_eq!(groups(&numbers).count(), 8);
        assert_eq!(groups(&numbers[..20]).count(), 5);
        let few: Vec<&str> = (0..40).map(|i| ["1", "2", "3"][i % 3]).collect();
        assert_eq!(groups(&few).count(), 3);
        let names: Vec<&str> = (0..16).map(|i| ["a", "b", "c"][i % 3]).collect();
        assert_eq!(groups(&names).count(), 3, "bins are for numbers");
    }
}
