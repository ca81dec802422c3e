//! The complete solution of a constrained MDP, in lexicographic order: primary cost, then each secondary cost.
//!
//! The order is the tie-break that the deadline study needs and does not state: fast and slow take the same number of
//! steps, so that without it the speed would be whatever a solver's column order gives. With it the expected totals are
//! unique, and independent of how states and actions are numbered.
//!
//! 1. Drop what cannot take part in a policy that surely arrives ([`super::prune`]).
//! 2. Solve the occupation-measure programme by interior point ([`super::solve`]).
//! 3. Purify to a vertex; where the solver reports anything but a solution, start at the vertex of the best
//!    policy without bounds instead and impose the bounds one by one. What cannot be met is found here.
//! 4. Certify or improve the vertex by pivots, criterion by criterion, each on the optimal face of the last.
//! 5. Read the policy off, and evaluate it exactly. The values reported are these.
//! 6. Compare them with the bounds, and the primary with a lower bound by weak duality that owes nothing to steps 2 to
//!    4 but the multipliers.

use super::improvement::lexicographic_best;
use super::model::{Cmdp, Pair};
use super::occupation::{Overflow, Programme};
use super::policy::{Policy, evaluate, of_vertex};
use super::prune::Sure;
use super::solve::{InteriorFailure, interior};
use super::vertex::{Stalled, Vertex};
use thiserror::Error;

/// Relative excess over a bound that is called rounding.
pub const BOUND_TOLERANCE: f64 = 1e-9;
/// The same for a bound or an optimum of zero, relative to the largest cost.
const ZERO_BOUND_TOLERANCE: f64 = 1e-12;

/// The handling of a bound that no policy meets together with the bounds before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unmeetable {
    /// The answer is "infeasible".
    Refuse,
    /// Achieve the least total that is possible, and solve for the other criteria with that as bound.
    AchieveLeast,
    /// Solve without the bound.
    Drop,
}

/// The answer to a constrained MDP.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// A policy that surely arrives and is best.
    Optimal(Solution),
    /// No policy surely arrives and meets the bounds that may not be relaxed.
    Infeasible(Infeasible),
}

/// Why there is no policy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Infeasible {
    /// No policy reaches the absorbing set with certainty.
    NoSureArrival,
    /// None does so without ever paying a cost whose bound is zero.
    ZeroBounds,
    /// A bound cannot be met together with those before it.
    Bound {
        /// Which secondary cost.
        index: usize,
        /// The least expected total of the policies that meet the bounds before it.
        least: f64,
    },
}

/// A policy and its exact expected totals.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// Expected primary total.
    pub primary: f64,
    /// Expected secondary totals, in the model's order.
    pub secondary: Vec<f64>,
    /// The policy itself.
    pub policy: Policy,
    /// λ ≥ 0 per bound: the primary cost that one unit more of it would save; 0 for relaxed bounds.
    pub multipliers: Vec<f64>,
    /// Bounds that could not be met, with their handling; empty for a policy within all bounds.
    pub relaxed: Vec<Relaxation>,
    /// How the solution was found.
    pub effort: Effort,
}

/// A bound that could not be met.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relaxation {
    /// Which secondary cost.
    pub index: usize,
    /// Its handling.
    pub how: Unmeetable,
    /// The least expected total of the policies that meet the bounds before it.
    pub least: f64,
}

/// The effort of finding a solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Effort {
    /// Iterations of the interior-point method, or why it gave no solution to start from. The solution is
    /// certified by pivoting in either case. `None` where there was nothing to solve.
    pub interior: Option<Result<u32, InteriorFailure>>,
    /// Pivots from the starting point to the vertex.
    pub pivots: usize,
}

/// Failure to find an answer that may exist.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SolveError {
    /// Too large for dense algebra.
    #[error("{states} states take part; expected at most {MAX_STATES}")]
    TooLarge {
        /// How many states can be reached and surely arrive.
        states: usize,
    },
    /// Costs and probabilities whose products leave the range of floating point.
    #[error("costs or expected totals exceed the range of floating point; scale the costs")]
    Overflow,
    /// Pivoting did not end.
    #[error(
        "no solution could be certified: rounding dominates (interior point: {interior}); scale the costs \
         or drop probabilities that are next to zero"
    )]
    Numerical {
        /// The result of the interior-point method.
        interior: String,
    },
    /// The policy's exact evaluation does not confirm the programme's solution.
    #[error(
        "the policy found has an expected {name} of {total}, above its bound {bound}: rounding dominates; \
         scale the costs or drop probabilities that are next to zero"
    )]
    Unconfirmed {
        /// The secondary cost's name.
        name: String,
        /// Its exact expected total.
        total: f64,
        /// Its bound.
        bound: f64,
    },
    /// The multipliers do not confirm that the solution is optimal.
    #[error(
        "the policy found costs {primary}, and {lower} could not be ruled out: rounding dominates; \
         scale the costs or drop probabilities that are next to zero"
    )]
    Uncertified {
        /// Its exact expected primary total.
        primary: f64,
        /// A lower bound on the cost of every policy within the bounds.
        lower: f64,
    },
}

/// Relative gap between a solution and its lower bound that is called rounding.
const GAP: f64 = 1e-8;

impl From<Overflow> for SolveError {
    fn from(_: Overflow) -> Self {
        Self::Overflow
    }
}

/// The largest number of states that may take part.
pub const MAX_STATES: usize = 2000;

/// Solves `cmdp` with every bound as it is.
///
/// # Errors
/// A model too large or too badly scaled; never for one that is merely infeasible.
pub fn solve(cmdp: &Cmdp) -> Result<Outcome, SolveError> {
    solve_with(cmdp, &vec![Unmeetable::Refuse; cmdp.secondary().len()])
}

/// Solves `cmdp`, handling bounds that cannot be met by `handling`, one entry per secondary cost. Bounds are
/// imposed in the model's order, so that the first to be relaxed is declared last. The steps are those of the module
/// documentation.
///
/// # Errors
/// As [`solve`].
///
/// # Panics
/// Where `handling` does not have one entry per secondary cost.
pub fn solve_with(cmdp: &Cmdp, handling: &[Unmeetable]) -> Result<Outcome, SolveError> {
    assert_eq!(handling.len(), cmdp.secondary().len(), "one handling per secondary cost");
    // 1. Prune.
    let sure = Sure::of(cmdp, |_| true);
    if sure.reachable(cmdp).is_none() {
        return Ok(Outcome::Infeasible(Infeasible::NoSureArrival));
    }
    // A bound of zero forbids every pair that costs. Imposed here, it is kept exactly.
    let forbidding: Vec<usize> = (0..handling.len())
        .filter(|i| handling[*i] == Unmeetable::Refuse && cmdp.secondary()[*i].bound == 0.0)
        .collect();
    let free = |pair: &Pair| forbidding.iter().all(|i| pair.costs[i + 1] == 0.0);
    let allowed = Sure::of(cmdp, free);
    let Some(reachable) = allowed.reachable(cmdp) else {
        return Ok(Outcome::Infeasible(Infeasible::ZeroBounds));
    };
    let states = reachable.iter().filter(|r| **r).count();
    let acting = sure.approach.iter().flatten().count();
    if states.max(acting) > MAX_STATES {
        return Err(SolveError::TooLarge { states: states.max(acting) });
    }
    let programme = Programme::new(cmdp, &allowed, &reachable)?;
    let criteria = model_criteria(cmdp);

    // 2. Solve by interior point.
    let start = interior_or_nothing(&programme);
    let found = start.as_ref().and_then(|result| result.as_ref().ok());
    let mut effort = Effort {
        interior: start
            .as_ref()
            .map(|result| result.as_ref().map(|i| i.iterations).map_err(|e| *e)),
        pivots: 0,
    };
    let numerical = |effort: &Effort| SolveError::Numerical {
        interior: match effort.interior {
            None => "not needed".to_owned(),
            Some(Ok(_)) => "solved".to_owned(),
            Some(Err(failure)) => failure.to_string(),
        },
    };
    let stalled = |_: Stalled| numerical(&effort);

    // 3. A vertex: purified, or that of the best policy without bounds, with the bounds imposed one by one.
    let mut relaxed = Vec::new();
    let mut kept_to_a_face = !forbidding.is_empty();
    let purified = found.and_then(|i| Vertex::of_interior(&programme, &i.columns));
    let mut vertex = if let Some(vertex) = purified {
        vertex
    } else {
        let best = lexicographic_best(cmdp, &allowed, &criteria);
        let columns: Vec<usize> = (0..programme.pairs.len())
            .filter(|j| {
                let index = programme.pairs[*j];
                best[cmdp.pairs()[index].state] == Some(index)
            })
            .collect();
        let mut vertex =
            Vertex::of_policy(&programme, &columns).ok_or_else(|| numerical(&effort))?;
        for (i, how) in handling.iter().enumerate() {
            let Some(optimum) = vertex.impose(i).map_err(stalled)? else { continue };
            let excess = -vertex.slack(i);
            let bound = cmdp.secondary()[i].bound;
            let tolerance = if bound > 0.0 { BOUND_TOLERANCE } else { ZERO_BOUND_TOLERANCE };
            let knife_edge = excess <= tolerance;
            if knife_edge || *how == Unmeetable::AchieveLeast {
                // Solving on the face of least total is solving with that total as the bound, without the knife edge.
                vertex.keep_to(&optimum);
                kept_to_a_face = true;
            }
            vertex.release(i);
            if !knife_edge {
                let least = bound + excess * programme.bound_scale[i];
                if *how == Unmeetable::Refuse {
                    return Ok(Outcome::Infeasible(Infeasible::Bound { index: i, least }));
                }
                relaxed.push(Relaxation { index: i, how: *how, least });
            }
        }
        vertex
    };

    // 4. Criterion by criterion, each on the optimal face of the last.
    let mut multipliers = vec![0.0; handling.len()];
    for (k, costs) in programme.objectives.iter().enumerate() {
        let optimum = vertex.optimise(costs).map_err(stalled)?;
        if k == 0 {
            for (i, y) in optimum.bound_multipliers.iter().enumerate() {
                multipliers[i] =
                    (-y).max(0.0) * programme.objective_scale[0] / programme.bound_scale[i];
            }
        }
    }
    effort.pivots = vertex.pivots;

    // 5. Read the policy off and evaluate it.
    let fallback = fallback(cmdp, &sure, &criteria, &multipliers, &relaxed);
    // A share of 1e-13 is rounding of zero, unless what it buys costs 1e13 as much as the rest: then the exact totals
    // show it, and it is kept.
    let mut confirmed = Err(numerical(&effort));
    for negligible in [1e-12, 1e-15, 0.0] {
        let policy = of_vertex(cmdp, &programme, &vertex, &fallback, negligible);
        let Some(totals) = evaluate(cmdp, &policy) else { continue };
        if totals.iter().chain(&multipliers).any(|total| !total.is_finite()) {
            return Err(SolveError::Overflow);
        }
        // 6. Compare with the bounds, then with the lower bound.
        confirmed = confirm(cmdp, &programme, &totals[1..], &relaxed).map(|()| (policy, totals));
        if confirmed.is_ok() {
            break;
        }
    }
    let (policy, totals) = confirmed?;
    if relaxed.is_empty() && !kept_to_a_face {
        certify(cmdp, &fallback, &multipliers, totals[0])?;
    }
    Ok(Outcome::Optimal(Solution {
        primary: totals[0],
        secondary: totals[1..].to_vec(),
        policy,
        multipliers,
        relaxed,
        effort,
    }))
}

/// Returns the interior point, or `None` where every state of β is absorbing and there is nothing to solve.
fn interior_or_nothing(
    programme: &Programme,
) -> Option<Result<super::solve::Interior, InteriorFailure>> {
    (programme.flow_rows > 0).then(|| interior(programme))
}

/// Returns the cost of each pair of the model per criterion.
fn model_criteria(cmdp: &Cmdp) -> Vec<Vec<f64>> {
    (0..=cmdp.secondary().len())
        .map(|k| cmdp.pairs().iter().map(|pair| pair.costs[k]).collect())
        .collect()
}

/// Chooses the pairs for states that the policy never visits (a wrong door, a mistaken vertex): the best by the costs
/// that the solution put on everything, c + Σ λᵢ cᵢ; then by the secondary costs in order, then by steps. Where a bound
/// had to be relaxed to the least achievable, that cost comes first.
fn fallback(
    cmdp: &Cmdp,
    sure: &Sure,
    criteria: &[Vec<f64>],
    multipliers: &[f64],
    relaxed: &[Relaxation],
) -> Vec<Option<usize>> {
    let lagrangian = cmdp
        .pairs()
        .iter()
        .map(|pair| {
            let priced = pair.costs[1..].iter().zip(multipliers).map(|(c, lambda)| c * lambda);
            pair.costs[0] + priced.sum::<f64>()
        })
        .collect();
    let urgent = relaxed.iter().filter(|r| r.how == Unmeetable::AchieveLeast);
    let order: Vec<Vec<f64>> = urgent
        .map(|r| criteria[r.index + 1].clone())
        .chain(std::iter::once(lagrangian))
        .chain(criteria[1..].iter().cloned())
        .collect();
    lexicographic_best(cmdp, sure, &order)
}

/// Certifies the optimum by weak duality: no policy within the bounds costs less than the best one without bounds by c
/// + Σ λᵢ cᵢ, which is the fallback, minus Σ λᵢ Dᵢ.
fn certify(
    cmdp: &Cmdp,
    fallback: &[Option<usize>],
    multipliers: &[f64],
    primary: f64,
) -> Result<(), SolveError> {
    let choices = fallback
        .iter()
        .map(|pair| pair.iter().map(|index| (cmdp.pairs()[*index].action, 1.0)).collect())
        .collect();
    let lower = evaluate(cmdp, &Policy::new(cmdp, choices)).map_or(f64::NEG_INFINITY, |totals| {
        let priced = multipliers.iter().zip(cmdp.secondary()).zip(&totals[1..]);
        totals[0] + priced.map(|((lambda, s), total)| lambda * (total - s.bound)).sum::<f64>()
    });
    // Where the optimum is zero, rounding is relative to what a step may cost.
    let dearest = cmdp.pairs().iter().fold(0.0_f64, |most, pair| most.max(pair.costs[0]));
    if primary - lower <= GAP * primary + ZERO_BOUND_TOLERANCE * dearest {
        Ok(())
    } else {
        Err(SolveError::Uncertified { primary, lower })
    }
}

/// Compares the exact totals with the bounds, or with the least that was achievable.
fn confirm(
    cmdp: &Cmdp,
    programme: &Programme,
    totals: &[f64],
    relaxed: &[Relaxation],
) -> Result<(), SolveError> {
    for (i, (secondary, total)) in cmdp.secondary().iter().zip(totals).enumerate() {
        let bound = match relaxed.iter().find(|r| r.index == i) {
            Some(Relaxation { how: Unmeetable::Drop, .. }) => continue,
            Some(relaxation) => relaxation.least,
            None => secondary.bound,
        };
        let allowed = if secondary.bound > 0.0 {
            bound * (1.0 + BOUND_TOLERANCE)
        } else {
            bound + ZERO_BOUND_TOLERANCE * programme.bound_scale[i]
        };
        if *total > allowed {
            return Err(SolveError::Unconfirmed {
                name: secondary.name.clone(),
                total: *total,
                bound,
            });
        }
    }
    Ok(())
}
