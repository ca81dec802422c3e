//! A condition of a design.

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;
use std::ops::Deref;
use std::sync::Arc;

/// A value for each of some factors, in the manifest's order; a cell of the design has one for every factor.
///
/// ```
/// use reenact::condition::Condition;
///
/// let rows = Condition::from([("environment", "basic")]);
/// let cell = rows.clone().with("prior", "floor-plan");
/// assert!(cell.has_all(&rows));
/// assert_eq!(cell.value("prior"), Some("floor-plan"));
/// assert_eq!(cell.to_string(), "environment=basic prior=floor-plan");
/// ```
///
/// All trials of a cell share the one text of its values: a plan may have a million of them.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Condition(Arc<[(String, String)]>);

impl Default for Condition {
    fn default() -> Self {
        Self(Arc::new([]))
    }
}

impl Serialize for Condition {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.0.as_ref().serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Condition {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Vec::deserialize(deserializer).map(|pairs| Self(pairs.into()))
    }
}

impl Condition {
    /// Returns the value of `factor`.
    pub fn value(&self, factor: &str) -> Option<&str> {
        self.0.iter().find(|(name, _)| name == factor).map(|(_, value)| value.as_str())
    }

    /// Returns whether it has every value of `part`.
    pub fn has_all(&self, part: &Self) -> bool {
        part.0.iter().all(|value| self.0.contains(value))
    }

    /// Adds `value` of `factor` at the end.
    #[must_use]
    pub fn with(self, factor: impl Into<String>, value: impl Into<String>) -> Self {
        self.0.iter().cloned().chain([(factor.into(), value.into())]).collect()
    }

    /// Adds the values of `other` at the end.
    #[must_use]
    pub fn and(self, other: &Self) -> Self {
        self.0.iter().chain(other).cloned().collect()
    }

    /// Returns a file name for this cell: the values joined by underscores, `all` where there is no factor. Only
    /// `[A-Za-z0-9.-]` of each value survive; resolution refuses manifests where two cells clash.
    pub fn slug(&self) -> String {
        let safe = |value: &String| {
            value
                .chars()
                .map(|c| if c.is_ascii_alphanumeric() || ".-".contains(c) { c } else { '-' })
                .collect::<String>()
        };
        let parts: Vec<_> = self.0.iter().map(|(_, value)| safe(value)).collect();
        if parts.is_empty() { "all".to_owned() } else { parts.join("_") }
    }
}

impl Deref for Condition {
    type Target = [(String, String)];

    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl<F: Into<String>, V: Into<String>> FromIterator<(F, V)> for Condition {
    fn from_iter<T: IntoIterator<Item = (F, V)>>(pairs: T) -> Self {
        Self(pairs.into_iter().map(|(factor, value)| (factor.into(), value.into())).collect())
    }
}

impl<F: Into<String>, V: Into<String>, const N: usize> From<[(F, V); N]> for Condition {
    fn from(pairs: [(F, V); N]) -> Self {
        pairs.into_iter().collect()
    }
}

impl<'a> IntoIterator for &'a Condition {
    type Item = &'a (String, String);
    type IntoIter = std::slice::Iter<'a, (String, String)>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.iter()
    }
}

impl fmt::Display for Condition {
    /// Writes the factors as people read them: `prior=floor-plan environment=basic`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts: Vec<_> = self.0.iter().map(|(name, value)| format!("{name}={value}")).collect();
        f.write_str(&parts.join(" "))
    }
}
