//! The description of a table's columns: the words and bounds of which a data dictionary is made.

use super::Table;

/// The kind of a column's values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Names.
    Text,
    /// Whole numbers.
    Integer,
    /// Numbers.
    Number,
    /// `true` and `false`.
    Boolean,
}

/// One column of a table, described.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Its name in the header line.
    pub name: String,
    /// The kind of its values.
    pub kind: Kind,
    /// Their unit as SI and its brochure write it, `%` for percent; empty for names, counts, scores and ratios.
    pub unit: String,
    /// The least possible value.
    pub least: Option<f64>,
    /// The greatest possible value.
    pub most: Option<f64>,
    /// The only possible values; empty where that is not known beforehand.
    pub among: Vec<String>,
    /// A regular expression that every value fits.
    pub pattern: Option<&'static str>,
    /// Its meaning, in a sentence.
    pub meaning: String,
    /// When its field is empty; `None` where it never is.
    pub empty: Option<String>,
}

impl Column {
    fn new(name: &str, kind: Kind, unit: &str, meaning: &str) -> Self {
        Self {
            name: name.to_owned(),
            kind,
            unit: unit.to_owned(),
            least: None,
            most: None,
            among: Vec::new(),
            pattern: None,
            meaning: meaning.to_owned(),
            empty: None,
        }
    }

    /// Creates a column of names.
    pub fn text(name: &str, meaning: &str) -> Self {
        Self::new(name, Kind::Text, "", meaning)
    }

    /// Creates a column of numbers in `unit`.
    pub fn number(name: &str, unit: &str, meaning: &str) -> Self {
        Self::new(name, Kind::Number, unit, meaning)
    }

    /// Creates a column of counts: whole and not negative.
    pub fn count(name: &str, meaning: &str) -> Self {
        Self { least: Some(0.0), ..Self::new(name, Kind::Integer, "", meaning) }
    }

    /// Creates a column of numbers from 0 to 100 percent.
    pub fn percent(name: &str, meaning: &str) -> Self {
        Self::number(name, "%", meaning).at_least(0.0).at_most(100.0)
    }

    /// Creates a column of probabilities, 0 to 1.
    pub fn probability(name: &str, meaning: &str) -> Self {
        Self::number(name, "", meaning).at_least(0.0).at_most(1.0)
    }

    /// Returns the same with a least value.
    #[must_use]
    pub fn at_least(self, least: f64) -> Self {
        Self { least: Some(least), ..self }
    }

    /// Returns the same with a greatest value.
    #[must_use]
    pub fn at_most(self, most: f64) -> Self {
        Self { most: Some(most), ..self }
    }

    /// Returns the same, with values that fit `pattern`.
    #[must_use]
    pub fn like(self, pattern: &'static str) -> Self {
        Self { pattern: Some(pattern), ..self }
    }

    /// Returns the same, with `when` for the cases in which it is empty.
    #[must_use]
    pub fn empty_where(self, when: &str) -> Self {
        Self { empty: Some(when.to_owned()), ..self }
    }

    /// Creates a column that has these values and no others: its kind is that of all of them.
    pub fn of_values(name: &str, unit: &str, meaning: &str, values: &[String]) -> Self {
        let all = |fits: fn(&str) -> bool| !values.is_empty() && values.iter().all(|v| fits(v));
        let kind = if all(|v| matches!(v, "true" | "false")) {
            Kind::Boolean
        } else if all(|v| v.parse::<i64>().is_ok_and(|n| n.to_string() == v)) {
            Kind::Integer
        } else if all(|v| v.parse::<f64>().is_ok_and(f64::is_finite)) {
            Kind::Number
        } else {
            Kind::Text
        };
        let among = values.to_vec();
        Self { among, ..Self::new(name, kind, unit, meaning) }
    }

    /// Creates a column of which nothing is known but its name.
    pub fn unknown(name: &str) -> Self {
        Self::text(name, "").empty_where("as its author left it")
    }

    /// Returns its range in words; empty where nothing bounds it.
    pub fn range(&self) -> String {
        if !self.among.is_empty() {
            return self.among.join(", ");
        }
        match (self.least, self.most) {
            (Some(least), Some(most)) => format!("{least} to {most}"),
            (Some(least), None) => format!("{least} or more"),
            (None, Some(most)) => format!("{most} or less"),
            (None, None) => String::new(),
        }
    }
}

/// A table in a file, described.
#[derive(Debug, Clone, PartialEq)]
pub struct DescribedTable {
    /// Path of the CSV file, relative to the dictionary that holds the description.
    pub path: String,
    /// Its title.
    pub title: String,
    /// What one row is.
    pub row: String,
    /// The columns that identify a row among all others; empty where none do.
    pub key: Vec<String>,
    /// The column that names a row of another table, and that table's path: the two are joined on it.
    pub joins: Option<(&'static str, String)>,
    /// Its columns, in their order.
    pub columns: Vec<Column>,
}

impl DescribedTable {
    /// Creates the description of `table`, whose columns `describe` looks up by their names.
    pub fn of(
        table: &Table,
        path: String,
        (title, row): (&str, &str),
        describe: impl Fn(&str) -> Option<Column>,
    ) -> Self {
        let column = |name: &String| describe(name).unwrap_or_else(|| Column::unknown(name));
        Self {
            path,
            title: title.to_owned(),
            row: row.to_owned(),
            key: Vec::new(),
            joins: None,
            columns: table.columns.iter().map(column).collect(),
        }
    }
}

/// Returns the unit that the end of a column's name gives: `distance-m`, `deadline-s`; empty where it gives none.
pub fn unit_of(name: &str) -> &'static str {
    const UNITS: [(&str, &str); 9] = [
        ("-rad-per-m", "rad/m"),
        ("-m-s", "m/s"),
        ("-percent", "%"),
        ("-deg", "°"),
        ("-rad", "rad"),
        ("-hz", "Hz"),
        ("-m2", "m²"),
        ("-m", "m"),
        ("-s", "s"),
    ];
    UNITS.iter().find(|(end, _)| name.ends_with(end)).map_or("", |(_, unit)| unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_columns_kind_is_what_all_of_its_values_are() {
        let kind = |values: &[&str]| {
            let values: Vec<String> = values.iter().map(|v| (*v).to_owned()).collect();
            Column::of_values("x", "", "", &values).kind
        };
        assert_eq!(kind(&["true", "false"]), Kind::Boolean);
        assert_eq!(kind(&["680", "68"]), Kind::Integer);
        assert_eq!(kind(&["0", "0.5"]), Kind::Number);
        assert_eq!(kind(&["0", "none"]), Kind::Text);
        assert_eq!(kind(&["007"]), Kind::Number, "no integer is written so");
        assert_eq!(kind(&[]), Kind::Text);
    }

    #[test]
    fn the_unit_is_the_longest_that_ends_the_name() {
        assert_eq!(unit_of("mean-speed-m-s"), "m/s");
        assert_eq!(unit_of("turning-rad-per-m"), "rad/m");
        assert_eq!(unit_of("node-noise-m"), "m");
        assert_eq!(unit_of("furnished"), "");
    }
}
