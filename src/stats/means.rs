//! Means of groups, from values or from the mean, standard deviation and number a paper prints.

use super::distribution::{f_sf, student_t_quantile, student_t_sf, student_t_two_sided};
use super::summary::Summary;
use super::{Interval, Tails, real};

/// Student's t statistic of a difference of two means.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TTest {
    /// Difference of the means in standard errors; infinite where neither group varies.
    pub t: f64,
    /// Degrees of freedom.
    pub df: f64,
    /// Difference of the means, first less second.
    pub difference: f64,
    /// Standard error of the difference.
    pub standard_error: f64,
    /// p-values; "less" means that the first mean is the lower.
    pub tails: Tails,
}

impl TTest {
    /// Computes the test of `difference` against `shift`.
    fn new(difference: f64, standard_error: f64, df: f64, shift: f64) -> Self {
        let t = if difference == shift { 0.0 } else { (difference - shift) / standard_error };
        let tails = Tails {
            less: student_t_sf(-t, df),
            greater: student_t_sf(t, df),
            two_sided: student_t_two_sided(t, df),
        };
        Self { t, df, difference, standard_error, tails }
    }

    /// Computes the interval of the difference.
    pub fn interval(&self, confidence: f64) -> Interval {
        let half = student_t_quantile(0.5 + 0.5 * confidence, self.df) * self.standard_error;
        Interval { low: self.difference - half, high: self.difference + half, confidence }
    }
}

/// Computes Welch's t test of two means with unequal variances (Welch 1947, df by Satterthwaite 1946).
///
/// Each group has at least two values. Where neither group varies the df is that of equal variances.
pub fn welch(a: Summary, b: Summary) -> TTest {
    welch_shifted(a, b, 0.0)
}

/// Computes [`welch`] against a difference of `shift` instead of zero.
pub fn welch_shifted(a: Summary, b: Summary, shift: f64) -> TTest {
    let (va, vb) = (a.variance_of_mean(), b.variance_of_mean());
    let (na, nb) = (real(a.n), real(b.n));
    let variance = va + vb;
    let df = if variance > 0.0 {
        // Shares of the variance first: squares of the variances themselves would underflow.
        let (sa, sb) = (va / variance, vb / variance);
        1.0 / (sa * sa / (na - 1.0) + sb * sb / (nb - 1.0))
    } else {
        na + nb - 2.0
    };
    TTest::new(a.mean - b.mean, variance.sqrt(), df, shift)
}

/// Computes Welch's test of matched groups: the difference, first less second, is the mean of each pair's own, so that
/// what moves both groups of a pair alike is no part of it; the variance of either side is that within its groups,
/// pooled over pairs. One pair gives [`welch`].
///
/// Each group has at least one value. `None` where a side has no group of two, which leaves its variance unknown.
pub fn welch_matched(pairs: &[(Summary, Summary)]) -> Option<TTest> {
    let count = real(pairs.len() as u64);
    let (firsts, seconds): (Vec<Summary>, Vec<Summary>) = pairs.iter().copied().unzip();
    // Variance of the mean of one side's means, and its degrees of freedom.
    let side = |groups: &[Summary]| {
        let df: f64 = groups.iter().map(|g| real(g.n) - 1.0).sum();
        let squares: f64 =
            groups.iter().filter(|g| g.n > 1).map(|g| (real(g.n) - 1.0) * g.sd * g.sd).sum();
        let weight: f64 = groups.iter().map(|g| 1.0 / real(g.n)).sum();
        (df > 0.0).then(|| (squares / df * weight / (count * count), df))
    };
    let ((va, da), (vb, db)) = (side(&firsts)?, side(&seconds)?);
    let variance = va + vb;
    let df = if variance > 0.0 {
        let (sa, sb) = (va / variance, vb / variance);
        1.0 / (sa * sa / da + sb * sb / db)
    } else {
        da + db
    };
    let difference = pairs.iter().map(|(a, b)| a.mean - b.mean).sum::<f64>() / count;
    Some(TTest::new(difference, variance.sqrt(), df, 0.0))
}

/// Computes Student's t test of two means with one common variance: the square root of two-group ANOVA.
pub fn student(a: Summary, b: Summary) -> TTest {
    let (na, nb) = (real(a.n), real(b.n));
    let df = na + nb - 2.0;
    let pooled = ((na - 1.0) * a.sd * a.sd + (nb - 1.0) * b.sd * b.sd) / df;
    TTest::new(a.mean - b.mean, (pooled * (1.0 / na + 1.0 / nb)).sqrt(), df, 0.0)
}

/// Computes the interval of one mean by Student's t.
pub fn mean_interval(a: Summary, confidence: f64) -> Interval {
    let half =
        student_t_quantile(0.5 + 0.5 * confidence, real(a.n) - 1.0) * a.variance_of_mean().sqrt();
    Interval { low: a.mean - half, high: a.mean + half, confidence }
}

/// One-way analysis of variance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Anova {
    /// Mean square between groups over mean square within; infinite where no group varies.
    pub f: f64,
    /// Degrees of freedom between groups.
    pub df_between: f64,
    /// Degrees of freedom within groups.
    pub df_within: f64,
    /// Upper tail.
    pub p: f64,
}

/// Computes a one-way analysis of variance (Fisher 1925) from group summaries, each of at least two values.
pub fn anova(groups: &[Summary]) -> Anova {
    let all: u64 = groups.iter().map(|g| g.n).sum();
    let df_between = super::length(groups) - 1.0;
    let df_within = real(all) - super::length(groups);
    let grand = groups.iter().map(|g| real(g.n) * g.mean).sum::<f64>() / real(all);
    let between: f64 = groups.iter().map(|g| real(g.n) * (g.mean - grand) * (g.mean - grand)).sum();
    let within: f64 = groups.iter().map(|g| (real(g.n) - 1.0) * g.sd * g.sd).sum();
    let f = if between == 0.0 { 0.0 } else { (between / df_between) / (within / df_within) };
    Anova { f, df_between, df_within, p: f_sf(f, df_between, df_within) }
}
