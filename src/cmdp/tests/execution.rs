//! The policies executed: drawn afresh at every visit, walks must take on average what evaluation gives.

use super::*;

#[test]
fn walks_take_what_the_evaluation_says() {
    let mut randomised = 0;
    for family in Family::ALL {
        for index in 0..4 {
            let cmdp = family.instance(index, 14).cmdp();
            let Outcome::Optimal(solution) = solve(&cmdp).unwrap() else { continue };
            randomised += solution.policy.randomised();
            let coordinates = vec![("family".to_owned(), format!("{family:?}"))];
            let mut stream = Seeds::new(index, coordinates).stream("walks");
            let walks = 3000;
            let criteria = 1 + cmdp.secondary().len();
            let (mut sums, mut squares) = (vec![0.0; criteria], vec![0.0; criteria]);
            for _ in 0..walks {
                let totals = walk(&cmdp, &solution.policy, &mut stream);
                for k in 0..criteria {
                    sums[k] += totals[k];
                    squares[k] += totals[k] * totals[k];
                }
            }
            let exact = std::iter::once(solution.primary).chain(solution.secondary);
            for (k, exact) in exact.enumerate() {
                let n = f64::from(walks);
                let mean = sums[k] / n;
                let variance = (squares[k] / n - mean * mean).max(0.0);
                let allowed = 5.0 * (variance / n).sqrt() + 1e-9 * exact;
                assert!(
                    (mean - exact).abs() <= allowed,
                    "{family:?} {index}, criterion {k}: mean {mean}, exact {exact}, allowed {allowed}"
                );
            }
        }
    }
    assert!(randomised > 0, "no policy drawn was randomised");
}

fn walk(cmdp: &Cmdp, policy: &Policy, stream: &mut Stream) -> Vec<f64> {
    let mut totals = vec![0.0; 1 + cmdp.secondary().len()];
    let mut state = draw(cmdp.initial(), stream.uniform());
    while !cmdp.is_absorbing(state) {
        assert!(policy.visits(state));
        let action = policy.draw(state, stream.uniform()).unwrap();
        let pair =
            cmdp.pairs_of(state).map(|i| &cmdp.pairs()[i]).find(|p| p.action == action).unwrap();
        for (total, cost) in totals.iter_mut().zip(&pair.costs) {
            *total += cost;
        }
        state = draw(&pair.successors, stream.uniform());
    }
    totals
}

fn draw(distribution: &[(usize, f64)], uniform: f64) -> usize {
    let mut below = 0.0;
    for (outcome, probability) in distribution {
        below += probability;
        if uniform < below {
            return *outcome;
        }
    }
    distribution.last().unwrap().0
}
