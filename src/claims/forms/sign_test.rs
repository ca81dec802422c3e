//! `sign-test`: over many pairs of cells, or over trials that share their noise, one side is lower more often
//! than not. Several metrics of the same runs vote together: they are one pair, not several.
//!
//! ```yaml
//! id: P11
//! says: Using a priori knowledge improves considerably the performance in all the three cases
//! paper-table: supports
//! expect:
//!   sign-test:
//!     metric: [distance-m-at-80, distance-m-at-90]
//!     direction: less
//!     where: {prior: floor-plan}
//!     than: {prior: none}
//!     for-each: {environment: [basic, office, open], furnished: [true, false]}
//!     minimum-n: 6
//!     censored: reached-only
//! ```

use super::declare::form;
use super::form::Form;
use super::scope::Scope;
use crate::claims::cannot_test::CannotTest;
use crate::claims::cells::{ForEach, Values, Where};
use crate::claims::faults::Faults;
use crate::claims::gather::{Bench, Draft, Evidence};
use crate::claims::metric::Metric;
use crate::claims::terms::{Censored, Side, Sides, Terms};
use crate::claims::verdict::{CellNumbers, EffectSize};
use crate::stats;
use crate::stats::proportion::{Proportion, wilson};
use crate::stats::real;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

form! {
    /// `sign-test`.
    pub struct SignTest {
        /// What is measured. Several metrics of one pair vote; a drawn vote is a tie.
        pub metric: Values,
        /// Which side the first cell lies on.
        pub direction: Side,
        /// The first of each pair.
        pub r#where: Where,
        /// The second of each pair.
        pub than: Where,
        /// The pairs, or with `pairs: trials` a restriction of them.
        #[serde(default)]
        pub for_each: ForEach,
        /// Pairs of cells (by their means or shares) or of trials.
        #[serde(default)]
        pub pairs: Pairs,
    }
    terms {
        sides, alpha,
        /// Pairs that are not ties, without which nothing is judged.
        minimum_n,
        /// What becomes of runs that did not reach the measure; with `pairs: trials`, `worst` ranks them behind.
        censored,
    }
}

/// What a sign is taken of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Pairs {
    /// Two cells of each `for-each` combination.
    #[default]
    Cells,
    /// Two trials of the same number in conditions that differ only in the factors compared.
    Trials,
}

impl Form for SignTest {
    /// Returns the shared terms. What is counted are pairs: a cell needs one run.
    fn terms(&self) -> Terms {
        Terms { minimum_runs: 1, ..self.shared_terms() }
    }

    fn scope(&self) -> Scope<'_> {
        let named = [("/where", &self.r#where), ("/than", &self.than)];
        Scope::two_cells(&self.metric, named, &self.for_each)
    }

    fn ranks(&self) -> bool {
        self.pairs == Pairs::Trials
    }

    fn check<'a>(&'a self, _: &mut Faults<'a>) {}

    fn judge(&self, bench: &Bench<'_>) -> Vec<Draft> {
        let sign = if self.direction == Side::Less { "<" } else { ">" };
        let about = format!(
            "{}: ({}) {sign} ({}), by sign",
            self.metric.0.join(" and "),
            self.r#where,
            self.than
        );
        let mut signs = Signs::default();
        let counted = match self.pairs {
            Pairs::Cells => by_cells(bench, self, &mut signs),
            Pairs::Trials => by_trials(bench, self, &mut signs),
        };
        let evidence = counted.and_then(|()| {
            let pairs = signs.below + signs.above;
            if pairs < self.minimum_n.max(1) {
                let (minimum, ties) = (self.minimum_n, signs.ties);
                return Err(CannotTest::FewPairs { pairs, minimum, ties });
            }
            let claimed = match self.direction {
                Side::Less => signs.below,
                Side::Greater => signs.above,
            };
            let tails = stats::rank::sign_test(claimed, pairs - claimed);
            let half = claimed * 2;
            let (p_for, p_against) = match self.sides {
                Sides::One => (tails.greater, tails.less),
                Sides::Two => (
                    if half > pairs { tails.two_sided } else { 1.0 },
                    if half < pairs { tails.two_sided } else { 1.0 },
                ),
            };
            let share = Proportion::new(claimed, pairs);
            let effect =
                EffectSize::new("share-of-pairs", share.share(), wilson(share, bench.confidence()));
            let statistics = vec![
                ("pairs", real(pairs)),
                ("as-claimed", real(claimed)),
                ("ties", real(signs.ties)),
            ];
            Ok(Evidence { p_for, p_against, statistics, effect: Some(effect) })
        });
        // More trials make more pairs only where trials are the pairs.
        let conditions = if self.pairs == Pairs::Trials { signs.conditions } else { Vec::new() };
        let test = "sign-test";
        vec![Draft { about, test, cells: signs.cells, conditions, evidence, notes: signs.notes }]
    }
}

/// Signs of the pairs, and what they were taken from.
#[derive(Default)]
struct Signs {
    below: u64,
    above: u64,
    ties: u64,
    cells: Vec<CellNumbers>,
    conditions: Vec<usize>,
    notes: Vec<String>,
}

impl Signs {
    /// Counts one pair, in which each metric has one vote.
    fn count(&mut self, differences: &[f64]) {
        let vote = |d: &f64| i64::from(*d > 0.0) - i64::from(*d < 0.0);
        match differences.iter().map(vote).sum::<i64>().signum() {
            -1 => self.below += 1,
            1 => self.above += 1,
            _ => self.ties += 1,
        }
    }
}

/// Counts one pair per combination: noise in common is welcome within a pair and refused between pairs.
fn by_cells(bench: &Bench<'_>, form: &SignTest, signs: &mut Signs) -> Result<(), CannotTest> {
    let mut pair_of: BTreeMap<Vec<String>, usize> = BTreeMap::new();
    let mut reason = None;
    for (pair, pins) in form.for_each.combinations().iter().enumerate() {
        let mut differences = Vec::new();
        for name in &form.metric.0 {
            let metric = Metric::named(name);
            reason = reason.or_else(|| bench.observations.lacks(&metric));
            let mut means = [0.0; 2];
            for (mean, side) in means.iter_mut().zip([&form.r#where, &form.than]) {
                let (group, mut numbers, fault) = bench.group(&side.pinned(pins), &metric);
                reason = reason.or(fault);
                *mean = group.summary.mean;
                numbers.cell = format!("{metric}: {}", numbers.cell);
                if numbers.reached < numbers.trials && !metric.is_share() {
                    let (reached, trials) = (numbers.reached, numbers.trials);
                    signs
                        .notes
                        .push(format!("reached by {reached} of {trials} ({})", numbers.cell));
                }
                signs.cells.push(numbers);
                for &i in &group.conditions {
                    let own = bench.observations.own_coordinates(i, bench.context.shared_noise);
                    let own = own.into_iter().map(str::to_owned).collect();
                    if *pair_of.entry(own).or_insert(pair) != pair {
                        reason = reason
                            .or_else(|| Some(CannotTest::InTwoPairs(bench.observations.name(i))));
                    }
                }
                signs.conditions.extend(&group.conditions);
            }
            differences.push(means[0] - means[1]);
        }
        signs.count(&differences);
    }
    reason.map_or(Ok(()), Err)
}

/// What two partners have in common: the factor values that are not compared, and the trial number.
type Partner<'a> = (Vec<&'a str>, i64);

/// Counts one pair per trial number and condition, the two conditions differing in the compared factors only.
fn by_trials(bench: &Bench<'_>, form: &SignTest, signs: &mut Signs) -> Result<(), CannotTest> {
    let observations = bench.observations;
    let compared: Vec<String> = form.r#where.0.keys().chain(form.than.0.keys()).cloned().collect();
    if let Some(other) = bench.context.shared_noise.iter().find(|f| !compared.contains(f)) {
        return Err(CannotTest::NoiseOver(other.clone()));
    }
    let metrics: Vec<Metric> = form.metric.0.iter().map(|name| Metric::named(name)).collect();
    if let Some(reason) = metrics.iter().find_map(|m| observations.lacks(m)) {
        return Err(reason);
    }
    let mut sides: [BTreeMap<Partner<'_>, Vec<Option<f64>>>; 2] = Default::default();
    for pins in form.for_each.combinations() {
        for (side, cell) in sides.iter_mut().zip([&form.r#where, &form.than]) {
            let cell = cell.pinned(&pins);
            for metric in &metrics {
                let (_, mut numbers, _) = bench.group(&cell, metric);
                numbers.cell = format!("{metric}: {}", numbers.cell);
                signs.cells.push(numbers);
            }
            for i in observations.select(&cell) {
                signs.conditions.push(i);
                let condition = &observations.conditions[i];
                let own = observations.own_coordinates(i, &compared);
                for (row, &number) in condition.numbers.iter().enumerate() {
                    let readings: Result<Vec<Option<f64>>, _> =
                        metrics.iter().map(|m| condition.reading(row, m)).collect();
                    let Ok(readings) = readings else {
                        let condition = observations.name(i);
                        return Err(CannotTest::FailedTrial { number, condition });
                    };
                    if side.insert((own.clone(), number), readings).is_some() {
                        let cell = cell.to_string();
                        return Err(CannotTest::SeveralPartners { number, cell });
                    }
                }
            }
        }
    }
    let [first, second] = &sides;
    let mut unpaired = first.len() + second.len();
    let mut censored = 0;
    for (key, mine) in first {
        let Some(theirs) = second.get(key) else { continue };
        unpaired -= 2;
        if mine.iter().chain(theirs).any(Option::is_none) {
            censored += 1;
            if bench.terms.censored == Censored::ReachedOnly {
                continue;
            }
        }
        let last = |x: &Option<f64>| x.unwrap_or(f64::INFINITY);
        let difference = |(a, b): (&Option<f64>, &Option<f64>)| {
            let (a, b) = (last(a), last(b));
            // Two runs that never got there are tied; infinity less infinity would not be.
            if a == b { 0.0 } else { a - b }
        };
        signs.count(&mine.iter().zip(theirs).map(difference).collect::<Vec<_>>());
    }
    if censored > 0 && bench.terms.censored == Censored::Refuse {
        return Err(CannotTest::CensoredPairs(censored));
    }
    if censored > 0 {
        signs.notes.push(format!("in {censored} pairs a run never reached the measure"));
    }
    if unpaired > 0 {
        signs.notes.push(format!("{unpaired} trials have no partner"));
    }
    Ok(())
}
