//! `reenact vary --joint N`: the claims judged again at draws that change every assumption at once.

use super::{Study, advice, verdicts_of};
use crate::claims::Judgement;
use crate::claims::multiverse::{Choice, Explained, Found, MOST_CELLS, Multiverse};
use crate::cli::args::DataFormat;
use crate::cli::exit::{Exit, Failure};
use crate::cli::load;
use crate::cli::terminal::counted;
use crate::manifest::Experiment;
use serde_json::{Value, json};

/// The greatest seed that a CSV file holds to the last digit, whatever reads it.
const MOST_SEED: u64 = i64::MAX as u64;

impl Study<'_> {
    /// Judges the claims of the `chosen` experiment at so many `draws` of its choices, and writes them beside the manifest.
    pub(super) fn draw(&self, chosen: Experiment, draws: usize) -> Result<Exit, Failure> {
        let choices = chosen.choices();
        let seed = self.seed(&chosen)?;
        check_draws(draws, choices.len(), chosen.claims.len())?;
        let drawn: Vec<Vec<Value>> =
            choices.iter().map(|choice| choice.draw(seed, draws)).collect();
        let trials = chosen.trials;
        let (verdicts, records) = self.verdicts(chosen)?;
        let mut found = Multiverse::new((seed, trials), &choices, (&verdicts, records));
        for number in 0..draws {
            let values: Vec<Value> = drawn.iter().map(|values| values[number].clone()).collect();
            if self.terminal.is_watched() {
                self.terminal.note(&format!("{}/{draws}: draw {number}", number + 1));
            }
            found.push(&values, self.found_at(&choices, &values)?);
        }
        let path = self.args.manifest.with_extension("multiverse.csv");
        let is_named = self.write(&path, &found.to_csv(), "multiverse")?;
        if self.args.format == DataFormat::Json {
            let answer = json!({
                "manifest": self.args.manifest,
                "path": path,
                "named_in_manifest": is_named,
                "trials_per_condition": trials,
                "seed": seed,
                "draws": draws,
                "verdicts": verdicts_of(&verdicts),
                "records_digest": format!("sha256:{records}"),
                "choices": choices
                    .iter()
                    .map(|choice| json!({"setting": choice.setting, "domain": choice.domain.to_string()}))
                    .collect::<Vec<_>>(),
                "refused": found
                    .refused()
                    .map(|(draw, reason)| json!({"draw": draw.number, "reason": reason}))
                    .collect::<Vec<_>>(),
                "claims": found
                    .explanation()
                    .claims
                    .iter()
                    .map(|claim| told(claim, &found.settings))
                    .collect::<Vec<_>>(),
            });
            self.terminal.result(&answer.to_string());
            return Ok(Exit::Yes);
        }
        let advice = advice(is_named, &path, "multiverse");
        self.terminal.result(&in_words(&choices, &found));
        self.terminal.result(&format!(
            "wrote {}: {} judged at {}{advice}\n",
            path.display(),
            counted(verdicts.len(), "claim"),
            found.in_words()
        ));
        Ok(Exit::Yes)
    }

    /// Returns the seed of the hypercube.
    fn seed(&self, chosen: &Experiment) -> Result<u64, Failure> {
        let (seed, whose, next) = match self.args.seed {
            Some(seed) => (seed, "`--seed`", "give a smaller one"),
            None => {
                (chosen.seed, "the manifest's seed", "give another for the draws with `--seed`")
            }
        };
        if seed > MOST_SEED {
            return Err(Failure::not_understood(format!(
                "{whose} must be at most {MOST_SEED} to be recorded in a table, found {seed}; {next}"
            )));
        }
        Ok(seed)
    }

    /// Returns what is found where each of `choices` has the value beside it.
    fn found_at(&self, choices: &[Choice], values: &[Value]) -> Result<Found, Failure> {
        // JSON is YAML too.
        let set: Vec<String> = choices
            .iter()
            .zip(values)
            .map(|(choice, value)| format!("{}={value}", choice.setting))
            .collect();
        let (manifest, set) = (&self.args.manifest, self.overrides(&set));
        let given = load::Given { set: &set, allow: &self.args.allow };
        let calibrator = self.execution.calibrator();
        match load::resolved(manifest, given, calibrator, self.terminal)? {
            Err(faults) => Ok(Found::refused_by(&faults)),
            Ok((loaded, _)) => {
                let (verdicts, records) = self.verdicts(loaded.experiment)?;
                Ok(Found::judged(&verdicts, records))
            }
        }
    }
}

/// Refuses no draw at all, and more than a table may have.
fn check_draws(draws: usize, choices: usize, claims: usize) -> Result<(), Failure> {
    if draws == 0 {
        return Err(Failure::not_understood("`--joint` must be at least 1, found 0"));
    }
    let most = MOST_CELLS / (choices * claims).max(1);
    if draws >= most {
        return Err(Failure::not_understood(format!(
            "`--joint` must be less than {most} for {} and {}, found {draws}",
            counted(choices, "choice"),
            counted(claims, "claim")
        )));
    }
    Ok(())
}

/// Writes for programs how many draws give a claim each verdict, and which choice explains most.
fn told(claim: &Explained, settings: &[String]) -> Value {
    let most = claim.most();
    json!({
        "claim": claim.claim,
        "as_chosen": claim.chosen.to_string(),
        "supported": claim.count(Judgement::Supported),
        "contradicted": claim.count(Judgement::Contradicted),
        "inconclusive": claim.count(Judgement::Inconclusive),
        "cannot_be_tested": claim.count(Judgement::CannotBeTested),
        "support_share_low": claim.support.map(|interval| interval.low),
        "support_share_high": claim.support.map(|interval| interval.high),
        "most_by": most.and_then(|(place, _)| settings.get(place)),
        "most_share": most.map(|(_, share)| share),
    })
}

/// Writes what was drawn, and for every claim how many draws support it and which choice explains most.
fn in_words(choices: &[Choice], found: &Multiverse) -> String {
    let mut text = "Choices, all drawn at once\n".to_owned();
    for choice in choices {
        text.push_str(&format!("  {}: {}\n", choice.setting, choice.domain));
    }
    let refused: Vec<_> = found.refused().collect();
    if !refused.is_empty() {
        text.push_str("\nRefused by the manifest's own checks, and counted for nothing\n");
        for (draw, reason) in refused {
            text.push_str(&format!("  {draw}: {reason}\n"));
        }
    }
    let claims = found.explanation().claims;
    let id = claims.iter().map(|claim| claim.claim.chars().count()).max().unwrap_or(0).max(5);
    text.push_str("\nDraws that support each claim (95 % interval)\n");
    text.push_str(&format!(
        "  {:id$}  {:16}  {:24}  contradict  neither\n",
        "claim", "as chosen", "support"
    ));
    for claim in &claims {
        let neither = claim.count(Judgement::Inconclusive) + claim.count(Judgement::CannotBeTested);
        text.push_str(&format!(
            "  {:id$}  {:16}  {:24}  {:<10}  {neither}\n",
            claim.claim,
            claim.chosen.to_string(),
            claim.support_in_words(),
            claim.count(Judgement::Contradicted),
        ));
        let words = claim.most_in_words(&found.settings);
        text.push_str(&format!("  {:id$}  {words}\n", ""));
    }
    text.push('\n');
    text
}
