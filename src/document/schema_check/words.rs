//! What a schema wants, in words.

use crate::document::{Content, Node};
use serde_json::Value;

/// Returns whether a node is of one of the JSON types that `kinds` (a name or a list of names) allows.
pub(super) fn accepts(kinds: &Value, node: &Node) -> bool {
    let is = |kind: &str| match &node.content {
        Content::Null => kind == "null",
        Content::Bool(_) => kind == "boolean",
        Content::Integer(_) => kind == "integer" || kind == "number",
        Content::Float(_) => kind == "number",
        Content::Text(_) => kind == "string",
        Content::List(_) => kind == "array",
        Content::Map(_) => kind == "object",
    };
    match kinds {
        Value::String(kind) => is(kind),
        Value::Array(kinds) => kinds.iter().filter_map(Value::as_str).any(is),
        _ => true,
    }
}

/// Returns the values a schema is limited to; none where it is not.
pub(super) fn constants(schema: &Value) -> Vec<&Value> {
    let listed = schema.get("enum").and_then(Value::as_array).into_iter().flatten();
    listed.chain(schema.get("const")).collect()
}

/// Returns the first sentence of what a schema says about itself, without its full stop.
pub(super) fn described(schema: &Value) -> Option<String> {
    let text = schema.get("description")?.as_str()?.split("\n\n").next()?.replace('\n', " ");
    let text = text.split(". ").next().unwrap_or_default().trim_end_matches('.').to_owned();
    (!text.is_empty()).then_some(text)
}

/// Says what any of `leaves` wants: `a number or nothing`, ``one of `a`, `b` ``.
pub(super) fn expected(leaves: &[&Value]) -> String {
    let mut words: Vec<String> = Vec::new();
    let mut names: Vec<String> = Vec::new();
    let mut optional = false;
    for leaf in leaves {
        let fixed = constants(leaf);
        if !fixed.is_empty() {
            names.extend(fixed.iter().filter(|v| !v.is_null()).map(|v| match v.as_str() {
                Some(text) => format!("`{text}`"),
                None => format!("`{v}`"),
            }));
            optional |= fixed.iter().any(|v| v.is_null());
            continue;
        }
        let kinds: Vec<&str> = match leaf.get("type") {
            Some(Value::String(kind)) => vec![kind],
            Some(Value::Array(kinds)) => kinds.iter().filter_map(Value::as_str).collect(),
            _ if leaf.get("properties").is_some() => vec!["object"],
            _ => vec!["anything"],
        };
        for kind in kinds {
            let word = match kind {
                "null" => {
                    optional = true;
                    continue;
                }
                "boolean" => "`true` or `false`",
                "integer" => "a whole number",
                "number" => "a number",
                "string" => "text",
                "array" => "a list",
                "object" => "a mapping",
                _ => "a value",
            };
            let mut word = word.to_owned();
            if kind == "object" {
                let keys: Vec<String> = leaf
                    .get("required")
                    .and_then(Value::as_array)
                    .into_iter()
                    .flatten()
                    .filter_map(Value::as_str)
                    .map(|key| format!("`{key}`"))
                    .collect();
                if !keys.is_empty() && keys.len() <= 3 {
                    word = format!("a mapping with {}", keys.join(" and "));
                }
            }
            if !words.contains(&word) {
                words.push(word);
            }
        }
    }
    // `a mapping with a or a mapping with b` reads better short.
    let mut merged: Vec<String> = Vec::new();
    for word in words {
        match (merged.last_mut(), word.strip_prefix("a mapping with ")) {
            (Some(last), Some(rest)) if last.starts_with("a mapping with ") => {
                last.push_str(" or ");
                last.push_str(rest);
            }
            _ => merged.push(word),
        }
    }
    let mut words = merged;
    match names.len() {
        0 => {}
        1 => words.insert(0, names.remove(0)),
        _ => words.insert(0, format!("one of {}", names.join(", "))),
    }
    if words.is_empty() {
        return if optional { "nothing".to_owned() } else { "a value".to_owned() };
    }
    words.join(" or ")
}
