//! What of the differences between two sets of cell means neither side's sampling explains.

use super::Interval;
use super::summary::sorted_quantile;
use crate::rng::Stream;

/// One cell on both sides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// The arm of the experiment that it belongs to: cells of one arm are of the same runs.
    pub arm: usize,
    /// Log of our mean over theirs.
    pub log_ratio: f64,
    /// Variance of that log which the sampling of both sides accounts for.
    pub variance: f64,
}

/// What is left of the differences of one set of cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unexplained {
    /// tau: the root of the mean square log ratio less the mean variance by sampling, 0 where sampling explains all. Of small
    /// numbers, the relative error of a cell.
    pub tau: f64,
    /// Its percentile interval over resampled arms; `None` with fewer than three arms.
    pub interval: Option<Interval>,
    /// In what share of the resamples this set leaves the least of all sets: how sure it is that it is the nearest.
    pub nearest: f64,
}

/// Sums over the cells of one arm.
#[derive(Debug, Clone, Copy, Default)]
struct Arm {
    excess: f64,
    cells: f64,
}

/// Computes what each of `sets` leaves unexplained. They share their arms, of which the same are drawn for all of them in each
/// of `resamples` resamples (a bootstrap by clusters, paired over the sets).
pub fn unexplained(
    sets: &[Vec<Difference>],
    resamples: u32,
    confidence: f64,
    stream: &mut Stream,
) -> Vec<Unexplained> {
    let arms = sets.iter().flatten().map(|cell| cell.arm + 1).max().unwrap_or(0);
    let sums: Vec<Vec<Arm>> = sets.iter().map(|set| by_arm(set, arms)).collect();
    let mut taus: Vec<Vec<f64>> = vec![Vec::new(); sets.len()];
    let mut nearest = vec![0_u32; sets.len()];
    let mut drawn = vec![0_usize; arms];
    for _ in 0..resamples {
        for arm in &mut drawn {
            #[expect(clippy::cast_possible_truncation, reason = "an index below the length")]
            let index = stream.below(arms as u64) as usize;
            *arm = index;
        }
        let left: Vec<f64> =
            sums.iter().map(|arms| excess(drawn.iter().map(|&i| arms[i]))).collect();
        let least = left.iter().copied().filter(|x| x.is_finite()).fold(f64::INFINITY, f64::min);
        for (i, &left) in left.iter().enumerate().filter(|(_, left)| left.is_finite()) {
            taus[i].push(left.max(0.0).sqrt());
            nearest[i] += u32::from(left <= least);
        }
    }
    let tail = (1.0 - confidence) / 2.0;
    let of_set = |(i, arms): (usize, &Vec<Arm>)| {
        let mut found = std::mem::take(&mut taus[i]);
        found.sort_by(f64::total_cmp);
        let enough = arms.iter().filter(|arm| arm.cells > 0.0).count() >= 3;
        let interval = enough.then(|| Interval {
            low: sorted_quantile(&found, tail),
            high: sorted_quantile(&found, 1.0 - tail),
            confidence,
        });
        Unexplained {
            tau: excess(arms.iter().copied()).max(0.0).sqrt(),
            interval,
            nearest: f64::from(nearest[i]) / f64::from(resamples.max(1)),
        }
    };
    sums.iter().enumerate().map(of_set).collect()
}

fn by_arm(set: &[Difference], arms: usize) -> Vec<Arm> {
    let mut sums = vec![Arm::default(); arms];
    for cell in set {
        let arm = &mut sums[cell.arm];
        arm.excess += cell.log_ratio * cell.log_ratio - cell.variance;
        arm.cells += 1.0;
    }
    sums
}

/// Returns the mean, over the cells of `arms`, of the square log ratio less the variance by sampling; NaN for no cells.
fn excess(arms: impl Iterator<Item = Arm>) -> f64 {
    let (excess, cells) =
        arms.fold((0.0, 0.0), |(excess, cells), arm| (excess + arm.excess, cells + arm.cells));
    excess / cells
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Seeds;
    use crate::stats::assert_close;

    fn stream() -> Stream {
        Seeds::new(1, Vec::new()).stream("test")
    }

    /// Returns 40 arms of four cells, each off by `error` of its own and 5 % of noise that sampling accounts for.
    fn cells(error: f64) -> Vec<Difference> {
        let mut stream = Seeds::new(7, Vec::new()).stream("cells");
        let cell = |i: usize| Difference {
            arm: i / 4,
            log_ratio: error * stream.normal() + 0.05 * stream.normal(),
            variance: 0.0025,
        };
        (0..160).map(cell).collect()
    }

    #[test]
    fn what_sampling_accounts_for_is_taken_out() {
        let found = unexplained(&[cells(0.2), cells(0.0)], 500, 0.95, &mut stream());
        let wide = found[0].interval.unwrap();
        assert!((found[0].tau - 0.2).abs() < 0.03, "{:?}", found[0]);
        assert!(wide.low < 0.2 && 0.2 < wide.high && wide.high - wide.low < 0.1, "{wide:?}");
        assert!(found[1].tau < 0.03, "{:?}", found[1]);
        assert_eq!((found[0].nearest, found[1].nearest), (0.0, 1.0));
    }

    #[test]
    fn a_set_by_hand_has_its_own_tau() {
        let cell = |arm, log_ratio| Difference { arm, log_ratio, variance: 0.01 };
        // (0.04 + 0.09 + 0.01) / 3 - 0.01
        let found = unexplained(
            &[vec![cell(0, 0.2), cell(0, -0.3), cell(1, 0.1)]],
            100,
            0.95,
            &mut stream(),
        );
        assert_close(found[0].tau, (0.14_f64 / 3.0 - 0.01).sqrt(), 1e-12);
        assert_eq!((found[0].interval, found[0].nearest), (None, 1.0), "two arms are too few");
        let nothing = unexplained(&[Vec::new()], 10, 0.95, &mut stream());
        assert_eq!((nothing[0].tau, nothing[0].nearest), (0.0, 0.0));
    }
}
