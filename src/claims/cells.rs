//! Which trials a claim speaks of: cells of the design and pools of them.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};
use serde::{Serialize, Serializer};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;

/// One value or a list of values, as text; numbers are written in shortest form (`680`, `0.5`).
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Values(pub Vec<String>);

impl Values {
    /// Makes a single value.
    pub fn one(value: impl Into<String>) -> Self {
        Self(vec![value.into()])
    }
}

impl Values {
    /// Returns each of these as the name of a metric, with the pointer from the form to it.
    pub(crate) fn as_metrics(&self) -> Vec<(String, &str)> {
        let names = self.0.iter().enumerate();
        names.map(|(i, name)| (format!("/metric/{i}"), name.as_str())).collect()
    }
}

impl<'de> Deserialize<'de> for Values {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct OneOrMany;
        impl<'de> Visitor<'de> for OneOrMany {
            type Value = Values;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a value or a list of values")
            }
            fn visit_str<E>(self, text: &str) -> Result<Values, E> {
                Ok(Values::one(text))
            }
            fn visit_bool<E>(self, value: bool) -> Result<Values, E> {
                Ok(Values::one(value.to_string()))
            }
            fn visit_i64<E>(self, value: i64) -> Result<Values, E> {
                Ok(Values::one(value.to_string()))
            }
            fn visit_u64<E>(self, value: u64) -> Result<Values, E> {
                Ok(Values::one(value.to_string()))
            }
            fn visit_f64<E>(self, value: f64) -> Result<Values, E> {
                Ok(Values::one(value.to_string()))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Values, A::Error> {
                let mut all = Vec::new();
                while let Some(Values(mut some)) = seq.next_element()? {
                    all.append(&mut some);
                }
                Ok(Values(all))
            }
        }
        deserializer.deserialize_any(OneOrMany)
    }
}

impl Serialize for Values {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match &self.0[..] {
            [one] => serializer.serialize_str(one),
            many => many.serialize(serializer),
        }
    }
}

impl JsonSchema for Values {
    fn schema_name() -> Cow<'static, str> {
        "Values".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let scalar = serde_json::json!({"type": ["string", "number", "boolean"]});
        json_schema!({"anyOf": [scalar, {"type": "array", "items": scalar, "minItems": 1}]})
    }
}

/// Factor to value or values. Several values are pooled; a factor left out is pooled over all its values.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, serde::Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct Where(pub BTreeMap<String, Values>);

impl Where {
    /// Returns this selection with the factors of `pins` held at one value each.
    #[must_use]
    pub fn pinned(&self, pins: &BTreeMap<String, String>) -> Self {
        let mut all = self.0.clone();
        for (factor, value) in pins {
            all.insert(factor.clone(), Values::one(value.clone()));
        }
        Self(all)
    }

    /// Returns this selection with all factors of `other` replaced by its values.
    #[must_use]
    pub fn replaced(&self, other: &Self) -> Self {
        let mut all = self.0.clone();
        all.extend(other.0.iter().map(|(factor, values)| (factor.clone(), values.clone())));
        Self(all)
    }

    /// Returns every combination of one value per factor, the last factor varying fastest; one empty combination
    /// where no factor is named.
    pub fn combinations(&self) -> Vec<BTreeMap<String, String>> {
        let mut all = vec![BTreeMap::new()];
        for (factor, values) in &self.0 {
            all = all
                .iter()
                .flat_map(|pins: &BTreeMap<String, String>| {
                    values.0.iter().map(move |value| {
                        let mut pins = pins.clone();
                        pins.insert(factor.clone(), value.clone());
                        pins
                    })
                })
                .collect();
        }
        all
    }

    /// Returns whether every condition is selected.
    pub fn is_all(&self) -> bool {
        self.0.is_empty()
    }

    /// Counts the combinations without making them.
    pub fn count(&self) -> usize {
        self.0.values().map(|values| values.0.len()).fold(1, usize::saturating_mul)
    }

    /// Returns whether a condition with these factor values is selected.
    pub fn admits<'a>(&self, value_of: impl Fn(&str) -> Option<&'a str>) -> bool {
        self.0.iter().all(|(factor, values)| {
            value_of(factor).is_some_and(|here| values.0.iter().any(|v| v == here))
        })
    }
}

impl fmt::Display for Where {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() {
            return f.write_str("all trials");
        }
        for (i, (factor, values)) in self.0.iter().enumerate() {
            let comma = if i > 0 { ", " } else { "" };
            write!(f, "{comma}{factor}={}", values.0.join("|"))?;
        }
        Ok(())
    }
}

/// What a claim is repeated over: the combinations of one map, or those of each map of a list.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ForEach(pub Vec<Where>);

impl ForEach {
    /// Returns all combinations in order; one empty combination where nothing is named.
    pub fn combinations(&self) -> Vec<BTreeMap<String, String>> {
        if self.0.is_empty() {
            return vec![BTreeMap::new()];
        }
        self.0.iter().flat_map(Where::combinations).collect()
    }

    /// Returns the pools that `cells` yields, over all combinations.
    pub(crate) fn pools<P: IntoIterator<Item = Where>>(
        &self,
        cells: impl Fn(&BTreeMap<String, String>) -> P,
    ) -> Vec<Where> {
        self.combinations().iter().flat_map(cells).collect()
    }

    /// Returns the `named` selections of a form, and after them those that it is repeated over; each with the pointer from
    /// the form.
    pub(crate) fn after<'a>(
        &'a self,
        named: impl IntoIterator<Item = (&'static str, &'a Where)>,
    ) -> Vec<(String, &'a Where)> {
        let named = named.into_iter().map(|(path, cell)| (path.to_owned(), cell));
        let repeated = self.0.iter().enumerate();
        named.chain(repeated.map(|(i, cell)| (format!("/for-each/{i}"), cell))).collect()
    }
}

impl<'de> Deserialize<'de> for ForEach {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct MapOrList;
        impl<'de> Visitor<'de> for MapOrList {
            type Value = ForEach;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a map of factors to values or a list of such maps")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<ForEach, A::Error> {
                let mut factors = BTreeMap::new();
                while let Some((factor, values)) = map.next_entry()? {
                    factors.insert(factor, values);
                }
                Ok(ForEach(vec![Where(factors)]))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<ForEach, A::Error> {
                let mut all = Vec::new();
                while let Some(one) = seq.next_element()? {
                    all.push(one);
                }
                Ok(ForEach(all))
            }
        }
        deserializer.deserialize_any(MapOrList)
    }
}

impl Serialize for ForEach {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.0.serialize(serializer)
    }
}

impl JsonSchema for ForEach {
    fn schema_name() -> Cow<'static, str> {
        "ForEach".into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let one = generator.subschema_for::<Where>();
        json_schema!({"anyOf": [one, {"type": "array", "items": one}]})
    }
}

/// The other side of a comparison.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, serde::Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Than {
    /// Which trials.
    pub r#where: Where,
    /// Factors whose values are compared with one by one instead of pooled.
    #[serde(default)]
    pub each: Vec<String>,
}

impl Than {
    /// Returns the cells to compare with, one where `each` is empty.
    pub fn cells(&self) -> Vec<Where> {
        let listed = Where(
            self.r#where
                .0
                .iter()
                .filter(|(factor, _)| self.each.contains(factor))
                .map(|(factor, values)| (factor.clone(), values.clone()))
                .collect(),
        );
        listed.combinations().iter().map(|pins| self.r#where.pinned(pins)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse<T: for<'de> Deserialize<'de>>(text: &str) -> T {
        serde_yaml::from_str(text).unwrap()
    }

    #[test]
    fn scalars_and_lists_read_alike() {
        let cell: Where = parse("{start: C, deadline-s: [680, 0.50], furnished: true}");
        assert_eq!(cell.to_string(), "deadline-s=680|0.5, furnished=true, start=C");
        assert_eq!(
            serde_json::to_string(&cell).unwrap(),
            r#"{"deadline-s":["680","0.5"],"furnished":"true","start":"C"}"#
        );
        assert_eq!(Where::default().to_string(), "all trials");
    }

    #[test]
    fn combinations_cross_within_a_map_and_add_up_over_a_list() {
        let crossed: ForEach = parse("{a: [1, 2], b: [u, v, w]}");
        assert_eq!(crossed.combinations().len(), 6);
        let listed: ForEach = parse("[{a: 1, b: u}, {a: 2, b: [v, w]}]");
        assert_eq!(listed.combinations().len(), 3);
        assert_eq!(ForEach::default().combinations(), vec![BTreeMap::new()]);
    }

    #[test]
    fn the_other_side_is_pooled_or_taken_one_by_one() {
        let pooled: Than = parse("{where: {start: [A, B], strategy: [f, g]}}");
        assert_eq!(pooled.cells().len(), 1);
        let apart: Than = parse("{where: {start: [A, B], strategy: [f, g]}, each: [strategy]}");
        let names: Vec<_> = apart.cells().iter().map(ToString::to_string).collect();
        assert_eq!(names, ["start=A|B, strategy=f", "start=A|B, strategy=g"]);
    }
}
