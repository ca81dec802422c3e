//! What a reviewer asks of a climb, and what they bring along.

use super::signature::Vouching;
use super::{Level, Report};
use crate::bundle::Moment;

/// How far to climb.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Options {
    /// The highest level to judge.
    pub level: Level,
    /// How many trials level 4 executes.
    pub sample: usize,
    /// How many rows of the robustness and of the multiverse table are run again; as many as the level takes where nothing is said.
    pub rows: Option<Rows>,
    /// The reviewer's seed for drawing them, and for level 6 the experiment's; the bundle's author must not know it
    /// beforehand.
    pub seed: u64,
}

/// Rows of a robustness or multiverse table: each is a run of the study at other values of its settings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rows {
    /// So many, drawn with the reviewer's seed.
    Drawn(usize),
    /// All of them.
    All,
}

/// What a reviewer brings along besides the bundle.
#[derive(Clone, Copy)]
pub struct Reviewer<'a> {
    /// Who must vouch for the bundle.
    pub vouching: Vouching<'a>,
    /// Seconds since some instant, to tell how long each level took.
    pub clock: &'a dyn Fn() -> f64,
    /// Is shown the report as it stands whenever a level has been judged: what that says of higher levels is not final.
    pub judged: &'a dyn Fn(&Report),
}

impl Reviewer<'_> {
    /// Creates a reviewer who asks for no signature and has no clock.
    pub fn anonymous() -> Self {
        let vouching = Vouching { trust: None, signature: None, now: Moment(0) };
        Self { vouching, clock: &|| 0.0, judged: &|_| () }
    }
}

impl std::fmt::Debug for Reviewer<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Reviewer").field("vouching", &self.vouching).finish_non_exhaustive()
    }
}
