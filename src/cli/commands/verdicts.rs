//! Verdicts in print: what the paper's table shows beside what we find, and the reproduction score.

use crate::claims::verdict::{EffectSize, agreement_in_words};
use crate::claims::{ClaimVerdict, Judgement, PaperTable, Score};
use crate::cli::fold::wrapped;

/// Lists the verdicts on a study's claims with their score, and those on the machine, which count for nothing; empty
/// where nothing is claimed. A function of the verdicts alone: no lock changes what is printed.
pub(super) fn in_words(verdicts: &[ClaimVerdict], machine: &[ClaimVerdict]) -> String {
    let mut text = String::new();
    if !verdicts.is_empty() {
        text.push_str(&lists(["Claims of the paper", "Checks of our own"], verdicts));
        for line in Score::lines(verdicts) {
            text.push_str(&format!("reproduction: {line}\n"));
        }
        text.push('\n');
    }
    if !machine.is_empty() {
        let titles = [
            "Claims of the paper about the machine (not among the results)",
            "Checks of our own about the machine (not among the results)",
        ];
        text.push_str(&lists(titles, machine));
        text.push('\n');
    }
    text
}

/// Says how many claims came out in which way, which ones, and where the paper's own table says otherwise: for a screen that has no
/// room for a line a claim. Empty where nothing is claimed.
pub(super) fn in_short(
    verdicts: &[ClaimVerdict],
    machine: &[ClaimVerdict],
    columns: usize,
) -> String {
    let (papers, ours): (Vec<&ClaimVerdict>, Vec<&ClaimVerdict>) =
        verdicts.iter().partition(|verdict| verdict.says.is_some());
    let lists = [
        ("Claims of the paper", papers),
        ("Checks of our own", ours),
        ("About the machine (not among the results)", machine.iter().collect()),
    ];
    let mut text = String::new();
    for (title, verdicts) in lists.into_iter().filter(|(_, verdicts)| !verdicts.is_empty()) {
        text.push_str(&wrapped(&format!("{title}: {}", verdicts.len()), 0, columns));
        for judgement in Judgement::ALL {
            let of = verdicts.iter().filter(|verdict| verdict.judgement == judgement);
            let ids: Vec<&str> = of.map(|verdict| verdict.id.as_str()).collect();
            if !ids.is_empty() {
                let words = judgement.to_string().replace('-', " ");
                let line = format!("{} {words}: {}", ids.len(), ids.join(", "));
                text.push_str(&wrapped(&line, 2, columns));
            }
        }
        let differs = verdicts.iter().filter(|verdict| {
            matches!(
                (verdict.judgement, verdict.paper_table),
                (Judgement::Supported, PaperTable::Contradicts)
                    | (Judgement::Contradicted, PaperTable::Supports)
            )
        });
        let ids: Vec<&str> = differs.map(|verdict| verdict.id.as_str()).collect();
        if !ids.is_empty() {
            let line = format!("the paper's own table says the opposite of: {}", ids.join(", "));
            text.push_str(&wrapped(&line, 2, columns));
        }
    }
    if !text.is_empty() {
        text.push('\n');
    }
    text
}

/// Lists what the paper says, and apart from it what we check besides; empty lists are left out.
fn lists(titles: [&str; 2], verdicts: &[ClaimVerdict]) -> String {
    let (papers, ours): (Vec<&ClaimVerdict>, Vec<&ClaimVerdict>) =
        verdicts.iter().partition(|verdict| verdict.says.is_some());
    let lists = titles.into_iter().zip([papers, ours]).filter(|(_, list)| !list.is_empty());
    lists.map(|(title, verdicts)| list(title, &verdicts)).collect()
}

fn list(title: &str, verdicts: &[&ClaimVerdict]) -> String {
    let width = |texts: &mut dyn Iterator<Item = String>| {
        texts.map(|text| text.chars().count()).max().unwrap_or(0)
    };
    let id = width(&mut verdicts.iter().map(|v| v.id.clone())).max(5);
    let mut text = format!("{title}\n  {:id$}  {:16}  paper's table\n", "claim", "we find");
    for verdict in verdicts {
        text.push_str(&format!(
            "  {:id$}  {:16}  {}\n",
            verdict.id,
            verdict.judgement.to_string().replace('-', " "),
            verdict.paper_table
        ));
        if verdict.judgement == Judgement::CannotBeTested {
            text.push_str(&format!("  {:id$}  {}\n", "", verdict.reason));
        }
        for comparison in &verdict.comparisons {
            let words = agreement_in_words(comparison.statistics.iter());
            if let (false, Some(effect)) = (words.is_empty(), &comparison.effect) {
                let EffectSize { name, value, low, high, .. } = effect;
                let range = format!("[{low:.2}, {high:.2}]");
                text.push_str(&format!("  {:id$}  {name} {value:.2} {range}\n", ""));
                for part in words.split(", ") {
                    text.push_str(&format!("  {:id$}  {part}\n", ""));
                }
            }
        }
        for comparison in &verdict.comparisons {
            if let Some(words) = comparison.at_both_numbers() {
                text.push_str(&format!("  {:id$}  {}\n", "", comparison.about));
                text.push_str(&format!("  {:id$}    {words}\n", ""));
            }
        }
        if let Some((censored, all)) = verdict.censored() {
            text.push_str(&format!(
                "  {:id$}  {censored} of {all} runs compared never reached the measure\n",
                ""
            ));
        }
        if let Some(trials) = verdict.trials_to_decide {
            text.push_str(&format!(
                "  {:id$}  {trials} trials per condition would have decided it\n",
                ""
            ));
        }
    }
    text
}
