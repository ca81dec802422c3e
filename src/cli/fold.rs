//! Texts for a terminal of so many columns: tables folded where they are too wide, never wrapped by the terminal.

use crate::table::Table;

/// In front of every line.
const INDENT: &str = "  ";
/// Between two columns.
const GAP: &str = "  ";

/// Writes `table` in lines of at most `width` characters where that can be: with names of columns over several lines,
/// and with columns that still have no room in blocks below, each beside the first `keys` columns. Numbers stand to the
/// right, the columns `left` to the left.
pub(super) fn aligned(table: &Table, keys: usize, left: &[usize], width: usize) -> String {
    let cells: Vec<Vec<String>> =
        table.rows.iter().map(|row| row.iter().map(ToString::to_string).collect()).collect();
    let names: Vec<&str> = table.columns.iter().map(String::as_str).collect();
    let of_cells = |i: usize| cells.iter().map(|row| length(&row[i])).max().unwrap_or(0);
    let whole: Vec<usize> = (0..names.len()).map(|i| of_cells(i).max(length(names[i]))).collect();
    if total(&whole) <= width {
        let headers: Vec<Vec<String>> = names.iter().map(|name| vec![(*name).to_owned()]).collect();
        return block(&headers, &cells, &whole, left, &(0..names.len()).collect::<Vec<_>>());
    }
    let narrow: Vec<usize> = (0..names.len())
        .map(|i| pieces(names[i]).iter().map(|piece| length(piece)).fold(of_cells(i), usize::max))
        .collect();
    let headers: Vec<Vec<String>> =
        names.iter().zip(&narrow).map(|(name, &room)| folded(name, room)).collect();
    let keys = keys.min(names.len());
    let first = total(&narrow[..keys]);
    let mut blocks: Vec<Vec<usize>> = Vec::new();
    let mut taken = usize::MAX;
    for (column, room) in narrow.iter().enumerate().skip(keys) {
        let more = GAP.len() + room;
        match blocks.last_mut() {
            Some(last) if taken + more <= width => {
                last.push(column);
                taken += more;
            }
            _ => {
                blocks.push(vec![column]);
                taken = first + more;
            }
        }
    }
    let with_keys =
        |columns: &Vec<usize>| (0..keys).chain(columns.iter().copied()).collect::<Vec<_>>();
    let blocks: Vec<String> = blocks
        .iter()
        .map(|columns| block(&headers, &cells, &narrow, left, &with_keys(columns)))
        .collect();
    blocks.join("\n")
}

/// Returns whether `table` has room in lines of `width` characters without blocks below one another.
pub(super) fn fits(table: &Table, width: usize) -> bool {
    let widest = |(i, name): (usize, &String)| {
        let cells = table.rows.iter().map(|row| length(&row[i].to_string()));
        pieces(name).iter().map(|piece| length(piece)).chain(cells).max().unwrap_or(0)
    };
    let widths: Vec<usize> = table.columns.iter().enumerate().map(widest).collect();
    total(&widths) <= width
}

fn block(
    headers: &[Vec<String>],
    cells: &[Vec<String>],
    widths: &[usize],
    left: &[usize],
    columns: &[usize],
) -> String {
    let deep = columns.iter().map(|&i| headers[i].len()).max().unwrap_or(0);
    let mut text = String::new();
    let mut line = |cell: &dyn Fn(usize) -> String| {
        let padded: Vec<String> = columns
            .iter()
            .map(|&i| {
                let (cell, width) = (cell(i), widths[i]);
                if left.contains(&i) {
                    format!("{cell:<width$}")
                } else {
                    format!("{cell:>width$}")
                }
            })
            .collect();
        text.push_str(format!("{INDENT}{}", padded.join(GAP)).trim_end());
        text.push('\n');
    };
    for depth in 0..deep {
        // Names end above their column.
        line(&|i| {
            let missing = deep - headers[i].len();
            depth.checked_sub(missing).map_or_else(String::new, |at| headers[i][at].clone())
        });
    }
    for row in cells {
        line(&|i| row[i].clone());
    }
    text
}

/// Wraps `text` into lines of at most `width` characters, each indented.
pub(super) fn wrapped(text: &str, indent: usize, width: usize) -> String {
    let mut out = String::new();
    let mut line = String::new();
    for word in text.split_whitespace() {
        if !line.is_empty() && indent + length(&line) + 1 + length(word) > width {
            out.push_str(&format!("{:indent$}{line}\n", ""));
            line.clear();
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line.push_str(word);
    }
    out + &format!("{:indent$}{line}\n", "")
}

/// Wraps every line of `text` that is longer than `width`, below its own beginning.
pub(super) fn narrowed(text: &str, width: usize) -> String {
    let narrow = |line: &str| {
        let indent = length(line) - length(line.trim_start());
        if length(line) <= width { format!("{line}\n") } else { wrapped(line, indent, width) }
    };
    text.lines().map(narrow).collect()
}

fn length(text: &str) -> usize {
    text.chars().count()
}

fn total(widths: &[usize]) -> usize {
    INDENT.len() + widths.iter().sum::<usize>() + GAP.len() * widths.len().saturating_sub(1)
}

/// Splits `name` into the parts between which it may be folded: after hyphens, at spaces.
fn pieces(name: &str) -> Vec<&str> {
    name.split(' ').flat_map(|word| word.split_inclusive('-')).collect()
}

/// Folds `name` into lines of at most `room` characters, or of one piece.
fn folded(name: &str, room: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for piece in pieces(name) {
        match lines.last_mut() {
            Some(line) => {
                let gap = if line.ends_with('-') { "" } else { " " };
                if length(line) + gap.len() + length(piece) <= room {
                    line.push_str(gap);
                    line.push_str(piece);
                } else {
                    lines.push(piece.to_owned());
                }
            }
            None => lines.push(piece.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        let mut table = Table::new(["start", "random", "normalized-frontier", "complete-corridor"]);
        table.push(["A", "96 (96)", "1265 (1006)", "96 (40)"].map(Into::into).to_vec());
        table.push(["B", "0 (0)", "26 (20)", "0 (24)"].map(Into::into).to_vec());
        table
    }

    #[test]
    fn a_table_is_as_wide_as_it_is_where_there_is_room() {
        assert_eq!(
            aligned(&table(), 1, &[], 80),
            "  start   random  normalized-frontier  complete-corridor
      A  96 (96)          1265 (1006)            96 (40)
      B    0 (0)              26 (20)             0 (24)
"
        );
    }

    #[test]
    fn names_of_columns_are_folded_first() {
        assert_eq!(
            aligned(&table(), 1, &[], 46),
            "                  normalized-  complete-
  start   random     frontier   corridor
      A  96 (96)  1265 (1006)    96 (40)
      B    0 (0)      26 (20)     0 (24)
"
        );
    }

    #[test]
    fn then_columns_stand_in_blocks_beside_the_first() {
        let narrow = aligned(&table(), 1, &[0], 30);
        assert_eq!(
            narrow,
            "                  normalized-
  start   random     frontier
  A      96 (96)  1265 (1006)
  B        0 (0)      26 (20)

         complete-
  start   corridor
  A        96 (40)
  B         0 (24)
"
        );
        assert!(narrow.lines().all(|line| length(line) <= 30));
    }

    #[test]
    fn texts_are_wrapped_between_words() {
        assert_eq!(wrapped("one two three", 2, 9), "  one two\n  three\n");
        assert_eq!(wrapped("unbreakable", 2, 5), "  unbreakable\n");
        assert_eq!(narrowed("a  b\n    one two three\n\n", 12), "a  b\n    one two\n    three\n\n");
    }
}
