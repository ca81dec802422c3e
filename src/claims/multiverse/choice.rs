//! One choice that a paper leaves open: the values that it may have, and its dimension of the hypercube.

use crate::claims::sensitivity::in_words;
use crate::math::{exp, ln};
use crate::rng::Seeds;
use crate::stats::latin_hypercube::dimension;
use crate::stats::length;
use serde_json::Value;

/// How many times the least value of a range its greatest is at least where the range is drawn evenly in the logarithm.
const WIDE: f64 = 3.0;

/// A choice with everything that could as well have been chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// Path of the setting in the manifest: `parameters.mapping.hit-ratio`.
    pub setting: String,
    /// The value that the manifest chose.
    pub chosen: Value,
    /// The values that it may have.
    pub domain: Domain,
}

/// The values that a choice may have.
#[derive(Debug, Clone, PartialEq)]
pub enum Domain {
    /// All numbers between two, these included.
    Interval {
        /// The least.
        low: f64,
        /// The greatest.
        high: f64,
        /// What is drawn evenly.
        scale: Scale,
        /// Whether only whole numbers are meant.
        whole: bool,
    },
    /// These and no others, each as often as every other.
    OneOf(Vec<Value>),
}

/// What is drawn evenly of an interval.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// The number.
    Linear,
    /// Its logarithm: where all numbers are positive and the greatest is three times the least or more.
    Logarithmic,
}

impl Choice {
    /// Creates the choice of `setting`, which is `chosen` and could as well be any of `range`: where all of these are numbers, any
    /// number between the least and the greatest, a `whole` one where the setting takes no other.
    pub fn new(setting: &str, chosen: &Value, range: &[Value], whole: bool) -> Self {
        let stated: Vec<&Value> = std::iter::once(chosen).chain(range).collect();
        let numbers: Option<Vec<f64>> = stated.iter().map(|value| value.as_f64()).collect();
        let domain = if let Some(numbers) = numbers {
            let low = numbers.iter().copied().fold(f64::INFINITY, f64::min);
            let high = numbers.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            // 0.2 to 0.6 is threefold, though not in binary.
            let is_wide = low > 0.0 && high >= WIDE * low * (1.0 - 1e-9);
            let scale = if is_wide { Scale::Logarithmic } else { Scale::Linear };
            Domain::Interval { low, high, scale, whole }
        } else {
            let mut values: Vec<Value> = Vec::new();
            for value in stated {
                if !values.contains(value) {
                    values.push(value.clone());
                }
            }
            Domain::OneOf(values)
        };
        Self { setting: setting.to_owned(), chosen: chosen.clone(), domain }
    }

    /// Draws this choice `count` times: its dimension of the Latin hypercube of `seed`, which is the same whatever other choices
    /// there are.
    pub fn draw(&self, seed: u64, count: usize) -> Vec<Value> {
        let coordinates = vec![("setting".to_owned(), self.setting.clone())];
        let mut stream = Seeds::new(seed, coordinates).stream("latin-hypercube");
        dimension(count, &mut stream).into_iter().map(|part| self.domain.at(part)).collect()
    }

    /// Returns the value that `words` are [`in_words`] of: one that the manifest states where there is one.
    pub fn value_of(&self, words: &str) -> String {
        let stated = match &self.domain {
            Domain::OneOf(values) => values.iter().find(|value| in_words(value) == words),
            Domain::Interval { .. } => None,
        };
        // JSON is YAML too.
        stated.map_or_else(|| words.to_owned(), ToString::to_string)
    }
}

impl Domain {
    /// Returns the value at `part`, a number in [0, 1), of this domain: equal parts hold as much of it. Numbers that are not
    /// whole have six digits, so that a table holds all of them.
    fn at(&self, part: f64) -> Value {
        match self {
            Self::Interval { low, high, scale, whole } => {
                // Half a number more at either end, so that rounding leaves the ends as likely as what is between.
                let margin = if *whole { 0.5 } else { 0.0 };
                let (from, to) = (low - margin, high + margin);
                let number = match scale {
                    Scale::Linear => from + part * (to - from),
                    Scale::Logarithmic => exp(ln(from) + part * (ln(to) - ln(from))),
                };
                if *whole {
                    #[expect(
                        clippy::cast_possible_truncation,
                        reason = "between two whole numbers as written"
                    )]
                    let number = number.round().clamp(*low, *high) as i64;
                    return Value::from(number);
                }
                let six: f64 = format!("{number:.5e}").parse().expect("a float reads its own text");
                Value::from(six.clamp(*low, *high))
            }
            Self::OneOf(values) => {
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "below the number of values"
                )]
                let index = (part * length(values)) as usize;
                values[index.min(values.len() - 1)].clone()
            }
        }
    }
}

impl std::fmt::Display for Domain {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Interval { low, high, scale, whole } => {
                let kind = if *whole { "whole numbers " } else { "" };
                let evenly = match scale {
                    Scale::Linear => "",
                    Scale::Logarithmic => ", evenly in the logarithm",
                };
                write!(f, "{kind}{low} to {high}{evenly}")
            }
            Self::OneOf(values) => {
                let words: Vec<String> = values.iter().map(in_words).collect();
                f.write_str(&words.join(" or "))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn choice(chosen: &Value, range: &[Value], whole: bool) -> Choice {
        Choice::new("parameters.a", chosen, range, whole)
    }

    fn words(chosen: &Value, range: &[Value], whole: bool) -> String {
        choice(chosen, range, whole).domain.to_string()
    }

    #[test]
    fn numbers_are_an_interval_and_everything_else_is_as_stated() {
        assert_eq!(words(&json!(0.5), &[json!(0.3)], false), "0.3 to 0.5");
        let threefold = words(&json!(0.4), &[json!(0.2), json!(0.6)], false);
        assert_eq!(threefold, "0.2 to 0.6, evenly in the logarithm");
        assert_eq!(words(&json!(0), &[json!(0.5)], false), "0 to 0.5");
        assert_eq!(words(&json!(-1), &[json!(30)], false), "-1 to 30");
        assert_eq!(words(&json!(2), &[json!(5)], true), "whole numbers 2 to 5");
        let named = words(&json!("tag"), &[json!("laser"), json!("tag")], false);
        assert_eq!(named, "tag or laser");
        assert_eq!(words(&json!(null), &[json!(25)], false), "null or 25");
        assert_eq!(words(&json!(true), &[json!(false)], false), "true or false");
    }

    #[test]
    fn draws_cover_the_interval_by_what_is_even_in_it() {
        let drawn = |choice: &Choice| -> Vec<f64> {
            let mut drawn: Vec<f64> =
                choice.draw(7, 100).iter().map(|value| value.as_f64().unwrap()).collect();
            drawn.sort_by(f64::total_cmp);
            drawn
        };
        let linear = drawn(&choice(&json!(1.0), &[json!(2.0)], false));
        assert!(linear[0] >= 1.0 && linear[0] < 1.01 && linear[99] > 1.99 && linear[99] <= 2.0);
        assert!((linear[49] - 1.5).abs() < 0.01, "{}", linear[49]);
        let wide = drawn(&choice(&json!(0.01), &[json!(1.0)], false));
        assert!(wide[0] < 0.0105 && wide[99] > 0.95, "{wide:?}");
        assert!((wide[49] - 0.1).abs() < 0.005, "half are below the geometric mean: {}", wide[49]);
        let six = wide.iter().all(|x| format!("{x:.5e}").parse::<f64>().unwrap() == *x);
        assert!(six, "{wide:?}");
    }

    #[test]
    fn whole_numbers_and_names_are_drawn_as_often_as_one_another() {
        let of = |choice: &Choice, value: &Value| {
            choice.draw(7, 40).iter().filter(|drawn| *drawn == value).count()
        };
        let whole = choice(&json!(4), &[json!(2), json!(5)], true);
        for number in 2..=5 {
            assert_eq!(of(&whole, &json!(number)), 10, "{number}");
        }
        let named = choice(&json!("a"), &[json!("b"), json!(true), json!(0.5)], false);
        for name in [json!("a"), json!("b"), json!(true), json!(0.5)] {
            assert_eq!(of(&named, &name), 10, "{name}");
        }
        let powers = choice(&json!(1), &[json!(100)], true).draw(7, 100);
        assert!(powers.iter().all(|n| (1..=100).contains(&n.as_i64().unwrap())));
    }

    #[test]
    fn a_choice_is_drawn_the_same_beside_any_other() {
        let a = choice(&json!(0.5), &[json!(0.3)], false);
        let b = Choice { setting: "parameters.b".to_owned(), ..a.clone() };
        assert_eq!(a.draw(7, 8), a.draw(7, 8));
        assert_ne!(a.draw(7, 8), b.draw(7, 8));
        assert_ne!(a.draw(7, 8), a.draw(8, 8));
    }

    #[test]
    fn words_are_the_value_again() {
        let named = choice(&json!("uniform"), &[json!("10"), json!(null)], false);
        assert_eq!(
            ["uniform", "10", "null"].map(|words| named.value_of(words)),
            ["\"uniform\"", "\"10\"", "null"]
        );
        assert_eq!(choice(&json!(0.5), &[json!(0.3)], false).value_of("0.41"), "0.41");
    }
}
