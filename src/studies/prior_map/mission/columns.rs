//! What the measures of a trial say: one place for the data dictionary and for what claims and tables may speak of.

use super::FURTHER_AT_MILESTONES;
use super::pose_errors::POSE_ERRORS;
use super::trace::{MILESTONES, coverage_at_distance, level_of};
use crate::studies::prior_map::requests::Metric;
use crate::table::{Column, unit_of};

/// The measures that are told at the end of every trial, and those that a manifest asks for.
const WHOLE: [&str; 8] = [
    "distance-m",
    "time-s",
    "coverage-percent",
    "turning-rad",
    "decisions",
    "frontiers-given-up",
    "contacts",
    "turning-rad-per-m",
];

/// Returns every measure that a trial of this study can have, but for coverages at distances that a manifest asks for.
pub fn measures() -> Vec<String> {
    let mut names: Vec<String> = WHOLE.map(str::to_owned).to_vec();
    names.push("mean-speed-m-s".to_owned());
    for percent in MILESTONES {
        names.push(Metric::DistanceM.measure_at(percent));
        names.push(Metric::TimeS.measure_at(percent));
        names.extend(FURTHER_AT_MILESTONES.map(|name| format!("{name}-at-{percent}")));
    }
    names.extend(POSE_ERRORS.map(str::to_owned));
    names
}

/// Returns what the measure `name` says; `None` where trials of this study have none of that name.
pub fn measure(name: &str) -> Option<Column> {
    whole(name).or_else(|| pose_error(name)).or_else(|| at_milestone(name)).or_else(|| {
        let distance: u32 = name.split('-').rev().nth(1)?.parse().ok()?;
        (coverage_at_distance(distance) == name).then(|| {
            let meaning = format!("Coverage when the robot had travelled {distance} m");
            Column::percent(name, &meaning).empty_where("the trial ended before it got that far")
        })
    })
}

fn whole(name: &str) -> Option<Column> {
    let number =
        |meaning| Column::number(name, unit_of(name), meaning).at_least(0.0).empty_where(PANICKED);
    let count = |meaning| Column::count(name, meaning).empty_where(PANICKED);
    Some(match name {
        "distance-m" => number("Way that the body truly travelled in the whole trial"),
        "time-s" => number("Simulated time from the start to the end of the trial"),
        "coverage-percent" => Column::percent(
            name,
            "Share of the cells that can be seen from where a robot can be that the robot's map shows at the end",
        )
        .empty_where(PANICKED),
        "turning-rad" => number("Sum of the absolute turns of the body in the whole trial"),
        "decisions" => count("How many times the robot chose where to go"),
        "frontiers-given-up" => count("Locations that the robot chose and gave up on the way"),
        "contacts" => count("How many times the body came into contact with something"),
        "turning-rad-per-m" => number("turning-rad over distance-m").empty_where("it never moved"),
        "mean-speed-m-s" => number("distance-m over time-s").empty_where("it took no time"),
        _ => return None,
    })
}

/// When a measure of the end of a trial is empty.
const PANICKED: &str = "the program failed in the trial (outcome panicked)";

fn pose_error(name: &str) -> Option<Column> {
    let meaning = match POSE_ERRORS.iter().position(|known| *known == name)? {
        0 => {
            "Distance from where the robot was to where it took itself to be, at each scan taken into the map: root mean square"
        }
        1 => "The same distance: median",
        2 => "The same distance: largest",
        3 => "The same for the way as the robot sees it at the end of the trial: root mean square",
        _ => "The same for dead reckoning by odometry alone: root mean square",
    };
    let empty = "the robot is told its pose, or the program failed in the trial";
    Some(Column::number(name, "m", meaning).at_least(0.0).empty_where(empty))
}

fn at_milestone(name: &str) -> Option<Column> {
    let (what, percent) = name.rsplit_once("-at-")?;
    let percent: f64 = percent.parse().ok()?;
    let is_milestone = MILESTONES.iter().any(|&known| f64::from(known) == percent);
    if !is_milestone && level_of(name).is_none() {
        return None;
    }
    let never = format!("coverage never reached {percent} %");
    let then = format!("when {percent} % of the environment was covered");
    let column = match what {
        "distance-m" => Column::number(name, "m", &format!("Way travelled {then}")).at_least(0.0),
        "time-s" => Column::number(name, "s", &format!("Simulated time {then}")).at_least(0.0),
        "decisions" => {
            Column::count(name, &format!("Choices of where to go that had been made {then}"))
        }
        "open-frontiers" => Column::count(name, &format!("Frontiers in the robot's map {then}")),
        _ => return None,
    };
    Some(column.empty_where(&never))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_measure_says_what_it_is() {
        for name in measures() {
            let column = measure(&name).unwrap_or_else(|| panic!("{name} is not described"));
            assert_eq!(column.name, name);
            assert_eq!(
                column.unit,
                if name.ends_with("percent") { "%" } else { column.unit.as_str() }
            );
            assert!(!column.meaning.is_empty() && column.empty.is_some(), "{name}");
        }
        let asked_for = measure("coverage-percent-at-239-m").unwrap();
        assert_eq!(asked_for.meaning, "Coverage when the robot had travelled 239 m");
        let further = measure("distance-m-at-99.5").unwrap();
        assert_eq!(further.meaning, "Way travelled when 99.5 % of the environment was covered");
        assert_eq!(measure("decisions-at-51"), None);
        assert_eq!(measure("coverage-percent-at-m"), None);
    }
}
