//! The appendix as LaTeX, to be included by the paper: `\input{artifact-appendix}` after `\appendix`.

use super::super::latex::{escaped, one_line};
use super::{Block, Part};

/// Writes the whole document.
pub(super) fn written(title: &str, parts: &[Part]) -> String {
    let mut text = format!(
        "% To be included after \\appendix. Needs \\usepackage[utf8]{{inputenc}} with older LaTeX, and \\usepackage{{booktabs}}.\n\
         \\section{{{}}}\n",
        set(title)
    );
    for part in parts {
        text.push_str(&format!("\n\\subsection{{{}}}\n", escaped(part.title)));
        for block in &part.blocks {
            write(block, &mut text);
        }
    }
    text
}

fn write(block: &Block, text: &mut String) {
    match block {
        Block::Text(words) => text.push_str(&format!("\n{}\n", set(words))),
        Block::List(items) if items.is_empty() => (),
        Block::List(items) => {
            let items = items.iter().map(|item| set(item));
            list("itemize", items, text);
        }
        Block::Facts(facts) => {
            let items = facts
                .iter()
                .map(|(name, words)| format!("\\textbf{{{}}}: {}", escaped(name), set(words)));
            list("itemize", items, text);
        }
        Block::Commands(commands) => {
            // What closes the environment closes it wherever it stands.
            let plain = |words: &str| one_line(words).replace("\\end{verbatim}", "");
            for command in commands {
                let line = plain(&command.line);
                let (purpose, time) = (set(&command.purpose), set(&command.time));
                text.push_str(&format!(
                    "\n\\noindent {purpose} ({time}):\n\\begin{{verbatim}}\n{line}\n\\end{{verbatim}}\n"
                ));
            }
        }
        Block::Table(head, rows) => table(head, rows, text),
    }
}

fn list(kind: &str, items: impl Iterator<Item = String>, text: &mut String) {
    text.push_str(&format!("\\begin{{{kind}}}\n"));
    for item in items {
        text.push_str(&format!("\\item {item}\n"));
    }
    text.push_str(&format!("\\end{{{kind}}}\n"));
}

/// Writes the claims, a paragraph each: their sentences are too long for the columns of a table that is set in a column.
fn table(head: &[&str], rows: &[Vec<String>], text: &mut String) {
    let items = rows.iter().map(|row| {
        let cells = head.iter().zip(row).skip(1).filter(|(_, cell)| !cell.is_empty());
        let cells: Vec<String> = cells
            .map(|(head, cell)| format!("\\emph{{{}}}: {}", escaped(head), set(cell)))
            .collect();
        let id = row.first().map(|id| set(id)).unwrap_or_default();
        format!("[{{{id}}}] {}", cells.join("; "))
    });
    list("description", items.collect::<Vec<_>>().into_iter(), text);
}

/// Returns `text` as LaTeX sets it, what stands between two back ticks as code.
fn set(text: &str) -> String {
    let line = one_line(text);
    let pieces = line.split('`');
    let is_paired = pieces.clone().count() % 2 == 1;
    let pieces = pieces.enumerate().map(|(i, piece)| match i % 2 {
        1 if is_paired => format!("\\texttt{{{}}}", escaped(piece)),
        _ => escaped(piece),
    });
    pieces.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn code_is_set_as_code_and_nothing_is_obeyed() {
        assert_eq!(set("`a_b` costs 5 %"), "\\texttt{a\\_b} costs 5 \\%");
        assert_eq!(set("one ` alone \\x"), "one  alone \\textbackslash{}x");
    }
}
