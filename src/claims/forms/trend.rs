//! `trend`: the metric rises or falls along scored cells (`cochran-armitage` for shares, `spearman` with a
//! permutation p for measures).
//!
//! ```yaml
//! id: D6
//! says: the temporal deadlines are strict, and this boosts failure rates for all algorithms
//! paper-table: supports
//! expect:
//!   trend:
//!     metric: success
//!     direction: rising
//!     along:
//!       - {score: 0.1, where: {deadline-s: 68}}
//!       - {score: 0.4, where: {deadline-s: 272}}
//!       - {score: 0.7, where: {deadline-s: 477}}
//!       - {score: 1.0, where: {deadline-s: 680}}
//!     for-each: {strategy: [random, frontier]}
//! ```

use super::declare::form;
use super::difference::{directed, share_effect};
use super::form::Form;
use super::scope::Scope;
use crate::claims::cannot_test::CannotTest;
use crate::claims::cells::{ForEach, Values, Where};
use crate::claims::faults::Faults;
use crate::claims::gather::{Bench, Draft, Evidence, Group};
use crate::claims::metric::Metric;
use crate::claims::terms::{Side, Terms, Test};
use crate::claims::verdict::EffectSize;
use crate::stats::proportion::{Proportion, cochran_armitage};
use crate::stats::rank::{spearman, spearman_interval, spearman_permutation};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

form! {
    /// `trend`.
    pub struct Trend {
        /// What is measured.
        pub metric: Values,
        /// Holds for every step.
        #[serde(default)]
        pub r#where: Where,
        /// Two or more steps with different scores.
        pub along: Vec<Step>,
        /// Which way.
        pub direction: Direction,
        /// Repeated over these.
        #[serde(default)]
        pub for_each: ForEach,
    }
    terms {
        /// Default: `cochran-armitage` for shares, `spearman` for measures.
        test,
        sides, alpha, correction, at_least,
        /// Runs per step without which nothing is judged.
        minimum_n,
        censored,
    }
}

/// One step of a trend.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Step {
    /// Where it stands along the trend.
    pub score: f64,
    /// The cell or pool there.
    pub r#where: Where,
}

/// Which way a trend goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Direction {
    /// Up with the score.
    Rising,
    /// Down with the score.
    Falling,
}

impl Trend {
    /// Returns the cells that it goes along, in `base`.
    fn steps(&self, base: &Where) -> Vec<Where> {
        self.along.iter().map(|step| base.replaced(&step.r#where)).collect()
    }
}

impl Form for Trend {
    fn terms(&self) -> Terms {
        self.shared_terms()
    }

    fn scope(&self) -> Scope<'_> {
        let first = ("/where".to_owned(), &self.r#where);
        let steps = self.along.iter().enumerate();
        let steps = steps.map(|(i, step)| (format!("/along/{i}/where"), &step.r#where));
        let selections = [first].into_iter().chain(steps).chain(self.for_each.after([])).collect();
        let repeated = Scope::repeated(self.metric.as_metrics(), [], &self.for_each, |pins| {
            self.steps(&self.r#where.pinned(pins))
        });
        Scope { selections, ..repeated }
    }

    fn has_test(&self, test: Test) -> bool {
        matches!(test, Test::CochranArmitage | Test::Spearman)
    }

    fn ranks(&self) -> bool {
        true
    }

    fn check<'a>(&'a self, faults: &mut Faults<'a>) {
        let scores: Vec<f64> = self.along.iter().map(|s| s.score).collect();
        let apart = (1..scores.len()).all(|i| !scores[..i].contains(&scores[i]));
        let finite = scores.iter().all(|s| s.is_finite());
        faults.unless(scores.len() >= 2 && apart && finite, "/along", || {
            format!("expected two or more different scores, found {scores:?}")
        });
    }

    fn judge(&self, bench: &Bench<'_>) -> Vec<Draft> {
        let scores: Vec<f64> = self.along.iter().map(|step| step.score).collect();
        let (side, word) = match self.direction {
            Direction::Rising => (Side::Greater, "rises"),
            Direction::Falling => (Side::Less, "falls"),
        };
        let mut drafts = Vec::new();
        for name in &self.metric.0 {
            let metric = Metric::named(name);
            let usual = if metric.is_share() { Test::CochranArmitage } else { Test::Spearman };
            let test = bench.terms.test.unwrap_or(usual);
            for pins in self.for_each.combinations() {
                let base = self.r#where.pinned(&pins);
                let cells = self.steps(&base);
                let about = format!("{metric}: {word} along {} steps in ({base})", cells.len());
                drafts.push(bench.draft(about, test.name(), &cells, &metric, |about, groups| {
                    weigh(bench, about, test, groups, &scores, side)
                }));
            }
        }
        drafts
    }
}

fn weigh(
    bench: &Bench<'_>,
    about: &str,
    test: Test,
    groups: &[Group],
    scores: &[f64],
    side: Side,
) -> Result<Evidence, CannotTest> {
    if groups.len() < 2 {
        return Err(CannotTest::OneStep);
    }
    let sides = bench.terms.sides;
    let shares: Option<Vec<Proportion>> = groups.iter().map(|g| g.proportion).collect();
    match (test, shares) {
        (Test::CochranArmitage, Some(shares)) => {
            let found = cochran_armitage(&shares, scores);
            let (p_for, p_against) = directed(found.tails, found.z, side, sides);
            let at = |pick: fn(f64, f64) -> bool| {
                (1..scores.len())
                    .fold(0, |best, i| if pick(scores[i], scores[best]) { i } else { best })
            };
            let (low, high) = (at(|a, b| a < b), at(|a, b| a > b));
            let effect = Some(share_effect(shares[high], shares[low], bench.confidence()));
            Ok(Evidence { p_for, p_against, statistics: vec![("z", found.z)], effect })
        }
        (Test::Spearman, None) => {
            let (mut x, mut y) = (Vec::new(), Vec::new());
            for (group, score) in groups.iter().zip(scores) {
                x.resize(x.len() + group.values.len(), *score);
                y.extend(&group.values);
            }
            let rho = spearman(&x, &y);
            if rho.is_nan() {
                return Err(CannotTest::NothingRisesOrFalls);
            }
            let mut stream = bench.stream(about);
            let tails = spearman_permutation(&x, &y, bench.context.permutations, &mut stream);
            let (p_for, p_against) = directed(tails, rho, side, sides);
            let interval = spearman_interval(rho, x.len() as u64, bench.confidence());
            let effect = EffectSize::new("spearman", rho, interval);
            Ok(Evidence { p_for, p_against, statistics: Vec::new(), effect: Some(effect) })
        }
        _ => Err(CannotTest::OtherMetric(test.name())),
    }
}
