//! Expected total costs of a Markov chain with absorption, by state elimination without subtraction.
//!
//! States are censored one after the other; the probability of leaving a state is always *summed*, never
//! taken as 1 - P(x, x) (Grassmann, Taksar and Heyman 1985, "Regenerative analysis and steady state
//! distributions for Markov chains"). Everything is a sum, product or quotient of numbers at least 0, so each
//! result is right to a few times n rounding errors *relative to itself*, however badly scaled the chain is.

/// A chain under construction: transition probabilities among n transient states, the probability of being
/// absorbed from each, and the costs of a visit to each by several criteria.
#[derive(Debug)]
pub(super) struct Chain {
    states: usize,
    /// By rows; the diagonal is never read.
    onward: Vec<f64>,
    absorbed: Vec<f64>,
    /// By criterion, then state.
    costs: Vec<Vec<f64>>,
}

impl Chain {
    /// Creates a chain of `states` states without transitions, whose visits cost nothing by each of `criteria`.
    pub(super) fn new(states: usize, criteria: usize) -> Self {
        Self {
            states,
            onward: vec![0.0; states * states],
            absorbed: vec![0.0; states],
            costs: vec![vec![0.0; states]; criteria],
        }
    }

    /// Adds to the probability of going from `x` to `y`, or to absorption where `y` is `None`. Self-loops
    /// are implied by what the others leave.
    pub(super) fn go(&mut self, x: usize, y: Option<usize>, probability: f64) {
        match y {
            Some(y) => self.onward[x * self.states + y] += probability,
            None => self.absorbed[x] += probability,
        }
    }

    /// Adds to the cost of one visit to `x` by `criterion`.
    pub(super) fn charge(&mut self, x: usize, criterion: usize, cost: f64) {
        self.costs[criterion][x] += cost;
    }

    /// Computes the expected total cost from each state, by criterion and state; `None` where some state does not
    /// surely reach absorption.
    pub(super) fn totals(mut self) -> Option<Vec<Vec<f64>>> {
        let n = self.states;
        for k in (0..n).rev() {
            let (before, rest) = self.onward.split_at_mut(k * n);
            let line = &mut rest[..k];
            let exit = self.absorbed[k] + line.iter().sum::<f64>();
            if exit <= 0.0 || !exit.is_finite() {
                return None;
            }
            // From here on, row k gives the chain's next state among the states before k, and its cost is that of the
            // whole stay.
            for p in line.iter_mut() {
                *p /= exit;
            }
            self.absorbed[k] /= exit;
            for costs in &mut self.costs {
                costs[k] /= exit;
            }
            for x in 0..k {
                let through = before[x * n + k];
                if through > 0.0 {
                    for (p, q) in before[x * n..x * n + k].iter_mut().zip(line.iter()) {
                        *p += through * q;
                    }
                    self.absorbed[x] += through * self.absorbed[k];
                    for costs in &mut self.costs {
                        costs[x] += through * costs[k];
                    }
                }
            }
        }
        for costs in &mut self.costs {
            for k in 0..n {
                let ahead: f64 = self.onward[k * n..k * n + k]
                    .iter()
                    .zip(costs.iter())
                    .map(|(p, v)| p * v)
                    .sum();
                costs[k] += ahead;
            }
        }
        Some(self.costs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gamblers_ruin_has_its_closed_form() {
        // Steps until 0 or n from k, fair: k (n - k). States 1..n-1 are the chain's 0..n-2.
        let n = 12;
        let mut chain = Chain::new(n - 1, 1);
        for x in 0..n - 1 {
            chain.go(x, x.checked_sub(1), 0.5);
            chain.go(x, (x + 1 < n - 1).then_some(x + 1), 0.5);
            chain.charge(x, 0, 1.0);
        }
        let totals = chain.totals().unwrap();
        for (x, total) in totals[0].iter().enumerate() {
            let k = x + 1;
            let expected = f64::from(u32::try_from(k * (n - k)).unwrap());
            assert!((total - expected).abs() < 1e-12 * expected);
        }
    }

    /// Checks one state between a start and the goal that is left with probability 1e-13 only: 1 - P(x, x) would have
    /// lost four digits.
    #[test]
    fn hardly_leaving_a_state_costs_no_accuracy() {
        let p = 1e-13;
        let mut chain = Chain::new(2, 1);
        chain.go(0, Some(1), 1.0);
        chain.go(1, None, p / 2.0);
        chain.go(1, Some(0), p / 2.0);
        chain.charge(1, 0, 1.0);
        // v1 = 1/p + v0 / 2 and v0 = v1.
        let total = chain.totals().unwrap()[0][0];
        assert!((total - 2.0 / p).abs() < 1e-15 * total, "{total}");
    }

    #[test]
    fn going_round_for_ever_is_noticed() {
        let mut chain = Chain::new(3, 1);
        chain.go(0, Some(1), 0.5);
        chain.go(0, None, 0.5);
        chain.go(1, Some(2), 1.0);
        chain.go(2, Some(1), 1.0);
        assert_eq!(chain.totals(), None);
        assert_eq!(Chain::new(0, 1).totals(), Some(vec![vec![]]));
    }
}
