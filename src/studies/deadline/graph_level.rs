//! `mission.simulation: graph`: trials on the building's graph, where the mind is real and every maneuver takes what is
//! stated. The paper's own model of the world (section 3), for proposals of an inference; never a result.

use super::build_cmdp::{DoorPairs, Expectation, Maneuvers, SideCorridors, Through};
use super::rules::parameters;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a trial is simulated by.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum Simulation {
    /// A body with sensors among walls.
    #[default]
    Physics,
    /// Steps on the building's graph. Such trials are proposals for `reenact infer`; no table, figure or claim may rest on
    /// them.
    Graph,
}

parameters!(
    /// What maneuvers take where `mission.simulation` is `graph`.
    GraphLevel {
        /// What all durations are multiplied by, those that the planner expects too, above 0.
        #[schemars(extend("exclusiveMinimum" = 0))]
        time_scale: f64 = 1.0,
        /// Probability of a collision where a robot enters a room or turns into a side corridor by a door's maneuver, 0 to
        /// 1; `null` is the calibration's.
        #[schemars(range(min = 0.0, max = 1.0))]
        entry_hazard: Option<f64> = None,
        /// The same of every other maneuver: along a corridor, or out of a room.
        #[schemars(range(min = 0.0, max = 1.0))]
        corridor_hazard: Option<f64> = None,
        /// Duration of a corridor, slow (s), above 0; `null` is the calibration's.
        #[schemars(extend("exclusiveMinimum" = 0))]
        corridor_slow_s: Option<f64> = None,
        /// Duration of a corridor, fast (s).
        #[schemars(extend("exclusiveMinimum" = 0))]
        corridor_fast_s: Option<f64> = None,
        /// Duration of a door, slow (s).
        #[schemars(extend("exclusiveMinimum" = 0))]
        door_slow_s: Option<f64> = None,
        /// Duration of a door, fast (s).
        #[schemars(extend("exclusiveMinimum" = 0))]
        door_fast_s: Option<f64> = None,
        /// Duration of the look around before the first move (s), 0 or more.
        #[schemars(range(min = 0.0))]
        look_around_s: f64 = 9.0,
    }
);

impl GraphLevel {
    /// Returns whether it states all that a maneuver takes, so that no calibration is needed.
    pub fn is_complete(&self) -> bool {
        let durations =
            [self.corridor_slow_s, self.corridor_fast_s, self.door_slow_s, self.door_fast_s];
        durations.iter().chain([&self.entry_hazard, &self.corridor_hazard]).all(Option::is_some)
    }

    /// Returns what maneuvers take, in place of `calibrated` where it states something of its own.
    pub fn maneuvers(&self, calibrated: &Maneuvers) -> Maneuvers {
        let pair = |both: [Expectation; 2], durations: [Option<f64>; 2], hazard: Option<f64>| {
            [0, 1].map(|speed: usize| Expectation {
                time_s: self.time_scale * durations[speed].unwrap_or(both[speed].time_s),
                failure: hazard.unwrap_or(both[speed].failure),
            })
        };
        let doors = [self.door_slow_s, self.door_fast_s];
        let door = |pairs: &DoorPairs| DoorPairs {
            entering: pair(pairs.entering, doors, self.entry_hazard),
            leaving: pair(pairs.leaving, doors, self.corridor_hazard),
            side_corridor: pair(pairs.side_corridor, doors, self.entry_hazard),
        };
        let corridors = [self.corridor_slow_s, self.corridor_fast_s];
        Maneuvers {
            corridor: pair(calibrated.corridor, corridors, self.corridor_hazard),
            door_left: door(&calibrated.door_left),
            door_right: door(&calibrated.door_right),
            side_corridors: calibrated.side_corridors,
        }
    }

    /// Returns what maneuvers take where it states all of it ([`Self::is_complete`]); what it does not state takes nothing.
    pub fn stated(&self, side_corridors: SideCorridors) -> Maneuvers {
        let nothing = [Expectation { time_s: 0.0, failure: 0.0 }; 2];
        let door = DoorPairs::alike(nothing);
        self.maneuvers(&Maneuvers {
            corridor: nothing,
            door_left: door,
            door_right: door,
            side_corridors,
        })
    }
}

/// Returns whether the hazard of a maneuver through that is the one of entries ([`GraphLevel::entry_hazard`]).
pub const fn is_entry(through: Through, side_corridors: SideCorridors) -> bool {
    match through {
        Through::Entering => true,
        Through::SideCorridor => matches!(side_corridors, SideCorridors::Door),
        Through::Corridor | Through::Leaving => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studies::deadline::build_cmdp::{Motion, Speed};
    use crate::studies::deadline::building;

    #[test]
    fn what_is_stated_stands_in_for_what_was_measured() {
        let measured = building::maneuvers();
        let level = GraphLevel {
            time_scale: 2.0,
            entry_hazard: Some(0.05),
            door_fast_s: Some(5.0),
            ..GraphLevel::default()
        };
        let taken = level.maneuvers(&measured);
        let corridor = taken.expect(Motion::Corridor, Through::Corridor, Speed::Slow);
        assert_eq!(corridor, Expectation { time_s: 26.0, failure: 0.004 });
        let entering = taken.expect(Motion::DoorLeft, Through::Entering, Speed::Fast);
        assert_eq!(entering, Expectation { time_s: 10.0, failure: 0.05 });
        let leaving = taken.expect(Motion::DoorLeft, Through::Leaving, Speed::Slow);
        assert_eq!(leaving, Expectation { time_s: 24.2, failure: 0.015 });
        assert!(!level.is_complete());
    }
}
