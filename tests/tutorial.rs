//! Every command of docs/tutorial.md, as a reader would type it.

use crate::sandbox::{Answer, PROGRAM, Sandbox, repository};
use std::path::Path;
use std::process::Command;

/// Returns the shell blocks of a Markdown text.
fn blocks(text: &str) -> Vec<&str> {
    let blocks = text.split("```sh\n").skip(1);
    blocks.filter_map(|rest| rest.split("```").next()).collect()
}

/// Copies the files of `from` and below.
fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let to = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            copy(&entry.path(), &to);
        } else {
            std::fs::copy(entry.path(), to).unwrap();
        }
    }
}

#[test]
fn every_command_of_the_tutorial_does_what_it_says() {
    let desk = Sandbox::new();
    for folder in ["robots", "examples"] {
        copy(&repository().join(folder), &desk.path(folder));
    }
    let text = std::fs::read_to_string(repository().join("docs/tutorial.md")).unwrap();
    let blocks = blocks(&text);
    assert!(blocks.len() >= 5, "{}", blocks.len());
    let program = Path::new(PROGRAM).parent().unwrap();
    for block in blocks {
        let mut shell = Command::new("sh");
        desk.dress(&mut shell).args(["-euc", "PATH=$1:$PATH; eval \"$2\"", "sh"]);
        let answer = Answer::of(shell.arg(program).arg(block));
        assert_eq!(answer.code, 0, "{block}\n{answer:?}");
        // Nothing of a tutorial is doubtful.
        let doubts = ["warning:", "error:"].map(|word| answer.stderr.contains(word));
        assert_eq!(doubts, [false; 2], "{block}\n{answer:?}");
    }
    for file in
        ["burger.svg", "hall.svg", "hall-study.html", "trial.html", "explored.yaml", "explored.pgm"]
    {
        assert!(desk.path(file).is_file(), "{file}");
    }
}
