//! u(p): the ranking of candidate locations (section 3.1, equations 1 to 4).

/// A candidate location with the two quantities by which it is judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Appraisal {
    /// D(p, p_R): Euclidean distance from the robot (m).
    pub distance: f64,
    /// I(p): expected new area (m²).
    pub gain: f64,
}

/// Computes u(p) of every candidate: α d(p) + (1 - α) i(p) (equation 1), with d(p) = (D_max - D) / D_max (equation 2)
/// and i(p) = I / I_max (equation 3).
///
/// Where all candidates are at the robot (`D_max` = 0) or promise nothing (`I_max` = 0) the paper's quotient is
/// 0 / 0: the term is then the same for all, 1 and 0.
pub fn utilities(candidates: &[Appraisal], alpha: f64) -> Vec<f64> {
    let d_max = candidates.iter().map(|c| c.distance).fold(0.0, f64::max);
    let i_max = candidates.iter().map(|c| c.gain).fold(0.0, f64::max);
    candidates
        .iter()
        .map(|c| {
            let d = if d_max > 0.0 { (d_max - c.distance) / d_max } else { 1.0 };
            let i = if i_max > 0.0 { c.gain / i_max } else { 0.0 };
            alpha * d + (1.0 - alpha) * i
        })
        .collect()
}

/// Returns the indices of the candidates from the best to the worst; the first found stays first among equals (equation
/// 4).
pub fn ranked(utilities: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..utilities.len()).collect();
    order.sort_by(|&a, &b| utilities[b].total_cmp(&utilities[a]));
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const CANDIDATES: [Appraisal; 3] = [
        Appraisal { distance: 2.0, gain: 1.0 },
        Appraisal { distance: 8.0, gain: 10.0 },
        Appraisal { distance: 4.0, gain: 5.0 },
    ];

    #[test]
    fn equations_one_to_four_by_hand() {
        let u = utilities(&CANDIDATES, 0.5);
        assert_eq!(u, [0.5 * 0.75 + 0.5 * 0.1, 0.5, 0.5 * 0.5 + 0.5 * 0.5]);
        assert_eq!(ranked(&u), [1, 2, 0], "the first among equals stays first");
    }

    #[test]
    fn alpha_one_picks_the_nearest_and_alpha_zero_the_richest() {
        assert_eq!(ranked(&utilities(&CANDIDATES, 1.0))[0], 0);
        assert_eq!(ranked(&utilities(&CANDIDATES, 0.0))[0], 1);
    }

    #[test]
    fn degenerate_quotients_do_not_become_nan() {
        let here = [Appraisal { distance: 0.0, gain: 0.0 }; 2];
        assert_eq!(utilities(&here, 0.5), [0.5, 0.5]);
    }

    proptest! {
        #[test]
        fn utilities_are_shares(raw in prop::collection::vec((0.0..1e3, 0.0..1e3), 1..20), alpha in 0.0..=1.0) {
            let candidates: Vec<_> =
                raw.into_iter().map(|(distance, gain)| Appraisal { distance, gain }).collect();
            for u in utilities(&candidates, alpha) {
                prop_assert!((0.0..=1.0 + 1e-12).contains(&u));
            }
        }
    }
}
