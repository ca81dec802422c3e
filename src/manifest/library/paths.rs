//! Paths as manifests write them: with forward slashes, relative to where they are written.

use crate::manifest::input::WrittenIn;

/// Returns `path` without `.` steps, doubled slashes and steps that `..` undoes.
pub(in crate::manifest) fn normalised(path: &str) -> String {
    let mut steps: Vec<&str> = Vec::new();
    for step in path.split('/') {
        match step {
            "" | "." => {}
            ".." if steps.last().is_some_and(|last| *last != "..") => {
                steps.pop();
            }
            ".." if path.starts_with('/') => {}
            other => steps.push(other),
        }
    }
    let root = if path.starts_with('/') { "/" } else { "" };
    format!("{root}{}", steps.join("/"))
}

/// Returns `path`, written in the file `beside`, from where `beside` is written.
pub(in crate::manifest) fn joined(beside: &str, path: &str) -> String {
    match beside.rsplit_once('/') {
        Some((folder, _)) if !path.starts_with('/') => normalised(&format!("{folder}/{path}")),
        _ => normalised(path),
    }
}

/// Says what paths are relative to, in words.
pub(in crate::manifest) fn relative_to(written_in: WrittenIn) -> &'static str {
    match written_in {
        WrittenIn::Manifest => "paths are relative to the file they are written in",
        WrittenIn::CommandLine
        | WrittenIn::Calibration
        | WrittenIn::Inference
        | WrittenIn::PreviousMap => "paths in `--set` are relative to the current directory",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_joined_and_normalised() {
        assert_eq!(normalised("./a//b/../c.yaml"), "a/c.yaml");
        assert_eq!(normalised("../../x"), "../../x");
        assert_eq!(normalised("/a/../../b"), "/b");
        assert_eq!(joined("../worlds/basic.yaml", "priors/a.png"), "../worlds/priors/a.png");
        assert_eq!(joined("../worlds/basic.yaml", "/abs.png"), "/abs.png");
        assert_eq!(joined("basic.yaml", "a.png"), "a.png");
    }
}
