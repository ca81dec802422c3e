//! Tables with named columns and one canonical text form each for CSV and Markdown.

mod column;

pub use column::{Column, DescribedTable, Kind, unit_of};

use serde::{Deserialize, Serialize};

/// One entry of a table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Value {
    /// Nothing: not reached, not applicable. An empty field in CSV.
    Missing,
    /// A whole number.
    Integer(i64),
    /// A finite number, written in shortest round-trip form.
    Number(f64),
    /// A name.
    Text(String),
}

impl Value {
    /// Returns the number, if the value is one.
    pub fn as_f64(&self) -> Option<f64> {
        match self {
            #[expect(clippy::cast_precision_loss, reason = "counts stay far below 2^53")]
            Self::Integer(n) => Some(*n as f64),
            Self::Number(x) => Some(*x),
            Self::Missing | Self::Text(_) => None,
        }
    }
}

impl std::fmt::Display for Value {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Missing => Ok(()),
            Self::Integer(n) => write!(f, "{n}"),
            // Minus zero would be a second text for the same number.
            Self::Number(x) => write!(f, "{}", if *x == 0.0 { 0.0 } else { *x }),
            Self::Text(text) => f.write_str(text),
        }
    }
}

impl From<&str> for Value {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Value {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<f64> for Value {
    fn from(x: f64) -> Self {
        if x.is_finite() { Self::Number(x) } else { Self::Missing }
    }
}

impl From<i64> for Value {
    fn from(n: i64) -> Self {
        Self::Integer(n)
    }
}

impl<T: Into<Value>> From<Option<T>> for Value {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Missing, Into::into)
    }
}

/// Named columns and rows of values. Units stand in the column names (`distance-m`).
///
/// ```
/// use reenact::table::{Table, Value};
///
/// let mut table = Table::new(["prior", "distance-m"]);
/// table.push(vec!["none".into(), 71.5.into()]);
/// table.push(vec!["floor-plan".into(), Value::Missing]);
/// assert_eq!(table.to_csv(), "prior,distance-m\nnone,71.5\nfloor-plan,\n");
/// assert_eq!(Table::from_csv(&table.to_csv()), Ok(table));
/// ```
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Table {
    /// Column names, unique.
    pub columns: Vec<String>,
    /// Rows, each as long as `columns`.
    pub rows: Vec<Vec<Value>>,
}

/// Writes a line of CSV (RFC 4180), ended by a line feed.
pub fn csv_line(fields: impl Iterator<Item = String>) -> String {
    let mut line = String::new();
    for (i, field) in fields.enumerate() {
        if i > 0 {
            line.push(',');
        }
        if field.contains([',', '"', '\n', '\r']) {
            line.push('"');
            line.push_str(&field.replace('"', "\"\""));
            line.push('"');
        } else {
            line.push_str(&field);
        }
    }
    line.push('\n');
    line
}

/// Why a text is not a table.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {problem}")]
pub struct TableError {
    /// One-based line in the text.
    pub line: usize,
    /// What is wrong, expected and found.
    pub problem: String,
}

impl Table {
    /// Returns an empty table of these columns.
    pub fn new<S: Into<String>>(columns: impl IntoIterator<Item = S>) -> Self {
        Self { columns: columns.into_iter().map(Into::into).collect(), rows: Vec::new() }
    }

    /// Appends a row.
    ///
    /// # Panics
    /// Where the row is not as long as the columns.
    pub fn push(&mut self, row: Vec<Value>) {
        assert_eq!(row.len(), self.columns.len(), "a row has one value per column");
        self.rows.push(row);
    }

    /// Returns the position of the column `name`.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|c| c == name)
    }

    /// Returns the value of `row` in the column `name`; missing where there is no such column.
    pub fn value<'a>(&'a self, row: &'a [Value], name: &str) -> &'a Value {
        self.column(name).map_or(&Value::Missing, |i| &row[i])
    }

    /// Writes RFC 4180 with LF line ends and a header line.
    pub fn to_csv(&self) -> String {
        let mut text = csv_line(self.columns.iter().cloned());
        for row in &self.rows {
            text.push_str(&csv_line(row.iter().map(ToString::to_string)));
        }
        text
    }

    /// Reads RFC 4180 text with a header line. Fields that are numbers become numbers, empty ones missing.
    ///
    /// # Errors
    /// Where a row is longer or shorter than the header, a column is named twice or a quote stays open.
    pub fn from_csv(text: &str) -> Result<Self, TableError> {
        let mut records = parse_csv(text)?.into_iter();
        let Some((_, columns)) = records.next() else {
            return Err(TableError {
                line: 1,
                problem: "expected a header line, found nothing".into(),
            });
        };
        if let Some(twice) = columns.iter().enumerate().find(|(i, c)| columns[..*i].contains(c)) {
            return Err(TableError {
                line: 1,
                problem: format!("column `{}` is named twice", twice.1),
            });
        }
        let mut table = Self::new(columns);
        for (line, fields) in records {
            if fields.len() != table.columns.len() {
                let problem =
                    format!("expected {} fields, found {}", table.columns.len(), fields.len());
                return Err(TableError { line, problem });
            }
            table.rows.push(fields.into_iter().map(value_of).collect());
        }
        Ok(table)
    }

    /// Writes a GitHub-flavoured Markdown table, columns padded to equal width.
    pub fn to_markdown(&self) -> String {
        let text = |value: &Value| value.to_string().replace('|', "\\|");
        let mut widths: Vec<usize> =
            self.columns.iter().map(|c| c.chars().count().max(3)).collect();
        for row in &self.rows {
            for (width, value) in widths.iter_mut().zip(row) {
                *width = (*width).max(text(value).chars().count());
            }
        }
        let mut out = String::new();
        let mut line = |fields: &mut dyn Iterator<Item = String>| {
            out.push('|');
            for (field, width) in fields.zip(&widths) {
                out.push_str(&format!(" {field:<width$} |"));
            }
            out.push('\n');
        };
        line(&mut self.columns.iter().cloned());
        line(&mut widths.iter().map(|&w| "-".repeat(w)));
        for row in &self.rows {
            line(&mut row.iter().map(text));
        }
        out
    }
}

fn value_of(field: String) -> Value {
    if field.is_empty() {
        return Value::Missing;
    }
    if let Ok(n) = field.parse::<i64>() {
        return Value::Integer(n);
    }
    match field.parse::<f64>() {
        Ok(x)
            if x.is_finite()
                && field.starts_with(|c: char| c.is_ascii_digit() || c == '-' || c == '.') =>
        {
            Value::Number(x)
        }
        _ => Value::Text(field),
    }
}

/// Splits the text into records, each with the line on which it begins.
fn parse_csv(text: &str) -> Result<Vec<(usize, Vec<String>)>, TableError> {
    let mut records = Vec::new();
    let (mut fields, mut field, mut line, mut begun) = (Vec::new(), String::new(), 1, 1);
    let mut quoted_since = None;
    let mut characters = text.chars().peekable();
    while let Some(character) = characters.next() {
        match (character, quoted_since) {
            ('"', Some(_)) if characters.peek() == Some(&'"') => {
                characters.next();
                field.push('"');
            }
            ('"', Some(_)) => quoted_since = None,
            ('"', None) if field.is_empty() => quoted_since = Some(line),
            (',', None) => fields.push(std::mem::take(&mut field)),
            ('\r', None) if characters.peek() == Some(&'\n') => {}
            ('\n', None) => {
                fields.push(std::mem::take(&mut field));
                records.push((begun, std::mem::take(&mut fields)));
                line += 1;
                begun = line;
            }
            (other, _) => {
                if other == '\n' {
                    line += 1;
                }
                field.push(other);
            }
        }
    }
    if let Some(line) = quoted_since {
        return Err(TableError { line, problem: "a quoted field is never closed".into() });
    }
    if !field.is_empty() || !fields.is_empty() {
        fields.push(field);
        records.push((begun, fields));
    }
    Ok(records)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn faults_are_named_with_their_line() {
        let fault = |text: &str| Table::from_csv(text).unwrap_err().to_string();
        assert_eq!(fault(""), "line 1: expected a header line, found nothing");
        assert_eq!(fault("a,b\n1,2\n3\n"), "line 3: expected 2 fields, found 1");
        assert_eq!(fault("a,a\n"), "line 1: column `a` is named twice");
        assert_eq!(fault("a\n\"x\ny\n"), "line 2: a quoted field is never closed");
    }

    #[test]
    fn markdown_is_padded() {
        let mut table = Table::new(["coverage", "D"]);
        table.push(vec!["70%".into(), 7.25.into()]);
        assert_eq!(
            table.to_markdown(),
            "| coverage | D    |\n| -------- | ---- |\n| 70%      | 7.25 |\n"
        );
    }

    proptest! {
        #[test]
        fn csv_round_trips(rows in prop::collection::vec(("[ -~\n]{0,8}", any::<i64>(), -1e9_f64..1e9), 0..6)) {
            let mut table = Table::new(["text", "integer", "number"]);
            for (text, integer, number) in rows {
                // A text that reads as a number comes back as one; that is all CSV can express.
                table.push(vec![value_of(format!("x{text}")), integer.into(), number.into()]);
            }
            let back = Table::from_csv(&table.to_csv()).unwrap();
            prop_assert_eq!(back.columns, table.columns);
            for (a, b) in back.rows.iter().flatten().zip(table.rows.iter().flatten()) {
                prop_assert_eq!(a.to_string(), b.to_string());
            }
        }

        #[test]
        fn any_text_is_parsed_or_refused(text in "[a\",\n\r1.]{0,40}") {
            let _ = Table::from_csv(&text);
        }
    }
}
