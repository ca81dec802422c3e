//! Which verdicts hang on what the paper leaves open, where all of it is left open at once: every claim judged again at draws of a
//! Latin hypercube over the stated ranges, on the same trial numbers and the same noise (a multiverse analysis: Steegen et al. 2016).
//!
//! | file | holds |
//! |---|---|
//! | `choice` | one choice: the values that it may have, and its dimension of the hypercube |
//! | `draws` | what was drawn and what became of the claims |
//! | `table` | the same as CSV |
//! | `explained` | the share of draws that support each claim, and how much of its change each choice explains |
//! | `matrix` | that as tables |

mod choice;
mod draws;
mod explained;
mod matrix;
mod table;

pub use choice::{Choice, Domain, Scale};
pub use draws::{Draw, Found, Multiverse, Verdict};
pub use explained::{Explained, Explanation, LEAST_DRAWS, Quantity, STANDS_OUT};
pub use matrix::short;
pub use table::{MOST_CELLS, MultiverseError, Prefix, prefixed};
