//! The faults of claims, found before anything runs.

use super::Claim;
use super::cells::{Values, Where};
use super::comparing::Comparison;
use super::expect::Expect;
use super::measuring::{Bound, That};
use super::metric::{Metric, WALL_TIME};
use super::power::Assume;
use super::terms::{Censored, Order, Pairs, PerRun, Sides, Statistic, Test};
use crate::document::{known_or_near, quoted};
use std::collections::BTreeSet;

/// What there is to speak of in a study.
#[derive(Debug, Clone, Copy)]
pub struct Known<'a> {
    /// The factors and their values.
    pub factors: &'a [(String, Vec<String>)],
    /// `success`, `outcome:NAME` and columns of the trials.
    pub metrics: &'a [String],
    /// Names of published tables.
    pub published: &'a [String],
}

/// What is wrong with a claim.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault<'a> {
    /// JSON pointer of it in the claim: `/expect/less/where/start/1`, the second value where a list of them is written. Empty
    /// where it is the claim itself.
    pub pointer: String,
    /// Whether it is the key there and not its value.
    pub at_key: bool,
    /// What is wrong.
    pub message: String,
    /// The name that is unknown, and those that are known.
    pub unknown: Option<(String, Vec<&'a str>)>,
}

impl Fault<'_> {
    fn new(pointer: impl Into<String>, message: impl Into<String>) -> Self {
        Self { pointer: pointer.into(), at_key: false, message: message.into(), unknown: None }
    }

    /// What may have been meant, where a name is unknown.
    pub fn help(&self) -> Option<String> {
        self.unknown.as_ref().map(|(name, known)| known_or_near(name, known))
    }
}

/// The faults of a manifest's claims, by the claim's number: those of each ([`Claim::check`]) and ids used twice.
pub fn check_all<'a>(
    claims: &'a [Claim],
    known: Known<'a>,
) -> impl Iterator<Item = (usize, Fault<'a>)> + 'a {
    let mut ids = BTreeSet::new();
    claims.iter().enumerate().flat_map(move |(i, claim)| {
        let twice = (!ids.insert(claim.id.as_str()))
            .then(|| Fault::new("/id", format!("the id `{}` is used twice", quoted(&claim.id))));
        twice.into_iter().chain(claim.check(known)).map(move |fault| (i, fault))
    })
}

impl Claim {
    /// The faults of this claim in a study where this is `known`. Empty where it can be judged.
    pub fn check<'a>(&'a self, known: Known<'a>) -> Vec<Fault<'a>> {
        let mut faults = Faults { known, form: String::new(), found: Vec::new() };
        if self.id.is_empty() {
            faults.add("/id", "expected a name, found nothing".to_owned());
        }
        self.check_words(&mut faults);
        faults.form = format!("/expect/{}", self.expect.form());
        self.check_circumstance(&mut faults);
        for (path, selection) in self.expect.selections() {
            faults.selection(&path, selection);
        }
        faults.metrics(&self.expect);
        faults.terms(&self.expect);
        faults.form(&self.expect);
        faults.form = String::new();
        faults.assumption(self.power.as_ref());
        faults.found
    }

    /// The paper's words or ours: one of them, and said.
    fn check_words(&self, faults: &mut Faults<'_>) {
        match (&self.says, &self.ours) {
            (Some(_), Some(_)) => faults.add(
                "",
                "expected `says` or `ours`, found both; keep `says` where the words are the paper's, `ours` where they are your \
                 own"
                    .to_owned(),
            ),
            (None, None) => faults.add(
                "",
                "expected `says` with the paper's words, or `ours` with a check of your own, found neither".to_owned(),
            ),
            (Some(_), None) if self.paper_table.is_none() => faults.add(
                "",
                "expected `paper-table:` with `supports`, `contradicts` or `silent` beside `says`, found nothing; say what the \
                 paper's own numbers show of its sentence"
                    .to_owned(),
            ),
            _ => {}
        }
        for (key, words) in [("/says", &self.says), ("/ours", &self.ours)] {
            let said = words.as_ref().is_none_or(|words| !words.trim().is_empty());
            faults.unless(said, key, || "expected words, found none".to_owned());
        }
    }

    fn check_circumstance(&self, faults: &mut Faults<'_>) {
        for (path, metric) in self.expect.measured() {
            let wall = metric.starts_with(WALL_TIME);
            let metric = quoted(metric);
            if wall && !self.circumstance {
                faults.add(
                    &path,
                    format!(
                        "`{metric}` depends on the machine and belongs to the circumstance half of a bundle; mark the claim \
                         `circumstance: true` or measure simulated time"
                    ),
                );
            } else if !wall && self.circumstance {
                let message = format!(
                    "`{metric}` is a result of the study; only claims on {WALL_TIME} metrics are circumstance"
                );
                faults.found.push(Fault::new("/circumstance", message));
            }
        }
    }
}

struct Faults<'a> {
    known: Known<'a>,
    /// Pointer of what paths are relative to.
    form: String,
    found: Vec<Fault<'a>>,
}

impl<'a> Faults<'a> {
    fn add(&mut self, path: &str, message: String) {
        self.found.push(Fault::new(format!("{}{path}", self.form), message));
    }

    fn unless(&mut self, holds: bool, path: &str, message: impl FnOnce() -> String) {
        if !holds {
            self.add(path, message());
        }
    }

    /// A name that is none of `known`.
    fn unknown(
        &mut self,
        path: &str,
        message: String,
        name: &str,
        known: impl Iterator<Item = &'a String>,
    ) {
        let unknown = Some((name.to_owned(), known.map(String::as_str).collect()));
        let fault = Fault::new(format!("{}{path}", self.form), message);
        self.found.push(Fault { unknown, ..fault });
    }

    /// A factor that there is not, named by a value or by a key.
    fn unknown_factor(&mut self, path: &str, name: &str, at_key: bool) {
        let known = self.known.factors.iter().map(|(factor, _)| factor.as_str()).collect();
        let unknown = Some((name.to_owned(), known));
        let message = format!("unknown factor `{}`", quoted(name));
        let fault = Fault::new(format!("{}{path}", self.form), message);
        self.found.push(Fault { at_key, unknown, ..fault });
    }

    fn values_of(&self, factor: &str) -> Option<&'a [String]> {
        let found = self.known.factors.iter().find(|(known, _)| known == factor);
        found.map(|(_, values)| &values[..])
    }

    fn selection(&mut self, path: &str, selection: &Where) {
        for (factor, values) in &selection.0 {
            let path = format!("{path}/{}", factor.replace('~', "~0").replace('/', "~1"));
            let Some(known) = self.values_of(factor) else {
                self.unknown_factor(&path, factor, true);
                continue;
            };
            self.unless(!values.0.is_empty(), &path, || "expected a value, found none".to_owned());
            let mut listed = BTreeSet::new();
            for (i, value) in values.0.iter().enumerate() {
                let path = format!("{path}/{i}");
                if !listed.insert(value) {
                    self.add(&path, format!("the value `{}` is listed twice", quoted(value)));
                } else if !known.contains(value) {
                    let message =
                        format!("`{}` is not a value of the factor `{factor}`", quoted(value));
                    self.unknown(&path, message, value, known.iter());
                }
            }
        }
    }

    fn metrics(&mut self, expect: &Expect) {
        if matches!(expect, Expect::Untestable(_)) {
            return;
        }
        let named = expect.measured();
        self.unless(!named.is_empty(), "/metric", || "expected a metric, found none".to_owned());
        for (path, metric) in named {
            // Outcomes that count together are known where each of them is.
            let parts: Vec<String> = match Metric::named(metric) {
                Metric::Outcome(names) => names.iter().map(|n| format!("outcome:{n}")).collect(),
                _ => vec![metric.to_owned()],
            };
            let known = self.known.metrics;
            for part in parts.iter().filter(|part| !known.contains(part)) {
                let message = format!("unknown metric `{}`", quoted(part));
                self.unknown(&path, message, part, known.iter());
            }
        }
        if let Some(table) = expect.published() {
            self.table("/published", table);
        }
    }

    /// A published table that is named.
    fn table(&mut self, path: &str, name: &str) {
        let known = self.known.published;
        if !known.iter().any(|table| table == name) {
            let message = format!("unknown published table `{}`", quoted(name));
            self.unknown(path, message, name, known.iter());
        }
    }

    fn terms(&mut self, expect: &Expect) {
        let terms = expect.terms();
        self.unless(terms.alpha > 0.0 && terms.alpha < 0.5, "/alpha", || {
            format!("expected a level between 0 and 0.5, found {}", terms.alpha)
        });
        self.unless(terms.minimum_n > 0, "/minimum-n", || {
            "expected at least 1, found 0".to_owned()
        });
        self.unless(terms.at_least != Some(0), "/at-least", || {
            "expected at least 1, found 0: every verdict would be supported".to_owned()
        });
        let shares: Vec<bool> =
            expect.metrics().iter().map(|m| Metric::named(m).is_share()).collect();
        if let Some(test) = terms.test {
            let (allowed, for_shares) = match (expect, test) {
                (Expect::Trend(_), Test::CochranArmitage) => (true, true),
                (Expect::Trend(_), Test::Spearman) => (true, false),
                (Expect::Trend(_), _) | (_, Test::CochranArmitage | Test::Spearman) => {
                    (false, true)
                }
                (_, Test::FisherExact | Test::ChiSquare) => (true, true),
                (_, Test::Welch | Test::Anova | Test::MannWhitney | Test::BrownForsythe) => {
                    (true, false)
                }
            };
            self.unless(allowed, "/test", || format!("{} is no test of this form", test.name()));
            let kind = if for_shares { "shares (success, outcome:...)" } else { "measures" };
            self.unless(!allowed || shares.iter().all(|s| *s == for_shares), "/test", || {
                format!("{} is a test of {kind}", test.name())
            });
            let both = matches!(test, Test::Anova | Test::ChiSquare);
            self.unless(!both || terms.sides == Sides::Two, "/sides", || {
                format!("{} has two sides; say `sides: two`", test.name())
            });
        }
        let ranks = match expect {
            Expect::Less(_) | Expect::Greater(_) | Expect::Rank(_) => {
                terms.test == Some(Test::MannWhitney)
            }
            Expect::Trend(_) | Expect::Share(_) | Expect::Every(_) => true,
            Expect::Between(form) => form.statistic != Statistic::Mean,
            Expect::SignTest(form) => form.pairs == Pairs::Trials,
            _ => false,
        };
        self.unless(ranks || terms.censored != Censored::Worst, "/censored", || {
            "`worst` has a rank and no value: it needs mann-whitney, spearman, median, p95 or pairs of trials".to_owned()
        });
    }

    fn margin(&mut self, path: &str, margin: f64) {
        self.unless(margin > 0.0 && margin.is_finite(), path, || {
            format!("expected a positive number, found {margin}")
        });
    }

    fn bounds(&mut self, low: Option<f64>, high: Option<f64>, open_unit: bool) {
        self.unless(low.is_some() || high.is_some(), "/low", || {
            "expected `low`, `high` or both".to_owned()
        });
        if let (Some(low), Some(high)) = (low, high) {
            self.unless(low < high, "/low", || format!("{low} is not below high, {high}"));
        }
        for (path, bound) in [("/low", low), ("/high", high)] {
            if let Some(bound) = bound {
                let inside = !open_unit || (bound > 0.0 && bound < 1.0);
                self.unless(bound.is_finite() && inside, path, || {
                    format!("a share is bounded strictly between 0 and 1, found {bound}; leave out what always holds")
                });
            }
        }
    }

    fn across(&mut self, across: &Where) {
        let cells = across.count();
        self.unless(cells >= 2, "/across", || format!("expected two cells or more, found {cells}"));
    }

    fn form(&mut self, expect: &'a Expect) {
        match expect {
            Expect::Less(f) | Expect::Greater(f) => {
                self.each("/than/each", &f.than.each, &f.than.r#where);
                self.per_run(f);
            }
            Expect::Equivalent(f) => {
                self.each("/to/each", &f.to.each, &f.to.r#where);
                self.margin("/margin", f.margin);
            }
            Expect::Homogeneous(f) => {
                self.across(&f.across);
                self.margin("/margin", f.margin);
            }
            Expect::Between(f) => {
                let share = f.metric.0.iter().any(|m| Metric::named(m).is_share());
                self.bounds(f.low, f.high, share && f.relative_to.is_none());
                let mean = f.statistic == Statistic::Mean;
                self.unless(mean || !share, "/statistic", || "a share has a mean only".to_owned());
                self.unless(mean || f.relative_to.is_none(), "/statistic", || {
                    "relative differences are of means".to_owned()
                });
                let low = f.low.into_iter().chain(f.high).fold(0.0, f64::min);
                self.unless(f.relative_to.is_none() || low > -1.0, "/low", || {
                    format!("a relative difference is above -1, found {low}")
                });
            }
            Expect::Share(f) => {
                self.bounds(f.low, f.high, true);
                self.that(&f.that);
            }
            Expect::Every(f) => self.that(&f.that),
            Expect::Rate(f) => {
                for (path, quantity) in [("/of/per", &f.of), ("/than/per", &f.than)] {
                    let share = quantity.per.as_ref().is_some_and(|m| Metric::named(m).is_share());
                    self.unless(!share, path, || {
                        "expected a measure; a share is counted per trial anyway".to_owned()
                    });
                }
            }
            Expect::Trend(f) => {
                let scores: Vec<f64> = f.along.iter().map(|s| s.score).collect();
                let apart = (1..scores.len()).all(|i| !scores[..i].contains(&scores[i]));
                let finite = scores.iter().all(|s| s.is_finite());
                self.unless(scores.len() >= 2 && apart && finite, "/along", || {
                    format!("expected two or more different scores, found {scores:?}")
                });
            }
            Expect::Rank(f) => {
                self.across(&f.across);
                self.unless(f.across.0.len() == 1, "/across", || {
                    format!("expected one factor, found {}", f.across.0.len())
                });
                let ranked: Vec<&String> = f.across.0.values().flat_map(|v| &v.0).collect();
                let (named, enough) = match &f.order {
                    Order::First(value) | Order::Last(value) => (std::slice::from_ref(value), true),
                    Order::Descending(values) => (&values[..], values.len() >= 2),
                };
                self.unless(enough, "/order", || "expected two values or more".to_owned());
                for value in named {
                    if !ranked.contains(&value) {
                        let message = format!("`{}` is not among those ranked", quoted(value));
                        self.unknown("/order", message, value, ranked.iter().copied());
                    }
                }
            }
            Expect::SignTest(_) => {}
            Expect::Untestable(f) => self.unless(!f.because.trim().is_empty(), "/because", || {
                "expected the reason".to_owned()
            }),
            Expect::Spread(f) => {
                self.across(&f.across);
                self.unless(f.than.is_some() != f.at_most.is_some(), "/than", || {
                    "expected either `than` or `at-most`".to_owned()
                });
                f.at_most.iter().for_each(|bound| self.margin("/at-most", *bound));
            }
            Expect::CorrelationWithPublished(f) => {
                self.margin("/scale", f.scale);
                self.unless(f.at_least > -1.0 && f.at_least < 1.0, "/at-least", || {
                    format!("a correlation lies between -1 and 1, found {}", f.at_least)
                });
                self.base(f.ratio_to.as_ref());
            }
            Expect::RmseWithPublished(f) => {
                self.margin("/scale", f.scale);
                self.margin("/at-most", f.at_most);
                self.base(f.ratio_to.as_ref());
                self.unless(f.ratio_to.is_none() || f.baseline.is_empty(), "/baseline", || {
                    "skill over log ratios is counted over their mean; leave `baseline` out"
                        .to_owned()
                });
                for (i, factor) in f.baseline.iter().enumerate() {
                    if self.values_of(factor).is_none() {
                        self.unknown_factor(&format!("/baseline/{i}"), factor, false);
                    }
                }
            }
        }
    }

    fn base(&mut self, ratio_to: Option<&Where>) {
        let single = |w: &Where| !w.0.is_empty() && w.0.values().all(|Values(v)| v.len() == 1);
        self.unless(ratio_to.is_none_or(single), "/ratio-to", || {
            "expected one value per factor: the base of a ratio is one cell".to_owned()
        });
    }

    fn per_run(&mut self, form: &Comparison) {
        if let Some(per_run) = form.per_run {
            let share = form.metric.0.iter().find(|name| Metric::named(name).is_share());
            self.unless(share.is_none(), "/per-run", || {
                let share = share.map_or("", String::as_str);
                format!("`{share}` is a share of runs; only measures have logarithms")
            });
            let found = form.metric.0.len();
            let (fits, expected) = match per_run {
                PerRun::MeanLog => (found >= 2, "two metrics or more"),
                PerRun::LogRatio => (found == 2, "two metrics"),
            };
            self.unless(fits, "/per-run", || format!("expected {expected}, found {found}"));
        }
        self.unless(form.also_at_n.is_none_or(|n| n >= 2), "/also-at-n", || {
            "expected at least 2: fewer trials have no spread".to_owned()
        });
    }

    fn that(&mut self, that: &That) {
        let bounds = [("/that/at-least", &that.at_least), ("/that/at-most", &that.at_most)];
        let bounded = bounds.iter().any(|(_, bound)| bound.is_some());
        let share = Metric::named(&that.metric).is_share();
        self.unless(bounded != share, "/that", || {
            "a measure needs `at-least` or `at-most`, a share neither".to_owned()
        });
        for (path, bound) in bounds {
            let Some(Bound::Factor(name)) = bound else { continue };
            match self.values_of(name) {
                None => self.unknown_factor(path, name, false),
                Some(values) => {
                    let word = values.iter().find(|value| value.parse::<f64>().is_err());
                    self.unless(word.is_none(), path, || {
                        let word = word.map_or("", String::as_str);
                        format!("`{name}` has the value `{word}`, which is no number")
                    });
                }
            }
        }
    }

    fn each(&mut self, path: &str, each: &[String], other: &Where) {
        for factor in each {
            self.unless(other.0.contains_key(factor), path, || {
                format!("`{factor}` is not among the factors of `where`")
            });
        }
    }

    fn assumption(&mut self, power: Option<&Assume>) {
        match power {
            None => {}
            Some(Assume::Published { table, scale }) => {
                self.table("/power/published/table", table);
                self.margin("/power/published/scale", *scale);
            }
            Some(Assume::Cells(cells)) => {
                for (i, cell) in cells.iter().enumerate() {
                    self.selection(&format!("/power/cells/{i}/where"), &cell.r#where);
                }
            }
        }
    }
}
