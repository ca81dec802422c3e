//! Points of the prior, round by round: the first round is spread evenly, each later one lies by halves there again and near the
//! points that explained the table so far. What is inferred rests on the last round alone, each of whose points is weighed by how
//! likely it was to be drawn: the rounds before only say where to look, as points that shaped the density which they are weighed
//! by would be too light (population Monte Carlo, Cappé et al. 2004, with a defensive half, Hesterberg 1995).

use crate::rng::Stream;
use crate::stats::{importance as draws, length};
use crate::studies::inference::stratified;

/// Points that share their pace, for which walks are timed: as shares of the prior, 0 to 1.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Group {
    pub(super) pace: Vec<f64>,
    /// Of each point, what costs less to suppose.
    pub(super) others: Vec<Vec<f64>>,
}

/// A round that was drawn near some points.
#[derive(Debug)]
pub(super) struct Near {
    /// Weights of the points, by group, which add up to 1.
    weights: Vec<Vec<f64>>,
    groups: Vec<Group>,
    /// Half the width of the box about a point, by dimension of the pace and of the others.
    pace: Vec<f64>,
    others: Vec<f64>,
}

impl Near {
    /// Creates the round that is drawn near `groups` by the `weights` of their points; `None` where none has any.
    pub(super) fn of(groups: &[Group], weights: &[Vec<f64>]) -> Option<Self> {
        let sum: f64 = weights.iter().flatten().sum();
        if sum.is_nan() || sum <= 0.0 {
            return None;
        }
        let weights: Vec<Vec<f64>> =
            weights.iter().map(|own| own.iter().map(|weight| weight / sum).collect()).collect();
        let first = groups.first()?;
        let points = || {
            let each = groups.iter().zip(&weights);
            each.flat_map(|(group, own)| {
                group.others.iter().zip(own).map(move |(other, weight)| (group, other, *weight))
            })
        };
        let (timings, all) = (length(groups), length(&weights.concat()));
        // Widths follow the scatter of what explained the table, and are never less than a stratum of the first round.
        let width = |value: &dyn Fn(&Group, &Vec<f64>) -> f64, strata: f64| {
            let mean: f64 = points().map(|(g, o, weight)| weight * value(g, o)).sum();
            let square = |off: f64| off * off;
            let variance: f64 =
                points().map(|(g, o, weight)| weight * square(value(g, o) - mean)).sum();
            variance.sqrt().clamp(0.5 / strata, 0.5)
        };
        Some(Self {
            pace: (0..first.pace.len()).map(|d| width(&|g, _| g.pace[d], timings)).collect(),
            others: (0..first.others.first()?.len()).map(|d| width(&|_, o| o[d], all)).collect(),
            weights,
            groups: groups.to_vec(),
        })
    }

    /// Draws a group of `count` points.
    pub(super) fn draw(&self, count: usize, stream: &mut Stream) -> Group {
        let of_groups: Vec<f64> = self.weights.iter().map(|own| own.iter().sum()).collect();
        let group = draws::draw(&of_groups, stream).unwrap_or_default();
        let pace = moved(&self.groups[group].pace, &self.pace, stream);
        // Given the pace, other points are as likely as theirs is near.
        let each: Vec<(f64, &Vec<f64>)> = self
            .groups
            .iter()
            .zip(&self.weights)
            .flat_map(|(group, own)| {
                let near = density(&pace, &group.pace, &self.pace);
                own.iter().zip(&group.others).map(move |(weight, other)| (near * weight, other))
            })
            .collect();
        let likely: Vec<f64> = each.iter().map(|(weight, _)| *weight).collect();
        let others = (0..count)
            .map(|_| {
                let near = draws::draw(&likely, stream).unwrap_or_default();
                moved(each[near].1, &self.others, stream)
            })
            .collect();
        Group { pace, others }
    }

    /// Returns how much more likely than by the prior this round was to draw a point.
    pub(super) fn density(&self, pace: &[f64], other: &[f64]) -> f64 {
        let each = self.groups.iter().zip(&self.weights).map(|(group, own)| {
            let near = density(pace, &group.pace, &self.pace);
            if near == 0.0 {
                return 0.0;
            }
            let others = own.iter().zip(&group.others);
            near * others.map(|(w, o)| w * density(other, o, &self.others)).sum::<f64>()
        });
        each.sum()
    }
}

/// Returns how much less likely than by the prior a point of a round was drawn of which half lies `near`; 1 where all of it was drawn
/// by the prior.
pub(super) fn importance(near: Option<&Near>, pace: &[f64], other: &[f64]) -> f64 {
    near.map_or(1.0, |near| 2.0 / (1.0 + near.density(pace, other)))
}

/// Draws a round of `timings` groups of `count` points, by halves evenly and `near` where the table was explained.
pub(super) fn round(
    near: Option<&Near>,
    (paces, others): (usize, usize),
    (timings, count): (usize, usize),
    stream: &mut Stream,
) -> Vec<Group> {
    let evenly = if near.is_some() { timings.div_ceil(2) } else { timings };
    let spread = stratified(paces, evenly, stream);
    let points = stratified(others, evenly * count, stream);
    let even = spread.into_iter().zip(points.chunks(count));
    let mut groups: Vec<Group> =
        even.map(|(pace, others)| Group { pace, others: others.to_vec() }).collect();
    if let Some(near) = near {
        groups.extend((evenly..timings).map(|_| near.draw(count, stream)));
    }
    groups
}

/// Moves `center` anywhere within a box of half the widths `half`, thrown back at the ends of the prior.
fn moved(center: &[f64], half: &[f64], stream: &mut Stream) -> Vec<f64> {
    let each = center.iter().zip(half).map(|(center, half)| {
        let to = center + half * (2.0 * stream.uniform() - 1.0);
        let to = if to < 0.0 { -to } else { to };
        if to > 1.0 { 2.0 - to } else { to }
    });
    each.collect()
}

/// Returns the density at `at` of what [`moved`] makes of `center`.
fn density(at: &[f64], center: &[f64], half: &[f64]) -> f64 {
    let one = |((at, center), half): ((&f64, &f64), &f64)| {
        let from = [*at, -at, 2.0 - at];
        let hits = from.iter().filter(|from| (*from - center).abs() <= *half).count();
        crate::stats::real(hits as u64) / (2.0 * half)
    };
    at.iter().zip(center).zip(half).map(one).product()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Seeds;

    #[test]
    fn a_density_adds_up_to_one_at_the_ends_too() {
        for center in [0.0, 0.03, 0.5, 0.98] {
            let steps = 2000;
            let sum: f64 = (0..steps)
                .map(|i| (f64::from(i) + 0.5) / f64::from(steps))
                .map(|at| density(&[at], &[center], &[0.1]))
                .sum();
            assert!((sum / f64::from(steps) - 1.0).abs() < 0.01, "{center}: {sum}");
        }
    }

    #[test]
    fn later_rounds_find_a_peak_and_do_not_change_its_mean() {
        let mut stream = Seeds::new(8, Vec::new()).stream("rounds");
        // A peak whose integral over the prior is 1.
        let (pace_at, other_at, half) = (0.31, 0.93, 0.05);
        let likelihood = |pace: &[f64], other: &[f64]| {
            let near = (pace[0] - pace_at).abs() < half && (other[0] - other_at).abs() < half;
            if near { 100.0 } else { 0.0 }
        };
        let explained = |groups: &[Group], near: Option<&Near>| -> Vec<Vec<f64>> {
            let of = |group: &Group| {
                let each = group.others.iter();
                let pace = &group.pace;
                each.map(|o| importance(near, pace, o) * likelihood(pace, o)).collect()
            };
            groups.iter().map(of).collect()
        };
        let (mut sum, mut hits, runs) = (0.0, 0, 400);
        for _ in 0..runs {
            let first = round(None, (1, 1), (12, 8), &mut stream);
            let near = Near::of(&first, &explained(&first, None));
            let last = round(near.as_ref(), (1, 1), (12, 8), &mut stream);
            let weights = explained(&last, near.as_ref()).concat();
            hits += weights.iter().filter(|weight| **weight > 0.0).count();
            sum += weights.iter().sum::<f64>() / length(&weights);
        }
        let mean = sum / f64::from(runs);
        assert!((mean - 1.0).abs() < 0.1, "{mean}");
        // By the prior alone one point in a hundred would hit it.
        assert!(hits > 4 * 96 * 400 / 100, "{hits}");
    }
}
