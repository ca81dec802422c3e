//! The planner compared with two independent routes: the textbook programme in a simplex code (microlp), without
//! our pruning, folding and scaling; and a Dantzig-Wolfe loop whose pricing is Dijkstra's shortest path.

use super::*;
use microlp::{ComparisonOp, OptimizationDirection, Problem};

/// Solves the textbook occupation-measure programme over every state outside M. `None` where infeasible.
pub(super) fn textbook(cmdp: &Cmdp) -> Option<f64> {
    let mut problem = Problem::new(OptimizationDirection::Minimize);
    let used: Vec<&Pair> =
        cmdp.pairs().iter().filter(|pair| !cmdp.is_absorbing(pair.state)).collect();
    let variables: Vec<_> =
        used.iter().map(|pair| problem.add_var(pair.costs[0], (0.0, f64::INFINITY))).collect();
    for x in (0..cmdp.states()).filter(|x| !cmdp.is_absorbing(*x)) {
        let row: Vec<_> = used
            .iter()
            .zip(&variables)
            .filter_map(|(pair, variable)| {
                let enters: f64 =
                    pair.successors.iter().filter(|(y, _)| *y == x).map(|(_, p)| p).sum();
                let entry = f64::from(u8::from(pair.state == x)) - enters;
                (entry != 0.0).then_some((*variable, entry))
            })
            .collect();
        let beta = cmdp.initial().iter().find(|(s, _)| *s == x).map_or(0.0, |(_, p)| *p);
        problem.add_constraint(row.as_slice(), ComparisonOp::Eq, beta);
    }
    for (i, secondary) in cmdp.secondary().iter().enumerate() {
        let row: Vec<_> = used
            .iter()
            .zip(&variables)
            .map(|(pair, variable)| (*variable, pair.costs[i + 1] / secondary.bound))
            .filter(|(_, cost)| *cost != 0.0)
            .collect();
        problem.add_constraint(row.as_slice(), ComparisonOp::Le, 1.0);
    }
    match problem.solve() {
        Ok(outcome) => Some(outcome.into_solution().unwrap().objective()),
        Err(microlp::Error::Infeasible) => None,
        Err(other) => panic!("the oracle failed: {other}"),
    }
}

/// Returns the totals of the shortest path from each state of β by the weights, on a deterministic model.
fn shortest_path(cmdp: &Cmdp, weight: impl Fn(&Pair) -> f64) -> Vec<f64> {
    let n = cmdp.states();
    let mut distance = vec![f64::INFINITY; n];
    let mut totals = vec![vec![0.0; 1 + cmdp.secondary().len()]; n];
    let mut done = vec![false; n];
    for x in (0..n).filter(|x| cmdp.is_absorbing(*x)) {
        distance[x] = 0.0;
    }
    while let Some(y) = (0..n)
        .filter(|x| !done[*x] && distance[*x].is_finite())
        .min_by(|a, b| distance[*a].total_cmp(&distance[*b]))
    {
        done[y] = true;
        for pair in cmdp.pairs().iter().filter(|pair| pair.successors[0].0 == y) {
            let through = distance[y] + weight(pair);
            if !done[pair.state] && through < distance[pair.state] {
                distance[pair.state] = through;
                totals[pair.state] =
                    pair.costs.iter().zip(&totals[y]).map(|(c, total)| c + total).collect();
            }
        }
    }
    (0..=cmdp.secondary().len())
        .map(|k| cmdp.initial().iter().map(|(x, p)| p * totals[*x][k]).sum())
        .collect()
}

/// Computes the least primary cost of a mixture of paths within the bounds, by column generation; `None` where even the
/// best mixture needs its bounds exceeded.
fn dantzig_wolfe(cmdp: &Cmdp) -> Option<f64> {
    let bounds: Vec<f64> = cmdp.secondary().iter().map(|s| s.bound).collect();
    let mut paths = vec![shortest_path(cmdp, |pair| pair.costs[0])];
    let penalty = 1e4 * paths[0][0].max(1.0);
    loop {
        // Master: mix the paths found so far; each bound's row is divided by the bound, its excess penalised.
        // Its dual, in which the multipliers are the variables: maximise mu - sum lambda_i.
        let mut dual = Problem::new(OptimizationDirection::Maximize);
        let mu = dual.add_var(1.0, (f64::NEG_INFINITY, f64::INFINITY));
        let lambdas: Vec<_> = bounds.iter().map(|_| dual.add_var(-1.0, (0.0, penalty))).collect();
        for path in &paths {
            let mut row = vec![(mu, 1.0)];
            for (i, lambda) in lambdas.iter().enumerate() {
                row.push((*lambda, -path[i + 1] / bounds[i]));
            }
            dual.add_constraint(row.as_slice(), ComparisonOp::Le, path[0]);
        }
        let master = dual.solve().unwrap().into_solution().unwrap();
        let lambda: Vec<f64> = lambdas.iter().map(|l| master.var_value(*l)).collect();
        let priced = |costs: &[f64]| {
            costs[0] + (0..bounds.len()).map(|i| lambda[i] * costs[i + 1] / bounds[i]).sum::<f64>()
        };
        let path = shortest_path(cmdp, |pair| priced(&pair.costs));
        if priced(&path) >= master.var_value(mu) * (1.0 - 1e-12) - 1e-12 || paths.contains(&path) {
            let infeasible = lambda.iter().any(|l| *l > 0.999 * penalty);
            return (!infeasible).then_some(master.objective());
        }
        paths.push(path);
    }
}

#[derive(Debug, Default)]
struct Row {
    instances: usize,
    optimal: usize,
    infeasible: usize,
    interior_failed: usize,
    randomised: [usize; 3],
    worst_textbook: f64,
    worst_dantzig_wolfe: f64,
    worst_bound: f64,
}

/// Solves the instances of one family and compares each with the oracles.
fn judge(family: Family, count: u64) -> Row {
    let mut row = Row::default();
    for index in 0..count {
        let size = 5 + usize::try_from(index % 10).unwrap() * 4;
        let cmdp = family.instance(index, size).cmdp();
        row.instances += 1;
        let outcome = solve(&cmdp).unwrap();
        let expected = textbook(&cmdp);
        let by_paths = family.deterministic().then(|| dantzig_wolfe(&cmdp));
        let Outcome::Optimal(solution) = outcome else {
            assert_eq!(expected, None, "{family:?} {index}: {outcome:?}, microlp found a solution");
            assert_eq!(by_paths.flatten(), None, "{family:?} {index}: {outcome:?}");
            row.infeasible += 1;
            continue;
        };
        row.optimal += 1;
        let expected = expected.unwrap_or_else(|| panic!("{family:?} {index}: {solution:?}"));
        row.worst_textbook = row.worst_textbook.max(relative(solution.primary, expected));
        if let Some(by_paths) = by_paths {
            let by_paths = by_paths.unwrap_or_else(|| panic!("{family:?} {index}: {solution:?}"));
            row.worst_dantzig_wolfe =
                row.worst_dantzig_wolfe.max(relative(solution.primary, by_paths));
        }
        for (secondary, total) in cmdp.secondary().iter().zip(&solution.secondary) {
            row.worst_bound = row.worst_bound.max(total / secondary.bound - 1.0);
        }
        let randomised = solution.policy.randomised();
        assert!(
            randomised <= cmdp.secondary().len(),
            "{family:?} {index}: {randomised} randomised"
        );
        row.randomised[randomised] += 1;
        row.interior_failed += usize::from(!matches!(solution.effort.interior, Some(Ok(_)) | None));
    }
    row
}

#[test]
fn generated_instances_agree_with_simplex_and_with_column_generation() {
    let mut report = String::from(
        "family       n   opt inf | randomised 0/1/2 | interior failed | microlp  D-W      over bound\n",
    );
    for family in Family::ALL {
        let row = judge(family, 45);
        report.push_str(&format!(
            "{:<11} {:>3}  {:>3} {:>3} | {:>3}/{:>2}/{:>2} | {} | {:.1e}  {:.1e}  {:.1e}\n",
            format!("{family:?}"),
            row.instances,
            row.optimal,
            row.infeasible,
            row.randomised[0],
            row.randomised[1],
            row.randomised[2],
            row.interior_failed,
            row.worst_textbook,
            row.worst_dantzig_wolfe,
            row.worst_bound,
        ));
        assert!(row.worst_textbook < 1e-8, "{family:?}: {row:?}");
        assert!(row.worst_dantzig_wolfe < 1e-8, "{family:?}: {row:?}");
        assert!(row.worst_bound < BOUND_TOLERANCE, "{family:?}: {row:?}");
        assert!(
            row.optimal > 0 && row.infeasible > 0,
            "{family:?} judges one status only: {row:?}"
        );
    }
    #[expect(clippy::print_stderr, reason = "the table of the study, shown with --nocapture")]
    {
        eprintln!("{report}");
    }
}
