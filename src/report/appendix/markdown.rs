//! The appendix as Markdown, which every forge and archive shows.

use super::{Block, Part};

/// Writes the whole document.
pub(super) fn written(title: &str, parts: &[Part]) -> String {
    let mut text = format!("# {}\n", one_line(title));
    for part in parts {
        text.push_str(&format!("\n## {}\n", part.title));
        for block in &part.blocks {
            text.push('\n');
            write(block, &mut text);
        }
    }
    text
}

fn write(block: &Block, text: &mut String) {
    match block {
        Block::Text(words) => text.push_str(&format!("{}\n", one_line(words))),
        Block::List(items) => {
            for item in items {
                text.push_str(&format!("- {}\n", one_line(item)));
            }
        }
        Block::Facts(facts) => {
            for (name, words) in facts {
                text.push_str(&format!("- **{name}**: {}\n", one_line(words)));
            }
        }
        Block::Commands(commands) => {
            text.push_str("```\n");
            for command in commands {
                let (purpose, time) = (one_line(&command.purpose), one_line(&command.time));
                text.push_str(&format!("# {purpose}: {time}\n{}\n", one_line(&command.line)));
            }
            text.push_str("```\n");
        }
        Block::Table(head, rows) => {
            text.push_str(&format!("| {} |\n|{}\n", head.join(" | "), " --- |".repeat(head.len())));
            for row in rows {
                let cells: Vec<String> = row.iter().map(|cell| cell_text(cell)).collect();
                text.push_str(&format!("| {} |\n", cells.join(" | ")));
            }
        }
    }
}

/// What a stranger wrote may begin no line and end no cell.
fn cell_text(text: &str) -> String {
    one_line(text).replace('|', "\\|")
}

fn one_line(text: &str) -> String {
    text.split(|c: char| c.is_control() || c == ' ')
        .filter(|w| !w.is_empty())
        .collect::<Vec<_>>()
        .join(" ")
}
