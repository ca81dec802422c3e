//! `less`, `greater`, `rank` and `trend`: differences with a direction.

use super::cells::Where;
use super::comparing::{Comparison, Ranking, Trend};
use super::expect::Terms;
use super::gather::{Bench, Draft, Evidence, Group, varies};
use super::metric::Metric;
use super::terms::{Direction, Order, Side, Sides, Test};
use super::verdict::{Effect, FIRST_N, FIRST_N_HEDGES_G, FIRST_N_P};
use crate::stats::bootstrap::bootstrap;
use crate::stats::effect::{cliff_delta, hedges_g, risk_difference};
use crate::stats::means::{anova, student, welch};
use crate::stats::proportion::{
    Proportion, chi_square_homogeneity, cochran_armitage, fisher_exact, newcombe,
};
use crate::stats::rank::{mann_whitney, spearman, spearman_interval, spearman_permutation};
use crate::stats::summary::{Summary, median};
use crate::stats::{Interval, Tails, real};

pub(super) fn less(bench: &Bench<'_>, form: &Comparison) -> Vec<Draft> {
    sided(bench, form, Side::Less)
}

pub(super) fn greater(bench: &Bench<'_>, form: &Comparison) -> Vec<Draft> {
    sided(bench, form, Side::Greater)
}

fn sided(bench: &Bench<'_>, form: &Comparison, side: Side) -> Vec<Draft> {
    let mut drafts = Vec::new();
    for metric in Metric::of_run(&form.metric.0, form.per_run) {
        for pins in form.for_each.combinations() {
            for other in form.than.cells() {
                let cells = [form.r#where.pinned(&pins), other.pinned(&pins)];
                drafts.push(compare(bench, &metric, &cells, side));
            }
        }
    }
    drafts
}

pub(super) fn rank(bench: &Bench<'_>, form: &Ranking) -> Vec<Draft> {
    let Some((factor, values)) = form.across.0.iter().next() else { return Vec::new() };
    let with = |base: &Where, value: &str| {
        base.pinned(&[(factor.clone(), value.to_owned())].into_iter().collect())
    };
    let pairs: Vec<(&str, &str)> = match &form.order {
        Order::First(best) => {
            values.0.iter().filter(|v| *v != best).map(|v| (best.as_str(), v.as_str())).collect()
        }
        Order::Last(worst) => {
            values.0.iter().filter(|v| *v != worst).map(|v| (v.as_str(), worst.as_str())).collect()
        }
        Order::Descending(order) => {
            order.windows(2).map(|pair| (pair[0].as_str(), pair[1].as_str())).collect()
        }
    };
    let mut drafts = Vec::new();
    for metric in &form.metric.0 {
        for pins in form.for_each.combinations() {
            let base = form.r#where.pinned(&pins);
            for &(high, low) in &pairs {
                let cells = [with(&base, high), with(&base, low)];
                drafts.push(compare(bench, &Metric::named(metric), &cells, Side::Greater));
            }
        }
    }
    drafts
}

fn compare(bench: &Bench<'_>, metric: &Metric, cells: &[Where; 2], side: Side) -> Draft {
    let sign = if side == Side::Less { "<" } else { ">" };
    let about = format!("{metric}: ({}) {sign} ({})", cells[0], cells[1]);
    let test =
        bench.terms.test.unwrap_or(if metric.is_share() { Test::FisherExact } else { Test::Welch });
    let gathered = bench.gather(cells, metric);
    let mut notes = gathered.notes;
    let evidence = gathered.groups.and_then(|groups| {
        let found = evidence(bench, &about, test, &groups[0], &groups[1])?;
        let (p_for, p_against) = directed(found.tails, found.difference, side, found.sides);
        let effect = Some(found.effect);
        let mut statistics = found.statistics;
        if let Some(n) = bench.terms.also_at_n {
            match of_the_first(bench, metric, cells, test, side, n) {
                Ok(beside) => statistics.extend(beside),
                Err(reason) => notes.push(format!("of the first {n} trials alone: {reason}")),
            }
        }
        Ok(Evidence { p_for, p_against, statistics, effect })
    });
    Draft {
        about,
        test: test.name(),
        cells: gathered.numbers,
        conditions: gathered.conditions,
        evidence,
        notes,
    }
}

/// What the first `n` trials of each condition would have said: as many as the paper ran. Decides nothing.
fn of_the_first(
    bench: &Bench<'_>,
    metric: &Metric,
    cells: &[Where; 2],
    test: Test,
    side: Side,
    n: u64,
) -> Result<Vec<(&'static str, f64)>, String> {
    let first = bench.observations.first(n);
    let terms = Terms { minimum_runs: 2, also_at_n: None, ..bench.terms };
    let bench = Bench { observations: &first, terms, ..*bench };
    let groups = bench.gather(cells, metric).groups?;
    let found = evidence(&bench, "first trials", test, &groups[0], &groups[1])?;
    let (p, _) = directed(found.tails, found.difference, side, found.sides);
    let mut told = vec![(FIRST_N, real(n)), (FIRST_N_P, p)];
    told.extend(found.effect.standardised.map(|(_, g)| (FIRST_N_HEDGES_G, g)));
    Ok(told)
}

/// p-values for a difference on the side claimed and on the other.
pub(super) fn directed(tails: Tails, difference: f64, side: Side, sides: Sides) -> (f64, f64) {
    let (less, greater) = match sides {
        Sides::One => (tails.less, tails.greater),
        Sides::Two => (
            if difference < 0.0 { tails.two_sided } else { 1.0 },
            if difference > 0.0 { tails.two_sided } else { 1.0 },
        ),
    };
    match side {
        Side::Less => (less, greater),
        Side::Greater => (greater, less),
    }
}

struct Found {
    tails: Tails,
    difference: f64,
    sides: Sides,
    statistics: Vec<(&'static str, f64)>,
    effect: Effect,
}

fn evidence(
    bench: &Bench<'_>,
    about: &str,
    test: Test,
    a: &Group,
    b: &Group,
) -> Result<Found, String> {
    let wrong = || format!("{} does not apply to this metric", test.name());
    let both = |p: f64| Tails { less: f64::NAN, greater: f64::NAN, two_sided: p };
    let shares = || a.proportion.zip(b.proportion).ok_or_else(wrong);
    let measures = || if a.proportion.is_some() { Err(wrong()) } else { Ok(()) };
    let two_sided = 1.0 - bench.terms.alpha;
    Ok(match test {
        Test::FisherExact => {
            let (p, q) = shares()?;
            let effect = share_effect(p, q, bench.confidence());
            let (tails, difference) = (fisher_exact(p, q), risk_difference(p, q));
            Found { tails, difference, sides: bench.terms.sides, statistics: Vec::new(), effect }
        }
        Test::ChiSquare => {
            let (p, q) = shares()?;
            let found = chi_square_homogeneity(&[p, q]);
            Found {
                tails: both(found.p),
                difference: risk_difference(p, q),
                sides: Sides::Two,
                statistics: vec![("chi-square", found.statistic), ("df", found.df)],
                effect: share_effect(p, q, two_sided),
            }
        }
        Test::Welch => {
            measures()?;
            varies(&[a, b])?;
            let found = welch(a.summary, b.summary);
            Found {
                tails: found.tails,
                difference: found.difference,
                sides: bench.terms.sides,
                statistics: vec![("t", found.t), ("df", found.df)],
                effect: mean_effect(a, b, found.interval(bench.confidence())),
            }
        }
        Test::Anova => {
            measures()?;
            varies(&[a, b])?;
            let found = anova(&[a.summary, b.summary]);
            let pooled = student(a.summary, b.summary);
            Found {
                tails: both(found.p),
                difference: pooled.difference,
                sides: Sides::Two,
                statistics: vec![
                    ("f", found.f),
                    ("df-between", found.df_between),
                    ("df-within", found.df_within),
                ],
                effect: mean_effect(a, b, pooled.interval(two_sided)),
            }
        }
        Test::MannWhitney => {
            measures()?;
            let found = mann_whitney(&a.values, &b.values);
            let delta = bootstrap(
                &[&a.values, &b.values],
                |drawn| cliff_delta(&drawn[0], &drawn[1]),
                bench.context.resamples,
                bench.confidence(),
                &mut bench.stream(about),
            );
            Found {
                tails: found.tails,
                difference: delta.estimate,
                sides: bench.terms.sides,
                statistics: vec![("u", found.u), ("exact", f64::from(u8::from(found.exact)))],
                effect: Effect {
                    name: "cliff-delta",
                    value: delta.estimate,
                    interval: delta.interval,
                    standardised: None,
                },
            }
        }
        Test::BrownForsythe => {
            measures()?;
            varies(&[a, b])?;
            let (a, b) = (from_median(a), from_median(b));
            let found = student(a.summary, b.summary);
            Found {
                tails: found.tails,
                difference: found.difference,
                sides: bench.terms.sides,
                statistics: vec![("t", found.t), ("df", found.df)],
                effect: Effect {
                    name: "difference-of-distances-from-the-median",
                    ..mean_effect(&a, &b, found.interval(bench.confidence()))
                },
            }
        }
        Test::CochranArmitage | Test::Spearman => return Err(wrong()),
    })
}

/// The runs of a cell as distances from its median.
fn from_median(group: &Group) -> Group {
    let centre = median(&group.values);
    let values: Vec<f64> = group.values.iter().map(|x| (x - centre).abs()).collect();
    Group { summary: Summary::of(&values), values, ..group.clone() }
}

pub(super) fn share_effect(a: Proportion, b: Proportion, confidence: f64) -> Effect {
    let value = risk_difference(a, b);
    let interval = newcombe(a, b, confidence);
    Effect { name: "risk-difference", value, interval, standardised: None }
}

pub(super) fn mean_effect(a: &Group, b: &Group, interval: Interval) -> Effect {
    let value = a.summary.mean - b.summary.mean;
    let standardised = Some(("hedges-g", hedges_g(a.summary, b.summary)));
    Effect { name: "mean-difference", value, interval, standardised }
}

pub(super) fn trend(bench: &Bench<'_>, form: &Trend) -> Vec<Draft> {
    let scores: Vec<f64> = form.along.iter().map(|step| step.score).collect();
    let side = match form.direction {
        Direction::Rising => Side::Greater,
        Direction::Falling => Side::Less,
    };
    let word = if side == Side::Greater { "rises" } else { "falls" };
    let mut drafts = Vec::new();
    for name in &form.metric.0 {
        let metric = Metric::named(name);
        for pins in form.for_each.combinations() {
            let base = form.r#where.pinned(&pins);
            let cells: Vec<Where> = form.along.iter().map(|s| base.replaced(&s.r#where)).collect();
            let about = format!("{metric}: {word} along {} steps in ({base})", cells.len());
            let test = bench.terms.test.unwrap_or(if metric.is_share() {
                Test::CochranArmitage
            } else {
                Test::Spearman
            });
            let gathered = bench.gather(&cells, &metric);
            let evidence = gathered
                .groups
                .and_then(|groups| trend_evidence(bench, &about, test, &groups, &scores, side));
            drafts.push(Draft {
                about,
                test: test.name(),
                cells: gathered.numbers,
                conditions: gathered.conditions,
                evidence,
                notes: gathered.notes,
            });
        }
    }
    drafts
}

fn trend_evidence(
    bench: &Bench<'_>,
    about: &str,
    test: Test,
    groups: &[Group],
    scores: &[f64],
    side: Side,
) -> Result<Evidence, String> {
    if groups.len() < 2 {
        return Err("a trend needs two steps or more".to_owned());
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
                return Err("no value varies, so nothing can rise or fall".to_owned());
            }
            let mut stream = bench.stream(about);
            let tails = spearman_permutation(&x, &y, bench.context.permutations, &mut stream);
            let (p_for, p_against) = directed(tails, rho, side, sides);
            let interval = spearman_interval(rho, x.len() as u64, bench.confidence());
            let effect = Effect { name: "spearman", value: rho, interval, standardised: None };
            Ok(Evidence { p_for, p_against, statistics: Vec::new(), effect: Some(effect) })
        }
        _ => Err(format!("{} does not apply to this metric", test.name())),
    }
}
