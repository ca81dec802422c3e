//! Canonical JSON: the one text a value has, used for records and for everything that is hashed.
//!
//! Keys sorted bytewise, no white space, numbers in shortest round-trip form, `-0` written as `0`,
//! strings escaped as `serde_json` does. Injective: two values have the same text only if they are equal,
//! because JSON delimits every part.

mod as_written;

pub use as_written::AsWritten;

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

/// Writes the canonical text of `value`, without a final newline.
pub fn canonical(value: &Value) -> String {
    let mut text = String::new();
    write(value, &mut text);
    text
}

/// Writes the canonical text of anything serialisable.
///
/// # Panics
/// Where `value` cannot be JSON at all (a map with non-string keys); non-finite floats become `null`,
/// which resolution has ruled out before.
pub fn canonical_of<T: Serialize>(value: &T) -> String {
    canonical(&value_of(value))
}

/// Returns anything serialisable as plain JSON.
///
/// # Panics
/// As [`canonical_of`].
pub fn value_of<T: Serialize>(value: &T) -> Value {
    serde_json::to_value(value).expect("our own types serialise to JSON")
}

/// Breaks canonical JSON into indented lines with a final line feed, for people and for line-wise tools; the text of
/// every value stays as it is.
pub fn indented(canonical: &str) -> String {
    let (mut out, mut depth, mut quoted, mut escaped) = (String::new(), 0_usize, false, false);
    let mut characters = canonical.chars().peekable();
    while let Some(c) = characters.next() {
        if quoted {
            out.push(c);
            quoted = escaped || c != '"';
            escaped = c == '\\' && !escaped;
            continue;
        }
        match c {
            '{' | '[' if matches!(characters.peek(), Some('}' | ']')) => {
                out.push(c);
                out.extend(characters.next());
            }
            '{' | '[' => {
                depth += 1;
                out.push(c);
                out.push('\n');
                out.push_str(&"  ".repeat(depth));
            }
            '}' | ']' => {
                depth -= 1;
                out.push('\n');
                out.push_str(&"  ".repeat(depth));
                out.push(c);
            }
            ',' => {
                out.push_str(",\n");
                out.push_str(&"  ".repeat(depth));
            }
            ':' => out.push_str(": "),
            '"' => {
                quoted = true;
                out.push(c);
            }
            _ => out.push(c),
        }
    }
    out.push('\n');
    out
}

/// Estimates how much memory (bytes) the tree of a JSON text takes, never much less: a text of small objects takes a
/// hundred times its own length. To be asked before text of unknown origin is parsed to a [`Value`].
pub fn weight(text: &[u8]) -> u64 {
    // What `serde_json` allocates: a node of eleven entries for the smallest map, four elements for the smallest list,
    // and an element (doubled while its list grows) with the start of its text.
    const OBJECT: u64 = 680;
    const ARRAY: u64 = 128;
    const ELEMENT: u64 = 96;
    let (mut quoted, mut escaped) = (false, false);
    let mut weight = text.len() as u64;
    for byte in text {
        match (byte, quoted) {
            (b'"', true) => quoted = escaped,
            (b'"', false) => quoted = true,
            (b'{', false) => weight += OBJECT,
            (b'[', false) => weight += ARRAY,
            (b',', false) => weight += ELEMENT,
            _ => {}
        }
        escaped = *byte == b'\\' && quoted && !escaped;
    }
    weight
}

/// The most memory (bytes) that a JSON document of unknown origin may take.
const HEAVIEST: u64 = 64 << 20;

/// Why a JSON document of unknown origin is not read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// It would take more memory than any document that this program writes.
    #[error(
        "a document of {bytes} bytes that would take about {mebibytes} MiB of memory, more than the {} MiB allowed",
        HEAVIEST >> 20
    )]
    TooHeavy {
        /// Length of the text (bytes).
        bytes: usize,
        /// About how much memory it would take (MiB).
        mebibytes: u64,
    },
    /// It is no JSON, or not of the type.
    #[error(transparent)]
    Other(#[from] serde_json::Error),
}

/// Reads JSON of unknown origin into a type that may hold a [`Value`].
///
/// # Errors
/// As [`ReadError`] says.
pub fn read<T: DeserializeOwned>(text: &[u8]) -> Result<T, ReadError> {
    let weight = weight(text);
    if weight > HEAVIEST {
        return Err(ReadError::TooHeavy { bytes: text.len(), mebibytes: weight >> 20 });
    }
    Ok(serde_json::from_slice(text)?)
}

fn write(value: &Value, out: &mut String) {
    match value {
        Value::Object(map) => {
            let mut entries: Vec<_> = map.iter().collect();
            entries.sort_by(|a, b| a.0.as_bytes().cmp(b.0.as_bytes()));
            out.push('{');
            for (i, (key, item)) in entries.into_iter().enumerate() {
                if i > 0 {
                    out.push(',');
                }
                write_text(key, out);
                out.push(':');
                write(item, out);
            }
            out.push('}');
        }
        Value::Array(items) => {
            out.push('[');
            for (i, item) in items.iter().enumerate() {
                if i > 0 {
                    out.push(',');
                }
                write(item, out);
            }
            out.push(']');
        }
        Value::Number(number) => match number.as_f64() {
            Some(x) if number.is_f64() && x == 0.0 => out.push('0'),
            // A whole float and the integer of the same value are the same meaning: write both alike.
            Some(x) if number.is_f64() && x.fract() == 0.0 && x.abs() < 1e15 => {
                #[expect(clippy::cast_possible_truncation, reason = "whole and below 2^53")]
                let whole = x as i64;
                out.push_str(&whole.to_string());
            }
            // Not serde_json's own text: its form of large exponents is not promised to stay.
            Some(x) if number.is_f64() && !(1e-5..1e17).contains(&x.abs()) => {
                out.push_str(&format!("{x:e}"));
            }
            Some(x) if number.is_f64() => out.push_str(&x.to_string()),
            _ => out.push_str(&number.to_string()),
        },
        Value::String(text) => write_text(text, out),
        other => out.push_str(&other.to_string()),
    }
}

fn write_text(text: &str, out: &mut String) {
    // Nearly all of it: names, words and digests, of which a record has hundreds.
    if text.bytes().all(|byte| byte >= b' ' && byte != b'"' && byte != b'\\') {
        out.push('"');
        out.push_str(text);
        out.push('"');
    } else {
        out.push_str(&Value::from(text).to_string());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn keys_are_sorted_and_numbers_have_one_form() {
        assert_eq!(
            canonical(&json!({"b": 1.0, "a": [-0.0, 0.1, 1e300, 1e-7, null, "x\n"], "é": true})),
            r#"{"a":[0,0.1,1e300,1e-7,null,"x\n"],"b":1,"é":true}"#
        );
    }

    #[test]
    fn texts_are_escaped_as_serde_json_does() {
        let text: String = ('\0'..='\u{a0}').chain("é\u{2028}\u{1f916}".chars()).collect();
        let each = text.chars().map(String::from).chain([text.clone()]);
        let texts: Vec<String> = each.collect();
        assert_eq!(canonical(&json!(texts)), serde_json::to_string(&texts).unwrap());
    }

    #[test]
    fn documents_that_would_fill_the_memory_are_not_parsed() {
        assert_eq!(weight(br#"{"a,{":[1,2,"\"{,"]}"#), 20 + 680 + 128 + 2 * 96);
        let bomb = format!("[{}0]", r#"{"":0},"#.repeat(100_000));
        assert_eq!(
            read::<Value>(bomb.as_bytes()).unwrap_err().to_string(),
            "a document of 700003 bytes that would take about 74 MiB of memory, more than the 64 MiB allowed"
        );
        assert_eq!(read::<Value>(b"[1]").unwrap(), json!([1]));
        let torn = read::<Value>(b"[1").unwrap_err().to_string();
        assert!(torn.starts_with("EOF while parsing a list"), "{torn}");
    }

    #[test]
    fn near_misses_differ() {
        assert_ne!(canonical(&json!(["ab", "c"])), canonical(&json!(["a", "bc"])));
        assert_ne!(canonical(&json!({"a": "1"})), canonical(&json!({"a": 1})));
    }

    #[test]
    fn indentation_changes_no_value() {
        let value = json!({"a": [1, {}, [], "x\\\",{[:"], "b": {"c": null, "d": 1e300}});
        let text = indented(&canonical(&value));
        assert_eq!(serde_json::from_str::<Value>(&text).unwrap(), value);
        assert_eq!(
            text,
            "{\n  \"a\": [\n    1,\n    {},\n    [],\n    \"x\\\\\\\",{[:\"\n  ],\n  \"b\": {\n    \"c\": null,\n    \"d\": 1e300\n  }\n}\n"
        );
    }
}
