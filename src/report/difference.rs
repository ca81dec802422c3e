//! The page of a comparison.

use super::template::render;
use crate::compare::{Comparison, Party, Section};
use serde::Serialize;

/// Differences of one kind that a page shows; the rest are counted.
const ROWS_SHOWN: usize = 500;

#[derive(Serialize)]
#[serde(rename_all = "kebab-case")]
struct View<'a> {
    sides: [Side<'a>; 2],
    same: bool,
    answer: String,
    matching: Option<String>,
    sections: Vec<SectionView>,
}

#[derive(Serialize)]
#[serde(rename_all = "kebab-case")]
struct Side<'a> {
    name: &'a str,
    party: &'a Party,
}

#[derive(Serialize)]
#[serde(rename_all = "kebab-case")]
struct SectionView {
    id: String,
    name: &'static str,
    compared: String,
    changed: usize,
    remark: String,
    /// Subject, before, after, note.
    rows: Vec<[String; 4]>,
    more: usize,
}

/// Returns one self-contained offline page: the answer, what was compared, and every difference by kind. `names` are
/// what the two sides are called.
pub fn difference_page(comparison: &Comparison, names: [&str; 2]) -> String {
    let side = |name, party| Side { name, party };
    let view = View {
        sides: [side(names[0], &comparison.a), side(names[1], &comparison.b)],
        same: comparison.is_same(),
        answer: comparison.answer(),
        matching: comparison.matching_in_words(),
        sections: comparison.sections().into_iter().map(view_of).collect(),
    };
    render(include_str!("templates/difference.html"), include_str!("templates/page.js"), &view)
}

fn view_of(section: Section) -> SectionView {
    let changed = section.rows.len();
    let rows = section.rows.into_iter().take(ROWS_SHOWN);
    SectionView {
        id: section.name.replace(' ', "-"),
        name: section.name,
        compared: section.compared,
        changed,
        remark: section.remark,
        rows: rows.map(|row| [row.subject, row.from, row.to, row.note]).collect(),
        more: changed.saturating_sub(ROWS_SHOWN),
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::assert_offline;
    use super::*;
    use crate::bundle::{Bundle, Form, Limits, sample, seal};
    use crate::compare::{Account, Extent, Tolerances, compare};

    fn account(change: impl Fn(&mut crate::studies::TrialRecord)) -> Account {
        let mut conditions = sample::records();
        conditions.iter_mut().flat_map(|(_, records)| records).for_each(change);
        let content = sample::content_of(sample::STUDY.as_bytes(), 7, &conditions);
        let zip = seal(&content, &sample::circumstance()).unwrap().zip(Form::Bag);
        Account::of_bundle(&Bundle::read(&zip, &Limits::default()).unwrap()).unwrap()
    }

    fn page(change: impl Fn(&mut crate::studies::TrialRecord)) -> String {
        let none = Tolerances::default();
        let comparison = compare(&account(|_| ()), &account(change), Extent::Whole, &none).unwrap();
        difference_page(&comparison, ["old.zip", "<b>new.zip</b>"])
    }

    #[test]
    fn the_summary_comes_first_and_leads_to_every_difference() {
        let page = page(|record| record.cause = "<script>alert(1)</script>".to_owned());
        assert_offline(&page);
        let at = |text: &str| page.find(text).unwrap_or_else(|| panic!("no {text} in {page}"));
        let order =
            ["<h1>What changed</h1>", "id=\"sides\"", "id=\"summary\"", "<section id=\"trials\""];
        assert!(order.windows(2).all(|pair| at(pair[0]) < at(pair[1])));
        for text in [
            "<p>changed: trials (6)</p>",
            "<a href=\"#trials\">trials</a>",
            "&lt;b&gt;new.zip",
            "none&#x2f;0",
            "outcome explored -&gt; explored (&lt;script&gt;",
        ] {
            at(text);
        }
        assert_eq!(page.matches("</script>").count(), 1, "only our own script");
    }

    #[test]
    fn no_change_is_an_answer_too() {
        let page = page(|_| ());
        assert_offline(&page);
        assert!(page.contains("<h1>No change</h1>") && !page.contains("<h2"));
    }
}
