//! Tests of the whole planner by theme, and the instances they share.

mod certificate;
mod execution;
mod extremes;
mod golden;
mod invariance;
mod oracles;

use super::chain::Chain;
use super::*;
use crate::rng::{Seeds, Stream};

/// State, action, cost.
type Cost = (usize, usize, f64);

/// A model as plain lists, to be renumbered, written out and handed to other solvers.
#[derive(Debug, Clone, Default)]
pub(super) struct Instance {
    pub(super) states: usize,
    pub(super) actions: usize,
    pub(super) absorbing: Vec<usize>,
    pub(super) initial: Vec<(usize, f64)>,
    pub(super) transitions: Vec<(usize, usize, usize, f64)>,
    pub(super) primary: Vec<Cost>,
    /// Bounds with their costs.
    pub(super) secondary: Vec<(f64, Vec<Cost>)>,
}

impl Instance {
    pub(super) fn cmdp(&self) -> Cmdp {
        let mut builder = CmdpBuilder::new(self.states, self.actions);
        for x in &self.absorbing {
            builder.absorb(*x).unwrap();
        }
        for (x, p) in &self.initial {
            builder.initial(*x, *p).unwrap();
        }
        for (x, a, y, p) in &self.transitions {
            builder.transition(*x, *a, *y, *p).unwrap();
        }
        for (x, a, c) in &self.primary {
            builder.primary(*x, *a, *c).unwrap();
        }
        for (i, (bound, costs)) in self.secondary.iter().enumerate() {
            builder.secondary(format!("cost {i}"), *bound).unwrap();
            for (x, a, c) in costs {
                builder.secondary_cost(i, *x, *a, *c).unwrap();
            }
        }
        builder.build().unwrap()
    }

    /// Writes the same model in the JSON form.
    pub(super) fn document(&self) -> serde_json::Value {
        let names = |n: usize| (0..n).map(|i| format!("n{i}")).collect::<Vec<_>>();
        let secondary: Vec<_> = self
            .secondary
            .iter()
            .map(|(bound, costs)| serde_json::json!({"name": "s", "bound": bound, "costs": costs}))
            .collect();
        serde_json::json!({
            "states": names(self.states), "actions": names(self.actions),
            "absorbing": self.absorbing, "initial": self.initial, "transitions": self.transitions,
            "primary": self.primary, "secondary": secondary,
        })
    }

    /// Adds a pair with all its numbers.
    fn pair(&mut self, x: usize, a: usize, successors: &[(usize, f64)], costs: &[f64]) {
        self.transitions.extend(successors.iter().map(|(y, p)| (x, a, *y, *p)));
        self.primary.push((x, a, costs[0]));
        self.secondary.resize(costs.len() - 1, (f64::MAX, Vec::new()));
        for (i, c) in costs[1..].iter().enumerate() {
            self.secondary[i].1.push((x, a, *c));
        }
    }

    /// Returns the expected totals of the policy without bounds that is best by criterion `k`.
    fn best_by(&self, k: usize) -> Vec<f64> {
        let cmdp = self.cmdp();
        let costs = cmdp.pairs().iter().map(|pair| pair.costs[k]).collect();
        let sure = prune::Sure::of(&cmdp, |_| true);
        let best = improvement::lexicographic_best(&cmdp, &sure, &[costs]);
        let choices = best
            .iter()
            .map(|pair| pair.iter().map(|i| (cmdp.pairs()[*i].action, 1.0)).collect())
            .collect();
        evaluate(&cmdp, &Policy::new(&cmdp, choices)).unwrap()
    }

    /// Sets the bounds to what a mixture of the policies that are best by each secondary cost takes, or a little more
    /// or less. Never near the least: there, oracles with a tolerance cannot judge.
    fn bound(&mut self, stream: &mut Stream) {
        let extremes: Vec<_> = (0..self.secondary.len()).map(|i| self.best_by(i + 1)).collect();
        let weight = stream.between(0.1, 0.9);
        let (first, last) = (&extremes[0], &extremes[extremes.len() - 1]);
        for (i, (bound, _)) in self.secondary.iter_mut().enumerate() {
            let mixture = weight * first[i + 1] + (1.0 - weight) * last[i + 1];
            let share = stream.between(0.75, 1.3);
            *bound = mixture * if (share - 1.0).abs() < 0.003 { 1.003 } else { share };
        }
    }
}

/// Draws the cost of a step at a speed: primary, failure, time.
fn step_costs(stream: &mut Stream, literal: bool, fast: bool) -> [f64; 3] {
    let primary = if literal { 1.0 } else { stream.between(0.5, 3.0) };
    let (failure, time) = if fast { (0.03, 4.0) } else { (0.01, 9.0) };
    [primary, failure * stream.between(0.5, 1.5), time * stream.between(0.7, 1.3)]
}

/// The families of the generated instances.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Family {
    Corridor,
    Tree,
    Grid,
    SlippyGrid,
    Loop,
    Trapped,
}

impl Family {
    pub(super) const ALL: [Self; 6] =
        [Self::Corridor, Self::Tree, Self::Grid, Self::SlippyGrid, Self::Loop, Self::Trapped];

    /// Returns whether every action has one outcome.
    fn deterministic(self) -> bool {
        matches!(self, Self::Corridor | Self::Tree | Self::Grid)
    }

    /// Draws the instance number `index` of the family, with about `size` states.
    pub(super) fn instance(self, index: u64, size: usize) -> Instance {
        let coordinates = vec![("family".to_owned(), format!("{self:?}"))];
        let mut stream = Seeds::new(index, coordinates).stream("cmdp-instance");
        let stream = &mut stream;
        let literal = index.is_multiple_of(2);
        let mut instance = Instance { initial: vec![(0, 1.0)], ..Instance::default() };
        // Each undirected edge: a, b, and the probability of slipping (and to where).
        let (states, edges) = match self {
            Self::Corridor => (size, (1..size).map(|x| (x - 1, x)).collect::<Vec<_>>()),
            Self::Tree => (size, (1..size).map(|x| (below(stream, x), x)).collect()),
            Self::Grid | Self::SlippyGrid | Self::Trapped => {
                let width = (2..=size).find(|w| w * w >= size).unwrap();
                let right =
                    (0..width * width).filter(|x| x % width + 1 < width).map(|x| (x, x + 1));
                let down = (0..width * (width - 1)).map(|x| (x, x + width));
                (width * width, right.chain(down).collect())
            }
            Self::Loop => {
                let ring = (0..size).map(|x| (x, (x + 1) % size));
                let chords = (0..size / 4).map(|_| (below(stream, size), below(stream, size)));
                (size, ring.chain(chords.collect::<Vec<_>>()).filter(|(a, b)| a != b).collect())
            }
        };
        let goal = if self == Self::Loop { states / 2 } else { states - 1 };
        instance.states = states;
        instance.actions = 2 * edges.len() * 2;
        instance.absorbing = vec![goal];
        let mut action = 0;
        for (a, b) in edges {
            for (x, y) in [(a, b), (b, a)] {
                for fast in [false, true] {
                    let costs = step_costs(stream, literal, fast);
                    let mut outcomes = vec![(y, 1.0)];
                    if !self.deterministic() {
                        let slip = stream.between(0.0, 0.3);
                        let astray = if self == Self::Loop { x } else { below(stream, states) };
                        outcomes = vec![(y, 1.0 - slip), (astray, slip)];
                    }
                    instance.pair(x, action, &outcomes, &costs);
                    action += 1;
                }
            }
        }
        if self == Self::Trapped {
            // A pit that nothing leaves, one that only circles, and fast but risky actions past them.
            let pit = states;
            instance.states += 2;
            instance.actions = action + 1;
            instance.pair(pit + 1, action, &[(pit + 1, 1.0)], &[1.0, 0.0, 0.0]);
            for _ in 0..states / 2 {
                let (x, y) = (below(stream, states), below(stream, states));
                let risky = below(stream, action);
                instance.transitions.retain(|(s, a, _, _)| (*s, *a) != (x, risky));
                instance.primary.retain(|(s, a, _)| (*s, *a) != (x, risky));
                for (_, costs) in &mut instance.secondary {
                    costs.retain(|(s, a, _)| (*s, *a) != (x, risky));
                }
                let outcomes = [(y, 0.9), (pit + below(stream, 2), 0.1)];
                instance.pair(x, risky, &outcomes, &[0.1, 0.0, 0.1]);
            }
        }
        if index % 3 == 2 {
            instance.initial = vec![(0, 0.5), (below(stream, states), 0.25), (goal, 0.25)];
        }
        if index % 5 == 4 {
            instance.secondary.truncate(1);
        }
        instance.bound(stream);
        instance
    }
}

fn below(stream: &mut Stream, bound: usize) -> usize {
    usize::try_from(stream.below(bound as u64)).unwrap()
}

/// Returns |a - b| relative to the larger, with 1e-300 in place of zero.
pub(super) fn relative(a: f64, b: f64) -> f64 {
    (a - b).abs() / a.abs().max(b.abs()).max(1e-300)
}

pub(super) fn optimal(cmdp: &Cmdp) -> Solution {
    match solve(cmdp).unwrap() {
        Outcome::Optimal(solution) => solution,
        Outcome::Infeasible(why) => panic!("expected a solution, found {why:?}"),
    }
}

#[test]
fn a_chain_and_a_policy_agree_on_what_a_policy_costs() {
    // Slow with 1/4, fast with 3/4, one edge; fast slips back with 1/5.
    let mut instance = Instance {
        states: 2,
        actions: 2,
        absorbing: vec![1],
        initial: vec![(0, 1.0)],
        ..Instance::default()
    };
    instance.pair(0, 0, &[(1, 1.0)], &[1.0, 8.0]);
    instance.pair(0, 1, &[(1, 0.8), (0, 0.2)], &[1.0, 2.0]);
    let cmdp = instance.cmdp();
    let policy = Policy::new(&cmdp, vec![vec![(0, 0.25), (1, 0.75)], vec![]]);
    let mut chain = Chain::new(1, 2);
    chain.go(0, None, 0.25 + 0.75 * 0.8);
    chain.charge(0, 0, 1.0);
    chain.charge(0, 1, 0.25 * 8.0 + 0.75 * 2.0);
    let totals = chain.totals().unwrap();
    let evaluated = evaluate(&cmdp, &policy).unwrap();
    for (k, expected) in [1.0 / 0.85, 3.5 / 0.85].into_iter().enumerate() {
        assert!(relative(evaluated[k], expected) < 1e-15);
        assert!(relative(totals[k][0], expected) < 1e-15);
    }
    assert_eq!(policy.draw(0, 0.2), Some(0));
    assert_eq!(policy.draw(0, 0.25), Some(1));
    assert_eq!(policy.draw(1, 0.5), None);
}
