//! Where two files first differ, in the terms of their kind: cell, value or line.

use crate::table::Table;
use serde_json::Value;

/// The first difference of two unequal files: (what should be there, what is).
pub(super) fn first(path: &str, expected: &[u8], found: &[u8]) -> (String, String) {
    let kind = path.rsplit('.').next().unwrap_or_default();
    let by_kind = match (kind, std::str::from_utf8(expected), std::str::from_utf8(found)) {
        ("csv", Ok(expected), Ok(found)) => cell(expected, found),
        ("json", Ok(expected), Ok(found)) => value(expected, found),
        _ => None,
    };
    by_kind.unwrap_or_else(|| line(expected, found))
}

fn cell(expected: &str, found: &str) -> Option<(String, String)> {
    let (expected, found) = (Table::from_csv(expected).ok()?, Table::from_csv(found).ok()?);
    if expected.columns != found.columns {
        let list = |table: &Table| format!("the columns {}", table.columns.join(", "));
        return Some((list(&expected), list(&found)));
    }
    for (row, (a, b)) in expected.rows.iter().zip(&found.rows).enumerate() {
        for (column, (a, b)) in expected.columns.iter().zip(a.iter().zip(b)) {
            if a.to_string() != b.to_string() {
                return Some((
                    format!("`{a}` in row {}, column `{column}`", row + 1),
                    format!("`{b}`"),
                ));
            }
        }
    }
    let rows = |table: &Table| format!("{} rows", table.rows.len());
    (expected.rows.len() != found.rows.len()).then(|| (rows(&expected), rows(&found)))
}

fn value(expected: &str, found: &str) -> Option<(String, String)> {
    let (expected, found) =
        (serde_json::from_str(expected).ok()?, serde_json::from_str(found).ok()?);
    let (pointer, expected, found) = value_at(String::new(), Some(&expected), Some(&found))?;
    let shown =
        |value: Option<&Value>| value.map_or("nothing".to_owned(), |v| excerpt(&v.to_string()));
    Some((format!("{} at {pointer}", shown(expected)), shown(found)))
}

type Place<'a> = (String, Option<&'a Value>, Option<&'a Value>);

/// The JSON pointer of the first difference, and what stands there.
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

/// The first difference of two records, by measure rather than by byte.
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
                let shown = |line: Option<&str>| line.map_or("its end".to_owned(), excerpt);
                return (format!("{} in line {number}", shown(x)), shown(y));
            }
        }
    }
}

fn excerpt(text: &str) -> String {
    let start: String = text.chars().take(60).collect();
    let more = if start.len() < text.len() { "..." } else { "" };
    let visible: String = start
        .chars()
        .map(|c| if c.is_control() { c.escape_debug().to_string() } else { c.to_string() })
        .collect();
    format!("`{visible}{more}`")
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
    }
}
