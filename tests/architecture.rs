//! The shape of the code, kept by a machine: layers, the mind that cannot see the truth, one door to each foreign crate,
//! and purity below the shell.
//!
//! Reads `src/` as text, without `#[cfg(test)]` items and files. Says where, which rule, and what to do.

mod source;

use crate::sandbox::repository;
use source::{NamedPath, Shipped};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::Path;

/// Modules from the lowest layer up. A module imports lower layers only, never its own.
const LAYERS: [(&str, &[&str]); 9] = [
    ("layer 1", &["robot", "world", "claims"]),
    ("layer 2", &["sim", "mapping", "navigation", "cmdp"]),
    ("layer 3", &["studies"]),
    ("layer 4", &["manifest"]),
    ("layer 5", &["plan"]),
    ("layer 6", &["runner", "bundle"]),
    ("layer 7", &["verify", "compare"]),
    ("layer 8", &["merge", "report"]),
    ("the crate's root", &["main", "lib"]),
];

/// Layer 0, in an order: each imports only those before it.
const LAYER_0: &[&str] = &[
    "units",
    "math",
    "digest",
    "json",
    "rng",
    "geometry",
    "grid",
    "factor",
    "condition",
    "labels",
    "stats",
    "table",
    "figure",
    "document",
];

/// The shell, in an order: each imports every layer and only those of the shell before it.
const SHELL: &[&str] = &["provenance", "store", "cli"];

/// One crate, one door: who may name a crate (a file, or a folder with everything below it).
const DOORS: &[(&str, &[&str])] = &[
    ("annotate_snippets", &["document/diagnostic.rs"]),
    ("base16ct", &["digest.rs"]),
    ("base64ct", &["verify/attestation/dsse.rs", "verify/signature/minisign.rs"]),
    ("byteorder", &["report/bag/writer.rs"]),
    ("cdr_encoding", &["report/bag/writer.rs"]),
    ("clap", &["cli/"]),
    ("clap_complete", &["cli/"]),
    ("clap_mangen", &["cli/"]),
    ("clarabel", &["cmdp/solve.rs"]),
    ("console", &["cli/"]),
    ("crc32fast", &["report/bag/packed.rs", "world/map_server/bag/framing.rs"]),
    ("flate2", &["bundle/archive/unpack.rs"]),
    ("fs_err", &["store.rs", "store/"]),
    ("indicatif", &["cli/"]),
    ("libc", &["store.rs"]),
    ("libm", &["math.rs"]),
    ("mcap", &["report/bag/writer.rs", "world/map_server/bag.rs"]),
    ("ruzstd", &["report/bag/packed.rs", "world/map_server/bag/framing.rs"]),
    ("mesh_loader", &["world/mesh/files.rs"]),
    ("minijinja", &["report/template.rs"]),
    ("minisign_verify", &["verify/signature/minisign.rs"]),
    ("pdf_writer", &["report/print/pdf.rs"]),
    ("png", &["world/map_server/image.rs", "report/show/grid.rs"]),
    ("rand_chacha", &["rng.rs"]),
    ("rapier2d", &["sim/engine.rs"]),
    ("rayon", &["runner/scheduler.rs"]),
    ("roxmltree", &["document/", "robot/", "world/", "report/"]),
    ("rustix", &["store/scratch.rs"]),
    ("serde_yaml", &["document/reader.rs"]),
    ("sha2", &["digest.rs"]),
    ("signal_hook", &["cli/interrupt.rs"]),
    ("ssh_key", &["verify/signature/allowed_signers.rs", "verify/signature/ssh.rs"]),
    ("strsim", &["document/diagnostic.rs"]),
    ("tempfile", &["store/partial.rs", "store/scratch.rs"]),
    ("ttf_parser", &["report/print/face.rs"]),
    ("zip", &["bundle/archive.rs"]),
];

/// Crates that are vocabulary, not machinery: any module may name them.
const VOCABULARY: &[&str] = &["schemars", "serde", "serde_json", "thiserror"];

/// What only the shell may touch: files, processes, the environment and the clock.
const IMPURE: &[&[&str]] = &[
    &["std", "fs"],
    &["std", "env"],
    &["std", "net"],
    &["std", "process"],
    &["std", "time", "Instant"],
    &["std", "time", "SystemTime"],
];
const PRINTING: &[&str] = &["print", "println", "eprint", "eprintln", "dbg"];

/// The parts of a mind. A study's mission holds both ends; its `mod.rs` and `study.rs` are the door to it.
const MIND: &[&str] = &["mapping/", "navigation/", "cmdp/"];
const TRUTH: &[&str] = &["sim", "world"];

/// Rooms whose modules name one another without a circle: each names those below it, and never what its own parent holds.
const WITHOUT_CIRCLES: &[&str] = &["claims", "manifest"];

#[derive(Debug, PartialEq, Eq)]
struct Violation {
    file: String,
    line: usize,
    rule: String,
    remedy: String,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "src/{}:{}: {}; {}", self.file, self.line, self.rule, self.remedy)
    }
}

/// Returns a module's place from below, and what to call that place.
fn place(module: &str) -> Option<(usize, &'static str)> {
    if let Some(order) = LAYER_0.iter().position(|m| *m == module) {
        return Some((order, "layer 0"));
    }
    if let Some(order) = SHELL.iter().position(|m| *m == module) {
        return Some((200 + order, "the shell"));
    }
    let layer = LAYERS.iter().position(|(_, modules)| modules.contains(&module))?;
    Some((if module == "main" || module == "lib" { 300 } else { 100 + layer }, LAYERS[layer].0))
}

/// Returns the module path of a file below `src/`: `a/b.rs` and `a/b/mod.rs` are `a::b`.
fn module_of(file: &str) -> Vec<String> {
    let stem = file.strip_suffix(".rs").unwrap_or(file);
    let stem = stem.strip_suffix("/mod").unwrap_or(stem);
    if matches!(stem, "lib" | "main") {
        return Vec::new();
    }
    stem.split('/').map(str::to_owned).collect()
}

/// What studies share: it infers from what they propose, and is none.
const INFERENCE: &str = "inference";
/// Its setup hands on the world and the robot of a study's own.
const INFERENCE_SETUP: &str = "studies/inference/setup.rs";

fn is_mind(file: &str) -> bool {
    let in_study = file.strip_prefix("studies/").and_then(|rest| rest.split_once('/'));
    MIND.iter().any(|part| file.starts_with(part))
        || in_study.is_some_and(|(_, part)| {
            !["mod.rs", "study.rs", "mission.rs"].contains(&part)
                && !part.starts_with("mission/")
                && file != INFERENCE_SETUP
        })
}

/// Returns every violation in the shipped part of one file; `studies` are the modules in `studies/` that are studies.
fn check(file: &str, text: &str, studies: &[String]) -> Vec<Violation> {
    let shipped = Shipped::read(text);
    let module = module_of(file);
    let mut found = Vec::new();
    let mut fault = |line: usize, rule: String, remedy: &str| {
        let violation = Violation { file: file.to_owned(), line, rule, remedy: remedy.to_owned() };
        if !found.contains(&violation) {
            found.push(violation);
        }
    };
    let paths = shipped.paths(&module);
    for NamedPath { line, segments } in &paths {
        let names: Vec<&str> = segments.iter().map(String::as_str).collect();
        match names[..] {
            ["crate", imported, ..] => {
                layers(file, &module, imported, |rule, remedy| fault(*line, rule, remedy));
                mind_and_studies(file, &module, &names[1..], studies, |rule, remedy| {
                    fault(*line, rule, remedy);
                });
            }
            [foreign, ..] => {
                door(file, foreign, |rule, remedy| fault(*line, rule, remedy));
                if !is_shell(&module) && IMPURE.iter().any(|path| names.starts_with(path)) {
                    fault(
                        *line,
                        format!("`{}` outside the shell", names.join("::")),
                        "take the value as an argument, and let store.rs, provenance.rs or cli/ obtain it",
                    );
                }
            }
            [] => {}
        }
    }
    for pair in shipped.tokens.windows(2) {
        if !is_shell(&module) && PRINTING.contains(&pair[0].text.as_str()) && pair[1].text == "!" {
            fault(
                pair[0].line,
                format!("`{}!` outside the shell", pair[0].text),
                "return the text, and let cli/ print it",
            );
        }
    }
    found
}

fn is_shell(module: &[String]) -> bool {
    module.first().is_none_or(|top| SHELL.contains(&top.as_str()))
}

fn layers(file: &str, module: &[String], imported: &str, mut fault: impl FnMut(String, &str)) {
    let Some(own) = module.first() else { return };
    let Some((own_place, own_layer)) = place(own) else {
        fault(
            format!("`{own}` has no layer"),
            "give it one in tests/architecture.rs and docs/architecture.md",
        );
        return;
    };
    // Anything else after `crate::` is an item of the root, of which there are none but modules.
    let Some((place, layer)) = place(imported) else {
        fault(
            format!("`crate::{imported}` is in no layer"),
            "import it from its own module, or give the module a layer in tests/architecture.rs",
        );
        return;
    };
    if imported != own && place >= own_place {
        fault(
            format!("`{own}` ({own_layer}) imports `{imported}` ({layer}), which is not below it"),
            if file.starts_with("studies/") {
                "move what both need into a lower module"
            } else {
                "move what it needs down, or pass it in as a value, a function or a trait"
            },
        );
    }
}

fn mind_and_studies(
    file: &str,
    module: &[String],
    imported: &[&str],
    studies: &[String],
    mut fault: impl FnMut(String, &str),
) {
    if is_mind(file) {
        let mission = matches!(imported, ["studies", _, "mission" | "study", ..]);
        if TRUTH.contains(&imported[0]) || mission {
            fault(
                format!("a mind imports `{}`, which knows the truth", imported.join("::")),
                "give it sensor messages from `robot`, or move the code into the study's mission",
            );
        }
    }
    if let ([first, own, ..], ["studies", other, ..]) = (module, imported)
        && first == "studies"
        && studies.contains(own)
        && other != own
        && studies.iter().any(|study| study == other)
    {
        fault(
            format!("study `{own}` imports study `{other}`"),
            "move what both need into a lower module",
        );
    }
}

fn door(file: &str, foreign: &str, mut fault: impl FnMut(String, &str)) {
    let Some((_, doors)) = DOORS.iter().find(|(name, _)| *name == foreign) else { return };
    let open =
        doors.iter().any(|door| file == *door || (door.ends_with('/') && file.starts_with(door)));
    if !open {
        let doors = doors.join(", ");
        fault(
            format!("names `{foreign}`, whose door is {doors}"),
            "call what that module offers, and add to it what is missing",
        );
    }
}

/// A module by its path.
type Module = Vec<String>;

/// Returns which modules of `room` each of its modules names; a module holds its children, so it names them too.
fn imports(room: &str, files: &[(String, String)]) -> BTreeMap<Module, BTreeSet<Module>> {
    let modules: BTreeMap<Module, &str> = files
        .iter()
        .map(|(file, text)| (module_of(file), text.as_str()))
        .filter(|(module, _)| module.first().is_some_and(|first| first == room))
        .collect();
    let known = |path: &[String]| {
        (1..=path.len()).rev().map(|n| path[..n].to_vec()).find(|part| modules.contains_key(part))
    };
    let of = |(module, text): (&Module, &&str)| {
        let paths = Shipped::read(text).paths(module);
        let named = paths.iter().filter(|path| path.segments[0] == "crate");
        // `pub(in crate::claims)` says who sees an item, and names none.
        let named = named.filter(|path| !module.starts_with(&path.segments[1..]));
        let named = named.filter_map(|path| known(&path.segments[1..]));
        let children = modules.keys().filter(|child| child.split_last().unwrap().1 == &module[..]);
        let all = named.chain(children.cloned()).filter(|other| other != module);
        (module.clone(), all.collect())
    };
    modules.iter().map(of).collect()
}

/// Returns one circle of modules in words, if there is one.
fn circle(imports: &BTreeMap<Module, BTreeSet<Module>>) -> Option<String> {
    let mut left = imports.clone();
    loop {
        let known: BTreeSet<Module> = left.keys().cloned().collect();
        let before = left.len();
        left.retain(|_, named| !named.is_disjoint(&known));
        if left.len() == before {
            break;
        }
    }
    // Each module that is left names another that is left, so whoever follows them comes round.
    let mut walked = vec![left.keys().next()?];
    loop {
        let here = walked[walked.len() - 1];
        let next = left[here].iter().find(|named| left.contains_key(*named)).unwrap();
        if let Some(begin) = walked.iter().position(|module| *module == next) {
            walked.push(next);
            let names: Vec<String> = walked[begin..].iter().map(|m| m.join("::")).collect();
            return Some(names.join(" -> "));
        }
        walked.push(next);
    }
}

/// Returns the shipped files below `src/`, by path, with their text.
fn shipped_files() -> Vec<(String, String)> {
    fn walk(folder: &Path, src: &Path, files: &mut Vec<(String, String)>) {
        let mut entries: Vec<_> =
            std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
        entries.sort();
        for path in entries {
            if path.is_dir() {
                walk(&path, src, files);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let relative = path.strip_prefix(src).unwrap().to_str().unwrap().replace('\\', "/");
                files.push((relative, std::fs::read_to_string(&path).unwrap()));
            }
        }
    }
    let src = repository().join("src");
    let mut files = Vec::new();
    walk(&src, &src, &mut files);
    let tests: Vec<Vec<String>> = files
        .iter()
        .flat_map(|(file, text)| {
            let module = module_of(file);
            let below = move |name: String| module.iter().cloned().chain([name]).collect();
            Shipped::read(text).test_modules.into_iter().map(below)
        })
        .collect();
    files.retain(|(file, _)| !tests.iter().any(|test| module_of(file).starts_with(test)));
    files
}

fn studies() -> Vec<String> {
    std::fs::read_dir(repository().join("src/studies"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.is_dir())
        .map(|path| path.file_name().unwrap().to_str().unwrap().to_owned())
        .filter(|name| name != INFERENCE)
        .collect()
}

#[test]
fn the_code_keeps_its_shape() {
    let files = shipped_files();
    assert!(files.len() > 100, "only {} files found", files.len());
    let studies = studies();
    let violations: Vec<String> = files
        .iter()
        .flat_map(|(file, text)| check(file, text, &studies))
        .map(|violation| violation.to_string())
        .collect();
    assert!(violations.is_empty(), "{} violations:\n{}", violations.len(), violations.join("\n"));
}

#[test]
fn every_module_has_a_layer_and_every_dependency_a_door() {
    let (files, _): (Vec<_>, Vec<_>) = shipped_files().into_iter().unzip();
    for file in &files {
        let top = file.split('/').next().unwrap().trim_end_matches(".rs");
        assert!(
            place(top).is_some(),
            "src/{file}: `{top}` has no layer; give it one in tests/architecture.rs"
        );
    }
    let manifest = std::fs::read_to_string(repository().join("Cargo.toml")).unwrap();
    let dependencies =
        manifest.split("[dependencies]").nth(1).unwrap().split("\n[").next().unwrap();
    for line in dependencies.lines().filter(|l| !l.starts_with('#') && l.contains('=')) {
        let name = line.split('=').next().unwrap().trim().replace('-', "_");
        assert!(
            VOCABULARY.contains(&name.as_str()) || DOORS.iter().any(|(door, _)| *door == name),
            "Cargo.toml: `{name}` has no door; say in tests/architecture.rs which module may name it"
        );
    }
    for (name, doors) in DOORS {
        for door in *doors {
            assert!(
                repository().join("src").join(door).exists(),
                "the door of `{name}`, src/{door}, does not exist"
            );
        }
    }
}

#[test]
fn rooms_without_circles_stay_so() {
    let files = shipped_files();
    for room in WITHOUT_CIRCLES {
        let imports = imports(room, &files);
        assert!(imports.len() > 1, "src/{room} holds no modules");
        assert_eq!(
            circle(&imports),
            None,
            "src/{room}: move what both need into a module below them"
        );
    }
}

#[test]
fn a_circle_is_found_through_other_modules_and_through_the_parent() {
    let found = |files: &[(&str, &str)]| {
        let owned = |(file, text): &(&str, &str)| ((*file).to_owned(), (*text).to_owned());
        circle(&imports("plan", &files.iter().map(owned).collect::<Vec<_>>()))
    };
    let below = ("plan/key.rs", "use crate::digest::Digest; use super::factor::Factor;");
    assert_eq!(found(&[("plan/mod.rs", "mod key;"), below, ("plan/factor.rs", "")]), None);
    assert_eq!(
        found(&[below, ("plan/factor.rs", "fn f() { crate::plan::key::of(); }")]).as_deref(),
        Some("plan::factor -> plan::key -> plan::factor")
    );
    assert_eq!(
        found(&[("plan/mod.rs", "struct Plan;"), ("plan/key.rs", "use super::Plan;")]).as_deref(),
        Some("plan -> plan::key -> plan")
    );
}

#[test]
fn main_only_opens_the_command_line() {
    let text = std::fs::read_to_string(repository().join("src/main.rs")).unwrap();
    assert!(
        text.lines().count() <= 30,
        "src/main.rs has more than 30 lines; move the rest into src/cli"
    );
}

/// Returns what is said of `text` as the file `file`.
fn told(file: &str, text: &str) -> Vec<String> {
    let studies = ["deadline".to_owned(), "prior_map".to_owned()];
    check(file, text, &studies).iter().map(ToString::to_string).collect()
}

#[test]
fn an_import_from_above_is_found_however_it_is_written() {
    let expected = |line| {
        vec![format!(
            "src/geometry/pose.rs:{line}: `geometry` (layer 0) imports `plan` (layer 5), which is not below it; \
             move what it needs down, or pass it in as a value, a function or a trait"
        )]
    };
    for (line, text) in [
        (1, "use crate::plan::Plan;"),
        (2, "use crate::{math,\n    plan::{self, Plan}};"),
        (1, "pub(crate) use crate::plan as p;"),
        (2, "fn f() {\n    crate::plan::expand(); }"),
        (1, "use super::super::plan::Plan;"),
        (3, "#[cfg(test)]\nmod tests { use crate::cli::Exit; }\nuse crate::plan::Plan;"),
        (2, "const Q: char = '\"'; // '\nuse crate::plan::Plan; // \""),
    ] {
        assert_eq!(told("geometry/pose.rs", text), expected(line), "{text}");
    }
}

#[test]
fn what_is_not_shipped_or_not_code_may_name_anything() {
    for text in [
        "#[cfg(test)]\nmod tests {\n    use crate::plan::{self, Plan};\n    fn f() { if true { println!() } }\n}",
        "#[cfg(test)]\nmod tests;",
        "#[cfg(test)]\nuse crate::plan::{Plan, Selection};\nuse crate::math::sin;",
        "// crate::plan\n/* /* crate::plan */ crate::plan */\n//! [`crate::plan`]",
        "const A: &str = \"crate::plan \\\" crate::plan\"; const B: &str = r#\"\" crate::plan\"#;",
        "use super::Point; use self::inner::Pose; fn f<'a>(x: &'a str) -> &'a str { x }",
        "fn f() { let mut a = [1].iter().zip([2]); a.next(); }",
    ] {
        assert_eq!(told("geometry/pose.rs", text), Vec::<String>::new(), "{text}");
    }
}

#[test]
fn neighbours_in_a_layer_do_not_import_each_other() {
    assert_eq!(
        told("runner/event.rs", "use crate::bundle::Sealed;"),
        [
            "src/runner/event.rs:1: `runner` (layer 6) imports `bundle` (layer 6), which is not below it; \
          move what it needs down, or pass it in as a value, a function or a trait"
        ]
    );
    assert_eq!(told("geometry/pose.rs", "use crate::math::sin;"), Vec::<String>::new());
    assert_eq!(told("math.rs", "use crate::geometry::Pose;").len(), 1, "layer 0 has an order");
    assert_eq!(told("store.rs", "use crate::provenance::Environment;"), Vec::<String>::new());
    assert_eq!(
        told("provenance.rs", "use crate::store::publish;").len(),
        1,
        "the shell has an order"
    );
    assert_eq!(
        told("plan/key.rs", "use crate::shortcuts::all;"),
        ["src/plan/key.rs:1: `crate::shortcuts` is in no layer; \
          import it from its own module, or give the module a layer in tests/architecture.rs"]
    );
}

#[test]
fn a_mind_that_sees_the_truth_is_found() {
    let expected = |file: &str, what: &str| {
        format!(
            "src/{file}:1: a mind imports `{what}`, which knows the truth; \
             give it sensor messages from `robot`, or move the code into the study's mission"
        )
    };
    let file = "studies/prior_map/utility.rs";
    assert_eq!(told(file, "use crate::sim::Body;"), [expected(file, "sim::Body")]);
    assert_eq!(told(file, "use crate::world::World;"), [expected(file, "world::World")]);
    assert_eq!(
        told(file, "use super::mission::Reference;"),
        [expected(file, "studies::prior_map::mission::Reference")]
    );
    assert_eq!(
        told(file, "use super::study::PriorMap;"),
        [expected(file, "studies::prior_map::study::PriorMap")]
    );
    assert_eq!(
        told("navigation/local.rs", "use crate::world::World;"),
        [expected("navigation/local.rs", "world::World")]
    );
    for both_ends in
        ["studies/prior_map/mission/mod.rs", "studies/prior_map/study.rs", "studies/mod.rs"]
    {
        assert_eq!(told(both_ends, "use crate::{sim::Body, world::World};"), Vec::<String>::new());
    }
}

#[test]
fn a_study_that_imports_another_is_found() {
    for text in ["use crate::studies::deadline::Policy;", "use super::super::deadline::Policy;"] {
        assert_eq!(
            told("studies/prior_map/utility.rs", text),
            ["src/studies/prior_map/utility.rs:1: study `prior_map` imports study `deadline`; \
              move what both need into a lower module"]
        );
    }
    assert_eq!(
        told("studies/mod.rs", "use crate::studies::{deadline, prior_map};"),
        Vec::<String>::new()
    );
}

#[test]
fn a_second_door_to_a_crate_is_found() {
    assert_eq!(
        told("navigation/local.rs", "fn f(x: f64) -> f64 { libm::sin(x) }"),
        ["src/navigation/local.rs:1: names `libm`, whose door is math.rs; \
          call what that module offers, and add to it what is missing"]
    );
    assert_eq!(told("sim/mod.rs", "use rapier2d as physics;").len(), 1);
    assert_eq!(told("sim/lidar.rs", "use rapier2d::prelude::*;").len(), 1);
    assert_eq!(told("sim/engine.rs", "use rapier2d::prelude::*;"), Vec::<String>::new());
    assert_eq!(told("bundle/archive.rs", "use zip::ZipArchive;"), Vec::<String>::new());
}

#[test]
fn files_clock_environment_and_printing_are_found_outside_the_shell() {
    assert_eq!(
        told("report/page.rs", "fn f() {\n    println!(\"x\");\n}"),
        [
            "src/report/page.rs:2: `println!` outside the shell; return the text, and let cli/ print it"
        ]
    );
    assert_eq!(
        told("world/mod.rs", "use std::{fs, io};"),
        ["src/world/mod.rs:1: `std::fs` outside the shell; \
          take the value as an argument, and let store.rs, provenance.rs or cli/ obtain it"]
    );
    for text in [
        "use std::time::{Duration, Instant};",
        "use std::env;",
        "fn f() { std::time::SystemTime::now(); }",
    ] {
        assert_eq!(told("runner/scheduler.rs", text).len(), 1, "{text}");
    }
    assert_eq!(told("store.rs", "use std::{env, fs};"), Vec::<String>::new());
    assert_eq!(
        told("digest.rs", "const V: &str = env!(\"CARGO_PKG_VERSION\");"),
        Vec::<String>::new()
    );
}
