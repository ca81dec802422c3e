//! Counts over a trial: maneuvers by motion, speed and what they led through, and plans by how they meet their deadlines.

use crate::studies::Measures;
use crate::studies::deadline::build_cmdp::{Motion, Speed, Through};
use crate::studies::deadline::calibration::{MOTIONS, SPEEDS, maneuver_name};
use crate::studies::deadline::exploration::Explorer;
use crate::studies::deadline::planner::{Plan, Status};
use crate::units::{Seconds, Tick};
use std::ops::AddAssign;

/// The counts of one maneuver over a trial.
#[derive(Debug, Clone, Copy, Default)]
struct Count {
    begun: u32,
    arrived: u32,
    collided: u32,
    /// Simulated time (s) of those that arrived.
    seconds: f64,
}

impl AddAssign for Count {
    fn add_assign(&mut self, other: Self) {
        self.begun += other.begun;
        self.arrived += other.arrived;
        self.collided += other.collided;
        self.seconds += other.seconds;
    }
}

/// A maneuver as it was done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Done {
    pub(super) motion: Motion,
    pub(super) speed: Speed,
    pub(super) through: Through,
}

/// Counts by motion and speed, in the order of the calibration table, and by what was passed, in that of [`Through::ALL`].
#[derive(Debug, Default)]
pub(super) struct Tally {
    counts: [[[Count; 4]; 2]; 3],
    under_way: Option<(Done, Tick)>,
}

impl Tally {
    /// Records that a maneuver begins.
    pub(super) fn begin(&mut self, done: Done, now: Tick) {
        self.count(done).begun += 1;
        self.under_way = Some((done, now));
    }

    /// Records that the maneuver under way, if there is one, has arrived.
    pub(super) fn arrive(&mut self, now: Tick) {
        if let Some((done, since)) = self.under_way.take() {
            let count = self.count(done);
            count.arrived += 1;
            let Seconds(ended) = now.seconds();
            let Seconds(began) = since.seconds();
            count.seconds += ended - began;
        }
    }

    /// Records that the maneuver under way, if there is one, has ended in contact.
    pub(super) fn collide(&mut self) {
        if let Some((done, _)) = self.under_way.take() {
            self.count(done).collided += 1;
        }
    }

    fn count(&mut self, done: Done) -> &mut Count {
        let row = MOTIONS.iter().position(|m| *m == done.motion).unwrap_or_default();
        let column = SPEEDS.iter().position(|s| *s == done.speed).unwrap_or_default();
        let depth = Through::ALL.iter().position(|t| *t == done.through).unwrap_or_default();
        &mut self.counts[row][column][depth]
    }

    /// Adds the measures of an exploration's maneuvers to `measures`.
    pub(super) fn measures(&self, measures: &mut Measures) {
        self.passed(measures);
        let mut put = |name: String, value: f64| measures.insert(name, Some(value));
        let mut totals = [(0, 0); 2];
        for (row, motion) in self.counts.iter().zip(MOTIONS) {
            for ((by_through, speed), total) in row.iter().zip(SPEEDS).zip(&mut totals) {
                let name = maneuver_name(motion, speed);
                let mut all = Count::default();
                for (count, through) in by_through.iter().zip(Through::ALL) {
                    all += *count;
                    // Most are not done in most trials: a record says only what was.
                    if count.begun > 0 && Through::of(motion).contains(&through) {
                        put_counts(&format!("{name}-{}", through.name()), count, &mut put);
                    }
                }
                put_counts(&name, &all, &mut put);
                total.0 += all.begun;
                total.1 += all.collided;
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

    /// Adds the counts by what was passed, over all motions and speeds, to `measures`.
    pub(super) fn passed(&self, measures: &mut Measures) {
        for (depth, through) in Through::ALL.into_iter().enumerate() {
            let mut all = Count::default();
            self.counts.iter().flatten().for_each(|by_through| all += by_through[depth]);
            measures.insert(passages_through(through), Some(f64::from(all.begun)));
            measures.insert(collisions_through(through), Some(f64::from(all.collided)));
        }
    }
}

fn put_counts<T>(name: &str, count: &Count, put: &mut impl FnMut(String, f64) -> T) {
    put(format!("{name}-passages"), f64::from(count.begun));
    put(format!("{name}-arrived"), f64::from(count.arrived));
    put(format!("{name}-collisions"), f64::from(count.collided));
    put(format!("{name}-total-s"), count.seconds);
}

/// Returns the name of the measure of passages through that.
pub(super) fn passages_through(through: Through) -> String {
    format!("{}-passages", through.name())
}

/// Returns the name of the measure of collisions on passages through that.
pub(super) fn collisions_through(through: Through) -> String {
    format!("{}-collisions", through.name())
}

/// Adds the measures of the mind's decisions and discoveries to `measures`.
pub(super) fn decided(mind: &Explorer, measures: &mut Measures) {
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
