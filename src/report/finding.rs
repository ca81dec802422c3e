//! What a bundle found, in a sentence or two: the first thing that its page says.

use super::ReportContent;
use super::page::apart;
use super::template::fixed;
use crate::bundle::{self, Found};
use crate::stats::compatibility::Agreement;
use crate::studies::GridCell;

/// Returns the finding of `content`: its tables' answers, what became of the paper's claims, and how its printed numbers compare.
pub fn finding(content: &ReportContent) -> String {
    let (claims, _) = apart(&content.claims);
    let verdicts: Vec<String> = claims.iter().map(|claim| claim.verdict.clone()).collect();
    let rows = content.tables.iter().flat_map(|table| &table.rows);
    let cells: Vec<Agreement> =
        rows.flat_map(|row| &row.cells).map(|cell| cell.agreement).collect();
    let compared = match content.compared.as_str() {
        "" if content.claims.is_empty() && content.partial.is_none() => against_baseline(content),
        "" => None,
        compared => Some(compared.to_owned()),
    };
    bundle::finding(Found {
        answer: content.answers.first().map(|found| found.answer.as_str()),
        verdicts: &verdicts,
        cells: &cells,
        compared: compared.as_deref(),
        partial: content.partial.as_deref(),
        trials: content.headline.trials,
        conditions: content.headline.conditions,
    })
}

/// Says what the first table with a baseline shows of each other column, ours beside the paper's: for studies that claim nothing.
fn against_baseline(content: &ReportContent) -> Option<String> {
    /// Columns that are told; more would be the table again.
    const MOST: usize = 2;
    let table = content.tables.iter().find(|table| {
        table.rows.iter().flat_map(|row| &row.cells).any(|cell| cell.difference_percent.is_some())
    })?;
    let column = |i: usize, of: fn(&GridCell) -> Option<f64>| -> Vec<f64> {
        table.rows.iter().filter_map(|row| of(row.cells.get(i)?)).collect()
    };
    let ours = |i| column(i, |cell| cell.difference_percent);
    let baseline = (0..table.columns.len()).find(|i| ours(*i).is_empty())?;
    let others = (0..table.columns.len()).filter(|i| !ours(*i).is_empty()).take(MOST);
    let told = others.map(|i| {
        let printed = column(i, |cell| cell.published_difference_percent);
        let beside = span(&printed).map(|span| format!(" (printed {span})")).unwrap_or_default();
        format!("{} with {}{beside}", span(&ours(i)).unwrap_or_default(), table.columns[i])
    });
    let told: Vec<String> = told.collect();
    Some(format!(
        "against {}, {} changes by {}",
        table.columns[baseline],
        table.quantity,
        told.join(" and by ")
    ))
}

/// Writes the least and the greatest of `percents`: `-62 to -15 %`; `None` where there are none.
fn span(percents: &[f64]) -> Option<String> {
    let least = percents.iter().copied().reduce(f64::min)?;
    let most = percents.iter().copied().reduce(f64::max)?;
    let signed = |x: f64| {
        let text = fixed(x, 0);
        if x >= 0.5 { format!("+{text}") } else { text }
    };
    let (least, most) = (signed(least), signed(most));
    Some(if least == most { format!("{least} %") } else { format!("{least} to {most} %") })
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
        content.partial = None;
        assert_eq!(
            finding(&content),
            "12 of 15 published means are compatible with ours at 95 %; against no prior, distance travelled (m) changes by −39 % \
             with floor plan (printed −45 %) and by +37 % with footprint (printed −25 %)."
        );
        content.compared = "success is highest with random of the 5 compared (D1)".to_owned();
        assert_eq!(
            finding(&content),
            "12 of 15 published means are compatible with ours at 95 %; success is highest with random of the 5 compared (D1)."
        );
        let nothing = ReportContent { headline: content.headline, ..ReportContent::default() };
        assert_eq!(
            finding(&nothing),
            "40 trials in 4 conditions were run; no claim is made of them."
        );
    }
}
