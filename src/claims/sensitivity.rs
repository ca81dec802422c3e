//! Which verdicts hang on what the paper leaves open: every claim judged again with one setting at a time moved to
//! the other values that its manifest states, on the same trial numbers and the same noise.

use super::{Judgement, Verdict};
use crate::table::{Table, Value};

const COLUMNS: [&str; 7] =
    ["setting", "chosen", "tried", "trials", "claim", "at-chosen", "at-tried"];

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
    /// Adds what was found at one attempt: the verdicts at the chosen value and at the one tried, claim by claim.
    pub fn push(&mut self, attempt: &Attempt, at_chosen: &[Verdict], at_tried: &[Verdict]) {
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
        if table.columns != COLUMNS {
            // Nothing is quoted of a file of another kind: it may have been named by a slip.
            let is_ours = table.columns.iter().any(|column| COLUMNS.contains(&column.as_str()));
            let found = if is_ours { table.columns.join(", ") } else { "none of them".to_owned() };
            let columns = COLUMNS.join(", ");
            return Err(SensitivityError(format!("expected the columns {columns}, found {found}")));
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
            Ok(Row { setting, chosen, tried, trials, claim, at_chosen, at_tried })
        };
        let rows: Result<_, _> = table.rows.iter().enumerate().map(read).collect();
        Ok(Self { rows: rows? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "setting,chosen,tried,trials,claim,at-chosen,at-tried\n\
        parameters.pilot.stop-m,0.05,0.1,15,D1,supported,supported\n\
        parameters.pilot.stop-m,0.05,0.1,15,D2,inconclusive,contradicted\n\
        parameters.sensing.drive-noise,uniform,gaussian,15,D1,supported,inconclusive\n";

    #[test]
    fn a_table_of_verdicts_survives_a_round_trip_and_tells_what_flips() {
        let read = Sensitivity::from_csv(TEXT).unwrap();
        assert_eq!(read.to_csv(), TEXT);
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
            "expected the columns setting, chosen, tried, trials, claim, at-chosen, at-tried, found setting, value"
        );
        assert_eq!(
            told("root:x:0:0\n"),
            "expected the columns setting, chosen, tried, trials, claim, at-chosen, at-tried, found none of them"
        );
        assert_eq!(
            told(&TEXT.replace("inconclusive,contradicted", "inconclusive,wrong")),
            "row 2: expected a verdict as at-tried, found `wrong`"
        );
        assert_eq!(
            told(&TEXT.replace("gaussian,15", "gaussian,many")),
            "row 3: expected a number of trials as trials, found `many`"
        );
    }
}
