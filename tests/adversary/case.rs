//! One attack, and what the program must say to it.

use super::study::HONEST;
use crate::sandbox::{MOST_SECONDS, Sandbox};
use reenact::bundle::{Form, Tree, archive};
use reenact::digest::Sha256Digest;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

/// How the attacker hands over a bundle.
pub(crate) enum Made {
    /// A file of these bytes.
    File(Vec<u8>),
    /// A bag of these files, in an ordinary zip.
    Bag(Tree),
    /// The same, as a zip and as a folder: both must be told alike.
    Both(Tree),
    /// A folder that holds the honest bag, and what this adds to it.
    Folder(Box<dyn Fn(&Path)>),
}

/// An attack.
pub(crate) struct Case {
    /// What is done.
    pub(crate) name: &'static str,
    /// The rung that must refuse it.
    pub(crate) rung: u8,
    /// The highest rung asked for.
    pub(crate) level: u8,
    /// 1 where the bundle is not what it says, 2 where this program cannot judge it.
    pub(crate) exit: i32,
    /// The bundle.
    pub(crate) made: Made,
}

impl Case {
    /// Creates an attack that `rung` refuses, whatever is asked for above it.
    pub(crate) fn new(name: &'static str, rung: u8, made: Made) -> Self {
        Self { name, rung, level: rung.max(3), exit: 1, made }
    }

    /// Creates an attack that does something to the honest bag.
    pub(crate) fn on_honest(name: &'static str, rung: u8, attack: impl FnOnce(&mut Tree)) -> Self {
        let mut tree = HONEST.tree.clone();
        attack(&mut tree);
        Self::new(name, rung, Made::Bag(tree))
    }
}

/// Runs every attack in a sandbox and gives what was said: name, rung, exit code and every line that people read.
/// Prints the adversary's table.
#[expect(clippy::print_stdout, reason = "the table is for people, with --nocapture")]
pub(crate) fn run_all(cases: &[Case]) -> String {
    let mut said = String::new();
    for case in cases {
        let answers: Vec<(String, f64)> = match &case.made {
            Made::File(bytes) => vec![as_file(case, bytes)],
            Made::Bag(tree) => vec![as_file(case, &zip(tree))],
            Made::Both(tree) => vec![as_file(case, &zip(tree)), as_folder(case, tree, &|_| ())],
            Made::Folder(add) => vec![as_folder(case, &HONEST.tree, add)],
        };
        let (answer, seconds) = &answers[0];
        if let Some((other, _)) = answers.get(1) {
            assert_eq!(other, answer, "{}: a folder is told otherwise than a zip", case.name);
        }
        println!("{:<72} {}  {seconds:>6.2} s", case.name, case.rung);
        for (_, seconds) in &answers {
            assert!(*seconds < MOST_SECONDS, "{}: {seconds} s", case.name);
        }
        said += &format!(
            "## {}\nrefused at level {}, exit code {}\n{answer}\n",
            case.name, case.rung, case.exit
        );
    }
    said
}

/// Writes every attack that is a file into `folder`, and returns what the program says of each: what whoever else checks bundles
/// must say of it too.
pub(crate) fn written(cases: &[Case], folder: &Path) -> Vec<Value> {
    let told = cases.iter().filter_map(|case| {
        let bytes = match &case.made {
            Made::File(bytes) => bytes.clone(),
            Made::Bag(tree) | Made::Both(tree) => zip(tree),
            Made::Folder(_) => return None,
        };
        let file = format!("{}.zip", Sha256Digest::of(case.name).short());
        fs::write(folder.join(&file), &bytes).unwrap();
        let sandbox = Sandbox::new();
        sandbox.write("bundle", &bytes);
        let level = case.level.to_string();
        let answer =
            sandbox.run_reading(&["verify", "bundle", "--level", &level, "--sample-seed", "1"]);
        assert_eq!(answer.code, case.exit, "{}: {answer:?}", case.name);
        Some(json!({
            "name": case.name,
            "file": file,
            "level": case.level,
            "exit": case.exit,
            "said": answer.stdout,
        }))
    });
    told.collect()
}

fn zip(tree: &Tree) -> Vec<u8> {
    archive::write(tree, &HONEST.root, Form::Bag)
}

fn as_file(case: &Case, bytes: &[u8]) -> (String, f64) {
    let sandbox = Sandbox::new();
    sandbox.write("bundle", bytes);
    verify(case, &sandbox)
}

fn as_folder(case: &Case, tree: &Tree, add: &dyn Fn(&Path)) -> (String, f64) {
    let sandbox = Sandbox::new();
    let folder = sandbox.path("bundle");
    for (path, bytes) in tree {
        fs::create_dir_all(folder.join(path).parent().unwrap()).unwrap();
        fs::write(folder.join(path), bytes).unwrap();
    }
    add(&folder);
    verify(case, &sandbox)
}

fn verify(case: &Case, sandbox: &Sandbox) -> (String, f64) {
    let level = case.level.to_string();
    let answer =
        sandbox.run_reading(&["verify", "bundle", "--level", &level, "--sample-seed", "1"]);
    let name = case.name;
    assert_eq!((answer.stderr.as_str(), answer.code), ("", case.exit), "{name}: {answer:?}");
    let state = |line: &str| line.starts_with("  ").then(|| line.as_bytes().get(2).copied());
    let states: Vec<&str> = answer
        .stdout
        .lines()
        .filter(|line| state(line).flatten().is_some_and(|c| c.is_ascii_digit()))
        .collect();
    let refusing = states.iter().position(|line| !line.ends_with("passed"));
    assert_eq!(refusing, Some(usize::from(case.rung)), "{name}: {}", answer.stdout);
    let last = states.last().unwrap();
    let (_, told) = answer.stdout.split_once(&format!("{last}\n")).unwrap();
    (redacted(told), answer.seconds)
}

/// Hides digests, keys and measured numbers, which change with the engine: that one stands there is what matters.
pub(crate) fn redacted(text: &str) -> String {
    let (mut out, mut word) = (String::new(), String::new());
    for c in text.chars().chain(['\n']) {
        // A point belongs to a number only.
        if c.is_ascii_hexdigit() || (c == '.' && word.bytes().all(|b| b.is_ascii_digit())) {
            word.push(c);
            continue;
        }
        let is_hex = word.bytes().all(|b| b.is_ascii_hexdigit());
        let is_digest = is_hex
            && (word.len() >= 16
                || (word.len() >= 8 && word.bytes().any(|b| b.is_ascii_alphabetic()))
                || (word.len() == 8 && (out.ends_with("key ") || out.ends_with("sha256:"))));
        let is_measured = word.split_once('.').is_some_and(|(_, fraction)| fraction.len() > 3);
        out.push_str(match (is_digest, is_measured) {
            (true, _) => "*",
            (_, true) => "#",
            _ => &word,
        });
        word.clear();
        out.push(c);
    }
    out.pop();
    out
}
