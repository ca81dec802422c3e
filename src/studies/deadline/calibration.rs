//! The six (time, failure) pairs of the planner's maneuvers (section 6, "Maneuvers"), measured by a calibration
//! experiment of isolated passages and handed to the study as an input.

use crate::stats::distribution::student_t_quantile;
use crate::stats::proportion::{Proportion, wilson};
use crate::stats::summary::Summary;
use crate::studies::deadline::build_cmdp::{
    DoorPairs, Expectation, Maneuvers, Motion, SideCorridors, Speed, Through,
};
use crate::studies::findings::rounded;
use crate::studies::{CalibrationError, Outcome};
use serde_json::{Value as Json, json};

/// The motions, in the order of the table.
pub const MOTIONS: [Motion; 3] = [Motion::Corridor, Motion::DoorLeft, Motion::DoorRight];
/// The speeds, in the order of the table.
pub const SPEEDS: [Speed; 2] = [Speed::Slow, Speed::Fast];
/// The least number of passages with which a maneuver's pair is worth planning.
pub const LEAST_PASSAGES: u64 = 10;

const CONFIDENCE: f64 = 0.95;
/// The measured times and failures of one maneuver.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// The motion.
    pub motion: Motion,
    /// The speed.
    pub speed: Speed,
    /// What it was done for; `None` for all of it together, the paper's own pair.
    pub through: Option<Through>,
    /// Passages tried.
    pub passages: u64,
    /// Those that arrived.
    pub reached: u64,
    /// Those that ended in contact; the rest did not arrive in time.
    pub collided: u64,
    /// Mean duration (s) of those that arrived, and its 95 % interval (Student's t).
    pub time_s: [f64; 3],
    /// Share of passages that did not arrive, and its 95 % interval (Wilson).
    pub failure: [f64; 3],
}

/// All six pairs, and those of doors by what they are done for.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    pairs: Vec<Pair>,
}

/// One isolated passage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Driven {
    /// The motion.
    pub motion: Motion,
    /// The speed.
    pub speed: Speed,
    /// What it led through.
    pub through: Through,
    /// Its outcome.
    pub outcome: Outcome,
    /// Its duration (s), where it arrived.
    pub time_s: Option<f64>,
}

impl Calibration {
    /// Computes the pairs from `passages`.
    ///
    /// # Errors
    /// Where a maneuver has too few passages or none that arrived.
    pub fn measure(passages: impl IntoIterator<Item = Driven>) -> Result<Self, CalibrationError> {
        let passages: Vec<Driven> = passages.into_iter().collect();
        let mut pairs = Vec::new();
        for motion in MOTIONS {
            for speed in SPEEDS {
                let of = || passages.iter().filter(|p| p.motion == motion && p.speed == speed);
                pairs.push(pair((motion, speed, None), of())?);
                // What a building has few of is expected to go as the maneuver does in all.
                for through in Through::of(motion) {
                    let through_that = of().filter(|p| p.through == *through);
                    pairs.extend(pair((motion, speed, Some(*through)), through_that).ok());
                }
            }
        }
        Ok(Self { pairs })
    }

    /// Returns pairs that a check uses in place of measured ones: they enter no result.
    pub fn stand_in() -> Self {
        let pair = [
            Expectation { time_s: 10.0, failure: 0.01 },
            Expectation { time_s: 6.0, failure: 0.02 },
        ];
        let door = DoorPairs::alike(pair);
        Self::assumed(&Maneuvers {
            corridor: pair,
            door_left: door,
            door_right: door,
            side_corridors: SideCorridors::Door,
        })
    }

    /// Returns pairs that were not measured, for models and checks that need some: a door's whatever it is passed for.
    pub fn assumed(maneuvers: &Maneuvers) -> Self {
        let pair = |motion, speed| {
            let Expectation { time_s, failure } =
                maneuvers.expect(motion, Through::Entering, speed);
            Pair {
                motion,
                speed,
                through: None,
                passages: 0,
                reached: 0,
                collided: 0,
                time_s: [time_s; 3],
                failure: [failure; 3],
            }
        };
        let pairs = MOTIONS.iter().flat_map(|m| SPEEDS.map(|s| pair(*m, s))).collect();
        Self { pairs }
    }

    /// Returns the pairs, motion by motion, slow before fast; each before those of what it is done for.
    pub fn pairs(&self) -> &[Pair] {
        &self.pairs
    }

    /// Returns the planner's expectation of each maneuver, where that one turns into side corridors.
    pub fn maneuvers(&self, side_corridors: SideCorridors) -> Maneuvers {
        let expect = |motion: Motion, through: Through| {
            SPEEDS.map(|speed| {
                let of = || self.pairs.iter().filter(|p| p.motion == motion && p.speed == speed);
                let found = of().find(|p| p.through == Some(through));
                let found = found.or_else(|| of().find(|p| p.through.is_none()));
                found.map_or(Expectation { time_s: 0.0, failure: 0.0 }, |pair| Expectation {
                    time_s: pair.time_s[0],
                    failure: pair.failure[0],
                })
            })
        };
        let door = |motion| DoorPairs {
            entering: expect(motion, Through::Entering),
            leaving: expect(motion, Through::Leaving),
            side_corridor: expect(motion, Through::SideCorridor),
        };
        Maneuvers {
            corridor: expect(Motion::Corridor, Through::Corridor),
            door_left: door(Motion::DoorLeft),
            door_right: door(Motion::DoorRight),
            side_corridors,
        }
    }

    /// Returns the pairs as a trial's key and the resolved study hold them: what the planner sees, nothing else.
    pub fn to_json(&self) -> Json {
        let entry = |pair: &Pair| {
            json!({
                "motion": pair.motion,
                "speed": pair.speed,
                "through": pair.through,
                "time-s": pair.time_s[0],
                "failure": pair.failure[0],
            })
        };
        self.pairs.iter().map(entry).collect()
    }
}

fn pair<'a>(
    (motion, speed, through): (Motion, Speed, Option<Through>),
    of: impl Iterator<Item = &'a Driven>,
) -> Result<Pair, CalibrationError> {
    let (mut times, mut passages, mut collided) = (Vec::new(), 0, 0);
    for passage in of.filter(|passage| passage.outcome != Outcome::PANICKED) {
        passages += 1;
        collided += u64::from(passage.outcome == Outcome::COLLIDED);
        if passage.outcome == Outcome::REACHED {
            times.extend(passage.time_s);
        }
    }
    let reached = times.len() as u64;
    if passages < LEAST_PASSAGES || reached < 2 {
        return Err(CalibrationError::of(format!(
            "expected at least {LEAST_PASSAGES} passages of {} {} and 2 that arrive, found {passages} and {reached}",
            motion.name(),
            speed.name()
        )));
    }
    let summary = Summary::of(&times);
    #[expect(clippy::cast_precision_loss, reason = "counts of passages are small")]
    let freedom = (reached - 1) as f64;
    let half =
        student_t_quantile(0.5 + 0.5 * CONFIDENCE, freedom) * summary.variance_of_mean().sqrt();
    let failed = Proportion::new(passages - reached, passages);
    let interval = wilson(failed, CONFIDENCE);
    Ok(Pair {
        motion,
        speed,
        through,
        passages,
        reached,
        collided,
        time_s: [summary.mean, (summary.mean - half).max(0.0), summary.mean + half].map(rounded),
        failure: [failed.share(), interval.low, interval.high].map(rounded),
    })
}

/// Returns the name of a maneuver in measures: `door-left-slow`.
pub fn maneuver_name(motion: Motion, speed: Speed) -> String {
    format!("{}-{}", motion.name(), speed.name())
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    #[test]
    fn a_calibration_is_measured_and_written() {
        let passage = |i: u32, motion, speed| Driven {
            motion,
            speed,
            through: if motion == Motion::Corridor { Through::Corridor } else { Through::Entering },
            outcome: if i < 3 { Outcome::COLLIDED } else { Outcome::REACHED },
            time_s: Some(10.0 + f64::from(i)),
        };
        let passages = MOTIONS
            .iter()
            .flat_map(|m| SPEEDS.map(|s| (*m, s)))
            .flat_map(|(m, s)| (0..20).map(move |i| passage(i, m, s)));
        let calibration = Calibration::measure(passages).unwrap();
        let first = calibration.pairs()[0];
        assert_eq!((first.passages, first.reached, first.collided), (20, 17, 3));
        assert_eq!((first.time_s[0], first.failure[0]), (21.0, 0.15));
        // Student's t with 16 degrees of freedom: 2.1199; the sample's sd is 5.04975.
        assert!((first.time_s[2] - (21.0 + 2.1199 * 5.04975 / 17.0_f64.sqrt())).abs() < 1e-3);
        // Six of the paper, and the doors' again by what they were for: nobody left a room here.
        assert_eq!(calibration.pairs().len(), 10);
        let maneuvers = calibration.maneuvers(SideCorridors::Door);
        for through in Through::OF_DOORS {
            assert_eq!(maneuvers.expect(Motion::DoorLeft, through, Speed::Fast).time_s, 21.0);
        }
    }

    #[test]
    fn too_few_passages_are_no_calibration() {
        assert_eq!(
            Calibration::measure([]).unwrap_err().to_string(),
            "calibration: expected at least 10 passages of corridor slow and 2 that arrive, found 0 and 0"
        );
    }
}
