//! How long a run still takes: by simulated time, as trials of one condition are alike and those of different ones are not,
//! and by what was executed, as a trial from the store takes no time.

/// What is known of a run under way.
#[derive(Debug, Default)]
pub(super) struct Estimate {
    /// The condition of every trial of the plan; of one, where nothing is known of them.
    conditions: Vec<usize>,
    /// By condition: trials not finished, simulated time (s) of the finished, and how many these are.
    known: Vec<Known>,
    /// Simulated time (s) of the trials that were executed.
    worked_s: f64,
    executed: usize,
    /// Trials of the store that are still to be told.
    untold: usize,
    jobs: usize,
}

#[derive(Debug, Clone, Copy, Default)]
struct Known {
    left: usize,
    sum_s: f64,
    finished: usize,
}

impl Estimate {
    /// Creates the estimate of a run whose trials have these conditions, `cached` of them in the store.
    pub(super) fn new(conditions: Vec<usize>, cached: usize, jobs: usize) -> Self {
        let mut known = vec![Known::default(); conditions.iter().max().map_or(0, |most| most + 1)];
        for condition in &conditions {
            known[*condition].left += 1;
        }
        Self { conditions, known, untold: cached, jobs, ..Self::default() }
    }

    /// Notes that the trial at `index` of the plan has its record, which took `sim_s` of simulated time; 0 where it
    /// failed.
    pub(super) fn finished(&mut self, index: usize, sim_s: f64, cached: bool) {
        let Some(known) = self.conditions.get(index).and_then(|c| self.known.get_mut(*c)) else {
            return;
        };
        known.left = known.left.saturating_sub(1);
        if sim_s > 0.0 {
            known.sum_s += sim_s;
            known.finished += 1;
        }
        if cached {
            self.untold = self.untold.saturating_sub(1);
        } else {
            self.worked_s += sim_s;
            self.executed += 1;
        }
    }

    /// Counts the trials that are not finished.
    pub(super) fn left(&self) -> usize {
        self.known.iter().map(|known| known.left).sum()
    }

    /// Computes the simulated seconds per second of the clock that has gone `elapsed_s`; `None` before anything was
    /// executed.
    pub(super) fn rate(&self, elapsed_s: f64) -> Option<f64> {
        // Trials under way are half done, as a rule.
        let under_way = self.left().saturating_sub(self.untold).min(self.jobs.saturating_sub(1));
        let worked = self.worked_s + 0.5 * count(under_way) * self.mean_s()?;
        (self.executed > 0 && elapsed_s > 0.0 && worked > 0.0).then(|| worked / elapsed_s)
    }

    /// Estimates the seconds of the clock that the rest takes, where the clock has gone `elapsed_s`.
    pub(super) fn left_s(&self, elapsed_s: f64) -> Option<f64> {
        let mean = self.mean_s()?;
        let of = |known: &Known| {
            let each = if known.finished > 0 { known.sum_s / count(known.finished) } else { mean };
            count(known.left) * each
        };
        let to_simulate: f64 = self.known.iter().map(of).sum();
        let left = self.left();
        let fresh =
            if left == 0 { 0.0 } else { count(left.saturating_sub(self.untold)) / count(left) };
        Some(to_simulate * fresh / self.rate(elapsed_s)?)
    }

    /// Computes the mean simulated time (s) of a trial.
    fn mean_s(&self) -> Option<f64> {
        let (sum, finished) = self
            .known
            .iter()
            .fold((0.0, 0), |(sum, n), known| (sum + known.sum_s, n + known.finished));
        (finished > 0).then(|| sum / count(finished))
    }
}

#[expect(clippy::cast_precision_loss, reason = "trials are fewer than 2^53")]
fn count(n: usize) -> f64 {
    n as f64
}

/// Writes `seconds` as exactly as they deserve: `40 s`, `12 min`, `3 h 05 min`.
pub(super) fn in_words(seconds: f64) -> String {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
    let seconds = seconds.clamp(0.0, 1e9).round() as u64;
    match seconds {
        0..90 => format!("{seconds} s"),
        90..5400 => format!("{} min", (seconds + 30) / 60),
        5400..172_800 => format!("{} h {:02} min", seconds / 3600, seconds % 3600 / 60),
        _ => format!("{} days", (seconds + 43_200) / 86_400),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trials_of_the_store_take_no_time() {
        // 10 trials, 6 in the store; each executed one takes 100 s of simulated time in 10 s, one at a time.
        let mut estimate = Estimate::new(vec![0; 10], 6, 1);
        assert_eq!(estimate.left_s(0.1), None, "nothing is known yet");
        for index in 0..6 {
            estimate.finished(index, 100.0, true);
        }
        assert_eq!(estimate.left_s(0.1), None, "nothing was executed yet");
        estimate.finished(6, 100.0, false);
        assert_eq!(estimate.rate(10.0), Some(10.0));
        assert_eq!(estimate.left_s(10.0), Some(30.0));
        let mut early = Estimate::new(vec![0; 10], 6, 1);
        early.finished(6, 100.0, false);
        assert_eq!(early.left_s(10.0), Some(30.0), "also before they are told");
    }

    #[test]
    fn conditions_differ_in_length() {
        // Short trials first: the long ones are not taken for short once one of them is known.
        let conditions = (0..20).map(|i| usize::from(i >= 10)).collect();
        let mut estimate = Estimate::new(conditions, 0, 1);
        for index in 0..10 {
            estimate.finished(index, 10.0, false);
        }
        assert_eq!(estimate.left_s(10.0), Some(10.0));
        estimate.finished(10, 1000.0, false);
        assert_eq!(estimate.left_s(110.0), Some(900.0));
    }

    #[test]
    fn trials_under_way_count_half() {
        let mut estimate = Estimate::new(vec![0; 5], 0, 4);
        estimate.finished(0, 100.0, false);
        // 100 s done and three trials half done: 250 s of work in 10 s.
        assert_eq!(estimate.rate(10.0), Some(25.0));
        assert_eq!(estimate.left_s(10.0), Some(16.0));
    }

    #[test]
    fn words_are_as_exact_as_they_deserve() {
        let words = [0.4, 89.0, 100.0, 3600.0, 5400.0, 172_799.0, 1e6].map(in_words);
        assert_eq!(
            words,
            ["0 s", "89 s", "2 min", "60 min", "1 h 30 min", "47 h 59 min", "12 days"]
        );
    }
}
