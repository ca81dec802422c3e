//! Policy iteration without bounds, by several criteria in lexicographic order.
//!
//! It starts from a policy that surely arrives and changes an action only for a strict improvement. Costs are
//! at least 0 and the last criterion is the number of steps, so every policy on the way arrives surely too:
//! a closed class that never arrives would need a strict improvement of costs that are already least
//! (Bertsekas and Tsitsiklis 1991, "An analysis of stochastic shortest path problems").

use super::chain::Chain;
use super::model::{Cmdp, Pair};
use super::prune::Sure;
use std::cmp::Ordering;

/// Relative difference below which two expected costs are the same.
const SAME: f64 = 1e-11;

/// More rounds than any instance needs; reaching it leaves a policy that still surely arrives.
const ROUNDS: usize = 1000;

/// Chooses the pair to take in each sure state outside M so that expected totals are least, criterion by criterion;
/// equal ones are decided by the expected number of steps. `None` in the other states.
///
/// `criteria` gives the cost of a pair of the model by each criterion, most important first.
pub(super) fn lexicographic_best(
    cmdp: &Cmdp,
    sure: &Sure,
    criteria: &[Vec<f64>],
) -> Vec<Option<usize>> {
    let mut choice = sure.approach.clone();
    let mut row_of = vec![None; cmdp.states()];
    let acting: Vec<usize> = (0..cmdp.states()).filter(|x| choice[*x].is_some()).collect();
    for (row, x) in acting.iter().enumerate() {
        row_of[*x] = Some(row);
    }
    for _ in 0..ROUNDS {
        let Some(totals) = totals(cmdp, criteria, &choice, &row_of, acting.len()) else {
            return sure.approach.clone();
        };
        let mut changed = false;
        for &x in &acting {
            let mut best = value(&totals, row_of[x]);
            for index in cmdp.pairs_of(x).filter(|index| sure.pairs[*index]) {
                let pair = &cmdp.pairs()[index];
                if pair.exit() > 0.0 && Some(index) != choice[x] {
                    let ahead = lookahead(pair, index, criteria, &totals, &row_of);
                    if compare(&ahead, &best) == Ordering::Less {
                        best = ahead;
                        choice[x] = Some(index);
                        changed = true;
                    }
                }
            }
        }
        if !changed {
            break;
        }
    }
    choice
}

/// Computes the expected totals of a deterministic policy by each criterion and, last, in steps.
fn totals(
    cmdp: &Cmdp,
    criteria: &[Vec<f64>],
    choice: &[Option<usize>],
    row_of: &[Option<usize>],
    states: usize,
) -> Option<Vec<Vec<f64>>> {
    let mut chain = Chain::new(states, criteria.len() + 1);
    for index in choice.iter().flatten() {
        let pair = &cmdp.pairs()[*index];
        let x = row_of[pair.state]?;
        for (y, p) in pair.elsewhere() {
            chain.go(x, row_of[y], p);
        }
        for (k, costs) in criteria.iter().enumerate() {
            chain.charge(x, k, costs[*index]);
        }
        chain.charge(x, criteria.len(), 1.0);
    }
    chain.totals()
}

fn value(totals: &[Vec<f64>], row: Option<usize>) -> Vec<f64> {
    totals.iter().map(|by_state| row.map_or(0.0, |row| by_state[row])).collect()
}

/// Computes the expected totals of taking `pair` until it leaves its state, and the policy from then on.
fn lookahead(
    pair: &Pair,
    index: usize,
    criteria: &[Vec<f64>],
    totals: &[Vec<f64>],
    row_of: &[Option<usize>],
) -> Vec<f64> {
    let exit = pair.exit();
    totals
        .iter()
        .enumerate()
        .map(|(k, by_state)| {
            let here = criteria.get(k).map_or(1.0, |costs| costs[index]);
            let onward: f64 =
                pair.elsewhere().map(|(y, p)| p * row_of[y].map_or(0.0, |row| by_state[row])).sum();
            (here + onward) / exit
        })
        .collect()
}

/// Compares expected totals in lexicographic order, forgiving rounding.
fn compare(a: &[f64], b: &[f64]) -> Ordering {
    for (x, y) in a.iter().zip(b) {
        if (x - y).abs() > SAME * (x + y) {
            return x.total_cmp(y);
        }
    }
    Ordering::Equal
}
