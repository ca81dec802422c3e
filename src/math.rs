//! The only door to transcendental functions: the `libm` crate, whose results are the same bits on every
//! supported platform (std's are not: they differ between C libraries and even between CPUs).
//!
//! `sqrt`, `floor`, `abs` and the four operations are exact everywhere and are used from std.

use std::f64::consts::{PI, TAU};

/// Returns the sine of `x` (rad).
pub fn sin(x: f64) -> f64 {
    libm::sin(x)
}

/// Returns the cosine of `x` (rad).
pub fn cos(x: f64) -> f64 {
    libm::cos(x)
}

/// Returns the sine and cosine of `x` (rad).
pub fn sin_cos(x: f64) -> (f64, f64) {
    libm::sincos(x)
}

/// Returns the tangent of `x` (rad).
pub fn tan(x: f64) -> f64 {
    libm::tan(x)
}

/// Returns the angle (rad) of the vector (`x`, `y`), in (-π, π].
pub fn atan2(y: f64, x: f64) -> f64 {
    libm::atan2(y, x)
}

/// Returns the arc cosine (rad); NaN outside [-1, 1].
pub fn acos(x: f64) -> f64 {
    libm::acos(x)
}

/// Returns the arc sine (rad); NaN outside [-1, 1].
pub fn asin(x: f64) -> f64 {
    libm::asin(x)
}

/// Returns the natural exponential.
pub fn exp(x: f64) -> f64 {
    libm::exp(x)
}

/// Returns the natural logarithm.
pub fn ln(x: f64) -> f64 {
    libm::log(x)
}

/// Returns the natural logarithm of 1 + `x`, accurate for small `x`.
pub fn ln_1p(x: f64) -> f64 {
    libm::log1p(x)
}

/// Returns the exponential minus one, accurate for small `x`.
pub fn exp_m1(x: f64) -> f64 {
    libm::expm1(x)
}

/// Returns the decimal logarithm.
pub fn log10(x: f64) -> f64 {
    libm::log10(x)
}

/// Returns `x` to the power `y`.
pub fn pow(x: f64, y: f64) -> f64 {
    libm::pow(x, y)
}

/// Returns the length of the vector (`x`, `y`) without undue overflow.
pub fn hypot(x: f64, y: f64) -> f64 {
    libm::hypot(x, y)
}

/// Returns the equivalent angle in (-π, π].
pub fn wrap_angle(angle: f64) -> f64 {
    if angle > -PI && angle <= PI {
        return angle;
    }
    let turns = ((angle + PI) / TAU).floor();
    let wrapped = angle - turns * TAU;
    if wrapped > PI {
        wrapped - TAU
    } else if wrapped <= -PI {
        wrapped + TAU
    } else {
        wrapped
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wraps_into_the_half_open_circle() {
        assert_eq!(wrap_angle(PI), PI);
        assert_eq!(wrap_angle(-PI), PI);
        assert!((wrap_angle(7.0) - (7.0 - TAU)).abs() < 1e-15);
        assert!((wrap_angle(-40.0) - (-40.0 + 6.0 * TAU)).abs() < 1e-13);
        for k in -50..50 {
            let a = wrap_angle(f64::from(k) * 0.7);
            assert!(a > -PI && a <= PI);
        }
    }
}
