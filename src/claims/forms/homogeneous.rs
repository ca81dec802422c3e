//! `homogeneous`: all cells across a factor lie within a margin of one another.
//!
//! ```yaml
//! id: D1b
//! ours: at the shortest deadline all strategies do alike
//! expect:
//!   homogeneous:
//!     metric: success
//!     where: {start: A, deadline-s: 68}
//!     across: {strategy: [random, frontier, normalized-frontier]}
//!     margin: 0.1
//!     minimum-n: 50
//! ```

use super::declare::form;
use super::form::Form;
use super::margin::{pair, test_name};
use super::scope::Scope;
use crate::claims::cannot_test::CannotTest;
use crate::claims::cells::{ForEach, Values, Where};
use crate::claims::faults::Faults;
use crate::claims::gather::{Bench, Draft, Evidence, Group};
use crate::claims::metric::Metric;
use crate::claims::terms::Terms;
use crate::claims::verdict::EffectSize;
use crate::stats::means::anova;
use crate::stats::multiple::holm;
use crate::stats::proportion::{Proportion, chi_square_homogeneity};
use crate::stats::summary::Summary;

form! {
    /// `homogeneous`.
    pub struct Homogeneity {
        /// What is measured.
        pub metric: Values,
        /// Holds for every cell.
        #[serde(default)]
        pub r#where: Where,
        /// The cells: every combination.
        pub across: Where,
        /// Repeated over these.
        #[serde(default)]
        pub for_each: ForEach,
        /// Largest difference between any two cells that still counts as equal.
        pub margin: f64,
    }
    terms {
        /// Level of each one-sided test.
        alpha,
        correction, at_least, minimum_n, censored,
    }
}

impl Form for Homogeneity {
    fn terms(&self) -> Terms {
        self.shared_terms()
    }

    fn scope(&self) -> Scope<'_> {
        Scope::across(&self.metric, &self.r#where, &self.across, &self.for_each)
    }

    fn check<'a>(&'a self, faults: &mut Faults<'a>) {
        faults.across(&self.across);
        faults.margin("/margin", self.margin);
    }

    fn judge(&self, bench: &Bench<'_>) -> Vec<Draft> {
        let (across, margin) = (&self.across, self.margin);
        let mut drafts = Vec::new();
        for name in &self.metric.0 {
            let metric = Metric::named(name);
            for pins in self.for_each.combinations() {
                let base = self.r#where.pinned(&pins);
                let cells: Vec<Where> =
                    across.combinations().iter().map(|cell| base.pinned(cell)).collect();
                let about = format!("{metric}: ({base}) alike across {across} within {margin}");
                drafts.push(bench.draft(
                    about,
                    test_name(&metric),
                    &cells,
                    &metric,
                    |_, groups| all_pairs(bench, groups, margin),
                ));
            }
        }
        drafts
    }
}

/// Weighs whether all pairs lie inside the margin. That they do is an intersection of statements: each pair must pass at
/// alpha, and no correction is due (Berger 1982). That some pair lies beyond it is a union: Holm over the pairs.
fn all_pairs(bench: &Bench<'_>, groups: &[Group], margin: f64) -> Result<Evidence, CannotTest> {
    if groups.len() < 2 {
        return Err(CannotTest::OneCell);
    }
    let mut beyond = Vec::new();
    let mut widest: Option<(f64, EffectSize)> = None;
    let mut p_for = 0.0_f64;
    for (i, a) in groups.iter().enumerate() {
        for b in &groups[i + 1..] {
            let (found, mut effect) = pair(bench, a, b, margin)?;
            p_for = p_for.max(found.inside);
            beyond.push(found.beyond);
            if widest.as_ref().is_none_or(|(size, _)| effect.value.abs() > *size) {
                effect.name = "largest-difference".into();
                widest = Some((effect.value.abs(), effect));
            }
        }
    }
    let mut statistics = vec![("margin", margin)];
    // The usual test of homogeneity stands beside the verdict and takes no part in it.
    let shares: Option<Vec<Proportion>> = groups.iter().map(|g| g.proportion).collect();
    if let Some(shares) = shares {
        let found = chi_square_homogeneity(&shares);
        statistics.extend([
            ("chi-square", found.statistic),
            ("df", found.df),
            ("chi-square-p", found.p),
        ]);
    } else {
        let summaries: Vec<Summary> = groups.iter().map(|g| g.summary).collect();
        let found = anova(&summaries);
        statistics.extend([("f", found.f), ("anova-p", found.p)]);
    }
    let p_against = holm(&beyond).into_iter().fold(1.0, f64::min);
    let effect = widest.map(|(_, effect)| effect);
    Ok(Evidence { p_for, p_against, statistics, effect })
}
