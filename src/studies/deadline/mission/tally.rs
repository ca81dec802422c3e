//! Counts over a trial: maneuvers by motion and speed, and plans by how they meet their deadlines.

use crate::studies::deadline::build_cmdp::{Motion, Speed};
use crate::studies::deadline::calibration::{MOTIONS, SPEEDS, maneuver_name};
use crate::studies::deadline::exploration::Explorer;
use crate::studies::deadline::planner::{Plan, Status};
use crate::units::{Seconds, Tick};
use std::collections::BTreeMap;

/// The counts of one maneuver over a trial.
#[derive(Debug, Clone, Copy, Default)]
struct Count {
    begun: u32,
    arrived: u32,
    collided: u32,
    /// Simulated time (s) of those that arrived.
    seconds: f64,
}

/// Counts in the order of the calibration table.
#[derive(Debug, Default)]
pub(super) struct Tally {
    counts: [[Count; 2]; 3],
    under_way: Option<(Motion, Speed, Tick)>,
}

impl Tally {
    /// Records that a maneuver begins.
    pub(super) fn begin(&mut self, motion: Motion, speed: Speed, now: Tick) {
        self.count(motion, speed).begun += 1;
        self.under_way = Some((motion, speed, now));
    }

    /// Records that the maneuver under way, if there is one, has arrived.
    pub(super) fn arrive(&mut self, now: Tick) {
        if let Some((motion, speed, since)) = self.under_way.take() {
            let count = self.count(motion, speed);
            count.arrived += 1;
            let Seconds(ended) = now.seconds();
            let Seconds(began) = since.seconds();
            count.seconds += ended - began;
        }
    }

    /// Records that the maneuver under way, if there is one, has ended in contact.
    pub(super) fn collide(&mut self) {
        if let Some((motion, speed, _)) = self.under_way.take() {
            self.count(motion, speed).collided += 1;
        }
    }

    fn count(&mut self, motion: Motion, speed: Speed) -> &mut Count {
        let row = MOTIONS.iter().position(|m| *m == motion).unwrap_or_default();
        let column = SPEEDS.iter().position(|s| *s == speed).unwrap_or_default();
        &mut self.counts[row][column]
    }

    /// Adds the measures of the maneuvers to `measures`.
    pub(super) fn measures(&self, measures: &mut BTreeMap<String, Option<f64>>) {
        let mut put = |name: String, value: f64| measures.insert(name, Some(value));
        let mut totals = [(0, 0); 2];
        for (row, motion) in self.counts.iter().zip(MOTIONS) {
            for ((count, speed), total) in row.iter().zip(SPEEDS).zip(&mut totals) {
                let name = maneuver_name(motion, speed);
                put(format!("{name}-passages"), f64::from(count.begun));
                put(format!("{name}-arrived"), f64::from(count.arrived));
                put(format!("{name}-collisions"), f64::from(count.collided));
                put(format!("{name}-total-s"), count.seconds);
                total.0 += count.begun;
                total.1 += count.collided;
            }
        }
        let [(slow, slow_collisions), (fast, fast_collisions)] = totals;
        put("slow-maneuvers".to_owned(), f64::from(slow));
        put("slow-collisions".to_owned(), f64::from(slow_collisions));
        put("fast-maneuvers".to_owned(), f64::from(fast));
        put("fast-collisions".to_owned(), f64::from(fast_collisions));
        put("maneuvers".to_owned(), f64::from(slow + fast));
        // A trial without a maneuver has no share.
        let all = f64::from(slow + fast);
        let share = (slow + fast > 0).then(|| f64::from(fast) / all);
        measures.insert("fast-maneuver-share".to_owned(), share);
    }
}

/// Adds the measures of the mind's decisions and discoveries to `measures`.
pub(super) fn decided(mind: &Explorer, measures: &mut BTreeMap<String, Option<f64>>) {
    #[expect(clippy::cast_precision_loss, reason = "counts of one trial")]
    let mut put = |name: &str, count: usize| measures.insert(name.to_owned(), Some(count as f64));
    put("vertices", mind.map().len());
    put("decisions", mind.decisions().len());
    let plans: Vec<Status> =
        mind.decisions().iter().filter_map(|d| d.plan().map(Plan::status)).collect();
    put("plans", plans.len());
    for (name, status) in [
        ("plans-slack", Status::Slack),
        ("plans-active", Status::Active),
        ("plans-relaxed", Status::Relaxed),
    ] {
        put(name, plans.iter().filter(|s| **s == status).count());
    }
}
