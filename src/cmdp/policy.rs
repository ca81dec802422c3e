//! Stationary randomised policies: read off a vertex, completed by a fallback, and evaluated exactly.

use super::chain::Chain;
use super::model::Cmdp;
use super::occupation::Programme;
use super::vertex::Vertex;

/// π(x, a): the probability with which each action is taken in each state. To be drawn afresh at every visit.
#[derive(Debug, Clone, PartialEq)]
pub struct Policy {
    choices: Vec<Vec<(usize, f64)>>,
    visited: Vec<bool>,
}

impl Policy {
    /// Creates the policy that takes `choices[x]`, actions with their probabilities, in each state x of `cmdp`. States
    /// are visited if they can be reached from β by it.
    ///
    /// # Panics
    /// Where an action does not exist in its state.
    pub fn new(cmdp: &Cmdp, choices: Vec<Vec<(usize, f64)>>) -> Self {
        let visited = visited(cmdp, &choices);
        Self { choices, visited }
    }

    /// Returns the actions with their positive probabilities in `state`; empty in absorbing states and where no policy
    /// surely arrives.
    pub fn at(&self, state: usize) -> &[(usize, f64)] {
        &self.choices[state]
    }

    /// Returns whether `state` is ever visited from β. Elsewhere the policy is the fallback.
    pub fn visits(&self, state: usize) -> bool {
        self.visited[state]
    }

    /// Returns how many visited states have more than one action: at most as many as there are bounds.
    pub fn randomised(&self) -> usize {
        (0..self.choices.len()).filter(|x| self.visited[*x] && self.choices[*x].len() > 1).count()
    }

    /// Draws the action for a `uniform` number of [0, 1); `None` where the policy has none.
    pub fn draw(&self, state: usize, uniform: f64) -> Option<usize> {
        let choices = self.at(state);
        let mut below = 0.0;
        for (action, probability) in choices {
            below += probability;
            if uniform < below {
                return Some(*action);
            }
        }
        choices.last().map(|(action, _)| *action)
    }
}

/// Computes the expected totals of `policy` from β, primary first and then the secondaries, by state elimination;
/// `None` where it does not surely arrive.
///
/// # Panics
/// Where the policy is not one of `cmdp`.
pub fn evaluate(cmdp: &Cmdp, policy: &Policy) -> Option<Vec<f64>> {
    let acting: Vec<usize> =
        (0..cmdp.states()).filter(|x| policy.visited[*x] && !cmdp.is_absorbing(*x)).collect();
    let mut row_of = vec![None; cmdp.states()];
    for (row, x) in acting.iter().enumerate() {
        row_of[*x] = Some(row);
    }
    let criteria = 1 + cmdp.secondary().len();
    let mut chain = Chain::new(acting.len(), criteria);
    for (row, x) in acting.iter().enumerate() {
        for (action, share) in policy.at(*x) {
            let pair = &cmdp.pairs()[pair_index(cmdp, *x, *action)];
            for (y, p) in pair.elsewhere() {
                chain.go(row, row_of[y], share * p);
            }
            for (k, cost) in pair.costs.iter().enumerate() {
                chain.charge(row, k, share * cost);
            }
        }
    }
    let totals = chain.totals()?;
    let from_start = |by_state: &Vec<f64>| {
        cmdp.initial().iter().map(|(x, p)| row_of[*x].map_or(0.0, |row| p * by_state[row])).sum()
    };
    Some(totals.iter().map(from_start).collect())
}

/// Reads the policy off a vertex, with `fallback` (a pair per state) where it never comes. Actions whose share of their
/// state's largest is `negligible` or less are dropped.
///
/// A state with a single basic column takes it however small its occupation: a state reached with
/// probability 1e-14 is reached.
pub(super) fn of_vertex(
    cmdp: &Cmdp,
    programme: &Programme,
    vertex: &Vertex<'_>,
    fallback: &[Option<usize>],
    negligible: f64,
) -> Policy {
    let columns = vertex.columns();
    let mut basic: Vec<Vec<(usize, f64)>> = vec![Vec::new(); cmdp.states()];
    for (column, index) in programme.pairs.iter().enumerate() {
        if vertex.is_basic(column) {
            let pair = &cmdp.pairs()[*index];
            // From departures back to attempts: pi is the share of attempts.
            basic[pair.state].push((pair.action, columns[column] / pair.exit()));
        }
    }
    for choices in &mut basic {
        let largest = choices.iter().fold(0.0_f64, |largest, (_, rho)| largest.max(*rho));
        if choices.len() > 1 {
            choices.retain(|(_, rho)| *rho > negligible * largest || *rho == largest);
            if largest == 0.0 {
                choices.truncate(1);
            }
        }
        normalise(choices);
    }
    let greedy = |x: usize| {
        fallback[x].map(|index| (cmdp.pairs()[index].action, 1.0)).into_iter().collect::<Vec<_>>()
    };
    for (x, choices) in basic.iter_mut().enumerate() {
        if choices.is_empty() {
            *choices = greedy(x);
        }
    }
    let visited = visited(cmdp, &basic);
    for x in (0..cmdp.states()).filter(|x| !visited[*x]) {
        basic[x] = greedy(x);
    }
    Policy { choices: basic, visited }
}

/// Scales the weights of one state to sum to 1.
fn normalise(choices: &mut [(usize, f64)]) {
    if let [(_, only)] = choices {
        *only = 1.0;
        return;
    }
    let total: f64 = choices.iter().map(|(_, rho)| rho).sum();
    for (_, rho) in choices.iter_mut() {
        *rho /= total;
    }
}

fn visited(cmdp: &Cmdp, choices: &[Vec<(usize, f64)>]) -> Vec<bool> {
    let mut visited = vec![false; cmdp.states()];
    let mut stack: Vec<usize> = cmdp.initial().iter().map(|(x, _)| *x).collect();
    while let Some(x) = stack.pop() {
        if std::mem::replace(&mut visited[x], true) || cmdp.is_absorbing(x) {
            continue;
        }
        for (action, _) in choices[x].iter().filter(|(_, share)| *share > 0.0) {
            let pair = &cmdp.pairs()[pair_index(cmdp, x, *action)];
            stack.extend(pair.successors.iter().map(|(y, _)| *y).filter(|y| !visited[*y]));
        }
    }
    visited
}

fn pair_index(cmdp: &Cmdp, state: usize, action: usize) -> usize {
    cmdp.pairs_of(state)
        .find(|index| cmdp.pairs()[*index].action == action)
        .expect("a policy only takes actions that exist")
}
