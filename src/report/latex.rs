//! A bundle's numbers for a paper that is written in LaTeX: its tables with booktabs, beside the numbers of the paper that is
//! re-enacted, and every cell, verdict and digest by a name.

use super::content::{ReportContent, ReportTable};
use super::template::fixed;
use crate::studies::Measured;

/// The macro that gives a number by its name; a name that does not exist stops LaTeX with a message, so that no number is left out
/// unseen.
const LOOK_UP: &str = r"\providecommand{\reenact}[1]{%
  \ifcsname reenact@#1\endcsname\csname reenact@#1\endcsname
  \else\PackageError{reenact}{there is no number `#1'}{Their names stand in numbers.tex.}\fi}
";

/// Returns the files to include, each by its name: `numbers.tex` first, then one for each table.
pub fn latex(content: &ReportContent) -> Vec<(String, String)> {
    let tables = content.tables.iter().map(|t| (format!("{}.tex", t.id), table(t)));
    [("numbers.tex".to_owned(), numbers(content))].into_iter().chain(tables).collect()
}

fn numbers(content: &ReportContent) -> String {
    let mut text = format!(
        "% Numbers of the bundle with the results sha256:{}.\n% \\input{{numbers}}, then \\reenact{{NAME}} with one of these names:\n{LOOK_UP}",
        content.headline.results_digest
    );
    let mut define = |name: &str, value: &str| {
        let name = plain(name);
        text.push_str(&format!(
            "\\expandafter\\def\\csname reenact@{name}\\endcsname{{{value}}}\n"
        ));
    };
    let headline = &content.headline;
    define("results-digest", &headline.results_digest);
    define("results-digest/short", &headline.results_digest.chars().take(8).collect::<String>());
    define("trials", &headline.trials.to_string());
    define("conditions", &headline.conditions.to_string());
    define("engine", &escaped(&headline.engine_version));
    for claim in &content.claims {
        define(&format!("verdict/{}", claim.id), &claim.verdict.replace('-', " "));
    }
    for table in &content.tables {
        let decimals = usize::from(table.decimals);
        for row in &table.rows {
            for (column, cell) in table.columns.iter().zip(&row.cells) {
                let name = format!("{}/{}/{column}", table.id, row.label);
                let mut define = |what: &str, x: Option<f64>| {
                    if let Some(x) = x {
                        define(&format!("{name}{what}"), &number(x, decimals));
                    }
                };
                define("", cell.ours.map(|ours| ours.mean));
                define("/sd", cell.ours.and_then(|ours| ours.sd));
                define("/paper", cell.published.map(|paper| paper.mean));
                define("/paper/sd", cell.published.and_then(|paper| paper.sd));
            }
        }
    }
    text
}

/// Writes a table: under each column ours, and the paper's where it prints any of it.
fn table(table: &ReportTable) -> String {
    let decimals = usize::from(table.decimals);
    let is_printed: Vec<bool> = (0..table.columns.len())
        .map(|i| {
            table.rows.iter().any(|row| row.cells.get(i).is_some_and(|c| c.published.is_some()))
        })
        .collect();
    let columns: String = is_printed.iter().map(|both| if *both { "rr" } else { "r" }).collect();
    let heads = table.columns.iter().zip(&is_printed).map(|(column, both)| {
        let column = escaped(column);
        if *both { format!("\\multicolumn{{2}}{{c}}{{{column}}}") } else { column }
    });
    let mut text = format!(
        "% {}; {}. Needs \\usepackage{{booktabs}}.\n\\begin{{tabular}}{{l{columns}}}\n\\toprule\n{}",
        one_line(&table.title),
        one_line(&table.quantity),
        escaped(&table.row_header)
    );
    heads.for_each(|head| text.push_str(&format!(" & {head}")));
    text.push_str(" \\\\\n");
    if is_printed.contains(&true) {
        for both in &is_printed {
            text.push_str(if *both { " & ours & " } else { " & ours" });
            text.push_str(if *both { &table.beside } else { "" });
        }
        text.push_str(" \\\\\n");
    }
    text.push_str("\\midrule\n");
    for row in &table.rows {
        text.push_str(&escaped(&row.label));
        for (cell, both) in row.cells.iter().zip(&is_printed) {
            text.push_str(&format!(" & {}", measured(cell.ours, decimals)));
            if *both {
                text.push_str(&format!(" & {}", measured(cell.published, decimals)));
            }
        }
        text.push_str(" \\\\\n");
    }
    text + "\\bottomrule\n\\end{tabular}\n"
}

fn measured(found: Option<Measured>, decimals: usize) -> String {
    match found {
        None => "--".to_owned(),
        Some(Measured { mean, sd: Some(sd), .. }) => {
            format!("${} \\pm {}$", ascii(mean, decimals), ascii(sd, decimals))
        }
        Some(Measured { mean, .. }) => number(mean, decimals),
    }
}

fn number(x: f64, decimals: usize) -> String {
    if x.is_finite() { format!("\\ensuremath{{{}}}", ascii(x, decimals)) } else { "--".to_owned() }
}

fn ascii(x: f64, decimals: usize) -> String {
    fixed(x, decimals).replace('\u{2212}', "-").replace('–', "\\mbox{--}")
}

/// Returns `text` as part of a name: without what LaTeX would read as more than a letter.
fn plain(text: &str) -> String {
    let is_special = |c: char| "\\{}%#~^&$_".contains(c) || c.is_control();
    let text: String = text.chars().map(|c| if is_special(c) { '-' } else { c }).collect();
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Returns `text` as LaTeX sets it.
pub(super) fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '\\' => out.push_str("\\textbackslash{}"),
            '{' | '}' | '%' | '#' | '&' | '$' | '_' => out.extend(['\\', c]),
            '~' => out.push_str("\\textasciitilde{}"),
            '^' => out.push_str("\\textasciicircum{}"),
            '²' => out.push_str("\\ensuremath{^2}"),
            '\u{a0}' => out.push('~'),
            '\u{2212}' => out.push_str("\\ensuremath{-}"),
            '±' => out.push_str("\\ensuremath{\\pm}"),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

pub(super) fn one_line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::content;
    use super::*;

    #[test]
    fn a_table_has_ours_beside_the_papers() {
        let files = latex(&content());
        let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["numbers.tex", "table-1.tex"]);
        let mut lines = files[1].1.lines();
        assert_eq!(
            lines.by_ref().take(6).collect::<Vec<_>>(),
            [
                "% Distance to coverage, basic environment, furnished; distance travelled (m). Needs \\usepackage{booktabs}.",
                "\\begin{tabular}{lrrrrrrrr}",
                "\\toprule",
                "coverage & \\multicolumn{2}{c}{no prior} & \\multicolumn{2}{c}{floor plan} & \\multicolumn{2}{c}{footprint} & \
                 \\multicolumn{2}{c}{bounding box} \\\\",
                " & ours & paper & ours & paper & ours & paper & ours & paper \\\\",
                "\\midrule",
            ]
        );
        let row = lines.next().unwrap();
        assert!(
            row.starts_with("70 \\% & $25.50 \\pm 3.10$ & $25.00 \\pm 3.46$ & $15.50"),
            "{row}"
        );
        assert!(files[1].1.contains(" & -- & $37.50"), "what was not reached: {}", files[1].1);
    }

    #[test]
    fn every_cell_verdict_and_digest_has_a_name() {
        let numbers = &latex(&content())[0].1;
        for (name, value) in [
            ("table-1/70 -/floor plan", "\\ensuremath{15.50}"),
            ("table-1/70 -/floor plan/paper/sd", "\\ensuremath{3.46}"),
            ("verdict/P2", "contradicted"),
            ("results-digest/short", "9f86d081"),
            ("trials", "40"),
        ] {
            let line = format!("\\expandafter\\def\\csname reenact@{name}\\endcsname{{{value}}}\n");
            assert!(numbers.contains(&line), "{name}: {numbers}");
        }
    }

    #[test]
    fn what_latex_would_obey_is_set_as_text() {
        assert_eq!(escaped("a_b & 5 % \\x"), "a\\_b \\& 5 \\% \\textbackslash{}x");
        assert_eq!(plain("a_b/90 %\n\\x"), "a-b/90 ---x");
        assert_eq!(
            (number(-0.5, 1), number(f64::NAN, 1)),
            ("\\ensuremath{-0.5}".into(), "--".into())
        );
    }
}
