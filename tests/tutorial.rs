//! Every command of docs/tutorial.md, as a reader would type it.

use crate::sandbox::repository;
use std::path::Path;
use std::process::{Command, Stdio};

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
    let desk = tempfile::tempdir().unwrap();
    for folder in ["robots", "examples"] {
        copy(&repository().join(folder), &desk.path().join(folder));
    }
    let text = std::fs::read_to_string(repository().join("docs/tutorial.md")).unwrap();
    let blocks = blocks(&text);
    assert!(blocks.len() >= 5, "{}", blocks.len());
    let program = Path::new(env!("CARGO_BIN_EXE_reenact"));
    let mut path = vec![program.parent().unwrap().to_owned()];
    path.extend(std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default()));
    for block in blocks {
        let output = Command::new("sh")
            .args(["-euc", block])
            .current_dir(desk.path())
            .env("PATH", std::env::join_paths(&path).unwrap())
            .env("REENACT_STORE", desk.path().join("store"))
            .env("NO_COLOR", "1")
            .stdin(Stdio::null())
            .output()
            .unwrap();
        let (out, err) =
            (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        assert!(output.status.success(), "{block}\n{out}\n{err}");
        // Nothing of a tutorial is doubtful.
        assert!(!err.contains("warning:") && !err.contains("error:"), "{block}\n{err}");
    }
    for file in
        ["burger.svg", "hall.svg", "hall-study.html", "trial.html", "explored.yaml", "explored.pgm"]
    {
        assert!(desk.path().join(file).is_file(), "{file}");
    }
}
