//! The planner of the deadline study: constrained MDPs with total costs, solved exactly.
//!
//! A robot in a state x takes an action a, pays c(x, a), and arrives somewhere by chance; it stops on entering an
//! absorbing set M. Sought is the randomised policy with the least expected total cost among those that
//! reach M with certainty and keep the expected totals of further costs within bounds (Altman 1999; the
//! deadline study, section 3).
//!
//! - [`Cmdp`], built by [`CmdpBuilder`]: the model, valid by construction.
//! - [`prune`]: the states from which arrival can be sure at all.
//! - [`solve()`], [`solve_with`]: a policy with at most as many randomised states as there are bounds, with
//!   its exact totals; or that there is none; or an error, never a doubtful policy.
//! - [`evaluate`]: the exact costs of any policy.
//! - [`document`]: models as JSON files.

mod basis;
mod chain;
pub mod document;
mod improvement;
mod lexicographic;
mod model;
mod occupation;
mod policy;
pub mod prune;
mod solve;
mod vertex;

pub use document::{DocumentError, solve_document};
pub use lexicographic::{
    BOUND_TOLERANCE, Effort, Infeasible, MAX_STATES, Outcome, Relaxation, Solution, SolveError,
    Unmeetable, solve, solve_with,
};
pub use model::{Cmdp, CmdpBuilder, EntryError, ModelError, Pair, Secondary};
pub use policy::{Policy, evaluate};
pub use solve::InteriorFailure;

#[cfg(test)]
mod tests;
