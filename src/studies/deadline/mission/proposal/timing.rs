//! Walks timed: how likely the goal is reached, and a collision comes first, within each of several deadlines.
//!
//! Failures are not drawn: a walk carries the probability of having had none so far, so that few walks tell what many trials
//! would. The durations are those that the planner of section 3 expects: a leg whose local deadline lies between all slow and
//! all fast takes just that deadline, whichever of its edges are sped up. Where each deadline cuts a walk ([`Cut`]) does not
//! depend on hazards, so that one timing serves many of them.

use super::walk::{Leg, Walk};
use crate::studies::deadline::rules::UnplannedSpeed;
use crate::studies::deadline::schedule::Schedule;

/// What is supposed of time and hazard.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pace {
    /// Durations of a corridor and of a door (s): slow, fast.
    pub(super) corridor: [f64; 2],
    pub(super) door: [f64; 2],
    /// Probability of a collision at an entry, and in any other maneuver.
    pub(super) entry: f64,
    pub(super) other: f64,
    /// Duration of the look around (s).
    pub(super) look_around: f64,
    pub(super) unplanned: UnplannedSpeed,
}

/// Where a deadline cuts a walk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cut {
    /// How many legs end before it; `None` where it is over before the first begins.
    pub(super) legs: Option<u16>,
    /// Share of the next leg that is done by then.
    pub(super) share: f64,
    /// Where its times stand among those of all cuts.
    first: usize,
}

/// Where each deadline cuts a walk, and when the legs before end.
#[derive(Debug, Default)]
pub(super) struct Cuts {
    pub(super) each: Vec<Cut>,
    /// Cut by cut: when the first leg begins (s), and when each leg ends.
    ends: Vec<f64>,
}

impl Cuts {
    /// Returns when (s) `legs` of a walk have ended, as `cut` has it.
    fn after(&self, cut: &Cut, legs: u16) -> f64 {
        self.ends[cut.first + usize::from(legs)]
    }
}

/// How long legs take.
pub(super) struct Timing<'a> {
    pace: Pace,
    schedule: &'a Schedule,
    deadlines: &'a [f64],
}

impl<'a> Timing<'a> {
    pub(super) fn new(pace: Pace, schedule: &'a Schedule, deadlines: &'a [f64]) -> Self {
        Self { pace, schedule, deadlines }
    }

    /// Computes where each deadline cuts the walk `legs`, into `cuts`.
    pub(super) fn cut(&self, legs: &[Leg], cuts: &mut Cuts) {
        cuts.each.clear();
        cuts.ends.clear();
        for deadline in self.deadlines {
            let cut = self.cut_by(legs, *deadline, &mut cuts.ends);
            cuts.each.push(cut);
        }
    }

    fn cut_by(&self, legs: &[Leg], deadline: f64, ends: &mut Vec<f64>) -> Cut {
        let mut now = self.pace.look_around;
        let first = ends.len();
        ends.push(now);
        if now >= deadline {
            return Cut { legs: None, share: 0.0, first };
        }
        let mut count = 0_u16;
        for leg in legs {
            let time = self.time(*leg, now, deadline);
            if now + time >= deadline {
                return Cut { legs: Some(count), share: (deadline - now) / time, first };
            }
            now += time;
            ends.push(now);
            count += 1;
        }
        Cut { legs: Some(count), share: 0.0, first }
    }

    fn duration(&self, leg: Leg, speed: usize) -> f64 {
        f64::from(leg.corridors) * self.pace.corridor[speed]
            + f64::from(leg.doors) * self.pace.door[speed]
    }

    fn time(&self, leg: Leg, now: f64, deadline: f64) -> f64 {
        let slow = self.duration(leg, 0);
        let given =
            || self.schedule.local_deadline(usize::from(leg.edges()), now, deadline).seconds;
        match (leg.planned, self.pace.unplanned) {
            (true, _) => given().min(slow).max(self.duration(leg, 1)),
            (false, UnplannedSpeed::Fast) => self.duration(leg, 1),
            (false, UnplannedSpeed::Schedule) if slow > given() => self.duration(leg, 1),
            (false, UnplannedSpeed::Slow | UnplannedSpeed::Schedule) => slow,
        }
    }
}

/// Most moves of a leg for which the powers of survival are kept.
const MOST: usize = 64;

/// The hazards of a pace: probabilities of having come through so many moves.
pub(super) struct Hazards {
    entry: [f64; MOST],
    other: [f64; MOST],
}

/// For every goal and deadline, the sums over walks of the probabilities to have reached it and to have collided before, and of
/// the time that reaching it took.
#[derive(Debug, Clone)]
pub(super) struct Sums {
    /// By goal, then by deadline.
    pub(super) reached: Vec<f64>,
    pub(super) collided: Vec<f64>,
    /// The first times its time (s); empty where no times are learned from.
    taken: Vec<f64>,
}

impl Sums {
    pub(super) fn none(goals: usize, deadlines: usize, with_times: bool) -> Self {
        let count = goals * deadlines;
        let taken = if with_times { count } else { 0 };
        Self { reached: vec![0.0; count], collided: vec![0.0; count], taken: vec![0.0; taken] }
    }

    /// Returns the mean time (s) of what is reached at the place `at`; `None` where that never happens, or where no times are learned from.
    pub(super) fn time_s(&self, at: usize) -> Option<f64> {
        let taken = *self.taken.get(at)?;
        (self.reached[at] > 0.0).then(|| taken / self.reached[at])
    }

    /// Makes the sums over `count` walks means.
    pub(super) fn divide(&mut self, count: f64) {
        let all = self.reached.iter_mut().chain(&mut self.collided).chain(&mut self.taken);
        all.for_each(|sum| *sum /= count);
    }
}

impl Hazards {
    pub(super) fn of(pace: &Pace) -> Self {
        let powers = |hazard: f64| {
            let mut power = 1.0;
            std::array::from_fn(|_| {
                let this = power;
                power *= 1.0 - hazard;
                this
            })
        };
        Self { entry: powers(pace.entry), other: powers(pace.other) }
    }

    fn survival(&self, leg: Leg) -> f64 {
        let entries = usize::from(leg.entries);
        let others = usize::from(leg.edges()) - entries;
        self.entry[entries.min(MOST - 1)] * self.other[others.min(MOST - 1)]
    }

    /// Adds what `walk` gives where deadlines cut it by `cuts`. `survivals` is room to work in.
    pub(super) fn add(&self, walk: &Walk, cuts: &Cuts, survivals: &mut Vec<f64>, sums: &mut Sums) {
        let last = cuts.each.iter().filter_map(|cut| cut.legs).max().unwrap_or(0);
        let legs = walk.legs.len().min(usize::from(last) + 1);
        survivals.clear();
        let mut survival = 1.0;
        survivals.push(survival);
        for leg in &walk.legs[..legs] {
            survival *= self.survival(*leg);
            survivals.push(survival);
        }
        let over = |cut: &Cut| {
            let Some(done) = cut.legs.map(usize::from) else { return 0.0 };
            let before = survivals[done];
            // A failure lies at any point of a leg with the same probability.
            let after = survivals.get(done + 1).copied().unwrap_or(before);
            1.0 - before + (before - after) * cut.share
        };
        for (t, cut) in cuts.each.iter().enumerate() {
            let collided = over(cut);
            for (goal, arrival) in walk.arrivals.iter().enumerate() {
                let at = goal * cuts.each.len() + t;
                match (arrival, cut.legs) {
                    (Some(arrival), Some(done)) if *arrival <= done => {
                        let survival = survivals[usize::from(*arrival)];
                        sums.reached[at] += survival;
                        sums.collided[at] += 1.0 - survival;
                        if let Some(taken) = sums.taken.get_mut(at) {
                            *taken += survival * cuts.after(cut, *arrival);
                        }
                    }
                    _ => sums.collided[at] += collided,
                }
            }
        }
    }
}
