//! The trials of an experiment, in plan order.

use super::key::{Keys, engine_version, explain, key_content, study_digest};
use super::resolved::ResolvedStudy;
use super::selection::{Dealt, Selection, SelectionError};
use crate::condition::Condition;
use crate::digest::StudyDigest;
use crate::manifest::{Experiment, ResolvedCondition};
use crate::rng::Seeds;
use crate::studies::{Setup, TrialSpec};

/// An experiment and its trials: condition by condition, trial by trial.
#[derive(Debug, Clone)]
pub struct Plan {
    /// What is planned.
    pub experiment: Experiment,
    /// The trials, in plan order.
    pub trials: Vec<TrialSpec>,
    /// Whether some of the experiment's trials are left out (or others added).
    pub partial: bool,
}

/// Why a trial was not found.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum FindError {
    /// Neither a prefix of a key nor CONDITION/NUMBER.
    #[error("`{0}` is neither at least 8 hex digits of a trial's key nor CONDITION/NUMBER")]
    NotATrial(String),
    /// No trial is called that.
    #[error("no trial `{wanted}` in this plan; it begins with `{first}`")]
    Unknown {
        /// What was asked for.
        wanted: String,
        /// The first trial of the plan.
        first: String,
    },
    /// Several keys begin like that.
    #[error("`{0}` begins the keys of several trials: give more digits")]
    Ambiguous(String),
}

impl Plan {
    /// Plans all trials of `experiment`.
    pub fn of(experiment: Experiment) -> Self {
        let trials = expand(&experiment, &Selection::default());
        Self { experiment, trials, partial: false }
    }

    /// Plans the trials of `experiment` that `selection` wants.
    ///
    /// # Errors
    /// Where `selection` names factors or values that are not there, or leaves no condition.
    pub fn select(experiment: Experiment, selection: &Selection) -> Result<Self, SelectionError> {
        selection.check(&experiment)?;
        let trials = expand(&experiment, selection);
        Ok(Self { experiment, trials, partial: selection.is_partial() })
    }

    /// Counts the trials of `experiment` that `selection` wants, without making them.
    pub fn size(experiment: &Experiment, selection: &Selection) -> u64 {
        let wanted =
            experiment.design().filter(|(condition, _)| selection.wants(condition)).count();
        let all = wanted as u64 * u64::from(selection.trials.unwrap_or(experiment.trials));
        match selection.shard {
            // Of all N numbers from 0, those that leave I - 1 when divided.
            Some((i, n)) => (all + u64::from(n) - u64::from(i)) / u64::from(n),
            None => all,
        }
    }

    /// Returns to which of `shards`, from 1, each trial of a plan that is not one of a shard itself is dealt, in plan order.
    pub fn dealt(&self, shards: u32, dealt: Dealt) -> Vec<u32> {
        let conditions = || self.trials.chunk_by(|a, b| a.condition == b.condition);
        let ranks = ranks(conditions().map(|trials| &trials[0].setup), dealt);
        let dealt = conditions().zip(ranks).flat_map(|(trials, rank)| {
            let first = rank * trials.len() as u64;
            (first..).take(trials.len()).map(move |place| place % u64::from(shards.max(1)))
        });
        dealt.map(|shard| u32::try_from(shard).map_or(u32::MAX, |shard| shard + 1)).collect()
    }

    /// Finds the trial that `wanted` names: by at least 8 hex digits of its key, or as `CONDITION/NUMBER` with the
    /// condition's slug.
    ///
    /// # Errors
    /// Where it names none or several.
    pub fn find(&self, wanted: &str) -> Result<&TrialSpec, FindError> {
        let unknown = || FindError::Unknown {
            wanted: wanted.to_owned(),
            first: self.trials.first().map_or_else(String::new, |first| {
                format!("{}/{}", first.condition.slug(), first.trial)
            }),
        };
        if let Some((slug, number)) = wanted.rsplit_once('/') {
            let number: u32 =
                number.parse().map_err(|_| FindError::NotATrial(wanted.to_owned()))?;
            let found = |t: &&TrialSpec| t.trial == number && t.condition.slug() == slug;
            return self.trials.iter().find(found).ok_or_else(unknown);
        }
        let prefix = wanted.to_ascii_lowercase();
        if prefix.len() < 8 || !prefix.bytes().all(|b| b.is_ascii_hexdigit()) {
            return Err(FindError::NotATrial(wanted.to_owned()));
        }
        let mut found = self.trials.iter().filter(|t| t.key.hex().starts_with(&prefix));
        match (found.next(), found.next()) {
            (Some(trial), None) => Ok(trial),
            (Some(_), Some(_)) => Err(FindError::Ambiguous(wanted.to_owned())),
            (None, _) => Err(unknown()),
        }
    }

    /// Says what the key of `spec` is made of, in lines.
    pub fn explain(&self, spec: &TrialSpec) -> String {
        explain(&self.experiment, spec)
    }

    /// Returns the resolved study: what was asked with nothing left to guess.
    pub fn resolved(&self) -> ResolvedStudy {
        ResolvedStudy::of(&self.experiment, &engine_version(self.experiment.kind))
    }

    /// Computes the digest of what was asked.
    pub fn study_digest(&self) -> StudyDigest {
        study_digest(&self.experiment)
    }
}

fn expand(experiment: &Experiment, selection: &Selection) -> Vec<TrialSpec> {
    let count = selection.trials.unwrap_or(experiment.trials);
    let (shard, shards) = selection.shard.unwrap_or((1, 1));
    let wanted: Vec<&ResolvedCondition> =
        experiment.conditions.iter().filter(|c| selection.wants(&c.condition)).collect();
    let ranks = ranks(wanted.iter().map(|resolved| &resolved.setup), selection.dealt);
    let mut trials = Vec::new();
    for (resolved, rank) in wanted.into_iter().zip(ranks) {
        let ResolvedCondition { condition, setup, meanings, .. } = resolved;
        let first = rank * u64::from(count);
        let keys = Keys::of(key_content(
            experiment.kind,
            experiment.seed,
            &experiment.shared_noise,
            condition,
            0,
            setup,
            meanings,
        ));
        let seeds = seeds(experiment, condition);
        for trial in 0..count {
            if (first + u64::from(trial)) % u64::from(shards) != u64::from(shard - 1) {
                continue;
            }
            trials.push(TrialSpec {
                key: keys.key(trial),
                condition: condition.clone(),
                trial,
                seeds: seeds.of_trial(trial),
                setup: setup.clone(),
            });
        }
    }
    trials
}

/// Returns at which place each condition, of which these are the setups, is dealt to shards, from 0.
fn ranks<'a>(setups: impl Iterator<Item = &'a Setup>, dealt: Dealt) -> Vec<u64> {
    let costs: Vec<f64> = setups.map(|setup| setup.estimated_seconds()).collect();
    let mut order: Vec<usize> = (0..costs.len()).collect();
    if dealt == Dealt::ByCost {
        // Stable: conditions of one cost stay in plan order.
        order.sort_by(|&a, &b| costs[b].total_cmp(&costs[a]));
    }
    let mut ranks = vec![0; order.len()];
    for (rank, index) in (0..).zip(order) {
        ranks[index] = rank;
    }
    ranks
}

/// Returns where the random streams of a condition's trials come from: the study and the factors that do not share noise. The
/// trial's number comes behind them.
fn seeds(experiment: &Experiment, condition: &Condition) -> Seeds {
    let mut coordinates = vec![("study".to_owned(), experiment.kind.name().to_owned())];
    // Sorted, so that the order of factors in the manifest moves no number.
    let mut levels: Vec<_> =
        condition.iter().filter(|(name, _)| !experiment.shared_noise.contains(name)).collect();
    levels.sort();
    coordinates
        .extend(levels.into_iter().map(|(name, value)| (format!("factor {name}"), value.clone())));
    Seeds::new(experiment.seed, coordinates)
}
