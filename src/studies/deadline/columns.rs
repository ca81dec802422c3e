//! The meaning of a trial's measures, and the columns of its calibration: one place for the data dictionary and for the
//! names that claims and tables may use.

use super::calibration::{MOTIONS, SPEEDS, maneuver_name};
use crate::table::{Column, unit_of};

/// The measures of a whole trial.
const WHOLE: [&str; 15] = [
    "time-s",
    "distance-m",
    "turning-rad",
    "vertices",
    "decisions",
    "plans",
    "plans-slack",
    "plans-active",
    "plans-relaxed",
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
    names.extend(of_maneuvers().into_iter().map(|(name, ..)| name));
    names
}

/// Returns the names of the measures of maneuvers, each with the maneuver's and with the count's.
fn of_maneuvers() -> Vec<(String, String, &'static str)> {
    let mut names = Vec::new();
    for motion in MOTIONS {
        for speed in SPEEDS {
            let maneuver = maneuver_name(motion, speed);
            names
                .extend(OF_A_MANEUVER.map(|of| (format!("{maneuver}-{of}"), maneuver.clone(), of)));
        }
    }
    names
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
        "maneuvers" => count("Maneuvers begun"),
        "slow-maneuvers" => count("Slow maneuvers begun"),
        "slow-collisions" => count("Slow maneuvers that ended in contact: the trial's last one, if any"),
        "fast-maneuvers" => count("Fast maneuvers begun"),
        "fast-collisions" => count("Fast maneuvers that ended in contact: the trial's last one, if any"),
        "fast-maneuver-share" => {
            Column::probability(name, "fast-maneuvers over maneuvers").empty_where("no maneuver was begun")
        }
        _ => {
            let known = of_maneuvers().into_iter().find(|(known, ..)| known == name)?;
            let (_, maneuver, of) = known;
            match of {
                "passages" => count(&format!("Times that the maneuver {maneuver} was begun")),
                "arrived" => count(&format!("Times that it arrived ({maneuver})")),
                "collisions" => count(&format!("Times that it ended in contact ({maneuver})")),
                _ => number(&format!("Simulated time of those that arrived, summed up ({maneuver})")),
            }
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
        assert_eq!(names.len(), 15 + 6 * 4);
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
