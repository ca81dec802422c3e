//! The table as CSV: written by `reenact vary`, read from beside a manifest.

use super::rows::{Row, Sensitivity};
use crate::claims::verdict::Judgement;
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

/// Why a text is no table of sensitivity.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct SensitivityError(String);

impl Sensitivity {
    /// Writes one row per setting, value tried and claim.
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
    /// Where the text is no CSV, lacks a column, or a field holds what is never written there.
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

    /// Finds the first row that says something else of a run than an earlier one, in words.
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
pub(super) mod tests {
    use super::*;

    /// Returns a table of three rows, with digests that begin with `a` for the chosen values.
    pub(in crate::claims) fn text() -> String {
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

    /// Checks that what was judged before digests were written down can still be judged again.
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
