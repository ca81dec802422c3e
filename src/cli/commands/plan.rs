//! `reenact plan`: the trials that would run, what one trial's key is made of, or what they would decide.

mod power;

use crate::cli::args::{DataFormat, PlanArgs};
use crate::cli::calibrate::{Calibrator, Unmeasured};
use crate::cli::exit::{Exit, Failure};
use crate::cli::forecast::Forecast;
use crate::cli::load;
use crate::cli::terminal::{Terminal, counted};
use crate::provenance::{Environment, processors};
use crate::store::DirectoryStore;
use serde_json::{Value, json};
use std::cell::RefCell;

/// Lists the trials and estimates the rest, explains one of them, or says how likely they are to decide each claim.
pub(in crate::cli) fn run(
    args: &PlanArgs,
    environment: &Environment,
    terminal: Terminal,
) -> Result<Exit, Failure> {
    let store = DirectoryStore::new(environment.store().map_err(Failure::not_understood)?);
    // What a calibration measured is part of a trial's key, and of nothing else here.
    let missing = RefCell::new(None);
    let calibrator = match &args.explain {
        Some(_) => Calibrator::Stored(&store),
        None => Calibrator::AtHand(&store, &missing),
    };
    let loaded = load::manifest(&args.manifest, args.select.given(), calibrator, terminal)?;
    let (plan, _) = load::plan(loaded.experiment, &args.select)?;
    if let Some(wanted) = &args.explain {
        let spec = plan.find(wanted).map_err(Failure::not_understood)?;
        terminal.result(&plan.explain(spec));
        return Ok(Exit::Yes);
    }
    if args.power {
        terminal.result(&power::power(&plan, args.format));
        return Ok(Exit::Yes);
    }
    let missing = missing.into_inner();
    let store = match &missing {
        Some(_) => None,
        None => Some(store.look().map_err(Failure::failed)?),
    };
    let mut text = String::new();
    let mut lines: Vec<Value> = Vec::new();
    let mut done = 0;
    for spec in &plan.trials {
        let record = match &store {
            Some(store) => store.get(&spec.key).map_err(Failure::failed)?,
            None => None,
        };
        if args.format == DataFormat::Json {
            lines.push(json!({
                "key": missing.is_none().then(|| spec.key.hex()),
                "condition": spec.condition.slug(),
                "trial": spec.trial,
                "done": record.is_some(),
                "outcome": record.as_ref().map(|record| record.outcome.name()),
            }));
        }
        let state = match &record {
            Some(record) => {
                done += 1;
                format!("done  {}", record.outcome.name())
            }
            None => "to do".to_owned(),
        };
        text.push_str(&format!(
            "{}  {}/{}  {state}\n",
            missing.as_ref().map_or_else(|| spec.key.short(), |_| NO_KEY.to_owned()),
            spec.condition.slug(),
            spec.trial
        ));
    }
    let left = plan.trials.len() - done;
    let forecast = Forecast::of(&plan, store.as_ref()).map_err(Failure::failed)?;
    let time = forecast.time_of(left, processors()).filter(|_| left > 0);
    let time = time.map_or_else(String::new, |time| format!(", {time}"));
    text.push_str(&format!(
        "{}: {done} done, {left} to do{time}\n{}",
        counted(plan.trials.len(), "trial"),
        forecast.in_words()
    ));
    terminal.result(&match args.format {
        DataFormat::Human => text,
        DataFormat::Json => json!({
            "name": plan.experiment.name,
            "trials": lines,
            "done": done,
            "to_do": left,
            "partial": plan.partial,
            "forecast": forecast.to_json(),
        })
        .to_string(),
    });
    if let Some(missing) = missing {
        let on = match &missing {
            Unmeasured::NotRun { trials: "proposals", .. } => "what the inference proposes",
            _ => "what the calibration measures",
        };
        terminal.note(&format!("note: keys depend on {on}; {missing}"));
    }
    Ok(Exit::Yes)
}

/// What stands for a key that nobody can know yet.
const NO_KEY: &str = "--------";
