//! Claims of a paper as data, and what the trials say of them.
//!
//! [`Claim::check`] finds the faults of a claim before anything runs, [`judge`] holds it against the trials
//! table, [`power::power`] says beforehand what a number of trials would decide.
//!
//! A verdict is supported, contradicted, inconclusive or cannot-be-tested. What the paper says
//! ([`Claim::words`]), what its own table shows ([`Claim::paper_table`]) and what we find
//! ([`ClaimVerdict::judgement`]) stay three facts: none is computed from another.
//!
//! The rules (`docs/claims.md`): a p-value above alpha is never evidence of equality; runs that did not reach a
//! measure are counted and never silently dropped; trials that share their noise are refused by tests that
//! need independence; wall times belong to the circumstance half and cannot decide a result.

mod assume;
mod cannot_test;
pub mod cells;
mod check;
mod claim;
mod compared;
mod context;
mod faults;
pub mod forms;
mod gather;
mod judge;
pub mod metric;
pub mod multiverse;
pub mod observations;
pub mod power;
pub mod published;
mod score;
pub mod sensitivity;
pub(crate) mod statement;
pub mod terms;
pub mod tidy;
pub mod verdict;
mod words;

pub use assume::{Assume, AssumedCell};
pub use check::check_all;
pub use claim::Claim;
pub use compared::compared;
pub use context::Context;
pub use faults::{ClaimFault, Known};
pub use forms::Expect;
pub use judge::{judge, judge_observations, not_measured, share_of_draws};
pub use multiverse::Multiverse;
pub use observations::Observations;
pub use score::Score;
pub use sensitivity::Sensitivity;
pub use verdict::{ClaimVerdict, Judgement};
pub use words::{PaperTable, Words};

#[cfg(test)]
mod tests;
