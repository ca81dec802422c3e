//! The comparison as a whole.

use super::tolerance::ToleranceError;
use super::{Account, Change, Discrepancy, Settings, Tolerances, derived, settings, trials};
use crate::digest::ResultsDigest;
use serde::{Serialize, Serializer};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// How much of the first side the second one ran.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Extent {
    /// All of it.
    Whole,
    /// Whole conditions, but not all of them: tables, figures and verdicts cannot be compared.
    Conditions,
    /// Trial 0 of some or all conditions: a probe.
    FirstTrials,
}

/// Who is compared.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub struct Party {
    /// The study's short name.
    pub name: String,
    /// The engine that ran it.
    pub engine: String,
    /// Whether only part of the study was run.
    pub partial: bool,
    /// What came out; `sha256:` and the digits, as every command writes it.
    #[serde(serialize_with = "named_digest")]
    pub results_digest: ResultsDigest,
}

fn named_digest<S: Serializer>(digest: &ResultsDigest, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(&format_args!("sha256:{digest}"))
}

/// How trials were paired.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub struct Matching {
    /// Pairs of one key: the very same trial.
    pub by_key: usize,
    /// Pairs of two keys, by condition and number: trials of another engine, seed, input or setting.
    pub by_number: usize,
}

/// How many things were held against one another, and how many differences were admitted.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub struct Tally {
    /// Input files.
    pub inputs: usize,
    /// Values of the resolved study.
    pub settings: usize,
    /// Conditions.
    pub conditions: usize,
    /// Conditions whose records are known to a lock by one digest.
    pub records: usize,
    /// Cells of tables.
    pub cells: usize,
    /// Files under `results/`.
    pub files: usize,
    /// Claims.
    pub claims: usize,
    /// Trials that differ by no more than the declared tolerances.
    pub tolerated_trials: usize,
    /// Cells that do.
    pub tolerated_cells: usize,
}

/// Two accounts held against one another.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// The first side.
    pub a: Party,
    /// The second side.
    pub b: Party,
    /// How much of the first side the second one ran.
    pub extent: Extent,
    /// How trials were paired.
    pub matching: Matching,
    /// What was compared.
    pub tally: Tally,
    /// What differs, possible causes first.
    pub discrepancies: Vec<Discrepancy>,
}

/// Compares `b` with `a`. Where a side is a lock, what a lock does not hold is not compared.
///
/// # Errors
/// Where a tolerance is declared for a metric that neither side has.
pub fn compare(
    a: &Account,
    b: &Account,
    extent: Extent,
    tolerances: &Tolerances,
) -> Result<Comparison, ToleranceError> {
    tolerances.check(&metrics(a, b))?;
    let mut tally = Tally::default();
    let mut discrepancies = inputs(a, b, &mut tally);
    if a.manifest != b.manifest {
        let change = Change::new(a.manifest, b.manifest);
        discrepancies.push(Discrepancy::Manifest { change });
    }
    if a.engine != b.engine {
        let change = Change::new(a.engine.clone(), b.engine.clone());
        discrepancies.push(Discrepancy::Engine { change });
    }
    if a.is_lock || b.is_lock {
        let (x, y) = (a.settings.of_trials(), b.settings.of_trials());
        discrepancies.extend(asked(&x, &y, &mut tally));
    } else {
        discrepancies.extend(asked(&a.settings, &b.settings, &mut tally));
    }
    discrepancies.extend(conditions(a, b, extent, &mut tally));
    let trials = trials::compare(a, b, tolerances);
    tally.tolerated_trials = trials.tolerated;
    let mut trials_differ = !trials.differences.is_empty();
    discrepancies.extend(trials.differences);
    if (a.is_lock || b.is_lock) && extent != Extent::FirstTrials {
        let records = records(a, b, &mut tally);
        trials_differ |= !records.is_empty();
        discrepancies.extend(records);
    }
    if extent == Extent::Whole {
        let derived = derived::compare(a, b, tolerances, trials_differ);
        tally.cells = derived.compared_cells;
        tally.tolerated_cells = derived.tolerated_cells;
        tally.files = a.results.keys().filter(|path| b.results.contains_key(*path)).count();
        tally.claims = a.claims.keys().filter(|id| b.claims.contains_key(*id)).count();
        discrepancies.extend(derived.cells);
        discrepancies.extend(derived.files);
        discrepancies.extend(derived.claims);
    }
    let (a, b) = (party(a), party(b));
    Ok(Comparison { a, b, extent, matching: trials.matching, tally, discrepancies })
}

impl Comparison {
    /// Returns whether nothing differs by more than was admitted.
    pub fn is_same(&self) -> bool {
        self.discrepancies.is_empty()
    }

    /// Returns the whole comparison, for programs.
    pub fn to_json(&self) -> Value {
        serde_json::json!({
            "a": self.a,
            "b": self.b,
            "same": self.is_same(),
            "extent": self.extent,
            "matching": self.matching,
            "compared": self.tally,
            "causes": self.causes(),
            "discrepancies": self.discrepancies,
        })
    }
}

fn party(account: &Account) -> Party {
    Party {
        name: account.name.clone(),
        engine: account.engine.clone(),
        partial: account.partial,
        results_digest: account.results_digest,
    }
}

/// Returns every name that a tolerance may be declared for: measures, and columns of numbers in tables.
fn metrics<'a>(a: &'a Account, b: &'a Account) -> BTreeSet<&'a str> {
    let mut names: BTreeSet<&str> = BTreeSet::new();
    for side in [a, b] {
        names.extend(side.measures.iter().map(String::as_str));
        for (_, file) in side.results.iter().filter(|(path, _)| path.starts_with("tables/")) {
            let header = file.text.as_deref().and_then(|text| text.lines().next());
            if derived::table(file).is_some() {
                names.extend(header.into_iter().flat_map(|header| header.split(',')));
            }
        }
    }
    names
}

fn inputs(a: &Account, b: &Account, tally: &mut Tally) -> Vec<Discrepancy> {
    let paths: BTreeSet<&String> = a.inputs.keys().chain(b.inputs.keys()).collect();
    tally.inputs = paths.len();
    let changed = paths.into_iter().filter_map(|path| {
        let (from, to) = (a.inputs.get(path).copied(), b.inputs.get(path).copied());
        (from != to).then(|| Discrepancy::Input { path: path.clone(), change: Change { from, to } })
    });
    changed.collect()
}

/// Finds the settings that changed: those of the whole study, then those of conditions, alike changes listed once.
fn asked(a: &Settings, b: &Settings, tally: &mut Tally) -> Vec<Discrepancy> {
    let mut found = Vec::new();
    let changes = |x: &BTreeMap<String, Value>, y: &BTreeMap<String, Value>| {
        let paths: BTreeSet<&String> = x.keys().chain(y.keys()).collect();
        let count = paths.len();
        let changed = paths.into_iter().filter_map(|path| {
            let (from, to) = (x.get(path), y.get(path));
            let is_same = from.zip(to).is_some_and(|(from, to)| settings::same(from, to));
            (!is_same).then(|| (path.clone(), from.cloned(), to.cloned()))
        });
        (count, changed.collect::<Vec<_>>())
    };
    let (count, changed) = changes(&a.study, &b.study);
    tally.settings += count;
    for (path, from, to) in changed {
        let change = Change { from, to };
        found.push(Discrepancy::Setting { path, change, conditions: Vec::new(), everywhere: true });
    }
    let mut alike: Vec<(String, Change<Value>, Vec<String>)> = Vec::new();
    let mut common = 0;
    for (slug, x) in &a.conditions {
        let Some(y) = b.conditions.get(slug) else { continue };
        common += 1;
        let (count, changed) = changes(x, y);
        tally.settings += count;
        for (path, from, to) in changed {
            let change = Change { from, to };
            match alike.iter_mut().find(|known| known.0 == path && known.1 == change) {
                Some((_, _, conditions)) => conditions.push(slug.clone()),
                None => alike.push((path, change, vec![slug.clone()])),
            }
        }
    }
    alike.sort_by(|x, y| x.0.cmp(&y.0));
    for (path, change, conditions) in alike {
        let everywhere = conditions.len() == common;
        found.push(Discrepancy::Setting { path, change, conditions, everywhere });
    }
    found
}

/// Finds the conditions that are new, gone or of another size. Of a part that was run, only the plan knows what is gone.
fn conditions(a: &Account, b: &Account, extent: Extent, tally: &mut Tally) -> Vec<Discrepancy> {
    let sizes = |side: &Account| -> Vec<(String, usize)> {
        if extent == Extent::Whole || side.settings.conditions.is_empty() {
            side.conditions.iter().map(|c| (c.slug.clone(), c.trials)).collect()
        } else {
            let size = |slug: &String| side.condition(slug).map_or(0, |c| c.trials);
            side.settings.conditions.keys().map(|slug| (slug.clone(), size(slug))).collect()
        }
    };
    let (x, y) = (sizes(a), sizes(b));
    let of = |side: &[(String, usize)], slug: &str| {
        side.iter().find(|(name, _)| name == slug).map(|(_, trials)| *trials)
    };
    let new = y.iter().filter(|(slug, _)| of(&x, slug).is_none());
    let mut found = Vec::new();
    for (slug, _) in x.iter().chain(new) {
        let (from, to) = (of(&x, slug), of(&y, slug));
        let both = from.is_some() && to.is_some();
        tally.conditions += usize::from(both);
        if from != to && (extent == Extent::Whole || !both) {
            let (condition, change) = (slug.clone(), Change { from, to });
            found.push(Discrepancy::Condition { condition, change });
        }
    }
    found
}

/// Compares records by their digests: all that a lock knows of most trials.
fn records(a: &Account, b: &Account, tally: &mut Tally) -> Vec<Discrepancy> {
    let mut found = Vec::new();
    for (x, y) in a.conditions.iter().filter_map(|x| Some((x, b.condition(&x.slug)?))) {
        tally.records += 1;
        if x.records != y.records {
            let (condition, change) = (x.slug.clone(), Change::new(x.records, y.records));
            found.push(Discrepancy::Records { condition, change });
        }
    }
    found
}
