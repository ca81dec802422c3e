//! `correlation-with-published`: Spearman's correlation over the published cells, optionally of log ratios to
//! a base cell.
//!
//! ```yaml
//! id: D15
//! says: reaching the same conclusions in terms of relative value of the exploration strategies
//! paper-table: silent
//! expect:
//!   correlation-with-published:
//!     metric: success
//!     published: success-percent
//!     scale: 0.01
//!     at-least: 0.6
//! ```

use super::agreement::{Compared, compared};
use super::declare::form;
use super::form::Form;
use super::pairing::{Point, clusters};
use super::scope::Scope;
use crate::claims::cannot_test::CannotTest;
use crate::claims::cells::{Values, Where};
use crate::claims::faults::Faults;
use crate::claims::gather::{Bench, Draft, Evidence};
use crate::claims::terms::{Terms, one};
use crate::claims::verdict::EffectSize;
use crate::math::ln;
use crate::stats::distribution::normal_sf;
use crate::stats::length;
use crate::stats::rank::{midranks, pearson, spearman, spearman_interval, spearman_permutation};
use crate::stats::summary::mean;

form! {
    /// `correlation-with-published`.
    pub struct Correlation {
        /// What is measured; several where the published table has a `metric` column.
        pub metric: Values,
        /// Name of the published table.
        pub published: String,
        /// Published values times this are in the metric's unit (0.01 for percent).
        #[serde(default = "one")]
        pub scale: f64,
        /// Which of the published cells; default all.
        #[serde(default)]
        pub r#where: Where,
        /// If given, log ratios to the cell with these factors replaced are compared.
        pub ratio_to: Option<Where>,
        /// Spearman's correlation claimed.
        pub at_least: f64,
    }
    terms {
        alpha,
        /// Published cells without which nothing is judged.
        minimum_n,
        censored,
    }
}

impl Form for Correlation {
    /// Returns the shared terms. What is counted are published cells: one of ours needs one run.
    fn terms(&self) -> Terms {
        Terms { minimum_runs: 1, ..self.shared_terms() }
    }

    fn scope(&self) -> Scope<'_> {
        compared!(self).scope()
    }

    fn check<'a>(&'a self, faults: &mut Faults<'a>) {
        faults.margin("/scale", self.scale);
        faults.unless(self.at_least > -1.0 && self.at_least < 1.0, "/at-least", || {
            format!("a correlation lies between -1 and 1, found {}", self.at_least)
        });
        compared!(self).check(faults);
    }

    fn judge(&self, bench: &Bench<'_>) -> Vec<Draft> {
        let claimed = format!("correlation at least {}", self.at_least);
        compared!(self).draft(bench, "spearman", &claimed, |about, _, points| {
            correlated(bench, about, points, self.at_least)
        })
    }
}

/// Weighs whether the rank correlation reaches a level: its interval (Bonett and Wright 2000) above the level,
/// and a permutation p-value against none at all. Cells that are measured on the same runs count as one in both:
/// the interval has the width that independent ones of their number would give, and their mean ranks are permuted.
fn correlated(
    bench: &Bench<'_>,
    about: &str,
    points: &[Point<'_>],
    level: f64,
) -> Result<Evidence, CannotTest> {
    let (x, y): (Vec<f64>, Vec<f64>) = points.iter().map(|p| (p.x, p.y)).unzip();
    let (x, y) = (&x[..], &y[..]);
    let r = spearman(x, y);
    if r.is_nan() {
        return Err(CannotTest::NoCorrelation);
    }
    let clusters = clusters(points.iter().map(|p| p.runs));
    if clusters.len() < 4 {
        return Err(CannotTest::FewConditions(clusters.len()));
    }
    let mean_ranks = |values: &[f64]| -> Vec<f64> {
        let ranks = midranks(values);
        let of = |places: &Vec<usize>| mean(&places.iter().map(|&i| ranks[i]).collect::<Vec<_>>());
        clusters.iter().map(of).collect()
    };
    let mut stream = bench.stream(about);
    let permuted = spearman_permutation(
        &mean_ranks(x),
        &mean_ranks(y),
        bench.context.permutations,
        &mut stream,
    )
    .greater;
    let fisher = |r: f64| 0.5 * ln((1.0 + r) / (1.0 - r));
    let standard_error = ((1.0 + r * r / 2.0) / (length(&clusters) - 3.0)).sqrt();
    let z = (fisher(r) - fisher(level)) / standard_error;
    let (mx, my) = (mean(x), mean(y));
    let xy: f64 = x.iter().zip(y).map(|(a, b)| (a - mx) * (b - my)).sum();
    let xx: f64 = x.iter().map(|a| (a - mx) * (a - mx)).sum();
    Ok(Evidence {
        p_for: normal_sf(z).max(permuted),
        p_against: normal_sf(-z),
        statistics: vec![
            ("cells", length(x)),
            ("independent-cells", length(&clusters)),
            ("permutation-p", permuted),
            ("pearson", pearson(x, y)),
            ("slope", xy / xx),
        ],
        effect: Some(EffectSize::new(
            "spearman",
            r,
            spearman_interval(r, clusters.len() as u64, bench.confidence()),
        )),
    })
}
