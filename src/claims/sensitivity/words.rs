//! The values of settings in words.

use crate::table;
use serde_json::Value;

/// Writes a setting's value as tables and pages show it: numbers shortest, texts without quotes.
pub fn in_words(value: &Value) -> String {
    match (value.as_f64(), value.as_str()) {
        (Some(number), _) => table::Value::from(number).to_string(),
        (None, Some(text)) => text.to_owned(),
        (None, None) => value.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_the_same_words_however_they_are_written() {
        let words = |text: &str| in_words(&serde_json::from_str(text).unwrap());
        assert_eq!(
            ["1.0", "1", "0.25", "\"tag\"", "true"].map(words),
            ["1", "1", "0.25", "tag", "true"]
        );
    }
}
