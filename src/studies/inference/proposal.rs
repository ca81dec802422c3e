//! What one trial of an inference says: all that a building has to do with the observed table.

/// A proposal.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Proposal {
    /// By hold-out: the logarithm of the likelihood of what is learned from, averaged over the prior in this building.
    pub ln_evidence: Vec<f64>,
    /// By prior and value, where it has several: the same for that value alone.
    pub by_value: Vec<Vec<f64>>,
    /// Draws of the posterior in this building.
    pub draws: Vec<Drawn>,
    /// Draws of the prior in it.
    pub prior: Vec<Drawn>,
    /// By hold-out but the first: the expected shares of the first outcome in the cells held out, given the others.
    pub held: Vec<Vec<(usize, f64)>>,
    /// By simulated table.
    pub simulated: Vec<Below>,
}

/// A draw: what is supposed, and what that predicts.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Drawn {
    /// Placements, then priors (numbers, or indices of values), then the index of the concentration.
    pub values: Vec<f64>,
    /// By cell: the probabilities of the first and the second outcome.
    pub cells: Vec<[f64; 2]>,
    /// By cell: the mean time (s) of the first outcome, where it ever happens. Empty where no times are learned from.
    pub times: Vec<Option<f64>>,
}

impl Drawn {
    /// Returns the index of the concentration, which says how far the model is trusted.
    pub fn trust(&self) -> usize {
        let last = self.values.last().copied().unwrap_or_default();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "an index, as draws hold it"
        )]
        let trust = last as usize;
        trust
    }
}

/// What a building says of a simulated table.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Below {
    /// The logarithm of its likelihood, averaged over the prior.
    pub ln_evidence: f64,
    /// By continuous prior: the same of the draws that are below the truth.
    pub below: Vec<f64>,
}
