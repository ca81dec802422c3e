//! What a bundle found, in a sentence or two: the first thing that its page says.

use super::ReportContent;
use super::page::apart;
use crate::bundle::{self, Found};
use crate::stats::compatibility::Agreement;

/// Returns the finding of `content`: its tables' answers, what became of the paper's claims, and how its printed numbers compare.
pub fn finding(content: &ReportContent) -> String {
    let (claims, _) = apart(&content.claims);
    let verdicts: Vec<String> = claims.iter().map(|claim| claim.verdict.clone()).collect();
    let rows = content.tables.iter().flat_map(|table| &table.rows);
    let cells: Vec<Agreement> =
        rows.flat_map(|row| &row.cells).map(|cell| cell.agreement).collect();
    bundle::finding(Found {
        answer: content.answers.first().map(|found| found.answer.as_str()),
        verdicts: &verdicts,
        cells: &cells,
        partial: content.partial.as_deref(),
        trials: content.headline.trials,
        conditions: content.headline.conditions,
    })
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
