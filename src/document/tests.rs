use super::*;
use proptest::prelude::*;
use proptest::strategy::Strategy as _;
use serde::Deserialize;
use std::collections::BTreeMap;

/// A document with one of everything.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
#[expect(dead_code, reason = "read to be checked")]
struct Sample {
    /// What it is called.
    name: String,
    /// Trials per condition.
    #[schemars(range(min = 1, max = 1000))]
    trials: u32,
    #[schemars(extend("exclusiveMinimum" = 0))]
    range_m: Option<f64>,
    strategy: Option<Strategy>,
    sensor: Option<Sensor>,
    #[serde(default)]
    factors: BTreeMap<String, Vec<Scalar>>,
    #[serde(default)]
    at: Option<(f64, f64)>,
    nested: Option<Nested>,
    world: Option<World>,
    raw: Option<serde_json::Value>,
    color: Option<Color>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "read to be checked")]
enum Scalar {
    Flag(bool),
    Number(f64),
    Text(String),
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
enum Strategy {
    /// The nearest one.
    NearestFrontier,
    /// The best one.
    Utility,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[expect(dead_code, reason = "read to be checked")]
enum Sensor {
    /// Nothing at all.
    None,
    /// A scanner.
    Lidar {
        /// Number of beams.
        beams: u32,
    },
    Camera(f64),
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
#[expect(dead_code, reason = "read to be checked")]
struct Nested {
    /// How far (m).
    far_m: f64,
    #[serde(flatten)]
    shape: Shape,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", rename_all_fields = "kebab-case")]
#[expect(dead_code, reason = "read to be checked")]
enum Shape {
    Circle { radius_m: f64 },
    Polygon(Vec<(f64, f64)>),
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "read to be checked")]
enum World {
    File(FileWorld),
    By(ByWorld),
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[expect(dead_code, reason = "read to be checked")]
struct FileWorld {
    file: String,
    layers: Option<Vec<String>>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[expect(dead_code, reason = "read to be checked")]
struct ByWorld {
    by: String,
    values: BTreeMap<String, FileWorld>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(try_from = "String")]
struct Color;

impl TryFrom<String> for Color {
    type Error = String;
    fn try_from(text: String) -> Result<Self, String> {
        if text == "red" { Ok(Self) } else { Err(format!("`{text}` is not a colour we mix")) }
    }
}

/// Lists all faults of `text`, each as `line:column message | label | help`.
fn faults(text: &str) -> String {
    let source = Source::new("a.yaml", text);
    let lines = match parse::<Sample>(&source) {
        Ok(_) => vec!["none".to_owned()],
        Err(faults) => faults
            .iter()
            .map(|f| {
                let location = f.location().unwrap_or_default();
                let place = location.strip_prefix("a.yaml:").unwrap_or_default();
                let help = f.help.as_deref().unwrap_or("-");
                format!("{place} {} | {} | {help}", f.message, f.label)
            })
            .collect(),
    };
    lines.join("\n")
}

#[test]
fn every_fault_is_told_where_it_is() {
    insta::assert_snapshot!(faults("nmae: x\ntrials: 0\nrange-m: 0\nstrategy: utilty\nextra: 1\n"), @"
    1:1 unknown key `nmae` | not a key of this document | did you mean `name`?
    2:9 `trials` must be from 1 to 1000, found 0 | expected a number from 1 to 1000 | Trials per condition
    3:10 `range-m` must be above 0, found 0 | expected a number above 0 | -
    4:11 unknown value `utilty` for `strategy` | not one of the known values | did you mean `utility`? (known: nearest-frontier, utility)
    5:1 unknown key `extra` | not a key of this document | known keys: at, color, factors, name, nested, range-m, raw, sensor, strategy, trials, world
    ");
}

#[test]
fn a_path_as_a_key_is_told_to_be_nested() {
    insta::assert_snapshot!(faults("name: a\ntrials: 1\nworld.file: x\nnested.circle.radius-m: 2\nwrold.file: x\n"), @"
    3:1 unknown key `world.file` | not a key of this document | nest it: `world: {file: ...}`
    4:1 unknown key `nested.circle.radius-m` | not a key of this document | nest it: `nested: {circle: {radius-m: ...}}`
    5:1 unknown key `wrold.file` | not a key of this document | known keys: at, color, factors, name, nested, range-m, raw, sensor, strategy, trials, world
    ");
}

#[test]
fn missing_and_wrong_things_say_what_was_expected() {
    insta::assert_snapshot!(faults(""), @" `a.yaml`: expected a YAML mapping with `name` and `trials`, found nothing |  | -");
    insta::assert_snapshot!(faults("trials: ten\nname: 1.10\nrange-m: '3'\nat: [1, 2, 3]\nfactors: {a: 1}\n"), @r#"
    1:9 `trials` must be a whole number, found the text `ten` | expected a whole number | Trials per condition
    2:7 `name` must be text, found the number 1.1 | expected text | quote it: "1.1"
    3:10 `range-m` must be a number, found the text `3` | expected a number | remove the quotes: 3
    4:5 `at` must have 2 items, found 3 | expected 2 items | -
    5:14 `factors.a` must be a list, found the number 1 | expected a list | -
    "#);
    insta::assert_snapshot!(faults("range-m: 1,5\n"), @"
    1:1 missing key `name` | expected `name` here | add `name`, text: What it is called
    1:1 missing key `trials` | expected `trials` here | add `trials`, a whole number: Trials per condition
    1:10 `range-m` must be a number, found the text `1,5` | expected a number | the decimal separator is a point: 1.5
    ");
}

#[test]
fn the_alternative_meant_is_the_one_whose_faults_are_told() {
    let with = |rest: &str| faults(&format!("name: x\ntrials: 1\n{rest}"));
    insta::assert_snapshot!(with("sensor: {lidar: {beams: many}}"), @"3:25 `sensor.lidar.beams` must be a whole number, found the text `many` | expected a whole number | Number of beams");
    insta::assert_snapshot!(with("sensor: lidar"), @"3:9 unknown value `lidar` for `sensor` | expected `none` | `lidar` takes settings: write `{lidar: ...}`");
    insta::assert_snapshot!(with("sensor: {ladar: {beams: 3}}"), @"3:10 unknown key `ladar` | expected one of `lidar`, `camera` | did you mean `lidar`?");
    insta::assert_snapshot!(with("sensor: 3"), @"3:9 `sensor` must be `none` or a mapping with `lidar` or `camera`, found the number 3 | expected `none` or a mapping with `lidar` or `camera` | -");
    insta::assert_snapshot!(with("sensor: {}"), @"3:9 `sensor` must have one of the keys `lidar`, `camera`, found none | expected one of `lidar`, `camera` | -");
    insta::assert_snapshot!(with("sensor: none"), @"none");
    insta::assert_snapshot!(with("world: {fil: a, layers: [x]}"), @"3:9 unknown key `fil` | not a key of `world` | did you mean `file`?");
    insta::assert_snapshot!(with("world: {by: a, values: {x: {file: 3}}}"), @r#"3:35 `world.values.x.file` must be text, found the number 3 | expected text | quote it: "3""#);
    insta::assert_snapshot!(with("world: {flie: a}"), @"3:9 unknown key `flie` | expected one of `file`, `by`, `values` | did you mean `file`?");
    insta::assert_snapshot!(with("nested: {far-m: 1, circl: {radius-m: 2}}"), @"3:20 unknown key `circl` | expected one of `circle`, `polygon` | did you mean `circle`?");
    insta::assert_snapshot!(with("nested: {far-m: 1, circle: {radius-m: x}}"), @"3:39 `nested.circle.radius-m` must be a number, found the text `x` | expected a number | -");
    insta::assert_snapshot!(with("nested: {far-m: 1, circle: {radius-m: 1}}\nraw: {any: [thing]}\nfactors: {a: [x, 1, true]}"), @"none");
    insta::assert_snapshot!(with("color: green"), @"3:8 `green` is not a colour we mix |  | -");
    insta::assert_snapshot!(with("factors: {a: [[1]]}"), @"3:15 `factors.a[0]` must be `true` or `false` or a number or text, found a list | expected `true` or `false` or a number or text | -");
}

#[test]
fn lossy_and_ambiguous_texts_are_refused() {
    insta::assert_snapshot!(faults("name: no\ntrials: 010\nrange-m: .inf\nname: y\nfactors: {<<: *x}\n"), @r#"
    1:7 `no` is a boolean in YAML 1.1 and text in YAML 1.2 |  | write `false` for the boolean or "no" for the text
    2:9 `010` begins with a zero, which some readers take for octal |  | leave the zero out, or write "010" for the text
    3:10 `.inf` is not a finite number |  | write a finite number, or leave the key out where it is optional
    4:1 duplicate key `name` | already written on line 1 | remove one of the two
    5:11 merge keys (`<<`) are not used here |  | write the keys out
    5:15 not valid YAML: while parsing node, found unknown anchor |  | -
    "#);
    insta::assert_snapshot!(faults("name: !tag x\ntrials: 1_000\nrange-m: 0x1F\nraw: [True, 1e999, 99999999999999999999, {on: 1}, {[1]: 2}]"), @r#"
    1:7 tags (`!name`) are not used here |  | remove the tag; a choice is written as `{name: settings}`
    2:9 `1_000` is a number to some readers and text to others |  | write it in plain decimal digits, or "1_000" for the text
    3:10 `0x1F` is a number to some readers and text to others |  | write it in plain decimal digits, or "0x1F" for the text
    4:7 `True` is written in lower case |  | write `true`, or "True" for the text
    4:13 `1e999` is too large for a number |  | numbers reach to about 1.8e308
    4:20 `99999999999999999999` is too large to be kept exactly |  | whole numbers reach from -9223372036854775808 to 18446744073709551615
    4:43 `on` is a boolean in YAML 1.1 and text in YAML 1.2 |  | write `true` for the boolean or "on" for the text
    4:52 a key must be a plain name | found an alias, a list or a mapping | -
    "#);
    insta::assert_snapshot!(faults("%YAML 1.1\n---\nname: x\n"), @" `a.yaml`: expected a YAML mapping, found text that is none (line 1: YAML directives are disallowed) |  | -");
    insta::assert_snapshot!(faults("name: x\n---\ntrials: 1\n"), @"2:1 a second document begins here | expected the end of the file | keep one document per file and remove the `---` line");
    insta::assert_snapshot!(faults("name: x\n\ttrials: 1\n"), @"1:7 not valid YAML: while scanning a plain scalar, found a tab |  | -");
    insta::assert_snapshot!(faults("raw: &a [*a]"), @"1:10 an alias cannot stand inside itself |  | -");
    insta::assert_snapshot!(faults(&"[".repeat(20_000)), @" `a.yaml`: expected a YAML mapping, found text that is none (line 1: recursion limit exceeded) |  | -");
    let mut bomb = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n".to_owned();
    for i in 1..9 {
        let aliases = vec![format!("*a{}", i - 1); 10].join(", ");
        bomb += &format!("a{i}: &a{i} [{aliases}]\n");
    }
    insta::assert_snapshot!(faults(&bomb), @"6:10 aliases repeat more than 250000 values or 4194304 bytes of the document |  | write less under anchors (`&name`), or repeat it less often");
}

#[test]
fn aliases_stand_for_what_they_name() {
    let source = Source::new("a.yaml", "name: &n x\ntrials: 1\nraw: [*n, {k: *n}]\n");
    let parsed = parse::<Sample>(&source).unwrap();
    assert_eq!(parsed.value.raw, Some(serde_json::json!(["x", {"k": "x"}])));
}

#[test]
fn pointers_find_values_keys_and_the_nearest_thing_written() {
    let source =
        Source::new("a.yaml", "name: x\ntrials: 1\nfactors:\n  prior: [none, floor-plan]\n");
    let parsed = parse::<Sample>(&source).unwrap();
    let at = |d: Diagnostic| d.location().unwrap();
    assert_eq!(at(parsed.fault("/factors/prior/1", "x")), "a.yaml:4:17");
    assert_eq!(at(parsed.key_fault("/factors/prior", "x")), "a.yaml:4:3");
    assert_eq!(at(parsed.fault("/factors/start", "x")), "a.yaml:3:1");
    assert_eq!(at(parsed.fault("/nested/deep/0", "x")), "a.yaml:1:1");
    assert_eq!(parsed.tree.node("/factors/prior/9"), None);
}

#[test]
fn numbers_keep_their_bits() {
    for x in [0.1_f64, 1e-300, 1.797_693_134_862_315_7e308, 5e-324, 0.1 + 0.2] {
        let source = Source::new("a.yaml", format!("name: x\ntrials: 1\nrange-m: {x:e}\n"));
        let parsed = parse::<Sample>(&source).unwrap();
        assert_eq!(parsed.value.range_m.map(f64::to_bits), Some(x.to_bits()));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn no_text_panics(text in "\\PC{0,60}") {
        let _ = parse::<Sample>(&Source::new("a", text));
    }

    #[test]
    fn no_yaml_like_text_panics(text in "([a-z*&!<>|?%@`'\"#,:\\[\\]{}\n \t~0-9.é-]|name|trials: |sensor: |\n  |- ){0,40}") {
        if let Err(faults) = parse::<Sample>(&Source::new("a", text)) {
            for fault in faults {
                let _ = fault.render(false);
            }
        }
    }

    #[test]
    fn every_json_value_is_read_as_written(value in any_json()) {
        let text = serde_json::to_string(&value).unwrap();
        let tree = read(&Source::new("a", text)).unwrap();
        prop_assert_eq!(tree.root.to_json(), value);
    }
}

fn any_json() -> impl proptest::strategy::Strategy<Value = serde_json::Value> {
    let leaf = prop_oneof![
        Just(serde_json::Value::Null),
        any::<bool>().prop_map(Into::into),
        any::<i64>().prop_map(Into::into),
        "[ -~é]{0,8}".prop_map(Into::into),
    ];
    leaf.prop_recursive(4, 32, 5, |inner| {
        prop_oneof![
            prop::collection::vec(inner.clone(), 0..5).prop_map(Into::into),
            prop::collection::btree_map("[a-z]{1,4}", inner, 0..5)
                .prop_map(|map| serde_json::Value::Object(map.into_iter().collect())),
        ]
    })
}

#[test]
fn a_long_document_is_read_whole() {
    let mut text = "name: x\ntrials: 1\nfactors:\n".to_owned();
    for i in 0..1000 {
        text += &format!("  f{i}: [a, 1.5, true, some longer text]  # and a remark\n");
    }
    let parsed = parse::<Sample>(&Source::new("a.yaml", text)).unwrap();
    assert_eq!(parsed.value.factors.len(), 1000);
}
