//! What was measured in which building: a plan rests on the passages of the building in which its trial runs.

use crate::studies::deadline::build_cmdp::Through;
use crate::studies::deadline::calibration::{Calibration, Pair};
use crate::table::{Table, Value};
use crate::world::World;
use std::sync::Arc;

const COLUMNS: [&str; 13] = [
    "world",
    "motion",
    "speed",
    "through",
    "passages",
    "reached",
    "collided",
    "time-s",
    "time-low-s",
    "time-high-s",
    "failure",
    "failure-low",
    "failure-high",
];

/// The pairs of every building in which passages were driven.
#[derive(Debug, Clone)]
pub struct Calibrations {
    by_world: Vec<(Arc<World>, Arc<Calibration>)>,
}

impl Calibrations {
    /// Creates those of these buildings.
    pub fn new(by_world: Vec<(Arc<World>, Arc<Calibration>)>) -> Self {
        Self { by_world }
    }

    /// Returns the pairs measured in `world`; `None` where no passage was driven there.
    pub fn of(&self, world: &World) -> Option<Arc<Calibration>> {
        let found = self.by_world.iter().find(|(measured_in, _)| **measured_in == *world);
        found.map(|(_, calibration)| Arc::clone(calibration))
    }

    /// Returns the names of the buildings, in plan order.
    pub fn worlds(&self) -> impl Iterator<Item = &str> {
        self.by_world.iter().map(|(world, _)| world.name.as_str())
    }

    /// Writes the table that is sealed as an input: one row per building and maneuver, numbers of six significant digits.
    pub fn to_csv(&self) -> String {
        let mut table = Table::new(COLUMNS);
        for (world, calibration) in &self.by_world {
            calibration.pairs().iter().for_each(|pair| table.push(row(&world.name, pair)));
        }
        table.to_csv()
    }
}

fn row(world: &str, pair: &Pair) -> Vec<Value> {
    let whole = |n: u64| Value::from(i64::try_from(n).unwrap_or(i64::MAX));
    let mut row: Vec<Value> = vec![
        world.into(),
        pair.motion.name().into(),
        pair.speed.name().into(),
        pair.through.map_or("any", Through::name).into(),
    ];
    row.extend([pair.passages, pair.reached, pair.collided].map(whole));
    row.extend(pair.time_s.map(Value::from));
    row.extend(pair.failure.map(Value::from));
    row
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::{Region, RegionKind};

    #[test]
    fn a_calibration_is_that_of_the_building_in_which_it_was_measured() {
        let (world, mut other) = (Arc::new(World::empty()), World::empty());
        let (name, kind) = ("C2".to_owned(), RegionKind::Corridor);
        other.regions.push(Region { name, kind, polygon: Vec::new() });
        let measured = Arc::new(Calibration::stand_in());
        let calibrations = Calibrations::new(vec![(Arc::clone(&world), measured)]);
        assert!(calibrations.of(&world).is_some());
        assert!(calibrations.of(&other).is_none(), "its name is not what it is");
        let csv = calibrations.to_csv();
        assert!(csv.contains("\nempty,door-left,fast,any,0,0,0,6,6,6,0.02,0.02,0.02\n"), "{csv}");
    }
}
