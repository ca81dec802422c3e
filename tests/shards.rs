//! A study divided into shards comes to what one machine gives: merged from bundles where nothing is shared, or sealed by whoever
//! comes last where a store is.

use crate::sandbox::{Sandbox, TINY};
use reenact::bundle::{Archive, Bundle, Form, Limits, Tree};
use reenact::merge::{Shard, merge};
use reenact::plan::{Plan, Selection};
use reenact::verify::plan_of;
use serde_json::Value;
use std::fs;

/// The tiny study in three lengths, the shortest first.
fn place() -> Sandbox {
    let study = TINY
        .replace("trials: 3", "trials: 2")
        .replace("factors:\n", "factors:\n  limit-s: [2, 20, 6]\n")
        .replace("time-limit-s: 20", "time-limit-s: {factor: limit-s}");
    Sandbox::pinned().with_study(&study)
}

/// Runs the whole study elsewhere and returns its results digest.
fn alone(place: &Sandbox) -> String {
    let line =
        place.done(&["run", "tiny.yaml", "--no-cache", "--format", "json", "--out", "alone"]);
    json(&line)["results_digest"].as_str().unwrap().to_owned()
}

fn json(line: &str) -> Value {
    serde_json::from_str(line).unwrap_or_else(|error| panic!("{error}: {line}"))
}

/// Runs shard `i` of `n` without a store and returns its bundle, below the sandbox.
fn shard(place: &Sandbox, i: usize, n: usize) -> String {
    let out = format!("shard-{i}-of-{n}");
    let shard = format!("{i}/{n}");
    place.done(&["run", "tiny.yaml", "--no-cache", "--shard", &shard, "--out", &out]);
    only_file(place, &out)
}

fn only_file(place: &Sandbox, folder: &str) -> String {
    let files = place.files(folder);
    assert_eq!(files.len(), 1, "{files:?}");
    files[0].strip_prefix(place.path("")).unwrap().to_str().unwrap().to_owned()
}

/// The trials that `plan` lists, without their keys and states.
fn planned(place: &Sandbox, shard: &str) -> Vec<String> {
    let text = place.done(&["plan", "tiny.yaml", "--shard", shard]);
    let lines = text.lines().filter(|line| line.contains('/'));
    lines.map(|line| line.split_whitespace().nth(1).unwrap().to_owned()).collect()
}

#[test]
fn shards_are_of_about_the_same_cost_and_together_the_whole() {
    let place = place();
    let shards = ["1/3", "2/3", "3/3"].map(|shard| planned(&place, shard));
    // Four trials of each length: the longest are dealt first, in plan order.
    assert_eq!(shards[0], ["2_none/1", "20_none/0", "20_floor-plan/1", "6_floor-plan/0"]);
    assert_eq!(shards[1], ["2_floor-plan/0", "20_none/1", "6_none/0", "6_floor-plan/1"]);
    assert_eq!(shards[2], ["2_none/0", "2_floor-plan/1", "20_floor-plan/0", "6_none/1"]);
    let cost = |trials: &[String]| -> u32 {
        trials.iter().map(|trial| trial.split('_').next().unwrap().parse::<u32>().unwrap()).sum()
    };
    let costs = shards.each_ref().map(|trials| cost(trials));
    assert!(costs.iter().max().unwrap() - costs.iter().min().unwrap() <= 20, "{costs:?}");
}

/// They say no `dealt`: every third trial in plan order.
#[test]
fn shards_of_earlier_releases_are_what_they_were() {
    let place = place();
    let zip = fs::read(place.path(&shard(&place, 1, 3))).unwrap();
    let bundle = Bundle::read(&zip, &Limits::default()).unwrap();
    let experiment = plan_of(&bundle).unwrap().0.experiment;
    let written = r#"{"only":{},"trials":null,"shard":[2,3]}"#;
    let once: Selection = serde_json::from_str(written).unwrap();
    assert_eq!(serde_json::to_string(&once).unwrap(), written);
    let keys = |plan: Plan| plan.trials.into_iter().map(|spec| spec.key).collect::<Vec<_>>();
    let every_third = keys(Plan::of(experiment.clone())).into_iter().skip(1).step_by(3);
    let every_third: Vec<_> = every_third.collect();
    assert_eq!(keys(Plan::select(experiment.clone(), &once).unwrap()), every_third);
    let now = Selection::parse(&[], None, Some("2/3")).unwrap();
    assert_ne!(keys(Plan::select(experiment, &now).unwrap()), every_third);
}

#[test]
fn bundles_of_shards_merge_to_what_one_machine_gives() {
    let place = place();
    let alone = alone(&place);
    let shards = [1, 2, 3].map(|i| shard(&place, i, 3));
    // In any order, one of them twice.
    let answer = place.run(&[
        "merge", "--format", "json", "--out", "merged", &shards[2], &shards[0], &shards[2],
        &shards[1],
    ]);
    assert_eq!(answer.stderr, "note: 1 bundle of shards that were given before say the same\n");
    let told = json(&answer.stdout);
    assert_eq!((answer.code, &told["results_digest"]), (0, &Value::from(alone.as_str())));
    assert_eq!((&told["trials"], &told["partial"]), (&12.into(), &false.into()));
    // Where the clock is pinned nothing tells them apart.
    let (merged, of_one) = (only_file(&place, "merged"), only_file(&place, "alone"));
    assert_eq!(fs::read(place.path(&merged)).unwrap(), fs::read(place.path(&of_one)).unwrap());
    place.done(&["verify", "--level", "5", &merged]);
    let human = place.done(&["merge", &shards[0], &shards[1], &shards[2], "-o", "whole.zip"]);
    let end = format!(
        "12 trials: 12 time-limit; of 3 shards, none simulated here, {} s of simulated\ntime\nresults {alone}\nwhole.zip\n",
        4 * (2 + 20 + 6)
    );
    assert!(human.ends_with(&end), "{human}");
}

#[test]
fn a_lost_shard_is_named_and_running_it_alone_suffices() {
    let place = place();
    let shards = [1, 3].map(|i| shard(&place, i, 3));
    let answer = place.run(&["merge", &shards[0], &shards[1]]);
    assert_eq!(
        (answer.stderr.as_str(), answer.code),
        (
            "error: expected 3 shards, found 2: shard 2/3 is missing (`reenact run MANIFEST --shard 2/3`); a lost shard is run \
             again by itself, and merged with the others\n",
            1
        )
    );
    let lost = shard(&place, 2, 3);
    place.done(&["merge", &shards[0], &lost, &shards[1]]);
    // A part of a study is divided in the same way, and merged it is that part.
    let part = ["--only", "limit-s=2", "--no-cache", "--format", "json"];
    let run = |more: &[&str]| json(&place.done(&[&["run", "tiny.yaml"], &part[..], more].concat()));
    let whole = run(&["--out", "part"]);
    let halves = ["1/2", "2/2"].map(|half| run(&["--shard", half, "--out", "halves"]));
    let path = |told: &Value| told["bundle"].as_str().unwrap().to_owned();
    let merged = place.done(&["merge", &path(&halves[0]), &path(&halves[1]), "--format", "json"]);
    assert_eq!(json(&merged)["results_digest"], whole["results_digest"]);
    assert_eq!(json(&merged)["partial"], true);
    let answer = place.run(&["merge", &path(&halves[1])]);
    assert_eq!(
        answer.stderr,
        "error: expected 2 shards, found 1: shard 1/2 is missing (`reenact run MANIFEST --only limit-s=2 --shard 1/2`); a lost \
         shard is run again by itself, and merged with the others\n"
    );
}

#[test]
fn what_are_no_shards_of_one_study_is_refused() {
    let place = place();
    alone(&place);
    let whole = only_file(&place, "alone");
    let first = shard(&place, 1, 2);
    let other = shard(&place, 2, 3);
    let run = |out: &str, more: &[&str]| {
        let words = ["run", "tiny.yaml", "--no-cache", "--shard", "2/2", "--out", out];
        place.done(&[&words[..], more].concat());
        only_file(&place, out)
    };
    let reseeded = run("reseeded", &["--set", "seed=8"]);
    place.edit("tiny.yaml", "A tiny study", "Another");
    let edited = run("edited", &[]);
    let first_trials = run("first-trials", &["--trials", "1"]);
    let refusal = |bundles: &[&str]| {
        let answer = place.run(&[&["merge"], bundles].concat());
        assert_eq!(answer.stdout, "");
        (answer.stderr, answer.code)
    };
    let told = |text: String, code| (format!("error: {text}\n"), code);
    assert_eq!(
        refusal(&[&whole]),
        told(
            format!(
                "{whole}: expected the bundle of a shard (`reenact run --shard I/N`), found one of a whole study"
            ),
            2
        )
    );
    assert_eq!(
        refusal(&[&first, &other]),
        told(
            format!(
                "{other}: expected the division as in {first} (--shard I/2), found --shard I/3: these are no shards of one study"
            ),
            1
        )
    );
    assert_eq!(
        refusal(&[&first, &reseeded]),
        told(
            format!(
                "{reseeded}: expected `overrides` as in {first} ([]), found [\"seed=8\"]: these are no shards of one study"
            ),
            1
        )
    );
    let (stderr, code) = refusal(&[&first, &edited]);
    let says = format!("error: {edited}: expected the manifest as in {first} (sha256:");
    assert!(stderr.starts_with(&says) && code == 1, "{stderr}");
    let (stderr, _) = refusal(&[&edited, &first_trials]);
    assert_eq!(
        stderr,
        format!(
            "error: {first_trials}: expected the division as in {edited} (--shard I/2), found --trials 1 --shard I/2: these are \
             no shards of one study\n"
        )
    );
    let (stderr, code) = refusal(&["tiny.yaml"]);
    assert!(stderr.starts_with("error: tiny.yaml: the bundle is not what it says"), "{stderr}");
    assert_eq!(code, 1);
}

/// What only somebody who forges can bring about: shards that are whole by themselves, and contradict their plan or one another.
#[test]
fn shards_that_contradict_one_another_or_their_part_are_refused() {
    let place = place();
    let trees = [1, 2].map(|i| {
        let zip = fs::read(place.path(&shard(&place, i, 2))).unwrap();
        Bundle::read(&zip, &Limits::default()).unwrap().tree().clone()
    });
    let refusal = |trees: &[&Tree]| {
        let shards: Vec<Shard> = trees
            .iter()
            .zip(["a.zip", "b.zip", "c.zip"])
            .map(|(tree, name)| {
                let archive = Archive::of(Form::Bag, (*tree).clone());
                Shard { name: name.to_owned(), bundle: Bundle::open(archive).unwrap() }
            })
            .collect();
        let refused = match merge(&shards) {
            Ok(merged) => merged.records(|_| Ok(())).unwrap_err(),
            Err(refused) => refused,
        };
        refused.to_string()
    };
    let path = "data/trials/20_none.jsonl";
    let lines = trees.each_ref().map(|tree| String::from_utf8(tree[path].clone()).unwrap());
    let with = |tree: &Tree, text: String| {
        let mut tree = tree.clone();
        tree.insert(path.to_owned(), text.into_bytes());
        tree
    };
    let key = |line: &str| line.split('"').find(|part| part.len() == 64).unwrap().to_owned();
    let other = lines[1].replace("\"sim-seconds\":20", "\"sim-seconds\":21");
    assert_ne!(other, lines[1]);
    let digest = |line: &str| reenact::digest::Sha256Digest::of(line.trim_end());
    assert_eq!(
        refusal(&[&trees[0], &trees[1], &with(&trees[1], other.clone())]),
        format!(
            "trial 20_none/1 (key {}): expected the record of b.zip (sha256:{}), found another in c.zip (sha256:{}) with the same \
             states throughout; equal keys must give equal bytes: `reenact verify --level 5` tells which of the two is not what \
             its trial gives",
            key(&lines[1]),
            digest(&lines[1]),
            digest(&other)
        )
    );
    assert_eq!(
        refusal(&[&trees[0], &with(&trees[1], String::new())]),
        "b.zip: expected trial 20_none/1, which is of shard 2/2, found no record of it"
    );
    assert_eq!(
        refusal(&[&with(&trees[0], lines.concat()), &with(&trees[1], String::new())]),
        "a.zip: expected trials of shard 1/2 alone, found 20_none/1, which is none of it"
    );
    let says = "b.zip: expected a trial's record at data/trials/20_none.jsonl:1, found ";
    assert!(refusal(&[&trees[0], &with(&trees[1], "{}\n".to_owned())]).starts_with(says));
    let engine = |tree: &Tree| {
        let mut tree = tree.clone();
        let resolved = tree.get_mut("data/study.resolved.json").unwrap();
        let text = String::from_utf8(resolved.clone()).unwrap();
        *resolved = text.replace("\"engine\": \"2.1\"", "\"engine\": \"2.0\"").into_bytes();
        tree
    };
    assert_eq!(
        refusal(&[&trees[0], &engine(&trees[1])]),
        "b.zip: expected the engine as in a.zip (2.1), found 2.0: these are no shards of one study"
    );
    assert_eq!(
        refusal(&[&engine(&trees[0]), &engine(&trees[1])]),
        "a.zip: expected records of engine 2.1, as this program runs it, found engine 2.0: merge with the release that ran them"
    );
    assert_eq!(refusal(&[]), "expected bundles of `reenact run --shard I/N`, found none");
}

/// Workers on one store, and whoever seals last.
#[test]
fn workers_on_a_shared_store_leave_nothing_to_simulate() {
    let place = place();
    let alone = alone(&place);
    for (shard, trials) in [("1/5", 3), ("2/5", 3), ("3/5", 2), ("4/5", 2), ("5/5", 2)] {
        let line =
            place.done(&["run", "tiny.yaml", "--no-seal", "--shard", shard, "--format", "json"]);
        let told = json(&line);
        assert_eq!((&told["shard"], &told["trials"]), (&shard.into(), &trials.into()));
        assert_eq!((&told["cached"], &told["sealed"]), (&0.into(), &false.into()));
        assert_eq!(told["store"], place.path("store").to_str().unwrap());
    }
    assert!(!place.path("artifacts").exists(), "nothing is sealed");
    let again = place.done(&["run", "tiny.yaml", "--no-seal", "--shard", "5/5"]);
    let (said, rest) = again.split_once(" simulated in ").unwrap();
    assert_eq!(said, "shard 5/5 of tiny: 2 trials, 0");
    let store = place.path("store");
    let end = format!(
        " s, 2 were there (2 of them executed again: the same bytes); kept in {}; nothing is sealed\n",
        store.display()
    );
    assert!(rest.ends_with(&end), "{rest}");
    let sealed = json(&place.done(&["run", "tiny.yaml", "--format", "json"]));
    assert_eq!(
        (&sealed["cached"], &sealed["results_digest"]),
        (&12.into(), &alone.as_str().into())
    );
}

#[test]
fn the_engine_s_environment_names_the_shard() {
    let place = place();
    let planned_by = |variables: &[(&str, &str)], shard: &str| {
        let mut command = place.command(&["plan", "tiny.yaml", "--shard", shard]);
        let answer = crate::sandbox::Answer::of(command.envs(variables.iter().copied()));
        // What they will come to is foretold below.
        let counted = answer.stdout.lines().find(|line| line.contains(" to do, about "));
        let counted = counted.and_then(|line| line.split_once(", about "));
        (counted.unwrap_or_default().0.to_owned(), answer.stderr, answer.code)
    };
    let fifth = ("2 trials: 0 done, 2 to do".to_owned(), String::new(), 0);
    let slurm = [
        ("SLURM_ARRAY_TASK_ID", "14"),
        ("SLURM_ARRAY_TASK_MIN", "10"),
        ("SLURM_ARRAY_TASK_MAX", "14"),
        ("SLURM_ARRAY_TASK_COUNT", "5"),
    ];
    assert_eq!(planned_by(&slurm, "auto"), fifth);
    assert_eq!(planned_by(&[("JOB_COMPLETION_INDEX", "4")], "auto/5"), fifth);
    let batch = [("AWS_BATCH_JOB_ARRAY_INDEX", "4"), ("AWS_BATCH_JOB_ARRAY_SIZE", "5")];
    assert_eq!(planned_by(&batch, "auto"), fifth);
    let unknown = "error: `--shard auto`: JOB_COMPLETION_INDEX says that this is task 5, and nothing says of how many; write \
                   `--shard auto/N`, or set REENACT_SHARDS to N\n";
    assert_eq!(
        planned_by(&[("JOB_COMPLETION_INDEX", "4")], "auto"),
        (String::new(), unknown.to_owned(), 2)
    );
    // What nobody asked for disturbs nobody.
    let odd = [("SLURM_ARRAY_TASK_ID", "x")];
    assert_eq!(planned_by(&odd, "5/5"), fifth);
}
