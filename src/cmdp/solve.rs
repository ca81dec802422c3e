//! The programme solved by clarabel, an interior-point solver; the only file that names the crate.
//!
//! One thread, its own factorisation, no time limit (a clock would be a hole in determinism), tolerances of 1e-10: the
//! default ones leave the objective 3e-8 low. The answer is an interior point of the optimal face, which randomises
//! everywhere; [`super::vertex`] turns it into a vertex.
//!
//! 1. Write the rows in the solver's form: A x + s = b with s = 0 on flow rows, s >= 0 on bound rows and on -x <= 0.
//! 2. Solve.
//! 3. Refuse every status but a full solution.
//! 4. Return columns and slacks, rounding below zero removed.

use super::occupation::Programme;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus, ZeroConeT,
};
use thiserror::Error;

/// The result of the interior-point method.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Interior {
    /// A value for every column, slacks included; at least 0.
    pub(super) columns: Vec<f64>,
    /// How many iterations it took.
    pub(super) iterations: u32,
}

/// Why the interior-point method has no solution to give: every status of the solver other than `Solved`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum InteriorFailure {
    /// A certificate that no occupation measure meets all bounds.
    #[error("primal infeasible")]
    PrimalInfeasible,
    /// The same at reduced accuracy.
    #[error("almost primal infeasible")]
    AlmostPrimalInfeasible,
    /// A direction of endless improvement, which costs of at least 0 rule out.
    #[error("dual infeasible")]
    DualInfeasible,
    /// A solution at reduced accuracy only.
    #[error("solved at reduced accuracy only")]
    AlmostSolved,
    /// The iteration limit.
    #[error("iteration limit reached")]
    MaxIterations,
    /// The search came to a standstill.
    #[error("insufficient progress")]
    InsufficientProgress,
    /// A factorisation or a step failed.
    #[error("numerical error")]
    NumericalError,
    /// The solver refused the data or stopped for a reason that we never give it.
    #[error("the solver refused the problem")]
    Refused,
}

/// Solves the programme for its first objective with all bounds.
pub(super) fn interior(programme: &Programme) -> Result<Interior, InteriorFailure> {
    let rows = programme.rows();
    let count = programme.pairs.len();
    let bounds = rows - programme.flow_rows;
    // 1. clarabel: A x + s = b with s = 0 on flow rows, s >= 0 on bound rows and on -x <= 0.
    let mut pointers = Vec::with_capacity(count + 1);
    let mut row_indices = Vec::new();
    let mut values = Vec::new();
    pointers.push(0);
    for (j, column) in programme.columns[..count].iter().enumerate() {
        for &(row, value) in column {
            row_indices.push(row);
            values.push(value);
        }
        row_indices.push(rows + j);
        values.push(-1.0);
        pointers.push(values.len());
    }
    let matrix = CscMatrix::new(rows + count, count, pointers, row_indices, values);
    let mut rhs = programme.rhs.clone();
    rhs.resize(rows + count, 0.0);
    let cones = [ZeroConeT(programme.flow_rows), NonnegativeConeT(bounds + count)];
    // 2. Solve.
    let settings = DefaultSettingsBuilder::default()
        .verbose(false)
        .max_threads(1)
        .direct_solve_method("qdldl".to_owned())
        .max_iter(200)
        .tol_gap_abs(1e-10)
        .tol_gap_rel(1e-10)
        .tol_feas(1e-10)
        .build()
        .map_err(|_| InteriorFailure::Refused)?;
    let quadratic = CscMatrix::zeros((count, count));
    let objective = &programme.objectives[0][..count];
    let mut solver = DefaultSolver::new(&quadratic, objective, &matrix, &rhs, &cones, settings)
        .map_err(|_| InteriorFailure::Refused)?;
    solver.solve();
    // 3. Only a full solution counts.
    let solution = &solver.solution;
    match solution.status {
        SolverStatus::Solved => {}
        SolverStatus::PrimalInfeasible => return Err(InteriorFailure::PrimalInfeasible),
        SolverStatus::AlmostPrimalInfeasible => {
            return Err(InteriorFailure::AlmostPrimalInfeasible);
        }
        SolverStatus::DualInfeasible | SolverStatus::AlmostDualInfeasible => {
            return Err(InteriorFailure::DualInfeasible);
        }
        SolverStatus::AlmostSolved => return Err(InteriorFailure::AlmostSolved),
        SolverStatus::MaxIterations => return Err(InteriorFailure::MaxIterations),
        SolverStatus::InsufficientProgress => return Err(InteriorFailure::InsufficientProgress),
        SolverStatus::NumericalError => return Err(InteriorFailure::NumericalError),
        SolverStatus::Unsolved | SolverStatus::MaxTime | SolverStatus::CallbackTerminated => {
            return Err(InteriorFailure::Refused);
        }
    }
    // 4. Columns and slacks.
    let mut columns: Vec<f64> = solution.x.iter().map(|x| x.max(0.0)).collect();
    columns.extend((0..bounds).map(|i| solution.s[programme.flow_rows + i].max(0.0)));
    if columns.iter().any(|x| !x.is_finite()) {
        return Err(InteriorFailure::NumericalError);
    }
    Ok(Interior { columns, iterations: solution.iterations })
}
