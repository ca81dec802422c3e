//! Where two files first differ, in the terms of their kind: cell, value or line.

use crate::json;
use crate::table::Table;
use serde_json::Value;

/// Finds the first difference of two unequal files: (what should be there, what is).
pub(super) fn first(path: &str, expected: &[u8], found: &[u8]) -> (String, String) {
    let kind = path.rsplit('.').next().unwrap_or_default();
    let by_kind = match (kind, std::str::from_utf8(expected), std::str::from_utf8(found)) {
        ("csv", Ok(expected), Ok(found)) => cell(expected, found),
        ("json", Ok(expected), Ok(found)) => value(expected, found),
        _ => None,
    };
    by_kind.unwrap_or_else(|| line(expected, found))
}

/// The longest line (bytes) that is read as a row: one of commas alone takes fifty times its length.
const LONGEST_ROW: usize = 1 << 16;

/// Reads no more than the header and the first row that differs: a table of unknown origin may be all rows.
fn cell(expected: &str, found: &str) -> Option<(String, String)> {
    let row_of = |header: &str, row: &str| {
        let fits = header.len().max(row.len()) <= LONGEST_ROW;
        fits.then(|| Table::from_csv(&format!("{header}\n{row}\n")).ok()).flatten()
    };
    let ((expected_header, expected_rows), (found_header, found_rows)) =
        (expected.split_once('\n')?, found.split_once('\n')?);
    if expected_header != found_header {
        let list = |header: &str| {
            let table = (header.len() <= LONGEST_ROW).then(|| Table::from_csv(header).ok());
            Some(format!("the columns {}", table.flatten()?.columns.join(", ")))
        };
        let (expected, found) = (list(expected_header)?, list(found_header)?);
        return (expected != found.trim_end()).then_some((expected, found));
    }
    let (mut a, mut b) = (expected_rows.lines(), found_rows.lines());
    let mut row = 0;
    loop {
        row += 1;
        match (a.next(), b.next()) {
            (Some(a), Some(b)) if a == b => {}
            (Some(a), Some(b)) => {
                let (a, b) = (row_of(expected_header, a)?, row_of(found_header, b)?);
                let cells = a.rows.first()?.iter().zip(b.rows.first()?);
                let (column, (a, b)) = a
                    .columns
                    .iter()
                    .zip(cells)
                    .find(|(_, (a, b))| a.to_string() != b.to_string())?;
                return Some((format!("`{a}` in row {row}, column `{column}`"), format!("`{b}`")));
            }
            (None, None) => return None,
            _ => {
                let rows = |rows: &str| format!("{} rows", rows.lines().count());
                return Some((rows(expected_rows), rows(found_rows)));
            }
        }
    }
}

fn value(expected: &str, found: &str) -> Option<(String, String)> {
    let (expected, found) =
        (json::read(expected.as_bytes()).ok()?, json::read(found.as_bytes()).ok()?);
    let (pointer, expected, found) = value_at(String::new(), Some(&expected), Some(&found))?;
    let shown =
        |value: Option<&Value>| value.map_or("nothing".to_owned(), |v| excerpt(&v.to_string()));
    Some((format!("{} at {pointer}", shown(expected)), shown(found)))
}

type Place<'a> = (String, Option<&'a Value>, Option<&'a Value>);

/// Finds the JSON pointer of the first difference, and what stands there.
fn value_at<'a>(at: String, a: Option<&'a Value>, b: Option<&'a Value>) -> Option<Place<'a>> {
    match (a, b) {
        (a, b) if a == b => None,
        (Some(Value::Object(x)), Some(Value::Object(y))) => x
            .keys()
            .chain(y.keys().filter(|key| !x.contains_key(*key)))
            .find_map(|key| value_at(format!("{at}/{key}"), x.get(key), y.get(key))),
        (Some(Value::Array(x)), Some(Value::Array(y))) => (0..x.len().max(y.len()))
            .find_map(|i| value_at(format!("{at}/{i}"), x.get(i), y.get(i))),
        _ => Some((if at.is_empty() { "/".to_owned() } else { at }, a, b)),
    }
}

/// Finds the first difference of two records, by measure rather than by byte.
pub(super) fn records(expected: &str, found: &str) -> (String, String) {
    value(expected, found).unwrap_or_else(|| line(expected.as_bytes(), found.as_bytes()))
}

fn line(expected: &[u8], found: &[u8]) -> (String, String) {
    let (a, b) = (String::from_utf8_lossy(expected), String::from_utf8_lossy(found));
    let (mut a_lines, mut b_lines) = (a.split('\n'), b.split('\n'));
    let mut number = 1;
    loop {
        match (a_lines.next(), b_lines.next()) {
            (Some(x), Some(y)) if x == y => number += 1,
            (None, None) => return ("the same bytes".into(), "others".into()),
            (x, y) => {
                let from = beginning(x.unwrap_or_default(), y.unwrap_or_default());
                let shown = |line: Option<&str>| {
                    line.map_or("its end".to_owned(), |line| excerpt_from(line, from))
                };
                return (format!("{} in line {number}", shown(x)), shown(y));
            }
        }
    }
}

/// Returns from which character to show two lines so that what differs is seen: the first, where it is near.
fn beginning(a: &str, b: &str) -> usize {
    let common = a.chars().zip(b.chars()).take_while(|(x, y)| x == y).count();
    if common < 40 { 0 } else { common - 20 }
}

fn excerpt(text: &str) -> String {
    excerpt_from(text, 0)
}

/// Returns sixty characters of `text` from the one at `from`.
fn excerpt_from(text: &str, from: usize) -> String {
    let part: String = text.chars().skip(from).take(60).collect();
    let (less, more) = (
        if from > 0 { "..." } else { "" },
        if text.chars().nth(from + 60).is_some() { "..." } else { "" },
    );
    let visible: String = part
        .chars()
        .map(|c| if c.is_control() { c.escape_debug().to_string() } else { c.to_string() })
        .collect();
    format!("`{less}{visible}{more}`")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_told_in_the_terms_of_the_file() {
        let say = |path, a: &str, b: &str| {
            let (expected, found) = first(path, a.as_bytes(), b.as_bytes());
            format!("{expected} / {found}")
        };
        assert_eq!(
            say("t.csv", "a,b\n1,2\n3,4\n", "a,b\n1,2\n3,5\n"),
            "`4` in row 2, column `b` / `5`"
        );
        assert_eq!(say("t.csv", "a\n1\n", "a\n1\n2\n"), "1 rows / 2 rows");
        assert_eq!(say("t.csv", "a\n1\n", "b\n1\n"), "the columns a / the columns b");
        assert_eq!(say("t.csv", "a\n1\n", "a\r\n1\r\n"), "`a` in line 1 / `a\\r`");
        assert_eq!(say("c.json", r#"{"x":[1,2]}"#, r#"{"x":[1,3]}"#), "`2` at /x/1 / `3`");
        assert_eq!(say("c.json", r#"{"x":1}"#, r#"{"y":1}"#), "`1` at /x / nothing");
        assert_eq!(say("f.svg", "a\nb", "a\n"), "`b` in line 2 / ``");
        assert_eq!(say("f.svg", "a", "a\nb"), "its end in line 2 / `b`");
        let long = "x".repeat(100);
        assert_eq!(
            say("f.svg", &format!("{long}yes"), &format!("{long}no")),
            "`...xxxxxxxxxxxxxxxxxxxxyes` in line 1 / `...xxxxxxxxxxxxxxxxxxxxno`",
            "what differs is seen"
        );
        let many = "1,2\n".repeat(50_000);
        assert_eq!(
            say("t.csv", &format!("a,b\n{many}3,4\n"), &format!("a,b\n{many}3,5\n")),
            "`4` in row 50001, column `b` / `5`"
        );
    }
}
