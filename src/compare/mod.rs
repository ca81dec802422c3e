//! What changed: two bundles, a bundle and a lock, or two locks, held against one another.
//!
//! Each side is an [`Account`], the result half by meaning: what was asked (inputs, engine, settings), what
//! came out (conditions, trials) and what was made of it (tables, figures, verdicts). [`compare`] yields a
//! [`Comparison`], a list of [`Discrepancy`]s in the order in which one would look for a cause: cheapest first.
//! Circumstances (dates, hosts, durations) are no part of an account, so they never count as change.
//!
//! A [`Lock`] is the small text beside a manifest that pins what its run yields. Nothing that is sealed, printed or
//! scored is ever read from one.

mod account;
mod advice;
mod comparison;
mod derived;
mod discrepancy;
mod human;
mod lock;
mod sections;
mod settings;
mod tolerance;
mod trials;

pub use account::{Account, ConditionAccount, ResultFile, Told, TrialAccount};
pub use advice::{Cause, drift};
pub use comparison::{Comparison, Extent, Matching, Party, compare};
pub use discrepancy::{Change, Discrepancy, MeasureChange, TrialDifference};
pub use lock::{LOCK_FORMAT, Lock, LockError, NotLockable};
pub use sections::{Row, Section};
pub use settings::Settings;
pub use tolerance::{Tolerance, Tolerances};

#[cfg(test)]
mod tests;
