//! A level that executed nothing is not passed, and one that was not executed as asked says nothing.

use super::*;

/// The sample's pipeline, but for what `execute` answers.
struct Executing(fn(&[usize]) -> Result<Vec<String>, RunError>);

struct Answering<'a> {
    inner: Box<dyn Replanned + 'a>,
    answer: fn(&[usize]) -> Result<Vec<String>, RunError>,
}

impl Pipeline for Executing {
    fn engine(&self, bundle: &Bundle) -> String {
        ENGINE.engine(bundle)
    }

    fn replan<'a>(&'a self, bundle: &'a Bundle) -> Result<Box<dyn Replanned + 'a>, ReplanError> {
        Ok(Box::new(Answering { inner: ENGINE.replan(bundle)?, answer: self.0 }))
    }
}

impl Replanned for Answering<'_> {
    fn trials(&self) -> Vec<PlannedTrial> {
        self.inner.trials()
    }

    fn content(&self) -> Result<BundleContent, ContentError> {
        self.inner.content()
    }

    fn execute(&self, indices: &[usize]) -> Result<Vec<String>, RunError> {
        (self.answer)(indices)
    }

    fn replicate(&self, seed: u64) -> Result<BundleContent, ReplicateError> {
        self.inner.replicate(seed)
    }
}

fn climbed(level: Level, sample: usize, pipeline: &dyn Pipeline) -> Report {
    let options = Options { level, sample, rows: None, seed: 1 };
    climb(Ok(Archive::of(Form::Bag, sample::sealed().tree)), &options, pipeline)
}

#[test]
fn a_sample_of_no_trial_passes_nothing() {
    let report = climbed(Level::Sampled, 0, &ENGINE);
    assert_eq!((report.verdict(), report.reached), (Verdict::Unanswered, Some(Level::Derived)));
    let human = report.to_human();
    let says = "  4 sampled   not judged\nobstacle at level 4: data/trials/: expected trials to execute again, found none (a sample \
                of no trial shows nothing: draw one at least with `--sample`)\nno trial was executed again\nnot checked: time and host \
                of the run\nreached level 3 (derived) of level 4 (sampled): this program cannot judge further\n";
    assert!(human.ends_with(says), "{human}");
    let why = report.attest(crate::bundle::Moment(0)).unwrap_err().to_string();
    assert_eq!(
        why,
        "the bundle holds to level 3 (derived) and not to level 4 (sampled), as was asked"
    );
}

#[test]
fn a_program_that_executed_otherwise_than_asked_has_failed() {
    type Answer = fn(&[usize]) -> Result<Vec<String>, RunError>;
    let none: Answer = |_| Ok(Vec::new());
    let fewer: Answer = |indices| Ok(vec![String::new(); indices.len() - 1]);
    let refused: Answer = |_| Err(RunError::Threads { jobs: 2, problem: "none left".to_owned() });
    let no_threads = "could not start 2 threads: none left; try fewer --jobs";
    for (answer, found) in [(none, "0"), (fewer, "5"), (refused, no_threads)] {
        for level in [Level::Sampled, Level::Full, Level::Replicated] {
            let report = climbed(level, 6, &Executing(answer));
            assert_eq!((report.verdict(), report.reached), (Verdict::Failed, Some(Level::Derived)));
            let human = report.to_human();
            let says = format!(
                "failure at level 4: data/trials/: expected 6 trials executed again, found {found} (this is a bug in reenact, or \
                 too little memory)\nnot checked: time and host of the run\nreached level 3 (derived) of level {level}: this program failed, which says nothing of the \
                 bundle\n"
            );
            assert!(human.ends_with(&says), "{human}");
            assert!(human.contains("  4 sampled ") && !human.contains("  4 sampled    passed"));
            let junit = report.to_junit();
            assert!(
                junit.contains("<error message=\"failure at level 4: ")
                    && junit.contains("errors=\"1\"")
            );
        }
    }
}
