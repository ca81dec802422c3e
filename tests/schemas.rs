//! What editors and scripts read files and answers by: the committed JSON Schemas are those of the program, and what is shipped
//! validates against them. The validator is another one than the program's own.

use crate::sandbox::{Sandbox, TINY, repository};
use reenact::document::{self, Source};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// The first line of a manifest, before the path of its schema.
const MODELINE: &str = "# yaml-language-server: $schema=";

/// Returns every manifest that is shipped.
fn shipped() -> Vec<PathBuf> {
    let mut manifests = Vec::new();
    for folder in ["manifests", "manifests/original"] {
        for entry in fs::read_dir(repository().join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|extension| extension == "yaml") {
                manifests.push(path);
            }
        }
    }
    manifests.sort();
    manifests
}

fn schema(path: &Path) -> Value {
    let text = fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    serde_json::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// Returns what of `instance` differs from `schema`, a line each.
fn differences(schema: &Value, instance: &Value) -> Vec<String> {
    let validator = jsonschema::draft202012::new(schema).unwrap_or_else(|e| panic!("{e}"));
    let differences = validator.iter_errors(instance);
    differences.map(|e| format!("{}: {e}", e.instance_path())).collect()
}

/// Reads the manifest at `path` and returns the path of the schema that its first line names, and what differs from it.
fn by_its_own_schema(path: &Path) -> (PathBuf, Vec<String>) {
    let text = fs::read_to_string(path).unwrap();
    let named = text.lines().next().and_then(|line| line.strip_prefix(MODELINE));
    let named = named.unwrap_or_else(|| panic!("{}: no schema is named", path.display()));
    let of = path.parent().unwrap().join(named);
    let tree = document::read(&Source::new("manifest.yaml", text.as_str())).unwrap();
    let differences = differences(&schema(&of), &tree.root.to_json());
    (of, differences)
}

/// Asserts that `stdout` is answers of the command `name`: compact lines, each as its committed schema says, of which nothing is
/// left to guess. Returns them.
#[track_caller]
pub(crate) fn assert_answers(name: &str, stdout: &str) -> Vec<Value> {
    let path = repository().join(format!("schemas/answers/{name}.schema.json"));
    let schema = schema(&path);
    assert_eq!(schema["$id"], format!("urn:reenact:answer:{name}:1"));
    assert!(!stdout.is_empty(), "{name}: no answer");
    let answers = stdout.lines().map(|line| {
        let answer: Value = serde_json::from_str(line).unwrap_or_else(|e| panic!("{e}: {line}"));
        let differences = differences(&schema, &answer);
        assert!(differences.is_empty(), "{name}: {differences:#?} in {line}");
        answer
    });
    answers.collect()
}

#[test]
fn the_committed_schema_of_manifests_is_the_one_that_is_printed() {
    let printed = Sandbox::new().run(&["schema"]);
    let committed = fs::read_to_string(repository().join("schemas/manifest.schema.json")).unwrap();
    assert!(
        printed.stdout == committed,
        "reenact schema > schemas/manifest.schema.json writes it anew"
    );
    let schema: Value = serde_json::from_str(&committed).unwrap();
    assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
    assert_eq!(schema["$id"], "urn:reenact:manifest:1");
    jsonschema::meta::validate(&schema).unwrap();
}

#[test]
fn every_shipped_manifest_validates_against_the_schema_that_it_names() {
    let manifests = shipped();
    assert!(manifests.len() > 25, "{}", manifests.len());
    let committed = repository().join("schemas/manifest.schema.json").canonicalize().unwrap();
    for path in manifests {
        let (of, differences) = by_its_own_schema(&path);
        assert_eq!(of.canonicalize().unwrap(), committed, "{}", path.display());
        assert!(differences.is_empty(), "{}: {differences:#?}", path.display());
    }
}

#[test]
fn a_starter_study_names_a_schema_that_lies_beside_it() {
    let sandbox = Sandbox::new();
    assert_eq!(sandbox.run(&["init", "first"]).code, 0);
    let (_, differences) = by_its_own_schema(&sandbox.path("first/first.yaml"));
    assert_eq!(differences, [""; 0]);
}

#[test]
fn an_editor_is_told_of_what_is_no_manifest() {
    let schema = schema(&repository().join("schemas/manifest.schema.json"));
    let path = repository().join("manifests/quickstart.yaml");
    let text = fs::read_to_string(path).unwrap().replace("trials: 10", "trials: none\nbags: 2");
    let tree = document::read(&Source::new("manifest.yaml", text.as_str())).unwrap();
    let mut told = differences(&schema, &tree.root.to_json());
    told.sort_by_key(|line| line.starts_with(':'));
    assert_eq!(
        told,
        [
            "/trials: \"none\" is not of type \"integer\"",
            ": Additional properties are not allowed ('bags' was unexpected)",
        ]
    );
}

#[test]
fn every_schema_of_an_answer_is_one_and_is_printed() {
    let sandbox = Sandbox::new();
    let mut names = Vec::new();
    for entry in fs::read_dir(repository().join("schemas/answers")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        let name = name.strip_suffix(".schema.json").unwrap().to_owned();
        jsonschema::meta::validate(&schema(&path)).unwrap();
        assert_eq!(sandbox.done(&["schema", &name]), fs::read_to_string(&path).unwrap());
        names.push(name);
    }
    names.sort();
    assert_eq!(names.len(), 20, "{names:?}");
}

fn json<'a>(words: &[&'a str]) -> Vec<&'a str> {
    [words, &["--format", "json"]].concat()
}

#[test]
fn a_study_is_answered_as_its_schemas_say() {
    let place = Sandbox::new().with_study(TINY);
    let planned = place.done(&json(&["plan", "tiny.yaml"]));
    let planned = &assert_answers("plan", &planned)[0];
    assert_eq!((&planned["done"], &planned["to_do"]), (&0.into(), &6.into()));
    let power = place.done(&json(&["plan", "tiny.yaml", "--power"]));
    assert_answers("plan-power", &power);
    let kept = place.done(&json(&["run", "tiny.yaml", "--no-seal", "--shard", "1/2"]));
    assert_answers("run-no-seal", &kept);
    let run = place.done(&json(&["run", "tiny.yaml"]));
    let run = &assert_answers("run", &run)[0];
    let planned = place.done(&json(&["plan", "tiny.yaml"]));
    let planned = &assert_answers("plan", &planned)[0];
    assert_eq!((&planned["done"], &planned["to_do"]), (&6.into(), &0.into()));
    assert_eq!(planned["trials"][0]["condition"], "none");

    let digest = &run["results_digest"];
    let lock = place.done(&json(&["lock", "tiny.yaml"]));
    let new = &assert_answers("lock", &lock)[0];
    assert_eq!((&new["state"], &new["results_digest"]), (&"new".into(), digest));
    let again = place.done(&json(&["lock", "tiny.yaml"]));
    assert_eq!(assert_answers("lock", &again)[0]["state"], "unchanged");
    let probed = place.done(&json(&["run", "tiny.yaml", "--locked", "--probe"]));
    assert_answers("run-probe", &probed);
    let locked = place.done(&json(&["run", "tiny.yaml", "--locked"]));
    let run = &assert_answers("run", &locked)[0];
    assert_eq!((&run["drift"], &run["results_digest"]), (&Value::Null, digest));

    let bundle = run["bundle"].as_str().unwrap();
    let checked = place.done(&json(&["verify", "--level", "5", bundle]));
    let checked = &assert_answers("verify", &checked)[0];
    for key in ["bundle_id", "results_digest", "study_digest"] {
        assert_eq!(checked[key], run[key], "{key}: the same in every answer");
    }
    let replicated = place.run(&json(&["verify", "--level", "6", bundle]));
    assert_answers("verify", &replicated.stdout);
    let report = place.done(&json(&["report", bundle, "-o", "page.html"]));
    assert_eq!(&assert_answers("report", &report)[0]["results_digest"], digest);
    for form in ["--flat", "--rocrate", "--dir", "--latex"] {
        let exported = place.done(&json(&["export", bundle, form, "--out", "exported"]));
        let exported = &assert_answers("export", &exported)[0];
        assert_eq!(exported["form"], form.trim_start_matches('-'));
        assert!(place.path(exported["path"].as_str().unwrap()).exists(), "{form}");
    }

    let other = place.done(&json(&["run", "tiny.yaml", "--set", "seed=8", "--out", "other"]));
    let other = &assert_answers("run", &other)[0];
    let differs = place.run(&json(&["diff", bundle, other["bundle"].as_str().unwrap()]));
    let differs = &assert_answers("diff", &differs.stdout)[0];
    assert_eq!((&differs["a"]["results_digest"], &differs["same"]), (digest, &false.into()));
    assert_eq!(differs["b"]["results_digest"], other["results_digest"]);
    let drifted = place.run(&json(&["run", "tiny.yaml", "--set", "seed=8", "--locked"]));
    assert_eq!(assert_answers("run", &drifted.stdout)[0]["drift"]["same"], false);
    assert_eq!(drifted.code, 1);

    assert_eq!(
        assert_answers("cache-size", &place.done(&json(&["cache", "size"])))[0]["trials"],
        12
    );
    assert_answers("cache-verify", &place.done(&json(&["cache", "verify"])));
}

#[test]
fn check_answers_with_every_fault_and_its_place() {
    let place = Sandbox::new().with_study(TINY);
    let checked = place.done(&["check", "tiny.yaml", "--format", "json"]);
    let good = &assert_answers("check", &checked)[0];
    assert_eq!((&good["ok"], &good["trials"]), (&true.into(), &6.into()));
    place.edit("tiny.yaml", "trials: 3", "trials: many");
    place.edit("tiny.yaml", "seed: 7", "seed: 7\nsede: 8");
    let words = ["check", "tiny.yaml", "no-such.yaml", "--format", "json"];
    let answer = place.run(&words);
    let told = assert_answers("check", &answer.stdout);
    assert_eq!((told.len(), answer.code, answer.stderr.as_str()), (2, 2, ""));
    let faults = told[0]["faults"].as_array().unwrap();
    let at: Vec<String> = faults
        .iter()
        .map(|fault| {
            format!("{}:{}:{}: {}", fault["file"], fault["line"], fault["column"], fault["message"])
        })
        .collect();
    assert_eq!(
        at,
        [
            r#""tiny.yaml":8:1: "unknown key `sede`""#,
            r#""tiny.yaml":9:9: "`trials` must be a whole number, found the text `many`""#,
        ]
    );
    assert_eq!(told[1]["faults"][0]["line"], Value::Null, "a file that is not there has no line");
}

#[test]
fn files_are_written_and_told_as_the_schemas_say() {
    let place = Sandbox::new().with_study(TINY);
    let texts = |value: &Value| -> Vec<String> {
        let values = value.as_array().unwrap().iter();
        values.map(|value| value.as_str().unwrap().to_owned()).collect()
    };
    let begun = place.done(&json(&["init", "first"]));
    let begun = &assert_answers("init", &begun)[0];
    assert_eq!(begun["manifest"], "first/first.yaml");
    let files = ["first.yaml", "kobuki.urdf", "apartment.yaml", "manifest.schema.json"];
    assert_eq!(texts(&begun["written"]), files.map(|file| format!("first/{file}")));
    assert_eq!(place.files("first").len(), files.len());

    let shown = place.run(&json(&["show", "worlds/basic.yaml", "-o", "world.svg"]));
    let answer = &assert_answers("show", &shown.stdout)[0];
    assert_eq!((&answer["kind"], &answer["path"]), (&"world".into(), &"world.svg".into()));
    let lines = texts(&answer["described"]);
    assert_eq!(lines.join("\n") + "\n", place.run(&["show", "worlds/basic.yaml"]).stdout);
    assert_eq!((shown.stderr.as_str(), &answer["warnings"]), ("", &0.into()));
    let shown = place.done(&json(&["show", "robots/kobuki.urdf"]));
    assert_eq!(assert_answers("show", &shown)[0]["kind"], "robot");
    let derived = ["show", "worlds/basic.yaml", "--derive", "floor-plan", "-o", "plan.svg"];
    assert_eq!(assert_answers("show", &place.done(&json(&derived)))[0]["kind"], "prior");

    let run = place.done(&json(&["run", "tiny.yaml"]));
    let run = &assert_answers("run", &run)[0];
    let bundle = run["bundle"].as_str().unwrap();
    let replay = ["replay", bundle, "none/0", "--svg", "still.svg", "--mcap", "trial.mcap"];
    let replay = [&replay[..], &["--map", "map.yaml"]].concat();
    let played = place.done(&json(&replay));
    let played = &assert_answers("replay", &played)[0];
    assert_eq!(played["results_digest"], run["results_digest"]);
    let written = texts(&played["written"]);
    assert_eq!(
        written,
        ["still.svg", "trial.mcap", "trial.foxglove-layout.json", "map.yaml", "map.pgm"]
    );
    assert!(written.iter().all(|file| place.path(file).exists()), "{written:?}");
    let trial = &played["trials"][0];
    assert_eq!((&trial["trial"], &trial["matches"]), (&"none/0".into(), &true.into()));
    let plan = place.done(&json(&["plan", "tiny.yaml"]));
    assert_eq!(trial["key"], assert_answers("plan", &plan)[0]["trials"][0]["key"]);

    let imported = place.done(&json(&["import", "map.yaml", "-o", "copy.yaml"]));
    let imported = &assert_answers("import", &imported)[0];
    assert_eq!((&imported["path"], &imported["world"]), (&"copy.yaml".into(), &"map".into()));
    let described = place.run(&["show", "copy.yaml"]).stdout;
    let meaning = imported["meaning"].as_str().unwrap().trim_start_matches("sha256:");
    assert!(described.ends_with(&format!("meaning: {meaning}\n")), "{described} {meaning}");
}
