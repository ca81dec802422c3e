//! Which verdicts hang on what the paper leaves open: every claim judged again with one setting at a time moved to
//! the other values that its manifest states, on the same trial numbers and the same noise.

use super::verdict::{Judgement, Verdict};
use crate::digest::Sha256Digest;
use crate::table::{Table, Value};
use std::collections::BTreeMap;

const COLUMNS: [&str; 9] = [
    "setting",
    "chosen",
    "tried",
    "trials",
    "claim",
    "at-chosen",
    "at-tried",
    "records-at-chosen",
    "records-at-tried",
];

/// One claim under one other value of one setting.
#[derive(Debug, Clone, PartialEq)]
struct Row {
    setting: String,
    chosen: String,
    tried: String,
    trials: u32,
    claim: String,
    at_chosen: Judgement,
    at_tried: Judgement,
    records_at_chosen: Option<Sha256Digest>,
    records_at_tried: Option<Sha256Digest>,
}

/// A run of the whole study that the table rests on: at the values that the manifest chose, or with one setting moved.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// The setting and its other value, as [`in_words`]; `None` for the run at the chosen values.
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
    /// What `fresh` verdicts and records would have the table say of this run.
    #[must_use]
    pub fn with(&self, fresh: &[Verdict], records: Sha256Digest) -> Self {
        let verdicts = fresh.iter().map(|verdict| (verdict.id.clone(), verdict.judgement));
        Self { verdicts: verdicts.collect(), records: Some(records), ..self.clone() }
    }

    /// The first difference from what the same run gave elsewhere: what it gave there, and what this says.
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

    /// What `run --set` needs to do it again; `value_of` gives a setting's value as YAML by its path and its words.
    pub fn overrides(&self, value_of: &dyn Fn(&str, &str) -> String) -> Vec<String> {
        let mut set = vec!["sensitivity=null".to_owned(), format!("trials={}", self.trials)];
        if let Some((setting, tried)) = &self.moved {
            set.push(format!("{setting}={}", value_of(setting, tried)));
        }
        set
    }
}

/// The verdicts under every value that was tried, setting by setting.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sensitivity {
    rows: Vec<Row>,
}

/// One setting at the value that a manifest chose, and another that it was tried at.
#[derive(Debug, Clone, PartialEq)]
pub struct Attempt {
    /// Path of the setting in the manifest: `parameters.mapping.hit-ratio`.
    pub setting: String,
    /// The value that the manifest chose, as [`in_words`].
    pub chosen: String,
    /// The other value, as [`in_words`].
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

/// Why a text is no table of sensitivity.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct SensitivityError(String);

/// A setting's value as tables and pages write it: numbers shortest, texts without quotes.
pub fn in_words(value: &serde_json::Value) -> String {
    match (value.as_f64(), value.as_str()) {
        (Some(number), _) => Value::from(number).to_string(),
        (None, Some(text)) => text.to_owned(),
        (None, None) => value.to_string(),
    }
}

impl Sensitivity {
    /// Adds what was found at one attempt: verdicts and records at the chosen value and at the one tried, claim by claim.
    pub fn push(
        &mut self,
        attempt: &Attempt,
        (at_chosen, records_at_chosen): (&[Verdict], Sha256Digest),
        (at_tried, records_at_tried): (&[Verdict], Sha256Digest),
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

    /// Everything that was tried, in the order of the table.
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

    /// The runs that it rests on: the one at the chosen values first, then every attempt in the order of the table.
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

    /// The verdicts that `attempt` changes.
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

    /// Ids of the claims that were judged.
    pub fn claims(&self) -> Vec<&str> {
        let mut claims: Vec<&str> = Vec::new();
        for row in &self.rows {
            if !claims.contains(&row.claim.as_str()) {
                claims.push(&row.claim);
            }
        }
        claims
    }

    /// One row per setting, value tried and claim.
    pub fn to_csv(&self) -> String {
        let mut table = Table::new(COLUMNS);
        for row in &self.rows {
            table.push(vec![
                row.setting.as_str().into(),
                row.chosen.as_str().into(),
                row.tried.as_str().into(),
                i64::from(row.trials).into(),
                row.claim.as_str().into(),
                row.at_chosen.to_string().into(),
                row.at_tried.to_string().into(),
                row.records_at_chosen.map(|digest| digest.hex()).into(),
                row.records_at_tried.map(|digest| digest.hex()).into(),
            ]);
        }
        table.to_csv()
    }

    /// Reads what [`Self::to_csv`] writes.
    ///
    /// # Errors
    /// Where the text is no CSV, lacks a column, or a field is none of those that are written.
    pub fn from_csv(text: &str) -> Result<Self, SensitivityError> {
        let table = Table::from_csv(text).map_err(|e| SensitivityError(e.to_string()))?;
        // The first tables held no digests of runs.
        let without_digests = table.columns == COLUMNS[..7];
        if table.columns != COLUMNS && !without_digests {
            // Nothing is quoted of a file of another kind: it may have been named by a slip.
            let is_ours = table.columns.iter().any(|column| COLUMNS.contains(&column.as_str()));
            let found = if is_ours { table.columns.join(", ") } else { "none of them".to_owned() };
            return Err(SensitivityError(format!(
                "expected the columns {}, found {found}; `reenact vary` writes them",
                COLUMNS.join(", ")
            )));
        }
        let read = |(i, fields): (usize, &Vec<Value>)| {
            let text = |column: usize| fields[column].to_string();
            let fault = |column: usize, expected: &str| {
                let (row, name, found) = (i + 1, COLUMNS[column], text(column));
                SensitivityError(format!(
                    "row {row}: expected {expected} as {name}, found `{found}`"
                ))
            };
            let verdict = |column: usize| {
                let found = Judgement::ALL.into_iter().find(|j| j.to_string() == text(column));
                found.ok_or_else(|| fault(column, "a verdict"))
            };
            let trials = text(3).parse().map_err(|_| fault(3, "a number of trials"))?;
            let (at_chosen, at_tried) = (verdict(5)?, verdict(6)?);
            let (setting, chosen, tried, claim) = (text(0), text(1), text(2), text(4));
            let digest = |column: usize| {
                if without_digests || fields[column] == Value::Missing {
                    return Ok(None);
                }
                let found = Sha256Digest::from_hex(&text(column));
                found.map(Some).ok_or_else(|| fault(column, "64 hex digits"))
            };
            Ok(Row {
                setting,
                chosen,
                tried,
                trials,
                claim,
                at_chosen,
                at_tried,
                records_at_chosen: digest(7)?,
                records_at_tried: digest(8)?,
            })
        };
        let rows: Result<_, _> = table.rows.iter().enumerate().map(read).collect();
        let read = Self { rows: rows? };
        match read.contradiction() {
            Some(problem) => Err(SensitivityError(problem)),
            None => Ok(read),
        }
    }

    /// The first row that says something else of a run than an earlier one, in words.
    fn contradiction(&self) -> Option<String> {
        let (mut records, mut verdicts) = (BTreeMap::new(), BTreeMap::new());
        for (i, row) in self.rows.iter().enumerate() {
            let tried = (Some((row.setting.as_str(), row.tried.as_str())), row.trials);
            for (run, found, judgement) in [
                ((None, row.trials), row.records_at_chosen, row.at_chosen),
                (tried, row.records_at_tried, row.at_tried),
            ] {
                let known = *records.entry(run).or_insert(found);
                let before = *verdicts.entry((run, row.claim.as_str())).or_insert(judgement);
                if known != found || before != judgement {
                    let (row, claim) = (i + 1, &row.claim);
                    let by = |digest: Option<Sha256Digest>| {
                        digest.map_or("none".to_owned(), |d| d.short())
                    };
                    return Some(format!(
                        "row {row}: says {judgement} of {claim} by records {}, where an earlier row says {before} by {} of \
                         the same run",
                        by(found),
                        by(known)
                    ));
                }
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A table of three rows, with digests that begin with `a` for the chosen values.
    fn text() -> String {
        let digest = |first: &str| format!("{first}{}", "0".repeat(63));
        let row = |what: &str, tried: &str| format!("{what},{},{}\n", digest("a"), digest(tried));
        [
            COLUMNS.join(",") + "\n",
            row("parameters.pilot.stop-m,0.05,0.1,15,D1,supported,supported", "b"),
            row("parameters.pilot.stop-m,0.05,0.1,15,D2,inconclusive,contradicted", "b"),
            row(
                "parameters.sensing.drive-noise,uniform,gaussian,15,D1,supported,inconclusive",
                "c",
            ),
        ]
        .concat()
    }

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
    fn numbers_are_the_same_words_however_they_are_written() {
        let words = |text: &str| in_words(&serde_json::from_str(text).unwrap());
        assert_eq!(
            ["1.0", "1", "0.25", "\"tag\"", "true"].map(words),
            ["1", "1", "0.25", "tag", "true"]
        );
    }

    #[test]
    fn other_tables_are_refused_in_words() {
        let told = |text: &str| Sensitivity::from_csv(text).unwrap_err().to_string();
        assert_eq!(
            told("setting,value\n"),
            "expected the columns setting, chosen, tried, trials, claim, at-chosen, at-tried, records-at-chosen, \
             records-at-tried, found setting, value; `reenact vary` writes them"
        );
        assert_eq!(
            told("root:x:0:0\n"),
            "expected the columns setting, chosen, tried, trials, claim, at-chosen, at-tried, records-at-chosen, \
             records-at-tried, found none of them; `reenact vary` writes them"
        );
        assert_eq!(
            told(&text().replace("inconclusive,contradicted", "inconclusive,wrong")),
            "row 2: expected a verdict as at-tried, found `wrong`"
        );
        assert_eq!(
            told(&text().replace("gaussian,15", "gaussian,many")),
            "row 3: expected a number of trials as trials, found `many`"
        );
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

    #[test]
    fn rows_that_contradict_one_another_are_refused() {
        let told = |text: &str| Sensitivity::from_csv(text).unwrap_err().to_string();
        assert_eq!(
            told(
                &text().replace("15,D1,supported,inconclusive", "15,D1,contradicted,inconclusive")
            ),
            "row 3: says contradicted of D1 by records a0000000, where an earlier row says supported by a0000000 of the same \
             run"
        );
        assert_eq!(
            told(&text().replacen(",b0", ",d0", 1)),
            "row 2: says contradicted of D2 by records b0000000, where an earlier row says contradicted by d0000000 of the \
             same run"
        );
        let cut = text().replace(&format!("c{}", "0".repeat(63)), "c0");
        assert_eq!(told(&cut), "row 3: expected 64 hex digits as records-at-tried, found `c0`");
    }

    /// What was judged before digests were written down can still be judged again.
    #[test]
    fn tables_without_digests_are_read() {
        let seven = |line: &str| line.split(',').take(7).collect::<Vec<_>>().join(",") + "\n";
        let old: String = text().lines().map(seven).collect();
        let read = Sensitivity::from_csv(&old).unwrap();
        assert!(read.runs().iter().all(|run| run.records.is_none()));
        assert!(read.to_csv().lines().nth(1).unwrap().ends_with(",supported,supported,,"));
        assert_eq!(Sensitivity::from_csv(&read.to_csv()).unwrap(), read);
        let mut other = read.runs()[0].clone();
        other.verdicts[0].1 = Judgement::Contradicted;
        assert!(read.runs()[0].difference(&other).is_some());
    }
}
