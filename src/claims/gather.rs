//! The runs of cells, and every reason why they cannot be compared.

use super::cannot_test::CannotTest;
use super::cells::Where;
use super::context::Context;
use super::metric::Metric;
use super::observations::{Counted, Observations};
use super::terms::{Censored, Sides, Terms};
use super::verdict::{CellNumbers, EffectSize};
use crate::rng::{Seeds, Stream};
use crate::stats::proportion::{Proportion, chi_square_homogeneity, fisher_exact};
use crate::stats::summary::{Summary, median};

/// The test that counts trials and estimates nothing, so that it has no p-value.
pub(super) const COUNT: &str = "count";

/// Everything a form needs at hand.
pub(super) struct Bench<'a> {
    pub(super) claim: &'a str,
    pub(super) observations: &'a Observations,
    pub(super) context: &'a Context<'a>,
    pub(super) terms: Terms,
}

/// One comparison before correction.
pub(super) struct Draft {
    pub(super) about: String,
    pub(super) test: &'static str,
    pub(super) cells: Vec<CellNumbers>,
    /// Conditions whose number of trials the evidence grows with; empty where it grows with something else.
    pub(super) conditions: Vec<usize>,
    pub(super) evidence: Result<Evidence, CannotTest>,
    pub(super) notes: Vec<String>,
}

impl Draft {
    /// Returns a comparison that cannot be tested, without a look at any cell.
    pub(super) fn untestable(about: String, reason: CannotTest) -> Self {
        Self {
            about,
            test: "none",
            cells: Vec::new(),
            conditions: Vec::new(),
            evidence: Err(reason),
            notes: Vec::new(),
        }
    }
}

/// What a test says.
pub(super) struct Evidence {
    pub(super) p_for: f64,
    pub(super) p_against: f64,
    pub(super) statistics: Vec<(&'static str, f64)>,
    pub(super) effect: Option<EffectSize>,
}

/// The runs of one cell or pool.
#[derive(Debug, Clone)]
pub(super) struct Group {
    pub(super) conditions: Vec<usize>,
    /// Of measures, one per run that counts; infinite for censored runs where they rank last. Shares are counted instead.
    pub(super) values: Vec<f64>,
    /// For shares.
    pub(super) proportion: Option<Proportion>,
    /// Of a share, number and mean alone.
    pub(super) summary: Summary,
}

impl Group {
    /// Counts the runs that count.
    pub(super) fn runs(&self) -> u64 {
        self.proportion.map_or(self.values.len() as u64, |share| share.trials)
    }
}

/// Cells gathered for one comparison.
pub(super) struct Gathered {
    pub(super) numbers: Vec<CellNumbers>,
    pub(super) conditions: Vec<usize>,
    pub(super) groups: Result<Vec<Group>, CannotTest>,
    pub(super) notes: Vec<String>,
}

impl Bench<'_> {
    /// Returns the runs of `cells`, or why they cannot be compared: nothing there, failed or censored runs, too few of
    /// them, a condition in two cells, or noise in common.
    pub(super) fn gather(&self, cells: &[Where], metric: &Metric) -> Gathered {
        let (mut numbers, mut groups, mut conditions) = (Vec::new(), Vec::new(), Vec::new());
        let mut reasons = Vec::new();
        reasons.extend(self.observations.lacks(metric));
        for cell in cells {
            let (group, seen, fault) = self.group(cell, metric);
            for &i in &group.conditions {
                if conditions.contains(&i) {
                    let name = self.observations.name(i);
                    reasons.push(CannotTest::InTwoCells(name));
                } else {
                    conditions.push(i);
                }
            }
            numbers.push(seen);
            groups.push(group);
            reasons.extend(fault);
        }
        reasons.extend(self.shared_noise(&conditions));
        let notes = if self.terms.censored == Censored::ReachedOnly && !metric.is_share() {
            unequal_reach(&numbers, self.terms.alpha)
        } else {
            Vec::new()
        };
        let groups = reasons.into_iter().next().map_or(Ok(groups), Err);
        Gathered { numbers, conditions, groups, notes }
    }

    /// Compares `cells`: `weigh` says what their runs are evidence of.
    pub(super) fn draft(
        &self,
        about: String,
        test: &'static str,
        cells: &[Where],
        metric: &Metric,
        weigh: impl FnOnce(&str, &[Group]) -> Result<Evidence, CannotTest>,
    ) -> Draft {
        let gathered = self.gather(cells, metric);
        let evidence = gathered.groups.and_then(|groups| weigh(&about, &groups));
        let (cells, conditions, notes) = (gathered.numbers, gathered.conditions, gathered.notes);
        Draft { about, test, cells, conditions, evidence, notes }
    }

    /// Refuses trials that are not independent.
    pub(super) fn shared_noise(&self, conditions: &[usize]) -> Option<CannotTest> {
        let (one, other) = self.observations.sharing(conditions, self.context.shared_noise)?;
        let factors = self.context.shared_noise.join(", ");
        Some(CannotTest::SharedNoise { one, other, factors })
    }

    /// Returns the runs of one cell, and what is wrong with them.
    pub(super) fn group(
        &self,
        cell: &Where,
        metric: &Metric,
    ) -> (Group, CellNumbers, Option<CannotTest>) {
        let conditions = self.observations.select(cell);
        let (group, numbers, censored, failed) =
            match self.observations.counted(&conditions, metric) {
                Some(counted) => share(conditions, cell, counted),
                None => self.measures(conditions, cell, metric),
            };
        let (trials, n) = (numbers.trials, group.runs());
        let (minimum, name) = (self.terms.minimum_runs, numbers.cell.clone());
        let fault = if trials == 0 {
            Some(CannotTest::NoTrial(name))
        } else if failed > 0 {
            Some(CannotTest::FailedTrials { failed, trials, cell: name })
        } else if censored > 0 && self.terms.censored == Censored::Refuse {
            let metric = metric.clone();
            Some(CannotTest::CensoredRuns { censored, trials, cell: name, metric })
        } else if n < minimum {
            Some(CannotTest::FewRuns { cell: name, n, minimum })
        } else {
            None
        };
        (group, numbers, fault)
    }

    /// Returns the values of a measure in `conditions`, which are `cell`, with their numbers and how many runs are censored and
    /// failed.
    fn measures(
        &self,
        conditions: Vec<usize>,
        cell: &Where,
        metric: &Metric,
    ) -> (Group, CellNumbers, usize, u64) {
        let readings = self.observations.readings(&conditions, metric);
        let reached: Vec<f64> = readings.values.iter().flatten().copied().collect();
        let summary = Summary::of(&reached);
        let numbers = CellNumbers {
            cell: cell.to_string(),
            trials: readings.values.len() as u64 + readings.failed,
            reached: reached.len() as u64,
            successes: None,
            mean: finite(summary.mean),
            sd: finite(summary.sd),
            median: finite(median(&reached)),
            published: None,
        };
        let censored = readings.values.len() - reached.len();
        let mut values = reached;
        if self.terms.censored == Censored::Worst {
            values.resize(values.len() + censored, f64::INFINITY);
        }
        let group = Group { conditions, values, proportion: None, summary };
        (group, numbers, censored, readings.failed)
    }

    /// Returns the confidence of the interval that says the same as the test.
    pub(super) fn confidence(&self) -> f64 {
        match self.terms.sides {
            Sides::One => 1.0 - 2.0 * self.terms.alpha,
            Sides::Two => 1.0 - self.terms.alpha,
        }
    }

    /// Returns the resampling stream of one comparison.
    pub(super) fn stream(&self, about: &str) -> Stream {
        let coordinates = vec![("claim".to_owned(), self.claim.to_owned())];
        Seeds::new(self.context.seed, coordinates).stream(&format!("claims/{about}"))
    }
}

/// Does what [`Bench::measures`] does for a share: it needs no list of zeros and ones.
fn share(
    conditions: Vec<usize>,
    cell: &Where,
    counted: Counted,
) -> (Group, CellNumbers, usize, u64) {
    let Counted { successes, reached, censored, failed } = counted;
    let proportion = Proportion::new(successes, reached);
    let numbers = CellNumbers {
        cell: cell.to_string(),
        trials: reached + censored + failed,
        reached,
        successes: Some(successes),
        mean: finite(proportion.share()),
        sd: None,
        median: None,
        published: None,
    };
    let summary = Summary { n: reached, mean: proportion.share(), sd: f64::NAN };
    let group = Group { conditions, values: Vec::new(), proportion: Some(proportion), summary };
    (group, numbers, usize::try_from(censored).unwrap_or(usize::MAX), failed)
}

fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

/// Says where the share of runs that reached a measure differs between cells: the comparison is then one of
/// those that got there.
fn unequal_reach(cells: &[CellNumbers], alpha: f64) -> Vec<String> {
    if cells.iter().all(|c| c.reached == c.trials) || cells.iter().any(|c| c.trials == 0) {
        return Vec::new();
    }
    let reach: Vec<_> = cells.iter().map(|c| Proportion::new(c.reached, c.trials)).collect();
    let p = match reach[..] {
        [a, b] => fisher_exact(a, b).two_sided,
        _ => chi_square_homogeneity(&reach).p,
    };
    let listed: Vec<String> =
        cells.iter().map(|c| format!("{} of {} ({})", c.reached, c.trials, c.cell)).collect();
    let differ = if p <= alpha {
        "; the cells differ in this, so the runs compared are a selection"
    } else {
        ""
    };
    vec![format!("reached by {}{differ}", listed.join(", "))]
}

/// Refuses groups that do not vary at all: they were not drawn at random, and no test of means applies.
pub(super) fn varies(groups: &[&Group]) -> Result<(), CannotTest> {
    if let Some(small) = groups.iter().find(|g| g.summary.n < 2) {
        return Err(CannotTest::NoSpread(small.summary.n));
    }
    if groups.iter().all(|g| g.proportion.is_none() && g.summary.sd == 0.0) {
        return Err(CannotTest::NothingVaries);
    }
    Ok(())
}
