//! What is shown is checked first; a level that executed nothing is not passed; and a bundle says how it came to be.

use super::case::redacted;
use super::forger;
use super::study::{HONEST, STUDY};
use crate::sandbox::{Answer, PROGRAM, Sandbox};
use reenact::bundle::{Form, Tree, archive};
use std::fs;
use std::process::Command;

/// Returns the honest bundle with one verdict turned, and every digest made right.
fn turned() -> Tree {
    let mut tree = HONEST.tree.clone();
    forger::set_json(&mut tree, "data/results/claims.json", |claims| {
        claims[0]["verdict"] = "contradicted".into();
    });
    forger::reseal(&mut tree);
    tree
}

/// Returns the honest bundle as another engine's, every digest made right.
fn of_another_engine() -> Tree {
    let mut tree = HONEST.tree.clone();
    forger::set_json(&mut tree, forger::RESOLVED, |resolved| resolved["engine"] = "0".into());
    forger::reseal(&mut tree);
    tree
}

fn with(name: &str, tree: &Tree) -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.write("honest", &HONEST.zip);
    sandbox.write(name, archive::write(tree, &HONEST.root, Form::Bag));
    sandbox
}

const COMMANDS: [&[&str]; 7] = [
    &["report", "turned", "-o", "page.html"],
    &[
        "replay",
        "turned",
        "none/0",
        "--html",
        "page.html",
        "--svg",
        "still.svg",
        "--mcap",
        "bag.mcap",
    ],
    &["diff", "turned", "honest"],
    &["diff", "honest", "turned", "--format", "json"],
    &["diff", "turned", "honest", "--format", "html", "-o", "page.html"],
    &["export", "turned", "--dir"],
    &["export", "turned", "--rocrate"],
];

#[test]
fn a_turned_verdict_is_not_shown_compared_or_handed_on() {
    let sandbox = with("turned", &turned());
    let says = "error: turned: the bundle is not what it says: reached level 2 (coherent) of level 3 (derived)\nerror at level 3: \
                data/results/claims.json: expected `\"supported\"` at /0/verdict, as the records give, found \
                `\"contradicted\"`\n`reenact verify turned` lists everything that was found; `--unchecked` shows it anyway\n";
    for words in COMMANDS {
        let answer = sandbox.run_reading(words);
        assert_eq!(answer.stdout, "", "{words:?}");
        assert_eq!((answer.stderr.as_str(), answer.code), (says, 1), "{words:?}");
    }
}

#[test]
fn what_is_wanted_unchecked_stands_under_a_banner() {
    let banner = "NOT WHAT IT SAYS: 1 fault, reached level 2 (coherent) of level 3 (derived)";
    let sandbox = with("turned", &turned());
    for words in COMMANDS {
        let answer = sandbox.run_bounded(&[words, &["--unchecked"]].concat());
        let is_data = words.contains(&"json");
        let told = if is_data { &answer.stderr } else { &answer.stdout };
        let first = told.lines().find(|line| line.contains("NOT WHAT IT SAYS")).unwrap();
        let is_diff = words[0] == "diff";
        let named = if is_diff { format!("turned: {banner}") } else { banner.to_owned() };
        assert_eq!(first, named, "{words:?}");
        if !is_data {
            let begin = told.lines().position(|line| line == first).unwrap();
            assert_eq!(begin, 0, "{words:?}: {told}");
        }
        let expected = i32::from(is_diff);
        assert_eq!(answer.code, expected, "{words:?}: {answer:?}");
        if words.contains(&"page.html") {
            let page = sandbox.read("page.html");
            let body = page.split_once("<body>\n").unwrap().1;
            assert!(body.starts_with("<p class=\"banner\" role=\"alert\""), "{words:?}");
            assert!(
                body.split_once("</p>").unwrap().0.ends_with(&format!(">{named}")),
                "{words:?}"
            );
        }
    }
    let still = sandbox.read("still.svg");
    assert!(still.contains(">NOT WHAT IT SAYS</text>"), "{still}");
    let bag = fs::read(sandbox.path("bag.mcap")).unwrap();
    assert!(bag.windows(banner.len()).any(|window| window == banner.as_bytes()));
}

#[test]
fn what_holds_is_said_to_hold_and_carries_no_banner() {
    let sandbox = with("turned", &turned());
    let line = "checked to level 3 (derived): the bundle is what it says";
    for (words, says, code) in [
        (&["report", "honest", "-o", "page.html"][..], format!("{line}\npage.html\n"), 0),
        (
            &["replay", "honest", "none/0", "--html", "page.html", "--svg", "still.svg"],
            format!("{line}\nnone/0: the re-enacted record equals the archived one\n"),
            0,
        ),
        (
            &["diff", "honest", "honest", "--format", "html", "-o", "page.html"],
            format!("honest: {line}\nhonest: {line}\npage.html\n"),
            0,
        ),
        (&["export", "honest", "--dir", "-o", "out"], format!("{line}\nout/{}\n", HONEST.root), 0),
    ] {
        for unchecked in [&[][..], &["--unchecked"]] {
            let answer = sandbox.run_bounded(&[words, unchecked].concat());
            // Circumstances are told as such where the bundle has some.
            let told = answer.stdout.lines().next().unwrap();
            assert!(says.starts_with(told.split(';').next().unwrap()), "{words:?}: {told}");
            assert_eq!(answer.stdout.lines().count(), says.lines().count(), "{}", answer.stdout);
            assert_eq!(answer.code, code, "{words:?}: {answer:?}");
            if words.contains(&"page.html") {
                let page = sandbox.read("page.html");
                assert!(!page.contains("class=\"banner\""), "{words:?}");
            }
        }
    }
}

#[test]
fn what_another_engine_ran_is_shown_with_how_far_it_was_checked() {
    let sandbox = with("older", &of_another_engine());
    let banner =
        "checked to level 2 (coherent): this program cannot derive the results of engine 0";
    let answer = sandbox.run_bounded(&["report", "older", "-o", "page.html"]);
    let says = format!("{banner}\npage.html\n");
    assert_eq!(
        (answer.stdout.as_str(), answer.stderr.as_str(), answer.code),
        (says.as_str(), "", 0)
    );
    let page = sandbox.read("page.html");
    assert!(
        page.contains("<p class=\"banner\" role=\"alert\"")
            && page.contains(&format!(">{banner}</p>"))
    );
    let answer = sandbox.run_bounded(&["export", "older", "--dir"]);
    assert_eq!((answer.stdout.lines().next(), answer.code), (Some(banner), 0));
}

#[test]
fn many_faults_are_counted_and_a_strangers_words_are_kept_in_place() {
    let mut tree = HONEST.tree.clone();
    for i in 0..12 {
        tree.insert(format!("data/results/tables/x-{i:02}.csv"), b"x\n".to_vec());
        forger::describe(&mut tree, &format!("results/tables/x-{i:02}.csv"));
    }
    forger::reseal(&mut tree);
    let sandbox = with("many", &tree);
    let answer = sandbox.run_reading(&["report", "many"]);
    assert_eq!(answer.code, 1);
    let lines: Vec<&str> = answer.stderr.lines().collect();
    assert_eq!(lines.len(), 13, "{}", answer.stderr);
    assert_eq!(lines[11], "... and 2 more", "{}", answer.stderr);
    assert!(
        lines[1..11]
            .iter()
            .all(|line| line.starts_with("error at level 3: data/results/tables/x-"))
    );
}

#[test]
fn a_level_that_executed_nothing_is_not_passed() {
    let sandbox = with("turned", &turned());
    let says = "error: `--sample` must be 1 or more, found 0: a level that executes nothing shows nothing; `--level 3` is the highest \
                that needs no execution\n";
    for level in ["3", "4", "5"] {
        let answer = sandbox.run_reading(&[
            "verify", "honest", "--level", level, "--sample", "0", "--attest", "a.json",
        ]);
        assert_eq!((answer.stdout.as_str(), answer.stderr.as_str(), answer.code), ("", says, 2));
    }
}

#[test]
fn a_trial_that_differs_fails_the_sample_and_the_whole() {
    // A record that was made up, and all that follows from it derived.
    let mut tree = HONEST.tree.clone();
    forger::set_records(&mut tree, "none", |records| {
        let measures = records[1]["measures"].as_object_mut().unwrap();
        let (_, value) = measures.iter_mut().find(|(_, value)| value.is_f64()).unwrap();
        *value = (value.as_f64().unwrap() + 1.0).into();
    });
    let tree = forger::rederive(tree);
    let sandbox = with("made-up", &tree);
    let human = sandbox.run_reading(&["verify", "made-up", "--level", "6"]);
    assert_eq!(human.code, 1);
    let states: Vec<&str> = human.stdout.lines().filter(|line| line.starts_with("  ")).collect();
    assert_eq!(
        &states[3..7],
        [
            "  3 derived    passed",
            "  4 sampled    failed",
            "  5 full       failed",
            "  6 replicated not judged"
        ]
    );
    let json = sandbox.run_reading(&["verify", "made-up", "--level", "5", "--format", "json"]);
    let json: serde_json::Value = serde_json::from_str(&json.stdout).unwrap();
    let states: Vec<_> =
        json["levels"].as_array().unwrap().iter().map(|l| l["state"].as_str().unwrap()).collect();
    assert_eq!(states, ["passed", "passed", "passed", "passed", "failed", "failed"]);
    let junit =
        sandbox.run_reading(&["verify", "made-up", "--level", "5", "--format", "junit"]).stdout;
    let document = roxmltree::Document::parse(&junit).unwrap();
    let told: Vec<_> = document
        .descendants()
        .filter(|node| node.has_tag_name("failure"))
        .map(|node| (node.attribute("type").unwrap(), node.attribute("message").unwrap()))
        .collect();
    assert_eq!((told.len(), told[0].0), (2, "sampled"), "{junit}");
    assert_eq!(told[1], ("full", "1 of 6 trials gave other bytes than the bundle holds"));
}

/// Returns the line of the results digest of a run, which must have ended well.
fn results_of(answer: &Answer) -> String {
    assert_eq!(answer.code, 0, "{answer:?}");
    answer.stdout.lines().rev().nth(1).unwrap().to_owned()
}

#[test]
fn a_bundles_readme_gives_the_command_that_yields_it() {
    let author = Sandbox::pinned().with_study(STUDY);
    fs::copy(author.path("robots/kobuki.urdf"), author.path("my robot.urdf")).unwrap();
    let told = [
        (&[][..], "reenact run study.yaml --out ../../again", None),
        (
            &[
                "--trials",
                "1",
                "--only",
                "prior=none",
                "--set",
                "title=it's $HOME",
                "--set",
                "robot=my robot.urdf",
            ],
            "reenact run study.yaml --set 'title=it'\\''s $HOME' --set 'robot=my robot.urdf' --only prior=none --trials 1 --out \
             ../../again",
            Some(
                "partial: --only prior=none --trials 1; overrides: title = it's $HOME, robot = my robot.urdf",
            ),
        ),
        (
            &["--shard", "2/3"],
            "reenact run study.yaml --shard 2/3 --out ../../again",
            Some("partial: --shard 2/3"),
        ),
    ];
    for (words, command, departs) in told {
        let ran = author.run(&[&["run", "tiny.yaml", "--out", "sealed"], words].concat());
        let (results, bundle) = (results_of(&ran), ran.last_line());
        let exported = author.run(&["export", bundle, "--dir", "--out", "../stranger"]);
        let data = author.path(exported.last_line()).join("data");
        let readme = fs::read_to_string(data.join("README.md")).unwrap();
        assert!(readme.contains(&format!("\n```\n{command}\n```\n")), "{readme}");
        let said = departs.map(|words| format!("How it was run: `{words}`."));
        assert_eq!(readme.contains("How it was run"), said.is_some(), "{readme}");
        assert!(said.is_none_or(|said| readme.contains(&said)), "{readme}");

        // As it stands there, by a shell, where nothing of the author's is.
        let script = command.replacen("reenact", "\"$REENACT\"", 1);
        let (mut shell, store) = (Command::new("sh"), author.path("other-store"));
        author.dress(&mut shell).args(["-c", &script]).current_dir(&data);
        let again = Answer::of(shell.env("REENACT", PROGRAM).env("REENACT_STORE", store));
        assert_eq!(results_of(&again), results, "{command}");
        let says = "inputs are those that the bundle holds in `inputs/`";
        assert!(again.stderr.contains(says), "{again:?}");

        // And verify says how the run departs from the manifest, in all its forms.
        let human = author.run(&["verify", bundle]).stdout;
        let name = departs.map_or("tiny".to_owned(), |words| format!("tiny ({words})"));
        assert!(human.starts_with(&format!("study    {name}\n")), "{human}");
        let json = author.run(&["verify", bundle, "--format", "json"]);
        let json: serde_json::Value = serde_json::from_str(&json.stdout).unwrap();
        assert_eq!(json["partial"], departs.is_some());
        assert_eq!(json["selection"].is_null(), departs.is_none(), "{json}");
        let set: Vec<_> =
            words.windows(2).filter(|pair| pair[0] == "--set").map(|pair| pair[1]).collect();
        assert_eq!(json["overrides"], serde_json::json!(set));
        let junit = author.run(&["verify", bundle, "--format", "junit"]).stdout;
        let partial = format!("<property name=\"partial\" value=\"{}\"/>", departs.is_some());
        assert!(junit.contains(&partial), "{junit}");
        assert_eq!(junit.contains("<property name=\"departure\""), departs.is_some(), "{junit}");
    }

    // A shard beyond the last trial is a bundle of none: there is nothing to execute, so level 4 and above are not passed.
    let ran = author.run(&["run", "tiny.yaml", "--out", "sealed", "--shard", "7/7"]);
    assert_eq!(ran.code, 0, "{ran:?}");
    for level in ["4", "5"] {
        let answer = author.run(&["verify", ran.last_line(), "--level", level]);
        let text = answer.stdout;
        assert_eq!(answer.code, 2, "{text}");
        let says = "obstacle at level 4: data/trials/: expected trials to execute again, found none (the bundle holds no trial, so \
                    there is none to execute)\nno trial was executed again\nreached level 3 (derived) of level ";
        assert!(text.contains(says), "{}", redacted(&text));
    }
}

/// A manifest of an unpacked bundle takes nothing from outside of it.
#[test]
fn an_unpacked_bundle_leads_nowhere_else() {
    let sandbox = Sandbox::new();
    for (path, bytes) in &HONEST.tree {
        fs::create_dir_all(sandbox.path(path).parent().unwrap()).unwrap();
        sandbox.write(path, bytes);
    }
    sandbox.edit("data/study.resolved.json", "inputs/kobuki.urdf", "inputs/../../secret");
    let answer = sandbox.run(&["check", "data/study.yaml"]);
    let says = "error: `data/study.resolved.json` cannot be read: expected an input in `inputs/`, found `inputs/../../secret`\n";
    assert_eq!((answer.stderr.as_str(), answer.code), (says, 2));
}
