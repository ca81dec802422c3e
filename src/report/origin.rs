//! Where the numbers come from: engine, inputs, circumstances of the run, and what the digest covers.

use crate::bundle::Bundle;
use crate::plan::Plan;
use serde::Serialize;

/// The fact that names the program and its version.
pub(super) const SEALED_BY: &str = "sealed by";

/// Where the numbers come from.
#[derive(Debug, Clone, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Provenance {
    /// What is known of the run, name and value; without who, where and when where the bundle does not tell.
    pub facts: Vec<(String, String)>,
    /// Values from the command line, `PATH=VALUE`.
    pub overrides: Vec<String>,
    /// The sealed inputs.
    pub inputs: Vec<InputRow>,
}

/// One sealed input.
#[derive(Debug, Clone, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct InputRow {
    /// What it is for: `world`, `robot`, `prior`, `published`, `calibration`, `posterior`.
    pub role: String,
    /// Its path as the manifest writes it.
    pub written: String,
    /// Its path in the bundle.
    pub sealed: String,
    /// Its licence: its own where one is stated, else the manifest's.
    pub license: String,
    /// SHA-256 of its bytes, 64 hex digits.
    pub sha256: String,
}

/// Returns where the numbers of `bundle` come from.
pub(super) fn provenance(bundle: &Bundle, plan: &Plan) -> Provenance {
    let experiment = &plan.experiment;
    let of_the_manifest = experiment.license.clone().unwrap_or_else(|| "not stated".to_owned());
    let inputs = bundle.inputs().iter().map(|input| InputRow {
        role: role(&input.as_written).to_owned(),
        written: input.as_written.clone(),
        sealed: input.path.clone(),
        license: input.license.clone().unwrap_or_else(|| of_the_manifest.clone()),
        sha256: input.sha256.hex(),
    });
    Provenance {
        facts: facts(bundle, plan),
        overrides: experiment.overrides.clone(),
        inputs: inputs.collect(),
    }
}

fn facts(bundle: &Bundle, plan: &Plan) -> Vec<(String, String)> {
    let mut facts = vec![
        ("engine version", bundle.engine().to_owned()),
        ("study digest", format!("sha256:{}", bundle.study_digest().hex())),
    ];
    if let Some(told) = bundle.circumstance() {
        facts.push((SEALED_BY, format!("reenact {}", told.version)));
        if told.environment.is_empty() {
            let text = "not recorded, so that the same study gives the same bundle everywhere (SOURCE_DATE_EPOCH)";
            facts.push(("time and machine of the run", text.to_owned()));
        } else {
            let run = format!("{} to {}", told.started.iso(), told.ended.iso());
            facts.push(("run from, to", run));
            let machine = told.environment.iter().map(|(name, value)| format!("{name} {value}"));
            facts.push(("machine", machine.collect::<Vec<_>>().join(", ")));
        }
    } else {
        facts.push((
            "time and machine of the run",
            "not told: this is no bag, or not one of ours".to_owned(),
        ));
    }
    if plan.experiment.calibration.is_some() {
        let files = bundle.inputs().iter().filter(|input| role(&input.as_written) == "calibration");
        let files: Vec<&str> = files.map(|input| input.path.as_str()).collect();
        let text = format!(
            "what maneuvers take was measured by an experiment of its own and is sealed as an input: {}",
            files.join(", ")
        );
        facts.push(("calibration", text));
    }
    if plan.experiment.inference().is_some() {
        let files = bundle.inputs().iter().filter(|input| role(&input.as_written) == "posterior");
        let files: Vec<&str> = files.map(|input| input.path.as_str()).collect();
        let text = format!(
            "the draws that are run follow from the proposals of an inference, which are sealed as an input: {}",
            files.join(", ")
        );
        facts.push(("posterior", text));
    }
    if let Some(capsule) = bundle.capsule() {
        facts.push(("engine's source", format!("in the bundle, from {capsule}")));
    }
    facts.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
}

fn role(as_written: &str) -> &'static str {
    if as_written.ends_with(".draws.csv") || as_written.ends_with(".proposals.jsonl") {
        return "posterior";
    }
    if as_written.ends_with(".maneuvers.csv") || as_written.contains("calibration") {
        return "calibration";
    }
    if as_written.ends_with(".sensitivity.csv") {
        return "sensitivity";
    }
    if as_written.ends_with(".multiverse.csv") {
        return "multiverse";
    }
    match as_written.rsplit('.').next() {
        Some("urdf" | "xacro" | "gazebo") => "robot",
        Some("csv") => "published",
        Some("world" | "sdf") => "world",
        Some("png" | "pgm") => "prior",
        _ if as_written.contains("world") => "world",
        _ => "input",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_told_apart_by_what_made_them() {
        let files = [
            "a.maneuvers.csv",
            "a-calibration.draws.csv",
            "a.proposals.jsonl",
            "manifests/a.sensitivity.csv",
            "a.multiverse.csv",
            "reference/a.csv",
            "../robots/a.urdf",
        ];
        let roles = [
            "calibration",
            "posterior",
            "posterior",
            "sensitivity",
            "multiverse",
            "published",
            "robot",
        ];
        assert_eq!(files.map(role), roles);
    }
}
