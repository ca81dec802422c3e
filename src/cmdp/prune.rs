//! The states and pairs that can take part in a policy that surely reaches the absorbing set.
//!
//! The occupation-measure programme is only right among those: elsewhere its rows are dependent, or it is
//! infeasible for the wrong reason. The set is the greatest fixpoint (outer) of a least fixpoint (inner):
//! the largest S such that every state of S can reach M with positive probability by pairs that never leave
//! S ∪ M (de Alfaro 1997, "Formal verification of probabilistic systems", almost-sure reachability).

use super::model::{Cmdp, Pair};

/// The states from which some policy reaches M with probability 1, and the pairs that stay among them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Sure {
    /// By state; absorbing states count.
    pub states: Vec<bool>,
    /// By index into [`Cmdp::pairs`]: all successors are sure, and the state is not absorbing.
    pub pairs: Vec<bool>,
    /// By state: a pair that comes closer to M with positive probability. Taking it everywhere is a policy
    /// that surely arrives. `None` for absorbing states and for those that are not sure.
    pub approach: Vec<Option<usize>>,
}

impl Sure {
    /// Computes the nested fixpoint on the pairs of `cmdp` that are `usable`.
    pub fn of(cmdp: &Cmdp, usable: impl Fn(&Pair) -> bool) -> Self {
        let pairs = cmdp.pairs();
        let mut arrivals = vec![Vec::new(); cmdp.states()];
        for (index, pair) in pairs.iter().enumerate() {
            for (y, _) in pair.elsewhere() {
                arrivals[y].push(index);
            }
        }
        let mut states = vec![true; cmdp.states()];
        loop {
            let inside: Vec<bool> = pairs
                .iter()
                .map(|pair| {
                    !cmdp.is_absorbing(pair.state)
                        && states[pair.state]
                        && usable(pair)
                        && pair.successors.iter().all(|(y, _)| states[*y])
                })
                .collect();
            let mut reached: Vec<bool> = (0..cmdp.states()).map(|x| cmdp.is_absorbing(x)).collect();
            let mut approach = vec![None; cmdp.states()];
            let mut frontier: Vec<usize> = (0..cmdp.states()).filter(|x| reached[*x]).collect();
            // Breadth first, so that `approach` is also short.
            while !frontier.is_empty() {
                let mut next = Vec::new();
                for &y in &frontier {
                    for &index in &arrivals[y] {
                        let x = pairs[index].state;
                        if inside[index] && !reached[x] {
                            reached[x] = true;
                            approach[x] = Some(index);
                            next.push(x);
                        }
                    }
                }
                frontier = next;
            }
            if reached == states {
                return Self { states, pairs: inside, approach };
            }
            states = reached;
        }
    }

    /// Returns the non-absorbing states that sure pairs can reach from β, or `None` where β is not wholly sure: then no
    /// policy surely arrives.
    pub fn reachable(&self, cmdp: &Cmdp) -> Option<Vec<bool>> {
        let mut reached = vec![false; cmdp.states()];
        let mut stack = Vec::new();
        for &(x, _) in cmdp.initial() {
            if !self.states[x] {
                return None;
            }
            if !cmdp.is_absorbing(x) {
                reached[x] = true;
                stack.push(x);
            }
        }
        while let Some(x) = stack.pop() {
            for index in cmdp.pairs_of(x).filter(|index| self.pairs[*index]) {
                for (y, _) in cmdp.pairs()[index].elsewhere() {
                    if !reached[y] && !cmdp.is_absorbing(y) {
                        reached[y] = true;
                        stack.push(y);
                    }
                }
            }
        }
        Some(reached)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cmdp::model::CmdpBuilder;

    /// Returns a model: 0 -> goal 4 by action 0 surely, by action 1 with a trap 3 (no action of its own) in between; 1
    /// only by the trapped action; 2 only into 1; 5 loops between 5 and 0.
    fn trapped() -> Cmdp {
        let mut builder = CmdpBuilder::new(6, 2);
        builder.absorb(4).unwrap();
        builder.initial(0, 1.0).unwrap();
        for (x, a, y, p) in [
            (0, 0, 4, 1.0),
            (0, 1, 4, 0.9),
            (0, 1, 3, 0.1),
            (1, 0, 3, 0.5),
            (1, 0, 4, 0.5),
            (2, 0, 1, 1.0),
            (2, 1, 2, 1.0),
            (5, 0, 5, 1.0),
            (5, 1, 0, 1.0),
        ] {
            builder.transition(x, a, y, p).unwrap();
        }
        builder.build().unwrap()
    }

    #[test]
    fn traps_dead_ends_and_those_that_only_lead_there_are_dropped() {
        let cmdp = trapped();
        let sure = Sure::of(&cmdp, |_| true);
        assert_eq!(sure.states, [true, false, false, false, true, true]);
        // In order: (0,0) (0,1) (1,0) (2,0) (2,1) (5,0) (5,1).
        assert_eq!(sure.pairs, [true, false, false, false, false, true, true]);
        assert_eq!(sure.approach, [Some(0), None, None, None, None, Some(6)]);
        assert_eq!(
            sure.reachable(&cmdp).unwrap(),
            [true, false, false, false, false, false],
            "5 is sure but nothing leads there"
        );
    }

    #[test]
    fn no_absorbing_state_means_nobody_arrives() {
        let mut builder = CmdpBuilder::new(1, 1);
        builder.initial(0, 1.0).unwrap();
        builder.transition(0, 0, 0, 1.0).unwrap();
        let cmdp = builder.build().unwrap();
        let sure = Sure::of(&cmdp, |_| true);
        assert_eq!(sure.states, [false]);
        assert_eq!(sure.reachable(&cmdp), None);
    }
}
