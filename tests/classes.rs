//! Every file of a bundle is given, derived or a circumstance, and `verify` holds each to its class: here every file of one
//! bundle of each manifest that we ship is changed, with every digest made right again, and refused where its class says. A few manifests of every kind are walked each time, the
//! others by `.ci/full`.
//!
//! The bundles are of one trial of one condition. Calibrations are shortened to the ten passages a maneuver that they need, and
//! trials to twenty seconds where the study lets them; tables of robustness have a test of their own (`derived_inputs.rs`).

use crate::adversary::forger;
use crate::manifests::Beside;
use crate::sandbox::{Answer, Sandbox, repository};
use reenact::bundle::{
    Archive, Bundle, Class, Form, Limits, Tree, archive, class_of, results_digest,
};
use reenact::condition::Condition;
use reenact::document::Source;
use reenact::manifest;
use reenact::verify::{
    Finding, Level, Options, Reenactment, Report, Rows, Severity, climb, plan_of,
};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Our manifests with their surroundings, and the calibration's passages fewer.
struct Shipped {
    sandbox: Sandbox,
}

impl Shipped {
    fn new() -> Self {
        let sandbox = Sandbox::new();
        for part in ["manifests", "robots", "worlds"] {
            copy(&repository().join(part), &sandbox.path(part));
        }
        sandbox.edit("manifests/deadline-calibration.yaml", "trials: 2000", "trials: 10");
        Self { sandbox }
    }

    fn manifests(&self) -> Vec<PathBuf> {
        let entries = fs::read_dir(self.sandbox.path("manifests")).unwrap();
        let paths = entries.map(|entry| entry.unwrap().path());
        let mut paths: Vec<_> =
            paths.filter(|p| p.extension().is_some_and(|e| e == "yaml")).collect();
        paths.sort();
        paths
    }

    /// Runs one trial of one condition of `manifest` and returns the bundle, sealed by the program under test.
    fn bundle(&self, manifest: &Path) -> Bundle {
        let source = Source::new("m.yaml", fs::read_to_string(manifest).unwrap());
        let beside = Beside(manifest.parent().unwrap().to_owned());
        let (experiment, _) = manifest::resolve(&source, &[], &beside).unwrap();
        // One that starts from what an earlier exploration mapped, where there is one.
        let levels = experiment.design().map(|(condition, _)| condition);
        let from_a_map = |levels: &&Condition| {
            levels.iter().any(|(factor, value)| factor == "prior" && value.starts_with("previous"))
        };
        let chosen = levels.clone().find(from_a_map).or_else(|| levels.clone().next()).unwrap();
        let out = tempfile::tempdir().unwrap();
        let mut command = self.sandbox.command(&["run"]);
        command.arg(manifest);
        command.args(["--no-cache", "--trials", "1", "--out"]).arg(out.path());
        for (factor, value) in chosen {
            command.arg("--only").arg(format!("{factor}={value}"));
        }
        if experiment.kind.has_series() {
            command.args(["--set", "parameters.mission.time-limit-s=20"]);
        }
        let answer = Answer::of(&mut command);
        assert_eq!(answer.code, 0, "{}", answer.stderr);
        let path = fs::read_dir(out.path()).unwrap().next().unwrap().unwrap().path();
        Bundle::read(&fs::read(path).unwrap(), &Limits::default()).unwrap()
    }
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            copy(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), target).unwrap();
        }
    }
}

/// Runs `verify --level LEVEL`, without rows of robustness tables.
fn verify(tree: &Tree, level: Level) -> Report {
    let options = Options { level, sample: 59, rows: Some(Rows::Drawn(0)), seed: 4 };
    let archive = Archive::of(Form::Bag, tree.clone());
    climb(Ok(archive), &options, &Reenactment::new(1).unwrap())
}

fn errors(report: &Report) -> Vec<&Finding> {
    report.findings.iter().filter(|finding| finding.severity == Severity::Error).collect()
}

/// Asserts that an error at `level` reports every one of `changed`, and that nothing else breaks below.
#[track_caller]
fn refused(what: &str, tree: &Tree, level: Level, changed: &[String]) {
    let report = verify(tree, level);
    let errors = errors(&report);
    for path in changed {
        let of_it = |f: &&&Finding| f.path.split(':').next() == Some(path.as_str());
        let told = errors
            .iter()
            .find(of_it)
            .unwrap_or_else(|| panic!("{what}: nothing is said of {path}: {:#?}", report.findings));
        assert!(told.level <= level, "{what}: {told}");
    }
    assert!(report.reached < Some(level), "{what}: {level} is called passed");
}

/// Returns `bytes` changed as little as a text or an image can be.
fn changed(path: &str, bytes: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    let json = path.rsplit('.').next() == Some("json");
    match bytes.iter().rposition(u8::is_ascii_digit).filter(|_| json) {
        // A digit, so that it stays JSON.
        Some(at) => bytes[at] = if bytes[at] == b'7' { b'3' } else { b'7' },
        None => bytes.extend_from_slice(b" \n"),
    }
    bytes
}

/// Returns the honest tree with all of `paths` changed and every digest made right.
fn forged(honest: &Tree, paths: &[String]) -> Tree {
    let mut tree = honest.clone();
    for path in paths {
        let bytes = changed(path, &tree[path]);
        tree.insert(path.clone(), bytes);
    }
    forger::reseal(&mut tree);
    tree
}

/// Changes every file of `bundle` and returns the classes met.
fn walk(name: &str, bundle: &Bundle) -> BTreeSet<&'static str> {
    let honest = bundle.tree();
    let report = verify(honest, Level::Full);
    assert!(errors(&report).is_empty(), "{name}: {:#?}", report.findings);
    let class = |path: &String| {
        class_of(bundle, path).unwrap_or_else(|| panic!("{name}: {path} is of no class"))
    };
    let of = |wanted: Class| -> Vec<String> {
        honest.keys().filter(|path| class(path) == wanted).cloned().collect()
    };

    // Tag files: the lists and the declaration.
    for path in of(Class::Derived(1)) {
        let mut tree = honest.clone();
        let line = format!("{}  data/none.txt\n", "0".repeat(64));
        let addition = if path == "bagit.txt" { "Tag: another\n" } else { &line };
        let list = tree.get_mut(&path).unwrap();
        list.extend_from_slice(addition.as_bytes());
        if path != "tagmanifest-sha256.txt" {
            let digest = reenact::digest::Sha256Digest::of(&tree[&path]);
            forger::edit(&mut tree, "tagmanifest-sha256.txt", |text| {
                let right = |line: &str| {
                    if line.ends_with(&format!("  {path}")) {
                        return format!("{digest}  {path}\n");
                    }
                    format!("{line}\n")
                };
                text.lines().map(right).collect()
            });
        }
        let report = verify(&tree, Level::Fixity);
        assert!(!errors(&report).is_empty(), "{name}: {path} may say anything");
    }
    // What describes is held against the rest only where that is right, so results and descriptions are changed apart.
    let (results, others): (Vec<_>, Vec<_>) =
        of(Class::Derived(3)).into_iter().partition(|path| path.starts_with("data/results/"));
    refused(name, &forged(honest, &results), Level::Derived, &results);
    let is_page = |path: &String| path.ends_with("ro-crate-preview.html");
    let (pages, others): (Vec<_>, Vec<_>) = others.into_iter().partition(is_page);
    for path in pages {
        let paths = [path];
        refused(name, &forged(honest, &paths), Level::Derived, &paths);
    }
    let not_text =
        |path: &&String| path.ends_with("resolved.json") || path.ends_with("metadata.json");
    let (documents, texts): (Vec<_>, Vec<_>) = others.iter().cloned().partition(|p| not_text(&p));
    refused(name, &forged(honest, &texts), Level::Derived, &texts);
    let mut tree = honest.clone();
    forger::replace(&mut tree, forger::METADATA, "\"CreateAction\"", "\"Action\"");
    forger::reseal(&mut tree);
    refused(name, &tree, Level::Derived, &[forger::METADATA.to_owned()]);
    let mut tree = honest.clone();
    forger::set_json(&mut tree, forger::RESOLVED, |resolved| {
        resolved["study"]["title"] = "Another".into();
    });
    forger::reseal(&mut tree);
    refused(name, &tree, Level::Derived, &[forger::RESOLVED.to_owned()]);
    assert_eq!(documents.len(), 2, "{name}");

    // What was executed: a number of it changed, with everything that follows derived again by the program itself.
    for path in of(Class::Derived(5)) {
        let tree = match fabricated(bundle, &path) {
            Fabricated::Follows => continue,
            Fabricated::Unplannable(tree) => {
                // A later exploration is named after what this one gave.
                assert!(!errors(&verify(&tree, Level::Derived)).is_empty(), "{name}: {path}");
                continue;
            }
            Fabricated::Whole(tree) => tree,
        };
        assert!(
            errors(&verify(&tree, Level::Derived)).is_empty(),
            "{name}: {path} is told too early"
        );
        refused(name, &tree, Level::Full, &[path]);
    }

    // The author's: another one makes another study.
    let (digest, given) = (results_digest(honest), of(Class::Given));
    for path in &given {
        let tree = forged(honest, std::slice::from_ref(path));
        assert_ne!(results_digest(&tree), digest, "{name}: {path} is not told apart");
    }
    let mut tree = honest.clone();
    forger::edit(&mut tree, forger::STUDY, |text| {
        let seed = |line: &str| {
            [if line.starts_with("seed:") { "seed: 424242" } else { line }, "\n"].concat()
        };
        text.lines().map(seed).collect()
    });
    forger::reseal(&mut tree);
    assert!(!errors(&verify(&tree, Level::Derived)).is_empty(), "{name}: another seed is not told");

    // The run's own words, which say so themselves; their labels are a closed list all the same.
    let mut tree = honest.clone();
    forger::edit(&mut tree, forger::INFO, |text| format!("{text}Source-Organization: ACM\n"));
    forger::reseal_manifests(&mut tree);
    refused(name, &tree, Level::Coherent, &[forger::INFO.to_owned()]);
    assert_eq!(report.circumstances.last(), Some(&"time and host of the run"), "{name}");

    honest.keys().map(|path| class(path).name()).collect()
}

/// A forgery of something that was executed.
enum Fabricated {
    /// There is none of this file alone: it follows from another such file, or takes runs at other values to make.
    Follows,
    /// With it, what follows from it can no longer be planned.
    Unplannable(Tree),
    /// The best there is, with everything that follows.
    Whole(Tree),
}

/// Returns the best forgery of what was executed before or in the trials of `bundle` that changes `path`.
fn fabricated(bundle: &Bundle, path: &str) -> Fabricated {
    let mut tree = bundle.tree().clone();
    if let Some(slug) = path.strip_prefix("data/trials/").and_then(|p| p.strip_suffix(".jsonl")) {
        forger::set_records(&mut tree, slug, |records| {
            let measures = records[0]["measures"].as_object_mut().unwrap();
            let number =
                measures.values_mut().find(|value| value.as_f64().is_some_and(|x| x > 0.0));
            *number.unwrap() = 0.125.into();
        });
    } else if path.ends_with(".passages.csv") {
        let text = forger::text(&tree, path);
        let row = text.lines().position(|line| line.contains(",reached,")).unwrap();
        forger::set_cell(&mut tree, path, row, "time-s", "1.5");
    } else if path.contains("previous-map-") && path.rsplit('.').next() == Some("pgm") {
        let image = tree.get_mut(path).unwrap();
        let at = image.iter().rposition(|pixel| *pixel == 254).unwrap();
        image[at] = 0;
    } else {
        return Fabricated::Follows;
    }
    forger::reseal(&mut tree);
    let forged = Bundle::open(Archive::of(Form::Bag, tree.clone())).unwrap();
    match plan_of(&forged) {
        Ok(_) => Fabricated::Whole(forger::rederive(tree)),
        Err(_) => Fabricated::Unplannable(tree),
    }
}

/// Manifests of which every file of a bundle is changed each time: one of each study, one with a calibration, one with the map of
/// an earlier exploration. Walks through the others find the same faults in minutes.
const EACH_KIND: [&str; 4] = ["deadline", "prior-tables-7-8", "quickstart", "wander"];

/// Walks through a bundle of every manifest of which `wanted` says yes, on two threads, and returns how many there are.
fn walk_all(wanted: impl Fn(&str) -> bool) -> usize {
    let shipped = Shipped::new();
    let named = |path: &PathBuf| wanted(&path.file_stem().unwrap().to_string_lossy());
    let manifests: Vec<PathBuf> = shipped.manifests().into_iter().filter(named).collect();
    let next = AtomicUsize::new(0);
    let classes: Vec<BTreeSet<&str>> = std::thread::scope(|scope| {
        let walks = [(); 2].map(|()| {
            scope.spawn(|| {
                let mut met = Vec::new();
                while let Some(path) = manifests.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let name = path.file_stem().unwrap().to_string_lossy();
                    met.push(walk(&name, &shipped.bundle(path)));
                }
                met
            })
        });
        walks.into_iter().flat_map(|walk| walk.join().unwrap()).collect()
    });
    assert_eq!(classes.len(), manifests.len());
    let all: BTreeSet<&str> = classes.into_iter().flatten().collect();
    assert_eq!(all.into_iter().collect::<Vec<_>>(), ["circumstance", "derived", "given"]);
    manifests.len()
}

#[test]
fn every_file_of_a_bundle_is_refused_where_its_class_says() {
    assert_eq!(walk_all(|name| EACH_KIND.contains(&name)), EACH_KIND.len());
}

#[test]
#[ignore = "takes minutes; .ci/full does it"]
fn every_file_of_every_other_manifests_bundle_is_refused_where_its_class_says() {
    assert!(walk_all(|name| !EACH_KIND.contains(&name)) > EACH_KIND.len());
}

/// A zip is read as the tree that the walk changes.
#[test]
fn a_walk_changes_what_readers_read() {
    let shipped = Shipped::new();
    let quickstart = shipped.sandbox.path("manifests/quickstart.yaml");
    let bundle = shipped.bundle(&quickstart);
    let zip = archive::write(bundle.tree(), "b", Form::Bag);
    assert_eq!(archive::read(&zip, &Limits::default()).unwrap().tree, *bundle.tree());
}
