//! The meaning of a trial's measures, and the columns of its calibration: one place for the data dictionary and for the
//! names that claims and tables may use.

use super::in_situ::{part_name, parts};
use crate::table::{Column, unit_of};

/// The measures of a whole trial.
const WHOLE: [&str; 23] = [
    "time-s",
    "distance-m",
    "turning-rad",
    "vertices",
    "decisions",
    "plans",
    "plans-slack",
    "plans-active",
    "plans-relaxed",
    "corridor-passages",
    "corridor-collisions",
    "side-corridor-passages",
    "side-corridor-collisions",
    "entering-passages",
    "entering-collisions",
    "leaving-passages",
    "leaving-collisions",
    "maneuvers",
    "slow-maneuvers",
    "slow-collisions",
    "fast-maneuvers",
    "fast-collisions",
    "fast-maneuver-share",
];

/// The counts of each maneuver.
const OF_A_MANEUVER: [&str; 4] = ["passages", "arrived", "collisions", "total-s"];

/// Returns every measure that a trial of this study can have.
pub fn measures() -> Vec<String> {
    let mut names: Vec<String> = WHOLE.map(str::to_owned).to_vec();
    names.extend(of_maneuvers().into_iter().map(|measure| measure.name));
    names
}

/// A measure of a maneuver.
struct OfManeuver {
    name: String,
    /// The maneuver, with what it was done for.
    maneuver: String,
    /// Whether that is only a part of the maneuver's.
    is_part: bool,
    /// What it counts.
    of: &'static str,
}

fn of_maneuvers() -> Vec<OfManeuver> {
    let all = parts().flat_map(|(motion, speed, through)| {
        let (maneuver, is_part) = (part_name(motion, speed, through), through.is_some());
        OF_A_MANEUVER.map(|of| {
            let name = format!("{maneuver}-{of}");
            OfManeuver { name, maneuver: maneuver.clone(), is_part, of }
        })
    });
    all.collect()
}

/// When a measure of the end of a trial is empty.
const PANICKED: &str = "the program failed in the trial (outcome panicked)";

/// Describes the measure `name`; `None` where trials of this study have none of that name.
pub fn measure(name: &str) -> Option<Column> {
    let count = |meaning: &str| Column::count(name, meaning).empty_where(PANICKED);
    let number = |meaning: &str| {
        Column::number(name, unit_of(name), meaning).at_least(0.0).empty_where(PANICKED)
    };
    Some(match name {
        "time-s" => {
            number("Simulated time from the start until the robot arrived at the goal (in a passage: at its end)")
                .empty_where("it did not arrive")
        }
        "distance-m" => number("Way that the body truly travelled"),
        "turning-rad" => number("Sum of the absolute turns of the body"),
        "vertices" => count("Vertices of the robot's toposemantic map at the end"),
        "decisions" => count("How many times the robot chose where to go"),
        "plans" => count("Policies that the planner computed"),
        "plans-slack" => count("Plans that the deadline did not bind"),
        "plans-active" => count("Plans that the deadline bound: something is done faster than without it"),
        "plans-relaxed" => count("Plans for a deadline that cannot be met in expectation: the least time was taken"),
        "corridor-passages" => count("Maneuvers begun along a corridor"),
        "corridor-collisions" => count("Maneuvers along a corridor that ended in contact: the trial's last one, if any"),
        "side-corridor-passages" => count("Maneuvers begun from one corridor into another"),
        "side-corridor-collisions" => count("Maneuvers from one corridor into another that ended in contact: the trial's last one, if any"),
        "entering-passages" => count("Maneuvers begun through a door into a room"),
        "entering-collisions" => count("Maneuvers into a room that ended in contact: the trial's last one, if any"),
        "leaving-passages" => count("Maneuvers begun through a door out of a room"),
        "leaving-collisions" => count("Maneuvers out of a room that ended in contact: the trial's last one, if any"),
        "maneuvers" => count("Maneuvers begun"),
        "slow-maneuvers" => count("Slow maneuvers begun"),
        "slow-collisions" => count("Slow maneuvers that ended in contact: the trial's last one, if any"),
        "fast-maneuvers" => count("Fast maneuvers begun"),
        "fast-collisions" => count("Fast maneuvers that ended in contact: the trial's last one, if any"),
        "fast-maneuver-share" => {
            Column::probability(name, "fast-maneuvers over maneuvers").empty_where("no maneuver was begun")
        }
        _ => {
            let mut known = of_maneuvers().into_iter();
            let OfManeuver { maneuver, is_part, of, .. } = known.find(|known| known.name == name)?;
            let column = match of {
                "passages" => count(&format!("Times that the maneuver {maneuver} was begun")),
                "arrived" => count(&format!("Times that it arrived ({maneuver})")),
                "collisions" => count(&format!("Times that it ended in contact ({maneuver})")),
                _ => number(&format!("Simulated time of those that arrived, summed up ({maneuver})")),
            };
            if is_part { column.empty_where("it was not begun") } else { column }
        }
    })
}

/// Describes a column of the calibration that is sealed as an input.
pub fn of_calibration(name: &str) -> Option<Column> {
    let time =
        |meaning| Column::number(name, "s", meaning).at_least(0.0).empty_where("none arrived");
    Some(match name {
        "motion" => Column::text(name, "Motion of the maneuver"),
        "speed" => Column::text(name, "Its speed"),
        "world" => Column::text(name, "Building in which it was measured"),
        "through" => Column::text(
            name,
            "What it was done for: entering or leaving a room, turning into a side corridor, or any of these together",
        ),
        "passages" => Column::count(name, "Passages that were driven to measure it"),
        "reached" => Column::count(name, "Those that arrived"),
        "collided" => Column::count(name, "Those that ended in contact"),
        "time-s" => time("Mean duration of those that arrived"),
        "time-low-s" => time("Lower end of its 95 % interval"),
        "time-high-s" => time("Upper end of its 95 % interval"),
        "failure" => Column::probability(name, "Share of passages that failed"),
        "failure-low" => Column::probability(name, "Lower end of its 95 % interval"),
        "failure-high" => Column::probability(name, "Upper end of its 95 % interval"),
        _ => return None,
    })
}

/// Describes a column of the passages on which the calibration rests.
pub fn of_passages(name: &str) -> Option<Column> {
    Some(match name {
        "motion" => Column::text(name, "Motion of the maneuver"),
        "speed" => Column::text(name, "Its speed"),
        "world" => Column::text(name, "Building in which it was driven"),
        "through" => Column::text(
            name,
            "What it led through: corridor, side-corridor, or a door, entering or leaving a room",
        ),
        "trial" => Column::count(name, "Number of the passage among those of its maneuver, from 0"),
        "outcome" => {
            Column::text(name, "How it ended: reached, collided, late, stalled or panicked")
        }
        "time-s" => Column::number(name, "s", "How long it took")
            .at_least(0.0)
            .empty_where("it did not arrive"),
        "record" => Column::text(name, "SHA-256 of the passage's record, in hex"),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_measure_says_what_it_is() {
        let names = measures();
        assert_eq!(names.len(), 23 + (6 + 4 * 3) * 4);
        for name in names {
            let column = measure(&name).unwrap_or_else(|| panic!("{name} is not described"));
            assert_eq!(column.name, name);
            assert!(!column.meaning.is_empty() && column.empty.is_some(), "{name}");
        }
        let total = measure("door-left-slow-total-s").unwrap();
        assert_eq!(total.unit, "s");
        assert_eq!(measure("door-up-slow-total-s"), None);
    }
}
