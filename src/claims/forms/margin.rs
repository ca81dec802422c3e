//! Evidence that a difference lies inside a margin: what `equivalent` and `homogeneous` are made of.

use super::difference::{mean_effect, share_effect};
use crate::claims::cannot_test::CannotTest;
use crate::claims::gather::{Bench, Group, varies};
use crate::claims::metric::Metric;
use crate::claims::verdict::EffectSize;
use crate::stats::equivalence::{EquivalenceTest, tost_means, tost_proportions};
use crate::stats::means::welch;

/// Returns the name of the test for a metric.
pub(super) fn test_name(metric: &Metric) -> &'static str {
    if metric.is_share() { "tost-newcombe" } else { "tost-welch" }
}

/// Tests a pair from both sides and returns its difference beside the p-values.
pub(super) fn pair(
    bench: &Bench<'_>,
    a: &Group,
    b: &Group,
    margin: f64,
) -> Result<(EquivalenceTest, EffectSize), CannotTest> {
    if let Some((p, q)) = a.proportion.zip(b.proportion) {
        return Ok((tost_proportions(p, q, margin), share_effect(p, q, bench.confidence())));
    }
    varies(&[a, b])?;
    let interval = welch(a.summary, b.summary).interval(bench.confidence());
    Ok((tost_means(a.summary, b.summary, margin), mean_effect(a, b, interval)))
}
