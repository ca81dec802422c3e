//! The climb: level by level, collecting everything, and never executing what lower levels found wrong.

use super::reexecution::{self, Sample};
use super::{Finding, Level, Pipeline, Severity, coherent, derived, fixity};
use crate::bundle::{Archive, Bundle, Fault, OpenError, format};
use crate::digest::{BundleId, ResultsDigest, StudyDigest};
use serde::Serialize;

/// How far to climb.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Options {
    /// The highest level to judge.
    pub level: Level,
    /// How many trials level 4 executes.
    pub sample: usize,
    /// The reviewer's seed for drawing them; the bundle's author must not know it beforehand.
    pub seed: u64,
}

/// The answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Every level asked for holds: exit code 0.
    Holds,
    /// The bundle is not what it says: exit code 1.
    Broken,
    /// This program cannot judge that far: exit code 2.
    Unanswered,
}

/// What verification found.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// The level asked for.
    pub asked: Level,
    /// The highest level that holds together with all below it; `None` where not even level 0 does.
    pub reached: Option<Level>,
    /// The levels that were judged.
    pub judged: Vec<Level>,
    /// Everything noticed, lowest level first.
    pub findings: Vec<Finding>,
    /// The study's name, where it could be read.
    pub name: Option<String>,
    /// The engine that ran it.
    pub engine: Option<String>,
    /// This very bundle.
    pub bundle_id: Option<BundleId>,
    /// What came out, computed from the files.
    pub results_digest: Option<ResultsDigest>,
    /// What was asked, computed from the files.
    pub study_digest: Option<StudyDigest>,
    /// What was executed again, at level 4 or 5.
    pub sample: Option<Sample>,
}

impl Report {
    /// The answer.
    pub fn verdict(&self) -> Verdict {
        if self.findings.iter().any(|f| f.severity == Severity::Error) {
            Verdict::Broken
        } else if self.reached == Some(self.asked) {
            Verdict::Holds
        } else {
            Verdict::Unanswered
        }
    }

    fn note(&mut self, level: Level, severity: Severity, faults: impl IntoIterator<Item = Fault>) {
        self.findings.extend(faults.into_iter().map(|fault| Finding::new(level, severity, fault)));
    }

    /// Whether nothing stands in the way so far.
    fn is_clear(&self) -> bool {
        self.findings.iter().all(|finding| finding.severity == Severity::Note)
    }

    fn finish(mut self) -> Self {
        self.reached = None;
        for &level in &self.judged {
            let holds = |f: &Finding| f.level != level || f.severity == Severity::Note;
            if !self.findings.iter().all(holds) {
                break;
            }
            self.reached = Some(level);
        }
        self
    }
}

/// Climbs as far as asked. `opened` is what `bundle::archive` or `store` made of the file; `pipeline` is what levels 3
/// and above need.
pub fn climb(
    opened: Result<Archive, Vec<Fault>>,
    options: &Options,
    pipeline: &dyn Pipeline,
) -> Report {
    let mut report = Report {
        asked: options.level,
        reached: None,
        judged: vec![Level::Safe],
        findings: Vec::new(),
        name: None,
        engine: None,
        bundle_id: None,
        results_digest: None,
        study_digest: None,
        sample: None,
    };
    let archive = match opened {
        Ok(archive) => archive,
        Err(faults) => {
            report.note(Level::Safe, Severity::Error, faults);
            return report.finish();
        }
    };
    if options.level >= Level::Fixity {
        report.judged.push(Level::Fixity);
        report.note(Level::Fixity, Severity::Error, fixity::check(&archive));
    }
    if options.level >= Level::Coherent {
        report.judged.push(Level::Coherent);
        report.note(Level::Coherent, Severity::Error, coherent::crate_metadata(&archive.tree));
        report.note(Level::Coherent, Severity::Error, coherent::bag_facts(&archive.tree));
    }
    let bundle = match Bundle::open(archive) {
        Ok(bundle) => bundle,
        Err(error) => {
            match error {
                OpenError::Newer(fault) => {
                    // What a newer format means by its files is not for this version to say.
                    report.findings.clear();
                    report.judged = vec![Level::Safe, Level::Fixity];
                    report.note(Level::Fixity, Severity::Obstacle, [fault]);
                }
                OpenError::Unsafe(faults) | OpenError::Damaged(faults) => {
                    if options.level >= Level::Coherent {
                        report.note(Level::Coherent, Severity::Error, faults);
                    }
                }
            }
            return report.finish();
        }
    };
    report.name = Some(bundle.name().to_owned());
    report.engine = Some(bundle.engine().to_owned());
    report.bundle_id = bundle.bundle_id();
    report.results_digest = Some(bundle.results_digest());
    report.study_digest = Some(bundle.study_digest());
    if options.level >= Level::Coherent {
        report.note(Level::Coherent, Severity::Error, coherent::contents(&bundle));
    }
    if options.level >= Level::Derived {
        report.judged.push(Level::Derived);
        climb_on(&mut report, &bundle, options, pipeline);
    }
    report.finish()
}

/// Level 3 and above: what needs the engine.
fn climb_on(report: &mut Report, bundle: &Bundle, options: &Options, pipeline: &dyn Pipeline) {
    if bundle.engine() != pipeline.engine() {
        let path = format!("{}{}", format::PAYLOAD, format::RESOLVED);
        let fault = Fault::new(
            path,
            format!("engine {}", pipeline.engine()),
            format!("engine {}", bundle.engine()),
        );
        let hint = "only the engine that ran a study can derive or execute it again; the bundle's README.md has the line \
                    that installs it";
        report.note(Level::Derived, Severity::Obstacle, [fault.hint(hint)]);
        return;
    }
    let replanned = match pipeline.replan(bundle) {
        Ok(replanned) => replanned,
        Err(problem) => {
            let path = format!("{}{}", format::PAYLOAD, format::STUDY);
            let fault = Fault::new(path, "a manifest that can be planned again", problem);
            report.note(Level::Derived, Severity::Error, [fault]);
            return;
        }
    };
    let (faults, notes) = derived::check(bundle, replanned.as_ref());
    report.note(Level::Derived, Severity::Error, faults);
    report.note(Level::Derived, Severity::Note, notes);
    if options.level <= Level::Derived || !report.is_clear() {
        return;
    }
    let of = replanned.trials().len();
    let (level, indices, seed) = if options.level == Level::Full {
        (Level::Full, (0..of).collect(), None)
    } else {
        (Level::Sampled, reexecution::draw(options.seed, options.sample, of), Some(options.seed))
    };
    if level == Level::Full {
        // All trials are a sample, too.
        report.judged.push(Level::Sampled);
    }
    report.judged.push(level);
    let (sample, faults) = reexecution::check(bundle, replanned.as_ref(), &indices, seed);
    // A single trial that differs fails the sample as well as the whole.
    report.note(Level::Sampled, Severity::Error, faults);
    report.sample = Some(sample);
}
