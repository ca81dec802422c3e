//! Special functions and distributions against mpmath at 50 digits; the call is in the comment.

use super::FINE;
use crate::stats::assert_close;
use crate::stats::distribution::*;
use crate::stats::special::*;
use proptest::prelude::*;
use statrs::distribution::{ContinuousCDF, FisherSnedecor, StudentsT};

#[test]
fn gamma_and_beta() {
    // mpmath.loggamma(x)
    for (x, expected) in [
        (0.5, 0.572_364_942_924_700_1),
        (1.5, -0.120_782_237_635_245_22),
        (0.001, 6.907_178_885_383_854),
        (3.7, 1.428_072_326_665_388_1),
        (9.99, 12.779_315_214_350_193),
        (10.0, 12.801_827_480_081_47),
        (55.5, 166.321_506_159_840_37),
        (1e5, 1_051_287.708_973_656_9),
    ] {
        assert_close(ln_gamma(x), expected, FINE);
    }
    assert_eq!((ln_gamma(1.0), ln_gamma(2.0)), (0.0, 0.0));
    assert!(ln_gamma(0.0).is_nan() && ln_gamma(-1.5).is_nan());
    // mpmath.log(mpmath.beta(a, b))
    for (a, b, expected) in [
        (0.5, 0.5, 1.144_729_885_849_400_2),
        (2.0, 3.0, -2.484_906_649_788_000_3),
        (0.5, 50.0, -1.381_146_601_451_041_1),
        (25.0, 75.5, -56.920_819_571_031_91),
        (1e4, 2e4, -19_098.908_538_220_892),
    ] {
        assert_close(ln_beta(a, b), expected, FINE);
        assert_close(ln_beta(b, a), expected, FINE);
    }
    assert_close(exp_of(ln_choose(50, 3)), 19_600.0, FINE);
    assert_eq!(ln_choose(7, 7), 0.0);
}

fn exp_of(x: f64) -> f64 {
    crate::math::exp(x)
}

#[test]
fn incomplete_functions_in_both_tails() {
    // mpmath.gammainc(a, 0, x, regularized=True), mpmath.gammainc(a, x, regularized=True)
    for (a, x, p, q) in [
        (0.5, 0.1, 0.345_279_153_981_422_98, 0.654_720_846_018_577),
        (0.5, 30.0, 0.999_999_999_999_990_5, 9.485_737_571_073_848e-15),
        (5.0, 2.0, 0.052_653_017_343_711_157, 0.947_346_982_656_288_8),
        (5.0, 60.0, 1.0, 5.060_046_065_842_574e-21),
        (100.0, 80.0, 0.017_108_313_035_133_114, 0.982_891_686_964_866_9),
        (1000.0, 1200.0, 0.999_999_998_711_839_4, 1.288_160_608_628_143_3e-9),
        (2.5, 0.0001, 3.008_796_191_247_675_8e-11, 0.999_999_999_969_912),
    ] {
        let found = incomplete_gamma(a, x);
        assert_close(found.0, p, 1e-11);
        assert_close(found.1, q, 1e-11);
    }
    // mpmath.betainc(a, b, 0, x, regularized=True) and its complement
    for (a, b, x, lower, upper) in [
        (0.5, 0.5, 0.3, 0.369_010_119_565_545_4, 0.630_989_880_434_454_6),
        (2.0, 3.0, 0.01, 0.000_592_03, 0.999_407_97),
        (9.0, 0.5, 0.999, 0.894_709_228_674_460_6, 0.105_290_771_325_539_42),
        (50.0, 60.0, 0.2, 1.032_897_336_223_018_7e-9, 0.999_999_998_967_102_7),
        (0.5, 200.0, 0.1, 0.999_999_999_912_922_3, 8.707_774_398_967_444e-11),
        (1000.0, 1500.0, 0.45, 0.999_999_777_698_194_9, 2.223_018_050_896_806e-7),
        (3.0, 4.0, 0.9999, 0.999_999_999_999_998_5, 1.499_760_009_999_339_3e-15),
    ] {
        let found = incomplete_beta(a, b, x, 1.0 - x);
        assert_close(found.0, lower, 1e-11);
        assert_close(found.1, upper, 1e-11);
    }
    assert_eq!(incomplete_beta(2.0, 3.0, 0.0, 1.0), (0.0, 1.0));
    assert_eq!(incomplete_beta(2.0, 3.0, 1.0, 0.0), (1.0, 0.0));
}

#[test]
fn the_normal_distribution() {
    // mpmath.erfc(z / sqrt(2)) / 2
    for (z, expected) in [
        (-3.0, 0.998_650_101_968_369_9),
        (0.0, 0.5),
        (1e-5, 0.499_996_010_577_196_05),
        (1.0, 0.158_655_253_931_457_05),
        (6.0, 9.865_876_450_376_981e-10),
        (10.0, 7.619_853_024_160_526e-24),
        (20.0, 2.753_624_118_606_233_7e-89),
        (37.0, 5.725_571_222_524_577e-300),
    ] {
        assert_close(normal_sf(z), expected, 1e-11);
        assert_close(normal_cdf(-z), expected, 1e-11);
    }
    // mpmath.erf(x), mpmath.erfc(x)
    for (x, expected, rest) in [
        (1e-8, 1.128_379_167_095_512_6e-8, 0.999_999_988_716_208_3),
        (0.3, 0.328_626_759_459_127_4, 0.671_373_240_540_872_6),
        (-1.2, -0.910_313_978_229_635_4, 1.910_313_978_229_635_4),
        (2.5, 0.999_593_047_982_555, 0.000_406_952_017_444_958_94),
    ] {
        assert_close(erf(x), expected, FINE);
        assert_close(erfc(x), rest, FINE);
    }
    // mpmath.findroot of the lower tail at scipy.stats.norm.ppf(p)
    for (p, expected) in [
        (1e-300, -37.047_096_299_361_2),
        (1e-20, -9.262_340_089_798_408),
        (1e-6, -4.753_424_308_822_899),
        (0.025, -1.959_963_984_540_054_2),
        (0.2, -0.841_621_233_572_914_2),
        (0.9, 1.281_551_565_544_600_6),
        (0.975, 1.959_963_984_540_054),
    ] {
        assert_close(normal_quantile(p), expected, FINE);
    }
    // The absolute error near the middle is that of p itself.
    assert!((normal_quantile(0.499_99) + 2.506_628_274_896e-5).abs() < 1e-15);
    assert_eq!(normal_quantile(0.5), 0.0);
    assert_eq!(normal_quantile(0.0), f64::NEG_INFINITY);
    assert_eq!(normal_quantile(1.0), f64::INFINITY);
    assert!(normal_quantile(-0.1).is_nan());
}

#[test]
fn student_f_chi_square_and_binomial() {
    // mpmath.betainc(df/2, 1/2, 0, df/(df + t^2), regularized=True)/2 or its complement
    for (t, df, expected) in [
        (0.1, 1.0, 0.468_274_482_569_446_43),
        (2.0, 1.0, 0.147_583_617_650_433_27),
        (1e6, 1.0, 3.183_098_861_836_845_7e-7),
        (2.5, 9.0, 0.016_930_913_841_492_87),
        (-1.3, 17.3, 0.894_672_171_973_706_1),
        (12.0, 30.0, 2.790_092_707_599_628e-13),
        (5.0, 200.7, 6.235_269_597_529_537_5e-7),
        (40.0, 10.0, 1.140_428_871_542_877_3e-12),
        (1e-4, 50.0, 0.499_960_304_732_094_4),
        (3.0, 10_000.0, 0.001_353_224_094_998_833_1),
    ] {
        assert_close(student_t_sf(t, df), expected, 1e-11);
    }
    // mpmath.findroot of the above at scipy.stats.t.ppf(p, df)
    for (p, df, expected) in [
        (0.975, 9.0, 2.262_157_162_798_205),
        (0.95, 1.0, 6.313_751_514_675_037),
        (0.995, 17.3, 2.892_027_641_127_293_5),
        (0.05, 200.0, -1.652_508_100_910_877_5),
        (1e-10, 4.0, -416.175_140_329_604_1),
        (0.6, 3.0, 0.276_670_662_332_689_85),
    ] {
        assert_close(student_t_quantile(p, df), expected, 1e-11);
    }
    // mpmath.betainc(df2/2, df1/2, 0, df2/(df2 + df1 f), regularized=True)
    for (f, a, b, expected) in [
        (0.5, 1.0, 18.0, 0.488_554_324_804_732_7),
        (40.0, 1.0, 18.0, 5.837_650_049_777_875e-6),
        (3.2, 4.0, 245.0, 0.013_831_165_555_590_006),
        (1e6, 1.0, 1.0, 0.000_636_619_560_161_117_9),
        (200.0, 3.0, 36.0, 1.691_309_752_026_094e-22),
        (1.0, 5.0, 1000.0, 0.416_488_823_678_539_14),
        (1e-6, 2.0, 7.0, 0.999_999_000_000_642_9),
    ] {
        assert_close(f_sf(f, a, b), expected, 1e-11);
        assert_close(f_cdf(f, a, b), 1.0 - expected, 1e-9);
    }
    // mpmath.gammainc(df/2, x/2, regularized=True)
    for (x, df, expected) in [
        (0.1, 1.0, 0.751_829_634_045_849_3),
        (46.4, 30.0, 0.028_449_598_923_006_04),
        (3.84, 1.0, 0.050_043_521_248_705_1),
        (300.0, 4.0, 1.083_439_491_947_826e-63),
        (1.0, 4.0, 0.909_795_989_568_950_1),
        (1500.0, 1000.0, 1.045_464_038_597_965_7e-22),
    ] {
        assert_close(chi_square_sf(x, df), expected, 1e-11);
    }
    assert_close(chi_square_cdf(0.1, 1.0), 1.0 - 0.751_829_634_045_849_3, FINE);
    // scipy.stats.binom.sf(k - 1, n, p)
    for (k, n, p, expected) in [
        (20, 24, 0.5, 0.000_771_939_754_486_084),
        (46, 46, 0.5, 1.421_085_471_520_200_4e-14),
        (3, 10, 0.2, 0.322_200_473_600_000_15),
        (6, 6, 0.5, 0.015_625),
    ] {
        assert_close(binomial_sf_inclusive(k, n, p), expected, 1e-11);
    }
    assert_eq!(binomial_sf_inclusive(0, 5, 0.5), 1.0);
    assert_eq!(binomial_sf_inclusive(6, 5, 0.5), 0.0);
}

#[test]
fn without_a_degree_of_freedom_there_is_no_quantile_and_no_search_for_one() {
    for df in [0.0, -1.0, f64::NAN] {
        assert!(student_t_quantile(0.975, df).is_nan(), "{df}");
    }
}

proptest! {
    #[test]
    fn tails_agree_with_statrs(t in -30.0_f64..30.0, df in 1.0_f64..300.0, f in 0.01_f64..60.0, df2 in 2.0_f64..300.0) {
        let oracle = StudentsT::new(0.0, 1.0, df).unwrap();
        assert_close(student_t_sf(t, df), oracle.sf(t), 1e-9);
        let oracle = FisherSnedecor::new(df, df2).unwrap();
        assert_close(f_sf(f, df, df2), oracle.sf(f), 1e-9);
    }

    #[test]
    fn quantiles_invert(p in 1e-12_f64..1.0, df in 1.0_f64..500.0) {
        let p = p.min(1.0 - 1e-12);
        prop_assert!((normal_cdf(normal_quantile(p)) / p - 1.0).abs() < 1e-11);
        prop_assert!((student_t_cdf(student_t_quantile(p, df), df) / p - 1.0).abs() < 1e-10);
    }
}
