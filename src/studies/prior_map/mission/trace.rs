//! The record of a running trial: coverage over time and distance, and the state-hash chain.

use crate::geometry::Pose;
use crate::studies::prior_map::Crossing;
use crate::studies::state_chain::StateChain;
use crate::studies::{Measures, Outcome, SeriesPoint, TrialRecord, TrialSpec};
use crate::units::Tick;
use std::collections::BTreeMap;

/// Coverages (percent) at which distance and time are measured.
pub const MILESTONES: [u32; 10] = [50, 55, 60, 65, 70, 75, 80, 85, 90, 95];

/// Returns the names of the measures of time and distance at a further level of coverage (percent): `time-s-at-99.5`.
pub fn at_level(percent: f64) -> [String; 2] {
    [format!("time-s-at-{percent}"), format!("distance-m-at-{percent}")]
}

/// Returns the level of coverage (percent) that `name`, one of [`at_level`], is of.
pub fn level_of(name: &str) -> Option<f64> {
    let percent =
        name.strip_prefix("time-s-at-").or_else(|| name.strip_prefix("distance-m-at-"))?;
    let percent: f64 = percent.parse().ok().filter(|level| (0.0..=100.0).contains(level))?;
    at_level(percent).iter().any(|known| known == name).then_some(percent)
}

/// Returns the name of the measure of coverage (percent) after `distance_m` of travel.
pub fn coverage_at_distance(distance_m: u32) -> String {
    format!("coverage-percent-at-{distance_m}-m")
}

/// Returns whether `name` is that of coverage after some distance.
pub fn is_coverage_at_distance(name: &str) -> bool {
    let distance = name.strip_prefix("coverage-percent-at-").and_then(|n| n.strip_suffix("-m"));
    distance.is_some_and(|distance| distance.parse::<u32>().is_ok())
}

/// A level of coverage, and when it was reached.
#[derive(Debug, Clone, Copy)]
struct Level {
    percent: f64,
    is_reached: bool,
    /// Time (s) and distance (m), once that is decided.
    crossing: Option<(f64, f64)>,
}

/// The running record of a trial.
#[derive(Debug)]
pub(super) struct Trace {
    total: u32,
    covered: i64,
    next_percent: u32,
    series: Vec<SeriesPoint>,
    when: Crossing,
    crossings: BTreeMap<u32, (f64, f64)>,
    /// Crossed at a keyframe, but a choice decides when.
    undecided: Vec<u32>,
    /// Time (s), distance (m) and coverage (percent) at the last keyframe that changed the map.
    before: (f64, f64, f64),
    /// Further levels of coverage (percent) that are asked for, in between or above whole ones.
    levels: Vec<Level>,
    /// Distances (m) at which coverage is asked for, and its value there.
    at_distances: BTreeMap<u32, Option<f64>>,
    chain: StateChain,
}

impl Trace {
    /// Creates the trace of a trial in a world of `total` cells to cover; `when` decides at which moment a coverage
    /// counts as reached, which is also told of the further `levels` (percent), and coverage at `distances` (m).
    pub(super) fn new(total: u32, when: Crossing, distances: &[u32], levels: &[f64]) -> Self {
        let level = |&percent: &f64| Level { percent, is_reached: false, crossing: None };
        Self {
            total,
            covered: 0,
            next_percent: 1,
            series: Vec::new(),
            when,
            crossings: BTreeMap::new(),
            undecided: Vec::new(),
            before: (0.0, 0.0, 0.0),
            levels: levels.iter().map(level).collect(),
            at_distances: distances.iter().map(|&distance| (distance, None)).collect(),
            chain: StateChain::default(),
        }
    }

    /// Changes the number of covered cells.
    pub(super) fn cover(&mut self, change: i64) {
        self.covered += change;
    }

    /// Returns the coverage (percent, 0 to 100).
    pub(super) fn coverage_percent(&self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "cells of a building")]
        let covered = self.covered as f64;
        100.0 * covered / f64::from(self.total.max(1))
    }

    /// Returns whether it is told of every coverage reached when that was.
    pub(super) fn is_settled(&self) -> bool {
        let waits = |level: &Level| level.is_reached && level.crossing.is_none();
        self.undecided.is_empty() && !self.levels.iter().any(waits)
    }

    /// Notes the first crossing of every whole percent, at a keyframe that changed the map, and returns those crossed.
    pub(super) fn note_coverage(&mut self, now: Tick, distance_m: f64) -> std::ops::Range<u32> {
        let percent = self.coverage_percent();
        let time_s = now.seconds().get();
        let first = self.next_percent;
        while self.next_percent <= 100 && percent >= f64::from(self.next_percent) {
            let level = self.next_percent;
            match self.crossing(f64::from(level), (time_s, distance_m, percent)) {
                Some(crossing) => {
                    self.crossings.insert(level, crossing);
                }
                None => self.undecided.push(level),
            }
            self.next_percent += 1;
        }
        for i in 0..self.levels.len() {
            let Level { percent: level, is_reached, .. } = self.levels[i];
            if !is_reached && percent >= level {
                let crossing = self.crossing(level, (time_s, distance_m, percent));
                self.levels[i] = Level { percent: level, is_reached: true, crossing };
            }
        }
        self.before = (time_s, distance_m, percent);
        if first < self.next_percent {
            self.series.push(SeriesPoint { time_s, distance_m, coverage_percent: percent });
        }
        first..self.next_percent
    }

    /// Returns the time and distance at which `level` percent count as reached by a keyframe that brought `after`; `None`
    /// where the next choice will tell.
    fn crossing(&self, level: f64, after: (f64, f64, f64)) -> Option<(f64, f64)> {
        match self.when {
            Crossing::Keyframe => Some((after.0, after.1)),
            Crossing::Interpolated => Some(self.in_between(level, after)),
            Crossing::Decision => None,
        }
    }

    /// Returns the time and distance at which `level` percent were reached on a straight line from the keyframe before
    /// to `after`.
    fn in_between(&self, level: f64, after: (f64, f64, f64)) -> (f64, f64) {
        let before = self.before;
        let share = (level - before.2) / (after.2 - before.2);
        (before.0 + share * (after.0 - before.0), before.1 + share * (after.1 - before.1))
    }

    /// Notes that a location was chosen.
    pub(super) fn note_choice(&mut self, now: Tick, distance_m: f64) {
        for level in self.undecided.drain(..) {
            self.crossings.insert(level, (now.seconds().get(), distance_m));
        }
        for level in self.levels.iter_mut().filter(|level| level.is_reached) {
            level.crossing.get_or_insert((now.seconds().get(), distance_m));
        }
    }

    /// Notes how far the robot is, and every 10 s a point of the curve and a state hash.
    pub(super) fn note_time(&mut self, now: Tick, distance_m: f64, pose: Pose, choices: u32) {
        let percent = self.coverage_percent();
        let passed = |distance: u32| distance_m >= f64::from(distance);
        for (_, coverage) in self.at_distances.iter_mut().filter(|(d, _)| passed(**d)) {
            coverage.get_or_insert(percent);
        }
        if !self.chain.is_due(now) {
            return;
        }
        let coverage_percent = self.coverage_percent();
        self.series.push(SeriesPoint { time_s: now.seconds().get(), distance_m, coverage_percent });
        let covered = self.covered;
        self.chain.push(|hasher| {
            for bits in [pose.x, pose.y, pose.heading, distance_m].map(f64::to_bits) {
                hasher.update(bits.to_le_bytes());
            }
            hasher.update(now.0.to_le_bytes());
            hasher.update(covered.to_le_bytes());
            hasher.update(choices.to_le_bytes());
        });
    }

    /// Returns the record of the trial that ended `now` with `outcome`.
    pub(super) fn finish(
        self,
        spec: &TrialSpec,
        outcome: Outcome,
        cause: String,
        now: Tick,
    ) -> TrialRecord {
        let mut measures = Measures::new();
        for percent in MILESTONES {
            let crossing = self.crossings.get(&percent);
            measures.insert(format!("time-s-at-{percent}"), crossing.map(|c| c.0));
            measures.insert(format!("distance-m-at-{percent}"), crossing.map(|c| c.1));
        }
        for level in &self.levels {
            let [time, distance] = at_level(level.percent);
            measures.insert(time, level.crossing.map(|c| c.0));
            measures.insert(distance, level.crossing.map(|c| c.1));
        }
        for (&distance, coverage) in &self.at_distances {
            // A robot that has nothing left to explore has covered as much after any further distance.
            let coverage = coverage.unwrap_or_else(|| self.coverage_percent());
            measures.insert(coverage_at_distance(distance), Some(coverage));
        }
        measures.insert("time-s".to_owned(), Some(now.seconds().get()));
        measures.insert("coverage-percent".to_owned(), Some(self.coverage_percent()));
        TrialRecord {
            key: spec.key,
            condition: spec.condition.clone(),
            trial: spec.trial,
            outcome,
            cause,
            measures,
            series: self.series,
            sim_seconds: now.seconds().get(),
            chain: self.chain.to_hex(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a trace whose keyframes at 2 s and 4 s bring 50 and 60 of 100 cells; a choice follows at 5 s.
    fn trace(when: Crossing) -> Trace {
        let mut trace = Trace::new(100, when, &[], &[52.5, 65.5, 90.5]);
        trace.cover(50);
        assert_eq!(trace.note_coverage(Tick(6000), 1.0), 1..51);
        trace.cover(10);
        assert_eq!(trace.note_coverage(Tick(12_000), 3.0), 51..61);
        trace.note_choice(Tick(15_000), 3.5);
        trace.cover(10);
        trace.note_coverage(Tick(18_000), 4.0);
        trace
    }

    #[test]
    fn coverage_is_told_where_the_robot_first_is_that_far() {
        let mut trace = Trace::new(100, Crossing::Keyframe, &[2, 5], &[]);
        for (seconds, distance, cells) in [(1, 1.0, 10), (2, 2.1, 20), (3, 2.5, 30)] {
            trace.cover(cells);
            trace.note_time(Tick(seconds * 3000), distance, Pose::default(), 0);
        }
        let spec = crate::studies::prior_map::mission::tests::spec_of_the_flat();
        let record = trace.finish(&spec, Outcome::EXPLORED, String::new(), Tick(9000));
        assert_eq!(record.measures[&coverage_at_distance(2)], Some(30.0));
        assert_eq!(record.measures[&coverage_at_distance(5)], Some(60.0), "it ended before");
    }

    #[test]
    fn a_coverage_is_reached_at_a_keyframe_in_between_or_at_a_choice() {
        let at = |when, percent| trace(when).crossings.get(&percent).copied();
        assert_eq!(at(Crossing::Keyframe, 55), Some((4.0, 3.0)));
        assert_eq!(at(Crossing::Interpolated, 55), Some((3.0, 2.0)));
        assert_eq!(at(Crossing::Interpolated, 60), Some((4.0, 3.0)));
        assert_eq!(at(Crossing::Decision, 55), Some((5.0, 3.5)));
        assert_eq!(at(Crossing::Decision, 65), None, "no choice came after it");
        assert_eq!(at(Crossing::Keyframe, 71), None);
        let further =
            |when| trace(when).levels.iter().map(|level| level.crossing).collect::<Vec<_>>();
        assert_eq!(further(Crossing::Keyframe), [Some((4.0, 3.0)), Some((6.0, 4.0)), None]);
        assert_eq!(further(Crossing::Interpolated), [Some((2.5, 1.5)), Some((5.1, 3.55)), None]);
        assert_eq!(further(Crossing::Decision), [Some((5.0, 3.5)), None, None]);
    }

    #[test]
    fn a_level_is_known_by_its_name() {
        assert_eq!(level_of("distance-m-at-99.5"), Some(99.5));
        assert_eq!(level_of("time-s-at-70"), Some(70.0));
        assert_eq!(level_of("distance-m-at-099.5"), None);
        assert_eq!(level_of("distance-m-at-700"), None);
        assert_eq!(level_of("decisions-at-70"), None);
    }
}
