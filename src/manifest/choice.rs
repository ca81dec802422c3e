//! Values that may depend on a factor, and mappings whose order counts.

use crate::studies::FactorValue;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::marker::PhantomData;

/// A value written plainly, or one for every value of a factor.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Choice<T> {
    /// By a factor.
    By(By<T>),
    /// The same for all conditions.
    Plain(T),
}

/// One value for every value of a factor.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct By<T> {
    /// The factor that decides.
    pub by: String,
    /// What holds for each of its values.
    pub values: BTreeMap<String, Choice<T>>,
}

/// The values of a factor.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum FactorDoc {
    /// Crossed with everything.
    List(Levels),
    /// Other values for every value of an earlier factor.
    By(DependentFactor),
    /// Draws of a posterior, numbered from 1.
    Draws(DrawsFactor),
}

/// At least one value.
pub type Levels = Vec<FactorValue>;

/// Other values for every value of an earlier factor.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DependentFactor {
    /// The earlier factor.
    pub by: String,
    /// The values for each of its values.
    pub values: BTreeMap<String, Levels>,
}

/// A factor whose values are draws of what an inference found, numbered from 1: each sets the parameters that were inferred, and
/// the world where that is `{factor: NAME}`.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DrawsFactor {
    /// The manifest of the inference. Its proposals are taken from the store or made first, and sealed.
    pub posterior: String,
    /// How many draws: the middle one of each of as many equal parts of its table `posterior`.
    #[schemars(range(min = 1))]
    pub n: u32,
}

/// A mapping in the order written.
#[derive(Debug, Clone, PartialEq)]
pub struct Ordered<T>(pub Vec<(String, T)>);

impl<T> Default for Ordered<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Ordered<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Entries<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for Entries<T> {
            type Value = Ordered<T>;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a mapping")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Ordered<T>, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                }
                Ok(Ordered(entries))
            }
        }
        deserializer.deserialize_map(Entries(PhantomData))
    }
}

impl<T: JsonSchema> JsonSchema for Ordered<T> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        format!("Ordered_{}", T::schema_name()).into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        BTreeMap::<String, T>::json_schema(generator)
    }
}
