//! Agreement of two sets of cell means: ours, and those a paper prints with its spread and runs.

use super::distribution::student_t_quantile;
use super::summary::{Summary, mean, sample_sd};
use super::{Interval, length, real};

/// A least squares line with the spread that leaving out one block at a time gives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Rise of y per unit of x; NaN where x does not vary.
    pub slope: f64,
    /// y where x is 0; NaN where x does not vary.
    pub intercept: f64,
    /// Intervals of slope and intercept; `None` with fewer than three blocks, or where one of them leaves no line.
    pub intervals: Option<(Interval, Interval)>,
}

/// Fits the line through the points (x, y) with intervals by the jackknife over `blocks`, lists of indices into
/// `points` that cover each of them once (Quenouille 1956, Tukey 1958; t with one degree of freedom less than blocks).
///
/// Points of one block may depend on each other in any way: a block counts as one observation.
pub fn line(points: &[(f64, f64)], blocks: &[Vec<usize>], confidence: f64) -> Line {
    let (slope, intercept) = least_squares(points.iter().copied());
    let without: Vec<(f64, f64)> = blocks
        .iter()
        .map(|block| {
            let rest = points.iter().enumerate().filter(|(i, _)| !block.contains(i));
            least_squares(rest.map(|(_, point)| *point))
        })
        .collect();
    let count = length(blocks);
    let interval = |whole: f64, parts: &[f64]| {
        let variance = (count - 1.0) * (count - 1.0) / count * sample_sd(parts) * sample_sd(parts);
        let half =
            student_t_quantile(0.5 + 0.5 * confidence, count - 1.0) * variance.max(0.0).sqrt();
        half.is_finite().then_some(Interval { low: whole - half, high: whole + half, confidence })
    };
    let (slopes, intercepts): (Vec<f64>, Vec<f64>) = without.into_iter().unzip();
    let intervals = if blocks.len() < 3 || !slopes.iter().all(|slope| slope.is_finite()) {
        None
    } else {
        interval(slope, &slopes).zip(interval(intercept, &intercepts))
    };
    Line { slope, intercept, intervals }
}

fn least_squares(points: impl Iterator<Item = (f64, f64)>) -> (f64, f64) {
    let (x, y): (Vec<f64>, Vec<f64>) = points.unzip();
    let (mx, my) = (mean(&x), mean(&y));
    let xy: f64 = x.iter().zip(&y).map(|(a, b)| (a - mx) * (b - my)).sum();
    let xx: f64 = x.iter().map(|a| (a - mx) * (a - mx)).sum();
    let slope = if xx > 0.0 { xy / xx } else { f64::NAN };
    (slope, my - slope * mx)
}

/// Computes the standard deviation of the difference between a printed mean and that of an exact replicate of `runs`
/// runs.
pub fn replicate_sd(printed: Summary, runs: u64) -> f64 {
    printed.sd * (1.0 / real(printed.n) + 1.0 / real(runs)).sqrt()
}

/// Computes half the width of the interval around a printed mean in which the mean of `runs` runs of an exact replicate
/// lies with `confidence`: t(n - 1) sd √(1/n + 1/runs). The spread is the paper's alone, so that no agreement can be
/// won by a spread of one's own.
pub fn prediction_half_width(printed: Summary, runs: u64, confidence: f64) -> f64 {
    student_t_quantile(0.5 + 0.5 * confidence, real(printed.n) - 1.0) * replicate_sd(printed, runs)
}

/// Computes the same for the log of a ratio of two printed means, by the delta method, with Satterthwaite's degrees of
/// freedom; means are positive. Each comes with the runs of its replicate.
pub fn log_ratio_half_width(above: (Summary, u64), below: (Summary, u64), confidence: f64) -> f64 {
    let relative = |(printed, runs): (Summary, u64)| {
        let sd = replicate_sd(printed, runs) / printed.mean;
        sd * sd
    };
    let (a, b) = (relative(above), relative(below));
    if a + b == 0.0 {
        return 0.0;
    }
    let (sa, sb) = (a / (a + b), b / (a + b));
    let df = 1.0 / (sa * sa / (real(above.0.n) - 1.0) + sb * sb / (real(below.0.n) - 1.0));
    student_t_quantile(0.5 + 0.5 * confidence, df) * (a + b).sqrt()
}

/// Computes by how much the mean square error of a prediction is below that of the best constant, the mean of the
/// truth: 1 for a perfect one, 0 for the constant, negative for worse; NaN where nothing varies.
pub fn skill_over_constant(predicted: &[f64], truth: &[f64]) -> f64 {
    let constant = mean(truth);
    let squares = |guess: &dyn Fn(usize) -> f64| -> f64 {
        truth.iter().enumerate().map(|(i, t)| (guess(i) - t) * (guess(i) - t)).sum()
    };
    let of_constant = squares(&|_| constant);
    if of_constant > 0.0 { 1.0 - squares(&|i| predicted[i]) / of_constant } else { f64::NAN }
}

/// Computes the root mean square difference; NaN for no values.
pub fn rmse(a: &[f64], b: &[f64]) -> f64 {
    let squares: Vec<f64> = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).collect();
    mean(&squares).sqrt()
}

#[cfg(test)]
mod tests {
    use super::super::assert_close;
    use super::*;

    #[test]
    fn a_line_is_found_with_its_jackknife_interval() {
        // Least squares and the six slopes without one point each, by hand; t quantile 2.570581836614740 at 5 df.
        let y = [0.1, 0.9, 2.2, 2.8, 4.1, 5.2];
        let points: Vec<(f64, f64)> =
            (0..6_u8).map(|x| (f64::from(x), y[usize::from(x)])).collect();
        let singles: Vec<Vec<usize>> = (0..6).map(|i| vec![i]).collect();
        let found = line(&points, &singles, 0.95);
        assert_close(found.slope, 1.02, 1e-12);
        assert!(found.intercept.abs() < 1e-12);
        let (slope, _) = found.intervals.unwrap();
        assert_close(slope.low, SLOPE_LOW, 1e-9);
        assert_close(slope.high, SLOPE_HIGH, 1e-9);
    }

    const SLOPE_LOW: f64 = 0.911_664_110_492_322_3;
    const SLOPE_HIGH: f64 = 1.128_335_889_507_677_6;

    #[test]
    fn two_blocks_have_no_interval_and_equal_x_no_line() {
        let points = [(0.0, 1.0), (1.0, 2.0), (2.0, 2.5), (3.0, 4.0)];
        assert_eq!(line(&points, &[vec![0, 1], vec![2, 3]], 0.95).intervals, None);
        let upright = [(1.0, 1.0), (1.0, 2.0), (1.0, 3.0)];
        let found = line(&upright, &[vec![0], vec![1], vec![2]], 0.95);
        assert!(found.slope.is_nan() && found.intervals.is_none());
    }

    /// Checks that a block counts once, however often its points are listed.
    #[test]
    fn telling_the_points_of_a_block_twice_narrows_nothing() {
        let y = [0.2, 0.7, 2.4, 2.9, 3.8, 5.1];
        let points: Vec<(f64, f64)> =
            (0..6_u8).map(|x| (f64::from(x), y[usize::from(x)])).collect();
        let once: Vec<Vec<usize>> = (0..6).map(|i| vec![i]).collect();
        let twice: Vec<(f64, f64)> = points.iter().chain(&points).copied().collect();
        let blocks: Vec<Vec<usize>> = (0..6).map(|i| vec![i, i + 6]).collect();
        let (a, b) = (line(&points, &once, 0.9), line(&twice, &blocks, 0.9));
        let width = |l: Line| l.intervals.map_or(f64::NAN, |(s, _)| s.high - s.low);
        assert_close(width(a), width(b), 1e-9);
    }

    #[test]
    fn prediction_intervals_use_the_papers_spread() {
        let printed = Summary { n: 10, mean: 20.0, sd: 3.0 };
        // t quantile 2.262157162798205 at 9 df, times 3 sqrt(1/10 + 1/30)
        assert_close(prediction_half_width(printed, 30, 0.95), 2.478_069_013_372_927, 1e-6);
        let exact = Summary { sd: 0.0, ..printed };
        // With an exact base the ratio is as uncertain as its numerator: 15 % of sd.
        let ratio = log_ratio_half_width((printed, 30), (exact, 30), 0.95);
        assert_close(ratio, prediction_half_width(printed, 30, 0.95) / 20.0, 1e-9);
        assert_eq!(log_ratio_half_width((exact, 30), (exact, 30), 0.95), 0.0);
    }

    #[test]
    fn skill_is_one_for_the_truth_and_zero_for_its_mean() {
        let truth = [1.0, 2.0, 4.0];
        assert_eq!(skill_over_constant(&truth, &truth), 1.0);
        assert_close(skill_over_constant(&[7.0 / 3.0; 3], &truth) + 1.0, 1.0, 1e-12);
        assert!(skill_over_constant(&[4.0, 2.0, 1.0], &truth) < 0.0);
        assert!(skill_over_constant(&[1.0], &[2.0]).is_nan());
        assert_close(rmse(&[1.0, 2.0], &[2.0, 4.0]), 2.5_f64.sqrt(), 1e-12);
    }
}
