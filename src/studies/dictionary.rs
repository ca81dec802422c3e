//! What every column of the tables of trials and of inputs says: factors, what all studies share, and each study's own.
//! Requested tables declare their own columns.

use super::columns::of_factor;
use super::{Outcome, StudyKind, deadline, inference};
use crate::claims::Judgement;
use crate::claims::metric::WALL_TIME_COLUMNS;
use crate::claims::multiverse::{Prefix, prefixed};
use crate::factor::Factor;
use crate::table::{Column, unit_of};

/// The words for the columns of one experiment's tables.
#[derive(Debug, Clone, Copy)]
pub struct Dictionary<'a> {
    /// Which study.
    pub kind: StudyKind,
    /// Factors with all their values, in the manifest's order.
    pub factors: &'a [Factor],
    /// How trials can end besides the study's own ways, as parameters ask for it.
    pub further_outcomes: &'a [Outcome],
}

impl Dictionary<'_> {
    /// Describes a column of `trials.csv`.
    pub fn of_trials(&self, name: &str) -> Option<Column> {
        match name {
            "key" => Some(
                Column::text(
                    name,
                    "Identity of the trial: SHA-256 of everything that it depends on",
                )
                .like("^[0-9a-f]{64}$"),
            ),
            "outcome" => Some(self.outcome()),
            _ => self
                .trial_or_factor(name)
                .or_else(|| self.kind.measure(name))
                .or_else(|| inference::measure(name)),
        }
    }

    /// Describes a column of `series.csv`.
    pub fn of_series(&self, name: &str) -> Option<Column> {
        let number = |meaning: &str| Column::number(name, unit_of(name), meaning).at_least(0.0);
        match name {
            "key" => Some(
                Column::text(name, "The trial: its key in results/trials.csv")
                    .like("^[0-9a-f]{64}$"),
            ),
            "time-s" => Some(number("Simulated time since the trial began")),
            "distance-m" => Some(number("Way travelled until then")),
            "coverage-percent" => Some(Column::percent(name, "Coverage then")),
            _ => self.trial_or_factor(name),
        }
    }

    /// Describes a column of `circumstances/wall-times.csv`.
    pub fn of_wall_times(&self, name: &str) -> Option<Column> {
        let meaning = match WALL_TIME_COLUMNS.iter().position(|known| *known == name) {
            Some(0) => "Time that the trial took on the machine that ran it",
            Some(1) => "Time of one choice of where to go: mean over those of the trial",
            Some(_) => "Time of the longest choice of where to go",
            None => return self.of_trials(name),
        };
        let empty = "the trial came from a store, or nothing was chosen";
        Some(Column::number(name, "s", meaning).at_least(0.0).empty_where(empty))
    }

    /// Describes a column of a file with the paper's own numbers.
    pub fn of_published(&self, name: &str) -> Option<Column> {
        let silent = "the paper does not say";
        Some(match name {
            "coverage-percent" => Column::percent(name, "Level of coverage").empty_where(silent),
            "value" => Column::number(
                name,
                "",
                "The paper's number, in the unit of the table that it stands beside",
            ),
            "sd" => {
                Column::number(name, "", "The standard deviation that the paper prints with it")
                    .empty_where(silent)
            }
            "n" => Column::count(name, "Number of runs behind it").empty_where(silent),
            "measure" => {
                Column::text(name, "The column of results/trials.csv that the number is of")
            }
            // A paper may have levels that are not run.
            _ => Column { among: Vec::new(), ..self.factor(name)? }.empty_where(silent),
        })
    }

    /// Describes a column of the calibration from which the deadline study's planner takes its expectations of
    /// maneuvers.
    pub fn of_calibration(name: &str) -> Option<Column> {
        deadline::columns::of_calibration(name)
    }

    /// Describes a column of the passages on which a calibration rests.
    pub fn of_passages(name: &str) -> Option<Column> {
        deadline::columns::of_passages(name)
    }

    /// Describes a column of what `reenact vary` found.
    pub fn of_sensitivity(name: &str) -> Option<Column> {
        let verdicts = Judgement::ALL.map(|verdict| verdict.to_string());
        Some(match name {
            "setting" => Column::text(name, "Path of the assumption in the manifest"),
            "chosen" => Column::text(name, "The value that the manifest chose"),
            "tried" => Column::text(name, "Another value that its `range` states"),
            "trials" => Column::count(name, "Trials per condition at either value"),
            "claim" => Column::text(name, "Id of the claim"),
            "at-chosen" => {
                Column::of_values(name, "", "The verdict at the chosen value", &verdicts)
            }
            "at-tried" => Column::of_values(name, "", "The verdict at the value tried", &verdicts),
            "records-at-chosen" => {
                Column::text(name, "SHA-256 of the records of the run at the chosen values, in hex")
                    .empty_where("the table is older than this column")
            }
            "records-at-tried" => {
                Column::text(name, "SHA-256 of the records of the run at the value tried, in hex")
                    .empty_where("the table is older than this column")
            }
            _ => return None,
        })
    }

    /// Describes a column of what `reenact vary --joint` found.
    pub fn of_multiverse(name: &str) -> Option<Column> {
        let verdicts = Judgement::ALL.map(|verdict| verdict.to_string());
        Some(match (name, prefixed(name)) {
            (_, Some((Prefix::Verdict, claim))) => {
                Column::of_values(name, "", &format!("The verdict on the claim {claim}"), &verdicts)
                    .empty_where("the draw was refused")
            }
            (_, Some((Prefix::Estimate, claim))) => {
                let meaning =
                    format!("Mean effect of the comparisons by which the claim {claim} was judged");
                Column::number(name, "", &meaning)
                    .empty_where("the draw was refused, or these have no effect of one kind")
            }
            ("draw", _) => Column::text(
                name,
                "Number of the draw, from 0; `chosen` for the run at the values that the manifest chose",
            ),
            ("seed", _) => Column::count(name, "Seed of the Latin hypercube that was drawn"),
            ("trials", _) => Column::count(name, "Trials per condition of every draw"),
            ("refused", _) => {
                Column::text(name, "Why the manifest's own checks refuse these values together")
                    .empty_where("they were run")
            }
            ("records", _) => Column::text(name, "SHA-256 of the records of the run, in hex")
                .empty_where("the draw was refused"),
            _ => Column::text(name, "The value of the assumption of this path"),
        })
    }

    fn trial_or_factor(&self, name: &str) -> Option<Column> {
        if name == "trial" {
            return Some(Column::count(name, "Number of the trial in its condition, from 0"));
        }
        self.factor(name)
    }

    fn factor(&self, name: &str) -> Option<Column> {
        of_factor(self.factors, name)
    }

    fn outcome(&self) -> Column {
        let known = [self.kind.outcomes(), self.further_outcomes, &[Outcome::PANICKED]].concat();
        let words: Vec<String> =
            known.iter().map(|outcome| format!("{}: {}", outcome.name(), outcome.says())).collect();
        let meaning = format!("Why the trial ended. {}", words.join("; "));
        let among = known.iter().map(|outcome| outcome.name().to_owned());
        Column { among: among.collect(), ..Column::text("outcome", &meaning) }
    }
}
