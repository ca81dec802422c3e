//! What was found, in a sentence or two: the first thing that a bundle and its page say.

use crate::stats::compatibility::{Agreement, Tally};

/// What a finding is told from.
#[derive(Debug, Clone, Copy, Default)]
pub struct Found<'a> {
    /// What the tables answer, the first of which is told.
    pub answer: Option<&'a str>,
    /// The verdicts on the paper's claims, by name.
    pub verdicts: &'a [String],
    /// How the cells of all tables agree with what is printed.
    pub cells: &'a [Agreement],
    /// Which side of what the study compares came out ahead, as [`crate::claims::compared`] says it.
    pub compared: Option<&'a str>,
    /// Why only a part of the study was run; `None` for a whole run.
    pub partial: Option<&'a str>,
    /// Trials that were run.
    pub trials: u64,
    /// Conditions that they are of.
    pub conditions: u64,
}

/// Tells the first answer, how many of the paper's claims hold, how its printed numbers compare, and which side came out ahead.
pub fn finding(found: Found<'_>) -> String {
    // The rest of the answer stands with its table.
    let first = found.answer.map(|answer| match answer.split_once(". ") {
        Some((sentence, _)) => format!("{sentence}."),
        None => answer.to_owned(),
    });
    let mut sentences: Vec<String> = first.into_iter().collect();
    let count = |verdict: &str| found.verdicts.iter().filter(|one| *one == verdict).count();
    let mut parts = Vec::new();
    if !found.verdicts.is_empty() {
        let told = [
            ("supported", "holds here", "hold here"),
            ("contradicted", "does not", "do not"),
            ("inconclusive", "stays open", "stay open"),
            ("cannot-be-tested", "cannot be tested", "cannot be tested"),
        ];
        let told: Vec<String> = told
            .into_iter()
            .filter_map(|(verdict, one, many)| match count(verdict) {
                0 => None,
                1 => Some(format!("1 {one}")),
                n => Some(format!("{n} {many}")),
            })
            .collect();
        let whose = match found.verdicts.len() {
            1 => "Of the paper's one claim".to_owned(),
            n => format!("Of the paper's {n} claims"),
        };
        parts.push(format!("{whose}, {}", joined(&told)));
    }
    let most = Tally::of(found.cells).into_iter().max_by_key(|t| t.good + t.fair + t.bad);
    if let Some(tally) = most {
        parts.push(tally.in_words());
    }
    parts.extend(found.compared.map(str::to_owned));
    if let Some(partial) = found.partial {
        parts.insert(0, format!("A part of the study was run ({})", partial.trim_end_matches('.')));
    }
    if parts.is_empty() {
        let Found { trials, conditions, .. } = found;
        parts.push(format!(
            "{trials} trials in {conditions} conditions were run; no claim is made of them"
        ));
    }
    sentences.push(parts.join("; ") + ".");
    sentences.join(" ")
}

/// Joins `parts` as one speaks: `a, b and c`.
fn joined(parts: &[String]) -> String {
    match parts {
        [] => String::new(),
        [one] => one.clone(),
        [all @ .., last] => format!("{} and {last}", all.join(", ")),
    }
}
