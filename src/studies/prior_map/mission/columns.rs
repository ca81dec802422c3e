//! What the measures of a trial say, and the columns of this study's tables: one place for the data dictionary and for what
//! claims and tables may speak of.

use super::FURTHER_AT_MILESTONES;
use super::pose_errors::POSE_ERRORS;
use super::trace::{MILESTONES, coverage_at_distance};
use crate::studies::findings::agreement_column;
use crate::studies::prior_map::requests::{CoverageTable, EffectsTable, MeasuresTable, Metric};
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

/// Every measure that a trial of this study can have, but for coverages at distances that a manifest asks for.
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

/// What the measure `name` says; `None` where trials of this study have none of that name.
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
    let percent = percent.parse().ok().filter(|percent| MILESTONES.contains(percent))?;
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

/// A column of a coverage table, factors aside.
pub fn of_coverage_table(wanted: &CoverageTable, name: &str) -> Option<Column> {
    let (unit, of) = match wanted.metric {
        Metric::DistanceM => ("m", "way travelled when that coverage was reached"),
        Metric::TimeS => ("s", "simulated time when that coverage was reached"),
    };
    let baseline = wanted.baseline.as_ref().map_or("the baseline", |value| value.0.as_str());
    let number = |unit, meaning: String| Column::number(name, unit, &meaning);
    let against = "it is the baseline itself, or one of both has no runs that got there";
    let tested = "it is the baseline itself, or one of both has fewer than two runs that got there";
    let published = "the paper prints none";
    Some(match name {
        "coverage-percent" => Column::percent(name, "Level of coverage"),
        "mean" => number(unit, format!("Mean over trials of the {of}"))
            .at_least(0.0)
            .empty_where("no trial got there"),
        "sd" => number(unit, "Standard deviation over those trials (n - 1)".to_owned())
            .at_least(0.0)
            .empty_where("fewer than two trials got there"),
        "n" => Column::count(name, "Trials that reached the coverage; mean and sd are of these"),
        "trials" => Column::count(name, "All trials of the cell"),
        "difference-percent" => {
            number("%", format!("Difference of the mean to that of `{baseline}`")).empty_where(against)
        }
        "published" => number(unit, "The mean that the paper prints".to_owned())
            .at_least(0.0)
            .empty_where(published),
        "published-sd" => number(unit, "The standard deviation that the paper prints".to_owned())
            .at_least(0.0)
            .empty_where(published),
        "published-n" => Column::count(name, "The paper's number of runs").empty_where(published),
        "published-difference-percent" => number(
            "%",
            format!("Difference of the paper's mean to its mean for `{baseline}`, from the printed numbers"),
        )
        .empty_where("it is the baseline itself, or the paper prints no pair"),
        "hedges-g" => number("", format!("Effect against `{baseline}`: Hedges' g, all runs that got there"))
            .empty_where(tested),
        "welch-p" => Column::probability(name, "Two-sided p of Welch's test against the baseline, all runs that got there")
            .empty_where(tested),
        "first-n" => Column::count(name, "The paper's number of runs, or 10 where it prints none")
            .empty_where("it is the baseline itself"),
        "first-n-reached" => Column::count(name, "How many of the first `first-n` trials got there")
            .empty_where("it is the baseline itself"),
        "first-n-hedges-g" => number("", "Hedges' g against the baseline, the first `first-n` trials only".to_owned())
            .empty_where(tested),
        "first-n-welch-p" => {
            Column::probability(name, "p of Welch's test against the baseline, the first `first-n` trials only")
                .empty_where(tested)
        }
        "published-hedges-g" => {
            number("", "Hedges' g against the baseline from the paper's printed means and deviations".to_owned())
                .empty_where("the paper prints no pair of means with deviations")
        }
        "published-welch-p" => {
            Column::probability(name, "p of Welch's test against the baseline from the paper's printed numbers")
                .empty_where("the paper prints no pair of means with deviations")
        }
        _ => return agreement_column(name, unit),
    })
}

/// A column of a table of whole trials' measures, factors aside.
pub fn of_measures_table(wanted: &MeasuresTable, name: &str) -> Option<Column> {
    let unit = "that of measure";
    let number = |meaning| Column::number(name, unit, meaning);
    let published = "the paper prints none";
    Some(match name {
        "measure" => Column::of_values(
            name,
            "",
            "The column of results/trials.csv that is summed up",
            &wanted.measures,
        ),
        "mean" => number("Mean over trials").empty_where("no trial has the measure"),
        "sd" => number("Standard deviation over trials (n - 1)")
            .at_least(0.0)
            .empty_where("fewer than two trials have the measure"),
        "n" => Column::count(name, "Trials that have the measure; mean and sd are of these"),
        "trials" => Column::count(name, "All trials of the cell"),
        "published" => number("The mean that the paper prints").empty_where(published),
        "published-sd" => number("The standard deviation that the paper prints")
            .at_least(0.0)
            .empty_where(published),
        "published-n" => Column::count(name, "The paper's number of runs").empty_where(published),
        _ => return agreement_column(name, unit),
    })
}

/// A column of a table of effects, factors aside.
pub fn of_effects_table(wanted: &EffectsTable, name: &str) -> Option<Column> {
    let (unit, metric) = match wanted.metric {
        Metric::DistanceM => ("m", "way travelled"),
        Metric::TimeS => ("s", "simulated time"),
    };
    let never = "no condition has runs of both levels that got there";
    let percent = |meaning: &str| Column::number(name, "%", meaning).empty_where(never);
    let few = "no condition has two runs of both levels that got there";
    Some(match name {
        "factor" => {
            Column::of_values(name, "", "The factor whose levels are compared", &wanted.factors)
        }
        "level" => Column::text(name, "The level"),
        "against" => Column::text(name, "The level it is compared with: the factor's first"),
        "coverage-percent" => Column::percent(name, "Level of coverage"),
        "effect-percent" => percent(&format!(
            "By how much the level moves the {metric} at that coverage: ratio of geometric means over matched conditions, less one"
        )),
        "effect-low" => percent("Lower end of its 95 % interval").empty_where(few),
        "effect-high" => percent("Upper end of its 95 % interval").empty_where(few),
        "p" => Column::probability(name, "Two-sided p of no effect (Welch, matched conditions)")
            .empty_where(few),
        "matched-conditions" => {
            Column::count(name, "Combinations of all other factors that were run at both levels")
        }
        "compared-conditions" => {
            Column::count(name, "Those of them with runs of both levels that got there")
        }
        "n" => Column::count(name, "Runs at the level that reached the coverage"),
        "trials" => Column::count(name, "Runs at the level"),
        "against-n" => Column::count(name, "Runs at the first level that reached the coverage"),
        "against-trials" => Column::count(name, "Runs at the first level"),
        "against-geometric-mean" => Column::number(
            name,
            unit,
            &format!("Geometric mean of the {metric} at the first level"),
        )
        .at_least(0.0)
        .empty_where(never),
        "published" => Column::number(name, unit, "The mean that the paper prints")
            .at_least(0.0)
            .empty_where("the paper prints none"),
        "gap-percent" => percent("By how much the paper's mean is above that of the first level")
            .empty_where("the paper prints none, or no run got there"),
        "share-of-gap" => Column::number(
            name,
            "",
            "The effect as a share of that gap, of logarithms: 1 closes it, below 0 widens it",
        )
        .empty_where("the paper prints none, or no run got there"),
        _ => return None,
    })
}

/// A column of a table of agreement.
pub fn of_agreement_table(name: &str) -> Option<Column> {
    let nothing = "too few cells vary";
    let number = |meaning| Column::number(name, "", meaning).empty_where(nothing);
    let correlation = |meaning| number(meaning).at_least(-1.0).at_most(1.0);
    Some(match name {
        "table" => Column::text(name, "The coverage table that is compared with the paper's"),
        "scope" => Column::text(name, "`all` of it, or the factor's value that the part has"),
        "ratios" => Column::count(name, "Cells with a log ratio to their baseline on both sides"),
        "missing" => Column::count(name, "Cells that the paper prints and no run of ours reached"),
        "censored" => Column::count(
            name,
            "Cells with runs that never got there; their means are of those that did",
        ),
        "blocks" => Column::count(
            name,
            "Sets of cells with no run in common; intervals leave out one at a time",
        ),
        "slope" => number(
            "Slope of our log ratios on the paper's: 1 agrees, below 1 our gains are smaller",
        ),
        "slope-low" => number("Lower end of the slope's 95 % interval (jackknife over blocks)"),
        "slope-high" => number("Upper end of the slope's 95 % interval (jackknife over blocks)"),
        "intercept" => number("Intercept of that line: 0 agrees"),
        "intercept-low" => {
            number("Lower end of the intercept's 95 % interval (jackknife over blocks)")
        }
        "intercept-high" => {
            number("Upper end of the intercept's 95 % interval (jackknife over blocks)")
        }
        "pearson" => correlation("Pearson's correlation of the log ratios"),
        "spearman" => correlation("Spearman's correlation of the log ratios"),
        "rmse-log-ratio" => {
            number("Root mean square difference of the log ratios: 0 is perfect").at_least(0.0)
        }
        "skill-over-mean-ratio" => number(
            "Skill over the paper's one mean ratio: 1 is perfect, 0 no better than that constant",
        )
        .at_most(1.0),
        "mean-log-ratio" => number("Mean of our log ratios"),
        "published-mean-log-ratio" => number("Mean of the paper's log ratios"),
        "ratios-with-interval" => Column::count(
            name,
            "Log ratios around which the paper's spread and number of runs put a 95 % interval",
        ),
        "ratios-inside" => Column::count(name, "How many of our log ratios lie inside it"),
        "cells-with-interval" => {
            Column::count(name, "Cells around whose printed mean they put a 95 % interval")
        }
        "cells-inside" => Column::count(name, "How many of our cells lie inside it"),
        _ => return None,
    })
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
        assert_eq!(measure("distance-m-at-51"), None);
        assert_eq!(measure("coverage-percent-at-m"), None);
    }
}
