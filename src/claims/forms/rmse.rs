//! `rmse-with-published`: root mean square difference over the published cells, in the metric's unit, with the
//! skill over a constant and over `baseline` means beside it.
//!
//! ```yaml
//! id: D15b
//! ours: success rates within 18 points of the paper's
//! expect:
//!   rmse-with-published:
//!     metric: success
//!     published: success-percent
//!     scale: 0.01
//!     at-most: 0.18
//!     baseline: [start, strategy]
//! ```

use super::agreement::{Compared, compared};
use super::declare::form;
use super::form::Form;
use super::pairing::{Pair, Point, clusters, printed};
use super::scope::Scope;
use crate::claims::cells::{Values, Where};
use crate::claims::faults::Faults;
use crate::claims::gather::{Bench, Draft, Evidence};
use crate::claims::terms::{Terms, one};
use crate::claims::verdict::EffectSize;
use crate::stats::agreement;
use crate::stats::bootstrap::{Bootstrapped, bootstrap};
use crate::stats::distribution::student_t_quantile;
use crate::stats::proportion::{Proportion, newcombe};
use crate::stats::rank::{pearson, spearman};
use crate::stats::summary::mean;
use crate::stats::{length, real};
use std::collections::BTreeMap;

form! {
    /// `rmse-with-published`.
    pub struct Rmse {
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
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub ratio_to: Option<Where>,
        /// Root mean square difference claimed, in the metric's unit; with `ratio-to`, of the log ratios.
        pub at_most: f64,
        /// Factors whose published means are the guess that skill is counted over.
        #[serde(default)]
        pub baseline: Vec<String>,
    }
    terms {
        alpha,
        /// Published cells without which nothing is judged.
        minimum_n,
        censored,
    }
}

impl Form for Rmse {
    /// Returns the shared terms. What is counted are published cells: one of ours needs one run.
    fn terms(&self) -> Terms {
        Terms { minimum_runs: 1, ..self.shared_terms() }
    }

    fn scope(&self) -> Scope<'_> {
        compared!(self).scope()
    }

    fn check<'a>(&'a self, faults: &mut Faults<'a>) {
        faults.margin("/scale", self.scale);
        faults.margin("/at-most", self.at_most);
        compared!(self).check(faults);
        faults.unless(self.ratio_to.is_none() || self.baseline.is_empty(), "/baseline", || {
            "skill over log ratios is counted over their mean; leave `baseline` out".to_owned()
        });
        for (i, factor) in self.baseline.iter().enumerate() {
            if faults.values_of(factor).is_none() {
                faults.unknown_factor(&format!("/baseline/{i}"), factor, false);
            }
        }
    }

    fn judge(&self, bench: &Bench<'_>) -> Vec<Draft> {
        let claimed = format!("root mean square difference at most {}", self.at_most);
        compared!(self).draft(bench, "bootstrap-over-cells", &claimed, |about, pairs, points| {
            Ok(match &self.ratio_to {
                None => distance(bench, about, pairs, self),
                Some(base) => distance_of_ratios(bench, about, points, base, self.at_most),
            })
        })
    }
}

/// Returns the root of the mean of `squares` with its interval, `clusters` of them drawn together.
fn resampled(
    bench: &Bench<'_>,
    about: &str,
    squares: &[f64],
    clusters: &[Vec<usize>],
) -> Bootstrapped {
    let sums: Vec<f64> =
        clusters.iter().map(|places| places.iter().map(|&i| squares[i]).sum()).collect();
    let sizes: Vec<f64> = clusters.iter().map(|places| length(places)).collect();
    let places: Vec<f64> = (0..clusters.len()).map(|i| real(i as u64)).collect();
    bootstrap(
        &[&places],
        |drawn| {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "places of clusters"
            )]
            let total = |of: &[f64]| drawn[0].iter().map(|&i| of[i as usize]).sum::<f64>();
            (total(&sums) / total(&sizes)).sqrt()
        },
        bench.context.resamples,
        bench.confidence(),
        &mut bench.stream(about),
    )
}

/// Weighs by its resamples whether a root mean square difference is at most a bound.
fn bounded(found: &Bootstrapped, at_most: f64, statistics: Vec<(&'static str, f64)>) -> Evidence {
    let count =
        |holds: &dyn Fn(f64) -> bool| found.statistics.iter().filter(|&&x| holds(x)).count() as u64;
    let share = |n: u64| (real(n) + 1.0) / (length(&found.statistics) + 1.0);
    Evidence {
        p_for: share(count(&|x| x >= at_most)),
        p_against: share(count(&|x| x <= at_most)),
        statistics,
        effect: Some(EffectSize::new("rmse", found.estimate, found.interval)),
    }
}

/// Weighs log ratios: those with a base in common are one block, as whatever befell the base befell all of them.
fn distance_of_ratios(
    bench: &Bench<'_>,
    about: &str,
    points: &[Point<'_>],
    base: &Where,
    at_most: f64,
) -> Evidence {
    let (x, y): (Vec<f64>, Vec<f64>) = points.iter().map(|p| (p.x, p.y)).unzip();
    let squares: Vec<f64> = x.iter().zip(&y).map(|(x, y)| (x - y) * (x - y)).collect();
    let bases: Vec<BTreeMap<String, String>> = points
        .iter()
        .map(|point| {
            let mut pins = point.runs.clone();
            pins.retain(|factor, _| !base.0.contains_key(factor));
            pins
        })
        .collect();
    let blocks = clusters(bases.iter());
    let found = resampled(bench, about, &squares, &blocks);
    let line = agreement::line(
        &x.iter().copied().zip(y.iter().copied()).collect::<Vec<_>>(),
        &blocks,
        bench.confidence(),
    );
    let mut statistics = vec![
        ("cells", length(points)),
        ("independent-cells", length(&blocks)),
        ("bias", mean(&y) - mean(&x)),
        ("slope", line.slope),
        ("pearson", pearson(&x, &y)),
        ("spearman", spearman(&x, &y)),
        ("skill-over-constant", agreement::skill_over_constant(&y, &x)),
    ];
    let inside: Vec<f64> = points
        .iter()
        .filter_map(|point| {
            let (above, below) = point.of?;
            let (above, below) = (printed(above)?, printed(below)?);
            let half = agreement::log_ratio_half_width(above, below, 0.95);
            Some(f64::from(u8::from((point.y - point.x).abs() <= half)))
        })
        .collect();
    if !inside.is_empty() {
        statistics.push(("inside-prediction-interval", mean(&inside)));
        statistics.push(("cells-with-interval", length(&inside)));
    }
    bounded(&found, at_most, statistics)
}

fn distance(bench: &Bench<'_>, about: &str, pairs: &[Pair], form: &Rmse) -> Evidence {
    let differences: Vec<f64> = pairs.iter().map(|p| p.ours.summary.mean - p.published).collect();
    let squares: Vec<f64> = differences.iter().map(|d| d * d).collect();
    // Cells that are measured on the same runs are drawn together.
    let clusters = clusters(pairs.iter().map(|p| &p.pins));
    let found = resampled(bench, about, &squares, &clusters);
    let mut statistics = vec![
        ("cells", length(pairs)),
        ("independent-cells", length(&clusters)),
        ("bias", mean(&differences)),
    ];
    // What guesses score that know the paper's means and nothing else.
    let published: Vec<f64> = pairs.iter().map(|p| p.published).collect();
    let ours: Vec<f64> = pairs.iter().map(|p| p.ours.summary.mean).collect();
    let skill = |guess: &[f64]| {
        let errors: Vec<f64> =
            guess.iter().zip(&published).map(|(g, p)| (g - p) * (g - p)).collect();
        1.0 - mean(&squares) / mean(&errors)
    };
    statistics.push(("skill-over-constant", skill(&vec![mean(&published); pairs.len()])));
    if !form.baseline.is_empty() {
        let published_means = group_means(pairs, &published, &form.baseline);
        let our_means = group_means(pairs, &ours, &form.baseline);
        statistics.push(("skill-over-baseline-means", skill(&published_means)));
        let within = |values: &[f64], means: &[f64]| -> Vec<f64> {
            values.iter().zip(means).map(|(v, m)| v - m).collect()
        };
        let contrast = pearson(&within(&published, &published_means), &within(&ours, &our_means));
        statistics.push(("within-baseline-correlation", contrast));
    }
    let expected: Option<Vec<f64>> = pairs.iter().map(replicate_variance).collect();
    if let Some(expected) = expected {
        statistics.push(("replicate-rmse", mean(&expected).sqrt()));
    }
    let inside: Option<Vec<f64>> =
        pairs.iter().map(|p| predicted(p).map(|is| f64::from(u8::from(is)))).collect();
    if let Some(inside) = inside {
        statistics.push(("inside-prediction-interval", mean(&inside)));
    }
    bounded(&found, form.at_most, statistics)
}

/// Returns for each pair the mean of `values` over the pairs that agree with it in `factors`.
fn group_means(pairs: &[Pair], values: &[f64], factors: &[String]) -> Vec<f64> {
    let key = |pair: &Pair| -> Vec<Option<String>> {
        let pins = factors.iter().map(|f| pair.pins.get(f).cloned());
        pins.chain([Some(pair.metric.to_string())]).collect()
    };
    let mut groups: BTreeMap<Vec<Option<String>>, Vec<f64>> = BTreeMap::new();
    for (pair, value) in pairs.iter().zip(values) {
        groups.entry(key(pair)).or_default().push(*value);
    }
    pairs.iter().map(|pair| mean(&groups[&key(pair)])).collect()
}

/// Returns the variance of the difference between the paper's cell and an exact replicate of it with our runs.
fn replicate_variance(pair: &Pair) -> Option<f64> {
    let variance = if pair.metric.is_share() {
        pair.published * (1.0 - pair.published)
    } else {
        pair.sd? * pair.sd?
    };
    Some(variance * (1.0 / real(pair.n?) + 1.0 / real(pair.ours.runs())))
}

/// Returns whether our mean lies where the paper's spread and runs put 95 % of replicates.
fn predicted(pair: &Pair) -> Option<bool> {
    let n = pair.n?;
    if let Some(ours) = pair.ours.proportion {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a share of runs times runs"
        )]
        let successes = (pair.published.clamp(0.0, 1.0) * real(n)).round() as u64;
        let interval = newcombe(ours, Proportion::new(successes, n), 0.95);
        return Some(interval.low <= 0.0 && interval.high >= 0.0);
    }
    if n < 2 {
        return None;
    }
    let half = student_t_quantile(0.975, real(n) - 1.0) * replicate_variance(pair)?.sqrt();
    Some((pair.ours.summary.mean - pair.published).abs() <= half)
}
