//! The pipeline that `run` goes, gone again from a bundle: manifest, plan, trials, results.

use super::{Pipeline, PlannedTrial, Replanned};
use crate::bundle::{Bundle, BundleContent, Fault, assemble, format};
use crate::digest::Sha256Digest;
use crate::document::Source;
use crate::manifest::{self, Experiment, Inputs, WrittenIn};
use crate::plan::{ENGINE_VERSION, Plan, Selection};
use crate::runner::{Observer, RunError, Scheduler, Silent};
use crate::studies::{self, TrialRecord, TrialSpec};
use std::cell::RefCell;

/// This program's own pipeline.
pub struct Reenactment<'o> {
    scheduler: Scheduler,
    observer: &'o dyn Observer,
}

impl Reenactment<'static> {
    /// The pipeline on `jobs` threads.
    ///
    /// # Errors
    /// Where the system does not give them.
    pub fn new(jobs: usize) -> Result<Self, RunError> {
        Ok(Self { scheduler: Scheduler::new(jobs)?, observer: &Silent })
    }
}

impl Reenactment<'_> {
    /// The same, with `observer` told of the trials that are executed again.
    pub fn observed_by(self, observer: &dyn Observer) -> Reenactment<'_> {
        Reenactment { scheduler: self.scheduler, observer }
    }
}

impl Pipeline for Reenactment<'_> {
    fn engine(&self) -> &str {
        ENGINE_VERSION
    }

    fn replan<'a>(&'a self, bundle: &'a Bundle) -> Result<Box<dyn Replanned + 'a>, String> {
        let (plan, selection) = plan_of(bundle)?;
        Ok(Box::new(Study {
            bundle,
            plan,
            selection,
            scheduler: &self.scheduler,
            observer: self.observer,
        }))
    }
}

/// How many more trials a manifest may ask for than its bundle holds before it is not even planned.
const MOST_MISSING: u64 = 10_000;

/// Plans the study of `bundle` again, from its manifest, inputs, overrides and selection alone.
///
/// # Errors
/// Where they do not make a plan, in words.
pub fn plan_of(bundle: &Bundle) -> Result<(Plan, Selection), String> {
    plan_with(bundle, None)
}

/// The same plan, with `seed` in place of the manifest's where one is given.
fn plan_with(bundle: &Bundle, seed: Option<u64>) -> Result<(Plan, Selection), String> {
    let study = bundle.resolved();
    let (source, mut overrides) = written(bundle)?;
    // As `run --set seed=S` would have it: the last override counts.
    overrides.extend(seed.map(|seed| format!("seed={seed}")));
    let selection = match study.get("selection") {
        Some(written) => Selection::from_json(written)?,
        None => Selection::default(),
    };
    let inputs: &dyn Inputs = if seed.is_some() { &Afresh::new(bundle) } else { &Sealed(bundle) };
    let experiment = resolve(&source, &overrides, inputs)?;
    // Counted before they are made: a manifest of a few words can ask for millions.
    let planned = Plan::size(&experiment, &selection);
    let sealed: usize =
        bundle.conditions().iter().map(|c| bundle.record_lines(&c.slug).count()).sum();
    if planned > sealed as u64 + MOST_MISSING {
        return Err(format!("one of {planned} trials, where the bundle holds {sealed} records"));
    }
    let plan = if selection.is_partial() {
        Plan::select(experiment, &selection).map_err(|e| e.to_string())?
    } else {
        Plan::of(experiment)
    };
    Ok((plan, selection))
}

/// The manifest in `bundle` and what was overridden in it.
fn written(bundle: &Bundle) -> Result<(Source, Vec<String>), String> {
    let overrides = serde_json::from_value(bundle.resolved()["overrides"].clone())
        .map_err(|e| format!("overrides: {e}"))?;
    let text = std::str::from_utf8(bundle.study_yaml())
        .map_err(|_| "study.yaml is not UTF-8 text".to_owned())?;
    Ok((Source::new("study.yaml", text), overrides))
}

fn resolve(
    source: &Source,
    overrides: &[String],
    inputs: &dyn Inputs,
) -> Result<Experiment, String> {
    match manifest::resolve(source, overrides, inputs) {
        Ok((experiment, _)) => Ok(experiment),
        Err(faults) => Err(faults.iter().map(|f| f.render(false)).collect()),
    }
}

/// The inputs sealed in a bundle.
struct Sealed<'a>(&'a Bundle);

impl Inputs for Sealed<'_> {
    fn read(&self, as_written: &str, _: WrittenIn) -> Result<Vec<u8>, String> {
        self.0
            .input(as_written)
            .map(<[u8]>::to_vec)
            .ok_or_else(|| "the bundle holds no such input".to_owned())
    }

    fn calibrate(&self, _: &str, sealed_as: &str, _: WrittenIn) -> Result<Vec<u8>, String> {
        self.read(sealed_as, WrittenIn::Calibration)
    }

    fn explore(&self, _: &TrialSpec, sealed_as: &[String; 2]) -> Result<[Vec<u8>; 2], String> {
        let [descriptor, image] = sealed_as;
        let read = |name: &str| self.read(name, WrittenIn::PreviousMap);
        Ok([read(descriptor)?, read(image)?])
    }
}

/// The inputs sealed in a bundle, but for the maps of earlier explorations, which are explored again.
struct Afresh<'a> {
    sealed: Sealed<'a>,
    /// The sealed maps that came out otherwise.
    other: RefCell<Vec<Fault>>,
}

impl<'a> Afresh<'a> {
    fn new(bundle: &'a Bundle) -> Self {
        Self { sealed: Sealed(bundle), other: RefCell::default() }
    }
}

impl Inputs for Afresh<'_> {
    fn read(&self, as_written: &str, written_in: WrittenIn) -> Result<Vec<u8>, String> {
        self.sealed.read(as_written, written_in)
    }

    fn calibrate(
        &self,
        path: &str,
        sealed_as: &str,
        written_in: WrittenIn,
    ) -> Result<Vec<u8>, String> {
        self.sealed.calibrate(path, sealed_as, written_in)
    }

    fn explore(&self, spec: &TrialSpec, sealed_as: &[String; 2]) -> Result<[Vec<u8>; 2], String> {
        let again = manifest::explored(spec, sealed_as)?;
        // With another seed there is another exploration, of which the bundle knows nothing.
        if let Ok(sealed) = self.sealed.explore(spec, sealed_as) {
            for ((name, sealed), again) in sealed_as.iter().zip(sealed).zip(&again) {
                if sealed != *again {
                    let digest =
                        |bytes: &[u8]| format!("sha256:{}", Sha256Digest::of(bytes).short());
                    // These names are flat and safe, and so what they are in the bundle.
                    let path = format!("{}{}{name}", format::PAYLOAD, format::INPUTS);
                    let expected = format!("{} as explored again", digest(again));
                    let fault = Fault::new(path, expected, digest(&sealed));
                    let hint = "the previous map that the study starts from is not what that exploration gives";
                    self.other.borrow_mut().push(fault.hint(hint));
                }
            }
        }
        Ok(again)
    }
}

struct Study<'a> {
    bundle: &'a Bundle,
    plan: Plan,
    selection: Selection,
    scheduler: &'a Scheduler,
    observer: &'a dyn Observer,
}

impl Replanned for Study<'_> {
    fn trials(&self) -> Vec<PlannedTrial> {
        let planned = |spec: &TrialSpec| PlannedTrial {
            key: spec.key,
            slug: spec.condition.slug(),
            trial: spec.trial,
        };
        self.plan.trials.iter().map(planned).collect()
    }

    fn content(&self) -> Result<BundleContent, String> {
        let records = self.bundle.records().map_err(|faults| {
            faults.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
        })?;
        assemble::assemble(&self.plan, self.bundle.study_yaml(), &self.selection, &records)
    }

    fn execute(&self, indices: &[usize]) -> Result<Vec<String>, String> {
        let specs: Vec<TrialSpec> = indices.iter().map(|&i| self.plan.trials[i].clone()).collect();
        self.scheduler
            .run(&specs, &studies::execute, None, self.observer)
            .map(|records| records.iter().map(TrialRecord::to_line).collect())
            .map_err(|e| e.to_string())
    }

    fn explore_again(&self) -> Vec<Fault> {
        let afresh = Afresh::new(self.bundle);
        let told = written(self.bundle)
            .and_then(|(source, overrides)| resolve(&source, &overrides, &afresh));
        let mut faults = afresh.other.into_inner();
        if let (Err(problem), true) = (told, faults.is_empty()) {
            let path = format!("{}{}", format::PAYLOAD, format::STUDY);
            faults.push(Fault::new(path, "earlier explorations that can be run again", problem));
        }
        faults
    }

    fn replicate(&self, seed: u64) -> Result<BundleContent, String> {
        let (plan, selection) = plan_with(self.bundle, Some(seed))?;
        let records = self
            .scheduler
            .run(&plan.trials, &studies::execute, None, self.observer)
            .map_err(|e| e.to_string())?;
        assemble::assemble(&plan, self.bundle.study_yaml(), &selection, &records)
    }
}
