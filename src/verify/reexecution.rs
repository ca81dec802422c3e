//! Levels 4 and 5: trials executed again, by whoever doubts.

use super::{PlannedTrial, Replanned, difference};
use crate::bundle::{Bundle, BundlePath, Fault, format};
use crate::digest::Sha256Digest;
use crate::math;
use crate::rng::Seeds;
use crate::studies::TrialRecord;
use serde::Serialize;

/// What was executed again.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Sample {
    /// The reviewer's seed; `None` where every trial was executed.
    pub seed: Option<u64>,
    /// Trials executed.
    pub executed: usize,
    /// Trials that gave the same bytes.
    pub equal: usize,
    /// Trials in the bundle.
    pub of: usize,
}

impl Sample {
    /// Computes the largest fraction of wrong trials that this many equal ones leave possible at 95 % confidence: 1 -
    /// 0.05^(1/k), exact for draws with replacement and on the safe side without. `None` where a trial differed.
    pub fn bound(&self) -> Option<f64> {
        #[expect(clippy::cast_precision_loss, reason = "counts of trials are small")]
        let k = self.executed as f64;
        if self.equal != self.executed || self.executed == 0 {
            None
        } else if self.executed == self.of {
            Some(0.0)
        } else {
            Some(1.0 - math::pow(0.05, 1.0 / k))
        }
    }

    /// Says in words what it means.
    pub fn in_words(&self) -> String {
        let (executed, of) = (self.executed, self.of);
        let drawn = self.seed.map(|seed| format!(", drawn with seed {seed},")).unwrap_or_default();
        match self.bound() {
            Some(0.0) => format!("all {of} trials gave the same bytes again"),
            Some(bound) => format!(
                "{executed} of {of} trials{drawn} gave the same bytes again: with 95 % confidence fewer than {:.1} % of \
                 all trials would not",
                100.0 * bound
            ),
            None if executed == 0 => "no trial was executed again".to_owned(),
            None => format!(
                "{} of {executed} trials{drawn} gave other bytes than the bundle holds",
                executed - self.equal
            ),
        }
    }
}

/// Draws `count` different places out of `of`, in order, by the reviewer's seed alone.
pub(super) fn draw(seed: u64, count: usize, of: usize) -> Vec<usize> {
    Seeds::new(seed, Vec::new()).stream("verify-sample").places(count, of)
}

/// Faults that are told of one kind of thing that was executed again.
const MOST_FAULTS: usize = 100;

/// Returns the first of `faults`, and how many more there are.
pub(super) fn capped(mut faults: Vec<Fault>) -> Vec<Fault> {
    let more = faults.len().saturating_sub(MOST_FAULTS);
    if more > 0 {
        faults.truncate(MOST_FAULTS);
        faults.push(Fault::new("(bundle)", "the same again", format!("{more} more that differ")));
    }
    faults
}

/// Executes the trials at `indices` again and holds them against the bundle's records.
///
/// # Errors
/// Where this program did not execute what it was asked to, which says nothing of the bundle.
pub(super) fn check(
    bundle: &Bundle,
    replanned: &dyn Replanned,
    indices: &[usize],
    seed: Option<u64>,
) -> Result<(Sample, Vec<Fault>), Fault> {
    let planned = replanned.trials();
    let sealed: Vec<(String, &str)> = bundle
        .conditions()
        .iter()
        .flat_map(|condition| {
            let path = BundlePath::records(&condition.slug);
            let lines = bundle.record_lines(&condition.slug).enumerate();
            lines.map(move |(i, line)| (path.line(i + 1), line))
        })
        .collect();
    let trials = BundlePath::payload(format::TRIALS);
    let failed = |found: String| {
        let expected = format!("{} trials executed again", indices.len());
        Fault::new(&trials, expected, found).hint("this is a bug in reenact, or too little memory")
    };
    let fresh = replanned.execute(indices).map_err(|problem| failed(problem.to_string()))?;
    if fresh.len() != indices.len() {
        return Err(failed(fresh.len().to_string()));
    }
    let mut faults = Vec::new();
    for (&index, fresh) in indices.iter().zip(&fresh) {
        match (sealed.get(index), planned.get(index)) {
            (Some((_, line)), _) if line == fresh => {}
            (Some((place, line)), Some(trial)) => {
                faults.push(differing(place, trial, fresh, line));
            }
            _ => {
                let expected = format!("a record of the plan's trial {}", index + 1);
                faults.push(Fault::new(&trials, expected, "none"));
            }
        }
    }
    let equal = fresh.len().saturating_sub(faults.len());
    Ok((Sample { seed, executed: fresh.len(), equal, of: planned.len() }, faults))
}

/// Returns the obstacle at a level that executed nothing: it has shown nothing.
pub(super) fn nothing_executed(of: usize) -> Fault {
    let path = BundlePath::payload(format::TRIALS);
    let fault = Fault::new(path, "trials to execute again", "none");
    fault.hint(if of == 0 {
        "the bundle holds no trial, so there is none to execute"
    } else {
        "a sample of no trial shows nothing: draw one at least with `--sample`"
    })
}

fn differing(place: &str, trial: &PlannedTrial, fresh: &str, sealed: &str) -> Fault {
    let (expected, found) = difference::records(fresh, sealed);
    let divergence = match (TrialRecord::from_line(fresh), TrialRecord::from_line(sealed)) {
        (Ok(fresh), Ok(sealed)) => fresh.first_divergence(&sealed),
        _ => None,
    };
    let hint = match divergence {
        Some(seconds) => format!(
            "sha256:{} again, sha256:{} in the bundle; states first differ between {seconds} s and {} s of simulated time",
            Sha256Digest::of(fresh).short(),
            Sha256Digest::of(sealed).short(),
            seconds + 10.0
        ),
        None => "the states agree throughout: the record was changed, not the run".to_owned(),
    };
    let expected = format!("{expected}, as trial {} gives when executed again", trial.key.short());
    Fault::new(place, expected, found).hint(hint)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_the_reviewers_and_repeatable() {
        let drawn = draw(7, 10, 100);
        assert_eq!(drawn, draw(7, 10, 100));
        assert_ne!(drawn, draw(8, 10, 100));
        assert!(drawn.windows(2).all(|pair| pair[0] < pair[1]) && drawn.len() == 10);
        assert_eq!(draw(7, 500, 3), [0, 1, 2]);
        // Every place is as likely as any other: 3 of 10, 2000 times, is 600 each.
        let mut counts = [0_u32; 10];
        for seed in 0..2000 {
            for place in draw(seed, 3, 10) {
                counts[place] += 1;
            }
        }
        assert!(counts.iter().all(|count| (520..680).contains(count)), "{counts:?}");
    }

    #[test]
    fn bounds_are_those_of_the_rule_of_three() {
        let sample = |executed| Sample { seed: Some(1), executed, equal: executed, of: 3000 };
        for (k, bound) in [(10, 0.2589), (29, 0.0981), (59, 0.0495), (299, 0.00997)] {
            assert!((sample(k).bound().unwrap() - bound).abs() < 1e-4);
        }
        assert_eq!(sample(3000).bound(), Some(0.0));
        assert_eq!(Sample { equal: 9, ..sample(10) }.bound(), None);
        assert_eq!(
            sample(59).in_words(),
            "59 of 3000 trials, drawn with seed 1, gave the same bytes again: with 95 % confidence fewer than 5.0 % of all \
             trials would not"
        );
    }
}
