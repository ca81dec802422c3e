//! What a verdict depends on besides the trials.

use crate::table::Table;
use std::collections::BTreeMap;

/// What a verdict depends on besides the trials.
#[derive(Debug, Clone, Copy)]
pub struct Context<'a> {
    /// The paper's tables by name (contract: [`super::published`]).
    pub published: &'a BTreeMap<String, Table>,
    /// Factors over which the trials share their noise.
    pub shared_noise: &'a [String],
    /// The factor whose values are draws of a posterior, where there is one: what holds in each of them holds in a share of draws.
    pub draws: Option<&'a str>,
    /// Seed of resampling: the experiment's.
    pub seed: u64,
    /// Bootstrap resamples.
    pub resamples: u32,
    /// Permutations drawn.
    pub permutations: u32,
}

impl<'a> Context<'a> {
    /// Makes the context of a study: 2000 bootstrap resamples, 9999 permutations.
    pub fn new(
        published: &'a BTreeMap<String, Table>,
        shared_noise: &'a [String],
        seed: u64,
    ) -> Self {
        Self { published, shared_noise, draws: None, seed, resamples: 2000, permutations: 9999 }
    }

    /// Returns the same where the values of the factor `draws` are draws of a posterior.
    #[must_use]
    pub fn over_draws(self, draws: Option<&'a str>) -> Self {
        Self { draws, ..self }
    }
}
