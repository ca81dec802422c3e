//! A study's parameters as written: every value plain, with a reason, or by a factor.

use super::faults::step;
use crate::document::Node;
use crate::studies::StudyKind;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::Deserialize;
use serde_json::{Map, Value, json};
use std::borrow::Cow;

/// Parameters as written, their values still wrapped.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(transparent)]
pub struct ParametersDoc(pub Map<String, Value>);

/// Returns whether this is a value in one of the forms that [`Wrapped`] knows, not a group of parameters.
pub(super) fn is_wrapped(node: &Node) -> bool {
    ["value", "factor", "by", "points"].iter().any(|key| node.get(key).is_some())
}

/// One value that is written with a reason or by a factor.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Wrapped<'a> {
    /// JSON pointer from the manifest's root.
    pub(super) pointer: String,
    /// Why the value was chosen.
    pub(super) why: Option<&'a str>,
    /// Other values that could as well have been chosen.
    pub(super) range: &'a [Value],
    /// The value, or one for every value of a factor.
    pub(super) value: WrappedValue<'a>,
}

/// What is wrapped.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum WrappedValue<'a> {
    /// The same for all conditions.
    Plain(&'a Value),
    /// By a factor.
    By {
        /// The factor.
        factor: &'a str,
        /// Value of the factor to value of the parameter, which may be wrapped itself.
        values: &'a Map<String, Value>,
        /// For the values of the factor that are not named, if there is one.
        otherwise: Option<&'a Value>,
    },
    /// The value of this factor itself.
    Factor(&'a str),
    /// A number computed from one that was drawn.
    Drawn(Computed<'a>),
}

/// A number that is computed from one that was drawn, which is named by its factor and path: `draw.graph.time-scale`.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Computed<'a> {
    /// A value divided by it.
    Divided {
        /// The value.
        value: f64,
        /// The number that was drawn.
        by: &'a str,
    },
    /// A line through points, read at it.
    Read {
        /// The points: numbers as drawn, increasing, each with the value there.
        points: Vec<[f64; 2]>,
        /// The number that was drawn.
        at: &'a str,
    },
}

impl Computed<'_> {
    /// Returns the number that was drawn by its name, and the key at which that stands.
    pub(super) fn reference(&self) -> (&str, &'static str) {
        match self {
            Self::Divided { by, .. } => (by, "divided-by"),
            Self::Read { at, .. } => (at, "at"),
        }
    }

    /// Computes it where this was `drawn`; `None` where there is no such number.
    pub(super) fn at(&self, drawn: f64) -> Option<f64> {
        let computed = match self {
            Self::Divided { value, .. } => value / drawn,
            Self::Read { points, .. } => {
                let upper = points.iter().position(|[x, _]| drawn <= *x)?;
                match (points[upper], upper.checked_sub(1).map(|lower| points[lower])) {
                    ([x, y], _) if drawn == x => y,
                    ([x1, y1], Some([x0, y0])) => y0 + (y1 - y0) * (drawn - x0) / (x1 - x0),
                    (_, None) => return None,
                }
            }
        };
        computed.is_finite().then_some(computed)
    }

    /// Returns what stands in where it cannot be computed, which has been told: a parameter left out would be told once more.
    fn undrawn(&self) -> f64 {
        match self {
            Self::Divided { value, .. } => *value,
            Self::Read { points, .. } => points.first().map_or(0.0, |[_, value]| *value),
        }
    }

    /// Returns it as a manifest writes it, without its reason.
    pub(super) fn to_json(&self) -> Value {
        match self {
            Self::Divided { value, by } => json!({ "value": value, "divided-by": by }),
            Self::Read { points, at } => json!({ "points": points, "at": at }),
        }
    }
}

/// What values are taken out by: what holds in one condition.
pub(super) struct Here<'f, 'c> {
    /// The value of a factor.
    pub(super) level: &'f dyn Fn(&str) -> Option<&'c str>,
    /// A number that was drawn, by its name.
    pub(super) drawn: &'f dyn Fn(&str) -> Option<f64>,
}

impl ParametersDoc {
    /// Returns all values that are not plain, in the order of their pointers.
    pub(super) fn wrapped(&self, kind: StudyKind) -> Vec<Wrapped<'_>> {
        let mut found = Vec::new();
        collect(&self.0, &groups(kind), "/parameters", &mut found);
        found
    }

    /// Returns the parameters for one condition: wrapped values taken out by what holds `here`.
    pub(super) fn for_condition(&self, groups: &Groups, here: &Here<'_, '_>) -> Value {
        Value::Object(unwrap_all(&self.0, groups, here))
    }
}

/// The parameters' tree of groups: what is an object is a group, the rest are values.
pub(super) type Groups = Map<String, Value>;

/// Returns the groups of a study: its defaults.
pub(super) fn groups(kind: StudyKind) -> Groups {
    match kind.defaults() {
        Value::Object(groups) => groups,
        _ => Map::new(),
    }
}

fn wrap<'a>(value: &'a Value, pointer: &str) -> Option<Wrapped<'a>> {
    let map = value.as_object()?;
    let why = map.get("why").and_then(Value::as_str);
    let range = map.get("range").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let text = |key: &str| map.get(key).and_then(Value::as_str);
    if let (Some(value), Some(by)) = (map.get("value"), text("divided-by")) {
        let value = WrappedValue::Drawn(Computed::Divided { value: value.as_f64()?, by });
        return Some(Wrapped { pointer: pointer.to_owned(), why, range, value });
    }
    if let (Some(points), Some(at)) = (map.get("points"), text("at")) {
        let points = serde_json::from_value(points.clone()).ok()?;
        let value = WrappedValue::Drawn(Computed::Read { points, at });
        return Some(Wrapped { pointer: pointer.to_owned(), why, range, value });
    }
    let value = match (map.get("value"), map.get("factor"), map.get("by"), map.get("values")) {
        (Some(value), None, None, None) => WrappedValue::Plain(value),
        (None, Some(factor), None, None) => WrappedValue::Factor(factor.as_str()?),
        (None, None, Some(by), Some(values)) => {
            let otherwise = map.get("otherwise");
            WrappedValue::By { factor: by.as_str()?, values: values.as_object()?, otherwise }
        }
        _ => return None,
    };
    Some(Wrapped { pointer: pointer.to_owned(), why, range, value })
}

fn collect<'a>(
    written: &'a Map<String, Value>,
    groups: &Groups,
    pointer: &str,
    found: &mut Vec<Wrapped<'a>>,
) {
    for (key, value) in written {
        let pointer = format!("{pointer}/{key}");
        match (value, groups.get(key)) {
            (Value::Object(inner), Some(Value::Object(group))) => {
                collect(inner, group, &pointer, found);
            }
            _ => collect_wrapped(value, &pointer, found),
        }
    }
}

/// Collects `value`, where it is wrapped, and what is wrapped in it.
fn collect_wrapped<'a>(value: &'a Value, pointer: &str, found: &mut Vec<Wrapped<'a>>) {
    let Some(wrapped) = wrap(value, pointer) else { return };
    let inner = match &wrapped.value {
        WrappedValue::By { values, .. } => Some(*values),
        WrappedValue::Plain(_) | WrappedValue::Factor(_) | WrappedValue::Drawn(_) => None,
    };
    found.push(wrapped);
    for (level, value) in inner.into_iter().flatten() {
        collect_wrapped(value, &step(&format!("{pointer}/values"), level), found);
    }
}

fn unwrap_all(
    written: &Map<String, Value>,
    groups: &Groups,
    here: &Here<'_, '_>,
) -> Map<String, Value> {
    let mut plain = Map::new();
    for (key, value) in written {
        let value = match (value, groups.get(key)) {
            (Value::Object(inner), Some(Value::Object(group))) => {
                Some(Value::Object(unwrap_all(inner, group, here)))
            }
            _ => unwrap(value, here),
        };
        plain.extend(value.map(|value| (key.clone(), value)));
    }
    plain
}

/// Returns what is wrapped in `value`, itself where nothing is; `None` where no value of a factor has one.
fn unwrap(value: &Value, here: &Here<'_, '_>) -> Option<Value> {
    match wrap(value, "").map(|wrapped| wrapped.value) {
        None => Some(value.clone()),
        Some(WrappedValue::Plain(value)) => Some(value.clone()),
        Some(WrappedValue::By { factor, values, otherwise }) => {
            let chosen = (here.level)(factor).and_then(|level| values.get(level)).or(otherwise);
            chosen.and_then(|chosen| unwrap(chosen, here))
        }
        Some(WrappedValue::Factor(factor)) => (here.level)(factor).map(level_as_written),
        Some(WrappedValue::Drawn(computed)) => {
            let drawn = (here.drawn)(computed.reference().0);
            Some(drawn.and_then(|drawn| computed.at(drawn)).unwrap_or(computed.undrawn()).into())
        }
    }
}

/// Reads a factor's value as a parameter takes it: a number, `true` or `false` where it reads as one, else text.
fn level_as_written(level: &str) -> Value {
    match serde_json::from_str(level) {
        Ok(value @ (Value::Number(_) | Value::Bool(_))) => value,
        _ => Value::from(level),
    }
}

impl JsonSchema for ParametersDoc {
    fn schema_name() -> Cow<'static, str> {
        "Parameters".into()
    }

    /// Returns the schema of any study's parameters: `manifest::schema` puts those of one in their place.
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let mut schema = Schema::default();
        let mut of = |kind| {
            let ParametersSchema { groups, values } = ParametersSchema::of(kind);
            generator.definitions_mut().extend(values);
            groups
        };
        schema.insert("anyOf".to_owned(), StudyKind::all().map(&mut of).collect());
        schema
    }
}

/// The schema of the parameters of one study as manifests write them.
#[derive(Debug)]
pub(super) struct ParametersSchema {
    groups: Value,
    /// What each parameter's value may be, by the name under which the groups refer to it: `prior-map.mapping.particles`.
    values: Map<String, Value>,
}

impl ParametersSchema {
    /// Returns that of the study `kind`.
    pub(super) fn of(kind: StudyKind) -> Self {
        // Inlined, because its groups differ from the study's own schemas in what their values may be.
        let settings = schemars::generate::SchemaSettings::draft2020_12().for_deserialize();
        let generator = settings.with(|s| s.inline_subschemas = true).into_generator();
        let mut groups = kind.schema(generator);
        groups.remove("$schema");
        groups.remove("title");
        let mut values = Map::new();
        if let Some(object) = groups.as_object_mut() {
            wrap_values(object, kind.name(), &mut values);
        }
        Self { groups: groups.to_value(), values }
    }

    /// Puts it into the schema of a document of this study.
    pub(super) fn put_into(self, document: &mut Value) {
        document["properties"]["parameters"] = self.groups;
        if let Some(definitions) = document.get_mut("$defs").and_then(Value::as_object_mut) {
            definitions.extend(self.values);
        } else {
            document["$defs"] = Value::Object(self.values);
        }
    }

    /// Returns whether the parameter at `path` (`parameters.mapping.particles`) takes whole numbers only.
    pub(super) fn is_whole(&self, path: &str) -> bool {
        let mut found = &self.groups;
        for step in path.split('.').skip(1) {
            match found.get("properties").and_then(|groups| groups.get(step)) {
                Some(inner) => found = inner,
                // Below a parameter are the values of a factor, which are all of its kind.
                None => break,
            }
        }
        let name = found["$ref"].as_str().and_then(|r| r.strip_prefix(DEFINITIONS));
        let value = name.and_then(|name| self.values.get(name));
        let types = value.and_then(|value| value.pointer("/anyOf/0")).map_or(Vec::new(), types_of);
        let has = |name: &str| types.iter().any(|known| known == name);
        has("integer") && !has("number")
    }
}

/// Returns the types that `schema` names.
fn types_of(schema: &Value) -> Vec<Value> {
    match schema.get("type") {
        Some(Value::Array(types)) => types.clone(),
        Some(one) => vec![one.clone()],
        None => Vec::new(),
    }
}

/// The name of the definition of numbers that are computed from one that was drawn.
const COMPUTED: &str = "computed-from-a-draw";

/// Returns the forms of a number that is computed from one that was drawn: `{value, divided-by, why}`, `{points, at, why}`.
fn computed(why: &Value) -> Value {
    let number = |what: &str| {
        let description = format!(
            "{what} of this name in the draw, by factor and path: `draw.graph.time-scale`."
        );
        json!({ "type": "string", "description": description })
    };
    let pair =
        json!({ "type": "array", "items": { "type": "number" }, "minItems": 2, "maxItems": 2 });
    let points = json!({
        "type": "array",
        "items": pair,
        "minItems": 2,
        "description": "What was drawn, increasing, each with the value there; lines between them.",
    });
    let divided = json!({
        "type": "object",
        "properties": {
            "value": { "type": "number" },
            "divided-by": number("The number"),
            "why": why,
        },
        "required": ["value", "divided-by"],
        "additionalProperties": false,
    });
    let read = json!({
        "type": "object",
        "properties": { "points": points, "at": number("Where the lines are read: the number"), "why": why },
        "required": ["points", "at"],
        "additionalProperties": false,
    });
    json!({ "anyOf": [divided, read] })
}

/// Where a schema refers to its definitions.
const DEFINITIONS: &str = "#/$defs/";

/// Lets every value below `schema`, which is called `name`, be plain, `{value, why, range}`, `{factor, why}`,
/// `{by, values, otherwise, why}` or, where it is a number, computed from one that was drawn, and writes to `values` what each may be: values by one factor may lie in those by another.
fn wrap_values(schema: &mut Map<String, Value>, name: &str, values: &mut Map<String, Value>) {
    let Some(Value::Object(properties)) = schema.get_mut("properties") else { return };
    for (key, property) in properties {
        let name = format!("{name}.{key}");
        let Value::Object(object) = property else { continue };
        object.remove("default");
        if object.contains_key("properties") {
            wrap_values(object, &name, values);
            continue;
        }
        // What is told of the parameter is told of each of its values: a fault of one names what it is.
        let description = object.get("description").cloned().unwrap_or_default();
        let plain = Value::Object(object.clone());
        let why = json!({ "type": "string", "description": "Why this value was chosen." });
        let range = json!({
            "type": "array",
            "items": plain,
            "minItems": 1,
            "description": "Other values that could as well have been chosen: `reenact vary` tries the claims at each.",
        });
        let valued = json!({
            "type": "object",
            "properties": { "value": plain, "why": why, "range": range },
            "required": ["value", "why"],
            "additionalProperties": false,
        });
        let of_a_factor = json!({
            "type": "object",
            "properties": {
                "factor": { "type": "string", "description": "The factor whose own value this is." },
                "why": why,
            },
            "required": ["factor"],
            "additionalProperties": false,
        });
        let this = json!({ "$ref": format!("{DEFINITIONS}{name}") });
        let by_a_factor = json!({
            "type": "object",
            "properties": {
                "by": { "type": "string", "description": "The factor that decides." },
                "values": { "type": "object", "additionalProperties": this },
                "otherwise": plain,
                "why": why,
            },
            "required": ["by", "values"],
            "additionalProperties": false,
        });
        let mut forms = vec![plain, valued, of_a_factor, by_a_factor];
        if types_of(&forms[0]).iter().any(|known| known == "number") {
            forms.push(json!({ "$ref": format!("{DEFINITIONS}{COMPUTED}") }));
            values.entry(COMPUTED).or_insert_with(|| computed(&why));
        }
        *property = json!({ "description": description, "$ref": this["$ref"] });
        values.insert(name, json!({ "anyOf": forms }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studies::prior_map::Parameters;

    #[test]
    fn wrapped_values_are_found_and_taken_out() {
        let doc: ParametersDoc = serde_json::from_value(json!({
            "sensing": {
                "range-m": {"by": "environment", "values": {"basic": 10, "office": 30}, "why": "hardware"},
                "range-noise-sd-m": 0.1
            },
            "mapping": {"resolution-m": {"value": 0.05, "why": "finer"}}
        }))
        .unwrap();
        let kind = StudyKind::named("prior-map").unwrap();
        let pointers: Vec<_> = doc.wrapped(kind).iter().map(|w| w.pointer.clone()).collect();
        assert_eq!(pointers, ["/parameters/mapping/resolution-m", "/parameters/sensing/range-m"]);
        let level = |factor: &str| (factor == "environment").then_some("office");
        let here = Here { level: &level, drawn: &|_| None };
        let parameters = doc.for_condition(&groups(kind), &here);
        let parameters: Parameters = serde_json::from_value(parameters).unwrap();
        assert_eq!(parameters.sensing.range_m, Some(30.0));
        assert_eq!(parameters.sensing.range_noise_sd_m, Some(0.1));
        assert_eq!(parameters.mapping.resolution_m, 0.05);
    }

    #[test]
    fn numbers_are_computed_from_what_was_drawn() {
        let divided = Computed::Divided { value: 0.45, by: "draw.graph.time-scale" };
        assert_eq!((divided.at(1.5), divided.at(0.0)), (Some(0.3), None));
        let points = vec![[1.0, 10.0], [2.0, 20.0], [4.0, 0.0]];
        let read = Computed::Read { points, at: "draw.graph.entry-hazard" };
        let at = [0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 4.5].map(|drawn| read.at(drawn));
        let expected = [None, Some(10.0), Some(15.0), Some(20.0), Some(10.0), Some(0.0), None];
        assert_eq!(at, expected, "lines between points, nothing beyond them");
    }

    #[test]
    fn whole_numbers_are_told_from_others_by_the_schema() {
        let whole = |kind: &str, path: &str| {
            ParametersSchema::of(StudyKind::named(kind).unwrap()).is_whole(path)
        };
        assert!(whole("prior-map", "parameters.mapping.particles"));
        assert!(whole("deadline", "parameters.pilot.back-off-times"));
        assert!(!whole("deadline", "parameters.rules.schedule.seconds-per-edge"));
        assert!(!whole(
            "prior-map",
            "parameters.mapping.clip-range-m.values.released.values.office"
        ));
        assert!(!whole("deadline", "parameters.pilot.heading"));
        assert!(!whole("deadline", "parameters.no.such"));
    }

    #[test]
    fn values_by_one_factor_may_lie_in_those_by_another() {
        let doc: ParametersDoc = serde_json::from_value(json!({"mapping": {"clip-range-m": {
            "by": "reading",
            "values": {
                "described": null,
                "released": {"by": "environment", "values": {
                    "basic": null,
                    "office": {"value": 25, "why": "as released"},
                }},
            },
        }}}))
        .unwrap();
        let kind = StudyKind::named("prior-map").unwrap();
        let whys: Vec<_> = doc
            .wrapped(kind)
            .iter()
            .filter_map(|w| Some((w.pointer.clone(), w.why?.to_owned())))
            .collect();
        let place = "/parameters/mapping/clip-range-m/values/released/values/office";
        assert_eq!(whys, [(place.to_owned(), "as released".to_owned())]);
        let clip = |reading: &'static str, environment: &'static str| {
            let level =
                |factor: &str| Some(if factor == "reading" { reading } else { environment });
            let here = Here { level: &level, drawn: &|_| None };
            let parameters = doc.for_condition(&groups(kind), &here);
            serde_json::from_value::<Parameters>(parameters).unwrap().mapping.clip_range_m
        };
        assert_eq!(clip("described", "office"), None);
        assert_eq!(clip("released", "basic"), None);
        assert_eq!(clip("released", "office"), Some(25.0));
    }
}
