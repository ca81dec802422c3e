//! Shards of a study, run on as many machines, put together: what one machine would have sealed, with nothing simulated again.
//!
//! Each shard is a bundle of `run --shard I/N`. They must be of one study, by one engine, on the same inputs, and of one
//! division into N; a shard may be given twice where it says the same twice.

mod records;

use crate::bundle::{Bundle, Departure, shell_word};
use crate::digest::{Sha256Digest, TrialKey};
use crate::json::{self, AsWritten};
use crate::plan::{Dealt, ENGINE_VERSION, Plan, ResolvedStudy, Selection, engine_version};
use crate::verify::{ReplanError, plan_of};
use std::collections::BTreeMap;
use std::io;
use thiserror::Error;

/// Missing shards that a refusal lists.
const LISTED: usize = 8;

/// A bundle of part of a study, and what it is called.
#[derive(Debug)]
pub struct Shard {
    /// Its path, for messages.
    pub name: String,
    /// The bundle, which is what it says as far as that can be known without running it again.
    pub bundle: Bundle,
}

/// All shards of a study as one run, whose records are read from them in plan order ([`Merged::records`]).
#[derive(Debug)]
pub struct Merged<'a> {
    bundles: &'a [Shard],
    /// The bundles of each shard, by their places among `bundles`: one, and those that repeat it.
    given: BTreeMap<u32, Vec<usize>>,
    /// How trials were dealt to shards.
    dealt: Dealt,
    /// The study, or the part of it that was divided into shards.
    pub plan: Plan,
    /// Which part that is.
    pub selection: Selection,
    /// The manifest, byte for byte.
    pub study_yaml: Vec<u8>,
    /// Into how many shards it was divided.
    pub shards: u32,
    /// How many bundles were given of shards that another one was given of, too.
    pub repeated: usize,
}

/// Why shards make no study.
#[derive(Debug, Error)]
pub enum MergeError {
    /// There is nothing to merge.
    #[error("expected bundles of `reenact run --shard I/N`, found none")]
    Nothing,
    /// One is the bundle of something else.
    #[error(
        "{name}: expected the bundle of a shard (`reenact run --shard I/N`), found one of {found}"
    )]
    NoShard {
        /// Which.
        name: String,
        /// What it is of.
        found: String,
    },
    /// This program cannot derive results from the records of that engine.
    #[error(
        "{name}: expected records of engine {own}, as this program runs it, found engine {found}: merge with the release that ran them"
    )]
    Engine {
        /// Which.
        name: String,
        /// This program's.
        own: String,
        /// The bundle's.
        found: String,
    },
    /// Two are not of the same study.
    #[error(
        "{name}: expected {what} as in {first} ({expected}), found {found}: these are no shards of one study"
    )]
    Another {
        /// Which.
        name: String,
        /// What differs.
        what: String,
        /// The one that it is held against.
        first: String,
        /// What that one has.
        expected: String,
        /// What it has.
        found: String,
    },
    /// The study cannot be planned again.
    #[error("{name}: expected a manifest that can be planned again, found {problem}")]
    Unplanned {
        /// Which.
        name: String,
        /// Why.
        problem: Box<ReplanError>,
    },
    /// A line is no record.
    #[error("{name}: expected a trial's record at {place}, found {problem}")]
    NoRecord {
        /// Which bundle.
        name: String,
        /// The file and the line in it, from 1.
        place: String,
        /// Why.
        problem: String,
    },
    /// Shards are not there.
    #[error(
        "expected {of} shards, found {found}: {missing}; a lost shard is run again by itself, and merged with the others"
    )]
    Missing {
        /// Into how many the study was divided.
        of: u32,
        /// How many are there.
        found: usize,
        /// Those that are not, each with the command that runs it.
        missing: String,
    },
    /// A shard holds less than its part.
    #[error(
        "{name}: expected trial {trial}, which is of shard {shard}/{of}, found no record of it"
    )]
    Gap {
        /// The bundle that should hold it.
        name: String,
        /// The trial.
        trial: String,
        /// Its shard.
        shard: u32,
        /// Of how many.
        of: u32,
    },
    /// A shard holds trials of no shard, or of another.
    #[error(
        "{name}: expected trials of shard {shard}/{of} alone, found {trial}, which is none of it"
    )]
    Stray {
        /// Which bundle.
        name: String,
        /// The trial.
        trial: String,
        /// The bundle's shard.
        shard: u32,
        /// Of how many.
        of: u32,
    },
    /// Two records of one trial differ.
    #[error(transparent)]
    Conflict(Box<Conflict>),
    /// What was merged cannot be written.
    #[error("records cannot be put together: {0}")]
    Unwritten(#[from] io::Error),
}

/// Two records of one trial that differ.
#[derive(Debug, Error)]
#[error(
    "trial {trial} (key {key}): expected the record of {first} (sha256:{expected}), found another in {name} (sha256:{found}) \
     {divergence}; equal keys must give equal bytes: `reenact verify --level 5` tells which of the two is not what its trial \
     gives"
)]
pub struct Conflict {
    /// The trial.
    pub trial: String,
    /// Its key.
    pub key: TrialKey,
    /// The bundle that was given first.
    pub first: String,
    /// The digest of its record.
    pub expected: Sha256Digest,
    /// The other bundle.
    pub name: String,
    /// The digest of its record.
    pub found: Sha256Digest,
    /// Where they part, in words.
    pub divergence: String,
}

impl MergeError {
    /// Returns whether the request was the fault: what was given are no shards, or none that this program can judge. Otherwise
    /// they are, and make no study.
    pub fn is_misunderstood(&self) -> bool {
        matches!(self, Self::Nothing | Self::NoShard { .. } | Self::Engine { .. })
    }
}

/// Which of how many a bundle says it is.
struct Part {
    selection: Selection,
    shard: u32,
    of: u32,
}

/// Holds `shards` against one another, before their records are read.
///
/// # Errors
/// Where they are not all shards of one study.
pub fn merge(shards: &[Shard]) -> Result<Merged<'_>, MergeError> {
    let first = shards.first().ok_or(MergeError::Nothing)?;
    let parts: Vec<Part> = shards.iter().map(part).collect::<Result<_, _>>()?;
    let whole = &parts[0];
    for (shard, part) in shards.iter().zip(&parts) {
        same(first, whole, shard, part)?;
    }
    let mut given: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (index, part) in parts.iter().enumerate() {
        given.entry(part.shard).or_default().push(index);
    }
    let of = whole.of;
    if given.len() < of as usize {
        return Err(missing(&first.bundle, whole, &given));
    }
    let kind = first.bundle.resolved().study.read();
    let own = kind.map_or_else(|_| ENGINE_VERSION.to_owned(), engine_version);
    if own != first.bundle.engine() {
        let found = first.bundle.engine().to_owned();
        return Err(MergeError::Engine { name: first.name.clone(), own, found });
    }
    let unplanned =
        |problem| MergeError::Unplanned { name: first.name.clone(), problem: Box::new(problem) };
    let experiment = plan_of(&first.bundle).map_err(unplanned)?.0.experiment;
    let selection = whole.selection.unsharded();
    let plan = if selection.is_partial() {
        Plan::select(experiment, &selection).map_err(|problem| unplanned(problem.into()))?
    } else {
        Plan::of(experiment)
    };
    Ok(Merged {
        bundles: shards,
        dealt: whole.selection.dealt,
        selection,
        study_yaml: first.bundle.study_yaml().to_vec(),
        shards: of,
        repeated: shards.len() - given.len(),
        given,
        plan,
    })
}

/// Returns which shard a bundle is.
fn part(shard: &Shard) -> Result<Part, MergeError> {
    let Shard { name, bundle } = shard;
    let no_shard = |found: String| MergeError::NoShard { name: name.clone(), found };
    let departure = Departure::of(bundle.resolved(), bundle.is_partial());
    match departure.selection.as_ref().map(|selection| (selection, selection.shard)) {
        Some((selection, Some((shard, of)))) => {
            Ok(Part { selection: selection.clone(), shard, of })
        }
        Some(_) if !bundle.is_partial() => Err(no_shard("a whole study".to_owned())),
        _ => Err(no_shard(format!(
            "a study, {}",
            departure.in_words().unwrap_or_else(|| "partial".to_owned())
        ))),
    }
}

/// Holds what two shards of one study have in common against one another.
fn same(first: &Shard, whole: &Part, shard: &Shard, part: &Part) -> Result<(), MergeError> {
    let (a, b) = (&first.bundle, &shard.bundle);
    let another = |what: &str, expected: String, found: String| {
        Err(MergeError::Another {
            name: shard.name.clone(),
            what: what.to_owned(),
            first: first.name.clone(),
            expected,
            found,
        })
    };
    if a.engine() != b.engine() {
        return another("the engine", a.engine().to_owned(), b.engine().to_owned());
    }
    let manifest =
        |bundle: &Bundle| format!("sha256:{}", Sha256Digest::of(bundle.study_yaml()).short());
    if a.study_yaml() != b.study_yaml() {
        return another("the manifest", manifest(a), manifest(b));
    }
    let inputs = |bundle: &Bundle| -> BTreeMap<String, String> {
        let entry = |input: &crate::bundle::InputEntry| {
            (input.as_written.clone(), format!("sha256:{}", input.sha256.short()))
        };
        bundle.inputs().iter().map(entry).collect()
    };
    let (of_a, of_b) = (inputs(a), inputs(b));
    let absent = || "no such input".to_owned();
    for name in of_a.keys().chain(of_b.keys()) {
        if of_a.get(name) != of_b.get(name) {
            let told = |inputs: &BTreeMap<String, String>| {
                inputs.get(name).cloned().unwrap_or_else(absent)
            };
            return another(&format!("the input `{name}`"), told(&of_a), told(&of_b));
        }
    }
    let division = |part: &Part| {
        let mut options = part.selection.unsharded().options();
        options.push(format!("--shard I/{}", part.of));
        options.join(" ")
    };
    if division(whole) != division(part) {
        return another("the division", division(whole), division(part));
    }
    if whole.selection.dealt != part.selection.dealt {
        let told = |part: &Part| format!("dealt {}", json::canonical_of(&part.selection.dealt));
        return another("the division", told(whole), told(part));
    }
    let keys = |bundle: &Bundle| {
        let study = ResolvedStudy { selection: AsWritten::default(), ..bundle.resolved().clone() };
        study.to_json().as_object().cloned().unwrap_or_default()
    };
    let (of_a, of_b) = (keys(a), keys(b));
    let mut differing =
        of_a.keys().chain(of_b.keys()).filter(|key| of_a.get(*key) != of_b.get(*key));
    if let Some(key) = differing.next() {
        let told = |study: &serde_json::Map<String, serde_json::Value>| match study.get(key) {
            None => "nothing".to_owned(),
            Some(value) => match json::canonical(value) {
                short if short.len() <= 80 => short,
                long => format!("sha256:{}", Sha256Digest::of(long).short()),
            },
        };
        return another(&format!("`{key}`"), told(&of_a), told(&of_b));
    }
    Ok(())
}

/// Says which shards are missing, and how each is run.
fn missing(bundle: &Bundle, whole: &Part, given: &BTreeMap<u32, Vec<usize>>) -> MergeError {
    let overrides = Departure::of(bundle.resolved(), true).overrides;
    let command = |shard: u32| {
        let mut part = whole.selection.clone();
        part.shard = Some((shard, whole.of));
        let set = overrides.iter().flat_map(|set| ["--set".to_owned(), set.clone()]);
        let words = set.chain(part.options());
        let words: Vec<String> = words.map(|word| shell_word(&word).unwrap_or(word)).collect();
        format!(
            "shard {shard}/{} is missing (`reenact run MANIFEST {}`)",
            whole.of,
            words.join(" ")
        )
    };
    let mut told: Vec<String> = (1..=whole.of)
        .filter(|shard| !given.contains_key(shard))
        .take(LISTED)
        .map(command)
        .collect();
    let left = whole.of as usize - given.len() - told.len();
    if left > 0 {
        told.push(format!("and {left} more are"));
    }
    MergeError::Missing { of: whole.of, found: given.len(), missing: told.join(", ") }
}
