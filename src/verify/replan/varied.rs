//! The runs of a study at other values of its assumptions: one at a time (a robustness table), or all of them drawn together (a
//! multiverse table).

use super::super::pipeline::{MakeAgainError, ReplanError};
use super::{Sealed, Study, file_name, resolve, written};
use crate::bundle::{BundlePath, Fault, assemble};
use crate::claims::multiverse::{Draw, Found};
use crate::claims::sensitivity::{Run, in_words};
use crate::manifest::JointDraws;
use crate::plan::Plan;
use crate::studies::records_digest;

impl Study<'_> {
    /// Runs the rows at `indices` of the robustness table again.
    pub(super) fn vary_again(
        &self,
        indices: &[usize],
    ) -> Result<Vec<Option<Fault>>, MakeAgainError> {
        let known = self.plan.experiment.sensitivity.as_ref();
        let known = known.ok_or(MakeAgainError::NoTable)?;
        let path = BundlePath::input(file_name(&known.as_written));
        let runs = known.table.runs();
        let compared = indices.iter().map(|&index| {
            let run = runs.get(index).ok_or(MakeAgainError::NoRow(index))?;
            let (expected, found) = match self.varied_plan(run) {
                Err(problem) => ("a run that can be planned again".to_owned(), problem.to_string()),
                Ok(plan) => {
                    let records = self.run(&plan.trials)?;
                    let verdicts = assemble::verdicts(&plan, &records)?;
                    match run.difference(&run.with(&verdicts, records_digest(&records))) {
                        Some(difference) => difference,
                        None => return Ok(None),
                    }
                }
            };
            let fault = Fault::new(&path, format!("{expected}, {run}"), found);
            let hint = "the robustness table was not made by these runs: `reenact vary` makes it";
            Ok(Some(fault.hint(hint)))
        });
        compared.collect()
    }

    /// Makes the plan of a run of the robustness table.
    pub(super) fn varied_plan(&self, run: &Run) -> Result<Plan, ReplanError> {
        let value_of = |path: &str, tried: &str| {
            let assumptions = &self.plan.experiment.assumptions;
            let of_it = assumptions.iter().filter(|assumption| assumption.path == path);
            let stated = of_it.flat_map(|a| &a.range).find(|value| in_words(value) == tried);
            // JSON is YAML too.
            stated.map_or_else(|| tried.to_owned(), ToString::to_string)
        };
        self.plan_with_values(run.overrides(&value_of))
    }

    /// Draws the rows at `indices` of the multiverse table and runs them again.
    pub(super) fn draw_again(
        &self,
        indices: &[usize],
    ) -> Result<Vec<Option<Fault>>, MakeAgainError> {
        let known = self.plan.experiment.multiverse.as_ref();
        let JointDraws { as_written, table } = known.ok_or(MakeAgainError::NoTable)?;
        let path = BundlePath::input(file_name(as_written));
        let choices = self.plan.experiment.choices();
        let drawn = table.drawn_again(&choices);
        let compared = indices.iter().map(|&index| {
            let draw = table.runs().nth(index).ok_or(MakeAgainError::NoRow(index))?;
            let misdrawn = table.misdrawn(draw, &drawn);
            let difference = if misdrawn.is_some() {
                misdrawn
            } else {
                let found = self.found_at(draw, table.overrides(draw, &choices))?;
                table.difference(draw, &found)
            };
            Ok(difference.map(|(expected, found)| {
                // Below the header.
                let fault =
                    Fault::new(path.line(index + 2), format!("{expected}, {draw}"), found);
                fault.hint(
                    "the multiverse table was not made by these runs: `reenact vary --joint` makes it",
                )
            }))
        });
        compared.collect()
    }

    /// Returns what is found at `draw`, which these overrides ask for.
    fn found_at(&self, draw: &Draw, overrides: Vec<String>) -> Result<Found, MakeAgainError> {
        match self.plan_with_values(overrides) {
            Err(ReplanError::Faulty(faults)) => Ok(Found::refused_by(&faults)),
            Err(problem) => Err(MakeAgainError::Unplanned(draw.to_string(), problem)),
            Ok(plan) => {
                let records = self.run(&plan.trials)?;
                let verdicts = assemble::verdicts(&plan, &records)?;
                Ok(Found::judged(&verdicts, records_digest(&records)))
            }
        }
    }

    /// Plans the study with further `overrides` after its own.
    pub(super) fn plan_with_values(&self, further: Vec<String>) -> Result<Plan, ReplanError> {
        let (source, mut overrides) = written(self.bundle)?;
        overrides.extend(further);
        Ok(Plan::of(resolve(&source, &overrides, &Sealed(self.bundle))?))
    }
}
