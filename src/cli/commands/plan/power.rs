//! `reenact plan --power`: what numbers of trials would decide, said before any is run.

use crate::claims::power::{Chance, Power, PowerError, REPLICATES, power as power_of};
use crate::claims::{Claim, Context};
use crate::cli::args::DataFormat;
use crate::condition::Condition;
use crate::plan::Plan;
use serde_json::{Value, json};

/// Returns the power of `plan` for every claim that assumes a truth, and why the others have none.
pub(super) fn power(plan: &Plan, format: DataFormat) -> String {
    let experiment = &plan.experiment;
    let context = Context::new(&experiment.published, &experiment.shared_noise, experiment.seed);
    let mut conditions: Vec<Condition> = Vec::new();
    let mut trials = Vec::new();
    for spec in &plan.trials {
        // The plan goes condition by condition.
        if conditions.last() != Some(&spec.condition) {
            conditions.push(spec.condition.clone());
            trials.push(0);
        }
        trials.iter_mut().last().into_iter().for_each(|n| *n += 1);
    }
    let planned = trials.into_iter().max().unwrap_or(0);
    let claims = plan.experiment.claims.iter();
    let found: Vec<(Claim, Result<Power, PowerError>)> = claims
        .map(|claim| {
            let power = power_of(claim, &conditions, planned, &context, REPLICATES);
            (claim.clone(), power)
        })
        .collect();
    match format {
        DataFormat::Human => in_words(planned, &found),
        DataFormat::Json => {
            let claims: Vec<Value> =
                found.iter().map(|(claim, power)| line(claim, power)).collect();
            json!({"planned": planned, "studies": REPLICATES, "claims": claims}).to_string()
        }
    }
}

fn line(claim: &Claim, power: &Result<Power, PowerError>) -> Value {
    match power {
        Ok(power) => power.to_json(),
        Err(reason) => json!({"id": claim.id, "unknown": reason.to_string()}),
    }
}

fn in_words(planned: u64, found: &[(Claim, Result<Power, PowerError>)]) -> String {
    if found.is_empty() {
        return "the manifest makes no claim\n".to_owned();
    }
    let mut text = format!(
        "Share of {REPLICATES} made-up studies that support or contradict a claim, if what its `power` assumes is true\n"
    );
    for (claim, power) in found {
        text.push_str(&format!("\n{}: {}\n", claim.id, claim.words().text()));
        let power = match power {
            Ok(power) => power,
            Err(reason) => {
                text.push_str(&format!("  unknown: {reason}\n"));
                continue;
            }
        };
        text.push_str("  trials  supported  contradicted\n");
        let mut rows: Vec<&Chance> = power.ladder.iter().collect();
        if rows.iter().all(|chance| chance.trials != planned) {
            rows.push(&power.planned);
        }
        rows.sort_by_key(|chance| chance.trials);
        for chance in &rows {
            let mark = if chance.trials == planned { "  planned" } else { "" };
            text.push_str(&format!(
                "  {:>6}  {:>7.0} %  {:>10.0} %{mark}\n",
                chance.trials,
                100.0 * chance.supported,
                100.0 * chance.contradicted
            ));
        }
        let most = rows.last().map_or(planned, |chance| chance.trials);
        text.push_str(&match power.enough {
            Some(trials) => {
                format!("  {trials} trials per condition decide it in 80 % of studies or more\n")
            }
            None => format!("  {most} trials per condition do not decide it in 80 % of studies\n"),
        });
    }
    text
}
