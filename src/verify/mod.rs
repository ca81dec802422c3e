//! Is this bundle what it says? A ladder from "safe to open" to "every trial again, bit for bit" and "fresh seeds agree".
//!
//! [`climb`] collects every [`Finding`] of the levels asked for and reports the rung reached. Checksums (level 1) only
//! show that nothing changed since they were computed; from level 3 on, a forger would have to make the engine agree.

mod asked;
mod attestation;
mod brief;
mod closeness;
mod coherent;
mod derived;
mod difference;
mod earlier;
mod finding;
mod fixity;
mod ladder;
mod pipeline;
mod reexecution;
mod replan;
mod replication;
mod report;
mod signature;
mod support;

#[cfg(test)]
mod tests;

pub use asked::{Options, Reviewer, Rows};
pub use attestation::{AttestError, Attestation, Envelope, LONGEST as LONGEST_ATTESTATION};
pub use brief::Brief;
pub use closeness::{Apart, Closeness};
pub use earlier::{Earlier, EarlierAgain, Made};
pub use finding::{Finding, Level, Severity};
pub use ladder::{Report, Verdict, climb, climb_and_keep, climb_for};
pub use pipeline::{
    ContentError, MakeAgainError, Pipeline, PlannedTrial, ReplanError, Replanned, ReplicateError,
};
pub use reexecution::Sample;
pub use replan::{Errand, Executed, Reenactment, plan_of};
pub use replication::{ClaimAgain, Replication, VerdictStanding};
#[cfg(feature = "shell")]
pub(crate) use report::printable;
pub use signature::{NAMESPACE, Signed, Trust, Vouching, path_in_bag};
