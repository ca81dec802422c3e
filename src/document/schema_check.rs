//! Holds a tree against the JSON Schema of the type it is meant to be, and collects every fault.
//!
//! Of JSON Schema 2020-12 this knows what `schemars` derives: `$ref`, `type`, `enum`, `const`, `anyOf`,
//! `oneOf`, `allOf`, `properties`, `required`, `additionalProperties`, `unevaluatedProperties`, `items`,
//! `prefixItems`, lengths and ranges. serde itself would stop at the first fault and lose most places.

mod branches;
mod faults;
mod spot;
mod words;

use super::node::{Content, Entry, Node, Place, Tree};
use super::{Diagnostic, Severity, quoted, suggestion};
use faults::{Fault, Faults};
use serde_json::{Map, Value};
use spot::Spot;
use std::collections::BTreeSet;
use words::{accepts, constants, described, expected};

/// Finds every respect in which `tree` differs from `schema`, in the order of the text.
pub fn check(schema: &Value, tree: &Tree) -> Vec<Diagnostic> {
    let no_definitions = Map::new();
    let definitions = schema.get("$defs").and_then(Value::as_object).unwrap_or(&no_definitions);
    let checker = Checker { definitions };
    let kinds = checker.resolve(schema).get("type");
    if kinds.and_then(Value::as_str) == Some("object")
        && !matches!(tree.root.content, Content::Map(_))
    {
        // What it holds is not quoted: it may be any file, named by a slip.
        let found = match &tree.root.content {
            Content::Null => "nothing",
            Content::List(_) => "a list",
            _ => "text",
        };
        let name = &tree.sources[0].name;
        let wanted = expected(&[checker.resolve(schema)]);
        let wanted = wanted.trim_start_matches("a ");
        let message = format!("`{name}`: expected a YAML {wanted}, found {found}");
        return vec![Diagnostic::placeless(message)];
    }
    let mut faults = Faults::default();
    checker.check(schema, Spot::root(&tree.root), &mut faults);
    let left = faults.count() - faults.list.len();
    let mut told = faults.list;
    told.sort_by_key(|fault| fault.place);
    // A key unknown to a flattened choice is unknown to the mapping around it, too.
    told.dedup_by(|b, a| a.place == b.place && a.message == b.message);
    let others = (left > 0).then(|| Diagnostic::others(Severity::Error, left));
    let told = told.into_iter().map(|fault| {
        let mut diagnostic = tree.fault(fault.place, fault.message).label(fault.label);
        diagnostic.help = fault.help;
        diagnostic
    });
    told.chain(others).collect()
}

struct Checker<'s> {
    definitions: &'s Map<String, Value>,
}

impl<'s> Checker<'s> {
    /// Returns the schema itself, where `schema` only refers to one.
    fn resolve(&self, schema: &'s Value) -> &'s Value {
        let mut schema = schema;
        // A chain of references is short; a circle of them is a bug that must not hang a reader.
        for _ in 0..16 {
            let Some(name) = schema.get("$ref").and_then(Value::as_str) else { break };
            let Some(found) =
                name.strip_prefix("#/$defs/").and_then(|name| self.definitions.get(name))
            else {
                break;
            };
            schema = found;
        }
        schema
    }

    fn check(&self, schema: &'s Value, spot: Spot<'_>, faults: &mut Faults) {
        let about = schema;
        let schema = self.resolve(schema);
        if *schema == Value::Bool(false) {
            faults.push(|| spot.fault(format!("{} is not allowed here", spot.name()), ""));
            return;
        }
        if let Some(kinds) = schema.get("type")
            && !accepts(kinds, spot.node)
        {
            faults.push(|| self.wrong_type(&[schema], about, &spot));
            return;
        }
        if let Some(branches) =
            schema.get("anyOf").or_else(|| schema.get("oneOf")).and_then(Value::as_array)
        {
            let own = schema.get("properties").and_then(Value::as_object);
            let outside = own.into_iter().flat_map(Map::keys).map(String::as_str).collect();
            self.check_branches(branches, about, &outside, spot, faults);
        }
        for part in schema.get("allOf").and_then(Value::as_array).into_iter().flatten() {
            self.check(part, spot, faults);
        }
        let known = constants(schema);
        if !known.is_empty() && !known.contains(&&spot.node.to_json()) {
            faults.push(|| unknown_value(&known, &spot));
        }
        match &spot.node.content {
            Content::Integer(_) | Content::Float(_) => check_range(schema, &spot, faults),
            Content::List(items) => self.check_list(schema, items, spot, faults),
            Content::Map(entries) => self.check_map(schema, entries, spot, faults),
            _ => {}
        }
    }

    fn check_list(&self, schema: &'s Value, items: &[Node], spot: Spot<'_>, faults: &mut Faults) {
        let first = schema.get("prefixItems").and_then(Value::as_array);
        for (number, item) in items.iter().enumerate() {
            let item_schema =
                first.and_then(|schemas| schemas.get(number)).or_else(|| schema.get("items"));
            if let Some(item_schema) = item_schema {
                self.check(item_schema, spot.item(number, item), faults);
            }
        }
        let count = items.len() as u64;
        let bound = |name: &str| schema.get(name).and_then(Value::as_u64);
        let wanted = match (bound("minItems"), bound("maxItems")) {
            (Some(least), Some(most)) if least == most && count != least => format!("{least}"),
            (Some(least), _) if count < least => format!("at least {least}"),
            (_, Some(most)) if count > most => format!("at most {most}"),
            _ => return,
        };
        let items = if wanted.ends_with('1') && !wanted.ends_with("11") { "item" } else { "items" };
        let found = if count == 0 { "none".to_owned() } else { count.to_string() };
        faults.push(|| {
            spot.fault(
                format!("{} must have {wanted} {items}, found {found}", spot.name()),
                format!("expected {wanted} {items}"),
            )
        });
    }

    fn check_map(&self, schema: &'s Value, entries: &[Entry], spot: Spot<'_>, faults: &mut Faults) {
        let mut known = BTreeSet::new();
        self.property_names(schema, &mut known);
        let closed = ["additionalProperties", "unevaluatedProperties"]
            .iter()
            .any(|name| schema.get(name) == Some(&Value::Bool(false)));
        let own = schema.get("properties").and_then(Value::as_object);
        let rest = schema.get("additionalProperties").filter(|s| s.is_object());
        let written: BTreeSet<&str> = entries.iter().map(|entry| entry.key.as_str()).collect();
        let unwritten: Vec<&str> = known.iter().copied().filter(|k| !written.contains(k)).collect();
        let mut meant = Vec::new();
        for entry in entries {
            let property = own.and_then(|own| own.get(&entry.key));
            if let Some(property) = property.or(rest.filter(|_| !known.contains(&*entry.key))) {
                self.check(property, spot.entry(entry), faults);
            } else if closed && !known.contains(&*entry.key) {
                faults.push_unknown(entry.key_place, || {
                    let near = suggestion(&entry.key, unwritten.iter().copied());
                    meant.extend(near);
                    unknown_key(&entry.key, entry.key_place, near, &known, &spot)
                });
            }
        }
        for required in schema.get("required").and_then(Value::as_array).into_iter().flatten() {
            let Some(key) = required.as_str() else { continue };
            // A misspelled key is one fault, not two.
            if written.contains(key) || meant.contains(&key) {
                continue;
            }
            faults.push(|| {
                let property = own.and_then(|own| own.get(key)).unwrap_or(&Value::Null);
                let expectation = self.expected_by(property);
                let about =
                    described(property).map_or_else(String::new, |about| format!(": {about}"));
                let message = match spot.path().as_str() {
                    "" => format!("missing key `{key}`"),
                    path => format!("missing key `{key}` in `{path}`"),
                };
                let fault = spot.fault(message, format!("expected `{key}` here")).at(spot.key);
                fault.help(format!("add `{key}`, {expectation}{about}"))
            });
        }
    }

    /// Collects the names of all properties that `schema` or any of its alternatives knows.
    fn property_names(&self, schema: &'s Value, names: &mut BTreeSet<&'s str>) {
        let schema = self.resolve(schema);
        if let Some(own) = schema.get("properties").and_then(Value::as_object) {
            names.extend(own.keys().map(String::as_str));
        }
        for list in ["anyOf", "oneOf", "allOf"] {
            for part in schema.get(list).and_then(Value::as_array).into_iter().flatten() {
                self.property_names(part, names);
            }
        }
    }

    /// Says in words what `schema` wants.
    fn expected_by(&self, schema: &'s Value) -> String {
        let mut leaves = Vec::new();
        self.leaves(schema, &mut leaves, 0);
        expected(&leaves)
    }

    fn wrong_type(&self, leaves: &[&'s Value], about: &'s Value, spot: &Spot<'_>) -> Fault {
        let expectation = expected(leaves);
        let found = match &spot.node.content {
            // The bare number looks right; what is wrong is that it is not whole.
            Content::Float(value) if expectation.contains("whole number") => format!("{value}"),
            _ => spot.node.found(),
        };
        let fault = spot.fault(
            format!("{} must be {expectation}, found {found}", spot.name()),
            format!("expected {expectation}"),
        );
        let wants_number = expectation.contains("number");
        let wants_text = expectation.contains("text");
        let help = match &spot.node.content {
            Content::Text(text) if wants_number && text.parse::<f64>().is_ok() => {
                Some(format!("remove the quotes: {text}"))
            }
            Content::Text(text)
                if wants_number && text.replacen(',', ".", 1).parse::<f64>().is_ok() =>
            {
                Some(format!("the decimal separator is a point: {}", text.replacen(',', ".", 1)))
            }
            Content::Integer(_) | Content::Float(_) | Content::Bool(_) if wants_text => {
                spot.node.scalar_text().map(|text| format!("quote it: \"{text}\""))
            }
            _ => described(about).or_else(|| described(self.resolve(about))),
        };
        match help {
            Some(help) => fault.help(help),
            None => fault,
        }
    }
}

fn unknown_key(
    key: &str,
    place: Place,
    near: Option<&str>,
    known: &BTreeSet<&str>,
    spot: &Spot<'_>,
) -> Fault {
    let label = match spot.path().as_str() {
        "" => "not a key of this document".to_owned(),
        path => format!("not a key of `{path}`"),
    };
    let names: Vec<&str> = known.iter().copied().collect();
    // A path, as `--set` takes it.
    let path = key.split_once('.').filter(|(first, _)| known.contains(first));
    let nested = path.map(|(first, rest)| {
        let steps: Vec<&str> = rest.split('.').collect();
        let inside =
            steps.iter().rev().fold("...".to_owned(), |inner, step| match inner.as_str() {
                "..." => format!("{}: ...", quoted(step)),
                _ => format!("{}: {{{inner}}}", quoted(step)),
            });
        format!("nest it: `{first}: {{{inside}}}`")
    });
    let key = quoted(key);
    let help = nested.unwrap_or_else(|| match near {
        Some(near) => format!("did you mean `{near}`?"),
        None if names.is_empty() => "remove it: nothing is expected here".to_owned(),
        None => format!("known keys: {}", names.join(", ")),
    });
    spot.fault(format!("unknown key `{key}`"), label).at(place).help(help)
}

fn unknown_value(known: &[&Value], spot: &Spot<'_>) -> Fault {
    let names: Vec<String> =
        known.iter().map(|v| v.as_str().map_or_else(|| v.to_string(), str::to_owned)).collect();
    let written = spot.node.scalar_text().unwrap_or_default();
    let list = names.join(", ");
    let near = suggestion(&written, names.iter().map(String::as_str));
    let written = quoted(&written);
    let label = if names.len() == 1 {
        format!("expected `{list}`")
    } else {
        "not one of the known values".to_owned()
    };
    spot.fault(format!("unknown value `{written}` for {}", spot.name()), label).help(match near {
        Some(near) => format!("did you mean `{near}`? (known: {list})"),
        None => format!("known values: {list}"),
    })
}

fn check_range(schema: &Value, spot: &Spot<'_>, faults: &mut Faults) {
    #[expect(clippy::cast_precision_loss, reason = "compared with bounds far below 2^53")]
    let value = match spot.node.content {
        Content::Integer(value) => value as f64,
        Content::Float(value) => value,
        _ => return,
    };
    let bound = |name: &str| schema.get(name).and_then(Value::as_f64);
    let format_bounds = match schema.get("format").and_then(Value::as_str) {
        Some("uint32") => Some((0.0, f64::from(u32::MAX))),
        Some("int32") => Some((f64::from(i32::MIN), f64::from(i32::MAX))),
        _ => None,
    };
    // What the number's width forbids is named only where it is what was violated.
    let least = bound("minimum").or(format_bounds.map(|b| b.0).filter(|&b| value < b));
    let most = bound("maximum").or(format_bounds.map(|b| b.1).filter(|&b| value > b));
    let (above, below) = (bound("exclusiveMinimum"), bound("exclusiveMaximum"));
    let inside = least.is_none_or(|b| value >= b)
        && most.is_none_or(|b| value <= b)
        && above.is_none_or(|b| value > b)
        && below.is_none_or(|b| value < b);
    if inside {
        return;
    }
    let range = match (above, least, most, below) {
        (None, Some(least), Some(most), None) if least == most => format!("exactly {least}"),
        (None, Some(least), Some(most), None) => format!("from {least} to {most}"),
        _ => {
            let low = above.map(|b| format!("above {b}"));
            let low = low.or_else(|| least.map(|b| format!("at least {b}")));
            let high = below.map(|b| format!("below {b}"));
            let high = high.or_else(|| most.map(|b| format!("at most {b}")));
            let range: Vec<String> = low.into_iter().chain(high).collect();
            range.join(" and ")
        }
    };
    faults.push(|| {
        let fault = spot.fault(
            format!("{} must be {range}, found {value}", spot.name()),
            format!("expected a number {range}"),
        );
        match described(schema) {
            Some(about) => fault.help(about),
            None => fault,
        }
    });
}
