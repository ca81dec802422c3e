//! The general constrained MDP with total costs, valid by construction.
//!
//! (X, A, β, c, c₁..c_L, P, D₁..D_L) as in the deadline study, section 3, with any absorbing set M ⊆ X. Costs
//! stop on entering M. A pair (x, a) exists if and only if a transition was listed for it.

use std::collections::{BTreeMap, BTreeSet};
use thiserror::Error;

/// How far the probabilities of a pair, or of the initial states, may be from 1 in total.
const SUM_TOLERANCE: f64 = 1e-9;

/// A constrained MDP. Every probability is in (0, 1], every cost finite and at least 0, every index valid.
#[derive(Debug, Clone, PartialEq)]
pub struct Cmdp {
    actions: usize,
    absorbing: Vec<bool>,
    initial: Vec<(usize, f64)>,
    pairs: Vec<Pair>,
    /// Where the pairs of each state begin in `pairs`; one longer than there are states.
    first: Vec<usize>,
    secondary: Vec<Secondary>,
}

/// One action in one state: its successors and its costs.
#[derive(Debug, Clone, PartialEq)]
pub struct Pair {
    /// The state x.
    pub state: usize,
    /// The action a.
    pub action: usize,
    /// P(x, a, ·): successors in ascending order with their probabilities.
    pub successors: Vec<(usize, f64)>,
    /// c(x, a), then `c_1(x, a)` .. `c_L(x, a)`, in the units in which they were stated.
    pub costs: Vec<f64>,
}

impl Pair {
    /// Returns the probability of leaving the state, summed over the other states: exact where 1 - P(x, a, x) is not.
    pub fn exit(&self) -> f64 {
        self.elsewhere().map(|(_, p)| p).sum()
    }

    /// Returns the successors other than the state itself.
    pub fn elsewhere(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.successors.iter().copied().filter(|(y, _)| *y != self.state)
    }
}

/// A secondary cost's name and the bound D on its expected total.
#[derive(Debug, Clone, PartialEq)]
pub struct Secondary {
    /// As reported: `failure`, `time-s`.
    pub name: String,
    /// D ≥ 0, in the cost's own unit.
    pub bound: f64,
}

impl Cmdp {
    /// Returns |X|, absorbing states included.
    pub fn states(&self) -> usize {
        self.absorbing.len()
    }

    /// Returns |A|.
    pub fn actions(&self) -> usize {
        self.actions
    }

    /// Returns whether `state` is in M.
    pub fn is_absorbing(&self, state: usize) -> bool {
        self.absorbing[state]
    }

    /// Returns β: states with positive initial probability, ascending.
    pub fn initial(&self) -> &[(usize, f64)] {
        &self.initial
    }

    /// Returns all pairs, by state and then action. Pairs of absorbing states are kept but never used.
    pub fn pairs(&self) -> &[Pair] {
        &self.pairs
    }

    /// Returns the indices into [`Cmdp::pairs`] of the pairs of `state`.
    pub fn pairs_of(&self, state: usize) -> std::ops::Range<usize> {
        self.first[state]..self.first[state + 1]
    }

    /// Returns the secondary costs, in the order in which they were declared.
    pub fn secondary(&self) -> &[Secondary] {
        &self.secondary
    }

    /// Returns the same model with another bound on secondary cost `index`.
    ///
    /// # Panics
    /// Where there is no such cost, or the bound is negative or not finite.
    #[must_use]
    pub fn with_bound(mut self, index: usize, bound: f64) -> Self {
        assert!(bound.is_finite() && bound >= 0.0, "a bound is a finite number >= 0, not {bound}");
        self.secondary[index].bound = bound;
        self
    }
}

/// The fault of one entry; a document puts the entry's path in front.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum EntryError {
    /// An index beyond what was declared.
    #[error("{what} {index} does not exist; expected an index below {count}")]
    Index {
        /// `state` or `action`.
        what: &'static str,
        /// As given.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// Not a probability.
    #[error("probability {0} is {fault}; expected a number in [0, 1]", fault = fault(*.0))]
    Probability(f64),
    /// Not a cost.
    #[error("cost {0} is {fault}; expected a finite number >= 0", fault = fault(*.0))]
    Cost(f64),
    /// Not a bound.
    #[error("bound {0} is {fault}; expected a finite number >= 0", fault = fault(*.0))]
    Bound(f64),
    /// A cost on a pair that has no transition.
    #[error(
        "state {state} has no transition by action {action}; list it in `transitions` or drop the cost"
    )]
    UnlistedPair {
        /// The state.
        state: usize,
        /// The action.
        action: usize,
    },
}

/// Describes the fault of a number.
fn fault(x: f64) -> &'static str {
    if !x.is_finite() {
        "not finite"
    } else if x < 0.0 {
        "negative"
    } else {
        "above 1"
    }
}

/// The fault of the model as a whole.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ModelError {
    /// β does not sum to 1.
    #[error("the initial probabilities sum to {0}; expected 1")]
    InitialSum(f64),
    /// P(x, a, ·) does not sum to 1.
    #[error("the probabilities of state {state}, action {action} sum to {sum}; expected 1")]
    PairSum {
        /// The number of the first transition of the pair, in the order of [`CmdpBuilder::transition`].
        entry: usize,
        /// The state.
        state: usize,
        /// The action.
        action: usize,
        /// What they sum to.
        sum: f64,
    },
}

/// Collects a [`Cmdp`], refusing each bad entry as it comes. Transitions go before costs, because a cost
/// needs its pair; repeated entries add up.
#[derive(Debug, Clone)]
pub struct CmdpBuilder {
    states: usize,
    actions: usize,
    absorbing: BTreeSet<usize>,
    initial: BTreeMap<usize, f64>,
    pairs: BTreeMap<(usize, usize), Draft>,
    transitions: usize,
    secondary: Vec<Secondary>,
}

#[derive(Debug, Clone)]
struct Draft {
    entry: usize,
    successors: BTreeMap<usize, f64>,
    costs: BTreeMap<usize, f64>,
}

impl CmdpBuilder {
    /// Creates an empty model of `states` states and `actions` actions.
    pub fn new(states: usize, actions: usize) -> Self {
        Self {
            states,
            actions,
            absorbing: BTreeSet::new(),
            initial: BTreeMap::new(),
            pairs: BTreeMap::new(),
            transitions: 0,
            secondary: Vec::new(),
        }
    }

    /// Puts `state` into M.
    ///
    /// # Errors
    /// An index out of range.
    pub fn absorb(&mut self, state: usize) -> Result<(), EntryError> {
        self.check_state(state)?;
        self.absorbing.insert(state);
        Ok(())
    }

    /// Adds `probability` to β(`state`).
    ///
    /// # Errors
    /// An index out of range, or not a probability.
    pub fn initial(&mut self, state: usize, probability: f64) -> Result<(), EntryError> {
        self.check_state(state)?;
        *self.initial.entry(state).or_default() += check_probability(probability)?;
        Ok(())
    }

    /// Adds `probability` to P(`state`, `action`, `successor`), and with it the pair to the model.
    ///
    /// # Errors
    /// An index out of range, or not a probability.
    pub fn transition(
        &mut self,
        state: usize,
        action: usize,
        successor: usize,
        probability: f64,
    ) -> Result<(), EntryError> {
        self.check_pair(state, action)?;
        self.check_state(successor)?;
        let probability = check_probability(probability)?;
        let entry = self.transitions;
        self.transitions += 1;
        let draft = self.pairs.entry((state, action)).or_insert_with(|| Draft {
            entry,
            successors: BTreeMap::new(),
            costs: BTreeMap::new(),
        });
        *draft.successors.entry(successor).or_default() += probability;
        Ok(())
    }

    /// Adds `cost` to c(`state`, `action`).
    ///
    /// # Errors
    /// An index out of range, not a cost, or a pair without transitions.
    pub fn primary(&mut self, state: usize, action: usize, cost: f64) -> Result<(), EntryError> {
        self.cost(0, state, action, cost)
    }

    /// Declares the next secondary cost and returns its index.
    ///
    /// # Errors
    /// A bound that is negative or not finite.
    pub fn secondary(&mut self, name: impl Into<String>, bound: f64) -> Result<usize, EntryError> {
        if !bound.is_finite() || bound < 0.0 {
            return Err(EntryError::Bound(bound));
        }
        self.secondary.push(Secondary { name: name.into(), bound });
        Ok(self.secondary.len() - 1)
    }

    /// Adds `cost` to the secondary cost `index` of (`state`, `action`).
    ///
    /// # Errors
    /// An index out of range, not a cost, or a pair without transitions.
    ///
    /// # Panics
    /// Where `index` was not returned by [`CmdpBuilder::secondary`].
    pub fn secondary_cost(
        &mut self,
        index: usize,
        state: usize,
        action: usize,
        cost: f64,
    ) -> Result<(), EntryError> {
        assert!(index < self.secondary.len(), "secondary cost {index} was not declared");
        self.cost(index + 1, state, action, cost)
    }

    fn cost(
        &mut self,
        which: usize,
        state: usize,
        action: usize,
        cost: f64,
    ) -> Result<(), EntryError> {
        self.check_pair(state, action)?;
        if !cost.is_finite() || cost < 0.0 {
            return Err(EntryError::Cost(cost));
        }
        match self.pairs.get_mut(&(state, action)) {
            Some(draft) => *draft.costs.entry(which).or_default() += cost,
            // Costs stop on entering M, so that one stated there has no effect.
            None if self.absorbing.contains(&state) => {}
            None => return Err(EntryError::UnlistedPair { state, action }),
        }
        Ok(())
    }

    /// Builds the model.
    ///
    /// # Errors
    /// Probabilities that do not sum to 1.
    pub fn build(self) -> Result<Cmdp, ModelError> {
        let total: f64 = self.initial.values().sum();
        if (total - 1.0).abs() > SUM_TOLERANCE {
            return Err(ModelError::InitialSum(total));
        }
        let mut pairs = Vec::with_capacity(self.pairs.len());
        for ((state, action), draft) in self.pairs {
            let sum: f64 = draft.successors.values().sum();
            if (sum - 1.0).abs() > SUM_TOLERANCE {
                return Err(ModelError::PairSum { entry: draft.entry, state, action, sum });
            }
            let mut costs = vec![0.0; 1 + self.secondary.len()];
            for (which, cost) in draft.costs {
                costs[which] = cost;
            }
            let successors = draft.successors.into_iter().filter(|(_, p)| *p > 0.0).collect();
            pairs.push(Pair { state, action, successors, costs });
        }
        let first =
            (0..=self.states).map(|state| pairs.partition_point(|p| p.state < state)).collect();
        Ok(Cmdp {
            actions: self.actions,
            absorbing: (0..self.states).map(|s| self.absorbing.contains(&s)).collect(),
            initial: self.initial.into_iter().filter(|(_, p)| *p > 0.0).collect(),
            pairs,
            first,
            secondary: self.secondary,
        })
    }

    fn check_state(&self, index: usize) -> Result<(), EntryError> {
        check_index("state", index, self.states)
    }

    fn check_pair(&self, state: usize, action: usize) -> Result<(), EntryError> {
        self.check_state(state)?;
        check_index("action", action, self.actions)
    }
}

fn check_index(what: &'static str, index: usize, count: usize) -> Result<(), EntryError> {
    if index < count { Ok(()) } else { Err(EntryError::Index { what, index, count }) }
}

/// Checks a probability; rounding by a computation like `1 - slip + slip` is forgiven.
fn check_probability(p: f64) -> Result<f64, EntryError> {
    if (0.0..=1.0 + SUM_TOLERANCE).contains(&p) { Ok(p) } else { Err(EntryError::Probability(p)) }
}

#[cfg(test)]
#[path = "tests/model.rs"]
mod tests;
