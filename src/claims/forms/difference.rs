//! The difference of two cells, by every test there is of one.

use crate::claims::cannot_test::CannotTest;
use crate::claims::cells::Where;
use crate::claims::gather::{Bench, Draft, Evidence, Group, varies};
use crate::claims::metric::Metric;
use crate::claims::terms::{Side, Sides, Terms, Test};
use crate::claims::verdict::{EffectSize, FIRST_N, FIRST_N_HEDGES_G, FIRST_N_P};
use crate::stats::bootstrap::bootstrap;
use crate::stats::effect::{cliff_delta, hedges_g, risk_difference};
use crate::stats::means::{TTest, anova, student, welch};
use crate::stats::proportion::{Proportion, chi_square_homogeneity, fisher_exact, newcombe};
use crate::stats::rank::mann_whitney;
use crate::stats::summary::{Summary, median};
use crate::stats::{Interval, Tails, real};

pub(super) fn compare(bench: &Bench<'_>, metric: &Metric, cells: &[Where; 2], side: Side) -> Draft {
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

/// Returns what the first `n` trials of each condition would have said: as many as the paper ran. Decides nothing.
fn of_the_first(
    bench: &Bench<'_>,
    metric: &Metric,
    cells: &[Where; 2],
    test: Test,
    side: Side,
    n: u64,
) -> Result<Vec<(&'static str, f64)>, CannotTest> {
    let first = bench.observations.first(n);
    let terms = Terms { minimum_runs: 2, also_at_n: None, ..bench.terms };
    let bench = Bench { observations: &first, terms, ..*bench };
    let groups = bench.gather(cells, metric).groups?;
    let found = evidence(&bench, "first trials", test, &groups[0], &groups[1])?;
    let (p, _) = directed(found.tails, found.difference, side, found.sides);
    let mut beside = vec![(FIRST_N, real(n)), (FIRST_N_P, p)];
    beside.extend(found.effect.hedges_g.map(|g| (FIRST_N_HEDGES_G, g)));
    Ok(beside)
}

/// Returns the p-values for a difference on the side claimed and on the other.
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
    effect: EffectSize,
}

fn evidence(
    bench: &Bench<'_>,
    about: &str,
    test: Test,
    a: &Group,
    b: &Group,
) -> Result<Found, CannotTest> {
    let wrong = || CannotTest::OtherMetric(test.name());
    let both = |p: f64| Tails { less: f64::NAN, greater: f64::NAN, two_sided: p };
    let shares = || a.proportion.zip(b.proportion).ok_or_else(wrong);
    let measures = || if a.proportion.is_some() { Err(wrong()) } else { Ok(()) };
    let of_t = |found: TTest, effect: EffectSize| Found {
        tails: found.tails,
        difference: found.difference,
        sides: bench.terms.sides,
        statistics: vec![("t", found.t), ("df", found.df)],
        effect,
    };
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
            let effect = mean_effect(a, b, found.interval(bench.confidence()));
            of_t(found, effect)
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
                effect: EffectSize::new("cliff-delta", delta.estimate, delta.interval),
            }
        }
        Test::BrownForsythe => {
            measures()?;
            varies(&[a, b])?;
            let (a, b) = (from_median(a), from_median(b));
            let found = student(a.summary, b.summary);
            let effect = EffectSize {
                name: "difference-of-distances-from-the-median".into(),
                ..mean_effect(&a, &b, found.interval(bench.confidence()))
            };
            of_t(found, effect)
        }
        Test::CochranArmitage | Test::Spearman => return Err(wrong()),
    })
}

/// Returns the runs of a cell as distances from its median.
fn from_median(group: &Group) -> Group {
    let centre = median(&group.values);
    let values: Vec<f64> = group.values.iter().map(|x| (x - centre).abs()).collect();
    Group { summary: Summary::of(&values), values, ..group.clone() }
}

pub(super) fn share_effect(a: Proportion, b: Proportion, confidence: f64) -> EffectSize {
    let value = risk_difference(a, b);
    let interval = newcombe(a, b, confidence);
    EffectSize::new("risk-difference", value, interval)
}

pub(super) fn mean_effect(a: &Group, b: &Group, interval: Interval) -> EffectSize {
    let value = a.summary.mean - b.summary.mean;
    let hedges_g = Some(hedges_g(a.summary, b.summary));
    EffectSize { hedges_g, ..EffectSize::new("mean-difference", value, interval) }
}
