//! Which trials of a plan to run: `--only`, `--trials` and `--shard`.

use crate::condition::Condition;
use crate::document::suggestion;
use crate::manifest::Experiment;

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A part of a plan; the default is all of it. A resolved study keeps it in this form.
///
/// ```
/// use reenact::plan::Selection;
///
/// let selection = Selection::parse(&["prior=none".to_owned()], Some(2), Some("1/4")).unwrap();
/// assert!(selection.is_partial());
/// assert_eq!(selection.options().join(" "), "--only prior=none --trials 2 --shard 1/4");
/// let refused = Selection::parse(&[], None, Some("5/4")).unwrap_err();
/// assert_eq!(refused.to_string(), "`--shard 5/4` is not I/N with I from 1 to N");
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "Written")]
pub struct Selection {
    /// Factor to the values that are wanted; factors that are absent are not restricted.
    pub only: BTreeMap<String, Vec<String>>,
    /// Trials per condition, where fewer (or more) than the manifest's are wanted.
    pub trials: Option<u32>,
    /// Shard I of N, both from 1.
    pub shard: Option<(u32, u32)>,
    /// How the trials are dealt to the shards; the default where there are none.
    #[serde(skip_serializing_if = "Dealt::is_in_order")]
    pub dealt: Dealt,
}

/// How the trials of a plan are dealt to N shards: one after another, beginning with the first shard, as cards are. Either way
/// every trial is in one shard, and shards differ by one trial at most.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Dealt {
    /// In plan order, as by releases that sealed no such key.
    #[default]
    InOrder,
    /// The conditions whose trials are estimated to take longest first, so that the estimated costs of two shards differ by
    /// one trial's at most: of a sequence that falls, the sums of every N-th differ by no more than its first and last.
    ByCost,
}

impl Dealt {
    #[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde asks")]
    fn is_in_order(&self) -> bool {
        *self == Self::InOrder
    }
}

/// Why a selection cannot be made.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SelectionError {
    /// `--only` is not FACTOR=VALUE.
    #[error("`--only {0}` is not FACTOR=VALUE[,VALUE]")]
    NotAnOnly(String),
    /// The factor does not exist.
    #[error("unknown factor `{name}` in `--only`{hint}")]
    UnknownFactor {
        /// The name written.
        name: String,
        /// A suggestion or what is known.
        hint: String,
    },
    /// The factor has no such value.
    #[error("`{value}` is not a value of the factor `{name}`{hint}")]
    UnknownValue {
        /// The factor.
        name: String,
        /// The value written.
        value: String,
        /// A suggestion or what is known.
        hint: String,
    },
    /// `--shard` is not I/N with 1 <= I <= N.
    #[error("`--shard {0}` is not I/N with I from 1 to N")]
    NotAShard(String),
    /// `--trials 0`.
    #[error("`--trials` must be at least 1, found 0")]
    NoTrials,
    /// Nothing is left.
    #[error("no condition has all the values of `--only`")]
    Nothing,
}

/// A selection of unknown origin.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    only: BTreeMap<String, Vec<String>>,
    trials: Option<u32>,
    shard: Option<(u32, u32)>,
    #[serde(default)]
    dealt: Dealt,
}

/// A shard that is none of its plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("no shard {0} of {1}")]
struct NoShard(u32, u32);

impl TryFrom<Written> for Selection {
    type Error = NoShard;

    fn try_from(written: Written) -> Result<Self, NoShard> {
        let Written { only, trials, shard, dealt } = written;
        match shard {
            Some((i, n)) if i == 0 || i > n => Err(NoShard(i, n)),
            _ => Ok(Self { only, trials, shard, dealt }),
        }
    }
}

impl Selection {
    /// Reads a selection as the command line writes it: `--only` any number of times (values of one factor add up),
    /// `--trials` and `--shard I/N`.
    ///
    /// # Errors
    /// Where an option is not of its form.
    pub fn parse(
        only: &[String],
        trials: Option<u32>,
        shard: Option<&str>,
    ) -> Result<Self, SelectionError> {
        let mut selection = Self { trials, ..Self::default() };
        for written in only {
            let bad = || SelectionError::NotAnOnly(written.clone());
            let (factor, values) = written.split_once('=').ok_or_else(bad)?;
            let values: Vec<String> = values.split(',').map(str::to_owned).collect();
            if factor.is_empty() || values.iter().any(String::is_empty) {
                return Err(bad());
            }
            selection.only.entry(factor.to_owned()).or_default().extend(values);
        }
        if let Some(written) = shard {
            let bad = || SelectionError::NotAShard(written.to_owned());
            let (i, n) = written.split_once('/').ok_or_else(bad)?;
            let (i, n): (u32, u32) = (i.parse().map_err(|_| bad())?, n.parse().map_err(|_| bad())?);
            if i == 0 || i > n {
                return Err(bad());
            }
            selection.shard = Some((i, n));
            selection.dealt = Dealt::ByCost;
        }
        if trials == Some(0) {
            return Err(SelectionError::NoTrials);
        }
        Ok(selection)
    }

    /// Returns the selection as the command line writes it, a word each; nothing for a whole plan.
    pub fn options(&self) -> Vec<String> {
        let only = self.only.iter().map(|(factor, values)| {
            ["--only".to_owned(), format!("{factor}={}", values.join(","))]
        });
        let trials = self.trials.map(|trials| ["--trials".to_owned(), trials.to_string()]);
        let shard = self.shard.map(|(i, n)| ["--shard".to_owned(), format!("{i}/{n}")]);
        only.chain(trials).chain(shard).flatten().collect()
    }

    /// Returns whether anything of a plan is left out (or, with `--trials`, changed).
    pub fn is_partial(&self) -> bool {
        *self != Self::default()
    }

    /// Returns the same selection of all shards together.
    #[must_use]
    pub fn unsharded(&self) -> Self {
        Self { shard: None, dealt: Dealt::default(), ..self.clone() }
    }

    /// Holds the names of `--only` against the experiment.
    pub(super) fn check(&self, experiment: &Experiment) -> Result<(), SelectionError> {
        for (name, values) in &self.only {
            let Some(factor) = experiment.factors.iter().find(|f| f.name == *name) else {
                let known = experiment.factors.iter().map(|f| f.name.as_str()).collect();
                return Err(SelectionError::UnknownFactor {
                    name: name.clone(),
                    hint: hint(name, known),
                });
            };
            if let Some(value) = values.iter().find(|value| !factor.values.contains(value)) {
                let known = factor.values.iter().map(String::as_str).collect();
                return Err(SelectionError::UnknownValue {
                    name: name.clone(),
                    value: value.clone(),
                    hint: hint(value, known),
                });
            }
        }
        if experiment.design().any(|(condition, _)| self.wants(condition)) {
            Ok(())
        } else {
            Err(SelectionError::Nothing)
        }
    }

    /// Returns whether `condition` has one of the wanted values of every restricted factor.
    pub(super) fn wants(&self, condition: &Condition) -> bool {
        self.only.iter().all(|(factor, values)| {
            condition.value(factor).is_some_and(|value| values.iter().any(|v| v == value))
        })
    }
}

fn hint(word: &str, known: Vec<&str>) -> String {
    let list = known.join(", ");
    match suggestion(word, known) {
        Some(near) => format!(": did you mean `{near}`? (known: {list})"),
        None if list.is_empty() => ": the manifest has none".to_owned(),
        None => format!(" (known: {list})"),
    }
}
