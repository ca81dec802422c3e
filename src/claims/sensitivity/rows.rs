//! The rows of the table, and what they say of attempts, runs and claims.

use crate::claims::verdict::{ClaimVerdict, Judgement};
use crate::digest::Sha256Digest;

/// One claim under one other value of one setting.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Row {
    pub(super) setting: String,
    pub(super) chosen: String,
    pub(super) tried: String,
    pub(super) trials: u32,
    pub(super) claim: String,
    pub(super) at_chosen: Judgement,
    pub(super) at_tried: Judgement,
    pub(super) records_at_chosen: Option<Sha256Digest>,
    pub(super) records_at_tried: Option<Sha256Digest>,
}

/// A run of the whole study that the table rests on: at the values that the manifest chose, or with one setting moved.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// The setting and its other value, as [`super::in_words`]; `None` for the run at the chosen values.
    pub moved: Option<(String, String)>,
    /// Trials per condition.
    pub trials: u32,
    /// What each claim's verdict was.
    pub verdicts: Vec<(String, Judgement)>,
    /// Of the records of all its trials, in plan order; the first tables did not say it.
    pub records: Option<Sha256Digest>,
}

impl std::fmt::Display for Run {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match &self.moved {
            Some((setting, tried)) => write!(f, "with {setting} at {tried}"),
            None => f.write_str("at the values that the manifest chose"),
        }
    }
}

impl Run {
    /// Returns this run as `fresh` verdicts and records would have the table say it.
    #[must_use]
    pub fn with(&self, fresh: &[ClaimVerdict], records: Sha256Digest) -> Self {
        let verdicts = fresh.iter().map(|verdict| (verdict.id.clone(), verdict.judgement));
        Self { verdicts: verdicts.collect(), records: Some(records), ..self.clone() }
    }

    /// Finds the first difference from what the same run gave elsewhere: what it gave there, and what this says.
    pub fn difference(&self, fresh: &Self) -> Option<(String, String)> {
        for (claim, judgement) in &self.verdicts {
            let again = fresh.verdicts.iter().find(|(id, _)| id == claim).map(|(_, j)| *j);
            if again != Some(*judgement) {
                let again = again.map_or("no verdict".to_owned(), |j| j.to_string());
                return Some((format!("{again} for the claim {claim}"), judgement.to_string()));
            }
        }
        let (fresh, said) = (fresh.records?, self.records?);
        (fresh != said).then(|| (format!("records sha256:{fresh}"), format!("sha256:{said}")))
    }

    /// Returns what `run --set` needs to do it again; `value_of` gives a setting's value as YAML by its path and its words.
    pub fn overrides(&self, value_of: &dyn Fn(&str, &str) -> String) -> Vec<String> {
        let trials = format!("trials={}", self.trials);
        let mut set = vec!["sensitivity=null".to_owned(), "multiverse=null".to_owned(), trials];
        if let Some((setting, tried)) = &self.moved {
            set.push(format!("{setting}={}", value_of(setting, tried)));
        }
        set
    }
}

/// The verdicts under every value that was tried, setting by setting.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sensitivity {
    pub(super) rows: Vec<Row>,
}

/// One setting at the value that a manifest chose, and another that it was tried at.
#[derive(Debug, Clone, PartialEq)]
pub struct Attempt {
    /// Path of the setting in the manifest: `parameters.mapping.hit-ratio`.
    pub setting: String,
    /// The value that the manifest chose, as [`super::in_words`].
    pub chosen: String,
    /// The other value, as [`super::in_words`].
    pub tried: String,
    /// Trials per condition of both.
    pub trials: u32,
}

/// A verdict that is another one where a setting is moved.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Flip {
    /// Id of the claim.
    pub claim: String,
    /// The verdict at the value that the manifest chose.
    pub from: Judgement,
    /// The verdict at the value tried.
    pub to: Judgement,
}

impl Sensitivity {
    /// Adds what was found at one attempt: verdicts and records at the chosen value and at the one tried, claim by claim.
    pub fn push(
        &mut self,
        attempt: &Attempt,
        (at_chosen, records_at_chosen): (&[ClaimVerdict], Sha256Digest),
        (at_tried, records_at_tried): (&[ClaimVerdict], Sha256Digest),
    ) {
        for before in at_chosen {
            if let Some(after) = at_tried.iter().find(|after| after.id == before.id) {
                self.rows.push(Row {
                    setting: attempt.setting.clone(),
                    chosen: attempt.chosen.clone(),
                    tried: attempt.tried.clone(),
                    trials: attempt.trials,
                    claim: before.id.clone(),
                    at_chosen: before.judgement,
                    at_tried: after.judgement,
                    records_at_chosen: Some(records_at_chosen),
                    records_at_tried: Some(records_at_tried),
                });
            }
        }
    }

    /// Returns everything that was tried, in the order of the table.
    pub fn attempts(&self) -> Vec<Attempt> {
        let mut attempts: Vec<Attempt> = Vec::new();
        for row in &self.rows {
            let attempt = Attempt {
                setting: row.setting.clone(),
                chosen: row.chosen.clone(),
                tried: row.tried.clone(),
                trials: row.trials,
            };
            if !attempts.contains(&attempt) {
                attempts.push(attempt);
            }
        }
        attempts
    }

    /// Returns the runs that it rests on: the one at the chosen values first, then every attempt in the order of the table.
    pub fn runs(&self) -> Vec<Run> {
        let mut runs: Vec<Run> = Vec::new();
        let mut add = |moved: Option<(String, String)>, row: &Row, judgement, records| {
            let known = runs.iter_mut().find(|run| run.moved == moved && run.trials == row.trials);
            let verdict = (row.claim.clone(), judgement);
            match known {
                Some(run) if run.verdicts.contains(&verdict) => {}
                Some(run) => run.verdicts.push(verdict),
                None => {
                    runs.push(Run { moved, trials: row.trials, verdicts: vec![verdict], records });
                }
            }
        };
        for row in &self.rows {
            add(None, row, row.at_chosen, row.records_at_chosen);
            let moved = (row.setting.clone(), row.tried.clone());
            add(Some(moved), row, row.at_tried, row.records_at_tried);
        }
        runs.sort_by_key(|run| run.moved.is_some());
        runs
    }

    /// Returns the verdicts that `attempt` changes.
    pub fn flips(&self, attempt: &Attempt) -> Vec<Flip> {
        let of_it = self.rows.iter().filter(|row| {
            row.setting == attempt.setting
                && row.chosen == attempt.chosen
                && row.tried == attempt.tried
        });
        of_it
            .filter(|row| row.at_chosen != row.at_tried)
            .map(|row| Flip { claim: row.claim.clone(), from: row.at_chosen, to: row.at_tried })
            .collect()
    }

    /// Returns the ids of the claims that were judged.
    pub fn claims(&self) -> Vec<&str> {
        let mut claims: Vec<&str> = Vec::new();
        for row in &self.rows {
            if !claims.contains(&row.claim.as_str()) {
                claims.push(&row.claim);
            }
        }
        claims
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claims::sensitivity::table::tests::text;

    #[test]
    fn a_table_of_verdicts_survives_a_round_trip_and_tells_what_flips() {
        let read = Sensitivity::from_csv(&text()).unwrap();
        assert_eq!(read.to_csv(), text());
        assert_eq!(read.claims(), ["D1", "D2"]);
        let attempts = read.attempts();
        assert_eq!(attempts.len(), 2);
        let flip = |claim: &str, from, to| Flip { claim: claim.to_owned(), from, to };
        let (inconclusive, contradicted) = (Judgement::Inconclusive, Judgement::Contradicted);
        assert_eq!(read.flips(&attempts[0]), [flip("D2", inconclusive, contradicted)]);
        assert_eq!(read.flips(&attempts[1]), [flip("D1", Judgement::Supported, inconclusive)]);
    }

    #[test]
    fn the_runs_behind_a_table_are_told_once_each() {
        let read = Sensitivity::from_csv(&text()).unwrap();
        let runs = read.runs();
        let told: Vec<String> = runs.iter().map(ToString::to_string).collect();
        let expected = [
            "at the values that the manifest chose",
            "with parameters.pilot.stop-m at 0.1",
            "with parameters.sensing.drive-noise at gaussian",
        ];
        assert_eq!(told, expected);
        assert_eq!(runs[0].verdicts.len(), 2);
        let words = |path: &str, tried: &str| format!("<{path} {tried}>");
        assert_eq!(
            runs[2].overrides(&words),
            [
                "sensitivity=null",
                "multiverse=null",
                "trials=15",
                "parameters.sensing.drive-noise=<parameters.sensing.drive-noise gaussian>"
            ]
        );
        assert_eq!(runs[1].difference(&runs[1].clone()), None);
        let mut other = runs[1].clone();
        other.records = Some(Sha256Digest::of("other"));
        let (expected, found) = runs[1].difference(&other).unwrap();
        assert!(expected.starts_with("records sha256:") && found.starts_with("sha256:b0"));
        other.verdicts[1].1 = Judgement::Supported;
        let told = runs[1].difference(&other).unwrap();
        assert_eq!(told, ("supported for the claim D2".to_owned(), "contradicted".to_owned()));
    }
}
