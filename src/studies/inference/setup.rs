//! The setup of a condition of an inference: the study's own, and what all conditions share.

use super::{Drawn, Inference, Likelihoods, Printed, Proposal, Proposing};
use crate::digest::Sha256Digest;
use crate::geometry::Pose;
use crate::rng::{Seeds, Stream};
use crate::robot::Robot;
use crate::stats::importance;
use crate::studies::recording::Recording;
use crate::studies::{Outcome, Setup, Stopwatch, StudyKind, StudySetup, TrialRecord, TrialSpec};
use crate::world::World;
use serde_json::{Map, Value, json};
use std::fmt;
use std::sync::{Arc, OnceLock};

/// What all conditions of an inference share.
pub struct Shared {
    /// What is inferred.
    pub inference: Inference,
    proposing: &'static dyn Proposing,
    seed: u64,
    /// The study's own setups: one of every building.
    buildings: Vec<Setup>,
    /// Digest of what they are, on which simulated tables depend.
    meaning: Sha256Digest,
    tables: OnceLock<Result<Tables, String>>,
}

/// The observed table and the simulated ones.
struct Tables {
    likelihoods: Likelihoods,
    truths: Vec<Drawn>,
}

impl fmt::Debug for Shared {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.inference.fmt(f)
    }
}

/// The setup of a condition.
#[derive(Debug, Clone)]
pub struct InferenceSetup {
    own: Setup,
    shared: Arc<Shared>,
}

impl Shared {
    /// Creates what the conditions with these setups share; `meaning` is of all their worlds. `None` where `study` proposes nothing.
    pub fn new(
        inference: Inference,
        study: StudyKind,
        seed: u64,
        buildings: Vec<Setup>,
        meaning: Sha256Digest,
    ) -> Option<Self> {
        let proposing = study.proposing()?;
        let tables = OnceLock::new();
        Some(Self { inference, proposing, seed, buildings, meaning, tables })
    }

    /// Returns how the study proposes.
    pub fn proposing(&self) -> &'static dyn Proposing {
        self.proposing
    }

    /// Returns the names of what is supposed, in the order of a draw's values.
    pub fn quantities(&self) -> Vec<String> {
        let mut names = self.proposing.placements(&self.inference);
        names.extend(self.inference.priors.iter().map(|prior| prior.path.clone()));
        names.push("concentration".to_owned());
        names
    }

    fn tables(&self) -> Result<&Tables, String> {
        self.tables.get_or_init(|| self.simulate()).as_ref().map_err(Clone::clone)
    }

    /// Returns the tables made by known draws of the prior, in buildings that are drawn too.
    fn simulate(&self) -> Result<Tables, String> {
        let observed = &self.inference.observed;
        let mut tables = vec![observed.cells.iter().map(super::ObservedCell::printed).collect()];
        let mut truths = Vec::new();
        for table in 0..self.inference.simulated_tables {
            let coordinates = vec![("simulated-table".to_owned(), table.to_string())];
            let seeds = Seeds::new(self.seed, coordinates);
            let building = pick(&mut seeds.stream("building"), self.buildings.len());
            let truth =
                self.proposing.predict(&self.buildings[building], &self.inference, &seeds)?;
            let mut stream = seeds.stream("counts");
            let trust = truth.trust();
            let concentration = self.inference.concentration[trust];
            let mut timing = seeds.stream("times");
            let made = observed.cells.iter().enumerate().map(|(at, cell)| {
                let expected = truth.cells[at];
                let counts = draw_counts(expected, concentration, cell.trials(), &mut stream);
                let expected_s = truth.times.get(at).copied().flatten();
                let how = self.inference.times.as_ref().zip(expected_s);
                let time_s = how.and_then(|(how, expected_s)| {
                    how.draw(expected_s, counts[0], trust, &mut timing)
                });
                Printed { counts, time_s }
            });
            tables.push(made.collect::<Vec<_>>());
            truths.push(truth);
        }
        Ok(Tables { likelihoods: Likelihoods::of(&self.inference, &tables), truths })
    }
}

/// Draws counts of `trials` by Pólya's urn, which is what a Dirichlet-multinomial distribution gives: every outcome drawn makes
/// itself more likely.
pub(super) fn draw_counts(
    [first, second]: [f64; 2],
    concentration: f64,
    trials: u32,
    stream: &mut Stream,
) -> [u32; 3] {
    let mut counts = [0_u32; 3];
    let third = (1.0 - first - second).max(0.0);
    for _ in 0..trials {
        let mut urn = [first, second, third];
        for (share, count) in urn.iter_mut().zip(counts) {
            *share = concentration * *share + f64::from(count);
        }
        if let Some(outcome) = importance::draw(&urn, stream) {
            counts[outcome] += 1;
        }
    }
    counts
}

fn pick(stream: &mut Stream, count: usize) -> usize {
    usize::try_from(stream.below(count.max(1) as u64)).unwrap_or_default()
}

impl InferenceSetup {
    /// Creates the setup of a condition whose own one is `own`.
    pub fn new(own: Setup, shared: Arc<Shared>) -> Self {
        Self { own, shared }
    }

    /// Returns what all conditions share.
    pub fn shared(&self) -> &Arc<Shared> {
        &self.shared
    }

    /// Returns the study's own setup.
    pub fn own(&self) -> &Setup {
        &self.own
    }

    fn propose(&self, spec: &TrialSpec) -> Result<Proposal, String> {
        let Tables { likelihoods, truths } = self.shared.tables()?;
        let Shared { inference, proposing, .. } = &*self.shared;
        proposing.propose(&self.own, inference, likelihoods, truths, &spec.seeds)
    }
}

impl StudySetup for InferenceSetup {
    fn world(&self) -> &World {
        self.own.world()
    }

    fn robot(&self) -> &Robot {
        self.own.robot()
    }

    fn start(&self) -> Pose {
        self.own.start()
    }

    fn parameters(&self) -> Value {
        self.own.parameters()
    }

    fn further(&self) -> Map<String, Value> {
        let mut further = self.own.further();
        further.insert("inference".to_owned(), json!(self.shared.inference));
        further.insert("buildings".to_owned(), json!(self.shared.meaning.hex()));
        further
    }

    fn further_outcomes(&self) -> &'static [Outcome] {
        &[Outcome::PROPOSED]
    }

    fn is_model(&self) -> bool {
        true
    }

    fn run(
        &self,
        spec: &TrialSpec,
        _recording: Option<&mut Recording>,
        _watch: &mut dyn Stopwatch,
    ) -> TrialRecord {
        match self.propose(spec) {
            Err(why) => TrialRecord::panicked(spec, why),
            Ok(proposal) => TrialRecord {
                key: spec.key,
                condition: spec.condition.clone(),
                trial: spec.trial,
                outcome: Outcome::PROPOSED,
                cause: String::new(),
                measures: proposal.measures(),
                series: Vec::new(),
                sim_seconds: 0.0,
                chain: Vec::new(),
            },
        }
    }
}
