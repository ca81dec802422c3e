//! The page of one bundle.

use super::finding;
use super::hinges::Hinges;
use super::inline_svg::inline_svg;
use super::pack::base64;
use super::template::{Template, render_in};
use super::{ClaimRow, Command, ReportContent, ReportTable};
use crate::stats::compatibility::{Agreement, Band, Tally, rules};
use serde::Serialize;
use std::collections::BTreeMap;

#[derive(Serialize)]
struct View<'a> {
    report: &'a ReportContent,
    /// What was found, in a sentence or two.
    finding: String,
    /// The claims of the paper.
    claims: Vec<&'a ClaimRow>,
    /// The same by what their effects are quantities of, in the order in which those are met.
    groups: Vec<Group<'a>>,
    /// What we check besides.
    checks: Vec<&'a ClaimRow>,
    check_groups: Vec<Group<'a>>,
    /// The settings that were tried, against the claims of which a verdict hangs on one.
    hinges: Hinges,
    /// The commands that check, look and unpack, the quickest first.
    commands: Vec<&'a Command>,
    /// Tables that stand open: those with published numbers, where there are any.
    open_tables: Vec<usize>,
    /// The others.
    folded_tables: Vec<usize>,
    /// Figures that stand open: those that the paper has, where there are any.
    open_figures: Vec<usize>,
    /// The others.
    folded_figures: Vec<usize>,
    score: Score,
    /// The figures' drawings, as they may stand in a page; empty where a figure is none.
    drawings: Vec<String>,
    /// The figures' files, base64.
    files: Vec<String>,
    /// By table: the most trials that stand behind a cell of it.
    runs: Vec<u64>,
    /// By table: how many cells each method compared, by what it found.
    marks: Vec<Vec<Compared>>,
    /// By table: what its marks mean; empty where nothing is compared.
    rules: Vec<String>,
    /// Mark, words and look of every agreement by its name.
    agreements: BTreeMap<&'static str, [&'static str; 3]>,
}

/// Claims of which the effects lie on one axis.
#[derive(Serialize)]
#[serde(rename_all = "kebab-case")]
struct Group<'a> {
    quantity: &'a str,
    axis: &'a str,
    claims: Vec<&'a ClaimRow>,
}

/// Returns `claims` by quantity; those without one come last.
fn grouped<'a>(claims: &[&'a ClaimRow]) -> Vec<Group<'a>> {
    let mut groups: Vec<Group<'a>> = Vec::new();
    for claim in claims {
        match groups.iter_mut().find(|group| group.quantity == claim.quantity) {
            Some(group) => group.claims.push(claim),
            None => groups.push(Group {
                quantity: &claim.quantity,
                axis: &claim.axis,
                claims: vec![claim],
            }),
        }
    }
    groups.sort_by_key(|group| group.quantity.is_empty());
    groups
}

/// The whole report in a few counts: what a reader sees first.
#[derive(Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
struct Score {
    /// Claims of the paper by verdict, in the order in which one tells them.
    verdicts: [Share; 4],
    /// Checks of our own by verdict.
    own: [Share; 4],
    /// Claims of the paper by what its own table says.
    paper_tables: [Share; 3],
    /// Claims on which we and the paper's own table are at odds.
    differs: usize,
    /// Cells that are published and that we have, by method: never added up.
    cells: Vec<Compared>,
}

/// What one method found of the cells that it compared.
#[derive(Debug, PartialEq, Eq, Serialize)]
struct Compared {
    /// `118 of 180 published percentages are compatible with ours at 95 %`.
    words: String,
    /// Counts with mark and words, those of nothing left out.
    shares: Vec<Marked>,
}

/// How many cells have one mark.
#[derive(Debug, PartialEq, Eq, Serialize)]
struct Marked {
    look: &'static str,
    mark: &'static str,
    words: &'static str,
    count: usize,
}

/// How many of a kind.
#[derive(Debug, PartialEq, Eq, Serialize)]
struct Share {
    name: &'static str,
    count: usize,
}

impl Score {
    fn of(content: &ReportContent) -> Self {
        let (claims, checks) = apart(&content.claims);
        let of = |claims: &[&ClaimRow]| {
            ["supported", "contradicted", "inconclusive", "cannot-be-tested"].map(|name| Share {
                name,
                count: claims.iter().filter(|c| c.verdict == name).count(),
            })
        };
        let paper =
            |name| Share { name, count: claims.iter().filter(|c| c.paper_table == name).count() };
        let cells: Vec<Agreement> = content.tables.iter().flat_map(agreements).collect();
        Self {
            verdicts: of(&claims),
            own: of(&checks),
            paper_tables: ["supports", "contradicts", "silent"].map(paper),
            differs: claims.iter().filter(|claim| !claim.differs.is_empty()).count(),
            cells: compared(&cells),
        }
    }
}

/// Separates the claims of the paper from what we check besides.
pub(super) fn apart(claims: &[ClaimRow]) -> (Vec<&ClaimRow>, Vec<&ClaimRow>) {
    claims.iter().partition(|claim| claim.ours.is_empty())
}

/// Returns how the cells of a table agree.
fn agreements(table: &ReportTable) -> Vec<Agreement> {
    table.rows.iter().flat_map(|row| &row.cells).map(|cell| cell.agreement).collect()
}

/// Returns what each method found among `cells`.
fn compared(cells: &[Agreement]) -> Vec<Compared> {
    let of = |tally: Tally| {
        let of_it = || cells.iter().filter(|cell| cell.method() == Some(tally.method));
        let mut shares: Vec<Marked> = Vec::new();
        for look in ["within", "near", "apart"] {
            let mut alike = of_it().filter(|cell| self::look(**cell) == look);
            if let Some(first) = alike.next() {
                let (mark, words) = (first.mark(), first.words());
                shares.push(Marked { look, mark, words, count: 1 + alike.count() });
            }
        }
        Compared { words: tally.in_words(), shares }
    };
    Tally::of(cells).into_iter().map(of).collect()
}

/// Returns the colour of a mark, which adds nothing to its shape.
fn look(agreement: Agreement) -> &'static str {
    match agreement {
        Agreement::Compatible(_) | Agreement::Near(Band::Within10, _) => "within",
        Agreement::Near(Band::Within20, _) => "near",
        Agreement::Apart(_) | Agreement::Near(Band::Farther, _) => "apart",
        Agreement::Silent(_) => "",
    }
}

/// Returns the most trials that stand behind a cell of `table`.
fn most_runs(table: &ReportTable) -> u64 {
    let cells = table.rows.iter().flat_map(|row| &row.cells);
    cells.filter_map(|cell| cell.ours?.n).max().unwrap_or(0)
}

pub(super) const SCRIPT: &str =
    concat!(include_str!("templates/page.js"), include_str!("templates/report/report.js"));

/// The page's own parts, by the name under which it includes them.
const PARTS: [(&str, &str); 5] = [
    ("claims", include_str!("templates/report/claims.html")),
    ("tables", include_str!("templates/report/tables.html")),
    ("multiverse", include_str!("templates/report/multiverse.html")),
    ("provenance", include_str!("templates/report/provenance.html")),
    ("evaluation", include_str!("templates/report/evaluation.html")),
];

/// Returns one self-contained offline page: what the study does not show, its numbers beside the paper's, the figures,
/// the claims, the assumptions, and how to check it all.
pub fn page(content: &ReportContent) -> String {
    let view = view(content);
    let page = Template { page: include_str!("templates/report/page.html"), parts: &PARTS };
    let style = [super::STYLE, include_str!("templates/report/report.css")];
    render_in(page, &style, SCRIPT, &view)
}

fn view(content: &ReportContent) -> View<'_> {
    let cells = content.tables.iter().flat_map(agreements);
    let drawing = |f: &super::Figure| inline_svg(&f.svg, &f.alt).unwrap_or_default();
    let (claims, checks) = apart(&content.claims);
    let (open_tables, folded_tables) =
        told_apart(content.tables.iter().map(|table| !table.source.is_empty()));
    let is_paper = |figure: &super::Figure| {
        ["Figure ", "Table ", "Fig. "].iter().any(|word| figure.title.starts_with(word))
    };
    let (open_figures, folded_figures) = told_apart(content.figures.iter().map(is_paper));
    View {
        report: content,
        finding: finding(content),
        groups: grouped(&claims),
        check_groups: grouped(&checks),
        claims,
        checks,
        hinges: Hinges::of(content),
        commands: commands(content),
        open_tables,
        folded_tables,
        open_figures,
        folded_figures,
        score: Score::of(content),
        drawings: content.figures.iter().map(drawing).collect(),
        files: content.figures.iter().map(|figure| base64(figure.svg.as_bytes())).collect(),
        runs: content.tables.iter().map(most_runs).collect(),
        marks: content.tables.iter().map(|table| compared(&agreements(table))).collect(),
        rules: content.tables.iter().map(|t| rules(agreements(t)).unwrap_or_default()).collect(),
        agreements: cells.map(|a| (a.name(), [a.mark(), a.words(), look(a)])).collect(),
    }
}

/// Returns the numbers of what comes first and of the rest; where nothing does, all comes first.
fn told_apart(first: impl Iterator<Item = bool>) -> (Vec<usize>, Vec<usize>) {
    let (first, rest): (Vec<_>, Vec<_>) = first.enumerate().partition(|(_, is_first)| *is_first);
    let numbers = |of: Vec<(usize, bool)>| of.into_iter().map(|(i, _)| i).collect::<Vec<_>>();
    if first.is_empty() { (numbers(rest), Vec::new()) } else { (numbers(first), numbers(rest)) }
}

/// Returns the commands that anybody tries first: those of the badges that ask for a program, without the whole study.
fn commands(content: &ReportContent) -> Vec<&Command> {
    let wanted = ["functional", "reusable"];
    let badges = content.evaluation.badges.iter();
    badges.filter(|badge| wanted.contains(&badge.id.as_str())).flat_map(|b| &b.commands).collect()
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{assert_offline, content};
    use super::*;

    #[test]
    fn the_finding_comes_first_then_limits_and_commands_and_every_part_is_there() {
        let page = page(&content());
        assert_offline(&page);
        let at = |text: &str| page.find(text).unwrap_or_else(|| panic!("no {text} in the page"));
        let order = [
            "<h1>",
            "class=\"finding\"",
            "id=\"headline\"",
            "id=\"limits\"",
            "id=\"check\"",
            "id=\"answers\"",
            "id=\"claims\"",
            "id=\"own-checks\"",
            "id=\"machine-claims\"",
            "id=\"table-1\"",
            "id=\"coverage\"",
            "id=\"assumptions\"",
            "id=\"multiverse\"",
            "id=\"provenance\"",
            "id=\"evaluation\"",
        ];
        assert!(order.windows(2).all(|pair| at(pair[0]) < at(pair[1])), "{order:?}");
        for text in [
            "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08",
            "parameters.<wbr>mapping.<wbr>particles",
            "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855",
            "not compatible at 95 %",
            "reenact verify prior-9f86d081.zip",
            "not reached",
            "a footprint never harms",
            "no range stated",
            "at <code>0.6</code>: no verdict changes",
            "at <code>0.3</code>: 1 verdict changes",
            "P1</a> supported → inconclusive",
            "class=\"odds\"",
            "--set seed=7",
            "download=\"bars.svg\"",
            "reenact verify --level 6 prior-9f86d081.zip",
            "doi:10.1000",
            "<q>a floor plan shortens the way to 90 % coverage</q>",
            "<span class=\"id\">P3</span> gains here go with those printed",
            "Of <strong>1</strong> <a href=\"#own-checks\">check of our own</a>",
            "<td class=\"hinge flips\" title=\"at 0.3: supported → inconclusive\">",
            "without an effect to draw",
            "15 trials per condition, one setting at a time, same noise",
            "24 draws of 2 choices, 15 trials per condition, seed 7; 1 draw was refused",
            "<td class=\"choice shade-4 out\">",
            "draw 3: it is too fast",
        ] {
            at(text);
        }
        assert_eq!(
            page.matches("<svg class=\"key\"").count(),
            6,
            "of the plots of claims and checks"
        );
        assert_eq!(page.matches("<svg").count(), 3 + 6);
        assert_eq!(page, super::page(&content()), "the same content gives the same bytes");
    }

    #[test]
    fn the_score_counts_verdicts_tables_and_cells_each_on_its_own() {
        let score = Score::of(&content());
        let counts = |shares: &[Share]| shares.iter().map(|s| s.count).collect::<Vec<_>>();
        assert_eq!(counts(&score.verdicts), [1, 1, 0, 0]);
        assert_eq!(counts(&score.own), [0, 0, 1, 0], "not among the paper's");
        assert_eq!((counts(&score.paper_tables), score.differs), (vec![2, 0, 0], 1));
        let cells = &score.cells[0];
        assert_eq!(score.cells.len(), 1);
        assert_eq!(
            cells.words, "12 of 15 published means are compatible with ours at 95 %",
            "one is missing"
        );
        let shares: Vec<_> = cells.shares.iter().map(|s| (s.mark, s.count)).collect();
        assert_eq!(shares, [("✓", 12), ("≠", 3)]);
    }

    #[test]
    fn what_is_absent_leaves_no_empty_part() {
        let page = page(&ReportContent { title: "Nothing".into(), ..ReportContent::default() });
        for part in [
            "id=\"claims\"",
            "id=\"machine-claims\"",
            "id=\"tables\"",
            "id=\"figures\"",
            "id=\"assumptions\"",
            "id=\"multiverse\"",
            "id=\"limits\"",
            "id=\"evaluation\"",
        ] {
            assert!(!page.contains(part), "{part}");
        }
        assert_offline(&page);
    }

    #[test]
    fn no_link_leads_to_a_claim_that_was_not_judged() {
        let mut content = content();
        content.claims.clear();
        let page = page(&content);
        assert!(!page.contains("href=\"#claim-"), "a part of a study judges nothing");
        assert!(page.contains("<th scope=\"col\" class=\"turned\"><span>P1</span></th>"));
    }

    #[test]
    fn hostile_content_stays_text() {
        let mut content = content();
        content.title = "</title><script>alert(1)</script>".into();
        content.assumptions[0].path = "a.<img src=x>".into();
        content.claims[0].says = "<img src=x onerror=alert(1)>".into();
        content.figures[0].svg = "<svg><script>alert(2)</script></svg>".into();
        content.figures[1].svg = "not a drawing".into();
        let page = page(&content);
        assert!(!page.contains("<script>alert") && !page.contains("<img"));
        assert_eq!(page.matches("</script>").count(), 1);
        assert!(page.contains("This figure could not be read as SVG"));
    }
}
