//! Running a plan: trials on all cores, finished ones kept, records back in plan order.
//!
//! The runner knows neither files nor terminals: a [`TrialStore`] keeps records, an [`Observer`] receives progress.

mod event;
mod executor;
mod scheduler;
mod trial_store;
mod twice;

pub use event::{Observer, RunEvent, Silent};
pub use executor::{Executor, Mock};
pub use scheduler::{RunError, Scheduler};
pub use trial_store::{StoreError, TrialStore};
pub use twice::{Nondeterminism, Twice};

#[cfg(test)]
mod tests;
