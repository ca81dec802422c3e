//! What a finished run says on one screen: tables as far as there is room, the verdicts in words, and where the rest is.
//!
//! A study whose tables and verdicts fit is told whole. Where they do not, verdicts are counted, a table that is too long shows the
//! lines in which ours and the paper's lie apart, and further tables are named.

use super::exhibit::{self, Shown};
use super::verdicts;
use crate::claims::ClaimVerdict;
use crate::cli::fold::{narrowed, wrapped};
use crate::studies::Exhibit;

/// Lines of a screen, without those for what is worth typing next.
const LINES: usize = 38;

/// Fewest lines of a table that are worth its head.
const FEWEST: usize = 3;

/// What a run has to say.
pub(super) struct Screen<'a> {
    /// What the study is, and that it is partial where it is.
    pub(super) head: String,
    pub(super) exhibits: &'a [Exhibit],
    pub(super) verdicts: &'a [ClaimVerdict],
    /// Verdicts on the machine.
    pub(super) machine: &'a [ClaimVerdict],
    /// Counts, digest and path: what no run leaves out.
    pub(super) tail: String,
    pub(super) columns: usize,
}

impl Screen<'_> {
    /// Writes it: whole where that fits, folded where not.
    pub(super) fn to_text(&self) -> String {
        let tables: String = self
            .exhibits
            .iter()
            .map(|exhibit| exhibit::in_lines(exhibit, self.columns) + "\n")
            .collect();
        let claims = narrowed(&verdicts::in_words(self.verdicts, self.machine), self.columns);
        let whole = format!("{}\n{tables}{claims}{}", self.head, self.tail);
        if count(&whole) <= LINES { whole } else { self.folded() }
    }

    fn folded(&self) -> String {
        let claims = verdicts::in_short(self.verdicts, self.machine, self.columns);
        let ids: Vec<&str> = self.exhibits.iter().map(|exhibit| exhibit.id.as_str()).collect();
        // What names all tables takes as many lines as anything that names fewer.
        let most = count(&named(&ids, &ids, self.columns));
        let around = count(&self.head) + 1 + count(&claims) + count(&self.tail) + most + 1;
        let mut room = LINES.saturating_sub(around);
        let (mut text, mut legends) = (String::new(), Vec::new());
        let (mut left_out, mut cut) = (Vec::new(), Vec::new());
        for exhibit in self.exhibits {
            let legend = exhibit::legend_of(exhibit).filter(|legend| !legends.contains(legend));
            let below = legend.as_ref().map_or(0, |legend| count(&self.note(legend)));
            let Some(shown) = Shown::within(exhibit, self.columns, room.saturating_sub(below + 1))
                .filter(|shown| shown.is_whole || shown.rows >= FEWEST)
            else {
                left_out.push(exhibit.id.as_str());
                continue;
            };
            room = room.saturating_sub(count(&shown.text) + below + 1);
            text.push_str(&shown.text);
            if !shown.is_whole {
                cut.push(exhibit.id.as_str());
            }
            if let Some(legend) = legend {
                text.push_str(&self.note(&legend));
                legends.push(legend);
            }
            text.push('\n');
        }
        let rest = named(&left_out, &cut, self.columns);
        format!("{}\n{text}{claims}{rest}\n{}", self.head, self.tail)
    }

    fn note(&self, legend: &str) -> String {
        wrapped(&format!("({legend})"), 2, self.columns)
    }
}

/// Says where the tables are that are not shown, or not all of them.
fn named(left_out: &[&str], cut: &[&str], columns: usize) -> String {
    let mut parts = Vec::new();
    if !left_out.is_empty() {
        parts.push(format!("not shown: {}", left_out.join(", ")));
    }
    if !cut.is_empty() || !left_out.is_empty() {
        parts.push("every line is on the page that `reenact report` writes".to_owned());
    }
    if parts.is_empty() { String::new() } else { wrapped(&parts.join("; "), 0, columns) }
}

fn count(text: &str) -> usize {
    text.lines().count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studies::Lines;
    use crate::studies::fixture::with_findings;
    use crate::table::Table;
    use serde_json::json;

    const TAIL: &str = "20 trials: 20 explored\nresults sha256:00\nartifacts/a.zip\n";

    fn exhibits() -> Vec<Exhibit> {
        let mut all = Vec::new();
        with_findings(|findings, requests| {
            all.extend(requests.iter().map(|request| request.exhibit(findings, requests)));
        });
        all
    }

    fn verdicts(n: usize) -> Vec<ClaimVerdict> {
        let names = ["supported", "contradicted", "inconclusive", "cannot-be-tested"];
        let verdict = |i: usize| {
            json!({
                "id": format!("D{i}"), "says": "it is so", "verdict": names[i % 4],
                "paper-table": if i.is_multiple_of(8) { "contradicts" } else { "silent" },
            })
        };
        (0..n).map(|i| serde_json::from_value(verdict(i)).unwrap()).collect()
    }

    fn told(exhibits: &[Exhibit], verdicts: &[ClaimVerdict], columns: usize) -> String {
        let head = "A study\n".to_owned();
        let tail = TAIL.to_owned();
        Screen { head, exhibits, verdicts, machine: &[], tail, columns }.to_text()
    }

    /// A table of `rows` lines, of which ours and the paper's lie apart in the last two.
    fn long(rows: usize) -> Exhibit {
        let mut exhibit = exhibits().remove(0);
        let columns =
            ["coverage", "environment, furniture, reading, prior knowledge", "ours", "", "paper's"];
        let mut table = Table::new(columns);
        for i in 0..rows {
            let percent =
                if i % 2 == 0 { format!("{} %", 70 + 5 * (i / 2)) } else { String::new() };
            let prior = ["no prior", "free space of the previous map"][i % 2];
            let mark = if i + 2 >= rows { "≠" } else { "✓" };
            let name = format!("basic, furnished, as described, {prior}");
            let row = [percent, name, "12.34 ± 5.67".into(), mark.into(), "12.00 ± 3.00".into()];
            table.push(row.map(Into::into).to_vec());
        }
        exhibit.id = "distance".to_owned();
        exhibit.title = "Distance".to_owned();
        exhibit.set.lines = Lines::all(table, 2, [1]);
        exhibit
    }

    #[test]
    fn what_fits_is_told_whole() {
        let (one, claims) = (exhibits().remove(0), verdicts(4));
        let text = told(std::slice::from_ref(&one), &claims, 80);
        assert!(text.contains(&exhibit::in_lines(&one, 80)), "{text}");
        assert!(text.contains("  D3     cannot be tested  silent\n"), "{text}");
        assert!(text.ends_with(TAIL) && !text.contains("not shown"), "{text}");
    }

    #[test]
    fn what_does_not_fit_is_one_screenful_that_says_where_the_rest_is() {
        let mut all = vec![long(60)];
        all.extend(exhibits());
        for columns in [60, 80, 100] {
            let text = told(&all, &verdicts(28), columns);
            assert!(text.lines().count() <= LINES, "{columns}: {text}");
            assert!(text.ends_with(TAIL), "{text}");
            let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
            for said in [
                "Claims of the paper: 28 7 supported: D0, D4, D8,",
                "7 cannot be tested: D3,",
                "the paper's own table says the opposite of: D0, D8, D16, D24",
                "not shown: ",
            ] {
                assert!(words.contains(said), "{said}: {text}");
            }
            // Where a line has no room for both numbers, a short table says more than a part of this one.
            assert_eq!(words.contains(" more in distance.csv"), columns > 60, "{text}");
        }
    }

    #[test]
    fn lines_in_which_ours_and_the_papers_lie_apart_are_shown_first() {
        let shown = Shown::within(&long(60), 110, 7).unwrap();
        assert_eq!(
            shown.text,
            "Distance
  coverage  environment, furniture, reading, prior knowledge                        ours          paper's
      70 %  basic, furnished, as described, no prior                        12.34 ± 5.67  ✓  12.00 ± 3.00
            basic, furnished, as described, free space of the previous map  12.34 ± 5.67  ✓  12.00 ± 3.00
     215 %  basic, furnished, as described, no prior                        12.34 ± 5.67  ≠  12.00 ± 3.00
            basic, furnished, as described, free space of the previous map  12.34 ± 5.67  ≠  12.00 ± 3.00
  56 more in distance.csv
"
        );
        assert!((shown.rows, shown.is_whole) == (4, false));
    }

    #[test]
    fn ours_and_the_papers_stay_in_one_line_where_names_are_long() {
        let text = exhibit::in_lines(&long(3), 80);
        assert!(
            text.starts_with(
                "Distance
  coverage  prior knowledge                         ours          paper's
  basic, furnished, as described
      70 %  no prior                        12.34 ± 5.67  ✓  12.00 ± 3.00
            free space of the previous map  12.34 ± 5.67  ≠  12.00 ± 3.00
      75 %  no prior                        12.34 ± 5.67  ≠  12.00 ± 3.00
"
            ),
            "{text}"
        );
    }
}
