//! How near the means and shares of a fresh run lie to the sealed ones.
//!
//! Two honest runs differ by chance. For every condition, each measure's mean and each outcome's share are compared: the
//! interval of the difference at 95 % (Welch's for means, Newcombe's score interval for shares) leaves zero out in about one
//! of twenty where nothing but chance is at work. The comparisons of one run are not independent, so the count is told and
//! judged by the reader.

use crate::stats::means::welch;
use crate::stats::proportion::{Proportion, newcombe};
use crate::stats::summary::Summary;
use crate::table::{Table, Value};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

const CONFIDENCE: f64 = 0.95;

/// How many of those that lie outside are told in words.
const TOLD: usize = 5;

/// All comparisons of two runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub struct Closeness {
    /// Means and shares that could be compared.
    pub compared: usize,
    /// Those whose difference chance explains.
    pub within: usize,
    /// The others.
    pub outside: Vec<Apart>,
}

/// A mean or share that lies further from the sealed one than chance explains.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub struct Apart {
    /// The values of the factors.
    pub condition: String,
    /// The measure, or `outcome` and its name.
    pub of: String,
    /// In the bundle.
    pub sealed: f64,
    /// In the fresh run.
    pub fresh: f64,
    /// Lower limit of fresh less sealed.
    pub low: f64,
    /// Upper limit.
    pub high: f64,
}

impl Closeness {
    /// Says in one line what the comparison means.
    pub fn in_words(&self) -> String {
        let mut text = format!(
            "{} of {} means and shares lie where chance explains their difference from the sealed ones (it leaves out about 1 \
             in 20)",
            self.within, self.compared
        );
        for (i, apart) in self.outside.iter().take(TOLD).enumerate() {
            let before = if i == 0 { "; outside are " } else { ", " };
            let Apart { condition, of, sealed, fresh, .. } = apart;
            text.push_str(&format!("{before}{condition} {of} ({sealed:.3}, now {fresh:.3})"));
        }
        if self.outside.len() > TOLD {
            text.push_str(&format!(" and {} more", self.outside.len() - TOLD));
        }
        text
    }
}

/// Compares two `trials.csv`.
pub(super) fn of(sealed: &str, fresh: &str) -> Closeness {
    let (Ok(sealed), Ok(fresh)) = (Table::from_csv(sealed), Table::from_csv(fresh)) else {
        return Closeness { compared: 0, within: 0, outside: Vec::new() };
    };
    // Of both runs: an outcome that one of them never had is the most telling.
    let outcomes: BTreeSet<String> = [&sealed, &fresh]
        .into_iter()
        .filter_map(|table| Some((table, table.column("outcome")?)))
        .flat_map(|(table, column)| table.rows.iter().map(move |row| row[column].to_string()))
        .collect();
    let (sealed, fresh) = (Cells::of(&sealed, &outcomes), Cells::of(&fresh, &outcomes));
    let mut found = Closeness { compared: 0, within: 0, outside: Vec::new() };
    for (condition, of) in &sealed.order {
        let key = (condition.clone(), of.clone());
        let (Some(a), Some(b)) = (sealed.values.get(&key), fresh.values.get(&key)) else {
            continue;
        };
        // Fewer than two values have no spread to compare by.
        let (Some((x, y, low, high)), true) = (compare(a, b), a.len() > 1 && b.len() > 1) else {
            continue;
        };
        found.compared += 1;
        if low <= 0.0 && 0.0 <= high {
            found.within += 1;
        } else {
            let (condition, of) = key;
            found.outside.push(Apart { condition, of, sealed: x, fresh: y, low, high });
        }
    }
    found
}

/// Returns sealed and fresh mean or share, and the limits of fresh less sealed.
fn compare(sealed: &Values, fresh: &Values) -> Option<(f64, f64, f64, f64)> {
    match (sealed, fresh) {
        (Values::Measured(sealed), Values::Measured(fresh)) => {
            let (a, b) = (Summary::of(sealed), Summary::of(fresh));
            let interval = welch(b, a).interval(CONFIDENCE);
            Some((a.mean, b.mean, interval.low, interval.high))
        }
        (Values::Counted(sealed), Values::Counted(fresh)) => {
            let interval = newcombe(*fresh, *sealed, CONFIDENCE);
            Some((sealed.share(), fresh.share(), interval.low, interval.high))
        }
        _ => None,
    }
}

enum Values {
    /// What the trials that reached a measure had of it.
    Measured(Vec<f64>),
    /// How many trials ended in an outcome.
    Counted(Proportion),
}

impl Values {
    fn len(&self) -> usize {
        match self {
            Self::Measured(values) => values.len(),
            Self::Counted(share) => usize::try_from(share.trials).unwrap_or(usize::MAX),
        }
    }
}

/// Values by condition and measure or outcome, and the order in which the table has them.
#[derive(Default)]
struct Cells {
    order: Vec<(String, String)>,
    values: BTreeMap<(String, String), Values>,
}

impl Cells {
    /// Collects the values of a table whose columns are `key`, the factors, `trial`, `outcome`, then measures, as
    /// `docs/bundle-format.md` says.
    fn of(trials: &Table, outcomes: &BTreeSet<String>) -> Self {
        let mut cells = Self::default();
        let (Some(trial), Some(outcome)) = (trials.column("trial"), trials.column("outcome"))
        else {
            return cells;
        };
        let first = trials.column("key").map_or(0, |key| key + 1).min(trial);
        let condition = |row: &[Value]| {
            let levels: Vec<String> =
                (first..trial).map(|i| format!("{}={}", trials.columns[i], row[i])).collect();
            if levels.is_empty() { "all".to_owned() } else { levels.join(" ") }
        };
        let mut conditions: Vec<(String, Vec<&Vec<Value>>)> = Vec::new();
        for row in &trials.rows {
            let name = condition(row);
            match conditions.iter_mut().find(|(known, _)| *known == name) {
                Some((_, rows)) => rows.push(row),
                None => conditions.push((name, vec![row])),
            }
        }
        for (name, rows) in conditions {
            let all = rows.len() as u64;
            for ending in outcomes {
                let count = rows.iter().filter(|row| row[outcome].to_string() == *ending).count();
                let share = Proportion::new(count as u64, all);
                cells.enter(&name, format!("outcome {ending}"), Values::Counted(share));
            }
            for (i, measure) in trials.columns.iter().enumerate().skip(outcome + 1) {
                let values = rows.iter().filter_map(|row| row[i].as_f64()).collect();
                cells.enter(&name, measure.clone(), Values::Measured(values));
            }
        }
        cells
    }

    fn enter(&mut self, condition: &str, of: String, values: Values) {
        let key = (condition.to_owned(), of);
        self.order.push(key.clone());
        self.values.insert(key, values);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn csv(rows: &[(&str, &str, &str)]) -> String {
        let rows = rows.iter().enumerate().map(|(i, (prior, outcome, distance))| {
            format!("{i:064},{prior},{i},{outcome},{distance}\n")
        });
        format!("key,prior,trial,outcome,distance-m\n{}", rows.collect::<String>())
    }

    #[test]
    fn means_and_shares_are_told_where_chance_does_not_explain_them() {
        let many = |distances: [&'static str; 4], outcome: &'static str| {
            let rows = |prior: &'static str| distances.map(|distance| (prior, outcome, distance));
            csv(&[rows("none"), rows("map")].concat())
        };
        let sealed = many(["10", "11", "12", "13"], "explored");
        let same = of(&sealed, &many(["11", "12", "12", "10"], "explored"));
        assert_eq!((same.compared, same.within), (4, 4), "{same:?}");
        let other = of(&sealed, &many(["20", "21", "22", ""], "explored"));
        assert_eq!((other.compared, other.within), (4, 2));
        let apart = &other.outside[0];
        assert_eq!((apart.condition.as_str(), apart.of.as_str()), ("prior=none", "distance-m"));
        assert_eq!((apart.sealed, apart.fresh), (11.5, 21.0));
        // By hand: 9.5 -+ t(0.975, 4.959) * 0.8660, with t = 2.577.
        assert!(
            (apart.low - 7.268).abs() < 2e-3 && (apart.high - 11.732).abs() < 2e-3,
            "{apart:?}"
        );
        assert_eq!(
            other.in_words(),
            "2 of 4 means and shares lie where chance explains their difference from the sealed ones (it leaves out about 1 in \
             20); outside are prior=none distance-m (11.500, now 21.000), prior=map distance-m (11.500, now 21.000)"
        );
    }

    #[test]
    fn outcomes_are_compared_by_their_shares_and_single_values_not_at_all() {
        let rows = |explored: usize| {
            let rows: Vec<_> = (0..40)
                .map(|i| ("none", if i < explored { "explored" } else { "stuck" }, ""))
                .collect();
            csv(&rows)
        };
        let found = of(&rows(36), &rows(10));
        assert_eq!((found.compared, found.within), (2, 0), "{found:?}");
        let never = of(&rows(40), &rows(20));
        assert_eq!((never.compared, never.outside[1].of.as_str()), (2, "outcome stuck"));
        assert_eq!(found.outside[0].of, "outcome explored");
        assert_eq!((found.outside[0].sealed, found.outside[0].fresh), (0.9, 0.25));
        let one = csv(&[("none", "explored", "1")]);
        assert_eq!(of(&one, &one).compared, 0);
        assert_eq!(of("", "").compared, 0);
    }
}
