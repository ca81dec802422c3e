//! Which verdicts hang on what the paper leaves open: every claim judged again with one setting at a time moved to
//! the other values that its manifest states, on the same trial numbers and the same noise.

mod rows;
mod table;
mod words;

pub use rows::{Attempt, Flip, Run, Sensitivity};
pub use table::SensitivityError;
pub use words::in_words;
