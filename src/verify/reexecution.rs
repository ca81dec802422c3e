//! Levels 4 and 5: trials executed again, by whoever doubts.

use super::asked::Options;
use super::{Level, PlannedTrial, Replanned, difference};
use crate::bundle::{Bundle, BundlePath, Fault, format};
use crate::digest::Sha256Digest;
use crate::math;
use crate::rng::Seeds;
use crate::studies::TrialRecord;
use serde::Serialize;

/// What was executed again.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
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

/// Returns the level at which trials of a plan of `of` are executed again, and their places in it: all of them from level 5 on.
pub(super) fn chosen(options: &Options, of: usize) -> (Level, Vec<usize>) {
    if options.level >= Level::Full {
        (Level::Full, (0..of).collect())
    } else {
        (Level::Sampled, draw(options.seed, options.sample, of))
    }
}

/// Draws `count` different places out of `of`, in order, by the reviewer's seed alone.
fn draw(seed: u64, count: usize, of: usize) -> Vec<usize> {
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
    let mut again = Again { replanned, planned: &planned, wanted: Vec::new(), faults: Vec::new() };
    let mut left = indices.iter().copied().peekable();
    let (mut at, mut failure) = (0, None);
    for condition in bundle.conditions() {
        bundle.record_lines(&condition.slug, |line| {
            if left.next_if_eq(&at).is_some() {
                again.wanted.push((at, Some((line.place(), line.text.to_owned()))));
            }
            at += 1;
            if again.wanted.len() >= AT_ONCE {
                failure = again.execute().err();
            }
            failure.is_none()
        });
        if failure.is_some() {
            break;
        }
    }
    again.wanted.extend(left.map(|index| (index, None)));
    if let Some(problem) = failure.or_else(|| again.execute().err()) {
        let trials = BundlePath::payload(format::TRIALS);
        let expected = format!("{} trials executed again", indices.len());
        let fault = Fault::new(&trials, expected, problem);
        return Err(fault.hint("this is a bug in reenact, or too little memory"));
    }
    let (executed, of, faults) = (indices.len(), planned.len(), again.faults);
    let equal = executed.saturating_sub(faults.len());
    Ok((Sample { seed, executed, equal, of }, faults))
}

/// Trials whose records are held at once.
const AT_ONCE: usize = 8192;

/// Trials that are executed again.
struct Again<'a> {
    replanned: &'a dyn Replanned,
    planned: &'a [PlannedTrial],
    /// Their places in the plan, with the place and the text of the record that the bundle holds.
    wanted: Vec<(usize, Option<(String, String)>)>,
    faults: Vec<Fault>,
}

impl Again<'_> {
    /// Executes those that are wanted, and holds them against the bundle's records.
    ///
    /// # Errors
    /// Where this program did not execute them.
    fn execute(&mut self) -> Result<(), String> {
        let wanted = std::mem::take(&mut self.wanted);
        let indices: Vec<usize> = wanted.iter().map(|(index, _)| *index).collect();
        let fresh = self.replanned.execute(&indices).map_err(|problem| problem.to_string())?;
        if fresh.len() != indices.len() {
            return Err(fresh.len().to_string());
        }
        for ((index, sealed), fresh) in wanted.iter().zip(&fresh) {
            match (sealed, self.planned.get(*index)) {
                (Some((_, line)), _) if line == fresh => {}
                (Some((place, line)), Some(trial)) => {
                    self.faults.push(differing(place, trial, fresh, line));
                }
                _ => {
                    let trials = BundlePath::payload(format::TRIALS);
                    let expected = format!("a record of the plan's trial {}", index + 1);
                    self.faults.push(Fault::new(&trials, expected, "none"));
                }
            }
        }
        Ok(())
    }
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
