//! What is written down while a trial runs: coverage over time and distance, and the state-hash chain.

use crate::geometry::Pose;
use crate::studies::state_chain::StateChain;
use crate::studies::{Outcome, SeriesPoint, TrialRecord, TrialSpec};
use crate::units::Tick;
use std::collections::BTreeMap;

/// Coverages (percent) at which distance and time are told.
pub const MILESTONES: [u32; 10] = [50, 55, 60, 65, 70, 75, 80, 85, 90, 95];

/// The running record of a trial.
#[derive(Debug)]
pub(super) struct Trace {
    total: u32,
    covered: i64,
    next_percent: u32,
    series: Vec<SeriesPoint>,
    crossings: BTreeMap<u32, (f64, f64)>,
    chain: StateChain,
}

impl Trace {
    /// The trace of a trial in a world of `total` cells to cover.
    pub(super) fn new(total: u32) -> Self {
        Self {
            total,
            covered: 0,
            next_percent: 1,
            series: Vec::new(),
            crossings: BTreeMap::new(),
            chain: StateChain::default(),
        }
    }

    /// Changes the number of covered cells.
    pub(super) fn cover(&mut self, change: i64) {
        self.covered += change;
    }

    /// Coverage (percent, 0 to 100).
    pub(super) fn coverage_percent(&self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "cells of a building")]
        let covered = self.covered as f64;
        100.0 * covered / f64::from(self.total.max(1))
    }

    /// Notes the first crossing of every whole percent: at the keyframe that brought it, not interpolated.
    pub(super) fn note_coverage(&mut self, now: Tick, distance_m: f64) {
        let percent = self.coverage_percent();
        if percent < f64::from(self.next_percent) {
            return;
        }
        let time_s = now.seconds().get();
        while self.next_percent <= 100 && percent >= f64::from(self.next_percent) {
            self.crossings.insert(self.next_percent, (time_s, distance_m));
            self.next_percent += 1;
        }
        self.series.push(SeriesPoint { time_s, distance_m, coverage_percent: percent });
    }

    /// Every 10 s, notes a point of the curve and a state hash.
    pub(super) fn note_time(&mut self, now: Tick, distance_m: f64, pose: Pose, choices: u32) {
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

    /// The record of the trial that ended `now` with `outcome`.
    pub(super) fn finish(
        self,
        spec: &TrialSpec,
        outcome: Outcome,
        cause: String,
        now: Tick,
    ) -> TrialRecord {
        let mut measures = BTreeMap::new();
        for percent in MILESTONES {
            let crossing = self.crossings.get(&percent);
            measures.insert(format!("time-s-at-{percent}"), crossing.map(|c| c.0));
            measures.insert(format!("distance-m-at-{percent}"), crossing.map(|c| c.1));
        }
        measures.insert("time-s".to_owned(), Some(now.seconds().get()));
        measures.insert("coverage-percent".to_owned(), Some(self.coverage_percent()));
        TrialRecord {
            key: spec.key,
            condition: spec.condition.0.clone(),
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
