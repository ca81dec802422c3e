//! Manifests from the outside: faults told whole, and identities that depend on nothing but meaning.

use crate::sandbox::repository;
use proptest::prelude::*;
use reenact::bundle::assemble;
use reenact::document::{Diagnostic, Source};
use reenact::manifest::{
    self, CalibrationTrials, Experiment, InputError, Inputs, ProposalTrials, WrittenIn,
};
use reenact::plan::{Plan, ResolvedStudy, Selection, engine_version};
use reenact::studies::{StudyKind, TrialRecord, TrialSpec};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Files beside a manifest; those written on the command line do not exist.
pub(crate) struct Beside(pub(crate) PathBuf);

impl Inputs for Beside {
    fn read(&self, as_written: &str, written_in: WrittenIn) -> Result<Vec<u8>, InputError> {
        match written_in {
            WrittenIn::CommandLine
            | WrittenIn::Calibration
            | WrittenIn::Inference
            | WrittenIn::PreviousMap => Err(InputError::NoFile),
            WrittenIn::Manifest => {
                std::fs::read(self.0.join(as_written)).map_err(|_| InputError::NoFile)
            }
        }
    }

    /// Returns numbers that stand in for a run.
    fn calibrate(&self, _: &Experiment, _: &str) -> Result<CalibrationTrials, InputError> {
        Ok(CalibrationTrials::StandIn)
    }

    /// Returns draws that stand in for those of a run.
    fn propose(&self, _: &Experiment, _: &str) -> Result<ProposalTrials, InputError> {
        Ok(ProposalTrials::StandIn)
    }

    /// Returns floor plans that stand in for explorations.
    fn explore(
        &self,
        spec: &TrialSpec,
        sealed_as: &[String; 2],
    ) -> Result<[Vec<u8>; 2], InputError> {
        Ok(manifest::unexplored(spec, sealed_as)?)
    }
}

/// Files by the last part of their path.
struct InMemory(BTreeMap<&'static str, String>);

impl Inputs for InMemory {
    fn read(&self, as_written: &str, _: WrittenIn) -> Result<Vec<u8>, InputError> {
        let name = as_written.rsplit('/').next().unwrap_or_default();
        self.0.get(name).map(|text| text.clone().into_bytes()).ok_or(InputError::NoFile)
    }
}

type Resolved = Result<(Experiment, Vec<Diagnostic>), Vec<Diagnostic>>;

/// Resolves the manifest in `folder`, with the overrides that its first comments name.
fn resolve_file(folder: &str, file: &str) -> Resolved {
    let path = repository().join(folder).join(file);
    let text = std::fs::read_to_string(&path).unwrap();
    let overrides: Vec<String> =
        text.lines().filter_map(|l| l.strip_prefix("# --set ")).map(str::to_owned).collect();
    let source = Source::new(format!("{folder}/{file}"), text);
    manifest::resolve(&source, &overrides, &Beside(repository().join(folder)))
}

fn told(faults: &[Diagnostic]) -> String {
    faults.iter().map(|fault| fault.render(false)).collect::<Vec<_>>().join("\n")
}

fn manifests_in(folder: &str) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(repository().join(folder))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| Path::new(name).extension().is_some_and(|e| e == "yaml"))
        .collect();
    names.sort();
    assert!(!names.is_empty(), "{folder} has manifests");
    names
}

fn snapshots(folder: &str) -> insta::Settings {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(repository().join(folder));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings
}

#[test]
fn every_fault_is_told_whole() {
    snapshots("tests/manifests/invalid").bind(|| {
        for name in manifests_in("tests/manifests/invalid") {
            let Err(faults) = resolve_file("tests/manifests/invalid", &name) else {
                panic!("{name} resolves");
            };
            insta::assert_snapshot!(name.trim_end_matches(".yaml"), told(&faults));
        }
    });
}

#[test]
fn every_warning_is_told_whole() {
    snapshots("tests/manifests/warned").bind(|| {
        for name in manifests_in("tests/manifests/warned") {
            match resolve_file("tests/manifests/warned", &name) {
                Ok((_, warnings)) => {
                    insta::assert_snapshot!(name.trim_end_matches(".yaml"), told(&warnings));
                }
                Err(faults) => panic!("{name} does not resolve:\n{}", told(&faults)),
            }
        }
    });
}

#[test]
fn our_own_manifests_resolve_without_a_word() {
    for name in manifests_in("manifests") {
        match resolve_file("manifests", &name) {
            // Plans drawn from memory fit badly, all three of them, and that is to be said.
            Ok((_, warnings)) if name == "prior-table-10.yaml" => {
                assert_eq!(warnings.len(), 3, "{}", told(&warnings));
                for (number, warning) in (1..).zip(&warnings) {
                    let text = told(std::slice::from_ref(warning));
                    assert!(text.contains("the prior map fits the world badly"), "{text}");
                    assert!(text.contains(&format!("  hand-drawn-{number}: ")), "{text}");
                }
            }
            // Doors that stand ajar, so that the robot looks through them and does not pass: worlds/department-south.yaml.
            Ok((_, warnings)) if name == "prior-tables-11-12.yaml" => {
                let text = told(&warnings);
                assert!(text.contains("the robot is too wide for 31 % of the floor"), "{text}");
                assert_eq!(warnings.len(), 1, "{text}");
            }
            Ok((_, warnings)) => assert_eq!(told(&warnings), "", "{name}"),
            Err(faults) => panic!("{name} does not resolve:\n{}", told(&faults)),
        }
    }
}

/// What the deadline paper states, and what names an experiment rather than a choice of ours: these need no reason.
const STATED: [&str; 16] = [
    "mission.deadline-s",              // section 6, by start
    "mission.task",                    // what is run
    "passage.motion",                  // what is run
    "passage.speed",                   // what is run
    "rules.frontier.ties",             // section 5: uniform
    "rules.initial-vertices",          // section 4: K = 3
    "rules.normalized-frontier.gamma", // section 5: 0.5
    "rules.planner.failure-bound",     // section 6: 0.99
    "rules.planner.method",            // section 3
    "rules.schedule.ample-above",      // section 5
    "rules.schedule.middle-factor",    // section 5
    "rules.schedule.scarce-below",     // section 5
    "rules.schedule.scarce-factor",    // section 5
    "rules.strategy",                  // section 5
    "sensing.drive-noise-angular",     // section 6: 25 %
    "sensing.drive-noise-linear",      // section 6: 25 %
];

#[test]
fn every_parameter_that_the_deadline_paper_leaves_open_has_its_reason() {
    // The sensitivity run varies them: that is its reason.
    let varies = |name: &String| name == "deadline-sensitivity.yaml";
    let ours = manifests_in("manifests");
    for name in ours.iter().filter(|name| name.starts_with("deadline") && !varies(name)) {
        let (experiment, _) = resolve_file("manifests", name).map_err(|f| told(&f)).unwrap();
        let defaults = serde_json::json!(reenact::studies::deadline::Parameters::default());
        let mut open = Vec::new();
        leaves(&defaults, "", &mut open);
        let given: Vec<&str> = experiment.assumptions.iter().map(|a| a.path.as_str()).collect();
        open.retain(|path| !STATED.contains(&path.as_str()));
        // The robot's own, from its data sheet.
        open.retain(|path| path != "sensing.range-noise-sd-m");
        open.retain(|path| !given.contains(&format!("parameters.{path}").as_str()));
        assert!(open.is_empty(), "{name} gives no reason for {open:?}");
    }
}

fn leaves(value: &serde_json::Value, path: &str, found: &mut Vec<String>) {
    let Some(group) = value.as_object() else {
        found.push(path.to_owned());
        return;
    };
    for (key, value) in group {
        let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
        leaves(value, &path, found);
    }
}

fn quickstart() -> Experiment {
    resolve_file("manifests", "quickstart.yaml").map_err(|f| told(&f)).unwrap().0
}

/// Without a statement the resolved study keeps its bytes, and with it every digest of it.
#[test]
fn what_a_manifest_states_of_its_limits_is_sealed_and_nothing_where_it_states_none() {
    let resolved = |name| {
        let experiment = resolve_file("manifests", name).map_err(|f| told(&f)).unwrap().0;
        ResolvedStudy::of(&experiment, "1").to_json()
    };
    assert!(resolved("quickstart.yaml").get("limits").is_none());
    let limits = &resolved("prior-tables-11-12.yaml")["limits"];
    assert!(limits[0].as_str().unwrap().starts_with("No reproduction:"), "{limits}");
}

#[test]
fn the_quickstart_is_twenty_trials_in_two_conditions() {
    let plan = Plan::of(quickstart());
    let names: Vec<String> = plan.experiment.design().map(|(c, _)| c.slug()).collect();
    assert_eq!((names.join(" "), plan.trials.len()), ("none floor-plan".to_owned(), 20));
    let inputs: Vec<&str> = plan.experiment.inputs.iter().map(|i| i.as_written.as_str()).collect();
    assert_eq!(
        inputs,
        [
            "../robots/kobuki.urdf",
            "../worlds/basic.yaml",
            "reference/prior-table-1-basic-unfurnished.csv",
            "reference/prior-table-2-basic-unfurnished.csv"
        ]
    );
    let keys: std::collections::BTreeSet<_> = plan.trials.iter().map(|t| t.key).collect();
    assert_eq!(keys.len(), 20, "no two trials are the same");
    let resolved = plan.resolved().to_text();
    assert!(!resolved.contains(repository().to_str().unwrap()), "nothing of this machine");
}

#[test]
fn trials_are_found_by_key_and_by_name() {
    let plan = Plan::of(quickstart());
    let trial = plan.find("floor-plan/3").unwrap();
    assert_eq!((trial.condition.to_string().as_str(), trial.trial), ("prior=floor-plan", 3));
    assert_eq!(plan.find(&trial.key.hex()[..8]).unwrap().key, trial.key);
    assert_eq!(plan.find(&trial.key.hex().to_uppercase()[..12]).unwrap().key, trial.key);
    let fault = |wanted: &str| plan.find(wanted).unwrap_err().to_string();
    assert_eq!(
        fault("floor-plan/10"),
        "no trial `floor-plan/10` in this plan; it begins with `none/0`"
    );
    assert_eq!(fault("00000000"), "no trial `00000000` in this plan; it begins with `none/0`");
    assert_eq!(
        fault("abc"),
        "`abc` is neither at least 8 hex digits of a trial's key nor CONDITION/NUMBER"
    );
    let text = plan.explain(trial);
    assert!(text.starts_with(&format!("trial floor-plan/3\nkey   {}\n", trial.key)));
    assert!(text.contains("\n  condition.prior = \"floor-plan\"\n"));
    assert!(text.contains("\n  parameters.sensing.range-m = 10\n"));
}

#[test]
fn selections_keep_the_keys_of_what_they_keep() {
    let all = Plan::of(quickstart());
    assert!(!all.partial);
    let only = Selection::parse(&["prior=floor-plan".into()], Some(2), None).unwrap();
    let part = Plan::select(quickstart(), &only).unwrap();
    assert!(part.partial);
    let keys: Vec<_> = part.trials.iter().map(|t| t.key).collect();
    assert_eq!(keys, all.trials[10..12].iter().map(|t| t.key).collect::<Vec<_>>());

    let mut sharded = Vec::new();
    for i in 1..=3 {
        let shard = Selection::parse(&[], None, Some(&format!("{i}/3"))).unwrap();
        sharded.extend(Plan::select(quickstart(), &shard).unwrap().trials.iter().map(|t| t.key));
    }
    let mut keys: Vec<_> = all.trials.iter().map(|t| t.key).collect();
    keys.sort();
    sharded.sort();
    assert_eq!(sharded, keys, "shards are a partition");

    let fault = |only: &str| {
        let selection = Selection::parse(&[only.to_owned()], None, None);
        selection.and_then(|s| Plan::select(quickstart(), &s)).unwrap_err().to_string()
    };
    assert_eq!(fault("prior"), "`--only prior` is not FACTOR=VALUE[,VALUE]");
    assert_eq!(
        fault("piror=none"),
        "unknown factor `piror` in `--only`: did you mean `prior`? (known: prior)"
    );
    assert_eq!(
        fault("prior=non"),
        "`non` is not a value of the factor `prior`: did you mean `none`? (known: none, floor-plan)"
    );
    let shard = |s: &str| Selection::parse(&[], None, Some(s)).unwrap_err().to_string();
    assert_eq!(shard("4/3"), "`--shard 4/3` is not I/N with I from 1 to N");
}

#[test]
fn the_resolved_study_writes_everything_out() {
    let plan = Plan::of(quickstart());
    let resolved = plan.resolved().to_json();
    assert_eq!(resolved["engine-version"], engine_version(plan.experiment.kind));
    assert_eq!(resolved["inputs"][1]["file"], "inputs/basic.yaml");
    assert_eq!(resolved["inputs"][1]["sha256"].as_str().map(str::len), Some(64));
    let condition = &resolved["conditions"][1];
    assert_eq!(condition["condition"]["prior"], "floor-plan");
    assert_eq!(condition["described"]["prior"]["floor-plan-of"], "world");
    assert_eq!(condition["parameters"]["mapping"]["resolution-m"], 0.1, "defaults too");
}

#[test]
fn parameters_may_have_reasons_and_depend_on_factors() {
    let text = "\
reenact: 1
name: a
title: A
study: prior-map
seed: 1
trials: 1
robot: kobuki.urdf
world: {file: basic.yaml, layers: {by: furnished, values: {true: [furniture], false: []}}}
start: {by: furnished, values: {true: {x-m: 3, y-m: 2}, false: {x-m: 2, y-m: 2}}}
factors:
  furnished: [false, true]
  range-m: {by: furnished, values: {false: [10.0, 20], true: [30]}}
exclude: [{range-m: 20}]
include: [{furnished: true, range-m: 10}]
parameters:
  sensing:
    range-m: {by: range-m, values: {10: 10, 20: 20, 30.0: 30}, why: hardware}
  mapping:
    particles: {value: 1, why: as released}
";
    let (experiment, warnings) = resolve_text(text, &[]).map_err(|f| told(&f)).unwrap();
    assert_eq!(told(&warnings), "");
    let seen: Vec<String> = experiment
        .design()
        .map(|(condition, setup)| {
            format!(
                "{} x={} {} {}",
                condition.slug(),
                setup.start().x,
                setup.parameters()["sensing"]["range-m"],
                setup.world().layers().len()
            )
        })
        .collect();
    assert_eq!(seen, ["false_10 x=2 10.0 1", "true_30 x=3 30.0 2", "true_10 x=3 10.0 2"]);
    let why: Vec<_> =
        experiment.assumptions.iter().map(|a| format!("{}: {}", a.path, a.why)).collect();
    assert_eq!(
        why,
        ["parameters.mapping.particles: as released", "parameters.sensing.range-m: hardware"]
    );
}

#[test]
fn generated_buildings_are_named_by_seeds_and_told_apart() {
    let text = format!(
        "{HEAD}seed: 1\ntrials: 1\nrobot: kobuki.urdf\nstart: B\nfactors: {{building: [0, 1, 2]}}\n\
         world: {{generate: {{family: office-floor, seed: {{factor: building}}}}}}\n"
    );
    let (experiment, warnings) = resolve_text(&text, &[]).map_err(|f| told(&f)).unwrap();
    assert_eq!(told(&warnings), "");
    let inputs: Vec<&str> = experiment.inputs.iter().map(|i| i.as_written.as_str()).collect();
    assert_eq!(inputs, ["kobuki.urdf"], "a building that is made is no file");
    let meanings: Vec<String> =
        experiment.conditions.iter().map(|c| c.meanings.world.hex()).collect();
    let own = |seed: u64| {
        reenact::world::generate::generate(reenact::world::generate::Family::OfficeFloor, seed)
            .unwrap()
            .meaning()
            .hex()
    };
    assert_eq!(meanings, [own(0), own(1), own(2)]);
    let plan = Plan::of(experiment);
    let described = &plan.resolved().to_json()["conditions"][2]["described"]["world"];
    assert_eq!(described.to_string(), r#"{"generate":{"family":"office-floor","seed":2}}"#);

    // A number and a factor's value are the same seed, so the building is the same.
    let fixed = text.replace("{factor: building}", "1");
    let (experiment, _) = resolve_text(&fixed, &[]).map_err(|f| told(&f)).unwrap();
    assert!(experiment.conditions.iter().all(|c| c.meanings.world.hex() == own(1)));
}

#[test]
fn goal_and_starts_lie_where_a_manifest_puts_them() {
    use reenact::world::generate::{Family, generate};
    use reenact::world::topology::{TagScheme, Topology};
    let own = generate(Family::OfficeFloor, 1).unwrap();
    let graph = Topology::read(&own.tags, &TagScheme::default()).unwrap();
    let room = |number: &usize| {
        let vertex = &graph.vertices[*number];
        vertex.exits.len() == 1
            && !vertex.is_goal
            && vertex.kind == reenact::world::RegionKind::Room
    };
    let goal = (0..graph.vertices.len()).find(room).unwrap();
    let at = graph.vertices[goal].at;
    let text = |place: &str| {
        format!(
            "{HEAD}seed: 1\ntrials: 1\nrobot: kobuki.urdf\nstart: B\nfactors: {{x: [1]}}\n\
             world: {{generate: {{family: office-floor, seed: 1}}, place: {place}}}\n"
        )
    };
    let place = format!(
        "{{goal: {{x-m: {}, y-m: {}}}, starts: {{B: {{x-m: 1, y-m: 2, heading-deg: 90}}}}}}",
        at.x, at.y
    );
    let (experiment, _) = resolve_text(&text(&place), &[]).map_err(|f| told(&f)).unwrap();
    let setup = &experiment.conditions[0].setup;
    let moved = Topology::read(&setup.world().tags, &TagScheme::default()).unwrap();
    assert_eq!(moved.goals().collect::<Vec<_>>(), [goal]);
    let (found, start) = (setup.world().goals["goal"], setup.start());
    assert_eq!((found.x, found.y), (at.x, at.y));
    assert_eq!((start.x, start.y, start.heading), (1.0, 2.0, std::f64::consts::FRAC_PI_2));
    assert_eq!(setup.world().starts["A"], own.starts["A"], "what is not placed stays");
    assert_ne!(setup.world().meaning(), own.meaning());

    let without = text("{goal: {x-m: 1, y-m: 1}}")
        .replace("generate: {family: office-floor, seed: 1}", "file: basic.yaml");
    let faults = resolve_text(&without.replace("start: B", "start: {x-m: 3, y-m: 2}"), &[]);
    assert_eq!(
        told(&faults.unwrap_err()),
        "error: the world has no one goal that could be moved\n  --> a.yaml:10:41\n   |\n10 | world: {file: basic.yaml, place: {goal: {x-m: 1, y-m: 1}}}\n   |                                         ^^^^^^^^^^^^^^^^ it has 0 goals\n   |\n   = help: leave the goal out, or give the world one\n"
    );
}

fn resolve_text(text: &str, overrides: &[String]) -> Resolved {
    let file = |path: &str| std::fs::read_to_string(repository().join(path)).unwrap();
    let files = InMemory(BTreeMap::from([
        ("kobuki.urdf", file("robots/kobuki.urdf")),
        ("basic.yaml", file("worlds/basic.yaml")),
        // The same world with a remark and under another name.
        ("renamed.yaml", format!("# a remark\n{}", file("worlds/basic.yaml"))),
    ]));
    manifest::resolve(&Source::new("a.yaml", text), overrides, &files)
}

const LINES: [&str; 7] = [
    "seed: 1",
    "trials: 2",
    "robot: kobuki.urdf",
    "start: {x-m: 3, y-m: 2}",
    "factors: {prior: [none, floor-plan], size: [1, 2]}",
    "prior-maps: {floor-plan: {floor-plan-of: world}}",
    "parameters: {sensing: {range-m: 10, range-noise-sd-m: 0.1}}",
];
const HEAD: &str = "reenact: 1\nname: a\ntitle: A\nstudy: prior-map\n";
const WORLD: &str = "world: {file: basic.yaml, layers: [walls]}";

fn keys(text: &str, overrides: &[String]) -> Vec<String> {
    let (experiment, _) = resolve_text(text, overrides).map_err(|f| told(&f)).unwrap();
    Plan::of(experiment).trials.iter().map(|t| t.key.hex()).collect()
}

#[test]
fn keys_depend_on_meaning_alone() {
    let written = |lines: &[&str]| format!("{HEAD}{}\n", lines.join("\n"));
    let mut lines = LINES.to_vec();
    lines.push(WORLD);
    let reference = keys(&written(&lines), &[]);
    assert_eq!(reference.len(), 8);

    let same = |name: &str, lines: &[&str], overrides: &[&str]| {
        let overrides: Vec<String> = overrides.iter().map(|o| (*o).to_owned()).collect();
        assert_eq!(keys(&written(lines), &overrides), reference, "{name}");
    };
    let reversed: Vec<&str> = lines.iter().rev().copied().collect();
    same("the order of keys", &reversed, &[]);
    let mut commented = vec!["# a remark", ""];
    commented.extend(&lines);
    same("comments", &commented, &[]);
    let with = |from: &str, to: &'static str| -> Vec<&str> {
        lines.iter().map(|line| if *line == from { to } else { *line }).collect()
    };
    same(
        "paths, comments and names of inputs",
        &with(WORLD, "world: {file: somewhere/renamed.yaml, layers: [walls]}"),
        &[],
    );
    same("defaults written out", &with(LINES[3], "start: {x-m: 3.0, y-m: 2, heading-deg: 0}"), &[]);
    same(
        "reasons",
        &with(
            LINES[6],
            "parameters: {sensing: {range-m: {value: 10, why: x}, range-noise-sd-m: 1e-1}}",
        ),
        &[],
    );
    same("overrides that change nothing", &lines, &["seed=1", "parameters.sensing.range-m=10.0"]);
    same(
        "tables asked for",
        &lines,
        &["tables=[{id: t, coverage-table: {metric: time-s, at: [70], by: prior, rows: [size]}}]"],
    );

    let fewer = keys(&written(&lines), &["trials=1".to_owned()]);
    assert!(fewer.iter().all(|key| reference.contains(key)), "the number of trials");

    for change in [
        "seed=2",
        "parameters.sensing.range-m=10.5",
        "start.heading-deg=90",
        "world.layers=[furniture]",
        "shared-noise=[prior]",
        "factors.size=[3, 4]",
    ] {
        let changed = keys(&written(&lines), &[change.to_owned()]);
        assert!(changed.iter().all(|key| !reference.contains(key)), "{change} changes every key");
    }
    let other_prior =
        keys(&written(&lines), &["prior-maps.floor-plan={footprint-of: world}".to_owned()]);
    assert_eq!(other_prior[..4], reference[..4], "trials without prior keep theirs");
    assert!(other_prior[4..].iter().zip(&reference[4..]).all(|(a, b)| a != b));
}

#[test]
fn noise_is_shared_where_declared_and_only_there() {
    let draws = |shared: &str| -> Vec<u64> {
        let text = format!("{HEAD}{}\n{WORLD}\nshared-noise: {shared}\n", LINES.join("\n"));
        let (experiment, _) = resolve_text(&text, &[]).map_err(|f| told(&f)).unwrap();
        Plan::of(experiment).trials.iter().map(|t| t.seeds.stream("lidar").bits()).collect()
    };
    let distinct = |mut draws: Vec<u64>| {
        draws.sort_unstable();
        draws.dedup();
        draws.len()
    };
    assert_eq!(distinct(draws("[]")), 8);
    assert_eq!(distinct(draws("[prior]")), 4);
    assert_eq!(distinct(draws("[prior, size]")), 2);
    let shared = draws("[prior]");
    assert_eq!(shared[..4], shared[4..], "the same noise without prior and with");
}

#[test]
fn schemas_name_every_key() {
    let schema = manifest::schema(None);
    let parameters = schema.to_string();
    for key in ["prior-maps", "shared-noise", "range-noise-sd-m", "floor-plan-of", "coverage-table"]
    {
        assert!(parameters.contains(&format!("\"{key}\"")), "{key}");
    }
}

#[test]
fn the_reference_tells_every_parameter_with_its_default() {
    let reference = std::fs::read_to_string(repository().join("docs/manifest.md")).unwrap();
    let defaults =
        serde_json::to_value(reenact::studies::prior_map::Parameters::default()).unwrap();
    for (group, values) in defaults.as_object().unwrap() {
        for (key, value) in values.as_object().unwrap() {
            let value = reenact::json::canonical(value);
            let row = format!("| `{group}.{key}` | `{}` |", value.trim_matches('"'));
            assert!(reference.contains(&row), "docs/manifest.md lacks `{row}`");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn damaged_manifests_are_refused_or_read_never_worse(
        at in any::<prop::sample::Index>(),
        piece in "[a-z0-9:,{}\\[\\]\n\"' -]{0,8}",
        cut in 0_usize..12,
    ) {
        let text = format!("{HEAD}{}\n{WORLD}\n", LINES.join("\n"));
        let start = at.index(text.len());
        let end = (start + cut).min(text.len());
        let damaged = format!("{}{piece}{}", &text[..start], &text[end..]);
        if let Err(faults) = resolve_text(&damaged, &[]) {
            prop_assert!(!told(&faults).is_empty());
        }
    }

    #[test]
    fn no_override_panics(path in "[a-z.\\[\\]0-9-]{0,20}", value in "[a-z0-9:,{}\\[\\]\" ]{0,10}") {
        let text = format!("{HEAD}{}\n{WORLD}\n", LINES.join("\n"));
        let _ = resolve_text(&text, &[format!("{path}={value}")]);
    }
}

/// Creates a record that has every measure a trial of the study can have.
fn with_every_measure(kind: StudyKind, spec: &TrialSpec) -> TrialRecord {
    let asked_for = ["coverage-percent-at-239-m".to_owned()];
    let further = asked_for.iter().filter(|name| kind.is_further_measure(name));
    let names = kind.measures().into_iter().chain(further.cloned());
    TrialRecord {
        outcome: kind.outcomes()[0],
        measures: names.map(|name| (name, Some(1.0))).collect(),
        ..TrialRecord::panicked(spec, String::new())
    }
}

#[test]
fn every_column_of_every_table_of_every_study_is_described() {
    let mut tables = 0;
    for file in manifests_in("manifests") {
        let (experiment, _) = resolve_file("manifests", &file).map_err(|f| told(&f)).unwrap();
        let kind = experiment.kind;
        let selection = Selection { trials: Some(1), ..Selection::default() };
        let plan = Plan::select(experiment, &selection).unwrap();
        let records: Vec<TrialRecord> =
            plan.trials.iter().map(|spec| with_every_measure(kind, spec)).collect();
        let content = assemble::assemble(&plan, b"", &selection, &records).unwrap();
        let csv = |path: &str| Path::new(path).extension().is_some_and(|e| e == "csv");
        let inputs = content.inputs.iter().map(|input| format!("inputs/{}", input.name));
        let results = content.results.iter().map(|(path, _)| format!("results/{path}"));
        for path in inputs.chain(results).filter(|path| csv(path)) {
            let table = content.tables.iter().find(|table| table.path == path);
            let table = table.unwrap_or_else(|| panic!("{file}: {path} is not described"));
            tables += 1;
            for column in &table.columns {
                assert!(
                    !column.meaning.is_empty(),
                    "{file}: {path}: say what `{}` is, in `columns.rs` of its study",
                    column.name
                );
            }
        }
    }
    assert!(tables > 80, "{tables} tables");
}
