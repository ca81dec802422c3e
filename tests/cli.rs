//! The command line as people meet it: whole texts and exit codes.

use crate::sandbox::{Sandbox, repository};
use std::fs;
use std::path::PathBuf;

/// Creates a folder with the starter study in it.
fn desk() -> Sandbox {
    Sandbox::pinned().with_demo()
}

/// Runs one short trial and gives its bundle.
fn bundle_on(desk: &Sandbox) -> String {
    let words = ["run", "demo/demo.yaml", "--only", "prior=none", "--trials", "1"];
    desk.done(&words).lines().last().unwrap().to_owned()
}

/// Returns `text` with every number of wall time and every digest replaced, widths kept.
fn redacted(text: &str) -> String {
    let mut words: Vec<String> = Vec::new();
    for word in text.split(' ') {
        let hex = |w: &str| w.len() >= 8 && w.bytes().all(|b| b.is_ascii_hexdigit());
        words.push(match word.rsplit_once(':') {
            Some((head, digest)) if hex(digest.split('\n').next().unwrap_or("")) => {
                let rest = digest.split_once('\n').map_or(String::new(), |r| format!("\n{}", r.1));
                format!("{head}:DIGEST{rest}")
            }
            _ => word.to_owned(),
        });
    }
    let text = words.join(" ");
    let (before, after) = text.split_once("simulated in ").unwrap_or((&text, ""));
    let after =
        after.split_once(" s,").map_or(String::new(), |r| format!("simulated in T s,{}", r.1));
    let name = |line: &str| {
        if line.starts_with("artifacts/") {
            "artifacts/demo-XXXXXXXX.zip".to_owned()
        } else {
            line.to_owned()
        }
    };
    (before.to_owned() + &after).lines().map(name).collect::<Vec<_>>().join("\n")
}

#[test]
fn a_run_prints_the_table_the_digest_and_the_bundle() {
    let desk = desk();
    let answer = desk.run(&["run", "demo/demo.yaml", "--only", "prior=none", "--trials", "1"]);
    assert_eq!((answer.stderr.as_str(), answer.code), ("", 0));
    insta::assert_snapshot!(redacted(&answer.stdout));
    let last: Vec<&str> = answer.stdout.lines().rev().take(2).collect();
    assert!(last[1].starts_with("results sha256:") && last[1].len() == 15 + 64);
    let short = &last[1][15..23];
    assert_eq!(last[0], format!("artifacts/demo-{short}.zip"));
    assert!(desk.path(last[0]).exists());
    let path = last[0];
    let next = format!("next: reenact report {path}\n      reenact verify --level 4 {path}\n");
    assert_eq!(answer.next, next);
    assert!(answer.stdout.lines().count() + answer.next.lines().count() <= 40);
}

#[test]
fn json_is_one_line_with_the_documented_keys_and_a_second_run_is_cached() {
    let desk = desk();
    let bundle = bundle_on(&desk);
    let words =
        ["run", "demo/demo.yaml", "--only", "prior=none", "--trials", "1", "--format", "json"];
    let answer = desk.run(&words);
    assert_eq!((answer.stdout.lines().count(), answer.code), (1, 0));
    let line: serde_json::Value = serde_json::from_str(&answer.stdout).unwrap();
    let keys: Vec<&str> = line.as_object().unwrap().keys().map(String::as_str).collect();
    assert_eq!(
        keys,
        [
            "bundle",
            "bundle_id",
            "cached",
            "claims",
            "failed",
            "partial",
            "results_digest",
            "sim_seconds",
            "study_digest",
            "trials",
            "wall_seconds",
        ]
    );
    assert_eq!(
        (&line["cached"], &line["failed"], &line["partial"]),
        (&1.into(), &0.into(), &true.into())
    );
    let path = PathBuf::from(line["bundle"].as_str().unwrap());
    assert!(path.is_absolute() && path.ends_with(&bundle));
}

#[test]
fn a_bundle_verifies_to_the_top_and_replays_to_the_same_record() {
    let desk = desk();
    let bundle = bundle_on(&desk);
    let answer = desk.run(&["verify", &bundle, "--level", "5"]);
    assert_eq!(answer.code, 0, "{answer:?}");
    insta::assert_snapshot!(redacted(&answer.stdout));
    let answer =
        desk.run(&["replay", &bundle, "none/0", "--html", "replay.html", "--svg", "still.svg"]);
    let says = "checked to level 3 (derived): the bundle is what it says\nnone/0: the re-enacted record equals the archived \
                one\n";
    assert_eq!((answer.stdout.as_str(), answer.code), (says, 0));
    assert_eq!(answer.stderr, "wrote replay.html\nwrote still.svg\n");
    let answer = desk.run(&["report", &bundle, "-o", "report.html"]);
    let says = "checked to level 3 (derived): the bundle is what it says\nreport.html\n";
    assert_eq!((answer.stdout.as_str(), answer.code), (says, 0));
    for (page, holds) in
        [("replay.html", "<canvas"), ("report.html", "Distance travelled"), ("still.svg", "<svg")]
    {
        let text = desk.read(page);
        assert!(text.contains(holds), "{page}");
    }
}

#[test]
fn a_changed_number_is_found_and_named() {
    let desk = desk();
    let bundle = bundle_on(&desk);
    let exported = desk.run(&["export", &bundle, "--dir", "-o", "out"]).stdout;
    let folder = exported.lines().last().unwrap().to_owned();
    desk.edit(&format!("{folder}/data/results/trials.csv"), "explored", "stuck");
    let answer = desk.run(&["verify", &folder]);
    assert_eq!(answer.code, 1);
    let last: Vec<&str> = answer.stdout.lines().rev().take(2).collect();
    assert_eq!(
        last,
        [
            "reached level 0 (safe) of level 3 (derived): the bundle is not what it says",
            "error at level 3: data/results/trials.csv: expected `explored` in row 1, column `outcome`, as the \
             records give, found `stuck`",
        ]
    );
}

#[test]
fn every_fault_of_a_manifest_is_told_at_its_place() {
    let desk = desk();
    desk.edit("demo/demo.yaml", "trials: 10", "trails: 10");
    desk.edit("demo/demo.yaml", "floor-plan-of:", "floor-plan-off:");
    let answer = desk.run(&["check", "demo/demo.yaml"]);
    assert_eq!((answer.stdout.as_str(), answer.code), ("", 2));
    insta::assert_snapshot!(answer.stderr);
}

#[test]
fn requests_that_are_not_understood_end_with_2() {
    let desk = desk();
    for (words, says) in [
        (vec!["check", "nope.yaml"], "error: cannot read `nope.yaml`: no such file\n"),
        (vec!["verify", "nope.zip"], "error: cannot read `nope.zip`: no such file\n"),
        (
            vec!["run", "demo/demo.yaml", "--only", "prior=flor-plan"],
            "error: `flor-plan` is not a value of the factor `prior`: did you mean `floor-plan`? (known: none, \
             floor-plan)\n",
        ),
        (
            vec!["run", "demo/demo.yaml", "--jobs", "0"],
            "error: `--jobs` must be at least 1, found 0\n",
        ),
        (
            vec!["plan", "demo/demo.yaml", "--explain", "none/77"],
            "error: no trial `none/77` in this plan; it begins with `none/0`\n",
        ),
        (vec!["init", "demo"], "error: `demo` exists already; choose another name\n"),
    ] {
        let answer = desk.run(&words);
        assert_eq!((answer.stderr.as_str(), answer.code), (says, 2), "{words:?}");
        assert_eq!(answer.stdout, "", "{words:?}");
    }
    assert_eq!(desk.run(&["frobnicate"]).code, 2);
    assert_eq!(desk.run(&["--help"]).code, 0);
}

/// Checks that a plan needs no calibration, and that a key does.
#[test]
fn a_plan_is_shown_before_its_calibration_has_run() {
    let desk = Sandbox::pinned();
    let at = |name: &str| repository().join("manifests").join(name).display().to_string();
    let (manifest, calibration) = (at("deadline.yaml"), at("deadline-calibration.yaml"));
    let part = ["--trials", "2", "--only", "start=A", "--only", "strategy=frontier"];
    let answer =
        desk.run(&[&["plan", &manifest], &part[..], &["--only", "deadline-s=68"]].concat());
    let not_run = format!(
        "12000 of its 12000 passages have not run yet: `reenact run {calibration}` runs them"
    );
    let says = format!("note: keys depend on what the calibration measures; {not_run}\n");
    assert_eq!((answer.stderr, answer.code), (says, 0));
    let listed = "--------  A_68_frontier/0  to do\n--------  A_68_frontier/1  to do\n2 trials: 0 done, 2 to do, about 1 s on ";
    let foretold = answer.stdout.strip_prefix(listed).unwrap_or_default();
    let (processors, foretold) = foretold.split_once('\n').unwrap_or_default();
    assert!(
        processors.contains(" processor")
            && foretold.starts_with("bundle: at least ")
            && foretold.ends_with(
                " kB unpacked; memory: at least 31 MB; less than 0.01 core hours in all (by the manifest: no record of this \
                 plan is in the store; `reenact run --trials 1` puts one of each condition there)\n"
            ),
        "{}",
        answer.stdout
    );
    let answer = desk.run(&["plan", &manifest, "--explain", "A_68_frontier/0"]);
    assert_eq!((answer.stdout.as_str(), answer.code), ("", 2));
    assert!(answer.stderr.contains(&not_run), "{}", answer.stderr);
}

#[test]
fn an_unreadable_archive_is_an_answer_not_a_failure() {
    let desk = desk();
    desk.write("x.zip", "hello");
    let answer = desk.run(&["verify", "x.zip"]);
    assert_eq!(answer.code, 1);
    assert!(answer.stdout.starts_with("  0 safe      failed\n"), "{}", answer.stdout);
}

#[test]
fn show_says_what_was_understood() {
    let desk = desk();
    let answer = desk.run(&["show", "demo/apartment.yaml", "-o", "world.svg"]);
    assert_eq!((answer.stderr.as_str(), answer.code), ("wrote world.svg\n", 0));
    insta::assert_snapshot!(redacted(&answer.stdout));
    assert!(desk.read("world.svg").contains("</svg>"));
}

#[test]
fn a_generated_building_is_drawn_and_written_as_a_world() {
    let desk = desk();
    let generated = ["show", "--generate", "office-floor", "--seed", "3"];
    let answer = desk.run(&[&generated[..], &["-o", "b.yaml"]].concat());
    assert_eq!((answer.stderr.as_str(), answer.code), ("wrote b.yaml\n", 0));
    assert!(answer.stdout.starts_with("world: office-floor-3\nsize: "), "{}", answer.stdout);
    let again = desk.run(&["show", "b.yaml", "-o", "b.svg"]);
    assert_eq!((again.stdout, again.code), (answer.stdout, 0));
    let drawn = desk.run(&generated);
    assert_eq!((drawn.stderr.as_str(), drawn.code), ("wrote office-floor-3.svg\n", 0));
    assert_eq!(desk.read("office-floor-3.svg"), desk.read("b.svg"));
    let refused = desk.run(&["show", "b.yaml", "-o", "c.yaml"]);
    assert_eq!(
        (refused.stderr.as_str(), refused.code),
        (
            "error: only buildings of a family are written as YAML: name an .svg file for drawings\n",
            2
        )
    );
}

#[test]
fn a_constrained_mdp_is_solved_refused_or_infeasible() {
    let desk = desk();
    let problem = r#"{"states": ["here", "goal"], "actions": ["walk", "run"], "absorbing": [1], "initial": [[0, 1.0]],
 "transitions": [[0, 0, 1, 1.0], [0, 1, 1, 1.0]], "primary": [[0, 0, 4.0], [0, 1, 1.0]],
 "secondary": [{"name": "risk", "bound": 0.5, "costs": [[0, 1, 1.0]]}]}"#;
    desk.write("p.json", problem);
    let answer = desk.run(&["solve-cmdp", "p.json"]);
    let solved =
        r#"{"status":"optimal","primary":2.5,"secondary":[0.5],"policy":[[0,0,0.5],[0,1,0.5]]}"#;
    assert_eq!((answer.stdout.trim_end(), answer.code), (solved, 0));
    desk.write("i.json", problem.replace("[[0, 1, 1.0]]}", "[[0, 0, 1.0], [0, 1, 1.0]]}"));
    let answer = desk.run(&["solve-cmdp", "i.json"]);
    assert!(answer.stdout.contains(r#""status":"infeasible""#) && answer.code == 0, "{answer:?}");
    desk.write("b.json", problem.replace("\"absorbing\": [1]", "\"absorbing\": [7]"));
    let answer = desk.run(&["solve-cmdp", "b.json"]);
    let says = "error: b.json: absorbing[0]: state 7 does not exist; expected an index below 2\n";
    assert_eq!((answer.stderr.as_str(), answer.code), (says, 2));
}

#[test]
fn a_derived_prior_laid_over_its_world_lies_on_it() {
    let desk = desk();
    let world = "demo/apartment.yaml";
    let derived = desk.run(&["show", world, "--derive", "floor-plan", "-o", "plan.png"]);
    assert_eq!((derived.stderr.as_str(), derived.code), ("wrote plan.png\n", 0));
    let line = |start: &str| derived.stdout.lines().find_map(|l| l.strip_prefix(start)).unwrap();
    let origin = line("origin: (").trim_end_matches(") m");
    let cells = line("occupied: ").split(' ').next().unwrap();
    desk.write(
        "plan.yaml",
        format!(
            "image: plan.png\nresolution: 0.1\norigin: [{origin}, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
        ),
    );
    let over = ["show", world, "--over", "plan.yaml", "-o", "over.svg"];
    let laid = desk.run(&over);
    let agreement = |near: &str| {
        format!("agreement: {near} of {cells} occupied cells lie within 0.2 m of something solid\n")
    };
    assert!(laid.stdout.ends_with(&agreement(cells)), "{}", laid.stdout);
    let away = desk.run(&[&over[..], &["--start", "-100,50"]].concat());
    assert!(away.stdout.ends_with(&agreement("0")), "{} {}", away.stdout, away.stderr);
    let refused = desk.run(&[&over[..], &["--start", "1"]].concat());
    assert_eq!(
        (refused.stderr.as_str(), refused.code),
        ("error: --start: expected x,y (m), found 1 numbers\n", 2)
    );
}

/// Every command has a page of its own, named by the way to it.
#[test]
fn manual_pages_are_written_for_every_command() {
    let desk = Sandbox::new();
    let answer = desk.run(&["man", "pages"]);
    assert_eq!(answer.code, 0, "{answer:?}");
    let page = fs::read_to_string(desk.path("pages/reenact-cache-prune.1")).unwrap();
    assert!(page.contains("reenact\\-cache\\-prune"), "{page}");
    let pages = fs::read_dir(desk.path("pages")).unwrap().count();
    assert_eq!(answer.stdout, format!("{pages} pages in pages\n"));
    assert!(pages > 20, "{pages}");
}

/// What LaTeX is given: a file for each table, and numbers by name.
#[test]
fn a_bundle_is_exported_for_latex() {
    let desk = Sandbox::new();
    let bundle = repository().join("artifacts/quickstart-published.zip");
    let bundle = bundle.to_str().unwrap();
    let answer = desk.run(&["export", bundle, "--latex"]);
    assert_eq!(answer.code, 0, "{answer:?}");
    let folder = desk.path(answer.last_line());
    let numbers = fs::read_to_string(folder.join("numbers.tex")).unwrap();
    assert!(numbers.contains("csname reenact@table-1/"), "{numbers}");
    let table = fs::read_to_string(folder.join("table-1.tex")).unwrap();
    assert!(table.contains("\\toprule") && table.contains(" & ours & paper"), "{table}");
}

#[test]
fn figures_are_exported_for_the_width_of_a_column() {
    let desk = Sandbox::new();
    let bundle = repository().join("artifacts/quickstart-published.zip");
    let bundle = bundle.to_str().unwrap();
    // How far the bundle holds is told elsewhere.
    let words = ["export", bundle, "--figures", "figures", "--width", "180mm", "--unchecked"];
    let answer = desk.run(&words);
    assert_eq!((answer.code, answer.last_line()), (0, "figures"), "{answer:?}");
    let file = |name: &str| fs::read(desk.path("figures").join(name)).unwrap();
    let svg = String::from_utf8(file("figure-4.svg")).unwrap();
    assert!(svg.contains(" width=\"180mm\""), "{svg}");
    let pdf = file("figure-4.pdf");
    assert!(pdf.starts_with(b"%PDF-") && pdf.ends_with(b"%%EOF"));
    assert!(file("figure-4.csv").starts_with(b"series,what,x,y,"));
    let refused = |words: &[&str]| {
        let answer = desk.run(words);
        assert_eq!((answer.stdout.as_str(), answer.code), ("", 2));
        answer.stderr.lines().next().unwrap_or_default().to_owned()
    };
    assert_eq!(
        refused(&["export", bundle, "--figures", "figures", "--width", "3.5in"]),
        "error: invalid value '3.5in' for '--width <MM>': expected a width in millimetres from 60mm to 300mm, such as 88mm"
    );
    assert_eq!(
        refused(&["export", bundle, "--width", "88mm"]),
        "error: the following required arguments were not provided:"
    );
}

#[test]
fn what_could_not_be_sealed_is_refused_before_it_is_run() {
    let desk = desk();
    let answer = desk.run(&["run", "demo/demo.yaml", "--max-size", "10K"]);
    assert_eq!((answer.stdout.as_str(), answer.code), ("", 2));
    assert!(
        answer.stderr.starts_with("error: nothing was run: the bundle of ")
            && answer.stderr.ends_with(
                "expected at most 10 kB, so that anyone can check it; run fewer trials (--trials), run the study in parts \
                 (--only), or allow it more with --max-size, as whoever checks it must too\n"
            ),
        "{}",
        answer.stderr
    );
    assert!(!desk.path("artifacts").exists(), "nothing was begun");
    // What a trial comes to is known once one is in the store.
    let bundle = bundle_on(&desk);
    let plan = desk.done(&["plan", "demo/demo.yaml"]);
    let foretold = plan.lines().last().unwrap();
    assert!(
        foretold.starts_with("bundle: about ")
            && foretold.contains(" kB unpacked; memory: about ")
            && foretold.ends_with(" core hours in all (by 1 record in the store)"),
        "{foretold}"
    );
    let answer = desk.run(&["verify", "--max-size", "10K", &bundle]);
    assert_eq!(answer.code, 1);
    assert!(
        answer.stdout.contains(
            "(where you trust that it is so large, `--max-size` admits it: `--max-size 8G`)"
        ),
        "{}",
        answer.stdout
    );
}

#[test]
fn a_program_is_told_progress_in_lines_of_json() {
    let desk = Sandbox::new().with_study(crate::sandbox::TINY);
    let run = |asks: &str| {
        let mut command = desk.command(&["run", "tiny.yaml", "--format", "json", "--no-cache"]);
        crate::sandbox::Answer::of(command.env("REENACT_PROGRESS", asks))
    };
    let answer = run("json");
    assert_eq!(answer.code, 0, "{}", answer.stderr);
    let told: Vec<&str> = answer.stderr.lines().collect();
    let line = |done| {
        format!(
            r#"{{"progress":{{"cached":0,"done":{done},"failed":0,"name":"tiny","trials":6}}}}"#
        )
    };
    assert_eq!((told[0], told[told.len() - 1]), (&*line(0), &*line(6)));
    assert!(told.iter().all(|one| (0..=6).any(|done| *one == line(done))), "{told:?}");
    let other = run("yes");
    assert_eq!(
        (other.code, other.stderr.as_str()),
        (
            2,
            "error: REENACT_PROGRESS: expected `json`, found `yes`; unset it for progress that people read\n"
        )
    );
}
