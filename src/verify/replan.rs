//! The pipeline that `run` goes, gone again from a bundle: manifest, plan, trials, results.

mod errand;
mod varied;

pub use errand::{Errand, Executed};

use super::pipeline::{ContentError, MakeAgainError, ReplanError, ReplicateError};
use super::{Earlier, Made, Pipeline, PlannedTrial, Replanned};
use crate::bundle::assemble::{self, Asked};
use crate::bundle::{Bundle, BundleContent, BundlePath, Fault, Forgetful, Gathered, format};
use crate::claims::multiverse::Found;
use crate::digest::Sha256Digest;
use crate::document::Source;
use crate::manifest::{
    self, CalibrationTrials, Experiment, InputError, Inputs, ProposalTrials, WrittenIn,
};
use crate::plan::{ENGINE_VERSION, Plan, Selection, engine_version};
use crate::rng::Seeds;
use crate::runner::{Observer, RunError, Scheduler, Silent, TrialStore};
use crate::studies::{self, TrialRecord, TrialSpec};
use std::cell::RefCell;
use std::sync::Arc;

/// This program's own pipeline.
pub struct Reenactment<'o> {
    scheduler: Scheduler,
    observer: &'o dyn Observer,
    /// Records that others executed for this very climb.
    executed: Option<&'o Executed>,
}

impl Reenactment<'static> {
    /// Creates the pipeline on `jobs` threads.
    ///
    /// # Errors
    /// Where the system does not give them.
    pub fn new(jobs: usize) -> Result<Self, RunError> {
        Ok(Self { scheduler: Scheduler::new(jobs)?, observer: &Silent, executed: None })
    }
}

impl Reenactment<'_> {
    /// Returns the same pipeline with an `observer`, which is notified of the trials that are executed again.
    pub fn observed_by(self, observer: &dyn Observer) -> Reenactment<'_> {
        Reenactment { scheduler: self.scheduler, observer, executed: None }
    }
}

impl Pipeline for Reenactment<'_> {
    fn engine(&self, bundle: &Bundle) -> String {
        // A study that this program does not know was run by another.
        let kind = bundle.resolved().study.read();
        kind.map_or_else(|_| ENGINE_VERSION.to_owned(), engine_version)
    }

    fn replan<'a>(&'a self, bundle: &'a Bundle) -> Result<Box<dyn Replanned + 'a>, ReplanError> {
        let (plan, selection) = plan_of(bundle)?;
        Ok(Box::new(Study {
            bundle,
            plan,
            selection,
            scheduler: &self.scheduler,
            observer: self.observer,
            executed: self.executed,
        }))
    }
}

/// How many more trials a manifest may ask for than its bundle holds before it is not even planned.
const MOST_MISSING: u64 = 10_000;

/// Plans the study of `bundle` again, from its manifest, inputs, overrides and selection alone.
///
/// # Errors
/// Where they do not make a plan.
pub fn plan_of(bundle: &Bundle) -> Result<(Plan, Selection), ReplanError> {
    plan_with(bundle, None)
}

/// Makes the same plan; with a fresh seed in place of the manifest's, and all that ran before done anew, where one is
/// given.
fn plan_with(
    bundle: &Bundle,
    fresh: Option<(u64, &Study<'_>)>,
) -> Result<(Plan, Selection), ReplanError> {
    let (source, mut overrides) = written(bundle)?;
    // As `run --set seed=S` would have it: the last override counts.
    overrides.extend(fresh.map(|(seed, _)| format!("seed={seed}")));
    let written = &bundle.resolved().selection;
    let selection = if written.is_absent() {
        Selection::default()
    } else {
        written.read().map_err(ReplanError::Selection)?
    };
    let inputs: &dyn Inputs = match fresh {
        Some((seed, study)) => &Afresh::seeded(bundle, seed, study),
        None => &Sealed(bundle),
    };
    let experiment = resolve(&source, &overrides, inputs)?;
    // Counted before they are made: a manifest of a few words can ask for millions.
    let planned = Plan::size(&experiment, &selection);
    let sealed: usize = bundle.conditions().iter().map(|c| bundle.record_count(&c.slug)).sum();
    if planned > sealed as u64 + MOST_MISSING {
        return Err(ReplanError::TooMany { planned, sealed });
    }
    let plan = if selection.is_partial() {
        Plan::select(experiment, &selection)?
    } else {
        Plan::of(experiment)
    };
    Ok((plan, selection))
}

/// Returns the manifest in `bundle` and what was overridden in it.
fn written(bundle: &Bundle) -> Result<(Source, Vec<String>), ReplanError> {
    let overrides = bundle.resolved().overrides.read().map_err(ReplanError::Overrides)?;
    let text = std::str::from_utf8(bundle.study_yaml()).map_err(|_| ReplanError::NotText)?;
    Ok((Source::new("study.yaml", text), overrides))
}

fn resolve(
    source: &Source,
    overrides: &[String],
    inputs: &dyn Inputs,
) -> Result<Experiment, ReplanError> {
    let resolved = manifest::resolve(source, overrides, inputs);
    resolved.map(|(experiment, _)| experiment).map_err(ReplanError::Faulty)
}

/// Why a bundle's manifest does not get an input.
#[derive(Debug, thiserror::Error)]
#[error("the bundle holds no such input")]
struct NotSealed;

/// The inputs sealed in a bundle.
struct Sealed<'a>(&'a Bundle);

impl Inputs for Sealed<'_> {
    fn read(&self, as_written: &str, _: WrittenIn) -> Result<Vec<u8>, InputError> {
        let bytes = self.0.input(as_written).map(<[u8]>::to_vec);
        bytes.ok_or_else(|| InputError::other(NotSealed))
    }

    /// What is in the bundle was allowed when it was sealed, and nothing else is at hand.
    fn follows(&self, as_written: &str, _: WrittenIn) -> bool {
        self.0.input(as_written).is_some()
    }

    fn calibrate(&self, _: &Experiment, sealed_as: &str) -> Result<CalibrationTrials, InputError> {
        self.read(sealed_as, WrittenIn::Calibration).map(CalibrationTrials::Csv)
    }

    fn propose(&self, _: &Experiment, sealed_as: &str) -> Result<ProposalTrials, InputError> {
        self.read(sealed_as, WrittenIn::Inference).map(ProposalTrials::Lines)
    }

    fn explore(&self, _: &TrialSpec, sealed_as: &[String; 2]) -> Result<[Vec<u8>; 2], InputError> {
        let [descriptor, image] = sealed_as;
        let read = |name: &str| self.read(name, WrittenIn::PreviousMap);
        Ok([read(descriptor)?, read(image)?])
    }
}

/// The inputs sealed in a bundle, but for the maps of earlier explorations, which are explored again, and with fresh seeds the
/// calibration, which is measured anew.
struct Afresh<'a> {
    sealed: Sealed<'a>,
    /// The seed and who runs the calibration with it.
    fresh: Option<(u64, &'a Study<'a>)>,
    /// The sealed maps that came out otherwise.
    other: RefCell<Vec<Fault>>,
}

impl<'a> Afresh<'a> {
    fn new(bundle: &'a Bundle) -> Self {
        Self { sealed: Sealed(bundle), fresh: None, other: RefCell::default() }
    }

    fn seeded(bundle: &'a Bundle, seed: u64, study: &'a Study<'a>) -> Self {
        Self { fresh: Some((seed, study)), ..Self::new(bundle) }
    }
}

impl Inputs for Afresh<'_> {
    fn read(&self, as_written: &str, written_in: WrittenIn) -> Result<Vec<u8>, InputError> {
        self.sealed.read(as_written, written_in)
    }

    fn follows(&self, as_written: &str, written_in: WrittenIn) -> bool {
        self.sealed.follows(as_written, written_in)
    }

    fn calibrate(
        &self,
        calibration: &Experiment,
        sealed_as: &str,
    ) -> Result<CalibrationTrials, InputError> {
        let Some((seed, study)) = self.fresh else {
            return self.sealed.calibrate(calibration, sealed_as);
        };
        // Not the study's own: no passage may share a random number with a trial.
        let seed = Seeds::new(seed, Vec::new()).stream("calibration-seed").bits();
        let mut seeded = calibration.clone();
        seeded.seed = seed;
        let plan = Plan::of(seeded);
        let records = study.run(&plan.trials).map_err(InputError::other)?;
        CalibrationTrials::shown_by(&plan.experiment, &records).map_err(InputError::other)
    }

    /// Returns the sealed ones, with fresh seeds too: other draws would be another study.
    fn propose(&self, inference: &Experiment, sealed: &str) -> Result<ProposalTrials, InputError> {
        self.sealed.propose(inference, sealed)
    }

    fn explore(
        &self,
        spec: &TrialSpec,
        sealed_as: &[String; 2],
    ) -> Result<[Vec<u8>; 2], InputError> {
        let again = manifest::explored(spec, sealed_as)?;
        // With another seed there is another exploration, of which the bundle knows nothing.
        if let Ok(sealed) = self.sealed.explore(spec, sealed_as) {
            for ((name, sealed), again) in sealed_as.iter().zip(sealed).zip(&again) {
                if sealed != *again {
                    let digest =
                        |bytes: &[u8]| format!("sha256:{}", Sha256Digest::of(bytes).short());
                    // These names are flat and safe, and so what they are in the bundle.
                    let path = BundlePath::input(name);
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
    executed: Option<&'a Executed>,
}

impl Study<'_> {
    /// Executes `trials` and returns their records, never from a store; those that others executed for this climb are taken.
    fn run(&self, trials: &[TrialSpec]) -> Result<Vec<TrialRecord>, RunError> {
        let executed = self.executed.map(|executed| executed as &dyn TrialStore);
        self.scheduler.run(trials, &studies::execute, executed, self.observer)
    }

    /// Drives the passages at `indices` again.
    fn drive_again(&self, indices: &[usize]) -> Result<Vec<Option<Fault>>, MakeAgainError> {
        let run = self.plan.experiment.calibration.as_deref();
        let run = run.ok_or(MakeAgainError::NoCalibration)?;
        let sealed = run.showed.as_ref().ok_or(MakeAgainError::NoPassages)?;
        let path = BundlePath::input(file_name(&run.sealed_as));
        let plan = Plan::of(run.experiment.clone());
        let spec = |&i: &usize| plan.trials.get(i).cloned().ok_or(MakeAgainError::NoPassage(i));
        let trials = indices.iter().map(spec).collect::<Result<Vec<TrialSpec>, _>>()?;
        let records = self.run(&trials)?;
        let compared = indices.iter().zip(&records).map(|(&index, record)| {
            let expected = sealed.told_of(record);
            let found = sealed.told(index).ok_or(MakeAgainError::NoPassage(index))?;
            let fault = Fault::new(
                // Below the header.
                path.line(index + 2),
                format!("`{expected}`, as the passage gives when it is driven again"),
                format!("`{found}`"),
            );
            let hint = "the planner's expectations rest on passages that were not driven so";
            Ok((expected != found).then(|| fault.hint(hint)))
        });
        compared.collect()
    }
}

impl Study<'_> {
    /// Makes the proposals at `indices` again.
    fn propose_again(&self, indices: &[usize]) -> Result<Vec<Option<Fault>>, MakeAgainError> {
        let run = self.plan.experiment.inference().ok_or(MakeAgainError::NoInference)?;
        let sealed = run.proposals.as_ref().ok_or(MakeAgainError::NoInference)?;
        let path = BundlePath::input(file_name(&run.sealed_as));
        let plan = Plan::of(Experiment::clone(&run.experiment));
        let spec = |&i: &usize| plan.trials.get(i).cloned().ok_or(MakeAgainError::NoProposal(i));
        let trials = indices.iter().map(spec).collect::<Result<Vec<TrialSpec>, _>>()?;
        let records = self.run(&trials)?;
        let compared = indices.iter().zip(&records).map(|(&index, record)| {
            let found = sealed.get(index).ok_or(MakeAgainError::NoProposal(index))?;
            let expected = record.to_line();
            let digest = |line: &str| format!("sha256:{}", Sha256Digest::of(line).short());
            let fault = Fault::new(
                path.line(index + 1),
                format!("{} as the proposal is made again", digest(&expected)),
                digest(found),
            );
            let hint = "the draws that the study runs rest on proposals that were not made so";
            Ok((expected != *found).then(|| fault.hint(hint)))
        });
        compared.collect()
    }
}

/// Returns the last part of a path.
fn file_name(path: &str) -> &str {
    path.rsplit('/').next().unwrap_or(path)
}

impl Replanned for Study<'_> {
    fn trials(&self) -> Vec<PlannedTrial> {
        let conditions = self.plan.trials.chunk_by(|a, b| a.condition == b.condition);
        let planned = conditions.flat_map(|trials| {
            let slug: Arc<str> = trials[0].condition.slug().into();
            trials.iter().map(move |spec| {
                let slug = Arc::clone(&slug);
                PlannedTrial { key: spec.key, slug, trial: spec.trial }
            })
        });
        planned.collect()
    }

    fn content(&self) -> Result<BundleContent, ContentError> {
        // Of what is large, size and digest are all that is compared.
        let scratch = Forgetful::default();
        let gathered = self.bundle.gathered(&self.plan, &scratch).map_err(ContentError::Records)?;
        let Gathered { ledger, conditions } = gathered;
        let verdicts = assemble::verdicts_of(&self.plan, &ledger)?;
        let (study_yaml, selection) = (self.bundle.study_yaml(), &self.selection);
        let asked = Asked { plan: &self.plan, study_yaml, selection };
        let content = assemble::assemble_judged(asked, &ledger, conditions, &verdicts, &scratch);
        Ok(content.expect("what forgets takes every byte"))
    }

    fn execute(&self, indices: &[usize]) -> Result<Vec<String>, RunError> {
        let specs: Vec<TrialSpec> = indices.iter().map(|&i| self.plan.trials[i].clone()).collect();
        Ok(self.run(&specs)?.iter().map(TrialRecord::to_line).collect())
    }

    fn explore_again(&self) -> Vec<Fault> {
        let afresh = Afresh::new(self.bundle);
        let told = written(self.bundle)
            .and_then(|(source, overrides)| resolve(&source, &overrides, &afresh));
        let mut faults = afresh.other.into_inner();
        if let (Err(problem), true) = (told, faults.is_empty()) {
            let path = BundlePath::payload(format::STUDY);
            faults.push(Fault::new(
                path,
                "earlier explorations that can be run again",
                problem.to_string(),
            ));
        }
        faults
    }

    fn earlier(&self) -> Vec<Earlier> {
        let inputs = &self.plan.experiment.inputs;
        let path = |as_written: &str| {
            let input = inputs.iter().find(|input| input.as_written == as_written);
            BundlePath::input(input.map_or(as_written, |input| &input.name)).into()
        };
        let passages = self.plan.experiment.calibration.iter().filter_map(|run| {
            let units = vec![1; run.showed.as_ref()?.trials()];
            Some(Earlier { made: Made::Passages, path: path(&run.sealed_as), units })
        });
        let proposals = self.plan.experiment.inference().and_then(|run| {
            let units = vec![1; run.proposals.as_ref()?.len()];
            Some(Earlier { made: Made::Proposals, path: path(&run.sealed_as), units })
        });
        let robustness = self.plan.experiment.sensitivity.iter().map(|known| {
            let conditions = self.plan.experiment.conditions.len() as u64;
            let runs = known.table.runs();
            let units = runs.iter().map(|run| conditions * u64::from(run.trials)).collect();
            Earlier { made: Made::Robustness, path: path(&known.as_written), units }
        });
        let multiverse = self.plan.experiment.multiverse.iter().map(|known| {
            let conditions = self.plan.experiment.conditions.len() as u64;
            let trials = conditions * u64::from(known.table.trials);
            let units = known.table.runs().map(|draw| match draw.found {
                Found::Judged { .. } => trials,
                Found::Refused(_) => 0,
            });
            let path = path(&known.as_written);
            Earlier { made: Made::Multiverse, path, units: units.collect() }
        });
        passages.chain(proposals).chain(robustness).chain(multiverse).collect()
    }

    fn make_again(
        &self,
        made: Made,
        indices: &[usize],
    ) -> Result<Vec<Option<Fault>>, MakeAgainError> {
        match made {
            Made::Passages => self.drive_again(indices),
            Made::Proposals => self.propose_again(indices),
            Made::Robustness => self.vary_again(indices),
            Made::Multiverse => self.draw_again(indices),
        }
    }

    fn replicate(&self, seed: u64) -> Result<BundleContent, ReplicateError> {
        let (plan, selection) = plan_with(self.bundle, Some((seed, self)))?;
        let records = self.run(&plan.trials)?;
        Ok(assemble::assemble(&plan, self.bundle.study_yaml(), &selection, &records)?)
    }
}
