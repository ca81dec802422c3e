//! What a trial measured, by name.

use super::STUDIES;
use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::collections::btree_map::{BTreeMap, Iter};
use std::fmt;
use std::iter::Map;
use std::ops::Index;
use std::sync::LazyLock;

/// Measures that are read of one record: ten times what any study of ours has.
const MOST_MEASURES: usize = 4096;

/// Measures with their unit in the name; `None` where a trial never got there.
///
/// A name that a study has is kept once for all records; only a stranger's is a record's own.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Measures(BTreeMap<Cow<'static, str>, Option<f64>>);

/// Returns `name` as records keep it.
fn kept(name: String) -> Cow<'static, str> {
    static KNOWN: LazyLock<BTreeSet<String>> =
        LazyLock::new(|| STUDIES.iter().flat_map(|study| study.measures()).collect());
    match KNOWN.get(&name) {
        Some(known) => Cow::Borrowed(known),
        None => Cow::Owned(name),
    }
}

impl Measures {
    /// Creates none.
    pub const fn new() -> Self {
        Self(BTreeMap::new())
    }

    /// Returns the measure `name`; `None` where the trial says nothing of it, `Some(None)` where it never got there.
    pub fn get(&self, name: &str) -> Option<&Option<f64>> {
        self.0.get(name)
    }

    /// Returns the number that was measured; `None` where there is none.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.get(name).copied().flatten()
    }

    /// Sets the measure `name`.
    pub fn insert(&mut self, name: impl Into<String>, value: Option<f64>) {
        self.0.insert(kept(name.into()), value);
    }

    /// Keeps those whose name `is_kept`.
    pub fn retain(&mut self, is_kept: impl Fn(&str) -> bool) {
        self.0.retain(|name, _| is_kept(name));
    }

    /// Returns all names, sorted.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(AsRef::as_ref)
    }

    /// Returns every measure, sorted by name.
    pub fn iter(&self) -> <&Self as IntoIterator>::IntoIter {
        self.into_iter()
    }

    /// Returns how many there are.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Returns whether there is none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Estimates how much memory they take (bytes) where an allocation takes as much as `allocation` besides what it holds.
    pub(super) fn weight(&self, allocation: usize) -> usize {
        let name = |name: &Cow<'static, str>| match name {
            Cow::Borrowed(_) => 0,
            Cow::Owned(own) => allocation + own.len(),
        };
        let each = |of| size_of::<Cow<'static, str>>() + allocation + name(of);
        self.0.keys().map(each).sum()
    }
}

impl Index<&str> for Measures {
    type Output = Option<f64>;

    fn index(&self, name: &str) -> &Option<f64> {
        &self.0[name]
    }
}

type Entry<'a> = (&'a Cow<'static, str>, &'a Option<f64>);

impl<'a> IntoIterator for &'a Measures {
    type Item = (&'a str, Option<f64>);
    type IntoIter = Map<Iter<'a, Cow<'static, str>, Option<f64>>, fn(Entry<'a>) -> Self::Item>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.iter().map(|(name, value)| (name.as_ref(), *value))
    }
}

impl<N: Into<String>> Extend<(N, Option<f64>)> for Measures {
    fn extend<I: IntoIterator<Item = (N, Option<f64>)>>(&mut self, measures: I) {
        measures.into_iter().for_each(|(name, value)| self.insert(name, value));
    }
}

impl<N: Into<String>> FromIterator<(N, Option<f64>)> for Measures {
    fn from_iter<I: IntoIterator<Item = (N, Option<f64>)>>(measures: I) -> Self {
        let mut all = Self::new();
        all.extend(measures);
        all
    }
}

impl<N: Into<String>, const COUNT: usize> From<[(N, Option<f64>); COUNT]> for Measures {
    fn from(measures: [(N, Option<f64>); COUNT]) -> Self {
        measures.into_iter().collect()
    }
}

/// Reads no more measures than a record has: a map takes many times what its text does.
impl<'de> Deserialize<'de> for Measures {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Few;
        impl<'de> Visitor<'de> for Few {
            type Value = Measures;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("measures by name")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Measures, A::Error> {
                let mut measures = Measures::new();
                while let Some((name, value)) = map.next_entry::<String, _>()? {
                    measures.insert(name, value);
                    if measures.len() > MOST_MEASURES {
                        return Err(Error::custom(format!("more than {MOST_MEASURES} measures")));
                    }
                }
                Ok(measures)
            }
        }
        deserializer.deserialize_map(Few)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_of_a_study_weighs_nothing_and_a_strangers_all_of_it() {
        let weight = |name: &str| Measures::from([(name, None)]).weight(32);
        assert_eq!(weight("time-s"), 24 + 32);
        assert_eq!(weight("000"), 24 + 32 + 32 + 3);
        let read: Measures = serde_json::from_str(r#"{"time-s":1.5,"000":null}"#).unwrap();
        assert_eq!(read.weight(32), weight("time-s") + weight("000"), "read as well as made");
        assert_eq!(serde_json::to_string(&read).unwrap(), r#"{"000":null,"time-s":1.5}"#);
    }
}
