//! Weak duality as a judge without tolerances of its own: whatever the multipliers λ ≥ 0, no policy within the
//! bounds costs less than min over all policies of (c + Σ λᵢ cᵢ) minus Σ λᵢ Dᵢ, and that minimum is an
//! ordinary stochastic shortest path, found by policy iteration and evaluated exactly.

use super::*;

fn lower_bound(cmdp: &Cmdp, multipliers: &[f64]) -> f64 {
    let priced: Vec<f64> = cmdp
        .pairs()
        .iter()
        .map(|pair| {
            let extra = pair.costs[1..].iter().zip(multipliers).map(|(c, lambda)| c * lambda);
            pair.costs[0] + extra.sum::<f64>()
        })
        .collect();
    let sure = prune::Sure::of(cmdp, |_| true);
    let best = improvement::lexicographic_best(cmdp, &sure, &[priced]);
    let choices = best
        .iter()
        .map(|pair| pair.iter().map(|i| (cmdp.pairs()[*i].action, 1.0)).collect())
        .collect();
    let totals = evaluate(cmdp, &Policy::new(cmdp, choices)).unwrap();
    totals[0]
        + (0..multipliers.len())
            .map(|i| multipliers[i] * (totals[i + 1] - cmdp.secondary()[i].bound))
            .sum::<f64>()
}

/// Spreads costs over `decades` orders of magnitude, and makes every move likely to fail where `patient`.
fn distorted(mut instance: Instance, decades: f64, patient: bool, stream: &mut Stream) -> Instance {
    let mut stretch = || crate::math::pow(10.0, stream.between(-0.5, 0.5) * decades);
    for (_, _, c) in &mut instance.primary {
        *c *= stretch();
    }
    for (_, costs) in &mut instance.secondary {
        for (_, _, c) in costs.iter_mut() {
            *c *= stretch();
        }
    }
    if patient {
        for (x, a) in instance.primary.iter().map(|(x, a, _)| (*x, *a)).collect::<Vec<_>>() {
            let exit = crate::math::pow(10.0, stream.between(-6.0, 0.0));
            for entry in instance.transitions.iter_mut().filter(|t| (t.0, t.1) == (x, a)) {
                entry.3 *= exit;
            }
            instance.transitions.push((x, a, x, 1.0 - exit));
        }
    }
    instance.bound(stream);
    instance
}

fn judge(decades: f64, patient: bool, indices: std::ops::Range<u64>, goal: f64) -> usize {
    let mut solved = 0;
    for family in Family::ALL {
        for index in indices.clone() {
            let size = 5 + usize::try_from(index % 25).unwrap();
            let mut stream = Seeds::new(index, vec![]).stream("distort");
            let plain = family.instance(index, size);
            let cmdp = distorted(plain, decades, patient, &mut stream).cmdp();
            let outcome = solve(&cmdp).unwrap_or_else(|e| panic!("{family:?} {index}: {e}"));
            let Outcome::Optimal(solution) = outcome else { continue };
            solved += 1;
            let gap =
                (solution.primary - lower_bound(&cmdp, &solution.multipliers)) / solution.primary;
            assert!(
                gap.abs() < goal,
                "{family:?} {index}: {} has a gap of {gap}",
                solution.primary
            );
            for (secondary, total) in cmdp.secondary().iter().zip(&solution.secondary) {
                assert!(*total <= secondary.bound * (1.0 + BOUND_TOLERANCE), "{family:?} {index}");
            }
        }
    }
    solved
}

#[test]
fn the_multipliers_certify_the_value() {
    let solved = judge(0.0, false, 1000..1030, 1e-12);
    assert!(solved > 100, "{solved}");
}

/// Checks costs from 1e-3 to 1e3 or 1e-6 to 1e6, moves that take a million attempts, or both.
#[test]
fn bad_scaling_is_certified_too() {
    for (decades, patient) in [(6.0, false), (12.0, false), (0.0, true), (6.0, true)] {
        let solved = judge(decades, patient, 2000..2015, 1e-9);
        assert!(solved > 40, "{solved} at {decades} {patient}");
    }
}
