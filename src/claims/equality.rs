//! `equivalent` and `homogeneous`: evidence that differences lie inside a margin.

use super::comparing::{Equivalence, Homogeneity};
use super::comparison::{mean_effect, share_effect};
use super::gather::{Bench, Draft, Evidence, Group, varies};
use super::metric::Metric;
use super::verdict::Effect;
use crate::stats::equivalence::{self, tost_means, tost_proportions};
use crate::stats::means::{anova, welch};
use crate::stats::multiple::holm;
use crate::stats::proportion::{Proportion, chi_square_homogeneity};
use crate::stats::summary::Summary;

/// Name of the test for a metric.
fn test_name(metric: &Metric) -> &'static str {
    if metric.is_share() { "tost-newcombe" } else { "tost-welch" }
}

pub(super) fn equivalent(bench: &Bench<'_>, form: &Equivalence) -> Vec<Draft> {
    let mut drafts = Vec::new();
    for name in &form.metric.0 {
        let metric = Metric::named(name);
        for pins in form.for_each.combinations() {
            for other in form.to.cells() {
                let cells = [form.r#where.pinned(&pins), other.pinned(&pins)];
                let about =
                    format!("{metric}: ({}) = ({}) within {}", cells[0], cells[1], form.margin);
                let gathered = bench.gather(&cells, &metric);
                let evidence = gathered.groups.and_then(|groups| {
                    let (found, effect) = pair(bench, &groups[0], &groups[1], form.margin)?;
                    Ok(Evidence {
                        p_for: found.inside,
                        p_against: found.beyond,
                        statistics: vec![("margin", form.margin)],
                        effect: Some(effect),
                    })
                });
                drafts.push(Draft {
                    about,
                    test: test_name(&metric),
                    cells: gathered.numbers,
                    conditions: gathered.conditions,
                    evidence,
                    notes: gathered.notes,
                });
            }
        }
    }
    drafts
}

/// Two one-sided tests of a pair, and its difference.
fn pair(
    bench: &Bench<'_>,
    a: &Group,
    b: &Group,
    margin: f64,
) -> Result<(equivalence::Equivalence, Effect), String> {
    if let Some((p, q)) = a.proportion.zip(b.proportion) {
        return Ok((tost_proportions(p, q, margin), share_effect(p, q, bench.confidence())));
    }
    varies(&[a, b])?;
    let interval = welch(a.summary, b.summary).interval(bench.confidence());
    Ok((tost_means(a.summary, b.summary, margin), mean_effect(a, b, interval)))
}

/// All pairs inside the margin is an intersection of statements: each pair must pass at alpha, and no
/// correction is due (Berger 1982). Some pair beyond it is a union: Holm over the pairs.
pub(super) fn homogeneous(bench: &Bench<'_>, form: &Homogeneity) -> Vec<Draft> {
    let mut drafts = Vec::new();
    for name in &form.metric.0 {
        let metric = Metric::named(name);
        for pins in form.for_each.combinations() {
            let base = form.r#where.pinned(&pins);
            let cells: Vec<_> =
                form.across.combinations().iter().map(|cell| base.pinned(cell)).collect();
            let about =
                format!("{metric}: ({base}) alike across {} within {}", form.across, form.margin);
            let gathered = bench.gather(&cells, &metric);
            let evidence =
                gathered.groups.and_then(|groups| all_pairs(bench, &groups, form.margin));
            drafts.push(Draft {
                about,
                test: test_name(&metric),
                cells: gathered.numbers,
                conditions: gathered.conditions,
                evidence,
                notes: gathered.notes,
            });
        }
    }
    drafts
}

fn all_pairs(bench: &Bench<'_>, groups: &[Group], margin: f64) -> Result<Evidence, String> {
    if groups.len() < 2 {
        return Err("one cell has nothing to be alike to".to_owned());
    }
    let mut beyond = Vec::new();
    let mut widest: Option<(f64, Effect)> = None;
    let mut p_for = 0.0_f64;
    for (i, a) in groups.iter().enumerate() {
        for b in &groups[i + 1..] {
            let (found, mut effect) = pair(bench, a, b, margin)?;
            p_for = p_for.max(found.inside);
            beyond.push(found.beyond);
            if widest.as_ref().is_none_or(|(size, _)| effect.value.abs() > *size) {
                effect.name = "largest-difference";
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
