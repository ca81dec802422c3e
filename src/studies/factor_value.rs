//! A factor's value, however a manifest writes it.

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, de};
use std::borrow::Cow;

/// A factor's value as text, whatever scalar it was written as: `0.50` is `0.5`, `true` is `true`.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(transparent)]
pub struct FactorValue(pub String);

impl std::fmt::Display for FactorValue {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl<'de> Deserialize<'de> for FactorValue {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Scalar;
        impl de::Visitor<'_> for Scalar {
            type Value = FactorValue;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a number, text, `true` or `false`")
            }
            fn visit_bool<E: de::Error>(self, value: bool) -> Result<FactorValue, E> {
                Ok(FactorValue(value.to_string()))
            }
            fn visit_i64<E: de::Error>(self, value: i64) -> Result<FactorValue, E> {
                Ok(FactorValue(value.to_string()))
            }
            fn visit_u64<E: de::Error>(self, value: u64) -> Result<FactorValue, E> {
                Ok(FactorValue(value.to_string()))
            }
            fn visit_f64<E: de::Error>(self, value: f64) -> Result<FactorValue, E> {
                Ok(FactorValue(if value == 0.0 { 0.0 } else { value }.to_string()))
            }
            fn visit_str<E: de::Error>(self, value: &str) -> Result<FactorValue, E> {
                Ok(FactorValue(value.to_owned()))
            }
        }
        deserializer.deserialize_any(Scalar)
    }
}

impl JsonSchema for FactorValue {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "FactorValue".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({ "type": ["string", "number", "boolean"] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_the_same_however_it_is_written() {
        let read = |json: &str| serde_json::from_str::<FactorValue>(json).unwrap().0;
        assert_eq!(
            ["0.50", "5e-1", "-0.0", "7", "true", "\"x\""].map(read),
            ["0.5", "0.5", "0", "7", "true", "x"]
        );
    }
}
