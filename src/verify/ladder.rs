//! The climb: level by level, collecting everything, and never executing what lower levels found wrong.

use super::asked::{Options, Reviewer};
use super::earlier::{Earlier, EarlierAgain};
use super::reexecution::{self, Sample};
use super::replication::{self, Replication};
use super::signature::{self, Signed, Vouching};
use super::{Attestation, Finding, Level, Pipeline, Severity, coherent, derived, fixity, support};
use crate::bundle::{Archive, Bundle, BundlePath, Departure, Fault, OpenError, format};
use crate::digest::{BundleId, ResultsDigest, StudyDigest};
use serde::Serialize;

/// The answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Every level asked for holds: exit code 0.
    Holds,
    /// The bundle is not what it says: exit code 1.
    Broken,
    /// The bundle is what it says, and fresh seeds say the opposite of one of its verdicts: exit code 1.
    NotReplicated,
    /// The attestation that was given does not attest this bundle: exit code 1.
    NotAttested,
    /// This program cannot judge that far: exit code 2.
    Unanswered,
    /// This program failed on the way: exit code 3.
    Failed,
}

impl Verdict {
    /// Returns the exit code of a command that answers this.
    pub fn exit_code(self) -> u8 {
        match self {
            Self::Holds => 0,
            Self::Broken | Self::NotReplicated | Self::NotAttested => 1,
            Self::Unanswered => 2,
            Self::Failed => 3,
        }
    }
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
    /// How the run departs from the manifest as it stands, where the bundle could be read.
    pub departure: Option<Departure>,
    /// The engine that ran it.
    pub engine: Option<String>,
    /// This very bundle.
    pub bundle_id: Option<BundleId>,
    /// What came out, computed from the files.
    pub results_digest: Option<ResultsDigest>,
    /// What was asked, computed from the files.
    pub study_digest: Option<StudyDigest>,
    /// Who vouches for it, where that was asked and found good.
    pub signed: Option<Signed>,
    /// The attestation that was held against the bundle, or why it does not attest it.
    pub attestation: Option<Result<Attestation, Fault>>,
    /// What was executed again, at level 4 or 5.
    pub sample: Option<Sample>,
    /// What fresh seeds said, at level 6.
    pub replication: Option<Replication>,
    /// What was made by runs before the study's own, and executed again.
    pub earlier: Vec<EarlierAgain>,
    /// What nothing was held against here, each in a few words: whoever reads on must know whose word it is.
    pub unchecked: Vec<String>,
    /// What nothing can be held against: the circumstances of the run, as it tells them itself.
    pub circumstances: Vec<&'static str>,
    /// How long each level took (s), where a clock was given: for CI, and no part of the answer.
    pub seconds: Vec<(Level, f64)>,
}

impl Report {
    /// Returns the answer.
    pub fn verdict(&self) -> Verdict {
        let mut errors = self.findings.iter().filter(|f| f.severity == Severity::Error).peekable();
        if errors.peek().is_some() {
            if errors.all(|f| f.level == Level::Replicated) {
                Verdict::NotReplicated
            } else {
                Verdict::Broken
            }
        } else if self.findings.iter().any(|f| f.severity == Severity::Failure) {
            Verdict::Failed
        } else if matches!(self.attestation, Some(Err(_))) {
            Verdict::NotAttested
        } else if self.reached == Some(self.asked) {
            Verdict::Holds
        } else {
            Verdict::Unanswered
        }
    }

    fn note(&mut self, level: Level, severity: Severity, faults: impl IntoIterator<Item = Fault>) {
        self.findings.extend(faults.into_iter().map(|fault| Finding::new(level, severity, fault)));
    }

    /// Returns whether nothing hinders the climb so far.
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
///
/// ```
/// use reenact::bundle::{Limits, archive};
/// use reenact::verify::{Level, Options, Reenactment, climb};
///
/// let mut zip = std::fs::read("artifacts/quickstart-published.zip").unwrap();
/// let options = Options { level: Level::Coherent, sample: 1, rows: None, seed: 0 };
/// let pipeline = Reenactment::new(1).unwrap();
/// let report = climb(archive::read(&zip, &Limits::default()), &options, &pipeline);
/// assert_eq!(report.reached, Some(Level::Coherent));
/// zip.truncate(1000);
/// let report = climb(archive::read(&zip, &Limits::default()), &options, &pipeline);
/// assert_eq!(report.reached, None);
/// ```
pub fn climb(
    opened: Result<Archive, Vec<Fault>>,
    options: &Options,
    pipeline: &dyn Pipeline,
) -> Report {
    climb_for(&Reviewer::anonymous(), opened, options, pipeline)
}

/// Does what [`climb`] does, for a reviewer who wants to know who vouches for the bundle. The signature is checked
/// after level 0 and before anything else is read; where it is not what the reviewer asked for, the climb ends there.
pub fn climb_for(
    reviewer: &Reviewer<'_>,
    opened: Result<Archive, Vec<Fault>>,
    options: &Options,
    pipeline: &dyn Pipeline,
) -> Report {
    climb_and_keep(reviewer, opened, options, pipeline).0
}

/// Does what [`climb_for`] does, and returns the bundle too for whoever goes on with it; `None` where it cannot be read
/// at all.
pub fn climb_and_keep(
    reviewer: &Reviewer<'_>,
    opened: Result<Archive, Vec<Fault>>,
    options: &Options,
    pipeline: &dyn Pipeline,
) -> (Report, Option<Bundle>) {
    let report = Report {
        asked: options.level,
        reached: None,
        judged: vec![Level::Safe],
        findings: Vec::new(),
        name: None,
        departure: None,
        engine: None,
        bundle_id: None,
        results_digest: None,
        study_digest: None,
        signed: None,
        attestation: None,
        sample: None,
        replication: None,
        earlier: Vec::new(),
        unchecked: Vec::new(),
        circumstances: Vec::new(),
        seconds: Vec::new(),
    };
    let began = (reviewer.clock)();
    let Reviewer { clock, judged, .. } = *reviewer;
    let mut climb = Climb { report, options, pipeline, clock, judged, began };
    let bundle = climb.lower(opened, &reviewer.vouching);
    (climb.report.finish(), bundle)
}

/// A climb on its way.
struct Climb<'a> {
    report: Report,
    options: &'a Options,
    pipeline: &'a dyn Pipeline,
    clock: &'a dyn Fn() -> f64,
    judged: &'a dyn Fn(&Report),
    /// When the level at hand began.
    began: f64,
}

impl Climb<'_> {
    fn wants(&self, level: Level) -> bool {
        self.options.level >= level
    }

    /// Notes how long `level` took, and shows the report as it stands.
    fn took(&mut self, level: Level) {
        let now = (self.clock)();
        self.report.seconds.push((level, now - self.began));
        self.began = now;
        (self.judged)(&self.report.clone().finish());
    }

    /// Climbs levels 0 to 2, and further where they leave a bundle to read.
    fn lower(
        &mut self,
        opened: Result<Archive, Vec<Fault>>,
        vouching: &Vouching<'_>,
    ) -> Option<Bundle> {
        let archive = match opened {
            Ok(archive) => archive,
            Err(faults) => {
                self.report.note(Level::Safe, Severity::Error, faults);
                return None;
            }
        };
        self.took(Level::Safe);
        if !self.signature(&archive, vouching) {
            return None;
        }
        if self.wants(Level::Fixity) {
            self.report.judged.push(Level::Fixity);
            self.report.note(Level::Fixity, Severity::Error, fixity::check(&archive));
            self.took(Level::Fixity);
        }
        if self.wants(Level::Coherent) {
            self.report.judged.push(Level::Coherent);
            let metadata = coherent::crate_metadata(archive.files());
            self.report.note(Level::Coherent, Severity::Error, metadata);
        }
        let bundle = match Bundle::open(archive) {
            Ok(bundle) => bundle,
            Err(error) => {
                self.unreadable(error);
                return None;
            }
        };
        self.report.name = Some(bundle.name().to_owned());
        self.report.departure = Some(Departure::of(bundle.resolved(), bundle.is_partial()));
        self.report.engine = Some(bundle.engine().to_owned());
        self.report.bundle_id = bundle.bundle_id();
        self.report.results_digest = Some(bundle.results_digest());
        self.report.study_digest = Some(bundle.study_digest());
        if self.wants(Level::Coherent) {
            let mut faults = coherent::bag_facts(&bundle);
            faults.extend(coherent::contents(&bundle));
            self.report.note(Level::Coherent, Severity::Error, faults);
            self.took(Level::Coherent);
        }
        if self.wants(Level::Derived) {
            self.report.judged.push(Level::Derived);
            self.upper(&bundle);
        }
        Some(bundle)
    }

    /// Notes who vouches, and returns whether to go on.
    fn signature(&mut self, archive: &Archive, vouching: &Vouching<'_>) -> bool {
        match signature::check(archive, vouching) {
            signature::Outcome::Unsigned => true,
            signature::Outcome::Good(signed) => {
                self.report.signed = Some(signed);
                true
            }
            signature::Outcome::Unchecked(fault) => {
                if self.wants(Level::Fixity) {
                    self.report.note(Level::Fixity, Severity::Note, [fault]);
                }
                true
            }
            signature::Outcome::Refused(fault) => {
                self.report.judged.push(Level::Fixity);
                self.report.note(Level::Fixity, Severity::Error, [fault]);
                false
            }
        }
    }

    fn unreadable(&mut self, error: OpenError) {
        match error {
            OpenError::Newer(fault) => {
                // What a newer format means by its files is not for this version to say.
                self.report.findings.clear();
                self.report.judged = vec![Level::Safe, Level::Fixity];
                self.report.note(Level::Fixity, Severity::Obstacle, [fault]);
            }
            OpenError::Unsafe(faults) | OpenError::Damaged(faults) => {
                if self.wants(Level::Coherent) {
                    self.report.note(Level::Coherent, Severity::Error, faults);
                }
            }
        }
    }

    /// Climbs level 3 and above: what needs the engine.
    fn upper(&mut self, bundle: &Bundle) {
        let (options, pipeline) = (self.options, self.pipeline);
        let engine = pipeline.engine(bundle);
        if bundle.engine() != engine {
            let fault = support::other_engine(bundle, &engine);
            self.report.note(Level::Derived, Severity::Obstacle, [fault]);
            return;
        }
        if !(format::WHOLE..=format::FORMAT).contains(&bundle.format()) {
            let fault = support::other_format(bundle);
            self.report.note(Level::Derived, Severity::Obstacle, [fault]);
            return;
        }
        let replanned = match pipeline.replan(bundle) {
            Ok(replanned) => replanned,
            Err(problem) => {
                let path = BundlePath::payload(format::STUDY);
                let fault =
                    Fault::new(path, "a manifest that can be planned again", problem.to_string());
                self.report.note(Level::Derived, Severity::Error, [fault]);
                return;
            }
        };
        let derived = derived::check(bundle, replanned.as_ref());
        self.report.note(Level::Derived, Severity::Error, derived.faults);
        self.report.note(Level::Derived, Severity::Obstacle, derived.obstacles);
        self.report.note(Level::Derived, Severity::Note, derived.notes);
        self.report.unchecked.extend(derived.unchecked);
        self.report.circumstances = derived.circumstances;
        let earlier = replanned.earlier();
        self.took(Level::Derived);
        if !self.wants(Level::Sampled) || !self.report.is_clear() {
            self.report.unchecked.extend(earlier.iter().filter_map(Earlier::on_trust));
            return;
        }
        let of = replanned.trials().len();
        let (level, indices) = reexecution::chosen(options, of);
        let seed = (level == Level::Sampled).then_some(options.seed);
        if level == Level::Full {
            // All trials are a sample, too.
            self.report.judged.push(Level::Sampled);
        }
        self.report.judged.push(level);
        if level == Level::Full {
            self.report.note(level, Severity::Error, replanned.explore_again());
        }
        let (sample, faults) = match reexecution::check(bundle, replanned.as_ref(), &indices, seed)
        {
            Ok(answer) => answer,
            Err(fault) => return self.report.note(Level::Sampled, Severity::Failure, [fault]),
        };
        if sample.executed == 0 {
            let fault = reexecution::nothing_executed(sample.of);
            self.report.note(Level::Sampled, Severity::Obstacle, [fault]);
        }
        // A single trial that differs fails the sample as well as the whole.
        self.report.note(Level::Sampled, Severity::Error, faults);
        self.report.sample = Some(sample);
        for earlier in &earlier {
            let again = earlier.again(replanned.as_ref(), level, options);
            self.report.note(Level::Sampled, Severity::Error, again.faults);
            self.report.note(Level::Sampled, Severity::Failure, again.failure);
            self.report.unchecked.extend(again.on_trust);
            self.report.earlier.extend(again.executed);
        }
        self.took(level);
        if self.wants(Level::Replicated) && self.report.is_clear() {
            self.report.judged.push(Level::Replicated);
            let (replication, findings) =
                replication::check(bundle, replanned.as_ref(), options.seed);
            for (severity, fault) in findings {
                self.report.note(Level::Replicated, severity, [fault]);
            }
            self.report.replication = replication;
            self.took(Level::Replicated);
        }
    }
}
