//! Wall times of trials and the claims about them: measured, not derived, so they live in the circumstance half.

use super::assemble;
use crate::claims::metric::WALL_TIME_COLUMNS;
use crate::claims::observations::TrialsTableError;
use crate::claims::{self, ClaimVerdict};
use crate::digest::TrialKey;
use crate::factor::Factor;
use crate::plan::Plan;
use crate::studies::Ledger;
use crate::table::{Table, Value};
use std::collections::BTreeMap;

/// How long one trial took on the machine that ran it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct WallTime {
    /// The whole trial (s).
    pub trial_s: f64,
    /// Each choice of where to go (s), in order.
    pub selections_s: Vec<f64>,
}

/// Wall times of the trials that were executed; those that a store held have none.
pub type WallTimes = BTreeMap<TrialKey, WallTime>;

/// Verdicts on the claims about the machine, and the files under `circumstances/` that hold them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MachineResults {
    /// In the manifest's order.
    pub verdicts: Vec<ClaimVerdict>,
    /// As [`super::Circumstance::files`] takes them; none where nothing is claimed of the machine.
    pub files: Vec<(String, Vec<u8>)>,
}

/// Judges the claims about the machine by the `times` of `plan`'s trials, or says of each why there are none.
///
/// # Errors
/// Where no claim can be judged by such records.
pub fn measured(
    plan: &Plan,
    ledger: &Ledger,
    times: Result<&WallTimes, &str>,
) -> Result<MachineResults, TrialsTableError> {
    let claims = &plan.experiment.claims;
    let claims: Vec<_> = claims.iter().filter(|claim| claim.circumstance).collect();
    if plan.partial || claims.is_empty() {
        return Ok(MachineResults::default());
    }
    let experiment = &plan.experiment;
    let context =
        claims::Context::new(&experiment.published, &experiment.shared_noise, experiment.seed)
            .over_draws(experiment.draws());
    let mut files = Vec::new();
    let verdicts = match times {
        Ok(times) => {
            let table = table(plan, ledger, times);
            files.push(("wall-times.csv".to_owned(), table.to_csv().into_bytes()));
            let judged = claims.iter().map(|claim| claims::judge(claim, &table, &context));
            judged.collect::<Result<Vec<_>, _>>()?
        }
        Err(reason) => {
            claims.iter().map(|claim| claims::not_measured(claim, reason, &context)).collect()
        }
    };
    files.push(("claims.json".to_owned(), assemble::verdicts_json(&verdicts)));
    Ok(MachineResults { verdicts, files })
}

/// Returns the columns of the times of trials of a design of `factors`.
pub(super) fn columns(factors: &[Factor]) -> Vec<&str> {
    ["key"]
        .into_iter()
        .chain(factors.iter().map(|factor| factor.name.as_str()))
        .chain(["trial", "outcome"])
        .chain(WALL_TIME_COLUMNS)
        .collect()
}

/// Makes a table of one row a trial: key, factors, number, outcome and the columns of [`WALL_TIME_COLUMNS`].
fn table(plan: &Plan, ledger: &Ledger, times: &WallTimes) -> Table {
    let factors = &plan.experiment.factors;
    let mut table = Table::new(columns(factors));
    for trial in ledger.entries() {
        let mut row: Vec<Value> = vec![trial.key().hex().into()];
        row.extend(
            factors.iter().map(|f| trial.condition().value(&f.name).map(str::to_owned).into()),
        );
        row.push(i64::from(trial.trial()).into());
        row.push(trial.outcome().name().into());
        let time = times.get(&trial.key());
        let selections = time.map_or(&[][..], |time| &time.selections_s);
        let longest = selections.iter().copied().reduce(f64::max);
        #[expect(clippy::cast_precision_loss, reason = "choices of one trial")]
        let mean = longest.map(|_| selections.iter().sum::<f64>() / selections.len() as f64);
        row.extend([time.map(|time| time.trial_s), mean, longest].map(Value::from));
        table.push(row);
    }
    table
}
