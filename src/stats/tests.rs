//! Tests and intervals against scipy 1.17.1 and statsmodels 0.15.0; the call is in the comment.

use super::effect::*;
use super::equivalence::*;
use super::means::*;
use super::proportion::*;
use super::rank::*;
use super::summary::*;
use super::{
    Tails, assert_close,
    bootstrap::{bootstrap, bootstrap_shares},
    multiple::holm,
};
use crate::rng::Seeds;
use proptest::prelude::*;

mod distributions;

/// Far tighter than the 1e-9 that verdicts need.
const FINE: f64 = 1e-12;
/// Where the reference itself (scipy's own tails) is good to about this.
const COARSE: f64 = 1e-9;

fn tails(found: Tails, less: f64, greater: f64, two_sided: f64) {
    assert_close(found.less, less, COARSE);
    assert_close(found.greater, greater, COARSE);
    assert_close(found.two_sided, two_sided, COARSE);
}

#[test]
fn tests_on_proportions() {
    // scipy.stats.fisher_exact([[k1, n1 - k1], [k2, n2 - k2]], alternative)
    for (k1, n1, k2, n2, less, greater, two_sided) in [
        (
            48,
            50,
            28,
            50,
            0.999_999_930_759_801_2,
            1.432_036_286_782_239e-6,
            2.864_072_573_564_478_6e-6,
        ),
        (14, 200, 95, 200, 3.587_812_780_682_052_4e-21, 1.0, 7.175_625_561_364_101e-21),
        (13, 50, 17, 50, 0.256_547_216_683_763_1, 0.862_423_426_404_853_5, 0.513_094_433_367_526_2),
        (0, 10, 0, 10, 1.0, 1.0, 1.0),
        (5, 5, 0, 7, 1.0, 0.001_262_626_262_626_262_7, 0.001_262_626_262_626_262_3),
        (
            3,
            40,
            9,
            30,
            0.015_702_885_845_659_063,
            0.997_583_705_901_797_8,
            0.022_746_935_374_471_196,
        ),
    ] {
        let found = fisher_exact(Proportion::new(k1, n1), Proportion::new(k2, n2));
        tails(found, less, greater, two_sided);
    }
    // scipy.stats.chi2_contingency(table, correction=False)
    let at_a: Vec<_> = [13, 17, 15, 13, 15].map(|k| Proportion::new(k, 50)).to_vec();
    let found = chi_square_homogeneity(&at_a);
    assert_close(found.statistic, 1.083_507_468_462_193_3, COARSE);
    assert_close(found.p, 0.896_880_024_991_800_1, COARSE);
    assert_eq!(found.df, 4.0);
    let none = [Proportion::new(0, 50), Proportion::new(0, 20)];
    assert_eq!(chi_square_homogeneity(&none).p, 1.0);
    // z = sqrt(N) * scipy.stats.pearsonr(score, success)[0], p by scipy.stats.norm.sf
    let totals: Vec<_> = [385, 374, 351, 198].map(|k| Proportion::new(k, 750)).to_vec();
    let found = cochran_armitage(&totals, &[1.0, 0.7, 0.4, 0.1]);
    assert_close(found.z, 9.615_777_839_808_375, COARSE);
    assert_close(found.tails.two_sided, 6.858_895_930_668_835e-22, COARSE);
    let small = [Proportion::new(2, 20), Proportion::new(3, 25), Proportion::new(9, 22)];
    let found = cochran_armitage(&small, &[0.0, 1.0, 3.0]);
    assert_close(found.z, 2.710_042_791_730_636, COARSE);
    assert_close(found.tails.greater, 0.003_363_726_402_718_207_3, COARSE);
    assert_eq!(cochran_armitage(&none, &[0.0, 1.0]).tails.two_sided, 1.0);
}

#[test]
fn intervals_of_proportions() {
    // scipy.stats.binomtest(k, n).proportion_ci(confidence, 'wilson')
    for (k, n, confidence, low, high) in [
        (14, 200, 0.95, 0.042_152_171_828_342_81, 0.114_054_808_856_106_46),
        (0, 10, 0.95, 0.0, 0.277_532_799_862_889_26),
        (50, 50, 0.9, 0.948_666_814_213_729_9, 1.0),
        (28, 50, 0.99, 0.382_924_751_328_664_1, 0.723_016_997_665_220_7),
    ] {
        let found = wilson(Proportion::new(k, n), confidence);
        assert_close(found.low, low, COARSE);
        assert_close(found.high, high, COARSE);
    }
    // statsmodels.stats.proportion.confint_proportions_2indep(..., method='newcomb', compare='diff');
    // the first three are rows (a), (d) and (g) of Newcombe 1998's table of examples
    for (k1, n1, k2, n2, confidence, low, high) in [
        (56, 70, 48, 80, 0.95, 0.052_431_472_402_364_98, 0.333_872_654_036_906),
        (9, 10, 3, 10, 0.95, 0.170_522_723_934_503_02, 0.809_017_973_535_488_1),
        (0, 10, 0, 20, 0.95, -0.161_125_158_052_819_38, 0.277_532_799_862_889_2),
        (28, 50, 20, 50, 0.9, -0.003_932_756_052_418_607, 0.312_336_219_745_427_7),
    ] {
        let found = newcombe(Proportion::new(k1, n1), Proportion::new(k2, n2), confidence);
        assert_close(found.low, low, COARSE);
        assert_close(found.high, high, COARSE);
    }
}

#[test]
fn tests_on_means() {
    let summary = |mean, sd, n| Summary { n, mean, sd };
    let (without, with) = (summary(22.97, 3.46, 10), summary(12.27, 1.84, 10));
    // scipy.stats.ttest_ind_from_stats(*a, *b, equal_var=False), df by Satterthwaite's formula
    let found = welch(without, with);
    assert_close(found.t, 8.634_312_393_387_372, COARSE);
    assert_close(found.df, 13.713_476_157_925_433, COARSE);
    assert_close(found.tails.two_sided, 6.494_231_361_237_056e-7, COARSE);
    assert_close(found.tails.greater, 3.247_115_680_618_528e-7, COARSE);
    let interval = found.interval(0.95);
    assert_close(interval.low, 8.036_871_503_917_325, COARSE);
    assert_close(interval.high, 13.363_128_496_082_673, COARSE);
    let found = welch(summary(7.12, 0.9, 10), summary(7.32, 1.4, 7));
    assert_close(found.tails.two_sided, 0.746_500_329_711_971_3, COARSE);
    let found = welch(summary(433.0, 11.0, 30), summary(171.0, 9.0, 12));
    assert_close(found.tails.two_sided, 2.392_318_159_958_707e-31, COARSE);
    // scipy.stats.ttest_ind_from_stats(*a, *b, equal_var=True)
    let pooled = student(without, with);
    assert_close(pooled.tails.two_sided, 8.130_888_299_343_204e-8, COARSE);
    // Two-group analysis of variance is the square of it (the papers' own test).
    let analysis = anova(&[without, with]);
    assert_close(analysis.f, pooled.t * pooled.t, FINE);
    assert_close(analysis.p, pooled.tails.two_sided, FINE);
    // scipy.stats.f_oneway
    let groups = [
        [6.0, 8.0, 4.0, 5.0, 3.0, 4.0],
        [8.0, 12.0, 9.0, 11.0, 6.0, 8.0],
        [13.0, 9.0, 11.0, 8.0, 7.0, 12.0],
    ];
    let found = anova(&groups.map(|g| Summary::of(&g)));
    assert_close(found.f, 9.264_705_882_352_942, COARSE);
    assert_close(found.p, 0.002_398_777_329_392_908_3, COARSE);
    assert_eq!((found.df_between, found.df_within), (2.0, 15.0));
    // (mean - t(0.975, 9) sd / sqrt(n)) by hand
    let one = mean_interval(with, 0.95);
    assert_close(one.low, 12.27 - 2.262_157_162_798_205 * 1.84 / 10.0_f64.sqrt(), COARSE);
}

#[test]
fn groups_that_do_not_vary_are_told_apart_or_not() {
    let fixed = |mean| Summary { n: 5, mean, sd: 0.0 };
    assert_eq!(welch(fixed(1.0), fixed(1.0)).tails.two_sided, 1.0);
    assert_eq!(welch(fixed(1.0), fixed(2.0)).tails.less, 0.0);
    assert_eq!(anova(&[fixed(1.0), fixed(1.0)]).p, 1.0);
    assert_eq!(anova(&[fixed(1.0), fixed(2.0)]).p, 0.0);
}

#[test]
fn tests_on_ranks_and_signs() {
    // scipy.stats.mannwhitneyu(x, y, alternative), method 'auto'
    let found = mann_whitney(&[1.1, 2.2, 3.3, 0.4], &[2.5, 5.1, 4.4, 6.0, 7.2]);
    assert!(found.exact);
    assert_eq!(found.u, 1.0);
    tails(
        found.tails,
        0.015_873_015_873_015_872,
        0.992_063_492_063_492_1,
        0.031_746_031_746_031_744,
    );
    let found = mann_whitney(&[9.5, 8.5], &[1.0, 2.0, 3.0, 4.0, 5.0]);
    tails(found.tails, 1.0, 0.047_619_047_619_047_616, 0.095_238_095_238_095_23);
    let tied = mann_whitney(
        &[1.0, 2.0, 2.0, 3.0, 3.0, 3.0, 4.0, 5.0, 6.0, 7.0],
        &[3.0, 4.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 9.0, 10.0, 12.0],
    );
    assert!(!tied.exact);
    assert_eq!(tied.u, 17.0);
    tails(
        tied.tails,
        0.003_940_655_547_356_609,
        0.996_813_719_699_885_7,
        0.007_881_311_094_713_218,
    );
    let x: Vec<f64> = (0..12).map(|i| f64::from(i) * 1.3).collect();
    let y: Vec<f64> = (0..15).map(|i| f64::from(i) * 1.1 + 2.03).collect();
    let found = mann_whitney(&x, &y);
    assert_eq!(found.u, 63.0);
    tails(found.tails, 0.097_993_840_508_291_19, 0.910_179_724_924_461_6, 0.195_987_681_016_582_37);
    assert_eq!(mann_whitney(&[1.0; 10], &[1.0; 12]).tails.two_sided, 1.0);
    // scipy.stats.binomtest(k, n, 0.5, alternative)
    tails(
        sign_test(20, 4),
        0.999_861_419_200_897_2,
        0.000_771_939_754_486_084,
        0.001_543_879_508_972_168,
    );
    tails(sign_test(3, 7), 0.171_875, 0.945_312_5, 0.343_75);
    assert_eq!(sign_test(0, 0).two_sided, 1.0);
}

#[test]
fn correlation_by_ranks() {
    let x = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
    let y = [2.0, 1.0, 4.0, 3.0, 7.0, 5.0, 5.0];
    // scipy.stats.spearmanr
    assert_close(spearman(&x, &y), 0.810_843_716_426_003_2, COARSE);
    // scipy.stats.permutation_test((x,), statistic, permutation_type='pairings', n_resamples=inf)
    let mut stream = Seeds::new(7, Vec::new()).stream("test");
    let exact = spearman_permutation(&x, &y, 0, &mut stream);
    tails(exact, 0.984_920_634_920_635, 0.017_460_317_460_317_46, 0.034_920_634_920_634_92);
    // numpy.tanh(numpy.arctanh(r) -+ z * sqrt((1 + r*r/2)/(n - 3)))
    let interval = spearman_interval(0.77, 60, 0.95);
    assert_close(interval.low, 0.619_835_902_775_060_2, COARSE);
    assert_close(interval.high, 0.865_764_932_221_363_3, COARSE);
    assert_eq!(spearman_interval(1.0, 10, 0.95).high, 1.0);
    assert_eq!(spearman_interval(0.3, 3, 0.95).low, -1.0);
}

/// Checks that drawn orders estimate what all orders count: nine pairs, one more than are enumerated exactly.
#[test]
fn drawn_permutations_agree_with_all_of_them() {
    let x: Vec<f64> = (0..9).map(f64::from).collect();
    let y = [3.0, 0.0, 4.0, 1.0, 2.0, 6.0, 5.0, 8.0, 7.0];
    let draw = |seed| {
        let mut stream = Seeds::new(seed, Vec::new()).stream("test");
        spearman_permutation(&x, &y, 9999, &mut stream)
    };
    // numpy over all 362880 orders: r = 0.783333, one-sided p = 0.008611662257495592;
    // five standard errors of a share drawn 9999 times are 0.0047.
    let found = draw(1);
    assert!((found.greater - 0.008_611_662_257_495_592).abs() < 0.0047, "{}", found.greater);
    assert_eq!(found, draw(1));
    assert_ne!(found, draw(2));
}

#[test]
fn equivalence_needs_evidence() {
    let summary = |mean, sd, n| Summary { n, mean, sd };
    // max(t.cdf((d - m)/se, df), t.sf((d + m)/se, df)) by scipy, Satterthwaite's df
    let found = tost_means(summary(10.2, 1.1, 30), summary(10.0, 1.4, 25), 1.0);
    assert_close(found.inside, 0.012_409_412_293_790_698, COARSE);
    assert_close(found.beyond, 0.987_590_587_706_209_3, COARSE);
    // statsmodels.stats.weightstats.ttost_ind(a, b, -1, 1, usevar='unequal')
    let a = Summary::of(&[10.1, 9.4, 11.2, 10.6, 9.9, 10.8, 10.3]);
    let b = Summary::of(&[9.8, 10.9, 10.2, 10.7, 9.1, 11.3, 10.0, 10.4]);
    assert_close(tost_means(a, b, 1.0).inside, 0.005_955_489_785_256_201, COARSE);
    // scipy.optimize.brentq for the alpha at which statsmodels' Newcombe interval of confidence
    // 1 - 2 alpha touches the margin
    let prop = Proportion::new;
    let found = tost_proportions(prop(102, 200), prop(98, 200), 0.15);
    assert_close(found.inside, 0.003_956_446_792_832_194, COARSE);
    let found = tost_proportions(prop(28, 50), prop(20, 50), 0.1);
    assert_close(found.inside, 0.726_476_940_147_199_3, COARSE);
    assert_close(found.beyond, 0.273_523_059_852_800_7, COARSE);
    // Nothing observed is not nothing there.
    let found = tost_proportions(prop(0, 5), prop(0, 5), 0.1);
    assert_close(found.inside, 0.228_028_270_125_127_97, COARSE);
    assert!(tost_proportions(prop(150, 200), prop(90, 200), 0.1).beyond < 1e-4);
    assert!(tost_proportions(prop(1, 2), prop(1, 2), 1.0).inside < 1e-12);
}

#[test]
fn effects_summaries_and_holm() {
    let (a, b) =
        (Summary { n: 10, mean: 22.97, sd: 3.46 }, Summary { n: 10, mean: 12.27, sd: 1.84 });
    // (m1 - m2)/sqrt((9 s1^2 + 9 s2^2)/18), times mpmath's gamma(9)/(3 gamma(8.5))
    assert_close(cohen_d(a, b), 3.861_381_890_116_613_5, COARSE);
    assert_close(hedges_g(a, b), 3.697_838_570_444_266, COARSE);
    // By hand: of six pairs one is greater, four are less, one is tied.
    assert_close(cliff_delta(&[1.0, 2.0, 3.0], &[2.0, 4.0]), -0.5, FINE);
    assert_eq!(cliff_delta(&[5.0, 6.0], &[1.0, 2.0]), 1.0);
    // statsmodels.stats.multitest.multipletests(p, method='holm')
    let adjusted = holm(&[0.01, 0.04, 0.03, 0.005, 0.2]);
    for (found, expected) in adjusted.iter().zip([0.04, 0.09, 0.09, 0.025, 0.2]) {
        assert_close(*found, expected, FINE);
    }
    assert_eq!(holm(&[]), Vec::<f64>::new());
    // numpy: mean, std(ddof=1), median, quantile
    let v = [3.1, 4.1, 5.9, 2.6, 5.3, 5.8, 9.7];
    assert_close(mean(&v), 5.214_285_714_285_714, FINE);
    assert_close(sample_sd(&v), 2.362_504_724_107_143_5, FINE);
    assert_close(median(&v), 5.3, FINE);
    assert_close(quantile(&v, 0.1), 2.900_000_000_000_000_4, FINE);
    assert_close(quantile(&v, 0.83), 5.898_000_000_000_001, FINE);
    // numpy.std([1e9 + 4, ...], ddof=1): no cancellation
    let far = [1e9 + 4.0, 1e9 + 7.0, 1e9 + 13.0, 1e9 + 16.0];
    assert_close(sample_sd(&far), 5.477_225_575_051_661, FINE);
    assert!(mean(&[]).is_nan() && sample_sd(&[1.0]).is_nan() && median(&[]).is_nan());
}

#[test]
fn the_bootstrap_knows_the_spread_of_a_mean() {
    let values: Vec<f64> = (0..40).map(|i| f64::from((i * 17) % 40)).collect();
    let draw = |seed| {
        let mut stream = Seeds::new(seed, Vec::new()).stream("test");
        bootstrap(&[&values], |s| mean(&s[0]), 4000, 0.95, &mut stream)
    };
    let found = draw(3);
    // The bootstrap's variance of a mean is (n - 1)/n s^2/n (Efron and Tibshirani 1993, section 5.2);
    // the standard error of an sd over 4000 resamples is about 1.1 %.
    let n = 40.0_f64;
    let expected = sample_sd(&values) * ((n - 1.0) / n / n).sqrt();
    assert!((found.standard_error / expected - 1.0).abs() < 0.04);
    assert_eq!(found.estimate, 19.5);
    // Normal theory to within the same noise.
    assert!((found.interval.low - (19.5 - 1.96 * expected)).abs() < 0.25);
    assert!((found.interval.high - (19.5 + 1.96 * expected)).abs() < 0.25);
    assert_eq!(found, draw(3));
    assert_ne!(found, draw(4));
}

/// Checks that a resample of shares is a binomial draw: mean and spread of many against np and np(1 - p), and the ends.
#[test]
fn shares_are_resampled_as_zeros_and_ones_would_be() {
    let seen = [Proportion::new(60, 200), Proportion::new(0, 40), Proportion::new(40, 40)];
    let mut stream = Seeds::new(3, Vec::new()).stream("test");
    let first = bootstrap_shares(&seen, |s| s[0], 20_000, 0.95, &mut stream);
    assert_eq!(first.estimate, 0.3);
    // Five standard errors of a mean and of an sd over 20000 draws.
    let sd = (0.3_f64 * 0.7 / 200.0).sqrt();
    assert!((mean(&first.statistics) - 0.3).abs() < 5.0 * sd / 20_000.0_f64.sqrt());
    assert!((first.standard_error / sd - 1.0).abs() < 5.0 / 40_000.0_f64.sqrt());
    // scipy.stats.binom.ppf([.025, .975], 200, .3) / 200, to the step of one trial
    assert!((first.interval.low - 0.24).abs() < 0.0051, "{:?}", first.interval);
    assert!((first.interval.high - 0.365).abs() < 0.0051, "{:?}", first.interval);
    let ends = bootstrap_shares(&seen, |s| s[2] - s[1], 50, 0.95, &mut stream);
    assert_eq!((ends.interval.low, ends.interval.high), (1.0, 1.0));
}

/// Checks the arithmetic of the bootstrap to the last digits: the same resamples, drawn by this stream, through numpy.
#[test]
fn the_bootstrap_takes_numpys_quantiles_of_its_resamples() {
    let values = [3.1, 4.1, 5.9, 2.6, 5.3, 5.8, 9.7, 9.3, 2.3, 8.4, 6.2, 6.4];
    let mut stream = Seeds::new(3, Vec::new()).stream("test");
    let found = bootstrap(&[&values], |s| mean(&s[0]), 199, 0.9, &mut stream);
    // numpy.quantile(means, [0.05, 0.95]), numpy.std(means, ddof=1), numpy.mean(values)
    assert_close(found.interval.low, 4.844_166_666_666_666, FINE);
    assert_close(found.interval.high, 6.750_833_333_333_333, FINE);
    assert_close(found.standard_error, 0.612_908_397_012_503_8, FINE);
    assert_close(found.estimate, 5.758_333_333_333_333, FINE);
}

/// Checks the pairs (5, 7 and 1, 3), (12 and 10, 14): differences 4 and 0. Variances within are 2 and (2 + 8) / 2 = 5,
/// of the sides' means 2 (1/2 + 1) / 4 = 0.75 and 5 (1/2 + 1/2) / 4 = 1.25, with 1 and 2 degrees of freedom.
#[test]
fn matched_means_are_compared_pair_by_pair() {
    let pairs = [
        (Summary::of(&[5.0, 7.0]), Summary::of(&[1.0, 3.0])),
        (Summary::of(&[12.0]), Summary::of(&[10.0, 14.0])),
    ];
    let test = welch_matched(&pairs).unwrap();
    assert_close(test.difference, 2.0, FINE);
    assert_close(test.standard_error, 2.0_f64.sqrt(), FINE);
    assert_close(test.df, 4.0 / (0.5625 + 1.5625 / 2.0), FINE);
    let alone = [(Summary::of(&[12.0]), Summary::of(&[10.0, 14.0]))];
    assert_eq!(welch_matched(&alone), None, "one run has no spread");
    assert_eq!(welch_matched(&pairs[..1]), Some(welch(pairs[0].0, pairs[0].1)));
}

proptest! {
    #[test]
    fn fisher_sums_to_one_and_is_symmetric(k1 in 0_u64..30, k2 in 0_u64..30, more1 in 1_u64..30, more2 in 1_u64..30) {
        let (a, b) = (Proportion::new(k1, k1 + more1), Proportion::new(k2, k2 + more2));
        let (ab, ba) = (fisher_exact(a, b), fisher_exact(b, a));
        prop_assert!((ab.less - ba.greater).abs() < 1e-12);
        prop_assert!((ab.two_sided - ba.two_sided).abs() < 1e-9);
        // The table observed is in both tails.
        prop_assert!(ab.less + ab.greater >= 1.0 - 1e-12);
    }

    #[test]
    fn equivalence_matches_its_interval(k1 in 0_u64..40, k2 in 0_u64..40, margin in 0.02_f64..0.5) {
        let (a, b) = (Proportion::new(k1, 40), Proportion::new(k2, 40));
        let interval = newcombe(a, b, 0.90);
        let inside = interval.low > -margin && interval.high < margin;
        prop_assert_eq!(tost_proportions(a, b, margin).inside < 0.05, inside);
    }
}
