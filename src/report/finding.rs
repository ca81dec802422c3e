//! What a bundle found, in a sentence or two: the first thing that its page says.

use super::ReportContent;
use super::page::apart;
use crate::stats::compatibility::{Agreement, Tally};

/// Returns the finding of `content`: its tables' answers, what became of the paper's claims, and how its printed numbers compare.
pub(super) fn finding(content: &ReportContent) -> String {
    // The page has the rest of the answer a little further down.
    let first = content.answers.first().map(|found| match found.answer.split_once(". ") {
        Some((sentence, _)) => format!("{sentence}."),
        None => found.answer.clone(),
    });
    let mut sentences: Vec<String> = first.into_iter().collect();
    let (claims, _) = apart(&content.claims);
    let count = |verdict: &str| claims.iter().filter(|claim| claim.verdict == verdict).count();
    let mut parts = Vec::new();
    if !claims.is_empty() {
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
        let whose = match claims.len() {
            1 => "Of the paper's one claim".to_owned(),
            n => format!("Of the paper's {n} claims"),
        };
        parts.push(format!("{whose}, {}", joined(&told)));
    }
    let cells: Vec<Agreement> = content
        .tables
        .iter()
        .flat_map(|t| &t.rows)
        .flat_map(|r| &r.cells)
        .map(|c| c.agreement)
        .collect();
    if let Some(tally) =
        Tally::of(&cells).into_iter().max_by_key(|tally| tally.good + tally.fair + tally.bad)
    {
        parts.push(tally.in_words());
    }
    if let Some(partial) = &content.partial {
        parts.insert(0, format!("A part of the study was run ({})", partial.trim_end_matches('.')));
    }
    if parts.is_empty() {
        let (trials, conditions) = (content.headline.trials, content.headline.conditions);
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

#[cfg(test)]
mod tests {
    use super::super::fixtures::content;
    use super::*;

    #[test]
    fn answers_come_first_then_claims_and_cells() {
        let mut content = content();
        content.partial = None;
        content.answers[0].answer.push_str(" It is also the slowest.");
        assert_eq!(
            finding(&content),
            "The third, in 59 % of its trials. Of the paper's 2 claims, 1 holds here and 1 does not; 12 of 15 published means are \
             compatible with ours at 95 %."
        );
        content.answers.clear();
        content.claims.clear();
        content.partial =
            Some("3 trials per condition instead of 10; no claim is judged.".to_owned());
        assert_eq!(
            finding(&content),
            "A part of the study was run (3 trials per condition instead of 10; no claim is judged); 12 of 15 published means \
             are compatible with ours at 95 %."
        );
        let nothing = ReportContent { headline: content.headline, ..ReportContent::default() };
        assert_eq!(
            finding(&nothing),
            "40 trials in 4 conditions were run; no claim is made of them."
        );
    }
}
