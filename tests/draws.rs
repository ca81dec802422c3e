//! Draws of a posterior run in physics, from the outside: they follow from the inference that they are of, they are what the same
//! manifest gives with its values written by hand, and what nobody proposed is refused.

use crate::adversary::forger;
use crate::inference::TINY as INFERENCE;
use crate::sandbox::Sandbox;
use reenact::bundle::{Form, Limits, Tree, archive};

/// What the trials and the passages have in common; `DRAW`, `WORLD` and `VALUES` are written in different ways.
const HEAD: &str = "
reenact: 1
license: CC-BY-4.0
study: deadline
robot: robots/pioneer3at.urdf
start: A
";

const TRIALS: &str = "
name: drawn
title: Draws of a tiny inference in physics
seed: 3
trials: 3
calibration: drawn-calibration.yaml
factors:
  draw: DRAW
  strategy: [frontier, random]
world: WORLD
tables:
  - id: success
    title: Success
    outcome-table: {show: {share: [reached]}, by: strategy, over: draw}
figures:
  - id: bars
    title: Success
    outcome-bars: {show: {share: [reached]}, by: strategy, over: draw}
claims:
  - id: S
    ours: random is no worse than frontier
    paper-table: silent
    expect:
      greater:
        metric: success
        where: {strategy: random}
        than: {where: {strategy: frontier}}
        for-each: {draw: [1, 2]}
        correction: none
        minimum-n: 3
        at-least: 1
parameters:
  mission: {deadline-s: 400}
  rules: {strategy: {factor: strategy}RULES}
  VALUES
";

const PASSAGES: &str = "
name: drawn-calibration
title: Passages in draws of a tiny inference
seed: 4
trials: 10
factors:
  draw: DRAW
  motion: [corridor, door-left, door-right]
  speed: [slow, fast]
world: WORLD
parameters:
  mission: {task: passage}
  passage: {motion: {factor: motion}, speed: {factor: speed}}
  VALUES
";

const VALUES: &str = "sensing: {compass-noise-deg: {points: [[0.005, 4], [0.08, 8]], at: draw.graph.entry-hazard, why: a test}}";

/// Writes both manifests with their parts in the place of the words for them.
fn write(desk: &Sandbox, parts: &[(&str, &str)]) {
    for (name, text) in [("drawn.yaml", TRIALS), ("drawn-calibration.yaml", PASSAGES)] {
        let mut text = format!("{HEAD}{text}");
        for (word, part) in parts {
            text = text.replace(word, part);
        }
        desk.write(name, text);
    }
}

fn desk() -> Sandbox {
    let desk = Sandbox::pinned().with_files(&[
        "robots/pioneer3at.urdf",
        "manifests/reference/deadline-success.csv",
        "manifests/reference/deadline-collision.csv",
    ]);
    desk.write("tiny.yaml", INFERENCE);
    let drawn = [
        ("DRAW", "{posterior: tiny.yaml, n: 2}"),
        ("WORLD", "{factor: draw}"),
        ("RULES", ""),
        ("VALUES", VALUES),
    ];
    write(&desk, &drawn);
    desk
}

/// Runs the trials and returns stdout.
fn ran(desk: &Sandbox, more: &[&str]) -> String {
    let answer = desk.run(&[&["run", "drawn.yaml"], more].concat());
    assert_eq!(answer.code, 0, "{}{}", answer.stdout, answer.stderr);
    answer.stdout
}

fn tree(desk: &Sandbox, stdout: &str) -> Tree {
    let bytes = std::fs::read(desk.path(stdout.lines().last().unwrap())).unwrap();
    archive::read(&bytes, &Limits::default()).unwrap().tree
}

/// Returns the cells of a CSV file by their column, row by row.
fn rows(text: &str) -> Vec<std::collections::BTreeMap<&str, &str>> {
    let mut lines = text.lines().map(|line| line.split(','));
    let columns: Vec<&str> = lines.next().unwrap().collect();
    lines.map(|line| columns.iter().copied().zip(line).collect()).collect()
}

#[test]
fn draws_are_run_and_shown_in_bands_and_are_what_the_same_values_by_hand_give() {
    let desk = desk();
    let stdout = ran(&desk, &["-j", "1"]);
    let (told, _) = stdout.split_once("trials:").unwrap();
    insta::assert_snapshot!(told);
    let bundle = tree(&desk, &stdout);
    let text = |path: &str| forger::text(&bundle, path);
    let draws = text("data/inputs/tiny.draws.csv");
    let draws = rows(&draws);
    assert_eq!((draws.len(), draws[0]["draw"], draws[1]["draw"]), (2, "1", "2"));
    // The middle of either half of the table of all draws.
    assert_eq!((draws[0]["posterior-draw"], draws[1]["posterior-draw"]), ("50", "150"));
    let posterior = desk.run(&["infer", "tiny.yaml"]);
    let posterior = tree(&desk, &posterior.stdout);
    let posterior = forger::text(&posterior, "data/results/tables/posterior.csv");
    let posterior = rows(&posterior);
    for draw in &draws {
        let row = &posterior[draw["posterior-draw"].parse::<usize>().unwrap()];
        for column in ["building", "goal", "goal-x-m", "start-A-y-m", "graph.entry-hazard"] {
            assert_eq!(draw[column], row[column], "{column}");
        }
    }
    let success = text("data/results/tables/success.csv");
    let random = rows(&success).into_iter().find(|row| row["strategy"] == "random").unwrap();
    assert_eq!((random["n"], random["over-n"]), ("6", "2"));
    let number = |column: &str| random[column].parse::<f64>().unwrap();
    assert!(number("over-5") <= number("over-50") && number("over-50") <= number("over-95"));
    let middle = (number("over-50") - number("value")).abs();
    assert!(middle < 1e-3, "of two draws with as many trials the median is the mean");

    let claims = text("data/results/claims.json");
    assert!(claims.contains("% of draws ("), "{claims}");

    // The same by hand.
    let world = |draw: &std::collections::BTreeMap<&str, &str>| {
        let at = |place: &str| {
            format!(
                "{{x-m: {}, y-m: {}}}",
                draw[&*format!("{place}-x-m")],
                draw[&*format!("{place}-y-m")]
            )
        };
        let starts =
            ["A", "B", "C"].map(|start| format!("{start}: {}", at(&format!("start-{start}"))));
        format!(
            "{{generate: {{family: office-floor, seed: {}}}, place: {{goal: {}, starts: {{{}}}}}}}",
            draw["building"],
            at("goal"),
            starts.join(", ")
        )
    };
    let worlds =
        format!("{{by: draw, values: {{1: {}, 2: {}}}}}", world(&draws[0]), world(&draws[1]));
    let both = |value: &dyn Fn(usize) -> String| {
        format!("{{by: draw, values: {{1: {}, 2: {}}}, why: by hand}}", value(0), value(1))
    };
    let ties = both(&|i| draws[i]["rules.frontier.ties"].to_owned());
    let compass = both(&|i| {
        let hazard: f64 = draws[i]["graph.entry-hazard"].parse().unwrap();
        (4.0 + (8.0 - 4.0) * (hazard - 0.005) / (0.08 - 0.005)).to_string()
    });
    // Passages have rules, too, though none looks at them.
    let by_hand = [
        ("DRAW", "[1, 2]"),
        ("WORLD", &worlds),
        ("RULES", &format!(", frontier: {{ties: {ties}}}")),
        ("VALUES", &format!("sensing: {{compass-noise-deg: {compass}}}")),
    ];
    write(&desk, &by_hand);
    let hand = ran(&desk, &[]);
    assert!(hand.contains("(12 from the store, 3 of them"), "{hand}");
    let hand = tree(&desk, &hand);
    let trials = "data/results/trials.csv";
    assert_eq!(forger::text(&hand, trials), text(trials), "the same keys, so the same trials");
}

#[test]
fn draws_verify_to_the_top_on_any_number_of_threads_and_without_a_store() {
    let desk = desk();
    let digest = |stdout: &str| {
        stdout.lines().find(|line| line.starts_with("results sha256:")).unwrap().to_owned()
    };
    let one = ran(&desk, &["-j", "1", "--no-cache"]);
    let two = ran(&desk, &["-j", "2", "--no-cache"]);
    assert_eq!(digest(&one), digest(&two));
    let bundle = two.lines().last().unwrap();
    let verified = desk.run(&["verify", bundle, "--level", "5"]);
    assert_eq!(verified.code, 0, "{}{}", verified.stdout, verified.stderr);
    for says in [
        "all 2 proposals of the inference gave the same again",
        "all 120 passages of the calibration gave the same again",
        "reached level 5",
    ] {
        assert!(verified.stdout.contains(says), "{says}: {}", verified.stdout);
    }
    let json = desk.run(&["verify", bundle, "--level", "4", "--format", "json"]);
    let answer = &crate::schemas::assert_answers("verify", &json.stdout)[0];
    assert!(answer.to_string().contains("\"made\":\"proposals\""), "{answer}");
}

#[test]
fn draws_that_nobody_proposed_are_refused() {
    let desk = desk();
    let honest = tree(&desk, &ran(&desk, &[]));
    let verified = |tree: &Tree, level: &str| {
        desk.write("forged.zip", archive::write(tree, "forged", Form::Bag));
        let answer = desk.run(&["verify", "forged.zip", "--level", level]);
        (answer.stdout, answer.code)
    };
    let (table, proposals) = ("data/inputs/tiny.draws.csv", "data/inputs/tiny.proposals.jsonl");

    // A table that does not follow from the proposals.
    let mut tree = honest.clone();
    forger::set_cell(&mut tree, table, 1, "graph.entry-hazard", "0.01");
    forger::reseal(&mut tree);
    let (said, code) = verified(&tree, "3");
    assert_eq!(code, 1, "{said}");
    assert!(said.contains(table), "{said}");

    // A proposal that nobody made, of which all draws, and so all the rest, still follow: it has to be made again.
    let mut tree = honest.clone();
    forger::edit(&mut tree, proposals, |text| {
        text.replacen("\"simulated-00\":-", "\"simulated-00\":-1", 1)
    });
    forger::reseal(&mut tree);
    let tree = forger::rederive(tree);
    let (said, code) = verified(&tree, "3");
    assert_eq!(code, 0, "{said}");
    let (said, code) = verified(&tree, "4");
    assert_eq!(code, 1, "{said}");
    assert!(said.contains("as the proposal is made again"), "{said}");

    // A line less.
    let mut tree = honest;
    forger::edit(&mut tree, proposals, |text| {
        text.lines().take(1).map(|l| l.to_owned() + "\n").collect()
    });
    forger::reseal(&mut tree);
    let (said, code) = verified(&tree, "3");
    assert_eq!(code, 1, "{said}");
    assert!(said.contains("1 proposals are fewer than the inference makes"), "{said}");
}

#[test]
fn a_plan_says_that_proposals_are_missing_and_a_check_makes_none() {
    let desk = desk();
    let checked = desk.run(&["check", "drawn.yaml"]);
    assert_eq!(checked.code, 0, "{}", checked.stderr);
    let planned = desk.run(&["plan", "drawn.yaml"]);
    assert_eq!(planned.code, 0, "{}", planned.stderr);
    let note = "note: keys depend on what the inference proposes; 2 of its 2 proposals have not run yet: `reenact infer tiny.yaml` runs them";
    assert!(planned.stderr.contains(note), "{}", planned.stderr);
    let inferred = desk.run(&["infer", "tiny.yaml"]);
    assert_eq!(inferred.code, 0, "{}", inferred.stderr);
    let planned = desk.run(&["plan", "drawn.yaml"]);
    assert!(
        planned.stderr.contains("note: keys depend on what the calibration measures"),
        "{}",
        planned.stderr
    );
}
