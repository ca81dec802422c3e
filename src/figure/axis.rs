//! Axes with ticks at round numbers, chosen and written with integers.

use crate::math;

/// One labelled position of an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Tick {
    /// Its position (in the axis's unit).
    pub value: f64,
    /// The value as text, with as many decimals as the step has.
    pub label: String,
}

/// An axis: a title with its unit, a range, and the ticks. A linear one begins and ends on a tick.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// What is measured, with its unit: `distance travelled (m)`.
    pub title: String,
    /// Low end of the range.
    pub low: f64,
    /// High end of the range, above `low`.
    pub high: f64,
    /// Ticks in ascending order.
    pub ticks: Vec<Tick>,
    /// Whether equal steps are equal ratios; both ends are above 0 then.
    pub logarithmic: bool,
}

impl Axis {
    /// Creates the axis of `title` around all finite `values` whose step is the smallest of 1, 2 or 5 times a power of
    /// ten that needs at most `most` ticks (at least 3).
    ///
    /// No value at all gives 0 to 1; a single one is given room on both sides.
    pub fn covering(title: &str, values: impl IntoIterator<Item = f64>, most: u32) -> Self {
        let (mut low, mut high) = values
            .into_iter()
            .filter(|v| v.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        if low > high {
            (low, high) = (0.0, 1.0);
        } else if low == high {
            let room = if low == 0.0 { 0.5 } else { low.abs() / 2.0 };
            (low, high) = (low - room, high + room);
        }
        let steps = (-12..=15).flat_map(|e| [1, 2, 5].map(|m| Step { mantissa: m, exponent: e }));
        for step in steps {
            let Some((first, last)) = step.around(low, high) else { continue };
            if first < last && last - first < i64::from(most.max(3)) {
                let ticks: Vec<_> = (first..=last).map(|k| step.tick(k)).collect();
                let (low, high) = (ticks[0].value, ticks[ticks.len() - 1].value);
                return Self { title: title.to_owned(), low, high, ticks, logarithmic: false };
            }
        }
        // Beyond every step: the two ends alone.
        let ticks = [low, high].map(|value| Tick { value, label: format!("{value:e}") }).to_vec();
        Self { title: title.to_owned(), low, high, ticks, logarithmic: false }
    }

    /// Creates the logarithmic axis of `title` around all positive `values`, some room beyond them at both ends, with
    /// the coarsest usual set of ticks of which at least four lie within. Without a positive value it runs from 0.5 to
    /// 2.
    pub fn logarithmic(title: &str, values: impl IntoIterator<Item = f64>) -> Self {
        let (mut low, mut high) = values
            .into_iter()
            .filter(|v| v.is_finite() && *v > 0.0)
            .fold((f64::INFINITY, 0.0_f64), |(l, h), v| (l.min(v), h.max(v)));
        if low > high {
            (low, high) = (0.5, 2.0);
        }
        let room = math::pow(high / low, 0.05).max(1.05);
        (low, high) = (low / room, high * room);
        let mut ticks = Vec::new();
        for mantissas in [&[10][..], &[10, 20, 50], &[10, 15, 20, 30, 40, 50, 70], &FINE] {
            ticks = (-13..=15)
                .flat_map(|e| mantissas.iter().map(move |m| Step { mantissa: *m, exponent: e - 1 }))
                .map(|step| Tick { value: step.times(1), label: step.in_short() })
                .filter(|tick| (low..=high).contains(&tick.value))
                .collect();
            if ticks.len() >= 4 {
                break;
            }
        }
        Self { title: title.to_owned(), low, high, ticks, logarithmic: true }
    }

    /// Returns the position of `value` between the coordinates `from` (low end) and `to` (high end), in their unit.
    pub fn position(&self, value: f64, from: f64, to: f64) -> f64 {
        let share = if self.logarithmic {
            math::ln(value / self.low) / math::ln(self.high / self.low)
        } else {
            (value - self.low) / (self.high - self.low)
        };
        from + share * (to - from)
    }
}

/// Many round numbers, for axes that span a fraction of one.
const FINE: [i64; 15] = [10, 12, 14, 16, 18, 20, 25, 30, 35, 40, 50, 60, 70, 80, 90];

/// `mantissa` times ten to the `exponent`: the step between ticks, exact in decimals.
#[derive(Clone, Copy)]
struct Step {
    mantissa: i64,
    exponent: i32,
}

impl Step {
    /// Returns the length of `count` steps, rounded once: integers are exact, and so are powers of ten up to 10^22.
    fn times(self, count: i64) -> f64 {
        let power = (0..self.exponent.unsigned_abs()).fold(1.0, |power, _| power * 10.0);
        #[expect(clippy::cast_precision_loss, reason = "ticks are few and steps small integers")]
        let digits = (count * self.mantissa) as f64;
        if self.exponent < 0 { digits / power } else { digits * power }
    }

    /// Returns the whole numbers of steps just outside of `low` and `high`; `None` where they would be too many.
    fn around(self, low: f64, high: f64) -> Option<(i64, i64)> {
        let whole = |value: f64, outwards: fn(f64) -> f64| {
            let steps = value / self.times(1);
            // A value that is a multiple but for rounding counts as one.
            let near = steps.round();
            let whole = if (steps - near).abs() < 1e-9 { near } else { outwards(steps) };
            #[expect(clippy::cast_possible_truncation, reason = "guarded by the comparison")]
            (whole.abs() < 1e9).then_some(whole as i64)
        };
        Some((whole(low, f64::floor)?, whole(high, f64::ceil)?))
    }

    /// Writes the step itself without superfluous zeros: `0.15`, `2`, `300`.
    fn in_short(self) -> String {
        format!("{}", self.times(1))
    }

    fn tick(self, count: i64) -> Tick {
        let value = self.times(count);
        let decimals = usize::try_from(-self.exponent).unwrap_or(0);
        Tick { value, label: format!("{value:.decimals$}").replace('-', "\u{2212}") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn labels(values: &[f64], most: u32) -> String {
        let axis = Axis::covering("x", values.iter().copied(), most);
        axis.ticks.iter().map(|t| t.label.as_str()).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn ticks_are_round_and_written_with_their_own_decimals() {
        assert_eq!(labels(&[0.0, 100.0], 6), "0 20 40 60 80 100");
        assert_eq!(labels(&[0.3, 0.7], 6), "0.3 0.4 0.5 0.6 0.7");
        assert_eq!(labels(&[-3.0, 12.0], 5), "\u{2212}5 0 5 10 15");
        assert_eq!(labels(&[], 3), "0.0 0.5 1.0");
        assert_eq!(labels(&[8.0, f64::NAN], 6), "4 6 8 10 12");
        assert_eq!(labels(&[0.0, 1e300], 6), "0e0 1e300");
    }

    #[test]
    fn logarithmic_ticks_are_round_and_equal_ratios_equally_far() {
        let labels = |values: &[f64]| {
            let axis = Axis::logarithmic("x", values.iter().copied());
            axis.ticks.iter().map(|t| t.label.clone()).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(labels(&[7.1, 1900.0]), "10 20 50 100 200 500 1000 2000");
        assert_eq!(labels(&[0.43, 1.2]), "0.5 0.6 0.7 0.8 0.9 1 1.2");
        assert_eq!(labels(&[-1.0, f64::NAN]), "0.5 0.7 1 1.5 2");
        let axis = Axis::logarithmic("x", [1.0, 100.0]);
        let at = |x: f64| axis.position(x, 0.0, 1.0);
        assert!(
            (at(10.0) - 0.5).abs() < 1e-12
                && (at(50.0) - at(5.0) - at(10.0) + at(1.0)).abs() < 1e-12
        );
    }

    proptest! {
        #[test]
        fn every_value_lies_within_few_ascending_ticks(a in -1e6_f64..1e6, b in -1e6_f64..1e6, most in 3_u32..12) {
            let axis = Axis::covering("x", [a, b], most);
            prop_assert!(axis.ticks.len() <= most as usize && axis.ticks.len() >= 2);
            prop_assert!(axis.ticks.windows(2).all(|t| t[0].value < t[1].value));
            let slack = 1e-6 * (axis.high - axis.low);
            prop_assert!(axis.low <= a.min(b) + slack && axis.high >= a.max(b) - slack);
            let at = axis.position(a, 100.0, 0.0);
            prop_assert!((-1e-3..=100.001).contains(&at));
        }
    }
}
